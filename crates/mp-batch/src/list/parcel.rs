//! Scenes, and a list with its scenes, as bytes, for ranks that need not see the same disk.

use super::scenes::{InFolder, Known, Source, fingerprint_of, hexadecimal};
use super::{ListedProblems, ProblemList, SceneFingerprint, changed};
use crate::pieces::{Reader, Writer, torn};
use crate::ranks::broadcast;
use mp_io::{ErrorKind, Files};
use mp_plan::{Error, Request, Scene, SceneFiles, shipped_files};
use mp_ranks::Link;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl ListedProblems {
    /// The list and all files of its scenes.
    ///
    /// # Errors
    /// When one has changed since it was loaded, or cannot be read any more.
    pub(super) fn packed(&self) -> Result<Vec<u8>, Error> {
        let mut parcel = Writer::new();
        let (_, list) = mp_io::read_text(self.list.file())?;
        if xxhash_rust::xxh3::xxh3_64(&list) != self.list.fingerprint {
            return Err(changed(self.list.file()));
        }
        parcel.path(self.list.file());
        parcel.bytes(&list);
        // Each file once, however many scenes are made of it.
        let mut files: Vec<_> = self.known.iter().collect();
        files.sort_unstable_by_key(|(path, _)| *path);
        parcel.number(files.len());
        for (path, known) in files {
            parcel.path(path);
            match known {
                Ok(hash) => {
                    let bytes = InFolder(self.list.folder()).read(path, mp_io::MAX_MESH_BYTES)?;
                    if xxhash_rust::xxh3::xxh3_64(&bytes) != *hash {
                        return Err(changed(path));
                    }
                    parcel.number(1);
                    parcel.bytes(&bytes);
                }
                Err(message) => {
                    parcel.number(0);
                    parcel.text(message);
                }
            }
        }
        for (scene, known) in self.scenes.iter().zip(&self.fingerprints) {
            parcel.path(&scene.file);
            parcel.number(usize::from(scene.shipped));
            parcel.text(&known.fingerprint);
            parcel.number(scene.inputs.len());
            scene.inputs.iter().for_each(|file| parcel.path(file));
            parcel.number(scene.folders.len());
            for (folder, absolute) in &scene.folders {
                parcel.path(folder);
                parcel.path(absolute);
            }
        }
        Ok(parcel.0)
    }

    /// The list and the scenes of [packed](Self::packed) bytes. They are the same, or refused.
    ///
    /// # Errors
    /// When they are of another version, are not whole, or a scene is not the same here.
    pub(super) fn unpacked(bytes: &[u8]) -> Result<Self, Error> {
        let mut parcel = Reader::new(bytes)?;
        let file = parcel.path()?;
        let list = ProblemList::parse(file, parcel.bytes()?)?;
        let (mut sent, mut known) = (Sent::default(), Known::new());
        for _ in 0..parcel.number()? {
            let path = parcel.path()?;
            if parcel.number()? == 1 {
                sent.files.insert(path, parcel.bytes()?.to_vec());
            } else {
                known.insert(path, Err(parcel.text()?.to_owned()));
            }
        }
        let (mut scenes, mut fingerprints) = (Vec::new(), Vec::new());
        for name in &list.scenes {
            let (file, shipped) = (parcel.path()?, parcel.number()? == 1);
            let fingerprint = parcel.text()?.to_owned();
            let inputs = (0..parcel.number()?).map(|_| parcel.path()).collect::<Result<Vec<_>, _>>()?;
            let mut folders = Vec::new();
            for _ in 0..parcel.number()? {
                let (folder, absolute) = (parcel.path()?, parcel.path()?);
                sent.folders.insert(folder.clone(), absolute.clone());
                folders.push((folder, absolute));
            }
            let read = |name: &PathBuf| match shipped {
                true => shipped_files().read(name, mp_io::MAX_MESH_BYTES),
                false => sent.read(name, mp_io::MAX_MESH_BYTES),
            };
            let contents = inputs.iter().map(read).collect::<Result<Vec<_>, _>>()?;
            same(&file, &hexadecimal(fingerprint_of(contents)), &fingerprint)?;
            let name = name.clone();
            fingerprints.push(SceneFingerprint {
                scene: name,
                file: file.display().to_string(),
                fingerprint,
            });
            scenes.push(Arc::new(SceneFiles { file, shipped, inputs, folders, ..SceneFiles::default() }));
        }
        Ok(Self::new(list, scenes, fingerprints, Source::Sent(Arc::new(sent)), known))
    }
}

/// An error unless both fingerprints of the scene in `file` are the same.
fn same(file: &Path, here: &str, fingerprint: &str) -> Result<(), Error> {
    if here == fingerprint {
        return Ok(());
    }
    let message = format!("the scene {} has the fingerprint {here}, not {fingerprint}", file.display());
    Err(Error::new(message).help("start the same program on all nodes"))
}

