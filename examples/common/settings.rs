//! Everything that the panel, the keys and the scripts change, as plain data. [`apply`](super::apply) carries it over
//! to the world, [`settings_file`](super::settings_file) to a file and back.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};
use tailorbird::prelude::*;

use super::{scenes::SceneKind, settings_file as file};

/// The name of a preset. An alias, or serde would want to borrow it from the file.
pub type PresetName = &'static str;

/// Everything that a player can set.
#[derive(Resource, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DemoSettings {
    /// Scene that is shown.
    #[serde(
        serialize_with = "file::write_scene",
        deserialize_with = "file::read_scene"
    )]
    pub scene: SceneKind,
    /// Number of times that the scene was started anew. A change starts it again.
    #[serde(skip)]
    pub resets: u32,
    /// Particles along the longer side of the cloth.
    pub resolution: u32,
    /// The name of the preset that was chosen last.
    #[serde(rename = "fabric", deserialize_with = "file::read_preset")]
    pub preset: PresetName,
    /// Material of the cloth.
    pub material: ClothMaterial,
    /// Shading of the cloth.
    pub shading: ClothShading,
    /// Acceleration of gravity, downwards [m/s²].
    pub gravity: f32,
    /// Solver of the constraints.
    pub solver: ClothSolver,
    /// Substeps of a step, where they are not chosen automatically.
    #[serde(with = "file::Substeps")]
    pub substeps: Option<u32>,
    /// Iterations of a substep.
    pub iterations: u32,
    /// True if time stands still.
    pub paused: bool,
    /// Number of single steps that were asked for. A change does as many steps.
    #[serde(skip)]
    pub single_steps: u32,
    /// The air.
    pub wind: ClothWind,
    /// Radius of the ball [m].
    pub sphere_radius: f32,
    /// Speed at which the keys move the ball [m/s].
    pub sphere_speed: f32,
    /// Distance from the grabbed particle within which cloth is pulled along [m].
    pub grab_radius: f32,
    /// Parts that are drawn.
    pub look: Look,
    /// Method that finds the cloth under the pointer.
    #[serde(with = "file::Picking")]
    pub picking: ClothPickingBackend,
    /// True if a second cloth hangs beside the first, held by the other solver. Goes with the scene.
    #[serde(skip)]
    pub beside: bool,
}

/// Parts that are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Look {
    /// The weave, or a plain colour.
    pub texture: bool,
    /// The triangles' edges.
    pub wireframe: bool,
    /// Particles as points.
    pub particles: bool,
    /// Stretch constraints as lines.
    pub stretch: bool,
    /// Shear constraints as lines.
    pub shear: bool,
    /// Bend constraints as lines.
    pub bend: bool,
    /// Pins as crosses.
    pub pins: bool,
    /// Normals as lines.
    pub normals: bool,
    /// The box around the cloth.
    pub bounds: bool,
    /// The shapes of colliders.
    pub colliders: bool,
    /// Zones of wind, and arrows for the air.
    pub air: bool,
    /// Blur of what is nearer or farther than what the camera looks at.
    pub depth_of_field: bool,
    /// Of the lens: its focal length over the width of its opening; the smaller, the more is blurred.
    pub f_number: f32,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            texture: true,
            wireframe: false,
            particles: false,
            stretch: false,
            shear: false,
            bend: false,
            pins: false,
            normals: false,
            bounds: false,
            colliders: false,
            air: false,
            depth_of_field: false,
            f_number: 1.0,
        }
    }
}

impl Default for DemoSettings {
    fn default() -> Self {
        Self::of(SceneKind::Curtain)
    }
}

impl DemoSettings {
    /// The scene with its own material and wind.
    pub fn of(scene: SceneKind) -> Self {
        let solver = ClothSettings::default();
        let mut settings = Self {
            scene,
            resets: 0,
            resolution: 128,
            preset: "",
            material: ClothMaterial::default(),
            shading: ClothShading::Smooth,
            gravity: -solver.gravity.y,
            solver: ClothSolver::default(),
            substeps: solver.substeps,
            iterations: solver.iterations,
            paused: false,
            single_steps: 0,
            wind: ClothWind::default(),
            sphere_radius: 0.0,
            sphere_speed: 1.5,
            grab_radius: 0.06,
            look: Look::default(),
            picking: ClothPickingBackend::Ray,
            beside: false,
        };
        settings.show(scene);
        settings
    }

    /// Shows a scene with its own material, wind and ball. What concerns the solver and the looks stays.
    pub fn show(&mut self, scene: SceneKind) {
        self.scene = scene;
        self.resets += 1;
        self.beside = false;
        self.choose_preset(scene.preset());
        self.wind = scene.wind();
        self.sphere_radius = scene.sphere_radius();
    }

    /// Starts the scene anew, with the settings as they are.
    pub fn reset(&mut self) {
        self.resets += 1;
    }

    /// Takes over settings that were loaded, and starts their scene.
    pub fn take_over(&mut self, loaded: Self) {
        *self = Self {
            resets: self.resets + 1,
            single_steps: self.single_steps,
            ..loaded
        };
    }

    /// Shows the scene this many places further in the list, which goes round.
    pub fn show_next(&mut self, places: isize) {
        let count = SceneKind::ALL.len() as isize;
        let at = SceneKind::ALL.iter().position(|scene| *scene == self.scene);
        let next = (at.unwrap_or(0) as isize + places).rem_euclid(count);
        self.show(SceneKind::ALL[next as usize]);
    }

    /// The solver of the second cloth.
    pub fn other_solver(&self) -> ClothSolver {
        match self.solver {
            ClothSolver::Chains => ClothSolver::GaussSeidel,
            ClothSolver::GaussSeidel => ClothSolver::Chains,
        }
    }

    /// Takes over a preset; does nothing when there is none of this name.
    pub fn choose_preset(&mut self, name: &str) {
        let presets = ClothMaterial::presets();
        if let Some((name, material)) = presets.into_iter().find(|(known, _)| *known == name) {
            self.preset = name;
            self.material = material;
        }
    }
}

impl Look {
    /// Allowed f-numbers of the lens.
    pub const F_NUMBERS: std::ops::RangeInclusive<f32> = 0.2..=16.0;

    /// All that can be shown, by name.
    pub fn toggles(&mut self) -> [(&'static str, &mut bool); 12] {
        [
            ("texture", &mut self.texture),
            ("wireframe", &mut self.wireframe),
            ("particles", &mut self.particles),
            ("stretch", &mut self.stretch),
            ("shear", &mut self.shear),
            ("bend", &mut self.bend),
            ("pins", &mut self.pins),
            ("normals", &mut self.normals),
            ("bounds", &mut self.bounds),
            ("colliders", &mut self.colliders),
            ("air", &mut self.air),
            ("depth-of-field", &mut self.depth_of_field),
        ]
    }

    /// Shows or hides something by name; logs when there is nothing of this name.
    pub fn set(&mut self, name: &str, shown: bool) {
        match self.toggles().into_iter().find(|(known, _)| *known == name) {
            Some((_, value)) => *value = shown,
            None => warn!("nothing to show or hide is named {name:?}"),
        }
    }
}
