//! Normals for shading.

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;

use crate::{
    cloth::Cloth,
    particles::ClothParticles,
    points::Points,
    sleep::ClothRest,
    solver::kernels::{lanes::SharedPoints, normals},
    step::{ClothStep, for_each_cloth},
    topology::ClothTopology,
};

/// Which normals a cloth is shaded with.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default)]
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
    /// What each normal belongs to.
    pub fn shading(&self) -> ClothShading {
        self.shading
    }

    /// The number of normals: that of particles or of triangles.
    pub fn len(&self) -> usize {
        self.current.len()
    }

    /// What the normals take on the heap \[byte\].
    pub fn memory_bytes(&self) -> usize {
        self.current.memory_bytes() + self.previous.memory_bytes()
    }

    /// Whether there are none yet.
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
pub fn recompute_normals(
    step: Res<ClothStep>,
    mut cloths: Query<
        (
            &ClothRest,
            &ClothTopology,
            &ClothShading,
            &ClothParticles,
            &mut ClothNormals,
        ),
        With<Cloth>,
    >,
) {
    for_each_cloth!(step, cloths, |(
        rest,
        topology,
        shading,
        particles,
        mut normals,
    ): (
        &ClothRest,
        &ClothTopology,
        &ClothShading,
        &ClothParticles,
        Mut<ClothNormals>
    )| {
        if particles.is_empty() {
            return;
        }
        let ClothNormals {
            current,
            previous,
            shading: shading_before,
            revision,
        } = &mut *normals;
        let fresh = *revision != topology.revision || shading_before != shading;
        if rest.is_asleep() && !fresh {
            return;
        }
        if fresh {
            *revision = topology.revision;
            *shading_before = *shading;
            let len = match shading {
                ClothShading::Smooth => topology.particles(),
                ClothShading::Flat => topology.triangles().len(),
            };
            *current = std::iter::repeat_n(Vec3::Z, len).collect();
        }
        previous.copy_from(current);
        match shading {
            ClothShading::Smooth => match &topology.lattice {
                // The cells of a mesh are cut in its own way.
                Some(lattice) if topology.grid.is_some() => {
                    let rows = 0..lattice.rows as usize;
                    let current = SharedPoints::new(current);
                    let position = &particles.position;
                    normals::smooth_lattice(step.level(), lattice, position, current, rows);
                }
                _ => normals::smooth(&topology.triangles, &particles.position, current),
            },
            ClothShading::Flat => {
                normals::flat(topology.triangles().iter(), &particles.position, current);
            }
        }
        if fresh {
            previous.copy_from(current);
        }
    });
}
