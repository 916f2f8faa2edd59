//! Coefficients of a fabric.

/// Coefficients of a fabric and of its contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coefficients {
    /// Mass per area [kg/m²].
    pub areal_density: f32,
    /// Compliance of the threads along v [m/N].
    pub warp_compliance: f32,
    /// Compliance of the threads along u [m/N].
    pub weft_compliance: f32,
    /// Compliance in shear [m/N].
    pub shear_compliance: f32,
    /// Compliance in bending [1/(N m)].
    pub bend_compliance: f32,
    /// Friction inside the fabric \[m²/s\].
    pub viscosity: f32,
    /// Rate at which motion decays [1/s].
    pub damping: f32,
    /// Coulomb friction [-].
    pub friction: f32,
    /// Distance to keep from colliders \[m\].
    pub margin: f32,
}

/// Method by which the constraints are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Whole lines of edges at once.
    Lines,
    /// Spring by spring.
    Springs,
}
