//! The scenes: what hangs, blows or falls in each. The same functions feed the demo, the tests and the pictures.

use std::{f32::consts::FRAC_PI_2, fmt, str::FromStr};

use bevy::prelude::*;
use tailorbird::prelude::*;

pub use super::scene_assets::{MaterialOf, SceneAssets};
use super::{camera::OrbitCamera, character, crates, fan, garment, props, settings::DemoSettings};

/// Everything that a scene spawns, so that it can be cleared away.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct SceneEntity;

/// The cloth of a scene.
#[derive(Component, Clone, Copy, Debug)]
pub struct SceneCloth {
    /// Width and height [m].
    pub size: Vec2,
}

/// The ball of a scene.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct SceneSphere;

/// A scene of the demo.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum SceneKind {
    /// Hangs by its upper corners, in folds.
    #[default]
    Curtain,
    /// Blows in a gusty wind on a pole.
    Flag,
    /// Falls over a ball.
    Tablecloth,
    /// Held by its corners over a ball that the keys move.
    Ball,
    /// Worn by somebody who runs, jumps, and is put elsewhere now and then.
    Cape,
    /// Hangs from the yard of a boat that pitches and rolls.
    Banner,
    /// A skirt of two meshes and materials, from a glTF file, on a figure that the keys move.
    Garment,
    /// Bodies of a physics engine fall on a sheet that carries them.
    Crates,
    /// A silk curtain before a fan that turns to and fro.
    Fan,
}

impl SceneKind {
    /// All of them, in the order of the keys from 1 on.
    pub const ALL: [Self; 9] = [
        Self::Curtain,
        Self::Flag,
        Self::Tablecloth,
        Self::Ball,
        Self::Cape,
        Self::Banner,
        Self::Garment,
        Self::Crates,
        Self::Fan,
    ];

