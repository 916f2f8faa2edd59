//! Material of a cloth: its weight, stiffness, friction and drag.
//!
//! ```
//! # use bevy_ecs::prelude::*;
//! # use bevy_math::{UVec2, Vec2};
//! # use tailorbird_cloth::prelude::*;
//! fn spawn(mut commands: Commands) {
//!     let cloth = Cloth::grid(Vec2::new(2.0, 1.5), UVec2::new(64, 48));
//!     commands.spawn((cloth.clone(), ClothMaterial::silk()));
//!     // A fabric of one's own: a preset, and what differs. Stiffness is given by its inverse.
//!     let felt = ClothMaterial {
//!         areal_density: 0.4,
//!         bend_compliance: 1.0 / 2e-4,
//!         friction: 0.8,
//!         ..ClothMaterial::cotton()
//!     };
//!     commands.spawn((cloth, felt));
//! }
//!
//! /// Whatever it was, it is wet.
//! fn soak(mut materials: Query<&mut ClothMaterial>) {
//!     for mut material in &mut materials {
//!         material.areal_density *= 1.7;
//!         material.damping = 1.0;
//!     }
//! }
//! ```
//!
//! # Which knob
//!
//! | wanted | knob, with cotton's value | to know |
//! | --- | --- | --- |
//! | heavier | `areal_density`, 0.15 kg/m² | it pulls, pushes and swings harder and minds the wind less; how it hangs depends on stiffness by weight |
//! | gives way along its threads | `warp_compliance`, `weft_compliance`, 1/16,000 and 1/8,000 m/N | 0 is rigid, and costs the same; a grid's columns are warp |
//! | gives way on the bias | `shear_compliance`, 1/60 m/N | 0 beside rigid threads makes a plate, which stretches more |
//! | larger folds | `bend_compliance`, 1/8e-6 1/(N m) | the size of folds is about the bending length (B/(σ g))^⅓: 18 mm; 0 makes a board |
//! | less flutter and ripple | `viscosity`, 0.05 m²/s | between neighbours alone: a pendulum keeps its swing; at most about L²/(8 h) acts, with L and h as below |
//! | comes to rest sooner | `damping`, 0.3 1/s | against the world: what hangs in a vehicle lags behind it |
//! | clings, slides | `friction`, 0.5 | the geometric mean with the collider's |
//! | keeps its distance | `thickness`, 5 mm | not the fabric's own; added to the collider's margin |
//! | less in the wind | `drag`, `lift`, 1.2 | equal ones push along the normal alone; 0 feels no air |
//!
//! None of them changes what a step costs, but that a `viscosity` of 0 is a little cheaper.
//!
//! # Traps
//!
//! Rows and columns of a grid bend as stiffly as they are meant to, up to 100 σ L⁴/h²: with 8 substeps at 60 Hz all presets from a spacing of 2 mm on; on the bias a grid is half as stiff. The chain solver relaxes shear
//! once in a substep, and so the bending of meshes that are no flat grid: they hold up to a limit, a shear stiffness of about σ L²/(2 h²) and a bending rigidity of about
//! σ L⁴/(6 h²) (σ areal density, L spacing of the particles, h substep). A stiffer fabric acts as one at the limit, and so gets softer as the
//! resolution grows. More [substeps](crate::settings::ClothSettings::substeps) or fewer particles lift both.
//!
//! A fabric that stretches is held by its [tethers](crate::tethers) beyond 20 times the strain by its own weight: rubber that hangs on
//! pins gets no longer than that, whatever pulls.
//!
//! Errors are reported in [`ClothStatus`](crate::error::ClothStatus); the masses then stay as they were.

use bevy_ecs::prelude::*;
use bevy_reflect::prelude::*;
use tailorbird_solver::coefficients::Coefficients;

use crate::error::ClothErrorKind;

/// Grams per square metre in one ounce per square yard, the unit in which denim is sold: 28.349523 g / 0.83612736 m².
const OUNCE_PER_SQUARE_YARD: f32 = 0.033_905_75;

/// Kilograms per square metre in one momme, the unit in which silk is sold: 4.340 g/m².
const MOMME: f32 = 0.004_34;

