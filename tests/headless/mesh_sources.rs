//! Meshes that become cloth, as they come: compressed, painted, skinned, morphed; and cloth made anew when they are others.

use bevy::{
    asset::RenderAssetUsages,
    mesh::{
        Indices, MeshCompressionArgs, MeshVertexAttribute, PrimitiveTopology,
        VertexAttributeValues,
        morph::{MeshMorphWeights, MorphAttributes},
        skinning::SkinnedMesh,
    },
    prelude::*,
};
use tailorbird::{mesh::ClothMeshOf, prelude::*};

use crate::game::*;

/// A square of `n` × `n` vertices and 1 m, in the plane z = 0 with its upper left corner at the origin, with normals, tangents, UVs, and
/// vertex colours that are red where y > −0.1.
fn square(n: usize) -> Mesh {
    let place = move |i: usize| {
        let at = |k: usize| k as f32 / (n - 1) as f32;
        [at(i % n), -at(i / n), 0.0]
    };
    let all = 0..n * n;
    let positions: Vec<[f32; 3]> = all.clone().map(place).collect();
    let colors: Vec<[f32; 4]> = positions
        .iter()
        .map(|p| [f32::from(p[1] > -0.1), 0.0, 0.0, 1.0])
        .collect();
    let uvs: Vec<[f32; 2]> = positions
        .iter()
        .map(|p| [3.0 * p[0] - 1.0, -p[1]])
        .collect();
    let (rows, n) = (n - 1, n as u32);
    let cells = (0..rows as u32).flat_map(|y| (0..rows as u32).map(move |x| y * n + x));
    let indices = cells.flat_map(|i| [i, i + n, i + n + 1, i, i + n + 1, i + 1]);
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(
        Mesh::ATTRIBUTE_NORMAL,
        vec![[0.0, 0.0, 1.0]; positions.len()],
    )
    .with_inserted_attribute(
        Mesh::ATTRIBUTE_TANGENT,
        vec![[1.0, 0.0, 0.0, 1.0]; positions.len()],
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors)
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
    .with_inserted_indices(Indices::U32(indices.collect()))
}

fn add(app: &mut App, mesh: Mesh) -> Mesh3d {
    Mesh3d(app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh))
}

fn drawn(app: &App, entity: Entity) -> &Mesh {
    let handle = &get::<Mesh3d>(app, entity).0;
    let mesh = app.world().resource::<Assets<Mesh>>().get(handle);
    mesh.expect("a mesh")
}

fn floats<const N: usize>(mesh: &Mesh, attribute: MeshVertexAttribute) -> Vec<[f32; N]> {
    let values = mesh.attribute(attribute).expect(attribute.name);
    match values {
        VertexAttributeValues::Float32x2(_)
        | VertexAttributeValues::Float32x3(_)
        | VertexAttributeValues::Float32x4(_) => {}
        other => panic!("{}: {other:?}", attribute.name),
    }
    let (vectors, rest) = values.get_bytes().as_chunks::<4>().0.as_chunks::<N>();
    assert!(rest.is_empty());
    vectors
        .iter()
        .map(|vector| vector.map(f32::from_ne_bytes))
        .collect()
}

fn painted() -> ClothFromMesh {
    ClothFromMesh::default().with_pins(ClothMeshPins::color(ClothColorChannel::Red))
}

/// Cloth that was made, with its particles.
fn made(app: &mut App, mesh: Mesh3d, from_mesh: ClothFromMesh) -> Entity {
    let cloth = app.world_mut().spawn((mesh, from_mesh)).id();
    frames(app, 3);
    assert_eq!(get::<ClothStatus>(app, cloth), &ClothStatus::default());
    cloth
}

