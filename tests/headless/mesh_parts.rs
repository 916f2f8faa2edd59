//! Meshes that become cloth, as they come: of several entities, mirrored, with double-sided faces, facing both ways, moved far.

use bevy::{
    asset::RenderAssetUsages,
    camera::primitives::Aabb,
    mesh::{Indices, PrimitiveTopology, VertexAttributeValues},
    prelude::*,
};
use tailorbird::{mesh::ClothMesh, prelude::*};

use crate::game::*;

/// A square of 1 m from the origin to the upper right, of 5 × 5 vertices, facing +z.
fn square() -> Mesh {
    let at = |i: usize| [(i % 5) as f32 / 4.0, (i / 5) as f32 / 4.0];
    let indices = (0..20)
        .filter(|i| i % 5 < 4)
        .flat_map(|i| [i, i + 1, i + 6, i, i + 6, i + 5]);
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(
        Mesh::ATTRIBUTE_POSITION,
        (0..25)
            .map(|i| [at(i)[0], at(i)[1], 0.0])
            .collect::<Vec<_>>(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, (0..25).map(at).collect::<Vec<_>>())
    .with_inserted_indices(Indices::U32(indices.collect()))
}

fn add(app: &mut App, mesh: Mesh) -> Mesh3d {
    Mesh3d(app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh))
}

fn mesh(app: &App, entity: Entity) -> &Mesh {
    let handle = &get::<Mesh3d>(app, entity).0;
    app.world()
        .resource::<Assets<Mesh>>()
        .get(handle)
        .expect("a mesh")
}

fn vectors(mesh: &Mesh, attribute: bevy::mesh::MeshVertexAttribute) -> Vec<Vec3> {
    match mesh.attribute(attribute) {
        Some(VertexAttributeValues::Float32x3(values)) => {
            values.iter().map(|v| Vec3::from(*v)).collect()
        }
        other => panic!("{other:?}"),
    }
}

/// For each corner of each triangle of the drawn mesh its place and normal.
fn corners(mesh: &Mesh) -> Vec<(Vec3, Vec3)> {
    let positions = vectors(mesh, Mesh::ATTRIBUTE_POSITION);
    let normals = vectors(mesh, Mesh::ATTRIBUTE_NORMAL);
    let indices = mesh.indices().expect("indices");
    indices.iter().map(|i| (positions[i], normals[i])).collect()
}

/// Returns whether the normals of all triangles are on the sides from which they are drawn.
fn is_lit_from_its_fronts(mesh: &Mesh) -> bool {
    corners(mesh).chunks(3).all(|c| {
        let front = (c[1].0 - c[0].0).cross(c[2].0 - c[0].0);
        c.iter().all(|(_, normal)| normal.dot(front) > 0.0)
    })
}

/// Three squares side by side: the parent's own place, a moved child, and a grandchild that is mirrored.
fn three(app: &mut App, from_mesh: ClothFromMesh) -> (Entity, [Entity; 3]) {
    let square = add(app, square());
    let world = app.world_mut();
    let cloth = world
        .spawn((
            from_mesh,
            Transform::from_xyz(0.0, 5.0, 0.0),
            Visibility::default(),
        ))
        .id();
    let first = world
        .spawn((square.clone(), ChildOf(cloth), Name::new("first")))
        .id();
    let second = world
        .spawn((
            square.clone(),
            ChildOf(cloth),
            Transform::from_xyz(1.0, 1.0, 0.0)
                .with_rotation(Quat::from_rotation_z(-std::f32::consts::FRAC_PI_2)),
        ))
        .id();
    let node = world
        .spawn((
            ChildOf(cloth),
            Transform::from_xyz(-1.0, 0.0, 0.0),
            Visibility::default(),
            Name::new("node"),
        ))
        .id();
    let mirror = Transform::from_scale(Vec3::new(-0.5, 1.0, 1.0));
    let third = world
        .spawn((square, ChildOf(node), mirror.with_translation(Vec3::X)))
        .id();
    (cloth, [first, second, third])
}

#[test]
fn meshes_below_an_entity_are_one_cloth_wherever_they_are() {
    for shading in [ClothShading::Smooth, ClothShading::Flat] {
        let mut app = game();
        let pins = ClothMeshPins::matching(|p| p.y > 0.9);
        let (cloth, parts) = three(&mut app, ClothFromMesh::default().with_pins(pins));
        app.world_mut().entity_mut(cloth).insert(shading);
        frames(&mut app, 3);
        let report = &get::<ClothTopology>(&app, cloth).report;
        // Side by side, two edges are shared; the mirrored one is half as wide.
        assert_eq!(
            (report.particles, report.islands.len()),
            (3 * 25 - 2 * 5, 1),
            "{report}"
        );
        assert!(report.is_clean(), "{report}");
        assert_eq!(get::<ClothMesh>(&app, cloth).parts().len(), 3);
        frames(&mut app, 60);
        let particles: Vec<Vec3> = (0..65).map(|i| particle(&app, cloth, i)).collect();
        for part in parts {
            let place = *get::<GlobalTransform>(&app, part);
            for (p, n) in corners(mesh(&app, part)) {
                let p = place * p;
                let nearest = particles
                    .iter()
                    .map(|q| q.distance(p))
                    .fold(f32::INFINITY, f32::min);
                assert!(nearest < 1e-4, "{p}");
                // It hangs in its plane.
                assert!((n.z.abs() - 1.0).abs() < 1e-3, "{n}");
                assert!(n.is_normalized() && n.z > 0.0, "{n}");
            }
        }
        // Only the mirrored one is drawn clockwise; its transform turns that around.
        assert!(is_lit_from_its_fronts(mesh(&app, parts[0])));
        assert!(is_lit_from_its_fronts(mesh(&app, parts[1])));
    }
}

