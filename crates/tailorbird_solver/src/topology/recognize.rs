//! Recognises a triangle mesh that is a grid, so that it can be solved as one.

use bevy_math::{Vec2, Vec2Swizzles as _, Vec3};

use super::mesh_edges::MeshEdges;

/// Tolerance of the lengths of the edges of one direction: deviation from their mean, as a part of it.
const UNIFORM: f32 = 1e-3;

/// Tolerance of the right angles of the cells, as a cosine.
const RIGHT_ANGLE: f32 = 1e-2;

/// Largest ratio of the slope of the texture's v along the rows to that along the columns: the tangent of 22.5°.
const ACROSS: f32 = 0.414;

/// Least slope of the first axis along the rows or columns that orients the grid. 1 is the axis itself.
const STEEP: f32 = 0.1;

const UNPLACED: [i32; 2] = [i32::MIN; 2];

/// A triangle mesh that is a grid of equal rectangles, each cut along either diagonal.
///
/// The grid's triangles are counter-clockwise when its columns run +x and its rows −y: the layout of
/// [`ClothShape::Grid`](crate::shape::ClothShape::Grid).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recognized {
    /// Particles along a row, at least 2.
    pub columns: usize,
    /// Particles along a column, at least 2.
    pub rows: usize,
    /// Length of the edges along rows and along columns at rest \[m\].
    pub spacing: Vec2,
    /// `order[row * columns + column]` is the original index of that particle.
    pub order: Vec<u32>,
}

/// Two triangles with a common diagonal. Side `k` runs from corner `k` to the next.
struct Quad {
    /// Particles, counter-clockwise.
    corners: [u32; 4],
    sides: [u32; 4],
}

impl Recognized {
    /// Grid that a mesh forms, whatever the order of its vertices and triangles; `None` where it forms none.
    ///
    /// It may be flat or rolled up: the edges of each direction must have one length and the cells' angles be right, no more. With a closed
    /// tube, a hole, a missing triangle, an unused particle, or a triangle that faces the other way, the mesh is no grid. `edges` are the
    /// edges of `triangles`. Linear time.
    ///
    /// Rows follow one another along +v, where there are texture coordinates (`uvs`, at the corners of each triangle), else along −y, or in
    /// a horizontal sheet along +z, as far as the grid's directions allow. A mesh whose texture lies askew on it is no grid either: its
    /// threads do not follow its edges.
    pub fn detect(
        rest_positions: &[Vec3],
        triangles: &[[u32; 3]],
        edges: &MeshEdges,
        uvs: Option<&[[Vec2; 3]]>,
    ) -> Option<Self> {
        let quads = quads(rest_positions, triangles, edges)?;
        let places = place(rest_positions.len(), triangles.len(), &quads, edges)?;
        let mut lattice = Self::from_places(&places)?;
        if triangles.len() != 2 * (lattice.columns - 1) * (lattice.rows - 1) {
            return None;
        }
        let lengths = lattice.edge_lengths(rest_positions)?;
        lattice.spacing = Vec2::from_array(lengths);

        // Slopes of a value at the triangles' corners, along the rows and down the columns.
        let slopes = |value: &dyn Fn(usize, usize) -> f32| {
            let (mut sum, mut count) = ([0.0f64; 2], [0.0f64; 2]);
            for (t, triangle) in triangles.iter().enumerate() {
                for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                    let [a, b] = [from, to].map(|k| places[triangle[k] as usize]);
                    let step = [b[0] - a[0], b[1] - a[1]];
                    let along = usize::from(step[0] == 0);
                    if step[1 - along] == 0 {
                        let rise = value(t, to) - value(t, from);
                        sum[along] += f64::from(rise) * f64::from(step[along]);
                        count[along] += 1.0;
                    }
                }
            }
            [0, 1].map(|d| (sum[d] / count[d]) as f32 / lengths[d])
        };
        let position = |t: usize, k: usize| rest_positions[triangles[t][k] as usize];
        let steepest = |slopes: [f32; 2]| slopes[0].abs().max(slopes[1].abs());

