//! Scenes of rigid bodies by name, and plain runs of planners on them.

use crate::clock::processor_clock;
use crate::error::Result;
use crate::output::note;
use mp_cspace::{Cancel, Configuration, Outcome, Rng, Space, StopReason, Validity};
use mp_io::{RigidProblem, SpaceKind};
use mp_plan::{
    Budget, Control, Finish, Length, Request, RigidScene, RigidSpace, Robot, Scene, Search, TypedMotion,
    search,
};
use mp_robot::{Planar, Spatial};
use serde::{Deserialize, Serialize};

/// The problem of a shipped scene, or of a file.
pub(crate) fn problem(name: &str) -> Result<RigidProblem> {
    mp_plan::find_problem(name)
}

/// A scene of a rigid body, in space or in the plane.
#[derive(Clone, Debug)]
pub(crate) enum Rigid {
    Space(Box<RigidScene<Spatial>>),
    Plane(Box<RigidScene<Planar>>),
}

/// Evaluates an expression with a scene of either kind.
macro_rules! either {
    ($rigid:expr, $scene:ident => $body:expr) => {
        match $rigid {
            $crate::scenes::Rigid::Space($scene) => $body,
            $crate::scenes::Rigid::Plane($scene) => $body,
        }
    };
}
pub(crate) use either;

/// The result of a plain run of a planner.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Planned {
    pub(crate) solved: bool,
    /// Wall-clock time.
    pub(crate) seconds: f64,
    /// Collision and clearance queries.
    pub(crate) queries: u64,
    pub(crate) iterations: u64,
}

/// A request for the first path of a planner with its defaults, not shortened, without a time limit.
pub(crate) fn bare(planner: &str) -> Request {
    Request {
        first_only: true,
        finish: Finish::AsFound,
        budget: Budget { time_s: None, ..Budget::default() },
        ..Request::new(planner)
    }
}

impl Rigid {
    /// The scene called `name`. Start and goal must be free.
    pub(crate) fn load(name: &str) -> Result<Self> {
        let rigid = Self::new(problem(name)?)?;
        for odd in either!(&rigid, scene => Scene::new((**scene).clone())).check_ends()? {
            note(&format!("warning: {name}: {odd}"));
        }
        Ok(rigid)
    }

    /// The scene of `problem`.
    pub(crate) fn new(problem: RigidProblem) -> Result<Self> {
        Ok(match problem.space {
            SpaceKind::Se3 => Self::Space(Box::new(RigidScene::new(problem)?)),
            SpaceKind::Se2 => Self::Plane(Box::new(RigidScene::new(problem)?)),
        })
    }

    pub(crate) fn problem(&self) -> &RigidProblem {
        either!(self, scene => scene.problem())
    }

    /// The largest distance in the space, in its own metric.
    pub(crate) fn extent(&self) -> f64 {
        either!(self, scene => scene.space().extent())
    }

    /// A length in the metric of the space.
    pub(crate) fn length(&self, length: Length) -> f64 {
        match length {
            Length::Absolute(length) => length,
            Length::Fraction(part) => part * self.extent(),
        }
    }

    pub(crate) fn robot(&self) -> &dyn Robot {
        either!(self, scene => &**scene)
    }

    /// A plain run; `None` when it was interrupted.
    pub(crate) fn plan(&self, request: &Request, cancel: &Cancel) -> Result<Option<Planned>> {
        let found =
            searched(self.robot(), request, Control { cancel: cancel.clone(), ..Control::default() })?;
        Ok(found.map(|found| Planned {
            solved: matches!(found.outcome, Outcome::Solved(_)),
            seconds: found.time.as_secs_f64(),
            queries: found.queries,
            iterations: found.progress.iterations,
        }))
    }

    /// A search, timed by the processor, and whether it was solved within `queries` collision and distance
    /// queries; `None` when it was interrupted.
    pub(crate) fn search(
        &self,
        request: Request,
        queries: u64,
        cancel: &Cancel,
    ) -> Result<Option<(Search, bool)>> {
        let budget = Budget { queries: Some(queries), ..request.budget };
        let (cancel, clock) = (cancel.clone(), processor_clock());
        let control = Control { cancel, clock, keep_roadmap: true, ..Control::default() };
        let found = searched(self.robot(), &Request { budget, ..request }, control)?;
        Ok(found.map(|found| {
            let solved = matches!(found.outcome, Outcome::Solved(_)) && found.queries <= queries;
            (found, solved)
        }))
    }
}

fn searched(robot: &dyn Robot, request: &Request, mut control: Control<'_>) -> Result<Option<Search>> {
    let found = search(robot, request, &mut control)?;
    let interrupted = matches!(found.outcome, Outcome::Stopped(StopReason::Cancelled));
    Ok((!interrupted).then_some(found))
}

/// Free configurations, uniform in the space.
pub(crate) fn free<M: RigidSpace>(
    scene: &RigidScene<M>,
    mut rng: Rng,
) -> impl Iterator<Item = Configuration> {
    let mut robot = scene.checker().clone();
    let samples = std::iter::repeat_with(move || scene.space().sample_uniform(&mut rng));
    samples.filter(move |q| robot.is_valid(q))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_found_by_name_and_planned_in() {
        let scene = Rigid::load("maze").unwrap();
        assert!(matches!(scene, Rigid::Plane(_)) && scene.extent() > 10.0);
        let request = bare("rrt-connect").iterations(20_000);
        let planned = scene.plan(&request, &Cancel::new()).unwrap().unwrap();
        assert!(planned.solved && planned.queries > 0);
        let again = scene.plan(&request, &Cancel::new()).unwrap().unwrap();
        assert_eq!((planned.queries, planned.iterations), (again.queries, again.iterations));
        let cancel = Cancel::new();
        cancel.cancel();
        assert_eq!(scene.plan(&request, &cancel).unwrap(), None);
        assert!(Rigid::load("cubicels").unwrap_err().remedy().unwrap().contains("cubicles"));
    }
}
