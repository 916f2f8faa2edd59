//! The state of all particles of one cloth.

use std::ops::Deref;

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_reflect::prelude::*;
use tailorbird_solver::{particles::Particles, topology::Topology};

use crate::frame::ClothFrame;

/// The state of all particles of one cloth, in the cloth's frame: see [`Particles`].
///
/// Particles have the numbers of [`Cloth::rest_positions`](crate::cloth::Cloth::rest_positions), but where *storage order* is
/// written: see [`ParticleOrder`](tailorbird_solver::topology::order::ParticleOrder).
///
/// Read it freely. It is written by the cloth systems alone: pins, grabs and [`ClothForces`](crate::forces::ClothForces)
/// are the ways to move it.
#[derive(Component, Reflect, Clone, Debug, Default)]
#[reflect(Component, Default)]
pub struct ClothParticles(#[reflect(ignore)] pub(crate) Particles);

impl Deref for ClothParticles {
    type Target = Particles;

    fn deref(&self) -> &Particles {
        &self.0
    }
}

impl ClothParticles {
    /// Particles at rest, without mass yet.
    pub(crate) fn at_rest(topology: &Topology) -> Self {
        Self(Particles::at_rest(topology))
    }

    /// Position of a particle in the world \[m\].
    ///
    /// # Panics
    /// When `i` is out of range.
    pub fn world_position(&self, i: usize, frame: &ClothFrame) -> Vec3 {
        frame.to_world(self.position(i))
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use bevy_app::{App, FixedPostUpdate, FixedUpdate, TaskPoolPlugin};
    use bevy_math::{UVec2, Vec2};
    use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy};
    use bevy_transform::components::Transform;
    use tailorbird_solver::particles::Scratch;

    use super::*;
    use crate::prelude::*;

    /// An app in which each update is a step.
    fn app() -> App {
        let mut app = App::new();
        app.add_plugins((
            TaskPoolPlugin::default(),
            TimePlugin,
            ClothPlugin::default(),
        ));
        let fixed = Time::<Fixed>::from_hz(60.0);
        let step = fixed.timestep();
        app.insert_resource(fixed)
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
        app.update();
        app.insert_resource(TimeUpdateStrategy::ManualDuration(step));
        app
    }

    /// Moves at this velocity [m/s].
    #[derive(Component)]
    struct Moves(Vec3);

    fn go(time: Res<Time>, mut movers: Query<(&Moves, &mut Transform)>) {
        for (moves, mut place) in &mut movers {
            place.translation += time.delta_secs() * moves.0;
        }
    }

    /// A body that is pushed down into what lies below.
    #[derive(Resource)]
    struct Sinks(f32, Entity);

    fn sink(sinks: Option<ResMut<Sinks>>, mut colliders: ResMut<ExternalColliders>) {
        let Some(mut sinks) = sinks else {
            return;
        };
        let at = |height| bevy_math::Isometry3d::from_translation(Vec3::new(0.05, height, -0.02));
        let (start, end) = (at(sinks.0), at(sinks.0 - 0.002));
        sinks.0 -= 0.002;
        colliders.push(ExternalCollider {
            entity: sinks.1,
            part: 0,
            shape: ColliderShape::Sphere { radius: 0.3 },
            friction: 0.5,
            margin: 0.0,
            layers: ClothLayers::ALL,
            start,
            end,
            body: Some(ColliderBody {
                body: sinks.1,
                inv_mass: Vec3::splat(0.5),
                inv_inertia: bevy_math::Mat3::from_diagonal(Vec3::splat(14.0)),
                center_of_mass: Vec3::from(end.translation),
                linear_velocity: Vec3::NEG_Y * 0.12,
                angular_velocity: Vec3::ZERO,
            }),
        });
    }

    fn spoil(mut cloths: Query<&mut ClothParticles>) {
        for mut particles in &mut cloths {
            particles.bypass_change_detection().0.scratch = Scratch::default();
        }
    }

    /// The bits of all cloths after each of some steps.
    fn bits(steps: usize, spoils: bool, scene: &dyn Fn(&mut World)) -> Vec<Vec<u32>> {
        let mut app = app();
        app.add_systems(FixedUpdate, (go, sink));
        if spoils {
            app.add_systems(FixedPostUpdate, spoil.before(ClothSystems::Prepare));
        }
        scene(app.world_mut());
        (0..steps)
            .map(|_| {
                app.update();
                let mut cloths = app.world_mut().query::<&ClothParticles>();
                let points = cloths
                    .iter(app.world())
                    .flat_map(|particles| particles.positions());
                points
                    .flat_map(|p| p.to_array())
                    .map(f32::to_bits)
                    .collect()
            })
            .collect()
    }

    fn scenes() -> [(&'static str, fn(&mut World)); 7] {
        fn square() -> (Cloth, ClothMaterial) {
            let cloth = Cloth::grid(Vec2::splat(2.0), UVec2::splat(24)).centered();
            (cloth, ClothMaterial::cotton())
        }
        fn lying() -> Transform {
            Transform::from_xyz(0.0, 1.0, 0.0)
                .with_rotation(bevy_math::Quat::from_rotation_x(-1.57))
        }
        [
            ("wind", |world| {
                world.insert_resource(Wind {
                    velocity: Vec3::new(6.0, 0.0, 2.0),
                    turbulence: Turbulence {
                        speed: 2.0,
                        ..Turbulence::default()
                    },
                    ..Wind::default()
                });
                world.spawn((square(), ClothPins::edges([GridEdge::Left])));
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
                let pins = ClothPins::edges([GridEdge::Top]);
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
                        GridEdge::Top,
                        GridEdge::Bottom,
                        GridEdge::Left,
                        GridEdge::Right,
                    ]),
                ));
                world.spawn((
                    ClothCollider::sphere(0.3),
                    Moves(Vec3::new(0.1, 0.0, -1.0)),
                    Transform::from_xyz(0.0, 0.0, 0.5),
                ));
            }),
            ("a body", |world| {
                let edges = [GridEdge::Left, GridEdge::Right];
                world.spawn((square(), lying(), ClothPins::edges(edges)));
                let body = world.spawn_empty().id();
                world.insert_resource(Sinks(1.35, body));
            }),
            ("limits", |world| {
                world.spawn((square(), lying(), ClothMotionConstraints::within(0.2)));
            }),
        ]
    }

    /// Scratch of a step has no effect on the next one.
    #[test]
    fn scratch_can_be_dropped_before_each_step() {
        for (name, scene) in scenes() {
            let [kept, dropped] = [false, true].map(|spoils| bits(150, spoils, &scene));
            let differs = kept.iter().zip(&dropped).position(|(a, b)| a != b);
            assert_eq!(differs, None, "{name}: first step that differs");
        }
    }
}
