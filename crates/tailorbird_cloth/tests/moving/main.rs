//! Motion between frames, while cloth stands still, and at once.

#![cfg(test)]

mod elsewhere;
mod frames;
mod game;
mod growing;
mod standing_still;
