//! Finding scenes: by file, or by the name of a shipped scene.

use crate::{Error, ErrorKind, Scene};
use mp_cspace::Interrupt;
use mp_io::{Content, Disk, FORMATS, Files, ProblemChanges, RobotPath, Until};
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Endings of scene files, in the order in which they are tried.
fn endings() -> impl Iterator<Item = &'static str> {
    FORMATS.iter().filter(|format| format.content.is_problem()).flat_map(|format| format.endings).copied()
}

impl Scene {
    /// The scene that `given` names: a file, a file without its ending, a shipped scene, or a robot of [`RobotPath::of_environment`].
    /// A file comes first, then a scene. Without its ending
    /// the file of a path (`.txt`) is not meant: it often has the name of the scene.
    ///
    /// # Errors
    /// When there is no such scene (the error suggests the most similar name), or as [`load`](Self::load).
    pub fn find(given: impl AsRef<Path>) -> Result<Self, Error> {
        Self::find_until(given, &Interrupt::never())
    }

    /// As [`find`](Self::find), unless `interrupt` says to end.
    ///
    /// # Errors
    /// As [`find`](Self::find), and when it was interrupted.
    pub fn find_until(given: impl AsRef<Path>, interrupt: &Interrupt) -> Result<Self, Error> {
        Self::find_changed(given, &ProblemChanges::default(), interrupt)
    }

    /// As [`find_until`](Self::find_until), with another start, other goals or more obstacles: see [`load_changed`](Self::load_changed).
    ///
    /// # Errors
    /// As [`find_until`](Self::find_until), and when the changes make no sense.
    pub fn find_changed(
        given: impl AsRef<Path>,
        changes: &ProblemChanges,
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        let until = |files| Until { files, interrupt: interrupt.clone() };
        let SceneFiles { file, shipped, .. } = SceneFiles::find(Path::new(""), given.as_ref())?;
        if !shipped {
            return Self::load_changed(&until(&Disk), &file, changes);
        }
        let mut scene = Self::load_changed(&until(&shipped_files()), &file, changes)?;
        Arc::make_mut(&mut scene.files).shipped = true;
        Ok(scene)
    }

    /// The shipped scenes in groups: the title of each, and the names of its scenes with a sentence about each.
    #[must_use]
    pub fn gallery() -> Vec<(&'static str, Vec<(&'static str, &'static str)>)> {
        #[cfg(feature = "scenes")]
        return mp_scenes::groups().into_iter().map(|group| (group.title, group.scenes)).collect();
        #[cfg(not(feature = "scenes"))]
        Vec::new()
    }

    /// The names of the shipped scenes.
    #[must_use]
    pub fn shipped() -> Vec<&'static str> {
        #[cfg(feature = "scenes")]
        return mp_scenes::names().collect();
        #[cfg(not(feature = "scenes"))]
        Vec::new()
    }
}

/// The rigid-body problem that `given` names, found as by [`Scene::find`]: for code that works with types.
///
/// # Errors
/// When there is no such scene, or its robot is not a rigid body among meshes.
pub fn find_problem(given: impl AsRef<Path>) -> Result<mp_io::RigidProblem, Error> {
    let SceneFiles { file, shipped, .. } = SceneFiles::find(Path::new(""), given.as_ref())?;
    Ok(match shipped {
        true => mp_io::RigidProblem::load_from(&shipped_files(), &file)?,
        false => mp_io::RigidProblem::load(file)?,
    })
}

/// What a scene is read from: enough to [read it again](Scene::load_again), or elsewhere.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SceneFiles {
    /// The file of the scene itself.
    pub file: PathBuf,
    /// The text of that file, where another is meant than the one that is there.
    pub text: Option<String>,
    /// The problem that was made around that file, if it is a robot or a map alone: where it would be, and its text.
    pub around: Option<(PathBuf, String)>,
    /// Whether the scene was changed after it was read, so that reading it again gives another one.
    pub changed: bool,
    /// Whether all of them are among the [shipped files](shipped_files).
    pub shipped: bool,
    /// All that could be read, in the order in which they were.
    pub inputs: Vec<PathBuf>,
    /// Folders whose absolute names were asked for, with these.
    pub folders: Vec<(PathBuf, PathBuf)>,
}

/// The files of the scenes that come with the program, which are in memory. None without the feature `scenes`.
pub fn shipped_files() -> impl Files {
    #[cfg(feature = "scenes")]
    let file = |name: &str| mp_scenes::file(name).map(|file| file.bytes);
    #[cfg(not(feature = "scenes"))]
    let file = |_: &str| None::<&[u8]>;
    mp_io::InMemory(file)
}

