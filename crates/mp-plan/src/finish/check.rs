//! Verifies a path, with code that shares nothing with the planner's checks.

use crate::explain::{enclosures, list};
use crate::finish::trajectory::TrajectoryVerdict;
use crate::path::states;
use crate::{Error, PathRows, Robot};
use mp_cspace::angle::rotation_angle;
use mp_cspace::{Configuration, Interrupt, MotionCheck, Path, Space, path::PathFault};
use mp_geom::pose_from_six;
use mp_kinds::Deviation;
use mp_kinds::goals::next_to;
use mp_kinds::numbers::{at_least, brief, count, plain};
use mp_kinds::proof::{clearance, verified};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// The result of checking a path. `mp check --json` prints its JSON form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// The name of the scene that the path was checked in.
    pub scene: String,
    /// What messages call the path, such as its file; empty until the caller names it.
    pub path: String,
    /// Whether the path is free all along and leads from the start of the scene to a goal.
    pub free: bool,
    /// How many configurations the path has.
    pub configurations: usize,
    /// The length of the path, in the metric of the space.
    pub path_length: f64,
    /// A lower bound (m) on the clearance along the path; 0 when it is not free, or none is known.
    pub clearance: f64,
    /// The clearance (m) from obstacles that was asked for; left out where none was.
    #[serde(default, skip_serializing_if = "crate::request::is_zero")]
    pub clearance_kept: f64,
    /// What is wrong. Empty when the path is free.
    pub faults: Vec<String>,
    /// What is known of a trajectory besides; left out for paths without times.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trajectory: Option<TrajectoryVerdict>,
    /// What is odd about a path that is free: what is inside of closed surfaces, which have no inside unless they are made solid, and half turns.
    #[serde(default)]
    pub warnings: Vec<String>,
}

impl Verdict {
    /// A few lines for a person.
    #[must_use]
    pub fn summary(&self) -> String {
        if self.free {
            let clearance = match self.clearance.is_finite() {
                true if self.clearance == 0.0 => "clearance not known".to_owned(),
                true => format!("clearance at least {} m", at_least(self.clearance)),
                false => "there is nothing to hit".to_owned(),
            };
            let (time, shape) = match &self.trajectory {
                None => (String::new(), String::new()),
                Some(t) => {
                    let at = t
                        .least_at
                        .filter(|_| self.clearance.is_finite())
                        .map(|at| format!(" (the least is at {} s)", brief(at)));
                    (at.unwrap_or_default(), format!("{} s, {} curve, ", brief(t.duration), t.curve))
                }
            };
            let how = if self.clearance > 0.0 { "certified free" } else { "free wherever it was tested" };
            return format!(
                "{}: {how} in {}\n  {}, {shape}length {}, {clearance}{time}",
                self.path,
                self.scene,
                count(self.configurations, "configuration"),
                brief(self.path_length),
            );
        }
        format!("{}: not free in {}\n  {}", self.path, self.scene, self.faults.join("\n  "))
    }
}

/// Whether a path, which has a state, begins elsewhere than at the start, or ends elsewhere than at a goal.
pub(crate) fn end_faults(kind: &dyn Robot, states: &[Configuration]) -> Vec<String> {
    let mut faults = Vec::new();
    let (first, last) = (&states[0], &states[states.len() - 1]);
    let start = kind.deviation(first, kind.start());
    if !start.is_near() {
        faults.push(format!("does not begin at the start: {}{} off", brief(start.off), start.unit));
    }
    let ends: Vec<_> = match kind.goal_parts() {
        None => kind.goals().iter().map(|goal| kind.deviation(last, goal)).collect(),
        Some(goals) => goals.iter().map(|goal| kind.deviation(last, &next_to(kind, goal, last))).collect(),
    };
    let reached = ends.iter().any(Deviation::is_near) || kind.reaches_place(last);
    let nearest = ends.into_iter().min_by(|a, b| a.off.total_cmp(&b.off));
    if let Some(goal) = nearest
        && !reached
    {
        let which = if kind.goals().len() > 1 { "a goal" } else { "the goal" };
        faults.push(format!("does not end at {which}: {}{} off", brief(goal.off), goal.unit));
    }
    faults
}

