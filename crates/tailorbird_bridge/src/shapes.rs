//! Shapes of an engine as shapes of this project, each converted once.

use std::collections::HashMap;

use bevy_math::Isometry3d;
use tailorbird_cloth::collider::ClothColliderShape;

/// Steps without a use after which a conversion is forgotten.
const FORGET_AFTER: u64 = 128;

/// A part of an engine's shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Pose in the whole \[m\].
    pub at: Isometry3d,
    /// Shape of the part.
    pub shape: ClothColliderShape,
    /// Distance by which its surface is rounded off beyond the shape \[m\].
    pub margin: f32,
}

impl Piece {
    /// A shape at a place.
    pub fn new(at: Isometry3d, shape: ClothColliderShape) -> Self {
        Self {
            at,
            shape,
            margin: 0.0,
        }
    }
}

/// Conversions of shapes that an engine shares by reference counts, by their address. It keeps a clone of each, so that no
/// other shape gets that address.
#[derive(Debug)]
pub struct ShapeCache<S> {
    known: HashMap<usize, Known<S>>,
    step: u64,
}

#[derive(Debug)]
struct Known<S> {
    _shape: S,
    pieces: Vec<Piece>,
    used: u64,
}

impl<S> Default for ShapeCache<S> {
    fn default() -> Self {
        Self {
            known: HashMap::new(),
            step: 0,
        }
    }
}

impl<S: Clone> ShapeCache<S> {
    /// Begins a step: forgets what has not been used for long.
    pub fn begin_step(&mut self) {
        self.step += 1;
        let step = self.step;
        if step.is_multiple_of(FORGET_AFTER) {
            self.known
                .retain(|_, known| known.used + FORGET_AFTER > step);
        }
    }

    /// The pieces of a shape: as they are known, or converted.
    pub fn pieces(
        &mut self,
        address: usize,
        shape: &S,
        convert: impl FnOnce() -> Vec<Piece>,
    ) -> &[Piece] {
        let known = self.known.entry(address).or_insert_with(|| Known {
            _shape: shape.clone(),
            pieces: convert(),
            used: 0,
        });
        known.used = self.step;
        &known.pieces
    }

    /// The number of known shapes.
    pub fn len(&self) -> usize {
        self.known.len()
    }

    /// Returns whether no part is known.
    pub fn is_empty(&self) -> bool {
        self.known.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn a_shape_is_converted_once_and_forgotten_when_nobody_uses_it() {
        let mut cache = ShapeCache::default();
        let shape = Arc::new(1.0_f32);
        let mut count = 0;
        for _ in 0..2 * FORGET_AFTER {
            cache.begin_step();
            let pieces = cache.pieces(Arc::as_ptr(&shape) as usize, &shape, || {
                count += 1;
                let shape = ClothColliderShape::Sphere { radius: *shape };
                vec![Piece::new(Isometry3d::IDENTITY, shape)]
            });
            assert_eq!(pieces.len(), 1);
        }
        assert_eq!(count, 1);
        assert_eq!(Arc::strong_count(&shape), 2);
        for _ in 0..2 * FORGET_AFTER {
            cache.begin_step();
        }
        assert!(cache.is_empty());
        assert_eq!(Arc::strong_count(&shape), 1);
    }
}
