//! Files: bounded reading, decoding, atomic writing.

use crate::error::{Error, ErrorKind};
use std::fmt::{self, Debug};
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// The largest mesh file that is read, bytes (512 MiB).
pub const MAX_MESH_BYTES: u64 = 512 << 20;
/// The largest scene, problem or path file that is read, bytes (64 MiB).
pub const MAX_TEXT_BYTES: u64 = 64 << 20;

/// A place to read files from: the [`Disk`], or memory.
pub trait Files: Debug + Send + Sync {
    /// The content of the file at `path`, at most `limit` bytes.
    ///
    /// # Errors
    /// [`Error`] of kind [`ErrorKind::Io`] when there is no such file, of kind [`ErrorKind::TooLarge`] when it is larger.
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, Error>;

    /// Whether there is a file at `path`.
    fn holds(&self, path: &Path) -> bool {
        self.read(path, MAX_MESH_BYTES).is_ok()
    }

    /// A folder by its absolute name, as far as that is known: meshes of packages are sought in all folders above it.
    ///
    /// # Errors
    /// When the place knows absolute names, and there is no such folder.
    fn absolute(&self, folder: &Path) -> std::io::Result<PathBuf> {
        Ok(folder.to_owned())
    }
}

/// The file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, Error> {
        read_file(path, limit)
    }
    fn holds(&self, path: &Path) -> bool {
        path.is_file()
    }
    fn absolute(&self, folder: &Path) -> std::io::Result<PathBuf> {
        // A bare file name has the empty folder, which is the current one.
        std::fs::canonicalize(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })
    }
}

/// Files in memory: the function gives the content at a path whose parts are separated by `/`, and resolves `..`.
#[derive(Clone, Copy)]
pub struct InMemory<F>(pub F);

impl<F> Debug for InMemory<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("InMemory")
    }
}

impl<F: Fn(&str) -> Option<B> + Send + Sync, B: AsRef<[u8]>> Files for InMemory<F> {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, Error> {
        let name = path.to_string_lossy().replace('\\', "/");
        match (self.0)(&name) {
            Some(bytes) if bytes.as_ref().len() as u64 <= limit => Ok(bytes.as_ref().to_vec()),
            Some(bytes) => {
                let length = bytes.as_ref().len();
                let message = format!("the file has {length} bytes, more than the {limit} accepted");
                Err(Error::new(ErrorKind::TooLarge, name, message)
                    .help("simplify the mesh or split the file"))
            }
            None => {
                Err(Error::new(ErrorKind::Io, name, "cannot read the file: there is no such file in memory")
                    .help("check the spelling"))
            }
        }
    }
}

/// Reads a regular file of at most `limit` bytes.
pub(crate) fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, Error> {
    let meta = std::fs::metadata(path).map_err(|e| {
        let error = Error::io(path, "read the file", &e);
        if e.kind() == std::io::ErrorKind::NotFound { error.help(missing_help(path)) } else { error }
    })?;
    if meta.is_dir() {
        return Err(Error::new(ErrorKind::Io, path.display(), "this is a folder, not a file")
            .help("name a file inside it"));
    }
    if !meta.is_file() {
        return Err(Error::new(ErrorKind::Io, path.display(), "this is not a regular file")
            .help("pipes and devices may never end: copy the data to a file first"));
    }
    let too_large = |size: u64| {
        Error::new(
            ErrorKind::TooLarge,
            path.display(),
            format!("the file has {size} bytes, more than the {limit} this reader accepts"),
        )
        .help("simplify the mesh or split the file")
    };
    if meta.len() > limit {
        return Err(too_large(meta.len()));
    }
    let failed = |e: std::io::Error| {
        let error = Error::io(path, "read the file", &e);
        if e.kind() == std::io::ErrorKind::PermissionDenied {
            error.help("make the file readable for you")
        } else {
            error
        }
    };
    let mut bytes = Vec::new();
    File::open(path).map_err(failed)?.take(limit + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > limit {
        return Err(too_large(bytes.len() as u64));
    }
    tracing::debug!(file = %path.display(), bytes = bytes.len(), "read");
    Ok(bytes)
}

/// Reads a text file of at most [`MAX_TEXT_BYTES`]; returns the name that errors call it, and its bytes.
///
/// # Errors
/// [`Error`] when it cannot be read or is not a regular file.
pub fn read_text(path: &Path) -> Result<(String, Vec<u8>), Error> {
    Ok((path.display().to_string(), read_file(path, MAX_TEXT_BYTES)?))
}

/// The name of a file, without folders and extension.
pub(crate) fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned())
}

/// What to do when there is no file at `path`.
fn missing_help(path: &Path) -> String {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return format!("the folder {} does not exist", folder.display());
    }
    if path.to_string_lossy().contains('\\') && !cfg!(windows) {
        return "folders in file names are separated by `/`".to_owned();
    }
    format!("check the spelling; it is looked for in the folder {}", folder.display())
}

