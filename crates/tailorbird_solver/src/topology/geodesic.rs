//! Geodesic distances: the lengths of the shortest paths along the cloth at rest, for tethers.
//!
//! A front runs over the mesh in the order of distance, as in fast marching on triangulated domains (Kimmel and Sethian
//! 1998, Computing geodesic paths on manifolds). A triangle with two reached corners a and b is laid in the plane, and
//! the distances there give the image of a point source (Novotni and Klein 2002, Computing geodesic distances on
//! triangular meshes), with L = |ab|, r the distances from that source, and the third corner where y > 0:
//!
//! `x = (r_a² − r_b² + L²) / 2L`, `y = −√(r_a² − x²)`.
//!
//! If the straight line from the image to the third corner c crosses ab, its length is the distance of c; elsewhere
//! it is the lesser of `r_a + |ac|` and `r_b + |bc|`. Both are the lengths of paths, so that on flat cloth no distance comes out
//! too short, and the first is exact there. Three cases need more than that:
//!
//! - A particle can be nearer than one of the two through whose edge its path comes, in obtuse triangles and beyond them. It is reached
//!   ahead of that particle: further triangles are unfolded into the plane of the image.
//! - A path bends around the reflex corners of a boundary and around saddles. They become roots: distances behind them are measured from
//!   there.
//! - Where fronts meet that came from different sides (around a hole or a sleeve, from two sources), no single source fits. The directions
//!   from which a and b were reached show this; then each has an image of its own.
//!
//! The distance is exact on flat and on developable cloth (sleeves, folds). On a sphere of radius R it comes out short by up to the part `L
//! r / 24 R²`, as an image in the plane ignores the curvature between it and the edge. Sources a few edges apart on coarse, strongly curved
//! cloth can make it 2 % short: measure from each source alone there.

mod front;
#[cfg(test)]
mod tests;

use std::f32::consts::PI;

use bevy_math::Vec3;

use front::Front;

use super::groups::Groups;

/// Index of no half-edge and of no particle.
const NONE: u32 = u32::MAX;
/// Height over the edge below which a triangle is a line \[-\].
const THIN: f32 = 1e-4;
/// Excess of the angles around a particle over those of flat cloth above which paths bend there \[rad\].
const BEND: f32 = 0.05;

/// A triangle mesh, prepared for geodesic distances from any of its particles.
///
/// A half-edge `3 t + k` stands for corner k of triangle t, and for the edge opposite to it.
#[derive(Clone, Debug, Default)]
pub struct Geodesics {
    positions: Vec<Vec3>,
    /// Particle at the corner of each half-edge.
    corners: Vec<u32>,
    /// For each half-edge the other one of the same edge; `NONE` at the boundary, where more than two meet, and where the other triangle is
    /// seen from its back.
    across: Vec<u32>,
    /// For each half-edge the corner in the plane of the triangle, from the start of the edge, in lengths of the edge: along it and across.
    /// Across is 0 for a triangle that is a line.
    apexes: Vec<[f32; 2]>,
    /// Unit normal of each triangle; zero for one without area.
    normals: Vec<Vec3>,
    /// Half-edges at the corners of each particle.
    around: Groups,
    /// Particles at which the shortest path can bend.
    bends: Vec<bool>,
}

impl Geodesics {
    /// Prepares the mesh of `triangles`, particles at the corners of each, which lie at `rest_positions` \[m\].
    ///
    /// Triangles that name a particle twice or one that does not exist are left out. Triangles without area count as
    /// their edges.
    pub fn new(rest_positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let particles = rest_positions.len();
        let corners: Vec<u32> = triangles
            .iter()
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .filter(|triangle| triangle.iter().all(|&i| (i as usize) < particles))
            .flatten()
            .copied()
            .collect();

        let halves = (0..).zip(&corners).map(|(half, &i)| (i, half));
        let mut mesh = Self {
            positions: rest_positions.to_vec(),
            normals: Vec::with_capacity(corners.len() / 3),
            across: Vec::with_capacity(corners.len()),
            apexes: Vec::with_capacity(corners.len()),
            bends: Vec::with_capacity(particles),
            around: Groups::new(particles, halves),
            corners,
        };
        for half in 0..mesh.corners.len() as u32 {
            let [g, p, q] = mesh.corners_from(half).map(|i| mesh.at(i));
            if half % 3 == 0 {
                mesh.normals.push((p - g).cross(q - g).normalize_or_zero());
            }
            mesh.across.push(mesh.find_across(half));
            let edge = q - p;
            let scale = edge.length_squared().recip();
            let x = (g - p).dot(edge) * scale;
            let y = (g - p - edge * x).length() * scale.sqrt();
            mesh.apexes.push([x, if y > THIN { y } else { 0.0 }]);
        }
        for i in 0..particles as u32 {
            mesh.bends.push(mesh.can_bend(i));
        }
        mesh
    }

