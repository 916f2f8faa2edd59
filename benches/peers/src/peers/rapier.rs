//! The soft bodies of rapier3d.
//!
//! The sheet is what rapier's own generator for cloth makes: structural edges, both diagonals and skip-one edges along
//! rows and columns, 6 N² in all. A pass is one of rapier's solver iterations, that is a substep of its own, in which a
//! soft body by default asks for four sweeps over its constraints. Nothing is there to collide with, so the sheet has no
//! collider, and it never sleeps.

use rapier3d::prelude::*;

use super::Peer;
use crate::scene::{self, Sheet};

/// Natural frequency and damping ratio of all edges [Hz, -]: that of rapier's joints, so that the edges are as rigid as
/// the substeps allow.
const RIGID: [f32; 2] = [1e6, 1.0];

/// A world with a sheet in it.
pub struct Rapier {
    world: PhysicsWorld,
    sheet: SoftBodyHandle,
}

impl Rapier {
    /// The sheet at rest, with so many solver iterations in a step.
    pub fn new(sheet: Sheet, passes: u8) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::new(0.0, -scene::GRAVITY, 0.0);
        world.integration_parameters.dt = scene::STEP;
        world.integration_parameters.num_solver_iterations = passes.into();
        let [frequency, ratio] = RIGID;
        let (spacing, corner) = (sheet.spacing(), -scene::WIDTH / 2.0);
        let cloth = SoftBodyBuilder::cloth(
            Vector::new(corner, scene::Y, corner),
            Vector::new(0.0, 0.0, spacing),
            Vector::new(spacing, 0.0, 0.0),
            sheet.size,
            sheet.size,
        )
        .pinned_particles(sheet.pins().map(|i| i as u32))
        .mass(scene::AREAL_DENSITY * scene::WIDTH * scene::WIDTH)
        .softness(SpringCoefficients::new(frequency, ratio))
        .linear_damping(scene::DAMPING)
        .no_surface_collider()
        .can_sleep(false);
        let sheet = world.insert_soft_body(cloth);
        Self { world, sheet }
    }
}

impl Peer for Rapier {
    fn step(&mut self) {
        self.world.step();
    }

    fn positions(&self, into: &mut Vec<[f32; 3]>) {
        if let Some(sheet) = self.world.soft_bodies.get(self.sheet) {
            into.extend(sheet.particle_positions().map(|p| [p.x, p.y, p.z]));
        }
    }
}
