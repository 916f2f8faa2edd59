//! Cloth and the bodies of [Rapier](bevy_rapier3d) collide with each other, both ways.
//!
//! With [`ClothRapierPlugin`] each of Rapier's colliders keeps cloth out, without a mark on it, and cloth pushes, carries and
//! stops dynamic bodies with the impulse that it loses itself.
//!
//! ```
//! use bevy_app::{App, FixedPostUpdate, TaskPoolPlugin};
//! use bevy_math::{Quat, UVec2, Vec2};
//! use bevy_rapier3d::prelude::*;
//! use bevy_time::TimePlugin;
//! use bevy_transform::{TransformPlugin, components::Transform};
//! use tailorbird_cloth::prelude::*;
//! use tailorbird_rapier::ClothRapierPlugin;
//!
//! let mut app = App::new();
//! // Of `DefaultPlugins`, what physics needs.
//! app.add_plugins((TaskPoolPlugin::default(), TimePlugin, TransformPlugin));
//! app.add_plugins((
//!     // Rapier's own choice is `PostUpdate`, once in each frame; cloth has a fixed step.
//!     RapierPhysicsPlugin::<NoUserData>::default().in_schedule(FixedPostUpdate),
//!     ClothPlugin::default(),
//!     ClothRapierPlugin::default(),
//! ));
//! // A sheet that is held at its edges, and a ball above it.
//! app.world_mut().spawn((
//!     Cloth::grid(Vec2::splat(2.0), UVec2::splat(32)).centered(),
//!     ClothPins::edges([ClothEdge::Top, ClothEdge::Bottom, ClothEdge::Left, ClothEdge::Right]),
//!     Transform::from_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2)),
//! ));
//! app.world_mut().spawn((
//!     RigidBody::Dynamic,
//!     Collider::ball(0.15),
//!     ColliderMassProperties::Mass(2.0),
//!     Transform::from_xyz(0.0, 0.5, 0.0),
//! ));
//! app.finish();
//! app.cleanup();
//! app.update();
//! ```
//!
//! # What cloth sees
//!
//! - **Shapes**: balls, boxes, capsules, cylinders, cones, convex hulls, triangles and meshes of them, height fields,
//!   half-spaces, compounds, and the round forms of these; lines are as thick as a pencil lead (1 mm in radius). Voxels
//!   and custom shapes are left out with a warning.
//! - **Not** sensors, what is disabled, and what has [`ClothCollisionDisabled`].
//! - **Layers**: the collider's [`CollisionGroups`](bevy_rapier3d::geometry::CollisionGroups) against the cloth's
//!   [`ClothLayers`], which has the same two masks; a cloth without any meets all. A `ClothLayers` on the collider's entity
//!   replaces its `CollisionGroups` for cloth.
//! - **Friction**: the collider's coefficient. The geometric mean with the cloth's material counts, whatever the combine
//!   rule; cloth does not bounce, so restitution does not count.
//! - A [`ClothCollider`] on the same entity replaces Rapier's for cloth.
//!
//! # What bodies feel
//!
//! Dynamic bodies get impulses, with their mass, inertia and locked axes. Fixed and kinematic ones move cloth and feel
//! nothing. A body that sleeps is to cloth as if it were fixed, until the push differs from the one that it fell
//! asleep with ([`ClothLoad`]): then it wakes with the velocity that the difference gives it.
//!
//! # Heavy bodies
//!
//! A sheet carries what falls on it, however heavy and with any number of substeps. But a body that is heavy for its cloth stretches
//! it, and what is stretched beyond its measure trembles, the less the more substeps it has
//! ([`ClothSettings::substeps`]). A sheet of 2 m × 2 m cotton (0.6 kg) of 32² particles, pinned at its edges, moves from frame to frame
//! by 0.02 mm under a ball of 0.5 kg (16 substeps), by 0.04 mm under 2 kg (32) and by 0.4 mm under 10 kg (64), as
//! `cargo test -p tailorbird_rapier ball -- --nocapture` prints; with the few that are automatic, by millimetres.
//!
//! Only bodies that are dynamic are carried like this, and only by the default solver: by the classic one a heavy body falls through.
//!
//! # Order
//!
//! Rapier steps first, then cloth: Rapier's writeback, [`ClothBridgeSystems::Collect`], cloth,
//! [`ClothBridgeSystems::Apply`], after which `Transform` and `Velocity` are written again of bodies that cloth moved.
//!
//! Both should step equally often and for as long. So put Rapier into the schedule of cloth, as above, or into `FixedUpdate`
//! before it ([`in_fixed_schedule`](bevy_rapier3d::plugin::RapierPhysicsPlugin::in_fixed_schedule)). In `PostUpdate` (its
//! default) it steps once in a frame, and cloth sees bodies jump where it steps more often than that.

mod apply;
mod collect;
/// Parry's shapes as shapes that cloth collides with.
mod shape {
    tailorbird_bridge::convert_parry!(bevy_rapier3d::parry);
}

use bevy_app::{App, FixedPostUpdate, Plugin};
use bevy_ecs::{
    intern::Interned,
    schedule::{IntoScheduleConfigs, ScheduleLabel},
};
use bevy_rapier3d::{dynamics::RigidBody, geometry::Collider, plugin::PhysicsSet};
use bevy_transform::TransformSystems;
pub use tailorbird_bridge::{ClothBridgeSystems, ClothCollisionDisabled, ClothLoad, TrackedPose};
use tailorbird_cloth::prelude::*;

use self::{
    apply::{apply_reactions, write_transforms},
    collect::push_colliders,
};

/// Lets cloth and Rapier's bodies collide. Needs
/// [`RapierPhysicsPlugin`](bevy_rapier3d::plugin::RapierPhysicsPlugin) and
/// [`ClothPlugin`]; add it before any body is spawned.
pub struct ClothRapierPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl ClothRapierPlugin {
    /// For cloth that is simulated in this schedule.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: schedule.intern(),
        }
    }
}

impl Default for ClothRapierPlugin {
    /// For cloth in `FixedPostUpdate`, where it is unless told otherwise.
    fn default() -> Self {
        Self::new(FixedPostUpdate)
    }
}

impl Plugin for ClothRapierPlugin {
    fn build(&self, app: &mut App) {
        app.register_required_components::<Collider, TrackedPose>();
        app.register_required_components::<RigidBody, ClothLoad>();
        app.register_type::<ClothCollisionDisabled>();
        app.configure_sets(
            self.schedule,
            (
                ClothBridgeSystems::Collect
                    .after(PhysicsSet::Writeback)
                    .before(ClothSystems::Prepare),
                ClothBridgeSystems::Apply
                    .after(ClothSystems::Simulate)
                    .before(ClothSystems::Writeback)
                    .before(TransformSystems::Propagate),
            ),
        )
        .add_systems(
            self.schedule,
            (
                push_colliders.in_set(ClothBridgeSystems::Collect),
                (apply_reactions, write_transforms)
                    .chain()
                    .in_set(ClothBridgeSystems::Apply),
            ),
        );
    }
}
