//! A 2 × 2 sheet that hangs from its top edge is a plain pendulum of its height; it swings with the period 2π √(L/g).

use std::f32::consts::TAU;

use bevy::prelude::*;
use tailorbird::prelude::*;

use crate::world::*;

/// Period [s] and height of the last swing as a part of the first.
fn swing(height: f32, substeps: u32) -> (f32, f32) {
    let mut sim = Sim::vacuum().with_passes(substeps, 4);
    let cloth = sim.spawn((
        Cloth::grid(Vec2::new(0.3, height), UVec2::splat(2)),
        undamped(),
        ClothPins::edges([ClothEdge::Top]),
    ));
    sim.steps(0);
    // A push of 0.05 √(g L): swings out by 0.05 rad.
    let speed = 0.05 * (G * height).sqrt();
    sim.edit::<ClothForces>(cloth, |forces| {
        for bottom in [2, 3] {
            forces.add_acceleration(bottom, Vec3::Z * speed / DT);
        }
    });
    let mut crossings = Vec::new();
    let mut heights = vec![0.0f32];
    let mut before = 0.0f32;
    for step in 1..=1200 {
        sim.steps(1);
        let z = sim.at(cloth, 2).z;
        if step > 5 && before < 0.0 && z >= 0.0 {
            crossings.push((step as f32 - 1.0 + before / (before - z)) * DT);
            heights.push(0.0);
        }
        if let Some(last) = heights.last_mut() {
            *last = last.max(z.abs());
        }
        before = z;
    }
    let swings = crossings.len() - 1;
    let period = (crossings[swings] - crossings[0]) / swings as f32;
    (period, heights[swings] / heights[0])
}

#[test]
fn swings_with_the_period_of_its_length() {
    for height in [0.25, 1.0] {
        let (period, kept) = swing(height, 32);
        // An amplitude of 0.05 rad lengthens the period by 0.05²/16, far below the tolerance.
        let expected = TAU * (height / G).sqrt();
        println!("{height} m: {period} s, {expected} s expected; swing kept {kept}");
        assert!(
            (period / expected - 1.0).abs() < 0.01,
            "{period} {expected}"
        );
        // Projection corrects along the direction at the end of the substep, which has turned by θ' h: the tension m g brakes
        // with m g θ' h, so that the swing decays at the rate g h/(2 L), and by nothing else.
        let decay = (-G * DT / 32.0 / (2.0 * height) * 20.0).exp();
        println!("{decay} expected");
        assert!((kept / decay - 1.0).abs() < 0.05, "{kept} {decay}");
    }
}
