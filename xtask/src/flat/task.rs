//! A world in the plane made ready.

use super::FlatMover;
use crate::info::brief;
use miette::{IntoDiagnostic, Result, WrapErr, miette};
use mp::cspace::Space;
use mp::geom::flat::FlatWorld;
use mp::io::{FlatBody, FlatPart, FlatProblem, JointPath};
use mp::robot::{DiscRobot, PolygonRobot};
use nalgebra::{Point2, Vector2};
use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

/// A problem and everything made of it once, for all runs.
#[derive(Clone, Debug)]
pub(crate) struct Task<M: FlatMover> {
    pub(crate) problem: FlatProblem,
    pub(crate) robot: M,
    pub(crate) space: M::Space,
    pub(crate) start: M::State,
    pub(crate) goals: Vec<M::State>,
    /// Clearance that the certified check resolves, metres.
    pub(crate) tolerance: f64,
}

/// A task of either robot.
#[derive(Clone, Debug)]
pub(crate) enum AnyTask {
    Disc(Box<Task<DiscRobot>>),
    Polygon(Box<Task<PolygonRobot>>),
}

/// Evaluates `$do` with `$task` bound to the task of either robot.
macro_rules! either {
    ($any:expr, $task:ident => $do:expr) => {
        match $any {
            $crate::flat::AnyTask::Disc($task) => $do,
            $crate::flat::AnyTask::Polygon($task) => $do,
        }
    };
}
pub(crate) use either;

impl AnyTask {
    /// Reads the world `file` and makes it ready.
    pub(crate) fn load(file: &Path) -> Result<Self> {
        let problem = FlatProblem::load(file)?;
        Ok(match problem.file.robot {
            FlatBody::Disc(_) => Self::Disc(Box::new(Task::new(problem)?)),
            FlatBody::Polygon(_) => Self::Polygon(Box::new(Task::new(problem)?)),
        })
    }

    pub(crate) fn name(&self) -> &str {
        either!(self, task => &task.problem.name)
    }

    /// An error when start or a goal is not free.
    pub(crate) fn check_ends(&self) -> Result<()> {
        either!(self, task => task.check_ends())
    }
}

impl<M: FlatMover> Task<M> {
    pub(crate) fn new(problem: FlatProblem) -> Result<Self> {
        let polygons = problem.obstacles.iter().map(|o| o.polygon.clone()).collect();
        let world = Arc::new(FlatWorld::new(polygons, problem.file.walls).into_diagnostic()?);
        let robot = M::new(world, &problem.file.robot)?;
        let space = M::space(problem.bounds)?;
        let start = M::state(&problem.file.start);
        let goals = problem.file.goals.iter().map(|row| M::state(row)).collect();
        let tolerance = robot.tolerance();
        Ok(Self { problem, robot, space, start, goals, tolerance })
    }

    /// The configurations of a path that is one of this robot.
    pub(crate) fn path(&self, file: &JointPath) -> Result<Vec<M::State>> {
        let (found, numbers) = (file.configurations.first().map_or(0, Vec::len), self.space.dim());
        if found == numbers {
            return Ok(file.configurations.iter().map(|row| M::state(row)).collect());
        }
        Err(miette!(
            help = "is this a path of another robot?",
            "the configurations of the path have {found} numbers, those of {} have {numbers}",
            self.problem.name
        ))
    }

    /// The obstacles that the robot touches at `q`.
    pub(crate) fn touching(&self, q: &M::State) -> Vec<String> {
        let rings = self.robot.rings(q);
        let world = self.robot.world();
        let mut names: Vec<String> = Vec::new();
        let mut note = |obstacle: Option<usize>| {
            let name = match obstacle {
                Some(i) => self.problem.obstacles.get(i).map_or("?", |o| o.name.as_str()),
                None => "the walls",
            };
            if !names.iter().any(|n| n == name) {
                names.push(name.to_owned());
            }
        };
        for ring in &rings {
            for (a, b) in ring.iter().zip(ring.iter().skip(1).chain(ring.first())) {
                if let Some(near) = world.nearest_to_segment(a, b, self.tolerance) {
                    note(near.obstacle);
                }
            }
        }
        let inside = |p: &Point2<f64>| self.problem.obstacles.iter().position(|o| o.polygon.contains(p));
        for obstacle in rings.iter().flatten().filter_map(inside) {
            note(Some(obstacle));
        }
        names
    }

    /// What is wrong with start and goals.
    pub(crate) fn overlaps(&self) -> Vec<String> {
        self.ends().filter_map(|(name, _, q)| self.fault(&name, q)).collect()
    }

    fn ends(&self) -> impl Iterator<Item = (String, FlatPart, &M::State)> {
        let many = self.goals.len() > 1;
        let goals = self.goals.iter().enumerate().map(move |(i, q)| {
            let name = if many { format!("goal {}", i + 1) } else { "the goal".to_owned() };
            (name, FlatPart::Goal(i), q)
        });
        std::iter::once(("the start".to_owned(), FlatPart::Start, &self.start)).chain(goals)
    }

    pub(crate) fn check_ends(&self) -> Result<()> {
        for (name, part, q) in self.ends() {
            let Some(fault) = self.fault(&name, q) else { continue };
            let help = match self.nearest_free(q) {
                _ if !self.space.contains(q) => "move it, or widen the bounds".to_owned(),
                Some(free) => format!("a free place nearby is [{}]", written::<M>(&free)),
                None => "no free place was found nearby: is the world in metres?".to_owned(),
            };
            let error = self.problem.file.fault(part, &fault, &help);
            return Err(error).wrap_err_with(|| format!("cannot plan in {}", self.problem.name));
        }
        Ok(())
    }

    fn fault(&self, name: &str, q: &M::State) -> Option<String> {
        if !self.space.contains(q) {
            return Some(format!("{name} is out of bounds: {}", written::<M>(q)));
        }
        let clearance = self.robot.clone().clearance(q, self.tolerance);
        if clearance >= self.tolerance {
            return None;
        }
        let touching = self.touching(q);
        Some(match touching.is_empty() || clearance > 0.0 {
            true => format!(
                "{name} is {} m from contact: at least {} m is needed",
                brief(clearance),
                self.tolerance
            ),
            false => format!("{name} is in collision with {}", touching.join(", ")),
        })
    }

    /// A free place near `q`, with the same turn: the nearest on circles about it.
    fn nearest_free(&self, q: &M::State) -> Option<M::State> {
        let mut robot = self.robot.clone();
        let mut reach = 0.01 * self.robot.radius().max(1e-3 * self.space.extent());
        while reach < self.space.extent() {
            let around = (0..64).map(|i| {
                let (s, c) = (TAU * f64::from(i) / 64.0).sin_cos();
                M::moved(q, Vector2::new(c, s) * reach)
            });
            let mut free = around.filter(|p| {
                self.space.contains(p) && robot.clearance(p, f64::INFINITY) > 2.0 * self.tolerance
            });
            if let Some(found) = free.next() {
                return Some(found);
            }
            reach *= 1.2;
        }
        None
    }
}

/// `q` as a file has it.
pub(crate) fn written<M: FlatMover>(q: &M::State) -> String {
    M::row(q).iter().map(|v| ((v * 1e9).round() / 1e9 + 0.0).to_string()).collect::<Vec<_>>().join(", ")
}
