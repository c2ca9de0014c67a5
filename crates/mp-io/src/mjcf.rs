//! MJCF, the format of MuJoCo: a model becomes a URDF, which all that reads robots reads then, and an SRDF with the pairs of links that may
//! touch and the keyframes. See `docs/formats/mjcf.md`.

mod document;
mod geom;
mod pairs;
mod pose;
#[cfg(test)]
mod tests;
mod tree;
mod write;

use document::{Classes, Model, Source, sources};
use mp_formats::error::{Error, ErrorKind};
use mp_formats::files::Files;
use mp_geom::TriMesh;
use std::collections::BTreeMap;
use std::path::Path;
use tree::Reader;

/// A model of MuJoCo as other formats.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mjcf {
    /// The links and joints.
    pub(crate) urdf: String,
    /// The pairs that may touch, and the named states.
    pub(crate) srdf: String,
    /// Where the lines of the URDF come from.
    pub(crate) origin: Origin,
    /// The bodies that stay where they are when the base of the robot moves.
    pub(crate) scenery: Vec<String>,
    /// Meshes that no file has, by the names that the URDF has for them.
    pub(crate) made: BTreeMap<String, TriMesh>,
}

/// Where the lines of a URDF that was made of other files come from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Origin {
    files: Vec<Source>,
    /// For each line its file and its line there, from 1.
    lines: Vec<(usize, usize)>,
}

impl Origin {
    /// An error in a line of the URDF, counted from 1, where that comes from.
    pub(crate) fn error(&self, line: Option<usize>, message: String) -> Error {
        let kind = ErrorKind::Content;
        let place = line.and_then(|line| self.lines.get(line.checked_sub(1)?));
        match place.and_then(|(file, line)| Some((self.files.get(*file)?, *line))) {
            Some((Source { file, text }, line)) => Error::in_line(kind, file.display(), text, line, message),
            None => Error::new(kind, self.files[0].file.display(), message),
        }
    }
}

/// Whether a text begins as MJCF does.
pub(crate) fn is_mjcf(text: &str) -> bool {
    let mut rest = text.trim_start();
    while let Some((_, end)) =
        [("<?", "?>"), ("<!--", "-->")].into_iter().find(|(start, _)| rest.starts_with(start))
    {
        rest = rest.split_once(end).map_or("", |(_, rest)| rest).trim_start();
    }
    ["<mujoco", "<mujocoinclude"].iter().any(|root| {
        rest.strip_prefix(root)
            .is_some_and(|rest| rest.starts_with(|c: char| c.is_whitespace() || "/>".contains(c)))
    })
}

/// Reads `text`, the content of the model in `file`, and the files that it includes. What is passed over is noted.
///
/// # Errors
/// [`Error`] when a file is not MJCF, or an element makes no sense, with file and line.
pub(crate) fn read(files: &dyn Files, file: &Path, text: String) -> Result<Mjcf, Error> {
    let _span = tracing::debug_span!("mjcf", bytes = text.len()).entered();
    let sources = sources(files, file, text)?;
    let documents = sources.iter().map(Source::parsed).collect::<Result<Vec<_>, _>>()?;
    let model = Model { sources: &sources, documents: &documents };
    let classes = Classes::of(&model)?;
    let mut reader = Reader::new(&model, &classes, files)?;
    reader.world()?;
    let srdf = write::srdf(&mut reader)?;
    for note in reader.notes() {
        files.note(file, &note);
    }
    let (urdf, lines) = write::urdf(&reader);
    let (scenery, made) = (reader.scenery(), reader.made);
    drop(documents);
    Ok(Mjcf { urdf, srdf, origin: Origin { files: sources, lines }, scenery, made })
}
