//! How long work ends early.
//!
//! Somebody raises a [`Cancel`], or a deadline passes on a [`Clock`]. Long work has an [`Interrupt`] and asks
//! it again and again, also deep inside: planners within their iterations, checks of motions, verification,
//! and readers of files.
//!
//! ```
//! use mp_stop::{Cancel, Interrupt, StopReason};
//!
//! let cancel = Cancel::new();
//! let mut interrupt = Interrupt::new(cancel.clone());
//! let mut sum = 0_u64;
//! for i in 0.. {
//!     if interrupt.ask() {
//!         break;
//!     }
//!     sum += i;
//!     if i == 1000 {
//!         cancel.cancel(); // Another thread, or a signal handler, would do this.
//!     }
//! }
//! assert_eq!(sum, 500_500);
//! assert_eq!(interrupt.raised(), Some(StopReason::Cancelled));
//! ```
//!
//! With the feature `signals`, `signals::on_first` raises a [`Cancel`] at Ctrl-C or SIGTERM.

#[cfg(feature = "signals")]
pub mod signals;

use std::fmt;
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// Why work ended early, or a planner without a solution.
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
    /// The memory budget is spent.
    Memory,
    /// A [`Cancel`] was raised.
    Cancelled,
    /// The planner has tried all it can: there is no solution at its resolution.
    Exhausted,
}

/// A flag that ends work, raised from another thread or a signal handler.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicU8>);

impl Cancel {
    /// A flag that is not raised; clones share it.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Raises the flag.
    pub fn cancel(&self) {
        self.raise(CANCELLED);
    }

    /// Raises the flag because a memory budget is spent. Whoever raises it measures the memory.
    pub fn out_of_memory(&self) {
        self.raise(MEMORY);
    }

    /// The first reason stays.
    fn raise(&self, why: u8) {
        let _ = self.0.compare_exchange(0, why, Ordering::Relaxed, Ordering::Relaxed);
    }

    /// Whether the flag is raised.
    #[must_use]
    pub fn is_raised(&self) -> bool {
        self.0.load(Ordering::Relaxed) != 0
    }

    /// Why the flag was raised, if it is.
    #[must_use]
    pub fn reason(&self) -> Option<StopReason> {
        reason(self.0.load(Ordering::Relaxed))
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

/// Most iterations in a row at which a [`SparseClock`] does not read its clock.
const MOST_SKIPS: u32 = 15;

/// Reads a clock as seldom as short iterations allow: not at each, but at least at every 16th; after two
/// readings more than a millisecond apart, at the next.
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

    /// The time when it was read last.
    #[must_use]
    pub fn last_read(&self) -> Duration {
        self.last_read
    }

    /// The time, if it is read at this iteration.
    pub fn read(&mut self) -> Option<Duration> {
        if self.skips_left > 0 {
            self.skips_left -= 1;
            return None;
        }
        let now = self.clock.now();
        let slow = now.saturating_sub(self.last_read) > Duration::from_millis(1);
        self.skips = if slow { 0 } else { (2 * self.skips + 1).min(MOST_SKIPS) };
        (self.last_read, self.skips_left) = (now, self.skips);
        Some(now)
    }
}

/// The token that long work asks whether to end: when a [`Cancel`] is raised, or at a time of a clock.
///
/// Clones are for the parts of one piece of work, on any thread: once one of them was interrupted, all are.
/// Asking costs two atomic loads; with a deadline the clock is read as by a [`SparseClock`]. The default
/// never ends anything.
///
/// Work that was interrupted returns as soon as it can, with any answer. Whoever started it asks
/// [`raised`](Self::raised) afterwards, and drops the answer if so.
#[derive(Clone, Debug, Default)]
pub struct Interrupt {
    shared: Option<Arc<Shared>>,
    clock: Option<SparseClock>,
}

/// Work was interrupted by an [`Interrupt`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interrupted;

impl fmt::Display for Interrupted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the work was told to end")
    }
}

impl std::error::Error for Interrupted {}

/// What the clones of an [`Interrupt`] share.
#[derive(Debug)]
struct Shared {
    cancel: Cancel,
    /// The deadline in nanoseconds of the clock, if there is a clock.
    at: AtomicU64,
    /// 0, or why an answer was to end: see [`Interrupt::raised`].
    told: AtomicU8,
}

/// The values of [`Shared::told`] and [`Cancel`].
const CANCELLED: u8 = 1;
const DEADLINE: u8 = 2;
const MEMORY: u8 = 3;

/// What these values mean.
fn reason(told: u8) -> Option<StopReason> {
    match told {
        CANCELLED => Some(StopReason::Cancelled),
        DEADLINE => Some(StopReason::Deadline),
        MEMORY => Some(StopReason::Memory),
        _ => None,
    }
}

impl Interrupt {
    /// Ends nothing.
    #[must_use]
    pub fn never() -> Self {
        Self::default()
    }

    /// Ends work when `cancel` is raised.
    #[must_use]
    pub fn new(cancel: Cancel) -> Self {
        Self::made(cancel, Duration::MAX, None)
    }

