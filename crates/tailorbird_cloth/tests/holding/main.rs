//! Cloth that is held: attachments, motion constraints, and what holds them feels.
//!
//! Every bound comes from theory with a tolerance; none is a recorded output.

#![cfg(test)]

mod attachments;
mod bad_input;
mod bits;
mod breaking;
mod hand;
mod motion;
mod put_on;
mod regressions;
mod sleeping;
mod springs;
mod unseen;
mod world;
