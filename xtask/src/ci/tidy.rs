//! Checks beyond those of the compiler: that the crates depend on each other as `ARCHITECTURE.md` says, that
//! the paths it names exist, that no folders of a crate import each other in a circle, that every file is
//! named after what it holds, that every algorithm has an example and a test, and that no link of the
//! documentation is dead.

use super::{circles, links};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The error is a message that says why a check could not be made.
pub(super) type Result<T> = std::result::Result<T, String>;

/// Names that say nothing about what a file or folder holds.
const VAGUE_NAMES: [&str; 8] = ["common", "helper", "helpers", "misc", "shared", "stuff", "util", "utils"];

/// The program that must share no code with the others.
const ALONE: &str = "crates/mp-verify-certificate";

/// The most lines of code that it may have, without tests, comments and blank lines: it must be small enough to be read.
const ALONE_LINES: usize = 1220;

/// Calls that only `mp-store` makes: what it reads has a limit, and what it writes is whole.
const FILE_CALLS: [&str; 7] = [
    "fs::read(",
    "fs::read_to_string(",
    "fs::write(",
    "fs::rename(",
    "File::open(",
    "File::create(",
    "OpenOptions::new(",
];

/// Sources with such calls: a temporary folder of its own, and the shipped scenes.
const OWN_FILES: [&str; 2] = ["mp-plan/src/picture/mp4.rs", "mp-scenes/src/source.rs"];

/// The oracle of `mp-soak`, and the crates that it may use: it judges paths without any code of the project.
const ORACLE: &str = "crates/mp-soak/src/oracle";
const ORACLE_USES: [&str; 5] = ["nalgebra", "parry3d_f64", "self", "std", "super"];

/// All errors found in the workspace at `root`, a line each.
pub(crate) fn check(root: &Path) -> Result<Vec<String>> {
    let architecture = read(&root.join("ARCHITECTURE.md"))?;
    let mut findings = arrows(root, &architecture)?;
    findings.extend(missing_paths(root, &architecture));
    findings.extend(links::dead(root)?);
    let mut paths = Vec::new();
    for folder in ["crates", "mpi", "python", "xtask"] {
        rust_files(&root.join(folder), &mut paths)?;
    }
    paths.sort();
    let sources = paths.into_iter().map(|p| read(&p).map(|text| (p, text))).collect::<Result<Vec<_>>>()?;
    for src in paths_of_crates(root)? {
        if let Some(circle) = circles::of(&src, &sources) {
            let (shown, circle) = (src.strip_prefix(root).unwrap_or(&src).display(), circle.join(" → "));
            findings.push(format!("{shown} has a circle of imports between folders: {circle}"));
        }
    }
    findings.extend(alone_lines(
        sources.iter().map(|(p, text)| (p.strip_prefix(root).unwrap_or(p), text.as_str())),
    ));
    for src in paths_of_crates(root)? {
        let manifest = read(&src.with_file_name("Cargo.toml"))?;
        let of_crate = sources.iter().filter(|(path, _)| path.starts_with(&src));
        findings.extend(idle_tests(
            &manifest,
            of_crate.map(|(p, text)| (p.strip_prefix(root).unwrap_or(p), text)),
        ));
    }
    for (path, text) in &sources {
        let path = path.strip_prefix(root).unwrap_or(path);
        findings.extend(file_calls(path, text));
        findings.extend(oracle_uses(path, text));
        let shown = path.display();
        if has_vague_name(path) {
            findings.push(format!("{shown} has a name that does not say what it holds"));
        }
        findings.extend(algorithm(&sources, path).map(|lack| format!("{shown} has no {lack}")));
    }
    Ok(findings)
}

/// Tests that never run, as they are in the sources of a library whose manifest says that it has none.
fn idle_tests<'s>(manifest: &str, sources: impl Iterator<Item = (&'s Path, &'s String)>) -> Vec<String> {
    let mut of_lib = manifest.lines().skip_while(|line| line.trim() != "[lib]").skip(1);
    let has_none =
        of_lib.by_ref().take_while(|line| !line.starts_with('[')).any(|line| line.trim() == "test = false");
    let with_tests = sources.filter(|(_, text)| has_none && text.contains("#[cfg(test)]"));
    with_tests
        .map(|(path, _)| {
            format!(
                "{} has tests that never run: `test = false` in the manifest; put them into `tests`",
                path.display()
            )
        })
        .collect()
}

/// The folders of sources of all crates.
fn paths_of_crates(root: &Path) -> Result<Vec<PathBuf>> {
    let crates = root.join("crates");
    let crates = list(&crates)?.map(|folder| Ok(folder?.join("src")));
    crates.chain([Ok(root.join("python/src"))]).collect()
}

