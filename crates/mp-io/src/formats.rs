//! The table of file formats: what files with which endings hold, and who reads those that are meshes. Whatever tells files
//! apart by their names asks this table.
//!
//! A mesh format is a row of the table, and a file in the folder `formats`.

pub(crate) mod collada;
pub(crate) mod obj;
pub(crate) mod off;
pub(crate) mod stl;

use crate::error::{Error, ErrorKind};
use crate::gempa::mesh as gempa;
use crate::mesh::ReadMesh;
use std::path::Path;

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Content {
    /// A GEMPA environment.
    Environment,
    /// A problem of OMPL.app.
    OmplApp,
    /// A problem in TOML, for any robot.
    Toml,
    /// A scene as an editor keeps it.
    Document,
    /// A robot.
    Robot,
    /// A robot with macros, which are to be expanded first.
    RobotMacros,
    /// Groups of links, and the pairs of links that may touch.
    RobotSemantics,
    /// A map of ROS, which names its image.
    Map,
    /// The image of a map.
    MapImage,
    /// A triangle mesh.
    Mesh,
    /// A path in the text form of the robot.
    TextPath,
    /// A path in JSON.
    JsonPath,
    /// A path as comma-separated values.
    CsvPath,
    /// A picture made of pixels.
    Png,
    /// A picture made of lines and areas.
    Svg,
    /// A film in few colours.
    Gif,
    /// A film by ffmpeg.
    Mp4,
    /// The page of the viewer with the scene inside.
    Page,
    /// The scene as the viewer reads it.
    ViewerScene,
    /// Meshes that move, for other programs.
    Gltf,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Format {
    /// What such files hold.
    pub content: Content,
    /// Its name, for people.
    pub name: &'static str,
    /// The endings of its files, in small letters, the usual one first.
    pub endings: &'static [&'static str],
    /// Whether such files are read.
    pub read: bool,
    /// Whether such files are written.
    pub written: bool,
    /// Whether these bytes begin like such a mesh, and what reads it.
    mesh: Option<(fn(&[u8]) -> bool, ReadMesh)>,
}

use Content::{
    CsvPath, Document, Environment, Gif, Gltf, JsonPath, Map, MapImage, Mesh, Mp4, OmplApp, Page, Png,
};
use Content::{Robot, RobotMacros, RobotSemantics, Svg, TextPath, Toml, ViewerScene};

/// All formats whose files are told by their endings. Where an ending has several, the likeliest comes first.
#[rustfmt::skip]
pub const FORMATS: [Format; 24] = [
    row(Environment, "GEMPA environment", &["env", "txt"], true, true),
    row(OmplApp, "OMPL.app problem", &["cfg"], true, false),
    row(Toml, "robot, rigid body or world in the plane", &["toml"], true, false),
    row(Document, "scene of the editor", &["mp.json"], true, true),
    // Robots of other formats than URDF are told by their content what they are.
    row(Robot, "URDF", &["urdf", "xml", "sdf", "world", "mjcf"], true, false),
    row(RobotMacros, "robot description with macros", &["xacro"], false, false),
    row(RobotSemantics, "SRDF", &["srdf"], true, false),
    row(Map, "map of ROS", &["yaml", "yml"], true, false),
    row(MapImage, "image of a map", &["png", "pgm", "pbm", "ppm"], true, false),
    mesh("OFF", &["off"], true, off::begins, off::read),
    mesh("GEMPA triangles", &["txt"], true, |_| false, |file, bytes, _| gempa::parse_gempa_mesh(file, bytes)),
    mesh("STL", &["stl", "stla", "stlb"], true, stl::begins, stl::read),
    mesh("OBJ", &["obj"], false, |_| false, obj::read),
    mesh("COLLADA", &["dae"], false, collada::begins, collada::read),
    row(TextPath, "path as text", &["txt", "path"], true, true),
    row(JsonPath, "path as JSON", &["json"], true, true),
    row(CsvPath, "path as comma-separated values", &["csv"], true, true),
    row(Png, "picture in pixels", &["png"], false, true),
    row(Svg, "picture in lines and areas", &["svg"], false, true),
    row(Gif, "film in few colours", &["gif"], false, true),
    row(Mp4, "film", &["mp4"], false, true),
    row(Page, "page of the viewer", &["html", "htm"], false, true),
    row(ViewerScene, "scene of the viewer", &["mpv"], true, true),
    row(Gltf, "binary glTF", &["glb"], false, true),
];

const fn row(
    content: Content,
    name: &'static str,
    endings: &'static [&'static str],
    read: bool,
    written: bool,
) -> Format {
    Format { content, name, endings, read, written, mesh: None }
}

const fn mesh(
    name: &'static str,
    endings: &'static [&'static str],
    written: bool,
    begins: fn(&[u8]) -> bool,
    read: ReadMesh,
) -> Format {
    Format { mesh: Some((begins, read)), ..row(Mesh, name, endings, true, written) }
}

