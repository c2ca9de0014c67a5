//! Functions of Python that planners call, from any thread.

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// The calls of a robot's functions: how many there were, and the exception that one raised, until the work that called it ends with it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Calls(Arc<Counted>);

#[derive(Debug, Default)]
struct Counted {
    count: AtomicU64,
    raised: AtomicBool,
    error: Mutex<Option<PyErr>>,
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

    /// Whether they are the same.
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Keeps the first exception.
    fn raise(&self, error: PyErr) {
        let mut kept = self.0.error.lock().unwrap_or_else(PoisonError::into_inner);
        kept.get_or_insert(error);
        self.0.raised.store(true, Ordering::Release);
    }

    /// The exception, if there is one. Functions are called again.
    pub(crate) fn take(&self) -> Option<PyErr> {
        if !self.is_raised() {
            return None;
        }
        let taken = self.0.error.lock().unwrap_or_else(PoisonError::into_inner).take();
        self.0.raised.store(false, Ordering::Release);
        taken
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
