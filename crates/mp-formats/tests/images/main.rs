//! Images as worlds: every kind of PNG and PNM, and what is wrong with them.

mod png;
mod pnm;

use mp_formats::error::{Error, ErrorKind};
use mp_formats::grid::GridMap;

/// The brightness of the pixels.
fn read(bytes: &[u8]) -> Result<Vec<f32>, Error> {
    GridMap::parse("map.img", bytes).map(|grid| grid.brightness)
}

/// An image that is refused: what kind of error it is, and words of it.
fn refused(bytes: &[u8], kind: ErrorKind, words: &str) {
    let error = read(bytes).unwrap_err();
    let shown = error.to_string();
    assert!(shown.contains(words) && shown.starts_with("map.img:"), "{words}: {shown}");
    assert!(error.kind() == kind && error.remedy().is_some(), "{shown}");
}

#[test]
fn other_formats_are_refused() {
    for bytes in ["", "P", "P0 1 1 0", "P7\nWIDTH 1\n", "GIF89a", "\u{ff}\u{d8}", "BM", "hello"] {
        refused(bytes.as_bytes(), ErrorKind::Format, "neither a PNG nor a PGM image");
    }
}
