//! Film of a cloth from step to step.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use tailorbird_cloth::{prelude::*, topology::order::Given};

use crate::world::Shape;

/// A collider as it stands in the calm.
pub struct Body {
    pub at: Transform,
    pub shape: Shape,
    /// True if it is on a layer that the cloth meets.
    pub meets: bool,
}

impl Body {
    /// Distance of a point from the surface, negative inside \[m\].
    pub fn distance(&self, p: Vec3) -> f32 {
        let p = self.at.rotation.inverse() * (p - self.at.translation);
        match self.shape {
            Shape::Ball(radius) => p.length() - radius,
            Shape::Capsule(radius, length) => {
                let y = p.y.clamp(-0.5 * length, 0.5 * length);
                p.distance(Vec3::Y * y) - radius
            }
            Shape::Cuboid(sides) => {
                let q = p.abs() - 0.5 * Vec3::from(sides);
                q.max(Vec3::ZERO).length() + q.max_element().min(0.0)
            }
            Shape::HalfSpace => p.y,
        }
    }
}

/// Picture of the cloth at the end of a step.
pub struct Seen {
    /// Error of the cloth, or a particle without a finite position.
    pub wrong: Option<String>,
    /// The diagonal of the box around all particles \[m\].
    pub spread: f32,
    /// Size of the rest shape \[m\].
    pub size: f32,
    /// Of [`ClothStatus::strained`] [-].
    pub strained: f32,
    /// In the calm alone.
    pub stretch: ClothStretch,
    /// In the world \[m\]; in the calm alone.
    pub places: Vec<Vec3>,
}

/// All steps of a world.
#[derive(Resource)]
pub struct Film {
    pub hz: f64,
    pub steps: Vec<Seen>,
    /// The step that the calm begins with.
    pub calm: Option<usize>,
    pub bodies: Vec<Body>,
    pub air: bool,
    /// True if anything holds the cloth in the calm.
    pub held: bool,
    /// The most that all that holds the cloth has gone together \[m\].
    pub reach: f32,
    /// Largest distance of two held particles in the calm, as a multiple of that in the flat sheet [-].
    pub asked: f32,
    /// Particles that move freely in the calm, and their masses \[kg\].
    pub free: Vec<(usize, f32)>,
    /// [m/s²].
    pub gravity: Vec3,
    /// Of the material [1/s].
    pub damping: f32,
    /// Time that stretch takes to run along the fabric [s/m].
    pub slowness: f32,
}

impl Film {
    pub fn new(hz: f64, air: bool) -> Self {
        Self {
            hz,
            steps: Vec::new(),
            calm: None,
            bodies: Vec::new(),
            air,
            held: false,
            reach: 0.0,
            asked: 0.0,
            free: Vec::new(),
            gravity: Vec3::ZERO,
            damping: 0.0,
            slowness: 0.0,
        }
    }

    pub fn begin_calm(&mut self, bodies: Vec<Body>, held: bool) {
        self.calm = Some(self.steps.len());
        self.bodies = bodies;
        self.held = held;
    }

    /// Largest depth of a free particle inside a collider as the calm begins \[m\].
    pub fn buried(&self) -> f32 {
        let places = &self.steps[self.calm.unwrap()].places;
        let mut deepest = 0.0f32;
        for body in self.bodies.iter().filter(|body| body.meets) {
            for (i, _) in &self.free {
                deepest = deepest.max(-body.distance(places[*i]));
            }
        }
        deepest
    }

    pub fn calm_steps(&self) -> usize {
        self.calm.map_or(0, |calm| self.steps.len() - calm)
    }
}

fn diagonal(places: impl Iterator<Item = Vec3>) -> f32 {
    let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (low, high) = places.fold(nothing, |(low, high), p| (low.min(p), high.max(p)));
    (high - low).max(Vec3::ZERO).length()
}

/// Takes a picture.
pub fn film(
    mut film: ResMut<Film>,
    settings: Res<ClothSettings>,
    cloths: Query<(
        &ClothParticles,
        &ClothFrame,
        &ClothTopology,
        &ClothMaterial,
        &ClothStatus,
    )>,
) {
    let (particles, frame, topology, material, status) = cloths.single().unwrap();
    if particles.is_empty() {
        return;
    }
    let places: Vec<Vec3> = particles.positions().map(|p| frame.to_world(p)).collect();
    let wrong = places.iter().position(|p| !p.is_finite());
    let wrong = wrong.map(|i| format!("particle {i} is at {}", places[i]));
    let wrong = wrong.or_else(|| status.errors().next().map(ToString::to_string));
    let spread = diagonal(places.iter().copied());
    let calm = film.calm.is_some();
    if calm && film.calm_steps() == 0 {
        let held: Vec<bool> = (0..places.len()).map(|i| particles.is_held(i)).collect();
        let rest = &topology.rest_positions;
        let order = particles.order();
        let all: Vec<usize> = (0..places.len()).filter(|i| held[*i]).collect();
        let stored = |i: usize| rest[order.stored(Given(i as u32)).index()];
        for (k, &a) in all.iter().enumerate() {
            for &b in &all[..k] {
                let times = places[a].distance(places[b]) / stored(a).distance(stored(b));
                film.asked = film.asked.max(times);
            }
        }
        let free = (0..places.len()).filter(|i| !held[*i]);
        film.free = free.map(|i| (i, particles.mass(i))).collect();
        film.gravity = settings.gravity;
        film.damping = material.damping;
        let compliance = material.warp_compliance.max(material.weft_compliance);
        film.slowness = (material.areal_density * compliance).sqrt();
    }
    film.steps.push(Seen {
        wrong,
        spread,
        size: diagonal(topology.rest_positions.iter().copied()),
        strained: status.strained(),
        stretch: if calm {
            particles.stretch(topology)
        } else {
            ClothStretch::default()
        },
        places: if calm { places } else { Vec::new() },
    });
}
