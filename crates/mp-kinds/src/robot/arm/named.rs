//! Ends of a problem that are given by names: of joints, or of states of the SRDF.

use super::{LinkedSpace, read};
use crate::robot::HAIR;
use crate::{Error, count};
use mp_cspace::FloatingJoints;
use mp_io::{GoalEntry, GoalPart, MovingJoints, NamedStart, RobotFilePart, RobotProblem, StartEntry};
use mp_robot::{ArmModel, Kinematics, SrdfGroups};
use std::collections::{BTreeMap, BTreeSet};

/// The values of joints by name (rad or m).
pub(super) type Values = BTreeMap<String, f64>;

/// What a problem calls by names: the groups and states of the SRDFs of its robots, and the joints that its start names.
#[derive(Debug, Default)]
pub(super) struct NamedValues {
    /// Those of each robot.
    groups: Vec<SrdfGroups>,
    start: Values,
}

impl NamedValues {
    /// Those of a problem.
    ///
    /// # Errors
    /// When an SRDF is none, or has no state of the name that the start has.
    pub(super) fn of(problem: &RobotProblem) -> Result<Self, Error> {
        let file = &problem.file;
        let by_name = file.start.by_name().is_some()
            || file.robots.iter().any(|robot| robot.moving.is_some())
            || file.goals.iter().any(|goal| matches!(goal, GoalEntry::State(_)));
        let groups = problem.robots.iter().enumerate().map(|(i, robot)| {
            match robot.srdf.as_ref().filter(|_| by_name) {
                Some(text) => SrdfGroups::from_srdf(text).map_err(|e| read::srdf_fault(problem, i, &e)),
                None => Ok(SrdfGroups::default()),
            }
        });
        let mut named = Self { groups: groups.collect::<Result<_, _>>()?, start: Values::new() };
        named.start = match file.start.by_name() {
            None => Values::new(),
            Some(NamedStart::Joints(values)) => values.clone(),
            Some(NamedStart::State(state)) => named.state(problem, RobotFilePart::Start, state)?,
        };
        Ok(named)
    }

    pub(super) fn groups(&self, robot: usize) -> &SrdfGroups {
        &self.groups[robot]
    }

    /// The value that the start has for a joint, if it names that.
    pub(super) fn value(&self, joint: &str) -> Option<f64> {
        self.start.get(joint).copied()
    }

    /// The values that the start has for joints that are not among `names`: they are held, or not there.
    pub(super) fn beside(&self, names: &[String]) -> Values {
        let others = self.start.iter().filter(|(joint, _)| !names.contains(joint));
        others.map(|(joint, value)| (joint.clone(), *value)).collect()
    }

    /// The values of a state: of all robots and groups that have one of this name, where they differ those of the group that moves.
    fn state(&self, problem: &RobotProblem, part: RobotFilePart, name: &str) -> Result<Values, Error> {
        let (mut values, mut known) = (Values::new(), BTreeSet::new());
        let mut found = false;
        for (i, groups) in self.groups.iter().enumerate() {
            let (prefix, moving) = (problem.file.prefix(i), &problem.file.robots[i].moving);
            known.extend(groups.states().iter().map(|state| state.name.as_str()));
            let mut states: Vec<_> = groups.states().iter().filter(|state| state.name == name).collect();
            states.sort_by_key(
                |state| matches!(moving, Some(MovingJoints::Group(group)) if *group == state.group),
            );
            found |= !states.is_empty();
            let mut of: BTreeMap<&str, (&str, f64)> = BTreeMap::new();
            for state in states {
                let own = state.group.as_str();
                let counts = matches!(moving, Some(MovingJoints::Group(group)) if *group == own);
                for (joint, value) in &state.values {
                    match of.insert(joint, (own, *value)) {
                        Some((other, before)) if !counts && other != own && before != *value => {
                            let message = format!(
                                "the state \"{name}\" has {before} for `{joint}` in the group \"{other}\", and {value} in the group \"{own}\""
                            );
                            let help = "say which joints move by `group = \"…\"` in [robot], whose state counts then, or give numbers";
                            return Err(problem.file.fault(part, &message, help).into());
                        }
                        _ => {}
                    }
                }
            }
            values.extend(of.into_iter().map(|(joint, (_, value))| (format!("{prefix}{joint}"), value)));
        }
        if found {
            return Ok(values);
        }
        let help = match (problem.robots.iter().any(|robot| robot.srdf.is_some()), known.is_empty()) {
            (false, _) => "give numbers, or an SRDF by `srdf` in [robot]: there is none".to_owned(),
            (_, true) => "give numbers: the SRDF names no states".to_owned(),
            _ => format!("the SRDF has the states {}", known.into_iter().collect::<Vec<_>>().join(", ")),
        };
        Err(problem.file.fault(part, &format!("there is no state \"{name}\""), &help).into())
    }
}

