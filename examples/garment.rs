//! A skirt from a glTF file (`assets/garments/skirt.gltf`, made by `cargo xtask garment`): a waistband of denim and panels of cotton
//! are two meshes with materials of their own and become one cloth, held by what is painted on it (`_CLOTH_PIN`).
//!
//! Drag it with the left mouse button, turn the camera with the right one; the arrow keys, Page Up and Page Down move the figure
//! under it. `--offscreen DIR` draws a picture to DIR instead of opening a window.

mod common;

use std::{path::PathBuf, process::ExitCode, thread, time::Duration};

use bevy::{
    camera::{ImageRenderTarget, RenderTarget},
    gltf::GltfPlugin,
    prelude::*,
    render::{
        render_resource::TextureFormat,
        view::screenshot::{Screenshot, ScreenshotCaptured},
    },
    time::TimeUpdateStrategy,
};
use clap::Parser;
use common::{
    camera::OrbitCamera,
    graphics::check_driver,
    offscreen::{complete, plugins, save},
    stage::StagePlugin,
    window::ExitAfterFrames,
};
use tailorbird::prelude::*;

/// A skirt from a glTF file on a figure that moves.
#[derive(Parser)]
struct Arguments {
    /// Draws a picture to this folder instead of a window
    #[arg(long, value_name = "DIR")]
    offscreen: Option<PathBuf>,
    /// With --offscreen: how much is played before [s]
    #[arg(long, default_value = "3")]
    seconds: f32,
    /// With --offscreen: smooth edges, even without a graphics card, where they take long
    #[arg(long)]
    fine: bool,
}

/// What the picture is drawn to, and what came of it.
#[derive(Resource, Default)]
struct Picture(Option<Result<(), String>>);

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let result = check_driver().and_then(|()| match &arguments.offscreen {
        Some(dir) => draw(dir.join("garment.png"), &arguments),
        None => {
            play();
            Ok(())
        }
    });
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("garment: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Tells Bevy what `_CLOTH_PIN` is, which it knows without the first underscore.
fn gltf() -> GltfPlugin {
    GltfPlugin::default().add_custom_vertex_attribute("CLOTH_PIN", ATTRIBUTE_CLOTH_PIN)
}

fn add_scene(app: &mut App, stage: StagePlugin) {
    app.add_plugins((ClothPlugins::default(), stage))
        .add_systems(Startup, dress)
        .add_systems(PostStartup, look);
}

/// Opens the window.
fn play() {
    let mut app = App::new();
    app.add_plugins((DefaultPlugins.set(gltf()), ExitAfterFrames));
    add_scene(&mut app, StagePlugin::default());
    app.run();
}

/// Plays some time without a window, and saves a picture of what is there then.
fn draw(path: PathBuf, arguments: &Arguments) -> Result<(), String> {
    const FRAME: Duration = Duration::from_nanos(1_000_000_000 / 60);
    let size = UVec2::new(1280, 720);
    let mut app = App::new();
    app.add_plugins(plugins(size).set(gltf()));
    let target = Image::new_target_texture(size.x, size.y, TextureFormat::Rgba8UnormSrgb, None);
    let image = app.world_mut().resource_mut::<Assets<Image>>().add(target);
    let target = RenderTarget::Image(ImageRenderTarget {
        handle: image.clone(),
        scale_factor: 1.0,
    });
    let fine = arguments.fine;
    add_scene(&mut app, StagePlugin { target, fine });
    app.init_resource::<Picture>()
        .insert_resource(TimeUpdateStrategy::ManualDuration(FRAME));
    complete(&mut app);
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|error| error.to_string())?;
    }

    let looks = |app: &mut App, looks: bool| {
        let world = app.world_mut();
        let mut cameras = world.query::<&mut Camera>();
        cameras
            .iter_mut(world)
            .for_each(|mut camera| camera.is_active = looks);
        app.update();
    };
    for _ in 0..1000 {
        looks(&mut app, false);
        let world = app.world_mut();
        if world
            .query::<&ClothNormals>()
            .iter(world)
            .any(|normals| !normals.is_empty())
        {
            break;
        }
        thread::sleep(Duration::from_millis(10));
    }
    for _ in 0..(arguments.seconds / FRAME.as_secs_f32()) as u32 {
        looks(&mut app, false);
    }
    // Pipelines and textures are made when something looks at them.
    for _ in 0..5 {
        looks(&mut app, true);
    }
    app.world_mut().spawn(Screenshot::image(image)).observe(
        move |captured: On<ScreenshotCaptured>, mut picture: ResMut<Picture>| {
            picture.0 = Some(save(&captured.image, &path));
        },
    );
    for _ in 0..200 {
        looks(&mut app, true);
        if let Some(result) = app.world_mut().resource_mut::<Picture>().0.take() {
            return result;
        }
    }
    Err("the picture did not come".into())
}

/// The skirt on a figure of balls that the keys move.
fn dress(
    mut commands: Commands,
    server: Res<AssetServer>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let wood = MeshMaterial3d(materials.add(StandardMaterial {
        base_color: Color::srgb(0.74, 0.66, 0.54),
        perceptual_roughness: 0.6,
        ..default()
    }));
    let mut ball = |radius: f32, place: Vec3| {
        (
            ClothCollider::sphere(radius).with_friction(0.3),
            Mesh3d(meshes.add(Sphere::new(radius - 0.004).mesh().uv(48, 24))),
            wood.clone(),
            Transform::from_translation(place),
        )
    };
    let scene = GltfAssetLabel::Scene(0).from_asset("garments/skirt.gltf");
    commands
        .spawn((
            Name::new("figure"),
            SphereControls::default(),
            Transform::from_xyz(0.0, 0.1, 0.0),
            Visibility::default(),
        ))
        .with_children(|figure| {
            figure.spawn(ball(0.115, Vec3::new(0.0, 1.12, 0.0)));
            figure.spawn(ball(0.155, Vec3::new(0.0, 0.88, 0.0)));
            for z in [-0.1, 0.1] {
                figure.spawn(ball(0.09, Vec3::new(0.0, 0.72, z)));
                figure.spawn(ball(0.075, Vec3::new(0.0, 0.58, z)));
                figure.spawn(ball(0.065, Vec3::new(0.0, 0.45, z)));
            }
            figure.spawn((
                WorldAssetRoot(server.load(scene)),
                ClothFromMesh::default().with_pins(MeshPins::attribute()),
                ClothMaterial::cotton(),
            ));
        });
}

fn look(mut camera: Single<&mut OrbitCamera>) {
    **camera = OrbitCamera::new(Vec3::new(0.0, 0.82, 0.0), 55.0, 8.0, 1.7);
}
