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

use std::f32::consts::TAU;

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Quat, Vec2, Vec3};
use bevy_time::{Time, Virtual};
use bevy_transform::components::Transform;
use clap::{Args, ValueEnum};
use tailorbird_cloth::prelude::*;

use super::{
    cli::{self, Mesh},
    mesh,
    paths::{grown, net_ball, post},
    scene::SIZE,
};

/// Demands of the scenes.
#[derive(Args, Clone, Copy, Debug)]
pub struct Demands {
    /// Excess of the distance of the posts over the length of the sheet, as a part of 2 m.
    #[arg(long, value_name = "F", default_value_t = 0.1, value_parser = cli::finite, allow_hyphen_values = true)]
    pub apart: f32,

    /// Excess of the ball's radius over that of the tube around it, as a part of it.
    #[arg(long, value_name = "F", default_value_t = 0.03, value_parser = cli::not_negative, allow_hyphen_values = true)]
    pub tight: f32,

    /// Depth of a body within the sheet [m].
    #[arg(long, value_name = "M", default_value_t = 0.05, value_parser = cli::not_negative, allow_hyphen_values = true)]
    pub depth: f32,

    /// Speed of the ball [m/s].
    #[arg(long, value_name = "V", default_value_t = 20.0, value_parser = cli::positive, allow_hyphen_values = true)]
    pub speed: f32,

    /// Body that is put into the cloth.
    #[arg(long, value_enum, default_value_t = Body::Ball)]
    pub body: Body,

    /// Displacement of the curtain's holder in the scenes pause-move and hop [m].
    #[arg(long, value_name = "M", default_value_t = 2.0, value_parser = cli::finite, allow_hyphen_values = true)]
    pub way: f32,

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
    fn collider(self) -> ClothCollider {
        match self {
            Self::Ball => ClothCollider::sphere(0.3),
            Self::Capsule => ClothCollider::capsule(0.2, 0.4),
            Self::Box => ClothCollider::cuboid(0.5, 0.5, 0.5),
            Self::Ground => ClothCollider::half_space(),
        }
    }

    /// From its middle to its top [m].
    fn height(self) -> f32 {
        match self {
            Self::Ball => 0.3,
            Self::Capsule => 0.4,
            Self::Box => 0.25,
            Self::Ground => 0.0,
        }
    }
}

/// The tube: its radius and height [m].
const TUBE: Vec2 = Vec2::new(0.3, 1.0);

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

/// Play of a scene from step to step.
pub struct Play {
    scene: Scene,
    demands: Demands,
    side: u32,
    /// The post that moves, or the body.
    actor: Option<Entity>,
    /// True if the sheet was moved.
    moved: bool,
}

impl Play {
    /// Prepares what acts on a cloth. The middle of an upright sheet is 1 m above the ground.
    pub fn new(world: &mut World, args: &cli::Args, cloth: Entity) -> Self {
        let (scene, demands) = (args.scene, args.demands);
        let mut play = Self {
            scene,
            demands,
            side: args.size,
            actor: None,
            moved: false,
        };
        match scene {
            Scene::Posts | Scene::PutBack => {
                let half = 0.5 * scene.size().x;
                play.attach(world, cloth, |p| p.x < mesh::NEAR - half);
                play.attach(world, cloth, |p| p.x > half - mesh::NEAR);
            }
            Scene::PauseMove | Scene::Hop if demands.held == Held::Attached => {
                play.attach(world, cloth, |p| p.y > 0.5 * scene.size().y - mesh::NEAR);
            }
            Scene::PauseMove | Scene::Hop => {
                let holder = world.spawn(Transform::default()).add_child(cloth).id();
                play.actor = Some(holder);
            }
            Scene::Net => {
                let ball = ClothCollider::sphere(0.3);
                play.actor = Some(world.spawn((ball, net_ball(0.0))).id());
            }
            Scene::Ball => {
                let ball = ClothCollider::sphere(0.2);
                play.actor = Some(world.spawn((ball, play.flying_ball(0.0))).id());
            }
            Scene::Upright => {
                world.spawn(ClothCollider::half_space());
            }
            Scene::Tube => {
                let ball = ClothCollider::sphere(TUBE.x * (1.0 + demands.tight));
                world.spawn((ball, Transform::from_xyz(0.0, 1.0, 0.0)));
            }
            Scene::Overlap => {
                let height = 1.0 - demands.body.height() + demands.depth;
                let place = Transform::from_xyz(0.0, height, 0.0);
                world.spawn((demands.body.collider(), place));
            }
            _ => {}
        }
        play
    }

