//! Runs the peers and says how they did.

use std::time::{Duration, Instant};

use crate::{
    cli::MeasureArgs,
    error::Error,
    peers::{Peer, PeerKind},
    record::{self, Record},
    scene::{self, Sheet},
};

/// Takes all measurements that were asked for, prints them, and writes them where asked.
///
/// # Errors
/// When a peer is not built in, none came through, or the file cannot be written.
pub fn measure(args: &MeasureArgs) -> Result<(), Error> {
    let kinds = if args.peers.is_empty() {
        PeerKind::built()
    } else {
        args.peers.clone()
    };
    let builders = kinds
        .into_iter()
        .map(|kind| Ok((kind, kind.builder()?)))
        .collect::<Result<Vec<_>, Error>>()?;
    let mut records = Vec::new();
    println!(
        "{:<12} {:>5} {:>10} {:>6} {:>9} {:>10} {:>10} {:>10}",
        "peer", "size", "particles", "passes", "ms/step", "mean", "99 %", "largest"
    );
    for &size in &args.sizes {
        let sheet = Sheet { size: size.into() };
        for (kind, build) in &builders {
            for &passes in &args.iterations {
                let mut peer = build(sheet, passes);
                let start = format!(
                    "{:<12} {size:>5} {:>10} {passes:>6}",
                    kind.name(),
                    sheet.particles()
                );
                match hang(peer.as_mut(), sheet) {
                    Ok((time, stretch)) => {
                        let record = Record {
                            solver: kind.name().to_owned(),
                            scene: scene::NAME.to_owned(),
                            size: size.into(),
                            passes: passes.into(),
                            ms: time.as_secs_f64() * 1e3,
                            stretch_mean: stretch.mean,
                            stretch_p99: stretch.p99,
                            stretch_max: stretch.max,
                        };
                        println!(
                            "{start} {:>9.3} {:>8.3} % {:>8.3} % {:>8.3} %",
                            record.ms,
                            record.stretch_mean * 100.0,
                            record.stretch_p99 * 100.0,
                            record.stretch_max * 100.0
                        );
                        records.push(record);
                    }
                    Err(Diverged { step }) => println!("{start} diverged in step {step}"),
                }
            }
        }
    }
    if records.is_empty() {
        return Err(Error::NothingMeasured);
    }
    args.json
        .as_deref()
        .map_or(Ok(()), |path| record::write(path, &records))
}

/// A peer's positions are no longer numbers.
struct Diverged {
    /// When that was seen.
    step: usize,
}

/// Stretch of the structural edges, max(0, l / L − 1) [-].
struct Stretch {
    mean: f64,
    p99: f64,
    max: f64,
}

/// The median time of a step, and the stretch in all steps of the last quarter.
fn hang(peer: &mut dyn Peer, sheet: Sheet) -> Result<(Duration, Stretch), Diverged> {
    let mut times = Vec::with_capacity(scene::STEPS);
    let mut positions = Vec::with_capacity(sheet.particles());
    let mut stretch = Vec::new();
    for step in 1..=scene::STEPS {
        let start = Instant::now();
        peer.step();
        times.push(start.elapsed());
        if step > scene::STEPS - scene::STEPS / 4 {
            positions.clear();
            peer.positions(&mut positions);
            for [a, b] in sheet.edges() {
                let length = scene::distance(positions[a], positions[b]);
                if !length.is_finite() {
                    return Err(Diverged { step });
                }
                stretch.push((length / sheet.spacing() - 1.0).max(0.0));
            }
        }
    }
    let middle = times.len() / 2;
    let (_, median, _) = times.select_nth_unstable(middle);
    Ok((*median, Stretch::of(stretch)))
}

impl Stretch {
    /// Of these values, of which there is at least one.
    fn of(mut values: Vec<f32>) -> Self {
        let sum: f64 = values.iter().copied().map(f64::from).sum();
        let mean = sum / values.len() as f64;
        let at = values.len() * 99 / 100;
        let (_, p99, above) = values.select_nth_unstable_by(at, f32::total_cmp);
        let max = above.iter().copied().fold(*p99, f32::max);
        Self {
            mean,
            p99: (*p99).into(),
            max: max.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretch_of_known_values() {
        let stretch = Stretch::of((0..200).rev().map(|k| k as f32).collect());
        assert!((stretch.mean - 99.5).abs() < 1e-9);
        assert!((stretch.p99 - 198.0).abs() < 1e-9);
        assert!((stretch.max - 199.0).abs() < 1e-9);
    }

    #[test]
    fn the_classic_scheme_stretches_less_with_more_passes() {
        let sheet = Sheet { size: 12 };
        let mean = |passes| {
            let build = PeerKind::Classic.builder().expect("built in");
            let mut peer = build(sheet, passes);
            let result = hang(peer.as_mut(), sheet);
            result
                .unwrap_or_else(|d| panic!("diverged in step {}", d.step))
                .1
                .mean
        };
        let [few, many] = [4, 64].map(mean);
        assert!(many < few && few < 0.2 && many > 0.0, "{few} and {many}");
    }
}
