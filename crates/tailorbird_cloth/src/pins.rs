//! Particles that are held in the cloth's frame.
//!
#![doc = include_str!("pins.md")]

mod apply;

use bevy_ecs::prelude::*;
use bevy_math::{UVec2, Vec3};
use bevy_reflect::prelude::*;
use tailorbird_solver::topology::{Topology, order::Given};

pub use apply::apply_pins;

use crate::{error::ClothErrorKind, weights::ClothWeights};

/// The particles that are held: they move with the entity and with nothing else. Change it at any time.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(default, deny_unknown_fields))]
pub struct ClothPins {
    /// The pins. Where two name the same particle, the later one counts.
    pub pins: Vec<ClothPin>,
}

/// One pin, of one particle or several.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(deny_unknown_fields))]
pub struct ClothPin {
    /// Particles that the pin holds.
    pub selection: ClothSelection,
    /// Place of the pin, in the cloth's frame \[m\]; `None` is where the particles are at the time (at rest, for a new cloth). The
    /// particles move there within one step, evenly over the substeps.
    #[cfg_attr(feature = "serialize", serde(default))]
    pub target: Option<Vec3>,
    /// Author of the pin.
    #[cfg_attr(feature = "serialize", serde(default))]
    pub author: ClothPinAuthor,
}

/// Particles that a pin holds.
#[derive(Clone, Debug, PartialEq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[cfg_attr(feature = "serialize", serde(deny_unknown_fields))]
#[non_exhaustive]
pub enum ClothSelection {
    /// The particle with this index.
    Particle(u32),
    /// The particles with these indices.
    Particles(Vec<u32>),
    /// The particle at this column and row of a grid.
    Cell(UVec2),
    /// A corner of a grid.
    Corner(ClothCorner),
    /// An edge of a grid: from left to right, or from top to bottom.
    Edge(ClothEdge),
    /// Every particle that lies within a ball at rest.
    Within {
        /// Its centre, in the cloth's frame \[m\].
        center: Vec3,
        /// Its radius \[m\].
        radius: f32,
    },
}

/// A corner of a grid, seen from the front.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub enum ClothCorner {
    /// Row 0, column 0.
    TopLeft,
    /// Row 0, last column.
    TopRight,
    /// Last row, column 0.
    BottomLeft,
    /// Last row, last column.
    BottomRight,
}

impl ClothCorner {
    /// All four corners.
    pub const ALL: [Self; 4] = [
        Self::TopLeft,
        Self::TopRight,
        Self::BottomLeft,
        Self::BottomRight,
    ];
    /// The upper two.
    pub const TOP: [Self; 2] = [Self::TopLeft, Self::TopRight];
}

/// An edge of a grid, seen from the front.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub enum ClothEdge {
    /// Row 0.
    Top,
    /// The last row.
    Bottom,
    /// Column 0.
    Left,
    /// The last column.
    Right,
}

/// Author of a pin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub enum ClothPinAuthor {
    /// The game.
    #[default]
    Scene,
    /// The player, while dragging; see [`ClothPins::release_user_pins`].
    User,
}

impl ClothPin {
    /// Holds particles where they are.
    pub fn new(selection: ClothSelection) -> Self {
        Self {
            selection,
            target: None,
            author: ClothPinAuthor::Scene,
        }
    }

    /// Holds one particle at a point of the cloth's frame \[m\].
    pub fn at(particle: u32, target: Vec3) -> Self {
        Self {
            target: Some(target),
            ..Self::new(ClothSelection::Particle(particle))
        }
    }
}

impl ClothPin {
    /// Returns whether it selects particles by their positions, so that it means something on another shape as well.
    pub fn is_by_place(&self) -> bool {
        !matches!(
            self.selection,
            ClothSelection::Particle(_) | ClothSelection::Particles(_) | ClothSelection::Cell(_)
        )
    }
}

impl ClothPins {
    fn of(selections: impl IntoIterator<Item = ClothSelection>) -> Self {
        Self {
            pins: selections.into_iter().map(ClothPin::new).collect(),
        }
    }

    /// Corners of a grid.
    pub fn corners(corners: impl IntoIterator<Item = ClothCorner>) -> Self {
        Self::of(corners.into_iter().map(ClothSelection::Corner))
    }

    /// Edges of a grid.
    pub fn edges(edges: impl IntoIterator<Item = ClothEdge>) -> Self {
        Self::of(edges.into_iter().map(ClothSelection::Edge))
    }