/// Gives the start and the goals of a problem that are given by names as numbers. Returns what is to be said of them.
///
/// # Errors
/// When there is no such state or no such joint.
pub(super) fn resolve(
    problem: &mut RobotProblem,
    named: &NamedValues,
    kinematics: &Kinematics,
    model: &ArmModel,
) -> Result<Vec<String>, Error> {
    let base = if kinematics.floats() { <FloatingJoints as LinkedSpace>::BASE } else { &[] };
    let names: Vec<&str> = base
        .iter()
        .map(|(name, _)| *name)
        .chain(kinematics.coordinates().iter().map(|c| c.name.as_str()))
        .collect();
    let zeros = [vec![0.0; base.len()], kinematics.neutral()].concat();
    let row = |values: &Values, others: &[f64]| -> Vec<f64> {
        let value = |(name, other): (&&str, &f64)| *values.get(*name).unwrap_or(other);
        names.iter().zip(others).map(value).collect()
    };
    let mut said = Vec::new();
    let mut tell = |state: &str, values: &Values, are: &str| {
        let missing: Vec<_> = names.iter().filter(|name| !values.contains_key(**name)).copied().collect();
        if !missing.is_empty() {
            let numbers = count(missing.len(), "number");
            said.push(format!(
                "the state \"{state}\" leaves out {numbers}, which are {are}: {}",
                missing.join(", ")
            ));
        }
    };
    if let Some(NamedStart::Joints(values)) = problem.file.start.by_name() {
        let held = |name: &str| {
            model.joints.iter().find(|joint| joint.name == name).and_then(|joint| joint.kind.held())
        };
        if let Some(stray) =
            values.keys().find(|joint| !names.contains(&joint.as_str()) && held(joint).is_none())
        {
            let message = format!("the start names `{stray}`, which the robot does not have");
            let help = format!("in order: {}", names.join(", "));
            return Err(problem.file.fault(RobotFilePart::Start, &message, &help).into());
        }
        let elsewhere = |(joint, value): (&String, &f64)| {
            let at = held(joint).filter(|at| (value - at).abs() > HAIR)?;
            Some((joint.clone(), *value, at))
        };
        if let Some((joint, value, at)) = values.iter().find_map(elsewhere) {
            let message = format!("the start has `{joint}` at {value}, and it is held at {at}");
            let help = "leave it out of the start, or hold it there: by `hold` or equal `limits` in [robot]";
            return Err(problem.file.fault(RobotFilePart::Start, &message, help).into());
        }
    }
    problem.file.start = StartEntry::All(match &problem.file.start {
        StartEntry::All(numbers) | StartEntry::Beside { numbers, .. } => numbers.clone(),
        StartEntry::Named(given) => {
            if let NamedStart::State(state) = given {
                tell(state, &named.start, "at zero or the limit nearest to it");
            }
            row(&named.start, &zeros)
        }
    });
    let start = problem.file.start.row();
    let others = if start.len() < names.len() { zeros } else { start.to_vec() };
    for i in 0..problem.file.goals.len() {
        if let GoalEntry::Named(parts) = &problem.file.goals[i] {
            let mut parts = parts.clone();
            // Where a joint is held it need not be said, but may be.
            for joint in &model.joints {
                let Some(at) = joint.kind.held() else { continue };
                let Some(part) = parts.remove(&joint.name) else { continue };
                let there = match part {
                    GoalPart::Exactly(value) => value == at,
                    GoalPart::Between([low, high]) => (low..=high).contains(&at),
                    GoalPart::Free => true,
                };
                if !there {
                    let message = format!("the goal moves `{}`, which is held at {at}", joint.name);
                    let help = "leave it out of the goal, or do not hold it: by `hold`, equal `limits`, `group` or `joints` in [robot]";
                    return Err(problem.file.fault(RobotFilePart::Goal(i), &message, help).into());
                }
            }
            problem.file.goals[i] = GoalEntry::Named(parts);
        }
        let GoalEntry::State(state) = &problem.file.goals[i] else { continue };
        let values = named.state(problem, RobotFilePart::Goal(i), state)?;
        tell(state, &values, "as at the start");
        problem.file.goals[i] = GoalEntry::All(row(&values, &others));
    }
    Ok(said)
}
