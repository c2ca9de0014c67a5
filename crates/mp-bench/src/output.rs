//! Lines on standard output and standard error.

use crate::error::{IntoError, Result};
use std::io::{ErrorKind, Write};

/// Prints a line on standard output. A closed pipe is not an error.
pub(crate) fn print(line: &str) -> Result<()> {
    match writeln!(std::io::stdout().lock(), "{line}") {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(e).doing(|| "cannot write to standard output".into())
        }
        _ => Ok(()),
    }
}

/// Prints a line for the person watching, on standard error.
pub(crate) fn note(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}
