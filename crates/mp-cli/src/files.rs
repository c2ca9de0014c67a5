//! The output files of `plan`.

use crate::cli::Drawing;
use crate::input::is_standard;
use crate::output;
use crate::picture::Picture;
use mp_plan::{Error, PathFileKind, Scene, is_same_file};
use std::path::{Path, PathBuf};

/// The files for the path and the picture of each run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Files {
    out: Option<PathBuf>,
    picture: Option<PathBuf>,
    roadmap: Option<PathBuf>,
}

/// The folder of files that the user did not name.
const FOLDER: &str = "out";

impl Files {
    /// The files that are asked for. A single run without JSON output always gets both, by default in the
    /// folder `out`. With several runs, each must have its own files.
    pub(crate) fn new(
        out: Option<&Path>,
        picture: Option<&Path>,
        roadmap: Option<&Path>,
        json: bool,
        scenes: usize,
        runs: u32,
    ) -> Result<Self, Error> {
        let by_default = |asked: Option<&Path>, name: &str| match asked {
            Some(path) => Some(path.to_owned()),
            None if !json && scenes == 1 && runs == 1 => Some(Path::new(FOLDER).join(name)),
            None => None,
        };
        let files = Self {
            out: by_default(out, "{scene}.path.txt"),
            picture: by_default(picture, "{scene}.png"),
            roadmap: roadmap.map(Path::to_owned),
        };
        if let Some(out) = &files.out
            && is_standard(out)
            && (json || scenes > 1 || runs > 1)
        {
            return Err(Error::new("--out -: standard output has other content").help("name a file"));
        }
        for (option, path) in [("--out", &files.out), ("--picture", &files.picture)] {
            let Some(path) = path else { continue };
            let text = path.to_string_lossy();
            for (many, mark) in [(scenes > 1, "{scene}"), (runs > 1, "{seed}")] {
                if many && !text.contains(mark) {
                    let help = format!("put {mark} in its name, as in `{option} out/{{scene}}-{{seed}}.txt`");
                    let message = format!("{option} {text}: the runs would overwrite each other's file");
                    return Err(Error::new(message).help(help));
                }
            }
        }
        Ok(files)
    }

    /// The files of the path and the picture of one run.
    pub(crate) fn of(&self, scene: &str, seed: u64) -> (Option<PathBuf>, Option<PathBuf>) {
        let fill = |path: &PathBuf| match path.to_str() {
            Some(text) => PathBuf::from(text.replace("{scene}", scene).replace("{seed}", &seed.to_string())),
            None => path.clone(),
        };
        (self.out.as_ref().map(fill), self.picture.as_ref().map(fill))
    }

    /// Refuses files that cannot be written, have no known format, or are an input of the run, before any work
    /// is done.
    pub(crate) fn check(&self, scene: &Scene, seed: u64) -> Result<(), Error> {
        let (out, picture) = self.of(scene.name(), seed);
        let named = [("--out", &out), ("--picture", &picture), ("--roadmap", &self.roadmap)];
        for (i, (option, path)) in named.iter().enumerate() {
            let Some(path) = path.as_ref().filter(|path| !is_standard(path)) else { continue };
            output::writable(path)?;
            if let Some(input) = scene.input_at(path) {
                let message =
                    format!("{option} {} would overwrite the input {}", path.display(), input.display());
                return Err(Error::new(message).help("name another file"));
            }
            for (other, place) in &named[..i] {
                if place.as_ref().is_some_and(|place| is_same_file(place, path)) {
                    let message = format!("{option} and {other} name the same file, {}", path.display());
                    return Err(Error::new(message).help("give each a file of its own"));
                }
            }
        }
        if let Some(out) = out.as_ref().filter(|out| !is_standard(out)) {
            PathFileKind::of(out)?;
        }
        let drawing = Drawing::default();
        picture.map_or(Ok(()), |picture| Picture::of(scene, &picture, &drawing, true).map(|_| ()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(
        out: Option<&str>,
        picture: Option<&str>,
        json: bool,
        scenes: usize,
        runs: u32,
    ) -> Result<Files, Error> {
        Files::new(out.map(Path::new), picture.map(Path::new), None, json, scenes, runs)
    }

    #[test]
    fn a_single_run_gets_files_unless_a_program_reads_it() {
        let single = files(None, None, false, 1, 1).unwrap();
        assert_eq!(single.of("easy", 7), (Some("out/easy.path.txt".into()), Some("out/easy.png".into())));
        assert_eq!(files(None, None, true, 1, 1).unwrap(), Files::default());
        assert_eq!(files(None, None, false, 2, 1).unwrap(), Files::default());
        assert_eq!(files(Some("p.txt"), None, true, 1, 1).unwrap().of("s", 1), (Some("p.txt".into()), None));
    }

    #[test]
    fn many_runs_need_names_of_their_own() {
        assert!(files(Some("p.txt"), None, false, 2, 1).is_err());
        assert!(files(Some("{scene}.txt"), None, false, 2, 2).is_err());
        let both = files(Some("{scene}-{seed}.txt"), None, false, 2, 2).unwrap();
        assert_eq!(both.of("easy", 3).0, Some("easy-3.txt".into()));
    }

    #[test]
    fn outputs_have_a_kind_and_a_file_of_their_own() {
        let scene = Scene::find("easy").unwrap();
        for (out, picture) in [
            (Some("p.doc"), None),
            (Some("p"), None),
            (None, Some("p.svg")),
            (None, Some("p.jpg")),
            (Some("p.txt"), Some("./p.txt")),
        ] {
            assert!(
                files(out, picture, true, 1, 1).unwrap().check(&scene, 1).is_err(),
                "{out:?} {picture:?}"
            );
        }
        for out in ["p.txt", "p.json", "p.csv", "-"] {
            assert!(files(Some(out), Some("p.png"), false, 1, 1).unwrap().check(&scene, 1).is_ok(), "{out}");
        }
    }
}