        let texture = uvs
            .filter(|uvs| uvs.len() == triangles.len())
            .map(|uvs| slopes(&|t, k| uvs[t][k].y))
            .filter(|s| steepest(*s).is_finite() && steepest(*s) > 0.0);
        let slope = match texture {
            Some(s) if s[0].abs().min(s[1].abs()) > ACROSS * steepest(s) => return None,
            Some(s) => s,
            None => {
                let down = slopes(&|t, k| -position(t, k).y);
                if steepest(down) < STEEP {
                    slopes(&|t, k| position(t, k).z)
                } else {
                    down
                }
            }
        };
        let [right, down] = slope;
        let after = [down, right, -down, -right];
        let turns = (1..4).fold(0, |best, n| if after[n] > after[best] { n } else { best });
        for _ in 0..turns {
            lattice.turn();
        }
        Some(lattice)
    }

    /// Grid of the particles, from their columns and rows counted from any origin.
    fn from_places(places: &[[i32; 2]]) -> Option<Self> {
        let first = *places.first()?;
        let (mut low, mut high) = (first, first);
        for place in places {
            if *place == UNPLACED {
                return None;
            }
            for d in 0..2 {
                low[d] = low[d].min(place[d]);
                high[d] = high[d].max(place[d]);
            }
        }
        let [columns, rows] = [0, 1].map(|d| (i64::from(high[d]) - i64::from(low[d]) + 1) as usize);
        if columns.checked_mul(rows) != Some(places.len()) {
            return None;
        }
        let mut order = vec![u32::MAX; places.len()];
        for (particle, place) in places.iter().enumerate() {
            let [column, row] = [0, 1].map(|d| (place[d] - low[d]) as usize);
            let slot = &mut order[row * columns + column];
            if *slot != u32::MAX {
                return None;
            }
            *slot = particle as u32;
        }
        Some(Self {
            columns,
            rows,
            spacing: Vec2::ZERO,
            order,
        })
    }

    /// Length of the edges along rows and of those along columns \[m\], where they are the same everywhere.
    fn edge_lengths(&self, rest_positions: &[Vec3]) -> Option<[f32; 2]> {
        let at = |slot: usize| rest_positions[self.order[slot] as usize];
        let mut lengths = [0.0; 2];
        for (length, (step, columns, rows)) in lengths.iter_mut().zip([
            (1, self.columns - 1, self.rows),
            (self.columns, self.columns, self.rows - 1),
        ]) {
            let (mut sum, mut shortest, mut longest) = (0.0f64, f32::INFINITY, 0.0f32);
            for row in 0..rows {
                for column in 0..columns {
                    let slot = row * self.columns + column;
                    let edge = at(slot).distance(at(slot + step));
                    sum += f64::from(edge);
                    shortest = shortest.min(edge);
                    longest = longest.max(edge);
                }
            }
            let mean = (sum / (columns * rows) as f64) as f32;
            let uniform =
                longest - mean <= UNIFORM * mean && mean - shortest <= UNIFORM * mean && mean > 0.0;
            if !uniform {
                return None;
            }
            *length = mean;
        }
        Some(lengths)
    }

    /// Turns the grid by a quarter, so that rows follow one another along the direction that was +x.
    fn turn(&mut self) {
        let (columns, rows) = (self.rows, self.columns);
        self.order = (0..rows * columns)
            .map(|slot| {
                let (column, row) = (slot % columns, slot / columns);
                self.order[(self.rows - 1 - column) * self.columns + row]
            })
            .collect();
        (self.columns, self.rows) = (columns, rows);
        self.spacing = self.spacing.yx();
    }
}

