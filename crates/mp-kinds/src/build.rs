//! Robots from problems. Each is built behind a pointer here, where its checks are compiled.

use crate::{
    ArmScene, DrivenScene, Error, FloatingScene, PlanarBody, PlanarScene, RigidScene, RigidSpace, Robot,
    TypedMotion, greatest_speed,
};
use mp_cspace::Interrupt;
use mp_io::{
    Files, GoalEntry, PlanarProblem, PlanarShape, RigidProblem, RigidTask, RobotProblem, SpaceKind,
    StartEntry,
};
use mp_robot::{DiscRobot, Planar, PolygonRobot, Spatial};
use std::any::Any;
use std::sync::Arc;

/// A robot among its obstacles, and what is to be known of how it was built.
#[derive(Clone, Debug)]
pub struct Built {
    /// The robot among its obstacles, with start and goals.
    pub robot: Arc<dyn Robot>,
    /// The name of its kind: `space`, `plane`, `discs`, `moving`, `driven`, `driven-moving`, `arms`, `floating`.
    pub kind: &'static str,
    /// What was chosen, in sentences.
    pub notes: Vec<String>,
}

impl Built {
    fn new(robot: impl Robot + 'static, kind: &'static str) -> Self {
        Self { robot: Arc::new(robot), kind, notes: Vec::new() }
    }
}

/// The robot as the type `K`; `None` if it is of another type.
pub fn of_kind<K: 'static>(robot: &dyn Robot) -> Option<&K> {
    (robot as &dyn Any).downcast_ref()
}

/// An arm behind a pointer.
#[must_use]
pub fn shared_arm(arm: ArmScene) -> Arc<dyn Robot> {
    Arc::new(arm)
}

/// A rigid body among meshes. What did not change is shared with the robot `before`.
///
/// # Errors
/// When the bounds of the position are empty, a mesh or pose is not valid, or it was interrupted.
pub fn rigid_body(
    before: Option<&dyn Robot>,
    problem: RigidProblem,
    interrupt: &Interrupt,
) -> Result<Built, Error> {
    match problem.space {
        SpaceKind::Se3 => Ok(space(RigidScene::after_until(before.and_then(of_kind), problem, interrupt)?)),
        SpaceKind::Se2 => {
            let before = before.and_then(of_kind);
            Ok(plane(RigidScene::<Planar>::after_until(before, problem, interrupt)?))
        }
    }
}

/// A rigid body among meshes of which some move, or with goals that leave something free, or moved by inputs.
///
/// # Errors
/// When the bounds of the position are empty, a mesh, a pose or a time is not valid, a mesh in the plane is to move by inputs, or it was
/// interrupted.
pub fn rigid_task(task: RigidTask, interrupt: &Interrupt) -> Result<Built, Error> {
    match (task.problem.space, &task.driven) {
        (SpaceKind::Se3, Some(_)) => driven_body(task, interrupt),
        (SpaceKind::Se3, None) => body(task, space, interrupt),
        (SpaceKind::Se2, None) => body::<Planar>(task, plane, interrupt),
        (SpaceKind::Se2, Some(_)) => Err(Error::new("a mesh in the plane cannot move by inputs")
            .help("take a polygon in a world of the plane: docs/formats/planar-world.md")),
    }
}

/// A robot in the plane among polygons.
///
/// # Errors
/// When world, robot or bounds are not valid, or it was interrupted.
pub fn planar_world(problem: PlanarProblem, interrupt: &Interrupt) -> Result<Built, Error> {
    match problem.file.robot {
        PlanarShape::Disc(_) => world(problem, disc, interrupt),
        PlanarShape::Polygon(_) => world::<PolygonRobot>(problem, plane, interrupt),
    }
}

