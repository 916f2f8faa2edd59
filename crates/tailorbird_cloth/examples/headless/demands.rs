//! Scenes that ask for more than the fabric has, or do to it what games do every day.
//!
//! | scene | what happens |
//! | --- | --- |
//! | posts | a sheet of 2 m × 1 m, held along both short sides; one side goes away by a part of 2 m within a second and stands |
//! | put-back | the same; after 4 s the side is put back in one step |
//! | impaled | into the middle of a curtain that has hung for 2 s a still body of 0.3 m is put, for 10 s |
//! | impaled-gone | the same, and after 2 s it is taken away |
//! | net | held all round; the middle of a ball of 0.3 m goes 0.6 m beyond its plane at 1 m/s, stands for a second, comes back |
//! | tube | a tube of cloth around a ball that is too large |
//! | overlap | a sheet without pins that a body reaches into when it appears |
//! | upright | a curtain whose pins are released over the ground |
//! | ball | a ball flies through a curtain and on |
//! | drag | hung by two corners, which go 1 m aside and back twice in a second: up to 6.3 m/s and 79 m/s² |
//! | pause-move | `Time<Virtual>` is paused, what holds a curtain is moved, time goes on |
//! | hop | what holds a curtain is put elsewhere from one frame to the next, and a second later back |
//! | grow | a curtain's scale goes from 1 to 2 and back within two seconds; half a second later it is mirrored |

use bevy_math::Vec2;
use clap::{Args, ValueEnum};
use tailorbird_cloth::prelude::*;

use super::values;

/// Width and height of the sheet [m].
pub const SIZE: f32 = 2.0;

/// Demands of the scenes.
#[derive(Args, Clone, Copy, Debug)]
pub struct Demands {
    /// Excess of the distance of the posts over the length of the sheet, as a part of 2 m.
    #[arg(long, value_name = "F", default_value_t = 0.1, value_parser = values::finite, allow_hyphen_values = true)]
    pub apart: f32,

    /// Excess of the ball's radius over that of the tube around it, as a part of it.
    #[arg(long, value_name = "F", default_value_t = 0.03, value_parser = values::not_negative, allow_hyphen_values = true)]
    pub tight: f32,

    /// Depth of a body within the sheet [m].
    #[arg(long, value_name = "M", default_value_t = 0.05, value_parser = values::not_negative, allow_hyphen_values = true)]
    pub depth: f32,

    /// Speed of the ball [m/s].
    #[arg(long, value_name = "V", default_value_t = 20.0, value_parser = values::positive, allow_hyphen_values = true)]
    pub speed: f32,

    /// Body that is put into the cloth.
    #[arg(long, value_enum, default_value_t = Body::Ball)]
    pub body: Body,

    /// Displacement of the curtain's holder in the scenes pause-move and hop [m].
    #[arg(long = "way", value_name = "M", default_value_t = 2.0, value_parser = values::finite, allow_hyphen_values = true)]
    pub displacement: f32,

    /// Holder of the curtain there.
    #[arg(long, value_enum, default_value_t = Held::Attached)]
    pub held: Held,
}

/// Holder of a curtain that is moved.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// An entity that the curtain is attached to.
    Attached,
    /// The parent of the curtain, which is pinned.
    Child,
}

/// Scene.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scene {
    /// Swings down from two corners.
    Hang,
    /// Blows in the wind, held at one edge.
    Flag,
    /// Falls on a sphere.
    Drape,
    /// Falls.
    Free,
    /// Between two posts that stand too far apart.
    Posts,
    /// The same, and one is put back at once.
    PutBack,
    /// A body is put into a curtain.
    Impaled,
    /// The same, and is taken away.
    ImpaledGone,
    /// A ball is pushed into a net that is held all round, and comes back.
    Net,
    /// A tube around a ball that is too large.
    Tube,
    /// A body appears that reaches into a sheet.
    Overlap,
    /// A curtain whose pins are released over the ground.
    Upright,
    /// A ball flies through a curtain.
    Ball,
    /// Held by two corners that go to and fro.
    Drag,
    /// A curtain whose holder is moved while time stands still.
    PauseMove,
    /// A curtain whose holder is put elsewhere from one frame to the next.
    Hop,
    /// A curtain whose entity grows and shrinks, and is mirrored.
    Grow,
}

/// Body that is put into a cloth.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// A ball with a radius of 0.3 m.
    Ball,
    /// A capsule with a radius of 0.2 m, 0.8 m from end to end, upright.
    Capsule,
    /// A box with edges of 0.5 m.
    Box,
    /// Everything below a plane.
    Ground,
}

impl Body {
    pub fn collider(self) -> ClothCollider {
        match self {
            Self::Ball => ClothCollider::sphere(0.3),
            Self::Capsule => ClothCollider::capsule(0.2, 0.4),
            Self::Box => ClothCollider::cuboid(0.5, 0.5, 0.5),
            Self::Ground => ClothCollider::half_space(),
        }
    }

    /// From its middle to its top [m].
    pub fn height(self) -> f32 {
        match self {
            Self::Ball => 0.3,
            Self::Capsule => 0.4,
            Self::Box => 0.25,
            Self::Ground => 0.0,
        }
    }
}

impl Scene {
    /// Duration of the scene [s]; none if it goes on.
    pub fn seconds(self, demands: &Demands) -> Option<f64> {
        Some(match self {
            Self::Posts => 5.0,
            Self::PutBack | Self::ImpaledGone => 7.0,
            Self::Impaled => 12.0,
            Self::Net => 5.5,
            Self::Tube => 6.0,
            Self::Drag => 3.0,
            Self::Overlap => 3.0,
            Self::Upright | Self::PauseMove => 4.0,
            Self::Hop | Self::Grow => 6.0,
            // It is a second beyond the curtain at the end.
            Self::Ball => 2.0 + 2.0 / f64::from(demands.speed),
            Self::Hang | Self::Flag | Self::Drape | Self::Free => return None,
        })
    }

    /// The size of the sheet [m].
    pub fn size(self) -> Vec2 {
        match self {
            Self::Posts | Self::PutBack => Vec2::new(SIZE, 0.5 * SIZE),
            _ => Vec2::splat(SIZE),
        }
    }

    /// Columns and rows of a sheet with `size` along its longer side.
    pub fn resolution(self, size: u32) -> [u32; 2] {
        match self {
            Self::Posts | Self::PutBack => [size, size / 2 + 1],
            _ => [size; 2],
        }
    }

    /// Returns whether the sheet starts upright, and not lying at a height of 1 m.
    pub fn is_upright(self) -> bool {
        matches!(
            self,
            Self::Impaled
                | Self::ImpaledGone
                | Self::Upright
                | Self::Ball
                | Self::Tube
                | Self::PauseMove
                | Self::Hop
                | Self::Grow
        )
    }
}
