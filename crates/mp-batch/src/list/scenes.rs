//! The scenes of a list: what each is made of is known from the beginning, and it is loaded when its first
//! item comes.

use super::{ProblemList, SceneFingerprint};
use mp_io::{Disk, ErrorKind, Files};
use mp_plan::{Cancel, Error, Interrupt, Request, RobotsRead, Scene, SceneFiles, in_parallel, shipped_files};
use std::collections::HashMap;
use std::fmt::Debug;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use xxhash_rust::xxh3::{Xxh3, xxh3_64};

/// A list of problems, with the names and hashes of all files that its scenes are made of: all that is needed
/// to plan its items. A scene is loaded when its first item comes, and let go after its last one; a robot
/// that the next scene has too is kept. Clones share what is loaded.
#[derive(Clone, Debug)]
pub struct ListedProblems {
    pub(super) list: ProblemList,
    pub(super) scenes: Vec<Arc<SceneFiles>>,
    pub(super) fingerprints: Vec<SceneFingerprint>,
    pub(super) source: Source,
    /// What was read from the disk.
    pub(super) known: Arc<Known>,
    kept: Arc<Kept>,
    /// The last item of each scene.
    last: Arc<[u64]>,
}

/// Where the files of scenes are that do not come with the program.
#[derive(Clone, Debug)]
pub(super) enum Source {
    /// In a folder.
    Disk(PathBuf),
    /// In memory.
    Sent(Arc<super::parcel::Sent>),
    /// Nowhere: this is the only scene.
    Only(Scene),
}

/// What is known of files: their hashes, or why they cannot be read.
pub(super) type Known = HashMap<PathBuf, Result<u64, String>>;

impl ProblemList {
    /// Finds the scenes, which are files relative to the folder of the list, with or without their endings,
    /// or shipped scenes, and reads the files that they are made of, to know them again. No scene is made.
    ///
    /// # Errors
    /// When there is no such scene, or `interrupt` says to end. What is wrong with a scene is an error of its
    /// items.
    pub fn with_scenes(self, interrupt: &Interrupt) -> Result<ListedProblems, Error> {
        let places = self.scenes.iter().zip(&self.lines).map(|(name, line)| {
            SceneFiles::find(self.folder(), name.as_ref())
                .map_err(|e| e.context(format!("{}, line {line}", self.file.display())))
        });
        let places = places.collect::<Result<Vec<_>, _>>()?;
        let (seen, folder) = (Mutex::new(Seen::default()), self.folder().to_owned());
        let (robots, shipped_robots) = <(RobotsRead, RobotsRead)>::default();
        let read = |i: usize| match &places[i] {
            place if place.shipped => {
                read_once(place, &shipped_files(), (&Mutex::default(), &shipped_robots), interrupt)
            }
            place => read_once(place, &InFolder(&folder), (&seen, &robots), interrupt),
        };
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let read = in_parallel(places.len(), threads, &Cancel::new(), read);
        if interrupt.clone().ask() {
            return Err(Error::new("interrupted while the scenes of the list were read"));
        }
        let (mut scenes, mut fingerprints) = (Vec::new(), Vec::new());
        for ((scene, fingerprint), name) in read.into_iter().flatten().zip(&self.scenes) {
            let (name, file) = (name.clone(), scene.file.display().to_string());
            fingerprints.push(SceneFingerprint { scene: name, file, fingerprint });
            scenes.push(Arc::new(scene));
        }
        let known = lock(&seen).known.drain().collect();
        Ok(ListedProblems::new(self, scenes, fingerprints, Source::Disk(folder), known))
    }

    /// The list with one scene for all of its problems: for fuzzing.
    pub(crate) fn with_scene(&self, scene: &Scene) -> ListedProblems {
        let scenes = vec![Arc::default(); self.scenes.len()];
        ListedProblems::new(self.clone(), scenes, Vec::new(), Source::Only(scene.clone()), Known::new())
    }

    pub(super) fn folder(&self) -> &Path {
        self.file.parent().unwrap_or(Path::new(""))
    }
}

