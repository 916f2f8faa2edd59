//! What a cloth gives way to that is asked for more than its fabric has; [`effort`] tells when.

use super::{
    chains::Pass,
    kernels::{
        lanes::SharedPoints,
        line::{LEAST_COMPLIANCE, Recovery},
    },
};
use crate::{
    effort::{self, Effort},
    points::Points,
    topology::fabric::Fabric,
};

/// No cloth counts as smaller than this \[m\].
const SMALLEST: f32 = 1e-3;

/// κ of what hangs, times this, is the strain that it may cost to give way [-].
const LOAD: f32 = 0.015;

/// [`Recovery::least`] of what comes back at once.
const ALL: f32 = 1e6;

impl Pass<'_> {
    /// How what is strained comes back to its length in a substep.
    pub(super) fn recovery<'b>(
        &self,
        effort: Effort,
        start: &'b mut Points,
    ) -> Option<Recovery<'b>> {
        effort.recovers.then(|| {
            let (least, compliance) = match &self.topology.fabric {
                // All of a line comes back at its speed.
                None => {
                    let size = self.size().max(SMALLEST);
                    (2.0 * effort::SPEED * self.seconds / size, LEAST_COMPLIANCE)
                }
                Some(fabric) => (ALL, self.give(fabric)),
            };
            Recovery {
                start: SharedPoints::new(start),
                least,
                part: (effort::RATE * self.seconds).min(1.0),
                compliance,
            }
        })
    }

    /// The compliance of the chains of a mesh that is strained, relative to what its particles resist with [-].
    ///
    /// They end anywhere, at springs that are relaxed and bear less than a chain can pull with: with all of it single edges are torn out
    /// where the mesh as a whole is stretched by little. Its own weight stretches it by no more than a part of what counts as strained.
    fn give(&self, fabric: &Fabric) -> f32 {
        let count = (fabric.particles() as f32).sqrt().max(1.0);
        let size = self.size().max(SMALLEST);
        let spacing = size / count;
        // κ = 4 h² T/(m L) of what hangs by its upper edge.
        let kappa = 4.0 * self.seconds * self.seconds * self.gravity.max(1.0) * size;
        let least = LOAD * spacing * spacing / kappa;
        least.clamp(LEAST_COMPLIANCE, 1.0)
    }
}
