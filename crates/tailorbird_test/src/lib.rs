//! The world of the tests: an app without a window whose clock is moved by hand, and what is measured in it.
//!
//! - [`Sim`] is the app. Tests with several things in it use it as it is.
//! - [`Sheet`] is a [`Sim`] with one sheet, described by a [`Scene`].
//! - [`Path`] moves an entity, by the clock of a schedule.
//! - [`child`] runs a test of the same binary in a process of its own, [`golden`] compares with what is written down.
//!
//! Not published. It depends on neither meshes nor windows nor rendering.

#![expect(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::missing_panics_doc,
    reason = "helpers of tests"
)]

pub mod child;
mod external;
pub mod golden;
mod measure;
mod path;
mod scene;
mod sim;

pub use external::external;
pub use measure::{furthest, hash, unit};
pub use path::{Path, When};
pub use scene::{Scene, Sheet, rigid};
pub use sim::{DT, G, HZ, Recorded, Sim};
