//! Scenes of all kinds.

use super::setting::Ready;
use crate::arm::Task;
use crate::flat::AnyTask;
use miette::{Result, miette};
use mp::io::{FlatProblem, RobotProblem};
use std::path::{Path, PathBuf};

/// A scene made ready to plan on.
#[derive(Clone, Debug)]
pub(crate) enum Scene {
    Rigid(Ready),
    Arm(Box<Task>),
    Flat(AnyTask),
}

impl Scene {
    /// Reads the scene `file` and makes it ready.
    pub(crate) fn load(file: &Path) -> Result<Self> {
        Ok(match RobotProblem::is_named(file) {
            true if FlatProblem::is_one(file) => Self::Flat(AnyTask::load(file)?),
            true => Self::Arm(Box::new(Task::load(file)?)),
            false => Self::Rigid(Ready::load(file)?),
        })
    }

    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Rigid(ready) => ready.name(),
            Self::Arm(task) => task.name(),
            Self::Flat(task) => task.name(),
        }
    }

    /// An error when start or goal is not free.
    pub(crate) fn check_ends(&self) -> Result<()> {
        match self {
            Self::Rigid(ready) => ready.check_ends(),
            Self::Arm(task) => task.check_ends(),
            Self::Flat(task) => task.check_ends(),
        }
    }

    /// Writes the problem to `folder` for other planners; returns its file.
    pub(crate) fn export(&self, folder: &Path) -> Result<PathBuf> {
        match self {
            Self::Rigid(ready) => ready.export(folder),
            Self::Arm(task) => Err(miette!(
                help = "leave --export out: its URDF and obstacles are files already",
                "{} is an arm: only rigid bodies are exported",
                task.name()
            )),
            Self::Flat(task) => Err(miette!(
                help = "leave --export out: its file is text already",
                "{} is a world in the plane: only rigid bodies in space are exported",
                task.name()
            )),
        }
    }
}
