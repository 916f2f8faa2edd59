//! The solids of shapes, at the scales at which they are in use.

use std::{collections::BTreeMap, sync::Arc};

use bevy_math::Vec3;
use tailorbird_solver::contact::{
    solid::{Hull, Solid},
    surface::Surface,
};

use super::ClothColliderShape;

/// Hulls and meshes at the scales at which they are in use.
#[derive(Clone, Debug, Default)]
pub(super) struct Solids(BTreeMap<Key, Kept>);

/// Content of a solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    /// Kind of the shape: a hull and a mesh can have the same corners and triangles.
    kind: Kind,
    fingerprint: u64,
    /// Bits of the scale.
    scale: [u32; 3],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Hull,
    Mesh,
}

/// A solid that is kept from step to step.
#[derive(Clone, Debug)]
struct Kept {
    /// The step that used it last.
    used: u64,
    solid: Option<Solid>,
}

impl Solids {
    /// Forgets all shapes that were not used in this step.
    pub fn forget(&mut self, step: u64) {
        self.0.retain(|_, kept| kept.used == step);
    }

    /// A shape at this scale; `None` where nothing is left of it.
    pub fn scaled(&mut self, step: u64, shape: &ClothColliderShape, scale: Vec3) -> Option<Solid> {
        let most = scale.abs().max_element();
        let solid = match *shape {
            ClothColliderShape::Sphere { radius } => Solid::Sphere {
                radius: radius * most,
            },
            ClothColliderShape::HalfSpace => Solid::HalfSpace,
            ClothColliderShape::Capsule {
                radius,
                half_length,
            } => Solid::Capsule {
                radii: [radius * most; 2],
                half_length: half_length * most,
            },
            ClothColliderShape::TaperedCapsule {
                bottom_radius,
                top_radius,
                half_length,
            } => Solid::Capsule {
                radii: [bottom_radius * most, top_radius * most],
                half_length: half_length * most,
            },
            ClothColliderShape::Cuboid { size } => Solid::Cuboid {
                half_size: 0.5 * size * scale.abs(),
            },
            ClothColliderShape::Cylinder {
                radius,
                half_height,
            } => Solid::Cylinder {
                radius: radius * most,
                half_height: half_height * most,
            },
            ClothColliderShape::HeightField(ref field) => Solid::Terrain {
                field: field.field.clone(),
                scale,
            },
            ClothColliderShape::ConvexHull(ref hull) => {
                return self.kept(step, (Kind::Hull, hull.fingerprint()), scale, || {
                    let hull = Hull::new(hull.points(), hull.triangles(), scale)?;
                    Some(Solid::Hull(Arc::new(hull)))
                });
            }
            ClothColliderShape::TriMesh(ref mesh) => {
                return self.kept(step, (Kind::Mesh, mesh.fingerprint()), scale, || {
                    let surface = Surface::new(mesh.positions(), mesh.triangles(), scale)?;
                    Some(Solid::Mesh(Arc::new(surface)))
                });
            }
            ClothColliderShape::Compound(_) => return None,
        };
        Some(solid)
    }

    fn kept(
        &mut self,
        step: u64,
        (kind, fingerprint): (Kind, u64),
        scale: Vec3,
        make: impl FnOnce() -> Option<Solid>,
    ) -> Option<Solid> {
        let key = Key {
            kind,
            fingerprint,
            scale: scale.to_array().map(f32::to_bits),
        };
        let kept = self.0.entry(key).or_insert_with(|| Kept {
            used: step,
            solid: make(),
        });
        kept.used = step;
        kept.solid.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::{ConvexHull, TriMesh},
        *,
    };

    fn triangle(height: f32) -> ClothColliderShape {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Z].map(|p| p + Vec3::Y * height);
        ClothColliderShape::TriMesh(TriMesh::new(corners, [[0, 2, 1]]).expect("a triangle"))
    }

    /// A hull and a mesh of the same corners and triangles are not taken for each other, whichever comes first.
    #[test]
    fn a_hull_is_no_mesh() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let hull = ConvexHull::new(&corners).expect("a tetrahedron");
        let mesh = TriMesh::new(hull.points(), hull.triangles()).expect("its surface");
        let shapes = [
            ClothColliderShape::ConvexHull(hull),
            ClothColliderShape::TriMesh(mesh),
        ];
        for order in [[0, 1], [1, 0]] {
            let mut solids = Solids::default();
            for k in order {
                let solid = solids.scaled(1, &shapes[k], Vec3::ONE);
                assert_eq!(
                    matches!(solid, Some(Solid::Hull(_))),
                    k == 0,
                    "{order:?}: {solid:?}"
                );
            }
        }
    }

    /// A mesh that is gone is not taken for a new one at its address, though no step has forgotten it yet.
    #[test]
    fn a_new_mesh_is_no_old_one() {
        let mut solids = Solids::default();
        for k in 0..1000 {
            let height = k as f32;
            let solid = solids.scaled(1, &triangle(height), Vec3::ONE);
            let range = solid.and_then(|solid| solid.range()).expect("a surface");
            assert_eq!(range.0.y, height);
        }
        solids.forget(2);
        assert!(solids.0.is_empty());
    }
}