/// Cells of a mesh each of whose triangles has a right angle and shares the side opposite to it with another one.
fn quads(rest_positions: &[Vec3], triangles: &[[u32; 3]], edges: &MeshEdges) -> Option<Vec<Quad>> {
    let apexes: Vec<usize> = triangles
        .iter()
        .map(|triangle| right_angle(triangle.map(|i| rest_positions[i as usize])))
        .collect::<Option<_>>()?;
    let mut quads = Vec::with_capacity(triangles.len() / 2);
    for (t, &apex) in apexes.iter().enumerate() {
        let diagonal = 3 * t + (apex + 1) % 3;
        let &[first, second] = edges.sides(edges.edge_of_side[diagonal]) else {
            return None;
        };
        let across = first as usize + second as usize - diagonal;
        let (other, side) = (across / 3, across % 3);
        let opposite = apexes[other];
        let corner = |k: usize| triangles[t][(apex + k) % 3];
        let corners = [corner(0), corner(1), triangles[other][opposite], corner(2)];
        if side != (opposite + 1) % 3 || triangles[other][side] != corners[3] {
            return None;
        }
        if t < other {
            let sides = [
                3 * t + apex,
                3 * other + (opposite + 2) % 3,
                3 * other + opposite,
                3 * t + (apex + 2) % 3,
            ];
            quads.push(Quad {
                corners,
                sides: sides.map(|side| side as u32),
            });
        }
    }
    Some(quads)
}

/// Corner at which a triangle has its right angle.
fn right_angle(corners: [Vec3; 3]) -> Option<usize> {
    let mut best = None;
    let mut smallest = RIGHT_ANGLE;
    for k in 0..3 {
        let [p, q, r] = [0, 1, 2].map(|n| corners[(k + n) % 3]);
        let cosine = ((q - p).dot(r - p) / ((q - p).length() * (r - p).length())).abs();
        if cosine <= smallest {
            (best, smallest) = (Some(k), cosine);
        }
    }
    best
}

/// Column and row of each particle, counted from a corner of the first quad; `None` where two paths to a particle disagree, or a side joins
/// more than two quads or two that face opposite ways.
fn place(
    particles: usize,
    triangles: usize,
    quads: &[Quad],
    edges: &MeshEdges,
) -> Option<Vec<[i32; 2]>> {
    let mut side_of_quad = vec![(u32::MAX, 0u8); triangles * 3];
    for (q, quad) in quads.iter().enumerate() {
        for (k, &side) in quad.sides.iter().enumerate() {
            side_of_quad[side as usize] = (q as u32, k as u8);
        }
    }
    let mut places = vec![UNPLACED; particles];
    for (&corner, at) in quads
        .first()?
        .corners
        .iter()
        .zip([[0, 0], [0, 1], [1, 1], [1, 0]])
    {
        places[corner as usize] = at;
    }
    let mut seen = vec![false; quads.len()];
    seen[0] = true;
    let mut stack = vec![0];
    while let Some(q) = stack.pop() {
        let quad: &Quad = &quads[q];
        for (k, &side) in quad.sides.iter().enumerate() {
            let across = match edges.sides(edges.edge_of_side[side as usize]) {
                [_] => continue,
                &[first, second] => {
                    if first == side {
                        second
                    } else {
                        first
                    }
                }
                _ => return None,
            };
            let (neighbor, m) = side_of_quad[across as usize];
            let (neighbor, m) = (neighbor as usize, usize::from(m));
            let corners = quads.get(neighbor)?.corners;
            let corner = |n: usize| corners[(m + n) % 4] as usize;
            let [from, to] = [quad.corners[k] as usize, quad.corners[(k + 1) % 4] as usize];
            if [corner(0), corner(1)] != [to, from] {
                return None;
            }
            let [p, q] = [places[to], places[from]];
            // To the left of a step to the right lies the row above.
            let left = [q[1] - p[1], p[0] - q[0]];
            for (particle, base) in [(corner(2), q), (corner(3), p)] {
                let at = [base[0] + left[0], base[1] + left[1]];
                if places[particle] == UNPLACED {
                    places[particle] = at;
                } else if places[particle] != at {
                    return None;
                }
            }
            if !std::mem::replace(&mut seen[neighbor], true) {
                stack.push(neighbor);
            }
        }
    }
    seen.iter().all(|seen| *seen).then_some(places)
}

#[cfg(test)]
mod tests;
