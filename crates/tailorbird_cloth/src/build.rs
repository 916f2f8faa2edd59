//! Builds cloths, and rebuilds them when their shape changes.

use std::sync::Arc;

use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec2, Vec3};

use crate::{
    cloth::Cloth,
    error::{ClothStatus, ErrorSource},
    frame::ClothFrame,
    particles::ClothParticles,
    points::Points,
    topology::{ClothTopology, Topology},
};

/// Builds the topology and particles of cloths that are new or whose shape or scale changed.
///
/// A shape that is wrong is reported, and the cloth stays what it was: one that was never valid has no particles.
pub fn build_topology(
    mut cloths: Query<(
        Entity,
        Ref<Cloth>,
        &ClothFrame,
        &mut ClothTopology,
        &mut ClothParticles,
        &mut ClothStatus,
    )>,
    commands: ParallelCommands,
) {
    for (entity, cloth, frame, mut topology, mut particles, mut status) in &mut cloths {
        let outdated = topology.revision == 0 || topology.scale != frame.scale();
        let failed_before = !status.is_ok_for(ErrorSource::Shape) && !cloth.is_changed();
        if !frame.placed || !(cloth.is_changed() || outdated && !failed_before) {
            continue;
        }
        match Topology::build(&cloth.shape, frame.scale()) {
            Ok(new) => {
                *particles = keep_shape(&topology, &new, &particles)
                    .unwrap_or_else(|| ClothParticles::at_rest(&new));
                let dropped = new.dropped.clone();
                topology.0 = Arc::new(new);
                ClothStatus::update(&mut status, entity, &commands, ErrorSource::Shape, dropped);
                ClothStatus::update(&mut status, entity, &commands, ErrorSource::State, None);
            }
            Err(error) => {
                ClothStatus::update(&mut status, entity, &commands, ErrorSource::Shape, [error]);
            }
        }
    }
}

/// The particles of `new` in the shape and motion of the particles of `old`, where both are grids of one size.
fn keep_shape(
    old: &Topology,
    new: &Topology,
    particles: &ClothParticles,
) -> Option<ClothParticles> {
    let (from, to) = (old.grid?, new.grid?);
    let same = |a: Option<&Vec3>, b: Option<&Vec3>| Some(a?.abs_diff_eq(*b?, 1e-6));
    let same_size = old.scale == new.scale
        && same(old.rest_positions.first(), new.rest_positions.first())?
        && same(old.rest_positions.last(), new.rest_positions.last())?;
    if !same_size || particles.len() != old.particles() {
        return None;
    }
    let mut kept = ClothParticles::with_positions(resample(&particles.position, from, to));
    kept.previous_position = resample(&particles.previous_position, from, to);
    kept.substep_seconds = particles.substep_seconds;
    Some(kept)
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
