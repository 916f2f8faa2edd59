//! Whether particles are at rest, and how they come to it.

use bevy_math::Vec3;

use crate::particles::Particles;

/// How many particles that lie side by side are looked at together.
const RUN: usize = 16;

/// Time that places are averaged over \[s\].
const MEAN: f32 = 0.25;

/// How many times as fast as the whole a run may be at rest.
const FASTEST: f32 = 5.0;

impl Particles {
    /// Whether runs of particles are as near to their mean place of the last while as if they went at `speed` [m/s], root of the mean
    /// square, and none five times as far. To be asked once in each step.
    ///
    /// A crease that trembles stays where it is, however fast; what swings does not.
    pub fn is_at_rest(&mut self, speed: f32, seconds: f32) -> bool {
        let runs = self.len().div_ceil(RUN);
        let known = self.state.calm.len() == runs;
        self.state.calm.resize(runs, Vec3::ZERO);
        let part = if known {
            seconds / (MEAN + seconds)
        } else {
            1.0
        };
        let (mut sum, mut most) = (0.0, 0.0_f32);
        for (run, calm) in self.state.calm.iter_mut().enumerate() {
            let run = run * RUN..((run + 1) * RUN).min(self.input.inv_mass.len());
            let mean = |list: &[f32]| list[run.clone()].iter().sum::<f32>() / run.len() as f32;
            let position = &self.state.position;
            let place = Vec3::new(mean(&position.x), mean(&position.y), mean(&position.z));
            let away = (place - *calm).length_squared();
            *calm += part * (place - *calm);
            sum += away;
            most = most.max(away);
        }
        let near = (speed * MEAN).powi(2);
        known && sum <= near * runs as f32 && most <= FASTEST * FASTEST * near
    }

    /// Takes all but a part of what it moved in this step away, and of its velocity.
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
                let way = *now - *previous;
                *now = *start + kept * (*now - *start);
                *previous = *now - kept * way;
                *lost = 0.0;
            }
        };
        let (p, q) = (&mut self.state.position, &mut self.state.previous_position);
        let (s, l) = (&self.state.step_position, &mut self.state.lost_displacement);
        axis(&mut p.x, &mut q.x, &s.x, &mut l.x);
        axis(&mut p.y, &mut q.y, &s.y, &mut l.y);
        axis(&mut p.z, &mut q.z, &s.z, &mut l.z);
    }

    /// Takes all velocity away, also for interpolation.
    pub fn stop(&mut self) {
        self.state.step_position.copy_from(&self.state.position);
        self.state.previous_position.copy_from(&self.state.position);
        self.state.lost_displacement.fill(Vec3::ZERO);
    }
}
