//! Scripts: what a player does and when, as text.
//!
//! One line for each action: the time [s], the action, its values. Empty lines and what follows a `#` do not count.
//!
//! ```text
//! 0.5 point cloth 0.5 1    # the pointer goes to this point of the cloth: fractions from the left and from the top
//! 0.5 point 0.5 0.4        # … of the picture
//! 0.6 press                # the left mouse button
//! 0.6 move 0.2 -0.1 over 1 # to the right and down, in heights of the picture, within a time [s]
//! 1.6 wheel -2             # notches
//! 1.8 key P                # P, R, N, Space, 1 to 9, Left, Right, Up, Down, PageUp, PageDown, Shift
//! 2.0 release
//! 2.0 hold Up for 1        # a key, for a time [s]
//! 3.0 wind 5 0 1           # [m/s]
//! 3.0 gusts 0.5
//! 3.0 preset silk
//! 3.0 show wireframe       # or hide: texture, wireframe, particles, stretch, shear, bend, pins, normals, bounds, colliders
//! 4.0 orbit 40 5 over 1    # turns the camera to the right and up [°]
//! 4.0 zoom 2               # notches
//! ```

use std::str::FromStr;

use bevy::{math::Vec2, math::Vec3, prelude::KeyCode};

use super::scenes::SceneKind;

/// The format, for `--help`.
pub const FORMAT: &str = "\
Script: one line for each action: the time [s], the action, its values. Empty lines and what follows a # do not count.
  0.5 point cloth 0.5 1     the pointer goes to this point of the cloth: fractions from the left and from the top
  0.5 point 0.5 0.4         ... of the picture
  0.6 press                 the left mouse button
  0.6 move 0.2 -0.1 over 1  to the right and down, in heights of the picture, within a time [s]
  1.6 wheel -2              notches
  1.8 key P                 P, R, N, Space, 1 to 9, Left, Right, Up, Down, PageUp, PageDown, Shift
  2.0 release
  2.0 hold Up for 1         a key, for a time [s]
  3.0 wind 5 0 1            [m/s]
  3.0 gusts 0.5
  3.0 preset silk
  3.0 show wireframe        or hide: texture, wireframe, particles, stretch, shear, bend, pins, normals, bounds, colliders
  4.0 orbit 40 5 over 1     turns the camera to the right and up [degrees]
  4.0 zoom 2                notches";

/// Actions of a player, in order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script {
    /// The actions, the first one first.
    pub cues: Vec<Cue>,
}

/// An action with its time.
#[derive(Clone, Debug, PartialEq)]
pub struct Cue {
    /// [s].
    pub at: f32,
    /// The action.
    pub action: Action,
}

/// Something that a player does.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Puts the pointer somewhere: fractions from the left and from the top of the picture.
    PointAt(Vec2),
    /// Puts the pointer on the cloth: fractions from the left and from the top of the grid.
    PointAtCloth(Vec2),
    /// Presses the left mouse button.
    Press,
    /// Releases it.
    Release,
    /// Moves the pointer to the right and down [heights of the picture].
    Move {
        /// Displacement.
        by: Vec2,
        /// Duration [s].
        over: f32,
    },
    /// Turns the wheel [notches].
    Wheel(f32),
    /// Holds a key.
    Key {
        /// The key.
        key: KeyCode,
        /// Duration [s]; 0 is one frame.
        seconds: f32,
    },
    /// Sets the wind [m/s].
    ClothWind(Vec3),
    /// Sets the gusts' strength.
    ClothGusts(f32),
    /// Chooses a preset.
    Preset(String),
    /// Shows or hides something.
    Look {
        /// What.
        name: String,
        /// True if it is shown.
        shown: bool,
    },
    /// Turns the camera [°].
    Orbit {
        /// To the right and up.
        by: Vec2,
        /// Duration [s].
        over: f32,
    },
    /// Brings the camera closer [notches].
    Zoom(f32),
}

impl Script {
    /// The script that shows what a scene is about.
    pub fn of(scene: SceneKind) -> Self {
        let text = match scene {
            SceneKind::Curtain => CURTAIN,
            SceneKind::Flag => FLAG,
            SceneKind::Tablecloth => TABLECLOTH,
            SceneKind::Ball => BALL,
            SceneKind::Cape => CAPE,
            SceneKind::Banner => BANNER,
            SceneKind::Garment => GARMENT,
            SceneKind::Crates => CRATES,
            SceneKind::Fan => FAN,
        };
        // A test reads all of them.
        text.parse().unwrap_or_default()
    }
}

/// Drag, pin, release, release the pin; then the ball pushes through, then wind.
const CURTAIN: &str = "
1.5 point cloth 0.45 0.95
1.6 press
1.6 move 0.25 -0.25 over 1.0
2.8 key P
3.0 release
3.8 key P
4.0 hold Up for 1.2
5.2 hold Down for 1.2
5.6 wind 1 0 -2.5
";

/// The wind turns and drops; a corner is held for a while.
const FLAG: &str = "
2.0 point cloth 0.95 0.5
2.1 press
2.1 move -0.2 0.15 over 0.8
3.4 release
4.2 wind 3 0 3
5.5 wind 0 0 0
";

/// Falls, is pulled off a little, and the ball moves away under it.
const TABLECLOTH: &str = "
2.4 point cloth 0.5 0.98
2.5 press
2.5 move 0.25 -0.3 over 0.9
3.8 release
4.4 hold Left for 0.3
5.2 hold PageUp for 0.3
";

