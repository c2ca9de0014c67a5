//! Files that grow by whole lines.

use crate::FileId;
use crate::error::{Error, ErrorKind};
use crate::write::write;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Lines are on the disk at the latest after this time, if the machine loses its power.
const SYNC: Duration = Duration::from_secs(1);

/// A file that grows by whole lines, from several threads. A process that is killed loses no line that was
/// appended; at most the last line of the file is incomplete, and whoever opens the file again drops it.
///
/// Hold a [`Lock`](crate::Lock) on the file or its folder: two processes must not append to one file.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    id: FileId,
    open: Mutex<Open>,
}

#[derive(Debug)]
struct Open {
    file: File,
    synced: Instant,
}

impl Journal {
    /// The journal at `path`, which begins with `lines`, whole lines, in place of what the file held.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn create(path: &Path, lines: &str) -> Result<Self, Error> {
        write(path, lines.as_bytes())?;
        Self::resume(path, lines.len() as u64)
    }

    /// The journal at `path`, which exists, with its first `length` bytes: what is behind them, such as a
    /// line that is not whole, is cut off.
    ///
    /// # Errors
    /// When the file cannot be opened or cut.
    pub fn resume(path: &Path, length: u64) -> Result<Self, Error> {
        let open = || {
            let file = File::options().append(true).open(path)?;
            if file.metadata()?.len() > length {
                file.set_len(length)?;
            }
            Ok(file)
        };
        let file = open().map_err(|e| failed(path, &e))?;
        Ok(Self {
            path: path.to_owned(),
            id: FileId::of(path),
            open: Mutex::new(Open { file, synced: Instant::now() }),
        })
    }

    /// Appends `line`, which has no line break.
    ///
    /// # Errors
    /// When it cannot be written, for example because the disk is full. The file is then as before. And when the file has been deleted or
    /// replaced since it was opened, as nobody would find the line.
    pub fn append(&self, line: &str) -> Result<(), Error> {
        if FileId::of(&self.path) != self.id {
            let remedy = "start again, and leave the file where it is: what it held is lost";
            return Err(Error::new(
                ErrorKind::Io,
                &self.path,
                "the file was deleted or replaced while it grew",
                remedy,
            ));
        }
        let open = &mut *self.open.lock().unwrap_or_else(PoisonError::into_inner);
        let appended = open.append(line);
        appended.map_err(|e| failed(&self.path, &e))
    }
}

impl Open {
    fn append(&mut self, line: &str) -> io::Result<()> {
        let length = self.file.metadata()?.len();
        if let Err(e) = self.file.write_all(format!("{line}\n").as_bytes()) {
            // A line that is cut off must not become the beginning of the next one.
            let _ = self.file.set_len(length);
            return Err(e);
        }
        if self.synced.elapsed() > SYNC {
            self.file.sync_data()?;
            self.synced = Instant::now();
        }
        Ok(())
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        let _ = self.open.get_mut().unwrap_or_else(PoisonError::into_inner).file.sync_data();
    }
}

fn failed(path: &Path, error: &io::Error) -> Error {
    Error::io(path, "append to the file", error, "make room, and start again: the lines before are kept")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_many_threads_stay_whole() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("runs");
        let journal = Journal::create(&path, "first\n").unwrap();
        std::thread::scope(|scope| {
            for k in 0..4 {
                let journal = &journal;
                scope.spawn(move || (0..100).for_each(|i| journal.append(&format!("{k} {i}")).unwrap()));
            }
        });
        let text = std::fs::read_to_string(&path).unwrap();
        let mut lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.remove(0), "first");
        lines.sort_unstable();
        lines.dedup();
        assert_eq!(lines.len(), 400);
        assert!(lines.iter().all(|line| line.split(' ').count() == 2));
    }

    #[cfg(unix)]
    #[test]
    fn a_file_that_is_gone_is_an_error() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("runs");
        let journal = Journal::create(&path, "first\n").unwrap();
        journal.append("second").unwrap();
        // Moved and back it is the same file.
        std::fs::rename(&path, dir.path().join("aside")).unwrap();
        let gone = journal.append("third").unwrap_err();
        assert!(gone.to_string().contains("deleted or replaced"), "{gone}");
        std::fs::rename(dir.path().join("aside"), &path).unwrap();
        journal.append("third").unwrap();
        std::fs::remove_file(&path).unwrap();
        std::fs::write(&path, "first\n").unwrap();
        assert!(journal.append("fourth").is_err());
    }

    #[test]
    fn a_line_that_is_not_whole_is_cut_off() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("runs");
        std::fs::write(&path, "one\ntwo\nthr").unwrap();
        Journal::resume(&path, 8).unwrap().append("three").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "one\ntwo\nthree\n");
        let e = Journal::resume(&dir.path().join("missing"), 0).unwrap_err();
        assert!(e.message().starts_with("cannot append"), "{e}");
    }

    /// A disk that is always full.
    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_an_error_with_a_remedy() {
        let file = File::options().append(true).open("/dev/full").unwrap();
        let open = Mutex::new(Open { file, synced: Instant::now() });
        let journal = Journal { id: FileId::of(Path::new("x")), path: "x".into(), open };
        let e = journal.append("line").unwrap_err();
        assert!(e.message().contains("disk is full") && e.remedy().contains("make room"), "{e}");
    }
}
