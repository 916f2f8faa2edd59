//! A free cloth in vacuum falls as the discrete sum of Verlet says, x₀ + g h² n(n + 1)/2 after n substeps of h, at any
//! number of substeps.

use bevy::prelude::*;
use tailorbird::prelude::*;

use crate::world::*;

const STEPS: u32 = 30;

fn fall(substeps: u32) -> (f32, f32) {
    let mut sim = Sim::vacuum().with_passes(substeps, 2);
    let cloth = sim.spawn((square(5), undamped()));
    sim.steps(1);
    let rest = sim.particles(cloth).len();
    assert_eq!(rest, 25);
    sim.steps(STEPS - 1);

    let n = f64::from(STEPS * substeps);
    let h = 1.0 / HZ / f64::from(substeps);
    let fallen = -f64::from(G) * h * h * n * (n + 1.0) / 2.0;
    let rest: Vec<Vec3> = sim.get::<Cloth>(cloth).rest_positions();
    let error = sim
        .positions(cloth)
        .into_iter()
        .zip(rest)
        .map(|(p, rest)| (f64::from(p.y - rest.y) - fallen).abs() as f32)
        .fold(0.0, f32::max);

    // Each substep rounds a coordinate of at most 2 m once. Verlet keeps what was rounded as velocity, so that at worst,
    // where each rounding goes the same way, they add up to n(n + 1)/2 of them.
    (
        error,
        rounding(1.5) * (n * (n + 1.0) / 2.0) as f32 + rounding(2.0),
    )
}

#[test]
fn falls_as_the_discrete_sum_says() {
    for substeps in [1, 2, 4, 8, 16] {
        let (error, allowed) = fall(substeps);
        println!("{substeps} substeps: {error:e} m of {allowed:e} m");
        assert!(error <= allowed, "{substeps}: {error:e} {allowed:e}");
    }
}

#[test]
fn mass_does_not_matter() {
    let after = |material: ClothMaterial| {
        let mut sim = Sim::vacuum().with_passes(8, 2);
        let cloth = sim.spawn((
            square(4),
            ClothMaterial {
                damping: 0.0,
                ..material
            },
        ));
        sim.steps(20);
        sim.center_of_mass(cloth).y
    };
    let (silk, rubber) = (after(ClothMaterial::silk()), after(ClothMaterial::rubber()));
    // Worst case of 160 roundings below 1 m, as above, for each of the two.
    assert!((silk - rubber).abs() <= 2.0 * rounding(0.9) * 160.0 * 161.0 / 2.0);
}

#[test]
fn damping_approaches_the_terminal_velocity_at_any_number_of_substeps() {
    // v' = g − c v: v(t) = g/c (1 − e^(−c t)). The discrete decay e^(−c h) per substep is exact; adding g h after it instead
    // of during it is off by c h / 2 of it.
    let c = 4.0;
    for substeps in [1, 4, 16] {
        let mut sim = Sim::vacuum().with_passes(substeps, 2);
        let cloth = sim.spawn((
            square(4),
            ClothMaterial {
                damping: c,
                ..undamped()
            },
        ));
        sim.steps(60);
        let speed = -sim.velocities(cloth)[5].y;
        let expected = G / c * (1.0 - (-c).exp());
        let allowed = c * DT / substeps as f32 / 2.0 + 0.005;
        assert!(
            (speed / expected - 1.0).abs() < allowed,
            "{substeps}: {speed} {expected}"
        );
    }
}
