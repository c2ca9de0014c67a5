//! What a job of many ranks depends on, in a line: a checkpoint of another job is refused.

use crate::numbers::fingerprint;
use crate::{Error, Request, Scene};
use mp_ranks::Checkpoint;
use serde::Serialize;
use std::path::Path;

/// A request without its budget of time, which only ends work: what it ends is not kept.
pub(crate) fn timeless(request: &Request) -> Request {
    let mut timeless = request.clone();
    timeless.budget.time_s = None;
    timeless
}

impl Scene {
    /// The scene with its ends, what is asked for, and the version of the program; without the files of the scene, which not all ranks have.
    pub(crate) fn job_identity(&self, asked: &impl Serialize) -> Result<String, Error> {
        let json = serde_json::to_string(asked)
            .map_err(|e| Error::new(format!("the request cannot be written as JSON: {e}")))?;
        let ends = fingerprint(self.goals().into_iter().flatten().chain(self.start()));
        let request = xxhash_rust::xxh3::xxh3_64(json.as_bytes());
        let version = env!("CARGO_PKG_VERSION");
        Ok(format!("{} {ends:016x}, request {request:016x}, version {version}", self.name()))
    }

    /// Opens or begins the checkpoint of a job of this kind.
    pub(crate) fn checkpoint_of(&self, kind: &str, file: &Path, identity: &str) -> Result<Checkpoint, Error> {
        mp_store::make_folder(mp_store::folder_of(file))?;
        let files = self.input_fingerprint(Path::new(""))?;
        Ok(Checkpoint::open(file, &format!("{kind}, scene {files:016x}, {identity}"))?)
    }
}
