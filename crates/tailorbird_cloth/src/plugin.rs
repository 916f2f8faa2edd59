//! The plugin of this crate.

use bevy_app::{
    App, FixedFirst, FixedLast, FixedMainScheduleOrder, FixedPostUpdate, Plugin, RunFixedMainLoop,
    RunFixedMainLoopSystems,
};
use bevy_ecs::{
    intern::Interned,
    message::signal_message_update_system,
    prelude::*,
    schedule::{IntoScheduleConfigs, ScheduleLabel, SingleThreadedExecutor},
    system::ScheduleSystem,
};
use bevy_transform::TransformSystems;

use crate::{
    attachment::{break_attachments, prepare_attachments},
    bounds::update_bounds,
    build::build_topology,
    collider::{
        ClothColliders, collide_capsule, collide_cuboid, collide_half_space, collide_shape,
        collide_sphere, find_contacts, gather_reactions, snapshot_colliders,
    },
    diagnostics::{ClothStepTime, start_clock, stop_clock},
    forces::apply_forces,
    frame::{advance_frames, prepare_frames},
    grab::apply_grab,
    inertia::reset_teleported,
    motion::{begin_fixed_targets, end_fixed_targets, prepare_motion, see_targets},
    normals::recompute_normals,
    pins::apply_pins,
    prelude::*,
    runner::{OwnStages, simulate_cloths},
    sampling::{
        ClothFrameClock, FixedLoopBegins, FixedLoopEnds, begin_fixed_step, end_fixed_step,
        pass_on_teleports, sample_motion, sample_parents, see_frame,
    },
    schedule::{Prepare, Simulate, Writeback, run_part, run_substeps},
    sleep::{carry_unseen, rest_cloths, rest_unseen, settle_cloths, wake_cloths},
    slow_build::warn_of_slow_build,
    solver::{damp_tangles, solve_constraints, verlet_step},
    step::{begin_cloths, begin_step, plan_substeps, step_is_whole, step_runs},
    tethers::build_tethers,
    validate::guard_finite,
    wind::{apply_wind, prepare_wind},
};

/// Simulates cloth. Needs `TimePlugin` and `TaskPoolPlugin` (both part of Bevy's `MinimalPlugins`), nothing else.
pub struct ClothPlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl ClothPlugin {
    /// Simulates in this schedule. One step covers the time that `Time` tells there, so a schedule with a fixed time step is
    /// the one to choose.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: schedule.intern(),
        }
    }
}

impl Default for ClothPlugin {
    /// Simulates in `FixedPostUpdate`.
    fn default() -> Self {
        Self::new(FixedPostUpdate)
    }
}

impl Plugin for ClothPlugin {
    fn build(&self, app: &mut App) {
        register_types(app);
        add_sampling(app);
        app.init_resource::<ClothSettings>()
            .init_resource::<ClothStep>()
            .init_resource::<ClothStepTime>()
            .init_resource::<ClothColliders>()
            .init_resource::<ClothExternalColliders>()
            .init_resource::<ClothReactions>()
            .init_resource::<ClothWind>()
            .init_resource::<ClothWindState>();

        app.configure_sets(
            self.schedule,
            (
                ClothSystems::Prepare,
                ClothSystems::Simulate,
                ClothSystems::Writeback,
            )
                .chain()
                .before(TransformSystems::Propagate),
        )
        .add_systems(
            self.schedule,
            // They have the whole world, of which Bevy's signal needs nothing that cloth touches.
            (
                run_part::<Prepare>
                    .in_set(ClothSystems::Prepare)
                    .ambiguous_with(signal_message_update_system),
                run_part::<Simulate>
                    .in_set(ClothSystems::Simulate)
                    .ambiguous_with(signal_message_update_system),
                run_part::<Writeback>
                    .in_set(ClothSystems::Writeback)
                    .ambiguous_with(signal_message_update_system),
            ),
        );
        add_part(
            app,
            Prepare,
            (
                start_clock,
                begin_step,
                (sample_parents, pass_on_teleports, sample_motion).chain(),
                rest_unseen,
                prepare_frames,
                build_topology,
                apply_pins,
                reset_teleported,
                (prepare_attachments, prepare_motion, carry_unseen).chain(),
                build_tethers,
                plan_substeps,
                (snapshot_colliders, prepare_wind).chain().run_if(step_runs),
                wake_cloths,
                (
                    apply_grab,
                    apply_forces,
                    apply_wind.run_if(not(step_is_whole)),
                )
                    .chain()
                    .run_if(step_runs),
            )
                .chain(),
        );
        add_part(
            app,
            Simulate,
            (
                simulate_cloths.run_if(step_is_whole),
                (
                    begin_cloths,
                    (run_substeps, guard_finite, settle_cloths)
                        .chain()
                        .run_if(step_runs),
                )
                    .chain()
                    .run_if(not(step_is_whole)),
                // When it is known who settles: what carries bodies does not.
                gather_reactions,
            )
                .chain(),
        );
        add_part(
            app,
            Writeback,
            (
                (
                    recompute_normals,
                    update_bounds,
                    rest_cloths.run_if(step_runs),
                )
                    .chain()
                    .run_if(not(step_is_whole)),
                break_attachments.run_if(step_runs),
                stop_clock,
                warn_of_slow_build,
            )
                .chain(),
        );

        app.init_schedule(ClothSubstep)
            .edit_schedule(ClothSubstep, |schedule| {
                // The systems share cloths out to threads themselves; a substep is too short to share systems out.
                schedule.set_executor(SingleThreadedExecutor::new());
            })
            .configure_sets(
                ClothSubstep,
                (
                    ClothSubstepSystems::Integrate,
                    ClothSubstepSystems::Approach,
                    ClothSubstepSystems::Solve,
                    ClothSubstepSystems::Collide,
                )
                    .chain(),
            )
            .add_systems(
                ClothSubstep,
                (
                    (advance_frames, verlet_step)
                        .chain()
                        .in_set(ClothSubstepSystems::Integrate),
                    find_contacts.in_set(ClothSubstepSystems::Approach),
                    solve_constraints.in_set(ClothSubstepSystems::Solve),
                    (
                        collide_sphere,
                        collide_half_space,
                        collide_capsule,
                        collide_cuboid,
                        collide_shape,
                        damp_tangles,
                    )
                        .chain()
                        .in_set(ClothSubstepSystems::Collide),
                ),
            );
        let own = app.get_schedule(ClothSubstep).map(OwnStages::new);
        app.insert_resource(own.unwrap_or_default());
    }
}

