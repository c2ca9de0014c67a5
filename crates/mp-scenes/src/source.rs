//! The code that generates the shipped files, bit for bit: every mesh, and the scenes of those meshes, are made here, from
//! constants. `mp-bench assets` writes them. Scenes and robots without meshes are written by hand, where they are, or by mp-experiments.
//!
//! Each family of scenes is one file here; `shape` has the solids of which they consist, `scene` turns them into files.

mod alpha;
mod apartment;
mod assembly;
mod bugtrap;
mod cubicles;
pub mod disc_scenes;
mod furniture;
mod gempa;
mod key;
mod nut;
mod piano;
mod planar;
mod scene;
mod shape;
mod shelf;
#[cfg(test)]
mod tests;
mod twist;
mod windows;
mod wrench;

pub use scene::Files;
use std::fmt;
use std::io::ErrorKind;
use std::path::Path;

/// An error that says what is wrong in a sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error(String);

impl Error {
    fn new(message: impl fmt::Display) -> Self {
        Self(message.to_string())
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Error {}

/// The files at these paths below the folder `assets`.
macro_rules! by_hand {
    ($($path:literal)*) => {
        [$(($path, include_str!(concat!("../assets/", $path)))),*]
    };
}

/// The files that are written by hand; those called `rsrt-…` by `mp_experiments::clutter`, whose tests compare them.
const BY_HAND: [(&str, &str); 29] = by_hand! {
    "robots/arm-6.urdf"
    "robots/arm-7.urdf"
    "robots/humanoid.srdf"
    "robots/humanoid.urdf"
    "robots/mobile-arm.urdf"
    "robots/rsrt-arm.urdf"
    "robots/six.urdf"
    "robots/wrench.urdf"
    "scenes/accelerations.toml"
    "scenes/arm-6.toml"
    "scenes/arm-7.toml"
    "scenes/arm.toml"
    "scenes/blade.toml"
    "scenes/carry.toml"
    "scenes/crossing.toml"
    "scenes/docks.toml"
    "scenes/flyer.toml"
    "scenes/humanoid.toml"
    "scenes/mobile-arm.toml"
    "scenes/parking.toml"
    "scenes/rsrt-arm-64.toml"
    "scenes/rsrt-flyer-64.toml"
    "scenes/shelf.toml"
    "scenes/tool-pose.toml"
    "scenes/two-arms.toml"
    "scenes/unicycle.toml"
    "scenes/velocities.toml"
    "scenes/warehouse.toml"
    "scenes/wrench.toml"
};

/// Every shipped file, by path relative to the folder of the scenes.
#[must_use]
pub fn generate() -> Files {
    let mut files = Files::new();
    gempa::add(&mut files);
    windows::add(&mut files);
    cubicles::add(&mut files);
    bugtrap::add(&mut files);
    apartment::add(&mut files);
    alpha::add(&mut files);
    planar::add(&mut files);
    wrench::add(&mut files);
    apartment::add_flats(&mut files);
    assembly::add(&mut files);
    key::add(&mut files);
    nut::add(&mut files);
    shelf::add(&mut files);
    twist::add(&mut files);
    disc_scenes::add(&mut files);
    files.extend(BY_HAND.map(|(path, text)| (path.to_owned(), text.into())));
    files
}

/// The text of `src/files.rs`, which puts `files` into the crate.
#[must_use]
pub fn files_rs(files: &Files) -> String {
    const HEAD: &str = "\
//! The shipped files. Written by `mp-bench assets`.

use crate::File;

/// The files at these paths below the folder `assets`.
macro_rules! files {
    ($($path:literal)*) => {
        &[$(File { path: $path, bytes: include_bytes!(concat!(\"../assets/\", $path)) }),*]
    };
}

/// All files, in the order of their paths.
pub const FILES: &[File] = files! {
";
    let entry = |path: &String| format!("    \"{path}\"\n");
    HEAD.to_owned() + &files.keys().map(entry).collect::<String>() + "};\n"
}

/// The paths of `files` that are missing in `folder` or differ there.
///
/// # Errors
/// When a file cannot be read.
pub fn stale<'a>(folder: &Path, files: &'a Files) -> Result<Vec<&'a str>, Error> {
    let mut stale = Vec::new();
    for (path, bytes) in files {
        let on_disk = folder.join(path);
        match std::fs::read(&on_disk) {
            Ok(found) if found == *bytes => {}
            Ok(_) => stale.push(path.as_str()),
            Err(e) if e.kind() == ErrorKind::NotFound => stale.push(path),
            Err(e) => return Err(Error::new(format!("cannot read {}: {e}", on_disk.display()))),
        }
    }
    Ok(stale)
}
