//! A robot problem made ready.

use crate::info::brief;
use miette::{IntoDiagnostic, Result, WrapErr, miette};
use mp::cspace::{Clearance, JointRange, Joints, Space};
use mp::io::{JointPath, RobotPart, RobotProblem};
use mp::robot::{Arm, ArmModel, ArmVerifier};
use nalgebra::DVector;
use std::path::Path;

/// The joint values of an arm.
pub(crate) type State = DVector<f64>;

/// A problem and everything made of it once, for all runs.
#[derive(Clone, Debug)]
pub(crate) struct Task {
    pub(crate) problem: RobotProblem,
    pub(crate) arm: Arm,
    pub(crate) space: Joints<State>,
    pub(crate) start: State,
    pub(crate) goals: Vec<State>,
    /// Clearance that the certified check resolves, metres.
    pub(crate) tolerance: f64,
}

impl Task {
    /// Reads the robot problem `file` and makes it ready.
    pub(crate) fn load(file: &Path) -> Result<Self> {
        let problem = RobotProblem::load(file)?;
        let of = || format!("cannot make a robot of {}", problem.urdf_file.display());
        let mut model = ArmModel::from_urdf(&problem.urdf, |name| problem.mesh(name))
            .into_diagnostic()
            .wrap_err_with(of)?;
        for note in &model.notes {
            tracing::info!("{}: {note}", problem.urdf_file.display());
        }
        model.base = problem.base();
        if let Some(srdf) = &problem.srdf {
            model = model.with_srdf(srdf).map_err(|e| {
                problem.file.fault(RobotPart::Srdf, &e.to_string(), "name an SRDF of this robot, or none")
            })?;
        }
        for (i, (joint, [low, high])) in problem.file.limits.iter().enumerate() {
            model = model.with_limits(joint, *low, *high).map_err(|e| {
                problem.file.fault(RobotPart::Limits(i), &e.to_string(), "name joints as the URDF does")
            })?;
        }
        let obstacles = problem.obstacles.iter().map(|o| (o.name.clone(), o.mesh.clone(), o.pose));
        let arm = Arm::new(&model, obstacles).into_diagnostic().wrap_err_with(of)?;
        let space: Joints<State> = arm.space().into_diagnostic()?;
        let state = |part: RobotPart, name: &str, values: &[f64]| -> Result<State> {
            if values.len() == arm.dof() {
                return Ok(space.wrapped(&DVector::from_column_slice(values)));
            }
            let names: Vec<_> = arm.coordinates().iter().map(|c| c.name.as_str()).collect();
            let message = format!("{name} has {} numbers; the robot has {} joints", values.len(), arm.dof());
            Err(problem.file.fault(part, &message, &format!("in order: {}", names.join(", "))).into())
        };
        let start = state(RobotPart::Start, "the start", &problem.file.start)?;
        let goals = problem.file.goals.iter().enumerate();
        let goals =
            goals.map(|(i, goal)| state(RobotPart::Goal(i), "the goal", goal)).collect::<Result<Vec<_>>>()?;
        let tolerance = arm.tolerance();
        Ok(Self { problem, arm, space, start, goals, tolerance })
    }

    pub(crate) fn name(&self) -> &str {
        &self.problem.name
    }

    /// The independent checker.
    pub(crate) fn verifier(&self) -> Result<ArmVerifier<'_, Joints<State>>> {
        ArmVerifier::new(&self.space, &self.arm).into_diagnostic()
    }

    /// The configurations of a path that is one of this robot.
    pub(crate) fn path(&self, file: &JointPath) -> Result<Vec<State>> {
        let (joints, dof) = (file.configurations.first().map_or(0, Vec::len), self.arm.dof());
        if joints == dof {
            return Ok(self.states(file));
        }
        Err(miette!(
            help = "is this a path of another robot?",
            "the path has {joints} joints, the robot of {} has {dof}",
            self.name()
        ))
    }

    /// The configurations of a path as the space has them.
    pub(crate) fn states(&self, file: &JointPath) -> Vec<State> {
        let states = file.configurations.iter().map(|q| DVector::from_column_slice(q));
        states.map(|q| self.space.wrapped(&q)).collect()
    }

    /// What touches what at `q`, and how deep.
    pub(crate) fn touching(&self, q: &State) -> Vec<String> {
        let contacts = self.arm.clone().explain(q.as_slice());
        let told = contacts.iter().map(|c| {
            let whose = if c.with_itself { " of the robot" } else { "" };
            format!("{} in {}{whose} ({} m deep)", c.link, c.other, brief(c.depth))
        });
        told.collect()
    }

    /// Start and goals: how errors call them, and where they are in the file.
    fn ends(&self) -> impl Iterator<Item = (String, RobotPart, &State)> {
        let many = self.goals.len() > 1;
        let goals = self.goals.iter().enumerate().map(move |(i, q)| {
            let name = if many { format!("goal {}", i + 1) } else { "the goal".to_owned() };
            (name, RobotPart::Goal(i), q)
        });
        std::iter::once(("the start".to_owned(), RobotPart::Start, &self.start)).chain(goals)
    }

    /// What is wrong with start and goals.
    pub(crate) fn overlaps(&self) -> Vec<String> {
        let faults = self.ends().filter_map(|(name, _, q)| self.fault(&name, q));
        faults.collect()
    }

    /// An error when start or a goal is not free: names what touches, and the nearest free configuration.
    pub(crate) fn check_ends(&self) -> Result<()> {
        for (name, part, q) in self.ends() {
            let Some(fault) = self.fault(&name, q) else { continue };
            let help = match self.arm.clone().nearest_free(q, &self.space, 2.0 * self.tolerance) {
                _ if !self.space.contains(q) => "move it, or widen the limits".to_owned(),
                Some(free) => format!("the nearest free configuration found is [{}]", written(&free)),
                None => "no free configuration was found nearby: is the base where it should be?".to_owned(),
            };
            let error = self.problem.file.fault(part, &fault, &help);
            return Err(error).wrap_err_with(|| format!("cannot plan in {}", self.name()));
        }
        Ok(())
    }

    fn fault(&self, name: &str, q: &State) -> Option<String> {
        for (coordinate, x) in self.arm.coordinates().iter().zip(q.iter()) {
            if let JointRange::Interval { low, high } = coordinate.range
                && !(low..=high).contains(x)
            {
                let limits = format!("{} may be from {} to {}", coordinate.name, brief(low), brief(high));
                return Some(format!("{name} is out of the limits: {x}, but {limits}"));
            }
        }
        let clearance = self.arm.clone().clearance(q, self.tolerance);
        if clearance >= self.tolerance {
            return None;
        }
        let touching = self.touching(q);
        Some(match touching.is_empty() {
            true => format!(
                "{name} is {} m from contact: at least {} m is needed",
                brief(clearance),
                brief(self.tolerance)
            ),
            false => format!("{name} is in collision: {}", touching.join(", ")),
        })
    }
}

/// `q` as a robot problem has it.
pub(crate) fn written(q: &State) -> String {
    q.iter().map(|v| ((v * 1e9).round() / 1e9 + 0.0).to_string()).collect::<Vec<_>>().join(", ")
}
