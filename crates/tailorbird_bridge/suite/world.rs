//! Cloth and an engine's bodies in an app whose updates are steps of 1/60 s. The engine is the module `engine` of the test.

use std::f32::consts::FRAC_PI_2;

use bevy_app::{App, TaskPoolPlugin};
use bevy_ecs::prelude::*;
use bevy_math::{DVec3, Isometry3d, Mat3, Quat, UVec2, Vec2, Vec3};
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy, Virtual};
use bevy_transform::{TransformPlugin, components::Transform};
use tailorbird_cloth::{collider::ClothReaction, prelude::*};

use crate::engine;

/// Standard gravity [m/s²].
pub const G: f32 = 9.81;

/// Steps in a second.
pub const HZ: u32 = 60;

/// Kind of motion of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Kind {
    #[default]
    Dynamic,
    Fixed,
    /// With its velocity.
    Kinematic,
}

/// The form of a collider \[m\].
#[derive(Clone, Debug)]
pub enum Form {
    Ball(f32),
    /// Sides.
    Box(Vec3),
    /// Sides, and the radius that they are rounded off with.
    RoundBox(Vec3, f32),
    /// Radius, and the ends of the line.
    Capsule(f32, Vec3, Vec3),
    /// Radius and height.
    Cylinder(f32, f32),
    /// Radius and height.
    Cone(f32, f32),
    Hull(Vec<Vec3>),
    Mesh(Vec<Vec3>, Vec<[u32; 3]>),
    /// Heights by place, over a rectangle with this many cells a side and this side.
    Terrain(fn(f32, f32) -> f32, usize, f32),
    Compound(Vec<(Vec3, Quat, Form)>),
    HalfSpace(Vec3),
}

/// Kind of contact between cloth and body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Contact {
    #[default]
    Yes,
    /// A sensor.
    Sensor,
    /// The layers with these memberships and filters.
    Layers(u32, u32),
    /// The marker that opts out.
    Disabled,
}

/// A body with one collider.
#[derive(Clone, Debug)]
pub struct Body {
    pub kind: Kind,
    pub form: Form,
    /// Of the collider \[kg\].
    pub mass: f32,
    pub at: Isometry3d,
    pub velocity: Vec3,
    pub spin: Vec3,
    pub contact: Contact,
    /// True if the engine lets it sleep.
    pub sleeps: bool,
    /// True if gravity pulls it.
    pub falls: bool,
    /// Rate at which its motion decays [1/s].
    pub damping: f32,
    /// True if it moves up and down alone, and does not turn.
    pub on_rail: bool,
}

impl Body {
    pub fn new(form: Form, mass: f32, at: Vec3) -> Self {
        Self {
            kind: Kind::Dynamic,
            form,
            mass,
            at: Isometry3d::from_translation(at),
            velocity: Vec3::ZERO,
            spin: Vec3::ZERO,
            contact: Contact::Yes,
            sleeps: false,
            falls: true,
            damping: 0.0,
            on_rail: false,
        }
    }

    pub fn fixed(form: Form, at: Vec3) -> Self {
        Self {
            kind: Kind::Fixed,
            ..Self::new(form, 1.0, at)
        }
    }
}

/// Present motion of a body, in the world.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    pub position: Vec3,
    pub rotation: Quat,
    pub center: Vec3,
    pub velocity: Vec3,
    pub spin: Vec3,
    /// About the centre of mass [kg m²].
    pub inertia: Mat3,
    pub asleep: bool,
}

pub struct World {
    pub app: App,
}

impl World {
    pub fn new(gravity: Vec3) -> Self {
        let mut app = App::new();
        app.add_plugins((TaskPoolPlugin::default(), TimePlugin, TransformPlugin));
        engine::add(&mut app, gravity);
        app.insert_resource(ClothSettings {
            gravity,
            ..ClothSettings::default()
        })
        .insert_resource(ClothWind::vacuum());
        let step = std::time::Duration::from_secs(1) / HZ;
        app.insert_resource(TimeUpdateStrategy::ManualDuration(step));
        app.insert_resource(Time::<Fixed>::from_duration(step));
        app.world_mut()
            .resource_mut::<Time<Virtual>>()
            .set_max_delta(step);
        app.finish();
        app.cleanup();
        // The clock starts, without a step.
        app.update();
        Self { app }
    }

