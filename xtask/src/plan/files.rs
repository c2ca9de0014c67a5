//! Where results go.

use crate::output;
use crate::render;
use miette::{Result, miette};
use std::path::{Path, PathBuf};

/// Where the path and the picture of each run go.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Files {
    out: Option<PathBuf>,
    picture: Option<PathBuf>,
}

/// The folder of files nobody named.
const FOLDER: &str = "out";

impl Files {
    /// Files as asked for. A single run of which a person reads the summary gets both in any case, in the
    /// folder `out`. Of several runs each must have files of its own.
    pub(crate) fn new(
        out: Option<&Path>,
        picture: Option<&Path>,
        json: bool,
        scenes: usize,
        runs: u32,
    ) -> Result<Self> {
        let by_default = |asked: Option<&Path>, name: &str| match asked {
            Some(path) => Some(path.to_owned()),
            None if !json && scenes == 1 && runs == 1 => Some(Path::new(FOLDER).join(name)),
            None => None,
        };
        let files =
            Self { out: by_default(out, "{scene}.path.txt"), picture: by_default(picture, "{scene}.png") };
        for (option, path) in [("--out", &files.out), ("--picture", &files.picture)] {
            let Some(path) = path else { continue };
            let text = path.to_string_lossy();
            for (many, mark) in [(scenes > 1, "{scene}"), (runs > 1, "{seed}")] {
                if many && !text.contains(mark) {
                    let help = format!("put {mark} in its name, as in `{option} out/{{scene}}-{{seed}}.txt`");
                    return Err(miette!(
                        help = help,
                        "{option} {text}: the runs would overwrite each other's file"
                    ));
                }
            }
        }
        Ok(files)
    }

    /// The files of one run.
    pub(crate) fn of(&self, scene: &str, seed: u64) -> (Option<PathBuf>, Option<PathBuf>) {
        let fill = |path: &PathBuf| match path.to_str() {
            Some(text) => PathBuf::from(text.replace("{scene}", scene).replace("{seed}", &seed.to_string())),
            None => path.clone(),
        };
        (self.out.as_ref().map(fill), self.picture.as_ref().map(fill))
    }

    /// Complains about files that cannot be written, before any work is done.
    pub(crate) fn check(&self, scene: &str, flat: bool, seed: u64) -> Result<()> {
        let (out, picture) = self.of(scene, seed);
        picture.iter().try_for_each(|file| render::wanted(file, flat))?;
        out.iter().chain(&picture).try_for_each(|path| output::writable(path))
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
    ) -> Result<Files> {
        Files::new(out.map(Path::new), picture.map(Path::new), json, scenes, runs)
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
    fn drawings_are_made_in_the_plane_only() {
        let svg = files(None, Some("p.svg"), true, 1, 1).unwrap();
        assert!(svg.check("easy", false, 1).is_err());
        assert!(render::wanted(Path::new("p.svg"), true).is_ok());
        assert!(render::wanted(Path::new("p.png"), false).is_ok());
    }
}
