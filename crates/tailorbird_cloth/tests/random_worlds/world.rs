//! Worlds, and the distributions of random ones.

use std::f32::consts::PI;

use proptest::{collection::vec, prelude::*};

/// A vector or a rotation vector, so that what proptest prints is code.
pub type V = [f32; 3];

/// A sheet, what holds it, and what happens to it in the first two seconds.
#[derive(Clone, Debug)]
pub struct World {
    pub sheet: Sheet,
    pub holds: Vec<Hold>,
    pub clock: Clock,
    /// True if there is air, still or not; else a vacuum.
    pub air: bool,
    pub events: Vec<(f32, Event)>,
}

#[derive(Clone, Debug)]
pub struct Sheet {
    /// True if it is an irregular mesh, else a grid.
    pub irregular: bool,
    /// Columns and rows.
    pub particles: [u32; 2],
    /// Width and height \[m\].
    pub size: [f32; 2],
    /// Index of [`ClothMaterial::presets`](tailorbird_cloth::prelude::ClothMaterial::presets).
    pub fabric: usize,
    /// True if it starts in an upright plane, else in a level one.
    pub upright: bool,
    /// True if it is the child of an entity that moves in its place.
    pub child: bool,
}

/// Frames and steps in a second, and where things move.
#[derive(Clone, Debug)]
pub struct Clock {
    pub fps: f64,
    pub hz: f64,
    /// In `FixedUpdate`, or in `Update`.
    pub fixed: bool,
}

/// Holds particles of the sheet.
#[derive(Clone, Debug)]
pub struct Hold {
    pub grip: Grip,
    pub by: By,
}

/// Particles that are held.
#[derive(Clone, Debug)]
pub enum Grip {
    /// The particle that is nearest to a point, as parts of width and height.
    Near([f32; 2]),
    /// Both corners at an edge: top, bottom, left, right.
    Corners(usize),
    /// All of an edge.
    Edge(usize),
}

/// Holder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// Pins, which move with the sheet's entity.
    Pin,
    /// Pins with targets, which move in its frame.
    Target,
    /// An entity of its own.
    Entity,
    /// The same, by a spring.
    Spring,
}

/// The shape of a collider \[m\].
#[derive(Clone, Debug)]
pub enum Shape {
    Ball(f32),
    /// Radius, and length between the centres.
    Capsule(f32, f32),
    /// Its sides.
    Cuboid(V),
    HalfSpace,
}

/// Event. Holders and colliders are named by a number, of which the remainder by their count is taken; holder 0 is the sheet's entity, or
/// its parent.
#[derive(Clone, Debug)]
pub enum Event {
    /// Still air is a velocity of 0 [m/s].
    ClothWind {
        velocity: V,
        turbulence: f32,
    },
    Appear {
        shape: Shape,
        at: V,
        turn: V,
        /// [m/s].
        velocity: V,
    },
    /// The way \[m\] is gone at this speed [m/s]; at an infinite one at once.
    MoveBody {
        body: usize,
        by: V,
        speed: f32,
    },
    Vanish {
        body: usize,
    },
    /// Sets layers of collider and cloth that meet, or do not.
    Layers {
        body: usize,
        meet: bool,
    },
    Move {
        holder: usize,
        by: V,
        speed: f32,
    },
    /// A rotation vector, and a speed [rad/s].
    Turn {
        holder: usize,
        by: V,
        speed: f32,
    },
    /// Elsewhere at once, told by `ClothSampledMotion::teleport`.
    Teleport {
        holder: usize,
        by: V,
    },
    Release {
        hold: usize,
    },
    /// Time stands still, and meanwhile a holder is moved.
    Pause {
        holder: usize,
        by: V,
    },
    Scale(V),
    Gravity(V),
}

/// Coordinates up to `most` each.
fn vector(most: f32) -> impl Strategy<Value = V> {
    [-most..most, -most..most, -most..most]
}

fn sheet() -> impl Strategy<Value = Sheet> {
    let side = || prop_oneof![3 => 4u32..13, 1 => 13u32..34];
    let length = || 0.3f32..3.0;
    (
        any::<bool>(),
        [side(), side()],
        [length(), length()],
        0usize..7,
        any::<bool>(),
        prop::bool::weighted(0.25),
    )
        .prop_map(|(irregular, particles, size, fabric, upright, child)| {
            // No cell is more than four times as long as wide.
            let cells = particles.map(|n| (n - 1) as f32);
            let width = size[0] / cells[0];
            let height = (size[1] / cells[1]).clamp(0.25 * width, 4.0 * width);
            Sheet {
                irregular,
                particles,
                size: [size[0], height * cells[1]],
                fabric,
                upright,
                child,
            }
        })
}

