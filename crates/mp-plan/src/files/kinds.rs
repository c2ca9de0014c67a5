//! Scenes of the kinds of robots that this crate has.

use crate::robot::{DrivenScene, PlanarBody, PlanarScene, RigidScene, RigidSpace, greatest_speed};
use crate::{Error, Robot, Scene, TypedMotion};
use mp_cspace::Interrupt;
use mp_io::{PlanarProblem, PlanarShape, RigidProblem, RigidTask, SpaceKind};
use mp_robot::{DiscRobot, Planar, PolygonRobot, Spatial};

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
        match problem.space {
            SpaceKind::Se3 => {
                space(RigidScene::after_until(before.and_then(Self::robot), problem, interrupt)?)
            }
            SpaceKind::Se2 => {
                let before = before.and_then(Self::robot);
                plane(RigidScene::<Planar>::after_until(before, problem, interrupt)?)
            }
        }
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
        match (task.problem.space, &task.driven) {
            (SpaceKind::Se3, Some(_)) => driven_body(task, interrupt),
            (SpaceKind::Se3, None) => body(task, space, interrupt),
            (SpaceKind::Se2, None) => body::<Planar>(task, plane, interrupt),
            (SpaceKind::Se2, Some(_)) => Err(Error::new("a mesh in the plane cannot move by inputs")
                .help("take a polygon in a world of the plane: docs/formats/planar-world.md")),
        }
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
        match problem.file.robot {
            PlanarShape::Disc(_) => world(problem, disc, interrupt),
            PlanarShape::Polygon(_) => world::<PolygonRobot>(problem, plane, interrupt),
        }
    }
}

fn space(scene: RigidScene<Spatial>) -> Result<Scene, Error> {
    Ok(Scene::new(scene).of_kind("space"))
}

fn plane<K: Robot + 'static>(scene: K) -> Result<Scene, Error> {
    Ok(Scene::new(scene).of_kind("plane"))
}

fn disc(scene: PlanarScene<DiscRobot>) -> Result<Scene, Error> {
    Ok(Scene::new(scene).of_kind("discs"))
}

/// The scene of a rigid body that can make any motion; `still` makes it where no obstacle moves.
fn body<M: RigidSpace>(
    task: RigidTask,
    still: fn(RigidScene<M>) -> Result<Scene, Error>,
    interrupt: &Interrupt,
) -> Result<Scene, Error> {
    let scene = RigidScene::<M>::after_until(None, task.problem, interrupt)?.with_goals(task.goals);
    match &task.timing {
        Some(timing) => {
            Ok(Scene::new(scene.among_moving_until(&task.moving, timing, interrupt)?).of_kind("moving"))
        }
        None => still(scene),
    }
}

/// The scene of a robot of the plane; `still` makes it where no obstacle moves and the robot can make any motion.
fn world<B: PlanarBody>(
    problem: PlanarProblem,
    still: fn(PlanarScene<B>) -> Result<Scene, Error>,
    interrupt: &Interrupt,
) -> Result<Scene, Error> {
    let (moves, driven) = (!problem.file.moving.is_empty(), problem.file.driven.clone());
    let scene = PlanarScene::<B>::new_until(problem, interrupt)?;
    Ok(match driven {
        Some(driven) if moves => Scene::new(scene.driven_among_moving(&driven)?).of_kind("driven-moving"),
        Some(driven) => Scene::new(scene.driven(&driven)?).of_kind("driven"),
        None if moves => Scene::new(scene.among_moving()?).of_kind("moving"),
        None => still(scene)?,
    })
}

/// The scene of a rigid body in space that moves by inputs.
fn driven_body(mut task: RigidTask, interrupt: &Interrupt) -> Result<Scene, Error> {
    let Some(driven) = task.driven.take() else {
        return Err(Error::new("the robot does not move by inputs"));
    };
    let places = task.goals.iter().map(|goal| goal.iter().copied().take(6).collect()).collect();
    let scene = RigidScene::<Spatial>::after_until(None, task.problem, interrupt)?.with_goals(places);
    let Some(timing) = &mut task.timing else {
        let scene = DrivenScene::new(scene, &driven, &task.velocity, task.goals)?;
        return Ok(Scene::new(scene).of_kind("driven"));
    };
    timing.speed = Some(greatest_speed(TypedMotion::space(&scene), &driven));
    let scene = scene.among_moving_until(&task.moving, timing, interrupt)?;
    Ok(Scene::new(scene.driven(&driven, &task.velocity, task.goals)?).of_kind("driven-moving"))
}
