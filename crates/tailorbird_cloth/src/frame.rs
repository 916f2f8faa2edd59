//! The rigid frame that a cloth's particles live in.

use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Mat3, Quat, Vec3};
use bevy_reflect::prelude::*;
use bevy_transform::{components::GlobalTransform, helper::TransformHelper};

use crate::{
    cloth::Cloth,
    error::{ClothErrorKind, ClothStatus, ErrorSource},
    particles::ClothParticles,
    solver::kernels::rigid,
    stages::{ClothStages, ClothStagesItem, Substep},
    step::{ClothStep, for_each_awake},
};

/// The rigid frame that a cloth's particles live in: translation and rotation of the entity. Scale is part of the rest
/// shape instead.
///
/// Where the entity moves, the frame moves with it, evenly over the substeps, and pins with the frame. Free particles
/// keep their place in the world: they are expressed in the moved frame. So a cloth far from the world's origin is
/// as precise as one at it.
#[derive(Component, Clone, Copy, Debug, Reflect)]
#[reflect(Component, Default)]
pub struct ClothFrame {
    /// At the start of the step.
    pub(crate) start: Isometry3d,
    /// At the end of the step.
    pub(crate) end: Isometry3d,
    /// At the end of the substep in progress: what the particles' coordinates refer to.
    pub(crate) current: Isometry3d,
    pub(crate) scale: Vec3,
    pub(crate) placed: bool,
}

impl Default for ClothFrame {
    fn default() -> Self {
        Self {
            start: Isometry3d::IDENTITY,
            end: Isometry3d::IDENTITY,
            current: Isometry3d::IDENTITY,
            scale: Vec3::ONE,
            placed: false,
        }
    }
}

impl ClothFrame {
    /// Where the frame is in the world.
    pub fn isometry(&self) -> Isometry3d {
        self.current
    }

    /// The entity's scale, which is part of the rest shape.
    pub fn scale(&self) -> Vec3 {
        self.scale
    }

    /// A point of the frame in the world \[m\].
    pub fn to_world(&self, point: Vec3) -> Vec3 {
        self.current.rotation * point + Vec3::from(self.current.translation)
    }

    /// A point of the world in the frame \[m\].
    pub fn to_frame(&self, point: Vec3) -> Vec3 {
        self.current.rotation.inverse() * (point - Vec3::from(self.current.translation))
    }

    /// A point of the world in the frame at the end of the step \[m\].
    pub(crate) fn to_frame_at_end(self, point: Vec3) -> Vec3 {
        self.end.rotation.inverse() * (point - Vec3::from(self.end.translation))
    }

    /// A direction of the frame in world axes.
    pub fn vector_to_world(&self, vector: Vec3) -> Vec3 {
        self.current.rotation * vector
    }

    /// A direction of the world in the frame's axes.
    pub fn vector_to_frame(&self, vector: Vec3) -> Vec3 {
        self.current.rotation.inverse() * vector
    }

    /// Whether the frame moves during this step.
    pub fn is_moving(&self) -> bool {
        self.start != self.end
    }

    /// Takes over a scale that differs by more than the rounding of a scale that is read back from a rotated matrix.
    fn set_scale(&mut self, scale: Vec3) {
        const ROUNDING: f32 = 1e-5;
        let most = ROUNDING * scale.abs().max_element();
        if !self.placed || !scale.abs_diff_eq(self.scale, most) {
            self.scale = scale;
        }
    }

    fn place(&mut self, to: Isometry3d) {
        self.start = self.end;
        self.end = to;
        if !self.placed {
            self.start = to;
            self.placed = true;
        }
        self.current = self.start;
    }
}

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

/// Reads where the entities of the cloths are.
///
/// A transform that is not finite is reported, and the frame stays where it was.
pub fn prepare_frames(
    helper: TransformHelper,
    mut cloths: Query<(Entity, &mut ClothFrame, &mut ClothStatus), With<Cloth>>,
    commands: ParallelCommands,
) {
    for (entity, mut frame, mut status) in &mut cloths {
        let Ok(transform) = helper.compute_global_transform(entity) else {
            continue;
        };
        let error = match split(&transform) {
            Ok((isometry, scale)) => {
                frame.set_scale(scale);
                frame.place(isometry);
                None
            }
            Err(error) => {
                let stay = frame.end;
                if frame.placed {
                    frame.place(stay);
                }
                Some(error)
            }
        };
        ClothStatus::update(
            &mut status,
            entity,
            &commands,
            ErrorSource::Transform,
            error,
        );
    }
}

/// Moves the frames on by one substep, and expresses the free particles in the moved frame.
pub fn advance_frames(step: Res<ClothStep>, mut cloths: Query<ClothStages, With<Cloth>>) {
    let substep = step.in_progress();
    for_each_awake!(step, cloths, |mut cloth: ClothStagesItem| {
        cloth.frame.advance(&substep, &mut cloth.particles);
    });
}

impl ClothFrame {
    /// Moves on by one substep.
    pub(crate) fn advance(&mut self, substep: &Substep, particles: &mut ClothParticles) {
        if !self.is_moving() {
            particles.hold_still();
            return;
        }
        let to = if substep.left() == 1 {
            self.end
        } else {
            let (_, fraction) = substep.fractions();
            Isometry3d::new(
                self.start.translation.lerp(self.end.translation, fraction),
                self.start.rotation.slerp(self.end.rotation, fraction),
            )
        };
        let ClothParticles {
            position,
            previous_position,
            lost_displacement,
            acceleration,
            inv_mass,
            ..
        } = particles;
        let from = self.current;
        self.current = to;
        let inverse: Quat = to.rotation.inverse();
        // The difference of the translations first: it is small even where they are large.
        let shift = inverse * Vec3::from(from.translation - to.translation);
        let rotation = Mat3::from_quat(inverse * from.rotation);
        rigid::change_frame(rotation, shift, inv_mass, position, previous_position);
        rigid::rotate(rotation, lost_displacement);
        rigid::rotate(rotation, acceleration);
    }
}
