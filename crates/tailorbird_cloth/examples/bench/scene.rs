//! Scenes to measure, and the apps for them.

use std::f32::consts::FRAC_PI_2;

use bevy_app::{App, FixedPostUpdate, TaskPoolOptions, TaskPoolPlugin};
use bevy_ecs::prelude::*;
use bevy_math::{Quat, UVec2, Vec2, Vec3};
use bevy_time::{Fixed, Time, TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;
use tailorbird_cloth::prelude::*;

use super::cli::{Args, What};

/// Steps in a second \[1/s\].
const HZ: f64 = 60.0;

/// Flags, and particles along a side of each.
const FLAGS: (u32, u32) = (1000, 32);

/// Of the chain solver; `None` is as many as it chooses itself.
const SUBSTEPS: [Option<u32>; 5] = [None, Some(2), Some(4), Some(8), Some(16)];

/// Scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scene {
    Hang,
    Drape,
    DrapePinned,
    Flags,
}

impl Scene {
    pub fn name(self) -> &'static str {
        match self {
            Self::Hang => "hang",
            Self::Drape => "drape",
            Self::DrapePinned => "drape-pinned",
            Self::Flags => "flags",
        }
    }

    /// 5 s; 1 s of flags, as a step of a thousand takes its time.
    pub fn steps(self) -> u32 {
        match self {
            Self::Hang | Self::Drape | Self::DrapePinned => 300,
            Self::Flags => 60,
        }
    }
}

/// One measurement.
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    pub scene: Scene,
    pub size: u32,
    pub solver: ClothSolver,
    pub substeps: Option<u32>,
    pub iterations: u32,
}

/// All that is asked for.
pub fn setups(args: &Args) -> Vec<Setup> {
    let scenes: &[Scene] = match args.what {
        What::Hang => &[Scene::Hang],
        What::Drape => &[Scene::Drape, Scene::DrapePinned],
        What::Flags => &[Scene::Flags],
        What::Kernels | What::Colliders | What::Substep => &[],
        What::All => &[Scene::Hang, Scene::Drape, Scene::DrapePinned, Scene::Flags],
    };
    let mut setups = Vec::new();
    for &scene in scenes {
        let sizes = match (scene, args.size) {
            (Scene::Flags, _) => vec![FLAGS.1],
            (_, Some(size)) => vec![size],
            (_, None) => vec![64, 128, 256, 512],
        };
        for size in sizes {
            let chains = SUBSTEPS.map(|substeps| (ClothSolver::Chains, substeps, 1));
            let iterations: &[u32] = match (scene, size) {
                // More take minutes.
                (Scene::Flags, _) => &[5, 15],
                (_, ..=128) => &[5, 15, 30, 60],
                (_, 129..=256) => &[15],
                _ => &[],
            };
            let classic = iterations
                .iter()
                .map(|&iterations| (ClothSolver::GaussSeidel, Some(1), iterations));
            setups.extend(chains.into_iter().chain(classic).map(
                |(solver, substeps, iterations)| Setup {
                    scene,
                    size,
                    solver,
                    substeps,
                    iterations,
                },
            ));
        }
    }
    setups
}

impl Setup {
    /// 2 m × 2 m, or a flag of 1.5 m × 1 m.
    pub fn cloth(&self) -> Cloth {
        let size = match self.scene {
            Scene::Flags => Vec2::new(1.5, 1.0),
            _ => Vec2::splat(2.0),
        };
        Cloth::grid(size, UVec2::splat(self.size)).centered()
    }

    fn material(&self) -> ClothMaterial {
        let rigid = ClothMaterial {
            areal_density: 0.15,
            warp_compliance: 0.0,
            weft_compliance: 0.0,
            damping: 0.3,
            ..ClothMaterial::cotton()
        };
        match self.solver {
            ClothSolver::Chains => rigid,
            ClothSolver::GaussSeidel => ClothMaterial {
                shear_compliance: 0.0,
                bend_compliance: 0.0,
                ..rigid
            },
        }
    }

    /// An app whose updates are steps, at its start.
    pub fn app(&self, args: &Args) -> App {
        let mut app = App::new();
        let mut pools = TaskPoolOptions::default();
        if let Some(threads) = args.threads {
            pools.compute.min_threads = threads as usize;
            pools.compute.max_threads = threads as usize;
        }
        app.add_plugins((
            TaskPoolPlugin {
                task_pool_options: pools,
            },
            TimePlugin,
            ClothPlugin::default(),
        ));
        let fixed = Time::<Fixed>::from_hz(HZ);
        let timestep = fixed.timestep();
        app.insert_resource(fixed)
            .insert_resource(TimeUpdateStrategy::ManualDuration(timestep))
            .insert_resource(ClothSettings {
                substeps: self.substeps,
                iterations: self.iterations,
                instruction_set: match self.solver {
                    ClothSolver::Chains => args.isa.into(),
                    ClothSolver::GaussSeidel => ClothInstructionSet::Scalar,
                },
                ..Default::default()
            })
            .insert_resource(match self.scene {
                Scene::Flags => ClothWind::steady(Vec3::new(8.0, 0.0, 2.0)),
                _ => ClothWind::vacuum(),
            });
        self.spawn(app.world_mut());
        app.finish();
        app.cleanup();
        // The clock stands still.
        app.world_mut().run_schedule(FixedPostUpdate);
        app.update();
        app
    }

    fn spawn(&self, world: &mut World) {
        let flat =
            Transform::from_xyz(0.0, 1.0, 0.0).with_rotation(Quat::from_rotation_x(-FRAC_PI_2));
        let corners = ClothPins::corners(ClothCorner::TOP);
        let pins = match self.scene {
            Scene::Hang | Scene::DrapePinned => corners,
            Scene::Drape => ClothPins::default(),
            Scene::Flags => ClothPins::edges([ClothEdge::Left]),
        };
        if matches!(self.scene, Scene::Drape | Scene::DrapePinned) {
            let at = Transform::from_xyz(0.0, 0.45, 0.0);
            world.spawn((ClothCollider::sphere(0.5), at));
        }
        let bundle = |at: Transform| {
            let awake = ClothSleep::never();
            (
                self.cloth(),
                self.material(),
                self.solver,
                pins.clone(),
                awake,
                at,
            )
        };
        if self.scene == Scene::Flags {
            for k in 0..FLAGS.0 {
                let (row, column) = (k / 40, k % 40);
                let at = Vec3::new(column as f32, 0.0, row as f32) * 2.0;
                world.spawn(bundle(Transform::from_translation(at)));
            }
        } else {
            world.spawn(bundle(flat));
        }
    }
}