#[test]
fn only_the_meshes_with_the_name_become_cloth_and_those_that_are_left_out_get_back_what_they_were()
{
    let mut app = game();
    let (cloth, [first, second, third]) = three(
        &mut app,
        ClothFromMesh::default().with_names(["first", "node"]),
    );
    let before = get::<Mesh3d>(&app, second).clone();
    frames(&mut app, 3);
    assert_eq!(get::<ClothParticles>(&app, cloth).len(), 45);
    assert_eq!(get::<Mesh3d>(&app, second), &before);
    assert_ne!(get::<Mesh3d>(&app, third), &before);

    let mut entity = app.world_mut().entity_mut(cloth);
    entity.get_mut::<ClothFromMesh>().expect("there").parts =
        ClothMeshParts::Named(vec!["first".into()]);
    frames(&mut app, 3);
    assert_eq!(get::<ClothParticles>(&app, cloth).len(), 25);
    assert_eq!(get::<Mesh3d>(&app, third), &before);
    assert_ne!(get::<Mesh3d>(&app, first), &before);
    // Made again from the mesh as it was, not as it hung.
    let rest = get::<Cloth>(&app, cloth).rest_positions();
    assert_eq!(rest, vectors(&square(), Mesh::ATTRIBUTE_POSITION));
}

#[test]
fn a_part_that_goes_away_takes_nothing_with_it() {
    let mut app = game();
    let (cloth, [first, second, _]) = three(&mut app, ClothFromMesh::default());
    frames(&mut app, 10);
    app.world_mut().despawn(second);
    frames(&mut app, 10);
    app.world_mut().entity_mut(cloth).insert(ClothShading::Flat);
    frames(&mut app, 10);
    assert!(get::<ClothStatus>(&app, cloth).is_ok());
    assert_eq!(mesh(&app, first).count_vertices(), 96);
}

#[test]
fn the_boxes_of_all_parts_are_around_what_is_drawn_and_not_where_it_was_at_rest() {
    let mut app = game();
    let (cloth, parts) = three(&mut app, ClothFromMesh::default());
    for frame in 0..60 {
        app.update();
        for part in parts.into_iter().filter(|_| frame > 2) {
            let aabb = get::<Aabb>(&app, part);
            let (min, max) = (Vec3::from(aabb.min()) - 1e-4, Vec3::from(aabb.max()) + 1e-4);
            for p in vectors(mesh(&app, part), Mesh::ATTRIBUTE_POSITION) {
                assert!(
                    p.cmpge(min).all() && p.cmple(max).all(),
                    "{p} in {min} {max}"
                );
            }
        }
    }
    assert!(particle(&app, cloth, 0).y < 2.0, "it falls");
    for part in parts {
        let center = Vec3::from(get::<Aabb>(&app, part).center);
        assert!((*get::<GlobalTransform>(&app, part) * center).y < 3.0);
    }
}

