//! The error of this crate: which file, what is wrong, and what to do about it.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// What kind of thing went wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// There is no such file or folder.
    Missing,
    /// Another process has the lock.
    Locked,
    /// The file is larger than the limit.
    TooLarge,
    /// It is a folder, a device or a pipe, or the system refuses.
    Io,
}

/// A file that cannot be used: which one, what is wrong, and a remedy.
#[derive(Clone, Debug)]
pub struct Error {
    kind: ErrorKind,
    path: PathBuf,
    message: String,
    remedy: String,
}

impl Error {
    pub(crate) fn new(
        kind: ErrorKind,
        path: &Path,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self { kind, path: path.to_owned(), message: message.into(), remedy: remedy.into() }
    }

    /// An error of the system about `path`; `doing` completes "cannot …".
    pub(crate) fn io(path: &Path, doing: &str, error: &io::Error, remedy: impl Into<String>) -> Self {
        let (kind, why) = match error.kind() {
            io::ErrorKind::NotFound => (ErrorKind::Missing, "no such folder".to_owned()),
            io::ErrorKind::PermissionDenied => (ErrorKind::Io, "permission denied".to_owned()),
            io::ErrorKind::StorageFull => (ErrorKind::Io, "the disk is full".to_owned()),
            _ => (ErrorKind::Io, error.to_string()),
        };
        Self::new(kind, path, format!("cannot {doing}: {why}"), remedy)
    }

    /// An error of the system while the file at `path` is read: for those who read what [`open`](crate::open)
    /// opened.
    #[must_use]
    pub fn reading(path: &Path, error: &io::Error) -> Self {
        crate::read::failed(path, error)
    }

    /// What kind of thing went wrong.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// The file, as it was named.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What is wrong, without the file.
    #[must_use]
    pub fn message(&self) -> &str {
        &self.message
    }

    /// What to do about it.
    #[must_use]
    pub fn remedy(&self) -> &str {
        &self.remedy
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.message)
    }
}

impl std::error::Error for Error {}
