//! The motion vectors of cloth are those of its vertices.

use bevy::{
    anti_alias::taa::TemporalAntiAliasing,
    asset::{RenderAssetUsages, uuid_handle},
    core_pipeline::{prepass::MotionVectorPrepass, tonemapping::Tonemapping},
    image::{ImageAddressMode, ImageSampler, ImageSamplerDescriptor},
    pbr::Material,
    prelude::*,
    render::{
        pipelined_rendering::PipelinedRenderingPlugin,
        render_resource::{AsBindGroup, Extent3d, TextureDimension, TextureFormat},
    },
    shader::{Shader, ShaderRef},
    time::TimeUpdateStrategy,
};
use tailorbird::{
    motion_vectors::{ClothMotionBase, ClothMotionMaterial},
    prelude::*,
};

use crate::offscreen::{Offscreen, keep, pixel};

const SIZE: UVec2 = UVec2::new(160, 120);
/// Field of view [rad], and how far the camera is away [m].
const FOV: f32 = 0.8;
const AWAY: f32 = 3.0;
/// Colour that a motion of the whole picture's height would have.
const GAIN: f32 = 20.0;

const SHADER: Handle<Shader> = uuid_handle!("5b0f3c52-7f7e-4c8f-9a50-3c6b0e4f6a11");

/// Shows the motion vectors of what is behind.
#[derive(Asset, AsBindGroup, TypePath, Clone, Default)]
struct Looking {}

impl Material for Looking {
    fn fragment_shader() -> ShaderRef {
        SHADER.into()
    }

    fn alpha_mode(&self) -> AlphaMode {
        AlphaMode::Blend
    }
}

fn app(test: &str) -> Option<Offscreen> {
    let mut app = Offscreen::with_plugins(test, SIZE, |plugins| {
        plugins
            .disable::<PipelinedRenderingPlugin>()
            .add(MaterialPlugin::<Looking>::default())
            .add(ClothMotionVectorsPlugin)
    })?;
    let source = "
        import bevy_pbr::{prepass::utils, render::forward_io::VertexOutput};
        @fragment
        fn fragment(in: VertexOutput) -> @location(0) vec4<f32> {
            let motion = utils::prepass_motion_vector(in.position, 0u);
            return vec4<f32>(motion * 20.0 + 0.5, 0.0, 1.0);
        }";
    let world = app.app.world_mut();
    let shader = Shader::from_wesl(source, "looking.wesl");
    let inserted = world
        .resource_mut::<Assets<Shader>>()
        .insert(&SHADER, shader);
    inserted.expect("a place for the shader");
    let fixed = Time::<Fixed>::from_hz(60.0);
    let frame = TimeUpdateStrategy::ManualDuration(fixed.timestep());
    world.insert_resource(fixed);
    world.insert_resource(frame);
    world.insert_resource(ClothWind::vacuum());
    let target = app.target();
    let projection = PerspectiveProjection {
        fov: FOV,
        ..default()
    };
    let camera = (
        Camera3d::default(),
        target,
        Msaa::Off,
        Tonemapping::None,
        MotionVectorPrepass,
        Projection::from(projection),
        Transform::from_xyz(0.0, 0.0, AWAY),
    );
    let world = app.app.world_mut();
    world.spawn(camera);
    let quad = world
        .resource_mut::<Assets<Mesh>>()
        .add(Rectangle::new(2.0, 2.0));
    let looking = world.resource_mut::<Assets<Looking>>().add(Looking {});
    let near = Transform::from_xyz(0.0, 0.0, AWAY - 0.5);
    world.spawn((Mesh3d(quad), MeshMaterial3d(looking), near));
    Some(app)
}

/// A sheet of 2 m × 2 m that faces the camera.
fn sheet(app: &mut Offscreen) -> Entity {
    let world = app.app.world_mut();
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(StandardMaterial::default());
    let cloth = Cloth::grid(Vec2::splat(2.0), UVec2::splat(12)).centered();
    world
        .spawn((cloth, ClothSleep::never(), MeshMaterial3d(material)))
        .id()
}

