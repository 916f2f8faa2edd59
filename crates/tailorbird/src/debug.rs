//! Draws what a cloth consists of, and what it collides with. All of it is off until asked for:
//!
//! ```
//! # use bevy_ecs::prelude::*;
//! # use bevy_gizmos::config::GizmoConfigStore;
//! # use tailorbird::prelude::*;
//! fn show_pins(mut store: ResMut<GizmoConfigStore>) {
//!     store.config_mut::<ClothGizmos>().1.pins = true;
//! }
//! ```

mod colliders;
mod wind;

use bevy_app::{App, Plugin, PostUpdate};
use bevy_color::{Color, palettes::tailwind};
use bevy_ecs::prelude::*;
use bevy_gizmos::{
    AppGizmoBuilder, GizmoMeshSystems, GizmoPlugin,
    config::{GizmoConfigGroup, GizmoConfigStore},
    gizmos::Gizmos,
};
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use bevy_shape::Aabb3d;
use bevy_transform::TransformSystems;
use tailorbird_cloth::{
    prelude::*,
    topology::{constraints::ConstraintFamily, order::Stored},
};

/// Draws what a cloth consists of and what it collides with, as [`ClothGizmos`] says. Needs Bevy's `GizmoPlugin` (part of `DefaultPlugins`) to be
/// added before; does nothing without.
pub struct ClothDebugPlugin;

/// Parts of each cloth and collider that are drawn; everything is off by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect, GizmoConfigGroup)]
#[reflect(Default)]
pub struct ClothGizmos {
    /// Particles, as small crosses.
    pub particles: bool,
    /// Stretch constraints.
    pub stretch: bool,
    /// Shear constraints.
    pub shear: bool,
    /// Bend constraints.
    pub bend: bool,
    /// Pinned particles, and the one in a hand.
    pub pins: bool,
    /// Normals.
    pub normals: bool,
    /// The box around each cloth.
    pub bounds: bool,
    /// The shape of each [`ClothCollider`], without its margin; of a half-space a square of 10 m. What is in
    /// [`ClothExternalColliders`] is for its engine to draw.
    pub colliders: bool,
    /// The border of each [`ClothWindZone`], paler where it begins to blow at full strength, and arrows for the air in them and around
    /// cloths, 4 cm for 1 m/s.
    pub wind: bool,
}

impl ClothGizmos {
    /// Returns whether anything of a cloth is drawn.
    fn shows_any(&self) -> bool {
        let no_cloth = Self {
            colliders: self.colliders,
            wind: self.wind,
            ..Self::default()
        };
        *self != no_cloth
    }

    fn color(&self, family: ConstraintFamily) -> Option<Color> {
        match family {
            ConstraintFamily::Stretch => self.stretch.then_some(tailwind::EMERALD_400),
            ConstraintFamily::Shear => self.shear.then_some(tailwind::SKY_400),
            ConstraintFamily::Bend => self.bend.then_some(tailwind::FUCHSIA_400),
        }
        .map(Color::from)
    }
}

impl Plugin for ClothDebugPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<GizmoPlugin>() {
            return;
        }
        app.init_gizmo_group::<ClothGizmos>().add_systems(
            PostUpdate,
            (
                draw.run_if(shows_any),
                colliders::draw
                    .after(TransformSystems::Propagate)
                    .run_if(shows_colliders),
                wind::draw
                    .after(TransformSystems::Propagate)
                    .run_if(shows_wind),
            )
                .before(GizmoMeshSystems),
        );
    }
}

fn shows_any(store: Res<GizmoConfigStore>) -> bool {
    store.config::<ClothGizmos>().1.shows_any()
}

fn shows_colliders(store: Res<GizmoConfigStore>) -> bool {
    store.config::<ClothGizmos>().1.colliders
}

fn shows_wind(store: Res<GizmoConfigStore>) -> bool {
    store.config::<ClothGizmos>().1.wind
}

fn draw(
    cloths: Query<
        (
            &ClothTopology,
            &ClothParticles,
            &ClothNormals,
            &ClothBounds,
            &ClothFrame,
        ),
        With<Cloth>,
    >,
    mut gizmos: Gizmos<ClothGizmos>,
) {
    let show = *gizmos.config_ext;
    for (topology, particles, normals, bounds, frame) in &cloths {
        if particles.is_empty() || particles.len() != topology.particles() {
            continue;
        }
        let at = |i: usize| particles.world_position(i, frame);
        let stored = |i: usize| at(particles.order().given(Stored(i as u32)).index());
        let size = (topology.areas().sum::<f32>() / particles.len() as f32).sqrt();

        for family in ConstraintFamily::ALL {
            let Some(color) = show.color(family) else {
                continue;
            };
            for ([a, b], _) in topology.constraints().family(family) {
                gizmos.line(stored(a as usize), stored(b as usize), color);
            }
        }
        if show.particles {
            for i in 0..particles.len() {
                cross(&mut gizmos, at(i), 0.15 * size, tailwind::AMBER_300.into());
            }
        }
        if show.pins {
            for i in particles.pinned() {
                cross(&mut gizmos, at(i), 0.6 * size, tailwind::RED_500.into());
            }
            if let Some(i) = particles.grabbed() {
                cross(&mut gizmos, at(i), 0.8 * size, tailwind::YELLOW_400.into());
            }
        }
        if show.normals {
            for i in 0..normals.len() {
                let from = match normals.shading() {
                    ClothShading::Smooth => stored(i),
                    ClothShading::Flat => {
                        let corners = topology.triangles().get(i).unwrap_or_default();
                        corners
                            .into_iter()
                            .map(|k| stored(k as usize))
                            .sum::<Vec3>()
                            / 3.0
                    }
                };
                gizmos.ray(
                    from,
                    frame.vector_to_world(normals.normal(i)) * size,
                    tailwind::BLUE_500,
                );
            }
        }
        if show.bounds {
            let bounds = Aabb3d {
                min: bounds.min.into(),
                max: bounds.max.into(),
            };
            gizmos.aabb_3d(bounds, frame.isometry(), tailwind::GRAY_200);
        }
    }
}

fn cross(gizmos: &mut Gizmos<ClothGizmos>, center: Vec3, size: f32, color: Color) {
    let half = 0.5 * size;
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        gizmos.line(center - axis * half, center + axis * half, color);
    }
}
