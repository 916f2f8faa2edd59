//! The stages that keep particles out of colliders.

use bevy_ecs::prelude::*;
use tailorbird_solver::{contact::solid::SolidKind, kernels::contact::Phase, step::APPROACH};

use super::ClothColliders;
use crate::{
    cloth::Cloth,
    stages::{ClothStages, for_each_awake, run_stage},
    step::ClothStep,
};

/// Looks for contacts before the constraints are solved: pushes particles out, and notes where they touch.
///
/// For [`ClothSolver::Chains`](crate::solver::ClothSolver::Chains) alone, which then moves those particles along the surface, and bodies with them that cloth
/// pushes.
pub fn find_contacts(
    (step, colliders): (Res<ClothStep>, Res<ClothColliders>),
    mut cloths: Query<ClothStages, With<Cloth>>,
) {
    run_stage(APPROACH, &step, &colliders, &mut cloths);
}

macro_rules! collide_systems {
    ($($(#[$doc:meta])* $name:ident: $kind:ident,)*) => {
        $(
            $(#[$doc])*
            pub fn $name(
                step: Res<ClothStep>,
                colliders: Res<ClothColliders>,
                mut cloths: Query<ClothStages, With<Cloth>>,
            ) {
                let substep = step.in_progress();
                for_each_awake(&step, &mut cloths, &|mut cloth| {
                    cloth.with_cloth(|cloth| {
                        (colliders.list).collide(Phase::Final, Some(&[SolidKind::$kind]), &substep, cloth);
                    });
                });
            }
        )*
    };
}

collide_systems! {
    /// Keeps particles out of the spheres.
    collide_sphere: Sphere,
    /// Keeps particles out of the half-spaces.
    collide_half_space: HalfSpace,
    /// Keeps particles out of the capsules, straight and tapered.
    collide_capsule: Capsule,
    /// Keeps particles out of the boxes.
    collide_cuboid: Cuboid,
    /// Keeps particles out of cylinders, convex hulls, triangle meshes and terrain.
    collide_shape: Other,
}
