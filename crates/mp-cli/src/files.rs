//! The output files of `plan`.

use crate::cli::Drawing;
use crate::input::is_standard;
use crate::output::Claims;
use crate::picture::Picture;
use mp_plan::{Error, PathFileKind, Scene};
use std::path::{Path, PathBuf};

/// The files for the path and the picture of each run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Files {
    out: Option<PathBuf>,
    picture: Option<PathBuf>,
    roadmap: Option<PathBuf>,
    certificate: Option<PathBuf>,
    trajectory: Option<PathBuf>,
}

/// The folder of files that the user did not name.
const FOLDER: &str = "out";

impl Files {
    /// The files that are asked for. A single run without JSON output always gets both, by default in the
    /// folder `out`. With several runs, each must have its own files.
    pub(crate) fn new(
        out: Option<&Path>,
        picture: Option<&Path>,
        [roadmap, certificate, trajectory]: [Option<&Path>; 3],
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
            certificate: certificate.map(Path::to_owned),
            trajectory: trajectory.map(Path::to_owned),
        };
        if let Some(out) = &files.out
            && is_standard(out)
            && (json || scenes > 1 || runs > 1)
        {
            return Err(Error::new("--out -: standard output has other content").help("name a file"));
        }
        let named = [
            ("--out", &files.out),
            ("--picture", &files.picture),
            ("--certificate", &files.certificate),
            ("--trajectory", &files.trajectory),
        ];
        for (option, path) in named {
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
        let fill = |path: &PathBuf| Self::filled(path, scene, seed);
        (self.out.as_ref().map(fill), self.picture.as_ref().map(fill))
    }

    /// The file of the certificate of one run.
    pub(crate) fn certificate(&self, scene: &str, seed: u64) -> Option<PathBuf> {
        self.certificate.as_ref().map(|path| Self::filled(path, scene, seed))
    }

    /// The file of the trajectory of one run.
    pub(crate) fn trajectory(&self, scene: &str, seed: u64) -> Option<PathBuf> {
        self.trajectory.as_ref().map(|path| Self::filled(path, scene, seed))
    }

    /// The name of a file of one run.
    fn filled(path: &Path, scene: &str, seed: u64) -> PathBuf {
        match path.to_str() {
            Some(text) => PathBuf::from(text.replace("{scene}", scene).replace("{seed}", &seed.to_string())),
            None => path.to_owned(),
        }
    }

    /// Refuses files that cannot be written, have no known format, or are claimed already, before any work is done. With
    /// `several`, each of that number of routes or parts has files of its own.
    pub(crate) fn claim(
        &self,
        claims: &mut Claims,
        scene: &Scene,
        seed: u64,
        several: Option<usize>,
    ) -> Result<(), Error> {
        let (out, picture) = self.of(scene.name(), seed);
        let certificate = self.certificate(scene.name(), seed);
        let trajectory = self.trajectory(scene.name(), seed);
        if let Some(file) = &trajectory {
            crate::time::kind_of(file)?;
            if !scene.has_trajectories() {
                let message = format!("--trajectory: the robot of {} has none", scene.name());
                return Err(Error::new(message)
                    .help("arms have them whose base stands still or moves in the plane, and that do not move by inputs"));
            }
        }
        for (option, file) in [
            ("--out", &out),
            ("--picture", &picture),
            ("--certificate", &certificate),
            ("--trajectory", &trajectory),
        ] {
            match (file, several) {
                (None, _) => {}
                (Some(file), None) if option == "--out" && is_standard(file) => {}
                (Some(file), None) => claims.output(option, file)?,
                (Some(file), Some(count)) => {
                    (1..=count).try_for_each(|number| claims.output(option, &numbered(file, number)))?
                }
            }
        }
        if let Some(out) = out.as_ref().filter(|out| !is_standard(out)) {
            PathFileKind::of(out)?;
        }
        let drawing = Drawing::default();
        picture.map_or(Ok(()), |picture| Picture::of(scene, &picture, &drawing, true).map(|_| ()))
    }

    /// Refuses a file for the roadmap that cannot be written or is claimed already.
    pub(crate) fn claim_roadmap(&self, claims: &mut Claims) -> Result<(), Error> {
        self.roadmap.as_ref().map_or(Ok(()), |file| claims.output("--roadmap", file))
    }
}

/// The name of a file with a number before its ending.
pub(crate) fn numbered(file: &Path, number: usize) -> PathBuf {
    let [stem, ending] = [file.file_stem(), file.extension()]
        .map(|part| part.unwrap_or_default().to_string_lossy().into_owned());
    let dot = if ending.is_empty() { "" } else { "." };
    file.with_file_name(format!("{stem}-{number}{dot}{ending}"))
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
        Files::new(out.map(Path::new), picture.map(Path::new), [None; 3], json, scenes, runs)
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
                files(out, picture, true, 1, 1)
                    .unwrap()
                    .claim(&mut Claims::default(), &scene, 1, None)
                    .is_err(),
                "{out:?} {picture:?}"
            );
        }
        for out in ["p.txt", "p.json", "p.csv", "-"] {
            let files = files(Some(out), Some("p.png"), false, 1, 1).unwrap();
            assert!(files.claim(&mut Claims::default(), &scene, 1, None).is_ok(), "{out}");
        }
    }
}
