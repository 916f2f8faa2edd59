//! Cloth at rest stays at rest: over ten minutes the kinetic energy of cloth that hangs or lies does not grow.

use bevy::prelude::*;
use tailorbird::prelude::*;

use crate::world::*;

/// Ten minutes in windows of one minute: the largest kinetic energy [J] in each.
fn ten_minutes(sim: &mut Sim, cloths: &[Entity]) -> Vec<[f64; 10]> {
    let mut peaks = vec![[0.0f64; 10]; cloths.len()];
    for minute in 0..10 {
        for _ in 0..60 {
            sim.seconds(1.0);
            for (peak, &cloth) in peaks.iter_mut().zip(cloths) {
                peak[minute] = peak[minute].max(sim.particles(cloth).kinetic_energy());
            }
        }
    }
    peaks
}

#[test]
fn cloth_at_rest_stays_at_rest_for_ten_minutes() {
    let mut sim = Sim::new();
    let place = |x: f32, y: f32| Transform::from_xyz(x, y, 0.0).with_rotation(lying());
    sim.spawn((
        ClothCollider::half_space(),
        Transform::from_xyz(0.0, -3.0, 0.0),
    ));
    sim.spawn((
        ClothCollider::sphere(0.3),
        Transform::from_xyz(5.0, 0.0, 0.0),
    ));
    let hanging = sim.spawn((square(12), ClothPins::corners(ClothCorner::TOP)));
    let lying = sim.spawn((square(12), place(-5.0, -2.9)));
    let draped = sim.spawn((
        square(12),
        ClothMaterial {
            friction: 1.0,
            ..ClothMaterial::cotton()
        },
        place(5.0, 0.35),
    ));
    // One that is in the air all the time would not be at rest, so all settle first.
    sim.seconds(20.0);
    let cloths = [hanging, lying, draped];
    let peaks = ten_minutes(&mut sim, &cloths);
    for (name, peaks) in ["hanging", "lying", "draped"].into_iter().zip(peaks) {
        println!("{name}: {peaks:?}");
        // A millionth of a joule is a speed of 4 mm/s.
        let first = peaks[0].max(1e-6);
        for (minute, peak) in peaks.into_iter().enumerate() {
            assert!(peak <= 2.0 * first, "{name}, minute {minute}: {peak:e} J");
        }
    }
}
