//! Cloth and the bodies of [avian](avian3d) collide with each other, both ways.
//!
//! ![Crates and balls fall on a sheet that carries them](https://raw.githubusercontent.com/tailorbird/tailorbird/main/assets/pictures/gallery/crates.gif)
//!
//! With [`ClothAvianPlugin`] each of avian's colliders keeps cloth out, without a mark on it, and cloth pushes, carries and
//! stops dynamic bodies with the impulse that it loses itself.
//!
//! ```
//! use avian3d::prelude::*;
//! use bevy_app::{App, TaskPoolPlugin};
//! use bevy_math::{Quat, UVec2, Vec2};
//! use bevy_time::TimePlugin;
//! use bevy_transform::{TransformPlugin, components::Transform};
//! use tailorbird_avian::ClothAvianPlugin;
//! use tailorbird_cloth::prelude::*;
//!
//! let mut app = App::new();
//! // Of `DefaultPlugins`, what physics needs.
//! app.add_plugins((TaskPoolPlugin::default(), TimePlugin, TransformPlugin));
//! app.add_plugins((PhysicsPlugins::default(), ClothPlugin::default(), ClothAvianPlugin::default()));
//! // A sheet that is held at its edges, and a ball above it.
//! app.world_mut().spawn((
//!     Cloth::grid(Vec2::splat(2.0), UVec2::splat(32)).centered(),
//!     ClothPins::edges([ClothEdge::Top, ClothEdge::Bottom, ClothEdge::Left, ClothEdge::Right]),
//!     Transform::from_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2)),
//! ));
//! app.world_mut().spawn((
//!     RigidBody::Dynamic,
//!     Collider::sphere(0.15),
//!     Mass(2.0),
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
//! - **Not** sensors, what has [`ColliderDisabled`], and what has
//!   [`ClothCollisionDisabled`].
//! - **Layers**: the collider's [`CollisionLayers`] against the cloth's
//!   [`ClothLayers`], which has the same two masks; a cloth without any meets all. A
//!   `ClothLayers` on the collider's entity replaces its `CollisionLayers` for cloth.
//! - **Friction**: the dynamic coefficient, of the collider, else of its body, else
//!   [`DefaultFriction`]. The geometric mean with the cloth's material counts, whatever the
//!   combine rule; cloth does not bounce, so restitution does not count.
//! - A [`ClothCollider`] on the same entity replaces avian's for cloth.
//!
//! # What bodies feel
//!
//! Dynamic bodies get impulses, with their mass, inertia and locked axes. Static and kinematic ones move cloth and feel
//! nothing. A body that sleeps is to cloth as if it were static, until the push differs from the one that it fell
//! asleep with ([`ClothLoad`]): then it wakes with the velocity that the difference gives it.
//!
//! # Heavy bodies
//!
//! A sheet carries what falls on it, however heavy and with any number of substeps. But a body that is heavy for its cloth stretches
//! it, and what is stretched beyond its measure trembles, the less the more substeps it has
//! ([`ClothSettings::substeps`]). A sheet of 2 m × 2 m cotton (0.6 kg) of 32² particles, pinned at its edges, moves from frame to frame
//! by 0.02 mm under a ball of 0.5 kg (16 substeps), by 0.04 mm under 2 kg (32) and by 0.4 mm under 10 kg (64), as
//! `cargo test -p tailorbird_avian ball -- --nocapture` prints; with the few that are automatic, by millimetres.
//!
//! Only bodies that are dynamic are carried like this, and only by the default solver: by the classic one a heavy body falls through.
//!
//! # Order
//!
//! Avian steps first, then cloth, in `FixedPostUpdate` unless other schedules are given: avian's writeback,
//! [`ClothBridgeSystems::Collect`], cloth, [`ClothBridgeSystems::Apply`], after which `Transform`s are written again of
//! bodies that cloth moved. Both should step equally often, so give [`ClothPlugin`],
//! [`ClothAvianPlugin`] and [`PhysicsPlugins`] the same schedule.

mod apply;
mod collect;
/// Parry's shapes as shapes that cloth collides with.
mod shape {
    tailorbird_bridge::convert_parry!(avian3d::parry);
}

use avian3d::prelude::*;
use bevy_app::{App, FixedPostUpdate, Plugin};
use bevy_ecs::{
    intern::Interned,
    schedule::{IntoScheduleConfigs, ScheduleLabel},
};
use bevy_transform::TransformSystems;
pub use tailorbird_bridge::{ClothBridgeSystems, ClothCollisionDisabled, ClothLoad, TrackedPose};
use tailorbird_cloth::prelude::*;

use self::{
    apply::{apply_reactions, track_colliders, write_transforms},
    collect::push_colliders,
};

/// Lets cloth and avian's bodies collide. Needs avian's [`PhysicsPlugins`] and
/// [`ClothPlugin`]; add it before any body is spawned.
pub struct ClothAvianPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl ClothAvianPlugin {
    /// For cloth that is simulated in this schedule.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: schedule.intern(),
        }
    }
}

impl Default for ClothAvianPlugin {
    /// For cloth in `FixedPostUpdate`, where avian and cloth are unless told otherwise.
    fn default() -> Self {
        Self::new(FixedPostUpdate)
    }
}

impl Plugin for ClothAvianPlugin {
    fn build(&self, app: &mut App) {
        app.register_required_components::<Collider, TrackedPose>();
        app.register_required_components::<RigidBody, ClothLoad>();
        app.register_type::<ClothCollisionDisabled>();
        app.configure_sets(
            self.schedule,
            (
                ClothBridgeSystems::Collect
                    .after(PhysicsSystems::Writeback)
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
                (apply_reactions, write_transforms, track_colliders)
                    .chain()
                    .in_set(ClothBridgeSystems::Apply),
            ),
        );
    }
}
