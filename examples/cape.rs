//! A cape on somebody who runs, jumps, and is put elsewhere now and then. Drag it with the left mouse button, turn the camera
//! with the right one; the arrow keys move the ball.

mod common;

use std::process::ExitCode;

use common::scenes::SceneKind;

fn main() -> ExitCode {
    common::play("cape", SceneKind::Cape)
}
