//! Cloth and its motion, as data and functions, without an ECS.
//!
//! This is the inside of `tailorbird_cloth`. Games use the components and systems of that crate, which keeps its promises from one version
//! to the next. Here are
//!
//! - the rest shape and the topology computed from it once: [`shape`], [`topology`];
//! - a cloth in a step: [`particles`] (state, input, scratch, as arrays of [`points`] and [`numbers`]), [`frame`], holders, colliders,
//!   wind;
//! - `step`: the loop over substeps, and the table of their stages;
//! - the arithmetic, one file for each equation, explained in `kernels/README.md`.
//!
//! Modules that no documentation lists are public for `tailorbird_cloth` alone.
//!
//! Units are metres, kilograms and seconds.

#[doc(hidden)]
pub mod cloth;
#[doc(hidden)]
pub mod coefficients;
#[doc(hidden)]
pub mod contact;
#[doc(hidden)]
pub mod effort;
pub mod error;
#[doc(hidden)]
pub mod fingerprint;
pub mod frame;
#[doc(hidden)]
pub mod grant;
#[doc(hidden)]
pub mod hand;
#[doc(hidden)]
pub mod held;
#[doc(hidden)]
pub mod holds;
pub mod instruction_set;
#[doc(hidden)]
pub mod kernels;
#[doc(hidden)]
pub mod limits;
#[doc(hidden)]
pub mod memory;
pub mod numbers;
pub mod particles;
pub mod points;
#[doc(hidden)]
pub mod pose;
#[cfg(test)]
mod properties;
#[doc(hidden)]
pub mod reaction;
pub mod shape;
#[doc(hidden)]
pub mod solve;
mod split;
#[doc(hidden)]
pub mod step;
#[doc(hidden)]
pub mod stillness;
#[doc(hidden)]
pub mod substep;
#[doc(hidden)]
pub mod tethers;
pub mod topology;
pub mod wall_clock;
pub mod wind;
#[doc(hidden)]
pub mod workers;

/// True if this crate was built without optimisation: its kernels are then some 200 times slower.
pub const UNOPTIMISED: bool = cfg!(unoptimised);