/// Whether the program that shares no code has become long.
fn alone_lines<'s>(sources: impl Iterator<Item = (&'s Path, &'s str)>) -> Option<String> {
    let src = Path::new(ALONE).join("src");
    let own = sources.filter(|(path, _)| path.starts_with(&src) && !path.ends_with("tests.rs"));
    let code = |line: &&str| !(line.trim().is_empty() || line.trim_start().starts_with("//"));
    let lines: usize = own.map(|(_, text)| text.lines().filter(code).count()).sum();
    let long = || {
        format!(
            "{ALONE} has {lines} lines of code, and must have fewer than {ALONE_LINES}: it is read by who must trust it"
        )
    };
    (lines >= ALONE_LINES).then(long)
}

pub(super) fn read(path: &Path) -> Result<String> {
    std::fs::read_to_string(path).map_err(|e| format!("cannot read {}: {e}", path.display()))
}

pub(super) fn list(folder: &Path) -> Result<impl Iterator<Item = Result<PathBuf>>> {
    let failed = |e: std::io::Error| format!("cannot list {}: {e}", folder.display());
    let entries: Vec<_> =
        std::fs::read_dir(folder).map_err(failed)?.map(|e| e.map(|e| e.path()).map_err(failed)).collect();
    Ok(entries.into_iter())
}

