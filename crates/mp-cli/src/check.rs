//! `check`: is a path free, by the checker that shares no code with the planner's?

use crate::cli::Check;
use crate::output::{is_standard, print, standard_input};
use mp_plan::{Error, PathFileKind, PathRows, Scene, brief};
use std::path::Path;

/// Verifies a path, or explains a configuration. True when it is free.
pub(crate) fn run(args: &Check) -> Result<bool, Error> {
    once(&args.scene, args.path.as_deref())?;
    let scene = scene(&args.scene)?;
    if let Some(numbers) = &args.at {
        return explain(&scene, numbers, args.json);
    }
    let Some(file) = &args.path else { return Err(Error::new("name a path")) };
    let mut verdict = scene.check(&path(&scene, file)?)?;
    (verdict.scene, verdict.path) = (shown(&scene, &args.scene), file.display().to_string());
    match args.json {
        true => print(&json(&verdict)?)?,
        false => print(&verdict.summary())?,
    }
    Ok(verdict.free)
}

/// Refuses a scene and a path that both come from standard input.
pub(crate) fn once(scene: &Path, path: Option<&Path>) -> Result<(), Error> {
    match is_standard(scene) && path.is_some_and(is_standard) {
        true => Err(Error::new("scene and path cannot both come from standard input").help("name a file")),
        false => Ok(()),
    }
}

/// The scene meant by an argument; `-` is standard input.
pub(crate) fn scene(given: &Path) -> Result<Scene, Error> {
    if is_standard(given) {
        return Scene::parse("stdin", &standard_input()?, Path::new(""));
    }
    Scene::find(given)
}

/// How a scene is called in answers.
fn shown(scene: &Scene, given: &Path) -> String {
    scene.file().unwrap_or(given).display().to_string()
}

/// The path meant by an argument; `-` is standard input, in any form.
pub(crate) fn path(scene: &Scene, given: &Path) -> Result<PathRows, Error> {
    if !is_standard(given) {
        return PathRows::read(given, scene.path_format());
    }
    let text = standard_input()?;
    let kind = match text.trim_start() {
        t if t.starts_with('{') => PathFileKind::Json,
        t if t.lines().any(|line| line.contains(',')) => PathFileKind::Csv,
        _ => PathFileKind::Text,
    };
    PathRows::parse("standard input", text.as_bytes(), kind, scene.path_format())
}

/// What an answer is in JSON.
pub(crate) fn json(answer: &impl serde::Serialize) -> Result<String, Error> {
    serde_json::to_string(answer).map_err(|e| Error::new(format!("cannot write JSON: {e}")))
}

fn explain(scene: &Scene, numbers: &str, as_json: bool) -> Result<bool, Error> {
    let words = numbers.split([' ', ',', '\t']).filter(|word| !word.is_empty());
    let row =
        words.map(|word| word.parse::<f64>().map_err(|_| Error::new(format!("`{word}` is not a number"))));
    let explanation = scene.explain(&row.collect::<Result<Vec<_>, _>>()?)?;
    if as_json {
        print(&json(&explanation)?)?;
        return Ok(explanation.free);
    }
    let what = explanation.fault.clone().unwrap_or_else(|| "free".to_owned());
    print(&format!("the configuration is {what}"))?;
    if explanation.in_bounds {
        print(&format!("  clearance  {} m", brief(explanation.clearance)))?;
    }
    if let Some(free) = &explanation.nearest_free {
        let numbers: Vec<_> = free.iter().map(|v| brief(*v)).collect();
        print(&format!("  the nearest free configuration found is {}", numbers.join(" ")))?;
    }
    Ok(explanation.free)
}
