//! The rigid motion of a whole cloth.

use bevy_math::{DVec3, Vec3};

use crate::points::Points;

/// A rigid motion during a substep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RigidMotion {
    /// Centre of mass \[m\].
    pub center: Vec3,
    /// Displacement of the centre \[m\].
    pub displacement: Vec3,
    /// Rotation of the whole: axis times angle \[rad\].
    pub rotation: Vec3,
}

/// Least number of particles that a rigid motion is measured by.
const SAMPLES: usize = 256;

impl RigidMotion {
    /// Displacement of a point at the origin \[m\]; a point at x is displaced by the cross product of the rotation and x in addition.
    #[inline]
    pub fn at_origin(&self) -> Vec3 {
        self.displacement - self.rotation.cross(self.center)
    }

    /// Displacement of a point \[m\].
    pub fn at(&self, point: Vec3) -> Vec3 {
        self.rotation.cross(point) + self.at_origin()
    }

    /// Rigid motion that has the linear and the angular momentum of these particles, measured by a sample of them. Without rotation where
    /// they lie in a line.
    pub fn fit(mass: &[f32], position: &Points, previous: &Points) -> Self {
        // Odd, so that the sample is not one column of a sheet.
        Self::of_every((mass.len() / SAMPLES) | 1, mass, position, previous)
    }

    /// Rigid motion by all particles.
    pub fn of_all(mass: &[f32], position: &Points, previous: &Points) -> Self {
        Self::of_every(1, mass, position, previous)
    }

    fn of_every(every: usize, mass: &[f32], position: &Points, previous: &Points) -> Self {
        let len = mass.len();
        if len == 0 || !position.is_of(len) || !previous.is_of(len) {
            return Self::default();
        }
        // Moments around a particle, so that they do not grow with the distance from the origin.
        let origin = position.get(0).as_dvec3();
        let (mut total, mut moment, mut momentum, mut spin) =
            (0.0, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
        // Σ m (x², y², z²) and Σ m (yz, zx, xy).
        let (mut squares, mut products) = (DVec3::ZERO, DVec3::ZERO);
        for i in (0..len).step_by(every) {
            let (m, x) = (f64::from(mass[i]), position.get(i).as_dvec3());
            let r = x - origin;
            let (first, flow) = (r * m, (x - previous.get(i).as_dvec3()) * m);
            total += m;
            moment += first;
            momentum += flow;
            spin += r.cross(flow);
            squares += first * r;
            products += DVec3::new(first.y * r.z, first.z * r.x, first.x * r.y);
        }
        if total <= 0.0 {
            return Self::default();
        }
        // Around the centre.
        let center = moment / total;
        spin -= center.cross(momentum);
        squares -= moment * center;
        products -= DVec3::new(
            moment.y * center.z,
            moment.z * center.x,
            moment.x * center.y,
        );
        Self {
            center: (origin + center).as_vec3(),
            displacement: (momentum / total).as_vec3(),
            rotation: rotation(squares, products, spin).as_vec3(),
        }
    }
}

/// I⁻¹ L by the adjugate, I being (a, −f, −e; −f, b, −d; −e, −d, c), and (d, e, f) the products.
fn rotation(squares: DVec3, products: DVec3, spin: DVec3) -> DVec3 {
    let [a, b, c] = [
        squares.y + squares.z,
        squares.z + squares.x,
        squares.x + squares.y,
    ];
    let [d, e, f] = products.to_array();
    let first = DVec3::new(b * c - d * d, d * e + c * f, d * f + b * e);
    let second = DVec3::new(first.y, c * a - e * e, e * f + a * d);
    let third = DVec3::new(first.z, second.z, a * b - f * f);
    let determinant = DVec3::new(a, -f, -e).dot(first);
    let size = a + b + c;
    if determinant > 1e-9 * size * size * size {
        DVec3::new(first.dot(spin), second.dot(spin), third.dot(spin)) / determinant
    } else {
        DVec3::ZERO
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rigid_motion_is_found_wherever_the_cloth_is() {
        let motion = RigidMotion {
            center: Vec3::ZERO,
            displacement: Vec3::new(0.01, -0.02, 0.005),
            rotation: Vec3::new(0.002, 0.01, -0.004),
        };
        for far in [Vec3::ZERO, Vec3::new(3.0, -20.0, 7.0)] {
            let n = 40;
            let at = |i: usize| {
                let (u, v) = ((i % n) as f32 / 20.0, (i / n) as f32 / 20.0);
                far + Vec3::new(u, v, 0.3 * (3.0 * u + v).sin())
            };
            let position: Points = (0..n * n).map(at).collect();
            let mass: Vec<f32> = (0..n * n).map(|i| 1.0 + (i % 3) as f32).collect();
            let still = RigidMotion::fit(&mass, &position, &position);
            let previous: Points = (0..n * n)
                .map(|i| at(i) - motion.displacement - motion.rotation.cross(at(i) - still.center))
                .collect();
            let found = RigidMotion::fit(&mass, &position, &previous);
            assert!(found.displacement.distance(motion.displacement) < 1e-6);
            assert!(found.rotation.distance(motion.rotation) < 2e-6, "{found:?}");
        }
    }

    #[test]
    fn a_line_has_no_rotation_and_nothing_no_motion() {
        let line: Points = (0..9).map(|i| Vec3::X * i as f32).collect();
        let before: Points = (0..9)
            .map(|i| Vec3::new(i as f32, 0.1 * i as f32, 0.0))
            .collect();
        let found = RigidMotion::fit(&[1.0; 9], &line, &before);
        assert_eq!(found.rotation, Vec3::ZERO);
        assert!((found.displacement.y + 0.4).abs() < 1e-6);
        assert_eq!(
            RigidMotion::fit(&[0.0; 9], &line, &before),
            RigidMotion::default()
        );
    }
}
