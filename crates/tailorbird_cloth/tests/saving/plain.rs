//! Values without anything to check.

use bevy_ecs::entity::Entity;
use bevy_math::{UVec2, Vec2, Vec3};
use tailorbird_cloth::prelude::*;

use crate::{comes_back, read, through_json};

#[test]
fn shapes_come_back() {
    comes_back(&Cloth::grid(Vec2::new(1.5, 0.75), UVec2::new(7, 9)).with_origin(Vec2::splat(0.3)));
    let corners = [Vec3::ZERO, Vec3::X, Vec3::new(0.1, 1.0 / 3.0, -0.2)];
    comes_back(&Cloth {
        shape: ClothShape::Mesh {
            positions: corners.to_vec(),
            indices: vec![0, 1, 2],
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::new(0.25, 1.0)],
            weld_distance: 0.002,
        },
    });
}

#[test]
fn a_shape_without_its_options_has_their_defaults() {
    let grid: Cloth = read("(shape: Grid(size: (2, 1), resolution: (3, 4)))");
    assert_eq!(grid, Cloth::grid(Vec2::new(2.0, 1.0), UVec2::new(3, 4)));
    let mesh: Cloth =
        read("(shape: Mesh(positions: [(0, 0, 0), (1, 0, 0), (0, 1, 0)], indices: [0, 1, 2]))");
    assert_eq!(mesh, Cloth::mesh([Vec3::ZERO, Vec3::X, Vec3::Y], [0, 1, 2]));
}

#[test]
fn materials_come_back() {
    for (_, material) in ClothMaterial::presets() {
        comes_back(&material);
    }
    let heavy: ClothMaterial = read("(areal_density: 2)");
    assert_eq!(
        heavy,
        ClothMaterial {
            areal_density: 2.0,
            ..ClothMaterial::default()
        }
    );
}

#[test]
fn pins_come_back() {
    let mut pins = ClothPins::corners(ClothCorner::ALL)
        .with(ClothPin::at(7, Vec3::new(0.1, 0.2, 0.3)))
        .with(ClothPin::new(ClothSelection::Particles(vec![1, 2, 3])))
        .with(ClothPin::new(ClothSelection::Cell(UVec2::new(2, 3))))
        .with(ClothPin::new(ClothSelection::Within {
            center: Vec3::X,
            radius: 0.25,
        }))
        .with(ClothPin {
            author: ClothPinAuthor::User,
            ..ClothPin::at(9, Vec3::Y)
        });
    for edge in [
        ClothEdge::Top,
        ClothEdge::Bottom,
        ClothEdge::Left,
        ClothEdge::Right,
    ] {
        pins = pins.with(ClothPin::new(ClothSelection::Edge(edge)));
    }
    comes_back(&pins);
    let written_by_hand: ClothPins = read("(pins: [(selection: Corner(TopLeft))])");
    assert_eq!(written_by_hand, ClothPins::corners([ClothCorner::TopLeft]));
}

#[test]
fn weights_shading_and_solver_come_back() {
    comes_back(&ClothWeights {
        weights: vec![0.0, 0.1, 1.0],
    });
    for shading in [ClothShading::Smooth, ClothShading::Flat] {
        comes_back(&shading);
    }
    for solver in [ClothSolver::Chains, ClothSolver::GaussSeidel] {
        comes_back(&solver);
    }
}

#[test]
fn inertia_and_sleep_come_back() {
    let inertia = ClothInertia {
        linear: 0.1,
        angular: 0.2,
        centrifugal: 0.3,
        max_speed: 8.0,
        max_angular_speed: 3.0,
        teleport_speed: 50.0,
        teleport_angle: 1.5,
        teleport: ClothTeleportMode::Reset,
    };
    comes_back(&inertia);
    assert_eq!(read::<ClothInertia>("()"), ClothInertia::default());
    comes_back(&ClothSleep {
        enabled: false,
        speed: 0.02,
        seconds: 2.5,
        unseen: true,
    });
    assert_eq!(read::<ClothSleep>("(enabled: false)"), ClothSleep::never());
}

