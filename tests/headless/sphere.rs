//! No particle is ever inside a sphere, and none passes through one, whatever both do.

use bevy::prelude::*;
use proptest::prelude::*;
use tailorbird::prelude::*;

use crate::world::*;

/// Rounding leaves particles this far [m] inside at most: a coordinate of a few metres is rounded in the cloth's frame, when
/// it is pushed out, and on the way to the world.
const ROUNDING: f32 = 3e-6;

fn deepest(sim: &Sim, cloth: Entity, center: Vec3, radius: f32) -> f32 {
    let thickness = sim.get::<ClothMaterial>(cloth).thickness;
    sim.positions(cloth)
        .into_iter()
        .enumerate()
        .filter(|(i, _)| !sim.particles(cloth).is_pinned(*i))
        .map(|(_, p)| radius + thickness - p.distance(center))
        .fold(f32::NEG_INFINITY, f32::max)
}

fn point(range: f32) -> impl Strategy<Value = Vec3> {
    (-range..range, -range..range, -range..range).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 1000,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn no_particle_is_inside_after_a_drop(
        center in point(1.0),
        radius in 0.05f32..0.6,
        from in point(1.5),
        turn in point(3.0),
        speed in point(8.0),
        substeps in 1u32..=8,
    ) {
        // Some begin inside.
        let at_once = |s: &mut ClothSettings| s.overlap_speed = f32::INFINITY;
        let mut sim = Sim::new().with_passes(substeps, 2).with_settings(at_once);
        sim.spawn((ClothCollider::sphere(radius), Transform::from_translation(center)));
        let cloth = sim.spawn((
            square(8),
            Transform::from_translation(from).with_rotation(Quat::from_scaled_axis(turn)),
        ));
        sim.steps(0);
        sim.edit::<ClothForces>(cloth, |forces| {
            for i in 0..64 {
                forces.add_acceleration(i, speed / DT);
            }
        });
        for _ in 0..15 {
            sim.steps(2);
            let depth = deepest(&sim, cloth, center, radius);
            prop_assert!(depth <= ROUNDING, "{depth:e} m inside");
        }
    }
}

/// Follows the particles relative to a sphere from substep to substep.
#[derive(Resource)]
struct Chase {
    sphere: Vec3,
    velocity: Vec3,
    radius: f32,
    before: Vec<Vec3>,
    deepest: f32,
}

/// Depth to which the straight path of each free particle through a substep goes into the sphere, in the sphere's own system.
fn chase(
    step: Res<ClothStep>,
    mut chase: ResMut<Chase>,
    cloths: Query<(&ClothParticles, &ClothFrame)>,
) {
    let Ok((particles, frame)) = cloths.single() else {
        return;
    };
    let steps = step.steps() as f32 - 1.0 + step.fraction();
    let center = chase.sphere + chase.velocity * (steps * step.seconds());
    let now: Vec<Vec3> = (0..particles.len())
        .map(|i| particles.world_position(i, frame) - center)
        .collect();
    for (i, (&from, &to)) in std::mem::take(&mut chase.before)
        .iter()
        .zip(&now)
        .enumerate()
    {
        if !particles.is_pinned(i) {
            let along = to - from;
            let t = (-from.dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
            let depth = chase.radius - (from + along * t).length();
            chase.deepest = chase.deepest.max(depth);
        }
    }
    chase.before = now;
}

/// A pinned curtain that a sphere flies through: how deep particles get into the sphere or its path [m].
fn flown_through(substeps: u32, speed: f32, radius: f32) -> f32 {
    let mut sim = Sim::new().with_passes(substeps, 2);
    let cloth = sim.spawn((square(16), ClothPins::edges([ClothEdge::Top])));
    let start = Vec3::new(0.03, -0.1, 1.5);
    let sphere = sim.spawn((
        ClothCollider::sphere(radius),
        Transform::from_translation(start),
    ));
    let velocity = Vec3::NEG_Z * speed;
    sim.app.insert_resource(Chase {
        sphere: start,
        velocity,
        radius: radius + ClothMaterial::cotton().thickness,
        before: Vec::new(),
        deepest: f32::NEG_INFINITY,
    });
    sim.app
        .add_systems(ClothSubstep, chase.after(ClothSubstepSystems::Collide));
    // The first step knows no motion yet.
    // Until it is 0.4 m beyond: what it has drawn out to a quarter of the cloth, it goes through.
    let steps = (1.9 / speed * HZ as f32) as usize;
    for k in 1..=steps {
        let now = start + velocity * (k as f32 * DT);
        sim.edit::<Transform>(sphere, |t| t.translation = now);
        sim.steps(1);
        assert!(sim.all_finite(cloth));
    }
    sim.app.world().resource::<Chase>().deepest
}

#[test]
fn no_particle_tunnels_through_a_sphere_that_flies_through_a_curtain() {
    for substeps in [1, 8] {
        for (speed, radius) in [(20.0, 0.3), (20.0, 0.1), (5.0, 0.3)] {
            let depth = flown_through(substeps, speed, radius);
            println!("{substeps} substeps, {speed} m/s, radius {radius}: {depth:e}");
            assert!(
                depth < 10.0 * ROUNDING,
                "{substeps} {speed} {radius}: {depth:e}"
            );
        }
    }
}

#[test]
fn particles_in_the_way_of_a_fast_sphere_are_pushed_ahead() {
    for substeps in [1, 8] {
        let mut sim = Sim::vacuum().without_gravity().with_passes(substeps, 2);
        let cloth = sim.spawn(square(9));
        let sphere = sim.spawn((
            ClothCollider::sphere(0.3),
            Transform::from_xyz(0.0, 0.0, 1.0),
        ));
        for k in 0..30 {
            let z = 1.0 - 20.0 * k as f32 * DT;
            sim.edit::<Transform>(sphere, |t| t.translation.z = z);
            sim.steps(1);
            // The particle in the middle is in front of the sphere or where it was.
            let middle = sim.at(cloth, 40);
            assert!(middle.z <= z - 0.3 || z > 0.3, "{substeps}: {middle} {z}");
        }
    }
}

#[test]
fn a_sphere_that_jumps_sweeps_up_nothing() {
    let mut sim = Sim::vacuum().without_gravity();
    let cloth = sim.spawn(square(5));
    let sphere = sim.spawn((
        ClothCollider::sphere(0.3),
        Transform::from_xyz(0.0, 0.0, 50.0),
    ));
    sim.steps(2);
    sim.edit::<Transform>(sphere, |t| t.translation.z = -50.0);
    sim.steps(2);
    assert!(sim.positions(cloth).iter().all(|p| p.z.abs() < 1e-6));
}

#[test]
fn a_sphere_under_a_scaled_parent_has_the_scaled_radius() {
    let mut sim = Sim::new();
    let parent = sim.spawn(Transform::from_scale(Vec3::splat(2.0)));
    let sphere = sim.spawn(ClothCollider::sphere(0.15));
    sim.app.world_mut().entity_mut(parent).add_child(sphere);
    let cloth = sim.spawn((
        square(8),
        Transform::from_xyz(0.0, 0.4, 0.0).with_rotation(lying()),
    ));
    sim.steps(20);
    let depth = deepest(&sim, cloth, Vec3::ZERO, 0.3);
    assert!(depth <= ROUNDING && depth > -0.02, "{depth}");
}
