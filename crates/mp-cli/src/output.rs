//! Standard output, standard error, and output files.

use crate::input::is_standard;
use mp_plan::{Error, write_file};
use mp_store::FileId;
use std::collections::HashMap;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
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
                .help("name a file by --out, or make room where the output goes"));
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

/// The files of a command: inputs, and outputs that must be none of them, and no other output. Files are compared, not
/// names.
#[derive(Debug, Default)]
pub(crate) struct Claims(HashMap<FileId, Claim>);

#[derive(Debug)]
struct Claim {
    /// What an error calls it: `--out`, `input`.
    what: String,
    path: PathBuf,
    is_input: bool,
}

impl Claims {
    /// Adds a file that is read. Standard input is none.
    pub(crate) fn input(&mut self, path: &Path) {
        if !is_standard(path) {
            let claim = Claim { what: "input".into(), path: path.to_owned(), is_input: true };
            self.0.insert(FileId::of(path), claim);
        }
    }

    /// Adds a file that will be written. Standard output is none.
    ///
    /// # Errors
    /// When it is an input or another output, or could not be written.
    pub(crate) fn output(&mut self, option: &str, path: &Path) -> Result<(), Error> {
        if is_standard(path) {
            return Ok(());
        }
        mp_store::writable(path)?;
        let claim = Claim { what: option.into(), path: path.to_owned(), is_input: false };
        match self.0.insert(FileId::of(path), claim) {
            None => Ok(()),
            Some(other) if other.is_input => Err(Error::new(format!(
                "{option} {} would overwrite the input {}",
                path.display(),
                other.path.display()
            ))
            .help("name another file")),
            Some(other) if other.what == option => {
                Err(Error::new(format!("{option} {} would be written twice", path.display()))
                    .help("give each run a file of its own"))
            }
            Some(other) => Err(Error::new(format!(
                "{option} {} and {} {} are the same file",
                path.display(),
                other.what,
                other.path.display()
            ))
            .help("give each a file of its own")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_are_no_inputs_and_no_other_outputs() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        std::fs::write(at("scene"), "").unwrap();
        let mut claims = Claims::default();
        claims.input(&at("scene"));
        claims.input(&at("scene"));
        let refused = claims.output("--out", &at("./scene")).unwrap_err();
        assert!(refused.message().contains("overwrite the input"), "{refused}");
        claims.output("--out", &at("new/path")).unwrap();
        let refused = claims.output("--roadmap", &at("new/./path")).unwrap_err();
        assert!(refused.message().contains("--out"), "{refused}");
        claims.output("--out", Path::new("-")).unwrap();
        claims.output("--picture", Path::new("-")).unwrap();
        assert!(claims.output("--out", dir.path()).is_err());
    }
}
