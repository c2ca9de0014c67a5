//! Temporary files in the folder of the file that they become, and sweeping up those that a killed process
//! left.

use std::fs::{File, OpenOptions};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io;
use std::path::{Path, PathBuf};

/// The names of temporary files: this, sixteen random hexadecimal digits, [`ENDING`]. Names are not used
/// twice.
const BEGINNING: &str = ".mp-";
const ENDING: &str = ".tmp";

/// The most entries of a folder that are looked at for left-over files.
const LISTED: usize = 10_000;

/// A temporary file. It is locked as long as it is open, which says that it is in use, and removed when it is
/// dropped.
#[derive(Debug)]
pub(crate) struct Temporary {
    pub(crate) file: File,
    path: PathBuf,
    renamed: bool,
}

impl Temporary {
    /// A new empty file in `folder`.
    pub(crate) fn new_in(folder: &Path) -> io::Result<Self> {
        loop {
            let number = RandomState::new().build_hasher().finish();
            let path = folder.join(format!("{BEGINNING}{number:016x}{ENDING}"));
            let file = match OpenOptions::new().read(true).write(true).create_new(true).open(&path) {
                Ok(file) => file,
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => continue,
                Err(e) => return Err(e),
            };
            // Another process may take the new file for a left-over one, lock it and remove it.
            match file.try_lock() {
                Err(std::fs::TryLockError::WouldBlock) => continue,
                // A file system without locks: nobody can sweep it up.
                Err(std::fs::TryLockError::Error(_)) => {}
                Ok(()) if !path.exists() => continue,
                Ok(()) => {}
            }
            return Ok(Self { file, path, renamed: false });
        }
    }

    /// Another name for the file at `path`, in its folder, which keeps it when that is replaced.
    pub(crate) fn of(path: &Path) -> io::Result<Self> {
        let kept = Self::new_in(crate::write::folder_of(path))?;
        // The name is only ours, and free in between.
        std::fs::remove_file(&kept.path)?;
        std::fs::hard_link(path, &kept.path)?;
        Ok(kept)
    }

    /// Gives it the name `target`, in the same folder, in place of the file that may be there.
    pub(crate) fn rename(mut self, target: &Path) -> io::Result<()> {
        std::fs::rename(&self.path, target)?;
        self.renamed = true;
        Ok(())
    }

    /// Gives it the name `target`, in the same folder, which no file may have: not even since somebody looked, where the file system has links.
    pub(crate) fn name_anew(self, target: &Path) -> io::Result<()> {
        match std::fs::hard_link(&self.path, target) {
            Err(e) if e.kind() != io::ErrorKind::AlreadyExists => self.rename(target),
            linked => linked,
        }
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.renamed {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Removes the temporary files in `folder` that no process uses any more.
pub(crate) fn sweep(folder: &Path) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().take(LISTED);
    let left = entries.filter(|entry| {
        is_temporary(&entry.file_name().to_string_lossy())
            && entry.file_type().is_ok_and(|kind| kind.is_file())
    });
    for entry in left {
        let path = entry.path();
        if let Ok(file) = OpenOptions::new().read(true).write(true).open(&path)
            && file.try_lock().is_ok()
            && std::fs::remove_file(&path).is_ok()
        {
            tracing::debug!(file = %path.display(), "removed a left-over temporary file");
        }
    }
}

fn is_temporary(name: &str) -> bool {
    let digits = name.strip_prefix(BEGINNING).and_then(|rest| rest.strip_suffix(ENDING));
    digits.is_some_and(|digits| digits.len() == 16 && digits.bytes().all(|b| b.is_ascii_hexdigit()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_in_use_are_not_swept_up() {
        let dir = tempfile::tempdir().unwrap();
        let used = Temporary::new_in(dir.path()).unwrap();
        let left = dir.path().join(".mp-0123456789abcdef.tmp");
        let other = dir.path().join(".mp-notes.tmp");
        for file in [&left, &other] {
            std::fs::write(file, "half").unwrap();
        }
        sweep(dir.path());
        assert_eq!((left.exists(), other.exists(), used.path.exists()), (false, true, true));
        let path = used.path.clone();
        drop(used);
        assert!(!path.exists());
    }

    /// Threads that write and sweep in one folder do not take each other's files.
    #[test]
    fn many_writers_and_sweepers_do_not_disturb_each_other() {
        let dir = tempfile::tempdir().unwrap();
        let write = |k: usize| {
            for i in 0..200 {
                sweep(dir.path());
                let new = Temporary::new_in(dir.path()).unwrap();
                new.rename(&dir.path().join(format!("{k}-{}", i % 3))).unwrap();
            }
        };
        std::thread::scope(|scope| {
            (0..4).for_each(|k| {
                scope.spawn(move || write(k));
            });
        });
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 12);
    }
}