/// A scene and a request on all ranks: each of them calls this. Only the master needs the disk: it calls
/// `load`, and sends the request and all files of the scene to the others, once. `None` on the others when
/// the master cannot load it.
///
/// ```
/// use mp_plan::{Request, Scene};
/// let load = || Ok((Scene::find("easy")?, Request::new("rrt-connect").seed(7)));
/// let link = mp_ranks::threads(1).remove(0); // of MPI, on a cluster
/// let Some((scene, request)) = mp_batch::scene_on_ranks(&link, load)? else { return Ok(()) };
/// assert!(scene.plan(&request)?.solved);
/// # Ok::<(), mp_plan::Error>(())
/// ```
///
/// # Errors
/// On the master, when `load` fails or the scene is from no file; elsewhere, when a rank has another version
/// of the program. Where a rank cannot be reached.
pub fn scene_on_ranks(
    link: &dyn Link,
    load: impl FnOnce() -> Result<(Scene, Request), Error>,
) -> Result<Option<(Scene, Request)>, Error> {
    if !link.is_master() {
        let bytes = broadcast(link, Vec::new())?;
        if bytes.is_empty() {
            return Ok(None);
        }
        let mut parcel = Reader::new(&bytes)?;
        let request = serde_json::from_str(parcel.text()?).map_err(|_| torn())?;
        return Ok(Some((unpack(&mut parcel)?, request)));
    }
    let loaded = load().and_then(|(scene, request)| {
        let mut parcel = Writer::new();
        if link.ranks() > 1 {
            let text = serde_json::to_string(&request);
            parcel.text(&text.map_err(|e| Error::new(format!("the request is not valid: {e}")))?);
            pack(&scene, &mut parcel)?;
        }
        Ok(((scene, request), parcel.0))
    });
    match loaded {
        Ok((loaded, parcel)) => broadcast(link, parcel).map(|_| Some(loaded)),
        Err(e) => broadcast(link, Vec::new()).and(Err(e)),
    }
}

/// Writes a scene, with all files that it was read from.
fn pack(scene: &Scene, parcel: &mut Writer) -> Result<(), Error> {
    let file = scene.file().ok_or_else(|| {
        Error::new("a scene that was read from no file cannot be sent to other ranks")
            .help("write it to a file")
    })?;
    let contents = scene.input_files()?;
    parcel.path(file);
    parcel.number(contents.len());
    for (name, (_, bytes)) in scene.inputs().iter().zip(&contents) {
        parcel.path(name);
        parcel.bytes(bytes);
    }
    parcel.number(scene.files().folders.len());
    for (folder, absolute) in &scene.files().folders {
        parcel.path(folder);
        parcel.path(absolute);
    }
    Ok(())
}

/// Reads a scene. What it reads here must be what it read there.
fn unpack(parcel: &mut Reader<'_>) -> Result<Scene, Error> {
    let file = parcel.path()?;
    let (mut sent, mut inputs) = (Sent::default(), Vec::new());
    for _ in 0..parcel.number()? {
        let name = parcel.path()?;
        sent.files.insert(name.clone(), parcel.bytes()?.to_vec());
        inputs.push(name);
    }
    for _ in 0..parcel.number()? {
        sent.folders.insert(parcel.path()?, parcel.path()?);
    }
    let scene = Scene::load_from(&sent, &file)?;
    match scene.inputs() == inputs {
        true => Ok(scene),
        false => Err(Error::new(format!("the scene {} is read otherwise here", file.display()))
            .help("start the same program on all nodes")),
    }
}

/// Files of scenes, sent by another rank.
#[derive(Debug, Default)]
pub(super) struct Sent {
    files: HashMap<PathBuf, Vec<u8>>,
    /// Absolute names of folders, where the files come from.
    folders: HashMap<PathBuf, PathBuf>,
}

impl Files for Sent {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, mp_io::Error> {
        match self.files.get(path) {
            Some(bytes) if bytes.len() as u64 <= limit => Ok(bytes.to_vec()),
            Some(bytes) => {
                let message = format!("the file has {} bytes, more than the {limit} accepted", bytes.len());
                Err(mp_io::Error::new(ErrorKind::TooLarge, path.display(), message)
                    .help("simplify the mesh or split the file"))
            }
            None => {
                Err(mp_io::Error::new(ErrorKind::Io, path.display(), "the master did not send this file")
                    .help("start the same program on all nodes"))
            }
        }
    }
    fn holds(&self, path: &Path) -> bool {
        self.files.contains_key(path)
    }
    fn absolute(&self, folder: &Path) -> std::io::Result<PathBuf> {
        self.folders.get(folder).cloned().ok_or_else(|| std::io::ErrorKind::NotFound.into())
    }
}
