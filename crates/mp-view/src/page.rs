//! The page for the browser, as one file.

use crate::message::Message;
use crate::{Mesh, SceneFile};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::{Compression, write::GzEncoder};
use serde_json::json;
use std::collections::BTreeMap;
use std::io::Write as _;

/// The modules of the page, by their names in imports.
macro_rules! modules {
    ($($name:literal),* $(,)?) => {
        [$((concat!("mp/", $name, ".js"), include_str!(concat!("../page/", $name, ".js")))),*]
    };
}

const MODULES: [(&str, &str); 50] = modules!(
    "buffers",
    "camera",
    "colors",
    "controls",
    "copy",
    "coverage",
    "document",
    "dom",
    "editor",
    "ends",
    "endspanel",
    "field",
    "files",
    "following",
    "frames",
    "gallery",
    "gizmo",
    "growing",
    "handles",
    "inspector",
    "jointplots",
    "live",
    "lzma",
    "main",
    "math",
    "message",
    "milestones",
    "opening",
    "pace",
    "packed",
    "panels",
    "picking",
    "picture",
    "planning",
    "plot",
    "recording",
    "renderer",
    "runs",
    "saving",
    "scene",
    "session",
    "shaders",
    "shapes",
    "timeline",
    "timing",
    "triangulate",
    "unsaved",
    "viewer",
    "workbench",
    "worker",
);

const HTML: &str = include_str!("../page/index.html");
const STYLE: &str = include_str!("../page/style.css");

/// Where the planner of a page is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Planner<'a> {
    /// There is none: the page shows the scene inside.
    None,
    /// In the page: the bytes of the WebAssembly module, as docs/formats/session.md describes it.
    Inside(&'a [u8]),
    /// Behind the server that the page comes from.
    Server,
    /// There is none: the page shows what the program that it comes from sends, scenes and paths, as docs/formats/session.md describes
    /// it.
    Elsewhere,
}

/// The viewer as one HTML file, with a scene and a planner. It opens without a network, and needs a browser with WebGL 2.
///
/// Without a scene, a page with a planner lets people choose one; a page without a planner looks for the file `scene.mpv`
/// beside it. Nothing in a scene is run: names are shown as text.
#[must_use]
pub fn page(scene: Option<&SceneFile>, planner: Planner<'_>) -> String {
    let modules: BTreeMap<&str, &str> = MODULES.into_iter().collect();
    let modules = serde_json::to_vec(&modules).unwrap_or_default();
    let planner = match planner {
        Planner::None => String::new(),
        Planner::Inside(module) => part("planner", &mp_store::packed(module)),
        Planner::Server => "<meta name=\"mp-session\" content=\"server\">".to_owned(),
        Planner::Elsewhere => "<meta name=\"mp-session\" content=\"shown\">".to_owned(),
    };
    HTML.replace("<!--STYLE-->", &format!("<style>\n{STYLE}</style>"))
        .replace("<!--MODULES-->", &data("modules", &modules))
        .replace("<!--SCENE-->", &scene.map_or_else(String::new, |scene| data("scene", &scene.to_bytes())))
        .replace("<!--PLANNER-->", &planner)
}

/// With more vertices the meshes of a scene are in a page once, in the files of the scene, and the page shows them when its
/// planner has read those.
const MANY_VERTICES: usize = 5_000;

/// Files with more bytes are packed by gzip: each megabyte would take a second otherwise.
const MOST_SMALL: usize = 4 << 20;

/// As [`page`] with the WebAssembly module `planner` inside, which opens the scene from `files`: names and contents, the scene's own
/// first. So the page can plan in a scene that the module does not have.
#[must_use]
pub fn page_with_files(scene: &SceneFile, planner: &[u8], files: &[(String, Vec<u8>)]) -> String {
    let mut open = Message::default().with("do", "open");
    let list: Vec<_> =
        files.iter().map(|(name, bytes)| json!({"name": name, "bytes": open.array(bytes)})).collect();
    open.set("main", files.first().map(|(name, _)| name.as_str()));
    open.set("files", list);
    let light = SceneFile { meshes: vec![Mesh::default(); scene.meshes.len()], ..scene.clone() };
    let vertices: usize = scene.meshes.iter().map(|mesh| mesh.positions.len() / 3).sum();
    let scene = if vertices > MANY_VERTICES { &light } else { scene };
    let html = page(Some(scene), Planner::Inside(planner));
    let open = open.to_bytes();
    let open =
        if open.len() > MOST_SMALL { data("open", &open) } else { part("open", &mp_store::packed(&open)) };
    html.replacen("<script id=\"planner\"", &format!("{open}\n<script id=\"planner\""), 1)
}

