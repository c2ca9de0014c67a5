//! The table of file formats: what files with which endings hold, and who reads those that are meshes. Whatever tells files
//! apart by their names asks this table.
//!
//! A mesh format is a row of the table, and a file in the folder `formats`.

pub mod collada;
pub mod gempa;
pub(crate) mod gltf;
pub(crate) mod obj;
pub mod off;
pub(crate) mod ply;
pub mod stl;

use crate::error::{Error, ErrorKind};
use crate::mesh::ReadMesh;
use std::path::Path;

/// Whether bytes begin like a format.
type Begins = fn(&[u8]) -> bool;

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
    /// If it is a mesh: whether these bytes begin like one, and what reads it.
    mesh: Option<(Begins, ReadMesh)>,
}

macro_rules! formats {
    ($($content:ident, $name:literal, $endings:expr, $read:literal, $written:literal, $mesh:expr;)*) => {
        /// What a file holds: a value for each row of the table.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum Content { $(#[doc = $name] $content),* }
        /// All formats whose files are told by their endings. Where several have an ending, the likeliest comes first.
        pub const FORMATS: &[Format] = &[$(Format {
            content: Content::$content, name: $name, endings: &$endings, read: $read, written: $written, mesh: $mesh,
        }),*];
    };
}

formats! {
    Environment, "GEMPA environment", ["env", "txt"], true, true, None;
    OmplApp, "problem of OMPL.app", ["cfg"], true, false, None;
    Toml, "robot, rigid body or world in the plane", ["toml"], true, false, None;
    Document, "scene of the editor", ["mp.json"], true, true, None;
    Robot, "robot: URDF, or MJCF by its content", ["urdf", "xml", "sdf", "world", "mjcf"], true, false, None;
    RobotMacros, "robot with macros, expanded by the feature `xacro`", ["xacro"], false, false, None;
    RobotSemantics, "links that may touch: SRDF", ["srdf"], true, false, None;
    Map, "map of ROS", ["yaml", "yml"], true, false, None;
    MapImage, "image of a map", ["png", "pgm", "pbm", "ppm"], true, false, None;
    Off, "mesh in OFF", ["off"], true, true, Some((off::begins, off::read));
    Triangles, "mesh in GEMPA's triangles", ["txt"], true, true, Some((|_| false, gempa::read));
    Stl, "mesh in STL", ["stl", "stla", "stlb"], true, true, Some((stl::begins, stl::read));
    Obj, "mesh in OBJ", ["obj"], true, false, Some((|_| false, obj::read));
    Collada, "mesh in COLLADA", ["dae"], true, false, Some((collada::begins, collada::read));
    Ply, "mesh in PLY", ["ply"], true, false, Some((ply::begins, ply::read));
    PointSet, "points, one on each line", ["xyz"], true, false, None;
    Pcd, "points in PCD", ["pcd"], true, false, None;
    NumpyArray, "points in an array of numpy", ["npy"], true, false, None;
    Las, "points in LAS", ["las"], true, false, None;
    TextPath, "path as text of the robot", ["txt", "path"], true, true, None;
    JsonPath, "path as JSON", ["json"], true, true, None;
    CsvPath, "path as comma-separated values", ["csv"], true, true, None;
    Recording, "trajectory as a recording of ROS 2 in MCAP", ["mcap"], true, true, None;
    Png, "picture in pixels", ["png"], false, true, None;
    Svg, "picture in lines and areas", ["svg"], false, true, None;
    Gif, "film in few colours", ["gif"], false, true, None;
    Mp4, "film", ["mp4"], false, true, None;
    Page, "page of the viewer", ["html", "htm"], false, true, None;
    ViewerScene, "scene of the viewer", ["mpv"], true, true, None;
    Gltf, "meshes in binary glTF", ["glb"], true, true, Some((gltf::begins, gltf::read));
    GltfText, "mesh in glTF", ["gltf"], true, false, Some((|_| false, gltf::read));
}

use Content::{
    CsvPath, Document, Environment, Gif, Gltf, JsonPath, Mp4, OmplApp, Page, Png, Svg, TextPath, Toml,
    ViewerScene,
};

impl Content {
    /// What a file with this name may hold, the likeliest first.
    pub fn of(file: &Path) -> impl Iterator<Item = Self> {
        let name = file.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        let ends = move |ending: &&str| {
            let stem = name.strip_suffix(*ending).and_then(|rest| rest.strip_suffix('.'));
            stem.is_some_and(|stem| !stem.is_empty())
        };
        let named = FORMATS.iter().filter(move |format| format.endings.iter().any(&ends));
        named.map(|format| format.content)
    }

    /// The format of a mesh, by the name of its file if that can be nothing else, or else by its content.
    #[must_use]
    pub fn of_mesh(file: &Path, bytes: &[u8]) -> Option<Self> {
        let named = Self::of(file).find(|content| content.is_mesh());
        let begins = |format: &&Format| format.mesh.is_some_and(|(begins, _)| begins(bytes));
        let told = || FORMATS.iter().find(begins).map(|format| format.content);
        let sure = named.filter(|_| Self::of(file).all(Self::is_mesh));
        sure.or_else(told).or(named)
    }

    /// Its row of the table.
    #[must_use]
    pub fn format(self) -> &'static Format {
        &FORMATS[self as usize]
    }

    pub(crate) fn mesh_reader(self) -> Option<ReadMesh> {
        self.format().mesh.map(|(_, read)| read)
    }

    /// Whether the content is a mesh, which `read_mesh` reads.
    #[must_use]
    pub fn is_mesh(self) -> bool {
        self.format().mesh.is_some()
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

    /// The usual ending of such files.
    #[must_use]
    pub fn ending(self) -> &'static str {
        self.format().endings[0]
    }

    /// The usual endings of what is `wanted`, for people: `.txt, .json or .csv`.
    pub fn endings(wanted: impl Fn(Self) -> bool) -> String {
        let wanted = FORMATS.iter().filter(|format| wanted(format.content));
        let endings: Vec<_> = wanted.map(|format| format!(".{}", format.endings[0])).collect();
        match endings.split_last() {
            Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
            _ => endings.concat(),
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
        let of = |name: &str, bytes: &[u8]| Content::of_mesh(Path::new(name), bytes);
        assert_eq!(of("a.OFF", b""), Some(Content::Off));
        assert_eq!(of("a.txt", b"12\n"), Some(Content::Triangles));
        assert_eq!(of("a.txt", b"\n COFF # x"), Some(Content::Off));
        assert_eq!(of("a", b"OFF 1 2 3"), Some(Content::Off));
        assert_eq!(of("a", b"solid x\n facet normal 0 0 1"), Some(Content::Stl));
        assert_eq!(of("a.stl", b"OFF in the header of a binary file"), Some(Content::Stl));
        assert_eq!(of("a.xml", b"<?xml?><COLLADA"), Some(Content::Collada));
        assert_eq!(of("a.step", b"ISO-10303-21;"), None);
    }

    #[test]
    fn names_say_what_files_may_hold() {
        let of = |name: &str| Content::of(Path::new(name)).collect::<Vec<_>>();
        assert_eq!(of("room.txt"), [Environment, Content::Triangles, TextPath]);
        assert_eq!(of("room.mp.json"), [Document, JsonPath]);
        assert_eq!(of("folder.off/Map.PNG"), [Content::MapImage, Png]);
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
