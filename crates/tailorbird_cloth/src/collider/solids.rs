//! The solids of shapes, at the scales at which they are in use.

use std::{collections::BTreeMap, sync::Arc};

use bevy_math::Vec3;
use tailorbird_solver::contact::{
    solid::{Hull, Solid},
    surface::Surface,
};

use super::ColliderShape;

/// Hulls and meshes at the scales at which they are in use.
#[derive(Clone, Debug, Default)]
pub(super) struct Solids(BTreeMap<(usize, [u32; 3]), (u64, Option<Solid>)>);

impl Solids {
    /// What was not used in this step is forgotten.
    pub fn forget(&mut self, step: u64) {
        self.0.retain(|_, (used, _)| *used == step);
    }

    /// A shape at this scale; `None` where nothing is left of it.
    pub fn scaled(&mut self, step: u64, shape: &ColliderShape, scale: Vec3) -> Option<Solid> {
        let most = scale.abs().max_element();
        let solid = match *shape {
            ColliderShape::Sphere { radius } => Solid::Sphere {
                radius: radius * most,
            },
            ColliderShape::HalfSpace => Solid::HalfSpace,
            ColliderShape::Capsule {
                radius,
                half_length,
            } => Solid::Capsule {
                radii: [radius * most; 2],
                half_length: half_length * most,
            },
            ColliderShape::TaperedCapsule {
                bottom_radius,
                top_radius,
                half_length,
            } => Solid::Capsule {
                radii: [bottom_radius * most, top_radius * most],
                half_length: half_length * most,
            },
            ColliderShape::Cuboid { half_size } => Solid::Cuboid {
                half_size: half_size * scale.abs(),
            },
            ColliderShape::Cylinder {
                radius,
                half_height,
            } => Solid::Cylinder {
                radius: radius * most,
                half_height: half_height * most,
            },
            ColliderShape::HeightField(ref field) => Solid::Terrain {
                field: field.data(),
                scale,
            },
            ColliderShape::ConvexHull(ref hull) => {
                return self.kept(step, hull.id(), scale, || {
                    let hull = Hull::new(hull.points(), hull.triangles(), scale)?;
                    Some(Solid::Hull(Arc::new(hull)))
                });
            }
            ColliderShape::TriMesh(ref mesh) => {
                return self.kept(step, mesh.id(), scale, || {
                    let surface = Surface::new(mesh.positions(), mesh.triangles(), scale)?;
                    Some(Solid::Mesh(Arc::new(surface)))
                });
            }
            ColliderShape::Compound(_) => return None,
        };
        Some(solid)
    }

    fn kept(
        &mut self,
        step: u64,
        id: usize,
        scale: Vec3,
        make: impl FnOnce() -> Option<Solid>,
    ) -> Option<Solid> {
        let key = (id, scale.to_array().map(f32::to_bits));
        let (used, solid) = self.0.entry(key).or_insert_with(|| (step, make()));
        *used = step;
        solid.clone()
    }
}
