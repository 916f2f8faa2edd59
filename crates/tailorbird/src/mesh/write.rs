//! Writes the meshes of cloths, once per frame.

use bevy_asset::Assets;
use bevy_camera::primitives::Aabb;
use bevy_ecs::prelude::*;
use bevy_math::{Affine3A, Mat3, Vec3};
use bevy_mesh::{Mesh, VertexAttributeValues};
use bevy_time::{Fixed, Time};
use bevy_transform::components::GlobalTransform;
use tailorbird_cloth::{
    attachment::AttachedParticles, bounds::ClothBounds, drawn::ClothDrawnHolds, frame::ClothFrame,
    normals::ClothNormals, particles::ClothParticles, sleep::ClothRest, step::ClothStep,
    topology::ClothTopology,
};

use super::{ClothMesh, ClothMeshPart, ClothMeshSettings};

/// Writes positions, normals and tangents between the last two steps, and the box around them.
///
/// The particles live in the entity's rigid frame, its mesh in its own space: they differ by the scale alone. A mesh of an entity
/// below lies where that was when the cloth was made. A mesh that
/// would stay as it is, while the simulation is paused or the cloth sleeps, is left alone.
pub(super) fn write_cloth_mesh(
    mut commands: Commands,
    settings: Res<ClothMeshSettings>,
    fixed: Option<Res<Time<Fixed>>>,
    step: Option<Res<ClothStep>>,
    mut cloths: Query<(
        &mut ClothMesh,
        &ClothRest,
        &ClothParticles,
        &ClothNormals,
        &ClothTopology,
        &ClothFrame,
        &ClothBounds,
        (&AttachedParticles, &GlobalTransform, &mut ClothDrawnHolds),
    )>,
    places: Query<&GlobalTransform>,
    mut aabbs: Query<&mut Aabb>,
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
    for (mut cloth_mesh, rest, particles, normals, topology, frame, bounds, held) in &mut cloths {
        // One that sleeps stays where it fell asleep.
        let (steps, fraction) = match rest.asleep_since() {
            Some(step) => (step, 1.0),
            None => (step.steps(), fraction),
        };
        let now = (steps, fraction, frame.scale());
        let stale =
            cloth_mesh.revision != topology.revision || normals.shading() != cloth_mesh.shading;
        if stale || particles.is_empty() {
            continue;
        }
        let (attached, place, mut drawn) = held;
        if !rest.is_asleep() {
            let now = |target| places.get(target).ok().copied();
            drawn.update(topology, particles, attached, place, fraction, now);
        }
        if cloth_mesh.written == Some(now) && (drawn.is_still() || rest.is_asleep()) {
            continue;
        }
        let scale = frame.scale();
        let (a, b) = (bounds.min / scale, bounds.max / scale);
        let around = Aabb::from_min_max(a.min(b), a.max(b));
        for part in &mut cloth_mesh.parts {
            let Some(mut mesh) = meshes.get_mut(&part.handle) else {
                continue;
            };
            write_vertices(
                &mut mesh,
                part,
                (particles, &drawn),
                normals,
                fraction,
                scale,
            );
            let new = part
                .from_cloth
                .map_or(around, |from_cloth| moved(around, from_cloth));
            if let Ok(mut aabb) = aabbs.get_mut(part.entity) {
                aabb.set_if_neq(new);
            } else if let Ok(mut shown) = commands.get_entity(part.entity) {
                shown.insert(new);
            }
        }
        cloth_mesh.written = Some(now);
    }
}

/// A box around a box in another space.
fn moved(aabb: Aabb, by: Affine3A) -> Aabb {
    Aabb {
        center: by.transform_point3a(aabb.center),
        half_extents: by.matrix3.abs() * aabb.half_extents,
    }
}

fn write_vertices(
    mesh: &mut Mesh,
    part: &mut ClothMeshPart,
    (particles, drawn): (&ClothParticles, &ClothDrawnHolds),
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
    for (position, &particle) in positions.iter_mut().zip(&part.particle_of_vertex) {
        let i = particle as usize;
        let place = particles.interpolated(i, fraction) + drawn.offset(i);
        *position = (place * unscale).to_array();
    }
    let Some(mut vertex_normals) = take(mesh, Mesh::ATTRIBUTE_NORMAL) else {
        return;
    };
    for (normal, &index) in vertex_normals.iter_mut().zip(&part.normal_of_vertex) {
        let n = normals.interpolated(index as usize, fraction);
        *normal = if uniform {
            n
        } else {
            (n * scale).normalize_or(n)
        }
        .to_array();
    }
    if let Some(from_cloth) = part.from_cloth {
        for position in &mut positions {
            *position = from_cloth
                .transform_point3(Vec3::from(*position))
                .to_array();
        }
        // Normals transform by the inverse transpose.
        let to_normal = Mat3::from(from_cloth.matrix3).inverse().transpose();
        for normal in &mut vertex_normals {
            let n = Vec3::from(*normal);
            *normal = (to_normal * n).normalize_or(n).to_array();
        }
    }
    for &vertex in &part.backs {
        let normal = &mut vertex_normals[vertex as usize];
        *normal = (-Vec3::from(*normal)).to_array();
    }
    if let Some(tangents) = &mut part.tangents
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
