//! The two picking backends name the same place on a cloth, whatever the camera.

use bevy::{
    camera::{ScalingMode, Viewport},
    core_pipeline::prepass::DepthPrepass,
    picking::{backend::HitData, pointer::PointerInteraction},
    prelude::*,
    render::pipelined_rendering::PipelinedRenderingPlugin,
};
use tailorbird::prelude::*;

use crate::offscreen::{Offscreen, difference, keep, pixel};

const SIZE: UVec2 = UVec2::new(640, 480);
/// Columns and rows.
const RESOLUTION: UVec2 = UVec2::splat(25);

/// A curtain of 1.5 m × 1.5 m in front of the camera, with folds.
fn hang(app: &mut Offscreen) -> Entity {
    let world = app.app.world_mut();
    let material = StandardMaterial {
        base_color: Color::srgb(0.8, 0.2, 0.1),
        double_sided: true,
        cull_mode: None,
        ..default()
    };
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(material);
    world.spawn((
        DirectionalLight::default(),
        Transform::from_xyz(1.0, 2.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    // The pins come nearer to each other, and the cloth between them falls into folds.
    let pins = [0, 8, 16, 24].map(|column| {
        let across = column as f32 / 24.0 * 1.2 - 0.6;
        ClothPin::at(
            column,
            Vec3::new(across, 0.75, 0.1 * (column % 16) as f32 / 8.0),
        )
    });
    let pins = pins.into_iter().fold(ClothPins::default(), ClothPins::with);
    let cloth = Cloth::grid(Vec2::splat(1.5), RESOLUTION).centered();
    world
        .spawn((
            cloth,
            ClothMaterial::cotton(),
            pins,
            MeshMaterial3d(material),
            Transform::default(),
        ))
        .id()
}

#[derive(Clone, Copy, Debug)]
struct View {
    msaa: Msaa,
    orthographic: bool,
    part: bool,
}

impl View {
    fn spawn(self, app: &mut Offscreen) -> Entity {
        let projection = if self.orthographic {
            Projection::Orthographic(OrthographicProjection {
                scaling_mode: ScalingMode::FixedVertical {
                    viewport_height: 2.2,
                },
                ..OrthographicProjection::default_3d()
            })
        } else {
            Projection::default()
        };
        let viewport = self.part.then(|| Viewport {
            physical_position: UVec2::new(150, 70),
            physical_size: UVec2::new(400, 360),
            ..default()
        });
        let target = app.target();
        app.app
            .world_mut()
            .spawn((
                Camera3d::default(),
                Camera {
                    viewport,
                    ..default()
                },
                target,
                projection,
                self.msaa,
                DepthPrepass,
                Transform::from_xyz(0.7, 0.4, 2.6).looking_at(Vec3::new(0.0, -0.1, 0.0), Vec3::Y),
            ))
            .id()
    }

    const ALL: [Self; 8] = {
        let mut all = [Self {
            msaa: Msaa::Off,
            orthographic: false,
            part: false,
        }; 8];
        let mut i = 0;
        while i < 8 {
            if i & 1 != 0 {
                all[i].msaa = Msaa::Sample4;
            }
            all[i].orthographic = i & 2 != 0;
            all[i].part = i & 4 != 0;
            i += 1;
        }
        all
    };
}

fn use_backend(app: &mut Offscreen, backend: ClothPickingBackend) {
    app.app
        .world_mut()
        .resource_mut::<ClothPickingSettings>()
        .backend = backend;
}

fn pause(app: &mut Offscreen, paused: bool) {
    app.app.world_mut().resource_mut::<ClothSettings>().paused = paused;
}

/// Hit under the mouse.
fn hovered(app: &mut Offscreen) -> Option<(Entity, HitData)> {
    let world = app.app.world_mut();
    let mut pointers = world.query::<&PointerInteraction>();
    pointers
        .iter(world)
        .find_map(PointerInteraction::get_nearest_hit)
        .cloned()
}

/// Hit under the mouse there, when the answer has come.
fn pick(app: &mut Offscreen, at: Vec2) -> Option<(Entity, HitData)> {
    app.point(at);
    app.update(
        match app.app.world().resource::<ClothPickingSettings>().backend {
            ClothPickingBackend::Ray => 1,
            ClothPickingBackend::Depth => 3,
        },
    );
    hovered(app)
}

fn extra(hit: &HitData) -> ClothPointerHit {
    *hit.extra_as().expect("a hit of a cloth")
}

/// The middle of the pixel in which a camera sees the cloth beside a particle: a point of a triangle around it, so that
/// particles at the border are not missed.
fn pixel_of(app: &Offscreen, camera: Entity, cloth: Entity, particle: usize) -> Vec2 {
    let world = app.app.world();
    let (particles, topology, frame) =
        world
            .entity(cloth)
            .components::<(&ClothParticles, &ClothTopology, &ClothFrame)>();
    let triangle = topology
        .triangles()
        .iter()
        .find(|corners| corners.contains(&(particle as u32)));
    let at = triangle.expect("every particle is in one").map(|corner| {
        let weight = if corner as usize == particle {
            0.6
        } else {
            0.2
        };
        particles.world_position(corner as usize, frame) * weight
    });
    let (camera, transform) = world
        .entity(camera)
        .components::<(&Camera, &GlobalTransform)>();
    let at = camera
        .world_to_viewport(transform, at.into_iter().sum())
        .expect("in view");
    at.floor() + 0.5
}

/// Returns whether the cloth goes on all over the pixel, without an outline of the cloth or of a fold of it. Through an outline
/// the samples of a pixel show different things, and none of them is wrong.
fn is_inside(app: &Offscreen, camera: Entity, cloth: Entity, at: Vec2) -> bool {
    let world = app.app.world();
    let (particles, topology, bounds) =
        world
            .entity(cloth)
            .components::<(&ClothParticles, &ClothTopology, &ClothBounds)>();
    let (camera, transform) = world
        .entity(camera)
        .components::<(&Camera, &GlobalTransform)>();
    let depths = [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)].map(|(x, y)| {
        let ray = camera.viewport_to_world(transform, at + Vec2::new(x, y));
        let hit = particles.cast_ray(topology, bounds, ray.expect("a ray"));
        hit.map_or(f32::INFINITY, |hit| hit.distance)
    });
    depths.iter().all(|depth| (depth - depths[0]).abs() < 0.02)
}

/// A particle in the middle, some between, two at edges, and the four corners.
const PLACES: [usize; 9] = [312, 160, 415, 12, 300, 0, 24, 600, 624];

#[test]
fn both_backends_name_the_same_particle() {
    let test = "both_backends_name_the_same_particle";
    let Some(mut app) = Offscreen::new(test, SIZE) else {
        return;
    };
    let cloth = hang(&mut app);
    app.update(90);
    pause(&mut app, true);
    for view in View::ALL {
        let camera = view.spawn(&mut app);
        app.update(3);
        let mut largest = 0.0_f32;
        let (mut visible, mut compared) = (0, 0);
        for place in PLACES {
            let at = pixel_of(&app, camera, cloth, place);
            // A corner may be turned edge-on.
            if !is_inside(&app, camera, cloth, at) {
                continue;
            }
            use_backend(&mut app, ClothPickingBackend::Ray);
            let ray =
                pick(&mut app, at).unwrap_or_else(|| panic!("the ray hits {place} in {view:?}"));
            use_backend(&mut app, ClothPickingBackend::Depth);
            let depth =
                pick(&mut app, at).unwrap_or_else(|| panic!("depth shows {place} in {view:?}"));
            assert_eq!((ray.0, depth.0), (cloth, cloth));

            let (a, b) = (extra(&ray.1), extra(&depth.1));
            assert_eq!(
                a.particle, b.particle,
                "place {place} in {view:?}: {ray:?}, {depth:?}"
            );
            let (from, to) = (
                ray.1.position.expect("known"),
                depth.1.position.expect("known"),
            );
            largest = largest.max(from.distance(to));
            compared += 1;
            let allowed = if view.msaa == Msaa::Off { 5e-4 } else { 3e-3 };
            assert!(
                from.distance(to) < allowed,
                "{from} {to} at {place} in {view:?}"
            );
            assert!((ray.1.depth - depth.1.depth).abs() < allowed);
            if view.msaa == Msaa::Off && a.triangle == b.triangle {
                assert!(
                    a.barycentric.abs_diff_eq(b.barycentric, 0.02),
                    "{a:?} {b:?}"
                );
                assert!(
                    ray.1
                        .normal
                        .expect("known")
                        .dot(depth.1.normal.expect("known"))
                        > 0.999
                );
            }
            visible += usize::from(a.particle == place);
        }
        println!(
            "{view:?}: up to {:.3} mm apart, {compared} of {} places compared, {visible} in front",
            largest * 1e3,
            PLACES.len()
        );
        assert!(visible >= 5 && compared >= 6);

        let corner = if view.part {
            Vec2::new(155.5, 75.5)
        } else {
            Vec2::new(5.5, 5.5)
        };
        for backend in [ClothPickingBackend::Ray, ClothPickingBackend::Depth] {
            use_backend(&mut app, backend);
            let off = pick(&mut app, corner);
            assert!(off.is_none(), "{backend:?} in {view:?}: {off:?}");
        }
        app.app.world_mut().despawn(camera);
    }
}

#[test]
fn what_hides_the_cloth_hides_it_from_the_depth_backend() {
    let test = "what_hides_the_cloth_hides_it_from_the_depth_backend";
    let Some(mut app) = Offscreen::new(test, SIZE) else {
        return;
    };
    let cloth = hang(&mut app);
    app.update(30);
    pause(&mut app, true);
    let camera = View::ALL[1].spawn(&mut app);
    use_backend(&mut app, ClothPickingBackend::Depth);
    app.update(3);
    let (middle, edge) = (
        pixel_of(&app, camera, cloth, 312),
        pixel_of(&app, camera, cloth, 300),
    );
    assert!(pick(&mut app, middle).is_some());
    let open = app.picture();
    keep(&open, "hanging");

    let world = app.app.world_mut();
    let mesh = world.resource_mut::<Assets<Mesh>>().add(Sphere::new(0.2));
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(Color::srgb(0.1, 0.2, 0.8));
    world.spawn((
        Mesh3d(mesh),
        MeshMaterial3d(material),
        ClothCollider::sphere(0.2),
        Transform::from_xyz(0.2, 0.0, 0.8),
    ));
    app.update(3);
    assert!(pick(&mut app, middle).is_none(), "the sphere is in front");
    assert!(pick(&mut app, edge).is_some(), "nothing is in front");
    use_backend(&mut app, ClothPickingBackend::Ray);
    assert!(pick(&mut app, middle).is_some(), "the ray sees cloth alone");

    let hidden = app.picture();
    keep(&hidden, "hidden");
    assert!((0.02..0.5).contains(&difference(&open, &hidden, 8)));
    let [red, .., blue, _] = pixel(&open, middle.as_uvec2());
    assert!(red > blue);
    let [red, .., blue, _] = pixel(&hidden, middle.as_uvec2());
    assert!(blue > red);
}

/// Cloth that moves and is drawn between steps, in a renderer that works a frame behind.
#[test]
fn a_swinging_cloth_is_found() {
    let test = "a_swinging_cloth_is_found";
    let Some(mut app) = Offscreen::with_plugins(test, SIZE, |plugins| {
        plugins.enable::<PipelinedRenderingPlugin>()
    }) else {
        return;
    };
    let cloth = hang(&mut app);
    app.app
        .world_mut()
        .entity_mut(cloth)
        .insert(ClothMaterial::denim());
    app.app
        .insert_resource(ClothWind::steady(Vec3::new(0.0, 0.0, -2.0)));
    let camera = View::ALL[0].spawn(&mut app);
    use_backend(&mut app, ClothPickingBackend::Depth);
    let middle = SIZE.as_vec2() / 2.0 + 0.5;
    app.point(middle);
    app.update(20);
    let mut near = 0;
    let frames = 60;
    for _ in 0..frames {
        app.update(1);
        let (entity, hit) = hovered(&mut app).expect("the cloth fills the middle");
        assert_eq!((entity, hit.camera), (cloth, camera));
        let world = app.app.world_mut();
        let transform = *world.get::<GlobalTransform>(camera).expect("a camera");
        let ray = world
            .get::<Camera>(camera)
            .expect("a camera")
            .viewport_to_world(&transform, middle)
            .expect("a ray");
        let (particles, topology, bounds) = world
            .query::<(&ClothParticles, &ClothTopology, &ClothBounds)>()
            .get(world, cloth)
            .expect("a cloth");
        let exact = particles
            .cast_ray(topology, bounds, ray)
            .expect("the cloth fills the middle");
        let [a, b] = [exact.particle, extra(&hit).particle].map(|i| particles.position(i));
        near += usize::from(a.distance(b) < 0.1);
    }
    let swinging = app.picture();
    keep(&swinging, "swinging");
    println!("{near} of {frames} within a particle");
    assert!(near > frames * 9 / 10);
}

#[test]
fn nothing_is_left_of_what_is_gone() {
    let test = "nothing_is_left_of_what_is_gone";
    let Some(mut app) = Offscreen::new(test, SIZE) else {
        return;
    };
    let cloth = hang(&mut app);
    let camera = View::ALL[4].spawn(&mut app);
    app.update(10);
    pause(&mut app, true);
    use_backend(&mut app, ClothPickingBackend::Depth);
    let at = pixel_of(&app, camera, cloth, 312);
    assert!(pick(&mut app, at).is_some());

    // The pointer leaves the viewport: no hit, in the same frame.
    app.point(Vec2::new(20.5, 20.5));
    app.update(1);
    assert!(hovered(&mut app).is_none());
    assert!(pick(&mut app, at).is_some());

    // The viewport changes between question and answer.
    app.app
        .world_mut()
        .get_mut::<Camera>(camera)
        .expect("a camera")
        .viewport = None;
    app.update(4);
    let moved = pixel_of(&app, camera, cloth, 312);
    assert!(moved.distance(at) > 5.0);
    assert_eq!(
        extra(&pick(&mut app, moved).expect("a hit").1).particle,
        312
    );

    // Without a prepass there is nothing to ask.
    app.app
        .world_mut()
        .entity_mut(camera)
        .remove::<DepthPrepass>();
    app.update(1);
    assert!(hovered(&mut app).is_none());
    app.app.world_mut().entity_mut(camera).insert(DepthPrepass);
    assert!(pick(&mut app, moved).is_some());

    app.app.world_mut().despawn(cloth);
    app.update(1);
    assert!(hovered(&mut app).is_none());
    app.app.world_mut().despawn(camera);
    app.update(3);
    assert!(hovered(&mut app).is_none());
}
