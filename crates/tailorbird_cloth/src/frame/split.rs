//! World transforms as rigid frames and scales.

use bevy_math::{Isometry3d, Quat, Vec3, Vec3A};
use bevy_transform::components::GlobalTransform;

use crate::error::ClothErrorKind;

/// A world transform as rigid frame and scale, or what is wrong with it.
pub(crate) fn split(transform: &GlobalTransform) -> Result<(Isometry3d, Vec3), ClothErrorKind> {
    let (scale, rotation, translation) = transform.to_scale_rotation_translation();
    let matrix = transform.affine();
    if !matrix.is_finite() {
        return Err(ClothErrorKind::Transform {
            value: matrix.to_string(),
        });
    }
    if scale.to_array().contains(&0.0) {
        return Err(ClothErrorKind::Scale { value: scale });
    }
    Ok((Isometry3d::new(translation, rotation.normalize()), scale))
}

/// [`split`] with signs of the scale as they are wanted, where the transform mirrors as that does, else as in `known` where that does,
/// else so that it is turned as little as it may be against `rotation`. A matrix does not tell them.
pub(super) fn split_like(
    transform: &GlobalTransform,
    wanted: Vec3,
    (known, rotation): (Vec3, Quat),
) -> Result<(Isometry3d, Vec3), ClothErrorKind> {
    let (place, scale) = split(transform)?;
    let candidates = [Vec3::ONE, Vec3::X, Vec3::Y, Vec3::Z].map(|axis| {
        if axis == Vec3::ONE {
            (place.rotation, scale)
        } else {
            // Half a turn about one axis mirrors the other two.
            let turn = Quat::from_xyzw(axis.x, axis.y, axis.z, 0.0);
            (place.rotation * turn, scale * (2.0 * axis - 1.0))
        }
    });
    let mirrors = |like: Vec3| {
        let signs = like.signum();
        candidates
            .into_iter()
            .find(|(_, scale)| scale.signum() == signs)
    };
    let near = |candidate: &(Quat, Vec3)| candidate.0.dot(rotation).abs();
    let (rotation, scale) = mirrors(wanted)
        .or_else(|| mirrors(known))
        .unwrap_or_else(|| {
            let nearest = |a: (Quat, Vec3), b| if near(&b) > near(&a) + 1e-3 { b } else { a };
            candidates.into_iter().fold(candidates[0], nearest)
        });
    Ok((Isometry3d::new(place.translation, rotation), scale))
}

/// A transform as a rigid frame and a scale whose signs are those of `signs`.
///
/// # Errors
/// The error in the transform.
pub fn split_mirrored(
    transform: &GlobalTransform,
    signs: Vec3,
) -> Result<(Isometry3d, Vec3), ClothErrorKind> {
    split_like(transform, signs, (signs, Quat::IDENTITY))
}

/// Error of a world transform whose axes are not at right angles.
pub(super) fn check_shear(transform: &GlobalTransform) -> Option<ClothErrorKind> {
    /// Tolerance for rounding, several parents deep.
    const MOST: f32 = 1e-3;
    let axes = transform.affine().matrix3;
    let [x, y, z] = [axes.x_axis, axes.y_axis, axes.z_axis].map(Vec3A::normalize_or_zero);
    let value = x.dot(y).abs().max(y.dot(z).abs()).max(z.dot(x).abs());
    (value > MOST).then_some(ClothErrorKind::Shear { value, most: MOST })
}
