//! The museum of issues: the page says what the program says.

use crate::common::{Dir, Run, fed, mp};
use std::path::Path;

fn museum() -> (Dir, String) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/museum");
    let dir = Dir::empty();
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        if entry.file_type().unwrap().is_file() {
            dir.write(&entry.file_name().to_string_lossy(), std::fs::read(entry.path()).unwrap());
        }
    }
    let page = dir.read("README.md");
    (dir, page)
}

fn free(run: &Run) -> bool {
    assert_eq!(run.stdout.contains(": certified free in "), run.code == 0, "{run:?}");
    assert!(run.code < 2, "{run:?}");
    run.code == 0
}

#[test]
fn every_exhibit_is_answered_as_the_page_says() {
    let (dir, page) = museum();
    let exhibits: Vec<_> = page.split("\n## ").skip(1).collect();
    assert_eq!(exhibits.len(), 12);
    for exhibit in exhibits {
        assert!(exhibit.contains("](https://github.com/"), "{exhibit}");
        let block = |kind: &str| {
            let (_, rest) = exhibit.split_once(&format!("\n```{kind}\n")).unwrap();
            rest.split_once("```").unwrap().0
        };
        let command = block("sh").trim_end().strip_prefix("mp ").unwrap();
        let run = mp(&dir, &command.split(' ').collect::<Vec<_>>());
        assert_eq!(run.stdout, block("text"), "{command}: {}", run.stderr);
        assert!(!free(&run), "{command}");
        // The robot of the scene is free where it stands.
        let scene = command.split(' ').nth(1).unwrap();
        let info = mp(&dir, &["info", scene]);
        assert_eq!(info.code, 0, "{info:?}");
    }
}

#[test]
fn what_was_planned_is_free() {
    let (dir, _) = museum();
    for args in [
        ["check", "carried-as-planned.toml", "carried.json"].as_slice(),
        &["check", "blend.toml", "blend-as-planned.csv"],
        &["check", "spline.toml", "spline.csv", "--as", "linear"],
        &["check", "wrap.toml", "wrap.yaml", "--from", "0 3.183185307179586"],
        &["check", "start.toml", "start.csv", "--from", "0.6 -0.3"],
    ] {
        let run = mp(&dir, args);
        assert!(free(&run), "{args:?}: {run:?}");
    }
    let wrapped = ["check", "wrap.toml", "-", "--from", "0 3.183185307179586"];
    assert!(free(&fed(&dir, &wrapped, &dir.read("wrap.yaml"))));
    let degrees = dir.read("degrees.csv").replace("shoulder,elbow", "shoulder [deg],elbow [deg]");
    assert!(free(&fed(&dir, &["check", "degrees.toml", "-"], &degrees)));
    let by_place = dir.read("names.csv").replace("elbow,shoulder", "shoulder,elbow");
    let run = fed(&dir, &["check", "names.toml", "-"], &by_place);
    assert!(!free(&run) && run.stdout.contains("does not end") && !run.stdout.contains("hits"), "{run:?}");
}
