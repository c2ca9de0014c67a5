//! Processor time.

use mp_cspace::Clock;
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Whether time is [counted](count).
static COUNTED: AtomicBool = AtomicBool::new(false);

/// From now on time passes by how often it is asked for, a tenth of a millisecond each: it is the same on
/// every machine and in every run, and means nothing.
pub(crate) fn count() {
    COUNTED.store(true, Ordering::Relaxed);
}

/// Whether time is counted.
pub(crate) fn is_counted() -> bool {
    COUNTED.load(Ordering::Relaxed)
}

/// Nanoseconds of [processor time](processor_nanoseconds) that this thread has used, or of counted time.
pub(crate) fn nanoseconds() -> f64 {
    thread_local! {
        static ASKED: Cell<f64> = const { Cell::new(0.0) };
    }
    if !is_counted() {
        return processor_nanoseconds();
    }
    ASKED.set(ASKED.get() + 1e5);
    ASKED.get()
}

/// Nanoseconds of processor time that this thread has used; other work on the machine disturbs it less than
/// wall-clock time.
#[cfg(unix)]
fn processor_nanoseconds() -> f64 {
    let used = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    used.tv_sec as f64 * 1e9 + used.tv_nsec as f64
}

/// Nanoseconds of wall-clock time since the first call, on systems without processor time.
#[cfg(not(unix))]
fn processor_nanoseconds() -> f64 {
    static BEGIN: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    BEGIN.get_or_init(std::time::Instant::now).elapsed().as_nanos() as f64
}

/// Seconds of processor time since `began`, a value of [`nanoseconds`].
pub(crate) fn seconds_since(began: f64) -> f64 {
    (nanoseconds() - began) * 1e-9
}

/// The processor time of the thread that reads it, as the clock of a planner's budget and report.
pub(crate) fn processor_clock() -> Clock {
    Clock::new(|| Duration::from_nanos(nanoseconds() as u64))
}
