//! Functions of Python that planners call, from any thread.

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The calls of a robot's functions: how many there were, and the exception that one raised. It is kept until all work that goes on with
/// the robot has ended with it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Calls(Arc<Counted>);

#[derive(Debug, Default)]
struct Counted {
    count: AtomicU64,
    raised: AtomicBool,
    going: Mutex<Going>,
}

/// The work that goes on with a robot.
#[derive(Debug, Default)]
struct Going {
    /// The process that does it: one that is forked does not.
    process: u32,
    works: usize,
    error: Option<PyErr>,
}

/// Work that calls functions of a robot, until it is dropped.
#[derive(Debug)]
pub(crate) struct Calling(Calls);

impl Calling {
    /// The exception that a function raised meanwhile, for this or other work: then no answer can be relied on.
    pub(crate) fn raised(&self, py: Python<'_>) -> Option<PyErr> {
        self.0.going().error.as_ref().map(|error| error.clone_ref(py))
    }
}

impl Drop for Calling {
    fn drop(&mut self) {
        let mut going = self.0.going();
        going.works = going.works.saturating_sub(1);
        if going.works == 0 {
            let ended = going.error.take();
            self.0.0.raised.store(false, Ordering::Release);
            // What ends with it is not ours, and may come back here.
            drop(going);
            drop(ended);
        }
    }
}

impl Calls {
    /// How many there were.
    pub(crate) fn count(&self) -> u64 {
        self.0.count.load(Ordering::Relaxed)
    }

    /// Whether a function has raised an exception. Then no function is called any more.
    pub(crate) fn is_raised(&self) -> bool {
        self.0.raised.load(Ordering::Acquire)
    }

    /// Begins work.
    pub(crate) fn begin(&self) -> Calling {
        let mut going = self.going();
        let process = std::process::id();
        if going.process != process {
            (going.process, going.works) = (process, 0);
        }
        going.works += 1;
        Calling(self.clone())
    }

    fn going(&self) -> MutexGuard<'_, Going> {
        self.0.going.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Keeps the first exception.
    fn raise(&self, error: PyErr) {
        self.going().error.get_or_insert(error);
        self.0.raised.store(true, Ordering::Release);
    }
}

/// Does `job` in this thread, which the interpreter knows meanwhile: otherwise each call of a function makes and drops its state for the
/// thread, which takes ten times as long as the call.
pub(crate) fn known_to_python<T: Send>(job: impl FnOnce() -> T + Send) -> T {
    Python::attach(|py| py.detach(job))
}

/// A function of Python.
#[derive(Debug)]
pub(crate) struct Callback {
    function: Py<PyAny>,
    calls: Calls,
}

impl Callback {
    pub(crate) fn new(function: Py<PyAny>, calls: &Calls) -> Self {
        Self { function, calls: calls.clone() }
    }

    /// What the function returns, read by `read`; `None` when it raises an exception, or has raised one.
    pub(crate) fn call<T>(
        &self,
        arguments: impl for<'py> FnOnce(Python<'py>) -> PyResult<Bound<'py, PyTuple>>,
        read: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<T>,
    ) -> Option<T> {
        if self.calls.is_raised() {
            return None;
        }
        self.calls.0.count.fetch_add(1, Ordering::Relaxed);
        Python::attach(|py| {
            let result = arguments(py).and_then(|arguments| self.function.bind(py).call1(arguments));
            result.and_then(|result| read(&result)).map_err(|e| self.calls.raise(e)).ok()
        })
    }
}