    /// Particles by index.
    pub fn particles(particles: impl IntoIterator<Item = u32>) -> Self {
        Self::of(particles.into_iter().map(ClothSelection::Particle))
    }

    /// Every particle that lies within a ball (in the cloth's frame \[m\]) at rest.
    pub fn within(center: Vec3, radius: f32) -> Self {
        Self::of([ClothSelection::Within { center, radius }])
    }

    /// Every particle whose painted weight is above `threshold`.
    pub fn painted(weights: &ClothWeights, threshold: f32) -> Self {
        Self::of([ClothSelection::Particles(
            weights.above(threshold).collect(),
        )])
    }

    /// Adds a pin.
    pub fn with(mut self, pin: ClothPin) -> Self {
        self.pins.push(pin);
        self
    }

    /// Returns whether the player made any of the pins.
    pub fn has_user_pins(&self) -> bool {
        self.pins
            .iter()
            .any(|pin| pin.author == ClothPinAuthor::User)
    }

    /// Removes the pins that the player made, and tells how many there were.
    pub fn release_user_pins(&mut self) -> usize {
        let before = self.pins.len();
        self.pins.retain(|pin| pin.author != ClothPinAuthor::User);
        before - self.pins.len()
    }
}

impl ClothSelection {
    /// The particles that are selected.
    ///
    /// # Errors
    /// [`ClothErrorKind::ParticleOutOfRange`]; [`ClothErrorKind::NotAGrid`]; a ball whose radius is negative or not
    /// finite.
    pub fn particles(&self, topology: &Topology) -> Result<Vec<u32>, ClothErrorKind> {
        self.select("ClothPins", topology)
    }

    /// The particles that are selected in a component of this name.
    pub(crate) fn select(
        &self,
        field: &str,
        topology: &Topology,
    ) -> Result<Vec<u32>, ClothErrorKind> {
        let particles = topology.particles();
        let grid = || {
            topology.grid().ok_or_else(|| ClothErrorKind::NotAGrid {
                field: field.into(),
                value: format!("{self:?}"),
            })
        };
        let in_range = |value: u32| {
            if (value as usize) < particles {
                Ok(value)
            } else {
                Err(ClothErrorKind::ParticleOutOfRange {
                    field: field.into(),
                    value,
                    particles,
                })
            }
        };
        Ok(match *self {
            Self::Particle(particle) => vec![in_range(particle)?],
            Self::Particles(ref particles) => particles
                .iter()
                .map(|&particle| in_range(particle))
                .collect::<Result<_, _>>()?,
            Self::Cell(at) => {
                let size = grid()?;
                // A column beyond the last must not wrap into the next row.
                let inside = at.x < size.x && at.y < size.y;
                let particle = at.y.saturating_mul(size.x).saturating_add(at.x);
                vec![in_range(if inside {
                    particle
                } else {
                    particle.max(particles as u32)
                })?]
            }
            Self::Corner(corner) => {
                let last = grid()? - 1;
                let at = match corner {
                    ClothCorner::TopLeft => UVec2::ZERO,
                    ClothCorner::TopRight => UVec2::new(last.x, 0),
                    ClothCorner::BottomLeft => UVec2::new(0, last.y),
                    ClothCorner::BottomRight => last,
                };
                vec![at.y * (last.x + 1) + at.x]
            }
            Self::Edge(edge) => {
                let UVec2 {
                    x: columns,
                    y: rows,
                } = grid()?;
                match edge {
                    ClothEdge::Top => (0..columns).collect(),
                    ClothEdge::Bottom => (0..columns).map(|c| (rows - 1) * columns + c).collect(),
                    ClothEdge::Left => (0..rows).map(|r| r * columns).collect(),
                    ClothEdge::Right => (0..rows).map(|r| r * columns + columns - 1).collect(),
                }
            }
            Self::Within { center, radius } => {
                let checks = [
                    ClothErrorKind::vector(&format!("{field}.center"), center),
                    ClothErrorKind::number(
                        &format!("{field}.radius"),
                        radius,
                        |r| r >= 0.0 && r.is_finite(),
                        "at least 0 and finite [m]",
                    ),
                ];
                if let Some(error) = checks.into_iter().flatten().next() {
                    return Err(error);
                }
                let inside = |p: &Vec3| p.distance_squared(center) <= radius * radius;
                let place = |i| topology.rest_positions[topology.order.stored(Given(i)).index()];
                (0..particles as u32)
                    .filter(|&i| inside(&place(i)))
                    .collect()
            }
        })
    }
}