fn rust_files(folder: &Path, out: &mut Vec<PathBuf>) -> Result<()> {
    for entry in list(folder)? {
        let path = entry?;
        if path.is_dir() && !path.ends_with("target") {
            rust_files(&path, out)?;
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
    Ok(())
}

/// The rows of the code map, `| crate | … | dependencies |`: crate and dependencies.
fn code_map(architecture: &str) -> Vec<(String, BTreeSet<String>)> {
    let words = |cell: &str| -> BTreeSet<String> {
        let separators = |c: char| !(c.is_ascii_alphanumeric() || c == '-');
        cell.split(separators).filter(|w| *w == "mp" || w.starts_with("mp-")).map(str::to_owned).collect()
    };
    let rows = architecture.lines().filter(|line| line.starts_with("| `"));
    rows.filter_map(|row| {
        let cells: Vec<&str> = row.trim().trim_matches('|').split('|').collect();
        let name = cells.first()?.trim().trim_matches('`').to_owned();
        Some((name, words(cells.last()?)))
    })
    .collect()
}

/// The workspace's crates among the `[dependencies]` of a manifest.
fn dependencies(manifest: &str) -> BTreeSet<String> {
    let mut section = "";
    let mut out = BTreeSet::new();
    for line in manifest.lines().map(str::trim) {
        if line.starts_with('[') {
            section = line;
        } else if section == "[dependencies]"
            && let Some((name, _)) = line.split_once(['=', '.'])
        {
            let name = name.trim();
            if name == "mp" || name.starts_with("mp-") {
                out.insert(name.to_owned());
            }
        }
    }
    out
}

/// Differences between the dependencies in the code map and those in the manifests.
fn arrows(root: &Path, architecture: &str) -> Result<Vec<String>> {
    let map = code_map(architecture);
    let mut findings = Vec::new();
    let mut folders = ["mpi", "python", "xtask"].map(|name| root.join(name)).to_vec();
    let crates = root.join("crates");
    for entry in list(&crates)? {
        folders.push(entry?);
    }
    folders.sort();
    for folder in folders.iter().filter(|f| f.join("Cargo.toml").is_file()) {
        let name = folder.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let real = dependencies(&read(&folder.join("Cargo.toml"))?);
        match map.iter().find(|(n, _)| *n == name) {
            None => findings.push(format!("{name} is missing in the code map of ARCHITECTURE.md")),
            Some((_, said)) if *said != real => {
                findings.push(format!("{name} depends on {real:?}, but ARCHITECTURE.md says {said:?}"))
            }
            Some(_) => {}
        }
    }
    let known = |name: &str| folders.iter().any(|f| f.file_name().is_some_and(|n| n == name));
    let gone = map.iter().filter(|(name, _)| !known(name));
    findings.extend(gone.map(|(name, _)| format!("ARCHITECTURE.md names the crate {name}: there is none")));
    Ok(findings)
}

/// Paths in backticks that do not exist.
fn missing_paths(root: &Path, architecture: &str) -> Vec<String> {
    let quoted = architecture.split('`').skip(1).step_by(2);
    let paths = quoted.filter(|q| {
        q.contains('/')
            && q.chars().all(|c| c.is_ascii_alphanumeric() || "/._-".contains(c))
            && !q.starts_with('/')
    });
    let missing = paths.filter(|p| !root.join(p).exists());
    missing.map(|p| format!("ARCHITECTURE.md names {p}, which does not exist")).collect()
}

/// Whether the file, or a folder of it under `src`, has one of the [`VAGUE_NAMES`].
fn has_vague_name(path: &Path) -> bool {
    let in_src = path.iter().skip_while(|part| *part != "src");
    in_src
        .filter_map(|part| Path::new(part).file_stem())
        .any(|stem| VAGUE_NAMES.iter().any(|name| stem == *name))
}

/// The [`FILE_CALLS`] in the code of a library or program, but not in its tests.
fn file_calls(path: &Path, text: &str) -> Vec<String> {
    let is_test = path.iter().any(|part| part == "tests" || part == "tests.rs" || part == "examples");
    let is_own = OWN_FILES.iter().any(|own| path.ends_with(own));
    if is_test
        || is_own
        || !path.starts_with("crates")
        || path.starts_with("crates/mp-store")
        || path.starts_with(ALONE)
    {
        return Vec::new();
    }
    let code = ["#[cfg(test)]\nmod tests", "#![cfg(test)]"]
        .iter()
        .fold(text, |code, tests| code.split(tests).next().unwrap_or_default());
    let lines = code.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//"));
    let found =
        lines.filter_map(|(i, line)| Some((i, FILE_CALLS.iter().find(|call| line.contains(**call))?)));
    found
        .map(|(i, call)| {
            format!(
                "{}, line {}: files are read and written by mp-store, not by {call}…)",
                path.display(),
                i + 1
            )
        })
        .collect()
}

/// What a file of the [`ORACLE`] uses beyond its own files and [`ORACLE_USES`], tests apart.
fn oracle_uses(path: &Path, text: &str) -> Vec<String> {
    if !path.starts_with(ORACLE) {
        return Vec::new();
    }
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let lines = code.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//"));
    let foreign = |line: &str| {
        let used = line.trim_start().trim_start_matches("pub ").strip_prefix("use ");
        let first = used.map(|used| used.split([':', ';', ' ']).next().unwrap_or_default());
        let known = |first: &str| ORACLE_USES.contains(&first) || text.contains(&format!("mod {first};"));
        line.contains("mp_") || line.contains("crate::") || first.is_some_and(|first| !known(first))
    };
    let found = lines.filter(|(_, line)| foreign(line));
    found
        .map(|(i, line)| {
            format!(
                "{}, line {}: the oracle uses no code of the project: {}",
                path.display(),
                i + 1,
                line.trim()
            )
        })
        .collect()
}

/// What the file of an algorithm (`…/algo/NAME.rs`) lacks: an example called NAME, or a test. The test may be in the
/// file itself, in a file called NAME, or in one that names the algorithm or its type; for an algorithm that can be made
/// by name, also in one that runs all of these.
fn algorithm(sources: &[(PathBuf, String)], path: &Path) -> Option<&'static str> {
    if !path.parent().is_some_and(|p| p.ends_with("src/algo")) || path.ends_with("mod.rs") {
        return None;
    }
    let name = path.file_name()?;
    let stem = path.file_stem()?.to_string_lossy();
    let word = format!("\"{}\"", stem.replace('_', "-"));
    let made_by_name = |(s, text): &(PathBuf, String)| s == path && text.contains("const INFO: PlannerInfo");
    let registered = sources.iter().any(made_by_name);
    let capital = |part: &str| part[..1].to_uppercase() + &part[1..];
    let kind: String = stem.split('_').filter(|part| !part.is_empty()).map(capital).collect();
    let within = |s: &Path, folder: &str| s.ancestors().any(|p| p.ends_with(folder));
    if !sources.iter().any(|(s, _)| s.file_name() == Some(name) && within(s, "examples")) {
        return Some("example of its name");
    }
    let tests = |(s, text): &(PathBuf, String)| {
        (s == path && text.contains("#[cfg(test)]"))
            || (within(s, "tests")
                && (s.file_name() == Some(name)
                    || text.contains(&word)
                    || text.contains(&kind)
                    || (registered && text.contains("in planners()"))))
    };
    if sources.iter().any(tests) { None } else { Some("test") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_program_that_shares_no_code_stays_short() {
        let code = "fn f() {\n    // why\n\n}\n";
        let of = |times: usize| {
            let (src, tests) =
                (Path::new(ALONE).join("src/x.rs"), Path::new(ALONE).join("src/shape/tests.rs"));
            let (text, other) = (code.repeat(times), code.repeat(1000));
            let sources =
                [(&src, &text), (&tests, &other), (&PathBuf::from("crates/mp-io/src/x.rs"), &other)];
            alone_lines(sources.into_iter().map(|(path, text)| (path.as_path(), text.as_str())))
        };
        assert_eq!(of(609), None);
        assert!(of(610).unwrap().contains("1220 lines of code"));
    }

    #[test]
    fn the_workspace_is_tidy() {
        let findings = check(&crate::root()).unwrap();
        assert!(findings.is_empty(), "{findings:#?}");
    }

    #[test]
    fn tests_that_never_run_are_found() {
        let (path, text) = (Path::new("crates/mp-x/src/a.rs"), "#[cfg(test)]\nmod tests {}\n".to_owned());
        let found = |manifest: &str| idle_tests(manifest, [(path, &text)].into_iter()).len();
        assert_eq!(found("[package]\nname = \"x\"\n\n# Why.\n[lib]\ntest = false\n"), 1);
        assert_eq!(found("[lib]\ndoctest = false\n\n[[bin]]\nname = \"x\"\ntest = false\n"), 0);
    }

    #[test]
    fn calls_that_read_and_write_files_are_found() {
        let text = "fn f() {\n    // std::fs::write(a, b)\n    std::fs::write(a, b);\n}\n#[cfg(test)]\nmod tests { File::open(x) }\n";
        let found = |path: &str| file_calls(Path::new(path), text);
        assert_eq!(found("crates/mp-x/src/a.rs").len(), 1);
        assert!(found("crates/mp-x/src/a.rs")[0].contains("a.rs, line 3: "));
        let only_tests = "//! Tests.\n#![cfg(test)]\nfn f() {\n    std::fs::write(a, b);\n}\n";
        assert!(file_calls(Path::new("crates/mp-x/src/a.rs"), only_tests).is_empty());
        for path in [
            "crates/mp-store/src/a.rs",
            "crates/mp-x/tests/a.rs",
            "crates/mp-x/src/b/tests.rs",
            "xtask/src/a.rs",
        ] {
            assert!(found(path).is_empty(), "{path}");
        }
    }

    #[test]
    fn the_oracle_uses_nothing_of_ours() {
        let found = |file: &str, text: &str| oracle_uses(&Path::new(ORACLE).join(file), text).len();
        assert_eq!(
            found(
                "a.rs",
                "mod flat;\npub use flat::x;\nuse super::{A};\nuse std::fmt;\nuse nalgebra::Point3;\n"
            ),
            0
        );
        assert_eq!(found("a.rs", "// mp_plan\n#[cfg(test)]\nmod tests { use crate::draw; }\n"), 0);
        for bad in [
            "use mp_math::sin;",
            "    let x = mp_geom::X;",
            "use crate::draw::Draw;",
            "pub use serde::Serialize;",
        ] {
            assert_eq!(found("a.rs", bad), 1, "{bad}");
        }
        assert!(oracle_uses(Path::new("crates/mp-soak/src/trial.rs"), "use mp_plan::Scene;").is_empty());
    }

    #[test]
    fn sources_are_named_after_what_they_hold() {
        let vague = |path: &str| has_vague_name(Path::new(path));
        assert!(vague("crates/mp-x/src/utils.rs") && vague("crates/mp-x/src/misc/mod.rs"));
        assert!(!vague("crates/mp-x/src/boxes.rs") && !vague("crates/mp-x/tests/common/mod.rs"));
    }

    #[test]
    fn code_maps_and_manifests_are_understood() {
        let map = code_map(
            "| crate | x |\n|---|---|\n| `mp-a` | text with mp-z | `mp-b`, mp-c |\n| `mp-b` | t | nalgebra |\n",
        );
        let set = |names: &[&str]| names.iter().map(|s| (*s).to_owned()).collect::<BTreeSet<_>>();
        assert_eq!(map, [("mp-a".into(), set(&["mp-b", "mp-c"])), ("mp-b".into(), set(&[]))]);
        let manifest = "[package]\nname = \"x\"\n[dependencies]\nmp-b = { workspace = true }\nmp-c.workspace = true\nserde = \"1\"\n[dev-dependencies]\nmp-d = \"1\"\n";
        assert_eq!(dependencies(manifest), set(&["mp-b", "mp-c"]));
    }

    #[test]
    fn an_algorithm_needs_an_example_and_a_test() {
        let file = PathBuf::from("crates/mp-x/src/algo/fast.rs");
        let mut sources = vec![(file.clone(), String::new())];
        assert_eq!(algorithm(&sources, &file), Some("example of its name"));
        sources.push(("crates/mp/examples/all/fast.rs".into(), String::new()));
        assert_eq!(algorithm(&sources, &file), Some("test"));
        sources.push(("crates/mp-x/tests/family/all.rs".into(), "run(\"fast\")".into()));
        assert_eq!(algorithm(&sources, &file), None);
        assert_eq!(algorithm(&sources, Path::new("crates/mp-x/src/other.rs")), None);
        sources[2].1 = "for info in planners() {}".into();
        assert_eq!(algorithm(&sources, &file), Some("test"));
        sources[0].1 = "pub const INFO: PlannerInfo = PlannerInfo {}".into();
        assert_eq!(algorithm(&sources, &file), None);
    }
}
