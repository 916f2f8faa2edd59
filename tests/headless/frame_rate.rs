//! States depend on simulated time alone: at 30, 60 and 144 frames a second they are the same at the same steps.

use std::time::Duration;

use bevy::prelude::*;
use tailorbird::prelude::*;

use crate::world::*;

/// The bits after each step.
#[derive(Resource, Default)]
struct History(Vec<u64>);

fn note(mut history: ResMut<History>, cloth: Query<&ClothParticles>) {
    history.0.extend(cloth.iter().map(|cloth| hash([cloth])));
}

fn history(frames_per_second: f64) -> Vec<u64> {
    let mut sim = Sim::new();
    sim.app.init_resource::<History>();
    let mut wind = ClothWind::steady(Vec3::new(2.0, 0.0, 6.0));
    wind.gusts.strength = 0.5;
    sim.app.insert_resource(wind);
    sim.app.add_systems(FixedLast, note);
    sim.set_frame(Duration::from_secs_f64(1.0 / frames_per_second));
    sim.spawn(ClothCollider::sphere(0.2));
    sim.spawn((
        square(10),
        ClothPins::corners(ClothCorner::TOP),
        Transform::from_xyz(0.0, 0.0, -0.3),
    ));
    sim.frames((1.5 * frames_per_second) as u32);
    sim.app.world().resource::<History>().0.clone()
}

#[test]
fn the_frame_rate_does_not_matter() {
    let [a, b, c] = [30.0, 60.0, 144.0].map(history);
    let steps = a.len().min(b.len()).min(c.len());
    // Rounding of the frames to nanoseconds may leave out the last step.
    assert!(steps >= 89, "{} {} {}", a.len(), b.len(), c.len());
    assert_eq!(a[..steps], b[..steps]);
    assert_eq!(c[..steps], b[..steps]);
    assert_ne!(b[0], b[steps - 1]);
}
