//! Trial that tells a demand from a load.

use super::LEAST;

/// Part of the grant that is taken back to see whether a load pulls [-].
const PROBE: f32 = 0.15;

/// Part of the first grant below which a load pulls [-].
const HARDLY: f32 = 0.25;

/// Relative change of its strain by which a demand becomes another [-].
const CHANGED: f32 = 0.05;

/// Trial of the stretch of a mesh. A demand is there whatever is granted; a load (a weight, a spring) stretches the mesh the farther the
/// more it is granted. The two are told apart by taking back a part of the grant.
#[derive(Clone, Copy, Debug, Default)]
pub(super) enum Trial {
    /// The demand changes.
    #[default]
    None,
    /// Nothing more is granted, and the grant is taken back.
    TakesBack {
        /// Mean grant at first [-].
        first: f32,
        /// Mean grant after the last part was taken back [-].
        granted: f32,
        /// Mean strain at that time [-].
        strain: f32,
        /// `part` of [`Self::Demand`].
        part: f32,
    },
    /// A demand: more may be granted.
    Demand {
        /// The mean strain [-].
        strain: f32,
        /// Relative change of the strain by which the demand becomes another [-].
        part: f32,
    },
    /// A load: nothing is granted.
    Load,
}

impl Trial {
    /// Returns whether more may be granted, from the mean grant and the mean strain [-].
    pub fn grows(&mut self, stands: bool, [granted, strain]: [f32; 2]) -> bool {
        let takes_back = |first, part| Self::TakesBack {
            first,
            granted,
            strain,
            part,
        };
        let (next, grows) = match *self {
            _ if !stands => (Self::None, true),
            Self::None => (takes_back(granted, CHANGED), false),
            Self::TakesBack {
                granted: before, ..
            } if granted > (1.0 - PROBE) * before => (*self, false),
            Self::TakesBack { first, .. } if granted < HARDLY * first => (Self::Load, false),
            // The strain follows the part that is taken back.
            Self::TakesBack {
                first,
                granted: g,
                strain: e,
                part,
            } if e - strain > 0.5 * (g - granted) => (takes_back(first, part), false),
            Self::TakesBack { part, .. } => (Self::Demand { strain, part }, true),
            // A demand is not kept for ever.
            Self::Demand { strain: e, part } if (strain - e).abs() > (part * e).max(LEAST) => {
                (takes_back(granted, 2.0 * part), false)
            }
            Self::Demand { .. } => (*self, true),
            Self::Load => (Self::Load, false),
        };
        *self = next;
        grows
    }
}
