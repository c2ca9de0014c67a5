//! Files of a session: those that a page sends, and those that are written for it.

use super::text_of;
use crate::message::Message;
use mp_io::{Content, FORMATS, Files};
use mp_plan::Error;
use serde_json::Value;
use std::fmt;
use std::path::Path;

/// The endings of files that a page opens, and what such a file is for: `scene`, `mesh`, `path`, `viewer` (a scene file of the
/// viewer) or `text`, whose first lines tell. What is surely a scene comes first, then what a scene may name.
pub(crate) fn endings() -> Vec<(String, &'static str)> {
    let mut all: Vec<(u8, String, &str)> = Vec::new();
    for format in FORMATS.iter().filter(|format| format.read) {
        let (rank, kind) = match format.content {
            Content::Document => (0, "scene"),
            content if content.is_problem() => (1, "scene"),
            Content::Robot | Content::Map | Content::MapImage => (3, "scene"),
            Content::ViewerScene => (3, "viewer"),
            content if content.is_mesh() => (3, "mesh"),
            content if content.is_path() => (3, "path"),
            _ => continue,
        };
        for ending in format.endings.iter().map(|ending| format!(".{ending}")) {
            match all.iter_mut().find(|known| known.1 == ending) {
                Some(known) => (known.0, known.2) = (2, "text"),
                None => all.push((rank, ending, kind)),
            }
        }
    }
    all.sort_by_key(|ending| ending.0);
    all.into_iter().map(|(_, ending, kind)| (ending, kind)).collect()
}

/// Files by name.
pub(crate) struct Named(Vec<(String, Vec<u8>)>);

impl Named {
    /// The files of a request.
    pub(crate) fn of(request: &Message) -> Result<Self, Error> {
        let none = || Error::new("the request has no files");
        let list = request.head.get("files").and_then(Value::as_array).ok_or_else(none)?;
        let mut files = Vec::new();
        let mut left = request.data.len();
        for file in list {
            let members = file.as_object().ok_or_else(none)?;
            let name = text_of(members, "name")?.to_owned();
            let bytes = members.get("bytes").cloned().unwrap_or_default();
            let bytes = request.bytes(&bytes, "bytes").map_err(|e| Error::new(e.to_string()))?;
            // Many files in one place would take memory out of proportion.
            left = left.checked_sub(bytes.len()).ok_or_else(|| Error::new("files of the request overlap"))?;
            files.push((name, bytes));
        }
        if files.is_empty() { Err(none()) } else { Ok(Self(files)) }
    }

    /// The name of the only file; `what` it should be.
    pub(crate) fn only(&self, what: &str) -> Result<&str, Error> {
        match self.0.as_slice() {
            [(name, _)] => Ok(name),
            files => Err(Error::new(format!("{} files are given for one {what}", files.len()))
                .help("give one file at a time")),
        }
    }

    /// The content of a file; nothing if there is no such file.
    pub(crate) fn content(&self, name: &str) -> &[u8] {
        self.find(name).unwrap_or_default()
    }

    fn find(&self, name: &str) -> Option<&[u8]> {
        self.0.iter().find(|file| file.0 == name).map(|file| file.1.as_slice())
    }

    /// The name of the file that is a scene, by its ending.
    pub(crate) fn scene(&self) -> Result<&str, Error> {
        let scenes = endings().into_iter().filter(|(_, kind)| ["scene", "text"].contains(kind));
        let ends = |ending: &str| self.0.iter().find(|file| file.0.to_ascii_lowercase().ends_with(ending));
        let scene = scenes.filter_map(|(ending, _)| ends(&ending)).next();
        // One file of another ending is tried: its error says what it is.
        match (scene, self.0.as_slice()) {
            (Some((name, _)), _) | (None, [(name, _)]) => Ok(name),
            _ => Err(Error::new("none of these files is a scene").help(format!(
                "add the scene itself: {}; or a robot ({}) or a map ({})",
                Content::endings(Content::is_problem),
                Content::endings(|content| content == Content::Robot),
                Content::endings(|content| content == Content::Map)
            ))),
        }
    }
}

impl fmt::Debug for Named {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.0.iter().map(|file| &file.0)).finish()
    }
}

/// A file is found by its name, or else by the last parts of its name, as many as possible: pages do not know folders.
impl Files for Named {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, mp_io::Error> {
        let name = path.to_string_lossy().into_owned();
        let found = self.nearest(&name);
        if let [one, others @ ..] = found.as_slice()
            && let Some(other) = others.iter().find(|other| other.1 != one.1)
        {
            let message = format!("this may be {} or {}, which were opened together", one.0, other.0);
            return Err(mp_io::Error::new(mp_io::ErrorKind::Io, name, message)
                .help("open only the one that is meant, or name its folder in the scene"));
        }
        let memory = mp_io::InMemory(|_: &str| found.first().map(|file| &file.1));
        memory.read(path, limit).map_err(|e| match e.kind() {
            mp_io::ErrorKind::Io => mp_io::Error::new(
                mp_io::ErrorKind::Io,
                name,
                "this file was not opened together with the scene",
            )
            .help("open it together with the scene: choose or drop all files at once"),
            _ => e,
        })
    }
    fn holds(&self, path: &Path) -> bool {
        !self.nearest(&path.to_string_lossy()).is_empty()
    }
}

impl Named {
    /// The file of this name, or else those whose names end most like it.
    fn nearest(&self, name: &str) -> Vec<&(String, Vec<u8>)> {
        let parts = |name: &str| -> Vec<String> {
            let parts = name.split(['/', '\\']).filter(|part| !part.is_empty() && *part != ".");
            parts.rev().map(str::to_owned).collect()
        };
        let wanted = parts(name);
        let alike = |file: &(String, Vec<u8>)| match file.0 == name {
            true => usize::MAX,
            false => parts(&file.0).iter().zip(&wanted).take_while(|(a, b)| a == b).count(),
        };
        let most = self.0.iter().map(alike).max().filter(|most| *most > 0);
        self.0.iter().filter(|file| Some(alike(file)) == most).collect()
    }
}

/// The name of the files to be written, from a request, without an ending. The names that are made of it are checked when they are written.
pub(crate) fn plain_name(request: &Message) -> Result<String, Error> {
    let name = request.head.get("name").and_then(Value::as_str).unwrap_or("scene").trim();
    mp_store::check_name(name)?;
    Ok(name.to_owned())
}

/// The format that a request asks for: one of these, for `what`.
pub(crate) fn format_of<'f>(request: &Message, formats: &[&'f str], what: &str) -> Result<&'f str, Error> {
    let asked = text_of(&request.head, "format")?;
    formats.iter().find(|format| **format == asked).copied().ok_or_else(|| {
        Error::new(format!("there is no format `{asked}` for {what}"))
            .help(format!("take {}", formats.join(" or ")))
    })
}