#[test]
fn double_sided_faces_are_one_layer_each_side_of_which_is_lit() {
    for own_vertices in [false, true] {
        for shading in [ClothShading::Smooth, ClothShading::Flat] {
            let mut app = game();
            let mut doubled = square();
            let front: Vec<u32> = doubled
                .indices()
                .expect("indices")
                .iter()
                .map(|i| i as u32)
                .collect();
            if own_vertices {
                doubled.merge(&square()).expect("alike");
            }
            let first = if own_vertices { 25 } else { 0 };
            let back = front.iter().rev().map(|i| i + first);
            doubled.insert_indices(Indices::U32(front.iter().copied().chain(back).collect()));
            let handle = add(&mut app, doubled.clone());
            let material = app
                .world_mut()
                .resource_mut::<Assets<StandardMaterial>>()
                .add(StandardMaterial::default());
            let pins = ClothMeshPins::matching(|p| p.y == 1.0 && p.x != 0.5);
            let cloth = app
                .world_mut()
                .spawn((
                    handle,
                    MeshMaterial3d(material.clone()),
                    ClothFromMesh::default().with_pins(pins),
                    shading,
                ))
                .id();
            frames(&mut app, 60);
            let topology = get::<ClothTopology>(&app, cloth);
            assert_eq!(
                (topology.report.backs.count, topology.triangles().len()),
                (32, 32)
            );
            assert!(get::<ClothStatus>(&app, cloth).is_ok());
            assert_eq!(get::<ClothParticles>(&app, cloth).len(), 25);
            let drawn = mesh(&app, cloth);
            assert_eq!(corners(drawn).len(), 64 * 3);
            assert!(is_lit_from_its_fronts(drawn), "{own_vertices} {shading:?}");
            // Drawn from its own triangles, a back must not be drawn by the front's as well.
            let materials = app.world().resource::<Assets<StandardMaterial>>();
            assert!(!materials.get(&material).expect("there").double_sided);
            // UVs are those of the corners in the file.
            let uvs = |mesh: &Mesh| match mesh.attribute(Mesh::ATTRIBUTE_UV_0) {
                Some(VertexAttributeValues::Float32x2(uvs)) => mesh
                    .indices()
                    .expect("indices")
                    .iter()
                    .map(|i| uvs[i])
                    .collect::<Vec<_>>(),
                other => panic!("{other:?}"),
            };
            assert_eq!(uvs(drawn), uvs(&doubled));
        }
    }
}

#[test]
fn triangles_that_face_the_wrong_way_are_turned_and_lit() {
    for shading in [ClothShading::Smooth, ClothShading::Flat] {
        let mut app = game();
        let mut mixed = square();
        let mut indices: Vec<u32> = mixed
            .indices()
            .expect("indices")
            .iter()
            .map(|i| i as u32)
            .collect();
        for triangle in [0, 5, 6, 21] {
            indices.swap(3 * triangle, 3 * triangle + 1);
        }
        mixed.insert_indices(Indices::U32(indices));
        let handle = add(&mut app, mixed);
        let cloth = app
            .world_mut()
            .spawn((handle, ClothFromMesh::default(), shading))
            .id();
        frames(&mut app, 10);
        let topology = get::<ClothTopology>(&app, cloth);
        assert_eq!(topology.report.turned.count, 4);
        assert!(topology.lattice().is_some(), "a grid again");
        assert!(is_lit_from_its_fronts(mesh(&app, cloth)));
        assert!(corners(mesh(&app, cloth)).iter().all(|(_, n)| n.z > 0.99));
    }
}

#[test]
fn a_cloth_that_is_thrown_far_is_still_there() {
    let mut app = game();
    let (cloth, parts) = three(
        &mut app,
        ClothFromMesh::default().with_pins(ClothMeshPins::vertices([0])),
    );
    frames(&mut app, 10);
    for place in [Vec3::splat(1e4), Vec3::new(-3e4, 0.0, 20.0), Vec3::ZERO] {
        app.world_mut()
            .get_mut::<Transform>(cloth)
            .expect("there")
            .translation = place;
        frames(&mut app, 5);
        for part in parts {
            let drawn = mesh(&app, part);
            assert!(
                corners(drawn)
                    .iter()
                    .all(|(p, n)| p.is_finite() && n.is_normalized())
            );
            let aabb = get::<Aabb>(&app, part);
            assert!(aabb.center.is_finite() && aabb.half_extents.is_finite());
        }
    }
    frames(&mut app, 600);
    let p = particle(&app, cloth, 40);
    assert!(p.length() < 5.0, "{p}");
}

#[test]
fn what_is_wrong_with_one_part_is_told_and_nothing_becomes_cloth() {
    let mut app = game();
    let (cloth, [first, ..]) = three(&mut app, ClothFromMesh::default());
    let mut broken = square();
    broken.insert_indices(Indices::U32(vec![0, 1, 30]));
    let broken = add(&mut app, broken);
    app.world_mut().entity_mut(first).insert(broken);
    frames(&mut app, 3);
    let errors: Vec<_> = get::<ClothStatus>(&app, cloth).errors().cloned().collect();
    assert_eq!(
        errors,
        [ClothErrorKind::Shape(ClothShapeError::IndexOutOfRange {
            at: 2,
            value: 30,
            vertices: 25
        })]
    );
    assert!(app.world().get::<Cloth>(cloth).is_none());
    let good = add(&mut app, square());
    app.world_mut()
        .entity_mut(first)
        .insert((good, Transform::from_scale(Vec3::new(1.0, 0.0, 1.0))));
    frames(&mut app, 3);
    let errors: Vec<_> = get::<ClothStatus>(&app, cloth)
        .errors()
        .map(ToString::to_string)
        .collect();
    assert!(
        errors.len() == 1 && errors[0].contains("scaled to nothing"),
        "{errors:?}"
    );
    app.world_mut()
        .entity_mut(first)
        .insert(Transform::IDENTITY);
    frames(&mut app, 3);
    assert!(get::<ClothStatus>(&app, cloth).is_ok());
    assert_eq!(get::<ClothParticles>(&app, cloth).len(), 65);
}
