//! Pictures without a window: a scene is played by a script, in simulated time, and drawn to PNG files.

use std::{
    fmt, fs,
    path::{Path, PathBuf},
    thread,
    time::Duration,
};

use bevy::{
    app::PluginsState,
    camera::{ImageRenderTarget, NormalizedRenderTarget, RenderTarget},
    pbr::wireframe::WireframePlugin,
    prelude::*,
    render::{
        RenderPlugin,
        pipelined_rendering::PipelinedRenderingPlugin,
        render_resource::TextureFormat,
        view::screenshot::{Screenshot, ScreenshotCaptured},
    },
    time::TimeUpdateStrategy,
    window::{ExitCondition, WindowResolution},
    winit::WinitPlugin,
};
use image::RgbImage;
use tailorbird::fabric::ClothFabricLibrary;

use super::{
    actor::Actor, apply::DemoPlugin, garment, graphics::check_driver, script::Script,
    settings::DemoSettings, stage::StagePlugin,
};

/// A picture to draw, and its file.
#[derive(Clone, Debug)]
pub struct OffscreenOptions {
    /// The folder; it is made if it does not exist.
    pub dir: PathBuf,
    /// Duration that is played [s].
    pub seconds: f32,
    /// The time between two pictures [s].
    pub every: f32,
    /// Width and height [pixels].
    pub size: UVec2,
    /// Smooth edges, even without a graphics card, where that takes long.
    pub fine: bool,
    /// The scene, and how.
    pub settings: DemoSettings,
    /// Events on the way.
    pub script: Script,
}

/// Why there are no pictures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OffscreenError {
    /// Nothing to draw with.
    NoDriver(String),
    /// A file or folder cannot be written.
    Write(String),
    /// The renderer gave fewer pictures than it was asked for.
    Missing(usize),
}

impl fmt::Display for OffscreenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoDriver(why) | Self::Write(why) => f.write_str(why),
            Self::Missing(count) => write!(f, "{count} pictures were not drawn"),
        }
    }
}

impl std::error::Error for OffscreenError {}

/// Plays a scene and saves its pictures; returns their paths in order.
///
/// # Errors
/// When there is no graphics driver, or the pictures cannot be written.
pub fn draw(options: &OffscreenOptions) -> Result<Vec<PathBuf>, OffscreenError> {
    check_driver().map_err(OffscreenError::NoDriver)?;
    fs::create_dir_all(&options.dir)
        .map_err(|error| OffscreenError::Write(format!("{}: {error}", options.dir.display())))?;
    let mut stage = Offscreen::new(options);
    let frames_between = (options.every * Offscreen::FRAME_RATE).ceil().max(1.0) as u32;
    let frame = options.every / frames_between as f32;
    let pictures = (options.seconds / options.every).floor().max(0.0) as u32 + 1;
    for picture in 0..pictures {
        let name = format!("{}_{picture:04}.png", options.settings.scene);
        stage.take_picture(&options.dir.join(name), frame);
        for _ in 1..frames_between {
            stage.play(frame);
        }
    }
    stage.finish()
}

/// An app without a window that draws to an image.
pub struct Offscreen {
    /// The app.
    pub app: App,
    actor: Actor,
    image: Handle<Image>,
    time: f32,
    asked: usize,
}

/// The pictures that came, and the errors.
#[derive(Resource, Default)]
struct Album {
    saved: Vec<PathBuf>,
    /// With the number that each one was asked for as.
    kept: Vec<(usize, RgbImage)>,
    errors: Vec<String>,
}

impl Album {
    fn count(&self) -> usize {
        self.saved.len() + self.kept.len() + self.errors.len()
    }
}

impl Offscreen {
    /// Frames per simulated second.
    const FRAME_RATE: f32 = 30.0;

    /// Builds the app, and lets the scene settle in for a few steps.
    pub fn new(options: &OffscreenOptions) -> Self {
        let mut app = App::new();
        app.add_plugins((
            plugins(options.size),
            super::cloth_plugins(),
            WireframePlugin::default(),
        ));
        let UVec2 { x, y } = options.size;
        let image = Image::new_target_texture(x, y, TextureFormat::Rgba8UnormSrgb, None);
        let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        let target = ImageRenderTarget {
            handle: image.clone(),
            scale_factor: 1.0,
        };
        app.add_plugins(DemoPlugin {
            settings: options.settings.clone(),
            stage: StagePlugin {
                target: RenderTarget::Image(target.clone()),
                fine: options.fine,
                ..default()
            },
        })
        .init_resource::<Album>();
        complete(&mut app);

        let target = NormalizedRenderTarget::Image(target);
        let mut offscreen = Self {
            app,
            actor: Actor::new(options.script.clone(), target, options.size),
            image,
            time: 0.0,
            asked: 0,
        };
        for _ in 0..3 {
            offscreen.update(1.0 / 60.0, true);
        }
        for _ in 0..1000 {
            if offscreen
                .app
                .world()
                .resource::<ClothFabricLibrary>()
                .is_ready()
            {
                break;
            }
            thread::sleep(Duration::from_millis(10));
            offscreen.update(0.0, false);
        }
        offscreen
    }

