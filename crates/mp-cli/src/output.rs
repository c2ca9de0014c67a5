//! Standard output, and files that are written whole or not at all.

use mp_plan::Error;
use std::io::{ErrorKind, Read, Write};
use std::path::Path;

/// Prints a line on standard output. A reader that went away is no error.
pub(crate) fn print(line: &str) -> Result<(), Error> {
    match writeln!(std::io::stdout().lock(), "{line}") {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Error::new(format!("cannot write to standard output: {e}")))
        }
        _ => Ok(()),
    }
}

/// Prints a line for the person watching, on standard error.
pub(crate) fn note(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// All of standard input, which must be text of at most 64 MiB.
pub(crate) fn standard_input() -> Result<String, Error> {
    const MOST: u64 = mp_io::MAX_TEXT_BYTES;
    let mut text = String::new();
    let read = std::io::stdin().lock().take(MOST + 1).read_to_string(&mut text);
    read.map_err(|e| Error::new(format!("cannot read standard input: {e}")))?;
    match text.len() as u64 > MOST {
        true => Err(Error::new(format!("standard input has more than {MOST} bytes"))),
        false => Ok(text),
    }
}

/// Whether a name stands for standard input or output.
pub(crate) fn is_standard(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Writes `bytes` to `path` whole or not at all; to standard output for `-`. Makes the folder when it is missing.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    if is_standard(path) {
        let written = std::io::stdout().lock().write_all(bytes);
        return written.map_err(|e| Error::new(format!("cannot write to standard output: {e}")));
    }
    let folder = folder_of(path);
    std::fs::create_dir_all(folder)
        .map_err(|e| Error::new(format!("cannot make the folder {}: {e}", folder.display())))?;
    Ok(mp_io::write_atomic(path, bytes)?)
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Complains early about a path that [`write()`] will not be able to write.
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
