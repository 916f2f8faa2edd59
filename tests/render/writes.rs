//! Pictures are the same whether vertices go to the mesh asset or to where the renderer keeps them.

use bevy::{
    mesh::VertexAttributeValues, prelude::*, render::pipelined_rendering::PipelinedRenderingPlugin,
};
use tailorbird::prelude::*;

use crate::offscreen::{Offscreen, difference, keep};

const SIZE: UVec2 = UVec2::new(240, 180);

fn material(app: &mut Offscreen, color: Color) -> MeshMaterial3d<StandardMaterial> {
    let mut materials = app
        .app
        .world_mut()
        .resource_mut::<Assets<StandardMaterial>>();
    MeshMaterial3d(materials.add(color))
}

/// A sheet of 1 m × 1 m that hangs by two corners.
fn hang(app: &mut Offscreen, n: u32, at: Vec3, shading: ClothShading) -> Entity {
    let material = material(app, Color::srgb(0.7, 0.6, 0.2));
    let bundle = (
        Cloth::grid(Vec2::ONE, UVec2::splat(n)).centered(),
        ClothMaterial::cotton(),
        ClothPins::corners([ClothCorner::TopLeft, ClothCorner::TopRight]),
        shading,
        material,
        Transform::from_translation(at).with_rotation(Quat::from_rotation_x(-1.0)),
    );
    app.app.world_mut().spawn(bundle).id()
}

fn mesh_of(app: &Offscreen, cloth: Entity) -> Handle<Mesh> {
    let mesh = app.app.world().get::<Mesh3d>(cloth);
    mesh.expect("a mesh").0.clone()
}

/// Vertices of the mesh asset.
fn asset(app: &Offscreen, cloth: Entity) -> Vec<[f32; 3]> {
    let mesh = mesh_of(app, cloth);
    let meshes = app.app.world().resource::<Assets<Mesh>>();
    match meshes
        .get(&mesh)
        .and_then(|mesh| mesh.attribute(Mesh::ATTRIBUTE_POSITION))
    {
        Some(VertexAttributeValues::Float32x3(values)) => values.clone(),
        _ => panic!("no positions"),
    }
}

/// Gives all vertices of a cloth a colour.
fn paint(app: &mut Offscreen, cloth: Entity, color: [f32; 4]) {
    let mesh = mesh_of(app, cloth);
    let mut meshes = app.app.world_mut().resource_mut::<Assets<Mesh>>();
    let mut mesh = meshes.get_mut(&mesh).expect("a mesh");
    let colors = vec![color; mesh.count_vertices()];
    mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
}

/// Pictures of what happens to cloths and their meshes.
fn story(write: ClothMeshWrite, pipelined: bool) -> Option<Vec<Image>> {
    let name = format!("writes to {write:?}");
    let mut app = Offscreen::with_plugins(&name, SIZE, |plugins| {
        if pipelined {
            plugins
        } else {
            plugins.disable::<PipelinedRenderingPlugin>()
        }
    })?;
    app.app
        .world_mut()
        .resource_mut::<ClothMeshSettings>()
        .write = write;
    let target = app.target();
    let eye = Transform::from_xyz(0.0, 0.4, 4.5).looking_at(Vec3::Y * -0.3, Vec3::Y);
    let sun = Transform::from_xyz(1.0, 3.0, 2.0).looking_at(Vec3::ZERO, Vec3::Y);
    let light = DirectionalLight {
        shadow_maps_enabled: true,
        ..default()
    };
    let world = app.app.world_mut();
    let camera = world.spawn((Camera3d::default(), target, Msaa::Off, eye));
    let camera = camera.id();
    world.spawn((light, sun));
    let floor = world
        .resource_mut::<Assets<Mesh>>()
        .add(Plane3d::default().mesh().size(8.0, 8.0));
    let gray = material(&mut app, Color::srgb(0.5, 0.5, 0.5));
    let below = Transform::from_xyz(0.0, -1.2, 0.0);
    app.app.world_mut().spawn((Mesh3d(floor), gray, below));

    let mut pictures = Vec::new();
    let mut shoot = |app: &mut Offscreen, what: &str| {
        let picture = app.picture();
        keep(&picture, &format!("writes_{write:?}_{what}"));
        pictures.push(picture);
    };
    let first = hang(
        &mut app,
        24,
        Vec3::new(-0.8, 0.5, 0.0),
        ClothShading::Smooth,
    );
    let flat = hang(&mut app, 16, Vec3::new(0.8, 0.5, 0.0), ClothShading::Flat);
    app.update(2);
    let built = [first, flat].map(|cloth| asset(&app, cloth));
    app.update(20);
    let now = [first, flat].map(|cloth| asset(&app, cloth));
    assert_eq!(
        built == now,
        write == ClothMeshWrite::Slab,
        "who writes the asset"
    );
    shoot(&mut app, "hang");

    // So many that what the renderer keeps them in has to grow, and moves.
    let many: Vec<Entity> = (0..30)
        .map(|k| {
            let at = Vec3::new(0.15 * k as f32 - 2.2, 0.6, -1.5);
            hang(&mut app, 64, at, ClothShading::Smooth)
        })
        .collect();
    app.update(12);
    shoot(&mut app, "grow");

    // Another layout, then other values.
    paint(&mut app, first, [1.0, 0.2, 0.2, 1.0]);
    app.update(3);
    shoot(&mut app, "paint");
    paint(&mut app, first, [0.2, 0.2, 1.0, 1.0]);
    app.update(3);
    shoot(&mut app, "paint_again");

    // Nothing moves, and the asset changes.
    app.app.world_mut().resource_mut::<Time<Virtual>>().pause();
    app.update(2);
    paint(&mut app, first, [0.2, 1.0, 0.2, 1.0]);
    app.update(2);
    shoot(&mut app, "paint_still");
    app.app
        .world_mut()
        .resource_mut::<Time<Virtual>>()
        .unpause();

    // Their place is free for others.
    for cloth in many {
        app.app.world_mut().despawn(cloth);
    }
    app.update(2);
    hang(&mut app, 40, Vec3::new(0.0, 0.3, 0.6), ClothShading::Smooth);
    *app.app
        .world_mut()
        .get_mut::<ClothShading>(flat)
        .expect("shading") = ClothShading::Smooth;
    app.update(15);
    shoot(&mut app, "respawn");

    // Nobody looks for a while.
    let turn = |app: &mut Offscreen, to: Transform| {
        *app.app.world_mut().get_mut(camera).expect("a camera") = to;
    };
    turn(&mut app, eye.looking_to(Vec3::Z, Vec3::Y));
    app.update(30);
    turn(&mut app, eye);
    shoot(&mut app, "look_again");
    Some(pictures)
}

#[test]
fn pictures_are_the_same_wherever_vertices_are_written() {
    let Some(asset) = story(ClothMeshWrite::Asset, false) else {
        return;
    };
    for pair in asset.windows(2) {
        assert!(
            difference(&pair[0], &pair[1], 12) > 0.01,
            "nothing happened"
        );
    }
    for pipelined in [false, true] {
        let slab = story(ClothMeshWrite::Slab, pipelined).expect("pictures");
        for (k, (a, b)) in asset.iter().zip(&slab).enumerate() {
            let part = difference(a, b, 8);
            // With pipelined rendering a picture may be of the frame before.
            let most = if pipelined { 0.05 } else { 0.0005 };
            assert!(part <= most, "picture {k}, pipelined {pipelined}: {part}");
        }
    }
}
