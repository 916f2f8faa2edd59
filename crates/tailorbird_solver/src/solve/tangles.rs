//! Checks after the last substep of a step, and damping of tangles.

use fearless_simd::Level;

use super::chains::bare;
use crate::{
    effort::{EdgeSurvey, Effort, Longest},
    kernels::{lanes::SharedPoints, rigid_motion::RigidMotion, squeeze},
    particles::Particles,
    points::Points,
    topology::{
        Topology,
        fabric::Fabric,
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
    let Particles { state, input, .. } = particles;
    let (mass, inv_mass) = (&input.mass, &mut input.inv_mass);
    let (position, previous) = (&mut state.position, &mut state.previous_position);
    let (survey, squeezed) = match &topology.layout {
        Layout::Sheet(SheetLayout { lattice, .. }) => {
            let sheet = bare(lattice, position, inv_mass);
            let survey = squeeze::survey(level, sheet, lattice.spacing, allowed);
            let side = lattice.columns.max(lattice.rows) as f32;
            let of_edges = EdgeSurvey {
                strained: survey.strained,
                longest: Longest {
                    times: survey.longest,
                    part: survey.longest / side,
                },
                granted: state.grant.is_much(),
                is_mesh: false,
            };
            (of_edges, survey.squeezed)
        }
        Layout::Mesh(fabric) => survey_mesh(fabric, position, allowed, !state.grant.is_empty()),
    };
    // A cloth that carries bodies takes more substeps for them already, and would throw them.
    if state.couplings.is_empty() {
        state.effort.update(survey, state.touch);
    } else {
        state.effort = Effort::default();
    }
    (state.grant).renew(&topology.layout, position, seconds, state.effort);
    if !squeezed {
        return;
    }
    let whole = RigidMotion::of_all(mass, position, previous);
    match &topology.layout {
        Layout::Sheet(SheetLayout { lattice, .. }) => {
            let sheet = bare(lattice, position, inv_mass);
            let previous = SharedPoints::new(previous);
            squeeze::stop(level, sheet, previous, lattice.spacing, whole);
        }
        Layout::Mesh(fabric) => {
            for (ends, rest_length) in fabric.chains.edges() {
                let ends = ends.map(|i| i as usize);
                let [a, b] = ends.map(|i| position.get(i));
                if a.distance_squared(b) >= squeeze::LEAST * rest_length * rest_length {
                    continue;
                }
                for i in ends.into_iter().filter(|i| inv_mass[*i] > 0.0) {
                    let place = position.get(i);
                    previous.set(i, place - whole.at(place));
                }
            }
        }
    }
    if free {
        give_back(whole, mass, position, previous);
    }
}

/// Strain of the edges of a mesh, and whether one is squeezed.
fn survey_mesh(
    fabric: &Fabric,
    position: &Points,
    allowed: f32,
    granted: bool,
) -> (EdgeSurvey, bool) {
    let (mut squeezed, mut strained, mut count) = (false, 0, 0);
    let (mut far, mut farthest) = (0.0_f32, 0.0_f32);
    for (ends, rest_length) in fabric.chains.edges() {
        let [a, b] = ends.map(|i| position.get(i as usize));
        let (q, l2) = (a.distance_squared(b), rest_length * rest_length);
        squeezed |= q < squeeze::LEAST * l2;
        count += 1;
        if q > allowed * allowed * l2 {
            far = far.max(q / l2);
            farthest = farthest.max(q);
            strained += 1;
        }
    }
    let survey = EdgeSurvey {
        strained: strained as f32 / count.max(1) as f32,
        longest: Longest {
            times: far.sqrt(),
            part: farthest.sqrt() / fabric.size,
        },
        granted,
        is_mesh: true,
    };
    (survey, squeezed)
}

/// Adds to all particles the difference between the earlier rigid motion of the whole and the present one.
fn give_back(was: RigidMotion, mass: &[f32], position: &Points, previous: &mut Points) {
    let is = RigidMotion::of_all(mass, position, previous);
    for i in 0..mass.len() {
        let place = position.get(i);
        previous.set(i, previous.get(i) - (was.at(place) - is.at(place)));
    }
}
