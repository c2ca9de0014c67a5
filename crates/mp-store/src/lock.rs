//! Locks: one process at a time grows a file or a folder.

use crate::error::{Error, ErrorKind};
use crate::write::{folder_of, followed};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};

/// The right of this process to grow a file, or the files of a folder. It ends when the lock is dropped or
/// the process ends, however it ends.
///
/// The lock is on a small file of its own beside the file, which holds the number of the process. It binds
/// those who ask for it. Readers need no lock, because files are written whole. On file systems without locks
/// nothing is locked, and the log says so.
#[derive(Debug)]
pub struct Lock {
    #[cfg_attr(not(unix), expect(dead_code, reason = "the file stays"))]
    path: PathBuf,
    file: File,
}

impl Lock {
    /// Locks the file at `path`, which need not exist. Its folder must.
    ///
    /// # Errors
    /// Of kind [`ErrorKind::Locked`] when another process, or another lock of this one, has locked it: the
    /// message has the number of the process. When the folder is missing or not writable.
    pub fn of_file(path: &Path) -> Result<Self, Error> {
        let target = followed(path).map_err(|e| failed(path, &e))?;
        let mut name = std::ffi::OsString::from(".");
        name.push(target.file_name().unwrap_or_default());
        name.push(".lock");
        Self::at(path, folder_of(&target).join(name), "file")
    }

    /// Locks the folder, which must exist: for programs that write several files into it.
    ///
    /// # Errors
    /// As [`of_file`](Self::of_file).
    pub fn of_folder(folder: &Path) -> Result<Self, Error> {
        Self::at(folder, folder.join(".mp.lock"), "folder")
    }

    fn at(named: &Path, path: PathBuf, what: &str) -> Result<Self, Error> {
        loop {
            let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
            let file = file.map_err(|e| failed(named, &e))?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(taken(named, file, what)),
                Err(TryLockError::Error(e)) => {
                    tracing::warn!(file = %named.display(), error = %e, "the file system has no locks");
                    return Ok(Self { path, file });
                }
            }
            // The process that had the lock removes the file: then this is a file without a name, and anew.
            if is_at(&file, &path) {
                let mut lock = Self { path, file };
                lock.sign().map_err(|e| failed(named, &e))?;
                return Ok(lock);
            }
        }
    }

    /// Writes the number of this process into the file.
    fn sign(&mut self) -> io::Result<()> {
        self.file.set_len(0)?;
        self.file.rewind()?;
        writeln!(self.file, "{}", std::process::id())
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Only where it can be told afterwards whether a locked file still has its name.
        #[cfg(unix)]
        let _ = std::fs::remove_file(&self.path);
        let _ = self.file.unlock();
    }
}

/// Whether the open file is the one at `path`.
fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let ids = |meta: std::fs::Metadata| (meta.dev(), meta.ino());
        file.metadata().ok().map(ids) == std::fs::metadata(path).ok().map(ids)
    }
    #[cfg(not(unix))]
    {
        let _ = (file, path);
        true
    }
}

fn taken(path: &Path, mut file: File, what: &str) -> Error {
    let mut number = String::new();
    // Where locks are not only advisory, it cannot be read.
    let _ = Read::by_ref(&mut file).take(20).read_to_string(&mut number);
    let by = match number.trim().parse::<u32>() {
        Ok(number) => format!("process {number}"),
        Err(_) => "another process".to_owned(),
    };
    let remedy = format!("wait until it has ended, or name another {what}");
    Error::new(ErrorKind::Locked, path, format!("the {what} is in use: {by} is writing to it"), remedy)
}

fn failed(path: &Path, error: &io::Error) -> Error {
    let folder = folder_of(path).display();
    Error::io(path, "lock it", error, format!("make sure that the folder {folder} exists and is writable"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_one_has_the_lock() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("x.roadmap");
        let lock = Lock::of_file(&file).unwrap();
        let e = Lock::of_file(&dir.path().join("./x.roadmap")).unwrap_err();
        assert_eq!(e.kind(), ErrorKind::Locked);
        #[cfg(unix)]
        assert!(e.message().contains(&format!("process {}", std::process::id())), "{e}");
        let folder = Lock::of_folder(dir.path()).unwrap();
        assert!(Lock::of_folder(dir.path()).unwrap_err().remedy().contains("another folder"));
        drop((lock, folder));
        drop(Lock::of_file(&file).unwrap());
        #[cfg(unix)]
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0, "nothing is left");
        assert!(Lock::of_file(&dir.path().join("missing/x")).unwrap_err().message().contains("cannot lock"));
    }

    /// A lock file that a killed process left does not lock anything.
    #[test]
    fn what_a_killed_process_left_is_no_lock() {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join(".x.lock"), "123456789\n").unwrap();
        Lock::of_file(&dir.path().join("x")).unwrap();
    }

    /// The file of the lock is removed and made again all the time; still one thread at a time is between.
    #[test]
    fn locks_hold_although_their_files_come_and_go() {
        use std::sync::atomic::{AtomicUsize, Ordering};
        let dir = tempfile::tempdir().unwrap();
        let (inside, entered) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let work = || {
            while entered.load(Ordering::Relaxed) < 2000 {
                let Ok(_lock) = Lock::of_file(&dir.path().join("x")) else { continue };
                assert_eq!(inside.fetch_add(1, Ordering::SeqCst), 0);
                entered.fetch_add(1, Ordering::Relaxed);
                inside.fetch_sub(1, Ordering::SeqCst);
            }
        };
        std::thread::scope(|scope| (0..4).for_each(|_| drop(scope.spawn(work))));
        assert!(entered.load(Ordering::Relaxed) >= 2000);
    }
}
