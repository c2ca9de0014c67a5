//! Results on the disk, so that a job that was killed goes on.

use crate::Error;
use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use mp_store::{Journal, Lock};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::xxh3_64;

/// The largest checkpoint that is read, bytes (16 GiB).
const MAX_BYTES: u64 = 1 << 34;

/// The results of a job that are known, in a file that grows by a line for each: its item, a checksum, and
/// its bytes as base64. The first line says which job it is.
///
/// A process that is killed loses nothing that was kept.
#[derive(Debug)]
pub struct Checkpoint {
    file: PathBuf,
    journal: Journal,
    known: HashMap<u64, Vec<u8>>,
    /// Two jobs must not write into one file.
    _lock: Lock,
}

impl Checkpoint {
    /// Opens the checkpoint in `file`, or begins it. `job` says in a line which job it is: everything that
    /// its results depend on, best as hashes. An incomplete last line is dropped. A file of anything else is left as it is.
    ///
    /// # Errors
    /// When the file is in use, cannot be read or written, is damaged, or is that of another job.
    pub fn open(file: &Path, job: &str) -> Result<Self, Error> {
        let lock = Lock::of_file(file)?;
        let refused = |message: String, remedy: &str| Error::Checkpoint {
            file: file.display().to_string(),
            message,
            remedy: remedy.to_owned(),
        };
        let head = format!("mp-ranks checkpoint 1: {}", job.replace(['\n', '\r'], " "));
        let bytes = if file.exists() { mp_store::read(file, MAX_BYTES)? } else { Vec::new() };
        let text = String::from_utf8_lossy(&bytes);
        let first = text.lines().next().unwrap_or_default().trim_end();
        // The first line may be torn as well, if it is the beginning of that of this job.
        if first != head && !head.as_bytes().starts_with(&bytes) {
            let message = format!("it belongs to another job, `{}`", shortened(first));
            return Err(refused(message, "delete it, or name another file"));
        }
        let mut known = HashMap::new();
        let whole = text.split_inclusive('\n').filter(|line| line.ends_with('\n')).enumerate().skip(1);
        for (number, line) in whole {
            let Some((item, result)) = read_line(line.trim_end_matches('\n')) else {
                let message = format!("line {} is damaged", number + 1);
                return Err(refused(message, "delete that line, whose item is then done again"));
            };
            known.insert(item, result);
        }
        let end = text.rfind('\n').map_or(0, |end| end + 1);
        let kept = if end == 0 { format!("{head}\n") } else { text[..end].to_owned() };
        Ok(Self { file: file.to_owned(), journal: Journal::create(file, &kept)?, known, _lock: lock })
    }

    /// The results that were kept before.
    #[must_use]
    pub fn known(&self) -> &HashMap<u64, Vec<u8>> {
        &self.known
    }

    /// Keeps the result of an item.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn keep(&self, item: u64, result: &[u8]) -> Result<(), Error> {
        Ok(self.journal.append(&line(item, result))?)
    }

    /// Deletes the file, when everything is done.
    ///
    /// # Errors
    /// When it cannot be deleted.
    pub fn delete(self) -> Result<(), Error> {
        let file = self.file.clone();
        drop(self);
        std::fs::remove_file(&file).map_err(|e| Error::Checkpoint {
            file: file.display().to_string(),
            message: format!("cannot delete the file: {e}"),
            remedy: "delete it: the job is done".to_owned(),
        })
    }
}

fn line(item: u64, result: &[u8]) -> String {
    format!("{item} {:016x} {}", checksum(item, result), BASE64.encode(result))
}

fn read_line(line: &str) -> Option<(u64, Vec<u8>)> {
    let mut words = line.split(' ');
    let item = words.next()?.parse().ok()?;
    let sum = u64::from_str_radix(words.next()?, 16).ok()?;
    let result = BASE64.decode(words.next()?).ok()?;
    (words.next().is_none() && checksum(item, &result) == sum).then_some((item, result))
}

fn checksum(item: u64, result: &[u8]) -> u64 {
    xxh3_64(result) ^ item.wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

fn shortened(text: &str) -> String {
    let start: String = text.chars().filter(|c| !c.is_control()).take(80).collect();
    if start.len() < text.len() { format!("{start}…") } else { start }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_kept_and_a_torn_line_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("job");
        let open = || Checkpoint::open(&file, "squares of 10 numbers");
        let first = open().unwrap();
        assert!(first.known().is_empty());
        first.keep(7, b"forty-nine").unwrap();
        first.keep(1, b"").unwrap();
        drop(first);
        let text = std::fs::read_to_string(&file).unwrap();
        for cut in 0..text.len() {
            std::fs::write(&file, &text[..cut]).unwrap();
            let known = open().unwrap().known().clone();
            assert_eq!(known.len(), text[..cut].matches('\n').count().saturating_sub(1), "{cut}");
        }
        std::fs::write(&file, &text).unwrap();
        assert_eq!(open().unwrap().known()[&7], b"forty-nine");
        open().unwrap().delete().unwrap();
        assert!(!file.exists());
    }

    #[test]
    fn what_is_damaged_or_another_job_s_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("job");
        Checkpoint::open(&file, "one").unwrap().keep(3, b"abc").unwrap();
        let e = Checkpoint::open(&file, "two").unwrap_err().to_string();
        assert!(e.contains("another job") && e.contains("one") && e.contains("delete"), "{e}");
        for foreign in [b"password=hunter2".as_slice(), b"mp-ranks checkpoint 1: two", b"\n", b" ", b"\xff"] {
            let other = folder.path().join("other");
            std::fs::write(&other, foreign).unwrap();
            let e = Checkpoint::open(&other, "one").unwrap_err().to_string();
            assert!(e.contains("another job") && std::fs::read(&other).unwrap() == foreign, "{e}");
        }
        let text = std::fs::read_to_string(&file).unwrap();
        for damage in [text.replace("3 ", "4 "), text.replace("YWJj", "YWJk"), text.replace("3 ", "x ")] {
            std::fs::write(&file, &damage).unwrap();
            let e = Checkpoint::open(&file, "one").unwrap_err().to_string();
            assert!(e.contains("line 2 is damaged"), "{e}");
        }
        std::fs::write(&file, &text).unwrap();
        let held = Checkpoint::open(&file, "one").unwrap();
        assert!(Checkpoint::open(&file, "one").is_err());
        drop(held);
    }
}
