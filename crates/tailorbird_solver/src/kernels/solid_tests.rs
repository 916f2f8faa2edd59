//! Solids against the distances that another library computes, at all speeds, with all instruction sets.

use crate::properties::*;
use bevy_math::{EulerRot, Mat3, Quat, Vec3};
use parry3d::{
    query::PointQuery,
    shape::{Capsule as Pill, Cuboid as Block, Cylinder as Can, Segment},
};

use super::*;
use crate::{
    kernels::{
        ball::Ball,
        capsule::Capsule,
        contact::{Out, Phase},
        cuboid::Cuboid,
        cylinder::Cylinder,
        lanes::{Shared, SharedPoints, levels},
    },
    numbers::Numbers,
    points::Points,
};

const STILL: Motion = Motion {
    from: Vec3::ZERO,
    to: Vec3::ZERO,
    axes: Mat3::IDENTITY,
    turn: Mat3::IDENTITY,
    friction: 0.4,
};

fn point(range: f32) -> impl Strategy<Value = Vec3> {
    (-range..range, -range..range, -range..range).prop_map(Vec3::from)
}

fn size() -> impl Strategy<Value = f32> {
    0.02f32..1.0
}

/// Distance of a path's end from a shape after the contact, outwards, and the greatest depth before on the path.
fn after<Q: DistanceFunction>(
    solid: &Q,
    path: [Vec3; 2],
    distance: impl Fn(Vec3) -> f32,
) -> (f32, f32) {
    let contact = nearest(solid, &STILL, 0, path);
    let end = path[1] + contact.normal * contact.depth.max(0.0);
    let on_the_path = (0..=200).map(|k| distance(path[0].lerp(end, k as f32 / 200.0)));
    (distance(end), on_the_path.fold(f32::MAX, f32::min))
}

