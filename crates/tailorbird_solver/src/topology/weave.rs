//! Warp and weft: the directions of the threads on a triangle mesh, and the edges that follow them.
//!
//! Woven cloth hardly stretches along its threads and shears easily, so an edge's stiffness depends on its angle to them. In each
//! triangle's plane a direction is a complex number relative to the triangle's first side. Its square is the same for both ends of a line,
//! its fourth power the same for warp and weft: sums of fourth powers average directions modulo 90° (N-symmetry fields, as in Palacios &
//! Zhang 2007, Rotational Symmetry Field Design on Surfaces).

use bevy_math::{Vec2, Vec3};

use super::mesh_edges::MeshEdges;

mod frame;
mod gaps;

use frame::{TriangleFrame, along_v, conjugate, root, square};

/// Cosine of four times the largest angle to the nearest axis at which an edge follows a thread: 27.5°.
///
/// Below 30°, so that an equilateral mesh is not all threads and no shear; as near to it as jitter allows, because around a particle of an
/// irregular mesh edges lie 60° apart on average, and each of the four directions should find one. Diagonals of cells of any aspect are
/// told by their right angle instead.
const ALIGNED: f32 = -0.342;

/// Least agreement of the parts of an average for it to mean something. 1 is full agreement.
const COHERENT: f32 = 0.2;

/// Cosine of four times the largest angle between the threads of adjacent triangles at which the mesh counts as unrolled without
/// distortion: 10°.
const DEVELOPABLE: f32 = 0.766;

/// Number of passes over a curved mesh that smooth its threads.
const SWEEPS: usize = 8;

/// Threads that an edge follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum EdgeFamily {
    /// Threads along v.
    Warp,
    /// Threads along u.
    Weft,
    /// Neither warp nor weft.
    Shear,
}

/// Threads on a triangle mesh.
#[derive(Clone, Debug, Default)]
pub struct Weave {
    /// Unit direction of the warp in the plane of each triangle, either way. The weft is perpendicular to it.
    pub warp: Vec<Vec3>,
    /// Particles at the ends of each edge, the lower first. Ascending.
    pub ends: Vec<[u32; 2]>,
    /// Threads that each edge follows.
    pub family: Vec<EdgeFamily>,
    /// L²/(A₁ + A₂) of each edge \[-\], with its length and the areas of its triangles. The compliance of its spring is that of the
    /// membrane \[m/N\] times this.
    pub scale: Vec<f32>,
    /// Square of the cosine of the angle between each edge and the warp [-].
    pub along_warp: Vec<f32>,
}

impl Weave {
    /// Threads of a mesh without degenerate triangles, whose edges are `edges`.
    ///
    /// With texture coordinates (`uvs`, at the corners of each triangle) the warp is the direction in which u is constant. Else it is the
    /// direction of most edges that are no diagonals of cells, modulo 90°: one direction on each piece of the mesh that unrolls into a
    /// plane, a smooth field that follows the edges on others. Where the edges show no direction, the border counts, then the vertical. The
    /// more vertical thread is the warp.
    pub fn new(
        rest_positions: &[Vec3],
        triangles: &[[u32; 3]],
        edges: &MeshEdges,
        uvs: Option<&[[Vec2; 3]]>,
    ) -> Self {
        let surface = FramedMesh {
            frames: triangles
                .iter()
                .map(|t| TriangleFrame::new(t.map(|i| rest_positions[i as usize])))
                .collect(),
            triangles,
            edges,
        };
        let uvs = uvs.filter(|uvs| uvs.len() == triangles.len());
        let threads = surface.threads(|t| {
            let [a, b, c] = triangles[t].map(|i| rest_positions[i as usize]);
            uvs.and_then(|uvs| along_v([a, b, c], uvs[t]))
        });
        let mut weave = Self {
            ends: edges.ends.clone(),
            warp: surface
                .frames
                .iter()
                .zip(&threads)
                .map(|(frame, thread)| frame.x * root(*thread).x + frame.y * root(*thread).y)
                .collect(),
            ..Self::default()
        };
        let mut leanings = Vec::with_capacity(edges.len());
        for (edge, ends) in edges.ends.iter().enumerate() {
            let [a, b] = ends.map(|i| rest_positions[i as usize]);
            let sides = edges.sides(edge as u32);
            let area: f32 = sides
                .iter()
                .map(|side| surface.frames[*side as usize / 3].area)
                .sum();
            let leaning = surface.leaning(sides, &threads);
            weave.scale.push(a.distance_squared(b) / area);
            weave.along_warp.push(0.5 + 0.5 * leaning.upright);
            weave.family.push(if leaning.alignment > ALIGNED {
                leaning.family
            } else {
                EdgeFamily::Shear
            });
            leanings.push(leaning);
        }
        gaps::close(&mut weave, &leanings, rest_positions);
        weave
    }

