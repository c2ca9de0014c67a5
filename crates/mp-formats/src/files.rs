//! Files: where readers find them, and their bytes as text.

use crate::error::{Error, ErrorKind};
use mp_stop::Interrupt;
use std::fmt::{self, Debug};
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

    /// What readers ask whether to end; by default nothing ends them.
    fn interrupt(&self) -> Interrupt {
        Interrupt::never()
    }

    /// Takes a remark of a reader on the file at `path`, a few words for people: what was decided or passed over there. By
    /// default nobody hears it.
    fn note(&self, _path: &Path, _remark: &str) {}

    /// Takes a remark that is for all who use the file, as something in it is wrong most likely. By default a [note](Self::note).
    fn warn(&self, path: &Path, remark: &str) {
        self.note(path, remark);
    }

    /// Whether it only matters which files are read. Then readers of meshes read files as always, and return any small mesh.
    fn only_reads(&self) -> bool {
        false
    }

    /// Whether there is a file at `path`.
    fn holds(&self, path: &Path) -> bool {
        self.read(path, MAX_MESH_BYTES).is_ok()
    }

    /// The names of what is in `folder`, in alphabetical order, as far as that is known: to say what lies beside a file.
    fn names_in(&self, _folder: &Path) -> Vec<String> {
        Vec::new()
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
    fn names_in(&self, folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(current_if_empty(folder)).into_iter().flatten().flatten();
        let names = entries.take(MAX_NAMES).filter_map(|entry| entry.file_name().into_string().ok());
        let mut names: Vec<_> = names.collect();
        names.sort();
        names
    }
    fn absolute(&self, folder: &Path) -> std::io::Result<PathBuf> {
        std::fs::canonicalize(current_if_empty(folder))
    }
}

/// No more names of a folder are looked at.
const MAX_NAMES: usize = 100_000;

/// A bare file name has the empty folder, which is the current one.
fn current_if_empty(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

/// Other files, whose readers end when an [`Interrupt`] says so, with an error of kind [`ErrorKind::Interrupted`].
#[derive(Clone, Debug)]
pub struct Until<'f> {
    /// Where the files come from.
    pub files: &'f dyn Files,
    /// What readers ask.
    pub interrupt: Interrupt,
}

impl Files for Until<'_> {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, Error> {
        if self.interrupt.clone().ask() {
            return Err(Error::interrupted(path.display()));
        }
        self.files.read(path, limit)
    }
    fn interrupt(&self) -> Interrupt {
        self.interrupt.clone()
    }
    fn note(&self, path: &Path, remark: &str) {
        self.files.note(path, remark);
    }
    fn warn(&self, path: &Path, remark: &str) {
        self.files.warn(path, remark);
    }
    fn only_reads(&self) -> bool {
        self.files.only_reads()
    }
    fn holds(&self, path: &Path) -> bool {
        self.files.holds(path)
    }
    fn names_in(&self, folder: &Path) -> Vec<String> {
        self.files.names_in(folder)
    }
    fn absolute(&self, folder: &Path) -> std::io::Result<PathBuf> {
        self.files.absolute(folder)
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
///
/// # Errors
/// When it cannot be read, or is larger.
pub fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, Error> {
    Ok(mp_store::read(path, limit)?)
}

/// Reads a text file of at most [`MAX_TEXT_BYTES`]; returns the name that errors call it, and its bytes.
///
/// # Errors
/// [`Error`] when it cannot be read or is not a regular file.
pub fn read_text(path: &Path) -> Result<(String, Vec<u8>), Error> {
    Ok((path.display().to_string(), read_file(path, MAX_TEXT_BYTES)?))
}

/// The name of a file, without folders and extension.
pub fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned())
}

/// The name that a URI means, in which `%20` and the like stand for bytes; `None` if there are none, or they are no UTF-8.
#[must_use]
pub fn percent_decoded(uri: &str) -> Option<String> {
    let mut parts = uri.split('%');
    let mut bytes = parts.next()?.as_bytes().to_vec();
    for part in parts {
        // `%` alone is itself.
        match part.get(..2).filter(|digits| digits.bytes().all(|b| b.is_ascii_hexdigit())) {
            Some(digits) => {
                bytes.extend(u8::from_str_radix(digits, 16));
                bytes.extend(part[2..].bytes());
            }
            None => bytes.extend(format!("%{part}").bytes()),
        }
    }
    String::from_utf8(bytes).ok().filter(|name| name != uri)
}

/// `bytes` without what old programs write after a text: zero bytes and the end mark of DOS, 0x1a, and blanks among them.
pub(crate) fn without_end_marks(bytes: &[u8]) -> &[u8] {
    let is_mark = |b: &u8| matches!(b, 0 | 0x1a);
    let end = bytes.iter().rposition(|b| !is_mark(b) && !b.is_ascii_whitespace()).map_or(0, |last| last + 1);
    let blanks = bytes[end..].iter().position(is_mark).unwrap_or(bytes.len() - end);
    &bytes[..end + blanks]
}

/// `bytes` as UTF-8, without a byte order mark, and without zero bytes and marks of DOS at its end.
///
/// # Errors
/// When they are not UTF-8.
pub fn decode<'a>(file: &str, bytes: &'a [u8]) -> Result<&'a str, Error> {
    let body = without_end_marks(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_order_mark_is_skipped_and_other_bytes_are_placed() {
        assert_eq!(decode("f", b"\xef\xbb\xbfOFF").unwrap(), "OFF");
        let e = decode("f", b"OFF\n# caf\xe9\n").unwrap_err();
        assert_eq!((e.line(), e.column()), (Some(2), Some(6)));
        assert!(decode("f", b"\xff\xfeO\0F\0").is_err());
        assert!(decode("f", b"O\0F\0F\0").is_err());
    }

    #[test]
    fn uris_mean_names() {
        let of = |uri: &str| percent_decoded(uri);
        assert_eq!(of("my%20mesh/50%25%2cGr%C3%B6%c3%9fe.obj").unwrap(), "my mesh/50%,Größe.obj");
        assert_eq!(of("50%/a%20b%").unwrap(), "50%/a b%");
        assert_eq!(["a.obj", "50% ü.obj", "%", "%ö", "%+f", "a%ff", ""].map(of), [const { None }; 7]);
    }

    #[test]
    fn zero_bytes_and_marks_of_dos_end_a_text() {
        for end in ["", "\0", "\x1a", "\0\0\r\n\x1a\n", "\x1a\0 \0"] {
            assert_eq!(decode("f", format!("OFF\n{end}").as_bytes()).unwrap(), "OFF\n", "{end:?}");
        }
        assert_eq!(decode("f", b"\0").unwrap(), "");
        assert!(decode("f", b"OFF\0OFF").is_err());
    }
}
