//! Vectors between two steps, written into interleaved vertices: p (1 − f) + q f.

use bevy_math::Vec3;
use fearless_simd::{Level, Simd, dispatch, f32x4, prelude::*};
use tailorbird_solver::{
    kernels::lanes::{Factor, Reading, V3, Window, each_window, with_scratch},
    points::Points,
};

/// An attribute of three numbers in interleaved vertices.
#[derive(Debug)]
pub struct Interleaved<'a> {
    /// All numbers of all vertices.
    pub words: &'a mut [f32],
    /// Numbers of a vertex.
    pub stride: usize,
    /// Start of the attribute in a vertex; there are three numbers from there on.
    pub offset: usize,
}

/// Rows of a sheet as interleaved vertices.
#[derive(Debug)]
pub struct SheetVertices<'a> {
    /// All numbers of all vertices.
    pub words: &'a mut [f32],
    /// Numbers of a vertex.
    pub stride: usize,
    /// Vertices of a row.
    pub columns: usize,
    /// Starts of the position, the normal and the tangent in a vertex. The tangent has four numbers.
    pub places: [usize; 3],
    /// The last number of the tangents.
    pub handedness: f32,
}

/// The vectors of the last two steps.
#[derive(Clone, Copy)]
pub struct Between<'a> {
    /// After the step before, and after the last one.
    pub ends: [&'a Points; 2],
    /// The part of the path, 0 to 1.
    pub fraction: f32,
    /// Offsets that are added.
    pub offsets: Option<&'a Points>,
    /// Operation on the sum.
    pub last: Last,
}

/// Operation on a vector before it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Last {
    /// Each coordinate by its factor.
    Scale(Vec3),
    /// Made as long as 1; where that cannot be, the vector after the last step is written.
    Unit,
}

impl Between<'_> {
    /// Several vectors side by side: those of a window, `first` further on.
    #[inline(always)]
    fn side_by_side<S: Simd>(&self, simd: S, window: Window, first: usize) -> V3<S> {
        let (late, early) = (
            Factor(S::f32s::splat(simd, self.fraction)),
            Factor(S::f32s::splat(simd, 1.0 - self.fraction)),
        );
        let end: V3<S> = self.ends[1].window(simd, window, first);
        let mut v = early * self.ends[0].window(simd, window, first) + late * end;
        if let Some(offsets) = self.offsets {
            v = v + offsets.window(simd, window, first);
        }
        match self.last {
            Last::Scale(factors) => {
                v.x *= factors.x;
                v.y *= factors.y;
                v.z *= factors.z;
                v
            }
            Last::Unit => {
                let inverse = one_over_length(simd, v);
                let known = inverse.simd_gt(S::f32s::splat(simd, 0.0));
                (Factor(inverse) * v).select(known, end)
            }
        }
    }

    pub fn one(&self, i: usize) -> Vec3 {
        let [from, to] = self.ends.map(|points| points.get(i));
        let mut v = from * (1.0 - self.fraction) + to * self.fraction;
        if let Some(offsets) = self.offsets {
            v += offsets.get(i);
        }
        match self.last {
            Last::Scale(factors) => v * factors,
            Last::Unit => v.normalize_or(to),
        }
    }
}

/// Writes the vectors from `first` on into vertices, as many as there are vertices.
///
/// # Panics
/// When there are more vertices than vectors.
pub fn interleave(level: Level, between: Between, first: usize, to: Interleaved) {
    dispatch!(level, simd => interleave_with(simd, between, first, to));
}

/// Writes the vectors with these numbers into vertices.
///
/// # Panics
/// When a number is not below that of the vectors.
pub fn interleave_listed(between: Between, list: &[u32], to: Interleaved) {
    for (vertex, &i) in to.words.chunks_exact_mut(to.stride).zip(list) {
        vertex[to.offset..to.offset + 3].copy_from_slice(&between.one(i as usize).to_array());
    }
}

