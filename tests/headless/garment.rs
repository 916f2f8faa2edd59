//! A glTF file with a garment of two primitives becomes one cloth: whole at its seams, held where it says, drawn as it was.

use std::collections::HashMap;

use bevy::{
    asset::LoadState,
    mesh::{MeshVertexAttribute, VertexAttributeValues},
    prelude::*,
};
use tailorbird::{
    cloth::topology::order::Stored,
    mesh::{ClothMesh, ClothMeshOf},
    prelude::*,
};

use crate::game::*;

const SCENE: &str = "garments/skirt.gltf#Scene0";
/// Rows of particles, and how many there are in each.
const ROWS: usize = 38;
const AROUND: usize = 112;

fn wear(app: &mut App, scene: &'static str, from_mesh: ClothFromMesh) -> Entity {
    let scene = app.world().resource::<AssetServer>().load(scene);
    app.world_mut()
        .spawn((WorldAssetRoot(scene), from_mesh, ClothMaterial::cotton()))
        .id()
}

/// A skirt whose cloth is built.
fn skirt(app: &mut App, from_mesh: ClothFromMesh) -> Entity {
    let skirt = wear(app, SCENE, from_mesh);
    wait(app, |app| {
        app.world().get::<ClothMesh>(skirt).is_some() || !get::<ClothStatus>(app, skirt).is_ok()
    });
    let status = get::<ClothStatus>(app, skirt);
    assert!(status.is_ok() && status.strained() == 0.0, "{status:?}");
    skirt
}

/// The entities with its meshes, and how the vertices follow the particles.
fn parts(app: &App, skirt: Entity) -> Vec<(Entity, Vec<u32>)> {
    let parts = get::<ClothMesh>(app, skirt).parts().iter();
    parts
        .map(|part| (part.entity(), part.particle_of_vertex().to_vec()))
        .collect()
}

fn mesh_of(app: &App, part: Entity) -> &Mesh {
    let handle = &get::<Mesh3d>(app, part).0;
    let meshes = app.world().resource::<Assets<Mesh>>();
    meshes.get(handle).expect("a mesh")
}

/// The mesh of the file.
fn source(app: &App, primitive: usize) -> &Mesh {
    let path = format!("garments/skirt.gltf#Mesh0/Primitive{primitive}");
    let handle: Handle<Mesh> = app
        .world()
        .resource::<AssetServer>()
        .get_handle(path)
        .expect("loaded");
    app.world()
        .resource::<Assets<Mesh>>()
        .get(&handle)
        .expect("loaded")
}

fn positions(mesh: &Mesh) -> Vec<Vec3> {
    match mesh.attribute(Mesh::ATTRIBUTE_POSITION) {
        Some(VertexAttributeValues::Float32x3(values)) => {
            values.iter().map(|v| Vec3::from(*v)).collect()
        }
        other => panic!("{other:?}"),
    }
}

fn same(a: &Mesh, b: &Mesh, attribute: MeshVertexAttribute) -> bool {
    let bytes = |mesh: &Mesh| {
        mesh.attribute(attribute)
            .expect(attribute.name)
            .get_bytes()
            .to_vec()
    };
    bytes(a) == bytes(b)
}

