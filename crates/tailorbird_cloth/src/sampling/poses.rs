//! Poses of entities at both ends of a step.

use bevy_ecs::{prelude::*, system::SystemParam};
use bevy_transform::components::{GlobalTransform, Transform};

use super::ClothSampledMotion;

/// Computes where entities are at both ends of the step: the one place that cloths, holders, colliders and zones are read from.
#[derive(SystemParam)]
pub struct ClothSampledPoses<'w, 's> {
    parents: Query<'w, 's, &'static ChildOf>,
    places: Query<'w, 's, (&'static Transform, Option<&'static ClothSampledMotion>)>,
}

/// Poses of an entity at both ends of a step, in the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampledPose {
    /// Pose at its start; if the last step ended elsewhere, the displacement between is not felt.
    pub start: GlobalTransform,
    /// Pose at its end.
    pub end: GlobalTransform,
    /// True if it, or a parent, was put elsewhere.
    pub teleported: bool,
}

impl ClothSampledPoses<'_, '_> {
    /// Poses of an entity.
    ///
    /// # Errors
    /// The entity, it or a parent, that has no `Transform` or does not exist.
    pub(crate) fn get(&self, entity: Entity) -> Result<SampledPose, Entity> {
        let mut pose = SampledPose {
            start: GlobalTransform::IDENTITY,
            end: GlobalTransform::IDENTITY,
            teleported: false,
        };
        let (start, end) = self.ends(entity, &mut pose)?;
        (pose.start, pose.end) = (start.into(), end.into());
        let mut moved = start != end;
        for parent in self.parents.iter_ancestors(entity) {
            let (start, end) = self.ends(parent, &mut pose)?;
            pose.start = start * pose.start;
            moved |= start != end;
            pose.end = if moved { end * pose.end } else { pose.start };
        }
        Ok(pose)
    }

    fn ends(
        &self,
        entity: Entity,
        pose: &mut SampledPose,
    ) -> Result<(Transform, Transform), Entity> {
        let (place, motion) = self.places.get(entity).map_err(|_| entity)?;
        let Some(motion) = motion else {
            return Ok((*place, *place));
        };
        pose.teleported |= motion.teleported;
        Ok((motion.from, motion.now))
    }
}