    /// Distance of each particle from the nearest of the particles `sources` \[m\], shape \[particles\].
    ///
    /// Infinite where no path leads. Sources out of range are ignored.
    pub fn distances(&self, sources: &[u32]) -> Vec<f32> {
        self.nearest(sources).0
    }

    /// Distance of each particle from the nearest source \[m\], and the index of that source in `sources`, both of shape \[particles\].
    ///
    /// Without a path the distance is infinite and the source [`u32::MAX`]. Sources out of range are ignored; of equal distances the
    /// first source counts.
    pub fn nearest(&self, sources: &[u32]) -> (Vec<f32>, Vec<u32>) {
        Front::new(self, sources).run()
    }

    fn at(&self, particle: u32) -> Vec3 {
        self.positions[particle as usize]
    }

    fn around(&self, particle: u32) -> &[u32] {
        self.around.of(particle)
    }

    /// The particle at the corner of a half-edge, and the two at the ends of its edge.
    fn corners_from(&self, half: u32) -> [u32; 3] {
        [half, next(half), previous(half)].map(|h| self.corners[h as usize])
    }

    fn find_across(&self, half: u32) -> u32 {
        let [_, p, q] = self.corners_from(half);
        let around = self.around(p).iter().filter(|&&h| h / 3 != half / 3);
        let mut others = around.filter_map(|&h| {
            let [ahead, behind] = [next(h), previous(h)];
            if self.corners[behind as usize] == q {
                Some((ahead, true))
            } else {
                (self.corners[ahead as usize] == q).then_some((behind, false))
            }
        });
        match (others.next(), others.next()) {
            (Some((other, true)), None) => other,
            _ => NONE,
        }
    }

    fn can_bend(&self, particle: u32) -> bool {
        let mut angle = 0.0;
        let mut open = 0;
        for &half in self.around(particle) {
            let [g, p, q] = self.corners_from(half).map(|i| self.at(i));
            angle += (p - g).angle_between(q - g);
            for side in [next(half), previous(half)] {
                open += u32::from(self.across[side as usize] == NONE);
            }
        }
        match open {
            0 => angle > 2.0 * PI + BEND,
            1 | 2 => angle > PI + BEND,
            _ => true,
        }
    }
}

fn next(half: u32) -> u32 {
    if half % 3 == 2 { half - 2 } else { half + 1 }
}

fn previous(half: u32) -> u32 {
    if half.is_multiple_of(3) {
        half + 2
    } else {
        half - 1
    }
}

/// Chooses up to `most` of the particles `pins` that lie far from each other, for the tethers of a cloth; all of them if there are no more
/// than that.
///
/// The first is the pin farthest from the mean of the pins, each next one the pin farthest from those chosen before (straight lines between
/// `rest_positions` \[m\]; the earlier of equals). Pins out of range are left out.
pub fn tether_anchors(pins: &[u32], rest_positions: &[Vec3], most: usize) -> Vec<u32> {
    let at = |pin: u32| rest_positions.get(pin as usize).copied();
    let pins: Vec<(u32, Vec3)> = pins.iter().filter_map(|&i| Some((i, at(i)?))).collect();
    if pins.len() <= most {
        return pins.iter().map(|&(i, _)| i).collect();
    }
    let mean = pins.iter().map(|&(_, p)| p).sum::<Vec3>() / pins.len() as f32;
    let mut free: Vec<f32> = pins.iter().map(|&(_, p)| p.distance(mean)).collect();
    let mut anchors: Vec<u32> = Vec::with_capacity(most);
    while anchors.len() < most {
        let mut farthest = 0;
        for (i, distance) in free.iter().enumerate() {
            if *distance > free[farthest] {
                farthest = i;
            }
        }
        let first = anchors.is_empty();
        if !first && free[farthest] <= 0.0 {
            break;
        }
        let (pin, place) = pins[farthest];
        anchors.push(pin);
        for (distance, &(_, p)) in free.iter_mut().zip(&pins) {
            let to = p.distance(place);
            *distance = if first { to } else { distance.min(to) };
        }
    }
    anchors
}
