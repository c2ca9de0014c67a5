//! Reading scenes from files of any kind.

use super::without_problem;
use crate::files::inputs::Recording;
use crate::{Error, Scene, SceneFiles};
use mp_io::{Content, Disk, Files, ProblemChanges, ProblemFile, RigidProblem, SceneDocument};
use std::path::Path;
use std::sync::{Arc, PoisonError};

impl Scene {
    /// Reads a scene: a GEMPA environment (`.env`, `.txt`), an OMPL.app problem (`.cfg`), a robot problem, a rigid body or
    /// a world in the plane (`.toml`), a scene of the editor (`.mp.json`). Of a robot alone (`.urdf`) or a map alone (`.yaml` with
    /// its image) a scene is made, and its [notes](Self::notes) say how.
    ///
    /// # Errors
    /// When a file cannot be read or is not valid: with file, line, column and remedy.
    pub fn load(file: impl AsRef<Path>) -> Result<Self, Error> {
        Self::load_from(&Disk, file.as_ref())
    }

    /// As [`load`](Self::load), from other files than those on the disk, such as files in memory. With [`mp_io::Until`] loading ends
    /// when a token says so.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_from(files: &dyn Files, file: &Path) -> Result<Self, Error> {
        Self::load_after(files, file, None)
    }

    /// Reads a scene again, or elsewhere. `of` says what it is read from: all that [`files`](Self::files) gave of it, as what is taken from
    /// `before` is not read. That is the robot of the scene `before`, if it is the same: an arm of the same files.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_again(files: &dyn Files, of: Arc<SceneFiles>, before: Option<&Self>) -> Result<Self, Error> {
        let mut scene = match &of.text {
            Some(text) => Self::load_after(&Texts::one(&of.file, text, files), &of.file, before)?,
            None => Self::load_after(files, &of.file, before)?,
        };
        scene.files = of;
        Ok(scene)
    }

    /// As [`load_from`](Self::load_from), with changes of the problem. Those of a problem in TOML, and of a robot alone, are text of the
    /// problem. Rigid bodies of other formats take numbers and obstacles; all others take numbers.
    ///
    /// # Errors
    /// As [`load`](Self::load), and when the changes make no sense.
    pub fn load_changed(files: &dyn Files, file: &Path, changes: &ProblemChanges) -> Result<Self, Error> {
        if changes.is_empty() {
            return Self::load_from(files, file);
        }
        let named = Content::of(file).next();
        let (place, text) = match named {
            Some(Content::Toml) => {
                let text = String::from_utf8(files.read(file, mp_io::MAX_TEXT_BYTES)?);
                let wrong = |_| Error::new(format!("{} is not UTF-8 text", file.display()));
                (file.to_owned(), text.map_err(wrong)?)
            }
            Some(Content::RobotMacros) => return without_problem::with_macros(files, file, changes),
            Some(Content::Robot) => without_problem::problem_around(files, file)?,
            _ => return Self::load_with_rows(files, file, changes),
        };
        if !changes.arguments.is_empty() {
            return Err(Error::new(format!("--arg: {} has no macros", file.display()))
                .help("arguments are for robots in .xacro"));
        }
        let text = changes.applied(&place.display().to_string(), &text)?;
        let mut scene = Self::load_from(&Texts::one(&place, &text, files), &place)?.with_file(file);
        Arc::make_mut(&mut scene.files).text = Some(text);
        Ok(scene)
    }

    /// As [`load_changed`](Self::load_changed), of a problem that is not in TOML.
    fn load_with_rows(files: &dyn Files, file: &Path, changes: &ProblemChanges) -> Result<Self, Error> {
        let (from, to) = (changes.start_row()?, changes.goal_rows()?);
        let recording = Recording::new(files);
        let mut scene = Self::load_from(&recording, file)?;
        let bodies = changes.bodies(&recording, file)?;
        if !bodies.is_empty() {
            let problem = scene.rigid_problem().cloned();
            let mut problem = problem.ok_or_else(|| {
                Error::new(format!("--obstacle: {} takes no obstacles", file.display()))
                    .help("write a problem in TOML that names it: docs/formats")
            })?;
            problem.obstacles.extend(bodies);
            let of = Self::from_problem_until(problem, &files.interrupt())?;
            let (read, remarks) = (scene.files, scene.remarks);
            scene = of.with_file(file);
            (scene.files, scene.remarks) = (read, remarks);
        }
        let start = from.unwrap_or_else(|| scene.start());
        let goals = if to.is_empty() { scene.goals() } else { to };
        let scene = scene.with_ends(&start, &goals);
        let mut scene = scene.map_err(|e| e.context("the ends of --from and --to"))?;
        let files = Arc::make_mut(&mut scene.files);
        files.inputs = recording.read.into_inner().unwrap_or_else(PoisonError::into_inner);
        files.changed = true;
        Ok(scene)
    }

    fn load_after(files: &dyn Files, file: &Path, before: Option<&Self>) -> Result<Self, Error> {
        let _span = tracing::info_span!("load", file = %file.display()).entered();
        let named = Content::of(file).next();
        let of = |e: Error| match e.file() {
            Some(_) => e,
            None => e.context(format!("cannot plan in {}", file.display())),
        };
        let recording = Recording::new(files);
        let files: &dyn Files = &recording;
        let mut around = None;
        let scene = match without_problem::scene(files, file, named).map_err(of)? {
            Some((scene, problem)) => {
                around = problem;
                scene
            }
            None if named == Some(Content::Toml) => match ProblemFile::load_from(files, file)? {
                ProblemFile::World(problem) => {
                    Self::from_world_until(*problem, &files.interrupt()).map_err(of)?
                }
                ProblemFile::Body(task) => Self::from_task_until(*task, &files.interrupt()).map_err(of)?,
                ProblemFile::Links(problem) => {
                    Self::built(mp_kinds::build::arm(files, *problem, before.map(|scene| &*scene.robot))?)
                }
            },
            None if matches!(named, Some(Content::Document | Content::JsonPath)) => {
                let folder = file.parent().unwrap_or(Path::new(""));
                let mesh = |name: &str| mp_io::read_mesh_of(files, &folder.join(name));
                let document = SceneDocument::load_from(files, file)?;
                Self::of_document(None, document, &mesh, &files.interrupt()).map_err(of)?
            }
            None => {
                let problem = RigidProblem::load_from(files, file)?;
                Self::from_problem_until(problem, &files.interrupt()).map_err(of)?
            }
        };
        tracing::info!(name = scene.name(), space = %scene.space(), "loaded");
        let mut scene = scene.with_file(file);
        scene.remarks = recording.remarks().into();
        let Recording { read, folders, warnings, .. } = recording;
        let warnings = warnings.into_inner().unwrap_or_else(PoisonError::into_inner);
        let notes = warnings.into_iter().chain(scene.notes().iter().cloned()).collect();
        scene = scene.with_notes(notes);
        scene.files = Arc::new(SceneFiles {
            file: file.to_owned(),
            shipped: false,
            text: None,
            around,
            changed: named == Some(Content::RobotMacros),
            inputs: read.into_inner().unwrap_or_else(PoisonError::into_inner),
            folders: folders.into_inner().unwrap_or_else(PoisonError::into_inner),
        });
        Ok(scene)
    }

    /// Reads a scene from the text of a file. Its kind is recognized from its first lines. Other files that it names are
    /// looked for in `folder`. Reports call the scene `name`.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(name: &str, text: &str, folder: &Path) -> Result<Self, Error> {
        Self::parse_changed(name, text, folder, &ProblemChanges::default(), &mp_cspace::Interrupt::never())
    }

    /// As [`parse`](Self::parse), with changes as in [`load_changed`](Self::load_changed), and unless `interrupt` says to end.
    ///
    /// # Errors
    /// As [`parse`](Self::parse), when the changes make no sense, and when it was interrupted.
    pub fn parse_changed(
        name: &str,
        text: &str,
        folder: &Path,
        changes: &ProblemChanges,
        interrupt: &mp_cspace::Interrupt,
    ) -> Result<Self, Error> {
        let begins = |what: &str| text.lines().any(|line| line.trim_start().starts_with(what));
        let first = text.lines().map(str::trim).find(|line| !line.is_empty()).unwrap_or_default();
        let content = match first {
            _ if begins("[problem]") => Content::OmplApp,
            _ if first.eq_ignore_ascii_case("robot") => Content::Environment,
            _ if first.starts_with('{') => Content::JsonPath,
            _ if first.starts_with('<') => Content::Robot,
            _ if begins("image:") => Content::Map,
            _ if first.starts_with(['[', '#']) || first.contains('=') => Content::Toml,
            _ => Content::Environment,
        };
        let file = folder.join(format!("{name}.{}", content.ending()));
        let files = mp_io::Until { files: &Disk, interrupt: interrupt.clone() };
        Self::load_changed(&Texts::one(&file, text, &files), &file, changes)
    }
}

