//! Demands on a cloth, as far as physics tells.

use std::{fmt, ops::Range};

use crate::{CALM, SETTLED, WATCHED, film::Film, motion::Motion};

/// Kind of a violation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A particle is at no place, or the cloth reports an error.
    Wrong,
    /// Particles are farther apart than holds and fabric explain.
    Apart,
    /// Energy rises.
    Gains,
    /// Energy does not fall as fast as damping alone lets it.
    GoesOn,
    /// A particle is faster than what falls.
    Fast,
    /// A particle trembles.
    Trembles,
}

/// With what was measured.
pub struct Violation {
    pub kind: Kind,
    text: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:?}: {}", self.kind, self.text)
    }
}

/// Figures of the time that is watched, unless another one is named.
#[derive(Clone, Debug, Default)]
pub struct Figures {
    /// The fastest particle [m/s].
    pub speed: f64,
    /// Strongest tremble [m/s].
    pub tremble: f64,
    /// Speed of the particles, in a vacuum as seen from their mean velocity: root of the mean square [m/s].
    pub whole: f64,
    /// The largest rise of energy from [`SETTLED`] on, as a part of the scale [-].
    pub gain: f64,
    /// At the end.
    pub strained: f32,
    pub stretch: f32,
    pub inside: bool,
    /// When the calm began: how many times as far apart as in the flat sheet two held particles were at most [-], and how deep a free one
    /// was inside a collider \[m\].
    pub asked: (f32, f32),
    /// When it came out of colliders, and its stretch was recovered, the last time \[s\].
    pub settled: f64,
}

impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "fastest {:.2} m/s, trembles {:.2}, whole {:.2}, gain {:.3}, strained {:.2}, stretch {:.2}, free of work {:.2} s, asked {:.1} deep {:.2}{}",
            self.speed,
            self.tremble,
            self.whole,
            self.gain,
            self.strained,
            self.stretch,
            self.settled,
            self.asked.0,
            self.asked.1,
            if self.inside { ", inside" } else { "" },
        )
    }
}

/// Largest distance of particles as a multiple of that in the flat sheet, besides the distances of holds: while the world is wild, and at
/// the end [-].
const APART: [f32; 2] = [10.0, 3.0];

/// Additional distance by which each collider may push particles apart \[m\].
const ROOM: f32 = 3.0;

/// Ratio of the distances of holds to those in the flat sheet above which the only demand is that the cloth stays where it is: it is still
/// on its way to rest.
const TORN: f32 = 10.0;

/// Cloth that is stretched by more than this in the mean has work to give back [-].
const STRETCHED: f32 = 0.01;

/// For how long a fabric may keep energy before it gives it back \[s\], at least, and in times that stretch takes along its diagonal: four
/// are a period of what hangs.
const BOUNCE: (f32, f32) = (0.25, 4.0);

/// The least acceleration that energies are measured by [m/s²].
const G: f64 = 9.81;

/// Part of energy that may come from nowhere [-].
const GAIN: f64 = 0.01;

/// Speed below which a cloth is at rest [m/s].
const REST: f64 = 0.1;

/// Largest speed of a cloth that comes out of colliders, or back to its length [m/s].
const RECOVERY: f64 = 2.0;

/// Part of the motion of the whole below which a tremble is a ripple of it [-].
const RIPPLE: f64 = 0.5;

/// Motion within this time is trembling \[s\].
const MOMENT: f64 = 0.08;

/// Figures, and violations.
pub fn check(film: &Film) -> (Figures, Vec<Violation>) {
    let mut checks = Checks {
        film,
        calm: film.calm.unwrap(),
        figures: Figures::default(),
        violations: Vec::new(),
    };
    let end = film.steps.len() - 1;
    for (n, seen) in film.steps.iter().enumerate() {
        if let Some(wrong) = &seen.wrong {
            checks.violated(Kind::Wrong, format!("step {n} of {end}: {wrong}"));
            return (checks.figures, checks.violations);
        }
    }
    checks.apart();
    let last = &film.steps[end];
    (checks.figures.strained, checks.figures.stretch) = (last.strained, last.stretch.max);
    checks.figures.asked = (film.asked, film.buried());
    if !film.free.is_empty() && film.asked <= TORN {
        let motion = Motion::of(film, checks.calm);
        checks.energy(&motion);
        checks.speeds(&motion);
    }
    (checks.figures, checks.violations)
}

/// Checks of a world.
struct Checks<'a> {
    film: &'a Film,
    /// The step that the calm begins with.
    calm: usize,
    figures: Figures,
    violations: Vec<Violation>,
}