/// Writes whole vertices of a sheet: those of the rows from `first_row` on, as many as there are. The tangent of a vertex points from its
/// left to its right neighbour, orthogonal to its normal.
///
/// # Panics
/// When there are more vertices than vectors.
pub fn interleave_sheet(
    level: Level,
    [positions, normals]: [Between; 2],
    first_row: usize,
    to: SheetVertices,
) {
    with_scratch(3 * to.columns, |row| {
        dispatch!(level, simd => interleave_sheet_with(simd, [positions, normals], first_row, to, row));
    });
}

/// Numbers of a vertex as it is most often: position, normal, UVs and tangent start at these places.
const USUAL: usize = 12;
const USUAL_PLACES: [usize; 3] = [0, 3, 8];

#[inline(always)]
fn interleave_sheet_with<S: Simd>(
    simd: S,
    [positions, normals]: [Between; 2],
    first_row: usize,
    to: SheetVertices,
    row_scratch: &mut [f32],
) {
    let SheetVertices {
        words,
        stride,
        columns,
        places,
        handedness,
    } = to;
    let usual = stride == USUAL && places == USUAL_PLACES;
    for (row, vertices) in words.chunks_exact_mut(columns * stride).enumerate() {
        let start = (first_row + row) * columns;
        // The ends of the row one by one.
        for column in [0, columns - 1] {
            let [left, right] = [column.saturating_sub(1), (column + 1).min(columns - 1)];
            let along = positions.one(start + right) - positions.one(start + left);
            let normal = normals.one(start + column);
            let vertex = &mut vertices[column * stride..(column + 1) * stride];
            set(vertex, places[0], positions.one(start + column));
            set(vertex, places[1], normal);
            set(vertex, places[2], across(along, normal));
            vertex[places[2] + 3] = handedness;
        }
        if columns < 3 {
            continue;
        }
        // Each place is needed three times.
        each_window(
            simd,
            0..columns,
            #[inline(always)]
            |window| {
                let place = positions.side_by_side(simd, window, start);
                let lanes = S::f32s::LEN.min(columns - window.at);
                for (axis, values) in [place.x, place.y, place.z].into_iter().enumerate() {
                    let to = &mut row_scratch[axis * columns + window.at..][..lanes];
                    to.copy_from_slice(&values.as_slice()[..lanes]);
                }
            },
        );
        let row = &*row_scratch;
        let inner = &mut vertices[stride..(columns - 1) * stride];
        each_window(
            simd,
            0..columns - 2,
            #[inline(always)]
            |window| {
                let left = row_at(simd, row, columns, window, 0);
                let place = row_at(simd, row, columns, window, 1);
                let right = row_at(simd, row, columns, window, 2);
                let normal = normals.side_by_side(simd, window, start + 1);
                let along = right - left;
                let along = along - Factor(normal.dot(along)) * normal;
                let inverse = one_over_length(simd, along);
                let tangent = Factor(inverse) * along;
                let lanes = S::f32s::LEN.min(columns - 2 - window.at);
                let vertices = &mut inner[window.at * stride..][..lanes * stride];
                let all_turn = inverse.simd_gt(S::f32s::splat(simd, 0.0)).all_true();
                if usual && all_turn && lanes == S::f32s::LEN {
                    write_usual(simd, [place, normal, tangent], handedness, vertices);
                    return;
                }
                let vertices = vertices.chunks_exact_mut(stride);
                for (k, vertex) in vertices.enumerate() {
                    set(vertex, places[0], lane(place, k));
                    set(vertex, places[1], lane(normal, k));
                    let mut tangent = lane(tangent, k);
                    if tangent == Vec3::ZERO {
                        tangent = lane(normal, k).any_orthonormal_vector();
                    }
                    set(vertex, places[2], tangent);
                    vertex[places[2] + 3] = handedness;
                }
            },
        );
    }
}

/// Points of a row of three arrays, `by` further on.
#[inline(always)]
fn row_at<S: Simd>(simd: S, row: &[f32], columns: usize, window: Window, by: usize) -> V3<S> {
    V3 {
        x: Reading(&row[by..]).load_at(simd, window),
        y: Reading(&row[columns + by..]).load_at(simd, window),
        z: Reading(&row[2 * columns + by..]).load_at(simd, window),
    }
}

