//! Rest of particles: its detection, and how they are slowed to it.

use bevy_math::Vec3;

use crate::particles::Particles;

/// Number of particles side by side in a block.
const RUN: usize = 16;

/// Time over which positions are averaged \[s\].
const MEAN: f32 = 0.25;

/// Largest ratio of a block's motion to that of the whole at rest.
const FASTEST: f32 = 5.0;

impl Particles {
    /// Returns whether the cloth is at rest: the mean positions of blocks of 16 particles differ from their averages over the last 0.25 s
    /// by no more than `speed` [m/s] · 0.25 s (root mean square), and none by more than five times that. To be called once in each step.
    ///
    /// A crease that trembles stays where it is, however fast; a swinging cloth does not.
    pub fn is_at_rest(&mut self, speed: f32, seconds: f32) -> bool {
        let runs = self.len().div_ceil(RUN);
        let known = self.state.mean_position.len() == runs;
        self.state.mean_position.resize(runs, Vec3::ZERO);
        let part = if known {
            seconds / (MEAN + seconds)
        } else {
            1.0
        };
        let (mut sum, mut most) = (0.0, 0.0_f32);
        for (run, mean_position) in self.state.mean_position.iter_mut().enumerate() {
            let run = run * RUN..((run + 1) * RUN).min(self.input.inv_mass.len());
            let mean = |list: &[f32]| list[run.clone()].iter().sum::<f32>() / run.len() as f32;
            let position = &self.state.position;
            let place = Vec3::new(mean(&position.x), mean(&position.y), mean(&position.z));
            let away = (place - *mean_position).length_squared();
            *mean_position += part * (place - *mean_position);
            sum += away;
            most = most.max(away);
        }
        let limit = (speed * MEAN).powi(2);
        known && sum <= limit * runs as f32 && most <= FASTEST * FASTEST * limit
    }

    /// Removes all but a part of the displacement in this step, and of the velocity.
    pub fn slow_down(&mut self, kept: f32) {
        if kept == 1.0 {
            return;
        }
        let w = &self.input.inv_mass;
        let axis = |now: &mut [f32], previous: &mut [f32], start: &[f32], lost: &mut [f32]| {
            let lists = now
                .iter_mut()
                .zip(previous)
                .zip(start)
                .zip(lost)
                .zip(w.iter());
            for ((((now, previous), start), lost), w) in lists {
                if *w == 0.0 {
                    continue;
                }
                let displacement = *now - *previous;
                *now = *start + kept * (*now - *start);
                *previous = *now - kept * displacement;
                *lost = 0.0;
            }
        };
        let (p, q) = (&mut self.state.position, &mut self.state.previous_position);
        let (s, l) = (&self.state.step_position, &mut self.state.lost_displacement);
        axis(&mut p.x, &mut q.x, &s.x, &mut l.x);
        axis(&mut p.y, &mut q.y, &s.y, &mut l.y);
        axis(&mut p.z, &mut q.z, &s.z, &mut l.z);
    }

    /// Removes all velocity, also for interpolation.
    pub fn stop(&mut self) {
        self.state.step_position.copy_from(&self.state.position);
        self.state.previous_position.copy_from(&self.state.position);
        self.state.lost_displacement.fill(Vec3::ZERO);
    }
}
