//! Drawn cloth moves without stutter, and textures do not swim on it.

use std::time::Duration;

use bevy::{mesh::VertexAttributeValues, prelude::*, time::TimeUpdateStrategy};
use tailorbird::prelude::*;

use crate::game::*;

const DISPLAY: f64 = 144.0;
const SIDE: u32 = 17;

/// A curtain that swings.
fn swinging(app: &mut App, shading: ClothShading) -> Entity {
    let cloth = app
        .world_mut()
        .spawn((
            Cloth::grid(Vec2::ONE, UVec2::splat(SIDE)),
            ClothMaterial::cotton(),
            ClothPins::edges([ClothEdge::Top]),
            ClothSleep::never(),
            shading,
            Transform::from_rotation(Quat::from_rotation_x(-1.2)),
        ))
        .id();
    app.insert_resource(ClothWind::steady(Vec3::new(1.0, 0.0, 2.0)));
    frames(app, 20);
    cloth
}

fn display(app: &mut App) {
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
        1.0 / DISPLAY,
    )));
}

fn attribute<const N: usize>(
    app: &App,
    cloth: Entity,
    name: bevy::mesh::MeshVertexAttribute,
) -> Vec<[f32; N]> {
    let handle = &get::<Mesh3d>(app, cloth).0;
    let meshes = app.world().resource::<Assets<Mesh>>();
    let mesh = meshes.get(handle).expect("the mesh");
    let numbers = match mesh.attribute(name) {
        Some(VertexAttributeValues::Float32x3(values)) => values.as_flattened(),
        Some(VertexAttributeValues::Float32x4(values)) => values.as_flattened(),
        other => panic!("{other:?}"),
    };
    numbers.as_chunks::<N>().0.to_vec()
}

fn positions(app: &App, cloth: Entity) -> Vec<Vec3> {
    let all = attribute::<3>(app, cloth, Mesh::ATTRIBUTE_POSITION);
    all.into_iter().map(Vec3::from).collect()
}

/// The largest change of a velocity between two pairs of places, as a distance [m].
fn second_difference(places: &[Vec<Vec3>]) -> f32 {
    let triples = places.windows(3);
    let bends = triples.flat_map(|p| {
        let bend = |i: usize| (p[0][i] - 2.0 * p[1][i] + p[2][i]).length();
        (0..p[0].len()).map(bend).collect::<Vec<_>>()
    });
    bends.fold(0.0, f32::max)
}

/// The largest second differences of 120 frames and of the steps in them.
fn of_frames_and_steps(interpolate: bool) -> (f32, f32) {
    let mut app = game();
    app.world_mut()
        .resource_mut::<ClothMeshSettings>()
        .interpolate = interpolate;
    let cloth = swinging(&mut app, ClothShading::Smooth);
    display(&mut app);
    let (mut drawn, mut stepped) = (Vec::new(), Vec::new());
    for _ in 0..120 {
        app.update();
        drawn.push(positions(&app, cloth));
        let now: Vec<Vec3> = get::<ClothParticles>(&app, cloth).positions().collect();
        if stepped.last() != Some(&now) {
            stepped.push(now);
        }
    }
    assert!(
        (48..=52).contains(&stepped.len()),
        "{} steps",
        stepped.len()
    );
    (second_difference(&drawn), second_difference(&stepped))
}

#[test]
fn a_display_of_144_hz_shows_60_steps_a_second_without_stutter() {
    // Between steps the velocity is that of the steps: it changes by no more than theirs, in a shorter time.
    let (drawn, stepped) = of_frames_and_steps(true);
    let bound = stepped * (HERTZ / DISPLAY) as f32;
    assert!(
        drawn > 0.0 && drawn <= 1.01 * bound + 1e-6,
        "{drawn} m, bound {bound} m"
    );
    // What stutters does not pass.
    let (drawn, stepped) = of_frames_and_steps(false);
    let bound = stepped * (HERTZ / DISPLAY) as f32;
    assert!(drawn > 3.0 * bound, "{drawn} m, bound {bound} m");
}

/// Angle by which a direction turns \[rad\].
fn turned(a: Vec3, b: Vec3) -> f32 {
    a.angle_between(b)
}

#[test]
fn tangents_turn_no_faster_than_the_threads() {
    for shading in [ClothShading::Smooth, ClothShading::Flat] {
        let mut app = game();
        let cloth = swinging(&mut app, shading);
        display(&mut app);
        let state = |app: &App| {
            let own = |name| attribute::<3>(app, cloth, name).into_iter().map(Vec3::from);
            let tangents = attribute::<4>(app, cloth, Mesh::ATTRIBUTE_TANGENT);
            let particles: Vec<Vec3> = positions_of_particles(app, cloth);
            (
                own(Mesh::ATTRIBUTE_NORMAL).collect::<Vec<Vec3>>(),
                tangents,
                particles,
            )
        };
        let side = SIDE as usize;
        app.update();
        let mut before = state(&app);
        let particle_of_vertex = get::<tailorbird::mesh::ClothMesh>(&app, cloth).parts()[0]
            .particle_of_vertex()
            .to_vec();
        let mut most = 0.0f32;
        for _ in 0..120 {
            app.update();
            let now = state(&app);
            for (vertex, particle) in particle_of_vertex.iter().enumerate() {
                let (a, b) = (before.1[vertex], now.1[vertex]);
                assert_eq!(a[3], b[3], "handedness of vertex {vertex}");
                let [a, b] = [a, b].map(|[x, y, z, _]| Vec3::new(x, y, z));
                let (i, column) = (*particle as usize, *particle as usize % side);
                // The threads to both sides, and the normal, turn.
                let beside = [(column > 0, i.wrapping_sub(1)), (column + 1 < side, i + 1)];
                let threads = beside
                    .into_iter()
                    .filter(|(there, _)| *there)
                    .map(|(_, j)| turned(before.2[j] - before.2[i], now.2[j] - now.2[i]));
                let threads = threads.fold(0.0, f32::max);
                let normal = turned(before.0[vertex], now.0[vertex]);
                let tangent = turned(a, b);
                most = most.max(tangent);
                assert!(
                    tangent <= 2.0 * (threads + normal) + 2e-3,
                    "vertex {vertex}: {tangent} rad, threads {threads}, normal {normal}"
                );
            }
            before = now;
        }
        assert!(most > 1e-3, "it swings");
    }
}

/// Drawn places of the particles, by vertices.
fn positions_of_particles(app: &App, cloth: Entity) -> Vec<Vec3> {
    let parts = get::<tailorbird::mesh::ClothMesh>(app, cloth).parts();
    let drawn = positions(app, cloth);
    let mut all = vec![Vec3::ZERO; (SIDE * SIDE) as usize];
    for (vertex, particle) in parts[0].particle_of_vertex().iter().enumerate() {
        all[*particle as usize] = drawn[vertex];
    }
    all
}
