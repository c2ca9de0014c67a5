//! Lines on standard output and standard error.

use crate::error::{IntoError, Result};
use std::io::{ErrorKind, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether the reader of standard output has gone.
static CLOSED: AtomicBool = AtomicBool::new(false);

/// Whether something could not be printed, because the reader of standard output has gone.
pub(crate) fn is_closed() -> bool {
    CLOSED.load(Ordering::Relaxed)
}

/// Whether another process prints for this one.
static SILENT: AtomicBool = AtomicBool::new(false);

/// From now on nothing is printed: this is not the process that the person watches.
pub(crate) fn silence() {
    SILENT.store(true, Ordering::Relaxed);
}

/// Prints a line on standard output. A reader that has gone is no error here, so that all files are written.
pub(crate) fn print(line: &str) -> Result<()> {
    if SILENT.load(Ordering::Relaxed) {
        return Ok(());
    }
    match writeln!(std::io::stdout().lock(), "{line}") {
        Err(e) if e.kind() == ErrorKind::BrokenPipe => {
            CLOSED.store(true, Ordering::Relaxed);
            Ok(())
        }
        Err(e) => Err(e).doing(|| "cannot write to standard output".into()),
        Ok(()) => Ok(()),
    }
}

/// Prints a line for the person watching, on standard error.
pub(crate) fn note(line: &str) {
    if !SILENT.load(Ordering::Relaxed) {
        let _ = writeln!(std::io::stderr().lock(), "{line}");
    }
}