    /// Goes on by a frame [s].
    pub fn play(&mut self, seconds: f32) {
        self.actor.act(self.app.world_mut(), self.time, seconds);
        // Two frames ahead: what the pointer can touch is what was visible in the frame before.
        let looks = self.actor.touches(self.time, 3.0 * seconds);
        self.update(seconds, looks);
        self.time += seconds;
    }

    /// Goes on by a frame [s], and saves the picture of it.
    pub fn take_picture(&mut self, path: &Path, seconds: f32) {
        let path = path.to_owned();
        self.capture(seconds, move |album, picture| match picture.save(&path) {
            Ok(()) => album.saved.push(path.clone()),
            Err(error) => album.errors.push(format!("{}: {error}", path.display())),
        });
    }

    /// Goes on by a frame [s], and keeps the picture of it for [`Self::finish_kept`].
    pub fn keep_picture(&mut self, seconds: f32) {
        let number = self.asked;
        self.capture(seconds, move |album, picture| {
            album.kept.push((number, picture));
        });
    }

    /// Goes on by a frame [s]; its picture comes to the album some frames later.
    fn capture(
        &mut self,
        seconds: f32,
        put: impl Fn(&mut Album, RgbImage) + Send + Sync + 'static,
    ) {
        self.actor.act(self.app.world_mut(), self.time, seconds);
        self.asked += 1;
        self.app
            .world_mut()
            .spawn(Screenshot::image(self.image.clone()))
            .observe(
                move |captured: On<ScreenshotCaptured>, mut album: ResMut<Album>| match captured
                    .image
                    .clone()
                    .try_into_dynamic()
                {
                    Ok(picture) => put(&mut album, picture.to_rgb8()),
                    Err(error) => album.errors.push(error.to_string()),
                },
            );
        self.update(seconds, true);
        self.time += seconds;
    }

    /// Waits for the last pictures, and says where they were saved.
    ///
    /// # Errors
    /// When one of them cannot be written, or does not come.
    pub fn finish(self) -> Result<Vec<PathBuf>, OffscreenError> {
        let mut saved = self.wait()?.saved;
        saved.sort();
        Ok(saved)
    }

    /// Waits for the last pictures, and returns those that were kept, in order.
    ///
    /// # Errors
    /// When one of them does not come.
    pub fn finish_kept(self) -> Result<Vec<RgbImage>, OffscreenError> {
        let mut kept = self.wait()?.kept;
        kept.sort_by_key(|(number, _)| *number);
        Ok(kept.into_iter().map(|(_, picture)| picture).collect())
    }

    fn wait(mut self) -> Result<Album, OffscreenError> {
        for _ in 0..200 {
            if self.app.world().resource::<Album>().count() >= self.asked {
                break;
            }
            thread::sleep(Duration::from_millis(10));
            self.update(0.0, false);
        }
        let Some(album) = self.app.world_mut().remove_resource::<Album>() else {
            return Err(OffscreenError::Missing(self.asked));
        };
        let missing = self.asked - album.count();
        match album.errors.first() {
            Some(error) => Err(OffscreenError::Write(error.clone())),
            None if missing > 0 => Err(OffscreenError::Missing(missing)),
            None => Ok(album),
        }
    }

    /// One frame. A camera that does not look draws nothing, which is what takes the time.
    fn update(&mut self, seconds: f32, looks: bool) {
        let world = self.app.world_mut();
        world.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(
            seconds,
        )));
        let mut cameras = world.query::<&mut Camera>();
        for mut camera in cameras.iter_mut(world) {
            camera.is_active = looks;
        }
        self.app.update();
    }
}

/// Bevy without a window. The window that it is told of is never opened: pointers want one to belong to.
pub fn plugins(size: UVec2) -> bevy::app::PluginGroupBuilder {
    DefaultPlugins
        .set(WindowPlugin {
            primary_window: Some(Window {
                resolution: WindowResolution::new(size.x, size.y),
                ..default()
            }),
            exit_condition: ExitCondition::DontExit,
            ..default()
        })
        .set(RenderPlugin {
            synchronous_pipeline_compilation: true,
            ..default()
        })
        .set(garment::gltf())
        .disable::<WinitPlugin>()
        .disable::<PipelinedRenderingPlugin>()
}

/// Completes the app as a runner does before its first frame.
pub fn complete(app: &mut App) {
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
}
