//! What a cloth gives way to that is asked for more than its fabric has; [`effort`] tells when.

use super::chains::Pass;
use crate::{
    effort::Effort,
    kernels::{
        lanes::SharedPoints,
        lines::{Give, LARGEST_KAPPA},
        recovery::Recovery,
    },
};

/// No cloth counts as smaller than this \[m\].
const SMALLEST: f32 = 1e-3;

/// How fast what is farther from a pin than it reaches comes back while the cloth is strained, at least [m/s].
const TETHER_SPEED: f32 = 0.05;

/// And at which rate [1/s].
const TETHER_RATE: f32 = 0.5;

/// How many times as fast it does so while the cloth settles [-].
const SETTLING: f32 = 30.0;

/// How soft strained lines get.
struct Softness {
    /// The largest compliance, relative to what their particles resist with [-].
    most: f32,
    /// κ of what hangs, times this, is the strain that it may cost [-].
    load: f32,
    /// They are that soft where so much is granted [-].
    granted: f32,
}

/// What a body pushes out of the plane of a sheet contradicts rows and columns the more the farther it does.
const SHEET: Softness = Softness {
    most: 0.15,
    load: 0.03,
    granted: 0.2,
};

/// The chains of a mesh end anywhere, and contradict one another wherever more is asked for than they have.
const MESH: Softness = Softness {
    most: 1.0,
    load: 0.015,
    granted: 0.02,
};

/// What strained lines pull with at most where something touches the cloth, κ = 4 w |μ| [-].
const PULL: f32 = 5.0;

impl Pass<'_> {
    /// How what is farther from a pin than it reaches comes back; none where it does so at once. `fresh` is whether some
    /// of the pins are new.
    pub fn recovery<'b>(
        &self,
        effort: Effort,
        fresh: bool,
        start: SharedPoints<'b>,
    ) -> Option<Recovery<'b>> {
        let size = self.size().max(SMALLEST);
        let times = if effort.recovers { 1.0 } else { SETTLING };
        (effort.settles() || fresh).then(|| Recovery {
            start,
            least: 2.0 * times * TETHER_SPEED * self.seconds / size,
            part: (times * TETHER_RATE * self.seconds).min(1.0),
        })
    }

    /// How far lines give way, where so much strain is granted to the cloth.
    pub fn give(&self, effort: Effort, granted: f32, touches: bool) -> Give {
        if !effort.recovers {
            return Give::default();
        }
        Give {
            compliance: self.compliance(granted),
            pull: if touches { PULL } else { f32::MAX },
            push: LARGEST_KAPPA,
        }
    }

    /// The compliance of strained lines, relative to what their particles resist with [-].
    ///
    /// The softer they are, the more evenly is shared what has not been granted: a chain pulls with all its tension at what bears less. The
    /// own weight stretches a cloth by no more than a part of what counts as strained.
    fn compliance(&self, granted: f32) -> f32 {
        let count = (self.topology.particles() as f32).sqrt().max(1.0);
        let size = self.size().max(SMALLEST);
        let spacing = size / count;
        // κ = 4 h² T/(m L) of what hangs by its upper edge.
        let kappa = 4.0 * self.seconds * self.seconds * self.gravity.max(1.0) * size;
        let softness = if self.topology.fabric().is_some() {
            MESH
        } else {
            SHEET
        };
        let most = (softness.load * spacing * spacing / kappa).min(softness.most);
        let soft = most * (granted / softness.granted).min(1.0);
        soft.max(Give::default().compliance)
    }
}
