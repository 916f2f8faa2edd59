//! Real-time cloth for the Bevy game engine: hangs, blows, drapes, is dragged and pinned.
//!
//! ```no_run
//! # use bevy_app::prelude::*;
//! # use bevy_asset::prelude::*;
//! # use bevy_color::Color;
//! # use bevy_ecs::prelude::*;
//! # use bevy_math::prelude::*;
//! # use bevy_pbr::prelude::*;
//! # use bevy_transform::prelude::*;
//! use tailorbird::prelude::*;
//!
//! # fn app(app: &mut App) {
//! app.add_plugins(ClothPlugins::default()).add_systems(Startup, hang_a_curtain);
//! # }
//!
//! fn hang_a_curtain(mut commands: Commands, mut materials: ResMut<Assets<StandardMaterial>>) {
//!     commands.spawn((
//!         Cloth::grid(Vec2::new(2.0, 1.5), UVec2::new(64, 48)).centered(),
//!         ClothMaterial::cotton(),
//!         ClothPins::corners(ClothCorner::TOP),
//!         MeshMaterial3d(materials.add(Color::srgb(0.8, 0.1, 0.1))),
//!         Transform::from_xyz(0.0, 1.25, 0.0),
//!     ));
//! }
//! ```
//!
//! The simulation is in [`cloth`], a crate of its own that needs no renderer. This crate adds what a game needs on top;
//! [`ClothPlugins`](plugins::ClothPlugins) lists the parts.
//!
//! # Features
//!
//! | feature | what it adds | default |
//! | --- | --- | --- |
//! | `render` | meshes of cloths, cloths of meshes (`ClothFromMesh`), fabrics' looks: all that needs assets and Bevy's renderer | yes |
//! | `picking` | pointers hit cloth (`ClothPickingPlugin`), drag and pin it (`ClothDragPlugin`); keys move balls (`ClothSphereControlsPlugin`) | yes |
//! | `gizmos` | debug drawing (`ClothDebugPlugin`) | yes |
//! | `diagnostics` | figures for Bevy's `DiagnosticsStore` (`ClothDiagnosticsPlugin`) | yes |
//! | `motion_vectors` | for temporal antialiasing and motion blur (`ClothMotionVectorsPlugin`) | yes |
//! | `fabric_textures` | small textures of all fabrics in the program, 1.4 MB | yes |
//! | `serialize` | serde for what a game saves of its cloths | no |
//!
//! A server takes none of them (`default-features = false`), or [`cloth`] alone.
//!
//! # Guide
//!
//! | page | about |
//! | --- | --- |
//! | [`mesh`] | cloth made of meshes: garments from glTF, pins that are painted, seams, what is repaired |
//! | [`cloth::pins`], [`cloth::attachment`], [`cloth::motion`] | what holds a cloth: pins, bones and other entities, targets of an animation |
//! | [`cloth::inertia`] | a cloth on something that moves: what it feels, teleports, speed limits |
//! | [`cloth::sampling`] | when what moves is seen: the fixed loop and frames, pauses, hops |
//! | [`cloth::collider`] | what a cloth collides with: shapes, layers, bodies |
//! | `tailorbird_avian`, `tailorbird_rapier` | bodies of physics engines |
//! | [`mesh::rendering`] | how cloth is drawn: every setting, and its cost |
//! | [`motion_vectors`] | temporal antialiasing and motion blur |
//! | [`fabric`], [`cloth::material`] | what cloth is made of: how it moves, how it looks |
//! | [`cloth::wind`] | air: gusts, turbulence, zones |
//! | [`cloth::solver`], [`cloth::settings`], [`cloth::sleep`] | accuracy and what it costs |
//! | [`picking`], [`drag`] | the pointer |
//! | [`cloth::error`] | what happens to wrong input |

pub use tailorbird_cloth as cloth;

#[cfg(feature = "gizmos")]
pub mod debug;
#[cfg(feature = "diagnostics")]
pub mod diagnostics;
#[cfg(feature = "picking")]
pub mod drag;
pub mod drawn;
#[cfg(feature = "render")]
pub mod fabric;
#[cfg(feature = "render")]
pub mod mesh;
#[cfg(feature = "motion_vectors")]
pub mod motion_vectors;
#[cfg(feature = "picking")]
pub mod picking;
pub mod plugins;
#[cfg(feature = "picking")]
pub mod sphere_controls;

/// Names that most games need.
pub mod prelude {
    #[cfg(feature = "gizmos")]
    pub use crate::debug::{ClothDebugPlugin, ClothGizmos};
    #[cfg(feature = "diagnostics")]
    pub use crate::diagnostics::ClothDiagnosticsPlugin;
    #[cfg(feature = "motion_vectors")]
    pub use crate::motion_vectors::ClothMotionVectorsPlugin;
    pub use crate::plugins::ClothPlugins;
    #[cfg(feature = "picking")]
    pub use crate::{
        drag::{
            ClothDrag, ClothDragPlugin, ClothDragSettings, ClothGrabbed, ClothPinned,
            ClothReleased, ClothUnpinned,
        },
        picking::{ClothPickingBackend, ClothPickingPlugin, ClothPickingSettings, ClothPointerHit},
        sphere_controls::{ClothSphereControls, ClothSphereControlsPlugin},
    };
    #[cfg(feature = "render")]
    pub use crate::{
        fabric::{ClothFabric, ClothFabricPlugin, ClothLook},
        mesh::{
            ATTRIBUTE_CLOTH_PIN, ClothColliderFromMesh, ClothColorChannel, ClothFromMesh,
            ClothMeshParts, ClothMeshPins, ClothMeshPlugin, ClothMeshSettings, ClothMeshThreads,
            ClothMeshWrite, ClothUnseen,
        },
    };
    pub use tailorbird_cloth::prelude::*;
}
