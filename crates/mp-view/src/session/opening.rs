//! What a page with a planner inside needs of a scene: the module for its kind of robot, and the request that opens it.

use crate::message::Message;
use mp_plan::{Error, PathFormat, Scene};
use serde_json::json;
use std::path::{Path, PathBuf};

/// The name of the module of `mp-wasm` that plans for the robot of a scene: `rigid`, `planar` or `arms`.
#[must_use]
pub fn planner_module(scene: &Scene) -> &'static str {
    match (scene.path_format(), scene.is_planar_world()) {
        (PathFormat::Poses, _) => "rigid",
        (_, true) => "planar",
        _ => "arms",
    }
}

/// The request by which a page opens the scene in its own planner: with the content of all files of the scene.
///
/// # Errors
/// When the scene is not from a file, or a file cannot be read any more.
pub fn open_request(scene: &Scene) -> Result<Vec<u8>, Error> {
    let files = scene.input_files()?;
    let Some(main) = scene.file() else {
        return Err(Error::new("only a scene that was read from a file can be planned in a page"));
    };
    // Nobody needs to know in which folders of this computer the files are.
    let folder = common_folder(files.iter().map(|file| file.0.as_path()));
    let name = |path: &Path| {
        let inside = path.strip_prefix(&folder).unwrap_or(path);
        inside.to_string_lossy().replace('\\', "/")
    };
    let mut message = Message::default().with("do", "open").with("main", name(main));
    let files: Vec<_> = files
        .iter()
        .map(|(path, bytes)| json!({"name": name(path), "bytes": message.array(bytes)}))
        .collect();
    Ok(message.with("files", files).to_bytes())
}

/// The innermost folder that holds all files.
fn common_folder<'p>(mut files: impl Iterator<Item = &'p Path>) -> PathBuf {
    let first = files.next().and_then(Path::parent).unwrap_or(Path::new(""));
    files.fold(first.to_owned(), |folder, file| {
        folder.ancestors().find(|above| file.starts_with(above)).unwrap_or(Path::new("")).to_owned()
    })
}
