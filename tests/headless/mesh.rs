//! The mesh shows the particles: at both ends of the interpolation exactly, between them in between; with normals, tangents
//! and UVs that are right, and a box around it.

use std::time::Duration;

use bevy::{
    asset::RenderAssetUsages,
    camera::primitives::Aabb,
    mesh::{Indices, PrimitiveTopology, VertexAttributeValues},
    prelude::*,
    time::TimeUpdateStrategy,
};
use tailorbird::{
    cloth::topology::order::Stored,
    mesh::{ClothMesh, ClothVertexBinding},
    prelude::*,
};

use crate::game::*;

fn mesh(app: &App, entity: Entity) -> &Mesh {
    let handle = &get::<Mesh3d>(app, entity).0;
    app.world()
        .resource::<Assets<Mesh>>()
        .get(handle)
        .expect("the mesh")
}

fn vectors(app: &App, entity: Entity, attribute: bevy::mesh::MeshVertexAttribute) -> Vec<Vec3> {
    match mesh(app, entity).attribute(attribute) {
        Some(VertexAttributeValues::Float32x3(values)) => {
            values.iter().map(|v| Vec3::from(*v)).collect()
        }
        other => panic!("{other:?}"),
    }
}

fn positions(app: &App, entity: Entity) -> Vec<Vec3> {
    vectors(app, entity, Mesh::ATTRIBUTE_POSITION)
}

fn normals(app: &App, entity: Entity) -> Vec<Vec3> {
    vectors(app, entity, Mesh::ATTRIBUTE_NORMAL)
}

fn tangents(app: &App, entity: Entity) -> Vec<Vec4> {
    match mesh(app, entity).attribute(Mesh::ATTRIBUTE_TANGENT) {
        Some(VertexAttributeValues::Float32x4(values)) => {
            values.iter().map(|v| Vec4::from(*v)).collect()
        }
        other => panic!("{other:?}"),
    }
}

/// Lets time pass without the clock's own idea of a frame.
fn pass(app: &mut App, seconds: f64) {
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
        seconds,
    )));
    app.update();
}

#[test]
fn it_equals_the_particles_at_both_ends_and_lies_between_in_between() {
    let mut app = game();
    let cloth = curtain(&mut app, 9);
    frames(&mut app, 20);
    // An exact step ends where a step ends: the overstep is what is left over, 0 but for rounding.
    let fixed = app.world().resource::<Time<Fixed>>().overstep_fraction();
    let particles = get::<ClothParticles>(&app, cloth).clone();
    for (i, p) in positions(&app, cloth).into_iter().enumerate() {
        assert!(p.distance(particles.interpolated(Stored(i as u32), fixed)) < 1e-6);
    }
    let step = 1.0 / HERTZ;
    pass(&mut app, step * f64::from(1.0 - fixed) * 1.0001);
    assert!(app.world().resource::<Time<Fixed>>().overstep_fraction() < 1e-3);
    let particles = get::<ClothParticles>(&app, cloth).clone();
    for (p, before) in positions(&app, cloth)
        .into_iter()
        .zip(particles.previous_points().iter())
    {
        assert!(
            p.distance(before) < 1e-4,
            "overstep 0 shows the step before"
        );
    }
    pass(&mut app, 0.5 * step);
    for (i, p) in positions(&app, cloth).into_iter().enumerate() {
        let (before, after) = (particles.previous_points().get(i), particles.position(i));
        assert!(p.distance(before.midpoint(after)) < 1e-4);
    }
    pass(&mut app, 0.49 * step);
    for (p, after) in positions(&app, cloth)
        .into_iter()
        .zip(particles.positions())
    {
        assert!(p.distance(after) < 1e-3, "overstep 1 shows the last step");
    }
}