/// The motion vector in the middle of the picture: parts of its width and height, downwards.
fn motion(app: &mut Offscreen, name: &str) -> Vec2 {
    let picture = app.picture_in_motion();
    keep(&picture, &format!("motion_{name}"));
    let [r, g, ..] = pixel(&picture, SIZE / 2);
    let linear = Color::srgb_u8(r, g, 0).to_linear();
    (Vec2::new(linear.red, linear.green) - 0.5) / GAIN
}

fn height(app: &Offscreen, cloth: Entity) -> f32 {
    let particles = app.app.world().get::<ClothParticles>(cloth);
    particles
        .and_then(|p| p.positions().next())
        .map_or(f32::NAN, |p| p.y)
}

#[test]
fn a_falling_sheet_moves_by_what_it_fell() {
    let Some(mut app) = app("motion vectors of a falling sheet") else {
        return;
    };
    let cloth = sheet(&mut app);
    app.update(16);
    let before = height(&app, cloth);
    app.update(1);
    let fell = before - height(&app, cloth);
    assert!(fell > 0.02, "{fell} m in a frame");
    // What is seen at this distance is so high.
    let expected = fell / (2.0 * AWAY * (0.5 * FOV).tan());
    let seen = motion(&mut app, "falls");
    // A picture comes a frame or two later, when it falls by up to a fifth more.
    assert!(
        seen.x.abs() < 5e-4 && (0.9 * expected..1.25 * expected).contains(&seen.y),
        "{seen}, expected {expected}"
    );

    let world = app.app.world_mut();
    assert!(
        world
            .get::<MeshMaterial3d<ClothMotionMaterial>>(cloth)
            .is_some()
    );
    let base = world
        .get::<ClothMotionBase>(cloth)
        .map(|base| base.handle().clone());

    // What stays is not said to move, from the second frame on.
    world.resource_mut::<ClothSettings>().paused = true;
    app.update(3);
    let still = motion(&mut app, "still");
    assert!(still.length() < 5e-4, "{still}");

    // Switched off, the material is the one from before, and vertices do not tell how they move.
    let world = app.app.world_mut();
    world.resource_mut::<ClothSettings>().paused = false;
    world.resource_mut::<ClothMeshSettings>().motion_vectors = false;
    app.update(2);
    let world = app.app.world();
    let own = world.get::<MeshMaterial3d<StandardMaterial>>(cloth);
    assert_eq!(own.map(|own| own.0.clone()), base);
    assert!(
        world
            .get::<MeshMaterial3d<ClothMotionMaterial>>(cloth)
            .is_none()
    );
    let off = motion(&mut app, "off");
    assert!(off.length() < 5e-4, "{off}");
}

#[test]
fn the_material_follows_the_one_it_stands_for() {
    let Some(mut app) = app("materials of motion vectors") else {
        return;
    };
    let cloth = sheet(&mut app);
    app.update(3);
    let world = app.app.world_mut();
    let base = world
        .get::<ClothMotionBase>(cloth)
        .map(|base| base.handle().clone());
    let base = base.expect("a material");
    let own = world
        .get::<MeshMaterial3d<ClothMotionMaterial>>(cloth)
        .map(|own| own.0.clone());
    let own = own.expect("a material that stands for it");
    let red = |world: &World| {
        let all = world.resource::<Assets<ClothMotionMaterial>>();
        all.get(&own)
            .map(|own| (own.base.base_color, own.base.double_sided))
    };
    assert_eq!(red(world), Some((Color::WHITE, true)));
    let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
    materials.get_mut(&base).expect("the base").base_color = Color::BLACK;
    app.update(3);
    assert_eq!(red(app.app.world()), Some((Color::BLACK, true)));

    // Another one, which a second cloth shares.
    let world = app.app.world_mut();
    let other = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(Color::srgb(0.0, 0.5, 0.0));
    world
        .entity_mut(cloth)
        .insert(MeshMaterial3d(other.clone()));
    let second = sheet(&mut app);
    app.app
        .world_mut()
        .entity_mut(second)
        .insert(MeshMaterial3d(other.clone()));
    app.update(3);
    let world = app.app.world();
    let of = |cloth| {
        world
            .get::<MeshMaterial3d<ClothMotionMaterial>>(cloth)
            .map(|own| own.0.clone())
    };
    assert!(of(cloth).is_some() && of(cloth) == of(second));
    let base = world
        .get::<ClothMotionBase>(cloth)
        .map(|base| base.handle().clone());
    assert_eq!(base, Some(other));
    assert!(
        world
            .get::<MeshMaterial3d<StandardMaterial>>(cloth)
            .is_none()
    );

    // What is no cloth any more has its own again.
    app.app.world_mut().entity_mut(cloth).remove::<Cloth>();
    app.update(3);
    let world = app.app.world();
    let is_cloth = world.get::<tailorbird::mesh::ClothMeshOf>(cloth).is_some();
    assert_eq!(
        is_cloth,
        world
            .get::<MeshMaterial3d<StandardMaterial>>(cloth)
            .is_none()
    );
}