#[test]
fn a_compressed_mesh_becomes_the_cloth_that_it_would_be_uncompressed() {
    let mut app = game();
    let compressed = square(9)
        .compressed_mesh(&MeshCompressionArgs::regular())
        .unwrap_or_else(|(_, error)| panic!("{error:?}"));
    assert!(matches!(
        compressed.attribute(Mesh::ATTRIBUTE_POSITION),
        Some(VertexAttributeValues::Snorm16x4(_))
    ));
    let handles = [square(9), compressed.clone()].map(|mesh| add(&mut app, mesh));
    let [plain, small] = handles.map(|mesh| made(&mut app, mesh, painted()));
    // 16 bits within half a metre, and half a bit of rounding.
    let fine = 0.5 / f32::from(i16::MAX);
    let rest = [plain, small].map(|cloth| get::<Cloth>(&app, cloth).rest_positions());
    assert_eq!(rest[0].len(), rest[1].len());
    for (a, b) in rest[0].iter().zip(&rest[1]) {
        assert!(a.distance(*b) < fine, "{a} {b}");
    }
    // Paint in bytes names the same particles.
    let pins = [plain, small].map(|cloth| get::<ClothPins>(&app, cloth).clone());
    assert_eq!(pins[0], pins[1]);
    // What is drawn goes out of the box, and is not compressed.
    frames(&mut app, 40);
    let [plain, small] = [plain, small].map(|cloth| drawn(&app, cloth));
    for attribute in [Mesh::ATTRIBUTE_POSITION, Mesh::ATTRIBUTE_NORMAL] {
        let pairs = floats::<3>(plain, attribute).into_iter();
        for (a, b) in pairs.zip(floats::<3>(small, attribute)) {
            assert!(Vec3::from(a).distance(Vec3::from(b)) < 0.02, "{a:?} {b:?}");
        }
    }
    let uvs = [plain, small].map(|mesh| floats::<2>(mesh, Mesh::ATTRIBUTE_UV_0));
    for (a, b) in uvs[0].iter().zip(&uvs[1]) {
        assert!(
            Vec2::from(*a).distance(Vec2::from(*b)) < 1e-4,
            "{a:?} {b:?}"
        );
    }
    assert_eq!(floats::<4>(small, Mesh::ATTRIBUTE_TANGENT).len(), 81);

    // The same as a collider.
    let solid = ClothCollider::trimesh_from_mesh(&compressed).expect("a solid");
    let hull = ClothCollider::convex_hull_from_mesh(
        &Mesh::from(Cuboid::from_length(0.4))
            .compressed_mesh(&MeshCompressionArgs::regular())
            .unwrap_or_else(|(_, error)| panic!("{error:?}")),
    );
    assert!(solid.errors().is_empty() && hull.is_ok_and(|hull| hull.errors().is_empty()));
}

#[test]
fn what_falls_on_a_compressed_mesh_lies_on_it() {
    let mut app = game();
    let table = Mesh::from(Cuboid::new(1.0, 0.2, 1.0))
        .compressed_mesh(&MeshCompressionArgs::regular())
        .unwrap_or_else(|(_, error)| panic!("{error:?}"));
    let solid = ClothCollider::trimesh_from_mesh(&table).expect("a solid");
    app.world_mut().spawn((solid, Transform::default()));
    let flat = Transform::from_xyz(-0.3, 0.3, -0.3)
        .with_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2));
    let cloth = Cloth::grid(Vec2::splat(0.6), UVec2::splat(13));
    let cloth = app.world_mut().spawn((cloth, flat)).id();
    frames(&mut app, 120);
    for i in 0..169 {
        let y = particle(&app, cloth, i).y;
        assert!((0.1..0.12).contains(&y), "{i}: {y}");
    }
}

#[test]
fn paint_is_data_and_not_drawn_unless_asked_for() {
    let mut app = game();
    let mesh = add(&mut app, square(5));
    let plain = made(&mut app, mesh.clone(), painted());
    assert!(
        drawn(&app, plain)
            .attribute(Mesh::ATTRIBUTE_COLOR)
            .is_none()
    );
    assert_eq!(get::<ClothWeights>(&app, plain).above(0.5).count(), 5);
    let shown = ClothFromMesh {
        draw_paint: true,
        ..painted()
    };
    let shown = made(&mut app, mesh.clone(), shown);
    assert!(
        drawn(&app, shown)
            .attribute(Mesh::ATTRIBUTE_COLOR)
            .is_some()
    );
    // Colours that name nothing are colours.
    let pins = ClothMeshPins::matching(|p| p.y > -0.1);
    let colored = made(&mut app, mesh, ClothFromMesh::default().with_pins(pins));
    assert!(
        drawn(&app, colored)
            .attribute(Mesh::ATTRIBUTE_COLOR)
            .is_some()
    );
}

