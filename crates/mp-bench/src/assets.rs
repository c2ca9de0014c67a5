//! `assets`: generates the shipped scenes and the list of their files, or checks that they are up to date.

use crate::error::{IntoError, Result};
use crate::output::note;
use clap::Args;
use mp_plan::write_file;
use mp_scenes::source::{Files, files_rs, generate, stale};
use std::path::{Path, PathBuf};

/// The options of `assets` alone.
#[derive(Clone, Debug, Default, Args)]
#[group(skip)]
#[command(next_help_heading = "Of `assets`")]
pub(crate) struct Options {
    /// Write nothing; exit 0 only if every file is there and identical.
    #[arg(long)]
    check: bool,
    /// The folder of the crate to write or check: scenes are in `assets`, their list is `src/files.rs`
    /// [default: the crate mp-scenes of the workspace].
    #[arg(long = "crate-dir", value_name = "DIR")]
    dir: Option<PathBuf>,
}

/// Writes all files that differ, or checks them. True when files were written or none differs.
pub(crate) fn run(options: &Options) -> Result<bool> {
    let own = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../mp-scenes");
    let folder = options.dir.clone().unwrap_or_else(own);
    let made = generate();
    let table = ("src/files.rs".to_owned(), files_rs(&made).into_bytes());
    let files: Files =
        made.into_iter().map(|(path, bytes)| (format!("assets/{path}"), bytes)).chain([table]).collect();
    let stale = stale(&folder, &files).into_error()?;
    for path in &stale {
        match options.check {
            true => note(&format!("{} is missing or differs", folder.join(path).display())),
            false => write_file(&folder.join(path), &files[*path])?,
        }
    }
    let done = if options.check { "differ" } else { "written" };
    note(&format!("{} of {} files {done}", stale.len(), files.len()));
    Ok(!options.check || stale.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_written_is_the_same_when_checked() {
        let folder = tempfile::tempdir().unwrap();
        let dir = Some(folder.path().to_owned());
        assert!(!run(&Options { check: true, dir: dir.clone() }).unwrap());
        assert!(run(&Options { check: false, dir: dir.clone() }).unwrap());
        assert!(run(&Options { check: true, dir: dir.clone() }).unwrap());
        std::fs::write(folder.path().join("src/files.rs"), "").unwrap();
        assert!(!run(&Options { check: true, dir }).unwrap());
    }
}
