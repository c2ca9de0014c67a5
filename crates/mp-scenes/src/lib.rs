//! The shipped scenes, as files in memory, so that an installed program needs no data folder.
//!
//! ```
//! let scene = mp_scenes::scene("cubicles").expect("it is shipped");
//! assert_eq!(scene.path, "scenes/cubicles.env");
//! assert!(scene.bytes.starts_with(b"Robot"));
//! // Mesh names are relative to the file that contains them.
//! assert!(mp_scenes::file("scenes/../meshes/cubicles/robot.txt").is_some());
//! ```

mod files;
mod gallery;
mod puzzles;
#[cfg(feature = "source")]
pub mod source;

pub use files::FILES;
pub use gallery::{Group, groups};
pub use puzzles::{PUZZLES, Puzzle, puzzle, without_solution};

/// A file in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct File {
    /// Its path below the folder of the scenes, with `/` between the parts.
    pub path: &'static str,
    /// Its content.
    pub bytes: &'static [u8],
}

/// The name of a scene for first steps.
pub const SAMPLE: &str = "cubicles";

/// The names of the scenes, in alphabetical order.
pub fn names() -> impl Iterator<Item = &'static str> {
    let name = |file: &File| file.path.strip_prefix("scenes/")?.rsplit_once('.').map(|(name, _)| name);
    // Files are in the order of their paths: `arm-6.toml`, then `arm.toml`.
    let mut names: Vec<&str> = FILES.iter().filter_map(name).collect();
    names.sort_unstable();
    names.into_iter()
}

/// The problem file of a shipped scene, by the name of the scene.
#[must_use]
pub fn scene(name: &str) -> Option<File> {
    let named = |file: &&File| {
        let stem = file.path.strip_prefix("scenes/").and_then(|rest| rest.rsplit_once('.'));
        stem.is_some_and(|(stem, _)| stem == name)
    };
    FILES.iter().find(named).copied()
}

/// The file at `path`, below the folder of the scenes; `..` and `.` in it are resolved.
#[must_use]
pub fn file(path: &str) -> Option<File> {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split(['/', '\\']) {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop()?;
            }
            part => parts.push(part),
        }
    }
    let path = parts.join("/");
    FILES.binary_search_by(|file| file.path.cmp(&path)).ok().map(|i| FILES[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_of_the_folder_is_there_in_order() {
        assert!(FILES.is_sorted_by(|a, b| a.path < b.path));
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
        let (mut pending, mut found) = (vec![root.clone()], 0);
        while let Some(folder) = pending.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    pending.push(path);
                } else if path != root.join("README.md") {
                    let inside = path.strip_prefix(&root).unwrap().to_string_lossy().replace('\\', "/");
                    let bytes =
                        file(&inside).unwrap_or_else(|| panic!("{inside} is not in src/files.rs")).bytes;
                    assert!(bytes == std::fs::read(&path).unwrap(), "{inside}");
                    found += 1;
                }
            }
        }
        assert_eq!(found, FILES.len());
    }

    #[test]
    fn scenes_are_found_by_name() {
        assert!(names().is_sorted() && names().any(|name| name == SAMPLE));
        assert!(names().all(|name| scene(name).is_some()));
        assert_eq!(scene("zebra"), None);
        assert_eq!(file("../scenes/easy.env"), None);
    }
}
