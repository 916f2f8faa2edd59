//! Particles and normals between the last two steps, as interleaved vertices.

use bevy_math::Vec3;
use fearless_simd::Level;
use tailorbird_cloth::{normals::ClothNormals, particles::ClothParticles};

use super::interleave::{
    Between, Interleaved, Last, SheetVertices, interleave, interleave_listed, interleave_sheet,
};
use crate::drawn::ClothDrawnHolds;

/// Particle, or normal, that each vertex follows; in storage order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum VertexOrder<'a> {
    /// The first vertex follows this one, the second the next, and so on.
    From(usize),
    /// These.
    Listed(&'a [u32]),
}

/// Writes where particles are drawn between the last two steps: `fraction` 0 is the one before, 1 the last one. Each coordinate is
/// multiplied by its factor.
///
/// # Panics
/// When there is no such particle, or an attribute does not fit in a vertex.
pub(super) fn write_positions(
    particles: &ClothParticles,
    fraction: f32,
    drawn: &ClothDrawnHolds,
    factors: Vec3,
    order: VertexOrder,
    to: Interleaved,
) {
    let between = Between {
        ends: [particles.previous_points(), particles.points()],
        fraction,
        offsets: drawn.offsets(),
        last: Last::Scale(factors),
    };
    write(between, order, to);
}

/// Writes unit normals between the last two steps: `fraction` 0 is the one before, 1 the last one.
///
/// # Panics
/// When there is no such normal, or an attribute does not fit in a vertex.
pub(super) fn write_normals(
    normals: &ClothNormals,
    fraction: f32,
    order: VertexOrder,
    to: Interleaved,
) {
    let between = Between {
        ends: normals.ends(),
        fraction,
        offsets: None,
        last: Last::Unit,
    };
    write(between, order, to);
}

/// Writes positions, normals and tangents of the rows of a grid from `first_row` on, as many as there is room for, between the last two
/// steps: `fraction` 0 is the one before, 1 the last one. Each coordinate of a position is multiplied by its factor. A tangent points
/// along the row.
///
/// # Panics
/// When there are not as many particles and smooth normals, or an attribute does not fit in a vertex.
pub(super) fn write_sheet(
    particles: &ClothParticles,
    normals: &ClothNormals,
    fraction: f32,
    drawn: &ClothDrawnHolds,
    factors: Vec3,
    first_row: usize,
    to: SheetVertices,
) {
    let [position, normal, tangent] = to.places;
    let fits = position.max(normal) + 3 <= to.stride && tangent + 4 <= to.stride;
    assert!(fits && to.columns > 1, "attributes within a vertex");
    let positions = Between {
        ends: [particles.previous_points(), particles.points()],
        fraction,
        offsets: drawn.offsets(),
        last: Last::Scale(factors),
    };
    let normals = Between {
        ends: normals.ends(),
        offsets: None,
        last: Last::Unit,
        ..positions
    };
    interleave_sheet(Level::new(), [positions, normals], first_row, to);
}

fn write(between: Between, order: VertexOrder, to: Interleaved) {
    assert!(to.offset + 3 <= to.stride, "an attribute within a vertex");
    match order {
        VertexOrder::From(first) => interleave(Level::new(), between, first, to),
        VertexOrder::Listed(list) => interleave_listed(between, list, to),
    }
}
