//! Particles against a moving half-space: everything below a plane is solid.

use bevy_math::Vec3;

use super::contact::Path;
use crate::points::Points;

/// A half-space during one substep, in the frame of the particles.
#[derive(Clone, Copy, Debug)]
pub struct MovingHalfSpace {
    /// A point of the plane at the start \[m\].
    pub from: Vec3,
    /// The same point at the end \[m\].
    pub to: Vec3,
    /// Unit normal, out of the solid.
    pub normal: Vec3,
    /// Distance that is kept from the plane \[m\].
    pub margin: f32,
    /// Coulomb friction [-].
    pub friction: f32,
}

/// Keeps all free particles (`inv_mass` > 0) out of a half-space; returns how many touch it.
pub fn collide_all(
    plane: &MovingHalfSpace,
    inv_mass: &[f32],
    position: &mut Points,
    previous: &mut Points,
) -> usize {
    let mut contacts = 0;
    for (i, w) in inv_mass.iter().enumerate() {
        if *w > 0.0 {
            contacts += usize::from(collide_one(plane, i, position, previous));
        }
    }
    contacts
}

/// Keeps one particle out of a half-space; returns whether it touches.
#[inline]
pub fn collide_one(
    plane: &MovingHalfSpace,
    i: usize,
    position: &mut Points,
    previous: &mut Points,
) -> bool {
    let to = position.get(i) - plane.to;
    let depth = plane.margin - plane.normal.dot(to);
    if depth <= 0.0 {
        return false;
    }
    let from = previous.get(i) - plane.from;
    let path = Path { from, to }.resolve(plane.normal, depth, plane.friction, Vec3::ZERO);
    position.set(i, path.to + plane.to);
    previous.set(i, path.from + plane.from);
    true
}
