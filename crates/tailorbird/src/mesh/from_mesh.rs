//! Makes a cloth of a mesh that an entity has already.

use bevy_asset::{Assets, Handle};
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_mesh::{Mesh, Mesh3d, PrimitiveTopology, VertexAttributeValues};
use bevy_reflect::prelude::*;
use tailorbird_cloth::{
    cloth::{Cloth, ClothShape},
    error::{ClothErrorKind, ClothStatus, ErrorSource},
};

/// Makes a cloth of the entity's [`Mesh3d`], as soon as that is loaded.
///
/// The entity gets a [`Cloth`] of the mesh's triangles and a mesh of its own that keeps the UVs, colours and all other
/// attributes; the asset itself stays as it was, other entities may share it. It must be a triangle list that is kept in the
/// main world.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default)]
#[require(ClothStatus)]
pub struct ClothFromMesh {
    /// Vertices no further apart than this \[m\] become one particle.
    pub weld_distance: f32,
}

impl Default for ClothFromMesh {
    fn default() -> Self {
        Self {
            weld_distance: Cloth::WELD_DISTANCE,
        }
    }
}

/// The mesh that a cloth was made of.
#[derive(Component)]
pub(super) struct ClothMeshSource(pub(super) Handle<Mesh>);

pub(super) fn cloth_from_mesh(
    mut entities: Query<(Entity, &ClothFromMesh, &Mesh3d, &mut ClothStatus), Without<Cloth>>,
    meshes: Res<Assets<Mesh>>,
    mut commands: Commands,
    parallel_commands: ParallelCommands,
) {
    for (entity, from_mesh, mesh_3d, mut status) in &mut entities {
        let Some(mesh) = meshes.get(&mesh_3d.0) else {
            continue;
        };
        match shape_of(mesh, from_mesh.weld_distance) {
            Ok(shape) => {
                ClothStatus::update(
                    &mut status,
                    entity,
                    &parallel_commands,
                    ErrorSource::Shape,
                    None,
                );
                let source = ClothMeshSource(mesh_3d.0.clone());
                commands.entity(entity).insert((Cloth { shape }, source));
            }
            Err(reason) => {
                let error = ClothErrorKind::UnusableMesh {
                    reason: reason.into(),
                };
                ClothStatus::update(
                    &mut status,
                    entity,
                    &parallel_commands,
                    ErrorSource::Shape,
                    [error],
                );
            }
        }
    }
}

fn shape_of(mesh: &Mesh, weld_distance: f32) -> Result<ClothShape, &'static str> {
    if mesh.primitive_topology() != PrimitiveTopology::TriangleList {
        return Err("is not a triangle list");
    }
    let positions = match mesh.try_attribute_option(Mesh::ATTRIBUTE_POSITION) {
        Ok(Some(VertexAttributeValues::Float32x3(positions))) => positions,
        Ok(_) => return Err("has no positions of three f32"),
        Err(_) => return Err("is kept in the render world alone"),
    };
    let indices = mesh.indices().map_or_else(
        || (0..positions.len() as u32).collect(),
        |indices| indices.iter().map(|i| i as u32).collect(),
    );
    Ok(ClothShape::Mesh {
        positions: positions.iter().map(|p| Vec3::from(*p)).collect(),
        indices,
        weld_distance,
    })
}
