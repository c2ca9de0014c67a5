//! Stops: when a planner ends without a solution.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
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

/// Why a planner stopped without a solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum StopReason {
    /// The iteration budget is spent.
    Iterations,
    /// The node budget is spent.
    Nodes,
    /// The motion-check budget is spent.
    Motions,
    /// The deadline has passed.
    Deadline,
    /// A [`Cancel`] was raised.
    Cancelled,
    /// The planner has tried all it can: there is no solution at its resolution.
    Exhausted,
}

/// When to stop. Combine with [`Stop::or`].
pub trait Stop {
    /// `Some(reason)` to stop now. Called once per iteration, before it.
    fn check(&mut self, progress: &Progress) -> Option<StopReason>;
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
}
impl<S: Stop + ?Sized> Stop for Box<S> {
    fn check(&mut self, progress: &Progress) -> Option<StopReason> {
        (**self).check(progress)
    }
}
/// `None` never stops.
impl<S: Stop> Stop for Option<S> {
    fn check(&mut self, progress: &Progress) -> Option<StopReason> {
        self.as_mut().and_then(|stop| stop.check(progress))
    }
}

/// Either of two stops.
#[derive(Clone, Copy, Debug)]
pub struct Or<A, B>(pub A, pub B);

impl<A: Stop, B: Stop> Stop for Or<A, B> {
    fn check(&mut self, progress: &Progress) -> Option<StopReason> {
        self.0.check(progress).or_else(|| self.1.check(progress))
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

/// Stops at this many nodes.
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

/// Where the time is read: by default from the monotonic clock of the system.
///
/// WebAssembly has no such clock, and reading it panics there. A host of that kind passes its own.
#[derive(Clone, Copy)]
pub struct Clock(fn() -> Duration);

impl Clock {
    /// A clock that `now` reads: the time since some fixed moment. It must never go back.
    #[must_use]
    pub fn new(now: fn() -> Duration) -> Self {
        Self(now)
    }

    /// The time since a fixed moment.
    #[must_use]
    pub fn now(self) -> Duration {
        (self.0)()
    }
}

impl Default for Clock {
    fn default() -> Self {
        Self(|| {
            // A fixed moment, from which all times of this program are counted.
            static ORIGIN: OnceLock<Instant> = OnceLock::new();
            ORIGIN.get_or_init(Instant::now).elapsed()
        })
    }
}

impl fmt::Debug for Clock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Clock")
    }
}

/// Reads a clock as seldom as short iterations allow: not at each, but at least at every 64th; after two readings more than
/// a millisecond apart, at the next.
#[derive(Clone, Copy, Debug)]
pub struct SparseClock {
    clock: Clock,
    last_read: Duration,
    /// Iterations without reading the clock: between two readings, and still to go.
    skips: u32,
    skips_left: u32,
}

impl SparseClock {
    /// Reads `clock`, now and later.
    #[must_use]
    pub fn new(clock: Clock) -> Self {
        Self { clock, last_read: clock.now(), skips: 0, skips_left: 0 }
    }

    /// The time, if it is read at this iteration.
    pub fn read(&mut self) -> Option<Duration> {
        if self.skips_left > 0 {
            self.skips_left -= 1;
            return None;
        }
        let now = self.clock.now();
        let slow = now.saturating_sub(self.last_read) > Duration::from_millis(1);
        self.skips = if slow { 0 } else { (2 * self.skips + 1).min(63) };
        (self.last_read, self.skips_left) = (now, self.skips);
        Some(now)
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
        Self { clock, at: clock.last_read.checked_add(time) }
    }
}

impl Stop for Deadline {
    fn check(&mut self, _: &Progress) -> Option<StopReason> {
        let at = self.at?;
        (self.clock.read()? >= at).then_some(StopReason::Deadline)
    }
}

/// Stops when its flag is raised, from another thread or a signal handler.
///
/// ```
/// use mp_cspace::{Cancel, Iterations, Progress, Stop, StopReason};
/// let cancel = Cancel::new();
/// let handle = cancel.clone();
/// let mut stop = Iterations(1000).or(cancel);
/// assert_eq!(stop.check(&Progress::default()), None);
/// handle.cancel();
/// assert_eq!(stop.check(&Progress::default()), Some(StopReason::Cancelled));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Cancel(pub Arc<AtomicBool>);

impl Cancel {
    /// A flag that is not raised; clones share it.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Raises the flag.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Stop for Cancel {
    fn check(&mut self, _: &Progress) -> Option<StopReason> {
        self.0.load(Ordering::Relaxed).then_some(StopReason::Cancelled)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
