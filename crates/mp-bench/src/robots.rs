//! Descriptions of robots below a folder, as other people wrote them: which of them are planned for, and why
//! not the rest.
//!
//! Each is opened alone, which chooses a free start and a free goal, and planned for; then to a goal at
//! random. A robot that collides with itself in all configurations tried gets the SRDF that `mp srdf` makes,
//! and is opened again.

mod poses;

use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Table, sections};
use crate::options::Common;
use clap::Args;
use mp_cspace::{Interrupt, Rng};
use mp_io::RobotPath;
use mp_plan::{Clock, Error, ErrorKind, ProblemChanges, Request, RobotPairs, Scene};
use poses::Poses;
use rand::RngExt;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The options of the suite `robots` alone.
#[derive(Clone, Debug, Default, Args)]
#[group(skip)]
#[command(next_help_heading = "Of the suite `robots`")]
pub(crate) struct Options {
    /// A folder with descriptions of robots, such as a package of Python [default: the robots that
    /// `mp robots` lists].
    #[arg(long = "dir", value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Instead, inverse kinematics: so many poses of the last link of each robot, made from configurations at
    /// random.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    link_poses: Option<u32>,
}

/// A case: a description, by its place below the folder.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
struct Case {
    robot: String,
    joints: usize,
}

/// What became of a description.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Outcome {
    Planned,
    PlannedWithPairs,
    NotInTime,
    SelfCollision,
    MissingMesh,
    NoJointMoves,
    Invalid,
}

impl Outcome {
    const ALL: [(Self, &'static str); 7] = [
        (Self::Planned, "planned and proved"),
        (Self::PlannedWithPairs, "planned and proved with the SRDF of `mp srdf`"),
        (Self::NotInTime, "not planned in time"),
        (Self::SelfCollision, "collides with itself, also with the SRDF of `mp srdf`"),
        (Self::MissingMesh, "a mesh is missing, or of a format that is not read"),
        (Self::NoJointMoves, "no joint moves: all limits are equal"),
        (Self::Invalid, "the description is not valid"),
    ];

    fn words(self) -> &'static str {
        Self::ALL.iter().find(|(outcome, _)| *outcome == self).map_or("", |(_, words)| words)
    }

    fn is_planned(self) -> bool {
        matches!(self, Self::Planned | Self::PlannedWithPairs)
    }
}

/// The result of a case.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Run {
    outcome: Outcome,
    /// What is wrong.
    why: Option<String>,
    /// Seconds to open it, and to plan, shorten and prove.
    opening: f64,
    planning: f64,
    /// Whether a goal at random was planned for and proved; `None` when no free one was found.
    far: Option<bool>,
}