    pub fn earth() -> Self {
        Self::new(Vec3::NEG_Y * G)
    }

    /// With this many substeps in a step, in place of as many as the cloth's resolution asks for.
    pub fn with_substeps(mut self, count: u32) -> Self {
        self.app
            .world_mut()
            .resource_mut::<ClothSettings>()
            .substeps = Some(count);
        self
    }

    pub fn steps(&mut self, count: u32) {
        for _ in 0..count {
            self.app.update();
        }
    }

    pub fn seconds(&mut self, seconds: f32) {
        self.steps((seconds * HZ as f32).round() as u32);
    }

    pub fn body(&mut self, body: &Body) -> Entity {
        engine::spawn(self.app.world_mut(), body)
    }

    pub fn motion(&self, body: Entity) -> Motion {
        engine::motion(self.app.world(), body)
    }

    /// A square sheet of this side \[m\], which does not fall asleep.
    pub fn sheet(
        &mut self,
        side: f32,
        resolution: u32,
        material: ClothMaterial,
        pins: ClothPins,
        at: Transform,
    ) -> Entity {
        let cloth = Cloth::grid(Vec2::splat(side), UVec2::splat(resolution)).centered();
        let bundle = (cloth, material, pins, ClothSleep::never(), at);
        self.app.world_mut().spawn(bundle).id()
    }

    pub fn particles(&self, cloth: Entity) -> &ClothParticles {
        self.app.world().get(cloth).unwrap()
    }

    /// Positions of the particles of a cloth, in the world \[m\].
    pub fn points(&self, cloth: Entity) -> Vec<Vec3> {
        let frame = self.app.world().get::<ClothFrame>(cloth).unwrap();
        let particles = self.particles(cloth);
        particles.positions().map(|p| frame.to_world(p)).collect()
    }

    /// Of all particles, pinned ones as well [kg].
    pub fn mass(&self, cloth: Entity) -> f32 {
        let particles = self.particles(cloth);
        (0..particles.len()).map(|i| particles.mass(i)).sum()
    }

    /// Complaint about a cloth.
    pub fn complaint(&self, cloth: Entity) -> Option<String> {
        let status = self.app.world().get::<ClothStatus>(cloth).unwrap();
        let lost = || self.points(cloth).iter().position(|p| !p.is_finite());
        let error = status.errors().next().map(ToString::to_string);
        error.or_else(|| lost().map(|i| format!("particle {i} is nowhere")))
    }

    pub fn reaction(&self, body: Entity) -> Option<ClothReaction> {
        self.app
            .world()
            .resource::<ClothReactions>()
            .get(body)
            .copied()
    }

    /// Depth of the deepest particle inside a body \[m\]; negative if all are outside.
    pub fn depth(&self, cloth: Entity, body: Entity) -> f32 {
        let motion = self.motion(body);
        let at = Isometry3d::new(motion.position, motion.rotation).inverse();
        let points = self.points(cloth).into_iter().map(|p| at * p);
        points
            .map(|point| engine::depth(self.app.world(), body, point))
            .fold(f32::MIN, f32::max)
    }

    /// Linear momentum [kg m/s] and angular momentum about the origin [kg m²/s] of a cloth whose frame is the world's and of
    /// a body.
    pub fn momentum(&self, cloth: Entity, body: Entity, mass: f32) -> [DVec3; 2] {
        let particles = self.particles(cloth);
        let Motion {
            center,
            velocity,
            spin,
            inertia,
            ..
        } = self.motion(body);
        let linear = (mass * velocity).as_dvec3();
        let angular = center.as_dvec3().cross(linear) + (inertia * spin).as_dvec3();
        [
            particles.momentum().as_dvec3() + linear,
            particles.angular_momentum().as_dvec3() + angular,
        ]
    }
}

/// All edges of a sheet.
pub fn all_edges() -> ClothPins {
    ClothPins::edges([
        ClothEdge::Top,
        ClothEdge::Bottom,
        ClothEdge::Left,
        ClothEdge::Right,
    ])
}

/// Lying, at this height \[m\].
pub fn lying(height: f32) -> Transform {
    Transform::from_xyz(0.0, height, 0.0).with_rotation(Quat::from_rotation_x(-FRAC_PI_2))
}
