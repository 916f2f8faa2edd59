//! Wind on triangles.
//!
//! The pressure of air that flows with velocity u past a flat plate of area A with normal n (cos θ = û · n) is, for drag and
//! lift coefficients C_D and C_L,
//!
//! F = −½ ρ A |u|² [C_D cos²θ û + C_L cos θ (n − cos θ û)],
//!
//! u being the triangle's velocity relative to the air. With C_D = C_L it points along the normal. Taken for a whole step at
//! once it would throw a light cloth back and forth faster than the wind, so each triangle is taken along the exact
//! or implicit solution instead, which only ever turns and shortens u:
//!
//! - along the normal with C_L: u_n' = u_n / (1 + g), g = ½ ρ A/m C_L |u| Δt (m the triangle's mass);
//! - along û with the rest: u' = u / (1 + e), e = ½ ρ A/m (C_D − C_L) cos²θ |u| Δt.
//!
//! A particle gets the mean of the changes of its triangles, weighted by their share of its mass. By Jensen's inequality the
//! kinetic energy relative to the air then falls or stays at any length of the step.

#![expect(clippy::doc_markdown, reason = "formulas")]

use bevy_math::Vec3;

use crate::points::Points;

mod sheet;

pub use sheet::{AirSheet, classic_on_sheet, drag_and_lift_on_sheet};

/// Air around a fabric, and the fabric's coefficients.
#[derive(Clone, Copy, Debug)]
pub struct Air {
    /// Velocity of the air [m/s].
    pub wind: Vec3,
    /// ρ [kg/m³].
    pub density: f32,
    /// σ [kg/m²].
    pub areal_density: f32,
    /// C_D [-].
    pub drag: f32,
    /// C_L [-].
    pub lift: f32,
    /// Δt \[s\].
    pub seconds: f32,
}

impl Air {
    /// Change of the velocity `u` (relative to the air) of a plate with unit normal `n` in `seconds` [m/s]. It never makes the plate
    /// faster. `stretched` is the plate's area as a multiple of its area at rest.
    #[inline]
    pub fn velocity_change(&self, u: Vec3, n: Vec3, stretched: f32) -> Vec3 {
        let speed = u.length();
        if speed == 0.0 {
            return Vec3::ZERO;
        }
        let rate = 0.5 * self.density * stretched / self.areal_density * self.seconds;
        let u_n = u.dot(n);
        let cos = u_n / speed;
        let g = rate * self.lift * speed;
        let e = rate * (self.drag - self.lift) * cos * cos * speed;
        let turned = u - n * (u_n * (g / (1.0 + g)));
        if e >= 0.0 {
            turned / (1.0 + e) - u
        } else {
            // With more lift than drag, the part along û pushes forward: at most to the speed before.
            (turned * (1.0 - e)).clamp_length_max(speed) - u
        }
    }

    /// A third of the mass of a triangle of this area at rest \[m²\], by the length of the step [kg/s].
    #[inline]
    fn third(&self, rest_area: f32) -> f32 {
        self.areal_density * rest_area / 3.0 / self.seconds
    }
}

/// Adds drag and lift to the accelerations [m/s²] of the particles.
///
/// The velocity of a particle is `per_second` · (`position` − `previous`). Each corner has a third of a triangle's mass (areal density
/// times `rest_areas` \[m²\]), and gets the triangle's change of velocity by the ratio of that third to its own mass 1/`inv_mass` \[kg\]; a
/// held particle (`inv_mass` 0) gets nothing. A triangle without area does nothing.
///
/// # Panics
/// When a corner is not below the number of particles.
pub fn drag_and_lift(
    triangles: &[[u32; 3]],
    rest_areas: &[f32],
    air: Air,
    position: &Points,
    previous: &Points,
    per_second: f32,
    inv_mass: &[f32],
    acceleration: &mut Points,
) {
    for (triangle, &rest_area) in triangles.iter().zip(rest_areas) {
        let corners = triangle.map(|i| i as usize);
        let [a, b, c] = corners.map(|i| position.get(i));
        let normal = (b - a).cross(c - a);
        let double_area = normal.length();
        if double_area == 0.0 {
            continue;
        }
        let [a_before, b_before, c_before] = corners.map(|i| previous.get(i));
        let mean = ((a - a_before) + (b - b_before) + (c - c_before)) * (per_second / 3.0);
        let stretched = 0.5 * double_area / rest_area;
        let change = air.velocity_change(mean - air.wind, normal / double_area, stretched);
        let third = air.third(rest_area);
        for i in corners {
            acceleration.add(i, change * (third * inv_mass[i]));
        }
    }
}

