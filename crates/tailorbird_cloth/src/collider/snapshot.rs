//! Reads where the colliders are in a step.

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Mat3, Quat, Vec3};
use tailorbird_solver::contact::colliders::{Body, ColliderId, MovingCollider};

use super::{
    ClothCollider, ClothColliderBody, ClothColliderShape, ClothColliderState, ClothColliders,
    ClothExternalCollider, ClothExternalColliders, ClothLayers, check,
};
use crate::{
    error::{ClothErrorKind, ClothErrorSource, ClothStatus, ClothStatusOf},
    frame::split,
    sampling::ClothSampledPoses,
    step::ClothStep,
};

impl ClothColliders {
    /// Adds the parts of a collider at this scale.
    fn add(&mut self, step: u64, scale: Vec3, whole: &ClothExternalCollider) {
        let body = whole.body.as_ref().map(|body| self.body(body));
        let mut add = |part: u32, shape: &ClothColliderShape, at: Isometry3d| {
            let (rotation, scale) = scaled_axes(scale, at.rotation);
            let at = Isometry3d::new(at.translation, rotation);
            let Some(solid) = self.solids.scaled(step, shape, scale) else {
                return;
            };
            self.list.colliders.push(MovingCollider {
                id: ColliderId {
                    owner: whole.entity.to_bits(),
                    part: (whole.part, part),
                },
                solid,
                friction: whole.friction,
                margin: whole.margin,
                layers: whole.layers.layers(),
                start: whole.start * at,
                end: whole.end * at,
                body,
            });
        };
        if let ClothColliderShape::Compound(compound) = &whole.shape {
            for (k, (at, shape)) in compound.parts().iter().enumerate() {
                let place = Isometry3d::new(Vec3::from(at.translation) * scale, at.rotation);
                add(k as u32, shape, place);
            }
        } else {
            add(0, &whole.shape, Isometry3d::IDENTITY);
        }
    }

    /// The place of a body in the list of bodies.
    fn body(&mut self, body: &ClothColliderBody) -> usize {
        let found = self.bodies.binary_search_by_key(&body.body, |b| b.body);
        found.unwrap_or_else(|at| {
            self.bodies.insert(at, *body);
            at
        })
    }
}

/// Rotation and scale of a part, with this rotation, in a whole of this scale. Exact if the axes of the two agree, or the scale is the same
/// along all; no shape here can be sheared.
fn scaled_axes(scale: Vec3, rotation: Quat) -> (Quat, Vec3) {
    if rotation == Quat::IDENTITY {
        return (rotation, scale);
    }
    // What is mirrored turns the other way round.
    let (size, side) = (scale.abs(), Vec3::ONE.copysign(scale));
    let axis = rotation.xyz() * side * side.element_product();
    let rotation = Quat::from_xyzw(axis.x, axis.y, axis.z, rotation.w);
    if size == Vec3::splat(size.x) {
        return (rotation, scale);
    }
    let along = Mat3::from_quat(rotation);
    let sizes = [along.x_axis, along.y_axis, along.z_axis].map(|axis| (size * axis).length());
    (rotation, side * Vec3::from(sizes))
}

/// Reads the poses of colliders at the start and at the end of the step, and takes those of [`ClothExternalColliders`].
///
/// A wrong collider, or one whose transform is not finite, is reported and left out.
pub fn snapshot_colliders(
    step: Res<ClothStep>,
    poses: ClothSampledPoses,
    mut list: ResMut<ClothColliders>,
    mut external: ResMut<ClothExternalColliders>,
    mut colliders: Query<(
        &ClothCollider,
        Option<&ClothLayers>,
        &mut ClothColliderState,
        ClothStatusOf,
    )>,
    mut others: Query<ClothStatusOf, Without<ClothCollider>>,
    commands: ParallelCommands,
) {
    let list = &mut *list;
    list.list.colliders.clear();
    list.list.boxes.clear();
    list.list.bodies.clear();
    list.bodies.clear();
    for (collider, layers, mut pose, mut status) in &mut colliders {
        let entity = status.entity;
        let errors = collider.errors();
        let valid = errors.is_empty();
        status.update(&commands, ClothErrorSource::Collider, errors);
        let Ok(sampled) = poses.get(entity) else {
            continue;
        };
        let place = split(&sampled.end);
        let error = place.as_ref().err().cloned();
        status.update(&commands, ClothErrorSource::Transform, error);
        let (Ok((end, scale)), true) = (place, valid) else {
            continue;
        };
        let scale = pose.settle(scale);
        let start = split(&sampled.start).map_or(end, |(start, _)| start);
        let whole = ClothExternalCollider {
            entity,
            part: 0,
            shape: collider.shape.clone(),
            friction: collider.friction,
            margin: collider.margin,
            layers: layers.copied().unwrap_or_default(),
            start,
            end,
            body: None,
        };
        list.add(step.steps(), scale, &whole);
    }
    take_external(list, &mut external, step.steps(), &mut others, &commands);
    // The order in which they are solved must not depend on how entities are stored.
    list.list
        .colliders
        .sort_unstable_by_key(|collider| collider.id);
    list.solids.forget(step.steps());
    let ClothColliders { list, bodies, .. } = list;
    (list.boxes).extend(list.colliders.iter().map(MovingCollider::swept_box));
    list.bodies.extend(bodies.iter().map(|body| Body {
        inv_mass: body.inv_mass,
        inv_inertia: body.inv_inertia,
        center_of_mass: body.center_of_mass,
    }));
}