impl Checks<'_> {
    fn violated(&mut self, kind: Kind, text: String) {
        self.violations.push(Violation { kind, text });
    }

    /// Steps in so many seconds.
    fn steps(&self, seconds: f32) -> usize {
        (f64::from(seconds) * self.film.hz) as usize
    }

    fn watched(&self) -> Range<usize> {
        self.steps(CALM)..self.steps(CALM + WATCHED) - 1
    }

    fn apart(&mut self) {
        let film = self.film;
        let end = film.steps.len() - 1;
        let size = film.steps.iter().map(|s| s.size).fold(0.0, f32::max);
        let reach = film.reach + ROOM * film.bodies.len() as f32;
        for (steps, times) in [(0..end, APART[0]), (end..end + 1, APART[1])] {
            let spreads = film.steps[steps.clone()].iter().map(|s| s.spread);
            let farthest = spreads.fold(0.0, f32::max);
            if farthest > times * size + reach {
                let text = format!(
                    "in steps {steps:?} of {end} {farthest} m apart, {size} m at rest, holds went {} m",
                    film.reach
                );
                self.violated(Kind::Apart, text);
                return;
            }
        }
    }

    fn energy(&mut self, motion: &Motion) {
        let film = self.film;
        let (settled, watched) = (self.steps(SETTLED), self.watched());
        self.figures.inside = motion.inside[watched.end - 1];
        let (energy, kinetic) = if film.held || film.air || !film.bodies.is_empty() {
            (&motion.energy, &motion.kinetic)
        } else {
            (&motion.internal, &motion.internal)
        };
        let mass: f64 = film.free.iter().map(|(_, mass)| f64::from(*mass)).sum();
        let size = film.steps.last().unwrap().size;
        let weight = mass * f64::from(film.gravity.length()).max(G) * f64::from(size);
        let scale = weight + kinetic[settled];
        let bounce = self.steps(BOUNCE.0.max(BOUNCE.1 * size * film.slowness));
        let mut least = f64::INFINITY;
        let mut gained = (0.0, 0);
        let mut since = settled;
        let mut stretched = true;
        for n in settled..watched.end {
            // What is stretched later on has stretched itself.
            stretched &= film.steps[self.calm + n + 1].stretch.mean > STRETCHED;
            if motion.inside[n] || stretched {
                (least, since) = (f64::INFINITY, n + 1);
            } else if n >= since + bounce {
                let of_late = energy[n - bounce..=n].iter().copied();
                least = least.min(of_late.fold(f64::MIN, f64::max));
                let gain = (energy[n] - least) / scale;
                if gain > gained.0 {
                    gained = (gain, n);
                }
            }
        }
        self.figures.gain = gained.0;
        self.figures.settled = since as f64 / film.hz;
        if gained.0 > GAIN {
            let text = format!(
                "{:.2} s into the calm energy has risen by {:.1} % of {scale:.3} J, {weight:.3} J of which are weight by size",
                gained.1 as f64 / film.hz,
                100.0 * gained.0,
            );
            self.violated(Kind::Gains, text);
        }
        let moving: f64 = kinetic[watched.clone()].iter().sum();
        let damped = 2.0 * f64::from(film.damping) * moving / film.hz;
        let lost = energy[watched.start] - energy[watched.end - 1];
        if since <= watched.start && lost < 0.5 * damped - GAIN * scale {
            let text =
                format!("energy falls by {lost} J in the end, damping alone takes {damped} J");
            self.violated(Kind::GoesOn, text);
        }
    }

    fn speeds(&mut self, motion: &Motion) {
        let film = self.film;
        let (settled, watched) = (self.steps(SETTLED), self.watched());
        let square: f64 = motion.square[watched.clone()].iter().sum();
        self.figures.whole = (square / watched.len() as f64).sqrt();
        let up = -film.gravity.normalize_or_zero();
        let places = &film.steps[self.calm + settled].places;
        let top = places.iter().map(|p| up.dot(*p)).fold(f32::MIN, f32::max);
        let speed = |n: usize, k: usize| f64::from(motion.velocities[n][k].length());
        let first = (0..film.free.len()).map(|k| speed(settled, k));
        let first = first.fold(0.0, f64::max);
        let recovers = self.figures.settled > f64::from(SETTLED);
        let least = if recovers { RECOVERY } else { REST };
        let around = ((MOMENT * film.hz / 2.0).round() as usize).max(1);
        let (mut fast, mut trembling) = ((0.0, 0, 0.0), (0.0, 0));
        for (k, (i, _)) in film.free.iter().enumerate() {
            let fastest = watched.clone().map(|n| speed(n, k)).fold(0.0, f64::max);
            self.figures.speed = self.figures.speed.max(fastest);
            if fastest <= REST {
                continue;
            }
            for n in watched.clone() {
                let height = up.dot(film.steps[self.calm + n + 1].places[*i]);
                let drop = f64::from((top - height).max(0.0) * film.gravity.length());
                let most = (2.0 * (2.0 * drop + first * first)).sqrt().max(least);
                if speed(n, k) / most > fast.0 {
                    fast = (speed(n, k) / most, *i, most);
                }
            }
            let tremble = motion.tremble(k, watched.clone(), around);
            if tremble > trembling.0 {
                trembling = (tremble, *i);
            }
        }
        self.figures.tremble = trembling.0;
        if fast.0 > 1.0 {
            let (times, particle, most) = fast;
            let speed = times * most;
            let text = format!(
                "particle {particle} flies at {speed:.2} m/s in the end, falling explains {most:.2}"
            );
            self.violated(Kind::Fast, text);
        }
        if trembling.0 > REST.max(RIPPLE * self.figures.whole) {
            let text = format!(
                "particle {} trembles by {:.3} m/s in the end, where the whole goes at {:.3} m/s",
                trembling.1, trembling.0, self.figures.whole
            );
            self.violated(Kind::Trembles, text);
        }
    }
}