/// Notes in each frame, and at both ends of each step of the fixed loop, where things are.
fn add_sampling(app: &mut App) {
    app.init_resource::<ClothFrameClock>()
        .add_message::<ClothMotionTeleported>()
        .add_systems(
            RunFixedMainLoop,
            (sample_parents, pass_on_teleports, see_frame, see_targets)
                .chain()
                .in_set(RunFixedMainLoopSystems::BeforeFixedMainLoop),
        );
    add_part(
        app,
        FixedLoopBegins,
        (begin_fixed_step, begin_fixed_targets).chain(),
    );
    add_part(
        app,
        FixedLoopEnds,
        (end_fixed_step, end_fixed_targets).chain(),
    );
    if let Some(mut order) = app.world_mut().get_resource_mut::<FixedMainScheduleOrder>() {
        order.insert_after(FixedFirst, FixedLoopBegins);
        order.insert_after(FixedLast, FixedLoopEnds);
    }
}

/// Puts systems into a schedule of their own, on one thread: most take less time than a thread to wake.
fn add_part<M>(
    app: &mut App,
    part: impl ScheduleLabel + Clone,
    systems: impl IntoScheduleConfigs<ScheduleSystem, M>,
) {
    app.init_schedule(part.clone())
        .edit_schedule(part.clone(), |schedule| {
            schedule.set_executor(SingleThreadedExecutor::new());
        })
        .add_systems(part, systems);
}

fn register_types(app: &mut App) {
    app.register_type::<Cloth>()
        .register_type::<ClothAttachment>()
        .register_type::<ClothAttachmentOf>()
        .register_type::<ClothAttachments>()
        .register_type::<ClothAttachedTo>()
        .register_type::<ClothAttachmentsHeld>()
        .register_type::<ClothAttachmentForce>()
        .register_type::<crate::attachment::ClothAttachedParticles>()
        .register_type::<crate::attachment::ClothAttachmentState>()
        .register_type::<ClothMotionConstraints>()
        .register_type::<ClothMotionTargets>()
        .register_type::<crate::motion::ClothMotionState>()
        .register_type::<crate::motion::ClothTargetSamples>()
        .register_type::<ClothPinForces>()
        .register_type::<ClothMaterial>()
        .register_type::<ClothPins>()
        .register_type::<ClothGrab>()
        .register_type::<ClothForces>()
        .register_type::<ClothWeights>()
        .register_type::<ClothShading>()
        .register_type::<ClothStatus>()
        .register_type::<ClothSolver>()
        .register_type::<ClothSubsteps>()
        .register_type::<ClothInertia>()
        .register_type::<ClothSleep>()
        .register_type::<ClothSleepState>()
        .register_type::<ClothSeen>()
        .register_type::<crate::tethers::ClothTethers>()
        .register_type::<crate::settings::ClothInstructionSet>()
        .register_type::<ClothTopology>()
        .register_type::<ClothFrame>()
        .register_type::<ClothParticles>()
        .register_type::<ClothNormals>()
        .register_type::<ClothBounds>()
        .register_type::<ClothCollider>()
        .register_type::<ClothLayers>()
        .register_type::<crate::collider::ClothColliderState>()
        .register_type::<ClothSettings>()
        .register_type::<ClothSampledMotion>()
        .register_type::<ClothMotionTeleported>()
        .register_type::<ClothStep>()
        .register_type::<ClothStepTime>()
        .register_type::<ClothWind>()
        .register_type::<ClothWindZone>();
}
