//! Reactions of bodies.

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Mat3, Quat, UVec2, Vec3};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{Scene, Sheet, external};

/// A rigid body, stepped as a physics engine would.
#[derive(Clone)]
pub struct Body {
    entity: Entity,
    shape: ClothColliderShape,
    mass: f32,
    /// About every axis [kg m²].
    inertia: f32,
    pub at: Isometry3d,
    pub velocity: Vec3,
    pub spin: Vec3,
}

const STEP: f32 = 1.0 / 60.0;

impl Body {
    pub fn ball(sheet: &mut Sheet, mass: f32, radius: f32, at: Vec3, velocity: Vec3) -> Self {
        Self {
            entity: sheet.sim.spawn(()),
            shape: ClothColliderShape::Sphere { radius },
            mass,
            inertia: 0.4 * mass * radius * radius,
            at: Isometry3d::from_translation(at),
            velocity,
            spin: Vec3::ZERO,
        }
    }

    pub fn step(&mut self, sheet: &mut Sheet, gravity: Vec3) -> Option<Vec3> {
        self.velocity += gravity * STEP;
        let start = self.at;
        let turn = |by: Vec3, q: Quat| (Quat::from_scaled_axis(by) * q).normalize();
        let center = Vec3::from(start.translation) + self.velocity * STEP;
        let end = Isometry3d::new(center, turn(self.spin * STEP, start.rotation));
        sheet
            .sim
            .resource_mut::<ClothExternalColliders>()
            .push(external(
                self.entity,
                self.shape.clone(),
                [start, end],
                Some(ClothColliderBody {
                    body: self.entity,
                    inv_mass: Vec3::splat(1.0 / self.mass),
                    inv_inertia: Mat3::from_diagonal(Vec3::splat(1.0 / self.inertia)),
                    center_of_mass: center,
                    linear_velocity: self.velocity,
                    angular_velocity: self.spin,
                }),
            ));
        sheet.steps(1);
        self.at = end;
        let reactions = sheet.sim.resource::<ClothReactions>();
        let reaction = *reactions.get(self.entity)?;
        self.velocity = reaction.linear_velocity;
        self.spin = reaction.angular_velocity;
        self.at = Isometry3d::new(
            center + reaction.translation,
            turn(reaction.rotation, end.rotation),
        );
        Some(reaction.impulse)
    }

    fn momenta(&self) -> [Vec3; 2] {
        let p = self.velocity * self.mass;
        [
            p,
            Vec3::from(self.at.translation).cross(p) + self.spin * self.inertia,
        ]
    }

    pub fn energy(&self) -> f32 {
        0.5 * (self.mass * self.velocity.length_squared()
            + self.inertia * self.spin.length_squared())
    }
}

/// Momentum, angular momentum and kinetic energy of a sheet.
pub fn sheet_momenta(sheet: &Sheet) -> ([Vec3; 2], f32) {
    let particles = sheet.particles();
    let (mut p, mut l, mut e) = (Vec3::ZERO, Vec3::ZERO, 0.0);
    for i in 0..particles.len() {
        let (m, v) = (particles.mass(i), particles.velocity(i));
        p += m * v;
        l += particles.position(i).cross(m * v);
        e += 0.5 * m * v.length_squared();
    }
    ([p, l], e)
}

fn free(side: u32) -> Sheet {
    let mut scene = Scene {
        resolution: UVec2::splat(side),
        gravity: Vec3::ZERO,
        ..Scene::default()
    };
    scene.material.damping = 0.0;
    Sheet::new(&scene)
}

#[test]
fn a_ball_that_strikes_a_sheet_loses_what_the_sheet_gets() {
    // The sheet weighs 0.6 kg.
    for mass in [0.002, 0.05, 1.0, 50.0] {
        let mut sheet = free(33);
        let velocity = Vec3::new(0.5, 0.0, 2.0);
        let mut ball = Body::ball(&mut sheet, mass, 0.2, Vec3::new(0.3, 0.1, -0.3), velocity);
        ball.spin = Vec3::new(0.0, 3.0, 1.0);
        let [p, l] = ball.momenta();
        let energy = ball.energy();
        let mut worst = [0.0_f32; 2];
        for step in 0..60 {
            ball.step(&mut sheet, Vec3::ZERO);
            let (of_sheet, kinetic) = sheet_momenta(&sheet);
            let [p_now, l_now] = [0, 1].map(|k| of_sheet[k] + ball.momenta()[k]);
            let (wrong_p, wrong_l) = ((p_now - p).length(), (l_now - l).length());
            worst = [
                worst[0].max(wrong_p / p.length()),
                worst[1].max(wrong_l / (l.length() + p.length())),
            ];
            assert!(
                wrong_p < 0.0025 * p.length(),
                "{mass} kg, step {step}: {wrong_p} of {p}"
            );
            assert!(
                wrong_l < 0.025 * (l.length() + p.length()),
                "{mass} kg, step {step}: {wrong_l} of {l}"
            );
            let now = kinetic + ball.energy();
            assert!(
                now < 1.01 * energy,
                "{mass} kg, step {step}: {now} J of {energy} J"
            );
        }
        println!("{mass} kg: momentum off by {worst:?}");
        let slower = (velocity - ball.velocity).length() / velocity.length();
        assert!(slower > 1e-3, "{mass} kg: the sheet was not met");
    }
}

