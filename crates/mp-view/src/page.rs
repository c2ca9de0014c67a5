//! The page for the browser, as one file.

use crate::SceneFile;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::{Compression, write::GzEncoder};
use std::io::Write as _;

/// The modules of the page, by their names in imports.
macro_rules! modules {
    ($($name:literal),* $(,)?) => {
        [$((concat!("mp/", $name, ".js"), include_str!(concat!("../page/", $name, ".js")))),*]
    };
}

const MODULES: [(&str, &str); 28] = modules!(
    "buffers",
    "camera",
    "colors",
    "controls",
    "document",
    "dom",
    "ends",
    "gizmo",
    "growing",
    "main",
    "math",
    "message",
    "packed",
    "panels",
    "picking",
    "picture",
    "plot",
    "renderer",
    "scene",
    "session",
    "shaders",
    "shapes",
    "timeline",
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
}

/// The viewer as one HTML file, with a scene and a planner. It opens without a network, and needs a browser with WebGL 2.
///
/// Without a scene, a page with a planner lets people choose one; a page without a planner looks for the file `scene.mpv`
/// beside it. Nothing in a scene is run: names are shown as text.
#[must_use]
pub fn page(scene: Option<&SceneFile>, planner: Planner<'_>) -> String {
    let import = |(name, text): (&str, &str)| {
        format!("\"{name}\":\"data:text/javascript;base64,{}\"", STANDARD.encode(text))
    };
    let imports = MODULES.map(import).join(",");
    let planner = match planner {
        Planner::None => String::new(),
        Planner::Inside(module) => data("planner", module),
        Planner::Server => "<meta name=\"mp-session\" content=\"server\">".to_owned(),
    };
    HTML.replace("<!--STYLE-->", &format!("<style>\n{STYLE}</style>"))
        .replace(
            "<!--IMPORTMAP-->",
            &format!("<script type=\"importmap\">{{\"imports\":{{{imports}}}}}</script>"),
        )
        .replace("<!--SCENE-->", &scene.map_or_else(String::new, |scene| data("scene", &scene.to_bytes())))
        .replace("<!--PLANNER-->", &planner)
}

/// Bytes as a part of the page.
fn data(id: &str, bytes: &[u8]) -> String {
    let text = STANDARD.encode(packed(bytes));
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

    /// The planner is unpacked from the page as it was.
    #[test]
    fn the_planner_is_in_the_page() {
        let module = *b"\0asm\x01\0\0\0";
        let html = page(None, Planner::Inside(&module));
        let (_, rest) = html.split_once("<script id=\"planner\" type=\"application/octet-stream\">").unwrap();
        let bytes = STANDARD.decode(rest.split('<').next().unwrap()).unwrap();
        let mut unpacked = Vec::new();
        std::io::Read::read_to_end(&mut flate2::read::GzDecoder::new(&*bytes), &mut unpacked).unwrap();
        assert_eq!(unpacked, module);
        assert!(!html.contains("mp-session") && !html.contains("id=\"scene\""));
        let served = page(None, Planner::Server);
        assert!(
            served.contains("<meta name=\"mp-session\" content=\"server\">")
                && !served.contains("id=\"planner\"")
        );
    }

    #[test]
    fn the_page_has_a_place_for_each_part() {
        for place in ["<!--STYLE-->", "<!--IMPORTMAP-->", "<!--SCENE-->", "<!--PLANNER-->"] {
            assert_eq!(HTML.matches(place).count(), 1, "{place}");
        }
        // Nothing is loaded from elsewhere.
        for (name, text) in MODULES.into_iter().chain([("index.html", HTML), ("style.css", STYLE)]) {
            assert!(!text.contains("https://") && !text.contains("//cdn"), "{name}");
        }
    }
}
