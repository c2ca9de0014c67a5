//! Is a path free, by the checker that shares no code with the planner's? And of one configuration: what is wrong?

use crate::numbers::brief;
use crate::{End, Error, PathRows, RobotKind, Touch};
use mp_cspace::erased::AnyCheck;
use mp_cspace::{
    Clearance, MotionCheck, Path, Space, least_clearance,
    path::{PathFault, PathReport},
    verify_path,
};
use serde::{Deserialize, Serialize};

/// What the check of a path found. Its JSON form is what `mp check --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// The scene, as it was named.
    pub scene: String,
    /// The path, as it was named.
    pub path: String,
    /// Free all along, from the start of the scene to a goal.
    pub free: bool,
    /// How many configurations there are.
    pub configurations: usize,
    /// In the metric of the space.
    pub path_length: f64,
    /// A lower bound all along, metres; 0 when not free.
    pub clearance: f64,
    /// What is wrong, if anything.
    pub faults: Vec<String>,
}

impl Verdict {
    /// A few lines for a person.
    #[must_use]
    pub fn summary(&self) -> String {
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

/// The states of rows that came from a file.
pub(crate) fn states<K: RobotKind>(kind: &K, path: &PathRows) -> Result<Vec<K::State>, Error> {
    let columns = kind.columns().len();
    match path.rows.iter().find(|row| row.len() != columns) {
        None if path.rows.is_empty() => Err(Error::new("the path has no configurations")),
        None => Ok(path.rows.iter().map(|row| kind.state(row)).collect()),
        Some(row) => {
            let (name, found) = (kind.name(), row.len());
            let what = match found {
                1 => "1 number".to_owned(),
                n => format!("{n} numbers"),
            };
            Err(Error::new(format!(
                "a configuration of the path has {what}, the robot of {name} has {columns}"
            ))
            .help("is this a path of another robot?"))
        }
    }
}

/// Verifies a path, edge by edge.
pub(crate) fn verified<K: RobotKind>(kind: &K, path: &Path<K::State>) -> Result<PathReport, Error> {
    let mut verifier: AnyCheck<'_, K::State> = Box::new(kind.verifier()?);
    Ok(verify_path(kind.space(), path, &mut verifier))
}

/// A lower bound on the clearance (m) along a path that is free, so accurate.
pub(crate) fn clearance<K: RobotKind>(kind: &K, path: &Path<K::State>, accuracy: f64) -> Option<f64> {
    let mut checker = kind.checker().clone();
    least_clearance(kind.space(), &mut checker, path, accuracy).map(|tightest| tightest.clearance)
}

/// Verifies a path from the start to a goal.
pub(crate) fn check<K: RobotKind>(kind: &K, path: &PathRows) -> Result<Verdict, Error> {
    let _span = tracing::info_span!("check", scene = kind.name()).entered();
    let states = Path::straight(states(kind, path)?);
    let mut faults = Vec::new();
    let (first, last) = (&states.states[0], &states.states[states.states.len() - 1]);
    let start = kind.mismatch(first, kind.start());
    if !start.is_near() {
        faults.push(format!("does not begin at the start: {}{} off", brief(start.off), start.unit));
    }
    let ends = kind.goals().iter().map(|goal| kind.mismatch(last, goal));
    let nearest = ends.min_by(|a, b| a.off.total_cmp(&b.off));
    if let Some(goal) = nearest
        && !goal.is_near()
    {
        let which = if kind.goals().len() > 1 { "a goal" } else { "the goal" };
        faults.push(format!("does not end at {which}: {}{} off", brief(goal.off), goal.unit));
    }
    faults.extend(kind.odd_rows(&path.rows));
    let report = verified(kind, &states)?;
    faults.extend(report.fault.map(|fault| told(kind, &states, fault)));
    let clearance = match faults.is_empty() {
        true => {
            let found = clearance(kind, &states, 0.1 * kind.accuracy());
            found.map_or(report.clearance, |c| c.max(report.clearance))
        }
        false => 0.0,
    };
    Ok(Verdict {
        scene: kind.name().to_owned(),
        path: String::new(),
        free: faults.is_empty(),
        configurations: states.states.len(),
        path_length: report.length,
        clearance,
        faults,
    })
}

/// The fault with the configuration at which it is, and what touches.
fn told<K: RobotKind>(kind: &K, path: &Path<K::State>, fault: PathFault) -> String {
    let (edge, check) = match fault {
        PathFault::Motion { edge, check } => (edge, check),
        PathFault::OutOfBounds { state } => {
            return format!("configuration {} is {}", state + 1, kind.out_of_bounds(&path.states[state]));
        }
        fault => return fault.to_string(),
    };
    let (from, to) = (&path.states[edge], path.states.get(edge + 1).unwrap_or(&path.states[edge]));
    let state = kind.space().interpolate(from, to, check.failed_at().unwrap_or(0.0));
    let at: Vec<_> = kind.row(&state).into_iter().map(brief).collect();
    let touching = kind.touching(&state);
    let what = match (check, touching.is_empty()) {
        (MotionCheck::Unproven { .. }, _) | (_, true) => {
            format!("comes nearer to contact than {} m", brief(kind.tolerance()))
        }
        _ => format!("hits {}", list(&touching)),
    };
    format!("{what} between configurations {} and {}, at [{}]", edge + 1, edge + 2, at.join(", "))
}

fn list(touching: &[Touch]) -> String {
    touching.iter().map(Touch::to_string).collect::<Vec<_>>().join(", ")
}

/// What there is to say about one configuration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Explanation {
    /// In bounds, and at least the tolerance from contact.
    pub free: bool,
    /// Within the bounds of the space.
    pub in_bounds: bool,
    /// A lower bound on the distance to contact, metres; zero in collision.
    pub clearance: f64,
    /// What touches what.
    pub touching: Vec<Touch>,
    /// What is wrong, in a sentence after "the configuration is"; none when it is free.
    pub fault: Option<String>,
    /// A free configuration nearby, of one that is not free.
    pub nearest_free: Option<Vec<f64>>,
}

/// Explains a configuration.
pub(crate) fn explain<K: RobotKind>(kind: &K, q: &K::State) -> Explanation {
    let (in_bounds, fault) = (kind.space().contains(q), fault(kind, q));
    let clearance = match in_bounds {
        true => kind.checker().clone().clearance(q, f64::INFINITY).max(0.0),
        false => 0.0,
    };
    let nearest = fault.is_some().then(|| kind.nearest_free(q)).flatten();
    Explanation {
        free: fault.is_none(),
        in_bounds,
        clearance,
        touching: if in_bounds { kind.touching(q) } else { Vec::new() },
        fault,
        nearest_free: nearest.map(|q| kind.row(&q)),
    }
}

/// What is wrong with a configuration, after "the start is".
fn fault<K: RobotKind>(kind: &K, q: &K::State) -> Option<String> {
    if !kind.space().contains(q) {
        return Some(kind.out_of_bounds(q));
    }
    let tolerance = kind.tolerance();
    let clearance = kind.checker().clone().clearance(q, tolerance);
    if clearance >= tolerance {
        return None;
    }
    let touching = kind.touching(q);
    Some(match touching.is_empty() {
        true => format!("{} m from contact: at least {} m is needed", brief(clearance), brief(tolerance)),
        false if touching.iter().any(|touch| touch.part.is_some()) => {
            format!("in collision: {}", list(&touching))
        }
        false => format!("in collision with {}", list(&touching)),
    })
}

/// Start and goals, and how messages call them.
fn ends<K: RobotKind>(kind: &K) -> impl Iterator<Item = (End, String, &K::State)> {
    let many = kind.goals().len() > 1;
    let goals = kind.goals().iter().enumerate().map(move |(i, q)| {
        let name = if many { format!("goal {}", i + 1) } else { "the goal".to_owned() };
        (End::Goal(i), name, q)
    });
    std::iter::once((End::Start, "the start".to_owned(), kind.start())).chain(goals)
}

/// What is wrong with a configuration that messages call `name`, and what to do; `None` when it is free.
pub(crate) fn refused<K: RobotKind>(kind: &K, name: &str, q: &K::State) -> Option<(String, String)> {
    let fault = fault(kind, q)?;
    let help = match kind.nearest_free(q) {
        _ if !kind.space().contains(q) => "move it, or widen the bounds".to_owned(),
        Some(free) => format!("the nearest free configuration found is {}", kind.written(&free)),
        None => "no free configuration was found nearby: is the scene in metres, the robot in its frame?"
            .to_owned(),
    };
    Some((format!("{name} is {fault}"), help))
}

/// An error when start or a goal is not free: names what touches, how deep, and the nearest free configuration.
/// Otherwise what is odd about them.
pub(crate) fn check_ends<K: RobotKind>(kind: &K) -> Result<Vec<String>, Error> {
    for (end, name, q) in ends(kind) {
        if let Some((message, help)) = refused(kind, &name, q) {
            return Err(kind.fault(end, message, help));
        }
    }
    Ok(kind.odd_ends().into_iter().collect())
}

/// What is wrong or odd about a scene.
pub(crate) fn lint<K: RobotKind>(kind: &K) -> Vec<String> {
    let mut found: Vec<String> =
        ends(kind).filter_map(|(_, name, q)| Some(format!("{name} is {}", fault(kind, q)?))).collect();
    found.extend(kind.lint());
    if kind.bodies().iter().all(|body| body.pose.is_none()) {
        found.push("there are no obstacles".to_owned());
    }
    if kind.goals().contains(kind.start()) {
        found.push("start and goal are the same".to_owned());
    }
    found
}
