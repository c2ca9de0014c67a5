//! Standard output, standard error, and output files.

use crate::input::is_standard;
use mp_plan::{Error, folder_of, write_file};
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Prints a line on standard output. A closed pipe is not an error.
pub(crate) fn print(line: &str) -> Result<(), Error> {
    match writeln!(std::io::stdout().lock(), "{line}") {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Error::new(format!("cannot write to standard output: {e}")))
        }
        _ => Ok(()),
    }
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
    if is_standard(path) {
        let written = std::io::stdout().lock().write_all(bytes);
        return written.map_err(|e| Error::new(format!("cannot write to standard output: {e}")));
    }
    write_file(path, bytes)
}

/// Refuses a path that [`write()`] would not be able to write.
pub(crate) fn writable(path: &Path) -> Result<(), Error> {
    if path.is_dir() {
        return Err(Error::new(format!("{} is a folder", path.display())).help("name a file"));
    }
    // The nearest folder that exists must be one.
    let mut folder = folder_of(path);
    while !folder.exists() {
        folder = folder_of(folder);
    }
    if !folder.is_dir() {
        let (path, folder) = (path.display(), folder.display());
        return Err(Error::new(format!("cannot write {path}: {folder} is not a folder")));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_written_is_known_beforehand() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("file");
        write(&file, b"").unwrap();
        assert!(writable(dir.path()).is_err());
        assert!(writable(&file.join("below")).is_err());
        assert!(writable(&file).is_ok());
        assert!(writable(&dir.path().join("new/folder/file")).is_ok());
        assert!(writable(Path::new("relative")).is_ok());
    }
}
