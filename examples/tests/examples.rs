//! The programs of the folder `examples` do what they say. That they build outside of the workspace is a check of `cargo xtask ci`.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The folder `examples/NAME`.
fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// What a command prints.
fn output(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|e| panic!("{command:?}: {e}"));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(output.status.success(), "{command:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// Lines of a program that are code.
fn lines(name: &str) -> usize {
    let text = std::fs::read_to_string(folder(name).join("src/main.rs")).unwrap();
    text.lines().filter(|line| !line.trim().is_empty() && !line.trim().starts_with("//")).count()
}

#[test]
fn a_scene_is_planned_for_in_a_few_lines() {
    let printed = output(&mut Command::new(env!("CARGO_BIN_EXE_plan-a-scene")));
    assert!(printed.contains("configurations, clear by"), "{printed}");
    assert!(lines("plan-a-scene") < 20);
}

#[test]
fn a_robot_of_ones_own_needs_the_vocabulary_and_the_trees_only() {
    let printed = output(&mut Command::new(env!("CARGO_BIN_EXE_own-robot")));
    let (first, last) = (printed.lines().next().unwrap(), printed.lines().last().unwrap());
    assert_eq!(
        [first, last],
        ["Leaves { left: 0.0, right: 0.0 }", "Leaves { left: 1.5, right: 0.0 }"],
        "{printed}"
    );
}

/// The files of the documentation.
fn pages(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            pages(&path, out);
        } else if path.extension().is_some_and(|e| e == "md") {
            out.push(path);
        }
    }
}

#[test]
fn rust_in_the_documentation_runs() {
    let printed =
        output(Command::new(env!("CARGO_BIN_EXE_documentation")).current_dir(env!("CARGO_TARGET_TMPDIR")));
    assert_eq!(printed.matches("m long").count(), 2, "{printed}");
    let code = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let program = code(&std::fs::read_to_string(folder("documentation").join("src/main.rs")).unwrap());
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut files = vec![root.join("README.md")];
    pages(&root.join("docs"), &mut files);
    let mut count = 0;
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        for block in text.split("\n```rust\n").skip(1) {
            let block = block.split("\n```").next().unwrap();
            let shown = file.display();
            assert!(program.contains(&code(block)), "{shown}: not in examples/documentation:\n{block}");
            count += 1;
        }
    }
    assert!(count >= 4, "{count} blocks");
}
