//! Heights over a rectangle: terrain.

use std::sync::Arc;

use bevy_math::{UVec2, Vec2};
use bevy_reflect::prelude::*;
use tailorbird_solver::contact::solid::Field;

use crate::error::ClothErrorKind;

/// Heights above the x-z plane, in a grid around the origin. All below the surface is solid, as deep as it may be. A clone
/// shares them.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[reflect(opaque, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct HeightField {
    /// Field in the form of the solver.
    pub(super) field: Field,
}

impl HeightField {
    /// `heights[row · columns + column]` \[m\]: columns lie along +x, rows along +z. `size` is the rectangle between the
    /// first and the last of them \[m\].
    ///
    /// # Errors
    /// [`ClothErrorKind::HeightField`], [`ClothErrorKind::Value`].
    pub fn new(
        heights: impl Into<Arc<[f32]>>,
        columns: u32,
        size: Vec2,
    ) -> Result<Self, ClothErrorKind> {
        let heights = heights.into();
        let rows = heights.len() as u32 / columns.max(1);
        if columns < 2 || rows < 2 || rows as usize * columns as usize != heights.len() {
            return Err(ClothErrorKind::HeightField {
                heights: heights.len(),
                columns,
            });
        }
        let finite =
            |h: f32| ClothErrorKind::number("HeightField height", h, h.is_finite(), "finite [m]");
        let positive = |side| ClothErrorKind::positive("HeightField size", side, "m");
        let mut sides = size.to_array().into_iter();
        let wrong = heights.iter().find_map(|h| finite(*h));
        if let Some(error) = wrong.or_else(|| sides.find_map(positive)) {
            return Err(error);
        }
        let resolution = UVec2::new(columns, rows);
        Ok(Self {
            field: Field::new(heights, resolution, size),
        })
    }

    /// The heights \[m\], row by row.
    pub fn heights(&self) -> &[f32] {
        &self.field.heights
    }

    /// Columns (along x) and rows (along z).
    pub fn resolution(&self) -> UVec2 {
        self.field.resolution
    }

    /// The rectangle along x and z \[m\].
    pub fn size(&self) -> Vec2 {
        self.field.size
    }
}