/// Runs the suite. True when it was measured completely; a robot that is not planned for is a result.
pub(crate) fn run(common: &Common, options: &Options) -> Result<bool> {
    let folders = match options.folders.as_slice() {
        [] => RobotPath::of_environment(),
        given => RobotPath::new(given.iter().cloned()),
    };
    let shown = |file: &Path| {
        let inside = folders.folders().iter().find_map(|folder| file.strip_prefix(folder).ok());
        inside.unwrap_or(file).to_string_lossy().replace('\\', "/")
    };
    let descriptions = folders.descriptions();
    let still = descriptions.iter().filter(|robot| robot.joints == 0).count();
    let robots = descriptions.into_iter().filter(|robot| robot.joints > 0);
    let files: BTreeMap<Case, PathBuf> =
        robots.map(|robot| (Case { robot: shown(&robot.file), joints: robot.joints }, robot.file)).collect();
    if files.is_empty() {
        return Err(
            Error::new("there is no description of a robot with joints").help("name a folder: --dir DIR")
        );
    }
    let lab = Lab::new(common)?;
    if let Some(count) = options.link_poses {
        return inverse_kinematics(&lab, &files, count);
    }
    let name = lab.name("robots");
    let cap = if common.quick { common.time.min(5.0) } else { common.time };
    let mut log = lab.log(&name, cap)?;
    let cases: Vec<Case> = files.keys().cloned().collect();
    // Reasons say where files are on this machine.
    let without_place = |why: &String| {
        let places = folders.folders().iter().map(|folder| format!("{}/", folder.display()));
        places.fold(why.clone(), |why, place| why.replace(&place, ""))
    };
    let of = |case: &Case| {
        let run = measured(&files[case], cap)?;
        Ok(run.map(|run| Run { why: run.why.as_ref().map(without_place), ..run }))
    };
    if !lab.measure(&mut log, "robots", &cases, of)? {
        return Ok(false);
    }
    let runs: Vec<(&Case, &Run)> = log.each(&cases).collect();
    let table = Table::of(
        runs.iter().copied(),
        &[
            ("robot", &|(case, _)| case.robot.clone()),
            ("joints", &|(case, _)| case.joints.to_string()),
            ("outcome", &|(_, run)| run.outcome.words().to_owned()),
            ("opening s", &|(_, run)| format!("{:.2}", run.opening)),
            ("planning s", &|(_, run)| format!("{:.2}", run.planning)),
            ("goal at random", &|(_, run)| far(run.far).to_owned()),
            ("why", &|(_, run)| run.why.clone().unwrap_or_default()),
        ],
    );
    let parts = [("Outcomes".to_owned(), outcomes(&runs, still)), ("Robots".to_owned(), table.clone())];
    lab.report(&name, &sections(2, &parts), &table)?;
    Ok(true)
}

/// Measures inverse kinematics of each robot.
fn inverse_kinematics(lab: &Lab, files: &BTreeMap<Case, PathBuf>, count: u32) -> Result<bool> {
    let name = lab.name("robots-poses");
    let mut log = lab.log(&name, f64::from(count))?;
    let cases: Vec<Case> = files.keys().cloned().collect();
    let of = |case: &Case| Ok(Some(poses::reached(&files[case], count)?));
    if !lab.measure(&mut log, "robots", &cases, of)? {
        return Ok(false);
    }
    let runs: Vec<(&Case, &Poses)> = log
        .each(&cases)
        .filter_map(|(case, poses): (_, &Option<Poses>)| Some((case, poses.as_ref()?)))
        .collect();
    let table = Table::of(
        runs.iter().copied(),
        &[
            ("robot", &|(case, _)| case.robot.clone()),
            ("link", &|(_, poses)| poses.link.clone()),
            ("joints that move it", &|(_, poses)| poses.joints.to_string()),
            ("poses", &|(_, poses)| poses.asked.to_string()),
            ("reached", &|(_, poses)| poses.reached.to_string()),
            ("median ms", &|(_, poses)| format!("{:.3}", poses.median)),
            ("longest ms", &|(_, poses)| format!("{:.1}", poses.longest)),
        ],
    );
    lab.report(&name, &sections(2, &[("Poses".to_owned(), table.clone())]), &table)?;
    Ok(true)
}

/// A result with a goal at random, in a word.
fn far(far: Option<bool>) -> &'static str {
    match far {
        Some(true) => "planned",
        Some(false) => "not in time",
        None => "",
    }
}

/// How often each outcome is there.
fn outcomes(runs: &[(&Case, &Run)], still: usize) -> Table {
    let count = |wanted: &dyn Fn(&Run) -> bool| runs.iter().filter(|(_, run)| wanted(run)).count();
    let mut table = Table::new(["outcome", "descriptions"]);
    let mut row = |what: &str, count: String| table.rows.push(vec![what.to_owned(), count]);
    for (outcome, words) in Outcome::ALL {
        row(words, count(&|run| run.outcome == outcome).to_string());
    }
    let arms = count(&|run| run.outcome != Outcome::NoJointMoves);
    let planned = count(&|run| run.outcome.is_planned());
    row("**planned, of those with joints that move**", format!("**{planned} of {arms}**"));
    let valid = arms - count(&|run| run.outcome == Outcome::Invalid);
    row("planned, of those whose description is valid", format!("{planned} of {valid}"));
    let pairs = count(&|run| run.outcome == Outcome::PlannedWithPairs);
    let collide = pairs + count(&|run| run.outcome == Outcome::SelfCollision);
    row(
        "planned with an SRDF, of those that collide with themselves without",
        format!("{pairs} of {collide}"),
    );
    let [solved, tried] = [count(&|run| run.far == Some(true)), count(&|run| run.far.is_some())];
    row("planned to a goal at random", format!("{solved} of {tried}"));
    row("without joints that move, such as tables: left out", still.to_string());
    table
}

