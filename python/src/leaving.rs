//! The end of the interpreter. A thread that asks for its lock from then on is ended inside of our code, which aborts the process. So all work
//! that calls Python ends before.

use mp_plan::Cancel;
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// What is said to work that begins too late.
pub(crate) const LEAVING: &str = "the interpreter ends: nothing is planned any more";

/// How often it is asked whether all work has ended, and how many times at most: a function of a user's may never return.
const INTERVAL: Duration = Duration::from_millis(10);
const TIMES: usize = 500;

/// The work under way.
struct GoingOn {
    /// Whether the interpreter ends.
    leaving: bool,
    /// How much work has begun so far.
    begun: u64,
    /// The number of each, and what ends it.
    work: Vec<(u64, Cancel)>,
}

static GOING_ON: Mutex<GoingOn> = Mutex::new(GoingOn { leaving: false, begun: 0, work: Vec::new() });

fn going_on() -> MutexGuard<'static, GoingOn> {
    GOING_ON.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Work that calls Python, until it is dropped.
pub(crate) struct Work(u64);

impl Work {
    /// Begins, unless the interpreter ends. If that happens later, `cancel` is raised.
    pub(crate) fn begin(cancel: &Cancel) -> Option<Self> {
        let mut all = going_on();
        if all.leaving {
            return None;
        }
        all.begun += 1;
        let number = all.begun;
        all.work.push((number, cancel.clone()));
        Some(Self(number))
    }
}

impl Drop for Work {
    fn drop(&mut self) {
        going_on().work.retain(|(number, _)| *number != self.0);
    }
}

/// Ends all work, and waits for its end.
#[pyfunction]
fn leave(py: Python<'_>) {
    let mut all = going_on();
    all.leaving = true;
    let none = all.begun == 0;
    drop(all);
    if none {
        return;
    }
    py.detach(|| {
        for _ in 0..TIMES {
            let ended = {
                let all = going_on();
                all.work.iter().for_each(|(_, cancel)| cancel.cancel());
                all.work.is_empty()
            };
            // What has just ended may still make its result.
            std::thread::sleep(INTERVAL);
            if ended {
                return;
            }
        }
    });
}

/// A process that was forked has none of the threads: none of their work goes on here.
#[pyfunction]
fn forked() {
    // If a thread that is gone has locked it, that stays so.
    if let Ok(mut all) = GOING_ON.try_lock() {
        all.work.clear();
    }
}

/// Has the interpreter call [`leave`] before it ends, and [`forked`] in each process that it forks.
pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let leave = wrap_pyfunction!(leave, module)?;
    module.py().import("atexit")?.call_method1("register", (leave,))?;
    // Not on Windows.
    let os = module.py().import("os")?;
    if os.hasattr("register_at_fork")? {
        let forked = [("after_in_child", wrap_pyfunction!(forked, module)?)].into_py_dict(module.py())?;
        os.call_method("register_at_fork", (), Some(&forked))?;
    }
    Ok(())
}
