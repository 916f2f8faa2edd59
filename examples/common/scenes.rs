//! The four scenes: what hangs, blows or falls in each. The same functions feed the demo, the tests and the pictures.

use std::{f32::consts::FRAC_PI_2, fmt, str::FromStr};

use bevy::{ecs::system::SystemParam, prelude::*};
use tailorbird::prelude::*;

use super::{camera::OrbitCamera, fabric::Fabrics, settings::DemoSettings};

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
}

impl SceneKind {
    /// All four, in the order of the keys 1 to 4.
    pub const ALL: [Self; 4] = [Self::Curtain, Self::Flag, Self::Tablecloth, Self::Ball];

    /// Its name in the command line, the panel and the names of pictures.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Curtain => "curtain",
            Self::Flag => "flag",
            Self::Tablecloth => "tablecloth",
            Self::Ball => "ball",
        }
    }

    /// The preset that it starts with.
    pub const fn preset(self) -> &'static str {
        match self {
            Self::Curtain | Self::Tablecloth => "cotton",
            Self::Flag => "silk",
            Self::Ball => "denim",
        }
    }

    /// The wind that it starts with.
    pub fn wind(self) -> Wind {
        match self {
            Self::Flag => Wind {
                gusts: Gusts {
                    strength: 0.5,
                    period: 3.0,
                },
                ..Wind::steady(Vec3::new(7.0, 0.0, 1.0))
            },
            // A breath of air, as through an open window.
            Self::Curtain => Wind {
                gusts: Gusts {
                    strength: 0.9,
                    period: 2.5,
                },
                ..Wind::steady(Vec3::new(0.2, 0.0, 0.9))
            },
            Self::Tablecloth | Self::Ball => Wind::default(),
        }
    }

    /// Width and height of its cloth [m].
    pub const fn size(self) -> Vec2 {
        match self {
            Self::Curtain => Vec2::new(2.0, 1.5),
            Self::Flag => Vec2::new(1.8, 1.2),
            Self::Tablecloth | Self::Ball => Vec2::new(2.0, 2.0),
        }
    }

    /// The dye of its cloth; denim has its own.
    pub const fn color(self) -> Color {
        match self {
            Self::Curtain => Color::srgb(0.62, 0.10, 0.12),
            Self::Flag => Color::srgb(0.93, 0.52, 0.10),
            Self::Tablecloth => Color::srgb(0.90, 0.88, 0.82),
            Self::Ball => Color::srgb(0.16, 0.38, 0.42),
        }
    }

    /// Radius of its ball at the start [m].
    pub const fn sphere_radius(self) -> f32 {
        match self {
            Self::Curtain => 0.25,
            Self::Flag => 0.2,
            Self::Tablecloth => 0.5,
            Self::Ball => 0.3,
        }
    }

    /// Where its ball is at the start, given the radius [m].
    pub fn sphere_position(self, radius: f32) -> Vec3 {
        match self {
            Self::Curtain => Vec3::new(0.0, radius, 1.1),
            Self::Flag => Vec3::new(-0.6, radius, 0.9),
            Self::Tablecloth => Vec3::new(0.0, radius, 0.0),
            Self::Ball => Vec3::new(0.0, 0.95, 0.0),
        }
    }

    /// Where it is looked at from.
    pub fn view(self) -> OrbitCamera {
        let (focus, yaw, pitch, distance) = match self {
            Self::Curtain => (Vec3::new(0.0, 0.98, 0.0), 24.0, 8.0, 4.2),
            Self::Flag => (Vec3::new(0.8, 1.75, 0.0), -16.0, 2.0, 4.2),
            Self::Tablecloth => (Vec3::new(0.0, 0.42, 0.0), 30.0, 20.0, 3.7),
            Self::Ball => (Vec3::new(0.0, 0.85, 0.0), 28.0, 20.0, 4.3),
        };
        OrbitCamera::new(focus, yaw, pitch, distance)
    }

    /// Columns and rows with square cells, `longer` of them along the longer side.
    pub fn resolution(self, longer: u32) -> UVec2 {
        let size = self.size();
        let cells = (size / size.max_element() * longer.saturating_sub(1) as f32).round();
        cells.as_uvec2().max(UVec2::ONE) + 1
    }

    /// Its cloth at rest.
    pub fn cloth(self, longer: u32) -> Cloth {
        let grid = Cloth::grid(self.size(), self.resolution(longer));
        match self {
            Self::Flag => grid,
            Self::Curtain => grid.with_origin(Vec2::new(0.5, 0.0)),
            Self::Tablecloth | Self::Ball => grid.centered(),
        }
    }

    /// What holds it.
    pub fn pins(self) -> ClothPins {
        match self {
            Self::Curtain => corners(&GridCorner::TOP, Vec3::new(0.82, 0.0, 0.0)),
            Self::Flag => ClothPins::edges([GridEdge::Left]),
            Self::Tablecloth => ClothPins::default(),
            Self::Ball => corners(&GridCorner::ALL, Vec3::new(0.9, 0.9, 0.0)),
        }
    }

    /// Where its cloth is.
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
fn corners(which: &[GridCorner], at: Vec3) -> ClothPins {
    let pins = which.iter().map(|&corner| {
        let sign = match corner {
            GridCorner::TopLeft => Vec3::new(-1.0, 1.0, 0.0),
            GridCorner::TopRight => Vec3::new(1.0, 1.0, 0.0),
            GridCorner::BottomLeft => Vec3::new(-1.0, -1.0, 0.0),
            GridCorner::BottomRight => Vec3::new(1.0, -1.0, 0.0),
        };
        ClothPin {
            target: Some(at * sign),
            ..ClothPin::new(PinSelection::Corner(corner))
        }
    });
    ClothPins {
        pins: pins.collect(),
    }
}

