//! The command line. Every value is checked here, so that a wrong one is named with its flag (exit code 2).

use std::path::PathBuf;

use bevy_math::Vec3;
use clap::{Parser, ValueEnum};
use tailorbird_cloth::prelude::*;

pub use super::demands::Scene;
use super::{
    demands::{Demands, Held},
    values,
};

/// A cloth without a renderer: simulates a sheet of 2 m × 2 m, horizontal at y = 1 at the start, and prints figures.
#[derive(Parser, Clone, Debug)]
#[command(name = "headless", version)]
pub struct Args {
    /// Scene.
    #[arg(long, value_enum, default_value_t = Scene::Hang)]
    pub scene: Scene,

    /// Particles along each side.
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = values::size, allow_hyphen_values = true)]
    pub size: u32,

    /// Description of the sheet.
    #[arg(long, value_enum, default_value_t = Mesh::Grid)]
    pub mesh: Mesh,

    /// Pinned particles: the corners (0, 0) and (0, N−1), or row 0 [default: that of the scene].
    #[arg(long, value_enum)]
    pub pins: Option<Pins>,

    /// Number of steps to simulate [default: 300, or as long as the scene lasts].
    #[arg(long, value_name = "S", allow_hyphen_values = true)]
    pub steps: Option<u32>,

    /// Steps in a second [1/s].
    #[arg(long, value_name = "HZ", default_value_t = 60.0, value_parser = values::hz, allow_hyphen_values = true)]
    pub hz: f64,

    /// Substeps in a step [default: as many as the solver needs at this size].
    #[arg(long, value_name = "n", value_parser = values::substeps, allow_hyphen_values = true)]
    pub substeps: Option<u32>,

    /// Passes over the constraints in a substep.
    #[arg(long, value_name = "k", default_value_t = ClothSettings::default().iterations,
          value_parser = values::iterations, allow_hyphen_values = true)]
    pub iterations: u32,

    /// Method by which the constraints are solved.
    #[arg(long, value_enum, default_value_t = Solver::Chains)]
    pub solver: Solver,

    /// Material of the sheet; the values below count all the same [default: cotton that does not stretch].
    #[arg(long, value_name = "NAME", value_parser = material, allow_hyphen_values = true)]
    pub material: Option<ClothMaterial>,

    /// Acceleration downwards [m/s²].
    #[arg(long, value_name = "G", default_value_t = 9.81, value_parser = values::finite, allow_hyphen_values = true)]
    pub gravity: f32,

    /// Rate at which motion decays [1/s] [default: the material's].
    #[arg(long, value_name = "D", value_parser = values::not_negative, allow_hyphen_values = true)]
    pub damping: Option<f32>,

    /// Velocity of the air [m/s]; 0,0,0 is no air at all [default: 8,0,2 in the scene flag, else 0,0,0].
    #[arg(long, value_name = "x,y,z", value_parser = values::vector, allow_hyphen_values = true)]
    pub wind: Option<Vec3>,

    /// Middle and radius of a sphere [m] [default: 0,0.45,0,0.5 in the scene drape, else none].
    #[arg(long, value_name = "x,y,z,r", value_parser = sphere, allow_hyphen_values = true)]
    pub sphere: Option<Sphere>,

    /// The instructions that the kernels use.
    #[arg(long, value_enum, default_value_t = Isa::Auto)]
    pub isa: Isa,

    /// Compliance along warp and weft [m/N] [default: 0, or the material's].
    #[arg(long, value_name = "A", value_parser = values::not_negative, allow_hyphen_values = true)]
    pub compliance: Option<f32>,

    /// Compliance in shear [m/N] [default: the material's; 0 without one for gauss-seidel].
    #[arg(long, value_name = "A", value_parser = values::not_negative, allow_hyphen_values = true)]
    pub shear_compliance: Option<f32>,

    /// Compliance in bending [1/(N m)] [default: the material's; 0 without one for gauss-seidel].
    #[arg(long, value_name = "A", value_parser = values::not_negative, allow_hyphen_values = true)]
    pub bend_compliance: Option<f32>,

    /// Friction inside the fabric [m²/s] [default: the material's].
    #[arg(long, value_name = "V", value_parser = values::not_negative, allow_hyphen_values = true)]
    pub viscosity: Option<f32>,

    /// Mass per area [kg/m²] [default: the material's].
    #[arg(long, value_name = "R", value_parser = values::positive, allow_hyphen_values = true)]
    pub density: Option<f32>,

    /// Demands of the scenes.
    #[command(flatten)]
    pub demands: Demands,

    /// Threads of the compute pool [default: one for each core].
    #[arg(long, value_name = "T", value_parser = values::threads, allow_hyphen_values = true)]
    pub threads: Option<u32>,

    /// Other than 0: nudges each particle up or down during the first step, by up to 0.1 mm, differently for each seed.
    #[arg(
        long,
        value_name = "I",
        default_value_t = 0,
        allow_hyphen_values = true
    )]
    pub seed: u64,

    /// Prints JSON instead of a table.
    #[arg(long)]
    pub json: bool,

    /// Writes where the particles are in the world after the last step: step,row,column,x,y,z [m].
    #[arg(long, value_name = "FILE")]
    pub dump: Option<PathBuf>,

    /// Writes the start and every K-th step to the dump as well.
    #[arg(long, value_name = "K", requires = "dump", value_parser = values::every, allow_hyphen_values = true)]
    pub dump_every: Option<u32>,
}

