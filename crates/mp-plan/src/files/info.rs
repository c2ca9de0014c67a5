//! What is in a file: a mesh, a scene or a path.

mod mesh;
mod path;
mod scene;

pub use mesh::{MeshInfo, Surface};
pub use path::PathInfo;
pub use scene::{BodyInfo, ColumnInfo, SceneInfo};

use crate::{Error, PathFormat, PathRows, Scene};
use mp_io::{Content, ProblemChanges};
use serde::Serialize;
use std::fmt;
use std::path::Path;

/// What is in a file. `mp info --json` prints its JSON form, in which `kind` is `mesh`, `scene` or `path`.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Info {
    /// A mesh: its surface, size and volume.
    Mesh(MeshInfo),
    /// A scene of any kind.
    Scene(SceneInfo),
    /// A path: its configurations and its length.
    Path(PathInfo),
}

impl Info {
    /// What is in a file, or in the shipped scene of that name.
    ///
    /// # Errors
    /// When the file cannot be read, is of an unknown kind, or is not valid.
    pub fn read(file: &Path) -> Result<Self, Error> {
        Self::read_changed(file, &ProblemChanges::default())
    }

    /// As [`read`](Self::read), of a scene with changes: see [`Scene::load_changed`].
    ///
    /// # Errors
    /// As [`read`](Self::read), and when the changes make no sense, or there is no scene to change.
    pub fn read_changed(file: &Path, changes: &ProblemChanges) -> Result<Self, Error> {
        let scene = || Scene::find_changed(file, changes, &crate::Interrupt::never());
        if !file.exists() {
            return Ok(Self::Scene(SceneInfo::of(&scene()?)));
        }
        let content = content(file)?;
        if !changes.is_empty() && content != FileContent::Scene {
            return Err(Error::new(format!("{} is no scene: nothing in it can be changed", file.display()))
                .help("leave out --from, --to and --obstacle"));
        }
        Ok(match content {
            FileContent::Mesh => Self::Mesh(MeshInfo::read(file)?),
            FileContent::Scene => Self::Scene(SceneInfo::of(&scene()?)),
            FileContent::Path(format) => Self::Path(PathInfo::of(file, &PathRows::read(file, format, &[])?)),
        })
    }
}

impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mesh(info) => info.fmt(f),
            Self::Scene(info) => info.fmt(f),
            Self::Path(info) => info.fmt(f),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FileContent {
    Mesh,
    Scene,
    Path(PathFormat),
}

/// The content of a file, by its ending; for `.txt` by its first lines.
fn content(file: &Path) -> Result<FileContent, Error> {
    use Content::{CsvPath, JsonPath, Map, MapImage, Robot, RobotMacros, RobotSemantics, TextPath};
    let is_text = Content::of(file).any(|content| content == TextPath);
    match Content::of(file).next().filter(|_| !is_text) {
        Some(Robot | RobotMacros | RobotSemantics | Map | MapImage) => return Ok(FileContent::Scene),
        Some(problem) if problem.is_problem() => return Ok(FileContent::Scene),
        Some(CsvPath) => return Ok(FileContent::Path(PathFormat::Joints)),
        Some(JsonPath) => {
            let poses = PathRows::read(file, PathFormat::Poses, &[]).is_ok();
            return Ok(FileContent::Path(if poses { PathFormat::Poses } else { PathFormat::Joints }));
        }
        Some(mesh) if mesh.is_mesh() => return Ok(FileContent::Mesh),
        _ => {}
    }
    let (_, bytes) = mp_io::read_text(file)?;
    if !is_text && bytes.starts_with(b"<?xml") {
        return Err(Error::new(format!("{} is an XML file, not a scene", file.display())).help(format!(
            "name a scene: {}; or a robot: {}",
            Content::endings(Content::is_problem),
            Content::endings(|content| content == Robot)
        )));
    }
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(1 << 16)]);
    let mut lines = head.lines().map(str::trim).filter(|l| !l.is_empty());
    let (first, second) = (lines.next().unwrap_or_default(), lines.next().unwrap_or_default());
    let counts: Vec<Option<usize>> = first.split_whitespace().map(|w| w.parse().ok()).collect();
    let numbers = second.split_whitespace().count();
    Ok(match (counts.as_slice(), numbers) {
        ([Some(_), Some(joints)], numbers) if *joints == numbers => FileContent::Path(PathFormat::Joints),
        ([Some(_)], 6) => FileContent::Path(PathFormat::Poses),
        _ if first == "Robot" => FileContent::Scene,
        _ => FileContent::Mesh,
    })
}
