//! Meshes as plain numbers, whatever form the renderer has them in.
//!
//! Bevy can keep positions as 16-bit numbers within a box, directions as octahedral coordinates, texture coordinates within their range, and
//! other attributes in small formats (`Mesh::compressed_mesh`, the glTF loader's `mesh_compression`). A cloth moves out of any box, so
//! what it is drawn with is plain.

use std::borrow::Cow;

use bevy_math::{Vec2, Vec3};
use bevy_mesh::{
    Mesh, MeshVertexAttribute, VertexAttributeValues as Values, VertexFormat,
    octahedral_decode_signed, octahedral_decode_tangent,
};
use tailorbird_cloth::error::ClothErrorKind;

/// Of a mesh that cannot be used.
pub(super) fn unusable(reason: impl Into<String>) -> ClothErrorKind {
    ClothErrorKind::UnusableMesh {
        reason: reason.into(),
    }
}

/// Positions of the vertices, in the space of the mesh \[m\].
///
/// # Errors
/// An error if there are none, or none that can be read.
pub(super) fn positions(mesh: &Mesh) -> Result<Cow<'_, [[f32; 3]]>, ClothErrorKind> {
    match mesh.try_attribute_option(Mesh::ATTRIBUTE_POSITION) {
        Ok(Some(Values::Float32x3(places))) => Ok(Cow::Borrowed(places)),
        Ok(Some(Values::Snorm16x4(places))) => {
            let Some(around) = mesh.final_aabb else {
                return Err(unusable("has compressed positions, but no box for them"));
            };
            let (middle, half) = (
                Vec3::from(around.min + around.max) / 2.0,
                Vec3::from(around.max - around.min) / 2.0,
            );
            let place = |p: &[i16; 4]| middle + half * Vec3::from([p[0], p[1], p[2]].map(snorm16));
            Ok(places.iter().map(|p| place(p).to_array()).collect())
        }
        Ok(Some(values)) => Err(unusable(format!(
            "has positions of {:?}, which is neither three f32 nor compressed by Bevy",
            VertexFormat::from(values)
        ))),
        Ok(None) => Err(unusable("has no positions")),
        Err(_) => Err(unusable(
            "is kept in the render world alone: give it `RenderAssetUsages::MAIN_WORLD` as well",
        )),
    }
}

/// One number of an attribute for each vertex; nothing where the attribute has not so many, or no fractions.
pub(super) fn channel(values: &Values, channel: usize) -> Option<Vec<f32>> {
    fn of<const N: usize, T: Copy>(
        values: &[[T; N]],
        channel: usize,
        number: impl Fn(T) -> f32,
    ) -> Option<Vec<f32>> {
        (channel < N).then(|| values.iter().map(|value| number(value[channel])).collect())
    }
    match values {
        Values::Float32(values) if channel == 0 => Some(values.clone()),
        Values::Float32x2(values) => of(values, channel, |v| v),
        Values::Float32x3(values) => of(values, channel, |v| v),
        Values::Float32x4(values) => of(values, channel, |v| v),
        Values::Float16(values) if channel == 0 => {
            Some(values.iter().map(|v| f32::from(*v)).collect())
        }
        Values::Float16x2(values) => of(values, channel, f32::from),
        Values::Float16x4(values) => of(values, channel, f32::from),
        Values::Unorm8(values) if channel == 0 => {
            Some(values.iter().copied().map(unorm8).collect())
        }
        Values::Unorm8x2(values) => of(values, channel, unorm8),
        Values::Unorm8x4(values) => of(values, channel, unorm8),
        Values::Unorm16(values) if channel == 0 => {
            Some(values.iter().copied().map(unorm16).collect())
        }
        Values::Unorm16x2(values) => of(values, channel, unorm16),
        Values::Unorm16x4(values) => of(values, channel, unorm16),
        _ => None,
    }
}