/// An interrupt that says to end after `seconds`.
fn within(seconds: f64) -> Interrupt {
    let clock = Clock::default();
    let end = clock.now().saturating_add(Duration::from_secs_f64(seconds));
    Interrupt::by(mp_cspace::Cancel::new(), clock, end)
}

/// Opens a description and plans, within `cap` seconds for each step.
fn measured(file: &Path, cap: f64) -> Result<Option<Run>> {
    let clock = Clock::default();
    let began = clock.now();
    let since = |began: Duration| (clock.now() - began).as_secs_f64();
    let alone = Scene::find_changed(file, &ProblemChanges::default(), &within(cap));
    let (scene, pairs) = match alone {
        Err(error) if is_self_collision(&error) => (with_pairs(file, cap), true),
        alone => (alone, false),
    };
    let opening = since(began);
    let scene = match scene {
        Ok(scene) => scene,
        Err(error) => {
            let (outcome, why) = (outcome_of(&error), Some(error.message().to_owned()));
            return Ok(Some(Run { outcome, why, opening, planning: 0.0, far: None }));
        }
    };
    let began = clock.now();
    let solved = planned(&scene, cap)?;
    let planning = since(began);
    let outcome = match (solved, pairs) {
        (false, _) => Outcome::NotInTime,
        (true, false) => Outcome::Planned,
        (true, true) => Outcome::PlannedWithPairs,
    };
    let far = free_at_random(&scene).map(|goal| planned(&scene.with_ends(&scene.start(), &[goal])?, cap));
    Ok(Some(Run { outcome, why: None, opening, planning, far: far.transpose()? }))
}

/// Whether a path is found and proved.
fn planned(scene: &Scene, cap: f64) -> Result<bool> {
    let report = scene.plan(&Request::new(scene.default_planner()).seed(1).time(cap))?;
    Ok(report.solved && report.verified)
}

/// The robot with the SRDF that `mp srdf` makes.
fn with_pairs(file: &Path, cap: f64) -> Result<Scene> {
    let folder = tempfile::tempdir().into_error()?;
    let srdf = folder.path().join("made.srdf");
    // A person waits for it once.
    let text = RobotPairs::sampled(file, &within(10.0 * cap))?.srdf(true);
    mp_store::write(&srdf, text.as_bytes())?;
    let quoted = |path: &Path| serde_json::Value::from(path.to_string_lossy()).to_string();
    let file = std::path::absolute(file).into_error()?;
    let problem = format!(
        "[robot]\nurdf = {}\nsrdf = {}\n[motion]\nstart = []\ngoal = []\n",
        quoted(&file),
        quoted(&srdf)
    );
    Scene::parse_changed("made", &problem, folder.path(), &ProblemChanges::default(), &within(cap))
}

/// A free configuration at random, the same every time; `None` when none is found soon.
fn free_at_random(scene: &Scene) -> Option<Vec<f64>> {
    const TRIES: usize = 300;
    let mut rng = Rng::seed(1);
    let limits = scene.limits();
    let mut row = || -> Vec<f64> {
        let value = |limits: &Option<[f64; 2]>| {
            let [low, high] = limits.unwrap_or([-std::f64::consts::PI, std::f64::consts::PI]);
            low + (high - low) * rng.random::<f64>()
        };
        limits.iter().map(value).collect()
    };
    (0..TRIES).map(|_| row()).find(|row| {
        let ends = scene.with_ends(row, std::slice::from_ref(row));
        ends.is_ok_and(|ends| ends.check_ends().is_ok())
    })
}

