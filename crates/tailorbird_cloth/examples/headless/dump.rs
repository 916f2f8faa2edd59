//! Positions of the particles, as CSV: step,row,column,x,y,z in the world [m], with 9 significant digits, enough to read the same `f32`
//! back.

use std::io::{self, Write};

use super::scene::Sheet;

/// The header.
const COLUMNS: &str = "step,row,column,x,y,z";

/// Writes the last step, and every so many before it.
pub struct Dump<W> {
    file: W,
    every: Option<u32>,
    last: u32,
    started: bool,
}

impl<W: Write> Dump<W> {
    /// Writes to `file` the start and every `every`-th step where that is given, and the step `last`.
    pub fn new(file: W, every: Option<u32>, last: u32) -> Self {
        Self {
            file,
            every,
            last,
            started: false,
        }
    }

    /// Writes the step, if it is one to be written.
    ///
    /// # Errors
    /// The errors of the file.
    pub fn write(&mut self, step: u32, sheet: &Sheet) -> io::Result<()> {
        let due = self.every.is_some_and(|every| step.is_multiple_of(every));
        if !(due || step == self.last) {
            return Ok(());
        }
        if !self.started {
            writeln!(self.file, "{COLUMNS}")?;
            self.started = true;
        }
        let columns = sheet.columns();
        for (i, p) in sheet.world_positions().enumerate() {
            let (row, column) = (i / columns, i % columns);
            writeln!(
                self.file,
                "{step},{row},{column},{:.8e},{:.8e},{:.8e}",
                p.x, p.y, p.z
            )?;
        }
        Ok(())
    }

    /// Makes sure that everything is written.
    ///
    /// # Errors
    /// The errors of the file.
    pub fn finish(mut self) -> io::Result<()> {
        self.file.flush()
    }
}
