//! Runs jobs in parallel.

use mp_cspace::Cancel;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Runs `count` jobs, numbered from 0, on `threads` threads, and returns their results in the order of their numbers.
/// A job that did not begin because of `cancel` gives `None`. If each job has its own seed, results do not depend on the
/// number of threads.
///
/// ```
/// let squares = mp_plan::in_parallel(4, 2, &mp_plan::Cancel::new(), |i| i * i);
/// assert_eq!(squares, [Some(0), Some(1), Some(4), Some(9)]);
/// ```
pub fn in_parallel<T: Send>(
    count: usize,
    threads: usize,
    cancel: &Cancel,
    job: impl Fn(usize) -> T + Sync,
) -> Vec<Option<T>> {
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<Option<T>>> = Mutex::new((0..count).map(|_| None).collect());
    let work = || {
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= count || cancel.is_raised() {
                break;
            }
            let result = job(i);
            if let Ok(mut done) = done.lock() {
                done[i] = Some(result);
            }
        }
    };
    let threads = threads.min(count);
    if threads > 1 {
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(work);
            }
        });
    } else {
        // Some systems have no threads.
        work();
    }
    done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner)
}
