//! Contact planes of triangle meshes.

use super::{cache::ContactCache, solid::Solid, surface::Surface};
use crate::{
    contact::{
        cache::MeshPlanes,
        colliders::{ColliderId, MovingCollider},
    },
    kernels::{
        patches::{Patches, outdated},
        solid::Motion,
    },
    particles::Particles,
    substep::Substep,
};

static NOTHING: std::sync::LazyLock<Patches> = std::sync::LazyLock::new(Patches::default);

impl ContactCache {
    /// Contact planes with this collider.
    pub fn seen(&self, collider: &MovingCollider) -> &Patches {
        let id = collider.surface_id();
        let planes = self.planes.iter().find(|planes| planes.collider == id);
        planes.map_or(&NOTHING, |planes| &planes.patches)
    }
}

impl MeshPlanes {
    /// Returns whether the planes are those of this collider.
    pub fn is_of(&self, collider: &MovingCollider) -> bool {
        self.collider.is_some() && self.collider == collider.surface_id()
    }
}

impl MovingCollider {
    /// Identity of a mesh at its scale.
    pub fn surface_id(&self) -> Option<(ColliderId, u64)> {
        let Solid::Mesh(_) = self.solid else {
            return None;
        };
        Some((self.id, self.solid.bits()[1]))
    }

    /// Updates the contact planes of particles that left the range of theirs.
    pub fn prepare(
        &self,
        motion: &Motion,
        margin: f32,
        particles: &mut Particles,
        cache: &mut ContactCache,
        substep: &Substep,
        range: std::ops::Range<usize>,
    ) {
        let (Solid::Mesh(surface), id) = (&self.solid, self.surface_id()) else {
            return;
        };
        let len = particles.len();
        let known = cache.planes.iter().position(|planes| planes.collider == id);
        let at = known.unwrap_or_else(|| {
            cache.planes.push(MeshPlanes::default());
            cache.planes.len() - 1
        });
        let MeshPlanes {
            collider,
            patches,
            outdated: found,
        } = &mut cache.planes[at];
        if *collider != id || patches.holds.len() != len {
            *collider = id;
            patches.reset(len);
        }
        found.clear();
        outdated(
            substep.level,
            patches,
            motion,
            (&particles.state.position, &particles.input.inv_mass),
            range,
            |i| found.push(i),
        );
        for &i in &*found {
            find_plane(surface, patches, motion, particles, i, margin);
        }
    }
}

/// Finds the contact plane of a particle with a mesh.
pub fn find_plane(
    surface: &Surface,
    patches: &mut Patches,
    motion: &Motion,
    particles: &Particles,
    i: usize,
    margin: f32,
) {
    let inverse = motion.axes.transpose();
    let from = inverse * (motion.turn * (particles.state.previous_position.get(i) - motion.from));
    let to = inverse * (particles.state.position.get(i) - motion.to);
    surface.find_plane(patches, i, [from, to], margin);
}
