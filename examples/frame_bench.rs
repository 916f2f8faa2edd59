//! Cost of cloth in a whole frame: simulation, mesh, extraction, rendering.
//!
//! Frames are drawn to a small image, without a window. Each scene is measured with its meshes not written at all, written as assets,
//! and written to where the renderer keeps them, in turns.

use std::{
    fs,
    io::{self, Write},
    path::PathBuf,
    time::Duration,
};

use tailorbird::cloth::wall_clock::WallClock;

use bevy::{
    app::{AppLabel, PluginsState, TerminalCtrlCHandlerPlugin},
    camera::RenderTarget,
    log::LogPlugin,
    prelude::*,
    render::{
        RenderApp,
        pipelined_rendering::PipelinedRenderingPlugin,
        render_resource::{PollType, TextureFormat},
        renderer::RenderDevice,
    },
    time::TimeUpdateStrategy,
    window::ExitCondition,
    winit::WinitPlugin,
};
use clap::Parser;
use serde::Serialize;
use tailorbird::{mesh::ClothMeshSystems, prelude::*};

/// Measures frames with cloth
#[derive(Parser)]
#[command(name = "frame_bench", version)]
struct Args {
    /// Cloths and particles along each side, such as 100x32; 0x2 is what frames without cloth take [default: 0x2 1x256 1x128 10x64 100x32 1000x32]
    #[arg(value_name = "COUNTxSIZE", value_parser = scene)]
    scenes: Vec<[u32; 2]>,

    /// The camera looks elsewhere: nothing is drawn, but all meshes are written
    #[arg(long)]
    away: bool,

    /// Frames of each measurement
    #[arg(long, value_name = "N", default_value_t = 40, value_parser = clap::value_parser!(u32).range(3..))]
    frames: u32,

    /// Writes the figures to this file, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

fn scene(text: &str) -> Result<[u32; 2], String> {
    let numbers = text.split_once('x').and_then(|(count, size)| {
        let (count, size) = (count.parse().ok()?, size.parse().ok()?);
        ((0..=10_000).contains(&count) && (2..=1024).contains(&size)).then_some([count, size])
    });
    numbers.ok_or_else(|| "0 to 10000 cloths of 2 to 1024 particles a side, such as 100x32".into())
}

/// Treatment of the meshes.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Meshes {
    Nothing,
    Asset,
    Slab,
}

/// Parts of a frame [ms].
#[derive(Clone, Copy, Debug, Default, Serialize)]
struct Frame {
    simulate: f64,
    write: f64,
    /// All else of the main schedule.
    other: f64,
    extract: f64,
    render: f64,
}

impl Frame {
    fn parts(&self) -> [f64; 5] {
        [
            self.simulate,
            self.write,
            self.other,
            self.extract,
            self.render,
        ]
    }

    fn total(&self) -> f64 {
        self.parts().iter().sum()
    }
}

#[derive(Serialize)]
struct Record {
    cloths: u32,
    size: u32,
    writes: Meshes,
    /// Medians [ms].
    frame: Frame,
    /// Median of the whole frame [ms].
    total: f64,
    /// The part of it that is not simulation.
    outside_solver: f64,
    /// Time that the meshes add to a frame in which they are not written [ms].
    added: f64,
    /// Ratio of that to the sum of it and the simulation: a part of what the cloth costs, an empty frame of Bevy left out. None without cloth.
    outside_solver_of_cloth: Option<f64>,
}

/// Time in the frame's systems.
#[derive(Resource, Default)]
struct Clock {
    start: Option<WallClock>,
    simulate: Duration,
    write: Duration,
}

fn start(mut clock: ResMut<Clock>) {
    clock.start = Some(WallClock::start());
}

fn simulated(mut clock: ResMut<Clock>) {
    if let Some(start) = clock.start.take() {
        clock.simulate += start.elapsed();
    }
}

fn written(mut clock: ResMut<Clock>) {
    if let Some(start) = clock.start.take() {
        clock.write += start.elapsed();
    }
}

