//! A guide: from a mesh, or a glTF file, to a cloth.
//!
//! ![A skirt on a figure that hurries to and fro](https://raw.githubusercontent.com/tailorbird/tailorbird/main/assets/pictures/gallery/garment.gif)
//!
//! # One mesh
//!
//! [`ClothFromMesh`] beside a `Mesh3d` is all. The material, the UVs and every other attribute are kept; vertices at one place,
//! as along the seams of UVs, become one particle.
//!
//! ```
//! # use bevy_asset::prelude::*;
//! # use bevy_ecs::prelude::*;
//! # use bevy_mesh::prelude::*;
//! # use bevy_pbr::prelude::*;
//! use tailorbird::prelude::*;
//!
//! fn hang(mut commands: Commands, assets: Res<AssetServer>, material: Res<Fabric>) {
//!     commands.spawn((
//!         Mesh3d(assets.load("curtain.glb#Mesh0/Primitive0")),
//!         MeshMaterial3d(material.0.clone()),
//!         ClothFromMesh::default().with_pins(ClothMeshPins::matching(|p| p.y > 1.9)),
//!         ClothMaterial::silk(),
//!     ));
//! }
//! # #[derive(Resource)] struct Fabric(Handle<StandardMaterial>);
//! ```
//!
//! # A scene
//!
//! On an entity without a mesh it waits for those below, and makes one cloth of all of them: a garment whose parts have materials
//! of their own is one cloth, and holds together where they meet. With names, only those nodes of the scene become cloth, the
//! others stay what they are.
//!
//! ```
//! # use bevy_asset::prelude::*;
//! # use bevy_ecs::prelude::*;
//! # use bevy_gltf::GltfAssetLabel;
//! # use bevy_world_serialization::WorldAssetRoot;
//! use tailorbird::prelude::*;
//!
//! fn dress(mut commands: Commands, assets: Res<AssetServer>) {
//!     let scene = GltfAssetLabel::Scene(0).from_asset("garments/skirt.gltf");
//!     commands.spawn((
//!         WorldAssetRoot(assets.load(scene)),
//!         ClothFromMesh::default()
//!             .with_names(["skirt"])
//!             .with_pins(ClothMeshPins::attribute()),
//!     ));
//! }
//! ```
//!
//! # Pins that are painted
//!
//! | [`ClothMeshPins`] | the pinned vertices |
//! | --- | --- |
//! | [`color`](ClothMeshPins::color) | those whose vertex colour (glTF's `COLOR_0`) is above 0.5 in a channel |
//! | [`attribute`](ClothMeshPins::attribute) | those whose `_CLOTH_PIN` is above 0.5 |
//! | [`matching`](ClothMeshPins::matching) | those whose places match |
//! | [`vertices`](ClothMeshPins::vertices) | those with these indices |
//!
//! A particle is pinned where any of its vertices is. What is painted stays readable for each particle in
//! [`ClothWeights`](tailorbird_cloth::weights::ClothWeights). Bevy reads an attribute that it does not know where it is told so, under
//! its name without the first underscore:
//!
//! ```
//! use bevy_app::prelude::*;
//! use bevy_gltf::GltfPlugin;
//! use tailorbird::prelude::*;
//!
//! # fn add(app: &mut App) {
//! // In place of the one in `DefaultPlugins`: `DefaultPlugins.set(…)`.
//! app.add_plugins(
//!     GltfPlugin::default().add_custom_vertex_attribute("CLOTH_PIN", ATTRIBUTE_CLOTH_PIN),
//! );
//! # }
//! ```
//!
//! In Blender, a float attribute of the vertices named `_CLOTH_PIN` is exported when *Data › Mesh › Attributes* is ticked in the
//! exporter.
//!
//! # What is repaired, and what is refused
//!
//! Meshes are seldom made for simulation. What can be repaired is, and is told in
//! [`Topology::report`](tailorbird_cloth::topology::Topology::report): how often, where first, and in the log once;
//! [`ClothMeshReport`](tailorbird_cloth::topology::report::ClothMeshReport) lists what becomes of each finding. What cannot (no triangle with
//! an area, indices out of range, places that are not finite or farther than 1,000 km from the origin, a mesh that is no triangle
//! list, an asset that does not load) is a [`ClothErrorKind`](tailorbird_cloth::error::ClothErrorKind) in
//! [`ClothStatus`](tailorbird_cloth::error::ClothStatus).
//!
//! ```
//! # use bevy_ecs::prelude::*;
//! use tailorbird::prelude::*;
//!
//! fn inspect(cloths: Query<(NameOrEntity, &ClothTopology, &ClothStatus), Changed<ClothTopology>>) {
//!     for (name, topology, status) in &cloths {
//!         let islands = topology.report.islands.len();
//!         if islands > 1 {
//!             println!("{name} falls apart into {islands} pieces:\n{}", topology.report);
//!         }
//!         for error in status.errors() {
//!             println!("{name}: {error}");
//!         }
//!     }
//! }
//! ```
//!
//! A mesh with double-sided faces, fronts and backs each with triangles of their own, is one layer of cloth; both are drawn, each
//! with its own UVs, and their material stays as it is. Other materials become two-sided.

#[cfg(doc)]
use super::{ClothFromMesh, ClothMeshPins};
