//! Particles as four numbers each, for constraints between any particles: one load gets position and inverse mass.
//!
//! The lanes of a vector are x, y, z and the inverse mass of one particle here. Constraints are taken one after the other, each with the
//! same operations whatever the instruction set.

use bevy_math::Vec4;

use super::lanes::with_scratch;
use crate::points::Points;

/// Position \[m\] and inverse mass [1/kg] of a particle.
pub type Packed = [f32; 4];

/// Calls `f` with the particles packed, then stores their positions.
pub fn with_packed<R>(
    position: &mut Points,
    inv_mass: &[f32],
    f: impl FnOnce(&mut [Packed]) -> R,
) -> R {
    with_scratch(4 * inv_mass.len(), |scratch| {
        let packed = scratch.as_chunks_mut::<4>().0;
        let Points { x, y, z } = position;
        let places = x.iter_mut().zip(y).zip(z);
        for ((((x, y), z), w), packed) in places.zip(inv_mass).zip(&mut *packed) {
            *packed = [*x, *y, *z, *w];
        }
        let result = f(packed);
        let Points { x, y, z } = position;
        let places = x.iter_mut().zip(y).zip(z);
        for (((x, y), z), packed) in places.zip(packed) {
            [*x, *y, *z, _] = *packed;
        }
        result
    })
}

/// The vector with 0 in the lane of the inverse mass.
#[inline(always)]
pub fn of_space(v: Vec4) -> Vec4 {
    let space = Vec4::new(1.0, 1.0, 1.0, 0.0).cmpgt(Vec4::ZERO);
    Vec4::select(space, v, Vec4::ZERO)
}

/// The inverse mass in all lanes.
#[inline(always)]
pub fn inv_mass(particle: Vec4) -> Vec4 {
    use bevy_math::Vec4Swizzles;
    particle.wwww()
}

/// x² + y² + z² in all lanes.
#[inline(always)]
pub fn squared(v: Vec4) -> Vec4 {
    use bevy_math::Vec4Swizzles;
    let v = v * v;
    v.xxxx() + v.yyyy() + v.zzzz()
}

#[cfg(test)]
mod tests {
    use bevy_math::Vec3;

    use super::*;

    #[test]
    fn places_come_back_and_masses_stay() {
        let mut position: Points = (0..5).map(|i| Vec3::new(i as f32, 2.0, 3.0)).collect();
        let inv_mass = [1.0, 2.0, 3.0, 4.0, f32::INFINITY];
        with_packed(&mut position, &inv_mass, |packed| {
            assert_eq!(packed[1], [1.0, 2.0, 3.0, 2.0]);
            let step = Vec4::new(0.5, 0.0, 0.0, f32::INFINITY * 0.0);
            for particle in packed.iter_mut() {
                *particle = (Vec4::from_array(*particle) + of_space(step)).to_array();
            }
            assert_eq!(packed[4][3], f32::INFINITY);
        });
        assert_eq!(position.get(4), Vec3::new(4.5, 2.0, 3.0));
        let v = Vec4::new(1.0, 2.0, 3.0, f32::NAN);
        assert_eq!(squared(v), Vec4::splat(14.0));
    }
}