/// Writes as many vertices as a vector has lanes, by four numbers at a time: number by number, storing takes longer than computing.
#[inline(always)]
fn write_usual<S: Simd>(
    simd: S,
    [place, normal, tangent]: [V3<S>; 3],
    handedness: f32,
    words: &mut [f32],
) {
    let handedness = f32x4::splat(simd, handedness);
    let vertices = words.as_chunks_mut::<USUAL>().0;
    for (quarter, vertices) in vertices.as_chunks_mut::<4>().0.iter_mut().enumerate() {
        let first = transposed([
            four(simd, place.x, quarter),
            four(simd, place.y, quarter),
            four(simd, place.z, quarter),
            four(simd, normal.x, quarter),
        ]);
        let last = transposed([
            four(simd, tangent.x, quarter),
            four(simd, tangent.y, quarter),
            four(simd, tangent.z, quarter),
            handedness,
        ]);
        for (k, vertex) in vertices.iter_mut().enumerate() {
            first[k].store_slice(&mut vertex[..4]);
            vertex[4] = normal.y.as_slice()[4 * quarter + k];
            vertex[5] = normal.z.as_slice()[4 * quarter + k];
            last[k].store_slice(&mut vertex[8..]);
        }
    }
}

#[inline(always)]
fn four<S: Simd>(simd: S, values: S::f32s, quarter: usize) -> f32x4<S> {
    f32x4::from_slice(simd, &values.as_slice()[4 * quarter..][..4])
}

#[inline(always)]
fn transposed<S: Simd>([a, b, c, d]: [f32x4<S>; 4]) -> [f32x4<S>; 4] {
    let [ac, bd] = [[a.zip_low(c), a.zip_high(c)], [b.zip_low(d), b.zip_high(d)]];
    [
        ac[0].zip_low(bd[0]),
        ac[0].zip_high(bd[0]),
        ac[1].zip_low(bd[1]),
        ac[1].zip_high(bd[1]),
    ]
}

/// 1/|v|; 0 where that is not finite.
#[inline(always)]
fn one_over_length<S: Simd>(simd: S, v: V3<S>) -> S::f32s {
    let one = S::f32s::splat(simd, 1.0);
    let zero = S::f32s::splat(simd, 0.0);
    let inverse = one / v.dot(v).sqrt();
    let finite = inverse.simd_gt(zero) & inverse.simd_lt(one / zero);
    finite.select(inverse, zero)
}

/// The direction of a vector across a unit normal.
pub(super) fn across(v: Vec3, normal: Vec3) -> Vec3 {
    let v = (v - normal * normal.dot(v)).normalize_or_zero();
    if v == Vec3::ZERO {
        normal.any_orthonormal_vector()
    } else {
        v
    }
}

#[inline(always)]
fn set(vertex: &mut [f32], place: usize, v: Vec3) {
    let place = &mut vertex[place..place + 3];
    place[0] = v.x;
    place[1] = v.y;
    place[2] = v.z;
}

#[inline(always)]
fn lane<S: Simd>(v: V3<S>, k: usize) -> Vec3 {
    Vec3::new(v.x.as_slice()[k], v.y.as_slice()[k], v.z.as_slice()[k])
}

#[inline(always)]
fn interleave_with<S: Simd>(simd: S, between: Between, first: usize, to: Interleaved) {
    let Interleaved {
        words,
        stride,
        offset,
    } = to;
    let count = words.len() / stride;
    each_window(
        simd,
        0..count,
        #[inline(always)]
        |window| {
            let v = between.side_by_side(simd, window, first);
            let lanes = S::f32s::LEN.min(count - window.at);
            let vertices = words[window.at * stride..].chunks_exact_mut(stride);
            for (k, vertex) in vertices.take(lanes).enumerate() {
                set(vertex, offset, lane(v, k));
            }
        },
    );
}
