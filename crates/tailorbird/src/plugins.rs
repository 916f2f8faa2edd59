//! All plugins in one group.

use bevy_app::{
    FixedFirst, FixedLast, FixedPostUpdate, FixedPreUpdate, FixedUpdate, PluginGroup,
    PluginGroupBuilder,
};
use bevy_ecs::{intern::Interned, schedule::ScheduleLabel};

use crate::prelude::*;

/// Everything a game needs to have cloth. Add it after `DefaultPlugins`.
///
/// | plugin | what it does |
/// | --- | --- |
/// | [`ClothPlugin`] | simulates; alone, it is all that a server needs |
/// | [`ClothMeshPlugin`] | builds a mesh for each cloth, and writes it once per frame, between the last two steps |
/// | [`ClothFabricPlugin`] | gives cloths the material of their [`ClothLook`] |
/// | [`ClothPickingPlugin`] | lets pointers hit cloth: `On<Pointer<…>>` observers work on it as on any mesh |
/// | [`ClothDragPlugin`] | drags cloth with the pointer, and pins it with a key |
/// | [`SphereControlsPlugin`] | moves entities with [`SphereControls`] by keys |
/// | [`ClothDiagnosticsPlugin`] | counts, times and measures stretch for Bevy's `DiagnosticsStore` |
/// | [`ClothDebugPlugin`] | draws particles, constraints, pins, normals and bounds; off until asked for |
///
/// Each can be left out: `ClothPlugins::default().build().disable::<ClothDragPlugin>()`. Without a renderer, a window or
/// picking the parts that need them do nothing.
pub struct ClothPlugins {
    schedule: Interned<dyn ScheduleLabel>,
}

impl ClothPlugins {
    /// Simulates in this schedule instead of `FixedPostUpdate`. In one that does not have a fixed time step, what is
    /// drawn is the last step, without interpolation.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: schedule.intern(),
        }
    }

    fn is_fixed(&self) -> bool {
        [
            FixedFirst.intern(),
            FixedPreUpdate.intern(),
            FixedUpdate.intern(),
            FixedPostUpdate.intern(),
            FixedLast.intern(),
        ]
        .contains(&self.schedule)
    }
}

impl Default for ClothPlugins {
    fn default() -> Self {
        Self::new(FixedPostUpdate)
    }
}

impl PluginGroup for ClothPlugins {
    fn build(self) -> PluginGroupBuilder {
        let interpolate = self.is_fixed();
        PluginGroupBuilder::start::<Self>()
            .add(ClothPlugin::new(self.schedule))
            .add(ClothMeshPlugin {
                settings: ClothMeshSettings {
                    interpolate,
                    ..ClothMeshSettings::default()
                },
            })
            .add(ClothFabricPlugin::default())
            .add(ClothPickingPlugin)
            .add(ClothDragPlugin)
            .add(SphereControlsPlugin)
            .add(ClothDiagnosticsPlugin)
            .add(ClothDebugPlugin)
    }
}
