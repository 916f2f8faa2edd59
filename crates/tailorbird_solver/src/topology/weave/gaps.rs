//! Edges that join threads which would end inside an irregular mesh.

use bevy_math::Vec3;

use super::{super::groups::Groups, EdgeFamily, Leaning, Weave};

/// Cosine of four times the largest angle to a thread at which an edge can stand in for it: 40°.
const NEAR: f32 = -0.94;

/// Cosine of the angle between two edges at a particle above which they leave it in the same direction.
const SAME_DIRECTION: f32 = 0.25;

/// Makes askew edges follow a thread where, at both ends, no other edge that follows it leaves in the same direction: the edge that lies
/// best first. Else a thread would end there, and its tension would be borne by shear alone.
pub(super) fn close(weave: &mut Weave, leanings: &[Leaning], rest_positions: &[Vec3]) {
    let mut gaps: Vec<usize> = (0..leanings.len())
        .filter(|e| weave.family[*e] == EdgeFamily::Shear && leanings[*e].alignment > NEAR)
        .collect();
    if gaps.is_empty() {
        return;
    }
    // Rounded, so that among equals the order of the mesh decides.
    gaps.sort_by_key(|e| (-1e3 * leanings[*e].alignment) as i32);

    let ends = weave.ends.iter().enumerate();
    let ends = ends.flat_map(|(e, ends)| ends.map(|i| (i, e)));
    let edges = Groups::new(rest_positions.len(), ends);
    let along = |weave: &Weave, edge: usize, from: u32| {
        let [a, b] = weave.ends[edge].map(|i| rest_positions[i as usize]);
        let along = (b - a).normalize_or_zero();
        if weave.ends[edge][0] == from {
            along
        } else {
            -along
        }
    };
    for gap in gaps {
        let family = leanings[gap].family;
        let ends_at = |i: u32| {
            let direction = along(weave, gap, i);
            let edges = edges.of(i).iter();
            edges
                .filter(|e| weave.family[**e] == family)
                .all(|e| along(weave, *e, i).dot(direction) < SAME_DIRECTION)
        };
        let [a, b] = weave.ends[gap];
        if ends_at(a) && ends_at(b) {
            weave.family[gap] = family;
        }
    }
}