/// A copy of a mesh without compression, without the attributes of skins and morph targets, and without these attributes.
///
/// # Errors
/// An error if there are no positions that can be read.
pub(super) fn plain(mesh: &Mesh, without: &[MeshVertexAttribute]) -> Result<Mesh, ClothErrorKind> {
    let mut copy = Mesh::new(mesh.primitive_topology(), mesh.asset_usage);
    copy.enable_raytracing = mesh.enable_raytracing;
    copy.insert_attribute(Mesh::ATTRIBUTE_POSITION, positions(mesh)?.into_owned());
    let skin = [Mesh::ATTRIBUTE_JOINT_INDEX, Mesh::ATTRIBUTE_JOINT_WEIGHT];
    let left_out = |attribute: &MeshVertexAttribute| {
        let mut all = skin.iter().chain(without);
        attribute.id == Mesh::ATTRIBUTE_POSITION.id || all.any(|other| other.id == attribute.id)
    };
    for (attribute, values) in mesh.try_attributes().into_iter().flatten() {
        if left_out(attribute) {
            continue;
        }
        match (attribute.id, values) {
            (id, Values::Snorm16x2(packed)) if id == Mesh::ATTRIBUTE_NORMAL.id => {
                let normals: Vec<[f32; 3]> = packed
                    .iter()
                    .map(|n| octahedral_decode_signed(Vec2::from(n.map(snorm16))).to_array())
                    .collect();
                copy.insert_attribute(Mesh::ATTRIBUTE_NORMAL, normals);
            }
            (id, Values::Snorm16x2(packed)) if id == Mesh::ATTRIBUTE_TANGENT.id => {
                let tangents: Vec<[f32; 4]> = packed
                    .iter()
                    .map(|t| {
                        let (along, sign) = octahedral_decode_tangent(Vec2::from(t.map(snorm16)));
                        along.extend(sign).to_array()
                    })
                    .collect();
                copy.insert_attribute(Mesh::ATTRIBUTE_TANGENT, tangents);
            }
            _ => match UV_SETS.iter().position(|set| set.id == attribute.id) {
                Some(set) => {
                    if let Some(uvs) = uvs(mesh, values, set) {
                        copy.insert_attribute(UV_SETS[set], uvs);
                    }
                }
                None => copy.insert_attribute(*attribute, values.clone()),
            },
        }
    }
    if let Ok(Some(indices)) = mesh.try_indices_option() {
        copy.insert_indices(indices.clone());
    }
    Ok(copy)
}

/// Texture coordinates of the vertices, if the mesh has any.
pub(super) fn texture_coordinates(mesh: &Mesh) -> Option<Vec<Vec2>> {
    let values = mesh.try_attribute_option(UV_SETS[0]).ok().flatten();
    let uvs = uvs(mesh, values?, 0)?;
    Some(uvs.into_iter().map(Vec2::from).collect())
}

/// Bevy's sets of texture coordinates.
const UV_SETS: [MeshVertexAttribute; 2] = [Mesh::ATTRIBUTE_UV_0, Mesh::ATTRIBUTE_UV_1];

/// Texture coordinates of a set, in whatever form; Bevy's compression keeps them within their range.
fn uvs(mesh: &Mesh, values: &Values, set: usize) -> Option<Vec<[f32; 2]>> {
    let range = match values {
        Values::Unorm16x2(_) => mesh.final_uv_ranges[set],
        _ => None,
    };
    let (min, size) = range.map_or((Vec2::ZERO, Vec2::ONE), |range| {
        (range.min, range.max - range.min)
    });
    let place = |(u, v)| (min + size * Vec2::new(u, v)).to_array();
    let (u, v) = (channel(values, 0)?, channel(values, 1)?);
    Some(u.into_iter().zip(v).map(place).collect())
}

fn snorm16(value: i16) -> f32 {
    (f32::from(value) / f32::from(i16::MAX)).max(-1.0)
}

fn unorm16(value: u16) -> f32 {
    f32::from(value) / f32::from(u16::MAX)
}

fn unorm8(value: u8) -> f32 {
    f32::from(value) / f32::from(u8::MAX)
}
