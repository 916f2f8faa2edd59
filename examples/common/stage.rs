//! The stage of the scenes: camera, light, ground and sky.

use std::f32::consts::{FRAC_PI_2, TAU};

use bevy::{
    asset::RenderAssetUsages,
    camera::{Exposure, RenderTarget},
    core_pipeline::tonemapping::{DebandDither, Tonemapping},
    light::{
        CascadeShadowConfigBuilder, DirectionalLightShadowMap, NotShadowCaster,
        cluster::ClusterConfig,
    },
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
    render::renderer::RenderAdapterInfo,
};
use tailorbird::prelude::*;

use super::{
    camera::{OrbitCamera, OrbitCameraPlugin},
    detail::Detail,
    graphics::Adapter,
    low::LowMaterialPlugin,
};

/// Camera, light, ground and sky.
#[derive(Clone, Default)]
pub struct StagePlugin {
    /// Target of the camera; the window unless another is given.
    pub target: RenderTarget,
    /// Smooth edges even without a graphics card, where they take three times as long.
    pub fine: bool,
    /// Detail of the picture.
    pub detail: Detail,
}

impl Plugin for StagePlugin {
    fn build(&self, app: &mut App) {
        if self.detail == Detail::Low {
            app.add_plugins(LowMaterialPlugin);
        }
        app.add_plugins(OrbitCameraPlugin)
            .insert_resource(self.detail)
            .insert_resource(DirectionalLightShadowMap {
                size: self.detail.shadow_map(),
            })
            .insert_resource(GlobalAmbientLight::NONE)
            // Between the ground's edge and the sky.
            .insert_resource(ClearColor(HORIZON))
            .insert_resource(StageCamera(self.clone()))
            .add_systems(
                Startup,
                (spawn_camera, spawn_light, spawn_ground, spawn_sky),
            );
    }
}

/// Properties of the camera.
#[derive(Resource, Clone)]
struct StageCamera(StagePlugin);

const ZENITH: Color = Color::srgb(0.40, 0.56, 0.76);
const HORIZON: Color = Color::srgb(0.88, 0.90, 0.92);
const FLOOR: Color = Color::srgb(0.46, 0.46, 0.46);
/// Of the sky [m].
const RADIUS: f32 = 60.0;

fn spawn_camera(
    mut commands: Commands,
    stage: Res<StageCamera>,
    adapter: Option<Res<RenderAdapterInfo>>,
    mut images: ResMut<Assets<Image>>,
) {
    let software = adapter.is_some_and(|adapter| Adapter::of(&adapter) == Adapter::Software);
    let smooth = stage.0.fine || !software;
    let mut camera = commands.spawn((
        Name::new("camera"),
        Camera3d::default(),
        stage.0.target.clone(),
        Projection::from(PerspectiveProjection {
            fov: 36_f32.to_radians(),
            near: 0.05,
            ..default()
        }),
        if smooth { Msaa::Sample4 } else { Msaa::Off },
        Exposure::default(),
        OrbitCamera::new(Vec3::Y, 20.0, 10.0, 5.0),
        DistanceFog {
            color: HORIZON,
            falloff: FogFalloff::Linear {
                start: 8.0,
                end: 45.0,
            },
            ..default()
        },
    ));
    match stage.0.detail {
        Detail::Full => {
            let sky = EnvironmentMapLight::hemispherical_gradient(
                &mut images,
                Color::srgb(0.80, 0.86, 0.95),
                Color::srgb(0.72, 0.72, 0.72),
                Color::srgb(0.34, 0.31, 0.28),
            );
            camera.insert((
                Tonemapping::TonyMcMapface,
                EnvironmentMapLight {
                    intensity: 1100.0,
                    ..sky
                },
            ));
        }
        // Its materials bring the light of the sky and the tones themselves, and there are no lamps.
        Detail::Low => {
            camera.insert((
                Tonemapping::None,
                DebandDither::Disabled,
                ClusterConfig::Single,
            ));
        }
    }
}

fn spawn_light(mut commands: Commands) {
    commands.spawn((
        Name::new("sun"),
        DirectionalLight {
            color: Color::srgb(1.0, 0.95, 0.88),
            illuminance: 9000.0,
            shadow_maps_enabled: true,
            shadow_depth_bias: 0.02,
            shadow_normal_bias: 1.2,
            ..default()
        },
        CascadeShadowConfigBuilder {
            num_cascades: 1,
            minimum_distance: 0.1,
            maximum_distance: 10.0,
            ..default()
        }
        .build(),
        Transform::from_xyz(-3.0, 5.0, 3.5).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

/// The ground that is seen is the ground that cloth lies on.
fn spawn_ground(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        Name::new("ground"),
        ClothCollider::half_space().with_friction(0.6),
        Mesh3d(
            meshes.add(
                Circle::new(RADIUS)
                    .mesh()
                    .resolution(64)
                    .build()
                    .rotated_by(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2)),
            ),
        ),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color: FLOOR,
            perceptual_roughness: 0.9,
            reflectance: 0.2,
            ..default()
        })),
    ));
}

/// A dome, darker towards the top, lighter at the horizon.
fn spawn_sky(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        Name::new("sky"),
        Mesh3d(meshes.add(dome())),
        MeshMaterial3d(materials.add(StandardMaterial {
            unlit: true,
            cull_mode: None,
            fog_enabled: false,
            ..default()
        })),
        NotShadowCaster,
    ));
}

/// The upper half of a sphere, and a little more, so that it reaches below the horizon.
fn dome() -> Mesh {
    const RINGS: u32 = 32;
    const SIDES: u32 = 48;
    const BELOW: f32 = 0.03;
    let mut positions = Vec::new();
    for ring in 0..=RINGS {
        let (sin, cos) = ((FRAC_PI_2 + BELOW) * ring as f32 / RINGS as f32 - BELOW).sin_cos();
        for side in 0..=SIDES {
            let around = Vec2::from_angle(TAU * side as f32 / SIDES as f32) * cos;
            positions.push([RADIUS * around.x, RADIUS * sin, RADIUS * around.y]);
        }
    }
    let colors: Vec<[f32; 4]> = positions.iter().map(sky_color).collect();
    let indices = (0..RINGS * (SIDES + 1))
        .filter(|first| first % (SIDES + 1) < SIDES)
        .flat_map(|a| {
            let (b, c) = (a + 1, a + SIDES + 1);
            [a, b, c, b, c + 1, c]
        });
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::RENDER_WORLD,
    )
    .with_inserted_attribute(
        Mesh::ATTRIBUTE_NORMAL,
        vec![[0.0, 1.0, 0.0]; positions.len()],
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors)
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_indices(Indices::U32(indices.collect()))
}

fn sky_color(position: &[f32; 3]) -> [f32; 4] {
    let height = (position[1] / RADIUS).clamp(0.0, 1.0);
    let part = (height * 2.2).min(1.0).powf(0.8);
    HORIZON
        .to_linear()
        .mix(&ZENITH.to_linear(), part)
        .to_f32_array()
}