/// JSON has no infinity: it says `null` where there is no limit.
#[test]
fn what_has_no_limit_comes_back_without_one() {
    comes_back(&ClothInertia::default());
    comes_back(&ClothMotionConstraints::default());
    let free = ClothPerParticle::Each(vec![0.0, f32::INFINITY, 2.0]);
    comes_back(&free);
    comes_back(&ClothPerParticle::All(f32::INFINITY));
    assert_eq!(
        serde_json::to_string(&free).unwrap(),
        r#"{"Each":[0.0,null,2.0]}"#
    );
}

#[test]
fn settings_come_back() {
    for instruction_set in [
        ClothInstructionSet::Auto,
        ClothInstructionSet::Scalar,
        ClothInstructionSet::Sse2,
        ClothInstructionSet::Avx2,
        ClothInstructionSet::Avx512,
    ] {
        comes_back(&ClothSettings {
            gravity: Vec3::new(0.1, -1.62, 0.0),
            substeps: Some(12),
            most_substeps: 40,
            substep_budget: 70_000,
            iterations: 3,
            instruction_set,
            time_scale: 0.5,
            paused: true,
            pending_steps: 2,
            overlap_speed: 0.3,
            teleport_speed: 12.0,
        });
    }
    assert_eq!(read::<ClothSettings>("()"), ClothSettings::default());
}

#[test]
fn wind_comes_back() {
    let gusts = ClothGusts {
        strength: 0.4,
        period: 1.7,
    };
    let turbulence = ClothTurbulence {
        speed: 0.6,
        scale: 0.9,
        seed: 3,
    };
    for model in [ClothWindModel::Aerodynamic, ClothWindModel::Classic] {
        comes_back(&ClothWind {
            velocity: Vec3::new(1.0, 0.2, -3.0),
            gusts,
            turbulence,
            model,
            air_density: 1.1,
        });
    }
    for shape in [
        ClothWindShape::Cuboid {
            size: Vec3::new(1.0, 2.0, 3.0),
        },
        ClothWindShape::Sphere { radius: 4.0 },
    ] {
        comes_back(&ClothWindZone {
            shape,
            velocity: Vec3::Z,
            falloff: 0.5,
            gusts,
            turbulence,
        });
    }
    let breeze: ClothWind = read("(velocity: (1, 0, 0), gusts: (strength: 0.5))");
    assert_eq!(breeze.gusts.period, ClothGusts::default().period);
    assert_eq!(breeze.air_density, ClothWind::default().air_density);
}

#[test]
fn attachments_come_back() {
    let edge = ClothAttachment::edge(ClothEdge::Left);
    comes_back(&edge);
    comes_back(&ClothAttachment {
        compliance: 0.01,
        ..edge.with_points([Vec3::X, Vec3::Y]).with_break_force(30.0)
    });
    let entity = Entity::from_raw_u32(12).unwrap();
    comes_back(&ClothAttachmentOf(entity));
    comes_back(&ClothAttachedTo(entity));
}

#[test]
fn motion_constraints_and_targets_come_back() {
    comes_back(&ClothMotionConstraints::at_most(vec![0.0, 0.5, 1.0]).with_backstop(0.01, 0.3));
    for space in [ClothTargetSpace::Frame, ClothTargetSpace::World] {
        let mut targets = ClothMotionTargets::in_space(space);
        targets.set([Vec3::X, Vec3::Y], [Vec3::Z, Vec3::NEG_Z]);
        comes_back(&targets);
    }
}

/// Small numbers keep their digits in a file.
#[test]
fn numbers_come_back_with_all_their_bits() {
    let odd = ClothMaterial {
        bend_compliance: f32::from_bits(0x3eaa_aaab),
        friction: f32::from_bits(1),
        ..ClothMaterial::default()
    };
    let back = through_json(&odd);
    assert_eq!(back.friction.to_bits(), 1);
    comes_back(&odd);
}
