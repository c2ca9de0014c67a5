//! Entry points for fuzzing, as those of [`mp_io::fuzz`]: scene files of the viewer, and requests of a session.
//!
//! None may panic, hang or take memory out of proportion, whatever the bytes.

use crate::bytes::frame;
use crate::message::Message;
use crate::session::{Opening, RunRequest, Workspace};
use crate::{SceneFile, scene_of_mesh};
use mp_io::InMemory;
use mp_plan::{Error, Scene};
use std::path::Path;
use std::sync::OnceLock;

/// Reads any bytes. The error is the one that refuses them.
pub type Target = fn(&[u8]) -> Result<(), Error>;

/// What is read: a name, and the function to call.
pub const TARGETS: [(&str, Target); 2] = [("viewer-file", viewer_file), ("session", session)];

/// Scene files: the line of the head, and the arrays behind it. Magic number and length of the head are made right.
///
/// # Errors
/// When the bytes are refused.
pub fn viewer_file(bytes: &[u8]) -> Result<(), Error> {
    let (head, data) = split(bytes);
    let refused = |e: crate::ViewError| Error::new(e.to_string());
    let file = SceneFile::parse(&frame(head.to_vec(), data)).map_err(refused)?;
    let written = file.to_bytes();
    // Bytes are compared, as arrays may have numbers that are not equal to themselves.
    let again = SceneFile::parse(&written).unwrap_or_else(|e| panic!("what was written cannot be read: {e}"));
    assert_eq!(again.to_bytes(), written);
    Ok(())
}

/// Requests of a page, one in each line, and the bytes that they name, after an empty line. Runs are not begun, and shipped
/// scenes not opened: that takes long, and reads nothing else.
///
/// # Errors
/// The last one that a request was answered with.
pub fn session(bytes: &[u8]) -> Result<(), Error> {
    static SCENE: OnceLock<Scene> = OnceLock::new();
    let scene = SCENE.get_or_init(|| {
        let mesh = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
        scene_of_mesh(&InMemory(|_: &str| Some(mesh)), Path::new("m.off")).unwrap_or_else(|e| panic!("{e}"))
    });
    let end = bytes.windows(2).position(|two| two == b"\n\n").unwrap_or(bytes.len());
    let (requests, data) = (&bytes[..end], bytes.get(end + 2..).unwrap_or_default());
    let mut workspace = Workspace::new(Opening { scene: Some(scene.clone()), ..Opening::default() });
    let mut last = Ok(());
    for request in requests.split(|b| *b == b'\n') {
        last = answer(&mut workspace, &frame(request.to_vec(), data));
    }
    last
}

fn answer(workspace: &mut Workspace, request: &[u8]) -> Result<(), Error> {
    let request = Message::parse(request).map_err(|e| Error::new(e.to_string()))?;
    if RunRequest::of(&request)?.is_some() {
        return workspace.scene_to_plan(&request).map(drop);
    }
    if request.head.contains_key("scene") {
        return Ok(());
    }
    let reply = workspace.answer(&request)?.to_bytes();
    assert!(Message::parse(&reply).is_ok(), "a reply is a message");
    Ok(())
}

/// The first line, and what is behind it.
fn split(bytes: &[u8]) -> (&[u8], &[u8]) {
    let end = bytes.iter().position(|b| *b == b'\n').unwrap_or(bytes.len());
    (&bytes[..end], bytes.get(end + 1..).unwrap_or_default())
}
