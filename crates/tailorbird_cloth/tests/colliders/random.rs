//! Whatever colliders do, cloth stays finite, and no particle is left inside one that is convex.

use bevy_math::{DVec2, DVec3, EulerRot, Isometry3d, Quat, UVec2, Vec2, Vec3};
use bevy_transform::components::Transform;
use proptest::prelude::*;
use tailorbird_cloth::prelude::*;
use tailorbird_test::{Scene, Sheet, rigid};

fn shape() -> impl Strategy<Value = ClothCollider> {
    let length = || prop_oneof![1e-4f32..1e-2, 0.01f32..2.0];
    prop_oneof![
        length().prop_map(ClothCollider::sphere),
        (length(), length()).prop_map(|(r, l)| ClothCollider::capsule(r, l)),
        (length(), length(), length())
            .prop_map(|(a, b, l)| ClothCollider::tapered_capsule(a, b, l)),
        (length(), length(), length()).prop_map(|(x, y, z)| ClothCollider::cuboid(x, y, z)),
        (length(), length()).prop_map(|(r, h)| ClothCollider::cylinder(r, h)),
        Just(ClothCollider::half_space()),
        prop::collection::vec((-1f32..1.0, -1f32..1.0, -1f32..1.0), 4..30).prop_map(|points| {
            let points: Vec<Vec3> = points.into_iter().map(Vec3::from).collect();
            ClothCollider::convex_hull(&points).unwrap_or(ClothCollider::sphere(0.1))
        }),
        prop::collection::vec((-1f32..1.0, -1f32..1.0, -1f32..1.0), 9..10).prop_map(|points| {
            let points: Vec<Vec3> = points.into_iter().map(Vec3::from).collect();
            let soup = [[0, 1, 2], [2, 3, 4], [4, 5, 6], [6, 7, 8], [0, 4, 8]];
            ClothCollider::trimesh(points, soup).unwrap_or(ClothCollider::sphere(0.1))
        }),
    ]
}

