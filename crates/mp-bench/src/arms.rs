//! Arms on the problem sets of MotionBenchMaker (Chamzas et al. 2022, *MotionBenchMaker: a tool to generate and benchmark motion
//! planning datasets*): where the time of a whole call goes.

use crate::clock::processor_clock;
use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Table, sections};
use crate::options::Common;
use clap::Args;
use mp_plan::{Control, Error, ErrorKind, ProblemChanges, Report, Request, RunStage, Scene};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The largest file of problems that is read, bytes.
const MAX_BYTES: u64 = 1 << 30;

/// The options of the suite `arms` alone.
#[derive(Clone, Debug, Default, Args)]
#[group(skip)]
#[command(next_help_heading = "Of the suite `arms`")]
pub(crate) struct Options {
    /// The folder with the problem sets; docs/benchmarks.md says what is in it.
    #[arg(long, value_name = "DIR")]
    dataset: Option<PathBuf>,
    /// The robot: `DIR/ROBOT.json` and `DIR/robots/ROBOT/ROBOT.urdf`.
    #[arg(long, value_name = "ROBOT", default_value = "panda")]
    robot: String,
    /// Problems of each scene [default: 10, with --quick 1].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    problems: Option<u32>,
    /// Take robots as VAMP does: the balls of `ROBOT_spherized.urdf` for the links, with `ROBOT_spherized.srdf`, and capsules that contain
    /// them for cylinders; in the scene `box`, boxes.
    #[arg(long)]
    spheres: bool,
    /// Measure nothing; write the scene files of the problems, and `problems.jsonl`, a list of them for `mp many`, to this folder.
    #[arg(long, value_name = "FOLDER")]
    list: Option<PathBuf>,
}

/// The problems of a robot.
#[derive(Debug, Deserialize)]
struct ProblemSet {
    joints: Vec<String>,
    problems: BTreeMap<String, Vec<Problem>>,
}

/// A problem: configurations in the order of the joints.
#[derive(Debug, Deserialize)]
struct Problem {
    index: u32,
    /// Whether start and goal are free.
    valid: bool,
    start: Vec<f64>,
    goals: Vec<Vec<f64>>,
    spheres: Vec<Obstacle>,
    boxes: Vec<Obstacle>,
    cylinders: Vec<Obstacle>,
}

/// An obstacle: a place (m), roll, pitch and yaw about fixed axes, and the half sides of a box, or a radius and a length (m).
#[derive(Debug, Deserialize)]
struct Obstacle {
    #[serde(default)]
    n: String,
    p: [f64; 3],
    #[serde(default)]
    rpy: [f64; 3],
    #[serde(default)]
    h: [f64; 3],
    #[serde(default)]
    r: f64,
    #[serde(default)]
    l: f64,
}

impl Problem {
    /// The problem file of the robot described in `folder`; with `spheres`, as [`Options::spheres`] says.
    fn text(&self, joints: &[String], folder: &Path, robot: &str, (scene, spheres): (&str, bool)) -> String {
        let quoted = |path: PathBuf| Value::from(path.to_string_lossy()).to_string();
        let values = |row: &[f64]| {
            let pairs: Vec<String> = joints.iter().zip(row).map(|(j, x)| format!("{j} = {x:?}")).collect();
            format!("{{ {} }}", pairs.join(", "))
        };
        let mut text = format!("[robot]\nurdf = {}\n", quoted(folder.join(format!("{robot}.urdf"))));
        let srdf = folder.join(format!("{robot}.srdf"));
        if srdf.exists() {
            let _ = writeln!(text, "srdf = {}", quoted(srdf));
        }
        let _ = writeln!(text, "packages = {}\njoints = {joints:?}", quoted(folder.to_owned()));
        let goal = self.goals.first().map(|goal| values(goal)).unwrap_or_default();
        let _ = writeln!(text, "[motion]\nstart = {}\ngoal = {goal}", values(&self.start));
        let shapes = [
            (&self.spheres, (|o| format!("sphere = {:?}", o.r)) as fn(&Obstacle) -> String),
            (&self.boxes, |o| format!("box = {:?}", o.h.map(|half| 2.0 * half))),
            (
                &self.cylinders,
                match (spheres, scene) {
                    (false, _) => |o| format!("cylinder = {:?}", [o.r, o.l]),
                    (true, "box") => |o| format!("box = {:?}", [2.0 * o.r, 2.0 * o.r, o.l]),
                    (true, _) => |o| format!("capsule = {:?}", [o.r, o.l]),
                },
            ),
        ];
        for (obstacles, shape) in shapes {
            for obstacle in obstacles {
                let ([x, y, z], [roll, pitch, yaw]) = (obstacle.p, obstacle.rpy);
                let (name, shape) = (Value::from(obstacle.n.as_str()), shape(obstacle));
                let pose = [x, y, z, yaw, pitch, roll];
                let _ = writeln!(text, "[[obstacle]]\nname = {name}\n{shape}\npose = {pose:?}");
            }
        }
        text
    }
}

