//! Carries [`DemoSettings`] over to the world: whoever changes them, panel, keys or script, takes the same way.

use bevy::{
    core_pipeline::prepass::DepthPrepass,
    gizmos::config::GizmoConfigStore,
    pbr::wireframe::{Wireframe, WireframeColor},
    post_process::dof::{DepthOfField, DepthOfFieldMode},
    prelude::*,
};
use tailorbird::{prelude::*, sphere_controls::move_spheres};

use super::{
    camera::OrbitCamera,
    compare::{self, Beside},
    crates::CratesPlugin,
    gamepad::GamepadPlugin,
    garment,
    hand::HandPlugin,
    moving::MovingPlugin,
    scenes::{SceneAssets, SceneCloth, SceneEntity, SceneKind, SceneSphere, look, spawn_scene},
    settings::DemoSettings,
    shortcuts::use_shortcuts,
    stage::StagePlugin,
    touch::TouchPlugin,
};

/// The demo without window and panel: stage, scenes, settings, keys. Add it after Bevy's plugins and `ClothPlugins`.
#[derive(Default)]
pub struct DemoPlugin {
    /// Settings at the start.
    pub settings: DemoSettings,
    /// Stage of the scenes.
    pub stage: StagePlugin,
}

/// The systems that carry settings over, in `Update`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ApplySettings;

impl Plugin for DemoPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((
            self.stage.clone(),
            MovingPlugin,
            CratesPlugin,
            GamepadPlugin,
            HandPlugin,
            TouchPlugin,
        ))
        .insert_resource(self.settings.clone())
        .add_systems(
            Update,
            (use_shortcuts.before(ApplySettings), garment::add_mipmaps),
        )
        .add_systems(
            Update,
            (
                show_scene,
                apply_cloth,
                apply_sphere,
                apply_solver,
                apply_fabric,
                apply_wireframe,
                apply_gizmos,
                apply_picking,
                apply_lens,
            )
                .chain()
                .in_set(ApplySettings)
                .run_if(resource_changed::<DemoSettings>),
        )
        .add_systems(FixedUpdate, keep_above_ground.after(move_spheres));
    }
}

/// Clears the old scene away and spawns the new one; both cloths start together.
fn show_scene(
    mut commands: Commands,
    settings: Res<DemoSettings>,
    mut shown: Local<Option<(SceneKind, u32, bool)>>,
    old: Query<(Entity, Has<Beside>), With<SceneEntity>>,
    mut cameras: Query<&mut OrbitCamera>,
    mut assets: SceneAssets,
) {
    let wanted = (settings.scene, settings.resets, settings.beside);
    let before = shown.replace(wanted);
    if before == Some(wanted) {
        return;
    }
    let stays = before == Some((settings.scene, settings.resets, true));
    for (entity, beside) in &old {
        if beside || !stays {
            // Some are below others, and go with them.
            commands.entity(entity).try_despawn();
        }
    }
    if !stays {
        spawn_scene(&mut commands, &settings, &mut assets);
    }
    if settings.beside {
        compare::spawn_beside(&mut commands, &settings, &mut assets);
    }
    let looks = (settings.scene, settings.beside);
    if before.is_none_or(|(scene, _, beside)| (scene, beside) != looks) {
        let view = if settings.beside {
            compare::view(settings.scene)
        } else {
            settings.scene.view()
        };
        for mut camera in &mut cameras {
            let covered = camera.covered;
            *camera = OrbitCamera { covered, ..view };
        }
    }
}

fn apply_cloth(
    settings: Res<DemoSettings>,
    mut drag: ResMut<ClothDragSettings>,
    mut cloths: Query<
        (
            &mut Cloth,
            &mut ClothMaterial,
            &mut ClothSolver,
            &mut ClothShading,
            &mut ClothPins,
            Has<Beside>,
        ),
        With<SceneCloth>,
    >,
) {
    drag.radius = settings.grab_radius;
    for (mut cloth, mut material, mut solver, mut shading, mut pins, beside) in &mut cloths {
        material.set_if_neq(settings.material);
        solver.set_if_neq(if beside {
            settings.other_solver()
        } else {
            settings.solver
        });
        shading.set_if_neq(settings.shading);
        let shape = settings.scene.cloth(settings.resolution);
        if shape.is_some_and(|shape| cloth.set_if_neq(shape)) {
            // They name particles of the grid as it was.
            *pins = settings.scene.pins(settings.resolution);
        }
    }
}

