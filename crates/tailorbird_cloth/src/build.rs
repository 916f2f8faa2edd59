//! Builds cloths, and rebuilds them when their shape changes.

use std::{
    collections::HashMap,
    sync::{Arc, Weak},
};

use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec2, Vec3};
use tailorbird_solver::{
    particles::Particles,
    points::Points,
    topology::{Topology, order::Stored},
};
use tracing::warn;

use crate::{
    attachment::ClothAttachedParticles,
    cloth::{Cloth, ClothShape},
    error::{ClothErrorKind, ClothErrorSource, ClothStatusOf, ClothStatusOfItem},
    frame::ClothFrame,
    particles::ClothParticles,
    topology::ClothTopology,
};

/// The topologies that are in use, so that cloths of equal shape and scale share one.
#[derive(Default)]
pub struct SharedTopologies(HashMap<u64, Weak<Topology>>);

impl SharedTopologies {
    /// The topology of a shape that is scaled by `scale`, built where no cloth has it yet.
    fn get(&mut self, shape: &ClothShape, scale: Vec3) -> Result<Arc<Topology>, ClothErrorKind> {
        let print = shape.fingerprint(scale);
        if let Some(topology) = self.0.get(&print).and_then(Weak::upgrade) {
            return Ok(topology);
        }
        let topology = Arc::new(Topology::build(shape, scale)?);
        self.0.insert(print, Arc::downgrade(&topology));
        Ok(topology)
    }

    /// Forgets those that are not in use any more.
    fn forget(&mut self) {
        self.0.retain(|_, topology| topology.strong_count() > 0);
    }
}

/// Builds the topology and particles of cloths that are new or whose shape or scale changed: a [`Cloth`] that is written again as it
/// was stays as it is. Cloths of equal shape and scale share their topology, and with it its revision.
///
/// A shape that is wrong is reported, and the cloth stays what it was: one that was never valid has no particles.
pub fn build_topology(
    mut cloths: Query<(
        Ref<Cloth>,
        &ClothFrame,
        &mut ClothTopology,
        &ClothAttachedParticles,
        &mut ClothParticles,
        ClothStatusOf,
    )>,
    mut shared: Local<SharedTopologies>,
    commands: ParallelCommands,
) {
    let mut built = false;
    for (cloth, frame, mut topology, attached, mut particles, mut status) in &mut cloths {
        let outdated = topology.revision == 0 || topology.scale != frame.scale();
        let failed_before = !status.list.is_ok_for(ClothErrorSource::Shape) && !cloth.is_changed();
        if !frame.placed || !(cloth.is_changed() || outdated && !failed_before) {
            continue;
        }
        match shared.get(&cloth.shape, frame.scale()) {
            Ok(new) if new.revision == topology.revision => {
                tell_dropped(&mut status, &commands, &new);
            }
            Ok(new) => {
                built = true;
                // One that was written as it was is no other one.
                let another = cloth.is_changed()
                    && cloth.shape.fingerprint(topology.scale) != topology.revision;
                if another || !particles.grow(&topology, &new, attached) {
                    *particles = keep_shape(&topology, &new, &particles)
                        .unwrap_or_else(|| ClothParticles::at_rest(&new));
                }
                if !new.report.is_clean() {
                    warn!("{}: {}", status.entity, new.report);
                }
                tell_dropped(&mut status, &commands, &new);
                topology.0 = new;
            }
            Err(error) => {
                status.update(&commands, ClothErrorSource::Shape, [error]);
            }
        }
    }
    if built {
        shared.forget();
    }
}

/// Tells of a valid shape which parts of it are left out. What was wrong with the state of another one is over.
fn tell_dropped(status: &mut ClothStatusOfItem, commands: &ParallelCommands, topology: &Topology) {
    let dropped = topology.dropped.iter().cloned();
    let dropped: Vec<_> = dropped.map(ClothErrorKind::from).collect();
    status.update(commands, ClothErrorSource::Shape, dropped);
    status.update(commands, ClothErrorSource::State, None);
}