/// Material of a cloth. Change it at any time.
///
/// Stiffness is given as its inverse, so that 0 is rigid, and for the fabric, not for a spring: it does not depend on the
/// resolution. A band of width b and length l that is pulled with the force F along the warp gets longer by
/// `warp_compliance` · F l/b.
///
/// The presets have the areal densities under which such fabrics are sold:
///
/// | preset | areal density | from |
/// | --- | --- | --- |
/// | [`silk`](Self::silk) | 0.069 kg/m² | 16 momme charmeuse, 1 momme = 4.340 g/m² |
/// | [`cotton`](Self::cotton) | 0.150 kg/m² | bed sheeting and shirting is sold at 110 to 200 g/m² |
/// | [`denim`](Self::denim) | 0.475 kg/m² | 14 oz/yd², 1 oz/yd² = 33.906 g/m² |
/// | [`canvas`](Self::canvas) | 0.339 kg/m² | 10 oz/yd² cotton duck |
/// | [`lace`](Self::lace) | 0.060 kg/m² | curtain lace is sold at 40 to 80 g/m² |
/// | [`leather`](Self::leather) | 0.860 kg/m² | 1.0 mm garment leather of 860 kg/m³ |
/// | [`rubber`](Self::rubber) | 0.930 kg/m² | 1.0 mm sheet of natural rubber, 930 kg/m³ |
///
/// and these stiffnesses:
///
/// | preset | warp, weft [N/m] | shear [N/m] | bending [N m] | from |
/// | --- | --- | --- | --- | --- |
/// | silk | 16000, 8000 | 17 | 3e-6 | estimates, in the range that Kawabata's instruments (KES-F) give for such fabrics |
/// | cotton | 16000, 8000 | 60 | 8e-6 | estimates, as for silk |
/// | denim | 9000, 9000 | 120 | 1e-4 | stretch and shear: KES-F, Journal of Textiles 2016, 4614168, Table 5 (EMT 5.5 %, G 2.18 gf/(cm deg)); bending: 6.2e-5 N m of the 11 oz denim of Wang, O'Brien and Ramamoorthi 2011, by weight to the power of 2.5 |
/// | canvas | 20000, 15000 | 300 | 8e-5 | estimates: between denim and tarpaulin |
/// | lace | 2000, 1500 | 10 | 1e-6 | estimates: a knitted net gives way more than any weave |
/// | leather | 20000, 20000 | 7700 | 3e-4 | estimates: E = 20 MPa, Poisson's ratio 0.3; bending from a bending length of 3.3 cm |
/// | rubber | 1500, 1500 | 500 | 1.7e-4 | shear modulus 0.5 MPa of vulcanised natural rubber, E = 3 G, B = E t³/9 |
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
pub struct ClothMaterial {
    /// Mass per area [kg/m²].
    pub areal_density: f32,
    /// Strain by tension per width along the warp: the columns of a grid [m/N].
    pub warp_compliance: f32,
    /// The same along the weft: the rows of a grid [m/N].
    pub weft_compliance: f32,
    /// Shear angle by shear force per width [m/N].
    pub shear_compliance: f32,
    /// Curvature by bending moment per width: the inverse of the bending rigidity \[1/(N m)\].
    pub bend_compliance: f32,
    /// Friction inside the fabric, as a kinematic viscosity \[m²/s\]: neighbours that move differently slow each other down,
    /// motion as a whole is free. Limited to what a substep can take.
    pub viscosity: f32,
    /// Rate at which motion decays [1/s]; independent of the number of substeps.
    pub damping: f32,
    /// Coulomb friction [-]. The geometric mean with the collider's counts.
    pub friction: f32,
    /// Distance at which the cloth's middle stays from colliders \[m\].
    pub thickness: f32,
    /// Drag coefficient of a flat plate across the flow [-].
    pub drag: f32,
    /// Lift coefficient of a flat plate [-]. Equal to `drag`, the air pushes along the normal alone.
    pub lift: f32,
}

impl Default for ClothMaterial {
    /// Cotton.
    fn default() -> Self {
        Self::cotton()
    }
}

impl ClothMaterial {
    /// Charmeuse: light, smooth, drapes in fine folds.
    pub const fn silk() -> Self {
        Self {
            areal_density: 16.0 * MOMME,
            warp_compliance: 1.0 / 16e3,
            weft_compliance: 1.0 / 8e3,
            shear_compliance: 1.0 / 17.0,
            bend_compliance: 1.0 / 3e-6,
            viscosity: 0.05,
            damping: 0.3,
            friction: 0.2,
            thickness: 0.003,
            drag: 1.2,
            lift: 1.2,
        }
    }

    /// A bed sheet.
    pub const fn cotton() -> Self {
        Self {
            areal_density: 0.15,
            warp_compliance: 1.0 / 16e3,
            weft_compliance: 1.0 / 8e3,
            shear_compliance: 1.0 / 60.0,
            bend_compliance: 1.0 / 8e-6,
            viscosity: 0.05,
            damping: 0.3,
            friction: 0.5,
            thickness: 0.005,
            drag: 1.2,
            lift: 1.2,
        }
    }

