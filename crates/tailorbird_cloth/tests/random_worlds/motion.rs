//! Motion of the free particles in the calm.

use std::ops::Range;

use bevy_math::{DMat3, DVec3, Vec3};

use crate::film::Film;

/// Velocities and energies in the calm, of free particles.
pub struct Motion {
    pub velocities: Vec<Vec<Vec3>>,
    /// Without the motion of the whole as a rigid body.
    pub deforming: Vec<Vec<Vec3>>,
    /// The mean of the squares of all velocities, as seen from what flows past them: the air, or nothing but themselves [m²/s²].
    pub square: Vec<f64>,
    pub kinetic: Vec<f64>,
    pub energy: Vec<f64>,
    /// Kinetic, as seen from the mean velocity.
    pub internal: Vec<f64>,
    /// True if any particle is inside a collider.
    pub inside: Vec<bool>,
}

impl Motion {
    pub fn of(film: &Film, calm: usize) -> Self {
        let steps = &film.steps[calm..];
        let mut motion = Self {
            velocities: Vec::new(),
            deforming: Vec::new(),
            square: Vec::new(),
            kinetic: Vec::new(),
            energy: Vec::new(),
            internal: Vec::new(),
            inside: Vec::new(),
        };
        for two in steps.windows(2) {
            let [from, to] = [&two[0].places, &two[1].places];
            let mut velocities = Vec::with_capacity(film.free.len());
            let (mut kinetic, mut potential, mut inside) = (0.0, 0.0, false);
            let (mut momentum, mut whole) = (DVec3::ZERO, 0.0);
            for &(i, mass) in &film.free {
                let mass = f64::from(mass);
                let velocity = (to[i] - from[i]) * film.hz as f32;
                let middle = 0.5 * (to[i].as_dvec3() + from[i].as_dvec3());
                momentum += mass * velocity.as_dvec3();
                whole += mass;
                kinetic += 0.5 * mass * velocity.as_dvec3().length_squared();
                potential -= mass * film.gravity.as_dvec3().dot(middle);
                let bodies = film.bodies.iter().filter(|body| body.meets);
                inside |= bodies.into_iter().any(|body| body.distance(to[i]) < 0.0);
                velocities.push(velocity);
            }
            let places = film.free.iter().map(|(i, mass)| (to[*i], *mass));
            let (deforming, square) = without_rigid(places, &velocities, film.air);
            motion.velocities.push(velocities);
            motion.deforming.push(deforming);
            motion.square.push(square);
            motion.kinetic.push(kinetic);
            motion.energy.push(kinetic + potential);
            motion
                .internal
                .push(kinetic - 0.5 * momentum.length_squared() / whole);
            motion.inside.push(inside);
        }
        motion
    }

    /// The median of how far the velocity of a particle by which the cloth deforms is from its mean around that step, over some steps
    /// [m/s].
    pub fn tremble(&self, particle: usize, steps: Range<usize>, around: usize) -> f64 {
        let at = |n: usize| self.deforming[n][particle];
        let last = self.deforming.len() - 1;
        let mut off: Vec<f32> = steps
            .map(|n| {
                let range = n.saturating_sub(around)..=(n + around).min(last);
                let count = range.clone().count() as f32;
                at(n).distance(range.map(at).sum::<Vec3>() / count)
            })
            .collect();
        off.sort_by(f32::total_cmp);
        f64::from(off[off.len() / 2])
    }
}

/// Velocities without those of a rigid body with the same momentum and angular momentum; and the mean of the squares of all, in air, or
/// of what the mean velocity leaves, in a vacuum [m²/s²].
fn without_rigid(
    places: impl Iterator<Item = (Vec3, f32)> + Clone,
    velocities: &[Vec3],
    air: bool,
) -> (Vec<Vec3>, f64) {
    let all = places.zip(velocities);
    let all = all.map(|((p, mass), v)| (p.as_dvec3(), f64::from(mass), v.as_dvec3()));
    let mass: f64 = all.clone().map(|(_, mass, _)| mass).sum();
    let mean = |of: &dyn Fn(DVec3, DVec3) -> DVec3| {
        let sum: DVec3 = all.clone().map(|(p, mass, v)| mass * of(p, v)).sum();
        sum / mass
    };
    let (center, velocity) = (mean(&|p, _| p), mean(&|_, v| v));
    let momentum = mean(&|p, v| (p - center).cross(v - velocity));
    let mut inertia = DMat3::ZERO;
    for (p, m, _) in all.clone() {
        let r = p - center;
        let outer = DMat3::from_cols(r * r.x, r * r.y, r * r.z);
        inertia += (DMat3::IDENTITY * r.length_squared() - outer) * (m / mass);
    }
    // Particles in a line may turn about it.
    let least = 1e-9 * (inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z);
    let inertia = inertia + DMat3::IDENTITY * least.max(1e-12);
    let spin = inertia.inverse() * momentum;
    let rigid = |p: DVec3| velocity + spin.cross(p - center);
    let still = if air { DVec3::ZERO } else { velocity };
    let square: f64 = all.clone().map(|(_, _, v)| v.distance_squared(still)).sum();
    let rest = all.map(|(p, _, v)| (v - rigid(p)).as_vec3());
    (rest.collect(), square / velocities.len() as f64)
}