/// Texts in place of files, among other files.
#[derive(Debug)]
pub(crate) struct Texts<'a> {
    pub(crate) texts: Vec<(&'a Path, &'a str)>,
    pub(crate) files: &'a dyn Files,
}

impl<'a> Texts<'a> {
    /// The text of one file.
    pub(crate) fn one(file: &'a Path, text: &'a str, files: &'a dyn Files) -> Self {
        Self { texts: vec![(file, text)], files }
    }
}

impl Files for Texts<'_> {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, mp_io::Error> {
        match self.texts.iter().find(|(file, _)| path == *file) {
            Some((_, text)) => Ok(text.as_bytes().to_vec()),
            None => self.files.read(path, limit),
        }
    }
    fn interrupt(&self) -> mp_cspace::Interrupt {
        self.files.interrupt()
    }
    fn note(&self, path: &Path, remark: &str) {
        self.files.note(path, remark);
    }
    fn warn(&self, path: &Path, remark: &str) {
        self.files.warn(path, remark);
    }
    fn only_reads(&self) -> bool {
        self.files.only_reads()
    }
    fn holds(&self, path: &Path) -> bool {
        self.texts.iter().any(|(file, _)| path == *file) || self.files.holds(path)
    }
    fn names_in(&self, folder: &Path) -> Vec<String> {
        self.files.names_in(folder)
    }
    fn absolute(&self, folder: &Path) -> std::io::Result<std::path::PathBuf> {
        self.files.absolute(folder)
    }
}
