//! An app that renders to an image, without a window, at the pace of the test.

use std::{
    env, fs,
    io::Write,
    path::PathBuf,
    sync::{Arc, Mutex, MutexGuard, Once, OnceLock, PoisonError},
    time::Duration,
};

use bevy::{
    app::{PluginGroupBuilder, TerminalCtrlCHandlerPlugin},
    camera::{NormalizedRenderTarget, RenderTarget},
    image::TextureFormatPixelInfo,
    log::{Level, LogPlugin},
    picking::pointer::{Location, PointerAction, PointerId, PointerInput},
    prelude::*,
    render::{
        RenderPlugin,
        pipelined_rendering::PipelinedRenderingPlugin,
        render_resource::{PollType, TextureFormat},
        renderer::{RenderDevice, RenderInstance},
        settings::{Backends, WgpuSettings},
        view::screenshot::{Screenshot, ScreenshotCaptured},
    },
    tasks::block_on,
    time::TimeUpdateStrategy,
    window::ExitCondition,
    winit::WinitPlugin,
};
use tailorbird::prelude::*;

/// Time from one frame to the next.
pub const FRAME: Duration = Duration::from_nanos(1_000_000_000 / 60);

/// Returns whether there is something to render with. Without, says which test is skipped, or fails when
/// `TAILORBIRD_REQUIRE_GPU` is set.
pub fn graphics(test: &str) -> bool {
    if has_adapter() {
        return true;
    }
    let line = format!("skipped: {test}: no graphics driver (install mesa-vulkan-drivers)");
    assert!(env::var_os("TAILORBIRD_REQUIRE_GPU").is_none(), "{line}");
    println!("{line}");
    if let Some(path) = env::var_os("TAILORBIRD_SKIP_LOG") {
        let mut file = fs::OpenOptions::new()
            .create(true)
            .append(true)
            .open(&path)
            .expect("TAILORBIRD_SKIP_LOG names a file that can be written");
        writeln!(file, "{line}").expect("TAILORBIRD_SKIP_LOG can be written");
    }
    false
}

/// Looks for what Bevy would render with: it would panic for want of it. OpenGL alone does not count.
fn has_adapter() -> bool {
    static FOUND: OnceLock<bool> = OnceLock::new();
    *FOUND.get_or_init(|| {
        // The only way to the instance's type without depending on wgpu.
        let instance = RenderInstance::new(Default::default());
        !block_on(instance.enumerate_adapters(Backends::PRIMARY)).is_empty()
    })
}

/// The app, the image that it renders to, and the right to be the only one.
pub struct Offscreen {
    pub app: App,
    target: Handle<Image>,
    _alone: MutexGuard<'static, ()>,
}