/// The ball pushes up, goes round, and is let go.
const BALL: &str = "
1.0 hold PageUp for 0.35
1.8 hold Right for 0.3
2.4 hold Left for 0.6
3.2 point cloth 0.5 0.99
3.3 press
3.3 move 0.05 -0.22 over 0.6
4.2 key P
4.4 release
5.0 key P
5.2 hold PageDown for 0.5
";

/// It runs by itself; the ball gets in its way.
const CAPE: &str = "
3.0 hold Right for 0.9
";

/// The wind turns, and somebody pulls at a corner.
const BANNER: &str = "
2.0 point cloth 0.9 0.95
2.1 press
2.1 move 0.2 -0.1 over 0.8
3.2 release
4.5 wind -3 0 1.5
";

/// The figure hurries to and fro.
const GARMENT: &str = "
1.5 hold Left for 0.3
2.2 hold Right for 0.5
3.2 hold Left for 0.3
";

/// One after the other falls; then a corner of the sheet is pulled.
const CRATES: &str = "
4.0 point cloth 0.5 0.98
4.1 press
4.1 move 0.0 0.15 over 0.6
5.2 release
";

/// The fan sweeps by itself; a corner is lifted, and the ball goes through below.
const FAN: &str = "
2.0 point cloth 0.9 0.95
2.1 press
2.1 move -0.1 -0.2 over 0.8
3.4 release
4.5 hold Up for 0.8
";

impl FromStr for Script {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut cues = Vec::new();
        for (number, line) in text.lines().enumerate() {
            let line = line.split('#').next().unwrap_or_default();
            let words: Vec<&str> = line.split_whitespace().collect();
            if let Some((at, rest)) = words.split_first() {
                let cue = cue(at, rest).map_err(|error| format!("line {}: {error}", number + 1))?;
                cues.push(cue);
            }
        }
        cues.sort_by(|a, b| a.at.total_cmp(&b.at));
        Ok(Self { cues })
    }
}

fn cue(at: &str, words: &[&str]) -> Result<Cue, String> {
    let at = number(at)?;
    let action = match words {
        ["point", "cloth", x, y] => Action::PointAtCloth(pair(x, y)?),
        ["point", x, y] => Action::PointAt(pair(x, y)?),
        ["press"] => Action::Press,
        ["release"] => Action::Release,
        ["move", x, y] => moved(x, y, "0")?,
        ["move", x, y, "over", over] => moved(x, y, over)?,
        ["wheel", notches] => Action::Wheel(number(notches)?),
        ["key", name] => held(name, "0")?,
        ["hold", name, "for", seconds] => held(name, seconds)?,
        ["wind", x, y, z] => Action::ClothWind(pair(x, y)?.extend(number(z)?)),
        ["gusts", strength] => Action::ClothGusts(number(strength)?),
        ["preset", name] => Action::Preset((*name).into()),
        ["show", name] => look(name, true),
        ["hide", name] => look(name, false),
        ["orbit", yaw, pitch] => orbit(yaw, pitch, "0")?,
        ["orbit", yaw, pitch, "over", over] => orbit(yaw, pitch, over)?,
        ["zoom", notches] => Action::Zoom(number(notches)?),
        _ => return Err(format!("{:?} is no action; see --help", words.join(" "))),
    };
    Ok(Cue { at, action })
}

fn number(word: &str) -> Result<f32, String> {
    match word.parse::<f32>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("{word:?} is no number")),
    }
}

fn pair(x: &str, y: &str) -> Result<Vec2, String> {
    Ok(Vec2::new(number(x)?, number(y)?))
}

fn moved(x: &str, y: &str, over: &str) -> Result<Action, String> {
    Ok(Action::Move {
        by: pair(x, y)?,
        over: number(over)?,
    })
}

fn orbit(yaw: &str, pitch: &str, over: &str) -> Result<Action, String> {
    Ok(Action::Orbit {
        by: pair(yaw, pitch)?,
        over: number(over)?,
    })
}

fn look(name: &str, shown: bool) -> Action {
    Action::Look {
        name: name.into(),
        shown,
    }
}

fn held(name: &str, seconds: &str) -> Result<Action, String> {
    let key = match name {
        "P" => KeyCode::KeyP,
        "R" => KeyCode::KeyR,
        "N" => KeyCode::KeyN,
        "Space" => KeyCode::Space,
        "1" => KeyCode::Digit1,
        "2" => KeyCode::Digit2,
        "3" => KeyCode::Digit3,
        "4" => KeyCode::Digit4,
        "5" => KeyCode::Digit5,
        "6" => KeyCode::Digit6,
        "7" => KeyCode::Digit7,
        "8" => KeyCode::Digit8,
        "9" => KeyCode::Digit9,
        "Left" => KeyCode::ArrowLeft,
        "Right" => KeyCode::ArrowRight,
        "Up" => KeyCode::ArrowUp,
        "Down" => KeyCode::ArrowDown,
        "PageUp" => KeyCode::PageUp,
        "PageDown" => KeyCode::PageDown,
        "Shift" => KeyCode::ShiftLeft,
        _ => return Err(format!("{name:?} is no key of the demo; see --help")),
    };
    Ok(Action::Key {
        key,
        seconds: number(seconds)?,
    })
}
