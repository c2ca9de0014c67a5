//! The files that a scene was read from. An output must not overwrite them.

use crate::Scene;
use crate::files::find::{SceneFiles, shipped_files};
use mp_io::{Content, DescribedRobot, Disk, Error, Files, ProblemFile};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Files, with a record of those that were read.
#[derive(Debug)]
pub(crate) struct Recording<'a> {
    pub(crate) files: &'a dyn Files,
    pub(crate) read: Mutex<Vec<PathBuf>>,
    /// Folders whose absolute names were asked for, with these.
    pub(crate) folders: Mutex<Vec<(PathBuf, PathBuf)>>,
    /// What readers remarked, and of which files.
    remarks: Mutex<Vec<(String, Vec<String>)>>,
    /// Of these all who use the scene hear.
    pub(crate) warnings: Mutex<Vec<String>>,
}

impl<'a> Recording<'a> {
    pub(crate) fn new(files: &'a dyn Files) -> Self {
        let (read, folders, remarks, warnings) = Default::default();
        Self { files, read, folders, remarks, warnings }
    }

    /// The remarks of readers, a sentence for each.
    pub(crate) fn remarks(&self) -> Vec<String> {
        const SHOWN: usize = 4;
        let remarks = self.remarks.lock().map(|remarks| remarks.clone()).unwrap_or_default();
        let sentence = |(remark, files): (String, Vec<String>)| {
            let shown = files[..files.len().min(SHOWN)].join(", ");
            match files.len().saturating_sub(SHOWN) {
                0 => format!("{remark}: {shown}"),
                more => format!("{remark}: {shown} and {more} more"),
            }
        };
        remarks.into_iter().map(sentence).collect()
    }
}

impl Files for Recording<'_> {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, Error> {
        if let Ok(mut read) = self.read.lock()
            && !read.iter().any(|known| known == path)
        {
            read.push(path.to_owned());
        }
        self.files.read(path, limit)
    }
    fn interrupt(&self) -> mp_cspace::Interrupt {
        self.files.interrupt()
    }
    fn note(&self, path: &Path, remark: &str) {
        tracing::info!("{}: {remark}", path.display());
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        if let Ok(mut remarks) = self.remarks.lock() {
            match remarks.iter_mut().find(|(known, _)| known == remark) {
                Some((_, files)) if files.contains(&name) => {}
                Some((_, files)) => files.push(name),
                None => remarks.push((remark.to_owned(), vec![name])),
            }
        }
        self.files.note(path, remark);
    }
    fn warn(&self, path: &Path, remark: &str) {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        if let Ok(mut warnings) = self.warnings.lock() {
            warnings.push(format!("{name}: {remark}"));
        }
        self.files.warn(path, remark);
    }
    fn only_reads(&self) -> bool {
        self.files.only_reads()
    }
    fn holds(&self, path: &Path) -> bool {
        self.files.holds(path)
    }
    fn names_in(&self, folder: &Path) -> Vec<String> {
        self.files.names_in(folder)
    }
    fn absolute(&self, folder: &Path) -> std::io::Result<PathBuf> {
        let absolute = self.files.absolute(folder)?;
        if let Ok(mut folders) = self.folders.lock()
            && !folders.iter().any(|(known, _)| known == folder)
        {
            folders.push((folder.to_owned(), absolute.clone()));
        }
        Ok(absolute)
    }
}

/// The robots of scenes that were [read](Scene::read_files) before, and what reading their meshes asked for.
#[derive(Debug, Default)]
pub struct RobotsRead(Mutex<Vec<RobotRead>>);

/// Robots of a scene, the files of their meshes, and the folders whose absolute names were asked for.
type RobotRead = (Vec<DescribedRobot>, Arc<[Vec<PathBuf>; 2]>);

