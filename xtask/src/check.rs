//! `check`: is a path free, by the checker that shares no code with the planner's?

use crate::cli::Check;
use crate::info::brief;
use crate::output::print;
use crate::plan::mover::Mover;
use crate::plan::setting::{Ready, Setting};
use crate::plan::tuples::travel;
use crate::{arm, flat, scenes};
use miette::{IntoDiagnostic, Result, WrapErr};
use mp::cspace::{MotionCheck, Path, PathFault, Space, least_clearance, verify_path};
use mp::io::{FlatProblem, JointPath, PathFile, RobotProblem, SpaceKind};
use serde::Serialize;

/// A path begins at the start and ends at the goal if no point of the robot is farther off than this, in
/// radii of the robot: files often have four digits.
const MATCH: f64 = 1e-3;
/// A number of a planar path that must be zero may be this far from it.
const PLANAR: f64 = 1e-9;

#[derive(Clone, Debug, Serialize)]
pub(crate) struct Verdict {
    scene: String,
    path: String,
    /// Free all along, from the start of the scene to its goal.
    free: bool,
    configurations: usize,
    /// In the metric of the space.
    path_length: f64,
    /// A lower bound all along, metres; 0 when not free.
    clearance: f64,
    /// What is wrong, if anything.
    faults: Vec<String>,
}

/// Verifies a path. True when it is certified free.
pub(crate) fn run(args: &Check) -> Result<bool> {
    let scene = scenes::find(&args.scene)?;
    let mut verdict = if FlatProblem::is_one(&scene) {
        flat::check(&flat::AnyTask::load(&scene)?, &JointPath::read(&args.path)?)?
    } else if RobotProblem::is_named(&scene) {
        arm::check(&arm::Task::load(&scene)?, &JointPath::read(&args.path)?)?
    } else {
        let (ready, file) = (Ready::load(&scene)?, PathFile::read(&args.path)?);
        match &ready {
            Ready::Space(setting) => verify(setting, &file)?,
            Ready::Plane(setting) => verify(setting, &file)?,
        }
    };
    (verdict.scene, verdict.path) = (scene.display().to_string(), args.path.display().to_string());
    if args.json {
        print(&serde_json::to_string(&verdict).into_diagnostic().wrap_err("cannot write JSON")?)?;
    } else {
        print(&verdict.told())?;
    }
    Ok(verdict.free)
}

impl Verdict {
    /// Free when there are no faults.
    pub(crate) fn new(configurations: usize, path_length: f64, clearance: f64, faults: Vec<String>) -> Self {
        let (scene, path, free) = (String::new(), String::new(), faults.is_empty());
        Self { scene, path, free, configurations, path_length, clearance, faults }
    }

    fn told(&self) -> String {
        if self.free {
            return format!(
                "{}: certified free in {}\n  {} configurations, length {}, clearance at least {} m",
                self.path,
                self.scene,
                self.configurations,
                brief(self.path_length),
                brief(self.clearance)
            );
        }
        format!("{}: not free in {}\n  {}", self.path, self.scene, self.faults.join("\n  "))
    }
}

fn verify<M: Mover>(setting: &Setting<M>, file: &PathFile) -> Result<Verdict> {
    let poses = file.poses();
    let path = Path::straight(poses.iter().map(M::configuration).collect::<Vec<_>>());
    let mut faults = Vec::new();
    let ends =
        [("start", poses.first(), &setting.problem.start), ("goal", poses.last(), &setting.problem.goal)];
    for (name, end, wanted) in ends {
        let off = end.map_or(f64::INFINITY, |end| travel(end, wanted, setting.radius));
        if off > MATCH * setting.radius {
            let verb = if name == "start" { "begin" } else { "end" };
            faults.push(format!("does not {verb} at the {name} of the scene: up to {} m off", brief(off)));
        }
    }
    if setting.problem.space == SpaceKind::Se2 {
        let off = |c: &[f64; 6]| [c[2], c[4], c[5]].iter().any(|v| v.abs() > PLANAR);
        if let Some(i) = file.configurations.iter().position(off) {
            faults.push(format!("configuration {} leaves the plane: z, β and γ must be 0", i + 1));
        }
    }
    let report = verify_path(&setting.space, &path, &mut setting.verifier()?);
    faults.extend(report.fault.map(|fault| told(setting, &path, fault)));
    let clearance = match faults.is_empty() {
        true => {
            let mut robot = setting.robot.clone();
            let tightest = least_clearance(&setting.space, &mut robot, &path, 0.1 * setting.tolerance);
            tightest.map_or(report.clearance, |t| t.clearance.max(report.clearance))
        }
        false => 0.0,
    };
    Ok(Verdict::new(poses.len(), report.length, clearance, faults))
}

/// The fault with the configuration at which it is, and the bodies that touch.
fn told<M: Mover>(setting: &Setting<M>, path: &Path<M::State>, fault: PathFault) -> String {
    let PathFault::Motion { edge, check } = fault else {
        return match fault {
            PathFault::OutOfBounds { state } => format!("configuration {} is out of bounds", state + 1),
            fault => fault.to_string(),
        };
    };
    let (from, to) = (&path.states[edge], path.states.get(edge + 1).unwrap_or(&path.states[edge]));
    let state = setting.space.interpolate(from, to, check.failed_at().unwrap_or(0.0));
    let at = mp::geom::six_from_pose(&M::pose(&state)).map(brief).join(" ");
    let touching = setting.touching(&state);
    let what = match (check, touching.is_empty()) {
        (MotionCheck::Undecided { .. }, _) | (_, true) => {
            format!("comes nearer to an obstacle than {} m", brief(setting.tolerance))
        }
        _ => format!("hits {}", touching.join(", ")),
    };
    format!("{what} between configurations {} and {}, at {at}", edge + 1, edge + 2)
}
