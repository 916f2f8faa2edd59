//! Whole steps.

use bevy_math::{UVec2, Vec2};

use super::*;
use crate::{
    coefficients::{Coefficients, Method},
    contact::{
        colliders::{ColliderId, Layers, MovingCollider},
        solid::Solid,
    },
    held::{Held, HeldBy, HolderKind},
    holds::Holds,
    shape::ClothShape,
    tethers::Tethers,
    topology::{Topology, copies::ParticleCopy, order::Stored, test_meshes},
    workers::Workers,
};

const LAYERS: Layers = Layers {
    memberships: 1,
    filters: 1,
};

const SECONDS: f32 = 1.0 / 60.0;

/// A cloth and what belongs to it.
#[derive(Clone)]
struct Owned {
    topology: Topology,
    coefficients: Coefficients,
    tethers: Tethers,
    holds: Holds,
    frame: Frame,
    particles: Particles,
}

impl Owned {
    /// A sheet of 1 m that is held by its upper corners.
    fn sheet(side: u32) -> Self {
        let shape = ClothShape::Grid {
            size: Vec2::ONE,
            resolution: UVec2::splat(side),
            origin: Vec2::ZERO,
        };
        Self::of(&shape, &[0, side - 1])
    }

    /// A mesh of about `side`² vertices in a square of 1 m, two of which are held.
    fn mesh(side: usize) -> Self {
        let (positions, triangles) = test_meshes::delaunay(side, 3);
        let shape = ClothShape::Mesh {
            positions,
            indices: triangles.into_flattened(),
            uvs: Vec::new(),
            weld_distance: 0.0,
        };
        Self::of(&shape, &[0, 1])
    }

    fn of(shape: &ClothShape, held: &[u32]) -> Self {
        let topology = Topology::build(shape, Vec3::ONE).expect("valid");
        let coefficients = Coefficients {
            areal_density: 0.2,
            bend_compliance: 1e4,
            shear_compliance: 1e-3,
            viscosity: 1e-4,
            friction: 0.4,
            margin: 0.01,
            ..Coefficients::default()
        };
        let mut particles = Particles::at_rest(&topology);
        let held = held.iter().map(|&particle| Held {
            particle: Stored(particle),
            by: HeldBy::Pin(topology.rest_positions[particle as usize]),
        });
        particles.hold(HolderKind::Pin, held);
        particles.set_masses(topology.areas(), coefficients.areal_density);
        Self {
            topology,
            coefficients,
            tethers: Tethers::default(),
            holds: Holds::default(),
            frame: Frame::default(),
            particles,
        }
    }

    fn cloth(&mut self) -> ClothData<'_> {
        ClothData {
            topology: &self.topology,
            coefficients: &self.coefficients,
            method: Method::Lines,
            layers: LAYERS,
            tethers: &self.tethers,
            holds: &mut self.holds,
            limits: None,
            forces: None,
            frame: &mut self.frame,
            particles: &mut self.particles,
        }
    }

    fn bits(&self) -> Vec<u32> {
        let all = self.particles.positions();
        all.flat_map(|p| p.to_array()).map(f32::to_bits).collect()
    }
}

fn ball() -> Colliders {
    let at = Isometry3d::from_translation(Vec3::new(0.5, -0.5, 0.1));
    let ball = MovingCollider {
        id: ColliderId {
            owner: 1,
            part: (0, 0),
        },
        solid: Solid::Sphere { radius: 0.2 },
        friction: 0.3,
        margin: 0.0,
        layers: LAYERS,
        start: at,
        end: at,
        body: None,
    };
    Colliders {
        boxes: vec![ball.swept_box()],
        colliders: vec![ball],
        bodies: Vec::new(),
    }
}

/// Takes cloths through a step among colliders.
fn go(colliders: &Colliders, group: &mut [&mut Owned]) {
    let count = 8;
    let nth = |index| Substep {
        level: Level::new(),
        seconds: SECONDS / count as f32,
        index,
        count,
        iterations: 1,
        gravity: Vec3::NEG_Y * 9.81,
        overlap_speed: 1.0,
        workers: Workers::ALONE,
    };
    for owned in &mut *group {
        owned.particles.begin_step();
    }
    let mut cloths: Vec<ClothData> = group.iter_mut().map(|owned| owned.cloth()).collect();
    step(count, nth, colliders, &mut cloths);
}

#[test]
fn cloths_of_a_group_that_do_not_meet_do_as_each_alone() {
    let (mut a, mut b) = (Owned::sheet(17), Owned::sheet(12));
    let (mut alone_a, mut alone_b) = (a.clone(), b.clone());
    for _ in 0..60 {
        go(&ball(), &mut [&mut a, &mut b]);
        go(&ball(), &mut [&mut alone_b]);
        go(&ball(), &mut [&mut alone_a]);
    }
    assert!(a.bits() == alone_a.bits() && b.bits() == alone_b.bits());
}

#[test]
fn a_particle_that_is_split_off_falls_by_itself() {
    for (viscosity, is_mesh) in [(0.0, false), (1e-4, false), (0.0, true), (1e-4, true)] {
        let mut whole = if is_mesh {
            Owned::mesh(14)
        } else {
            Owned::sheet(17)
        };
        whole.coefficients.viscosity = viscosity;
        let mut torn = whole.clone();
        let copy = ParticleCopy { of: 40, part: 0.5 };
        torn.topology = torn.topology.with_copies(&[copy]);
        torn.particles.append(&[copy]);
        let last = whole.particles.len();
        let mass = |owned: &Owned, i: usize| owned.particles.input.mass[i];
        let half = 0.5 * mass(&whole, 40);
        assert_eq!([40, last].map(|i| mass(&torn, i)), [half; 2]);
        let density = torn.coefficients.areal_density;
        torn.particles.set_masses(torn.topology.areas(), density);
        assert!(
            [40, last]
                .iter()
                .all(|i| (mass(&torn, *i) - half).abs() < 1e-6 * half)
        );
        let (start, steps) = (torn.particles.state.position.get(last), 20);
        for _ in 0..steps {
            go(&Colliders::default(), &mut [&mut whole]);
            go(&Colliders::default(), &mut [&mut torn]);
        }
        let [whole, torn] = [whole, torn].map(|owned| owned.particles.state.position);
        let away = |i: usize| whole.get(i).distance(torn.get(i));
        // A sheet with a particle of half the mass.
        let away = (0..last).map(away).fold(0.0, f32::max);
        assert!(away < 0.05, "{away} m, mesh: {is_mesh}");
        let seconds = SECONDS * steps as f32;
        let fallen = start - torn.get(last);
        let expected = 0.5 * 9.81 * seconds * seconds;
        assert!(fallen.x.abs() + fallen.z.abs() < 1e-5, "{fallen}");
        assert!((fallen.y - expected).abs() < 0.02 * expected, "{fallen}");
    }
}

#[test]
fn a_report_names_the_first_particle_that_is_not_finite() {
    let mut sheet = Owned::sheet(9);
    sheet.particles.state.previous_position.set(70, Vec3::NAN);
    sheet
        .particles
        .state
        .position
        .set(33, Vec3::Y * f32::INFINITY);
    let report = Report::of(Level::new(), &sheet.particles);
    assert_eq!(report.non_finite, Some(Stored(33)));
}
