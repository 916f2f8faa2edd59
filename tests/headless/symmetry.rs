//! A scene that is symmetric about a plane stays symmetric.

use bevy::prelude::*;
use tailorbird::prelude::*;

use crate::world::*;

/// The largest distance of a particle from the mirror image of its partner.
fn asymmetry(sim: &Sim, cloth: Entity, partner: impl Fn(usize) -> usize, mirror: Vec3) -> f32 {
    let positions = sim.positions(cloth);
    (0..positions.len())
        .map(|i| positions[i].distance(positions[partner(i)] * mirror))
        .fold(0.0, f32::max)
}

const LEFT_RIGHT: Vec3 = Vec3::new(-1.0, 1.0, 1.0);

#[test]
fn a_curtain_in_gravitys_plane_stays_in_it() {
    let mut sim = Sim::new();
    let cloth = sim.spawn((
        square(12),
        ClothMaterial::silk(),
        ClothPins::corners(ClothCorner::TOP),
    ));
    sim.seconds(3.0);
    // Nothing in the scene has a z coordinate other than 0: exact.
    assert!(sim.positions(cloth).iter().all(|p| p.z == 0.0));
}

#[test]
fn a_hanging_sheet_stays_mirrored() {
    // Gauss–Seidel solves one diagonal before the other. With enough passes the order no longer matters; what is left of it
    // is a part of the residual of the constraints, which is below the mean stretch times the spacing.
    for n in [12, 13] {
        let mut sim = Sim::new().with_passes(16, 4);
        let cloth = sim.spawn((
            square(n),
            ClothMaterial::cotton(),
            ClothPins::corners(ClothCorner::TOP),
            Transform::from_rotation(lying()),
        ));
        let n = n as usize;
        let spacing = 1.0 / (n - 1) as f32;
        let mut worst = 0.0f32;
        for _ in 0..20 {
            sim.steps(6);
            let partner = |i: usize| i / n * n + (n - 1 - i % n);
            worst = worst.max(asymmetry(&sim, cloth, partner, LEFT_RIGHT));
        }
        println!("{n}: {worst} m of {spacing} m");
        assert!(worst < 0.25 * spacing, "{n}: {worst} {spacing}");
    }
}

#[test]
fn a_sheet_on_a_sphere_stays_centered() {
    // A flat sheet on a ball must fold, and which way is an instability: single particles need not mirror each other. The
    // sheet as a whole has no reason to slide off to either side.
    let mut sim = Sim::new().with_passes(16, 4);
    sim.spawn(ClothCollider::sphere(0.3));
    let cloth = sim.spawn((
        square(13),
        ClothMaterial::cotton(),
        Transform::from_xyz(0.0, 0.4, 0.0).with_rotation(lying()),
    ));
    let spacing = 1.0 / 12.0;
    let mut worst = 0.0f32;
    for step in 0..60 {
        sim.steps(1);
        let center = sim.center_of_mass(cloth);
        worst = worst.max(center.x.hypot(center.z));
        if step < 8 {
            // It falls freely, in which nothing breaks the symmetry.
            let left_right = asymmetry(&sim, cloth, |i| i / 13 * 13 + (12 - i % 13), LEFT_RIGHT);
            assert!(left_right < 1e-5, "{left_right}");
        }
    }
    println!("{worst} m of {spacing} m");
    assert!(worst < 0.25 * spacing, "{worst}");
}