/// A case: a problem of a robot.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
struct Case {
    robot: String,
    scene: String,
    index: u32,
    seed: u64,
}

/// The result of a case: seconds of processor time.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Run {
    /// Whether start and goal are free: where the set is made with other shapes of the links, they may not be. The rest is zero then.
    valid: bool,
    /// Whether there is a path, proved.
    solved: bool,
    planning: f64,
    shortening: f64,
    proof: f64,
    /// From the scene that is ready to the report.
    whole: f64,
    /// Making the trees of the verifier, once for a robot among obstacles.
    ready: f64,
    /// The length of the path, in the metric of the space.
    length: f64,
    fingerprint: String,
}

/// Runs the suite. True when every problem was solved.
pub(crate) fn run(common: &Common, options: &Options) -> Result<bool> {
    let lab = Lab::one_at_a_time(common)?;
    measured(&lab, common, options)
}

fn measured(lab: &Lab, common: &Common, options: &Options) -> Result<bool> {
    let dataset = options.dataset.as_ref().ok_or_else(|| {
        Error::new("the suite `arms` reads its problems from a folder")
            .help("name it: --dataset DIR; docs/benchmarks.md says what is in it")
    })?;
    let dataset = std::path::absolute(dataset).into_error()?;
    let robot = &options.robot;
    let file = dataset.join(format!("{robot}.json"));
    let set: ProblemSet = serde_json::from_slice(&mp_store::read(&file, MAX_BYTES)?)
        .map_err(|e| Error::new(format!("{}: {e}", file.display())))?;
    let folder = dataset.join("robots").join(robot);
    let count = options.problems.unwrap_or(if common.quick { 1 } else { 10 });
    let problems: BTreeMap<Case, &Problem> = set
        .problems
        .iter()
        .filter(|(scene, _)| common.scenes.is_empty() || common.scenes.contains(scene))
        .flat_map(|(scene, problems)| {
            let valid = problems.iter().filter(|problem| problem.valid).take(count as usize);
            valid.flat_map(move |problem| {
                (1..=common.runs_or(1, 1)).map(move |seed| {
                    let (robot, scene) = (robot.clone(), scene.clone());
                    (Case { robot, scene, index: problem.index, seed: seed.into() }, problem)
                })
            })
        })
        .collect();
    let urdf = if options.spheres { format!("{robot}_spherized") } else { robot.clone() };
    let text = |case: &Case, problem: &Problem| {
        problem.text(&set.joints, &folder, &urdf, (&case.scene, options.spheres))
    };
    if let Some(list) = &options.list {
        return written(list, &problems, text);
    }
    let cases: Vec<Case> = problems.keys().cloned().collect();
    let name = lab.name(&format!("arms-{urdf}"));
    let mut log = lab.log(&name, common.time)?;
    let complete = lab.measure(&mut log, &name, &cases, |case| {
        let text = text(case, problems[case]);
        let (changes, never) = (ProblemChanges::default(), mp_cspace::Interrupt::never());
        let scene = Scene::parse_changed(&case.scene, &text, &folder, &changes, &never)?;
        planned(&scene, case.seed, common.time, lab)
    })?;
    if !complete {
        return Ok(false);
    }
    let runs: Vec<(&Case, &Run)> = log.each(&cases).collect();
    let refused = runs.iter().filter(|(_, run)| !run.valid).count();
    let scenes = set.problems.keys().map(|scene| (scene.as_str(), Some(scene)));
    let mut summary = Table::new([
        "scene",
        "solved",
        "planning ms",
        "shortening ms",
        "proof ms",
        "whole call ms",
        "making ready ms",
        "mean length",
    ]);
    for (name, scene) in scenes.chain([("**all**", None)]) {
        let of = runs.iter().filter(|(case, run)| run.valid && scene.is_none_or(|s| *s == case.scene));
        let of: Vec<&Run> = of.map(|(_, run)| *run).collect();
        if !of.is_empty() {
            summary.rows.push(row(name, &of));
        }
    }
    let mut text = sections(2, &[(robot.clone(), summary)]);
    if refused > 0 {
        let _ = writeln!(
            text,
            "\nOf {} problems {refused} are left out: a start or goal is not free.",
            runs.len()
        );
    }
    lab.report(&name, &text, &log.table(&cases)?)?;
    Ok(runs.iter().all(|(_, run)| run.solved || !run.valid))
}

