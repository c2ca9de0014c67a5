//! Standard output, standard error, and output files.

use crate::input::is_standard;
pub(crate) use mp_plan::Claims;
use mp_plan::{Error, Interrupt, StoppedBy, write_file};
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether the reader of standard output has gone.
static CLOSED: AtomicBool = AtomicBool::new(false);

/// The exit code when nobody has read all of the answer: that of a process ended by the signal for a closed pipe.
pub(crate) const CLOSED_CODE: u8 = 141;

/// Whether something could not be printed, because the reader of standard output has gone.
pub(crate) fn is_closed() -> bool {
    CLOSED.load(Ordering::Relaxed)
}

/// Writes to standard output. A reader that has gone is no error here, so that all files are written; the exit code
/// tells it.
fn to_standard_output(bytes: &[u8]) -> Result<(), Error> {
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(e) if e.kind() == ErrorKind::BrokenPipe => CLOSED.store(true, Ordering::Relaxed),
        Err(e) => {
            return Err(Error::new(format!("cannot write to standard output: {e}"))
                .help("make room where the output goes, or send it elsewhere"));
        }
        Ok(()) => {}
    }
    Ok(())
}

/// Prints a line on standard output.
pub(crate) fn print(line: &str) -> Result<(), Error> {
    to_standard_output(format!("{line}\n").as_bytes())
}

/// Prints an answer as JSON on standard output.
pub(crate) fn print_json(answer: &impl serde::Serialize) -> Result<(), Error> {
    print(&serde_json::to_string(answer).map_err(|e| Error::new(format!("cannot write JSON: {e}")))?)
}

/// Prints a line for the person watching, on standard error.
pub(crate) fn note(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Writes `bytes` to `path`, whole or not at all, or to standard output for `-`. Makes the folder when it is missing.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    if is_standard(path) { to_standard_output(bytes) } else { write_file(path, bytes) }
}

/// What was made of a path, unless that was interrupted: then a note says that there is no `file`.
pub(crate) fn in_time<T>(
    made: Result<T, Error>,
    interrupt: &Interrupt,
    file: &Path,
) -> Result<Option<T>, Error> {
    match (made, interrupt.raised()) {
        (Err(_), Some(why)) => {
            let (why, file) = (StoppedBy::from(why), file.display());
            note(&format!(
                "{why}: {file} was not made; `mp check --certificate` and `mp time` make it of a path"
            ));
            Ok(None)
        }
        (made, _) => made.map(Some),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_plan::Cancel;

    /// What ends a run while its path is proved leaves the path; other errors stay errors.
    #[test]
    fn a_proof_without_time_is_no_error() {
        let (cancel, file) = (Cancel::default(), Path::new("proof.json"));
        let mut interrupt = Interrupt::new(cancel.clone());
        let failed = || Err::<(), _>(Error::new("not free"));
        assert!(!interrupt.ask() && in_time(failed(), &interrupt, file).is_err());
        assert_eq!(in_time(Ok(1), &interrupt, file).unwrap(), Some(1));
        cancel.cancel();
        assert!(interrupt.ask());
        assert_eq!(in_time(failed(), &interrupt, file).unwrap(), None);
        assert_eq!(in_time(Ok(1), &interrupt, file).unwrap(), Some(1));
    }
}