    /// Raw 14-ounce denim: heavy and stiff.
    pub const fn denim() -> Self {
        Self {
            areal_density: 14.0 * OUNCE_PER_SQUARE_YARD,
            warp_compliance: 1.0 / 9e3,
            weft_compliance: 1.0 / 9e3,
            shear_compliance: 1.0 / 120.0,
            bend_compliance: 1.0 / 1e-4,
            viscosity: 0.05,
            damping: 0.5,
            friction: 0.6,
            thickness: 0.006,
            drag: 1.2,
            lift: 1.2,
        }
    }

    /// Cotton duck: tents, sails, bags.
    pub const fn canvas() -> Self {
        Self {
            areal_density: 10.0 * OUNCE_PER_SQUARE_YARD,
            warp_compliance: 1.0 / 20e3,
            weft_compliance: 1.0 / 15e3,
            shear_compliance: 1.0 / 300.0,
            bend_compliance: 1.0 / 8e-5,
            viscosity: 0.05,
            damping: 0.5,
            friction: 0.6,
            thickness: 0.006,
            drag: 1.2,
            lift: 1.2,
        }
    }

    /// Curtain lace: air goes through it, so that wind moves it less.
    pub const fn lace() -> Self {
        Self {
            areal_density: 0.06,
            warp_compliance: 1.0 / 2e3,
            weft_compliance: 1.0 / 1.5e3,
            shear_compliance: 1.0 / 10.0,
            bend_compliance: 1.0 / 1e-6,
            viscosity: 0.05,
            damping: 0.3,
            friction: 0.4,
            thickness: 0.004,
            drag: 0.6,
            lift: 0.6,
        }
    }

    /// Garment leather, 1 mm.
    pub const fn leather() -> Self {
        Self {
            areal_density: 0.86,
            warp_compliance: 1.0 / 20e3,
            weft_compliance: 1.0 / 20e3,
            shear_compliance: 1.0 / 7.7e3,
            bend_compliance: 1.0 / 3e-4,
            viscosity: 0.1,
            damping: 0.8,
            friction: 0.6,
            thickness: 0.006,
            drag: 1.2,
            lift: 1.2,
        }
    }

    /// A sheet of natural rubber, 1 mm: stretches visibly under its own weight.
    pub const fn rubber() -> Self {
        Self {
            areal_density: 0.93,
            warp_compliance: 1.0 / 1500.0,
            weft_compliance: 1.0 / 1500.0,
            shear_compliance: 1.0 / 500.0,
            bend_compliance: 1.0 / 1.7e-4,
            viscosity: 0.1,
            damping: 1.0,
            friction: 0.9,
            thickness: 0.006,
            drag: 1.2,
            lift: 1.2,
        }
    }

    /// The presets with their names.
    pub const fn presets() -> [(&'static str, Self); 7] {
        [
            ("silk", Self::silk()),
            ("cotton", Self::cotton()),
            ("denim", Self::denim()),
            ("canvas", Self::canvas()),
            ("leather", Self::leather()),
            ("rubber", Self::rubber()),
            ("lace", Self::lace()),
        ]
    }

    /// Coefficients for the solver.
    pub(crate) fn coefficients(&self) -> Coefficients {
        Coefficients {
            areal_density: self.areal_density,
            warp_compliance: self.warp_compliance,
            weft_compliance: self.weft_compliance,
            shear_compliance: self.shear_compliance,
            bend_compliance: self.bend_compliance,
            viscosity: self.viscosity,
            damping: self.damping,
            friction: self.friction,
            margin: self.margin(),
        }
    }

    /// The distance to keep from colliders \[m\]: none where the thickness is invalid.
    pub(crate) fn margin(&self) -> f32 {
        if self.thickness.is_finite() {
            self.thickness.max(0.0)
        } else {
            0.0
        }
    }

    /// Errors of this material.
    pub fn errors(&self) -> Vec<ClothErrorKind> {
        let check = |field: &str, value, unit| {
            ClothErrorKind::not_negative(format_args!("ClothMaterial.{field}"), value, unit)
        };
        let checks = [
            ClothErrorKind::positive("ClothMaterial.areal_density", self.areal_density, "kg/m²"),
            check("warp_compliance", self.warp_compliance, "m/N"),
            check("weft_compliance", self.weft_compliance, "m/N"),
            check("shear_compliance", self.shear_compliance, "m/N"),
            check("bend_compliance", self.bend_compliance, "1/(N m)"),
            check("viscosity", self.viscosity, "m²/s"),
            check("damping", self.damping, "1/s"),
            check("friction", self.friction, "-"),
            check("thickness", self.thickness, "m"),
            check("drag", self.drag, "-"),
            check("lift", self.lift, "-"),
        ];
        checks.into_iter().flatten().collect()
    }
}
