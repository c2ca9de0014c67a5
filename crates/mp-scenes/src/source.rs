//! `cargo xtask assets`: regenerates `assets/`, bit for bit. Every scene and mesh the project ships is made
//! here, from constants.
//!
//! A family of scenes is a file; `shape` has the solids they are made of, `scene` turns them into files.

mod alpha;
mod apartment;
mod arm;
mod bugtrap;
pub(crate) mod courses;
mod cubicles;
mod flat;
mod furniture;
mod gempa;
mod piano;
mod scene;
mod shape;
#[cfg(test)]
mod tests;
mod windows;

use crate::output;
use clap::Args;
use miette::{IntoDiagnostic, Result, WrapErr};
use scene::Files;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// What to do with the assets.
#[derive(Clone, Debug, Args)]
pub(crate) struct AssetsArgs {
    /// Write nothing; exit 0 only if every file is there and identical.
    #[arg(long)]
    check: bool,
    /// The folder to write or check [default: `assets` of the workspace].
    #[arg(long, value_name = "DIR")]
    dir: Option<PathBuf>,
}

/// Writes all assets, or checks them: true when nothing differs.
///
/// # Errors
/// When a file cannot be read or written.
pub(crate) fn run(args: &AssetsArgs) -> Result<bool> {
    let folder = args.dir.clone().unwrap_or_else(|| crate::scenes::root().join("assets"));
    let files = generate();
    let stale = stale(&folder, &files)?;
    for (path, bytes) in files.iter().filter(|(path, _)| stale.contains(path)) {
        if args.check {
            output::note(&format!("{} is missing or differs", folder.join(path).display()));
        } else {
            output::write(&folder.join(path), bytes)?;
        }
    }
    let done = if args.check { "differ" } else { "written" };
    output::note(&format!("{} of {} files {done}", stale.len(), files.len()));
    Ok(!args.check || stale.is_empty())
}

/// Every asset, by path relative to the assets folder.
fn generate() -> Files {
    let mut files = Files::new();
    gempa::add(&mut files);
    windows::add(&mut files);
    cubicles::add(&mut files);
    bugtrap::add(&mut files);
    apartment::add(&mut files);
    alpha::add(&mut files);
    flat::add(&mut files);
    arm::add(&mut files);
    courses::add(&mut files);
    files
}

/// The paths of `files` that are missing in `folder` or differ there.
fn stale<'a>(folder: &Path, files: &'a Files) -> Result<Vec<&'a String>> {
    let mut stale = Vec::new();
    for (path, bytes) in files {
        let on_disk = folder.join(path);
        match std::fs::read(&on_disk) {
            Ok(found) if found == *bytes => {}
            Ok(_) => stale.push(path),
            Err(e) if e.kind() == ErrorKind::NotFound => stale.push(path),
            Err(e) => {
                return Err(e)
                    .into_diagnostic()
                    .wrap_err_with(|| format!("cannot read {}", on_disk.display()));
            }
        }
    }
    Ok(stale)
}