fn hold() -> impl Strategy<Value = Hold> {
    let grip = prop_oneof![
        2 => [0f32..1.0, 0f32..1.0].prop_map(Grip::Near),
        2 => (0usize..4).prop_map(Grip::Corners),
        1 => (0usize..4).prop_map(Grip::Edge),
    ];
    let by = prop_oneof![
        3 => Just(By::Pin),
        1 => Just(By::Target),
        3 => Just(By::Entity),
        1 => Just(By::Spring),
    ];
    (grip, by).prop_map(|(grip, by)| Hold { grip, by })
}

fn clock() -> impl Strategy<Value = Clock> {
    let hz = prop_oneof![6 => Just(60.0), 1 => Just(30.0), 1 => Just(144.0)];
    let fps = prop_oneof![3 => Just(None), 1 => Just(Some(60.0)), 1 => Just(Some(45.0))];
    (hz, fps, any::<bool>()).prop_map(|(hz, fps, fixed)| Clock {
        fps: fps.unwrap_or(hz),
        hz,
        fixed,
    })
}

fn shape() -> impl Strategy<Value = Shape> {
    let length = || 0.05f32..0.6;
    prop_oneof![
        length().prop_map(Shape::Ball),
        (length(), length()).prop_map(|(radius, length)| Shape::Capsule(radius, length)),
        [length(), length(), length()].prop_map(Shape::Cuboid),
        Just(Shape::HalfSpace),
    ]
}

/// Speed: slow, fast, a hop, or there at once.
fn speed() -> impl Strategy<Value = f32> {
    prop_oneof![
        3 => 0.2f32..6.0,
        2 => 6f32..30.0,
        1 => 30f32..100.0,
        2 => Just(f32::INFINITY),
    ]
}

fn event() -> impl Strategy<Value = Event> {
    let number = || 0usize..6;
    let displacement = || prop_oneof![3 => vector(0.5), 2 => vector(3.0), 1 => vector(20.0)];
    let turn = || vector(PI);
    let factor = || prop_oneof![Just(1f32), 0.5f32..2.0, -2f32..-0.5];
    let wind = prop_oneof![Just([0.0; 3]), vector(6.0), vector(57.0)];
    let velocity = prop_oneof![Just([0.0; 3]), vector(2.0), vector(25.0)];
    prop_oneof![
        2 => (wind, 0f32..15.0)
            .prop_map(|(velocity, turbulence)| Event::ClothWind { velocity, turbulence }),
        4 => (shape(), vector(1.5), turn(), velocity)
            .prop_map(|(shape, at, turn, velocity)| Event::Appear { shape, at, turn, velocity }),
        2 => (number(), displacement(), speed())
            .prop_map(|(body, by, speed)| Event::MoveBody { body, by, speed }),
        1 => number().prop_map(|body| Event::Vanish { body }),
        1 => (number(), any::<bool>()).prop_map(|(body, meet)| Event::Layers { body, meet }),
        5 => (number(), displacement(), speed())
            .prop_map(|(holder, by, speed)| Event::Move { holder, by, speed }),
        2 => (number(), turn(), speed())
            .prop_map(|(holder, by, speed)| Event::Turn { holder, by, speed }),
        1 => (number(), displacement()).prop_map(|(holder, by)| Event::Teleport { holder, by }),
        1 => number().prop_map(|hold| Event::Release { hold }),
        1 => (number(), displacement()).prop_map(|(holder, by)| Event::Pause { holder, by }),
        1 => prop_oneof![
            factor().prop_map(|all| [all; 3]),
            [factor(), factor(), factor()],
        ]
        .prop_map(Event::Scale),
        1 => prop_oneof![
            Just([0.0; 3]),
            Just([0.0, -1.62, 0.0]),
            vector(15.0),
        ]
        .prop_map(Event::Gravity),
    ]
}

pub fn world() -> impl Strategy<Value = World> {
    let events = vec((0f32..super::WILD, event()), 0..10);
    let holds = vec(hold(), 0..4);
    let air = prop::bool::weighted(0.75);
    (sheet(), holds, clock(), air, events).prop_map(|(sheet, holds, clock, air, mut events)| {
        events.sort_by(|a, b| a.0.total_cmp(&b.0));
        World {
            sheet,
            holds,
            clock,
            air,
            events,
        }
    })
}
