//! Cloth is drawn where it is: far from where it began, with its shadow, and in front of what it hides.

use bevy::prelude::*;
use tailorbird::prelude::*;

use crate::offscreen::{Offscreen, keep, pixel};

const SIZE: UVec2 = UVec2::new(160, 120);

fn material(app: &mut Offscreen, material: StandardMaterial) -> MeshMaterial3d<StandardMaterial> {
    let world = app.app.world_mut();
    MeshMaterial3d(
        world
            .resource_mut::<Assets<StandardMaterial>>()
            .add(material),
    )
}

fn glass(color: Color) -> StandardMaterial {
    StandardMaterial {
        base_color: color,
        unlit: true,
        alpha_mode: AlphaMode::Blend,
        ..default()
    }
}

/// A sheet of 1 m × 1 m without weight that flies with a velocity [m/s].
fn flying(app: &mut Offscreen, at: Transform, look: StandardMaterial, velocity: Vec3) -> Entity {
    let look = material(app, look);
    let cloth = Cloth::grid(Vec2::ONE, UVec2::splat(8)).centered();
    let fabric = ClothMaterial {
        damping: 0.0,
        ..ClothMaterial::cotton()
    };
    let world = app.app.world_mut();
    world.insert_resource(ClothWind::vacuum());
    world.resource_mut::<ClothSettings>().gravity = Vec3::ZERO;
    let bundle = (cloth, fabric, ClothSleep::never(), at, look);
    let cloth = world.spawn(bundle).id();
    app.update(1);
    let world = app.app.world_mut();
    let rate = 1.0 / world.resource::<Time<Fixed>>().timestep().as_secs_f32();
    let mut cloth_forces = world
        .get_mut::<ClothForces>(cloth)
        .expect("forces of a cloth");
    for particle in 0..64 {
        cloth_forces.add_acceleration(particle, rate * velocity);
    }
    cloth
}

fn camera(app: &mut Offscreen, eye: Vec3, at: Vec3) {
    let target = app.target();
    let place = Transform::from_translation(eye).looking_at(at, Vec3::Y);
    app.app
        .world_mut()
        .spawn((Camera3d::default(), target, Msaa::Off, place));
}

fn light(picture: &Image, at: UVec2) -> u32 {
    pixel(picture, at)[..3].iter().map(|c| u32::from(*c)).sum()
}

#[test]
fn what_flew_away_is_drawn_and_casts_a_shadow() {
    let Some(mut app) = Offscreen::new("a cloth far from its rest pose", SIZE) else {
        return;
    };
    let flat = Transform::from_xyz(0.0, 1.0, 0.0)
        .with_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2));
    // 30 m in a second and a half.
    let white = StandardMaterial::default();
    flying(&mut app, flat, white, Vec3::X * 20.0);
    let floor = app
        .app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(Plane3d::default().mesh().size(20.0, 20.0));
    let gray = material(&mut app, Color::srgb(0.5, 0.5, 0.5).into());
    let under = Transform::from_xyz(30.0, 0.0, 0.0);
    app.app.world_mut().spawn((Mesh3d(floor), gray, under));
    let sun = DirectionalLight {
        shadow_maps_enabled: true,
        ..default()
    };
    let above = Transform::from_xyz(0.0, 5.0, 0.01).looking_at(Vec3::ZERO, Vec3::Y);
    app.app.world_mut().spawn((sun, above));
    let there = Vec3::new(30.0, 0.5, 0.0);
    camera(&mut app, there + Vec3::new(0.0, 2.0, 3.6), there);
    let empty = app.picture();
    app.update(90);
    let picture = app.picture();
    keep(&picture, "light_flew_away");
    // The sheet is seen from a little above; its shadow is in the middle below it.
    let column = |picture: &Image| {
        (0..SIZE.y)
            .map(|y| light(picture, UVec2::new(SIZE.x / 2, y)))
            .collect::<Vec<_>>()
    };
    let (before, after) = (column(&empty), column(&picture));
    let brighter = before
        .iter()
        .zip(&after)
        .filter(|(b, a)| **a > **b + 30)
        .count();
    let darker = before
        .iter()
        .zip(&after)
        .filter(|(b, a)| **a + 60 < **b)
        .count();
    assert!(brighter > 3, "the sheet is not seen: {after:?}");
    assert!(darker > 5, "it casts no shadow: {after:?}");
}

