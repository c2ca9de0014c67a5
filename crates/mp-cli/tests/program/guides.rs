//! The guides of the documentation are true: their files are written, and their commands run in order.

use crate::common::Dir;
use std::path::Path;
use std::process::Command;

/// Writes the files of a page (blocks with a title) to `dir`, and runs its commands (lines of `sh` blocks). How many these are.
fn follow(page: &str, dir: &Dir) -> usize {
    let mut count = 0;
    let mut blocks = page.split("\n```");
    while let (Some(_), Some(block)) = (blocks.next(), blocks.next()) {
        let (kind, text) = block.split_once('\n').unwrap();
        if let Some((_, title)) = kind.split_once("title=") {
            dir.write(title.trim_matches('"'), format!("{text}\n"));
        } else if kind == "sh" {
            for line in text.lines() {
                run(line, dir);
                count += 1;
            }
        }
    }
    count
}

fn run(line: &str, dir: &Dir) {
    let programs = Path::new(env!("CARGO_BIN_EXE_mp")).parent().unwrap();
    let search = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap_or_default());
    let output =
        Command::new("sh").args(["-c", line]).current_dir(dir.path("")).env("PATH", search).output().unwrap();
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn guides_can_be_followed() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guides");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let page = std::fs::read_to_string(entry.unwrap().path()).unwrap();
        count += follow(&page, &Dir::empty());
    }
    assert!(count > 15, "{count} commands");
}
