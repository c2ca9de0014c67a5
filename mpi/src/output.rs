//! Standard output and standard error.

use mp_plan::Error;
use std::io::Write;
use std::time::{Duration, Instant};

/// How often progress is told: under MPI nobody has a terminal, and lines stay.
const EVERY: Duration = Duration::from_secs(10);

/// Prints a line on standard output.
pub(crate) fn print(line: &str) -> Result<(), Error> {
    writeln!(std::io::stdout().lock(), "{line}")
        .map_err(|e| Error::new(format!("cannot write to standard output: {e}")))
}

/// Prints a line for the person watching, on standard error.
pub(crate) fn note(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Tells of progress now and then.
pub(crate) struct Teller(Instant);

impl Teller {
    pub(crate) fn new() -> Self {
        Self(Instant::now())
    }

    /// Prints the line, unless another one was printed a short time ago.
    pub(crate) fn say(&mut self, line: impl FnOnce() -> String) {
        if self.0.elapsed() >= EVERY {
            self.0 = Instant::now();
            note(&line());
        }
    }
}
