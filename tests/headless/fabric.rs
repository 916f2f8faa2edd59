//! A look gives a cloth a material: one for all that look alike, plain at first, with the textures of the fabric once they are there.

use std::{thread, time::Duration};

use bevy::{
    image::{CompressedImageFormats, ImageLoader},
    prelude::*,
};
use tailorbird::{fabric::ClothFabricLibrary, prelude::*};

use crate::game::*;

/// A game that copied no textures.
fn dressed() -> App {
    dressed_by(ClothFabricPlugin::default())
}

fn dressed_by(textures: ClothFabricPlugin) -> App {
    let mut app = with_textures(textures);
    app.finish();
    app.cleanup();
    // Bevy's renderer would do so.
    app.register_asset_loader(ImageLoader::new(CompressedImageFormats::NONE));
    app
}

fn flag(app: &mut App, look: ClothLook) -> Entity {
    let cloth = Cloth::grid(Vec2::new(0.9, 0.6), UVec2::new(9, 7));
    app.world_mut().spawn((cloth, look)).id()
}

fn handle(app: &App, cloth: Entity) -> AssetId<StandardMaterial> {
    get::<MeshMaterial3d<StandardMaterial>>(app, cloth).0.id()
}

fn material(app: &App, cloth: Entity) -> &StandardMaterial {
    let materials = app.world().resource::<Assets<StandardMaterial>>();
    materials.get(handle(app, cloth)).expect("the material")
}

fn wait(app: &mut App) {
    for _ in 0..2000 {
        app.update();
        if app.world().resource::<ClothFabricLibrary>().is_ready() {
            return;
        }
        thread::sleep(Duration::from_millis(5));
    }
    panic!("the textures do not come");
}

#[test]
fn every_fabric_has_its_textures_with_smaller_copies() {
    let files = ClothFabricPlugin::from_folder("textures");
    for (textures, size) in [(ClothFabricPlugin::default(), 256), (files, 1024)] {
        every_fabric_has_textures(textures, size);
    }
}

fn every_fabric_has_textures(textures: ClothFabricPlugin, size: u32) {
    let mut app = dressed_by(textures);
    let cloths = ClothFabric::ALL.map(|fabric| flag(&mut app, ClothLook::new(fabric)));
    app.update();
    assert!(!app.world().resource::<ClothFabricLibrary>().is_ready());
    wait(&mut app);
    for (cloth, fabric) in cloths.into_iter().zip(ClothFabric::ALL) {
        let material = material(&app, cloth);
        let tiles = material.uv_transform.matrix2.col(0).x;
        assert!((tiles - 0.9 / fabric.tile).abs() < 1e-3, "{tiles} tiles");
        let textures = [
            &material.base_color_texture,
            &material.normal_map_texture,
            &material.metallic_roughness_texture,
        ];
        for texture in textures {
            let texture = texture.as_ref().expect("a texture");
            let images = app.world().resource::<Assets<Image>>();
            let image = images.get(texture).expect("the image");
            assert_eq!(image.size(), UVec2::splat(size), "{fabric:?}");
            assert_eq!(
                image.texture_descriptor.mip_level_count,
                size.ilog2() + 1,
                "{fabric:?}"
            );
        }
        let sees_through = material.alpha_mode == AlphaMode::AlphaToCoverage;
        assert_eq!(sees_through, fabric.has_holes, "{fabric:?}");
    }
}

#[test]
fn cloths_that_look_alike_share_a_material_and_others_do_not() {
    let mut app = dressed();
    let red = ClothLook::new(ClothFabric::SILK).with_dye(Color::srgb(0.6, 0.1, 0.1));
    let [a, b] = [(); 2].map(|()| flag(&mut app, red.clone()));
    let c = flag(&mut app, red.clone().with_dye(Color::WHITE));
    app.update();
    assert_eq!(handle(&app, a), handle(&app, b));
    assert_ne!(handle(&app, a), handle(&app, c));
    *app.world_mut().get_mut::<ClothLook>(c).expect("the look") = red;
    wait(&mut app);
    assert_eq!(handle(&app, a), handle(&app, c));
    assert!(material(&app, a).base_color_texture.is_some());
    // One that comes when the textures are there has them at once.
    let d = flag(&mut app, ClothLook::new(ClothFabric::SILK));
    app.update();
    assert!(material(&app, d).base_color_texture.is_some());
}

#[test]
fn looks_and_physics_come_together_or_alone() {
    let mut app = dressed();
    let shape = Cloth::grid(Vec2::ONE, UVec2::splat(5));
    let both = app
        .world_mut()
        .spawn((shape.clone(), ClothFabric::LEATHER.bundle()));
    let both = both.id();
    let plain = ClothLook {
        textured: false,
        ..ClothLook::new(ClothFabric::LACE)
    };
    let mixed = app
        .world_mut()
        .spawn((shape, plain, ClothMaterial::denim()));
    let mixed = mixed.id();
    app.update();
    assert_eq!(*get::<ClothMaterial>(&app, both), ClothMaterial::leather());
    assert_eq!(*get::<ClothMaterial>(&app, mixed), ClothMaterial::denim());
    assert!(material(&app, mixed).base_color_texture.is_none());
    assert!(material(&app, both).diffuse_transmission == 0.0);
    assert!(material(&app, mixed).diffuse_transmission > 0.0, "thin");
    wait(&mut app);
    assert!(material(&app, mixed).base_color_texture.is_none());
}

#[test]
fn presets_of_both_kinds_have_the_same_names() {
    for (name, physics) in ClothMaterial::presets() {
        let fabric = ClothFabric::by_name(name).expect(name);
        assert_eq!(fabric.material, physics);
    }
    assert_eq!(ClothFabric::ALL.len(), ClothMaterial::presets().len());
}

#[test]
fn a_fabric_of_ones_own_is_a_value() {
    let mut app = dressed();
    let velvet = ClothFabric {
        name: "velvet".into(),
        color: Color::srgb(0.3, 0.02, 0.06),
        tile: 0.3,
        ..ClothFabric::COTTON
    };
    let look = ClothLook {
        textured: false,
        ..ClothLook::new(velvet.clone())
    };
    let [a, b] = [0.9, 0.5].map(|roughness| {
        let fabric = ClothFabric {
            roughness,
            ..velvet.clone()
        };
        let look = ClothLook {
            fabric,
            ..look.clone()
        };
        flag(&mut app, look)
    });
    let grey = flag(&mut app, look.with_dye(Color::linear_rgb(0.5, 0.5, 0.5)));
    // Of which there are no textures: it stays plain.
    let textured = flag(&mut app, ClothLook::new(velvet));
    app.update();
    assert_ne!(handle(&app, a), handle(&app, b));
    assert_eq!(material(&app, a).perceptual_roughness, 0.9);
    let [own, dyed] = [a, grey].map(|cloth| material(&app, cloth).base_color.to_linear());
    assert!((dyed.red - 0.5 * own.red).abs() < 1e-6, "{dyed:?}");
    wait(&mut app);
    assert!(material(&app, textured).base_color_texture.is_none());
}
