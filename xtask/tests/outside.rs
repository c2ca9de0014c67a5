//! Programs outside of the workspace build and run: one depends on `mp-plan` alone, one on `mp-cspace` and `mp-tree` alone.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Builds and runs the program in `examples/NAME`; what it prints.
fn run(name: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let folder = root.join("examples").join(name);
    // The versions of the workspace: nothing is fetched, and what is built already is used.
    std::fs::copy(root.join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    let target = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("outside");
    let output = Command::new(env!("CARGO"))
        .args(["run", "--quiet", "--offline"])
        .current_dir(&folder)
        .env("CARGO_TARGET_DIR", target)
        .output()
        .unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(output.status.success(), "{name}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// Lines of a program that are code.
fn lines(name: &str) -> usize {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let text = std::fs::read_to_string(root.join("examples").join(name).join("src/main.rs")).unwrap();
    text.lines().filter(|line| !line.trim().is_empty() && !line.trim().starts_with("//")).count()
}

#[test]
fn a_scene_is_planned_for_in_a_few_lines() {
    let printed = run("plan-a-scene");
    assert!(printed.contains("configurations, clear by"), "{printed}");
    assert!(lines("plan-a-scene") < 20);
}

#[test]
fn a_robot_of_ones_own_needs_the_vocabulary_and_the_trees_only() {
    let printed = run("own-robot");
    let (first, last) = (printed.lines().next().unwrap(), printed.lines().last().unwrap());
    assert_eq!(
        [first, last],
        ["Leaves { left: 0.0, right: 0.0 }", "Leaves { left: 1.5, right: 0.0 }"],
        "{printed}"
    );
}