/// What is needed to show a scene.
#[derive(SystemParam)]
pub struct SceneAssets<'w> {
    meshes: ResMut<'w, Assets<Mesh>>,
    materials: ResMut<'w, Assets<StandardMaterial>>,
    fabrics: Res<'w, Fabrics>,
}

impl SceneAssets<'_> {
    /// A ball of this radius [m].
    pub fn sphere(&mut self, radius: f32) -> Mesh3d {
        Mesh3d(self.meshes.add(Sphere::new(radius).mesh().uv(64, 32)))
    }

    /// The material of the scene's cloth.
    pub fn cloth(&mut self, settings: &DemoSettings) -> MeshMaterial3d<StandardMaterial> {
        let scene = settings.scene;
        let material = self.fabrics.material(
            settings.preset,
            scene.color(),
            scene.size(),
            settings.look.texture,
        );
        MeshMaterial3d(self.materials.add(material))
    }

    fn painted(&mut self, color: Color, roughness: f32, metallic: f32) -> MaterialOf {
        MeshMaterial3d(self.materials.add(StandardMaterial {
            base_color: color,
            perceptual_roughness: roughness,
            metallic,
            ..default()
        }))
    }
}

type MaterialOf = MeshMaterial3d<StandardMaterial>;

/// Spawns a scene.
pub fn spawn_scene(commands: &mut Commands, settings: &DemoSettings, assets: &mut SceneAssets) {
    spawn_cloth(commands, settings, assets);
    spawn_sphere(commands, settings, assets);
    match settings.scene {
        SceneKind::Curtain => spawn_rail(commands, assets),
        SceneKind::Flag => spawn_flagpole(commands, assets),
        SceneKind::Tablecloth => {}
        SceneKind::Ball => spawn_posts(commands, assets),
    }
}

fn spawn_cloth(commands: &mut Commands, settings: &DemoSettings, assets: &mut SceneAssets) {
    let scene = settings.scene;
    commands.spawn((
        Name::new(scene.name()),
        SceneEntity,
        SceneCloth { size: scene.size() },
        scene.cloth(settings.resolution),
        settings.material,
        settings.solver,
        settings.shading,
        scene.pins(),
        scene.transform(),
        assets.cloth(settings),
    ));
}

fn spawn_sphere(commands: &mut Commands, settings: &DemoSettings, assets: &mut SceneAssets) {
    let radius = settings.sphere_radius;
    commands.spawn((
        Name::new("ball"),
        SceneEntity,
        SceneSphere,
        ClothCollider::sphere(radius),
        SphereControls::default(),
        Transform::from_translation(settings.scene.sphere_position(radius)),
        assets.sphere(radius),
        assets.painted(Color::srgb(0.78, 0.76, 0.72), 0.35, 0.0),
    ));
}

/// The rod above the curtain.
fn spawn_rail(commands: &mut Commands, assets: &mut SceneAssets) {
    let brass = assets.painted(Color::srgb(0.75, 0.6, 0.35), 0.35, 1.0);
    let rod = Mesh3d(assets.meshes.add(Cylinder::new(0.014, 1.9)));
    let knob = Mesh3d(assets.meshes.add(Sphere::new(0.032)));
    let across =
        Transform::from_xyz(0.0, 1.87, -0.015).with_rotation(Quat::from_rotation_z(FRAC_PI_2));
    commands.spawn((SceneEntity, rod, brass.clone(), across));
    for x in [-0.95, 0.95] {
        let place = Transform::from_xyz(x, 1.87, -0.015);
        commands.spawn((SceneEntity, knob.clone(), brass.clone(), place));
    }
}

fn spawn_flagpole(commands: &mut Commands, assets: &mut SceneAssets) {
    let white = assets.painted(Color::srgb(0.85, 0.85, 0.86), 0.4, 0.0);
    let gold = assets.painted(Color::srgb(0.9, 0.7, 0.3), 0.3, 1.0);
    let pole = Mesh3d(assets.meshes.add(Cylinder::new(0.022, 2.62)));
    let knob = Mesh3d(assets.meshes.add(Sphere::new(0.05)));
    commands.spawn((
        SceneEntity,
        pole,
        white,
        Transform::from_xyz(0.0, 1.31, 0.0),
    ));
    commands.spawn((SceneEntity, knob, gold, Transform::from_xyz(0.0, 2.65, 0.0)));
}

/// Four posts under the corners of the sheet.
fn spawn_posts(commands: &mut Commands, assets: &mut SceneAssets) {
    let wood = assets.painted(Color::srgb(0.42, 0.28, 0.17), 0.7, 0.0);
    let post = Mesh3d(assets.meshes.add(Cylinder::new(0.02, 1.35)));
    for (x, z) in [(-0.9, -0.9), (0.9, -0.9), (-0.9, 0.9), (0.9, 0.9)] {
        let place = Transform::from_xyz(x, 0.675, z);
        commands.spawn((SceneEntity, post.clone(), wood.clone(), place));
    }
}