impl Format {
    /// The formats of files with this name, the likeliest first.
    pub fn named(file: &Path) -> impl Iterator<Item = &'static Self> {
        let name = file.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        let ends = move |ending: &&str| {
            name.strip_suffix(*ending)
                .and_then(|rest| rest.strip_suffix('.'))
                .is_some_and(|stem| !stem.is_empty())
        };
        FORMATS.iter().filter(move |format| format.endings.iter().any(&ends))
    }

    /// The format of a mesh, by the name of its file if that can be nothing else, or else by its content.
    #[must_use]
    pub fn of_mesh(file: &Path, bytes: &[u8]) -> Option<&'static Self> {
        let mut named = Self::named(file).filter(|format| format.mesh.is_some());
        let begins = |format: &&Self| format.mesh.is_some_and(|(begins, _)| begins(bytes));
        match Content::of(file).all(|content| content == Mesh) {
            true => named.next().or_else(|| FORMATS.iter().find(begins)),
            false => FORMATS.iter().find(begins).or_else(|| named.next()),
        }
    }

    /// What reads a mesh of this format.
    pub(crate) fn mesh_reader(&self) -> Option<ReadMesh> {
        self.mesh.map(|(_, read)| read)
    }
}

impl Content {
    /// What a file with this name may hold, the likeliest first.
    pub fn of(file: &Path) -> impl Iterator<Item = Self> {
        Format::named(file).map(|format| format.content)
    }

    /// Whether it is a whole problem: robot, obstacles, start and goal.
    #[must_use]
    pub fn is_problem(self) -> bool {
        matches!(self, Environment | OmplApp | Toml | Document)
    }

    /// Whether it is a path.
    #[must_use]
    pub fn is_path(self) -> bool {
        matches!(self, TextPath | JsonPath | CsvPath)
    }

    /// Whether it shows a scene: a picture, a film, or what a viewer shows.
    #[must_use]
    pub fn is_shown(self) -> bool {
        matches!(self, Png | Svg | Gif | Mp4 | Page | ViewerScene | Gltf)
    }

    /// The usual ending of such files: the first of its row.
    #[must_use]
    pub fn ending(self) -> &'static str {
        FORMATS.iter().find(|format| format.content == self).map_or("", |format| format.endings[0])
    }

    /// The usual endings of all formats that hold what is `wanted`, for people: `.txt, .json or .csv`.
    pub fn endings(wanted: impl Fn(Self) -> bool) -> String {
        let wanted = FORMATS.iter().filter(|format| wanted(format.content));
        let endings: Vec<_> = wanted.map(|format| format!(".{}", format.endings[0])).collect();
        match endings.split_last() {
            Some((last, [])) => last.clone(),
            Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
            None => String::new(),
        }
    }

    /// The error of a file whose name does not end as that of `what`, which has to hold what is `wanted`.
    pub fn not_named(file: &Path, what: &str, wanted: impl Fn(Self) -> bool) -> Error {
        let message = match file.extension() {
            Some(ending) => {
                format!("cannot write {what} as .{}", ending.to_string_lossy().to_ascii_lowercase())
            }
            None => format!("the name has no ending, which says how to write {what}"),
        };
        let help = format!("end its name in {}", Self::endings(wanted));
        Error::new(ErrorKind::Unsupported, file.display(), message).help(help)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_are_told_by_name_or_content() {
        let of = |name: &str, bytes: &[u8]| Format::of_mesh(Path::new(name), bytes).map(|format| format.name);
        assert_eq!(of("a.OFF", b""), Some("OFF"));
        assert_eq!(of("a.txt", b"12\n"), Some("GEMPA triangles"));
        assert_eq!(of("a.txt", b"\n COFF # x"), Some("OFF"));
        assert_eq!(of("a", b"OFF 1 2 3"), Some("OFF"));
        assert_eq!(of("a", b"solid x\n facet normal 0 0 1"), Some("STL"));
        assert_eq!(of("a.stl", b"OFF in the header of a binary file"), Some("STL"));
        assert_eq!(of("a.xml", b"<?xml?><COLLADA"), Some("COLLADA"));
        assert_eq!(of("a.step", b"ISO-10303-21;"), None);
    }

    #[test]
    fn names_say_what_files_may_hold() {
        let of = |name: &str| Content::of(Path::new(name)).collect::<Vec<_>>();
        assert_eq!(of("room.txt"), [Environment, Mesh, TextPath]);
        assert_eq!(of("room.mp.json"), [Document, JsonPath]);
        assert_eq!(of("folder.off/Map.PNG"), [MapImage, Png]);
        for other in ["off", ".off", "a.off/b", "a.offs", ""] {
            assert!(of(other).is_empty(), "{other}");
        }
    }

    #[test]
    fn all_endings_are_documented() {
        let guide = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/formats/README.md");
        let guide = std::fs::read_to_string(guide).unwrap();
        for format in FORMATS {
            for ending in format.endings {
                assert!(guide.contains(&format!("`.{ending}`")), "{}: .{ending}", format.name);
            }
        }
    }
}