/// Bytes as a part of the page.
fn data(id: &str, bytes: &[u8]) -> String {
    part(id, &packed(bytes))
}

/// A part of the page as it is.
fn part(id: &str, bytes: &[u8]) -> String {
    let text = STANDARD.encode(bytes);
    format!("<script id=\"{id}\" type=\"application/octet-stream\">{text}</script>")
}

impl SceneFile {
    /// The viewer with this scene inside and without a planner: [`page`].
    #[must_use]
    pub fn to_html(&self) -> String {
        page(Some(self), Planner::None)
    }
}

/// Packed by gzip, which browsers unpack. The same bytes give the same bytes.
fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    // Writing to memory does not fail; the page reads bytes that are not packed too.
    written.unwrap_or_else(|_| bytes.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every module of the folder is in the list, and imports only modules that are.
    #[test]
    fn modules_are_complete() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/page");
        let mut files: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| name.ends_with(".js"))
            .map(|name| format!("mp/{name}"))
            .collect();
        files.sort();
        assert_eq!(files, MODULES.map(|(name, _)| name));
        for (name, text) in MODULES {
            for import in text.split("from \"").skip(1) {
                let import = import.split('"').next().unwrap();
                assert!(files.iter().any(|file| file == import), "{name} imports {import}");
            }
        }
    }

    /// A scene is data: its names never become a part of the page's own text.
    #[test]
    fn names_are_not_written_into_the_page() {
        let scene = mp_plan::Scene::find("easy").unwrap();
        let mut file = SceneFile::of(&scene).unwrap();
        let before = file.to_html();
        file.name = "</script><script>alert(1)</script><!--SCENE-->".into();
        let after = file.to_html();
        assert!(!after.contains("alert(1)"));
        assert_eq!(before.matches("<script").count(), after.matches("<script").count());
    }

    /// A part of a page, unpacked as the page does it.
    fn unpacked(html: &str, id: &str) -> Vec<u8> {
        let begin = format!("<script id=\"{id}\" type=\"application/octet-stream\">");
        let (_, rest) = html.split_once(&begin).unwrap();
        let bytes = STANDARD.decode(rest.split('<').next().unwrap()).unwrap();
        let mut unpacked = Vec::new();
        let mut decoder = lzma_rust2::LzmaReader::new_mem_limit(&*bytes, u32::MAX, None).unwrap();
        std::io::Read::read_to_end(&mut decoder, &mut unpacked).unwrap();
        unpacked
    }

    /// The planner is unpacked from the page as it was.
    #[test]
    fn the_planner_is_in_the_page() {
        let module = *b"\0asm\x01\0\0\0";
        let html = page(None, Planner::Inside(&module));
        assert_eq!(unpacked(&html, "planner"), module);
        assert!(!html.contains("mp-session") && !html.contains("id=\"scene\""));
        let served = page(None, Planner::Server);
        assert!(
            served.contains("<meta name=\"mp-session\" content=\"server\">")
                && !served.contains("id=\"planner\"")
        );
    }

    /// A session that gets the request inside the page has the scene open.
    #[test]
    fn the_files_of_a_scene_are_in_the_page() {
        let file = SceneFile::of(&mp_plan::Scene::find("easy").unwrap()).unwrap();
        let cube = b"OFF 4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
        let html = page_with_files(&file, b"module", &[("a.off".to_owned(), cube.to_vec())]);
        let open = Message::parse(&unpacked(&html, "open")).unwrap();
        assert_eq!((&open.head["do"], &open.head["main"]), (&json!("open"), &json!("a.off")));
        assert_eq!(open.bytes(&open.head["files"][0]["bytes"], "bytes").unwrap(), cube);
        assert!(html.find("id=\"open\"") < html.find("id=\"planner\""));
    }

    #[test]
    fn the_page_has_a_place_for_each_part() {
        for place in ["<!--STYLE-->", "<!--MODULES-->", "<!--SCENE-->", "<!--PLANNER-->"] {
            assert_eq!(HTML.matches(place).count(), 1, "{place}");
        }
        // Nothing is loaded from elsewhere.
        for (name, text) in MODULES.into_iter().chain([("index.html", HTML), ("style.css", STYLE)]) {
            assert!(!text.contains("https://") && !text.contains("//cdn"), "{name}");
        }
    }
}
