//! Motion limits: bounds of the distance of particles from their targets.

use crate::{
    held::HolderKind,
    kernels::{
        lanes::{Shared, SharedPoints},
        limit::{self, Backstop, Limits},
    },
    numbers::Numbers,
    particles::{Input, Particles, State},
    points::Points,
    substep::Substep,
};

/// Bounds of the distance of particles from their targets during a step, in storage order.
#[derive(Clone, Debug, Default)]
pub struct MotionLimits {
    /// Largest distance from the target \[m\]; empty where nothing is constrained.
    pub max_distance: Numbers,
    /// Distance from the target to the backstop \[m\]; empty without backstops.
    pub backstop_distance: Numbers,
    /// Radius of the backstop \[m\].
    pub backstop_radius: Numbers,
    /// Targets at the start and at the end of the step, in the cloth's frame \[m\].
    pub targets: [Points; 2],
    /// Unit normals at the targets.
    pub normals: [Points; 2],
}

impl MotionLimits {
    /// Heap memory in use \[byte\].
    pub fn memory_bytes(&self) -> usize {
        let points = self.targets.iter().chain(&self.normals);
        let numbers = [
            &self.max_distance,
            &self.backstop_distance,
            &self.backstop_radius,
        ];
        points.map(Points::memory_bytes).sum::<usize>()
            + numbers.map(Numbers::memory_bytes).iter().sum::<usize>()
    }

    /// Moves particles that are held at their targets on by one substep.
    pub fn advance(&self, substep: &Substep, particles: &mut Particles) {
        let Particles {
            state: State { position, .. },
            input: Input { held, .. },
            ..
        } = particles;
        let left = substep.left() as f32;
        for limited in held.of(HolderKind::Limit) {
            let i = limited.particle.index();
            if i < self.targets[1].len() {
                let (from, to) = (position.get(i), self.targets[1].get(i));
                let next = if left > 1.0 {
                    from + (to - from) / left
                } else {
                    to
                };
                position.set(i, next);
            }
        }
    }

    /// Keeps the free particles within their limits.
    pub fn hold(&self, substep: &Substep, particles: &mut Particles) {
        let Particles {
            state:
                State {
                    position,
                    previous_position,
                    ..
                },
            input: Input { inv_mass, .. },
            ..
        } = particles;
        let len = position.len();
        if self.max_distance.len() != len {
            return;
        }
        let [start, end] = &self.targets;
        let [normals_from, normals_to] = &self.normals;
        let (from, to) = substep.fractions();
        let limits = Limits {
            targets: [start, end],
            fractions: (from, if substep.left() == 1 { 1.0 } else { to }),
            max_distance: &self.max_distance,
            backstop: (!self.backstop_distance.is_empty()).then_some(Backstop {
                normals: [normals_from, normals_to],
                distance: &self.backstop_distance,
                radius: &self.backstop_radius,
            }),
        };
        let position = SharedPoints::new(position);
        let previous = SharedPoints::new(previous_position);
        let inv_mass = Shared::new(inv_mass);
        substep.workers.share(0..len, |range| {
            limit::hold(substep.level, limits, position, previous, inv_mass, range);
        });
    }
}
