//! Scenes and paths from files and from standard input.

use crate::output::note;
use mp_io::ProblemChanges;
pub(crate) use mp_plan::is_standard;
use mp_plan::{Error, Interrupt, PathFileKind, PathRows, Scene, StopReason, Verdict};
use std::path::Path;

/// The whole standard input, which must be text of at most 64 MiB.
pub(crate) fn standard_input() -> Result<String, Error> {
    let name = Path::new("standard input");
    let bytes = mp_store::read_stream(name, std::io::stdin().lock(), mp_io::MAX_TEXT_BYTES)?;
    String::from_utf8(bytes)
        .map_err(|_| Error::new("standard input is not UTF-8 text").help("give a text file in UTF-8"))
}

/// Refuses a scene and a path that both come from standard input.
pub(crate) fn refuse_two_standard_inputs(scene: &Path, path: Option<&Path>) -> Result<(), Error> {
    match is_standard(scene) && path.is_some_and(is_standard) {
        true => Err(Error::new("scene and path cannot both come from standard input").help("name a file")),
        false => Ok(()),
    }
}

/// The scene that an argument names; `-` is standard input. What was chosen for a robot or a map alone is said to the person
/// watching.
pub(crate) fn scene(given: &Path, changes: &ProblemChanges) -> Result<Scene, Error> {
    let scene = read(given, changes, &Interrupt::never())?;
    scene.notes().iter().for_each(|line| note(&format!("note: {line}")));
    Ok(scene)
}

/// As [`scene`], ready to plan in.
///
/// # Errors
/// Inside: what ended it, if it was interrupted.
pub(crate) fn scene_until(
    given: &Path,
    changes: &ProblemChanges,
    interrupt: &Interrupt,
) -> Result<Result<Scene, StopReason>, Error> {
    let scene = read(given, changes, interrupt);
    if let Ok(scene) = &scene {
        // Whether it was interrupted is asked below.
        let _ = scene.make_ready(interrupt);
    }
    if let Some(reason) = interrupt.raised() {
        return Ok(Err(reason));
    }
    let scene = scene?;
    scene.notes().iter().for_each(|line| note(&format!("note: {line}")));
    Ok(Ok(scene))
}

fn read(given: &Path, changes: &ProblemChanges, interrupt: &Interrupt) -> Result<Scene, Error> {
    match is_standard(given) {
        true => Scene::parse_changed("stdin", &standard_input()?, Path::new(""), changes, interrupt),
        false => Scene::find_changed(given, changes, interrupt),
    }
}

/// The path that an argument names; `-` is standard input, in any format.
pub(crate) fn path(scene: &Scene, given: &Path) -> Result<PathRows, Error> {
    if !is_standard(given) {
        return scene.read_path(given);
    }
    let text = standard_input()?;
    let kind = match text.trim_start() {
        t if t.starts_with('{') => PathFileKind::Json,
        t if t.lines().any(|line| line.contains(',')) => PathFileKind::Csv,
        _ => PathFileKind::Text,
    };
    scene.parse_path("standard input", text.as_bytes(), kind)
}

/// The path that an argument names, and the verdict about it. If anything is wrong, this is said to the person watching.
pub(crate) fn judged_path(scene: &Scene, given: &Path) -> Result<(PathRows, Verdict), Error> {
    let path = path(scene, given)?;
    let verdict = scene.check(&path)?;
    if !verdict.free {
        note(&format!("warning: this path would not pass `mp check`: {}", verdict.faults.join("; ")));
    }
    Ok((path, verdict))
}

/// The numbers of a text, between spaces or commas.
pub(crate) fn numbers(text: &str) -> Result<Vec<f64>, Error> {
    let words = text.split([' ', ',', '\t']).filter(|word| !word.is_empty());
    words.map(|word| word.parse().map_err(|_| Error::new(format!("`{word}` is not a number")))).collect()
}
