//! Runs a stream of jobs in parallel, and gives their results in order.

use mp_cspace::Cancel;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// How many results for each thread may wait for an earlier one that takes long.
const AHEAD: usize = 512;

/// Draws `items` one by one and runs `job` on each, with its number, on `threads` threads. `take` gets the
/// results in the order of the items; it runs in the calling thread while others work. At most 512 items for
/// each thread are drawn before the result of the first of them is taken: however many items there are,
/// memory stays the same. Returns how many results were taken.
///
/// When `cancel` is raised, or `take` breaks, no further item is drawn; `take` still gets the results of
/// those that were, unless it broke.
///
/// ```
/// use std::ops::ControlFlow;
/// let mut squares = Vec::new();
/// mp_batch::in_order(1..=4, 2, &mp_plan::Cancel::new(), |_, n| n * n, |_, square| {
///     squares.push(square);
///     ControlFlow::Continue(())
/// });
/// assert_eq!(squares, [1, 4, 9, 16]);
/// ```
///
/// # Panics
/// When `items`, `job` or `take` panics.
pub fn in_order<I, T: Send>(
    items: impl IntoIterator<Item = I, IntoIter: Send>,
    threads: usize,
    cancel: &Cancel,
    job: impl Fn(usize, I) -> T + Sync,
    mut take: impl FnMut(usize, T) -> ControlFlow<()>,
) -> usize {
    let items = items.into_iter();
    if threads <= 1 {
        // Some systems have no threads.
        let mut taken = 0;
        for (number, item) in items.take_while(|_| !cancel.is_raised()).enumerate() {
            let result = job(number, item);
            taken += 1;
            if take(number, result).is_break() {
                break;
            }
        }
        return taken;
    }
    let source = Mutex::new((0, items.fuse()));
    let queue = Queue {
        state: Mutex::new(State { ready: BTreeMap::new(), taken: 0, at_work: threads, ended: false }),
        changed: Condvar::new(),
        ahead: AHEAD.saturating_mul(threads),
    };
    let work = || {
        let _leave = Leave(&queue);
        loop {
            let (number, item) = {
                // After a panic of the items there are no more.
                let Ok(mut source) = source.lock() else { return };
                let (next, items) = &mut *source;
                if !queue.wait_for_room(*next) || cancel.is_raised() {
                    return;
                }
                let Some(item) = items.next() else { return };
                *next += 1;
                (*next - 1, item)
            };
            queue.put(number, job(number, item));
        }
    };
    std::thread::scope(|scope| {
        // Also when `take` panics.
        let _end = End(&queue);
        for _ in 0..threads {
            scope.spawn(work);
        }
        let mut taken = 0;
        while let Some(result) = queue.wait_for(taken) {
            taken += 1;
            if take(taken - 1, result).is_break() {
                break;
            }
        }
        taken
    })
}

/// The results that are not taken yet.
struct Queue<T> {
    state: Mutex<State<T>>,
    changed: Condvar,
    /// How many items may be drawn before the first of them is taken.
    ahead: usize,
}

struct State<T> {
    ready: BTreeMap<usize, T>,
    taken: usize,
    /// The number of threads that may still put a result.
    at_work: usize,
    /// Nothing more will be taken.
    ended: bool,
}

impl<T> Queue<T> {
    fn lock(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State<T>>) -> MutexGuard<'a, State<T>> {
        self.changed.wait(state).unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until item `next` may be drawn; false if none may be.
    fn wait_for_room(&self, next: usize) -> bool {
        let mut state = self.lock();
        while !state.ended && next >= state.taken + self.ahead {
            state = self.wait(state);
        }
        !state.ended
    }

    fn put(&self, number: usize, result: T) {
        self.lock().ready.insert(number, result);
        self.changed.notify_all();
    }

    /// Waits for the result `number`; `None` if there will be none.
    fn wait_for(&self, number: usize) -> Option<T> {
        let mut state = self.lock();
        loop {
            if let Some(result) = state.ready.remove(&number) {
                state.taken = number + 1;
                self.changed.notify_all();
                return Some(result);
            }
            if state.at_work == 0 {
                return None;
            }
            state = self.wait(state);
        }
    }
}

/// A thread puts no more results. When it panics, the others end too.
struct Leave<'q, T>(&'q Queue<T>);

impl<T> Drop for Leave<'_, T> {
    fn drop(&mut self) {
        let mut state = self.0.lock();
        state.at_work -= 1;
        state.ended |= std::thread::panicking();
        drop(state);
        self.0.changed.notify_all();
    }
}

/// Nothing more will be taken.
struct End<'q, T>(&'q Queue<T>);

impl<T> Drop for End<'_, T> {
    fn drop(&mut self) {
        self.0.lock().ended = true;
        self.0.changed.notify_all();
    }
}
