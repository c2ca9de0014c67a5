//! The scenes of a list, loaded once.

use super::{ProblemList, SceneFingerprint};
use crate::{Error, Request, Scene};
use mp_cspace::{Cancel, Interrupt};
use std::path::{Path, PathBuf};

/// A list of problems with its scenes: all that is needed to plan its items.
#[derive(Clone, Debug)]
pub struct ListedProblems {
    pub(super) list: ProblemList,
    pub(super) scenes: Vec<Scene>,
    pub(super) fingerprints: Vec<SceneFingerprint>,
}

impl ProblemList {
    /// Loads the scenes, each once: files relative to the folder of the list, with or without their endings, or shipped scenes.
    ///
    /// # Errors
    /// When one cannot be loaded, or `interrupt` says to end.
    pub fn with_scenes(self, interrupt: &Interrupt) -> Result<ListedProblems, Error> {
        let (mut scenes, mut fingerprints) = (Vec::new(), Vec::new());
        for (name, line) in self.scenes.iter().zip(&self.lines) {
            let of = |e: Error| e.context(format!("{}, line {line}", self.file.display()));
            let scene = Scene::find_in(self.folder(), name.as_ref(), interrupt).map_err(of)?;
            fingerprints.push(SceneFingerprint {
                scene: name.clone(),
                file: scene.file().map(|file| file.display().to_string()).unwrap_or_default(),
                fingerprint: hexadecimal(scene.input_fingerprint(self.folder()).map_err(of)?),
            });
            scenes.push(scene);
        }
        Ok(ListedProblems { list: self, scenes, fingerprints })
    }

    /// The list with one scene for all of its problems: for fuzzing.
    #[cfg(all(feature = "kinds", feature = "pictures", feature = "roadmaps"))]
    pub(crate) fn with_scene(&self, scene: &Scene) -> ListedProblems {
        let scenes = vec![scene.clone(); self.scenes.len()];
        ListedProblems { list: self.clone(), scenes, fingerprints: Vec::new() }
    }

    pub(super) fn folder(&self) -> &Path {
        self.file.parent().unwrap_or(Path::new(""))
    }
}

impl ListedProblems {
    /// Reads a list and its scenes, unless `cancel` is raised.
    ///
    /// # Errors
    /// As [`ProblemList::load`] and [`ProblemList::with_scenes`].
    pub fn load(file: impl AsRef<Path>, cancel: &Cancel) -> Result<Self, Error> {
        match ProblemList::load(file)?.with_scenes(&Interrupt::new(cancel.clone())) {
            Err(_) if cancel.is_raised() => {
                Err(Error::new("interrupted while the scenes of the list were loaded"))
            }
            loaded => loaded,
        }
    }

    /// The list.
    #[must_use]
    pub fn list(&self) -> &ProblemList {
        &self.list
    }

    /// Its scenes, in the order of their first lines.
    #[must_use]
    pub fn scenes(&self) -> &[Scene] {
        &self.scenes
    }

    /// The files that were read: the list itself, and those of scenes that are on the disk. An output must be none of them.
    #[must_use]
    pub fn inputs(&self) -> Vec<PathBuf> {
        let of_scenes = self.scenes.iter().flat_map(|scene| scene.inputs_on_disk());
        let of_scenes = of_scenes.map(|file| self.list.folder().join(file));
        std::iter::once(self.list.file.clone()).chain(of_scenes).collect()
    }

    /// The scene and the request of an item. A request that names no planner has the one that suits the scene; one that names no budget of
    /// time has `time_s` seconds, if they are given. An item has one thread.
    ///
    /// # Errors
    /// When there is no such item, or the scene cannot have its start or goals.
    pub fn problem(&self, item: u64, time_s: Option<f64>) -> Result<(Scene, Request), Error> {
        let (problem, seed) = self.list.item(item).ok_or_else(|| {
            let items = self.list.items;
            Error::new(format!("the list has no item {item}")).help(format!("it has {items}, from 0"))
        })?;
        let scene = &self.scenes[problem.scene];
        let scene = match (&problem.start, &problem.goals) {
            (None, None) => scene.clone(),
            (start, goals) => {
                let start = start.clone().unwrap_or_else(|| scene.start());
                scene.with_ends(&start, &goals.clone().unwrap_or_else(|| scene.goals()))?
            }
        };
        let mut request = Request { seed, threads: 1, ..problem.request.clone() };
        if !problem.names_planner {
            request.planner = scene.default_planner().to_owned();
        }
        if let (Some(time), false) = (time_s, problem.names_time) {
            request.budget.time_s = Some(time);
        }
        Ok((scene, request))
    }
}

/// A fingerprint as text.
pub(super) fn hexadecimal(fingerprint: u64) -> String {
    format!("{fingerprint:016x}")
}
