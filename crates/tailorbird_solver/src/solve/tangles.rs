//! Checks after the last substep of a step, and damping of tangles.

use fearless_simd::Level;

use super::chains::bare;
use crate::{
    effort::{EdgeSurvey, Effort, Longest},
    grant::Threads,
    kernels::{lanes::SharedPoints, rigid_motion::RigidMotion, squeeze},
    particles::{Input, Particles, State},
    points::Points,
    topology::{
        Topology,
        layout::{Layout, SheetLayout},
    },
};

/// Damps tangled particles: an edge compressed below 70 % of its rest length gets the rigid motion of the whole cloth. Conserves momentum
/// if the cloth is free.
pub fn damp(
    level: Level,
    topology: &Topology,
    allowed: f32,
    seconds: f32,
    particles: &mut Particles,
) {
    if particles.is_empty() || particles.len() != topology.particles() {
        return;
    }
    let free = !particles.input.inv_mass.contains(&0.0);
    let Particles {
        state:
            State {
                position,
                previous_position,
                effort,
                grant,
                touch,
                couplings,
                ..
            },
        input: Input { mass, inv_mass, .. },
        ..
    } = particles;
    match &topology.layout {
        Layout::Sheet(SheetLayout { lattice, .. }) => {
            let sheet = bare(lattice, position, inv_mass);
            let survey = squeeze::survey(level, sheet, lattice.spacing, allowed);
            // A cloth that carries bodies takes more substeps for them already, and would throw them.
            if couplings.is_empty() {
                let side = lattice.columns.max(lattice.rows) as f32;
                let longest = Longest {
                    times: survey.longest,
                    part: survey.longest / side,
                };
                let survey = EdgeSurvey {
                    strained: survey.strained,
                    longest,
                    granted: grant.is_much(),
                    is_mesh: false,
                };
                effort.update(survey, *touch);
            } else {
                *effort = Effort::default();
            }
            grant.renew(Threads::Sheet(*lattice), position, seconds, *effort);
            if !survey.squeezed {
                return;
            }
            let whole = RigidMotion::of_all(mass, position, previous_position);
            let previous = SharedPoints::new(previous_position);
            let sheet = bare(lattice, position, inv_mass);
            squeeze::stop(level, sheet, previous, lattice.spacing, whole);
            if free {
                give_back(whole, mass, position, previous_position);
            }
        }
        Layout::Mesh(fabric) => {
            let is_squeezed = |position: &Points, [a, b]: [u32; 2], rest_length: f32| {
                let [a, b] = [a, b].map(|i| position.get(i as usize));
                a.distance_squared(b) < squeeze::LEAST * rest_length * rest_length
            };
            let (mut squeezed, mut strained, mut count) = (false, 0, 0);
            let (mut far, mut farthest) = (0.0_f32, 0.0_f32);
            for ([a, b], rest_length) in fabric.chains().edges() {
                let [a, b] = [a, b].map(|i| position.get(i as usize));
                let (q, l2) = (a.distance_squared(b), rest_length * rest_length);
                squeezed |= q < squeeze::LEAST * l2;
                count += 1;
                if q > allowed * allowed * l2 {
                    far = far.max(q / l2);
                    farthest = farthest.max(q);
                    strained += 1;
                }
            }
            if couplings.is_empty() {
                let part = strained as f32 / count.max(1) as f32;
                let longest = Longest {
                    times: far.sqrt(),
                    part: farthest.sqrt() / fabric.size(),
                };
                let survey = EdgeSurvey {
                    strained: part,
                    longest,
                    granted: !grant.is_empty(),
                    is_mesh: true,
                };
                effort.update(survey, *touch);
            } else {
                *effort = Effort::default();
            }
            grant.renew(Threads::Mesh(fabric), position, seconds, *effort);
            if !squeezed {
                return;
            }
            let whole = RigidMotion::of_all(mass, position, previous_position);
            for (ends, rest_length) in fabric.chains().edges() {
                if is_squeezed(position, ends, rest_length) {
                    for i in ends.map(|i| i as usize) {
                        if inv_mass[i] > 0.0 {
                            let place = position.get(i);
                            previous_position.set(i, place - whole.at(place));
                        }
                    }
                }
            }
            if free {
                give_back(whole, mass, position, previous_position);
            }
        }
    }
}

/// Adds to all particles the difference between the earlier rigid motion of the whole and the present one.
fn give_back(was: RigidMotion, mass: &[f32], position: &Points, previous: &mut Points) {
    let is = RigidMotion::of_all(mass, position, previous);
    for i in 0..mass.len() {
        let place = position.get(i);
        previous.set(i, previous.get(i) - (was.at(place) - is.at(place)));
    }
}