/// Waits until no other test renders: two renderers at a time in one process are slow, and not what is tested.
pub fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    // A test that failed must not fail the others.
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Offscreen {
    /// An app with `DefaultPlugins` and `ClothPlugins`, without a camera. `None` where the test is to be skipped.
    pub fn new(test: &str, size: UVec2) -> Option<Self> {
        Self::with_plugins(test, size, |plugins| {
            plugins.disable::<PipelinedRenderingPlugin>()
        })
    }

    /// [`Self::new`] with other default plugins.
    pub fn with_plugins(
        test: &str,
        size: UVec2,
        change: impl FnOnce(PluginGroupBuilder) -> PluginGroupBuilder,
    ) -> Option<Self> {
        static LOG: Once = Once::new();
        if !graphics(test) {
            return None;
        }
        let alone = alone();

        let mut plugins = DefaultPlugins
            .set(RenderPlugin {
                render_creation: WgpuSettings {
                    backends: Some(Backends::PRIMARY),
                    ..default()
                }
                .into(),
                synchronous_pipeline_compilation: true,
                ..default()
            })
            // Picking asks for a primary window, even where no pointer is on it.
            .set(WindowPlugin {
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            .disable::<WinitPlugin>()
            .disable::<TerminalCtrlCHandlerPlugin>()
            .disable::<LogPlugin>();
        LOG.call_once(|| {
            plugins =
                std::mem::replace(&mut plugins, PluginGroupBuilder::start::<DefaultPlugins>())
                    .enable::<LogPlugin>()
                    .set(LogPlugin {
                        level: Level::WARN,
                        ..default()
                    });
        });
        let mut app = App::new();
        app.add_plugins(change(plugins))
            .add_plugins((
                ClothPlugins::default(),
                ClothDragPlugin,
                ClothSphereControlsPlugin,
            ))
            .insert_resource(TimeUpdateStrategy::ManualDuration(FRAME));
        app.finish();
        app.cleanup();
        let image = Image::new_target_texture(size.x, size.y, TextureFormat::Rgba8UnormSrgb, None);
        let target = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        Some(Self {
            app,
            target,
            _alone: alone,
        })
    }

    /// Target of a camera that is to be in the picture.
    pub fn target(&self) -> RenderTarget {
        self.target.clone().into()
    }

    /// Runs frames, and waits for the renderer after each.
    pub fn update(&mut self, frames: usize) {
        for _ in 0..frames {
            self.app.update();
            assert_eq!(
                self.app.should_exit(),
                None,
                "the renderer gave up: see the log"
            );
            let device = self.app.world().resource::<RenderDevice>().clone();
            device
                .poll(PollType::wait_indefinitely())
                .expect("the device answers");
        }
    }

    /// The picture in the target, while time stands still.
    pub fn picture(&mut self) -> Image {
        let strategy = TimeUpdateStrategy::ManualDuration(Duration::ZERO);
        let running = std::mem::replace(&mut *self.app.world_mut().resource_mut(), strategy);
        let picture = self.picture_in_motion();
        self.app.insert_resource(running);
        picture
    }

    /// The picture in the target, while time goes on.
    pub fn picture_in_motion(&mut self) -> Image {
        let picture: Arc<Mutex<Option<Image>>> = Arc::default();
        let sender = picture.clone();
        self.app
            .world_mut()
            .spawn(Screenshot::image(self.target.clone()))
            .observe(move |captured: On<ScreenshotCaptured>| {
                *sender.lock().expect("not poisoned") = Some(captured.image.clone());
            });
        for _ in 0..100 {
            self.update(1);
            if let Some(picture) = picture.lock().expect("not poisoned").take() {
                return picture;
            }
        }
        panic!("no picture after 100 frames");
    }

    /// Moves the mouse to a place on the target [pixels].
    pub fn point(&mut self, position: Vec2) {
        self.pointer(position, PointerAction::Move { delta: Vec2::ZERO });
    }

    /// Does something with the mouse at a place on the target [pixels].
    pub fn pointer(&mut self, position: Vec2, action: PointerAction) {
        let location = Location {
            target: NormalizedRenderTarget::Image(self.target.clone().into()),
            position,
        };
        self.app
            .world_mut()
            .write_message(PointerInput::new(PointerId::Mouse, location, action));
    }
}

/// Writes a picture to the folder named by `TAILORBIRD_PICTURES`, to look at.
pub fn keep(picture: &Image, name: &str) {
    if let Some(folder) = env::var_os("TAILORBIRD_PICTURES") {
        let path = PathBuf::from(folder).join(name).with_extension("png");
        let picture = picture
            .clone()
            .try_into_dynamic()
            .expect("a format that PNG has");
        picture
            .to_rgb8()
            .save(&path)
            .expect("TAILORBIRD_PICTURES can be written");
    }
}

/// Colour of a pixel of a picture, as stored, 0 to 255.
pub fn pixel(picture: &Image, at: UVec2) -> [u8; 4] {
    let bytes = picture
        .pixel_bytes(at.extend(0))
        .expect("inside the picture");
    assert_eq!(picture.texture_descriptor.format.pixel_size().ok(), Some(4));
    [bytes[0], bytes[1], bytes[2], bytes[3]]
}

/// The part of the pixels that differ by more than `threshold` in any channel, 0 to 1.
pub fn difference(a: &Image, b: &Image, threshold: u8) -> f32 {
    let (a, b) = (
        a.data.as_ref().expect("read"),
        b.data.as_ref().expect("read"),
    );
    assert_eq!(a.len(), b.len());
    let differ =
        |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > threshold);
    let pixels = a.len() / 4;
    a.chunks_exact(4)
        .zip(b.chunks_exact(4))
        .filter(differ)
        .count() as f32
        / pixels as f32
}