fn app([count, size]: [u32; 2], away: bool) -> App {
    let mut app = App::new();
    let plugins = DefaultPlugins
        .set(WindowPlugin {
            exit_condition: ExitCondition::DontExit,
            ..default()
        })
        .disable::<WinitPlugin>()
        .disable::<LogPlugin>()
        .disable::<TerminalCtrlCHandlerPlugin>()
        .disable::<PipelinedRenderingPlugin>();
    let fixed = Time::<Fixed>::from_hz(60.0);
    app.add_plugins((plugins, ClothPlugins::default()))
        .insert_resource(TimeUpdateStrategy::ManualDuration(fixed.timestep()))
        .insert_resource(fixed)
        .insert_resource(ClothWind::steady(Vec3::new(2.0, 0.0, 5.0)))
        .insert_resource(Meshes::Slab)
        .insert_resource(ClothMeshSettings {
            unseen: ClothUnseen::Write,
            ..ClothMeshSettings::default()
        })
        .init_resource::<Clock>()
        .configure_sets(
            PostUpdate,
            ClothMeshSystems.run_if(|write: Res<Meshes>| *write != Meshes::Nothing),
        )
        .add_systems(
            FixedPostUpdate,
            (
                start.before(ClothSystems::Prepare),
                simulated.after(ClothSystems::Writeback),
            ),
        )
        .add_systems(
            PostUpdate,
            (
                start
                    .after(TransformSystems::Propagate)
                    .before(ClothMeshSystems),
                written.after(ClothMeshSystems),
            ),
        );
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();

    let image = Image::new_target_texture(32, 32, TextureFormat::Rgba8UnormSrgb, None);
    let world = app.world_mut();
    let image = world.resource_mut::<Assets<Image>>().add(image);
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(Color::WHITE);
    let columns = count.isqrt().max(1);
    let far = 2.0 * columns as f32;
    let target = if away {
        2.0 * far * Vec3::Z + 10.0
    } else {
        Vec3::ZERO
    };
    world.spawn((
        Camera3d::default(),
        Msaa::Off,
        RenderTarget::from(image),
        Transform::from_xyz(0.0, 0.0, far + 2.0).looking_at(target, Vec3::Y),
    ));
    world.spawn((
        DirectionalLight::default(),
        Transform::from_xyz(1.0, 2.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    for k in 0..count {
        let place = UVec2::new(k % columns, k / columns).as_vec2() - 0.5 * columns as f32;
        world.spawn((
            Cloth::grid(Vec2::ONE, UVec2::splat(size)).centered(),
            ClothPins::edges([ClothEdge::Left]),
            ClothSleep::never(),
            MeshMaterial3d(material.clone()),
            Transform::from_translation((1.2 * place).extend(0.0)),
        ));
    }
    app
}

/// Runs a frame, and waits until it is drawn, which is not counted.
fn frame(app: &mut App) -> Frame {
    *app.world_mut().resource_mut::<Clock>() = Clock::default();
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    let begin = WallClock::start();
    app.main_mut().run_default_schedule();
    let main = begin.elapsed();
    let begin = WallClock::start();
    let all = app.sub_apps_mut();
    let mut extract = Duration::ZERO;
    if let Some(render) = all.sub_apps.get_mut(&RenderApp.intern()) {
        render.extract(all.main.world_mut());
        extract = begin.elapsed();
        render.update();
    }
    let render = begin.elapsed() - extract;
    app.world_mut().clear_trackers();
    if let Some(device) = app.world().get_resource::<RenderDevice>() {
        let _ = device.poll(PollType::wait_indefinitely());
    }
    let clock = app.world().resource::<Clock>();
    Frame {
        simulate: ms(clock.simulate),
        write: ms(clock.write),
        other: ms(main.saturating_sub(clock.simulate + clock.write)),
        extract: ms(extract),
        render: ms(render),
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

fn measure(scene: [u32; 2], away: bool, frames: u32) -> Vec<Record> {
    const TREATMENTS: [Meshes; 3] = [Meshes::Nothing, Meshes::Asset, Meshes::Slab];
    let mut app = app(scene, away);
    for _ in 0..20 {
        frame(&mut app);
    }
    let mut found = TREATMENTS.map(|_| Vec::new());
    for k in 0..3 * frames.div_ceil(3) {
        // In turns of a few frames, of which the first are not counted: others use this machine as well.
        let treatment = k as usize % TREATMENTS.len();
        app.insert_resource(TREATMENTS[treatment]);
        app.world_mut().resource_mut::<ClothMeshSettings>().write = match TREATMENTS[treatment] {
            Meshes::Asset => ClothMeshWrite::Asset,
            _ => ClothMeshWrite::Slab,
        };
        for _ in 0..3 {
            frame(&mut app);
        }
        found[treatment].extend((0..3).map(|_| frame(&mut app)));
    }
    let records = TREATMENTS.into_iter().zip(found).map(|(writes, frames)| {
        let part = |of: fn(&Frame) -> f64| median(frames.iter().map(of).collect());
        let total = part(Frame::total);
        Record {
            cloths: scene[0],
            size: scene[1],
            writes,
            frame: Frame {
                simulate: part(|frame| frame.simulate),
                write: part(|frame| frame.write),
                other: part(|frame| frame.other),
                extract: part(|frame| frame.extract),
                render: part(|frame| frame.render),
            },
            total,
            outside_solver: part(|frame| 1.0 - frame.simulate / frame.total()),
            added: 0.0,
            outside_solver_of_cloth: None,
        }
    });
    let mut records: Vec<Record> = records.collect();
    let still = records[0].total;
    for record in &mut records {
        record.added = record.total - still;
        let cloth = record.frame.simulate + record.added;
        record.outside_solver_of_cloth =
            (record.cloths > 0 && cloth > 0.0).then_some(record.added / cloth);
    }
    records
}

fn main() -> io::Result<()> {
    let args = Args::parse();
    let scenes = if args.scenes.is_empty() {
        vec![[0, 2], [1, 256], [1, 128], [10, 64], [100, 32], [1000, 32]]
    } else {
        args.scenes
    };
    let mut out = io::stdout().lock();
    writeln!(
        out,
        "ms, medians; outside: the part of the frame that is not simulation; adds: to a frame whose meshes are not written; of cloth: the part of \
         simulation and that"
    )?;
    writeln!(
        out,
        "cloths  size  mesh      simulate   write   other  extract  render   total  outside    adds  of cloth"
    )?;
    let mut all = Vec::new();
    for scene in scenes {
        let records = measure(scene, args.away, args.frames);
        for record in &records {
            let [simulate, write, other, extract, render] = record.frame.parts();
            writeln!(
                out,
                "{:>6} {:>4}²  {:<8} {simulate:>9.3} {write:>7.3} {other:>7.3} {extract:>8.3} {render:>7.3} {:>7.3} {:>7.0} % {:>7.3} {:>9}",
                record.cloths,
                record.size,
                format!("{:?}", record.writes).to_lowercase(),
                record.total,
                100.0 * record.outside_solver,
                record.added,
                record
                    .outside_solver_of_cloth
                    .map_or_else(String::new, |part| format!("{:.0} %", 100.0 * part)),
            )?;
        }
        all.extend(records);
    }
    if let Some(path) = args.json {
        fs::write(
            path,
            serde_json::to_string_pretty(&all).map_err(io::Error::other)?,
        )?;
    }
    Ok(())
}
