//! Colliders in the shape of meshes.

use bevy_math::Vec3;
use bevy_mesh::Mesh;
use tailorbird_cloth::{collider::ClothCollider, error::ClothErrorKind};

use super::{parts::append, plain};

/// Makes a [`ClothCollider`] in the shape of a [`Mesh`], compressed or not.
///
/// ```
/// # use bevy_math::Vec3;
/// # use bevy_mesh::{Mesh, Meshable};
/// # use bevy_shape::Cuboid;
/// # use tailorbird::prelude::*;
/// let mesh = Mesh::from(Cuboid::from_length(0.5));
/// let solid = ClothCollider::trimesh_from_mesh(&mesh)?;
/// let hull = ClothCollider::convex_hull_from_mesh(&mesh)?;
/// # Ok::<(), ClothErrorKind>(())
/// ```
pub trait ClothColliderFromMesh: Sized {
    /// A collider of all triangles of the mesh.
    ///
    /// # Errors
    /// An error if the mesh is not kept in the main world, is no list of triangles, or has no positions that can be read; and the errors of
    /// [`ClothCollider::trimesh`].
    fn trimesh_from_mesh(mesh: &Mesh) -> Result<Self, ClothErrorKind>;

    /// The convex hull of the vertices of the mesh.
    ///
    /// # Errors
    /// An error if the mesh is not kept in the main world, or has no positions that can be read; and the errors of
    /// [`ClothCollider::convex_hull`].
    fn convex_hull_from_mesh(mesh: &Mesh) -> Result<Self, ClothErrorKind>;
}

impl ClothColliderFromMesh for ClothCollider {
    fn trimesh_from_mesh(mesh: &Mesh) -> Result<Self, ClothErrorKind> {
        let (mut positions, mut indices) = (Vec::new(), Vec::new());
        append(mesh, None, &mut positions, &mut indices)?;
        Self::trimesh(positions, indices.as_chunks::<3>().0)
    }

    fn convex_hull_from_mesh(mesh: &Mesh) -> Result<Self, ClothErrorKind> {
        let positions = plain::positions(mesh)?;
        let points: Vec<Vec3> = positions.iter().copied().map(Vec3::from).collect();
        Self::convex_hull(&points)
    }
}
