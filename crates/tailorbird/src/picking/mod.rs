//! Lets pointers hit cloth.
//!
//! Two backends find what is under a pointer, and both say it the same way: `bevy_picking`'s `PointerHits`, with a
//! [`ClothPointerHit`] as the extra data of each hit. So observers of `PointerPress` and the like work on a cloth as on any mesh.

#[cfg(feature = "render")]
mod depth;
mod ray;

use bevy_app::{App, Plugin, PreUpdate};
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_picking::{PickingSystems, backend::ray::RayMap};
use bevy_reflect::prelude::*;

/// Lets pointers hit cloth, in the way that [`ClothPickingSettings`] says. Needs Bevy's `PickingPlugin`; does nothing
/// without.
pub struct ClothPickingPlugin;

/// Settings of the search for cloth under pointers. Change it at any time.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Resource, Default)]
pub struct ClothPickingSettings {
    /// The backend in use.
    pub backend: ClothPickingBackend,
}

/// A way to find the cloth under a pointer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
pub enum ClothPickingBackend {
    /// A ray from the camera against the cloth's current triangles. Exact, at once, works without a renderer. Sees cloth
    /// alone: what hides it from the camera hides it from the pointer only if it is pickable itself.
    #[default]
    Ray,
    /// Needs the feature `render`, without which it finds nothing. The depth that the camera sees under the pointer, and the particle nearest to that point. Everything that the camera
    /// draws in its depth prepass hides cloth behind it. The answer comes a few frames late. Works on cameras with
    /// a `DepthPrepass`. Transparent materials are not in it, so such cloth is not found; and a touch that presses as it
    /// lands has no answer yet, so it does not grab.
    Depth,
}

/// Place of a pointer on a cloth: the extra data of the `HitData` of `Pointer` events.
///
/// ```
/// # use bevy_ecs::prelude::*;
/// # use bevy_picking::events::PointerPress;
/// # use tailorbird::prelude::*;
/// fn on_press(press: On<PointerPress>) {
///     if let Some(hit) = press.hit.extra_as::<ClothPointerHit>() {
///         println!("particle {} of {}", hit.particle, press.entity);
///     }
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
pub struct ClothPointerHit {
    /// An index into the topology's `triangles`.
    pub triangle: usize,
    /// Weights of the triangle's corners; they add up to 1.
    pub barycentric: Vec3,
    /// The corner nearest to the pointer.
    pub particle: usize,
}

impl Plugin for ClothPickingPlugin {
    fn build(&self, app: &mut App) {
        #[cfg(feature = "render")]
        app.add_plugins(depth::ClothDepthPickingPlugin);
        app.register_type::<ClothPickingSettings>()
            .init_resource::<ClothPickingSettings>()
            .add_systems(
                PreUpdate,
                ray::update_hits.in_set(PickingSystems::Backend).run_if(
                    resource_exists::<RayMap>.and_then(backend_is(ClothPickingBackend::Ray)),
                ),
            );
    }
}

/// Run condition: this backend is in use.
fn backend_is(backend: ClothPickingBackend) -> impl Fn(Res<ClothPickingSettings>) -> bool + Clone {
    move |settings| settings.backend == backend
}