    /// Ends work when `cancel` is raised, or at the time `at` of `clock`.
    #[must_use]
    pub fn by(cancel: Cancel, clock: Clock, at: Duration) -> Self {
        Self::made(cancel, at, Some(SparseClock::new(clock)))
    }

    fn made(cancel: Cancel, at: Duration, clock: Option<SparseClock>) -> Self {
        let (at, told) = (AtomicU64::new(nanoseconds(at)), AtomicU8::new(0));
        Self { shared: Some(Arc::new(Shared { cancel, at, told })), clock }
    }

    /// Moves the deadline of all clones, if there is one: for work with pauses that do not count.
    pub fn move_deadline(&self, at: Duration) {
        if let Some(shared) = &self.shared {
            shared.at.store(nanoseconds(at), Ordering::Relaxed);
        }
    }

    /// Whether to end now.
    #[inline]
    pub fn ask(&mut self) -> bool {
        let Some(shared) = &self.shared else { return false };
        if shared.told.load(Ordering::Relaxed) != 0 {
            return true;
        }
        let why = match shared.cancel.0.load(Ordering::Relaxed) {
            0 => match self.clock.as_mut().and_then(SparseClock::read) {
                Some(now) if nanoseconds(now) >= shared.at.load(Ordering::Relaxed) => DEADLINE,
                _ => return false,
            },
            why => why,
        };
        // The first reason stays.
        let _ = shared.told.compare_exchange(0, why, Ordering::Relaxed, Ordering::Relaxed);
        true
    }

    /// As [`ask`](Self::ask), for work that returns errors by `?`.
    ///
    /// # Errors
    /// When work is to end now.
    #[inline]
    pub fn go_on(&mut self) -> Result<(), Interrupted> {
        if self.ask() { Err(Interrupted) } else { Ok(()) }
    }

    /// Why work was interrupted, if any of the clones was. Looks neither at the flag nor at the clock.
    #[must_use]
    pub fn raised(&self) -> Option<StopReason> {
        reason(self.shared.as_ref()?.told.load(Ordering::Relaxed))
    }
}

/// As many as fit: 584 years.
fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicU64;

    #[test]
    fn all_clones_are_told_and_the_first_reason_stays() {
        static TIME: AtomicU64 = AtomicU64::new(0);
        let clock = Clock::new(|| Duration::from_millis(TIME.load(Ordering::Relaxed)));
        let cancel = Cancel::new();
        let mut one = Interrupt::by(cancel.clone(), clock, Duration::from_millis(50));
        let mut other = one.clone();
        assert!(!one.ask() && !other.ask());
        TIME.store(50, Ordering::Relaxed);
        assert_eq!(one.raised(), None, "nobody has asked since");
        while !one.ask() {}
        assert!(other.ask());
        cancel.cancel();
        assert!(other.ask());
        assert_eq!([one.raised(), other.raised()], [Some(StopReason::Deadline); 2]);
        // Another piece of work with the same flag.
        let mut next = Interrupt::new(cancel);
        assert_eq!(next.raised(), None);
        assert!(next.ask());
        assert_eq!(next.raised(), Some(StopReason::Cancelled));
        assert!(!Interrupt::never().ask());
    }

    #[test]
    fn work_without_memory_is_told_so() {
        let cancel = Cancel::new();
        let mut interrupt = Interrupt::new(cancel.clone());
        assert_eq!((interrupt.ask(), cancel.reason()), (false, None));
        cancel.out_of_memory();
        assert_eq!((interrupt.ask(), interrupt.raised()), (true, Some(StopReason::Memory)));
        // Ctrl-C afterwards changes nothing.
        cancel.cancel();
        assert_eq!((cancel.is_raised(), cancel.reason()), (true, Some(StopReason::Memory)));
        let other = Cancel::new();
        other.cancel();
        assert_eq!(other.reason(), Some(StopReason::Cancelled));
    }

    /// However quick the asks before were, a late one is at most 16 asks behind the clock; slow asks are not
    /// late at all.
    #[test]
    fn clocks_are_read_often_enough() {
        static TIME: AtomicU64 = AtomicU64::new(0);
        static READ: AtomicU64 = AtomicU64::new(0);
        let clock = Clock::new(|| {
            READ.fetch_add(1, Ordering::Relaxed);
            Duration::from_micros(TIME.load(Ordering::Relaxed))
        });
        let mut interrupt = Interrupt::by(Cancel::new(), clock, Duration::from_millis(900));
        for _ in 0..16_000 {
            TIME.fetch_add(1, Ordering::Relaxed);
            assert!(!interrupt.ask());
        }
        let read = READ.load(Ordering::Relaxed);
        assert!((1000..1100).contains(&read), "{read}");
        let mut asks = 0;
        while !interrupt.ask() {
            TIME.fetch_add(10_000, Ordering::Relaxed);
            asks += 1;
        }
        assert!((89..89 + 16).contains(&asks), "{asks}");
        assert!(TIME.load(Ordering::Relaxed) < 900_000 + 16 * 10_000);
    }
}