fn place() -> impl Strategy<Value = Transform> {
    let coordinate = || -1.5f32..1.5;
    let angle = || -3.1f32..3.1;
    (
        (coordinate(), coordinate(), coordinate()),
        (angle(), angle(), angle()),
    )
        .prop_map(|(at, (x, y, z))| {
            Transform::from_translation(at.into()).with_rotation(Quat::from_euler(
                EulerRot::XYZ,
                x,
                y,
                z,
            ))
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn random_colliders_that_jump_about_leave_cloth_finite(
        colliders in prop::collection::vec((shape(), place(), place()), 1..6),
    ) {
        let mut sheet = Sheet::new(&Scene {
            resolution: UVec2::splat(9),
            ..Scene::default()
        });
        let world = sheet.sim.app.world_mut();
        let entities: Vec<_> = colliders.iter().map(|(collider, at, _)| world.spawn((collider.clone(), *at)).id()).collect();
        sheet.steps(3);
        for (entity, (_, _, to)) in entities.iter().zip(&colliders) {
            sheet.sim.move_to(*entity, *to);
        }
        sheet.steps(5);
        let world = sheet.sim.app.world();
        let particles = world.get::<ClothParticles>(sheet.entity).expect("particles");
        prop_assert!(particles.points().iter().all(Vec3::is_finite));
        // Not even for a moment, after which it would have been reset.
        let status = world.get::<ClothStatus>(sheet.entity).expect("a status");
        prop_assert!(status.is_ok(), "{status:?}");
    }
}

/// A convex shape, of which this file knows the distance by formulas in double precision.
#[derive(Clone, Debug)]
enum Convex {
    Sphere(f32),
    /// Radii, and half of the way between the centres \[m\].
    Capsule(f32, f32, f32),
    Cuboid(Vec3),
    /// Radius and half height \[m\].
    Cylinder(f32, f32),
    Hull(Vec<Vec3>, Vec<[DVec3; 3]>),
}

impl Convex {
    fn collider(&self) -> ClothCollider {
        match self {
            Self::Sphere(radius) => ClothCollider::sphere(*radius),
            Self::Capsule(a, b, half) if a == b => ClothCollider::capsule(*a, 2.0 * half),
            Self::Capsule(a, b, half) => ClothCollider::tapered_capsule(*a, *b, 2.0 * half),
            Self::Cuboid(half) => ClothCollider::cuboid(2.0 * half.x, 2.0 * half.y, 2.0 * half.z),
            Self::Cylinder(radius, half) => ClothCollider::cylinder(*radius, 2.0 * half),
            Self::Hull(points, _) => ClothCollider::convex_hull(points).expect("a hull"),
        }
    }

    /// Of a ball around the origin that holds it \[m\].
    fn reach(&self) -> f32 {
        match self {
            Self::Sphere(radius) => *radius,
            Self::Capsule(a, b, half) => half + a.max(*b),
            Self::Cuboid(half) => half.length(),
            Self::Cylinder(radius, half) => radius.hypot(*half),
            Self::Hull(points, _) => points.iter().map(|p| p.length()).fold(0.0, f32::max),
        }
    }

    /// Distance of a point from the surface, negative inside \[m\].
    fn distance(&self, p: DVec3) -> f64 {
        match self {
            Self::Sphere(radius) => p.length() - f64::from(*radius),
            Self::Capsule(a, b, half) => {
                let [a, b, half] = [a, b, half].map(|v| f64::from(*v));
                // The distance from the balls on the axis is convex along it.
                let ball = |t: f64| {
                    let y = half * (2.0 * t - 1.0);
                    p.distance(DVec3::Y * y) - (a + t * (b - a))
                };
                let (mut low, mut high) = (0.0, 1.0);
                for _ in 0..80 {
                    let third = (high - low) / 3.0;
                    if ball(low + third) < ball(high - third) {
                        high -= third;
                    } else {
                        low += third;
                    }
                }
                ball(low).min(ball(0.0)).min(ball(1.0))
            }
            Self::Cuboid(half) => {
                let q = p.abs() - half.as_dvec3();
                q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
            }
            Self::Cylinder(radius, half) => {
                let size = DVec2::new(f64::from(*radius), f64::from(*half));
                let q = DVec2::new(p.x.hypot(p.z), p.y.abs()) - size;
                q.max(DVec2::ZERO).length() + q.max_element().min(0.0)
            }
            Self::Hull(_, faces) => {
                let above = |[a, b, c]: &[DVec3; 3]| (b - a).cross(c - a).normalize().dot(p - a);
                let above = faces.iter().map(above).fold(f64::MIN, f64::max);
                let away = faces.iter().map(|face| p.distance(nearest(*face, p)));
                if above < 0.0 {
                    above
                } else {
                    away.fold(f64::MAX, f64::min)
                }
            }
        }
    }
}

/// The point of a triangle that is nearest to another.
fn nearest(corners: [DVec3; 3], p: DVec3) -> DVec3 {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).normalize();
    let inside = |from: DVec3, to: DVec3| normal.cross(to - from).dot(p - from) >= 0.0;
    if inside(a, b) && inside(b, c) && inside(c, a) {
        return p - normal * normal.dot(p - a);
    }
    let on = |(from, to): (DVec3, DVec3)| {
        let displacement = to - from;
        from + displacement
            * ((p - from).dot(displacement) / displacement.length_squared()).clamp(0.0, 1.0)
    };
    let sides = [(a, b), (b, c), (c, a)].map(on);
    let nearer = |q: DVec3, r: DVec3| if p.distance(q) < p.distance(r) { q } else { r };
    nearer(nearer(sides[0], sides[1]), sides[2])
}

/// The triangles between three of some points that have no other in front.
fn faces(points: &[Vec3]) -> Vec<[DVec3; 3]> {
    let points: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
    let mut faces = Vec::new();
    for (i, a) in points.iter().enumerate() {
        for (j, b) in points.iter().enumerate() {
            for c in points.iter().skip(i.max(j) + 1).filter(|_| i != j) {
                let normal = (b - a).cross(c - a);
                let front = |p: &DVec3| normal.dot(p - a) > 1e-9 * normal.length();
                if normal.length() > 1e-9 && !points.iter().any(front) {
                    faces.push([*a, *b, *c]);
                }
            }
        }
    }
    faces
}

fn convex() -> impl Strategy<Value = Convex> {
    let size = || 0.05f32..0.5;
    let half = || 0.025f32..0.25;
    let point = move || (-0.25f32..0.25, -0.25f32..0.25, -0.25f32..0.25);
    prop_oneof![
        size().prop_map(Convex::Sphere),
        (half(), half()).prop_map(|(r, h)| Convex::Capsule(r, r, h)),
        (half(), half(), half()).prop_map(|(a, b, h)| Convex::Capsule(a, b, h)),
        (half(), half(), half()).prop_map(|(x, y, z)| Convex::Cuboid(Vec3::new(x, y, z))),
        (half(), half()).prop_map(|(r, h)| Convex::Cylinder(r, h)),
        (prop::collection::vec(point(), 4..12), point()).prop_filter_map(
            "flat",
            |(points, squeeze)| {
                let squeeze = (4.0 * Vec3::from(squeeze)).abs().max(Vec3::splat(0.2));
                let points: Vec<Vec3> = points
                    .into_iter()
                    .map(|p| squeeze * Vec3::from(p))
                    .collect();
                let hull = ClothCollider::convex_hull(&points).ok()?;
                let ClothColliderShape::ConvexHull(hull) = &hull.shape else {
                    return None;
                };
                (hull.volume() > 1e-5).then(|| Convex::Hull(points.clone(), faces(&points)))
            }
        ),
    ]
}

/// A convex collider on a straight way.
#[derive(Clone, Debug)]
struct Thing {
    shape: Convex,
    /// Rotation as the part of a compound, if it is one.
    part: Option<Quat>,
    margin: f32,
    friction: f32,
    /// Scaled alike along all axes.
    at: Transform,
    /// [m/s].
    velocity: Vec3,
    /// [rad/s].
    spin: Vec3,
}

impl Thing {
    fn collider(&self) -> ClothCollider {
        let shape = self.shape.collider();
        let collider = self.part.map_or(shape.clone(), |turn| {
            let at = Isometry3d::new(Vec3::ZERO, turn);
            ClothCollider::compound([(at, shape.shape)]).expect("a part")
        });
        collider
            .with_margin(self.margin)
            .with_friction(self.friction)
    }

    fn reach(&self) -> f32 {
        self.shape.reach() * self.at.scale.x
    }

    fn pose(&self, seconds: f32) -> Transform {
        let turn = Quat::from_scaled_axis(self.spin * seconds);
        Transform::from_translation(self.at.translation + self.velocity * seconds)
            .with_rotation((turn * self.at.rotation).normalize())
            .with_scale(self.at.scale)
    }

    fn distance(&self, pose: Transform, p: Vec3) -> f64 {
        let scale = f64::from(pose.scale.x);
        let away = (p.as_dvec3() - pose.translation.as_dvec3()) / scale;
        let inverse = |turn: Quat| turn.as_dquat().normalize().inverse();
        let local = inverse(self.part.unwrap_or_default()) * (inverse(pose.rotation) * away);
        scale * self.shape.distance(local)
    }
}

fn thing() -> impl Strategy<Value = Thing> {
    let vector = |most: f32| (-most..most, -most..most, -most..most).prop_map(Vec3::from);
    let or_none = move |most: f32| prop_oneof![Just(Vec3::ZERO), vector(0.2 * most), vector(most)];
    let margin = prop_oneof![Just(0.0f32), 0.0f32..0.05];
    let place = (-0.4f32..0.4, -0.4f32..0.4, -0.7f32..0.0, place());
    let part = prop::option::weighted(0.3, self::place().prop_map(|at| at.rotation));
    let scale = prop_oneof![Just(1.0f32), 0.7f32..1.5];
    let motion = (or_none(8.0), or_none(20.0));
    (convex(), part, scale, margin, 0.0f32..1.5, place, motion).prop_map(
        |(shape, part, scale, margin, friction, (x, y, z, turn), (velocity, spin))| Thing {
            shape,
            part,
            margin,
            friction,
            at: Transform::from_xyz(x, y, z)
                .with_rotation(turn.rotation)
                .with_scale(Vec3::splat(scale)),
            velocity,
            spin,
        },
    )
}

/// One, or two that never come nearer to each other than the cloth needs room between them.
fn things() -> impl Strategy<Value = Vec<Thing>> {
    let toward = (-1f32..1.0, -1f32..1.0, -1f32..1.0).prop_map(Vec3::from);
    let two =
        (thing(), thing(), toward, 0.01f32..0.3).prop_map(|(first, mut other, toward, gap)| {
            let room = first.margin + other.margin + 2.0 * rigid().thickness;
            let apart = first.reach() + other.reach() + room + gap;
            let toward = toward.try_normalize().unwrap_or(Vec3::X);
            other.at.translation = first.at.translation + toward * apart;
            other.velocity = first.velocity;
            vec![first, other]
        });
    prop_oneof![thing().prop_map(|thing| vec![thing]), two]
}

/// A sheet of a metre: a grid, or triangles of all sizes with holes between them.
fn cloth() -> impl Strategy<Value = Cloth> {
    let grid =
        (3u32..26, 3u32..26).prop_map(|(x, y)| Cloth::grid(Vec2::ONE, UVec2::new(x, y)).centered());
    let vertex = || (-0.4f32..0.4, -0.4f32..0.4, -0.05f32..0.05, 0u8..10);
    let mesh = (4usize..18)
        .prop_flat_map(move |n| (Just(n), prop::collection::vec(vertex(), n * n)))
        .prop_map(|(n, vertices)| {
            let cell = 1.0 / (n - 1) as f32;
            let place = |(i, (x, y, z, _)): (usize, &(f32, f32, f32, u8))| {
                let at = Vec2::new((i % n) as f32 + x, (i / n) as f32 + y) * cell - 0.5;
                at.extend(*z)
            };
            let positions: Vec<Vec3> = vertices.iter().enumerate().map(place).collect();
            let mut indices = Vec::new();
            for i in (0..n * (n - 1)).filter(|i| i % n + 1 < n) {
                let [a, b, c, d] = [i, i + 1, i + n, i + n + 1].map(|i| i as u32);
                match vertices[i].3 {
                    0 => indices.extend([a, b, d]),
                    1..5 => indices.extend([a, b, d, a, d, c]),
                    _ => indices.extend([a, b, c, b, d, c]),
                }
            }
            Cloth::mesh(positions, indices)
        });
    prop_oneof![grid, mesh]
}

/// Tolerance for the rounding of coordinates of less than 8 m, after some additions \[m\].
const ROUNDING: f64 = 5e-6;

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_particle_is_left_inside_a_convex_collider(
        things in things(),
        cloth in cloth(),
        speed in prop_oneof![Just(0.0f32), 0.0f32..30.0],
        classic in prop::bool::weighted(0.3),
        held in any::<bool>(),
    ) {
        let mut sheet = Sheet::new(&Scene {
            cloth: Some(cloth),
            pins: ClothPins::particles(held.then_some(0)),
            ..Scene::default()
        });
        let solver = if classic { ClothSolver::GaussSeidel } else { ClothSolver::Chains };
        sheet.insert(solver);
        // Some begin inside.
        sheet.sim.resource_mut::<ClothSettings>().overlap_speed = f32::INFINITY;
        let particles = sheet.particles().len() as u32;
        sheet.change(|forces: &mut ClothForces| {
            for i in 0..particles {
                forces.add_acceleration(i, Vec3::NEG_Z * speed * 60.0);
            }
        });
        let entities: Vec<_> = things.iter().map(|thing| {
                sheet.sim.spawn((thing.collider(), thing.pose(0.0)))
            }).collect();
        for step in 0..40u8 {
            let poses: Vec<_> = things.iter().map(|thing| thing.pose(f32::from(step) / 60.0)).collect();
            for (entity, pose) in entities.iter().zip(&poses) {
                sheet.sim.move_to(*entity, *pose);
            }
            sheet.step();
            prop_assert_eq!(sheet.complaint(), None);
            // What has drawn an edge out to four times its length may go through.
            if sheet.stretch().max > 3.0 {
                return Ok(());
            }
            let particles = sheet.particles();
            for i in (0..particles.len()).filter(|i| !particles.is_held(*i)) {
                let p = particles.position(i);
                for (thing, pose) in things.iter().zip(&poses) {
                    let distance = thing.distance(*pose, p);
                    // What one of two pushes out may come nearer to the other; alone each keeps its distance.
                    let least = if things.len() == 1 {
                        f64::from(thing.margin + rigid().thickness) - ROUNDING
                    } else {
                        -0.001
                    };
                    prop_assert!(
                        distance > least,
                        "particle {} in step {}: {} m from {:?}", i, step, distance, thing
                    );
                }
            }
        }
    }
}
