//! Vertices at the same place become one particle.

use std::collections::HashMap;

use bevy_math::Vec3;

/// Vertices joined by position.
pub struct Welded {
    /// Position of each particle: that of its first vertex.
    pub positions: Vec<Vec3>,
    /// Particle of each vertex.
    pub particle_of_vertex: Vec<u32>,
}

/// Joins each vertex to the first earlier one that is no further than `distance` \[m\] away.
///
/// Vertices are sorted into cubes of that size and looked up in the 27 around them: linear time, and the same result every time.
pub fn weld(positions: &[Vec3], distance: f32) -> Welded {
    let size = f64::from(distance.max(f32::MIN_POSITIVE));
    let cell = |p: Vec3| p.as_dvec3().to_array().map(|v| (v / size).floor());
    let key = |cell: [f64; 3]| cell.map(f64::to_bits);

    let mut cells: HashMap<[u64; 3], Vec<u32>> = HashMap::with_capacity(positions.len());
    let mut welded = Welded {
        positions: Vec::new(),
        particle_of_vertex: Vec::with_capacity(positions.len()),
    };
    for &p in positions {
        let center = cell(p);
        let mut found: Option<u32> = None;
        for offset in 0..27 {
            let neighbor = [offset % 3, offset / 3 % 3, offset / 9]
                .map(|o| f64::from(o) - 1.0)
                .into_iter()
                .zip(center)
                // Adding 0 turns −0 into 0, which has other bits.
                .map(|(o, c)| o + c + 0.0);
            let mut at = [0.0; 3];
            at.iter_mut().zip(neighbor).for_each(|(a, n)| *a = n);
            for &candidate in cells.get(&key(at)).map_or(&[][..], Vec::as_slice) {
                let near = welded.positions[candidate as usize].distance(p) <= distance;
                if near && found.is_none_or(|f| candidate < f) {
                    found = Some(candidate);
                }
            }
        }
        let particle = found.unwrap_or_else(|| {
            let new = welded.positions.len() as u32;
            welded.positions.push(p);
            cells
                .entry(key(center.map(|c| c + 0.0)))
                .or_default()
                .push(new);
            new
        });
        welded.particle_of_vertex.push(particle);
    }
    welded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_of_a_seam_become_one_particle() {
        let seam = [
            Vec3::ZERO,
            Vec3::X,
            Vec3::new(1.0, 4e-6, -4e-6),
            Vec3::new(-0.0, 0.0, -0.0),
            Vec3::Y,
        ];
        let welded = weld(&seam, 1e-5);
        assert_eq!(welded.particle_of_vertex, [0, 1, 1, 0, 2]);
        assert_eq!(welded.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    }

    #[test]
    fn vertices_in_neighboring_cells_are_found_and_distant_ones_left() {
        let d = 0.01;
        let pair = [Vec3::new(0.0099, 0.0, 0.0), Vec3::new(0.0101, 0.0, 0.0)];
        assert_eq!(weld(&pair, d).positions.len(), 1);
        let apart = [Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.0101, 0.0, 0.0)];
        assert_eq!(weld(&apart, d).positions.len(), 2);
    }

    #[test]
    fn far_from_the_origin_nothing_overflows() {
        let far = [Vec3::splat(1e30), Vec3::splat(-1e30), Vec3::splat(1e30)];
        assert_eq!(weld(&far, 1e-5).particle_of_vertex, [0, 1, 0]);
    }
}
