//! All plugins in one group.

#[cfg(feature = "render")]
use bevy_app::{FixedFirst, FixedLast, FixedPreUpdate, FixedUpdate};
use bevy_app::{FixedPostUpdate, PluginGroup, PluginGroupBuilder};
use bevy_ecs::{intern::Interned, schedule::ScheduleLabel};

use crate::prelude::*;

/// Everything a game needs to have cloth. Add it after `DefaultPlugins`.
///
/// | plugin | what it does |
/// | --- | --- |
/// | [`ClothPlugin`] | simulates; alone, it is all that a server needs |
/// | [`ClothMeshPlugin`] | builds a mesh for each cloth, and writes it once per frame, between the last two steps |
/// | [`ClothFabricPlugin`] | gives cloths the material of their [`ClothLook`] |
/// | [`ClothPickingPlugin`] | lets pointers hit cloth: observers of `PointerPress` and the like work on it as on any mesh |
/// | [`ClothDiagnosticsPlugin`] | counts, times and measures stretch for Bevy's `DiagnosticsStore` |
/// | [`ClothDebugPlugin`] | draws particles, constraints, pins, normals and bounds; off until asked for |
///
/// Each can be left out: `ClothPlugins::default().build().disable::<ClothDebugPlugin>()`. Without a renderer, a window or
/// picking the parts that need them do nothing.
///
/// None of them listens to mouse or keys. What does is added by name: [`ClothDragPlugin`] lets the pointer drag every cloth and a key pin
/// it, [`ClothSphereControlsPlugin`] lets keys move entities with [`ClothSphereControls`].
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

    #[cfg(feature = "render")]
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
        #[cfg(feature = "render")]
        let interpolate = self.is_fixed();
        let group = PluginGroupBuilder::start::<Self>().add(ClothPlugin::new(self.schedule));
        #[cfg(feature = "render")]
        let group = group
            .add(ClothMeshPlugin {
                settings: ClothMeshSettings {
                    interpolate,
                    ..ClothMeshSettings::default()
                },
            })
            .add(ClothFabricPlugin::default());
        #[cfg(feature = "picking")]
        let group = group.add(ClothPickingPlugin);
        #[cfg(feature = "diagnostics")]
        let group = group.add(ClothDiagnosticsPlugin);
        #[cfg(feature = "gizmos")]
        let group = group.add(ClothDebugPlugin);
        group
    }
}
