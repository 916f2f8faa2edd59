//! Solid things that cloth collides with.

mod near;

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Vec3};
use bevy_reflect::prelude::*;
use bevy_transform::{components::Transform, helper::TransformHelper};

use crate::{
    cloth::Cloth,
    error::{ClothErrorKind, ClothStatus, ErrorSource},
    frame::{shortest, split},
    particles::ClothParticles,
    solver::{
        ClothSolver,
        kernels::{
            contact::{Phase, Touching},
            half_space::{self, MovingHalfSpace},
            lanes::{Shared, SharedPoints},
            sphere::{self, MovingSphere},
        },
    },
    stages::{ClothStages, ClothStagesItem, Substep, for_each_awake},
    step::ClothStep,
};

/// A solid thing that every cloth collides with. It follows the entity's `Transform`, from step to step without gaps, and
/// takes cloth along by friction.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component)]
#[require(Transform, ClothStatus, ColliderPose)]
pub struct ClothCollider {
    /// Its shape, around the entity's origin.
    pub shape: ColliderShape,
    /// Coulomb friction [-]. The geometric mean with the material's counts.
    pub friction: f32,
}

/// The shape of a collider.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[non_exhaustive]
pub enum ColliderShape {
    /// A ball. Where the entity is scaled, the largest factor counts.
    Sphere {
        /// \[m\].
        radius: f32,
    },
    /// Everything below the entity's x-z plane: the ground.
    HalfSpace,
}

impl ClothCollider {
    /// The friction of a collider unless another is given [-].
    pub const FRICTION: f32 = 0.5;

    /// A collider that moves faster than this [m/s] is taken to be put elsewhere instead: it does not sweep up the cloth
    /// between.
    pub const TELEPORT_SPEED: f32 = 200.0;

    /// A ball of this radius \[m\].
    pub fn sphere(radius: f32) -> Self {
        Self {
            shape: ColliderShape::Sphere { radius },
            friction: Self::FRICTION,
        }
    }

    /// Everything below the entity's x-z plane.
    pub fn half_space() -> Self {
        Self {
            shape: ColliderShape::HalfSpace,
            friction: Self::FRICTION,
        }
    }

    /// With this Coulomb friction [-].
    pub fn with_friction(self, friction: f32) -> Self {
        Self { friction, ..self }
    }

    /// What is wrong with this collider.
    pub fn errors(&self) -> Vec<ClothErrorKind> {
        let radius = match self.shape {
            ColliderShape::Sphere { radius } => ClothErrorKind::number(
                "ClothCollider radius",
                radius,
                |r| r > 0.0 && r.is_finite(),
                "above 0 and finite [m]",
            ),
            ColliderShape::HalfSpace => None,
        };
        let friction = ClothErrorKind::number(
            "ClothCollider.friction",
            self.friction,
            |f| f >= 0.0 && f.is_finite(),
            "at least 0 and finite [-]",
        );
        [radius, friction].into_iter().flatten().collect()
    }
}

/// Where a collider was at the end of the step before. Written by [`snapshot_colliders`] alone.
#[derive(Component, Clone, Copy, Debug, Default, Reflect)]
#[reflect(Component, Default)]
pub struct ColliderPose(Option<Isometry3d>);

/// The colliders of this step with their motion. Written by [`snapshot_colliders`] alone.
#[derive(Resource, Clone, Debug, Default)]
pub struct ClothColliders {
    colliders: Vec<MovingCollider>,
}

#[derive(Clone, Copy, Debug)]
struct MovingCollider {
    entity: Entity,
    shape: ColliderShape,
    friction: f32,
    start: Isometry3d,
    end: Isometry3d,
}

impl ClothColliders {
    /// The number of colliders.
    pub fn len(&self) -> usize {
        self.colliders.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.colliders.is_empty()
    }
}

/// Reads where the colliders are at the start and at the end of the step.
///
/// One that is wrong, or whose transform is not finite, is reported and left out.
pub fn snapshot_colliders(
    step: Res<ClothStep>,
    helper: TransformHelper,
    mut list: ResMut<ClothColliders>,
    mut colliders: Query<(Entity, &ClothCollider, &mut ColliderPose, &mut ClothStatus)>,
    commands: ParallelCommands,
) {
    list.colliders.clear();
    for (entity, collider, mut pose, mut status) in &mut colliders {
        let errors = collider.errors();
        let valid = errors.is_empty();
        ClothStatus::update(
            &mut status,
            entity,
            &commands,
            ErrorSource::Collider,
            errors,
        );
        let Ok(transform) = helper.compute_global_transform(entity) else {
            continue;
        };
        let place = split(&transform);
        let error = place.as_ref().err().cloned();
        ClothStatus::update(
            &mut status,
            entity,
            &commands,
            ErrorSource::Transform,
            error,
        );
        let (Ok((end, scale)), true) = (place, valid) else {
            pose.0 = None;
            continue;
        };
        let start = pose
            .0
            .filter(|start| {
                let moved = start.translation.distance(end.translation);
                moved <= ClothCollider::TELEPORT_SPEED * step.world_seconds()
            })
            .unwrap_or(end);
        pose.0 = Some(end);
        let shape = match collider.shape {
            ColliderShape::Sphere { radius } => ColliderShape::Sphere {
                radius: radius * scale.abs().max_element(),
            },
            ColliderShape::HalfSpace => ColliderShape::HalfSpace,
        };
        list.colliders.push(MovingCollider {
            entity,
            shape,
            friction: collider.friction,
            start,
            end,
        });
    }
    // The order in which they are solved must not depend on how entities are stored.
    list.colliders.sort_by_key(|collider| collider.entity);
}