#[test]
fn without_a_fixed_step_it_shows_the_last_step() {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        bevy::asset::AssetPlugin::default(),
        bevy::mesh::MeshPlugin,
        ClothPlugins::new(Update),
    ))
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(
        13,
    )));
    let cloth = app
        .world_mut()
        .spawn(Cloth::grid(Vec2::ONE, UVec2::splat(5)))
        .id();
    frames(&mut app, 10);
    let particles = get::<ClothParticles>(&app, cloth);
    assert!(particles.position(0).y < -0.05, "it falls");
    for (p, q) in positions(&app, cloth)
        .into_iter()
        .zip(particles.positions())
    {
        assert!(p.distance(q) < 1e-6);
    }
}

#[test]
fn paused_it_stands_still_at_the_last_step() {
    let mut app = game();
    let cloth = curtain(&mut app, 9);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
        1.0 / 144.0,
    )));
    frames(&mut app, 50);
    app.world_mut().resource_mut::<ClothSettings>().paused = true;
    frames(&mut app, 5);
    let still = positions(&app, cloth);
    for _ in 0..10 {
        app.update();
        assert_eq!(positions(&app, cloth), still);
    }
    let particles = get::<ClothParticles>(&app, cloth);
    for (p, q) in still.iter().zip(particles.positions()) {
        assert!(p.distance(q) < 1e-6);
    }
}

#[test]
fn uvs_run_from_the_top_left_corner_and_tangents_along_u() {
    let mut app = game();
    let cloth = curtain(&mut app, 5);
    // A material that is not known may look at tangents.
    app.world_mut()
        .entity_mut(cloth)
        .remove::<MeshMaterial3d<StandardMaterial>>();
    app.world_mut().resource_mut::<ClothSettings>().paused = true;
    frames(&mut app, 3);
    let Some(VertexAttributeValues::Float32x2(uvs)) =
        mesh(&app, cloth).attribute(Mesh::ATTRIBUTE_UV_0)
    else {
        panic!("no UVs");
    };
    assert_eq!(
        (uvs[0], uvs[4], uvs[20], uvs[24]),
        ([0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0])
    );
    for (tangent, normal) in tangents(&app, cloth).into_iter().zip(normals(&app, cloth)) {
        assert!(tangent.truncate().distance(Vec3::X) < 1e-5);
        // glTF's convention, and so Bevy's: the bitangent w (n × t) points up in the picture, where v falls.
        let bitangent = normal.cross(tangent.truncate()) * tangent.w;
        assert!(bitangent.distance(Vec3::Y) < 1e-5, "{tangent} {normal}");
    }
}

/// With tangents but without a normal map Bevy does not turn the normals of backs.
#[test]
fn there_are_tangents_where_the_material_looks_at_them() {
    let mut app = game();
    let cloth = curtain(&mut app, 5);
    let mut materials = app.world_mut().resource_mut::<Assets<StandardMaterial>>();
    let plain = materials.add(StandardMaterial::default());
    let mapped = materials.add(StandardMaterial {
        normal_map_texture: Some(Handle::default()),
        ..default()
    });
    for (material, has) in [(&plain, false), (&mapped, true), (&plain, false)] {
        app.world_mut()
            .entity_mut(cloth)
            .insert(MeshMaterial3d(material.clone()));
        frames(&mut app, 3);
        let found = mesh(&app, cloth).attribute(Mesh::ATTRIBUTE_TANGENT);
        assert_eq!(found.is_some(), has);
        if has {
            let along = tangents(&app, cloth)[12].truncate();
            assert!(along.is_normalized(), "{along}");
        }
        assert!(normals(&app, cloth).iter().all(|n| n.is_normalized()));
    }
}

/// A sheet bent into a part of a cylinder of radius 1 about the y axis: normals are radial.
fn bent(app: &mut App, shading: ClothShading) -> Entity {
    let n = 33;
    let mut positions = Vec::new();
    let mut indices = Vec::new();
    for row in 0..n {
        for column in 0..n {
            let angle = (column as f32 / (n - 1) as f32 - 0.5) * 1.6;
            positions.push(Vec3::new(
                angle.sin(),
                -(row as f32) / (n - 1) as f32,
                angle.cos(),
            ));
        }
    }
    for row in 0..n - 1 {
        for column in 0..n - 1 {
            let a = row * n + column;
            indices.extend([a, a + n, a + n + 1, a, a + n + 1, a + 1]);
        }
    }
    app.world_mut().resource_mut::<ClothSettings>().paused = true;
    app.world_mut()
        .spawn((Cloth::mesh(positions, indices), shading))
        .id()
}