/// `bytes` as UTF-8, without a byte order mark.
pub(crate) fn decode<'a>(file: &str, bytes: &'a [u8]) -> Result<&'a str, Error> {
    let body = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = std::str::from_utf8(body).map_err(|e| {
        let good = std::str::from_utf8(&body[..e.valid_up_to()]).unwrap_or_default();
        let byte = body.get(e.valid_up_to()).copied().unwrap_or_default();
        let end = good.len();
        Error::at(ErrorKind::Format, file, good, end, 0, format!("byte 0x{byte:02x} is not UTF-8 text"))
            .expected("a text file")
            .help("save the file as UTF-8; a binary or UTF-16 file cannot be read here")
    })?;
    match text.find('\0') {
        None => Ok(text),
        Some(at) => {
            Err(Error::at(ErrorKind::Format, file, text, at, 1, "a zero byte: this is not UTF-8 text".into())
                .expected("a text file")
                .help("save the file as UTF-8; a binary or UTF-16 file cannot be read here"))
        }
    }
}

/// Writes `content` to `path` in one step: into a temporary file in the same folder, which is then renamed, so that a
/// reader sees the old file or the whole new one, and a failure leaves nothing behind.
///
/// # Errors
/// [`Error`] of kind [`ErrorKind::Io`] when the folder is missing or not writable or the disk is full.
pub fn write_atomic(path: &Path, content: &[u8]) -> Result<(), Error> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let fail = |doing: &str, e: &std::io::Error| {
        let error = Error::io(path, doing, e);
        match e.kind() {
            std::io::ErrorKind::NotFound => error.help(format!("create the folder {}", folder.display())),
            std::io::ErrorKind::PermissionDenied => {
                error.help(format!("make the folder {} writable, or write elsewhere", folder.display()))
            }
            _ => error,
        }
    };
    match std::fs::metadata(path) {
        Ok(m) if m.is_dir() => {
            return Err(Error::new(ErrorKind::Io, path.display(), "cannot write the file: this is a folder")
                .help("name a file inside it"));
        }
        // Renaming would replace the device or pipe itself.
        Ok(m) if !m.is_file() => {
            let message = "cannot write the file: this is a device or a pipe";
            return Err(Error::new(ErrorKind::Io, path.display(), message).help("name a regular file"));
        }
        _ => {}
    }
    // A link stays a link: its target is replaced.
    let target = if path.is_symlink() {
        std::fs::canonicalize(path).map_err(|e| fail("write the file", &e))?
    } else {
        path.to_owned()
    };
    let folder = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".mp-").suffix(".tmp");
    #[cfg(unix)]
    {
        // The permissions that `File::create` gives; the umask of the process still applies.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder).map_err(|e| fail("write the file", &e))?;
    file.write_all(content).map_err(|e| fail("write the file", &e))?;
    file.as_file().sync_all().map_err(|e| fail("write the file", &e))?;
    file.persist(&target).map_err(|e| fail("write the file", &e.error))?;
    tracing::debug!(file = %path.display(), bytes = content.len(), "written");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writing_is_all_or_nothing() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.txt");
        write_atomic(&path, b"one").unwrap();
        write_atomic(&path, b"two").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"two");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
        let e = write_atomic(&dir.path().join("missing/a.txt"), b"x").unwrap_err();
        assert!(e.remedy().unwrap().starts_with("create the folder"));
        assert_eq!(write_atomic(dir.path(), b"x").unwrap_err().kind(), ErrorKind::Io);
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[test]
    #[cfg(unix)]
    fn links_stay_links_and_devices_stay_devices() {
        let dir = tempfile::tempdir().unwrap();
        let (file, link) = (dir.path().join("a.txt"), dir.path().join("link"));
        std::fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_atomic(&link, b"new").unwrap();
        assert!(link.is_symlink());
        assert_eq!(std::fs::read(&file).unwrap(), b"new");
        std::os::unix::fs::symlink("/dev/null", dir.path().join("null")).unwrap();
        let e = write_atomic(&dir.path().join("null"), b"x").unwrap_err();
        assert!(e.message().contains("device"));
    }

    #[test]
    fn what_is_not_a_small_regular_file_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.off");
        assert!(
            read_file(&path, 10).unwrap_err().to_string().ends_with("cannot read the file: no such file")
        );
        assert!(read_file(dir.path(), 10).unwrap_err().to_string().contains("this is a folder"));
        std::fs::write(&path, [b' '; 11]).unwrap();
        assert_eq!(read_file(&path, 10).unwrap_err().kind(), ErrorKind::TooLarge);
        assert_eq!(read_file(&path, 11).unwrap().len(), 11);
        #[cfg(target_os = "linux")]
        assert!(
            read_file(Path::new("/dev/zero"), 10).unwrap_err().to_string().contains("not a regular file")
        );
    }

    #[test]
    fn a_byte_order_mark_is_skipped_and_other_bytes_are_placed() {
        assert_eq!(decode("f", b"\xef\xbb\xbfOFF").unwrap(), "OFF");
        let e = decode("f", b"OFF\n# caf\xe9\n").unwrap_err();
        assert_eq!((e.line(), e.column()), (Some(2), Some(6)));
        assert!(decode("f", b"\xff\xfeO\0F\0").is_err());
    }
}