    fn attach(&mut self, world: &mut World, cloth: Entity, held: impl Fn(Vec3) -> bool) {
        let Some(positions) = world.get::<Cloth>(cloth).map(Cloth::rest_positions) else {
            return;
        };
        let particles = (0..).zip(positions).filter(|(_, p)| held(*p));
        let clip = ClothAttachment::particles(particles.map(|(i, _)| i));
        let post = world.spawn(Transform::default()).id();
        world.spawn((clip.to(post), AttachmentOf(cloth)));
        self.actor = Some(post);
    }

    fn drag(&self, world: &mut World, cloth: Entity, time: f32) {
        let rest = world.get::<Cloth>(cloth).map(Cloth::rest_positions);
        let (Some(rest), Some(mut pins)) = (rest, world.get_mut::<ClothPins>(cloth)) else {
            return;
        };
        let [a, b] = [0, self.side - 1];
        let along = (rest[b as usize] - rest[a as usize]).normalize();
        let aside = along * 0.5 * (1.0 - (2.0 * TAU * time).cos());
        pins.pins = [a, b]
            .map(|i| ClothPin::at(i, rest[i as usize] + aside))
            .to_vec();
    }

    /// Events between two frames, before the step that ends at `time` [s]: while time stands still.
    pub fn interrupt(&mut self, app: &mut App, time: f32) {
        if self.scene != Scene::PauseMove || self.moved || time <= 2.0 {
            return;
        }
        self.moved = true;
        app.world_mut().resource_mut::<Time<Virtual>>().pause();
        app.update();
        if let Some(actor) = self.actor
            && let Some(mut holder) = app.world_mut().get_mut::<Transform>(actor)
        {
            holder.translation.x += self.demands.way;
        }
        app.update();
        app.world_mut().resource_mut::<Time<Virtual>>().unpause();
    }

    /// Before the step that ends at `time` [s].
    pub fn act(&mut self, world: &mut World, cloth: Entity, time: f32) {
        let demands = self.demands;
        let place = match self.scene {
            Scene::Posts => Some(post(time, demands.apart)),
            Scene::PutBack if time > 4.0 => Some(Transform::default()),
            Scene::PutBack => Some(post(time, demands.apart)),
            Scene::Hop if time > 3.0 => Some(Transform::default()),
            Scene::Hop if time > 2.0 => Some(Transform::from_xyz(demands.way, 0.0, 0.0)),
            Scene::Grow => {
                if let Some(mut place) = world.get_mut::<Transform>(cloth) {
                    place.scale = grown(time);
                }
                None
            }
            Scene::Net => Some(net_ball(time)),
            Scene::Drag => {
                self.drag(world, cloth, time);
                None
            }
            Scene::Ball => Some(self.flying_ball(time)),
            Scene::ImpaledGone if time > 4.0 => {
                if let Some(body) = self.actor.take() {
                    world.despawn(body);
                }
                None
            }
            Scene::Impaled | Scene::ImpaledGone if time > 2.0 && self.actor.is_none() => {
                let middle = Transform::from_xyz(0.0, 1.0, 0.0);
                self.actor = Some(world.spawn((demands.body.collider(), middle)).id());
                None
            }
            Scene::Upright if time > 1.0 => {
                if let Some(mut pins) = world.get_mut::<ClothPins>(cloth)
                    && !pins.pins.is_empty()
                {
                    pins.pins.clear();
                }
                None
            }
            _ => None,
        };
        if let (Some(place), Some(actor)) = (place, self.actor)
            && let Some(mut transform) = world.get_mut::<Transform>(actor)
        {
            *transform = place;
        }
    }

    /// A little beside the middle, as a ball that hits a particle exactly is nothing that happens.
    fn flying_ball(&self, time: f32) -> Transform {
        Transform::from_xyz(0.011, 1.007, self.demands.speed * (time - 1.0) - 2.0)
    }
}

/// The cloth of a scene, around its origin.
pub fn cloth(args: &cli::Args) -> Cloth {
    let (scene, size) = (args.scene, args.scene.size());
    let resolution = scene.resolution(args.size);
    let jitter = match args.mesh {
        Mesh::Grid if scene != Scene::Tube => {
            return Cloth::grid(size, resolution.into()).centered();
        }
        Mesh::Grid | Mesh::Shuffled => 0.0,
        Mesh::Irregular => mesh::JITTER,
    };
    if scene == Scene::Tube {
        mesh::tube(args.size, TUBE, jitter)
    } else {
        mesh::sheet(resolution, size, jitter)
    }
}

/// Pose of the cloth of a scene: rows along +z at a height of 1 m, or upright, 1 m above the ground.
pub fn place(scene: Scene) -> Isometry3d {
    let rotation = if scene.is_upright() {
        Quat::IDENTITY
    } else {
        Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2)
    };
    Isometry3d::new(Vec3::Y, rotation)
}