/// Writes the scene files of the problems and the list of them. True, as nothing was measured that could have failed.
fn written(
    list: &Path,
    problems: &BTreeMap<Case, &Problem>,
    text: impl Fn(&Case, &Problem) -> String,
) -> Result<bool> {
    mp_store::make_folder(list)?;
    let mut lines = String::new();
    for (case, problem) in problems {
        let scene = format!("{}-{}", case.scene, case.index);
        mp_store::write(&list.join(format!("{scene}.toml")), text(case, problem).as_bytes())?;
        let budget = json!({ "time_s": null, "iterations": 1_000_000 });
        let line = json!({ "scene": scene, "seeds": [case.seed], "request": { "budget": budget } });
        let _ = writeln!(lines, "{line}");
    }
    mp_store::write(&list.join("problems.jsonl"), lines.as_bytes())?;
    Ok(true)
}

/// A row of the table: medians, means and 95% quantiles, each of all problems.
fn row(name: &str, runs: &[&Run]) -> Vec<String> {
    let cell = |value: fn(&Run) -> f64| {
        let mut sorted: Vec<f64> = runs.iter().map(|run| 1e3 * value(run)).collect();
        sorted.sort_by(f64::total_cmp);
        let at = |percent: usize| sorted[(sorted.len() - 1) * percent / 100];
        let mean = sorted.iter().sum::<f64>() / sorted.len() as f64;
        format!("{:.1} / {mean:.1} / {:.1}", at(50), at(95))
    };
    let solved: Vec<f64> = runs.iter().filter(|run| run.solved).map(|run| run.length).collect();
    let length = solved.iter().sum::<f64>() / solved.len().max(1) as f64;
    vec![
        name.to_owned(),
        format!("{}/{}", solved.len(), runs.len()),
        cell(|run| run.planning),
        cell(|run| run.shortening),
        cell(|run| run.proof),
        cell(|run| run.whole),
        cell(|run| run.ready),
        format!("{length:.3}"),
    ]
}

/// Plans, shortens and proves, within `time` seconds of processor time.
fn planned(scene: &Scene, seed: u64, time: f64, lab: &Lab) -> Result<Option<Run>> {
    let mut request = Request::new(scene.default_planner()).seed(seed);
    request.budget.time_s = Some(time);
    let mut control = Control { cancel: lab.cancel.clone(), clock: processor_clock(), ..Control::default() };
    let clock = control.clock;
    let since = |began: Duration| clock.now().saturating_sub(began).as_secs_f64();
    let began = clock.now();
    // Planning would do it, and count it as its own.
    let _ = scene.make_ready(&mp_cspace::Interrupt::new(lab.cancel.clone()));
    let (ready, began) = (since(began), clock.now());
    let report = match scene.plan_with(&request, &mut control) {
        Err(error) if matches!(error.kind(), ErrorKind::NotFree(_)) => {
            tracing::warn!("left out: {}", error.report());
            return Ok(Some(Run::default()));
        }
        report => report?,
    };
    let whole = since(began);
    Ok((!lab.cancel.is_raised()).then(|| of_report(&report, whole, ready)))
}

