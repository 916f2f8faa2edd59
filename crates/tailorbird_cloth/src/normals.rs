//! Normals for shading.

use bevy_ecs::prelude::*;
use bevy_math::{Mat3, Quat, Vec3};
use bevy_reflect::prelude::*;
use fearless_simd::Level;
use tailorbird_solver::{
    kernels::{lanes::SharedPoints, normals, rigid},
    points::Points,
    topology::Topology,
    workers::Workers,
};

use crate::{
    cloth::Cloth,
    stages::{ClothStages, ClothStagesItem, for_each_cloth},
    step::ClothStep,
};

/// Normals that a cloth is shaded with.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub enum ClothShading {
    /// One for each particle: the mean of its triangles, weighted by area.
    #[default]
    Smooth,
    /// One for each triangle.
    Flat,
}

/// The normals after the last two steps, in the cloth's frame. Written by [`recompute_normals`] alone.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct ClothNormals {
    #[reflect(ignore)]
    current: Points,
    #[reflect(ignore)]
    previous: Points,
    shading: ClothShading,
    revision: u64,
}

impl ClothNormals {
    /// Shading: particles or triangles that the normals belong to.
    pub fn shading(&self) -> ClothShading {
        self.shading
    }

    /// The number of normals: that of particles or of triangles.
    pub fn len(&self) -> usize {
        self.current.len()
    }

    /// Heap memory of the normals \[byte\].
    pub fn memory_bytes(&self) -> usize {
        self.current.memory_bytes() + self.previous.memory_bytes()
    }

    /// Returns whether there are none yet.
    pub fn is_empty(&self) -> bool {
        self.current.is_empty()
    }

    /// A normal after the last step, of unit length.
    ///
    /// # Panics
    /// When `i` is out of range.
    pub fn normal(&self, i: usize) -> Vec3 {
        self.current.get(i)
    }

    /// The normals after the step before, and after the last one, in storage order.
    pub fn ends(&self) -> [&Points; 2] {
        [&self.previous, &self.current]
    }

    /// A normal between the last two steps: `fraction` 0 is the one before, 1 the last one. Of unit length.
    ///
    /// # Panics
    /// When `i` is out of range.
    #[inline]
    pub fn interpolated(&self, i: usize, fraction: f32) -> Vec3 {
        let (from, to) = (self.previous.get(i), self.current.get(i));
        (from * (1.0 - fraction) + to * fraction).normalize_or(to)
    }
}

/// Computes the normals of all cloths.
pub fn recompute_normals(step: Res<ClothStep>, mut cloths: Query<ClothStages, With<Cloth>>) {
    for_each_cloth(&step, &mut cloths, &|mut cloth| {
        if cloth.rest.is_asleep() {
            cloth.renew(step.level());
        } else {
            cloth.recompute_normals(step.level(), Workers::ALONE);
        }
    });
}

impl ClothNormals {
    /// Turns all of them.
    pub(crate) fn turn(&mut self, by: Quat) {
        let by = Mat3::from_quat(by);
        rigid::rotate(by, &mut self.current);
        rigid::rotate(by, &mut self.previous);
    }

    fn are_stale(&self, topology: &Topology, shading: ClothShading) -> bool {
        self.revision != topology.revision || self.shading != shading
    }
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
        match (shading, &topology.lattice, topology.grid) {
            // The cells of a mesh are cut in its own way.
            (ClothShading::Smooth, Some(lattice), Some(_)) => {
                let current = SharedPoints::new(current);
                workers.share(0..lattice.rows as usize, |rows| {
                    normals::smooth_lattice(level, lattice, position, current, rows);
                });
            }
            (ClothShading::Smooth, ..) => {
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
