//! Stops: when a planner ends without a solution.

use mp_stop::{Cancel, Clock, Interrupt, SparseClock, StopReason};
use std::time::{Duration, Instant};

/// What a planner has done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Progress {
    /// Iterations of the planner's loop.
    pub iterations: u64,
    /// Nodes of its trees or roadmap.
    pub nodes: usize,
    /// Motions checked by the local planner.
    pub motions: u64,
    /// Candidate paths that failed independent verification.
    pub rejected: u64,
    /// No node is left to grow from: more iterations change nothing.
    pub exhausted: bool,
}

impl Progress {
    /// Progress with the given counts, nothing rejected.
    #[must_use]
    pub fn new(iterations: u64, nodes: usize, motions: u64) -> Self {
        Self { iterations, nodes, motions, rejected: 0, exhausted: false }
    }
}

/// When to stop. Combine with [`Stop::or`].
pub trait Stop {
    /// `Some(reason)` to stop now. Called once per iteration, before it.
    fn check(&mut self, progress: &Progress) -> Option<StopReason>;
    /// `Some(reason)` when the last iteration was interrupted: then the iteration counts for nothing, and
    /// neither does a path that it returned. Called after each iteration. `None`, the default, for stops that
    /// act between iterations only.
    fn cut_short(&self) -> Option<StopReason> {
        None
    }
    /// Stops when either does; `self` is checked first.
    fn or<B: Stop>(self, other: B) -> Or<Self, B>
    where
        Self: Sized,
    {
        Or(self, other)
    }
}

impl<S: Stop + ?Sized> Stop for &mut S {
    fn check(&mut self, progress: &Progress) -> Option<StopReason> {
        (**self).check(progress)
    }
    fn cut_short(&self) -> Option<StopReason> {
        (**self).cut_short()
    }
}
impl<S: Stop + ?Sized> Stop for Box<S> {
    fn check(&mut self, progress: &Progress) -> Option<StopReason> {
        (**self).check(progress)
    }
    fn cut_short(&self) -> Option<StopReason> {
        (**self).cut_short()
    }
}
/// `None` never stops.
impl<S: Stop> Stop for Option<S> {
    fn check(&mut self, progress: &Progress) -> Option<StopReason> {
        self.as_mut().and_then(|stop| stop.check(progress))
    }
    fn cut_short(&self) -> Option<StopReason> {
        self.as_ref().and_then(Stop::cut_short)
    }
}

/// Either of two stops.
#[derive(Clone, Copy, Debug)]
pub struct Or<A, B>(pub A, pub B);

impl<A: Stop, B: Stop> Stop for Or<A, B> {
    fn check(&mut self, progress: &Progress) -> Option<StopReason> {
        self.0.check(progress).or_else(|| self.1.check(progress))
    }
    fn cut_short(&self) -> Option<StopReason> {
        self.0.cut_short().or_else(|| self.1.cut_short())
    }
}

/// Stops after this many iterations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Iterations(pub u64);

impl Stop for Iterations {
    fn check(&mut self, progress: &Progress) -> Option<StopReason> {
        (progress.iterations >= self.0).then_some(StopReason::Iterations)
    }
}

/// Stops when the planner has at least this many nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Nodes(pub usize);

impl Stop for Nodes {
    fn check(&mut self, progress: &Progress) -> Option<StopReason> {
        (progress.nodes >= self.0).then_some(StopReason::Nodes)
    }
}

/// Stops after this many motion checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Motions(pub u64);

impl Stop for Motions {
    fn check(&mut self, progress: &Progress) -> Option<StopReason> {
        (progress.motions >= self.0).then_some(StopReason::Motions)
    }
}

/// Stops at a time of the clock. The clock changes when a run ends, not what is computed before: for
/// reproducible runs use the counting stops.
///
/// The clock is read by a [`SparseClock`].
#[derive(Clone, Copy, Debug)]
pub struct Deadline {
    clock: SparseClock,
    at: Option<Duration>,
}

impl Deadline {
    /// Stops at the instant `at`.
    #[must_use]
    pub fn at(at: Instant) -> Self {
        Self::after(at.saturating_duration_since(Instant::now()))
    }

    /// Stops when `time` has passed from now.
    #[must_use]
    pub fn after(time: Duration) -> Self {
        Self::by(Clock::default(), time)
    }

    /// Stops when `time` has passed from now on this clock.
    #[must_use]
    pub fn by(clock: Clock, time: Duration) -> Self {
        let clock = SparseClock::new(clock);
        Self { clock, at: clock.last_read().checked_add(time) }
    }
}

impl Stop for Deadline {
    fn check(&mut self, _: &Progress) -> Option<StopReason> {
        let at = self.at?;
        (self.clock.read()? >= at).then_some(StopReason::Deadline)
    }
}

impl Stop for Cancel {
    fn check(&mut self, _: &Progress) -> Option<StopReason> {
        self.reason()
    }
}

/// Stops before an iteration as an [`Interrupt`] does inside one, and says when it has cut an iteration
/// short.
impl Stop for Interrupt {
    fn check(&mut self, _: &Progress) -> Option<StopReason> {
        if self.ask() { self.raised() } else { None }
    }
    fn cut_short(&self) -> Option<StopReason> {
        self.raised()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::Ordering;

    #[test]
    fn budgets_and_their_combination() {
        let mut stop = Iterations(10).or(Nodes(5)).or(Motions(7)).or(None::<Nodes>);
        assert_eq!(stop.check(&Progress::new(9, 4, 6)), None);
        assert_eq!(stop.check(&Progress::new(10, 5, 7)), Some(StopReason::Iterations));
        assert_eq!(stop.check(&Progress::new(9, 5, 7)), Some(StopReason::Nodes));
        assert_eq!(stop.check(&Progress::new(9, 4, 7)), Some(StopReason::Motions));
        assert_eq!(Iterations(0).check(&Progress::default()), Some(StopReason::Iterations));
    }

    #[test]
    fn deadlines_pass() {
        let mut passed = Deadline::at(Instant::now());
        assert_eq!(passed.check(&Progress::default()), Some(StopReason::Deadline));
        let mut never = Deadline::after(Duration::MAX);
        let mut far = Deadline::after(Duration::from_secs(3600));
        for _ in 0..1000 {
            assert_eq!(never.check(&Progress::default()), None);
            assert_eq!(far.check(&Progress::default()), None);
        }
        let mut soon = Deadline::after(Duration::from_millis(5));
        while soon.check(&Progress::default()).is_none() {}
        // A clock of one's own.
        static TIME: std::sync::atomic::AtomicU64 = std::sync::atomic::AtomicU64::new(0);
        let clock = Clock::new(|| Duration::from_secs(TIME.fetch_add(1, Ordering::Relaxed)));
        let mut third = Deadline::by(clock, Duration::from_secs(2));
        assert_eq!(third.check(&Progress::default()), None);
        assert_eq!(third.check(&Progress::default()), Some(StopReason::Deadline));
    }
}
