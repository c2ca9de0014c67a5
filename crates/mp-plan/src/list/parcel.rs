//! A list with its scenes as bytes, for ranks that need not see the same disk.

use super::{ListedProblems, ProblemList, SceneFingerprint};
use crate::inputs::fingerprint_of;
use crate::{Error, Scene};
use mp_io::{ErrorKind, Files};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// What such bytes begin with.
const FORMAT: &str = "mp-many parcel 1";

impl ListedProblems {
    /// The list and all files of its scenes.
    ///
    /// # Errors
    /// When one has changed since it was loaded, or cannot be read any more.
    pub(super) fn packed(&self) -> Result<Vec<u8>, Error> {
        let changed = |file: &Path| {
            Error::new(format!("{} has changed since it was loaded", file.display())).help("start again")
        };
        let mut parcel = Writer::default();
        parcel.text(FORMAT);
        parcel.text(env!("CARGO_PKG_VERSION"));
        let (_, list) = mp_io::read_text(self.list.file())?;
        if xxhash_rust::xxh3::xxh3_64(&list) != self.list.fingerprint {
            return Err(changed(self.list.file()));
        }
        parcel.path(self.list.file());
        parcel.bytes(&list);
        for (scene, known) in self.scenes.iter().zip(&self.fingerprints) {
            let files = scene.inputs().iter().map(|file| Ok(scene.content(self.list.folder(), file)?));
            let files = files.collect::<Result<Vec<_>, Error>>()?;
            if hexadecimal(fingerprint_of(files.iter().map(Ok))?) != known.fingerprint {
                return Err(changed(Path::new(&known.file)));
            }
            parcel.path(Path::new(&known.file));
            parcel.text(&known.fingerprint);
            parcel.number(files.len());
            for (name, bytes) in scene.inputs().iter().zip(&files) {
                parcel.path(name);
                parcel.bytes(bytes);
            }
            parcel.number(scene.folders.len());
            for (folder, absolute) in &*scene.folders {
                parcel.path(folder);
                parcel.path(absolute);
            }
        }
        Ok(parcel.0)
    }

    /// The list and the scenes of [packed](Self::packed) bytes. They are the same, or refused.
    ///
    /// # Errors
    /// When they are of another version, are not whole, or a scene cannot be loaded or is not the same here.
    pub(super) fn unpacked(bytes: &[u8]) -> Result<Self, Error> {
        let mut parcel = Reader(bytes);
        if parcel.text()? != FORMAT {
            return Err(torn());
        }
        let version = parcel.text()?;
        if version != env!("CARGO_PKG_VERSION") {
            let own = env!("CARGO_PKG_VERSION");
            let message = format!("this rank has version {own} of the program, and the master {version}");
            return Err(Error::new(message).help("start the same program on all nodes"));
        }
        let file = parcel.path()?;
        let list = ProblemList::parse(file, parcel.bytes()?)?;
        let (mut scenes, mut fingerprints) = (Vec::new(), Vec::new());
        for name in &list.scenes {
            let file = parcel.path()?;
            let fingerprint = parcel.text()?.to_owned();
            let mut sent = Sent::default();
            for _ in 0..parcel.number()? {
                sent.files.insert(parcel.path()?, parcel.bytes()?);
            }
            for _ in 0..parcel.number()? {
                sent.folders.insert(parcel.path()?, parcel.path()?);
            }
            let scene = Scene::load_from(&sent, &file)?;
            let read = |name: &PathBuf| sent.read(name, mp_io::MAX_MESH_BYTES).map_err(Error::from);
            let here = hexadecimal(fingerprint_of(scene.inputs().iter().map(read))?);
            if here != fingerprint {
                let message =
                    format!("the scene {} has the fingerprint {here}, not {fingerprint}", file.display());
                return Err(Error::new(message).help("start the same program on all nodes"));
            }
            let (scene_name, file) = (name.clone(), file.display().to_string());
            fingerprints.push(SceneFingerprint { scene: scene_name, file, fingerprint });
            scenes.push(scene);
        }
        Ok(Self { list, scenes, fingerprints })
    }
}

/// A fingerprint as text.
pub(super) fn hexadecimal(fingerprint: u64) -> String {
    format!("{fingerprint:016x}")
}

/// The files of a scene, sent by another rank.
#[derive(Debug, Default)]
struct Sent<'b> {
    files: HashMap<PathBuf, &'b [u8]>,
    /// Absolute names of folders, where the files come from.
    folders: HashMap<PathBuf, PathBuf>,
}

impl Files for Sent<'_> {
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

/// Pieces of bytes, each after its length.
#[derive(Default)]
struct Writer(Vec<u8>);

impl Writer {
    fn number(&mut self, number: usize) {
        self.0.extend((number as u64).to_le_bytes());
    }
    fn bytes(&mut self, bytes: &[u8]) {
        self.number(bytes.len());
        self.0.extend(bytes);
    }
    fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }
    /// A name that is not UTF-8 fails where it is read.
    fn path(&mut self, path: &Path) {
        self.bytes(path.as_os_str().as_encoded_bytes());
    }
}

/// Reads what a [`Writer`] wrote.
struct Reader<'b>(&'b [u8]);

impl<'b> Reader<'b> {
    fn number(&mut self) -> Result<usize, Error> {
        let (number, rest) = self.0.split_first_chunk::<8>().ok_or_else(torn)?;
        self.0 = rest;
        usize::try_from(u64::from_le_bytes(*number)).map_err(|_| torn())
    }
    fn bytes(&mut self) -> Result<&'b [u8], Error> {
        let length = self.number()?;
        let (bytes, rest) = self.0.split_at_checked(length).ok_or_else(torn)?;
        self.0 = rest;
        Ok(bytes)
    }
    fn text(&mut self) -> Result<&'b str, Error> {
        std::str::from_utf8(self.bytes()?).map_err(|_| torn())
    }
    fn path(&mut self) -> Result<PathBuf, Error> {
        Ok(self.text()?.into())
    }
}

fn torn() -> Error {
    Error::new("the list did not arrive whole").help("start the same program on all nodes")
}
