//! A cloth that is made of meshes that are there already.

use bevy_ecs::prelude::*;
use bevy_reflect::prelude::*;
use tailorbird_cloth::{cloth::Cloth, error::ClothStatus};

use super::ClothMeshPins;

/// Makes a cloth of the entity's `Mesh3d` or, if it has none, of all meshes below it, as soon as they are loaded: of a glTF scene, say. The
/// [guide](super::garments) shows it.
///
/// The entity gets a [`Cloth`] of all triangles. Each mesh is replaced by a copy that the cloth moves, with the same UVs, colours,
/// materials and all other attributes; the assets stay as they were, others may share them. They must be triangle lists that are kept in
/// the main world, and may be compressed. The places of the entities below at that time count, not later ones.
///
/// Other means of moving the mesh are lost: the copy has neither a skin nor morph targets, and `SkinnedMesh` is taken off its entity,
/// because each vertex would be moved twice. The log says so.
///
/// Change it, remove the `Cloth`, replace the `Mesh3d` or the scene, or change an asset that it was made of, and the cloth is made again,
/// flat as the mesh is. Material, shading and pins by place stay; pins that players made, and other pins by index, go with the particles
/// that they named. Errors in the assets are told by [`ClothStatus`], findings in the triangles by
/// [`Topology::report`](tailorbird_cloth::topology::Topology::report).
#[derive(Component, Clone, Debug, Reflect)]
#[reflect(Component, Default)]
#[require(ClothStatus)]
pub struct ClothFromMesh {
    /// Vertices no further apart than this \[m\] become one particle, of different meshes as well.
    pub weld_distance: f32,
    /// Vertices that are pinned; one pin beside those of [`ClothPins`](tailorbird_cloth::pins::ClothPins). Painted weights are kept in
    /// [`ClothWeights`](tailorbird_cloth::weights::ClothWeights).
    pub pins: ClothMeshPins,
    /// Meshes below the entity that become the cloth.
    pub parts: ClothMeshParts,
    /// Directions of its warp and weft.
    pub threads: ClothMeshThreads,
    /// True if the attribute that [`Self::pins`] reads, vertex colours say, is drawn as well. Paint is data: colours that name pins
    /// would tint the cloth.
    pub draw_paint: bool,
}

impl Default for ClothFromMesh {
    /// All meshes, welded within [`Cloth::WELD_DISTANCE`], without pins.
    fn default() -> Self {
        Self {
            weld_distance: Cloth::WELD_DISTANCE,
            pins: ClothMeshPins::None,
            parts: ClothMeshParts::All,
            threads: ClothMeshThreads::Uvs,
            draw_paint: false,
        }
    }
}

impl ClothFromMesh {
    /// With these pins.
    pub fn with_pins(mut self, pins: ClothMeshPins) -> Self {
        self.pins = pins;
        self
    }

    /// Of the meshes with, or below entities with, one of these names.
    pub fn with_names<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.parts = ClothMeshParts::Named(names.into_iter().map(Into::into).collect());
        self
    }

    /// With warp and weft along these.
    pub fn with_threads(mut self, threads: ClothMeshThreads) -> Self {
        self.threads = threads;
        self
    }

    /// With vertices no further apart than this \[m\] as one particle.
    pub fn with_weld_distance(mut self, distance: f32) -> Self {
        self.weld_distance = distance;
        self
    }
}

/// Directions of the warp and weft of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default)]
pub enum ClothMeshThreads {
    /// The warp where u of the first texture coordinates is constant, the weft where v is: as in the pattern of a garment. In triangles
    /// without texture coordinates along the edges.
    #[default]
    Uvs,
    /// Along the edges that are no diagonals, for meshes whose texture coordinates say nothing about the fabric: packed charts, say.
    Edges,
}

/// The meshes below an entity that become its cloth.
#[derive(Clone, Debug, Default, PartialEq, Eq, Reflect)]
#[non_exhaustive]
pub enum ClothMeshParts {
    /// All but those below an entity with a `Cloth` or [`ClothFromMesh`] of its own.
    #[default]
    All,
    /// Of these those that have, or lie below an entity that has, one of these [`Name`]s: in a glTF scene, of nodes.
    Named(Vec<String>),
}