    /// Its name in the command line, the panel and the names of pictures.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Curtain => "curtain",
            Self::Flag => "flag",
            Self::Tablecloth => "tablecloth",
            Self::Ball => "ball",
            Self::Cape => "cape",
            Self::Banner => "banner",
            Self::Garment => "garment",
            Self::Crates => "crates",
            Self::Fan => "fan",
        }
    }

    /// The preset that it starts with.
    pub const fn preset(self) -> &'static str {
        match self {
            Self::Curtain | Self::Cape | Self::Banner | Self::Garment => "cotton",
            Self::Tablecloth => "canvas",
            Self::Flag | Self::Fan => "silk",
            Self::Ball | Self::Crates => "denim",
        }
    }

    /// The wind that it starts with.
    pub fn wind(self) -> ClothWind {
        match self {
            Self::Flag => ClothWind {
                gusts: ClothGusts {
                    strength: 0.4,
                    period: 3.0,
                },
                turbulence: ClothTurbulence {
                    speed: 1.2,
                    scale: 1.5,
                    seed: 1,
                },
                ..ClothWind::steady(Vec3::new(7.0, 0.0, 1.0))
            },
            // A breath of air, as through an open window.
            Self::Curtain => ClothWind {
                gusts: ClothGusts {
                    strength: 0.9,
                    period: 2.5,
                },
                ..ClothWind::steady(Vec3::new(0.2, 0.0, 0.9))
            },
            Self::Banner => ClothWind {
                gusts: ClothGusts {
                    strength: 0.5,
                    period: 2.0,
                },
                turbulence: ClothTurbulence {
                    speed: 0.5,
                    scale: 1.2,
                    seed: 2,
                },
                ..ClothWind::steady(Vec3::new(0.7, 0.0, 1.4))
            },
            Self::Tablecloth
            | Self::Ball
            | Self::Cape
            | Self::Garment
            | Self::Crates
            | Self::Fan => ClothWind::default(),
        }
    }

    /// Width and height of its cloth [m].
    pub const fn size(self) -> Vec2 {
        match self {
            Self::Curtain => Vec2::new(2.0, 1.5),
            Self::Flag => Vec2::new(1.8, 1.2),
            Self::Tablecloth | Self::Ball => Vec2::new(2.0, 2.0),
            Self::Cape => Vec2::new(1.1, 1.15),
            Self::Banner => Vec2::new(1.2, 1.5),
            Self::Garment => Vec2::new(1.0, 1.0),
            Self::Crates => Vec2::new(2.4, 2.4),
            Self::Fan => Vec2::new(2.4, 1.6),
        }
    }

    /// The dye of its cloth; denim has its own.
    pub const fn color(self) -> Color {
        match self {
            Self::Curtain => Color::srgb(0.62, 0.10, 0.12),
            Self::Flag => Color::srgb(0.93, 0.52, 0.10),
            Self::Tablecloth => Color::srgb(0.90, 0.88, 0.82),
            Self::Ball => Color::srgb(0.16, 0.38, 0.42),
            Self::Cape => Color::srgb(0.45, 0.07, 0.13),
            Self::Banner => Color::srgb(0.10, 0.30, 0.55),
            // It has materials of its own.
            Self::Garment => Color::WHITE,
            Self::Fan => Color::srgb(0.30, 0.56, 0.52),
            Self::Crates => Color::srgb(0.24, 0.30, 0.36),
        }
    }

    /// Radius of its ball at the start [m].
    pub const fn sphere_radius(self) -> f32 {
        match self {
            Self::Curtain => 0.25,
            Self::Flag | Self::Cape | Self::Banner | Self::Crates | Self::Fan => 0.2,
            Self::Garment => 0.1,
            Self::Tablecloth => 0.5,
            Self::Ball => 0.3,
        }
    }

    /// Position of its ball at the start, given the radius [m].
    pub fn sphere_position(self, radius: f32) -> Vec3 {
        match self {
            Self::Curtain => Vec3::new(0.0, radius, 1.1),
            Self::Flag => Vec3::new(-0.6, radius, 0.9),
            Self::Tablecloth => Vec3::new(0.0, radius, 0.0),
            Self::Ball => Vec3::new(0.0, 0.95, 0.0),
            Self::Cape => Vec3::new(0.0, radius, 0.0),
            Self::Banner => Vec3::new(-1.6, radius, 1.6),
            Self::Garment => Vec3::new(0.0, radius, 0.5),
            Self::Crates => Vec3::new(0.0, radius, 0.0),
            Self::Fan => Vec3::new(0.7, radius, 0.6),
        }
    }

    /// View of the scene at the start.
    pub fn view(self) -> OrbitCamera {
        let (focus, yaw, pitch, distance) = match self {
            Self::Curtain => (Vec3::new(0.0, 0.98, 0.0), 24.0, 8.0, 4.2),
            Self::Flag => (Vec3::new(0.8, 1.75, 0.0), -16.0, 2.0, 4.2),
            Self::Tablecloth => (Vec3::new(0.0, 0.42, 0.0), 30.0, 20.0, 3.7),
            Self::Ball => (Vec3::new(0.0, 0.85, 0.0), 28.0, 20.0, 4.3),
            Self::Cape => (Vec3::new(0.0, 0.95, 0.0), 20.0, 12.0, 4.6),
            Self::Banner => (Vec3::new(0.0, 1.45, 0.0), 25.0, 8.0, 7.5),
            Self::Garment => (Vec3::new(0.0, 0.64, 0.0), 55.0, 10.0, 2.7),
            Self::Crates => (Vec3::new(0.0, 1.05, 0.0), 28.0, 27.0, 5.6),
            Self::Fan => (Vec3::new(0.0, 1.0, 0.4), 38.0, 10.0, 4.9),
        };
        OrbitCamera::new(focus, yaw, pitch, distance)
    }

    /// Columns and rows with square cells, `longer` of them along the longer side.
    pub fn resolution(self, longer: u32) -> UVec2 {
        let size = self.size();
        let cells = (size / size.max_element() * longer.saturating_sub(1) as f32).round();
        cells.as_uvec2().max(UVec2::ONE) + 1
    }

    /// Its cloth at rest; none where that comes from a file.
    pub fn cloth(self, longer: u32) -> Option<Cloth> {
        let grid = Cloth::grid(self.size(), self.resolution(longer));
        match self {
            Self::Flag => Some(grid),
            Self::Curtain | Self::Cape | Self::Banner | Self::Fan => {
                Some(grid.with_origin(Vec2::new(0.5, 0.0)))
            }
            Self::Tablecloth | Self::Ball | Self::Crates => Some(grid.centered()),
            Self::Garment => None,
        }
    }

    /// Pins that hold it, with `longer` particles along the longer side.
    pub fn pins(self, longer: u32) -> ClothPins {
        match self {
            Self::Curtain => corners(&ClothCorner::TOP, Vec3::new(0.82, 0.0, 0.0)),
            Self::Flag => ClothPins::edges([ClothEdge::Left]),
            Self::Tablecloth | Self::Garment => ClothPins::default(),
            Self::Crates => corners(&ClothCorner::ALL, Vec3::new(1.1, 1.1, 0.0)),
            Self::Ball => corners(&ClothCorner::ALL, Vec3::new(0.9, 0.9, 0.0)),
            Self::Cape => character::collar(self.size().x, self.resolution(longer).x),
            Self::Banner => props::rings(self.resolution(longer).x),
            Self::Fan => fan::pleats(self.size().x, self.resolution(longer).x),
        }
    }

    /// Place of its cloth.
    pub fn transform(self) -> Transform {
        let flat = Quat::from_rotation_x(-FRAC_PI_2);
        match self {
            // Not quite upright, so that it swings into place.
            Self::Curtain => {
                Transform::from_xyz(0.0, 1.85, 0.0).with_rotation(Quat::from_rotation_x(-0.3))
            }
            Self::Flag => Transform::from_xyz(0.03, 2.5, 0.0),
            // A little askew, so that the folds are not symmetric.
            Self::Tablecloth => Transform::from_xyz(0.03, 1.3, 0.02)
                .with_rotation(Quat::from_rotation_y(0.3) * flat),
            Self::Ball => Transform::from_xyz(0.0, 1.35, 0.0).with_rotation(flat),
            Self::Crates => Transform::from_xyz(0.0, 1.6, 0.0).with_rotation(flat),
            Self::Garment => Transform::IDENTITY,
            Self::Cape => Transform::from_xyz(0.0, 0.21, 0.0).with_rotation(character::behind()),
            Self::Banner => Transform::from_xyz(0.0, 2.32, 0.07),
            Self::Fan => Transform::from_xyz(0.0, 1.9, 0.0),
        }
    }
}

