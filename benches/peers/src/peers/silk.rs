//! The cloth of `bevy_silk`.
//!
//! Its sticks are the structural edges, 2 N². What is timed is what its plugin does to the cloth in a frame, without the
//! mesh.

use bevy::{math::Mat4, math::Vec3, platform::collections::HashMap, prelude::GlobalTransform};
use bevy_silk::{components::cloth::Cloth, prelude::*};

use super::Peer;
use crate::scene::{self, Sheet};

/// A sheet of points and sticks.
pub struct Silk {
    passes: u8,
    friction: f32,
    fall: Vec3,
    cloth: Cloth,
}

impl Silk {
    /// The sheet at rest, whose sticks are gone over so many times in a step.
    pub fn new(sheet: Sheet, passes: u8) -> Self {
        let positions: Vec<_> = sheet.positions().map(Vec3::from_array).collect();
        let anchors: HashMap<_, _> = sheet
            .pins()
            .map(|i| (i, VertexAnchor::default()))
            .into_iter()
            .collect();
        let cloth = Cloth::new(
            &positions,
            &triangles(sheet),
            anchors,
            StickGeneration::Quads,
            StickLen::Auto,
            StickMode::Fixed,
            &Mat4::IDENTITY,
        );
        Self {
            passes,
            friction: (-scene::DAMPING * scene::STEP).exp(),
            fall: Vec3::NEG_Y * (scene::GRAVITY * scene::STEP * scene::STEP),
            cloth,
        }
    }
}

impl Peer for Silk {
    fn step(&mut self) {
        self.cloth.update_points(self.friction, self.fall);
        self.cloth
            .update_anchored_points(&GlobalTransform::IDENTITY, |_| None);
        self.cloth.update_sticks(self.passes);
    }

    fn positions(&self, into: &mut Vec<[f32; 3]>) {
        into.extend(
            self.cloth
                .current_point_positions
                .iter()
                .map(Vec3::to_array),
        );
    }
}

/// Two triangles for each square. Sticks come from the first two sides of each: the square's own.
fn triangles(sheet: Sheet) -> Vec<u32> {
    let n = sheet.size;
    sheet
        .pairs([1, 1])
        .flat_map(|[a, d]| [a + 1, a, a + n, a + n, d, a + 1])
        .map(|i| i as u32)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sticks_are_the_structural_edges() {
        let sheet = Sheet { size: 5 };
        let silk = Silk::new(sheet, 1);
        let mut sticks: Vec<_> = silk
            .cloth
            .stick_lengths
            .keys()
            .map(|[a, b]| [*a.min(b), *a.max(b)])
            .collect();
        let mut edges: Vec<_> = sheet.edges().collect();
        sticks.sort_unstable();
        edges.sort_unstable();
        assert_eq!(sticks, edges);
    }
}
