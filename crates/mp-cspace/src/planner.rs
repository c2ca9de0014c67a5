//! Outcomes and the planner trait.

use crate::{Event, Observer, Path, Progress, Rng, Stop, StopReason, trace};

/// How a solve ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome<P> {
    /// A verified solution.
    Solved(P),
    /// Stopped without one.
    Stopped(StopReason),
}

/// A planner that works one iteration at a time, so that it can be stopped, resumed and watched.
pub trait Planner<S> {
    /// What an edge of its paths stores.
    type Edge: Clone;
    /// One iteration. A returned path has passed the independent check.
    fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<S>) -> Option<Path<S, Self::Edge>>;
    /// What has been done so far.
    fn progress(&self) -> Progress;
    /// Whether the planner is anytime: steps after a solution return only better ones, so it is worth
    /// stepping until the budget is used up.
    fn improves(&self) -> bool {
        false
    }
    /// At most `k` verified paths that are far apart, the cheapest first: each is somewhere farther than
    /// `apart`, in the metric of the space, from all before it. To be called when a path was found; more
    /// steps give more of them. `None`, the default, where the planner lists no paths.
    fn routes(&mut self, _k: usize, _apart: f64) -> Option<Vec<Path<S, Self::Edge>>> {
        None
    }
    /// Runs until solved or stopped. Call again to continue with the same trees. An iteration that was
    /// [cut short](Stop::cut_short) ends the run, and its path does not count.
    fn solve(
        &mut self,
        rng: &mut Rng,
        stop: &mut dyn Stop,
        observer: &mut dyn Observer<S>,
    ) -> Outcome<Path<S, Self::Edge>> {
        loop {
            let progress = self.progress();
            let exhausted = || progress.exhausted.then_some(StopReason::Exhausted);
            if let Some(reason) = stop.check(&progress).or_else(exhausted) {
                trace::ended(&progress, Some(reason));
                return Outcome::Stopped(reason);
            }
            observer.on(Event::Iteration(progress));
            let path = self.step(rng, observer);
            if let Some(reason) = stop.cut_short() {
                trace::ended(&progress, Some(reason));
                return Outcome::Stopped(reason);
            }
            if let Some(path) = path {
                trace::ended(&self.progress(), None);
                observer.on(Event::Solved);
                return Outcome::Solved(path);
            }
        }
    }
}

impl<S, P: Planner<S> + ?Sized> Planner<S> for Box<P> {
    type Edge = P::Edge;
    fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<S>) -> Option<Path<S, P::Edge>> {
        (**self).step(rng, observer)
    }
    fn progress(&self) -> Progress {
        (**self).progress()
    }
    fn improves(&self) -> bool {
        (**self).improves()
    }
    fn routes(&mut self, k: usize, apart: f64) -> Option<Vec<Path<S, P::Edge>>> {
        (**self).routes(k, apart)
    }
}