/// Checks that a path is free and leads from the start to a goal. Where `interrupt` says to end, the path has a fault.
pub(crate) fn check(kind: &dyn Robot, path: &PathRows, interrupt: &Interrupt) -> Result<Verdict, Error> {
    let _span = tracing::info_span!("check", scene = kind.name()).entered();
    let states = Path::straight(states(kind, path)?);
    let mut faults = end_faults(kind, &states.states);
    faults.extend(kind.row_error(&path.rows));
    let report = verified(kind, &states, interrupt)?;
    faults.extend(report.fault.map(|fault| fault_text(kind, &states, fault)));
    let clearance = match faults.is_empty() {
        true => {
            let found = clearance(kind, &states, 0.1 * kind.accuracy(), interrupt);
            found.map_or(report.clearance, |c| c.max(report.clearance))
        }
        false => 0.0,
    };
    // What is inside at one end of a free path is so all along.
    let warnings = if faults.is_empty() {
        enclosures(kind, &states.states[0]).into_iter().chain(half_turn(kind, &states.states)).collect()
    } else {
        Vec::new()
    };
    Ok(Verdict {
        warnings,
        scene: kind.name().to_owned(),
        path: String::new(),
        free: faults.is_empty(),
        configurations: states.states.len(),
        path_length: report.length,
        clearance,
        clearance_kept: kind.kept(),
        faults,
        trajectory: None,
    })
}

/// Where a body in space first turns half way round in one piece: rows of angles do not say which way.
fn half_turn(kind: &dyn Robot, states: &[Configuration]) -> Option<String> {
    let first = kind.columns().iter().position(|column| column.name == "alpha")?;
    let turned = |q: &Configuration| {
        let row = kind.row(q);
        let [alpha, beta, gamma] = *row.get(first..)?.first_chunk()?;
        Some(pose_from_six([0.0, 0.0, 0.0, alpha, beta, gamma]).rotation)
    };
    let turns: Vec<_> = states.iter().map(turned).collect::<Option<_>>()?;
    let edge = turns.windows(2).position(|pair| rotation_angle(&pair[0], &pair[1]) > PI - 1e-7)?;
    Some(format!(
        "between configurations {} and {} it turns half way round, and the path does not say which way: another program may turn the \
        other way, which was not checked; put a configuration between",
        edge + 1,
        edge + 2
    ))
}

/// A fault as text, with the configuration at which it occurs and what touches there.
pub(crate) fn fault_text(kind: &dyn Robot, path: &Path<Configuration>, fault: PathFault) -> String {
    let (edge, check) = match fault {
        PathFault::Motion { edge, check } => (edge, check),
        PathFault::OutOfBounds { state } => {
            return format!("configuration {} is {}", state + 1, kind.out_of_bounds(&path.states[state]));
        }
        fault => return fault.to_string(),
    };
    let (from, to) = (&path.states[edge], path.states.get(edge + 1).unwrap_or(&path.states[edge]));
    if !kind.can_move(from, to) {
        return format!("the robot cannot move from configuration {} to {}", edge + 1, edge + 2);
    }
    let state = kind.any_space().interpolate(from, to, check.failed_at().unwrap_or(0.0));
    let at: Vec<_> = kind.row(&state).into_iter().map(plain).collect();
    let what = what_happens(kind, &state, check);
    format!("{what} between configurations {} and {}, at [{}]", edge + 1, edge + 2, at.join(", "))
}

/// What is wrong at a configuration where a check has failed: what it hits, as a rule.
pub(crate) fn what_happens(kind: &dyn Robot, state: &Configuration, check: MotionCheck) -> String {
    let touching = kind.touching(state);
    let broken = kind.broken(state);
    match (check, touching.is_empty()) {
        _ if let Some(constraint) = &broken => format!("is against the constraint `{constraint}`"),
        _ if kind.sampled().is_some() => "collides".to_owned(),
        (MotionCheck::Unproven { .. }, true)
            if kind.closest(state).is_some_and(|(_, apart)| apart > kind.kept() + kind.tolerance()) =>
        {
            "cannot be proved free in one piece (add configurations)".to_owned()
        }
        (_, true) if kind.kept() > 0.0 => {
            format!("comes nearer to an obstacle than {} m", brief(kind.kept()))
        }
        (MotionCheck::Unproven { .. }, _) | (_, true) => {
            format!("comes nearer to contact than {} m", brief(kind.tolerance()))
        }
        _ => format!("hits {}", list(&touching)),
    }
}
