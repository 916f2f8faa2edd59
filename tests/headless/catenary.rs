//! A narrow band that hangs from its ends takes the catenary of its length.

use bevy::prelude::*;
use tailorbird::prelude::*;

use crate::world::*;

/// Sag of a chain of length 1 over a span: with half the span b = a arsinh(1/(2a)), sag = √(a² + ¼) − a. By bisection.
fn catenary_sag(span: f64) -> f64 {
    let half_span = |a: f64| a * (0.5 / a).asinh();
    let (mut low, mut high) = (1e-6, 1e3);
    for _ in 0..200 {
        let a = 0.5 * (low + high);
        if half_span(a) < span / 2.0 {
            low = a;
        } else {
            high = a;
        }
    }
    (low * low + 0.25).sqrt() - low
}

#[test]
fn a_band_takes_the_catenary_of_its_length() {
    const COLUMNS: u32 = 41;
    for span in [0.6f32, 0.9] {
        let mut sim = Sim::vacuum().with_passes(32, 4);
        let inset = (1.0 - span) / 2.0;
        // Two rows 2 cm apart, horizontal, so that the band bends across its plane.
        let pins = [0, 1].map(|row| {
            let z = row as f32 * 0.02;
            let target = |x: f32| Some(Vec3::new(x, -z, 0.0));
            let pin = |particle, x| ClothPin {
                target: target(x),
                ..ClothPin::new(ClothSelection::Particle(particle))
            };
            [
                pin(row * COLUMNS, inset),
                pin(row * COLUMNS + COLUMNS - 1, 1.0 - inset),
            ]
        });
        let cloth = sim.spawn((
            Cloth::grid(Vec2::new(1.0, 0.02), UVec2::new(COLUMNS, 2)),
            ClothMaterial {
                // A chain does not resist bending.
                bend_compliance: 1e9,
                damping: 3.0,
                ..undamped()
            },
            ClothPins {
                pins: pins.concat(),
            },
            Transform::from_rotation(lying()),
        ));
        sim.seconds(12.0);
        let positions = sim.positions(cloth);
        let columns = COLUMNS as usize;
        let heights: Vec<f32> = (0..columns)
            .map(|c| 0.5 * (positions[c].y + positions[columns + c].y))
            .collect();
        let sag = -heights.iter().copied().fold(0.0, f32::min);
        let expected = catenary_sag(f64::from(span)) as f32;
        println!(
            "span {span}: sag {sag}, {expected} expected, longest edge {}",
            longest_edge(&sim, cloth)
        );
        assert!((sag / expected - 1.0).abs() < 0.01, "{sag} {expected}");
        // The lowest point is the middle, and the band hangs still.
        assert!((heights[20] + sag).abs() < 1e-3);
        for c in 0..columns {
            assert!((heights[c] - heights[columns - 1 - c]).abs() < 0.01 * sag);
        }
        assert!(sim.velocities(cloth).iter().all(|v| v.length() < 0.02));
    }
}
