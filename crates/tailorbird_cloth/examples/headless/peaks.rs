//! Largest values of a sheet from step to step.

use std::collections::VecDeque;

use bevy_math::Vec3;
use tailorbird_cloth::{prelude::*, topology::order::Given};

/// Largest values in the steps so far.
#[derive(Default)]
pub struct Peaks {
    /// Of the whole run.
    pub all: Seen,
    /// The fastest of each step of the last second [m/s].
    speeds: VecDeque<f32>,
    /// At the start [J].
    energy: f64,
    /// The most that the energy was above that [J].
    pub energy_gained: f64,
}

/// Values in a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    /// The fastest free particle, from step to step [m/s].
    pub speed: f32,
    /// The largest stretch [-].
    pub stretch: f32,
    /// Of motion from step to step, and of height [J].
    energy: f64,
    /// Steps in a second [1/s].
    hz: f32,
}

impl Peaks {
    /// Before the first step.
    pub fn at_start(seen: Seen) -> Self {
        Self {
            energy: seen.energy,
            ..Self::default()
        }
    }

    /// Values after a step. `gravity` is in the cloth's frame [m/s²].
    pub fn of_step(
        particles: &ClothParticles,
        topology: &ClothTopology,
        gravity: Vec3,
        hz: f32,
    ) -> Seen {
        let order = particles.order();
        let free = (0..particles.len()).filter(|i| !particles.is_held(*i));
        let (mut speed, mut kinetic) = (0.0_f32, 0.0);
        for i in free {
            let stored = order.stored(Given(i as u32)).index();
            let [to, from] = [particles.points(), particles.previous_points()];
            let v = to.get(stored).distance(from.get(stored)) * hz;
            speed = if v.is_finite() {
                speed.max(v)
            } else {
                f32::INFINITY
            };
            kinetic += 0.5 * f64::from(particles.mass(i)) * f64::from(v).powi(2);
        }
        Seen {
            speed,
            stretch: particles.stretch(topology).max,
            energy: kinetic + particles.potential_energy(gravity),
            hz,
        }
    }

    /// Takes the next step into account.
    pub fn add(&mut self, seen: Seen) {
        self.all.speed = self.all.speed.max(seen.speed);
        self.all.stretch = self.all.stretch.max(seen.stretch);
        self.energy_gained = self.energy_gained.max(seen.energy - self.energy);
        self.speeds.push_back(seen.speed);
        while self.speeds.len() as f32 > seen.hz {
            self.speeds.pop_front();
        }
    }

    /// The fastest free particle of the last second [m/s].
    pub fn speed_of_last_second(&self) -> f32 {
        self.speeds.iter().copied().fold(0.0, f32::max)
    }
}
