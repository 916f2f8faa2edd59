//! Pose of an entity, with its scale and shear.

use bevy_math::{Isometry3d, Mat3, Quat, Vec3};

/// Pose of an entity in the world: its rigid place, and the stretch of its own space within that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Translation \[m\] and rotation.
    place: Isometry3d,
    /// Scale and shear [-].
    stretch: Mat3,
}

/// Takes points of one space to another: x' = M x + t.
#[derive(Clone, Copy, Debug)]
pub struct Map {
    matrix: Mat3,
    shift: Vec3,
}

impl Map {
    /// Image of a point \[m\].
    pub fn apply(&self, point: Vec3) -> Vec3 {
        self.matrix * point + self.shift
    }

    /// The point whose image this is \[m\].
    pub fn undo(&self, point: Vec3) -> Vec3 {
        self.matrix.inverse() * (point - self.shift)
    }
}

impl Pose {
    /// Pose at a rigid place, with the stretch of its own space within that.
    pub fn new(place: Isometry3d, stretch: Mat3) -> Self {
        Self { place, stretch }
    }

    /// Translation \[m\] and rotation.
    pub fn place(&self) -> Isometry3d {
        self.place
    }

    /// The same pose at another place.
    pub fn at(&self, place: Isometry3d) -> Self {
        Self { place, ..*self }
    }

    /// Pose at a fraction of the motion to another, 0 to 1: the place moves along a straight line, and turns evenly.
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

    /// Map from the entity's own space to a frame's.
    pub fn seen_from(&self, frame: Isometry3d) -> Map {
        let unturned = frame.rotation.inverse();
        // The difference of the translations first: it is small even where they are large.
        let shift = unturned * Vec3::from(self.place.translation - frame.translation);
        let matrix = Mat3::from_quat(unturned * self.place.rotation) * self.stretch;
        Map { matrix, shift }
    }

    /// Displacement to another pose \[m\].
    pub fn displacement_to(&self, to: &Self) -> Vec3 {
        Vec3::from(to.place.translation - self.place.translation)
    }

    /// Rotation to another pose.
    pub fn turn_to(&self, to: &Self) -> Quat {
        to.place.rotation * self.place.rotation.inverse()
    }

    /// Returns whether another pose is larger by about the ratio by which a cloth grows.
    pub fn grows_to(&self, to: &Self, ratio: Vec3) -> bool {
        let growth = to.stretch.determinant() / self.stretch.determinant();
        let (is, should) = (growth.abs().ln(), ratio.element_product().abs().ln());
        (is - should).abs() < 0.1 * should.abs()
    }
}

/// Rigid motion from one pose to another, as seen from a frame that does not move.
pub fn motion(from: &Pose, to: &Pose, frame: Isometry3d) -> Isometry3d {
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
