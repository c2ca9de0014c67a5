//! Parts of an experiment that were measured elsewhere.

use crate::error::{IntoError, Result};
use mp_batch::Shard;
use mp_plan::Error;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The file in a folder for results that says which shard is there.
const FILE: &str = "shard.json";
/// The largest file of it that is read, bytes.
const MAX_BYTES: u64 = 1 << 20;
/// The largest log that is read, bytes (1 GiB).
const MAX_LOG_BYTES: u64 = 1 << 30;

/// What is in a folder of a shard.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ShardFile {
    /// The version of the program.
    program: String,
    /// What was measured, and how.
    command: String,
    shard: Shard,
    complete: bool,
}

impl ShardFile {
    pub(crate) fn new(command: &str, shard: Shard, complete: bool) -> Self {
        let program = env!("CARGO_PKG_VERSION").to_owned();
        Self { program, command: command.to_owned(), shard, complete }
    }

    /// Writes it into the folder.
    pub(crate) fn write(&self, folder: &Path) -> Result<()> {
        let text = serde_json::to_string_pretty(self).into_error()? + "\n";
        mp_plan::write_file(&folder.join(FILE), text.as_bytes())
    }

    /// Says that the folder is that of a shard, which is not complete yet.
    pub(crate) fn begin(folder: &Path, command: &str, shard: Shard) -> Result<()> {
        let new = Self::new(command, shard, false);
        mp_store::make_folder(folder)?;
        match Self::read(folder)? {
            Some(old) if old.is_of_one_command(&new) && old.shard == shard => Ok(()),
            Some(old) => {
                let message = format!("{} has shard {} of `{}`", folder.display(), old.shard, old.command);
                Err(Error::new(message).help("measure into another folder: --out DIR"))
            }
            None => new.write(folder),
        }
    }

    /// That in a folder; `None` when there is none.
    pub(crate) fn read(folder: &Path) -> Result<Option<Self>> {
        let file = folder.join(FILE);
        if !file.exists() {
            return Ok(None);
        }
        let bytes = mp_store::read(&file, MAX_BYTES)?;
        let read = serde_json::from_slice(&bytes);
        read.map(Some).map_err(|e| {
            Error::new(format!("{} is no description of a shard: {e}", file.display()))
                .help("measure the shard again into an empty folder")
        })
    }

    /// Whether a folder with `other` goes on with this one.
    fn is_of_one_command(&self, other: &Self) -> bool {
        (&self.program, &self.command) == (&other.program, &other.command)
    }
}

/// The lines of the logs in the folders of all shards of `command`, by the names of the logs.
///
/// # Errors
/// When a shard is missing, doubled, not complete, or of another command or version: which one.
pub(crate) fn merged(folders: &[PathBuf], command: &str) -> Result<Vec<(String, String)>> {
    let mut found: Vec<(Shard, &PathBuf)> = Vec::new();
    for folder in folders {
        let name = folder.display();
        let Some(file) = ShardFile::read(folder)? else {
            return Err(Error::new(format!("{name} has no shard"))
                .help("give the folders of `--out` of the runs with --shard"));
        };
        let again = |what: String| {
            Error::new(format!("{name} {what}")).help(format!("measure it again with --shard {}", file.shard))
        };
        let wanted = ShardFile::new(command, file.shard, true);
        if file.program != wanted.program {
            return Err(again(format!(
                "is of version {} of the program, not {}",
                file.program, wanted.program
            )));
        }
        if !file.is_of_one_command(&wanted) {
            return Err(again(
                "was measured by another command, with another suite or other options".to_owned(),
            ));
        }
        if !file.complete {
            return Err(Error::new(format!("shard {} in {name} is not complete", file.shard))
                .help("run its command again: it goes on"));
        }
        let of = found.first().map_or(file.shard.of(), |(shard, _)| shard.of());
        if file.shard.of() != of {
            return Err(Error::new(format!("{name} is shard {}, and others are of {of}", file.shard))
                .help("give the shards of one cut"));
        }
        if let Some((_, other)) = found.iter().find(|(shard, _)| *shard == file.shard) {
            let message = format!("shard {} is given twice, in {} and {name}", file.shard, other.display());
            return Err(Error::new(message).help("leave one out"));
        }
        found.push((file.shard, folder));
    }
    found.sort_by_key(|(shard, _)| shard.index());
    let of = found.first().map_or(1, |(shard, _)| shard.of());
    if let Some(missing) = (1..=of).find(|i| found.iter().all(|(shard, _)| shard.index() != *i)) {
        return Err(Error::new(format!("shard {missing}/{of} is missing"))
            .help(format!("measure it with --shard {missing}/{of}")));
    }
    let mut logs: Vec<(String, String)> = Vec::new();
    for (_, folder) in found {
        for (name, text) in logs_in(folder)? {
            match logs.iter_mut().find(|(known, _)| *known == name) {
                Some((_, all)) => all.push_str(&text),
                None => logs.push((name, text)),
            }
        }
    }
    Ok(logs)
}

/// Begins a folder for results with [merged] logs.
///
/// # Errors
/// When the folder has other logs of these names.
pub(crate) fn begin(folder: &Path, logs: &[(String, String)]) -> Result<()> {
    mp_store::make_folder(folder)?;
    for (name, text) in logs {
        let file = folder.join(name);
        if file.exists() {
            // What was merged before, and maybe gone on with.
            let there = mp_store::read(&file, MAX_LOG_BYTES)?;
            if there.starts_with(text.as_bytes()) {
                continue;
            }
            let message = format!("{} has other results", file.display());
            return Err(Error::new(message).help("merge into an empty folder: --out DIR"));
        }
        mp_plan::write_file(&file, text.as_bytes())?;
    }
    Ok(())
}

/// The logs in a folder, in the order of their names.
fn logs_in(folder: &Path) -> Result<Vec<(String, String)>> {
    let entries = std::fs::read_dir(folder).doing(|| format!("cannot list {}", folder.display()))?;
    let mut names: Vec<String> =
        entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
    names.retain(|name| name.ends_with("-runs.jsonl"));
    names.sort();
    let read = |name: String| {
        let bytes = mp_store::read(&folder.join(&name), MAX_LOG_BYTES)?;
        Ok((name, String::from_utf8_lossy(&bytes).into_owned()))
    };
    names.into_iter().map(read).collect()
}
