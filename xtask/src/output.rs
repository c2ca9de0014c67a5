//! Standard output, and files that are written whole or not at all.

use miette::{IntoDiagnostic, Result, WrapErr, miette};
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Prints a line on standard output. A reader that went away is no error.
pub(crate) fn print(line: &str) -> Result<()> {
    match writeln!(std::io::stdout().lock(), "{line}") {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(e).into_diagnostic().wrap_err("cannot write to standard output")
        }
        _ => Ok(()),
    }
}

/// Prints a line for the person watching, on standard error.
pub(crate) fn note(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Writes `bytes` to `path` whole or not at all. Makes the folder when it is missing.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = folder_of(path);
    std::fs::create_dir_all(folder)
        .into_diagnostic()
        .wrap_err_with(|| format!("cannot make the folder {}", folder.display()))?;
    Ok(mp::io::write_atomic(path, bytes)?)
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Complains early about a path that [`write()`] will not be able to write.
pub(crate) fn writable(path: &Path) -> Result<()> {
    if path.is_dir() {
        return Err(miette!(help = "name a file", "{} is a folder", path.display()));
    }
    // The nearest folder that exists must be one.
    let mut folder = folder_of(path);
    while !folder.exists() {
        folder = folder_of(folder);
    }
    if !folder.is_dir() {
        return Err(miette!("cannot write {}: {} is not a folder", path.display(), folder.display()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_replaced_whole_and_leave_nothing_behind() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a/b.txt");
        write(&path, b"one").unwrap();
        write(&path, b"two").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"two");
        assert_eq!(std::fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
    }

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