/// Of a sheet at the origin, by gravity.
fn potential(sheet: &Sheet) -> f32 {
    let world = sheet.sim.app.world();
    let particles = world
        .get::<ClothParticles>(sheet.entity)
        .expect("particles");
    let heights = (0..particles.len()).map(|i| particles.mass(i) * particles.position(i).z);
    9.81 * heights.sum::<f32>()
}

/// A sheet of 0.6 kg that is held at its edges.
fn trampoline(gravity: Vec3) -> Sheet {
    Sheet::new(&Scene {
        resolution: UVec2::splat(33),
        pins: ClothPins::edges([
            ClothEdge::Top,
            ClothEdge::Bottom,
            ClothEdge::Left,
            ClothEdge::Right,
        ]),
        gravity,
        ..Scene::default()
    })
}

#[test]
fn a_sheet_carries_balls_of_any_mass() {
    let gravity = Vec3::NEG_Z * 9.81;
    for mass in [0.05, 0.5, 3.0, 20.0, 100.0] {
        let mut sheet = trampoline(gravity);
        let mut ball = Body::ball(&mut sheet, mass, 0.3, Vec3::new(0.1, 0.0, 0.35), Vec3::ZERO);
        let weight = mass * 9.81;
        let energy = |ball: &Body| ball.energy() + weight * ball.at.translation.z;
        let start = energy(&ball);
        let mut carried = 0.0;
        for step in 0..360 {
            let impulse = ball.step(&mut sheet, gravity);
            if step >= 240 {
                carried += impulse.map_or(0.0, |impulse| impulse.z) / 2.0;
            }
            let now = energy(&ball) + sheet_momenta(&sheet).1 + potential(&sheet);
            assert!(
                now < 1.01 * start,
                "{mass} kg, step {step}: {now} J of {start} J"
            );
        }
        let height = ball.at.translation.z;
        assert!(height > 0.1, "{mass} kg: sank to {height}");
        let part = carried / weight;
        assert!(
            (part - 1.0).abs() < 0.004,
            "{mass} kg: {part} of its weight"
        );
        // Of this gravity takes 0.16 m/s in a step, before the sheet gives it back.
        let speed = ball.velocity.length();
        assert!(speed < 0.17, "{mass} kg: {}", ball.velocity);
    }
}

#[test]
fn a_sheet_that_is_lifted_takes_a_ball_along() {
    let gravity = Vec3::NEG_Z * 9.81;
    let mut sheet = trampoline(gravity);
    let mut ball = Body::ball(&mut sheet, 1.0, 0.3, Vec3::Z * 0.3, Vec3::ZERO);
    let (mut speed, mut height, mut measured) = (0.0_f32, 0.0, 0.0);
    for step in 0..180 {
        if step >= 60 {
            speed = (speed + 0.02).min(1.0);
        }
        height += speed * STEP;
        let mut entity = sheet.sim.app.world_mut().entity_mut(sheet.entity);
        *entity.get_mut::<Transform>().expect("a sheet") = Transform::from_xyz(0.0, 0.0, height);
        let before = ball.at.translation.z;
        ball.step(&mut sheet, gravity);
        if step >= 150 {
            measured += (ball.at.translation.z - before) / (30.0 * STEP);
        }
    }
    assert!((measured - 1.0).abs() < 0.02, "{measured} m/s");
    let speed = ball.velocity.z;
    // It still swings on the sheet.
    assert!((speed - 1.0).abs() < 0.1, "its velocity says {speed} m/s");
}

#[test]
fn nothing_is_given_back_twice() {
    let mut sheet = free(9);
    let mut ball = Body::ball(
        &mut sheet,
        1.0,
        0.2,
        Vec3::new(0.0, 0.0, -0.25),
        Vec3::Z * 4.0,
    );
    assert!((0..5).any(|_| ball.step(&mut sheet, Vec3::ZERO).is_some()));
    sheet.steps(1);
    assert_eq!(sheet.sim.resource::<ClothReactions>().iter().count(), 0);
}