#[test]
fn smooth_normals_are_those_of_the_bent_sheet() {
    let mut app = game();
    let cloth = bent(&mut app, ClothShading::Smooth);
    frames(&mut app, 3);
    for (p, n) in positions(&app, cloth).into_iter().zip(normals(&app, cloth)) {
        let radial = Vec3::new(p.x, 0.0, p.z).normalize();
        // Inside, the error is of second order in the spacing (0.05 rad); at the rim half of the triangles are missing.
        let rim = p.x.abs() > 0.71 || p.y == 0.0 || p.y == -1.0;
        assert!(
            n.angle_between(radial) < if rim { 0.03 } else { 1e-3 },
            "{p} {n}"
        );
    }
}

#[test]
fn flat_normals_are_those_of_the_triangles() {
    let mut app = game();
    let cloth = bent(&mut app, ClothShading::Flat);
    frames(&mut app, 3);
    let (positions, normals) = (positions(&app, cloth), normals(&app, cloth));
    assert_eq!(positions.len(), 32 * 32 * 6);
    for (corners, normals) in positions.chunks(3).zip(normals.chunks(3)) {
        let expected = (corners[1] - corners[0])
            .cross(corners[2] - corners[0])
            .normalize();
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        for n in normals {
            assert!(n.distance(expected) < 1e-4);
            assert!(n.angle_between(Vec3::new(middle.x, 0.0, middle.z)) < 0.03);
        }
    }
}

#[test]
fn shading_changes_at_run_time() {
    let mut app = game();
    let cloth = curtain(&mut app, 5);
    frames(&mut app, 5);
    assert_eq!(positions(&app, cloth).len(), 25);
    app.world_mut().entity_mut(cloth).insert(ClothShading::Flat);
    frames(&mut app, 5);
    assert_eq!(positions(&app, cloth).len(), 16 * 6);
    assert!(positions(&app, cloth).iter().any(|p| p.length() > 0.5));
    app.world_mut()
        .entity_mut(cloth)
        .insert(ClothShading::Smooth);
    frames(&mut app, 5);
    assert_eq!(positions(&app, cloth).len(), 25);
}

#[test]
fn the_box_is_around_what_is_drawn() {
    let mut app = game();
    let cloth = app
        .world_mut()
        .spawn(Cloth::grid(Vec2::ONE, UVec2::splat(9)))
        .id();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
        1.0 / 90.0,
    )));
    for _ in 0..60 {
        app.update();
        let Some(aabb) = app.world().get::<Aabb>(cloth) else {
            continue;
        };
        let (min, max) = (Vec3::from(aabb.min()) - 1e-5, Vec3::from(aabb.max()) + 1e-5);
        for p in positions(&app, cloth) {
            assert!(
                p.cmpge(min).all() && p.cmple(max).all(),
                "{p} in {min} {max}"
            );
        }
    }
    // It fell far out of the box it had at rest.
    assert!(get::<Aabb>(&app, cloth).center.y < -1.0);
}

#[test]
fn a_scaled_cloth_is_drawn_at_its_size_once() {
    let mut app = game();
    let cloth = curtain(&mut app, 5);
    app.world_mut().resource_mut::<ClothSettings>().paused = true;
    app.world_mut()
        .get_mut::<Transform>(cloth)
        .expect("one")
        .scale = Vec3::splat(2.0);
    frames(&mut app, 3);
    let place = *get::<GlobalTransform>(&app, cloth);
    for (i, p) in positions(&app, cloth).into_iter().enumerate() {
        assert!((place * p).distance(particle(&app, cloth, i)) < 1e-5);
    }
    assert!((particle(&app, cloth, 0)).distance(Vec3::new(-2.0, 2.0, 0.0)) < 1e-5);
}