impl ListedProblems {
    pub(super) fn new(
        list: ProblemList,
        scenes: Vec<Arc<SceneFiles>>,
        fingerprints: Vec<SceneFingerprint>,
        source: Source,
        known: Known,
    ) -> Self {
        let mut last = vec![0; scenes.len()];
        for problem in &list.problems {
            last[problem.scene] = problem.first + problem.seeds.count() - 1;
        }
        let (known, kept) = (Arc::new(known), Arc::default());
        Self { list, scenes, fingerprints, source, known, kept, last: last.into() }
    }

    /// Reads a list and the files of its scenes, unless `cancel` is raised.
    ///
    /// # Errors
    /// As [`ProblemList::load`] and [`ProblemList::with_scenes`].
    pub fn load(file: impl AsRef<Path>, cancel: &Cancel) -> Result<Self, Error> {
        ProblemList::load(file)?.with_scenes(&Interrupt::new(cancel.clone()))
    }

    /// The list as it was read, without its scenes.
    #[must_use]
    pub fn list(&self) -> &ProblemList {
        &self.list
    }

    /// The files that were read: the list itself, and those of scenes that are on the disk. An output must be
    /// none of them.
    #[must_use]
    pub fn inputs(&self) -> Vec<PathBuf> {
        let mut files: Vec<_> = self.known.keys().map(|file| self.list.folder().join(file)).collect();
        files.sort_unstable();
        std::iter::once(self.list.file.clone()).chain(files).collect()
    }

    /// The scene and the request of an item. A request without a planner gets the default one of the
    /// scene; a request without a budget of time gets `time_s` seconds, if these are given. An item has one
    /// thread.
    ///
    /// # Errors
    /// When there is no such item, or its scene cannot be loaded or cannot have its start or goals.
    pub fn problem(&self, item: u64, time_s: Option<f64>) -> Result<(Scene, Request), Error> {
        self.problem_until(item, time_s, &Interrupt::never())
    }

    /// As [`problem`](Self::problem), unless `interrupt` says to end.
    pub(super) fn problem_until(
        &self,
        item: u64,
        time_s: Option<f64>,
        interrupt: &Interrupt,
    ) -> Result<(Scene, Request), Error> {
        let (problem, seed) = self.list.item(item).ok_or_else(|| {
            let items = self.list.items;
            Error::new(format!("the list has no item {item}")).help(format!("it has {items}, from 0"))
        })?;
        let index = problem.scene;
        let load = |before: Option<&Scene>| self.loaded(index, before, interrupt);
        let mut scene = self.kept.scene(index, item >= self.last[index], load)?;
        if problem.start.is_some() || problem.goals.is_some() {
            let start = problem.start.clone().unwrap_or_else(|| scene.start());
            let goals = problem.goals.clone().unwrap_or_else(|| scene.goals());
            scene = scene.with_ends(&start, &goals)?;
        }
        if scene.parts_left() > 0 {
            return Err(Error::new(format!("the motion of {} has several parts", scene.name()))
                .help("plan it by `mp plan`, or give the start and the goal of one motion"));
        }
        let mut request = Request { seed, threads: 1, ..problem.request.clone() };
        if !problem.names_planner {
            request.planner = scene.default_planner().to_owned();
        }
        if let (Some(time), false) = (time_s, problem.names_time) {
            request.budget.time_s = Some(time);
        }
        Ok((scene, request))
    }

    /// A file that has changed since it was read first: no item of its scene can be planned.
    pub(super) fn changed(&self) -> Option<&Path> {
        self.kept.changed.get().map(PathBuf::as_path)
    }

    /// Loads a scene. Parts that `before` has too are taken from it, and not loaded again.
    fn loaded(&self, index: usize, before: Option<&Scene>, interrupt: &Interrupt) -> Result<Scene, Error> {
        let of = &self.scenes[index];
        let load = |files: &dyn Files, known: &Known| {
            let files = Again { files, known, interrupt, changed: &self.kept.changed };
            Scene::load_again(&files, Arc::clone(of), before)
        };
        match &self.source {
            Source::Only(scene) => Ok(scene.clone()),
            _ if of.shipped => load(&shipped_files(), &Known::new()),
            Source::Sent(sent) => load(&**sent, &self.known),
            Source::Disk(folder) => load(&InFolder(folder), &self.known),
        }
    }
}