fn of_report(report: &Report, whole: f64, ready: f64) -> Run {
    let spent = |stage: RunStage| {
        report.stages.iter().filter(|spent| spent.stage == stage).map(|spent| spent.time_s).sum()
    };
    Run {
        valid: true,
        solved: report.solved && report.verified,
        planning: spent(RunStage::Planning),
        shortening: spent(RunStage::Shortening),
        proof: spent(RunStage::Verifying),
        whole,
        ready,
        length: report.path_length.unwrap_or(0.0),
        fingerprint: report.fingerprint.clone().unwrap_or_default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An arm of two links in the plane, a problem with an obstacle of each kind, and one that is not valid.
    #[test]
    fn a_problem_set_is_read_planned_and_proved() {
        let folder = tempfile::tempdir().unwrap();
        let robots = folder.path().join("robots/small");
        std::fs::create_dir_all(&robots).unwrap();
        let link = |name: &str| {
            format!(
                "<link name='{name}'><collision><origin xyz='0.25 0 0'/><geometry><box size='0.4 0.05 0.05'/></geometry>\
                 </collision></link>"
            )
        };
        let joint = |name: &str, [parent, child]: [&str; 2], x: f64| {
            format!(
                "<joint name='{name}' type='revolute'><parent link='{parent}'/><child link='{child}'/><origin xyz='{x} 0 0'/>\
                 <axis xyz='0 0 1'/><limit lower='-3' upper='3' effort='1' velocity='1'/></joint>"
            )
        };
        let urdf = format!(
            "<robot name='small'><link name='base'/>{}{}{}{}</robot>",
            link("upper"),
            link("lower"),
            joint("a", ["base", "upper"], 0.0),
            joint("b", ["upper", "lower"], 0.5)
        );
        std::fs::write(robots.join("small.urdf"), urdf).unwrap();
        let problem = |index: u32, valid: bool, start: [f64; 2]| {
            serde_json::json!({
                "index": index, "valid": valid, "start": start, "goals": [[-1.5, -0.1]],
                "spheres": [{ "n": "ball", "p": [0.9, 0.0, 0.0], "r": 0.1 }],
                "boxes": [{ "n": "box", "p": [-0.8, 0.0, 0.0], "rpy": [0, 0, 0.5], "h": [0.1, 0.1, 0.1] }],
                "cylinders": [{ "n": "pole", "p": [0.0, 0.0, 0.5], "r": 0.05, "l": 0.2 }],
            })
        };
        let (free, in_ball) = ([1.5, 0.1], [0.0, 0.0]);
        let room = [problem(1, true, free), problem(2, false, free), problem(3, true, in_ball)];
        let set = serde_json::json!({ "joints": ["a", "b"], "note": "any", "problems": { "room": room } });
        std::fs::write(folder.path().join("small.json"), set.to_string()).unwrap();
        let out = folder.path().join("out");
        let (common, lab) = (Common { out: out.clone(), ..Common::test() }, Lab::test(&out, 1));
        let options = Options { robot: "small".to_owned(), ..Options::default() };
        assert!(measured(&lab, &common, &options).unwrap_err().remedy().unwrap().contains("--dataset"));
        let options = Options { dataset: Some(folder.path().to_owned()), ..options };
        assert!(measured(&lab, &common, &options).unwrap());
        let log = lab.log::<Case, Run>("arms-small-quick", common.time).unwrap();
        let [(case, run), (begins_in_ball, refused)] = log.all()[..] else { panic!("{:?}", log.all()) };
        assert_eq!((begins_in_ball.index, refused.valid), (3, false));
        assert_eq!((case.scene.as_str(), case.index), ("room", 1));
        assert!(run.solved && run.length > 3.0 && run.whole >= run.planning + run.shortening + run.proof);
        let text = std::fs::read_to_string(out.join("arms-small-quick.md")).unwrap();
        assert!(text.contains("| room | 1/1 |") && text.contains("Of 2 problems 1 are left out"), "{text}");
        let list = folder.path().join("list");
        assert!(measured(&lab, &common, &Options { list: Some(list.clone()), ..options }).unwrap());
        let lines = std::fs::read_to_string(list.join("problems.jsonl")).unwrap();
        let line: Value = serde_json::from_str(lines.lines().next().unwrap()).unwrap();
        assert_eq!((line["scene"].as_str(), &line["seeds"]), (Some("room-1"), &json!([case.seed])));
        assert_eq!(Scene::find(list.join("room-1")).unwrap().name(), "room-1");
    }
}
