//! Poses of entities.

use bevy_math::Mat3;
use bevy_transform::components::GlobalTransform;
use tailorbird_solver::pose::Pose;

use crate::{error::ClothErrorKind, frame::split};

/// Pose of an entity, or the error in its transform.
pub(super) fn pose_of(transform: &GlobalTransform) -> Result<Pose, ClothErrorKind> {
    let (place, _) = split(transform)?;
    let unturned = Mat3::from_quat(place.rotation.inverse());
    let stretch = unturned * Mat3::from(transform.affine().matrix3);
    Ok(Pose::new(place, stretch))
}

#[cfg(test)]
mod tests {
    use bevy_math::{Isometry3d, Quat, Vec3};
    use bevy_transform::components::Transform;
    use proptest::prelude::*;

    use super::*;

    fn vector(range: f32) -> impl Strategy<Value = Vec3> {
        (-range..range, -range..range, -range..range).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }

    prop_compose! {
        fn transform()(at in vector(5.0), axis in vector(3.0), scale in 0.1f32..3.0, flat in 0.2f32..1.0) -> Transform {
            let scale = Vec3::new(scale, scale * flat, -scale);
            Transform { translation: at, rotation: Quat::from_scaled_axis(axis), scale }
        }
    }

    proptest! {
        /// Points of a child that is sheared by its parent's scale, as well.
        #[test]
        fn points_are_where_the_transform_puts_them(
            parent in transform(), child in transform(), p in vector(2.0), frame in transform(),
        ) {
            let world = GlobalTransform::from(parent) * child;
            let frame = Isometry3d::new(frame.translation, frame.rotation);
            let map = pose_of(&world).expect("finite").seen_from(frame);
            let expected = frame.inverse() * world.transform_point(p);
            prop_assert!(map.apply(p).distance(expected) < 2e-4, "{} {expected}", map.apply(p));
            let scale = child.scale.abs().min_element() * parent.scale.abs().min_element();
            prop_assert!(map.undo(expected).distance(p) < 1e-4 / (scale * scale));
        }
    }

    #[test]
    fn half_way_round_is_on_the_arc() {
        let at = |angle| {
            let turned = Transform::from_rotation(Quat::from_rotation_y(angle));
            pose_of(&turned.into()).expect("finite")
        };
        let (from, to) = (at(0.0), at(1.0));
        for k in 0..=4 {
            let part = k as f32 / 4.0;
            let map = from.towards(&to, part).seen_from(Isometry3d::IDENTITY);
            let expected = Quat::from_rotation_y(part) * Vec3::X;
            assert!(map.apply(Vec3::X).distance(expected) < 1e-6);
        }
    }
}
