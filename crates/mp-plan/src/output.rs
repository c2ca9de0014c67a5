//! Files that a front end writes.

use crate::Error;
use mp_store::FileId;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Makes a folder, and those above it, when it is missing.
///
/// # Errors
/// When it cannot be made.
pub fn make_folder(folder: &Path) -> Result<(), Error> {
    Ok(mp_store::make_folder(folder)?)
}

/// Writes `bytes` to `path`, whole or not at all. Makes the folder when it is missing.
///
/// # Errors
/// When the folder or the file cannot be written.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    mp_store::make_folder(mp_store::folder_of(path))?;
    Ok(mp_store::write(path, bytes)?)
}

/// The files of a command: inputs, and outputs that must be none of them, and no other output. Files are compared, not
/// names. [Standard input](is_standard) is no file, and standard output may be that of one option alone, which is not added here.
#[derive(Debug, Default)]
pub struct Claims(HashMap<FileId, Claim>);

#[derive(Debug)]
struct Claim {
    /// What an error calls it: `--out`, `input`.
    what: String,
    path: PathBuf,
    is_input: bool,
}

impl Claims {
    /// Adds a file that is read.
    pub fn input(&mut self, path: &Path) {
        if !is_standard(path) {
            let claim = Claim { what: "input".into(), path: path.to_owned(), is_input: true };
            self.0.insert(FileId::of(path), claim);
        }
    }

    /// Adds a file that will be written; `option` is what errors call it.
    ///
    /// # Errors
    /// When it is an input or another output, is standard output, or could not be written.
    pub fn output(&mut self, option: &str, path: &Path) -> Result<(), Error> {
        if is_standard(path) {
            let message = format!("{option} {}: standard output has other content", path.display());
            return Err(Error::new(message).help("name a file"));
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

/// Whether a name stands for standard input or output: `-`, and what Unix calls them.
#[must_use]
pub fn is_standard(path: &Path) -> bool {
    let unix = ["/dev/stdin", "/dev/stdout", "/dev/fd/0", "/dev/fd/1", "/proc/self/fd/0", "/proc/self/fd/1"];
    path.as_os_str() == "-" || unix.iter().any(|name| path == Path::new(name))
}
