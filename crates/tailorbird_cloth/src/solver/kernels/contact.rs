//! A particle against a surface: no penetration, Coulomb friction, no bounce.

use bevy_math::Vec3;

/// A particle's path through a substep, relative to the collider: `from` its start, `to` its end \[m\].
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// At the start of the substep.
    pub from: Vec3,
    /// At the end of the substep.
    pub to: Vec3,
}

impl Path {
    /// Resolves a contact with a surface of unit `normal` that `to` lies `depth` \[m\] below.
    ///
    /// 1. `to` is pushed out along the normal.
    /// 2. The tangential displacement relative to the surface (which itself moves by `surface` \[m\]) is taken back, by at
    ///    most `friction` · `depth`: the push is what presses the two together.
    /// 3. What is left of motion away from the surface comes from the push alone, so `from` follows: a particle that was
    ///    inside does not pop out with a speed.
    #[inline]
    pub fn resolve(self, normal: Vec3, depth: f32, friction: f32, surface: Vec3) -> Self {
        let mut to = self.to + normal * depth;
        let moved = to - self.from;
        let away = normal.dot(moved);
        let sliding = moved - normal * away - surface;
        let length = sliding.length();
        let most = friction * depth;
        if length <= most {
            to -= sliding;
        } else {
            to -= sliding * (most / length);
        }
        Self {
            from: self.from + normal * away.max(0.0),
            to,
        }
    }
}
