//! Puts mutants into a source: each expression asks whether what stands for it is meant.

use std::ops::Range;

use super::find::Mutant;

/// Module that the expressions ask. The number of a mutant is that of its place in the list, from 1 on; 0 is none. Where the environment names a
/// file, all that ask are written there.
pub const QUESTION: &str = "
/// Number of the mutant that is meant.
#[doc(hidden)]
pub mod mutation {
    use std::{
        fs::OpenOptions,
        io::Write,
        sync::{
            OnceLock,
            atomic::{AtomicBool, AtomicU32, Ordering},
        },
    };

    static MEANT: AtomicU32 = AtomicU32::new(u32::MAX);
    static PATH: OnceLock<Option<String>> = OnceLock::new();
    static ASKED: [AtomicBool; 1 << 16] = [const { AtomicBool::new(false) }; 1 << 16];

    /// Returns whether this one is.
    #[inline(always)]
    pub fn is(mutant: u32) -> bool {
        let meant = MEANT.load(Ordering::Relaxed);
        if meant == u32::MAX { ask(mutant) } else { meant == mutant }
    }

    #[inline(never)]
    fn ask(mutant: u32) -> bool {
        let asked = &ASKED[mutant as usize % ASKED.len()];
        if asked.load(Ordering::Relaxed) && MEANT.load(Ordering::Relaxed) == u32::MAX {
            return false;
        }
        asked.store(true, Ordering::Relaxed);
        if let Some(path) = PATH.get_or_init(|| std::env::var(\"MUTANTS_ASKED\").ok()) {
            let file = OpenOptions::new().append(true).create(true).open(path);
            let _ = file.and_then(|mut file| writeln!(file, \"{mutant}\"));
            return false;
        }
        let meant = std::env::var(\"MUTANT\").ok();
        let meant = meant.and_then(|meant| meant.parse().ok()).unwrap_or(0);
        MEANT.store(meant, Ordering::Relaxed);
        meant == mutant
    }
}
";

/// A source with mutants, and where each of them is in it.
pub struct Planted {
    pub text: String,
    pub places: Vec<Place>,
}

/// Place of a mutant.
pub struct Place {
    /// In the list of all.
    pub mutant: usize,
    /// Range that stands for the expression.
    pub instead: Range<usize>,
    /// That, the expression and the question.
    pub whole: Range<usize>,
}

/// Plants those mutants that are not left out; each with its number in the list of all.
pub fn plant(text: &str, mutants: &[(usize, &Mutant)]) -> Planted {
    // Outer expressions begin first and end last.
    let mut ends: Vec<(usize, bool, usize, usize)> = Vec::new();
    for (k, (_, mutant)) in mutants.iter().enumerate() {
        let Range { start, end } = mutant.range;
        ends.push((start, true, usize::MAX - end, k));
        ends.push((end, false, usize::MAX - start, k));
    }
    // At one place what ends comes before what begins.
    ends.sort_by_key(|(at, begins, rank, k)| {
        let order = if *begins { *k } else { usize::MAX - *k };
        (*at, *begins, *rank, order)
    });
    let mut planted = Planted {
        text: String::new(),
        places: mutants
            .iter()
            .map(|(mutant, _)| Place {
                mutant: *mutant,
                instead: 0..0,
                whole: 0..0,
            })
            .collect(),
    };
    let mut done = 0;
    for (at, begins, _, k) in ends {
        planted.text += &text[done..at];
        done = at;
        let (number, mutant) = mutants[k];
        if begins {
            planted.places[k].whole.start = planted.text.len();
            planted.text += &format!("(if crate::mutation::is({}) {{ ", number + 1);
            planted.places[k].instead.start = planted.text.len();
            planted.text += &mutant.text;
            planted.places[k].instead.end = planted.text.len();
            planted.text += " } else { ";
        } else {
            planted.text += " })";
            planted.places[k].whole.end = planted.text.len();
        }
    }
    planted.text += &text[done..];
    planted
}
