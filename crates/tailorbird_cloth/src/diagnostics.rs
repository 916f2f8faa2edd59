//! Figures about a cloth: stretch, energy, momentum; how long a step takes.

use std::time::Duration;

use bevy_ecs::prelude::*;
use bevy_math::{DVec3, Vec3};
use bevy_reflect::prelude::*;
use tailorbird_solver::{topology::Topology, wall_clock::WallClock};

use crate::particles::ClothParticles;

/// Duration of the last step. Written by the cloth systems alone.
#[derive(Resource, Clone, Debug, Default, Reflect)]
#[reflect(Resource, Default)]
pub struct ClothStepTime {
    /// Time of all substeps; with wind, normals, boxes and checks if nobody has systems in
    /// [`ClothSubstep`](crate::schedule::ClothSubstep).
    pub simulate: Duration,
    /// The whole step, from the first system of [`ClothSystems::Prepare`](crate::schedule::ClothSystems) to the last of
    /// `Writeback`.
    pub total: Duration,
    #[reflect(ignore)]
    pub(crate) start: Option<WallClock>,
}

/// Starts the clock of the step.
pub(crate) fn start_clock(mut time: ResMut<ClothStepTime>) {
    time.start = Some(WallClock::start());
}

/// Stops the clock of the step.
pub(crate) fn stop_clock(mut time: ResMut<ClothStepTime>) {
    time.total = time.start.map_or(Duration::ZERO, |start| start.elapsed());
}

/// Stretch of the edges of a cloth: l/L − 1 over its stretch constraints [-].
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
pub struct ClothStretch {
    /// Mean of max(0, l/L − 1).
    pub mean: f32,
    /// The value that 99 % of the edges do not exceed.
    pub p99: f32,
    /// The largest.
    pub max: f32,
}

impl ClothParticles {
    /// Stretch of the edges. Zero for a cloth without edges.
    pub fn stretch(&self, topology: &Topology) -> ClothStretch {
        let position = &self.0.state.position;
        let edges = topology.stretch_edges().into_iter();
        let known = edges.filter(|([a, b], rest)| (*a.max(b) as usize) < self.len() && *rest > 0.0);
        let stretch = known.map(|(ends, rest)| {
            let [a, b] = ends.map(|i| position.get(i as usize));
            (a.distance(b) / rest - 1.0).max(0.0)
        });
        let mut values: Vec<f32> = stretch.collect();
        if values.is_empty() {
            return ClothStretch::default();
        }
        let sum: f64 = values.iter().map(|v| f64::from(*v)).sum();
        let mean = (sum / values.len() as f64) as f32;
        let at = (values.len() * 99 / 100).min(values.len() - 1);
        let (_, p99, above) = values.select_nth_unstable_by(at, f32::total_cmp);
        let max = above.iter().copied().fold(*p99, f32::max);
        ClothStretch {
            mean,
            p99: *p99,
            max,
        }
    }

    /// Kinetic energy \[J\] of all particles that are not pinned.
    pub fn kinetic_energy(&self) -> f64 {
        let square = |i| f64::from(self.stored_velocity(i).length_squared());
        self.free()
            .map(|(i, m)| 0.5 * f64::from(m) * square(i))
            .sum()
    }

    /// Potential energy \[J\] in a uniform gravity [m/s², axes of the frame], 0 at the frame's origin.
    pub fn potential_energy(&self, gravity: Vec3) -> f64 {
        let depth = |i| f64::from(gravity.dot(self.0.state.position.get(i)));
        self.free().map(|(i, m)| -f64::from(m) * depth(i)).sum()
    }

    /// Linear momentum [kg m/s] of all particles that are not pinned, in the axes of the frame.
    pub fn momentum(&self) -> Vec3 {
        let all = self.free();
        let sum: DVec3 = all
            .map(|(i, m)| (self.stored_velocity(i) * m).as_dvec3())
            .sum();
        sum.as_vec3()
    }

    /// Angular momentum [kg m²/s] of all particles that are not pinned, about the frame's origin.
    pub fn angular_momentum(&self) -> Vec3 {
        let state = &self.0.state;
        let each = self.free().map(|(i, m)| {
            // Half way through the substep, where the velocity is that of the difference.
            let place = 0.5 * (state.position.get(i) + state.previous_position.get(i));
            let momentum = self.stored_velocity(i) * m;
            place.as_dvec3().cross(momentum.as_dvec3())
        });
        each.sum::<DVec3>().as_vec3()
    }

    /// Free particles and their masses \[kg\].
    fn free(&self) -> impl Iterator<Item = (usize, f32)> + '_ {
        let input = &self.0.input;
        let free = (0..self.len()).filter(|&i| input.inv_mass[i] > 0.0);
        free.map(|i| (i, input.mass[i]))
    }
}
