//! Hinges: pairs of triangles that share an edge, and the measure of bending there.
//!
//! Of the four particles of a hinge (ends x₀, x₁ of the edge, opposite corners x₂, x₃) the vector D = Σ Kᵢ xᵢ vanishes
//! where they lie in a plane as they do at rest; it has the length 2 L sin(θ/2) after a fold by the angle θ along an edge of
//! length L. The coefficients Kᵢ depend on the rest shape alone, through the cotangents of the angles between the edge and
//! the other sides (Bergou et al., "A Quadratic Bending Model for Inextensible Surfaces", 2006):
//! K₀ = cot₁ + cot₁′, K₁ = cot₀ + cot₀′, K₂ = −cot₀ − cot₁, K₃ = −cot₀′ − cot₁′, with cot₀ and cot₁ at the ends x₀ and x₁ of
//! the triangle of x₂, the primed ones in that of x₃.
//!
//! # Energy
//!
//! The energy of a hinge is ½ B g |D|² with B the bending rigidity \[N m\] and
//!
//! g = 1/(S (1 + r (3r − 1)/2 + r² q²/2)), S = A + A′, r = (A cot₀ cot₁ + A′ cot₀′ cot₁′)/S, q = 2 (A cot₀ − A′ cot₀′)/S
//!
//! with the areas A, A′ of the triangles. Bergou et al. have g = 3/S, which makes a sheet three times as stiff as B says: they
//! give each edge a third of the area of its triangles, but in a sheet of right-angled triangles that is bent along its rows
//! one edge in three is bent, and it is bent by the angle that belongs to the whole area S.
//!
//! The other factor is there because a hinge measures more than the bending across its edge. On a surface of small curvature M
//! (in the frame of the edge: t along, n across), D = ±S (Mₙₙ − r Mₜₜ + q Mₜₙ). Edges whose r is large, like the diagonals of
//! a grid (r = 1), count curvature that other edges count as well. The factor is the simplest one that is right wherever
//! the sum over all hinges can be done by hand, for curvature in any direction: the equilateral triangulation (r = ⅓, q = 0:
//! g = 1/S), and right-angled triangles of any aspect ratio with alternating diagonals (r = 0 on rows and columns: g = 1/S; r = 1
//! on diagonals: g = 2/((4 + q²) S)). Triangulated grids with all diagonals alike are right along rows and columns; there, bending
//! along one diagonal is 2.5 times as stiff and along the other one half as stiff as it should be, which no choice of g can
//! change. Irregular Delaunay meshes come out 4 to 10 % too stiff when bent to a cylinder by force, and right within 3 % when
//! the particles in between find their own place (grids whose particles are moved by a fifth of a cell: 0 to 16 %, and within
//! 9 %). With alternating diagonals every other particle then rises a little, and the sheet is a quarter softer than asked.

use std::ops::Range;

use bevy_math::{DVec3, Vec3};

use super::{
    coloring::color_in_blocks,
    mesh_edges::{MOST_SIDES, MeshEdges},
};
use crate::memory_bytes;

/// Ratio of a triangle's area to the square of its longest edge below which it has no hinges.
const DEGENERATE: f64 = 1e-6;

/// Angle of a fold at rest \[rad\] below which a hinge counts as flat.
const FLAT: f64 = 1e-3;

/// A run of hinges no two of which share a particle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HingeBatch {
    /// Range of its hinges.
    pub range: Range<usize>,
    /// True if all its hinges are flat at rest: their rest lengths are 0.
    pub flat: bool,
}

/// Hinges as parallel arrays.
#[derive(Clone, Debug, Default)]
pub struct HingeConstraints {
    /// The ends of the edge, then the opposite corners.
    pub particles: Vec<[u32; 4]>,
    /// Kᵢ [-]; they add up to 0.
    pub coefficients: Vec<[f32; 4]>,
    /// 1/g \[m²\]: the energy is ½ B |D|² / area, the compliance of the constraint D = 0 is area/B [m/N].
    pub areas: Vec<f32>,
    /// Length of D at rest \[m\]. Negative where D points against (x₁ − x₀) × (x₃ − x₂).
    pub rest_lengths: Vec<f32>,
    /// All hinges, in the order in which they are solved; within a batch sorted by the lowest particle.
    pub batches: Vec<HingeBatch>,
}

/// Properties of a hinge besides its particles.
#[derive(Clone, Copy)]
struct Hinge {
    coefficients: [f32; 4],
    area: f32,
    rest_length: f32,
}

memory_bytes!(HingeConstraints: particles, coefficients, areas, rest_lengths, batches);

impl HingeConstraints {
    /// Hinges of a mesh: one for each edge of two triangles that are not degenerate. At an edge of up to eight triangles the two that lie
    /// flattest are a pair, then the next two, as long as they are folded by less than 60°.
    ///
    /// `rest_positions` are the positions of the particles at rest \[m\].
    ///
    /// # Panics
    /// When a triangle's corner is not below the number of particles.
    pub fn new(triangles: &[[u32; 3]], rest_positions: &[Vec3]) -> Self {
        let [mut flat, mut curved] = [const { (Vec::new(), Vec::new()) }; 2];
        for particles in pairs_of_triangles(triangles, rest_positions) {
            let corners = particles.map(|i| rest_positions[i as usize].as_dvec3());
            let Some(hinge) = hinge(corners) else {
                continue;
            };
            let (tuples, hinges) = if hinge.rest_length == 0.0 {
                &mut flat
            } else {
                &mut curved
            };
            tuples.push(particles);
            hinges.push(hinge);
        }
        let mut constraints = Self::default();
        for (flat, (tuples, hinges)) in [(true, flat), (false, curved)] {
            for batch in color_in_blocks(&tuples, rest_positions.len()) {
                let start = constraints.len();
                for k in batch {
                    let hinge: &Hinge = &hinges[k as usize];
                    constraints.particles.push(tuples[k as usize]);
                    constraints.coefficients.push(hinge.coefficients);
                    constraints.areas.push(hinge.area);
                    constraints.rest_lengths.push(hinge.rest_length);
                }
                let range = start..constraints.len();
                constraints.batches.push(HingeBatch { range, flat });
            }
        }
        constraints
    }

