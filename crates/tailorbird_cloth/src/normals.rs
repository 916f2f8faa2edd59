//! Normals for shading.

mod recompute;

use bevy_ecs::prelude::*;
use bevy_math::{Mat3, Quat, Vec3};
use bevy_reflect::prelude::*;
use tailorbird_solver::{kernels::rigid, points::Points, topology::Topology};

pub use recompute::recompute_normals;

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
    #[reflect(ignore)]
    revision: u64,
}

tailorbird_solver::memory_bytes!(ClothNormals: current, previous);

impl ClothNormals {
    /// Shading: particles or triangles that the normals belong to.
    pub fn shading(&self) -> ClothShading {
        self.shading
    }

    /// The number of normals: that of particles or of triangles.
    pub fn len(&self) -> usize {
        self.current.len()
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
