//! A banner on a boat that sails in circles. Drag it with the left mouse button, turn the camera with the right one; the arrow
//! keys move the ball.

mod common;

use std::process::ExitCode;

use common::scenes::SceneKind;

fn main() -> ExitCode {
    common::play("banner", SceneKind::Banner)
}
