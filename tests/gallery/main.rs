#![cfg(test)]
//! The measure that compares pictures, tried on made-up ones and on those in the repository; and the animations' format.

#![allow(dead_code, reason = "the example uses the rest")]

#[path = "../../examples/gallery/animation.rs"]
mod animation;
#[path = "../../examples/gallery/compare.rs"]
mod compare;
#[path = "../../examples/gallery/difference.rs"]
mod difference;
#[path = "../../examples/gallery/shrink.rs"]
mod shrink;
mod stored;