/// At most this number of scenes are kept: those that were asked for last.
const KEPT: usize = 16;

/// A scene, or the message and the remedy of the error.
type Loaded = Arc<OnceLock<Result<Scene, (String, Option<String>)>>>;

/// The scenes that are loaded.
#[derive(Default)]
struct Kept {
    slots: Mutex<Vec<(usize, Loaded)>>,
    /// The one that was loaded last.
    latest: Mutex<Option<Scene>>,
    changed: OnceLock<PathBuf>,
}

impl Debug for Kept {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Kept")
    }
}

impl Kept {
    /// The scene `index`, which `load` makes, given another one. The `last` who asks for it lets it go.
    fn scene(
        &self,
        index: usize,
        last: bool,
        load: impl FnOnce(Option<&Scene>) -> Result<Scene, Error>,
    ) -> Result<Scene, Error> {
        let slot = {
            let mut slots = lock(&self.slots);
            let known = slots.iter().position(|(other, _)| *other == index);
            let slot = known.map_or_else(|| (index, Loaded::default()), |at| slots.remove(at));
            if !last {
                slots.push(slot.clone());
            }
            slot.1
        };
        let found = slot.get_or_init(|| {
            let before = lock(&self.latest).clone();
            let loaded = load(before.as_ref()).map_err(|e| (e.to_string(), e.remedy().map(str::to_owned)));
            if let Ok(scene) = &loaded {
                *lock(&self.latest) = Some(scene.clone());
            }
            loaded
        });
        let mut slots = lock(&self.slots);
        match found.clone() {
            Ok(scene) => {
                let old = slots.len().saturating_sub(KEPT);
                slots.drain(..old);
                Ok(scene)
            }
            Err((message, remedy)) => {
                // It may have been interrupted.
                slots.retain(|(other, _)| *other != index);
                Err(error(message, remedy))
            }
        }
    }
}

fn error(message: String, remedy: Option<String>) -> Error {
    let error = Error::new(message);
    match remedy {
        Some(remedy) => error.help(remedy),
        None => error,
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Files of which much is known, read again.
#[derive(Debug)]
struct Again<'a> {
    files: &'a dyn Files,
    known: &'a Known,
    interrupt: &'a Interrupt,
    changed: &'a OnceLock<PathBuf>,
}

impl Files for Again<'_> {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, mp_io::Error> {
        if self.interrupt.clone().ask() {
            return Err(mp_io::Error::new(ErrorKind::Interrupted, path.display(), "reading was ended"));
        }
        let read = match self.known.get(path) {
            Some(Err(message)) => Err(message.clone()),
            known => self.files.read(path, limit).map_err(|e| {
                // It was there, and is gone.
                if e.kind() == ErrorKind::Io && known.is_some() {
                    let _ = self.changed.set(path.to_owned());
                }
                e.message().to_owned()
            }),
        };
        // An error has the same words wherever the list is.
        let bytes = read.map_err(|message| {
            mp_io::Error::new(ErrorKind::Io, path.display(), message).help("check the spelling")
        })?;
        if self.known.get(path).is_some_and(|known| *known != Ok(xxh3_64(&bytes))) {
            let _ = self.changed.set(path.to_owned());
            return Err(mp_io::Error::new(ErrorKind::Io, path.display(), "the file has changed"));
        }
        Ok(bytes)
    }
    fn interrupt(&self) -> Interrupt {
        self.interrupt.clone()
    }
    fn holds(&self, path: &Path) -> bool {
        // What is gone is noticed when it is read.
        self.known.get(path).is_some_and(Result::is_ok) || self.files.holds(path)
    }
    fn absolute(&self, folder: &Path) -> std::io::Result<PathBuf> {
        self.files.absolute(folder)
    }
}

/// The files that many scenes are made of are kept up to this many bytes while all are read (256 MiB).
const MOST_KEPT: usize = 256 << 20;

/// What was read for the scenes of a list.
#[derive(Debug, Default)]
struct Seen {
    known: Known,
    contents: HashMap<PathBuf, Arc<Vec<u8>>>,
    bytes: usize,
}