impl fmt::Display for SceneKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for SceneKind {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let names = Self::ALL.map(Self::name).join(", ");
        Self::ALL
            .into_iter()
            .find(|scene| scene.name() == name)
            .ok_or_else(|| format!("no scene has this name; there are {names}"))
    }
}

/// Corners, each held at the same distance from the middle [m]: closer than the cloth is wide, so that it hangs in folds.
fn corners(which: &[ClothCorner], at: Vec3) -> ClothPins {
    let pins = which.iter().map(|&corner| {
        let sign = match corner {
            ClothCorner::TopLeft => Vec3::new(-1.0, 1.0, 0.0),
            ClothCorner::TopRight => Vec3::new(1.0, 1.0, 0.0),
            ClothCorner::BottomLeft => Vec3::new(-1.0, -1.0, 0.0),
            ClothCorner::BottomRight => Vec3::new(1.0, -1.0, 0.0),
        };
        ClothPin {
            target: Some(at * sign),
            ..ClothPin::new(ClothSelection::Corner(corner))
        }
    });
    ClothPins {
        pins: pins.collect(),
    }
}

/// Look of the scene's cloth. A fabric that has a colour of its own is not dyed.
pub fn look(settings: &DemoSettings) -> ClothLook {
    let fabric = ClothFabric::by_name(settings.preset).unwrap_or_default();
    let dye = match &*fabric.name {
        "silk" | "cotton" => settings.scene.color(),
        "denim" => Color::srgb(0.55, 0.60, 0.72),
        _ => Color::WHITE,
    };
    ClothLook {
        textured: settings.look.texture,
        ..ClothLook::new(fabric).with_dye(dye)
    }
}

/// Spawns a scene.
pub fn spawn_scene(commands: &mut Commands, settings: &DemoSettings, assets: &mut SceneAssets) {
    let scene = settings.scene;
    if scene == SceneKind::Garment {
        return garment::spawn(commands, settings, assets);
    }
    let cloth = spawn_cloth(commands, settings);
    spawn_sphere(commands, settings, assets);
    match scene {
        SceneKind::Curtain => props::spawn_rail(commands, assets),
        SceneKind::Flag => props::spawn_flagpole(commands, assets),
        SceneKind::Tablecloth | SceneKind::Garment => {}
        SceneKind::Ball => props::spawn_posts(commands, assets, 0.9, 1.35),
        SceneKind::Cape => {
            let chest = character::spawn(commands, assets);
            commands.entity(cloth).insert(character::inertia());
            commands.entity(chest).add_child(cloth);
        }
        SceneKind::Banner => {
            let boat = props::spawn_boat(commands, assets);
            commands.entity(boat).add_child(cloth);
        }
        SceneKind::Crates => {
            props::spawn_posts(commands, assets, 1.1, 1.6);
            crates::spawn(commands, assets);
        }
        SceneKind::Fan => fan::spawn(commands, assets),
    }
}

fn spawn_cloth(commands: &mut Commands, settings: &DemoSettings) -> Entity {
    let scene = settings.scene;
    let mut cloth = commands.spawn((
        Name::new(scene.name()),
        SceneEntity,
        SceneCloth { size: scene.size() },
        settings.material,
        settings.solver,
        settings.shading,
        scene.pins(settings.resolution),
        scene.transform(),
        look(settings),
    ));
    if let Some(shape) = scene.cloth(settings.resolution) {
        cloth.insert(shape);
    }
    cloth.id()
}

fn spawn_sphere(commands: &mut Commands, settings: &DemoSettings, assets: &mut SceneAssets) {
    let radius = settings.sphere_radius;
    commands.spawn((
        Name::new("ball"),
        SceneEntity,
        SceneSphere,
        ClothCollider::sphere(radius),
        ClothSphereControls::default(),
        Transform::from_translation(settings.scene.sphere_position(radius)),
        assets.sphere(radius),
        assets.painted(Color::srgb(0.78, 0.76, 0.72), 0.35, 0.0),
    ));
}