impl ClothParticles {
    /// Scales the cloth to its new topology, of which the scale alone changed, keeping shape and motion. Returns whether it did: not for a
    /// cloth without particles.
    ///
    /// A cloth that is held in its frame grows about the frame's origin, an attached one about the middle of the held particles, a free one
    /// about its own: these may be anywhere.
    fn grow(&mut self, old: &Topology, new: &Topology, attached: &ClothAttachedParticles) -> bool {
        let count = self.len();
        let ratio = new.scale / old.scale;
        if count == 0 || count != new.particles() || !ratio.is_finite() {
            return false;
        }
        let about = if !self.0.input.held.any_in_frame() {
            let at = |i: Stored| self.0.state.position.get(i.index());
            let held = || attached.particles().filter(|i| i.index() < count);
            if held().next().is_some() {
                held().map(at).sum::<Vec3>() / held().count() as f32
            } else {
                (0..count as u32).map(Stored).map(at).sum::<Vec3>() / count as f32
            }
        } else {
            Vec3::ZERO
        };
        // Threads of a mesh may be found in another order at another scale.
        let moved = |i: u32| {
            let given = new.order.given(Stored(i));
            (new.order.stored(given), self.order.stored(given))
        };
        let same = (0..count as u32).all(|i| moved(i).0 == moved(i).1);
        let grown = |points: &Points| -> Points {
            let from = (0..count as u32).map(|i| moved(i).1.index());
            from.map(|i| about + ratio * (points.get(i) - about))
                .collect()
        };
        let [position, previous, step] = [
            &self.0.state.position,
            &self.0.state.previous_position,
            &self.0.state.step_position,
        ]
        .map(grown);
        if !same {
            let seconds = self.0.state.substep_seconds;
            *self = Self::at_rest(new);
            self.0.state.substep_seconds = seconds;
        }
        (self.0.state.position, self.0.state.previous_position) = (position, previous);
        self.0.state.step_position = step;
        self.0.state.lost_displacement.fill(Vec3::ZERO);
        self.0.state.grown_about = about;
        self.0.input.held.scale(ratio);
        self.0.state.mean_position.clear();
        self.0.state.grant.rescale();
        true
    }
}

/// The particles of `new` in the shape and motion of the particles of `old`, where both are grids of one size.
fn keep_shape(
    old: &Topology,
    new: &Topology,
    particles: &ClothParticles,
) -> Option<ClothParticles> {
    let (from, to) = (old.grid()?, new.grid()?);
    let same = |a: Option<&Vec3>, b: Option<&Vec3>| Some(a?.abs_diff_eq(*b?, 1e-6));
    let same_size = old.scale == new.scale
        && same(old.rest_positions.first(), new.rest_positions.first())?
        && same(old.rest_positions.last(), new.rest_positions.last())?;
    if !same_size || particles.len() != old.particles() {
        return None;
    }
    let before = &particles.0.state;
    let mut kept = Particles::with_positions(resample(&before.position, from, to));
    kept.state.previous_position = resample(&before.previous_position, from, to);
    kept.state.substep_seconds = before.substep_seconds;
    Some(ClothParticles(kept))
}

/// A grid of points with another resolution, bilinearly.
fn resample(points: &Points, from: UVec2, to: UVec2) -> Points {
    let at = |x: u32, y: u32| points.get((y * from.x + x) as usize);
    (0..to.y)
        .flat_map(|row| (0..to.x).map(move |column| UVec2::new(column, row)))
        .map(|target| {
            let place: Vec2 = target.as_vec2() / (to - 1).as_vec2() * (from - 1).as_vec2();
            let cell = place.as_uvec2().min(from - 2);
            let part = place - cell.as_vec2();
            let top = at(cell.x, cell.y).lerp(at(cell.x + 1, cell.y), part.x);
            let bottom = at(cell.x, cell.y + 1).lerp(at(cell.x + 1, cell.y + 1), part.x);
            top.lerp(bottom, part.y)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_shapes_share_a_topology_while_it_is_in_use() {
        let mut shared = SharedTopologies::default();
        let grid =
            |columns, width| Cloth::grid(Vec2::new(width, 1.0), UVec2::new(columns, 4)).shape;
        let mesh = |z| {
            let corners = [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, z)];
            Cloth::mesh(corners, [0, 1, 2]).shape
        };
        let shapes = [
            grid(4, 1.0),
            grid(5, 1.0),
            grid(4, 2.0),
            mesh(0.0),
            mesh(1.0),
        ];
        let scales = [Vec3::ONE, Vec3::new(1.0, 2.0, 1.0)];
        let mut all = Vec::new();
        for (shape, scale) in shapes
            .iter()
            .flat_map(|shape| scales.map(|scale| (shape, scale)))
        {
            let first = shared.get(shape, scale).expect("valid");
            let second = shared.get(&shape.clone(), scale).expect("valid");
            assert!(Arc::ptr_eq(&first, &second));
            let other = |other: &Arc<Topology>| other.revision != first.revision;
            assert!(all.iter().all(other));
            all.push(first);
        }
        let revision = all[0].revision;
        all.truncate(1);
        shared.forget();
        assert_eq!(shared.0.len(), 1);
        drop(all);
        let again = shared.get(&shapes[0], scales[0]).expect("valid");
        assert_eq!(again.revision, revision);
    }

    #[test]
    fn resampling_keeps_a_plane_and_its_corners() {
        let plane = |size: UVec2| -> Points {
            (0..size.y)
                .flat_map(|y| (0..size.x).map(move |x| (x, y)))
                .map(|(x, y)| {
                    let uv = Vec2::new(x as f32, y as f32) / (size - 1).as_vec2();
                    Vec3::new(uv.x, uv.y, 3.0 * uv.x - uv.y)
                })
                .collect()
        };
        let (from, to) = (UVec2::new(4, 7), UVec2::new(9, 3));
        let resampled = resample(&plane(from), from, to);
        for (a, b) in resampled.iter().zip(plane(to).iter()) {
            assert!(a.distance(b) < 1e-6);
        }
    }
}
