//! Problems in TOML that are edited: their obstacles, start and goals.

use crate::files::load::Texts;
use crate::{Error, Scene, SceneFiles};
use mp_geom::TriMesh;
use mp_io::{Content, Files, ProblemDocument, ProblemShape, off_text};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The problem in TOML that a scene was read from, or the one that was made around a robot or a map alone: what an editor begins with.
#[derive(Clone, Debug)]
pub struct SceneProblem {
    /// Where the text is, or would be: the names in it are relative to that.
    file: PathBuf,
    text: String,
    files: Arc<dyn Files>,
    /// Whether they are files of this machine.
    on_disk: bool,
    of: Arc<SceneFiles>,
    document: ProblemDocument,
}

/// Meshes by the names of documents.
type Meshes<'m> = &'m dyn Fn(&str) -> Result<TriMesh, mp_io::Error>;

impl Scene {
    /// The problem of the scene, to be edited. `files` are those that it was read from, on the disk or in memory.
    ///
    /// # Errors
    /// When the scene is not from a problem in TOML, a robot or a map alone, or is another one than its files say: what can be done instead.
    pub fn problem(&self, files: Arc<dyn Files>, on_disk: bool) -> Result<SceneProblem, Error> {
        let of = Arc::clone(&self.files);
        let toml = Content::of(&of.file).next() == Some(Content::Toml);
        let (file, text) = match (&of.around, &of.text) {
            _ if of.changed => {
                let message = format!("{} was changed by options or macros, which no file says", self.name());
                return Err(Error::new(message).help("write a problem in TOML that names it: docs/formats"));
            }
            (Some(around), _) => around.clone(),
            (None, Some(text)) => (of.file.clone(), text.clone()),
            (None, None) if toml => {
                let bytes = files.read(&of.file, mp_io::MAX_TEXT_BYTES)?;
                (of.file.clone(), String::from_utf8_lossy(&bytes).into_owned())
            }
            (None, None) => {
                return Err(Error::new(format!("{} is not from a file that holds obstacles", self.name()))
                    .help("open a problem in TOML: docs/formats"));
            }
        };
        let name = file.display().to_string();
        let mut document = ProblemDocument::of_text(self.name(), &name, &text)?;
        // Chosen ends would be chosen again, among other obstacles.
        if of.around.is_some() || ProblemDocument::chooses_ends(&name, &text)? {
            (document.start, document.goals) = (Some(self.start()), Some(self.goals()));
        }
        Ok(SceneProblem { file, text, files, on_disk, of, document })
    }
}

impl SceneProblem {
    /// What can be edited.
    #[must_use]
    pub fn document(&self) -> &ProblemDocument {
        &self.document
    }

    /// Whether there are obstacles beside those of the document: an image or a map of the plane.
    ///
    /// # Errors
    /// When the text cannot be read any more.
    pub fn has_map(&self) -> Result<bool, Error> {
        let mut named = false;
        mp_io::with_file_names(&self.file.display().to_string(), &self.text, &mut |name| {
            let path = Path::new(name);
            named |= Content::of(path).any(|content| matches!(content, Content::Map | Content::MapImage));
            None
        })?;
        Ok(named && self.document.plane)
    }

    /// The scene of the edited document. What did not change is shared with `before`. `mesh` gives the meshes that the problem does not
    /// name.
    ///
    /// # Errors
    /// When a reader of problems refuses what the document says.
    pub fn edited(
        &self,
        document: &ProblemDocument,
        mesh: Meshes<'_>,
        before: &Scene,
    ) -> Result<Scene, Error> {
        let files = self.written(&document.name, document, mesh)?;
        let folder = self.file.parent().unwrap_or(Path::new(""));
        let text = files.first().map(|(_, text)| text.clone()).unwrap_or_default();
        let added: Vec<(PathBuf, String)> =
            files.into_iter().skip(1).map(|(name, text)| (folder.join(name), text)).collect();
        let texts = added.iter().map(|(file, text)| (file.as_path(), text.as_str())).collect();
        let files = Texts { texts, files: &*self.files };
        let of = SceneFiles {
            file: self.file.clone(),
            text: Some(text),
            around: None,
            ..SceneFiles::clone(&self.of)
        };
        let scene = Scene::load_again(&files, Arc::new(of), Some(before))?;
        scene.with_file(&self.of.file).keeping(before.clearance_kept())
    }

