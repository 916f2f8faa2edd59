//! Times of the kernels, one table for each size.

use serde::Serialize;
use tailorbird_cloth::prelude::*;

use super::{
    cli::{Args, Isa},
    times::{KernelTime, measure},
};

/// One measurement, as it is written.
#[derive(Serialize, Clone, Debug)]
pub struct Record {
    kernel: &'static str,
    /// The name on the command line.
    isa: String,
    /// Particles along a side.
    size: u32,
    ns_per_particle: f64,
    constraints_per_particle: f64,
    ns_per_constraint: Option<f64>,
}

/// Measures and prints.
pub fn run(args: &Args) -> Vec<Record> {
    let sets = match args.isa {
        Isa::Auto => vec![Isa::Scalar, Isa::Sse2, Isa::Avx2, Isa::Avx512],
        one => vec![one],
    };
    let mut records = Vec::new();
    for size in args.size.map_or_else(|| vec![64, 256], |size| vec![size]) {
        let columns: Vec<Vec<KernelTime>> = sets
            .iter()
            .map(|&isa| measure(size, ClothInstructionSet::from(isa)))
            .collect();
        println!("{size} × {size}: ns per particle (ns per constraint)");
        print!("{:<22}", "");
        for isa in &sets {
            print!("{:>18}", name(*isa));
        }
        println!();
        for row in 0..columns.first().map_or(0, Vec::len) {
            print!("{:<22}", columns[0][row].name);
            for (isa, times) in sets.iter().zip(&columns) {
                let time = times[row];
                let of_one = time.ns_per_constraint();
                let of_one = of_one.map_or_else(String::new, |ns| format!(" ({ns:.2})"));
                print!("{:>18}", format!("{:.2}{of_one}", time.ns_per_particle));
                records.push(Record {
                    kernel: time.name,
                    isa: name(*isa),
                    size,
                    ns_per_particle: time.ns_per_particle,
                    constraints_per_particle: time.constraints_per_particle,
                    ns_per_constraint: time.ns_per_constraint(),
                });
            }
            println!();
        }
    }
    records
}

fn name(isa: Isa) -> String {
    format!("{isa:?}").to_lowercase()
}