    /// The number of hinges.
    pub fn len(&self) -> usize {
        self.particles.len()
    }

    /// Returns whether there are none.
    pub fn is_empty(&self) -> bool {
        self.particles.is_empty()
    }
}

/// Ends and opposite corners of the pairs of triangles at an edge, in the order of the edges.
fn pairs_of_triangles(triangles: &[[u32; 3]], rest_positions: &[Vec3]) -> Vec<[u32; 4]> {
    let edges = MeshEdges::new(rest_positions.len(), triangles);
    let opposite = |side: u32| triangles[side as usize / 3][(side as usize + 2) % 3];
    let mut pairs = Vec::with_capacity(edges.len());
    for (edge, &[a, b]) in (0..).zip(&edges.ends) {
        match edges.sides(edge) {
            &[c, d] => {
                let [c, d] = [c, d].map(opposite);
                if c != d && a != b {
                    pairs.push([a, b, c, d]);
                }
            }
            sides if (3..=MOST_SIDES).contains(&sides.len()) => {
                let opposite = sides.iter().map(|side| opposite(*side)).collect();
                pairs.extend(flattest_pairs([a, b], opposite, rest_positions));
            }
            _ => {}
        }
    }
    pairs
}

/// Pairs of the triangles at one edge of more than two: the two that lie flattest, then the next two.
fn flattest_pairs(
    [a, b]: [u32; 2],
    mut opposite: Vec<u32>,
    rest_positions: &[Vec3],
) -> Vec<[u32; 4]> {
    /// Cosine of the largest fold.
    const MOST_FOLDED: f64 = 0.5;
    let at = |i: u32| rest_positions[i as usize].as_dvec3();
    let along = (at(b) - at(a)).normalize_or_zero();
    // From the edge into the triangle, at right angles.
    let across = |i: u32| {
        (at(i) - at(a))
            .reject_from_normalized(along)
            .normalize_or_zero()
    };
    let mut pairs = Vec::new();
    loop {
        let mut best = None;
        let mut flattest = MOST_FOLDED;
        for (i, &c) in opposite.iter().enumerate() {
            for (j, &d) in opposite.iter().enumerate().skip(i + 1) {
                let flatness = -across(c).dot(across(d));
                if flatness > flattest && c != d {
                    (best, flattest) = (Some([i, j]), flatness);
                }
            }
        }
        let Some([i, j]) = best else {
            return pairs;
        };
        let d = opposite.remove(j);
        let c = opposite.remove(i);
        pairs.push([a, b, c, d]);
    }
}

/// Measures one hinge; `None` where a triangle is degenerate.
fn hinge([x0, x1, x2, x3]: [DVec3; 4]) -> Option<Hinge> {
    let edge = x1 - x0;
    // Area, and cotangents at both ends of the edge.
    let measure = |corner: DVec3| {
        let (from_0, from_1) = (corner - x0, corner - x1);
        let double_area = edge.cross(from_0).length();
        let longest = edge
            .length_squared()
            .max(from_0.length_squared())
            .max(from_1.length_squared());
        let valid = double_area > 2.0 * DEGENERATE * longest && longest.is_finite();
        valid.then(|| {
            let cotangents = [edge.dot(from_0), -edge.dot(from_1)].map(|dot| dot / double_area);
            (0.5 * double_area, cotangents)
        })
    };
    let (area, [cot_0, cot_1]) = measure(x2)?;
    let (area_3, [cot_0_3, cot_1_3]) = measure(x3)?;
    let coefficients = [
        cot_1 + cot_1_3,
        cot_0 + cot_0_3,
        -cot_0 - cot_1,
        -cot_0_3 - cot_1_3,
    ]
    .map(|k| k as f32);

    let sum = area + area_3;
    let r = (area * cot_0 * cot_1 + area_3 * cot_0_3 * cot_1_3) / sum;
    let q = 2.0 * (area * cot_0 - area_3 * cot_0_3) / sum;
    let area = sum * (1.0 + 0.5 * r * (3.0 * r - 1.0) + 0.5 * r * r * q * q);

    let [_, k1, k2, k3] = coefficients.map(f64::from);
    let d = k1 * edge + k2 * (x2 - x0) + k3 * (x3 - x0);
    let folded = d.length() > FLAT * edge.length();
    let rest_length = if folded {
        d.length().copysign(d.dot(edge.cross(x3 - x2)))
    } else {
        0.0
    };
    Some(Hinge {
        coefficients,
        area: area as f32,
        rest_length: rest_length as f32,
    })
}

#[cfg(test)]
#[path = "hinges_tests.rs"]
mod tests;