/// Adds the classic force ŵ |w · n| A [N, with 1 N s/m³], shared by the corners, to the accelerations [m/s²].
///
/// # Panics
/// When a corner is not below the number of particles.
pub fn classic(
    triangles: &[[u32; 3]],
    wind: Vec3,
    position: &Points,
    inv_mass: &[f32],
    acceleration: &mut Points,
) {
    let direction = wind.normalize_or_zero();
    for triangle in triangles {
        let corners = triangle.map(|i| i as usize);
        let [a, b, c] = corners.map(|i| position.get(i));
        // The normal's length is twice the area, and a third goes to each corner.
        let force = direction * (wind.dot((b - a).cross(c - a)).abs() / 6.0);
        for i in corners {
            acceleration.add(i, force * inv_mass[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::properties::*;

    use super::*;

    fn air(drag: f32, lift: f32, seconds: f32) -> Air {
        Air {
            wind: Vec3::ZERO,
            density: 1.225,
            areal_density: 0.1,
            drag,
            lift,
            seconds,
        }
    }

    fn vector(range: f32) -> impl Strategy<Value = Vec3> {
        (-range..range, -range..range, -range..range).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }

    proptest! {
        #[test]
        fn air_never_makes_a_plate_faster(
            u in vector(100.0), n in vector(1.0), drag in 0.0f32..3.0, lift in 0.0f32..3.0, seconds in 1e-4f32..10.0,
        ) {
            prop_assume!(n.length() > 0.1);
            let change = air(drag, lift, seconds).velocity_change(u, n.normalize(), 1.0);
            prop_assert!((u + change).length() <= u.length() * (1.0 + 1e-5));
        }

        #[test]
        fn an_edge_on_plate_feels_nothing(x in -50.0f32..50.0, y in -50.0f32..50.0) {
            let change = air(1.2, 0.7, 0.1).velocity_change(Vec3::new(x, y, 0.0), Vec3::Z, 1.0);
            prop_assert_eq!(change, Vec3::ZERO);
        }

        #[test]
        fn the_sign_of_the_normal_does_not_matter(u in vector(20.0), n in vector(1.0)) {
            prop_assume!(n.length() > 0.1);
            let n = n.normalize();
            let air = air(1.2, 0.7, 0.01);
            prop_assert!((air.velocity_change(u, n, 1.0) - air.velocity_change(u, -n, 1.0)).length() < 1e-4);
        }
    }

    #[test]
    fn short_steps_agree_with_the_force_of_the_formula() {
        let air = air(1.3, 0.8, 1e-5);
        let (u, n) = (Vec3::new(3.0, -4.0, 7.0), Vec3::new(0.48, 0.6, 0.64));
        let (speed, cos) = (u.length(), u.normalize().dot(n));
        let direction = u / speed;
        let force = -0.5
            * air.density
            * speed
            * speed
            * (air.drag * cos * cos * direction + air.lift * cos * (n - cos * direction));
        let expected = force / air.areal_density * air.seconds;
        let change = air.velocity_change(u, n, 1.0);
        assert!(
            (change - expected).length() < 1e-2 * expected.length(),
            "{change} {expected}"
        );
    }
}