impl SceneFiles {
    /// Where the scene `given` is, found as by [`Scene::find`], if files are relative to `folder`; so is the file that it returns. Which
    /// others there are is not known yet.
    ///
    /// # Errors
    /// When there is no such scene.
    pub fn find(folder: &Path, given: &Path) -> Result<Self, Error> {
        if let Some(file) = file_of(folder, given) {
            return Ok(Self { file, ..Self::default() });
        }
        #[cfg(feature = "scenes")]
        if let Some(scene) = given.to_str().and_then(mp_scenes::scene) {
            return Ok(Self { file: scene.path.into(), shipped: true, ..Self::default() });
        }
        if given.is_absolute() || folder.join(given).is_dir() {
            return Err(unknown(folder, given));
        }
        match RobotPath::of_environment().find(&given.to_string_lossy().replace('\\', "/")).as_slice() {
            [] => Err(unknown(folder, given)),
            [robot] => Ok(Self { file: robot.file.clone(), ..Self::default() }),
            several => {
                const SHOWN: usize = 8;
                let names = several.iter().map(|robot| robot.file.display().to_string());
                let more = several.len().saturating_sub(SHOWN);
                let more = if more > 0 { format!(", and {more} more") } else { String::new() };
                let message = format!("{} robots are called {}", several.len(), given.display());
                let help = "name one by its file, or with the folder before it";
                Err(Error::new(message)
                    .help(format!("{help}: {}{more}", names.take(SHOWN).collect::<Vec<_>>().join(", "))))
            }
        }
    }
}

/// The error about a scene that is not there.
fn unknown(folder: &Path, given: &Path) -> Error {
    let given = &folder.join(given);
    if given.is_dir() {
        return Error::new(format!("{} is a folder, not a scene file", given.display()))
            .help("name a file in it");
    }
    let stem = given.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let shipped = Scene::shipped();
    let beside = scenes_in(given.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")));
    let names = shipped.iter().copied().chain(beside.iter().map(String::as_str));
    let text = given.with_extension(Content::TextPath.ending());
    let help = match similar(&stem, names) {
        _ if given.extension().is_none() && is_path(&text) => {
            format!("{} is a path: name the scene that it leads through", text.display())
        }
        Some(name) => format!("did you mean `{name}`?"),
        None => format!(
            "name a file, a robot that `mp robots` lists, or one of the shipped scenes: {}",
            shipped.join(", ")
        ),
    };
    Error::new(format!("there is no scene {}", given.display())).help(help).of_kind(ErrorKind::Missing)
}

/// The file in `folder` that `given` names, with or without its ending.
fn file_of(folder: &Path, given: &Path) -> Option<PathBuf> {
    if folder.join(given).is_file() {
        return Some(given.to_owned());
    }
    let with = |ending: &str| {
        let mut name = given.as_os_str().to_owned();
        name.push(".");
        name.push(ending);
        PathBuf::from(name)
    };
    let is_scene = |path: &Path| path.is_file() && !is_path(path);
    endings().map(with).find(|path| is_scene(&folder.join(path)))
}

/// Whether a text file holds a path: its first line has only numbers, and that of a scene has not.
fn is_path(file: &Path) -> bool {
    let named = Content::of(file).any(|content| content == Content::TextPath);
    let read = || mp_store::open(file, mp_io::MAX_TEXT_BYTES).ok();
    named
        && read().is_some_and(|file| {
            let mut lines = BufReader::new(file.take(HEAD)).lines().map_while(Result::ok);
            let first = lines.find(|line| !line.trim().is_empty()).unwrap_or_default();
            !first.is_empty() && first.split_whitespace().all(|word| word.parse::<f64>().is_ok())
        })
}

/// Bytes of a file that are read to find its first line.
const HEAD: u64 = 4096;

/// The names of the scenes in `folder`, sorted.
fn scenes_in(folder: &Path) -> Vec<String> {
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let scenes = files.filter(|p| p.extension().is_some_and(|e| endings().any(|x| e == x)));
    let mut names: Vec<String> =
        scenes.filter_map(|p| p.file_stem().map(|s| s.to_string_lossy().into_owned())).collect();
    names.sort();
    names
}

/// The name most similar to `given`, if one is similar enough.
fn similar<'a>(given: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let allowed = given.chars().count().max(3) / 3 + 1;
    let near = names.map(|name| (edits(given, name), name));
    near.filter(|(d, _)| *d <= allowed).min_by_key(|(d, _)| *d).map(|(_, name)| name)
}

/// How many letters to insert, drop or replace to get from `a` to `b` (Levenshtein 1966).
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &cb) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(!ca.eq_ignore_ascii_case(&cb));
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
