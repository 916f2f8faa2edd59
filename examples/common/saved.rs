//! [`DemoSettings`] as a file has them: the same values in plain types, with what is allowed for each.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};
use tailorbird::prelude::*;

use super::{
    scenes::SceneKind,
    settings::{DemoSettings, Look},
};

/// Settings in a file. What is left out is as the scene brings it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SavedSettings {
    /// The name of the scene.
    pub scene: Option<String>,
    /// Particles along the longer side of the cloth.
    pub resolution: Option<u32>,
    /// The name of the fabric.
    pub fabric: Option<String>,
    /// What the cloth is made of, if not as the fabric.
    pub material: Option<SavedMaterial>,
    /// How the cloth is shaded.
    pub shading: Option<SavedShading>,
    /// Acceleration of gravity, downwards [m/s²].
    pub gravity: Option<f32>,
    /// How the constraints are solved.
    pub solver: Option<SavedSolver>,
    /// Substeps of a step.
    pub substeps: Option<SavedSubsteps>,
    /// Iterations of a substep.
    pub iterations: Option<u32>,
    /// Whether time stands still.
    pub paused: Option<bool>,
    /// The air.
    pub wind: Option<SavedWind>,
    /// Radius of the ball [m].
    pub sphere_radius: Option<f32>,
    /// How fast the keys move the ball [m/s].
    pub sphere_speed: Option<f32>,
    /// How far from the grabbed particle cloth is pulled along [m].
    pub grab_radius: Option<f32>,
    /// What is drawn.
    pub look: Option<Look>,
    /// How the cloth under the pointer is found.
    pub picking: Option<SavedPicking>,
}

/// [`ClothMaterial`] in a file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedMaterial {
    /// [kg/m²].
    pub areal_density: f32,
    /// [m/N].
    pub warp_compliance: f32,
    /// [m/N].
    pub weft_compliance: f32,
    /// [m/N].
    pub shear_compliance: f32,
    /// [1/(N m)].
    pub bend_compliance: f32,
    /// [m²/s].
    pub viscosity: f32,
    /// [1/s].
    pub damping: f32,
    /// [-].
    pub friction: f32,
    /// [m].
    pub thickness: f32,
    /// [-].
    pub drag: f32,
    /// [-].
    pub lift: f32,
}

/// [`ClothWind`] in a file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedWind {
    /// Towards x, y and z [m/s].
    pub velocity: [f32; 3],
    /// How it varies in time.
    pub gusts: SavedGusts,
    /// How it swirls.
    pub turbulence: SavedTurbulence,
    /// How it pushes.
    pub model: SavedWindModel,
    /// [kg/m³].
    pub air_density: f32,
}

/// [`ClothGusts`] in a file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedGusts {
    /// As a part of the wind's speed [-].
    pub strength: f32,
    /// [s].
    pub period: f32,
}

/// [`ClothTurbulence`] in a file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedTurbulence {
    /// [m/s].
    pub speed: f32,
    /// The largest eddies [m].
    pub scale: f32,
    /// Which of all.
    pub seed: u32,
}

/// Substeps in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SavedSubsteps {
    /// As many as the cloth needs.
    Automatic,
    /// So many.
    Fixed(u32),
}

/// The same choice in a file and in the plugin.
macro_rules! mirror {
    ($saved:ident of $live:ident { $($choice:ident),* }) => {
        #[doc = concat!("[`", stringify!($live), "`] in a file.")]
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
        pub enum $saved {
            $(
                #[doc = concat!("[`", stringify!($live), "::", stringify!($choice), "`].")]
                $choice,
            )*
        }

        impl From<$live> for $saved {
            fn from(live: $live) -> Self {
                match live {
                    $($live::$choice => Self::$choice,)*
                }
            }
        }

        impl From<$saved> for $live {
            fn from(saved: $saved) -> Self {
                match saved {
                    $($saved::$choice => Self::$choice,)*
                }
            }
        }
    };
}

mirror!(SavedShading of ClothShading { Smooth, Flat });
mirror!(SavedSolver of ClothSolver { Chains, GaussSeidel });
mirror!(SavedPicking of ClothPickingBackend { Ray, Depth });
mirror!(SavedWindModel of ClothWindModel { Aerodynamic, Classic });

/// The same fields in both, each of a type that has a way to the other's.
macro_rules! same_fields {
    ($saved:ident and $live:ident { $($field:ident),* }) => {
        impl From<$live> for $saved {
            fn from(live: $live) -> Self {
                Self { $($field: live.$field.into()),* }
            }
        }

        impl From<$saved> for $live {
            fn from(saved: $saved) -> Self {
                Self { $($field: saved.$field.into()),* }
            }
        }
    };
}

same_fields!(SavedMaterial and ClothMaterial {
    areal_density, warp_compliance, weft_compliance, shear_compliance, bend_compliance, viscosity, damping, friction,
    thickness, drag, lift
});
same_fields!(SavedGusts and ClothGusts { strength, period });
same_fields!(SavedTurbulence and ClothTurbulence { speed, scale, seed });
same_fields!(SavedWind and ClothWind { velocity, gusts, turbulence, model, air_density });

/// A value that is not allowed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotAllowed {
    /// Which one, with a point between each field and the one within.
    pub field: String,
    /// What it is.
    pub value: String,
    /// What it may be, with the unit.
    pub allowed: String,
}

impl NotAllowed {
    fn new(field: &str, value: impl ToString, allowed: impl Into<String>) -> Self {
        Self {
            field: field.into(),
            value: value.to_string(),
            allowed: allowed.into(),
        }
    }

