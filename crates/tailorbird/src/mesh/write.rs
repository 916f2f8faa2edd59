//! Writes the meshes of cloths, once per frame.

use bevy_asset::Assets;
use bevy_camera::primitives::Aabb;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_mesh::{Mesh, VertexAttributeValues};
use bevy_time::{Fixed, Time};
use tailorbird_cloth::{
    bounds::ClothBounds, frame::ClothFrame, normals::ClothNormals, particles::ClothParticles,
    sleep::ClothRest, step::ClothStep, topology::ClothTopology,
};

use super::{ClothMesh, ClothMeshSettings};

/// Writes positions, normals and tangents between the last two steps, and the box around them.
///
/// The particles live in the entity's rigid frame, the mesh in its own space: they differ by the scale alone. A mesh that
/// would stay as it is, while the simulation is paused or the cloth sleeps, is left alone.
pub(super) fn write_cloth_mesh(
    mut commands: Commands,
    settings: Res<ClothMeshSettings>,
    fixed: Option<Res<Time<Fixed>>>,
    step: Option<Res<ClothStep>>,
    mut cloths: Query<(
        Entity,
        &mut ClothMesh,
        &ClothRest,
        &ClothParticles,
        &ClothNormals,
        &ClothTopology,
        &ClothFrame,
        &ClothBounds,
        Option<&mut Aabb>,
    )>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    let Some(step) = step else {
        return;
    };
    let fraction = match fixed {
        Some(fixed) if settings.interpolate && step.running() => {
            fixed.overstep_fraction().clamp(0.0, 1.0)
        }
        _ => 1.0,
    };
    for (entity, mut cloth_mesh, rest, particles, normals, topology, frame, bounds, aabb) in
        &mut cloths
    {
        // One that sleeps stays where it fell asleep.
        let (steps, fraction) = match rest.asleep_since() {
            Some(step) => (step, 1.0),
            None => (step.steps(), fraction),
        };
        let now = (steps, fraction, frame.scale());
        let stale =
            cloth_mesh.revision != topology.revision || normals.shading() != cloth_mesh.shading;
        if stale || particles.is_empty() || cloth_mesh.written == Some(now) {
            continue;
        }
        let Some(mut mesh) = meshes.get_mut(&cloth_mesh.handle) else {
            continue;
        };
        write_vertices(
            &mut mesh,
            &mut cloth_mesh,
            particles,
            normals,
            fraction,
            frame.scale(),
        );
        cloth_mesh.written = Some(now);

        let (a, b) = (bounds.min / frame.scale(), bounds.max / frame.scale());
        let new = Aabb::from_min_max(a.min(b), a.max(b));
        match aabb {
            Some(mut aabb) => {
                aabb.set_if_neq(new);
            }
            None => {
                commands.entity(entity).insert(new);
            }
        }
    }
}

fn write_vertices(
    mesh: &mut Mesh,
    cloth_mesh: &mut ClothMesh,
    particles: &ClothParticles,
    normals: &ClothNormals,
    fraction: f32,
    scale: Vec3,
) {
    let unscale = scale.recip();
    // Normals transform by the inverse of the scale, so here by the scale.
    let uniform = scale.x == scale.y && scale.y == scale.z && scale.x > 0.0;
    let Some(mut positions) = take(mesh, Mesh::ATTRIBUTE_POSITION) else {
        return;
    };
    for (position, &particle) in positions.iter_mut().zip(&cloth_mesh.particle_of_vertex) {
        *position = (particles.interpolated(particle as usize, fraction) * unscale).to_array();
    }
    let Some(mut vertex_normals) = take(mesh, Mesh::ATTRIBUTE_NORMAL) else {
        return;
    };
    for (normal, &index) in vertex_normals.iter_mut().zip(&cloth_mesh.normal_of_vertex) {
        let n = normals.interpolated(index as usize, fraction);
        *normal = if uniform {
            n
        } else {
            (n * scale).normalize_or(n)
        }
        .to_array();
    }
    if let Some(tangents) = &mut cloth_mesh.tangents
        && let Some(VertexAttributeValues::Float32x4(values)) = mesh
            .try_attribute_mut_option(Mesh::ATTRIBUTE_TANGENT)
            .ok()
            .flatten()
    {
        tangents.write(&positions, &vertex_normals, values);
    }
    mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, positions);
    mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, vertex_normals);
}

/// Takes the values of an attribute out of a mesh, to write several attributes at a time without a copy.
fn take(mesh: &mut Mesh, attribute: bevy_mesh::MeshVertexAttribute) -> Option<Vec<[f32; 3]>> {
    match mesh.try_attribute_mut_option(attribute).ok().flatten() {
        Some(VertexAttributeValues::Float32x3(values)) => Some(std::mem::take(values)),
        _ => None,
    }
}
