//! What a cloth gives way to that is asked for more than its fabric has; [`effort`] tells when.

use super::{
    chains::Pass,
    kernels::{
        lanes::SharedPoints,
        line::{Give, LARGEST_KAPPA},
        recovery::Recovery,
    },
};
use crate::{effort::Effort, topology::fabric::Fabric};

/// No cloth counts as smaller than this \[m\].
const SMALLEST: f32 = 1e-3;

/// How fast what is farther from a pin than it reaches comes back while the cloth is strained, at least [m/s].
const TETHER_SPEED: f32 = 0.05;

/// And at which rate [1/s].
const TETHER_RATE: f32 = 0.5;

/// How many times as fast it does so while the cloth settles [-].
const SETTLING: f32 = 30.0;

/// The compliance of the lines of a strained sheet, relative to what their particles resist with [-].
const COMPLIANCE: f32 = 0.02;

/// κ of what hangs, times this, is the strain that it may cost to give way [-].
const LOAD: f32 = 0.015;

/// Where this is granted, chains are as soft as they get [-].
const SOFT: f32 = 0.02;

impl Pass<'_> {
    /// How what is farther from a pin than it reaches comes back; none where it does so at once.
    pub(super) fn recovery<'b>(
        &self,
        effort: Effort,
        start: SharedPoints<'b>,
    ) -> Option<Recovery<'b>> {
        let size = self.size().max(SMALLEST);
        let times = if effort.recovers { 1.0 } else { SETTLING };
        effort.settles().then(|| Recovery {
            start,
            least: 2.0 * times * TETHER_SPEED * self.seconds / size,
            part: (times * TETHER_RATE * self.seconds).min(1.0),
        })
    }

    /// How far chains give way, where the largest strain that a mesh is granted is this.
    pub(super) fn give(&self, effort: Effort, granted: f32, touches: bool) -> Give {
        if !effort.recovers {
            return Give::default();
        }
        match &self.topology.fabric {
            None => Give {
                compliance: COMPLIANCE,
                pull: if touches { LARGEST_KAPPA } else { f32::MAX },
                push: LARGEST_KAPPA,
            },
            Some(fabric) => Give {
                compliance: self.compliance(fabric, granted),
                push: LARGEST_KAPPA,
                ..Give::default()
            },
        }
    }

    /// The compliance of the chains of a mesh that is strained, relative to what its particles resist with [-].
    ///
    /// They end anywhere, and there pull with all their tension at what bears less: the softer they are, the more evenly is shared what
    /// has not been granted. Its own weight stretches the mesh by no more than a part of what counts as strained.
    fn compliance(&self, fabric: &Fabric, granted: f32) -> f32 {
        let count = (fabric.particles() as f32).sqrt().max(1.0);
        let size = self.size().max(SMALLEST);
        let spacing = size / count;
        // κ = 4 h² T/(m L) of what hangs by its upper edge.
        let kappa = 4.0 * self.seconds * self.seconds * self.gravity.max(1.0) * size;
        let least = LOAD * spacing * spacing / kappa;
        let soft = least.min(1.0) * (granted / SOFT).min(1.0);
        soft.max(Give::default().compliance)
    }
}