#[test]
fn a_skin_and_morph_targets_do_not_move_what_cloth_moves() {
    let mut app = game();
    let joint = app.world_mut().spawn(Transform::default()).id();
    let mut mesh = square(5);
    mesh.insert_attribute(
        Mesh::ATTRIBUTE_JOINT_INDEX,
        VertexAttributeValues::Uint16x4(vec![[0; 4]; 25]),
    );
    mesh.insert_attribute(
        Mesh::ATTRIBUTE_JOINT_WEIGHT,
        vec![[1.0f32, 0.0, 0.0, 0.0]; 25],
    );
    let up = MorphAttributes {
        position: Vec3::Y,
        ..default()
    };
    mesh.set_morph_targets(vec![up; 25]);
    let mesh = add(&mut app, mesh);
    let parent = app
        .world_mut()
        .spawn((ClothFromMesh::default(), Transform::default()))
        .id();
    let skin = SkinnedMesh {
        joints: vec![joint],
        ..default()
    };
    let weights = MeshMorphWeights::Value { weights: vec![1.0] };
    let part = (mesh, skin, weights, Name::new("skinned"), ChildOf(parent));
    let part = app.world_mut().spawn(part).id();
    let other = add(&mut app, square(4));
    app.world_mut()
        .spawn((other, Name::new("other"), ChildOf(parent)));
    frames(&mut app, 3);
    // Four corners are welded.
    assert_eq!(get::<ClothParticles>(&app, parent).len(), 25 + 16 - 4);
    let copy = drawn(&app, part);
    assert!(copy.attribute(Mesh::ATTRIBUTE_JOINT_INDEX).is_none());
    assert!(copy.attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT).is_none());
    assert!(!copy.has_morph_targets());
    assert!(app.world().get::<SkinnedMesh>(part).is_none());
    // What is no cloth any more is moved by its bones again.
    app.world_mut()
        .get_mut::<ClothFromMesh>(parent)
        .expect("there")
        .parts = ClothMeshParts::Named(vec!["other".into()]);
    frames(&mut app, 3);
    assert_eq!(get::<SkinnedMesh>(&app, part).joints, [joint]);
    assert!(drawn(&app, part).has_morph_targets());
}

#[test]
fn another_mesh_is_another_cloth_with_the_same_pins_and_material() {
    let mut app = game();
    let [coarse, fine] = [5, 9].map(|n| add(&mut app, square(n)));
    let cloth = made(&mut app, coarse, ClothFromMesh::default());
    let held = ClothSelection::Within {
        center: Vec3::ZERO,
        radius: 0.05,
    };
    let by_hand = ClothPin {
        author: ClothPinAuthor::User,
        ..ClothPin::at(24, Vec3::new(1.0, -1.0, 0.0))
    };
    let pins = ClothPins::default()
        .with(ClothPin::new(held.clone()))
        .with(by_hand);
    app.world_mut()
        .entity_mut(cloth)
        .insert((pins, ClothMaterial::leather()));
    frames(&mut app, 30);
    assert_eq!(get::<ClothParticles>(&app, cloth).len(), 25);

    app.world_mut().entity_mut(cloth).insert(fine.clone());
    frames(&mut app, 3);
    assert_eq!(get::<ClothParticles>(&app, cloth).len(), 81);
    assert_eq!(get::<ClothPins>(&app, cloth).pins, [ClothPin::new(held)]);
    assert_eq!(get::<ClothMaterial>(&app, cloth), &ClothMaterial::leather());
    assert_eq!(drawn(&app, cloth).count_vertices(), 81);
    assert_ne!(
        get::<Mesh3d>(&app, cloth),
        &fine,
        "the asset stays as it is"
    );
    frames(&mut app, 30);
    assert!(particle(&app, cloth, 0).length() < 1e-3, "it is held");
    assert!(particle(&app, cloth, 80).y < -1.1, "it swings down");
    assert_eq!(get::<ClothStatus>(&app, cloth), &ClothStatus::default());

    // The asset itself is another one.
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    *meshes.get_mut(&fine.0).expect("there") = square(7);
    frames(&mut app, 3);
    assert_eq!(get::<ClothParticles>(&app, cloth).len(), 49);
    let rest = get::<Cloth>(&app, cloth).rest_positions();
    assert_eq!(rest.len(), 49);
    frames(&mut app, 10);
    assert_eq!(drawn(&app, cloth).count_vertices(), 49);
}

#[test]
fn nothing_is_made_anew_while_nothing_changes() {
    let mut app = game();
    app.insert_resource(ClothMeshSettings {
        write: ClothMeshWrite::Asset,
        ..default()
    });
    let mesh = add(&mut app, square(5));
    let cloth = made(&mut app, mesh, painted());
    let revision = get::<ClothTopology>(&app, cloth).revision;
    for _ in 0..20 {
        app.update();
        assert_eq!(get::<ClothTopology>(&app, cloth).revision, revision);
    }
    // Nor when the entity's mesh is touched.
    app.world_mut()
        .get_mut::<Mesh3d>(cloth)
        .expect("there")
        .set_changed();
    frames(&mut app, 3);
    assert_eq!(get::<ClothTopology>(&app, cloth).revision, revision);
    assert!(app.world().get::<ClothMeshOf>(cloth).is_some());
}