/// Light and dark fields, 24 across.
fn chequered(app: &mut Offscreen) -> Handle<StandardMaterial> {
    const FIELDS: f32 = 24.0;
    let size = Extent3d {
        width: 2,
        height: 2,
        depth_or_array_layers: 1,
    };
    let texels = [230, 40, 40, 230].map(|grey: u8| [grey, grey, grey, 255]);
    let mut image = Image::new(
        size,
        TextureDimension::D2,
        texels.concat(),
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::all(),
    );
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        ..ImageSamplerDescriptor::nearest()
    });
    let world = app.app.world_mut();
    let image = world.resource_mut::<Assets<Image>>().add(image);
    let material = StandardMaterial {
        base_color_texture: Some(image),
        unlit: true,
        uv_transform: bevy::math::Affine2::from_scale(Vec2::splat(0.5 * FIELDS)),
        ..default()
    };
    world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(material)
}

/// Contrast that is left of a chequered sheet that falls past a camera with temporal anti-aliasing: mean difference of neighbours
/// in a column of pixels, 0 to 255.
fn contrast_while_it_falls(test: &str, with_plugin: bool) -> Option<f32> {
    let mut app = Offscreen::with_plugins(test, SIZE, |plugins| {
        let plugins = plugins.disable::<PipelinedRenderingPlugin>();
        if with_plugin {
            plugins.add(ClothMotionVectorsPlugin)
        } else {
            plugins
        }
    })?;
    let fixed = Time::<Fixed>::from_hz(60.0);
    let frame = TimeUpdateStrategy::ManualDuration(fixed.timestep());
    let world = app.app.world_mut();
    world.insert_resource(fixed);
    world.insert_resource(frame);
    world.insert_resource(ClothWind::vacuum());
    let material = chequered(&mut app);
    let target = app.target();
    let world = app.app.world_mut();
    world.spawn((
        Camera3d::default(),
        target,
        Msaa::Off,
        Tonemapping::None,
        TemporalAntiAliasing::default(),
        Projection::from(PerspectiveProjection {
            fov: FOV,
            ..default()
        }),
        Transform::from_xyz(0.0, -1.0, AWAY),
    ));
    let cloth = Cloth::grid(Vec2::splat(3.0), UVec2::splat(12)).centered();
    world.spawn((cloth, ClothSleep::never(), MeshMaterial3d(material)));
    app.update(30);
    let picture = app.picture_in_motion();
    keep(&picture, &format!("taa_{with_plugin}"));
    let column = |y: u32| f32::from(pixel(&picture, UVec2::new(SIZE.x / 2, y))[0]);
    let (from, to) = (SIZE.y / 4, 3 * SIZE.y / 4);
    let steps = (from..to).map(|y| (column(y + 1) - column(y)).abs());
    Some(steps.sum::<f32>() / (to - from) as f32)
}

/// Without its motion vectors a moving cloth is averaged with where it was, and its pattern is lost.
#[test]
fn temporal_anti_aliasing_keeps_the_pattern_of_a_falling_sheet() {
    let test = "temporal anti-aliasing of a falling sheet";
    let Some(with) = contrast_while_it_falls(test, true) else {
        return;
    };
    let without = contrast_while_it_falls(test, false).expect("as before");
    assert!(
        with > 1.3 * without,
        "{with} with motion vectors, {without} without"
    );
}
