//! What a cloth knows of the colliders around it.

use bevy_math::Vec3;

use super::bodies::{Bodies, Coupling};
use crate::{
    contact::colliders::ColliderId, kernels::patches::Patches, memory::heap, points::Points,
};

/// What a cloth knows of the colliders around it; scratch of a step.
#[derive(Clone, Debug, Default)]
pub struct ContactCache {
    /// Those that are near, as places in the list of colliders.
    pub near: Vec<usize>,
    /// The box within which `near` is complete, as long as the cloth stays inside it, in the world \[m\].
    pub holds: Option<(Vec3, Vec3)>,
    /// The stage that the boxes of blocks were found in: which substep, and whether its constraints are solved.
    pub stage: Option<(u32, bool)>,
    /// The boxes of the blocks of particles, now and at the start of the substep, in the cloth's frame \[m\].
    pub blocks: Vec<(Vec3, Vec3)>,
    /// The bodies as this cloth has moved them.
    pub bodies: Bodies,
    /// The particles that carry parts of bodies: those of the state, while colliders are looked at.
    pub couplings: Vec<Coupling>,
    /// What particles see of meshes: those of the state, while colliders are looked at.
    pub planes: Vec<MeshPlanes>,
    /// Particles that touch something.
    pub found: Vec<usize>,
    /// Colliders that go through the cloth: those of the state, while colliders are looked at.
    pub passing: Vec<ColliderId>,
}

impl ContactCache {
    /// Forgets what held in the step before.
    pub fn begin_step(&mut self) {
        self.holds = None;
        self.stage = None;
        self.bodies.clear();
    }

    /// What it takes on the heap \[byte\].
    pub fn memory_bytes(&self) -> usize {
        heap(&self.near) + heap(&self.blocks) + heap(&self.found) + heap(&self.couplings)
    }
}

/// What the particles of a cloth see of a mesh.
#[derive(Clone, Debug, Default)]
pub struct MeshPlanes {
    pub collider: Option<(ColliderId, u64)>,
    pub patches: Patches,
    /// Particles whose plane holds no longer; scratch.
    pub outdated: Vec<usize>,
}

impl MeshPlanes {
    /// What it takes on the heap \[byte\].
    pub fn memory_bytes(&self) -> usize {
        let Patches {
            normal,
            offset,
            place,
            holds,
        } = &self.patches;
        let points = [normal, place].map(Points::memory_bytes);
        points.iter().sum::<usize>()
            + offset.memory_bytes()
            + holds.memory_bytes()
            + heap(&self.outdated)
    }
}