/// Also where it is at a step of the same number as before.
#[test]
fn a_cloth_that_went_back_is_drawn_where_it_is() {
    let mut app = game();
    let cloth = curtain(&mut app, 9);
    frames(&mut app, 10);
    let saved = ClothSnapshot::take(app.world_mut());
    let drawn_right = |app: &App| {
        let particles = get::<ClothParticles>(app, cloth);
        let fixed = app.world().resource::<Time<Fixed>>().overstep_fraction();
        let places = positions(app, cloth).into_iter().enumerate();
        places
            .map(|(i, p)| p.distance(particles.interpolated(Stored(i as u32), fixed)))
            .fold(0.0, f32::max)
    };
    let second = f64::from(10.0 / HERTZ as f32);
    pass(&mut app, second);
    let (before, steps) = (
        positions(&app, cloth)[40],
        app.world().resource::<ClothStep>().steps(),
    );
    saved.restore(app.world_mut());
    app.world_mut().resource_mut::<ClothSettings>().gravity = Vec3::Y * 30.0;
    pass(&mut app, second);
    assert_eq!(app.world().resource::<ClothStep>().steps(), steps);
    assert!(positions(&app, cloth)[40].distance(before) > 0.01);
    assert!(drawn_right(&app) < 1e-5, "{}", drawn_right(&app));
}

#[test]
fn a_vertex_that_is_bound_to_a_triangle_is_drawn_on_it() {
    let mut app = game();
    let cloth = curtain(&mut app, 9);
    frames(&mut app, 10);
    let (corners, weights) = ([0, 1, 9], [0.5, 0.3, 0.2]);
    let bind = |app: &mut App, binding| {
        let mut mesh = app.world_mut().get_mut::<ClothMesh>(cloth).expect("built");
        let part = &mut mesh.parts_mut()[0];
        assert!(!part.bind(40, ClothVertexBinding::Particle(81)) && !part.bind(81, binding));
        assert!(part.bind(40, binding));
    };
    let mean = |places: &[Vec3]| -> Vec3 {
        let each = corners.iter().zip(weights);
        each.map(|(i, weight)| weight * places[*i as usize]).sum()
    };
    app.world_mut().resource_mut::<ClothSettings>().paused = true;
    for scale in [2.0, 1.0] {
        app.world_mut()
            .get_mut::<Transform>(cloth)
            .expect("one")
            .scale = Vec3::splat(scale);
        frames(&mut app, 3);
        // Another scale is another mesh.
        bind(&mut app, ClothVertexBinding::Triangle { corners, weights });
        frames(&mut app, 2);
        let (places, directions) = (positions(&app, cloth), normals(&app, cloth));
        assert!(places[40].distance(mean(&places)) < 1e-5, "scale {scale}");
        assert!(directions[40].distance(mean(&directions).normalize()) < 1e-5);
    }
    let bound = positions(&app, cloth)[40];
    bind(&mut app, ClothVertexBinding::Particle(40));
    frames(&mut app, 2);
    let particles = get::<ClothParticles>(&app, cloth);
    let free = positions(&app, cloth)[40];
    assert!(free.distance(particles.position(40)) < 1e-5 && free.distance(bound) > 0.1);
}

/// A quad of two triangles that share no vertex: its diagonal is a seam of the UVs.
fn seamed() -> Mesh {
    let positions = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    let uvs = [
        [0.0, 0.0],
        [0.5, 0.0],
        [0.5, 1.0],
        [0.5, 0.0],
        [1.0, 1.0],
        [0.5, 1.0],
    ];
    let colors = [[1.0, 0.0, 0.0, 1.0]; 6];
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions.to_vec())
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs.to_vec())
    .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors.to_vec())
    .with_inserted_indices(Indices::U16((0..6).collect()))
}

