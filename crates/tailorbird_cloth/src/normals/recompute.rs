//! Computes the normals after each step.

use bevy_math::Vec3;
use fearless_simd::Level;
use tailorbird_solver::{
    kernels::{lanes::SharedPoints, normals},
    workers::Workers,
};

use super::{ClothNormals, ClothShading};
use crate::stages::{ClothStagesItem, StagedCloths};

/// Computes the normals of all cloths.
pub fn recompute_normals(mut cloths: StagedCloths) {
    cloths.for_each(&|mut cloth, step, _| {
        if cloth.rest.is_asleep() {
            cloth.renew(step.level());
        } else {
            cloth.recompute_normals(step.level(), Workers::ALONE);
        }
    });
}

impl ClothStagesItem<'_, '_> {
    /// Computes the normals and the box of one that sleeps where it was rebuilt, or is shaded in another way.
    pub(crate) fn renew(&mut self, level: Level) {
        if self.normals.are_stale(self.topology, *self.shading) {
            self.recompute_normals(level, Workers::ALONE);
            self.update_bounds(level);
        }
    }

    /// Runs [`recompute_normals`] for one cloth.
    pub(crate) fn recompute_normals(&mut self, level: Level, workers: Workers) {
        let (topology, shading) = (self.topology, *self.shading);
        let position = &self.particles.0.state.position;
        if position.is_empty() {
            return;
        }
        let stale = self.normals.are_stale(topology, shading);
        let ClothNormals {
            current, previous, ..
        } = &mut *self.normals;
        if stale {
            let len = match shading {
                ClothShading::Smooth => topology.particles(),
                ClothShading::Flat => topology.triangles().len(),
            };
            *current = std::iter::repeat_n(Vec3::Z, len).collect();
            previous.clone_from(current);
        }
        match shading {
            // All are written anew.
            ClothShading::Smooth => std::mem::swap(previous, current),
            // A triangle without area keeps the normal it had.
            ClothShading::Flat => previous.copy_from(current),
        }
        match (shading, topology.grid_lattice()) {
            // The cells of a mesh are cut in its own way.
            (ClothShading::Smooth, Some(lattice)) => {
                let current = SharedPoints::new(current);
                workers.share(0..lattice.rows as usize, |rows| {
                    normals::smooth_lattice(level, lattice, position, current, rows);
                });
            }
            (ClothShading::Smooth, None) => {
                normals::smooth(&topology.triangles, position, current);
            }
            (ClothShading::Flat, ..) => {
                normals::flat(topology.triangles().iter(), position, current);
            }
        }
        if stale {
            previous.copy_from(current);
            self.normals.revision = topology.revision;
            self.normals.shading = shading;
        }
    }
}
