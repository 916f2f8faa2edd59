//! When and how each scene is shown: chosen by eye.

use crate::common::{scenes::SceneKind, script::Script};

/// When a scene's pictures are taken, and what happens meanwhile.
#[derive(Clone, Debug)]
pub struct Shots {
    /// When the still is taken [s].
    pub still: f32,
    /// When the animation begins [s].
    pub start: f32,
    /// Events on the way.
    pub script: Script,
}

impl Shots {
    /// Of a frame [s].
    pub const FRAME: f32 = 0.04;
    /// Frames from a picture of an animation to the next.
    const FRAMES_BETWEEN: u32 = 2;
    /// The same [10 ms].
    pub const DELAY: u16 = 8;
    /// Pictures of an animation: 3 s.
    const PICTURES: u32 = 38;

    /// Shots of a scene.
    ///
    /// # Errors
    /// When its script cannot be read.
    pub fn of(scene: SceneKind) -> Result<Self, String> {
        let (still, start, script) = match scene {
            SceneKind::Curtain => (2.96, 0.8, CURTAIN),
            SceneKind::Flag => (2.5, 1.0, FLAG),
            SceneKind::Tablecloth => (1.64, 0.2, TABLECLOTH),
            SceneKind::Ball => (2.0, 0.9, BALL),
            SceneKind::Cape => (4.76, 2.9, CAPE),
            SceneKind::Banner => (5.4, 3.6, BANNER),
            SceneKind::Garment => (3.0, 1.4, GARMENT),
            SceneKind::Crates => (1.2, 0.0, CRATES),
            SceneKind::Fan => (4.0, 1.8, FAN),
        };
        Ok(Self {
            still,
            start,
            script: script.parse()?,
        })
    }

    /// The frame of the still.
    pub fn still_frame(&self) -> u32 {
        frame(self.still)
    }

    /// The frames of the animation.
    pub fn animation_frames(&self) -> Vec<u32> {
        let first = frame(self.start);
        (0..Self::PICTURES)
            .map(|picture| first + picture * Self::FRAMES_BETWEEN)
            .collect()
    }
}

fn frame(seconds: f32) -> u32 {
    (seconds / Shots::FRAME).round() as u32
}

/// The ball pushes through below, and into the curtain from behind.
const CURTAIN: &str = "
0.0 zoom 1
0.3 hold PageUp for 0.2
0.8 hold Up for 1.2
2.3 hold Down for 0.8
";

const FLAG: &str = "
0.0 zoom 1.5
";

/// Falls; the ball rises, and goes away under it.
const TABLECLOTH: &str = "
0.0 zoom 0.7
1.7 hold PageUp for 0.2
2.3 hold Left for 0.3
";

/// The ball pushes up and goes round.
const BALL: &str = "
0.0 zoom 1
1.0 hold PageUp for 0.35
1.8 hold Right for 0.3
2.4 hold Left for 0.6
3.2 hold PageDown for 0.6
";

const CAPE: &str = "
0.0 zoom 2
";

const BANNER: &str = "
0.0 zoom 2.8
";

/// The figure hurries to and fro.
const GARMENT: &str = "
0.0 zoom 0.5
1.5 hold Left for 0.3
2.2 hold Right for 0.5
3.2 hold Left for 0.3
";

const CRATES: &str = "
0.0 zoom 0.5
";

const FAN: &str = "
0.0 zoom 0.5
";