/// Whether no free configuration was found.
fn is_self_collision(error: &Error) -> bool {
    error.message().starts_with("no configuration was found") || matches!(error.kind(), ErrorKind::NotFree(_))
}

/// What an error of opening means.
fn outcome_of(error: &Error) -> Outcome {
    let message = error.message();
    if is_self_collision(error) {
        Outcome::SelfCollision
    } else if error.file().is_some_and(|e| e.kind() == mp_io::ErrorKind::Interrupted)
        || message.contains("was ended")
    {
        Outcome::NotInTime
    } else if message.contains("no joint of this arm moves") {
        Outcome::NoJointMoves
    } else if ["no such file", "is not there", "not a mesh format"].iter().any(|why| message.contains(why)) {
        Outcome::MissingMesh
    } else {
        Outcome::Invalid
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An arm, one whose links touch at all times, one with a mesh that is lost, one that cannot move, and a
    /// table.
    #[test]
    fn each_description_has_its_outcome() {
        let folder = tempfile::tempdir().unwrap();
        let bar = |name: &str, shape: &str| {
            format!("<link name='{name}'><collision><geometry>{shape}</geometry></collision></link>")
        };
        let joint = |name: &str, [parent, child]: [&str; 2], at: &str, limits: &str| {
            format!(
                "<joint name='{name}' type='revolute'><parent link='{parent}'/><child link='{child}'/><origin xyz='{at}'/>\
                 <limit {limits}/></joint>"
            )
        };
        let room = "lower='-1' upper='1'";
        let cube = "<box size='0.1 0.1 0.1'/>";
        let arm = |shape: &str, limits: &str| {
            let joints =
                joint("a", ["l0", "l1"], "0 0 0.2", limits) + &joint("b", ["l1", "l2"], "0 0 0.2", limits);
            format!(
                "<robot name='r'>{}{}{}{joints}</robot>",
                bar("l0", cube),
                bar("l1", shape),
                bar("l2", cube)
            )
        };
        // Two arms on one base that are in each other, as they turn about a common axis.
        let touching = format!(
            "<robot name='t'>{}{}{}{}{}</robot>",
            bar("l0", cube),
            bar("l1", cube),
            bar("l2", "<box size='0.1 0.1 0.1001'/>"),
            joint("a", ["l0", "l1"], "0 0 0.5", room),
            joint("b", ["l0", "l2"], "0 0 0.5", "lower='2.5' upper='3.1'")
        );
        let files = [
            ("arm.urdf", arm(cube, room)),
            ("held.urdf", arm(cube, "lower='0' upper='0'")),
            ("lost.urdf", arm("<mesh filename='lost.stl'/>", room)),
            ("table.urdf", format!("<robot name='r'>{}</robot>", bar("l", cube))),
            ("touching.urdf", touching),
            ("wrong.urdf", arm("<box size='1 1'/>", room)),
        ];
        for (name, text) in &files {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        let of = |name: &str| measured(&folder.path().join(name), 20.0).unwrap().unwrap();
        let run = of("arm.urdf");
        assert_eq!((run.outcome, run.far), (Outcome::Planned, Some(true)), "{run:?}");
        for (name, outcome) in [
            ("held.urdf", Outcome::NoJointMoves),
            ("lost.urdf", Outcome::MissingMesh),
            ("wrong.urdf", Outcome::Invalid),
        ] {
            let run = of(name);
            assert!(run.outcome == outcome && run.why.is_some(), "{name}: {run:?}");
        }
        assert!(of("touching.urdf").outcome.is_planned());
        let results = folder.path().join("out");
        let common = Common { quick: true, out: results.clone(), ..Common::test() };
        assert!(run_in(&common, folder.path()));
        let table = std::fs::read_to_string(results.join("robots-quick.csv")).unwrap();
        assert!(table.lines().filter(|line| line.contains(".urdf,")).count() == 5, "{table}");
    }

    fn run_in(common: &Common, folder: &Path) -> bool {
        run(common, &Options { folders: vec![folder.to_owned()], link_poses: None }).unwrap()
    }
}
