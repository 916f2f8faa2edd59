//! Contact rule for a particle's path, in double precision, and particles that meet a collider.

use std::sync::atomic::AtomicBool;

use crate::properties::*;
use bevy_math::{DVec3, Vec3};

use super::{cases, vector};
use crate::{
    kernels::{
        contact::{Out, Path, Phase, Touching},
        lanes::{Shared, SharedPoints},
    },
    numbers::Numbers,
    points::Points,
};

/// Particles on their paths through a substep.
#[derive(Clone, Debug)]
pub(super) struct Particles {
    pub from: Vec<Vec3>,
    pub to: Vec<Vec3>,
    /// Noted contact of each particle: the normal and the depth.
    pub noted: Option<Vec<(Vec3, f32)>>,
    pub phase: Phase,
    /// Largest distance by which a particle is pushed out that was inside already \[m\].
    pub most: f32,
}

/// Positions afterwards, and noted contacts.
pub(super) struct Collided {
    pub from: Points,
    pub to: Points,
    pub noted: Option<(Points, Numbers)>,
    pub any: bool,
    pub overlaps: bool,
}

/// A particle that touches, relative to the collider, in axes in which that stands still.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    pub from: DVec3,
    pub to: DVec3,
    pub normal: DVec3,
    /// Depth of `to` below the surface.
    pub depth: f64,
    pub depth_at_start: f64,
    /// Displacement of the surface.
    pub surface: DVec3,
}

/// Path of a particle after its contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct After {
    pub from: DVec3,
    pub to: DVec3,
    pub depth: f64,
    pub overlaps: bool,
}

/// Verdict of a rule on a path.
pub(super) enum Verdict {
    Free,
    Touches(Meeting),
    /// Doubt: rounding decides.
    Doubt,
}

impl Particles {
    /// Collides all particles; the last one is held.
    pub fn collide(&self, collide: impl FnOnce(Touching) -> bool) -> Collided {
        let n = self.from.len();
        let (mut from, mut to): (Points, Points) = (
            self.from.iter().copied().collect(),
            self.to.iter().copied().collect(),
        );
        let mut inv_mass: Numbers = (0..n).map(|i| if i + 1 == n { 0.0 } else { 2.0 }).collect();
        let mut noted: Option<(Points, Numbers)> = self.noted.as_ref().map(|noted| {
            (
                noted.iter().map(|n| n.0).collect(),
                noted.iter().map(|n| n.1).collect(),
            )
        });
        let overlaps = AtomicBool::new(false);
        let any = collide(Touching {
            position: SharedPoints::new(&mut to),
            previous: SharedPoints::new(&mut from),
            inv_mass: Shared::new(&mut inv_mass),
            contacts: (noted.as_mut()).map(|(n, d)| (SharedPoints::new(n), Shared::new(d))),
            phase: self.phase,
            out: Out {
                most: self.most,
                overlaps: &overlaps,
            },
        });
        Collided {
            from,
            to,
            noted,
            any,
            overlaps: overlaps.into_inner(),
        }
    }

    /// Noted contact of a particle that counts: in the final phase alone.
    pub fn known(&self, i: usize) -> (DVec3, f64) {
        match (&self.noted, self.phase) {
            (Some(noted), Phase::Final) => (noted[i].0.as_dvec3(), f64::from(noted[i].1)),
            _ => (DVec3::ZERO, 0.0),
        }
    }

    /// Pushes out along the normal; a particle that was deep inside before comes out by as much as it went in, plus `most`. In the final
    /// phase friction takes the sliding back by its coefficient times the depth, that of the approach included. No motion away from the
    /// surface is left: `from` follows.
    pub fn resolved(&self, i: usize, meeting: Meeting, friction: f32) -> After {
        let Meeting {
            from, to, normal, ..
        } = meeting;
        let most = normal.dot(from - to).max(0.0) + f64::from(self.most);
        let overlaps = meeting.depth > most && meeting.depth_at_start > f64::from(self.most);
        let depth = if overlaps { most } else { meeting.depth };
        let to = to + normal * depth;
        let away = normal.dot(to - from);
        let out = from + normal * away.max(0.0);
        if self.phase == Phase::Approach {
            return After {
                from: out,
                to,
                depth,
                overlaps,
            };
        }
        let (noted, before) = self.known(i);
        let pressed = if normal.dot(noted) > 0.7 {
            depth + before
        } else {
            depth
        };
        let sliding = (to - from) - normal * away - meeting.surface;
        let to = to - sliding.clamp_length_max(f64::from(friction) * pressed);
        After {
            from: out,
            to,
            depth,
            overlaps,
        }
    }

    /// Compares all particles with the verdict of a rule on each, seen from outside; returns how many touch.
    pub fn compare(
        &self,
        is: &Collided,
        friction: f32,
        most: f64,
        rule: impl Fn(usize) -> Verdict,
        outside: impl Fn([DVec3; 2]) -> [DVec3; 2],
    ) -> Result<usize, TestCaseError> {
        self.compare_with(is, friction, most, rule, outside, self)
    }