    /// The files of the edited document: the problem `name.toml`, then those that are to stand beside it, in the folder `into` or in one that
    /// is not known yet. It names files of this machine where they are. Of files in memory, those that the problem names are among the
    /// files; where these name others in turn, none is, and the second list has all that are needed.
    ///
    /// # Errors
    /// When a document refers to what the text does not have, or a file cannot be read any more.
    #[expect(clippy::type_complexity, reason = "two lists of files")]
    pub fn saved(
        &self,
        name: &str,
        document: &ProblemDocument,
        mesh: Meshes<'_>,
        into: Option<&Path>,
    ) -> Result<(Vec<(String, Vec<u8>)>, Vec<String>), Error> {
        let mut files = self.written(name, document, mesh)?;
        let own: Vec<String> = files.iter().map(|file| file.0.clone()).collect();
        let text = std::mem::take(&mut files[0].1);
        let folder = self.file.parent().unwrap_or(Path::new(""));
        let here = || mp_store::folder_of(&self.file).canonicalize().ok();
        let (mut copies, mut left) = (Vec::<(String, Vec<u8>)>::new(), Vec::new());
        let renamed = match (self.on_disk.then(here).flatten(), into) {
            (Some(here), Some(into)) if here == into => text,
            (Some(here), _) => self.renamed(&text, &mut |file| {
                (!own.iter().any(|own| own == file)).then(|| here.join(file).display().to_string())
            })?,
            _ => {
                let known = |file: &str| self.files.read(&folder.join(file), mp_io::MAX_MESH_BYTES).ok();
                let mut named = Vec::new();
                let renamed = self.renamed(&text, &mut |file| {
                    let bytes = known(file).filter(|_| !own.iter().any(|own| own == file))?;
                    let parts: Vec<&str> =
                        file.split(['/', '\\']).filter(|part| !["", ".", ".."].contains(part)).collect();
                    let place = folder.join(file);
                    let copied = named.iter().position(|known| *known == place);
                    let copy = copied.map(|i| copies[i].0.clone()).unwrap_or_else(|| {
                        let taken: Vec<String> =
                            copies.iter().map(|copy| copy.0.clone()).chain(own.clone()).collect();
                        free_name(&format!("{name}_{}", parts.join("_")), &taken)
                    });
                    if copied.is_none() {
                        named.push(place);
                        copies.push((copy.clone(), bytes));
                    }
                    Some(copy)
                })?;
                let problem = |file: &PathBuf| *file == self.of.file || *file == self.file;
                let further =
                    |file: &&PathBuf| !problem(file) && !named.contains(file) && self.files.holds(file);
                // All or none: files that name others by where they stand cannot stand elsewhere.
                if self.of.inputs.iter().any(|file| further(&file)) {
                    let needed = self.of.inputs.iter().filter(|file| named.contains(file) || further(file));
                    left.extend(needed.map(|file| file.display().to_string()));
                    copies.clear();
                    text
                } else {
                    renamed
                }
            }
        };
        files[0].1 = renamed;
        let files = files.into_iter().map(|(name, text)| (name, text.into_bytes())).chain(copies);
        Ok((files.collect(), left))
    }

    fn renamed(&self, text: &str, name: &mut dyn FnMut(&str) -> Option<String>) -> Result<String, Error> {
        Ok(mp_io::with_file_names(&self.file.display().to_string(), text, name)?)
    }

    /// The text of the edited problem as the file `name.toml`, and the meshes that it names beside those of the problem.
    fn written(
        &self,
        name: &str,
        document: &ProblemDocument,
        mesh: Meshes<'_>,
    ) -> Result<Vec<(String, String)>, Error> {
        let mut taken: Vec<String> = Vec::new();
        self.renamed(&self.text, &mut |named| {
            taken.extend(Path::new(named).file_name().map(|file| file.to_string_lossy().into_owned()));
            None
        })?;
        let mut meshes: Vec<(&str, String)> = Vec::new();
        for obstacle in &document.obstacles {
            if let ProblemShape::Solid(mp_io::DocumentShape::Mesh { file: mesh, .. }) = &obstacle.shape
                && !meshes.iter().any(|(known, _)| known == mesh)
            {
                let file = free_name(&format!("{name}_{}.off", mesh.replace('.', "_")), &taken);
                taken.push(file.clone());
                meshes.push((mesh, file));
            }
        }
        let file_of = |mesh: &str| {
            meshes.iter().find(|(known, _)| *known == mesh).map(|(_, file)| file.clone()).unwrap_or_default()
        };
        let text = document.applied(&self.file.display().to_string(), &self.text, &file_of)?;
        let mut files = vec![(format!("{name}.toml"), text)];
        for (known, file) in &meshes {
            files.push((file.clone(), off_text(&mesh(known)?)));
        }
        Ok(files)
    }
}

/// `name`, or with the first number from 2 on before its ending with which it is not taken. Upper and lower case may be the same on a disk.
fn free_name(name: &str, taken: &[String]) -> String {
    let (stem, ending) =
        name.rsplit_once('.').map_or((name, String::new()), |(stem, e)| (stem, format!(".{e}")));
    let numbered = (2..).map(|number: u64| format!("{stem}_{number}{ending}"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    names.find(|name| !taken.iter().any(|known| known.eq_ignore_ascii_case(name))).unwrap_or_default()
}
