//! Finding scene files: by path, or by the name of a shipped scene.

use crate::names::closest;
use miette::{Result, miette};
use std::path::{Path, PathBuf};

/// The scene planned on when none is named.
pub(crate) const SAMPLE: &str = "cubicles";

const ENDINGS: [&str; 4] = ["env", "txt", "cfg", "toml"];

/// The folder of the workspace.
pub(crate) fn root() -> PathBuf {
    // Cargo says where the package is now; what was compiled in may have moved since.
    let package = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    let package = package.filter(|p| p.ends_with("xtask") && p.is_dir());
    let package = package.unwrap_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")));
    package.parent().map(Path::to_path_buf).unwrap_or(package)
}

/// The shipped scenes.
fn shipped() -> PathBuf {
    root().join("assets").join("scenes")
}

/// The file meant by `given`: a file, a file less its ending, or the name of a shipped scene.
pub(crate) fn find(given: &Path) -> Result<PathBuf> {
    let folders = [PathBuf::new(), root(), shipped()];
    for folder in &folders {
        let path = folder.join(given);
        if path.is_file() {
            return Ok(path);
        }
        for ending in ENDINGS {
            let mut name = path.clone().into_os_string();
            name.push(".");
            name.push(ending);
            let path = PathBuf::from(name);
            if path.is_file() {
                return Ok(path);
            }
        }
    }
    if given.is_dir() {
        let help = "name a file in it";
        return Err(miette!(help = help, "{} is a folder, not a scene file", given.display()));
    }
    let names = names_in(&shipped());
    let stem = given.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let beside = names_in(given.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")));
    let help = match closest(&stem, names.iter().chain(&beside).map(String::as_str)) {
        Some(name) => format!("did you mean `{name}`?"),
        None if names.is_empty() => "name a scene file; `cargo xtask assets` writes the shipped ones".into(),
        None => format!("name a scene file, or one of the shipped scenes: {}", names.join(", ")),
    };
    Err(miette!(help = help, "there is no scene {}", given.display()))
}

/// The names of the scenes in `folder`, sorted.
fn names_in(folder: &Path) -> Vec<String> {
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let scenes = files.filter(|p| p.extension().is_some_and(|e| ENDINGS.iter().any(|x| e == *x)));
    let mut names: Vec<String> =
        scenes.filter_map(|p| p.file_stem().map(|s| s.to_string_lossy().into_owned())).collect();
    names.sort();
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sample_is_found_by_name_by_path_and_without_ending() {
        let by_name = find(Path::new(SAMPLE)).unwrap();
        let by_path = find(&Path::new("assets/scenes").join(SAMPLE)).unwrap();
        assert_eq!(by_name.canonicalize().unwrap(), by_path.canonicalize().unwrap());
        assert_eq!(find(&by_name).unwrap(), by_name);
        assert!(names_in(&shipped()).iter().any(|n| n == SAMPLE));
    }

    #[test]
    fn a_slip_of_the_finger_is_understood() {
        let e = find(Path::new("cubicels")).unwrap_err();
        assert!(e.help().unwrap().to_string().contains("cubicles"), "{e:?}");
        assert!(find(Path::new("no/such/thing/at/all")).is_err());
    }
}
