//! Many independent problems, on all cores.

use crate::in_order;
use mp_plan::{Cancel, Control, Error, Report, Request, Scene};
use std::ops::ControlFlow;

/// Plans many problems on `threads` threads, and gives their results in the order of the problems to `take`,
/// which runs in the calling thread and may [break](ControlFlow::Break) off. A problem that cannot be planned
/// is a value as well: its error. Results do not depend on the number of threads, except for their times.
/// Problems are drawn when there is a thread for them, so they can be made as they are needed: memory does
/// not grow with their number. Returns how many results were taken.
///
/// When `cancel` is raised, no further problem begins, and those that have begun end soon, with what they
/// found.
///
/// ```
/// use mp_batch::plan_many;
/// use mp_plan::{Cancel, Request, Scene};
/// use std::ops::ControlFlow;
/// let scene = Scene::find("easy")?;
/// let problems = (1..=20).map(|seed| (scene.clone(), Request::new("rrt-connect").seed(seed)));
/// let mut lengths = Vec::new();
/// plan_many(problems, 2, &Cancel::new(), |number, result| {
///     match result {
///         Ok(report) => lengths.push(report.path_length),
///         Err(e) => eprintln!("problem {number}: {e}"),
///     }
///     ControlFlow::Continue(())
/// });
/// assert_eq!(lengths.len(), 20);
/// # Ok::<(), mp_plan::Error>(())
/// ```
///
/// # Panics
/// When drawing a problem, planning or `take` panics.
pub fn plan_many(
    problems: impl IntoIterator<Item = (Scene, Request), IntoIter: Send>,
    threads: usize,
    cancel: &Cancel,
    take: impl FnMut(usize, Result<Report, Error>) -> ControlFlow<()>,
) -> usize {
    let plan = |_, (scene, request): (Scene, Request)| {
        scene.plan_with(&request, &mut Control { cancel: cancel.clone(), ..Control::default() })
    };
    in_order(problems, threads, cancel, plan, take)
}
