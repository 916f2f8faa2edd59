//! The scenes that snapshots are taken of.

use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec2, Vec3};
use bevy_transform::components::Transform;

use super::{Moves, Plays, PlaysBetweenSteps, Sinks, Turns};
use crate::prelude::*;

/// Puts the targets of a square on a wave.
fn wave(step: u32, mut cloth: EntityWorldMut) {
    let places = (0..576).map(|k| {
        let (x, y) = (k % 24, k / 24);
        let place = Vec3::new(x as f32, -(y as f32), 0.0) * (2.0 / 23.0);
        place + Vec3::Z * (0.1 * (0.1 * (step + k) as f32).sin())
    });
    let places: Vec<Vec3> = places.collect();
    if let Some(mut targets) = cloth.get_mut::<ClothMotionTargets>() {
        targets.set_positions(places);
    }
}

/// Scenes by their names.
pub fn scenes() -> [(&'static str, fn(&mut World)); 15] {
    fn square() -> (Cloth, ClothMaterial) {
        let cloth = Cloth::grid(Vec2::splat(2.0), UVec2::splat(24)).centered();
        (cloth, ClothMaterial::cotton())
    }
    fn lying() -> Transform {
        Transform::from_xyz(0.0, 1.0, 0.0).with_rotation(bevy_math::Quat::from_rotation_x(-1.57))
    }
    [
        ("wind", |world| {
            world.insert_resource(ClothWind {
                velocity: Vec3::new(6.0, 0.0, 2.0),
                turbulence: ClothTurbulence {
                    speed: 2.0,
                    ..ClothTurbulence::default()
                },
                ..ClothWind::default()
            });
            world.spawn((square(), ClothPins::edges([ClothEdge::Left])));
            world.spawn((square(), ClothSolver::GaussSeidel));
        }),
        ("falls on shapes", |world| {
            world.spawn((square(), lying()));
            world.spawn(ClothCollider::half_space());
            world.spawn((
                ClothCollider::sphere(0.3),
                Transform::from_xyz(0.3, 0.6, 0.1),
            ));
            world.spawn((
                ClothCollider::cuboid(0.3, 0.4, 0.5),
                Transform::from_xyz(-0.5, 0.5, 0.2),
            ));
        }),
        ("falls on an open mesh", |world| {
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            let positions = corners.map(|(x, z)| Vec3::new(x, 0.3 + 0.1 * x, z));
            let mesh = ClothCollider::trimesh(positions, [[0, 2, 1], [0, 3, 2]]);
            world.spawn(mesh.expect("triangles"));
            world.spawn((square(), lying()));
        }),
        ("more than it has", |world| {
            let pins = ClothPins::edges([ClothEdge::Top]);
            world.spawn((square(), pins, Transform::default()));
            world.spawn((
                ClothCollider::sphere(0.3),
                Transform::from_xyz(0.1, 0.0, 0.05),
            ));
        }),
        ("a shot", |world| {
            world.spawn((
                square(),
                ClothPins::edges([
                    ClothEdge::Top,
                    ClothEdge::Bottom,
                    ClothEdge::Left,
                    ClothEdge::Right,
                ]),
            ));
            world.spawn((
                ClothCollider::sphere(0.3),
                Moves(Vec3::new(0.1, 0.0, -1.0)),
                Transform::from_xyz(0.0, 0.0, 0.5),
            ));
        }),
        ("a body", |world| {
            let edges = [ClothEdge::Left, ClothEdge::Right];
            world.spawn((square(), lying(), ClothPins::edges(edges)));
            let body = world.spawn_empty().id();
            world.insert_resource(Sinks(1.35, body));
        }),
        ("limits", |world| {
            world.spawn((square(), lying(), ClothMotionConstraints::at_most(0.2)));
        }),
        ("held by what turns, and by springs", |world| {
            let pole = world
                .spawn((Transform::from_xyz(0.0, 2.0, 0.0), Turns(2.0)))
                .id();
            let at = Transform::from_xyz(0.0, 2.0, 0.0);
            let cloth = world.spawn((square(), at)).id();
            let [rigid, soft] =
                [ClothCorner::TopLeft, ClothCorner::TopRight].map(ClothSelection::Corner);
            for (selection, compliance) in [(rigid, 0.0), (soft, 0.01)] {
                let attachment = ClothAttachment {
                    selections: vec![selection],
                    compliance,
                    ..ClothAttachment::default()
                };
                world.spawn((attachment, ClothAttachmentOf(cloth), ClothAttachedTo(pole)));
            }
        }),
        ("sleeps, and is woken", |world| {
            let pins = ClothPins::edges([ClothEdge::Top]);
            world.spawn((
                square(),
                pins,
                ClothSleep {
                    speed: 10.0,
                    ..ClothSleep::default()
                },
            ));
            world.spawn((
                ClothCollider::sphere(0.1),
                Moves(Vec3::new(0.0, 0.0, -0.5)),
                Transform::from_xyz(0.0, 0.0, 1.2),
            ));
        }),
        ("sleeps at what holds it", |world| {
            let pole = world.spawn(Transform::default()).id();
            let still = ClothSleep {
                speed: 10.0,
                ..ClothSleep::default()
            };
            let cloth = world.spawn((square(), still, Transform::default())).id();
            let top = ClothSelection::Edge(ClothEdge::Top);
            let attachment = ClothAttachment {
                selections: vec![top],
                ..ClothAttachment::default()
            };
            world.spawn((attachment, ClothAttachmentOf(cloth), ClothAttachedTo(pole)));
            let limited = (square(), still, ClothMotionConstraints::at_most(0.0));
            world.spawn((limited, Transform::from_xyz(5.0, 0.0, 0.0)));
        }),
        ("in a hand", |world| {
            let pins = ClothPins::corners([ClothCorner::TopLeft]);
            world.spawn((
                square(),
                pins,
                Transform::default(),
                Plays(|step, mut cloth| {
                    let Some(mut grab) = cloth.get_mut::<ClothGrab>() else {
                        return;
                    };
                    match step {
                        40 => grab.take(300, 0.3, Vec3::new(0.3, 0.2, 0.4)),
                        41..110 => grab.move_to(Vec3::new(0.3 + 0.01 * step as f32, 0.2, 0.4)),
                        110 => grab.release(),
                        _ => {}
                    }
                }),
            ));
        }),
        ("pushed, reset, paused, written wrongly", |world| {
            world.spawn((
                square(),
                ClothPins::edges([ClothEdge::Left]),
                Plays(|step, mut cloth| {
                    if step < 30
                        && let Some(mut forces) = cloth.get_mut::<ClothForces>()
                    {
                        forces.add_force(300, Vec3::new(0.0, 0.1, 0.02 * step as f32));
                    }
                    cloth.world_scope(|world| {
                        let mut settings = world.resource_mut::<ClothSettings>();
                        match step {
                            50 => settings.gravity = Vec3::NAN,
                            60 => settings.paused = true,
                            70 => settings.paused = false,
                            120 => settings.gravity = Vec3::NEG_Y,
                            _ => {}
                        }
                    });
                }),
            ));
        }),
        ("targets that a step moves", |world| {
            let cloth = (square(), ClothMotionConstraints::at_most(0.05));
            world.spawn((cloth, ClothMotionTargets::default(), Plays(wave)));
        }),
        ("targets that a frame moves", |world| {
            let cloth = (square(), ClothMotionConstraints::at_most(0.05));
            world.spawn((
                cloth,
                ClothMotionTargets::default(),
                PlaysBetweenSteps(wave),
            ));
        }),
        ("a mesh of any triangles in a zone, seen no more", |world| {
            let points: Vec<Vec3> = (0..200)
                .map(|k| {
                    let (x, y) = (k % 20, k / 20);
                    let shift = 0.3 * ((k * 7919) % 13) as f32 / 13.0;
                    Vec3::new(0.1 * (x as f32 + shift), -0.1 * (y as f32 + shift), 0.0)
                })
                .collect();
            let cells = (0..19u32).flat_map(|x| (0..9u32).map(move |y| 20 * y + x));
            let corners = cells.flat_map(|k| [k, k + 20, k + 1, k + 1, k + 20, k + 21]);
            let near = ClothSelection::Within {
                center: Vec3::ZERO,
                radius: 0.25,
            };
            let pins = ClothPins {
                pins: vec![ClothPin::new(near)],
            };
            let cloth = Cloth::mesh(points, corners.collect::<Vec<_>>());
            let sleep = ClothSleep {
                unseen: true,
                ..ClothSleep::default()
            };
            world.spawn((
                cloth,
                pins,
                sleep,
                Moves(Vec3::X),
                Transform::default(),
                Plays(|step, mut cloth| {
                    cloth.insert(ClothSeen(!(80..130).contains(&step)));
                }),
            ));
            let zone = ClothWindZone::cuboid(Vec3::splat(6.0), Vec3::new(1.0, 0.0, 4.0));
            world.spawn((zone, Transform::from_xyz(1.0, 0.0, 0.0)));
        }),
    ]
}
