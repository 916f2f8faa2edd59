//! Where an entity is, with its scale and shear.

use bevy_math::{Isometry3d, Mat3, Quat, Vec3};
use bevy_transform::components::GlobalTransform;

use crate::{error::ClothErrorKind, frame::split};

/// Where an entity is in the world: its rigid place, and what its own space is stretched by within that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pose {
    /// Translation \[m\] and rotation.
    place: Isometry3d,
    /// Scale and shear [-].
    stretch: Mat3,
}

/// Takes points of one space to another: x' = M x + t.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Map {
    matrix: Mat3,
    shift: Vec3,
}

impl Map {
    /// A point there \[m\].
    pub fn apply(&self, point: Vec3) -> Vec3 {
        self.matrix * point + self.shift
    }

    /// The point that gets there \[m\].
    pub fn undo(&self, point: Vec3) -> Vec3 {
        self.matrix.inverse() * (point - self.shift)
    }
}

impl Pose {
    /// The pose of an entity, or what is wrong with its transform.
    pub fn of(transform: &GlobalTransform) -> Result<Self, ClothErrorKind> {
        let (place, _) = split(transform)?;
        let unturned = Mat3::from_quat(place.rotation.inverse());
        Ok(Self {
            place,
            stretch: unturned * Mat3::from(transform.affine().matrix3),
        })
    }

    /// Translation \[m\] and rotation.
    pub fn place(&self) -> Isometry3d {
        self.place
    }

    /// The same elsewhere.
    pub fn at(&self, place: Isometry3d) -> Self {
        Self { place, ..*self }
    }

    /// A part of the way to another, 0 to 1: the place moves along a straight line, and turns evenly.
    pub fn towards(&self, to: &Self, fraction: f32) -> Self {
        if self == to || fraction >= 1.0 {
            return *to;
        }
        Self {
            place: Isometry3d::new(
                self.place.translation.lerp(to.place.translation, fraction),
                self.place.rotation.slerp(to.place.rotation, fraction),
            ),
            stretch: self.stretch * (1.0 - fraction) + to.stretch * fraction,
        }
    }

    /// From the entity's own space to a frame's.
    pub fn seen_from(&self, frame: Isometry3d) -> Map {
        let unturned = frame.rotation.inverse();
        // The difference of the translations first: it is small even where they are large.
        let shift = unturned * Vec3::from(self.place.translation - frame.translation);
        let matrix = Mat3::from_quat(unturned * self.place.rotation) * self.stretch;
        Map { matrix, shift }
    }

    /// How far it is to another \[m\].
    pub fn way_to(&self, to: &Self) -> Vec3 {
        Vec3::from(to.place.translation - self.place.translation)
    }

    /// How much another is turned.
    pub fn turn_to(&self, to: &Self) -> Quat {
        to.place.rotation * self.place.rotation.inverse()
    }

    /// Whether another pose is larger by about as much as a cloth that grows by this.
    pub fn grows_to(&self, to: &Self, ratio: Vec3) -> bool {
        let growth = to.stretch.determinant() / self.stretch.determinant();
        let (is, should) = (growth.abs().ln(), ratio.element_product().abs().ln());
        (is - should).abs() < 0.1 * should.abs()
    }
}

/// The rigid motion from one pose to another, as seen from a frame that does not move.
pub(super) fn motion(from: &Pose, to: &Pose, frame: Isometry3d) -> Isometry3d {
    let unturned = frame.rotation.inverse();
    // As small numbers: both ends relative to the frame.
    let [from, to] = [from, to].map(|pose| {
        let at = pose.place();
        Isometry3d::new(
            unturned * Vec3::from(at.translation - frame.translation),
            unturned * at.rotation,
        )
    });
    to * from.inverse()
}

#[cfg(test)]
mod tests {
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
        /// Also where a child is sheared by its parent's scale.
        #[test]
        fn points_are_where_the_transform_puts_them(
            parent in transform(), child in transform(), p in vector(2.0), frame in transform(),
        ) {
            let world = GlobalTransform::from(parent) * child;
            let frame = Isometry3d::new(frame.translation, frame.rotation);
            let map = Pose::of(&world).expect("finite").seen_from(frame);
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
            Pose::of(&turned.into()).expect("finite")
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
