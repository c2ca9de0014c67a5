//! Scenes and paths from files and from standard input.

use crate::cli::Curve;
use crate::interrupt::{PATIENCE, within};
use crate::output::note;
use mp_io::ProblemChanges;
pub(crate) use mp_plan::is_standard;
use mp_plan::{
    Error, Interrupt, PathFileKind, PathRows, Scene, StopReason, Trajectory, TrajectoryKind, Verdict,
};
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
    let (own, changes, until) = (given.to_owned(), changes.clone(), interrupt.clone());
    let load = move || {
        let scene = read(&own, &changes, &until);
        if let Ok(scene) = &scene {
            // Whether it was interrupted is asked below.
            let _ = scene.make_ready(&until);
        }
        scene
    };
    let scene = within(interrupt, PATIENCE, load)?;
    if let Some(reason) = interrupt.raised() {
        return Ok(Err(reason));
    }
    let scene = scene.ok_or_else(|| Error::new(format!("{} was not loaded", given.display())))??;
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
    match is_standard(given) {
        true => path_of_text(scene, &standard_input()?),
        false => scene.read_path(given),
    }
}

/// What standard input is called in errors.
const STANDARD: &str = "standard input";

/// The kind of a path on standard input.
fn kind_of_text(text: &str) -> PathFileKind {
    match text.trim_start() {
        t if t.starts_with('{') => PathFileKind::Json,
        // A message of ROS in YAML, which may have commas too.
        t if t.contains("joint_names:") => PathFileKind::Text,
        t if t.lines().any(|line| line.contains(',')) => PathFileKind::Csv,
        _ => PathFileKind::Text,
    }
}

fn path_of_text(scene: &Scene, text: &str) -> Result<PathRows, Error> {
    scene.parse_path(STANDARD, text.as_bytes(), kind_of_text(text))
}

/// A path, or a path with times.
pub(crate) enum Given {
    Path(PathRows),
    Timed(Trajectory),
}

/// The path or trajectory that an argument names; `-` is standard input. With a `curve`, which is that between points, it must have times.
pub(crate) fn given(scene: &Scene, file: &Path, curve: Option<Curve>) -> Result<Given, Error> {
    let text = if is_standard(file) { Some(standard_input()?) } else { None };
    let timed = match &text {
        Some(text) => {
            let kind = match kind_of_text(text) {
                PathFileKind::Csv => TrajectoryKind::Csv,
                PathFileKind::Json => TrajectoryKind::Json,
                PathFileKind::Text => TrajectoryKind::Yaml,
            };
            let found = scene.parse_trajectory(STANDARD, text.as_bytes(), kind, curve.flatten());
            // Text that is no YAML is a path.
            if kind == TrajectoryKind::Yaml { found.unwrap_or(None) } else { found? }
        }
        None => scene.read_trajectory(file, curve.flatten())?,
    };
    match (timed, text) {
        (Some(trajectory), _) => Ok(Given::Timed(trajectory)),
        (None, _) if curve.is_some() => {
            let message = format!("--as: {} has no times, or its robot no trajectories", file.display());
            Err(Error::new(message).help("between the configurations of a path all joints move evenly"))
        }
        (None, Some(text)) => Ok(Given::Path(path_of_text(scene, &text)?)),
        (None, None) if TrajectoryKind::of(file) == Some(TrajectoryKind::Yaml) => {
            Err(Error::new(format!("there is no trajectory of the robot in {}", file.display()))
                .help("JointTrajectory of ROS is read from YAML: see docs/formats/trajectory.md"))
        }
        (None, None) => Ok(Given::Path(scene.read_path(file)?)),
    }
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

/// The numbers of a text, between spaces or commas. All are finite.
pub(crate) fn numbers(text: &str) -> Result<Vec<f64>, Error> {
    let words = text.split([' ', ',', '\t']).filter(|word| !word.is_empty());
    let number =
        |word: &str| match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(Error::new(format!("`{word}` is not a finite number"))
                .help("write numbers such as 0.5 or -1e-3")),
        };
    words.map(number).collect()
}
