//! Scenes from problems in memory.

use crate::{Error, Scene};
use mp_cspace::Interrupt;
use mp_io::{PlanarProblem, RigidProblem, RigidTask};
use mp_kinds::build;

impl Scene {
    /// A scene of a rigid body among meshes.
    ///
    /// # Errors
    /// When the bounds of the position are empty, or a mesh or pose is not valid.
    pub fn from_problem(problem: RigidProblem) -> Result<Self, Error> {
        Self::from_problem_until(problem, &Interrupt::never())
    }

    /// As [`from_problem`](Self::from_problem), unless `interrupt` says to end.
    ///
    /// # Errors
    /// As [`from_problem`](Self::from_problem), and when it was interrupted.
    pub fn from_problem_until(problem: RigidProblem, interrupt: &Interrupt) -> Result<Self, Error> {
        Self::of_problem_until(None, problem, interrupt)
    }

    /// The scene of `problem`, which is an edited problem of the scene `before`: what did not change is shared with it.
    pub(crate) fn of_problem_until(
        before: Option<&Self>,
        problem: RigidProblem,
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        let _span = tracing::info_span!("build", scene = %problem.name).entered();
        Ok(Self::built(build::rigid_body(before.map(|scene| &*scene.robot), problem, interrupt)?))
    }

    /// A scene of a rigid body among meshes of which some move, or with goals that leave something free, or moved by inputs.
    ///
    /// # Errors
    /// When the bounds of the position are empty, a mesh, a pose or a time is not valid, or a mesh in the plane is to move by inputs.
    pub fn from_task(task: RigidTask) -> Result<Self, Error> {
        Self::from_task_until(task, &Interrupt::never())
    }

    /// As [`from_task`](Self::from_task), unless `interrupt` says to end.
    ///
    /// # Errors
    /// As [`from_task`](Self::from_task), and when it was interrupted.
    pub fn from_task_until(task: RigidTask, interrupt: &Interrupt) -> Result<Self, Error> {
        let _span = tracing::info_span!("build", scene = %task.problem.name).entered();
        Ok(Self::built(build::rigid_task(task, interrupt)?))
    }

    /// A scene of a robot in the plane among polygons.
    ///
    /// # Errors
    /// When world, robot or bounds are not valid.
    pub fn from_world(problem: PlanarProblem) -> Result<Self, Error> {
        Self::from_world_until(problem, &Interrupt::never())
    }

    /// As [`from_world`](Self::from_world), unless `interrupt` says to end.
    ///
    /// # Errors
    /// As [`from_world`](Self::from_world), and when it was interrupted.
    pub fn from_world_until(problem: PlanarProblem, interrupt: &Interrupt) -> Result<Self, Error> {
        let _span = tracing::info_span!("build", scene = %problem.name).entered();
        Ok(Self::built(build::planar_world(problem, interrupt)?))
    }
}
