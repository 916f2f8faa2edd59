//! The solids of shapes, at the scales at which they are in use.

use std::{collections::BTreeMap, sync::Arc};

use bevy_math::Vec3;
use tailorbird_solver::contact::{
    solid::{Hull, Solid},
    surface::Surface,
};

use super::ClothColliderShape;

/// Hulls and meshes at the scales at which they are in use, by the fingerprints of their shapes.
#[derive(Clone, Debug, Default)]
pub(super) struct Solids(BTreeMap<(u64, [u32; 3]), Kept>);

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
                return self.kept(step, hull.fingerprint(), scale, || {
                    let hull = Hull::new(hull.points(), hull.triangles(), scale)?;
                    Some(Solid::Hull(Arc::new(hull)))
                });
            }
            ClothColliderShape::TriMesh(ref mesh) => {
                return self.kept(step, mesh.fingerprint(), scale, || {
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
        fingerprint: u64,
        scale: Vec3,
        make: impl FnOnce() -> Option<Solid>,
    ) -> Option<Solid> {
        let key = (fingerprint, scale.to_array().map(f32::to_bits));
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
    use super::{super::TriMesh, *};

    fn triangle(height: f32) -> ClothColliderShape {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Z].map(|p| p + Vec3::Y * height);
        ClothColliderShape::TriMesh(TriMesh::new(corners, [[0, 2, 1]]).expect("a triangle"))
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
