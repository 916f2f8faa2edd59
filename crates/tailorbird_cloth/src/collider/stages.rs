//! The stages that keep particles out of colliders.

use tailorbird_solver::{contact::solid::SolidKind, step::APPROACH};

use crate::stages::StagedCloths;

/// Looks for contacts before the constraints are solved: pushes particles out, and notes where they touch.
///
/// For [`ClothSolver::Chains`](crate::solver::ClothSolver::Chains) alone, which then moves those particles along the surface, and bodies with them that cloth
/// pushes.
pub fn find_contacts(mut cloths: StagedCloths) {
    cloths.run(APPROACH);
}

/// Keeps particles out of the spheres.
pub fn collide_sphere(mut cloths: StagedCloths) {
    cloths.collide(SolidKind::Sphere);
}

/// Keeps particles out of the half-spaces.
pub fn collide_half_space(mut cloths: StagedCloths) {
    cloths.collide(SolidKind::HalfSpace);
}

/// Keeps particles out of the capsules, straight and tapered.
pub fn collide_capsule(mut cloths: StagedCloths) {
    cloths.collide(SolidKind::Capsule);
}

/// Keeps particles out of the boxes.
pub fn collide_cuboid(mut cloths: StagedCloths) {
    cloths.collide(SolidKind::Cuboid);
}

/// Keeps particles out of cylinders, convex hulls, triangle meshes and terrain.
pub fn collide_shape(mut cloths: StagedCloths) {
    cloths.collide(SolidKind::Other);
}