#[test]
fn transparent_cloths_are_sorted_by_where_they_are() {
    let Some(mut app) = Offscreen::new("transparent cloths", SIZE) else {
        return;
    };
    camera(&mut app, Vec3::Z * 4.0, Vec3::ZERO);
    let red = glass(Color::srgba(1.0, 0.0, 0.0, 0.9));
    let green = glass(Color::srgba(0.0, 1.0, 0.0, 0.9));
    let at = Transform::from_xyz;
    flying(&mut app, at(0.0, 0.0, 1.0), red, Vec3::Z * -2.0);
    flying(&mut app, at(0.0, 0.0, -0.5), green, Vec3::ZERO);
    let middle = |app: &mut Offscreen, name: &str| {
        let picture = app.picture();
        keep(&picture, &format!("light_{name}"));
        let [r, g, ..] = pixel(&picture, SIZE / 2);
        (r, g)
    };
    let (r, g) = middle(&mut app, "red_in_front");
    assert!(r > 2 * g, "red is in front: {r} {g}");
    // A second and a quarter later it is behind, though neither entity has moved.
    app.update(75);
    let (r, g) = middle(&mut app, "green_in_front");
    assert!(g > 2 * r, "green is in front: {r} {g}");
}

/// The light on the middle of a white sheet that is scaled and turned, with a light from the upper right of the camera.
fn light_on(place: Transform, shading: ClothShading, mapped: bool, name: &str) -> Option<u32> {
    let mut app = Offscreen::new("the light on a sheet", SIZE)?;
    app.app.insert_resource(ClothSettings {
        gravity: Vec3::ZERO,
        ..default()
    });
    let cloth = Cloth::grid(Vec2::splat(2.0), UVec2::splat(9)).centered();
    let flat = Image::new_fill(
        bevy::render::render_resource::Extent3d::default(),
        bevy::render::render_resource::TextureDimension::D2,
        &[128, 128, 255, 255],
        bevy::render::render_resource::TextureFormat::Rgba8Unorm,
        bevy::asset::RenderAssetUsages::default(),
    );
    let flat = app
        .app
        .world_mut()
        .resource_mut::<Assets<Image>>()
        .add(flat);
    let look = StandardMaterial {
        normal_map_texture: mapped.then_some(flat),
        ..default()
    };
    let white = material(&mut app, look);
    let world = app.app.world_mut();
    world.spawn((cloth, shading, white, place));
    let aside = Transform::from_xyz(1.0, 2.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y);
    world.spawn((DirectionalLight::default(), aside));
    camera(&mut app, Vec3::Z * 4.0, Vec3::ZERO);
    // Some pass when the pipelines of a new app are ready.
    app.update(20);
    let picture = app.picture();
    keep(&picture, &format!("light_on_{name}"));
    Some(light(&picture, SIZE / 2))
}

#[test]
fn backs_and_mirrored_cloths_are_lit_as_others() {
    let turned = Transform::from_rotation(Quat::from_rotation_y(std::f32::consts::PI));
    let scaled = Transform::from_scale;
    for (shading, mapped) in [
        (ClothShading::Smooth, false),
        (ClothShading::Flat, false),
        (ClothShading::Smooth, true),
    ] {
        let Some(front) = light_on(Transform::IDENTITY, shading, mapped, "front") else {
            return;
        };
        assert!(front > 400, "{front}");
        for (name, place) in [
            ("back", turned),
            ("x", scaled(Vec3::new(-1.0, 1.0, 1.0))),
            ("y", scaled(Vec3::new(1.0, -1.0, 1.0))),
            ("z", scaled(Vec3::new(1.0, 1.0, -1.0))),
            ("all", scaled(Vec3::NEG_ONE)),
            ("uneven", scaled(Vec3::new(-1.5, 1.0, 2.0))),
        ] {
            let lit = light_on(place, shading, mapped, name).unwrap_or_default();
            assert!(
                lit.abs_diff(front) <= 9,
                "{name}, {shading:?}, normal map {mapped}: {lit}, the front {front}"
            );
        }
    }
}
