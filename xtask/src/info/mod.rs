//! `info`: what is in a file.

mod mesh;
mod path;
mod scene;

use crate::cli::Info;
use crate::output::print;
use crate::scenes;
use miette::{IntoDiagnostic, Result, WrapErr, miette};
use mp::io::{FlatProblem, PathFile};
use serde::Serialize;
use std::io::Read;
use std::path::Path;

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Mesh,
    Scene,
    Robot,
    Flat,
    Path,
    JointPath,
}

/// Says what is in the file. True: bad files are errors.
pub(crate) fn run(args: &Info) -> Result<bool> {
    // A name of a shipped scene will do, but a file comes first.
    let file = if args.file.exists() { args.file.clone() } else { scenes::find(&args.file)? };
    match kind(&file)? {
        Kind::Mesh => show(&mesh::Facts::read(&file)?, args.json),
        Kind::Scene => show(&scene::Facts::read(&file)?, args.json),
        Kind::Robot => show(&crate::arm::Facts::read(&file)?, args.json),
        Kind::Flat => show(&crate::flat::Facts::read(&file)?, args.json),
        Kind::JointPath => show(&path::JointFacts::read(&file)?, args.json),
        Kind::Path => show(&path::Facts::read(&file)?, args.json),
    }?;
    Ok(true)
}

fn show(facts: &(impl Serialize + ToString), json: bool) -> Result<()> {
    if json {
        let text = serde_json::to_string(facts).into_diagnostic().wrap_err("cannot write JSON")?;
        return print(&text);
    }
    print(facts.to_string().trim_end())
}

/// Tells files apart by their ending, and `.txt` by how it begins.
fn kind(file: &Path) -> Result<Kind> {
    let ending = file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    match ending.as_str() {
        "env" | "cfg" => return Ok(Kind::Scene),
        "toml" if FlatProblem::is_one(file) => return Ok(Kind::Flat),
        "toml" => return Ok(Kind::Robot),
        "json" => return Ok(if PathFile::read(file).is_ok() { Kind::Path } else { Kind::JointPath }),
        "off" | "stl" | "obj" | "dae" => return Ok(Kind::Mesh),
        _ => {}
    }
    if !file.is_file() {
        return Err(miette!(help = "name a mesh, scene or path file", "{} is not a file", file.display()));
    }
    let mut head = Vec::new();
    let opened = std::fs::File::open(file).and_then(|f| f.take(1 << 16).read_to_end(&mut head));
    opened.into_diagnostic().wrap_err_with(|| format!("cannot read {}", file.display()))?;
    let head = String::from_utf8_lossy(&head);
    let mut lines = head.lines().map(str::trim).filter(|l| !l.is_empty());
    let (first, second) = (lines.next().unwrap_or_default(), lines.next().unwrap_or_default());
    let counts: Vec<Option<usize>> = first.split_whitespace().map(|w| w.parse().ok()).collect();
    let numbers = second.split_whitespace().count();
    if let [Some(_), Some(joints)] = counts[..]
        && joints == numbers
    {
        return Ok(Kind::JointPath);
    }
    let alone = counts.len() == 1;
    Ok(match (first, numbers) {
        ("Robot", _) => Kind::Scene,
        (_, 6) if alone && first.parse::<u64>().is_ok() => Kind::Path,
        _ => Kind::Mesh,
    })
}

/// `1 triangle`, `2 triangles`.
pub(crate) fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// A number for a person: four digits or so.
pub(crate) fn brief(v: f64) -> String {
    let magnitude = v.abs();
    let text = if magnitude != 0.0 && !(1e-3..1e6).contains(&magnitude) {
        return format!("{v:.3e}");
    } else if magnitude >= 100.0 {
        format!("{v:.1}")
    } else {
        format!("{v:.3}")
    };
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn txt_files_are_told_apart_by_how_they_begin() {
        let dir = tempfile::tempdir().unwrap();
        let cases = [
            ("Robot\nr.off\n", Kind::Scene),
            ("\n  2 \n0 0 0 0 0 0\n1 0 0 0 0 0\n", Kind::Path),
            ("1\n0 0 0 1 0 0 0 1 0\n", Kind::Mesh),
            ("2 3\n0 0 0\n1 0 0\n", Kind::JointPath),
            ("OFF\n3 1 0\n", Kind::Mesh),
            ("", Kind::Mesh),
        ];
        for (text, expected) in cases {
            let file = dir.path().join("x.txt");
            std::fs::write(&file, text).unwrap();
            assert_eq!(kind(&file).unwrap(), expected, "{text:?}");
        }
        assert!(kind(dir.path()).is_err());
    }

    #[test]
    fn numbers_are_brief() {
        for (v, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (-0.00001, "-1.000e-5"),
            (12.3456, "12.346"),
            (1234.56, "1234.6"),
            (2e7, "2.000e7"),
        ] {
            assert_eq!(brief(v), text);
        }
    }
}
