//! What goes into the file of a picture, by the ending of its name.

use mp_plan::{Error, PathRows, PictureKind, Report, Scene};
use mp_view::SceneFile;
use std::path::Path;

/// What goes into the file of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Picture {
    /// A picture, `.png` or `.svg`.
    Drawn(PictureKind),
    /// `.html`: the viewer with the scene inside, for a browser.
    Page,
    /// `.mpv`: the scene as the viewer reads it.
    Scene,
}

impl Picture {
    /// By the ending of the name of `file`.
    ///
    /// # Errors
    /// When this scene cannot be written as such a file.
    pub(crate) fn of(scene: &Scene, file: &Path) -> Result<Self, Error> {
        let ending = file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        match ending.as_str() {
            "html" | "htm" => Ok(Self::Page),
            "mpv" => Ok(Self::Scene),
            _ => Ok(Self::Drawn(scene.picture_kind(file)?)),
        }
    }

    /// The bytes of the file. A page shows the report too, if there is one.
    pub(crate) fn bytes(
        self,
        scene: &Scene,
        path: Option<&PathRows>,
        report: Option<&Report>,
        caption: &str,
        size: (usize, usize),
    ) -> Result<Vec<u8>, Error> {
        if let Self::Drawn(kind) = self {
            return scene.picture(path, caption, kind, size);
        }
        let mut file = SceneFile::of(scene)?;
        match (report, path) {
            (Some(report), _) => file.add_report(scene, report)?,
            (None, Some(path)) => file.add_path(scene, "path", path)?,
            (None, None) => {}
        }
        Ok(if self == Self::Page { file.to_html().into_bytes() } else { file.to_bytes() })
    }
}