/// An arm, whose base stands still or floats. What did not change is shared with the robot `before`.
///
/// # Errors
/// When a file cannot be read, or the problem is not valid.
pub fn arm(files: &dyn Files, problem: RobotProblem, before: Option<&dyn Robot>) -> Result<Built, Error> {
    if problem.file.robots.iter().any(|robot| robot.floating.is_some()) {
        let scene = FloatingScene::from_problem_after(files, problem, before.and_then(of_kind))?;
        let notes = scene.said();
        return Ok(Built { notes, ..Built::new(scene, "floating") });
    }
    let chosen = |goal: &GoalEntry| matches!(goal, GoalEntry::All(values) if values.is_empty());
    let open = matches!(&problem.file.start, StartEntry::All(values) if values.is_empty());
    if problem.file.robots.iter().all(|robot| robot.driven.is_none())
        && (open || problem.file.goals.iter().any(chosen))
    {
        return arm_with_chosen_ends(files, problem);
    }
    let scene = ArmScene::from_problem_after(files, problem, before.and_then(of_kind))?;
    let notes = scene.said();
    let built = match scene.driven()? {
        Some(driven) => Built::new(driven, "driven"),
        None => Built::new(scene, "arms"),
    };
    Ok(Built { notes, ..built })
}

/// An arm whose problem leaves its start, its goals or both open.
///
/// # Errors
/// As [`arm`], and when no free configuration is found.
pub fn arm_with_chosen_ends(files: &dyn Files, problem: RobotProblem) -> Result<Built, Error> {
    let (scene, notes) = ArmScene::with_chosen_ends(files, problem)?;
    Ok(Built { notes, ..Built::new(scene, "arms") })
}

fn space(scene: RigidScene<Spatial>) -> Built {
    Built::new(scene, "space")
}

fn plane<K: Robot + 'static>(scene: K) -> Built {
    Built::new(scene, "plane")
}

fn disc(scene: PlanarScene<DiscRobot>) -> Built {
    Built::new(scene, "discs")
}

/// A rigid body that can make any motion; `still` builds it where no obstacle moves.
fn body<M: RigidSpace>(
    task: RigidTask,
    still: fn(RigidScene<M>) -> Built,
    interrupt: &Interrupt,
) -> Result<Built, Error> {
    let scene = RigidScene::<M>::after_until(None, task.problem, interrupt)?.with_goals(task.goals);
    match &task.timing {
        Some(timing) => Ok(Built::new(scene.among_moving_until(&task.moving, timing, interrupt)?, "moving")),
        None => Ok(still(scene)),
    }
}

/// A robot of the plane; `still` builds it where no obstacle moves and the robot can make any motion.
fn world<B: PlanarBody>(
    problem: PlanarProblem,
    still: fn(PlanarScene<B>) -> Built,
    interrupt: &Interrupt,
) -> Result<Built, Error> {
    let (moves, driven) = (!problem.file.moving.is_empty(), problem.file.driven.clone());
    let scene = PlanarScene::<B>::new_until(problem, interrupt)?;
    Ok(match driven {
        Some(driven) if moves => Built::new(scene.driven_among_moving(&driven)?, "driven-moving"),
        Some(driven) => Built::new(scene.driven(&driven)?, "driven"),
        None if moves => Built::new(scene.among_moving()?, "moving"),
        None => still(scene),
    })
}

/// A rigid body in space that moves by inputs.
fn driven_body(mut task: RigidTask, interrupt: &Interrupt) -> Result<Built, Error> {
    let Some(driven) = task.driven.take() else {
        return Err(Error::new("the robot does not move by inputs"));
    };
    let places = task.goals.iter().map(|goal| goal.iter().copied().take(6).collect()).collect();
    let scene = RigidScene::<Spatial>::after_until(None, task.problem, interrupt)?.with_goals(places);
    let Some(timing) = &mut task.timing else {
        return Ok(Built::new(DrivenScene::new(scene, &driven, &task.velocity, task.goals)?, "driven"));
    };
    timing.speed = Some(greatest_speed(TypedMotion::space(&scene), &driven));
    let scene = scene.among_moving_until(&task.moving, timing, interrupt)?;
    Ok(Built::new(scene.driven(&driven, &task.velocity, task.goals)?, "driven-moving"))
}