/// Looks for contacts before the constraints are solved: pushes particles out, and notes where they touch.
///
/// For [`ClothSolver::Chains`] alone, which then moves those particles along the surface.
pub fn find_contacts(
    step: Res<ClothStep>,
    colliders: Res<ClothColliders>,
    mut cloths: Query<ClothStages, With<Cloth>>,
) {
    let substep = step.in_progress();
    for_each_awake(&step, &mut cloths, &|mut cloth| {
        colliders.approach(&substep, &mut cloth);
    });
}

/// Keeps particles out of the spheres.
pub fn collide_sphere(
    step: Res<ClothStep>,
    colliders: Res<ClothColliders>,
    mut cloths: Query<ClothStages, With<Cloth>>,
) {
    let substep = step.in_progress();
    for_each_awake(&step, &mut cloths, &|mut cloth| {
        colliders.collide_spheres(&substep, &mut cloth);
    });
}

/// Keeps particles out of the half-spaces.
pub fn collide_half_space(
    step: Res<ClothStep>,
    colliders: Res<ClothColliders>,
    mut cloths: Query<ClothStages, With<Cloth>>,
) {
    let substep = step.in_progress();
    for_each_awake(&step, &mut cloths, &|mut cloth| {
        colliders.collide_half_spaces(&substep, &mut cloth);
    });
}

impl ClothColliders {
    /// What [`find_contacts`] does for one cloth.
    pub(crate) fn approach(&self, substep: &Substep, cloth: &mut ClothStagesItem) {
        let particles = &mut *cloth.particles;
        if *cloth.solver != ClothSolver::Chains || self.is_empty() {
            particles.contacts.any = false;
            return;
        }
        let len = particles.len();
        particles.contacts.reset(len);
        for collider in &self.colliders {
            collider.collide(Phase::Approach, substep, cloth);
        }
    }

    /// What [`collide_sphere`] does for one cloth.
    pub(crate) fn collide_spheres(&self, substep: &Substep, cloth: &mut ClothStagesItem) {
        for collider in &self.colliders {
            if let ColliderShape::Sphere { .. } = collider.shape {
                collider.collide(Phase::Final, substep, cloth);
            }
        }
    }

    /// What [`collide_half_space`] does for one cloth.
    pub(crate) fn collide_half_spaces(&self, substep: &Substep, cloth: &mut ClothStagesItem) {
        for collider in &self.colliders {
            if let ColliderShape::HalfSpace = collider.shape {
                collider.collide(Phase::Final, substep, cloth);
            }
        }
    }
}

impl MovingCollider {
    /// Keeps the particles of one cloth out.
    fn collide(&self, phase: Phase, substep: &Substep, cloth: &mut ClothStagesItem) {
        let (frame, material) = (&*cloth.frame, cloth.material);
        let start = frame.start_of(self.start, self.end);
        let fractions = substep.fractions();
        let (from, to) = (start.translation.into(), self.end.translation.into());
        let [center_from, center_to] = frame.way_to_frame(from, to, fractions);
        let friction = combined_friction(self.friction, material.friction);
        let ClothParticles {
            position,
            previous_position,
            inv_mass,
            grabbed,
            contacts,
            ..
        } = &mut *cloth.particles;
        let len = inv_mass.len();
        let known = contacts.depth.len() == len && (phase == Phase::Approach || contacts.any);
        let touching = Touching {
            position: SharedPoints::new(position),
            previous: SharedPoints::new(previous_position),
            inv_mass: Shared::new(inv_mass),
            contacts: known.then(|| {
                (
                    SharedPoints::new(&mut contacts.normal),
                    Shared::new(&mut contacts.depth),
                )
            }),
            phase,
        };
        let held = grabbed.map(|held| held.particle as usize);
        let any = match self.shape {
            ColliderShape::Sphere { radius } => {
                let turned = shortest(self.end.rotation * start.rotation.inverse());
                let sphere = MovingSphere {
                    from: center_from,
                    to: center_to,
                    rotation: frame.vector_to_frame(turned.to_scaled_axis() / substep.count as f32)
                        - frame.carried_turn(),
                    radius: radius + material.margin(),
                    friction,
                };
                let any = substep.crew.any(0..len, |range| {
                    sphere::collide_all(substep.level, &sphere, touching, range)
                });
                if let Some(i) = held {
                    sphere::collide_one(&sphere, i, position, previous_position);
                }
                any
            }
            ColliderShape::HalfSpace => {
                let rotation = start.rotation.slerp(self.end.rotation, fractions.1);
                let plane = MovingHalfSpace {
                    from: center_from,
                    to: center_to,
                    normal: frame.vector_to_frame(rotation * Vec3::Y),
                    margin: material.margin(),
                    friction,
                };
                let any = substep.crew.any(0..len, |range| {
                    half_space::collide_all(substep.level, &plane, touching, range)
                });
                if let Some(i) = held {
                    half_space::collide_one(&plane, i, position, previous_position);
                }
                any
            }
        };
        contacts.any |= any && phase == Phase::Approach;
    }
}

/// Two surfaces rub with the geometric mean of their frictions: if either is slippery, so is the pair.
fn combined_friction(a: f32, b: f32) -> f32 {
    (a * b).max(0.0).sqrt()
}