/// Checks a path that starts outside, as it comes and at 20 m/s through the middle (a substep of 1/960 s, and longer ones).
fn check<Q: DistanceFunction>(
    solid: &Q,
    [from, to, aim]: [Vec3; 3],
    distance: impl Fn(Vec3) -> f32,
) -> Result<(), TestCaseError> {
    let (end, _) = after(solid, [from, to], &distance);
    prop_assert!(end > -1e-4, "ends at {end}");
    if distance(from) < 1e-3 {
        return Ok(());
    }
    let direction = (aim - from).normalize_or_zero();
    for travel in [20.0 / 960.0, 20.0 / 60.0, 20.0] {
        let (end, least) = after(solid, [from, from + direction * travel], &distance);
        prop_assert!(end > -1e-4, "ends at {end} after {travel} m");
        // Half of a substep's path goes by unseen where it is short against the shape.
        let unseen = (LONG * solid.size()).min(travel) + 1e-3;
        prop_assert!(least > -unseen, "was at {least} after {travel} m");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn nothing_ends_in_a_capsule_or_behind_it(from in point(2.0), to in point(2.0), aim in point(0.1), r in size(), h in size()) {
        let shape = Pill { segment: Segment::new(Vec3::Y * -h, Vec3::Y * h), radius: r };
        let solid = Capsule::new(r, r, h, 0.0);
        check(&solid, [from, to, aim], |p| shape.distance_to_local_point(p, false))?;
    }

    #[test]
    fn nothing_ends_in_a_box_or_behind_it(from in point(2.0), to in point(2.0), aim in point(0.1), x in size(), y in size(), z in size()) {
        let half_size = Vec3::new(x, y, z);
        let shape = Block::new(half_size);
        check(&Cuboid { half_size }, [from, to, aim], |p| shape.distance_to_local_point(p, false))?;
    }

    #[test]
    fn nothing_ends_in_a_cylinder_or_behind_it(from in point(2.0), to in point(2.0), aim in point(0.1), r in size(), h in size()) {
        let shape = Can::new(h, r);
        let solid = Cylinder { radius: r, half_height: h };
        check(&solid, [from, to, aim], |p| shape.distance_to_local_point(p, false))?;
    }

    #[test]
    fn a_tapered_capsule_is_a_row_of_balls(p in point(2.0), a in size(), b in size(), h in size()) {
        let solid = Capsule::new(a, b, h, 0.0);
        let contact = nearest(&solid, &STILL, 0, [p, p]);
        let ball = |k: u32| {
            let part = k as f32 / 1000.0;
            (p - Vec3::Y * (2.0 * part - 1.0) * h).length() - (a + (b - a) * part)
        };
        let expected = (0..=1000).map(ball).fold(f32::MAX, f32::min);
        prop_assert!((contact.depth + expected).abs() < 2e-3, "{} {expected}", contact.depth);
    }
}

/// Particles around a solid that turns and moves.
fn particles() -> (Points, Points, Numbers) {
    let number = |i: usize, k: u64| crate::topology::test_meshes::random(i, k) - 0.5;
    let points = |seed: u64, size: f32| -> Points {
        (0..77)
            .map(|i| size * Vec3::new(number(i, seed), number(i, seed + 1), number(i, seed + 2)))
            .collect()
    };
    let position = points(1, 1.5);
    let mut previous = points(4, 0.3);
    for i in 0..77 {
        previous.add(i, position.get(i));
    }
    let inv_mass = (0..77).map(|i| if i % 7 == 3 { 0.0 } else { 2.0 });
    (position, previous, inv_mass.collect())
}

fn bits<Q: DistanceFunction>(level: Level, solid: &Q, cuts: &[usize]) -> Vec<u32> {
    let turn = Quat::from_euler(EulerRot::XYZ, 0.1, 0.2, 0.3);
    let motion = Motion {
        from: Vec3::new(-0.1, 0.0, 0.0),
        to: Vec3::new(0.1, 0.05, 0.0),
        axes: Mat3::from_quat(turn),
        turn: Mat3::from_quat(turn * Quat::from_rotation_z(0.2)),
        friction: 0.3,
    };
    let (mut position, mut previous, mut inv_mass) = particles();
    let len = position.len();
    let (mut normal, mut depth) = (Points::zeroed(len), Numbers::zeroed(len));
    let mut touched = false;
    for phase in [Phase::Approach, Phase::Final] {
        let touching = Touching {
            position: SharedPoints::new(&mut position),
            previous: SharedPoints::new(&mut previous),
            inv_mass: Shared::new(&mut inv_mass),
            contacts: Some((SharedPoints::new(&mut normal), Shared::new(&mut depth))),
            phase,
            out: Out {
                most: f32::INFINITY,
                overlaps: &std::sync::atomic::AtomicBool::new(false),
            },
        };
        let mut start = 0;
        for end in cuts.iter().copied().chain([len]) {
            touched |= collide_all(level, solid, &motion, touching, start..end);
            start = end;
        }
    }
    assert!(touched);
    let all = position.iter().chain(previous.iter()).chain(normal.iter());
    all.flat_map(|p| p.to_array().map(f32::to_bits)).collect()
}

fn same_bits<Q: DistanceFunction>(solid: &Q) {
    let plain = bits(Level::fallback(), solid, &[]);
    for level in levels() {
        for cuts in [&[][..], &[16], &[5, 32, 61]] {
            assert!(
                bits(level, solid, cuts) == plain,
                "{level:?}, cut at {cuts:?}"
            );
        }
    }
}

#[test]
fn every_instruction_set_and_every_cut_gives_the_same_bits() {
    same_bits(&Ball { radius: 0.4 });
    same_bits(&Capsule::new(0.3, 0.3, 0.3, 0.01));
    same_bits(&Capsule::new(0.4, 0.1, 0.3, 0.01));
    same_bits(&Cuboid {
        half_size: Vec3::new(0.3, 0.4, 0.2),
    });
    same_bits(&Cylinder {
        radius: 0.3,
        half_height: 0.3,
    });
}

#[test]
fn a_turning_box_takes_along_what_lies_on_it() {
    let turn = Quat::from_rotation_y(0.01);
    let motion = Motion {
        axes: Mat3::from_quat(turn),
        turn: Mat3::from_quat(turn),
        friction: 10.0,
        ..STILL
    };
    let at = Vec3::new(0.4, 0.5, 0.0);
    let (mut position, mut previous): (Points, Points) = (
        [at - Vec3::Y * 0.001].into_iter().collect(),
        [at].into_iter().collect(),
    );
    let mut inv_mass: Numbers = [1.0].into_iter().collect();
    let touching = Touching {
        position: SharedPoints::new(&mut position),
        previous: SharedPoints::new(&mut previous),
        inv_mass: Shared::new(&mut inv_mass),
        contacts: None,
        phase: Phase::Final,
        out: Out {
            most: f32::INFINITY,
            overlaps: &std::sync::atomic::AtomicBool::new(false),
        },
    };
    let solid = Cuboid {
        half_size: Vec3::splat(0.5),
    };
    assert!(collide_all(
        Level::fallback(),
        &solid,
        &motion,
        touching,
        0..1
    ));
    assert!(
        position.get(0).distance(turn * at) < 1e-5,
        "{}",
        position.get(0)
    );
}

#[test]
fn a_long_path_that_rounding_has_begin_below_the_surface_ends_on_it() {
    let capsule = Capsule::new(0.1, 0.1, 0.2, 0.0);
    for below in [0.0, 1e-7, 1e-6, 5e-6] {
        let path = [Vec3::X * (0.1 - below), Vec3::new(0.06, 0.02, 0.01)];
        let (end, _) = after(&capsule, path, |p| p.x.hypot(p.z) - 0.1);
        assert!(end > -1e-7, "{below}: {end}");
    }
}
