//! Real-time cloth as ECS components and systems, without a renderer.
//!
//! A cloth is one entity. [`Cloth`](cloth::Cloth) says what its rest shape is, everything else it needs comes with it:
//!
//! ```
//! use bevy_app::{App, TaskPoolPlugin};
//! use bevy_math::{UVec2, Vec2};
//! use bevy_time::TimePlugin;
//! use tailorbird_cloth::prelude::*;
//!
//! let mut app = App::new();
//! app.add_plugins((TaskPoolPlugin::default(), TimePlugin, ClothPlugin::default()));
//! app.world_mut().spawn((
//!     Cloth::grid(Vec2::new(2.0, 1.5), UVec2::new(64, 48)),
//!     ClothMaterial::cotton(),
//!     ClothPins::corners([ClothCorner::TopLeft, ClothCorner::TopRight]),
//! ));
//! app.update();
//! ```
//!
//! The crate `tailorbird` adds what a game needs on top: the mesh, picking, dragging, debug drawing.
//!
//! # Features
//!
//! | feature | by default | what for |
//! | --- | --- | --- |
//! | `serialize` | no | saving: serde's `Serialize` and `Deserialize`, also for reflection, so that Bevy's worlds in files have them |
//!
//! # What is saved
//!
//! With the feature `serialize`, all that a game sets:
//!
//! - of a cloth: its shape, material, pins, painted weights, shading, solver, inertia and sleep settings, motion constraints and
//!   targets;
//! - colliders of all shapes, and layers;
//! - attachments, with what they belong to and what holds them: [`ClothAttachmentOf`](attachment::ClothAttachmentOf) and
//!   [`ClothAttachedTo`](attachment::ClothAttachedTo), which name entities and are mapped when a world is read;
//! - zones of wind, and the resources [`ClothSettings`](settings::ClothSettings) and [`ClothWind`](wind::ClothWind).
//!
//! Not what the simulation makes of it: particles, velocities, normals, sleep, [`ClothStatus`](error::ClothStatus). A cloth that
//! is read is built anew and starts at rest. Nor what lasts for a moment: [`ClothForces`](forces::ClothForces), which act for a step,
//! and [`ClothGrab`](grab::ClothGrab).
//!
//! A field that a file leaves out has its default, one that does not exist is an error. Colliders are checked as their constructors
//! check them, and what is wrong is an error of the file, with the text of [`ClothErrorKind`](error::ClothErrorKind); a convex hull
//! is computed again from its corners. Other values are checked where they are used, as those that a game sets: see
//! [`ClothStatus`](error::ClothStatus). JSON has no infinity and writes `null`, which is read as "no limit" where there need be none.
//!
//! Units are metres, kilograms and seconds. World axes are Bevy's: right-handed, y up.

pub mod attachment;
pub mod bounds;
pub mod build;
pub mod cloth;
pub mod collider;
pub mod diagnostics;
pub mod error;
pub mod forces;
pub mod frame;
pub mod grab;
pub mod inertia;
pub mod material;
pub mod motion;
pub mod normals;
pub mod particles;
pub mod pins;
pub mod plugin;
pub mod query;
pub mod reaction;
mod runner;
pub mod sampling;
pub mod schedule;
pub mod settings;
pub mod sleep;
pub mod slow_build;
pub mod snapshot;
pub mod solver;
pub mod stages;
pub mod step;
pub mod substep;
pub mod tethers;
pub mod topology;
#[cfg(feature = "serialize")]
mod unbounded;
pub mod validate;
pub mod weights;
pub mod wind;

pub use tailorbird_solver::{numbers, points, wall_clock};

/// The types that most users of the crate name.
pub mod prelude {
    pub use crate::{
        attachment::{
            ClothAttachedTo, ClothAttachment, ClothAttachmentBroken, ClothAttachmentForce,
            ClothAttachmentOf, ClothAttachmentOffset, ClothAttachments, ClothAttachmentsHeld,
            ClothBreakReason,
        },
        bounds::ClothBounds,
        cloth::{Cloth, ClothShape},
        collider::{
            ClothCollider, ClothColliderBody, ClothColliderShape, ClothExternalCollider,
            ClothExternalColliders, ClothLayers, ClothReactions,
        },
        diagnostics::{ClothStepTime, ClothStretch},
        error::{ClothError, ClothErrorKind, ClothShapeError, ClothStatus},
        forces::ClothForces,
        frame::ClothFrame,
        grab::ClothGrab,
        inertia::{ClothInertia, ClothTeleportMode, ClothTeleported},
        material::ClothMaterial,
        motion::{ClothMotionConstraints, ClothMotionTargets, ClothPerParticle, ClothTargetSpace},
        normals::{ClothNormals, ClothShading},
        particles::ClothParticles,
        pins::{ClothCorner, ClothEdge, ClothPin, ClothPinAuthor, ClothPins, ClothSelection},
        plugin::ClothPlugin,
        query::ClothHit,
        reaction::ClothPinForces,
        sampling::{ClothMotionTeleported, ClothSampledMotion},
        schedule::{ClothSubstep, ClothSubstepSystems, ClothSystems},
        settings::{ClothInstructionSet, ClothSettings},
        sleep::{ClothSeen, ClothSleep, ClothSleepState},
        snapshot::ClothSnapshot,
        solver::{ClothSolver, ClothSubsteps},
        step::ClothStep,
        substep::{SubstepCloth, SubstepCloths, SubstepContact},
        topology::{ClothTopology, report::ClothMeshReport},
        validate::ClothReset,
        weights::ClothWeights,
        wind::{
            ClothGusts, ClothTurbulence, ClothWind, ClothWindModel, ClothWindShape, ClothWindState,
            ClothWindZone,
        },
    };
}
