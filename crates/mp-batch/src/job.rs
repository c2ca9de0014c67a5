//! What a job of many ranks depends on, in a line: a checkpoint of another job is refused.

use crate::list::fingerprint_of;
use crate::ranks_error;
use mp_plan::{Error, Request, Scene};
use mp_ranks::Checkpoint;
use serde::Serialize;
use std::path::Path;

/// A request without its budget of time, which only ends work: what it ends is not kept.
pub(crate) fn timeless(request: &Request) -> Request {
    let mut timeless = request.clone();
    timeless.budget.time_s = None;
    timeless
}

/// The scene with its ends, what is asked for, and the version of the program; without the files of the
/// scene, which not all ranks have.
pub(crate) fn identity(scene: &Scene, asked: &impl Serialize) -> Result<String, Error> {
    let json = serde_json::to_string(&(scene.start(), scene.goals(), asked))
        .map_err(|e| Error::new(format!("the request cannot be written as JSON: {e}")))?;
    let hash = xxhash_rust::xxh3::xxh3_64(json.as_bytes());
    Ok(format!("{}, ends and request {hash:016x}, version {}", scene.name(), env!("CARGO_PKG_VERSION")))
}

/// Opens or begins the checkpoint of a job of this kind.
pub(crate) fn checkpoint(
    scene: &Scene,
    kind: &str,
    file: &Path,
    identity: &str,
) -> Result<Checkpoint, Error> {
    mp_store::make_folder(mp_store::folder_of(file))?;
    let files = if scene.inputs().is_empty() { Vec::new() } else { scene.input_files()? };
    let files = fingerprint_of(files.iter().map(|(_, bytes)| bytes));
    Checkpoint::open(file, &format!("{kind}, scene {files:016x}, {identity}")).map_err(ranks_error)
}
