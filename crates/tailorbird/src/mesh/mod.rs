//! From particles to the picture: builds a mesh for each cloth and writes it once per frame.

mod binding;
mod build;
mod changes;
mod cloth_mesh;
mod collider;
mod drawn;
mod follow;
mod from_mesh;
pub mod garments;
mod interleave;
#[cfg(test)]
mod interleave_tests;
mod interleaved;
mod make;
mod packed;
mod parts;
mod pins;
mod plain;
mod previous;
pub mod rendering;
mod slab;
mod sorting;
mod tangents;
mod tangents_wanted;
mod vertices;
mod write;

pub use binding::ClothVertexBinding;
#[cfg(feature = "motion_vectors")]
pub(crate) use build::make_materials_two_sided;
pub use cloth_mesh::{ClothMesh, ClothMeshOf, ClothMeshPart};
pub use collider::ClothColliderFromMesh;
pub use from_mesh::{ClothFromMesh, ClothMeshParts, ClothMeshThreads};
pub use packed::ATTRIBUTE_PREVIOUS_POSITION;
pub use pins::{ATTRIBUTE_CLOTH_PIN, ClothColorChannel, ClothMeshPins};

use bevy_app::{App, Plugin, PostUpdate, PreUpdate};
use bevy_asset::{AssetEventSystems, Assets};
use bevy_camera::visibility::VisibilitySystems;
use bevy_ecs::prelude::*;
use bevy_light::SimulationLightSystems;
use bevy_mesh::Mesh;
use bevy_pbr::StandardMaterial;
use bevy_reflect::prelude::*;
use bevy_transform::TransformSystems;

/// Treatment of cloth meshes that are visible to no camera and no light with shadows. Visibility is that of the cloth's own mesh entities,
/// whatever other entities have the same mesh. The cloths are simulated all the same, unless
/// [`ClothSleep::unseen`](tailorbird_cloth::sleep::ClothSleep::unseen) is set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default)]
pub enum ClothUnseen {
    /// They are not written until they are seen again, and then in that frame. Meshes that are written as assets are written all the same.
    #[default]
    Skip,
    /// They are written, for those who draw what Bevy does not see: by ray tracing, say. It is for them to set
    /// [`ClothSeen`](tailorbird_cloth::sleep::ClothSeen) then, where cloths are to sleep.
    Write,
}

/// Builds a mesh for each cloth (positions, normals, UVs, tangents), and writes it once per frame, in `PostUpdate`.
///
/// Makes the `StandardMaterial` of cloths two-sided as well: a cloth has a back.
#[derive(Default)]
pub struct ClothMeshPlugin {
    /// Initial [`ClothMeshSettings`].
    pub settings: ClothMeshSettings,
}

/// Settings of the writing of meshes.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default)]
pub struct ClothMeshSettings {
    /// Draws cloth between the last two steps, where the current frame is. For a simulation in a schedule with a fixed
    /// time step; without it motion would stutter wherever steps and frames do not coincide.
    pub interpolate: bool,
    /// Destination of the vertices.
    pub write: ClothMeshWrite,
    /// Treatment of meshes that are visible to no camera and no light with shadows.
    pub unseen: ClothUnseen,
    /// True if vertices carry their position in the frame before, as [`ATTRIBUTE_PREVIOUS_POSITION`]. `ClothMotionVectorsPlugin` sets it.
    pub motion_vectors: bool,
}

impl Default for ClothMeshSettings {
    fn default() -> Self {
        Self {
            interpolate: true,
            write: ClothMeshWrite::default(),
            unseen: ClothUnseen::default(),
            motion_vectors: false,
        }
    }
}

/// Destination of the vertices of cloths in each frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default)]
pub enum ClothMeshWrite {
    /// The renderer's own buffers. The mesh asset has the cloth as it was when its mesh was built.
    ///
    /// Without a renderer, or if it keeps a mesh in another form, the asset is written.
    #[default]
    Slab,
    /// To the mesh asset, for those who read it. It costs several times as much.
    Asset,
}

/// The systems that build and write meshes, in `PostUpdate`: some before the visibility of entities is checked, some after it.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ClothMeshSystems;

impl Plugin for ClothMeshPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<ClothFromMesh>()
            .register_type::<ClothMeshSettings>()
            .insert_resource(self.settings.clone())
            .configure_sets(
                PostUpdate,
                ClothMeshSystems
                    // What holds cloth is where it is drawn.
                    .after(TransformSystems::Propagate)
                    .run_if(resource_exists::<Assets<Mesh>>),
            )
            .add_observer(slab::forget_vertices)
            .add_observer(changes::note_ready)
            .add_systems(
                PreUpdate,
                make::cloth_from_mesh.run_if(resource_exists::<Assets<Mesh>>),
            )
            .add_systems(
                PostUpdate,
                (
                    (
                        build::build_cloth_mesh,
                        previous::add_previous_positions,
                        tangents_wanted::fit_tangents
                            .run_if(resource_exists::<Assets<StandardMaterial>>),
                        write::watch_meshes,
                        write::bound_cloth_meshes,
                        build::make_materials_two_sided
                            .run_if(resource_exists::<Assets<StandardMaterial>>),
                        (write::follow_cloth, write::write_cloth_mesh)
                            .chain()
                            .run_if(write::writes_assets),
                    )
                        .chain()
                        .before(AssetEventSystems)
                        .before(VisibilitySystems::CheckVisibility)
                        .before(VisibilitySystems::CalculateBounds),
                    // What is seen is known by now.
                    (write::follow_cloth, write::write_cloth_mesh)
                        .chain()
                        .after(VisibilitySystems::MarkNewlyHiddenEntitiesInvisible)
                        .after(SimulationLightSystems::CheckLightVisibility)
                        .run_if(not(write::writes_assets)),
                    write::note_seen
                        .after(VisibilitySystems::MarkNewlyHiddenEntitiesInvisible)
                        .after(SimulationLightSystems::CheckLightVisibility),
                )
                    .chain()
                    .in_set(ClothMeshSystems),
            );
    }

    fn finish(&self, app: &mut App) {
        slab::finish(app);
    }
}
