//! The contact cache of a cloth.

use bevy_math::Vec3;

use super::bodies::{Bodies, Coupling};
use crate::{contact::colliders::ColliderId, kernels::patches::Patches, memory_bytes};

/// Colliders near a cloth, and its contacts with them; scratch of a step.
#[derive(Clone, Debug, Default)]
pub struct ContactCache {
    /// Indices of the colliders that are near.
    pub near: Vec<usize>,
    /// The box within which `near` is complete, as long as the cloth stays inside it, in the world \[m\].
    pub holds: Option<(Vec3, Vec3)>,
    /// The stage that the boxes of blocks were found in: which substep, and whether its constraints are solved.
    pub stage: Option<(u32, bool)>,
    /// The boxes of the blocks of particles, now and at the start of the substep, in the cloth's frame \[m\].
    pub blocks: Vec<(Vec3, Vec3)>,
    /// The bodies as this cloth has moved them.
    pub bodies: Bodies,
    /// Particles that carry parts of bodies: those of the state, while contacts are searched.
    pub couplings: Vec<Coupling>,
    /// Contact planes of meshes: those of the state, while contacts are searched.
    pub planes: Vec<MeshPlanes>,
    /// Particles that touch something.
    pub found: Vec<usize>,
    /// Colliders that pass through the cloth: those of the state, while contacts are searched.
    pub passing: Vec<ColliderId>,
}

memory_bytes!(ContactCache: near, blocks, found, couplings);

impl ContactCache {
    /// Drops the results of the step before.
    pub fn begin_step(&mut self) {
        self.holds = None;
        self.stage = None;
        self.bodies.clear();
    }
}

/// Contact planes of the particles of a cloth with a mesh.
#[derive(Clone, Debug, Default)]
pub struct MeshPlanes {
    pub collider: Option<(ColliderId, u64)>,
    pub patches: Patches,
    /// Particles whose plane holds no longer; scratch.
    pub outdated: Vec<usize>,
}

memory_bytes!(MeshPlanes: patches.normal, patches.offset, patches.place, patches.holds, outdated);