impl Scene {
    /// Reads the files of the scene in `file`, in the order in which loading reads them. Of a problem in TOML no scene is made, and the meshes of
    /// robots that are `known` are not even parsed; other scenes are loaded.
    ///
    /// # Errors
    /// When a file cannot be read. Where there is none, the scene may be wrong nevertheless.
    pub fn read_files(files: &dyn Files, file: &Path, known: &RobotsRead) -> Result<(), crate::Error> {
        if Content::of(file).next() != Some(Content::Toml) {
            return Self::load_from(files, file).map(|_| ());
        }
        let ProblemFile::Links(problem) = ProblemFile::load_from(files, file)? else { return Ok(()) };
        let all = || known.0.lock().unwrap_or_else(PoisonError::into_inner);
        let before =
            all().iter().find(|(robots, _)| *robots == problem.robots).map(|(_, read)| Arc::clone(read));
        if let Some([meshes, folders]) = before.as_deref() {
            folders.iter().for_each(|folder| drop(files.absolute(folder)));
            return Ok(meshes
                .iter()
                .try_for_each(|mesh| files.read(mesh, mp_io::MAX_MESH_BYTES).map(drop))?);
        }
        let recording = Recording::new(files);
        mp_kinds::read_robots(&recording, &problem)?;
        let Recording { read, folders, .. } = recording;
        let read = read.into_inner().unwrap_or_else(PoisonError::into_inner);
        let folders = folders.into_inner().unwrap_or_else(PoisonError::into_inner);
        let folders = folders.into_iter().map(|(folder, _)| folder).collect();
        all().push((problem.robots, Arc::new([read, folders])));
        Ok(())
    }

    /// The files that the scene was read from: its own, meshes, maps, robot descriptions.
    #[must_use]
    pub fn inputs(&self) -> &[PathBuf] {
        &self.files.inputs
    }

    /// The files that the scene was read from, and where they are: for [`load_again`](Self::load_again).
    #[must_use]
    pub fn files(&self) -> &Arc<SceneFiles> {
        &self.files
    }

    /// The files that the scene was read from, its own first, with their content, so that it can be read elsewhere. Their
    /// names are relative to the innermost folder that holds all of them, with `/` between folders.
    ///
    /// # Errors
    /// When the scene is not from a file, or a file cannot be read any more.
    pub fn input_files(&self) -> Result<Vec<(String, Vec<u8>)>, crate::Error> {
        let inputs = self.inputs();
        if inputs.is_empty() {
            return Err(crate::Error::new(format!("{} was not read from a file", self.name())));
        }
        if self.files.changed {
            let message = format!("{} was changed by options, which no file says", self.name());
            return Err(crate::Error::new(message)
                .help("write the start, the goal and the obstacles into a problem: docs/formats"));
        }
        let folder = common_folder(inputs.iter().map(PathBuf::as_path));
        let file = |path: &PathBuf| {
            let inside = path.strip_prefix(&folder).unwrap_or(path);
            let content = match self.files.shipped {
                _ if *path == self.files.file && self.files.text.is_some() => {
                    self.files.text.clone().unwrap_or_default().into_bytes()
                }
                true => shipped_files().read(path, mp_io::MAX_MESH_BYTES)?,
                false => Disk.read(path, mp_io::MAX_MESH_BYTES)?,
            };
            Ok((inside.to_string_lossy().replace('\\', "/"), content))
        };
        inputs.iter().map(file).collect()
    }

    /// The input files that are on the disk: an output must be none of them. Empty for a shipped scene, which is in memory.
    #[must_use]
    pub fn inputs_on_disk(&self) -> &[PathBuf] {
        if self.files.shipped { &[] } else { &self.files.inputs }
    }
}

/// The innermost folder that holds all files.
fn common_folder<'p>(mut files: impl Iterator<Item = &'p Path>) -> PathBuf {
    let first = files.next().and_then(Path::parent).unwrap_or(Path::new(""));
    files.fold(first.to_owned(), |folder, file| {
        folder.ancestors().find(|above| file.starts_with(above)).unwrap_or(Path::new("")).to_owned()
    })
}
