//! Without gravity, air and pins nothing changes the momentum and the angular momentum of a cloth: its constraints act
//! between its own particles.

use bevy::prelude::*;

use crate::world::*;

/// A spinning and tumbling sheet, 0.15 kg: momentum and angular momentum before and after a second.
fn thrown(substeps: u32) -> [(Vec3, Vec3); 2] {
    let mut sim = Sim::vacuum().without_gravity().with_passes(substeps, 2);
    let cloth = sim.spawn((square(9), undamped()));
    sim.steps(0);
    sim.edit::<tailorbird::prelude::ClothForces>(cloth, |forces| {
        forces.add_impulse_at_point(Vec3::new(0.0, 0.06, 0.02), Vec3::new(0.4, 0.0, 0.0), 0.3);
        forces.add_impulse_at_point(Vec3::new(0.0, -0.03, 0.0), Vec3::new(-0.4, 0.0, 0.0), 0.3);
    });
    // After the second step wrinkles from the throw are under way.
    sim.steps(2);
    let measure = |sim: &Sim| {
        let particles = sim.particles(cloth);
        (particles.momentum(), particles.angular_momentum())
    };
    let before = measure(&sim);
    sim.steps(60);
    [before, measure(&sim)]
}

#[test]
fn momentum_is_kept() {
    for substeps in [1, 8] {
        let [(before, _), (after, _)] = thrown(substeps);
        println!("{substeps}: {before} {after}");
        // The impulses add up to (0, 0.03, 0.02) N s.
        assert!((before - Vec3::new(0.0, 0.03, 0.02)).length() < 1e-4);
        // Each of some 60 · substeps · 18 roundings of a particle's coordinate (below 1 m) changes its velocity by
        // rounding / h; for 81 particles of m/81 they add up as a random walk.
        let h = DT / substeps as f32;
        let roundings = (60.0 * substeps as f32 * 18.0 * 2.0).sqrt();
        let allowed = 0.15 / 81.0_f32.sqrt() * rounding(0.9) / h * roundings * 3.0;
        let error = (after - before).length();
        println!("{substeps}: momentum off by {error:e} of {allowed:e}");
        assert!(error < allowed, "{substeps}: {error:e} {allowed:e}");
    }
}

#[test]
fn angular_momentum_is_kept_as_the_substep_gets_short() {
    // A correction acts along the line between where two particles are heading, not between where they were: a torque of
    // third order in the angle that is turned per substep. Less is lost with each halving of the substep.
    let lost = [4, 8, 16, 32].map(|substeps| {
        let [(_, before), (_, after)] = thrown(substeps);
        println!("{substeps}: {before} {after}");
        (after - before).length() / before.length()
    });
    println!("lost: {lost:?}");
    assert!(lost[3] < 0.02, "{lost:?}");
    assert!(lost[3] < lost[0], "{lost:?}");
}
