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
    /// How many exceptions there were that were kept.
    kept: AtomicU64,
    error: Mutex<Option<PyErr>>,
}

impl Calls {
    /// How many there were.
    pub(crate) fn count(&self) -> u64 {
        self.0.count.load(Ordering::Relaxed)
    }

    /// Whether a function has raised an exception. Then no function is called any more.
    fn is_raised(&self) -> bool {
        self.0.raised.load(Ordering::Acquire)
    }

    /// Whether they are the same.
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Keeps the first exception.
    fn raise(&self, error: PyErr) {
        let mut kept = self.0.error.lock().unwrap_or_else(PoisonError::into_inner);
        if !self.0.raised.swap(true, Ordering::AcqRel) {
            *kept = Some(error);
            self.0.kept.fetch_add(1, Ordering::AcqRel);
        }
    }

    /// Functions are called again, for work that begins. How many exceptions there were before it: of those that come all work that goes on
    /// ends with the last, as functions have answered none of it meanwhile.
    pub(crate) fn begin(&self) -> u64 {
        self.0.raised.store(false, Ordering::Release);
        self.0.kept.load(Ordering::Acquire)
    }

    /// Whether there was an exception since [`begin`](Self::begin) has said `before`.
    pub(crate) fn raised_since(&self, before: u64) -> bool {
        self.0.kept.load(Ordering::Acquire) != before
    }

    /// The last exception, if there is one since [`begin`](Self::begin) has said `before`.
    pub(crate) fn take_since(&self, before: u64) -> Option<PyErr> {
        if !self.raised_since(before) {
            return None;
        }
        self.begin();
        let last = self.0.error.lock().unwrap_or_else(PoisonError::into_inner);
        Python::attach(|py| last.as_ref().map(|e| e.clone_ref(py)))
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
