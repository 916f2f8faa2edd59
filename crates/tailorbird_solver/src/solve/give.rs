//! Give of a cloth that is asked for more than its fabric has; [`effort`] tells when.

use super::chains::Pass;
use crate::{
    effort::Effort,
    kernels::{
        lanes::SharedPoints,
        lines::{Give, LARGEST_KAPPA},
        recovery::Recovery,
    },
};

/// Least size of a cloth \[m\].
const SMALLEST: f32 = 1e-3;

/// Least speed at which a particle beyond the reach of its tether comes back while the cloth is strained [m/s].
const TETHER_SPEED: f32 = 0.05;

/// Rate at which it comes back [1/s].
const TETHER_RATE: f32 = 0.5;

/// Factor of both while the cloth comes to rest [-].
const RECOVERED: f32 = 30.0;

/// Softness of strained lines.
struct Softness {
    /// Largest compliance, relative to the inverse masses of the particles [-].
    most: f32,
    /// Ratio to κ of a hanging cloth of the strain that the softness may cost [-].
    load: f32,
    /// Granted strain at which lines are that soft [-].
    granted: f32,
}

/// Softness of a sheet: a body that pushes it out of its plane contradicts rows and columns the more the farther it does.
const SHEET: Softness = Softness {
    most: 0.15,
    load: 0.03,
    granted: 0.2,
};

/// Softness of a mesh: its chains end anywhere, and contradict one another wherever more is asked for than they have.
const MESH: Softness = Softness {
    most: 1.0,
    load: 0.015,
    granted: 0.02,
};

/// Largest pull of strained lines where a collider touches the cloth, κ = 4 w |μ| [-].
const PULL: f32 = 5.0;

impl Pass<'_> {
    /// Bounded return of particles beyond the reach of their tethers; `None` where they come back at once. `fresh` is true if some of the
    /// pins are new.
    pub fn recovery<'b>(
        &self,
        effort: Effort,
        fresh: bool,
        start: SharedPoints<'b>,
    ) -> Option<Recovery<'b>> {
        let size = self.size().max(SMALLEST);
        let times = if effort.recovers { 1.0 } else { RECOVERED };
        (effort.is_slowed() || fresh).then(|| Recovery {
            start,
            least: 2.0 * times * TETHER_SPEED * self.seconds / size,
            part: (times * TETHER_RATE * self.seconds).min(1.0),
        })
    }

    /// Limits of compliance and tension of lines, for a cloth with so much granted strain.
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

    /// Compliance of strained lines, relative to the inverse masses of their particles [-].
    ///
    /// The softer the lines are, the more evenly the strain beyond the grant is shared: a chain pulls with all its tension at lines that
    /// bear less. The cloth's own weight stretches it by no more than a part of [`STRAIN`](crate::effort::STRAIN).
    fn compliance(&self, granted: f32) -> f32 {
        let count = (self.topology.particles() as f32).sqrt().max(1.0);
        let size = self.size().max(SMALLEST);
        let spacing = size / count;
        // κ = 4 h² T/(m L) of a cloth that hangs by its upper edge.
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
