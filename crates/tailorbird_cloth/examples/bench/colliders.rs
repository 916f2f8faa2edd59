//! Cost of each shape that a sheet lies on.

use std::{
    f32::consts::{FRAC_PI_2, PI, TAU},
    time::Duration,
};

use tailorbird_cloth::wall_clock::WallClock;

use bevy_app::{App, FixedPostUpdate, TaskPoolPlugin};
use bevy_ecs::prelude::*;
use bevy_math::{Isometry3d, Quat, UVec2, Vec2, Vec3};
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;
use serde::Serialize;
use tailorbird_cloth::prelude::*;

use super::cli::Args;

/// One measurement, as it is written.
#[derive(Serialize, Clone, Debug)]
pub struct Record {
    shape: &'static str,
    /// Particles along a side.
    size: u32,
    /// Of both stages of a substep, above those of a sheet without colliders.
    ns_per_particle_substep: f64,
    /// Of all other stages of a substep.
    solve_ns_per_particle_substep: f64,
    /// The part of the particles that lie on it.
    in_contact: f64,
}

/// Time that the stages of substeps took.
#[derive(Resource, Default)]
struct Clock {
    start: Option<WallClock>,
    collide: Duration,
    others: Duration,
    substeps: u32,
}

impl Clock {
    fn lap(&mut self) -> Duration {
        let lap = self.start.map_or(Duration::ZERO, |start| start.elapsed());
        self.start = Some(WallClock::start());
        lap
    }
}

/// Steps before the measurement: the sheet lies on the shape.
const SETTLE: u32 = 90;

/// Measures and prints.
pub fn run(args: &Args) -> Vec<Record> {
    let size = args.size.unwrap_or(128);
    let steps = args.steps.unwrap_or(60);
    let mut records = Vec::new();
    println!("{size}²: ns per particle and substep, of colliders and of all else");
    let (nothing, _) = measure(size, steps, &[]);
    let meant = |name: &str| args.shape.as_ref().is_none_or(|part| name.contains(part));
    for (shape, size, colliders) in shapes(size).into_iter().filter(|s| meant(s.0)) {
        let none = if size == 64 {
            measure(size, steps, &[]).0
        } else {
            nothing
        };
        let (collide, others) = measure(size, steps, &colliders);
        let record = Record {
            shape,
            size,
            ns_per_particle_substep: (collide - none).max(0.0),
            solve_ns_per_particle_substep: others,
            in_contact: touching(size, &colliders),
        };
        println!(
            "{shape:<24} {size:>4}² {:>8.2} {:>8.2}   {:.0} % in contact",
            record.ns_per_particle_substep,
            others,
            100.0 * record.in_contact
        );
        records.push(record);
    }
    records
}

type Placed = (ClothCollider, Transform);

/// Things to lie on, at about the same height below the sheet.
fn shapes(size: u32) -> Vec<(&'static str, u32, Vec<Placed>)> {
    let at = |y: f32| Transform::from_xyz(0.0, y, 0.0);
    let lying = |y: f32| at(y).with_rotation(Quat::from_rotation_z(FRAC_PI_2));
    let one = |collider: ClothCollider, at: Transform| vec![(collider, at)];
    let ball = |n: u32| ClothCollider::from(ball(0.7, n));
    let many = (0..1000).map(|k| {
        let place = Vec3::new((k % 32) as f32 - 15.5, -0.1, (k / 32) as f32 - 15.5);
        (
            ClothCollider::sphere(0.1),
            Transform::from_translation(0.5 * place),
        )
    });
    let points: Vec<Vec3> = (0..200)
        .map(|k| {
            let y = 1.0 - (k as f32 + 0.5) / 100.0;
            let (s, c) = (2.4 * k as f32).sin_cos();
            0.7 * Vec3::new(c * (1.0 - y * y).sqrt(), y, s * (1.0 - y * y).sqrt())
        })
        .collect();
    let hull = ClothCollider::convex_hull(&points).ok();
    let heights: Vec<f32> = (0..101 * 101)
        .map(|k| 0.1 * (0.2 * (k % 101) as f32).sin() * (0.2 * (k / 101) as f32).cos())
        .collect();
    let terrain = ClothCollider::height_field(heights, 101, Vec2::splat(4.0)).ok();
    let part = |x: f32| {
        let at = Isometry3d::new(Vec3::X * x, Quat::IDENTITY);
        (at, ClothColliderShape::Sphere { radius: 0.5 })
    };
    let compound = ClothCollider::compound([part(-0.5), part(0.0), part(0.5)]).ok();
    let mut list = vec![
        ("sphere", size, one(ClothCollider::sphere(0.7), at(-0.72))),
        (
            "capsule",
            size,
            one(ClothCollider::capsule(0.5, 1.2), lying(-0.52)),
        ),
        (
            "tapered capsule",
            size,
            one(ClothCollider::tapered_capsule(0.5, 0.4, 1.2), lying(-0.52)),
        ),
        (
            "half-space",
            size,
            one(ClothCollider::half_space(), at(-0.1)),
        ),
        (
            "cuboid",
            size,
            one(ClothCollider::cuboid(1.5, 0.4, 1.5), at(-0.22)),
        ),
        (
            "cylinder",
            size,
            one(ClothCollider::cylinder(0.7, 0.4), at(-0.22)),
        ),
        ("triangle mesh, 10,000", size, one(ball(50), at(-0.72))),
        ("triangle mesh, 10,000", 64, one(ball(50), at(-0.72))),
        ("1,000 spheres", size, many.collect()),
    ];
    let made = [
        ("convex hull, 200 points", hull, -0.72),
        ("height field", terrain, -0.2),
        ("compound of 3 spheres", compound, -0.52),
    ];
    list.extend(made.into_iter().filter_map(|(name, collider, y)| {
        let collider = collider?;
        Some((name, size, one(collider, at(y))))
    }));
    list
}

