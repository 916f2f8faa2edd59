//! A strip that is clamped at one end droops as the elastica: B θ'' = −σ g (L − s) cos θ with θ(0) = 0, θ'(L) = 0.

use bevy_math::{UVec2, Vec2, Vec3};
use tailorbird_cloth::prelude::*;
use tailorbird_test::{G, Scene, Sheet, rigid};

/// Deflection of the free end below the clamp, by the length, for `weight` = σ g L³/B. Runge–Kutta, and the curvature at the clamp by
/// bisection.
pub fn elastica(weight: f64) -> f64 {
    let shoot = |curvature: f64| {
        let (mut angle, mut bend, mut droop) = (0.0_f64, curvature, 0.0);
        let n = 2000;
        let h = 1.0 / f64::from(n);
        let slope = |s: f64, [angle, bend, _]: [f64; 3]| {
            [bend, -weight * (1.0 - s) * angle.cos(), angle.sin()]
        };
        for k in 0..n {
            let s = f64::from(k) * h;
            let y = [angle, bend, droop];
            let ahead = |k: [f64; 3], part: f64| std::array::from_fn(|i| y[i] + part * h * k[i]);
            let k1 = slope(s, y);
            let k2 = slope(s + 0.5 * h, ahead(k1, 0.5));
            let k3 = slope(s + 0.5 * h, ahead(k2, 0.5));
            let k4 = slope(s + h, ahead(k3, 1.0));
            let sum: [f64; 3] = std::array::from_fn(|i| k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
            angle += sum[0] * h / 6.0;
            bend += sum[1] * h / 6.0;
            droop += sum[2] * h / 6.0;
        }
        (bend, droop)
    };
    // Between straight and what a beam without deflection would have.
    let (mut low, mut high) = (0.0, 0.5 * weight);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if shoot(middle).0 < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    shoot(high).1
}

#[test]
fn the_elastica_of_a_stiff_strip_is_a_beam() {
    // σ g L⁴/(8 B).
    assert!((elastica(0.01) / (0.01 / 8.0) - 1.0).abs() < 1e-4);
}

const COLUMNS: u32 = 5;
const LENGTH: f32 = 0.5;

/// A strip of `rows` whose σ g L³/B is `weight`, L being its free length: how far it droops by that length. None where it is stiffer than a line
/// can be.
fn droop(rows: u32, substeps: Option<u32>, hz: f64, weight: f32) -> Option<f64> {
    let spacing = LENGTH / (rows - 1) as f32;
    // The clamp is half way between the two pinned rows.
    let free = spacing * (rows as f32 - 1.5);
    let density = rigid().areal_density;
    let rigidity = density * G * free.powi(3) / weight;
    let mut strip = Sheet::new(&Scene {
        size: Vec2::new(spacing * (COLUMNS - 1) as f32, LENGTH),
        resolution: UVec2::new(COLUMNS, rows),
        material: ClothMaterial {
            bend_compliance: 1.0 / rigidity,
            damping: 4.0,
            ..rigid()
        },
        pins: ClothPins::particles(0..2 * COLUMNS),
        gravity: Vec3::NEG_Z * G,
        substeps,
        ..Scene::default()
    });
    strip.sim.set_hz(hz);
    strip.step();
    let substeps = strip.sim.resource::<ClothStep>().substeps();
    let seconds = 1.0 / (hz as f32 * substeps as f32);
    if rigidity * seconds * seconds > 100.0 * density * spacing.powi(4) {
        return None;
    }
    strip.steps((6.0 * hz) as u32);
    assert_eq!(strip.complaint(), None);
    let particles = strip.particles();
    let last = particles.len() - COLUMNS as usize..particles.len();
    let depth: f64 = last.map(|i| -f64::from(particles.position(i).z)).sum();
    Some(depth / f64::from(COLUMNS) / f64::from(free))
}

#[test]
fn a_clamped_strip_droops_as_the_elastica() {
    let mut wrong = Vec::new();
    for weight in [0.1, 1.0, 10.0, 100.0] {
        let expected = elastica(f64::from(weight));
        let mut measured = 0;
        for rows in [17, 33, 65, 129] {
            for (substeps, hz) in [(None, 60.0), (Some(32), 60.0), (None, 30.0), (None, 240.0)] {
                let Some(droop) = droop(rows, substeps, hz, weight) else {
                    continue;
                };
                measured += 1;
                println!(
                    "{weight}, {rows} rows, {substeps:?} substeps, {hz} Hz: {droop:.4}, not {expected:.4}"
                );
                if (droop / expected - 1.0).abs() > 0.024 {
                    wrong.push((weight, rows, substeps, hz, droop, expected));
                }
            }
        }
        println!("{weight}: {measured} strips");
        assert!(measured >= 5, "{weight}");
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}
