//! The problems of Jouandeau, Touati and Ali Cherif 2008, *Incremental motion planning with Las Vegas
//! algorithms*, §4, and single runs of a planner on them. A free-flyer or an arm of six joints moves among 2
//! to 512 boxes. Its states are positions, or positions and velocities; there are three metrics.

mod boxes;
mod robots;
mod run;
mod scene_text;

use crate::Result;
pub use boxes::{LEVELS, Obstacle};
use robots::{Flyer, SixAxes, TestRobot};
pub use run::{ComparedPlanner, Run, RunSettings};

/// The robots, by name: see [`Mover::find`].
pub const MOVERS: [&str; 2] = ["free-flyer", "6-DOF arm"];
/// What a state holds: positions alone, or positions and velocities.
pub const MODELS: [&str; 2] = ["positions", "velocities"];
/// The metrics, by their names in tables.
pub const METRICS: [&str; 3] = ["euclidean", "scaled", "manhattan"];

/// A robot of the experiment, with its start, its goal and its worlds.
#[derive(Clone, Debug)]
pub struct Mover(Robot);

#[derive(Clone, Debug)]
enum Robot {
    Flyer(Box<Flyer>),
    Arm(Box<SixAxes>),
}

impl Mover {
    /// One of [`MOVERS`].
    ///
    /// # Errors
    /// When there is no such robot.
    pub fn find(name: &str) -> Result<Self> {
        Ok(Self(match MOVERS.iter().position(|mover| *mover == name) {
            Some(0) => Robot::Flyer(Box::new(Flyer::new()?)),
            Some(_) => Robot::Arm(Box::new(SixAxes::new()?)),
            None => return Err(format!("there is no robot `{name}` here: {}", MOVERS.join(", ")).into()),
        }))
    }

    /// `count` boxes of an instance, none of them at the start or the goal. The first n are those of its
    /// problem with n.
    ///
    /// # Errors
    /// When a box cannot be made, of which no case is known.
    pub fn obstacles(&self, count: usize, instance: u64) -> Result<Vec<Obstacle>> {
        match &self.0 {
            Robot::Flyer(flyer) => flyer.obstacles(count, instance),
            Robot::Arm(arm) => arm.obstacles(count, instance),
        }
    }

    /// Whether a box keeps some clearance from the start and the goal.
    ///
    /// # Errors
    /// When the box is not valid.
    pub fn spares(&self, obstacle: &Obstacle) -> Result<bool> {
        match &self.0 {
            Robot::Flyer(flyer) => flyer.spares(obstacle),
            Robot::Arm(arm) => arm.spares(obstacle),
        }
    }

    /// Whether each of these configurations, rows of six numbers as in path files, is free among obstacles.
    ///
    /// # Errors
    /// When an obstacle is not valid.
    pub fn are_free(&self, obstacles: &[Obstacle], rows: &[[f64; 6]]) -> Result<Vec<bool>> {
        match &self.0 {
            Robot::Flyer(flyer) => flyer.are_free(obstacles, rows),
            Robot::Arm(arm) => arm.are_free(obstacles, rows),
        }
    }

    /// The problem with `count` boxes of an instance as the text of a scene file
    /// (`docs/formats/rigid-problem.md`, `robot-problem.md`). It differs from what is planned for here in two
    /// things: its goal is a configuration, the middle of the goal region, and its boxes are solid, so that
    /// nothing may be wholly inside of one. The scene of the arm names the file of [`urdf`](Self::urdf).
    ///
    /// # Errors
    /// As [`obstacles`](Self::obstacles).
    pub fn scene_text(&self, count: usize, instance: u64) -> Result<String> {
        let (who, figure, tables) = match &self.0 {
            Robot::Flyer(flyer) => ("A bar that flies", 6, flyer.tables()),
            Robot::Arm(arm) => ("An arm of six joints", 7, arm.tables()),
        };
        let boxes = scene_text::obstacles(&self.obstacles(count, instance)?);
        Ok(format!(
            "# {who} among {count} boxes, instance {instance}: Figure {figure} of Jouandeau, Touati and Ali Cherif 2008, as rebuilt here.\n\n{tables}{boxes}"
        ))
    }

    /// The file of the robot that its scenes name, seen from the folder above theirs, and its text; the
    /// free-flyer has none.
    #[must_use]
    pub fn urdf(&self) -> Option<(&'static str, String)> {
        match &self.0 {
            Robot::Flyer(_) => None,
            Robot::Arm(arm) => Some((robots::ARM_FILE, arm.urdf())),
        }
    }

    /// Plans among obstacles, with states of one of [`MODELS`], under one of [`METRICS`]. `None` when it was
    /// cancelled.
    ///
    /// # Errors
    /// When there is no such model or metric, and when trees that grow by accelerations are to meet.
    pub fn plan(
        &self,
        obstacles: &[Obstacle],
        model: &str,
        metric: &str,
        settings: &RunSettings,
    ) -> Result<Option<Run>> {
        match &self.0 {
            Robot::Flyer(flyer) => run::among(&**flyer, obstacles, model, metric, settings),
            Robot::Arm(arm) => run::among(&**arm, obstacles, model, metric, settings),
        }
    }
}