/// A ball of 4 `n`² triangles, about.
fn ball(radius: f32, n: u32) -> ClothColliderShape {
    let point = |i: u32, j: u32| {
        let (s, c) = (TAU * i as f32 / (2 * n) as f32).sin_cos();
        let (height, y) = (PI * j as f32 / n as f32).sin_cos();
        radius * Vec3::new(height * c, y, height * s)
    };
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for j in 0..=n {
        positions.extend((0..2 * n).map(|i| point(i, j)));
    }
    for j in 0..n {
        for i in 0..2 * n {
            let next = (i + 1) % (2 * n);
            let [a, b] = [j * 2 * n + i, j * 2 * n + next];
            let [c, d] = [a + 2 * n, b + 2 * n];
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    tailorbird_cloth::collider::TriMesh::new(positions, triangles).map_or(
        ClothColliderShape::Sphere { radius },
        ClothColliderShape::TriMesh,
    )
}

fn app(size: u32, colliders: &[Placed]) -> (App, Entity) {
    let mut app = App::new();
    app.add_plugins((
        TaskPoolPlugin::default(),
        TimePlugin,
        ClothPlugin::default(),
    ));
    let fixed = Time::<Fixed>::from_hz(60.0);
    let timestep = fixed.timestep();
    app.insert_resource(fixed)
        .insert_resource(TimeUpdateStrategy::ManualDuration(timestep))
        .insert_resource(ClothWind::vacuum())
        .init_resource::<Clock>()
        .add_systems(
            ClothSubstep,
            (
                others
                    .after(ClothSubstepSystems::Integrate)
                    .before(ClothSubstepSystems::Approach),
                collide
                    .after(ClothSubstepSystems::Approach)
                    .before(ClothSubstepSystems::Solve),
                others
                    .after(ClothSubstepSystems::Solve)
                    .before(ClothSubstepSystems::Collide),
                end.after(ClothSubstepSystems::Collide),
            ),
        );
    for (collider, at) in colliders {
        app.world_mut().spawn((collider.clone(), *at));
    }
    let flat = Transform::from_rotation(Quat::from_rotation_x(-FRAC_PI_2));
    let cloth = Cloth::grid(Vec2::splat(2.0), UVec2::splat(size)).centered();
    let sheet = app
        .world_mut()
        .spawn((cloth, ClothSleep::never(), flat))
        .id();
    app.finish();
    app.cleanup();
    app.world_mut().run_schedule(FixedPostUpdate);
    app.update();
    (app, sheet)
}

fn others(mut clock: ResMut<Clock>) {
    let lap = clock.lap();
    clock.others += lap;
}

fn collide(mut clock: ResMut<Clock>) {
    let lap = clock.lap();
    clock.collide += lap;
}

fn end(mut clock: ResMut<Clock>) {
    let lap = clock.lap();
    clock.collide += lap;
    clock.substeps += 1;
}

/// ns per particle and substep: of the stages that collide, and of the others.
fn measure(size: u32, steps: u32, colliders: &[Placed]) -> (f64, f64) {
    let (mut app, _) = app(size, colliders);
    for _ in 0..SETTLE {
        app.update();
    }
    // The best of several stretches: others use this machine as well.
    let mut best = (f64::MAX, f64::MAX);
    let stretch = steps.div_ceil(6);
    for _ in 0..6 {
        let (mut collide, mut others) = (Duration::ZERO, Duration::ZERO);
        let mut substeps = 0;
        for _ in 0..stretch {
            *app.world_mut().resource_mut::<Clock>() = Clock::default();
            app.update();
            let clock = app.world().resource::<Clock>();
            collide += clock.collide;
            others += clock.others;
            substeps += clock.substeps;
        }
        let count = f64::from(substeps.max(1)) * f64::from(size) * f64::from(size);
        let ns = |time: Duration| time.as_secs_f64() * 1e9 / count;
        best = (best.0.min(ns(collide)), best.1.min(ns(others)));
    }
    best
}

/// The part of the particles that would be moved by 5 mm more of margin.
fn touching(size: u32, colliders: &[Placed]) -> f64 {
    let (mut app, sheet) = app(size, colliders);
    for _ in 0..SETTLE {
        app.update();
    }
    let places = |app: &App| -> Vec<Vec3> {
        let particles = app.world().get::<ClothParticles>(sheet);
        particles.map_or(Vec::new(), |p| p.positions().collect())
    };
    let before = places(&app);
    let mut all = app.world_mut().query::<&mut ClothCollider>();
    for mut collider in all.iter_mut(app.world_mut()) {
        collider.margin += 0.005;
    }
    app.update();
    let now = places(&app);
    let moved = before
        .iter()
        .zip(&now)
        .filter(|(a, b)| a.distance(**b) > 0.0035);
    moved.count() as f64 / before.len().max(1) as f64
}