/// Files that are only read, with a record.
#[derive(Debug)]
struct Reading<'a> {
    files: &'a dyn Files,
    seen: &'a Mutex<Seen>,
    interrupt: &'a Interrupt,
    inputs: Mutex<Vec<(PathBuf, Arc<Vec<u8>>)>>,
    folders: Mutex<Vec<(PathBuf, PathBuf)>>,
}

impl Files for Reading<'_> {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, mp_io::Error> {
        if self.interrupt.clone().ask() {
            return Err(mp_io::Error::new(ErrorKind::Interrupted, path.display(), "reading was ended"));
        }
        let known = lock(self.seen).contents.get(path).map(Arc::clone);
        let bytes = match known.filter(|bytes| bytes.len() as u64 <= limit) {
            Some(bytes) => bytes,
            None => {
                let read = self.files.read(path, limit);
                let mut seen = lock(self.seen);
                let known = read.as_ref().map(|bytes| xxh3_64(bytes)).map_err(|e| e.message().to_owned());
                seen.known.insert(path.to_owned(), known);
                let bytes = Arc::new(read?);
                if seen.bytes + bytes.len() <= MOST_KEPT {
                    seen.bytes += bytes.len();
                    seen.contents.insert(path.to_owned(), Arc::clone(&bytes));
                }
                bytes
            }
        };
        let mut inputs = lock(&self.inputs);
        if !inputs.iter().any(|(known, _)| known == path) {
            inputs.push((path.to_owned(), Arc::clone(&bytes)));
        }
        Ok(bytes.to_vec())
    }
    fn interrupt(&self) -> Interrupt {
        self.interrupt.clone()
    }
    fn only_reads(&self) -> bool {
        true
    }
    fn holds(&self, path: &Path) -> bool {
        self.files.holds(path)
    }
    fn absolute(&self, folder: &Path) -> std::io::Result<PathBuf> {
        let absolute = self.files.absolute(folder)?;
        let mut folders = lock(&self.folders);
        if !folders.iter().any(|(known, _)| known == folder) {
            folders.push((folder.to_owned(), absolute.clone()));
        }
        Ok(absolute)
    }
}

/// Reads the files of the scene at `place`, and nothing more. With a hash of the content of all.
fn read_once(
    place: &SceneFiles,
    files: &dyn Files,
    (seen, robots): (&Mutex<Seen>, &RobotsRead),
    interrupt: &Interrupt,
) -> (SceneFiles, String) {
    let reading = Reading { files, seen, interrupt, inputs: Mutex::default(), folders: Mutex::default() };
    // What is wrong is said at the items of the scene.
    let _ = Scene::read_files(&reading, &place.file, robots);
    let Reading { inputs, folders, .. } = reading;
    let inputs = inputs.into_inner().unwrap_or_else(PoisonError::into_inner);
    let fingerprint = fingerprint_of(inputs.iter().map(|(_, bytes)| bytes.as_slice()));
    let scene = SceneFiles {
        file: place.file.clone(),
        shipped: place.shipped,
        inputs: inputs.into_iter().map(|(path, _)| path).collect(),
        folders: folders.into_inner().unwrap_or_else(PoisonError::into_inner),
        ..SceneFiles::default()
    };
    (scene, hexadecimal(fingerprint))
}

#[derive(Debug)]
pub(super) struct InFolder<'f>(pub(super) &'f Path);

impl Files for InFolder<'_> {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, mp_io::Error> {
        Disk.read(&self.0.join(path), limit)
    }
    fn holds(&self, path: &Path) -> bool {
        Disk.holds(&self.0.join(path))
    }
    fn absolute(&self, folder: &Path) -> std::io::Result<PathBuf> {
        Disk.absolute(&self.0.join(folder))
    }
}

/// A hash of the content of files in their order (XXH3).
pub(crate) fn fingerprint_of<B: AsRef<[u8]>>(files: impl IntoIterator<Item = B>) -> u64 {
    let mut hash = Xxh3::new();
    for bytes in files {
        let bytes = bytes.as_ref();
        hash.update(&(bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    }
    hash.digest()
}

/// A fingerprint as text.
pub(super) fn hexadecimal(fingerprint: u64) -> String {
    format!("{fingerprint:016x}")
}
