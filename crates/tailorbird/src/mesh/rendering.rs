//! A guide: how cloth is drawn, with every setting and what it costs.
//!
//! ![A flag of silk in the wind](https://raw.githubusercontent.com/tailorbird/tailorbird/main/assets/pictures/gallery/flag.png)
//!
//! A cloth needs a material to be seen; all else is done: a mesh with positions, normals, UVs and tangents is built, put on its entity as
//! `Mesh3d`, and follows the particles in each frame.
//!
//! ```
//! # use bevy_color::Color;
//! # use bevy_ecs::prelude::*;
//! # use bevy_asset::prelude::*;
//! # use bevy_math::prelude::*;
//! # use bevy_pbr::prelude::*;
//! use tailorbird::prelude::*;
//!
//! fn hang(mut commands: Commands, mut materials: ResMut<Assets<StandardMaterial>>) {
//!     commands.spawn((
//!         Cloth::grid(Vec2::new(2.0, 1.5), UVec2::new(64, 48)),
//!         ClothShading::Flat,
//!         MeshMaterial3d(materials.add(Color::srgb(0.8, 0.1, 0.1))),
//!     ));
//! }
//! ```
//!
//! # Settings
//!
//! | setting | what it does | what it costs |
//! | --- | --- | --- |
//! | [`ClothMeshSettings::interpolate`](super::ClothMeshSettings::interpolate) | draws between the last two steps: no stutter, whatever the display's rate | nothing to speak of; what is drawn is up to a step old |
//! | [`ClothMeshWrite::Slab`](super::ClothMeshWrite::Slab) | vertices go straight to where the renderer keeps them; the asset stays as it was built | a copy of the vertices |
//! | [`ClothMeshWrite::Asset`](super::ClothMeshWrite::Asset) | vertices go to the `Mesh` asset, for those who read it | 1.7 to 4.6 times as much time, by the machine |
//! | [`ClothUnseen::Skip`](super::ClothUnseen::Skip) | what no camera and no light with shadows sees is not written | nothing |
//! | [`ClothUnseen::Write`](super::ClothUnseen::Write) | it is | as if it were seen |
//! | [`ClothSleep::unseen`](tailorbird_cloth::sleep::ClothSleep::unseen) | what no camera and no light with shadows sees is not simulated either | nothing; it saves both |
//! | [`ClothShading`](tailorbird_cloth::normals::ClothShading) | smooth, or flat: each triangle its own light | flat has three vertices for each triangle, six for each particle |
//! | [`ClothLook`](crate::fabric::ClothLook), [`ClothFabric`](crate::fabric::ClothFabric) | textures of a fabric, dyed | one material for all cloths that look alike; up to 17 MB of graphics memory for a fabric: three textures of 1024² and their smaller copies |
//! | [`ClothMotionVectorsPlugin`](crate::motion_vectors::ClothMotionVectorsPlugin) | motion vectors of the vertices | 12 bytes for each vertex, and a batch of their own |
//! | `Msaa` of the camera | smooth edges; lace has holes with smooth edges only with it | Bevy's |
//! | `NotShadowCaster` on the cloth | no shadow | saves drawing it once for each light |
//!
//! `cargo run --example frame_bench` measures frames with the mesh not written, written as an asset and written past it, and says which
//! part of a frame each stage takes. On two cores a sheet of 128² is simulated in 1.8 ms, and drawing it adds 0.3 to 0.6 ms, a seventh to a quarter
//! of what it costs; an empty frame of Bevy takes 2.5 ms, and the software driver's part.
//!
//! # Light
//!
//! - **Backs**: `StandardMaterial`s of cloths are made two-sided, so that normals of backs point to the viewer. A material that
//!   lets light through (`diffuse_transmission`, as those of [`ClothFabric`](crate::fabric::ClothFabric) have) shows the light behind a thin curtain; the
//!   cloth needs Bevy's `TransmittedShadowReceiver` where that light has shadows.
//! - **Normals** are those of the triangles around a particle, weighted by area; vertices on both sides of a seam of UVs share them.
//! - **Tangents** follow the threads along u. They turn no faster than those, so that normal maps do not swim.
//! - **Boxes** are around the particles as they are: a cloth that flies away from its entity is drawn, casts shadows, and is sorted by
//!   where it is among transparent things.
//! - **Thickness**: contacts keep a distance of [`ClothMaterial::thickness`](tailorbird_cloth::material::ClothMaterial::thickness) and the
//!   collider's margin. Where a cloth of wide cells lies on something round, its triangles cut corners: more particles or a
//!   margin of r − √(r² − d²/4), with r the radius and d the cell's diagonal, hide it.
//!
//! # Your own materials
//!
//! Any `Material` works on a cloth: the mesh is one like others. Set `cull_mode` to none, and turn normals on backs. The texture's v
//! grows downwards, as glTF has it.
//!
//! # Where vertices cannot be written past the asset
//!
//! Without a renderer, and where the renderer has the mesh in another form (compressed attributes, say), the asset is written, and a
//! warning says so once. After the graphics device was lost and Bevy has another one, the vertices are written again.