/// Description of the sheet.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mesh {
    /// Columns and rows.
    Grid,
    /// Triangles: the same particles in random order, cells cut along random diagonals, triangles in random order.
    Shuffled,
    /// Triangles, in random order, whose inner corners lie irregularly.
    Irregular,
}

/// Particles that are held.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pins {
    /// (0, 0) and (0, N−1).
    Corners,
    /// Row 0.
    Edge,
    /// The whole border.
    Border,
    /// None.
    None,
}

/// Method by which the constraints are solved.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solver {
    /// One after the other, in batches that share no particle.
    GaussSeidel,
    /// Whole lines of edges at once.
    Chains,
}

/// The instructions that the kernels use.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Isa {
    /// The best of this machine.
    Auto,
    /// One number at a time.
    Scalar,
    /// 4 numbers at a time.
    Sse2,
    /// 8 numbers at a time.
    Avx2,
    /// 16 numbers at a time.
    Avx512,
}

impl From<Isa> for ClothInstructionSet {
    fn from(isa: Isa) -> Self {
        match isa {
            Isa::Auto => Self::Auto,
            Isa::Scalar => Self::Scalar,
            Isa::Sse2 => Self::Sse2,
            Isa::Avx2 => Self::Avx2,
            Isa::Avx512 => Self::Avx512,
        }
    }
}

/// A sphere in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its middle [m].
    pub center: Vec3,
    /// Its radius [m].
    pub radius: f32,
}

impl Args {
    /// The pins asked for, or those of the scene.
    pub fn pins(&self) -> Pins {
        self.pins.unwrap_or(match self.scene {
            Scene::Hang | Scene::Drag => Pins::Corners,
            Scene::Net => Pins::Border,
            Scene::Drape | Scene::Free | Scene::Posts | Scene::PutBack => Pins::None,
            Scene::Tube | Scene::Overlap => Pins::None,
            Scene::PauseMove | Scene::Hop if self.demands.held == Held::Attached => Pins::None,
            _ => Pins::Edge,
        })
    }

    /// The wind asked for, or that of the scene [m/s].
    pub fn wind(&self) -> Vec3 {
        self.wind.unwrap_or(match self.scene {
            Scene::Flag => Vec3::new(8.0, 0.0, 2.0),
            _ => Vec3::ZERO,
        })
    }

    /// Material of the sheet.
    ///
    /// The springs of the classic scheme are rigid, as they always were; the chain solver's sheet folds because its shear and bending are
    /// as soft as a fabric's.
    pub fn material(&self) -> ClothMaterial {
        let rigid = ClothMaterial {
            warp_compliance: 0.0,
            weft_compliance: 0.0,
            ..ClothMaterial::cotton()
        };
        let base = self.material.unwrap_or(match self.solver {
            Solver::GaussSeidel => ClothMaterial {
                shear_compliance: 0.0,
                bend_compliance: 0.0,
                ..rigid
            },
            Solver::Chains => rigid,
        });
        ClothMaterial {
            areal_density: self.density.unwrap_or(base.areal_density),
            warp_compliance: self.compliance.unwrap_or(base.warp_compliance),
            weft_compliance: self.compliance.unwrap_or(base.weft_compliance),
            shear_compliance: self.shear_compliance.unwrap_or(base.shear_compliance),
            bend_compliance: self.bend_compliance.unwrap_or(base.bend_compliance),
            damping: self.damping.unwrap_or(base.damping),
            viscosity: self.viscosity.unwrap_or(base.viscosity),
            ..base
        }
    }

    /// Number of steps to simulate.
    pub fn steps(&self) -> u32 {
        let seconds = self.scene.seconds(&self.demands);
        let of_scene = seconds.map_or(300, |seconds| (seconds * self.hz).round() as u32);
        self.steps.unwrap_or(of_scene)
    }

    /// The sphere asked for, or that of the scene.
    pub fn sphere(&self) -> Option<Sphere> {
        self.sphere.or(match self.scene {
            Scene::Drape => Some(Sphere {
                center: Vec3::new(0.0, 0.45, 0.0),
                radius: 0.5,
            }),
            _ => None,
        })
    }
}

fn material(text: &str) -> Result<ClothMaterial, String> {
    let presets = ClothMaterial::presets();
    let found = presets.iter().find(|(name, _)| *name == text);
    found.map(|(_, material)| *material).ok_or_else(|| {
        let names = presets.map(|(name, _)| name).join(", ");
        format!("must be one of {names}")
    })
}

fn sphere(text: &str) -> Result<Sphere, String> {
    let [x, y, z, radius] = values::numbers(text)?;
    if radius <= 0.0 {
        return Err(format!("the radius {radius} must be above 0"));
    }
    Ok(Sphere {
        center: Vec3::new(x, y, z),
        radius,
    })
}