fn take_external(
    list: &mut ClothColliders,
    external: &mut ClothExternalColliders,
    step: u64,
    statuses: &mut Query<ClothStatusOf, Without<ClothCollider>>,
    commands: &ParallelCommands,
) {
    let colliders = &mut external.colliders;
    // Stable sorts need memory.
    colliders.sort_unstable_by_key(|collider| (collider.entity, collider.part));
    for collider in colliders
        .iter()
        .filter_map(|collider| collider.body.as_ref())
    {
        if body_errors(collider).next().is_none() {
            list.body(collider);
        }
    }
    for parts in colliders.chunk_by(|a, b| a.entity == b.entity) {
        let mut errors = Vec::new();
        for collider in parts {
            let before = errors.len();
            errors.extend(external_errors(collider));
            if errors.len() == before {
                list.add(step, Vec3::ONE, collider);
            }
        }
        let entity = parts[0].entity;
        if let Ok(mut status) = statuses.get_mut(entity) {
            status.update(commands, ClothErrorSource::Collider, errors);
        } else if !errors.is_empty() {
            // They are reported in the next step.
            commands.command_scope(|mut commands| {
                if let Ok(mut entity) = commands.get_entity(entity) {
                    entity.try_insert_if_new(ClothStatus::default());
                }
            });
        }
    }
    colliders.clear();
}

/// Errors of a collider from elsewhere.
fn external_errors(collider: &ClothExternalCollider) -> impl Iterator<Item = ClothErrorKind> {
    let places = [collider.start, collider.end].into_iter().filter_map(|at| {
        let finite = at.translation.is_finite() && at.rotation.is_finite();
        (!finite).then(|| ClothErrorKind::Transform {
            value: format!("{at:?}"),
        })
    });
    check(&collider.shape, collider.friction, collider.margin)
        .into_iter()
        .chain(places)
        .chain(collider.body.iter().flat_map(body_errors))
}

/// Errors of a body.
fn body_errors(body: &ClothColliderBody) -> impl Iterator<Item = ClothErrorKind> {
    let error = |field: &str, value: String, allowed: &str| ClothErrorKind::Body {
        field: field.into(),
        value,
        allowed: allowed.into(),
    };
    let mass = body.inv_mass;
    let right = mass.is_finite() && mass.min_element() >= 0.0;
    let mass =
        (!right).then(|| error("inv_mass", mass.to_string(), "at least 0 and finite [1/kg]"));
    let inertia = body.inv_inertia;
    let [x, y, z] = [inertia.x_axis.x, inertia.y_axis.y, inertia.z_axis.z];
    let right = inertia.is_finite() && x >= 0.0 && y >= 0.0 && z >= 0.0;
    let inertia = (!right).then(|| {
        let allowed = "finite, and not negative about any axis [1/(kg m²)]";
        error("inv_inertia", inertia.to_string(), allowed)
    });
    let vectors = [
        ("ClothColliderBody.center_of_mass", body.center_of_mass),
        ("ClothColliderBody.linear_velocity", body.linear_velocity),
        ("ClothColliderBody.angular_velocity", body.angular_velocity),
    ];
    let vectors = vectors
        .into_iter()
        .filter_map(|(field, value)| ClothErrorKind::vector(field, value));
    mass.into_iter().chain(inertia).chain(vectors)
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use bevy_math::EulerRot;

    use super::*;

    #[test]
    fn a_part_that_is_turned_by_quarters_or_scaled_alike_is_placed_exactly() {
        let quarters = (0..64u8).map(|k| {
            let [x, y, z] = [k & 3, k >> 2 & 3, k >> 4].map(|n| f32::from(n) * FRAC_PI_2);
            Quat::from_euler(EulerRot::XYZ, x, y, z)
        });
        let any = Quat::from_euler(EulerRot::XYZ, 0.7, -0.4, 2.0);
        let signs = (0..8u8).map(|k| {
            let sign = |bit: u8| if k >> bit & 1 == 0 { 1.0 } else { -1.0 };
            Vec3::new(sign(0), sign(1), sign(2))
        });
        for (sign, turn) in signs.flat_map(|s| quarters.clone().chain([any]).map(move |q| (s, q))) {
            let sizes = [Vec3::splat(2.0), Vec3::new(1.0, 2.0, 3.0)];
            for size in &sizes[..if turn == any { 1 } else { 2 }] {
                let scale = sign * size;
                let (rotation, along) = scaled_axes(scale, turn);
                for p in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(0.3, -0.5, 0.7)] {
                    let (is, should) = (rotation * (along * p), scale * (turn * p));
                    assert!(
                        (is - should).length() < 1e-5,
                        "{scale} {turn}: {is}, not {should}"
                    );
                }
            }
        }
    }
}