#[test]
fn a_cloth_from_a_mesh_keeps_uvs_and_colors_and_its_seam_closed_and_the_asset_alone() {
    for shading in [ClothShading::Smooth, ClothShading::Flat] {
        let mut app = game();
        let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(seamed());
        let cloth = app
            .world_mut()
            .spawn((ClothFromMesh::default(), Mesh3d(handle.clone()), shading))
            .id();
        frames(&mut app, 30);
        assert_eq!(get::<ClothParticles>(&app, cloth).len(), 4);
        let drawn = positions(&app, cloth);
        assert!(drawn[0].y < -0.1, "it falls");
        assert!(drawn[0].distance(drawn[3]) < 1e-6 && drawn[2].distance(drawn[4]) < 1e-6);
        let source = app
            .world()
            .resource::<Assets<Mesh>>()
            .get(&handle)
            .expect("the asset")
            .clone();
        for attribute in [Mesh::ATTRIBUTE_UV_0, Mesh::ATTRIBUTE_COLOR] {
            assert_eq!(
                format!("{:?}", mesh(&app, cloth).attribute(attribute)),
                format!("{:?}", source.attribute(attribute))
            );
        }
        assert_ne!(get::<Mesh3d>(&app, cloth).0, handle);
        assert_eq!(
            format!("{:?}", source.attribute(Mesh::ATTRIBUTE_POSITION)),
            format!("{:?}", seamed().attribute(Mesh::ATTRIBUTE_POSITION))
        );
    }
}

#[test]
fn a_mesh_that_cannot_be_a_cloth_is_a_typed_error() {
    let mut app = game();
    let lines = Mesh::new(PrimitiveTopology::LineList, RenderAssetUsages::default());
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(lines);
    let cloth = app
        .world_mut()
        .spawn((ClothFromMesh::default(), Mesh3d(handle)))
        .id();
    frames(&mut app, 3);
    let errors: Vec<String> = get::<ClothStatus>(&app, cloth)
        .errors()
        .map(ToString::to_string)
        .collect();
    assert_eq!(errors.len(), 1);
    assert!(errors[0].contains("is not a triangle list"), "{errors:?}");
}

#[test]
fn materials_of_cloths_become_two_sided() {
    let mut app = game();
    let material = app
        .world_mut()
        .resource_mut::<Assets<StandardMaterial>>()
        .add(StandardMaterial::default());
    let cloth = curtain(&mut app, 5);
    app.world_mut()
        .entity_mut(cloth)
        .insert(MeshMaterial3d(material.clone()));
    frames(&mut app, 2);
    let material = app
        .world()
        .resource::<Assets<StandardMaterial>>()
        .get(&material)
        .expect("one")
        .clone();
    assert!(material.double_sided && material.cull_mode.is_none());
}

#[test]
fn diagnostics_count_and_measure() {
    use bevy::diagnostic::DiagnosticsStore;
    let mut app = game();
    curtain(&mut app, 9);
    frames(&mut app, 20);
    let store = app.world().resource::<DiagnosticsStore>();
    let value = |path: bevy::diagnostic::DiagnosticPath| {
        store
            .get(&path)
            .and_then(bevy::diagnostic::Diagnostic::value)
            .expect("a value")
    };
    assert_eq!(value(ClothDiagnosticsPlugin::PARTICLES), 81.0);
    assert_eq!(
        value(ClothDiagnosticsPlugin::SUBSTEPS),
        f64::from(app.world().resource::<ClothStep>().substeps())
    );
    assert!(value(ClothDiagnosticsPlugin::CONSTRAINTS) > 81.0);
    assert!(value(ClothDiagnosticsPlugin::STEP_TIME) > 0.0);
    let (mean, max) = (
        value(ClothDiagnosticsPlugin::MEAN_STRETCH),
        value(ClothDiagnosticsPlugin::MAX_STRETCH),
    );
    assert!(mean > 0.0 && max >= mean && max < 20.0, "{mean} {max}");
}
