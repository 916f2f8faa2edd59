//! World positions of texels of the depth texture.

use bevy_math::{Mat4, UVec2, Vec2, Vec3};
use bevy_transform::components::GlobalTransform;

/// View of a camera in one frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    /// Projection, inverted.
    pub view_from_clip: Mat4,
    /// Transform of the camera.
    pub world_from_view: GlobalTransform,
    /// Upper left corner of the viewport in the texture \[texels\].
    pub origin: UVec2,
    /// Size of the viewport \[texels\].
    pub size: UVec2,
}

/// A point that is visible in one texel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct VisiblePoint {
    /// Where, in the world \[m\].
    pub position: Vec3,
    /// Width of the texel there \[m\].
    pub texel_width: f32,
}

/// Samples of a texel whose mean is more than this many texel widths away from their median show different surfaces.
const SAME_SURFACE: f32 = 4.0;

impl View {
    /// The texel of the viewport under a point given in normalised device coordinates; points beyond the border count
    /// as on it. `None` in an empty viewport.
    pub fn texel(&self, ndc: Vec2) -> Option<UVec2> {
        if self.size.min_element() == 0 || !ndc.is_finite() {
            return None;
        }
        let at = (ndc * Vec2::new(0.5, -0.5) + 0.5) * self.size.as_vec2();
        // Conversion of a negative number to an unsigned one gives 0.
        Some(at.as_uvec2().min(self.size - 1))
    }

    /// Visible point in a texel of the viewport, from the median and the mean depth of its samples.
    ///
    /// Depth is linear on the screen. So if all samples show the same surface, their mean is its depth in the middle of the texel, while a
    /// single one is off by up to half a texel times the slope. At an outline the mean means nothing.
    pub fn visible(&self, texel: UVec2, median: f32, mean: f32) -> Option<VisiblePoint> {
        let median = self.unproject(texel, median)?;
        self.unproject(texel, mean)
            .filter(|mean| {
                mean.position.distance(median.position) <= SAME_SURFACE * median.texel_width
            })
            .or(Some(median))
    }

    /// Visible point in the middle of a texel of the viewport, from its depth: 1 at the near plane, 0 at the far one, and also where
    /// nothing was drawn.
    fn unproject(&self, texel: UVec2, depth: f32) -> Option<VisiblePoint> {
        if !(depth > 0.0 && depth <= 1.0) {
            return None;
        }
        // To the view first and to the world then: that stays precise far from the world's origin.
        let in_view = |texel: Vec2| {
            let ndc = (texel / self.size.as_vec2() - 0.5) * Vec2::new(2.0, -2.0);
            self.view_from_clip.project_point3(ndc.extend(depth))
        };
        let center = texel.as_vec2() + 0.5;
        let point = in_view(center);
        let texel_width = point.distance(in_view(center + Vec2::X));
        let position = self.world_from_view.transform_point(point);
        (position.is_finite() && texel_width.is_finite()).then_some(VisiblePoint {
            position,
            texel_width,
        })
    }
}

#[cfg(test)]
mod tests {
    use bevy_camera::{CameraProjection, OrthographicProjection, PerspectiveProjection};
    use bevy_math::Rect;
    use bevy_transform::components::Transform;

    use super::*;

    /// A point that is projected and looked up by its texel and depth comes back to within half a texel.
    #[test]
    fn a_point_comes_back_through_its_texel_and_depth() {
        let perspective = PerspectiveProjection {
            aspect_ratio: 400.0 / 300.0,
            ..Default::default()
        };
        let orthographic = OrthographicProjection {
            area: Rect::new(-2.0, -1.5, 2.0, 1.5),
            ..OrthographicProjection::default_3d()
        };
        for clip_from_view in [
            perspective.get_clip_from_view(),
            orthographic.get_clip_from_view(),
        ] {
            let world_from_view = GlobalTransform::from(
                Transform::from_xyz(3.0, 2.0, 5.0).looking_at(Vec3::new(0.1, 0.2, 0.3), Vec3::Y),
            );
            let view = View {
                view_from_clip: clip_from_view.inverse(),
                world_from_view,
                origin: UVec2::new(70, 30),
                size: UVec2::new(400, 300),
            };
            for point in [
                Vec3::ZERO,
                Vec3::new(0.4, -0.3, 1.0),
                Vec3::new(-0.7, 0.5, -0.2),
            ] {
                let clip_from_world = clip_from_view * world_from_view.to_matrix().inverse();
                let ndc = clip_from_world.project_point3(point);
                let texel = view.texel(ndc.truncate()).expect("inside");
                let found = view.unproject(texel, ndc.z).expect("visible");
                assert!(
                    found.position.distance(point) <= 0.72 * found.texel_width,
                    "{found:?} for {point}"
                );
            }
            assert_eq!(view.unproject(UVec2::ZERO, 0.0), None);
            assert_eq!(view.unproject(UVec2::ZERO, f32::NAN), None);
            assert_eq!(view.texel(Vec2::new(-1.0, 1.0)), Some(UVec2::ZERO));
            assert_eq!(view.texel(Vec2::new(9.0, -9.0)), Some(UVec2::new(399, 299)));
            assert_eq!(
                View {
                    size: UVec2::new(0, 9),
                    ..view
                }
                .texel(Vec2::ZERO),
                None
            );
        }
    }
}
