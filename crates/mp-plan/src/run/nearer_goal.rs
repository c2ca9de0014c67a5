//! A path to another goal, much nearer than the one that the search has reached.

use crate::run::search::search_within;
use crate::{Budget, Control, Finish, Request, Robot};
use mp_cspace::{Configuration, Outcome, Path, Space};
use std::time::Duration;

/// Goals are looked for that are nearer to the start than this part of the path is long.
const NEARER: f64 = 0.5;
/// What the search for one of them may cost: some ten milliseconds for an arm.
const QUERIES: u64 = 20_000;
/// And the part of the time left.
const PART: f64 = 0.1;

/// A path to a goal much nearer to the start, if the path is to be shortened and RRT-Connect finds one soon. Where there are many goals, such as
/// the configurations that reach a place, the first one that a search reaches may be a bad choice. Goals that are regions are left as they
/// are.
pub(crate) fn nearer_goal(
    kind: &dyn Robot,
    request: &Request,
    path: &Path<Configuration>,
    control: &Control<'_>,
    left: Option<Duration>,
) -> Option<Path<Configuration>> {
    if request.finish != Finish::Shorten || kind.goal_parts().is_some() || kind.goals().len() < 2 {
        return None;
    }
    let (space, start) = (kind.any_space(), kind.start());
    // The path may be the answer to a query between other ends.
    let is_own = path.states.first() == Some(start)
        && path.states.last().is_some_and(|end| kind.goals().contains(end));
    if !is_own {
        return None;
    }
    let near = NEARER * path.length(&space);
    let mut goals = kind.goals().to_vec();
    goals.retain(|goal| space.distance(start, goal) < near);
    if goals.is_empty() {
        return None;
    }
    let Ok(among) = kind.any_with_ends(start.clone(), goals, &kind.given_start()) else { return None };
    let time_s = left.map(|left| PART * left.as_secs_f64());
    let budget = Budget { queries: Some(QUERIES), time_s, ..Budget::default() };
    let (planner, seed, metric, motion) = ("rrt-connect", request.seed, request.metric, request.motion);
    let request =
        Request { budget, seed, metric, motion, clearance: request.clearance, ..Request::new(planner) };
    let mut control = Control { cancel: control.cancel.clone(), clock: control.clock, ..Control::default() };
    // Where the time is up the start seems not to be free.
    let Ok(found) = search_within(&*among, &request, &mut control, 1.0, true) else { return None };
    match found.outcome {
        Outcome::Solved(path) => Some(path),
        Outcome::Stopped(_) => None,
    }
}