fn apply_sphere(
    settings: Res<DemoSettings>,
    mut assets: SceneAssets,
    mut spheres: Query<
        (&mut ClothCollider, &mut ClothSphereControls, &mut Mesh3d),
        With<SceneSphere>,
    >,
) {
    let radius = settings.sphere_radius;
    for (mut collider, mut controls, mut mesh) in &mut spheres {
        if collider.set_if_neq(ClothCollider::sphere(radius)) {
            *mesh = assets.sphere(radius);
        }
        controls.set_if_neq(ClothSphereControls {
            speed: settings.sphere_speed,
            fast_speed: 3.0 * settings.sphere_speed,
            ..default()
        });
    }
}

fn apply_solver(
    settings: Res<DemoSettings>,
    mut solver: ResMut<ClothSettings>,
    mut wind: ResMut<ClothWind>,
    mut steps: Local<u32>,
) {
    wind.set_if_neq(settings.wind.clone());
    let asked = settings.single_steps.wrapping_sub(*steps);
    *steps = settings.single_steps;
    let pending_steps = if settings.paused {
        solver.pending_steps + asked
    } else {
        0
    };
    solver.set_if_neq(ClothSettings {
        gravity: Vec3::new(0.0, -settings.gravity, 0.0),
        substeps: settings.substeps,
        iterations: settings.iterations,
        paused: settings.paused,
        pending_steps,
        ..default()
    });
}

fn apply_fabric(
    mut commands: Commands,
    settings: Res<DemoSettings>,
    mut shown: Local<Option<(&'static str, bool)>>,
    cloths: Query<Entity, With<SceneCloth>>,
) {
    let wanted = (settings.preset, settings.look.texture);
    if *shown == Some(wanted) {
        return;
    }
    *shown = Some(wanted);
    if settings.scene == SceneKind::Garment {
        // Its meshes have materials of their own.
        return;
    }
    for entity in &cloths {
        commands.entity(entity).insert(look(&settings));
    }
}

/// Needs Bevy's `WireframePlugin`; does nothing without.
fn apply_wireframe(
    mut commands: Commands,
    settings: Res<DemoSettings>,
    cloths: Query<(Entity, Has<Wireframe>), With<SceneCloth>>,
) {
    for (entity, shown) in &cloths {
        if settings.look.wireframe && !shown {
            let color = WireframeColor {
                color: Color::srgb(0.05, 0.06, 0.08),
            };
            commands.entity(entity).insert((Wireframe, color));
        } else if !settings.look.wireframe && shown {
            commands.entity(entity).remove::<Wireframe>();
        }
    }
}

fn apply_gizmos(settings: Res<DemoSettings>, mut store: ResMut<GizmoConfigStore>) {
    let (config, gizmos) = store.config_mut::<ClothGizmos>();
    // Nearer to the camera than the cloth that they lie in.
    config.depth_bias = -0.02;
    let look = settings.look;
    *gizmos = ClothGizmos {
        particles: look.particles,
        stretch: look.stretch,
        shear: look.shear,
        bend: look.bend,
        pins: look.pins,
        normals: look.normals,
        bounds: look.bounds,
        colliders: look.colliders,
        wind: look.air,
    };
}

fn apply_picking(
    mut commands: Commands,
    settings: Res<DemoSettings>,
    mut picking: ResMut<ClothPickingSettings>,
    cameras: Query<Entity, With<OrbitCamera>>,
) {
    picking.set_if_neq(ClothPickingSettings {
        backend: settings.picking,
    });
    for camera in &cameras {
        match settings.picking {
            ClothPickingBackend::Ray => commands.entity(camera).remove::<DepthPrepass>(),
            ClothPickingBackend::Depth => commands.entity(camera).insert(DepthPrepass),
        };
    }
}

/// The camera's focus is sharp.
fn apply_lens(
    mut commands: Commands,
    settings: Res<DemoSettings>,
    cameras: Query<(Entity, &OrbitCamera)>,
) {
    let look = settings.look;
    for (camera, orbit) in &cameras {
        if look.depth_of_field {
            commands.entity(camera).insert(DepthOfField {
                mode: DepthOfFieldMode::Bokeh,
                focal_distance: orbit.distance,
                aperture_f_stops: look.f_number,
                ..default()
            });
        } else {
            commands.entity(camera).remove::<DepthOfField>();
        }
    }
}

/// The keys do not push the ball into the ground.
fn keep_above_ground(mut spheres: Query<(&ClothCollider, &mut Transform), With<SceneSphere>>) {
    for (collider, mut transform) in &mut spheres {
        if let ClothColliderShape::Sphere { radius } = collider.shape
            && transform.translation.y < radius
        {
            transform.translation.y = radius;
        }
    }
}
