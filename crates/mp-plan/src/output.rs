//! Files that a front end writes.

use crate::Error;
use std::path::Path;

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
