//! The events of a scene, from step to step.

use std::f32::consts::TAU;

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Quat, Vec2, Vec3};
use bevy_time::{Time, Virtual};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;

use super::{
    cli::{Args, Mesh},
    demands::{Demands, Held, Scene},
    mesh,
    paths::{grown, net_ball, post},
};

/// The tube: its radius and height [m].
const TUBE: Vec2 = Vec2::new(0.3, 1.0);

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
    pub fn new(world: &mut World, args: &Args, cloth: Entity) -> Self {
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
        world.spawn((clip.to(post), ClothAttachmentOf(cloth)));
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
            holder.translation.x += self.demands.displacement;
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
            Scene::Hop if time > 2.0 => Some(Transform::from_xyz(demands.displacement, 0.0, 0.0)),
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
pub fn cloth(args: &Args) -> Cloth {
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