    /// What the plugin says about a field of `of`, which the file calls `called`.
    fn of_plugin(kind: &ClothErrorKind, of: &str, called: &str) -> Self {
        let rename = |field: &str| field.replacen(of, called, 1);
        match kind {
            ClothErrorKind::Value {
                field,
                value,
                allowed,
            } => Self::new(&rename(field), value, allowed),
            ClothErrorKind::Vector { field, value } => Self::new(&rename(field), value, "finite"),
            other => Self::new(called, other, "what the plugin takes"),
        }
    }
}

/// Takes over a number that lies in its range.
fn take<T: Copy + PartialOrd + ToString>(
    to: &mut T,
    value: Option<T>,
    field: &str,
    range: RangeInclusive<T>,
    unit: &str,
) -> Result<(), NotAllowed> {
    let Some(value) = value else {
        return Ok(());
    };
    if !range.contains(&value) {
        let (least, most) = (range.start().to_string(), range.end().to_string());
        let allowed = format!("{least} to {most}{unit}");
        return Err(NotAllowed::new(field, value, allowed));
    }
    *to = value;
    Ok(())
}

impl From<&DemoSettings> for SavedSettings {
    fn from(settings: &DemoSettings) -> Self {
        Self {
            scene: Some(settings.scene.name().into()),
            resolution: Some(settings.resolution),
            fabric: Some(settings.preset.into()),
            material: Some(settings.material.into()),
            shading: Some(settings.shading.into()),
            gravity: Some(settings.gravity),
            solver: Some(settings.solver.into()),
            substeps: Some(match settings.substeps {
                None => SavedSubsteps::Automatic,
                Some(count) => SavedSubsteps::Fixed(count),
            }),
            iterations: Some(settings.iterations),
            paused: Some(settings.paused),
            wind: Some(settings.wind.clone().into()),
            sphere_radius: Some(settings.sphere_radius),
            sphere_speed: Some(settings.sphere_speed),
            grab_radius: Some(settings.grab_radius),
            look: Some(settings.look),
            picking: Some(settings.picking.into()),
        }
    }
}

impl SavedSettings {
    /// As the demo has them.
    ///
    /// # Errors
    /// The first value that is not allowed.
    pub fn check(&self) -> Result<DemoSettings, NotAllowed> {
        let scene = match &self.scene {
            None => SceneKind::default(),
            Some(name) => name.parse().map_err(|_: String| {
                let names = SceneKind::ALL.map(SceneKind::name).join(", ");
                NotAllowed::new("scene", format!("{name:?}"), format!("one of {names}"))
            })?,
        };
        let mut settings = DemoSettings::of(scene);
        if let Some(name) = &self.fabric {
            settings.choose_preset(name);
            if settings.preset != name {
                let names = ClothMaterial::presets().map(|(name, _)| name).join(", ");
                let allowed = format!("one of {names}");
                return Err(NotAllowed::new("fabric", format!("{name:?}"), allowed));
            }
        }
        self.check_material_and_wind(&mut settings)?;
        take(
            &mut settings.resolution,
            self.resolution,
            "resolution",
            2..=512,
            "",
        )?;
        let most = ClothSettings::MOST_PASSES;
        if let Some(substeps) = self.substeps {
            settings.substeps = match substeps {
                SavedSubsteps::Automatic => None,
                SavedSubsteps::Fixed(count) => {
                    take(&mut { 1 }, Some(count), "substeps", 1..=most, "")?;
                    Some(count)
                }
            };
        }
        let s = &mut settings;
        take(
            &mut s.iterations,
            self.iterations,
            "iterations",
            0..=most,
            "",
        )?;
        take(
            &mut s.gravity,
            self.gravity,
            "gravity",
            0.0..=100.0,
            " m/s²",
        )?;
        for (to, value, field, range, unit) in [
            (
                &mut s.sphere_radius,
                self.sphere_radius,
                "sphere_radius",
                0.01..=2.0,
                " m",
            ),
            (
                &mut s.sphere_speed,
                self.sphere_speed,
                "sphere_speed",
                0.0..=100.0,
                " m/s",
            ),
            (
                &mut s.grab_radius,
                self.grab_radius,
                "grab_radius",
                0.0..=1.0,
                " m",
            ),
        ] {
            take(to, value, field, range, unit)?;
        }
        s.shading = self.shading.map_or(s.shading, Into::into);
        s.solver = self.solver.map_or(s.solver, Into::into);
        s.picking = self.picking.map_or(s.picking, Into::into);
        s.paused = self.paused.unwrap_or(s.paused);
        let f_number = self.look.map(|look| look.f_number);
        take(
            &mut s.look.f_number,
            f_number,
            "look.f_number",
            Look::F_NUMBERS,
            "",
        )?;
        s.look = self.look.unwrap_or(s.look);
        Ok(settings)
    }

    fn check_material_and_wind(&self, settings: &mut DemoSettings) -> Result<(), NotAllowed> {
        if let Some(material) = self.material {
            settings.material = material.into();
        }
        if let Some(kind) = settings.material.errors().first() {
            return Err(NotAllowed::of_plugin(kind, "ClothMaterial", "material"));
        }
        if let Some(wind) = self.wind {
            settings.wind = wind.into();
        }
        match settings.wind.errors().first() {
            Some(kind) => Err(NotAllowed::of_plugin(kind, "ClothWind", "wind")),
            None => Ok(()),
        }
    }
}