/// The particles that the pins of a skirt name.
fn pinned(app: &App, skirt: Entity) -> Vec<u32> {
    match get::<ClothPins>(app, skirt).pins.as_slice() {
        [
            ClothPin {
                selection: ClothSelection::Particles(particles),
                ..
            },
        ] => particles.clone(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn two_primitives_are_one_cloth_whose_seams_stay_closed() {
    let mut app = game();
    let skirt = skirt(
        &mut app,
        ClothFromMesh::default().with_pins(ClothMeshPins::attribute()),
    );
    let report = &get::<ClothTopology>(&app, skirt).report;
    let vertices: usize = (0..2).map(|k| source(&app, k).count_vertices()).sum();
    assert_eq!(report.particles, ROWS * AROUND);
    assert_eq!(report.welded.count, vertices - ROWS * AROUND);
    assert!(report.is_clean() && report.islands.len() == 1, "{report}");
    assert_eq!(report.border_edges, 2 * AROUND);

    frames(&mut app, 200);
    let parts = parts(&app, skirt);
    assert_eq!(parts.len(), 2);
    let mut place_of_particle: HashMap<u32, Vec3> = HashMap::new();
    let mut lowest = f32::INFINITY;
    for (primitive, (part, particle_of_vertex)) in parts.iter().enumerate() {
        let drawn = mesh_of(&app, *part);
        for (particle, p) in particle_of_vertex.iter().zip(positions(drawn)) {
            assert!(p.is_finite());
            lowest = lowest.min(p.y);
            // Both lie in one node: what is one particle is one place, to the last bit.
            assert_eq!(*place_of_particle.entry(*particle).or_insert(p), p);
        }
        for attribute in [
            Mesh::ATTRIBUTE_UV_0,
            Mesh::ATTRIBUTE_COLOR,
            ATTRIBUTE_CLOTH_PIN,
        ] {
            assert!(
                same(drawn, source(&app, primitive), attribute),
                "{}",
                attribute.name
            );
        }
        assert_eq!(get::<ClothMeshOf>(&app, *part).cloth(), skirt);
    }
    assert_eq!(place_of_particle.len(), ROWS * AROUND);
    // The panels reach 0.38 m down at rest and are 0.55 m long.
    assert!(
        (-0.57..-0.45).contains(&lowest),
        "{lowest} m: it does not hang"
    );
    let [a, b] = [0, 1].map(|k| get::<MeshMaterial3d<StandardMaterial>>(&app, parts[k].0));
    assert_ne!(a, b, "each part keeps its material");
}

#[test]
fn each_part_is_drawn_where_its_node_is() {
    let mut app = game();
    let skirt = skirt(
        &mut app,
        ClothFromMesh::default().with_pins(ClothMeshPins::attribute()),
    );
    app.world_mut().entity_mut(skirt).insert(
        Transform::from_xyz(3.0, 0.5, -1.0)
            .with_rotation(Quat::from_rotation_z(0.4))
            .with_scale(Vec3::splat(1.5)),
    );
    frames(&mut app, 60);
    let particles = get::<ClothParticles>(&app, skirt);
    let frame = get::<ClothFrame>(&app, skirt);
    let fraction = app.world().resource::<Time<Fixed>>().overstep_fraction();
    for (part, particle_of_vertex) in parts(&app, skirt) {
        let place = get::<GlobalTransform>(&app, part);
        let topology = get::<ClothTopology>(&app, skirt);
        for (particle, p) in particle_of_vertex
            .iter()
            .zip(positions(mesh_of(&app, part)))
        {
            let particle = Stored(*particle);
            let given = topology.order.given(particle);
            assert_eq!(topology.order.stored(given), particle);
            let expected = frame.to_world(particles.interpolated(particle, fraction));
            assert!((*place * p).distance(expected) < 1e-4, "{p} {expected}");
        }
    }
}

#[test]
fn pins_are_named_in_four_ways() {
    let mut app = game();
    let by_attribute = skirt(
        &mut app,
        ClothFromMesh::default().with_pins(ClothMeshPins::attribute()),
    );
    let wanted = pinned(&app, by_attribute);
    // Two of the four rows of the waistband are above a half.
    assert_eq!(wanted.len(), 2 * AROUND);
    let weights = &get::<ClothWeights>(&app, by_attribute).weights;
    assert_eq!(weights.len(), ROWS * AROUND);
    assert_eq!(weights.iter().filter(|w| **w == 1.0).count(), AROUND);
    assert_eq!(
        weights
            .iter()
            .filter(|w| (**w - 1.0 / 3.0).abs() < 1e-5)
            .count(),
        AROUND
    );

    let list: Vec<u32> = (0..2)
        .flat_map(|k| match source(&app, k).attribute(ATTRIBUTE_CLOTH_PIN) {
            Some(VertexAttributeValues::Float32(values)) => values.clone(),
            other => panic!("{other:?}"),
        })
        .zip(0..)
        .filter_map(|(weight, vertex)| (weight > 0.5).then_some(vertex))
        .collect();
    for pins in [
        ClothMeshPins::color(ClothColorChannel::Alpha),
        ClothMeshPins::matching(|p| p.y > 1.0225),
        ClothMeshPins::vertices(list),
    ] {
        let painted = matches!(pins, ClothMeshPins::Color { .. });
        let by_other = skirt(&mut app, ClothFromMesh::default().with_pins(pins));
        assert_eq!(pinned(&app, by_other), wanted);
        assert_eq!(app.world().get::<ClothWeights>(by_other).is_some(), painted);
    }
}

#[test]
fn what_names_pins_wrongly_is_told_and_the_cloth_falls() {
    let mut app = game();
    for (pins, says) in [
        (ClothMeshPins::vertices([1, 99_999]), "99999"),
        (
            ClothMeshPins::Attribute {
                attribute: Mesh::ATTRIBUTE_UV_1,
                threshold: 0.5,
            },
            "Vertex_Uv_1",
        ),
        (
            ClothMeshPins::Color {
                channel: ClothColorChannel::Red,
                threshold: f32::NAN,
            },
            "NaN",
        ),
    ] {
        let skirt = wear(&mut app, SCENE, ClothFromMesh::default().with_pins(pins));
        wait(&mut app, |app| {
            app.world().get::<ClothMesh>(skirt).is_some()
        });
        let errors: Vec<String> = get::<ClothStatus>(&app, skirt)
            .errors()
            .map(ToString::to_string)
            .collect();
        assert!(
            errors.len() == 1 && errors[0].contains(says) && errors[0].contains("must"),
            "{errors:?}"
        );
        frames(&mut app, 20);
        assert!(particle(&app, skirt, 0).y < 1.0);
        // The right ones clear it.
        let mut entity = app.world_mut().entity_mut(skirt);
        entity.get_mut::<ClothFromMesh>().expect("there").pins = ClothMeshPins::attribute();
        frames(&mut app, 2);
        assert!(get::<ClothStatus>(&app, skirt).is_ok());
        assert_eq!(pinned(&app, skirt).len(), 2 * AROUND);
        app.world_mut().despawn(skirt);
    }
}

#[test]
fn files_and_names_that_are_not_there_are_told() {
    let mut app = game();
    let missing = wear(
        &mut app,
        "garments/none.gltf#Scene0",
        ClothFromMesh::default(),
    );
    wait(&mut app, |app| !get::<ClothStatus>(app, missing).is_ok());
    let errors: Vec<_> = get::<ClothStatus>(&app, missing).errors().collect();
    assert!(
        matches!(errors[..], [ClothErrorKind::AssetNotLoaded { .. }]),
        "{errors:?}"
    );
    assert!(errors[0].to_string().contains("none.gltf"));

    let named = |name: &str| ClothFromMesh::default().with_names([name]);
    let other = wear(&mut app, SCENE, named("trousers"));
    wait(&mut app, |app| !get::<ClothStatus>(app, other).is_ok());
    let errors: Vec<String> = get::<ClothStatus>(&app, other)
        .errors()
        .map(ToString::to_string)
        .collect();
    assert!(
        errors[0].contains("trousers") && errors[0].contains("skirt"),
        "{errors:?}"
    );
    assert!(app.world().get::<Cloth>(other).is_none());

    let node = skirt(&mut app, named("skirt"));
    assert_eq!(parts(&app, node).len(), 2);
    // Bevy calls the entity of a primitive after its mesh and material.
    let one = skirt(&mut app, named("skirt.panels"));
    assert_eq!(parts(&app, one).len(), 1);
    assert_eq!(get::<ClothParticles>(&app, one).len(), (ROWS - 3) * AROUND);
}

#[test]
fn two_garments_of_one_file_share_nothing_that_moves() {
    let mut app = game();
    let held = skirt(
        &mut app,
        ClothFromMesh::default().with_pins(ClothMeshPins::attribute()),
    );
    let loose = skirt(&mut app, ClothFromMesh::default());
    let before = positions(source(&app, 1));
    frames(&mut app, 30);
    let handles = |skirt| {
        parts(&app, skirt)
            .into_iter()
            .map(|(part, _)| get::<Mesh3d>(&app, part).0.clone())
    };
    for (a, b) in handles(held).zip(handles(loose)) {
        assert_ne!(a, b);
    }
    assert!(particle(&app, loose, 0).y < particle(&app, held, 0).y - 0.5);
    assert_eq!(positions(source(&app, 1)), before);
    let server = app.world().resource::<AssetServer>();
    let id = get::<WorldAssetRoot>(&app, held).0.id();
    assert!(matches!(server.load_state(id), LoadState::Loaded));
}

/// The file is read again, as Bevy's file watcher asks for when it changes on disk: the scene is spawned anew.
#[test]
fn a_garment_whose_file_is_read_again_is_made_again() {
    let mut app = game();
    // Where no watcher looks for changes, Bevy reads a file again while somebody has a handle of all of it.
    let _file: Handle<bevy::gltf::Gltf> = app
        .world()
        .resource::<AssetServer>()
        .load("garments/skirt.gltf");
    let skirt = skirt(
        &mut app,
        ClothFromMesh::default().with_pins(ClothMeshPins::attribute()),
    );
    frames(&mut app, 60);
    let before: Vec<Entity> = parts(&app, skirt).iter().map(|part| part.0).collect();
    let pins = pinned(&app, skirt);
    app.world()
        .resource::<AssetServer>()
        .reload("garments/skirt.gltf");
    wait(&mut app, |app| {
        let parts = parts(app, skirt);
        let whole = parts
            .iter()
            .all(|part| app.world().get::<Mesh3d>(part.0).is_some());
        whole && parts.iter().all(|part| !before.contains(&part.0))
    });
    frames(&mut app, 10);
    assert_eq!(get::<ClothStatus>(&app, skirt), &ClothStatus::default());
    assert_eq!(get::<ClothParticles>(&app, skirt).len(), ROWS * AROUND);
    assert_eq!(pinned(&app, skirt), pins);
    assert_eq!(get::<ClothMaterial>(&app, skirt), &ClothMaterial::cotton());
    for (part, _) in parts(&app, skirt) {
        assert!(
            positions(mesh_of(&app, part))
                .iter()
                .any(|p| *p != Vec3::ZERO)
        );
    }
}

/// Another scene on the same entity.
#[test]
fn a_garment_of_another_scene_takes_the_place_of_the_first() {
    let mut app = game();
    let skirt = skirt(&mut app, ClothFromMesh::default());
    let before: Vec<Entity> = parts(&app, skirt).iter().map(|part| part.0).collect();
    let mut world = World::new();
    let mesh = source(&app, 0).clone();
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
    world.spawn((Mesh3d(mesh), Transform::default(), Visibility::default()));
    let other = bevy::world_serialization::WorldAsset::new(world);
    let other = app
        .world_mut()
        .resource_mut::<Assets<bevy::world_serialization::WorldAsset>>()
        .add(other);
    app.world_mut()
        .entity_mut(skirt)
        .insert(WorldAssetRoot(other));
    wait(&mut app, |app| {
        let parts = parts(app, skirt);
        parts.len() == 1 && !before.contains(&parts[0].0)
    });
    assert_eq!(get::<ClothStatus>(&app, skirt), &ClothStatus::default());
    assert!(get::<ClothParticles>(&app, skirt).len() < ROWS * AROUND);
}
