//! Reading within limits.

use crate::error::{Error, ErrorKind};
use crate::write::folder_of;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// The content of the regular file at `path`, at most `limit` bytes.
///
/// # Errors
/// As [`open`], and when the file grows beyond the limit while it is read.
pub fn read(path: &Path, limit: u64) -> Result<Vec<u8>, Error> {
    let file = open(path, limit)?;
    let bytes = read_stream(path, file, limit)?;
    tracing::debug!(file = %path.display(), bytes = bytes.len(), "read");
    Ok(bytes)
}

/// Opens the regular file at `path`, which has at most `limit` bytes.
///
/// # Errors
/// When there is no such file, it is a folder, pipe or device, it is larger, or the system refuses.
pub fn open(path: &Path, limit: u64) -> Result<File, Error> {
    let meta = std::fs::metadata(path).map_err(|e| failed(path, &e))?;
    if meta.is_dir() {
        let remedy = "name a file inside it";
        return Err(Error::new(ErrorKind::Io, path, "this is a folder, not a file", remedy));
    }
    if !meta.is_file() {
        let remedy = "pipes and devices may never end: copy the data to a file first";
        return Err(Error::new(ErrorKind::Io, path, "this is not a regular file", remedy));
    }
    if meta.len() > limit {
        return Err(too_large(path, &format!("the file has {} bytes", meta.len()), limit));
    }
    File::open(path).map_err(|e| failed(path, &e))
}

/// All that `stream` gives, at most `limit` bytes. Errors call it `name`.
///
/// # Errors
/// When it gives more, or cannot be read.
pub fn read_stream(name: &Path, stream: impl Read, limit: u64) -> Result<Vec<u8>, Error> {
    let mut bytes = Vec::new();
    stream.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(|e| failed(name, &e))?;
    match bytes.len() as u64 > limit {
        true => Err(too_large(name, "it has too many bytes", limit)),
        false => Ok(bytes),
    }
}

fn too_large(path: &Path, has: &str, limit: u64) -> Error {
    let message = format!("{has}, more than the {limit} this reader accepts");
    Error::new(ErrorKind::TooLarge, path, message, "simplify it, or split it into several files")
}

pub(crate) fn failed(path: &Path, error: &io::Error) -> Error {
    let remedy = match error.kind() {
        io::ErrorKind::NotFound => {
            let message = "cannot read the file: no such file";
            return Error::new(ErrorKind::Missing, path, message, missing_remedy(path));
        }
        io::ErrorKind::PermissionDenied => "make the file readable for you".to_owned(),
        _ => "copy the file to a disk of this machine, and read it there".to_owned(),
    };
    Error::io(path, "read the file", error, remedy)
}

/// What to do when there is no file at `path`.
fn missing_remedy(path: &Path) -> String {
    let folder = folder_of(path);
    if !folder.is_dir() {
        return format!("the folder {} does not exist", folder.display());
    }
    if path.to_string_lossy().contains('\\') && !cfg!(windows) {
        return "folders in file names are separated by `/`".to_owned();
    }
    format!("check the spelling; it is looked for in the folder {}", folder.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_a_small_regular_file_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.off");
        let missing = read(&path, 10).unwrap_err();
        assert_eq!(missing.kind(), ErrorKind::Missing);
        assert!(missing.remedy().starts_with("check the spelling"), "{}", missing.remedy());
        assert!(read(dir.path(), 10).unwrap_err().to_string().contains("this is a folder"));
        std::fs::write(&path, [b' '; 11]).unwrap();
        assert_eq!(read(&path, 10).unwrap_err().kind(), ErrorKind::TooLarge);
        assert_eq!(read(&path, 11).unwrap().len(), 11);
        assert_eq!(
            read_stream(Path::new("s"), [0; 11].as_slice(), 10).unwrap_err().kind(),
            ErrorKind::TooLarge
        );
        assert_eq!(read_stream(Path::new("s"), [0; 10].as_slice(), 10).unwrap().len(), 10);
    }

    /// A named pipe that nobody writes to: opening it would wait for ever.
    #[test]
    #[cfg(unix)]
    fn pipes_and_devices_are_refused_without_opening_them() {
        let dir = tempfile::tempdir().unwrap();
        let pipe = dir.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        if made.is_ok_and(|status| status.success()) {
            assert!(read(&pipe, 10).unwrap_err().to_string().contains("not a regular file"));
        }
        assert!(read(Path::new("/dev/zero"), 10).unwrap_err().to_string().contains("not a regular file"));
    }
}
