//! The start and the goals of a robot problem, as its robot takes them.

use super::{ArmScene, LinkedScene, LinkedSpace, pose_goals, within};
use crate::goals::GoalPart;
use crate::robot::DrivenScene;
use crate::{Error, Interrupt};
use mp_cspace::Configuration;
use mp_io::{GoalEntry, RobotFile, RobotFilePart, RobotPart, RobotProblem};
use mp_robot::Arm;
use std::f64::consts::FRAC_PI_2;

/// Where the angle β of a base that floats is among the numbers of a configuration.
const BETA: usize = 4;

/// The start and the goals of a problem.
pub(super) struct Ends {
    /// The row of the start.
    pub(super) start: Vec<f64>,
    /// What each goal asks of each number of a row.
    pub(super) goals: Vec<Vec<GoalPart>>,
    /// For each goal, the one of the problem that it is from.
    pub(super) entries: Vec<usize>,
    /// Which configurations reach goals that are places of links, in sentences.
    pub(super) said: Vec<String>,
}

impl<C: LinkedSpace> LinkedScene<C> {
    /// The ends of a problem, none of which is given by a name any more.
    ///
    /// # Errors
    /// When the length of a configuration does not fit the robot, or a goal cannot be reached by it: with the line of the file.
    pub(super) fn ends(problem: &RobotProblem, arm: &Arm, interrupt: &Interrupt) -> Result<Ends, Error> {
        let (file, names) = (&problem.file, Self::names(arm));
        let (driven, row) = (file.robots[0].driven.as_ref(), file.start.row());
        let state_names = driven.map_or_else(|| names.clone(), |driven| driven.state_names(&names));
        let floats = arm.kinematics().floats();
        if row.len() != state_names.len()
            && let Some(wrong) = wrong_count("the start", row, &names)
        {
            return Err(fault(file, RobotFilePart::Start, wrong));
        }
        if floats && driven.is_some() {
            let message = "a robot whose base floats cannot move by inputs here".to_owned();
            let help = "leave `kind` out, or give the base a place: `base = [x, y, z, α, β, γ]`".to_owned();
            return Err(fault(file, RobotFilePart::Robot(0, RobotPart::Robot), [message, help]));
        }
        let start = row[..names.len()].to_vec();
        let mut ends = Ends { start, goals: Vec::new(), entries: Vec::new(), said: Vec::new() };
        for (i, goal) in file.goals.iter().enumerate() {
            let wrong = |wrong| fault(file, RobotFilePart::Goal(i), wrong);
            if let (GoalEntry::Pose(entry), None, Ok(joints)) = (goal, driven, arm.space()) {
                let start = joints.wrapped(&within(joints.ranges(), row).into());
                let found = pose_goals::goals(arm, &joints, entry, &start, interrupt);
                let (configurations, sentence) = found.map_err(wrong)?;
                let exactly = |q: &Configuration| q.iter().map(|x| GoalPart::Exactly(*x)).collect();
                ends.goals.extend(configurations.iter().map(exactly));
                ends.said.push(sentence);
            } else {
                ends.goals.push(numbers(file, goal, &names, &state_names, floats).map_err(wrong)?);
            }
            ends.entries.resize(ends.goals.len(), i);
        }
        if let Some(driven) = driven {
            driven
                .check(&names)
                .map_err(|wrong| fault(file, RobotFilePart::Robot(0, RobotPart::Robot), wrong))?;
            let exact = |goal: &Vec<GoalPart>| goal.iter().any(|part| matches!(part, GoalPart::Exactly(_)));
            if let Some(i) = ends.goals.iter().position(exact) {
                let message = "a robot that moves by inputs cannot reach these numbers exactly".to_owned();
                let help = "say `tolerance = 0.1` in [motion], or give intervals: { joint = [1.0, 1.2] }";
                return Err(fault(file, RobotFilePart::Goal(i), [message, help.to_owned()]));
            }
        }
        ends.goals.iter_mut().for_each(|goal| goal.truncate(names.len()));
        if !file.parts.is_empty() {
            let all = file.part + file.parts.len();
            ends.said.push(format!("this is part {} of a motion of {all} parts", file.part));
        }
        Ok(ends)
    }
}

fn fault(file: &RobotFile, part: RobotFilePart, [message, help]: [String; 2]) -> Error {
    file.fault(part, &message, &help).into()
}

/// What a goal asks of each number of a row, and of the velocities after them.
fn numbers(
    file: &RobotFile,
    goal: &GoalEntry,
    names: &[String],
    state_names: &[String],
    floats: bool,
) -> Result<Vec<GoalPart>, [String; 2]> {
    if let Some(values) = goal.values()
        && values.len() != state_names.len()
        && let Some(wrong) = wrong_count("the goal", values, names)
    {
        return Err(wrong);
    }
    let parts = goal.parts("the goal", state_names, names.len(), file.tolerance)?;
    let steep = match parts.get(BETA) {
        Some(GoalPart::Between([low, high])) => *low < -FRAC_PI_2 || *high > FRAC_PI_2,
        Some(GoalPart::Exactly(v)) => goal.values().is_none() && v.abs() > FRAC_PI_2,
        _ => false,
    };
    if floats && steep {
        let message = "beta of a goal that leaves something free is beyond a quarter turn".to_owned();
        return Err([message, "give beta from -π/2 to π/2".to_owned()]);
    }
    Ok(parts)
}

/// An error message and a remedy if a configuration has the wrong length.
pub(super) fn wrong_count(what: &str, values: &[f64], names: &[String]) -> Option<[String; 2]> {
    let (found, joints) = (values.len(), names.len());
    (found != joints).then(|| {
        let message = format!("{what} has {found} numbers; a configuration of this robot has {joints}");
        [message, format!("in order: {}", names.join(", "))]
    })
}

impl ArmScene {
    /// The same arm, moved by inputs as its file says; `None` when the file says nothing of it.
    ///
    /// # Errors
    /// When the arm cannot move so.
    pub fn driven(&self) -> Result<Option<DrivenScene>, Error> {
        let Some(file) = self.source.as_ref().map(|problem| &problem.file) else { return Ok(None) };
        let Some(driven) = &file.robots[0].driven else { return Ok(None) };
        let names: Vec<_> = self.arm.coordinates().iter().map(|c| c.name.clone()).collect();
        let state_names = driven.state_names(&names);
        let parts =
            file.goals.iter().map(|goal| goal.parts("the goal", &state_names, names.len(), file.tolerance));
        let parts =
            parts.collect::<Result<_, _>>().map_err(|[message, help]| Error::new(message).help(help))?;
        let velocity = file.start.row()[names.len()..].to_vec();
        DrivenScene::new(self.clone(), driven, &velocity, parts).map(Some)
    }
}
