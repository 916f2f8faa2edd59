//! Whether what stretches a mesh is a demand or a load.

use super::LEAST;

/// The part of what is granted that is taken back to see whether a load pulls [-].
const PROBE: f32 = 0.15;

/// Where less than this part is left of what was granted, a load pulls [-].
const HARDLY: f32 = 0.25;

/// A demand whose strain changes by more than this part is another [-].
const CHANGED: f32 = 0.05;

/// Whether what stretches the mesh is a demand, that is there whatever is granted, or a load, which stretches it the farther the more it
/// is granted: a weight, a spring. That is found out by taking back a part of what was granted.
#[derive(Clone, Copy, Debug, Default)]
pub(super) enum Trial {
    /// What is asked for changes.
    #[default]
    None,
    /// Nothing more is granted, and what was is taken back.
    TakesBack {
        /// What was granted in the mean at first [-].
        first: f32,
        /// And after the last part was taken back.
        granted: f32,
        /// The mean strain then [-].
        strain: f32,
        /// That of [`Self::Demand`].
        part: f32,
    },
    /// It is a demand.
    Demand {
        /// The mean strain [-].
        strain: f32,
        /// It is another one if that changes by more than this part of it [-].
        part: f32,
    },
    /// It is a load: nothing is granted.
    Load,
}

impl Trial {
    /// Whether more may be granted, where this is granted and so much is the strain in the mean [-].
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
            // It follows what is taken back.
            Self::TakesBack {
                first,
                granted: g,
                strain: e,
                part,
            } if e - strain > 0.5 * (g - granted) => (takes_back(first, part), false),
            Self::TakesBack { part, .. } => (Self::Demand { strain, part }, true),
            // Not for ever.
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