    /// The same, with what was noted in the axes of the collider; `start` is how all was.
    pub fn compare_with(
        &self,
        is: &Collided,
        friction: f32,
        most: f64,
        rule: impl Fn(usize) -> Verdict,
        outside: impl Fn([DVec3; 2]) -> [DVec3; 2],
        start: &Self,
    ) -> Result<usize, TestCaseError> {
        let (mut count, mut doubt, mut overlaps) = (0, false, false);
        for i in 0..self.from.len() {
            let paths = [is.from.get(i), is.to.get(i)];
            let rule = if i + 1 == self.from.len() {
                Verdict::Free
            } else {
                rule(i)
            };
            let noted = is
                .noted
                .as_ref()
                .map(|(normal, depth)| (normal.get(i), depth[i]));
            let before = start.noted.as_ref().map(|noted| noted[i]);
            match rule {
                Verdict::Doubt => doubt = true,
                Verdict::Free => {
                    prop_assert_eq!(paths, [start.from[i], start.to[i]], "{} is free", i);
                    prop_assert_eq!(noted, before);
                }
                Verdict::Touches(meeting) => {
                    count += 1;
                    let after = self.resolved(i, meeting, friction);
                    overlaps |= after.overlaps;
                    let wanted = outside([after.from, after.to]);
                    for (is, wanted) in paths.iter().zip(wanted) {
                        let off = is.as_dvec3().distance(wanted);
                        prop_assert!(off < most, "{i}: {is} {wanted}, {meeting:?}");
                    }
                    if self.phase == Phase::Final {
                        prop_assert_eq!(noted, before);
                    } else if let Some((_, depth)) = noted {
                        prop_assert!((f64::from(depth) - after.depth).abs() < most);
                    }
                }
            }
        }
        prop_assert!(doubt || is.any == (count > 0));
        prop_assert!(doubt || is.overlaps == overlaps);
        Ok(count)
    }
}

/// Any particles: those that are where a contact was noted have been about there before.
pub(super) fn particles(size: f32, travel: f32) -> impl Strategy<Value = Particles> {
    let path =
        (vector(size), vector(travel)).prop_map(|(from, displacement)| (from, from + displacement));
    let noted = (vector(1.0), 0.0_f32..0.3, any::<bool>());
    let noted = noted.prop_map(|(normal, depth, some)| {
        if some {
            (normal.normalize_or_zero(), depth)
        } else {
            (Vec3::ZERO, 0.0)
        }
    });
    let phase = prop_oneof![Just(Phase::Approach), Just(Phase::Final)];
    let most = prop_oneof![Just(f32::INFINITY), 0.0_f32..0.1];
    let paths = prop::collection::vec((path, noted), 2..40);
    (paths, any::<bool>(), phase, most).prop_map(|(paths, is_noted, phase, most)| Particles {
        from: paths.iter().map(|(path, _)| path.0).collect(),
        to: paths.iter().map(|(path, _)| path.1).collect(),
        noted: is_noted.then(|| paths.iter().map(|(_, noted)| *noted).collect()),
        phase,
        most,
    })
}

/// Returns whether a number is so near to a threshold of a rule that rounding decides.
pub(super) fn near(value: f64, threshold: f64) -> bool {
    (value - threshold).abs() < 1e-5
}

/// Meeting of a path, in the axes of a solid, whose distance and normal are known.
pub(super) fn meeting(
    particles: &Particles,
    i: usize,
    [from, to]: [DVec3; 2],
    (distance, normal): (f64, DVec3),
    at_start: f64,
) -> Verdict {
    let (noted, depth) = particles.known(i);
    let cos = normal.dot(noted);
    let thresholds = [
        (distance, 0.0),
        (distance, depth),
        (cos, 0.9),
        (cos, 0.7),
        (-at_start, f64::from(particles.most)),
    ];
    if thresholds
        .into_iter()
        .any(|(value, threshold)| near(value, threshold))
    {
        return Verdict::Doubt;
    }
    if distance < 0.0 || (depth > 0.0 && distance < depth && cos > 0.9) {
        let depth = (-distance).max(0.0);
        let surface = DVec3::ZERO;
        return Verdict::Touches(Meeting {
            from,
            to,
            normal,
            depth,
            depth_at_start: -at_start,
            surface,
        });
    }
    Verdict::Free
}

proptest! {
    #![proptest_config(cases(1000))]

    /// One particle by itself: as those side by side in the final phase, with nothing noted.
    #[test]
    fn one_path_is_resolved_as_stated(
        from in vector(1.0), to in vector(1.0), normal in vector(1.0), depth in 0.0_f32..0.5, friction in 0.0_f32..2.0, surface in vector(0.3),
    ) {
        prop_assume!(normal.length() > 0.1);
        let normal = normal.normalize();
        let alone = Particles { from: vec![from], to: vec![to], noted: None, phase: Phase::Final, most: f32::INFINITY };
        let meeting = Meeting {
            from: from.as_dvec3(), to: to.as_dvec3(), normal: normal.as_dvec3(), depth: depth.into(), depth_at_start: 0.0, surface: surface.as_dvec3(),
        };
        let wanted = alone.resolved(0, meeting, friction);
        let is = Path { from, to }.resolve(normal, depth, friction * depth, surface);
        prop_assert!(is.from.as_dvec3().distance(wanted.from) < 3e-6);
        prop_assert!(is.to.as_dvec3().distance(wanted.to) < 3e-6);
    }
}
