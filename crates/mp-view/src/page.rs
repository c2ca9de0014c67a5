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

const MODULES: [(&str, &str); 20] = modules!(
    "buffers",
    "camera",
    "colors",
    "controls",
    "document",
    "dom",
    "gizmo",
    "main",
    "math",
    "packed",
    "panels",
    "picking",
    "picture",
    "plot",
    "renderer",
    "scene",
    "shaders",
    "shapes",
    "timeline",
    "triangulate",
);

const HTML: &str = include_str!("../page/index.html");
const STYLE: &str = include_str!("../page/style.css");

impl SceneFile {
    /// The viewer with this scene inside, as one HTML file: it opens without a network, and needs a browser with WebGL 2.
    ///
    /// Nothing in a scene is run: names are shown as text.
    #[must_use]
    pub fn to_html(&self) -> String {
        let import = |(name, text): (&str, &str)| {
            format!("\"{name}\":\"data:text/javascript;base64,{}\"", STANDARD.encode(text))
        };
        let imports = MODULES.map(import).join(",");
        let scene = STANDARD.encode(packed(&self.to_bytes()));
        HTML.replace("<!--STYLE-->", &format!("<style>\n{STYLE}</style>"))
            .replace(
                "<!--IMPORTMAP-->",
                &format!("<script type=\"importmap\">{{\"imports\":{{{imports}}}}}</script>"),
            )
            .replace(
                "<!--SCENE-->",
                &format!("<script id=\"scene\" type=\"application/octet-stream\">{scene}</script>"),
            )
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

    #[test]
    fn the_page_has_a_place_for_each_part() {
        for place in ["<!--STYLE-->", "<!--IMPORTMAP-->", "<!--SCENE-->"] {
            assert_eq!(HTML.matches(place).count(), 1, "{place}");
        }
        // Nothing is loaded from elsewhere.
        for (name, text) in MODULES.into_iter().chain([("index.html", HTML), ("style.css", STYLE)]) {
            assert!(!text.contains("https://") && !text.contains("//cdn"), "{name}");
        }
    }
}
