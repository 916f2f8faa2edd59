//! Particles beyond those of the rest shape.

use super::Topology;
use crate::fingerprint;

/// A particle that is split off another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParticleCopy {
    /// The particle that it is split off, in storage order.
    pub of: u32,
    /// The part of its area, and so of its mass, that it takes, 0 to 1 [-].
    pub part: f32,
}

impl Topology {
    /// The topology with more particles, which follow all others. They lie where those do that they are copies of, and nothing joins them
    /// to any.
    ///
    /// # Panics
    /// When one is a copy of a particle that does not exist.
    #[must_use]
    pub fn with_copies(&self, copies: &[ParticleCopy]) -> Self {
        let mut topology = self.clone();
        topology.areas = self.areas().collect();
        for copy in copies {
            let of = copy.of as usize;
            let area = copy.part * topology.areas[of];
            topology.areas[of] -= area;
            topology.areas.push(area);
            topology.rest_positions.push(self.rest_positions[of]);
            topology.origins.push(self.origin(copy.of));
        }
        let numbers = copies
            .iter()
            .flat_map(|copy| [copy.of, copy.part.to_bits()]);
        topology.revision ^= fingerprint::of(numbers);
        topology
    }

    /// The particle of the rest shape that a particle is, or was split off.
    pub fn origin(&self, particle: u32) -> u32 {
        let own = self.particles() - self.origins.len();
        let copy = (particle as usize).checked_sub(own);
        copy.map_or(particle, |copy| self.origins[copy])
    }

    /// The number of particles that the rest shape has.
    pub fn original_particles(&self) -> usize {
        self.particles() - self.origins.len()
    }
}

#[cfg(test)]
mod tests {
    use bevy_math::{UVec2, Vec2, Vec3};

    use super::*;
    use crate::{
        shape::ClothShape,
        topology::{
            alive::{AliveEdges, Family},
            layout::Layout,
            order::Stored,
        },
    };

    fn grid() -> Topology {
        let shape = ClothShape::Grid {
            size: Vec2::new(3.0, 2.0),
            resolution: UVec2::new(4, 3),
            origin: Vec2::ZERO,
        };
        Topology::build(&shape, Vec3::ONE).expect("a grid")
    }

    #[test]
    fn copies_share_the_area_and_hang_on_nothing() {
        let grid = grid();
        let torn = grid.with_copies(&[
            ParticleCopy { of: 5, part: 0.25 },
            ParticleCopy { of: 5, part: 0.5 },
        ]);
        let torn = torn.with_copies(&[ParticleCopy { of: 12, part: 1.0 }]);
        assert_eq!((torn.particles(), torn.original_particles()), (15, 12));
        assert_eq!([3, 12, 13, 14].map(|i| torn.origin(i)), [3, 5, 5, 5]);
        let sum = |topology: &Topology| topology.areas().sum::<f32>();
        assert!((sum(&grid) - sum(&torn)).abs() < 1e-5);
        let areas: Vec<f32> = torn.areas().collect();
        let whole = grid.areas().nth(5).expect("there");
        assert_eq!(areas[12..], [0.0, 0.375 * whole, 0.25 * whole]);
        assert_ne!(torn.revision, grid.revision);
        assert_eq!(torn.pieces(), [[0; 12].as_slice(), &[12, 13, 14]].concat());
        assert_eq!(torn.stretch_edges().len(), grid.stretch_edges().len());
        assert!(torn.neighbors(Stored(12)).is_empty());
    }

    #[test]
    fn torn_edges_are_no_edges_of_a_sheet() {
        let mut grid = grid();
        let before = grid.stretch_edges().len();
        let Layout::Sheet(sheet) = &mut grid.layout else {
            panic!("a grid is a sheet");
        };
        let mut alive = AliveEdges::all(&sheet.lattice);
        assert!(alive.tear(Family::Row, 4) && !alive.tear(Family::Row, 4));
        assert!(
            alive.tear(Family::Column, 5)
                && alive.tear(Family::Rising, 6)
                && alive.tear(Family::Falling, 0)
        );
        sheet.alive = Some(alive);
        let edges = grid.stretch_edges();
        assert_eq!(edges.len(), before - 2);
        let has = |ends: [u32; 2]| edges.iter().any(|(edge, _)| *edge == ends);
        assert!(!has([4, 5]) && !has([5, 9]) && has([5, 6]) && has([1, 5]));
        let around = |i| {
            let mut around: Vec<u32> = grid.neighbors(Stored(i)).iter().map(|n| n.0).collect();
            around.sort_unstable();
            around
        };
        assert_eq!(around(5), [1, 2, 6, 8, 10]);
        assert!(!around(9).contains(&6) && around(6).contains(&5));
    }
}