    /// Renumbers the particles: `number[i]` is the new index of particle `i`. Edges stay ascending.
    pub fn renumber(&mut self, number: &[u32]) {
        let mut edges: Vec<([u32; 2], usize)> = self
            .ends
            .iter()
            .enumerate()
            .map(|(edge, ends)| {
                let [a, b] = ends.map(|i| number[i as usize]);
                ([a.min(b), a.max(b)], edge)
            })
            .collect();
        edges.sort_unstable();
        self.family = edges.iter().map(|e| self.family[e.1]).collect();
        self.scale = edges.iter().map(|e| self.scale[e.1]).collect();
        self.along_warp = edges.iter().map(|e| self.along_warp[e.1]).collect();
        self.ends = edges.into_iter().map(|e| e.0).collect();
    }
}

/// Angles of an edge to the threads.
#[derive(Clone, Copy, Debug)]
struct Leaning {
    /// Cosine of four times the angle to the nearest thread; −1 for a diagonal of cells whose sides follow the threads.
    alignment: f32,
    /// The nearest thread.
    family: EdgeFamily,
    /// Cosine of twice the angle to the warp.
    upright: f32,
}

/// A step from one triangle to the next: the side that is left and the side that is entered.
type Step = [u32; 2];

struct FramedMesh<'a> {
    frames: Vec<TriangleFrame>,
    triangles: &'a [[u32; 3]],
    edges: &'a MeshEdges,
}