#[test]
fn scenes_of_bsn_become_cloth_when_they_are_complete() {
    let mut app = game();
    let mesh = add(&mut app, square(5)).0;
    let whole = {
        let mesh = mesh.clone();
        bsn! {
            ClothFromMesh { weld_distance: 0.001 }
            Transform::from_xyz(0.0, 2.0, 0.0)
            Children [
                Mesh3d({mesh.clone()})
                Transform::from_xyz(0.0, 1.0, 0.0)
            ]
        }
    };
    let cloth = app.world_mut().spawn_scene(whole).expect("a scene").id();
    frames(&mut app, 3);
    assert_eq!(get::<ClothParticles>(&app, cloth).len(), 25);
    let top = get::<Cloth>(&app, cloth).rest_positions()[0];
    assert_eq!(top, Vec3::Y);

    // Parts that come with a scene of their own are waited for.
    let part = {
        let mesh = mesh.clone();
        bsn! {
            Children [ Mesh3d({mesh.clone()}) Transform::from_xyz(3.0, 0.0, 0.0) ]
        }
    };
    let server = app.world().resource::<AssetServer>().clone();
    let patch = server.add(bevy::scene::ScenePatch::load(&server, part));
    let world = app.world_mut();
    let cloth = world
        .spawn((ClothFromMesh::default(), Transform::default()))
        .id();
    world.spawn((Mesh3d(mesh), ChildOf(cloth)));
    world.spawn((
        bevy::scene::ScenePatchInstance(patch),
        Transform::default(),
        ChildOf(cloth),
    ));
    for _ in 0..10 {
        app.update();
        if let Some(particles) = app.world().get::<ClothParticles>(cloth) {
            assert!([0, 50].contains(&particles.len()), "a part is missing");
        }
    }
    assert_eq!(get::<ClothParticles>(&app, cloth).len(), 50);
}

#[test]
fn a_sheared_cloth_says_so_and_a_rounded_right_angle_is_none() {
    let mut app = game();
    let world = app.world_mut();
    let uneven = Transform::from_scale(Vec3::new(2.0, 0.5, 1.0));
    let turned = Transform::from_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_4));
    let parent = world.spawn(uneven).id();
    let grid = || Cloth::grid(Vec2::ONE, UVec2::splat(5));
    let sheared = world.spawn((grid(), turned, ChildOf(parent))).id();
    let middle = world.spawn(turned).id();
    let upright = Transform {
        rotation: turned.rotation.inverse(),
        ..uneven
    };
    let right = world.spawn((grid(), upright, ChildOf(middle))).id();
    frames(&mut app, 3);
    let errors: Vec<_> = get::<ClothStatus>(&app, sheared).errors().collect();
    assert!(
        matches!(errors[..], [ClothErrorKind::Shear { value, .. }] if *value > 0.5),
        "{errors:?}"
    );
    assert_eq!(
        get::<ClothParticles>(&app, sheared).len(),
        25,
        "it is there all the same"
    );
    assert!(get::<ClothStatus>(&app, right).is_ok());
    app.world_mut()
        .entity_mut(parent)
        .insert(Transform::from_scale(Vec3::splat(2.0)));
    frames(&mut app, 3);
    assert!(get::<ClothStatus>(&app, sheared).is_ok());
}

#[test]
fn a_mesh_without_texture_coordinates_gives_none() {
    let mut app = game();
    for (strip, count) in [(false, 25), (true, 0)] {
        let mut plain = square(5);
        if strip {
            plain.remove_attribute(Mesh::ATTRIBUTE_UV_0);
            plain.remove_attribute(Mesh::ATTRIBUTE_TANGENT);
        }
        let mesh = add(&mut app, plain);
        let cloth = made(&mut app, mesh, ClothFromMesh::default());
        let ClothShape::Mesh { uvs, .. } = &get::<Cloth>(&app, cloth).shape else {
            panic!("a mesh");
        };
        assert_eq!(uvs.len(), count);
        assert_eq!(
            get::<Cloth>(&app, cloth),
            &get::<Cloth>(&app, cloth).clone()
        );
    }
}