impl FramedMesh<'_> {
    /// Square of the warp's direction in each triangle. `given` is the warp in some of them.
    fn threads(&self, given: impl Fn(usize) -> Option<Vec3>) -> Vec<Vec2> {
        let mut threads = vec![Vec2::X; self.frames.len()];
        let mut seen = vec![false; self.frames.len()];
        let mut roots = Vec::new();
        for (t, frame) in self.frames.iter().enumerate() {
            if let Some(warp) = given(t).and_then(|warp| frame.project(warp).try_normalize()) {
                threads[t] = square(warp);
                seen[t] = true;
                roots.push(t as u32);
            }
        }
        for step in self.walk(roots, &mut seen) {
            threads[step[1] as usize / 3] =
                self.carry(threads[step[0] as usize / 3], step, square_of);
        }
        let mut crosses = vec![Vec2::ZERO; self.frames.len()];
        for t in 0..self.frames.len() {
            if !std::mem::replace(&mut seen[t], true) {
                let steps = self.walk(vec![t as u32], &mut seen);
                self.estimate(t, &steps, &mut crosses, &mut threads);
            }
        }
        threads
    }

    /// Steps that lead to all triangles not `seen` yet, nearest first.
    fn walk(&self, mut queue: Vec<u32>, seen: &mut [bool]) -> Vec<Step> {
        let mut steps = Vec::new();
        let mut next = 0;
        while let Some(&t) = queue.get(next) {
            next += 1;
            for side in 3 * t..3 * t + 3 {
                for across in self.edges.across(side) {
                    if !std::mem::replace(&mut seen[across as usize / 3], true) {
                        queue.push(across / 3);
                        steps.push([side, across]);
                    }
                }
            }
        }
        steps
    }

    /// A power of a direction, unrolled over an edge into the next triangle. `power` gives that power of a side.
    fn carry(&self, v: Vec2, [from, to]: Step, power: fn(&Self, u32) -> Vec2) -> Vec2 {
        let start = |side: u32| self.triangles[side as usize / 3][side as usize % 3];
        let relative = v.rotate(conjugate(power(self, from)));
        if start(from) == start(to) {
            conjugate(relative).rotate(power(self, to))
        } else {
            relative.rotate(power(self, to))
        }
    }

    /// Estimates the threads of one piece of the mesh from its edges. `crosses` is scratch for their fourth powers.
    fn estimate(&self, first: usize, steps: &[Step], crosses: &mut [Vec2], threads: &mut [Vec2]) {
        let piece = || std::iter::once(first).chain(steps.iter().map(|step| step[1] as usize / 3));
        let mut average = |local: &dyn Fn(usize) -> (Vec2, f32)| {
            let mut weight = 0.0;
            for t in piece() {
                let part = local(t);
                crosses[t] = part.0;
                weight += part.1;
            }
            for &[from, to] in steps.iter().rev() {
                let part = self.carry(crosses[to as usize / 3], [to, from], fourth_of);
                crosses[from as usize / 3] += part;
            }
            let sum = crosses[first];
            (sum.length() > COHERENT * weight).then(|| sum.normalize())
        };
        let cross = average(&|t| self.edges_at(t))
            .or_else(|| average(&|t| self.border_at(t)))
            .or_else(|| average(&|t| self.axis_at(t, Vec3::Y)))
            .or_else(|| average(&|t| self.axis_at(t, Vec3::Z)))
            .unwrap_or(Vec2::X);
        crosses[first] = cross;
        for &step in steps {
            crosses[step[1] as usize / 3] =
                self.carry(crosses[step[0] as usize / 3], step, fourth_of);
        }
        if piece().any(|t| self.disagreement(t, crosses) < DEVELOPABLE) {
            self.smooth(first, steps, crosses);
        }

        threads[first] = root(crosses[first]);
        for &step in steps {
            let t = step[1] as usize / 3;
            let carried = self.carry(threads[step[0] as usize / 3], step, square_of);
            let thread = root(crosses[t]);
            threads[t] = if thread.dot(carried) < 0.0 {
                -thread
            } else {
                thread
            };
        }
        let uprightness = |axis: Vec3| {
            let (mut sum, mut area) = (0.0, 0.0);
            for t in piece() {
                let frame = &self.frames[t];
                sum += frame.area * threads[t].dot(square(frame.project(axis)));
                area += frame.area;
            }
            (f32::abs(sum) > 0.05 * area).then_some(sum)
        };
        let upright = uprightness(Vec3::Y).or_else(|| uprightness(Vec3::Z));
        if upright.is_some_and(|sum| sum < 0.0) {
            for t in piece() {
                threads[t] = -threads[t];
            }
        }
    }

    /// Lowest cosine of four times the angle between the threads of a triangle and those of its neighbours with higher indices.
    fn disagreement(&self, t: usize, crosses: &[Vec2]) -> f32 {
        let mut lowest = 1.0f32;
        for side in 3 * t as u32..3 * t as u32 + 3 {
            for across in self.edges.across(side).filter(|across| *across > side) {
                let there = crosses[across as usize / 3];
                lowest = lowest.min(crosses[t].dot(self.carry(there, [across, side], fourth_of)));
            }
        }
        lowest
    }

    /// Draws the threads of each triangle towards its own edges and the threads around it.
    fn smooth(&self, first: usize, steps: &[Step], crosses: &mut [Vec2]) {
        let own = |t: usize| {
            let (sum, weight) = self.edges_at(t);
            sum / weight.max(f32::MIN_POSITIVE)
        };
        let piece = || std::iter::once(first).chain(steps.iter().map(|step| step[1] as usize / 3));
        for t in piece() {
            let own = own(t);
            if own.length() > 0.5 {
                crosses[t] = own.normalize();
            }
        }
        for _ in 0..SWEEPS {
            for t in piece() {
                let mut sum = 2.0 * own(t);
                for side in 3 * t as u32..3 * t as u32 + 3 {
                    for across in self.edges.across(side) {
                        let there = crosses[across as usize / 3];
                        sum += self.carry(there, [across, side], fourth_of);
                    }
                }
                crosses[t] = sum.normalize_or(crosses[t]);
            }
        }
    }

    /// Sum of the fourth powers of the sides of a triangle but for a diagonal, and its greatest possible length.
    fn edges_at(&self, t: usize) -> (Vec2, f32) {
        let frame = &self.frames[t];
        let sides = (0..3).filter(|k| frame.diagonal != Some(*k));
        sides.fold((Vec2::ZERO, 0.0), |(sum, weight), k| {
            let length = frame.lengths[k];
            (sum + length * square(frame.sides[k]), weight + length)
        })
    }

    /// Sum of the fourth powers of the sides that lie on the border, and its greatest possible length.
    fn border_at(&self, t: usize) -> (Vec2, f32) {
        let border = |k: &usize| self.edges.across((3 * t + k) as u32).next().is_none();
        let frame = &self.frames[t];
        (0..3)
            .filter(border)
            .fold((Vec2::ZERO, 0.0), |(sum, weight), k| {
                let length = frame.lengths[k].sqrt();
                (sum + length * square(frame.sides[k]), weight + length)
            })
    }

    /// Fourth power of an axis, and its greatest possible length.
    fn axis_at(&self, t: usize, axis: Vec3) -> (Vec2, f32) {
        let frame = &self.frames[t];
        (frame.area * square(square(frame.project(axis))), frame.area)
    }

    /// Mean over its triangles of the angles of an edge to the threads.
    fn leaning(&self, sides: &[u32], threads: &[Vec2]) -> Leaning {
        let (mut alignment, mut upright) = (0.0, 0.0);
        for &side in sides {
            let (t, k) = (side as usize / 3, side as usize % 3);
            let frame = &self.frames[t];
            let cross = square(threads[t]);
            let along = |k: usize| square(frame.sides[k]).dot(cross);
            let cut = frame.diagonal == Some(k)
                && along((k + 1) % 3) > ALIGNED
                && along((k + 2) % 3) > ALIGNED;
            alignment += if cut { -1.0 } else { along(k) };
            upright += frame.sides[k].dot(threads[t]);
        }
        Leaning {
            alignment: alignment / sides.len() as f32,
            family: if upright > 0.0 {
                EdgeFamily::Warp
            } else {
                EdgeFamily::Weft
            },
            upright: (upright / sides.len() as f32).clamp(-1.0, 1.0),
        }
    }
}

fn square_of(surface: &FramedMesh, side: u32) -> Vec2 {
    surface.frames[side as usize / 3].sides[side as usize % 3]
}

fn fourth_of(surface: &FramedMesh, side: u32) -> Vec2 {
    square(square_of(surface, side))
}

#[cfg(test)]
mod tests;
