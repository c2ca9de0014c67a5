//! Many problems at once, as an iterator.

use crate::callback::{Calls, known_to_python};
use crate::error::{internal, to_python};
use crate::interrupt::{Cancel, INTERVAL};
use crate::leaving::{LEAVING, Work};
use crate::report::parts;
use crate::scene::{Scene, request};
use mp_batch::in_order;
use mp_plan::{Control, Error, Report, Request};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

/// How many results may wait until they are taken.
const WAITING: usize = 64;

/// What a worker has to say; what a panic says.
type Planned = std::thread::Result<Result<Report, Error>>;

/// Results in the order of problems. Problems are drawn and planned by threads of their own.
#[pyclass(frozen, module = "mp_motion._mp")]
#[derive(Debug)]
pub(crate) struct Many {
    /// The process whose threads plan: one that is forked does not have them.
    process: u32,
    results: Mutex<Option<Receiver<Planned>>>,
    thread: Mutex<Option<JoinHandle<()>>>,
    /// Ends the work; and what the user gave, which is not ours to raise.
    cancel: mp_plan::Cancel,
    theirs: Option<mp_plan::Cancel>,
    /// What drawing a problem, or a function of an own robot, raised.
    failures: Failures,
}

/// The exception of the iterator of problems, and that of a function of a robot.
#[derive(Clone, Debug, Default)]
struct Failures(Arc<Mutex<Raised>>);

#[derive(Debug, Default)]
struct Raised {
    drawing: Option<PyErr>,
    robot: Option<PyErr>,
}

impl Failures {
    fn with<T>(&self, use_it: impl FnOnce(&mut Raised) -> T) -> T {
        use_it(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn of_robot(&self) -> Option<PyErr> {
        self.with(|raised| raised.robot.take())
    }

    fn any(&self) -> Option<PyErr> {
        self.with(|raised| raised.robot.take().or_else(|| raised.drawing.take()))
    }
}

/// Draws problems, `(Scene, request as JSON)`, from an iterator of Python.
struct Drawn {
    iterator: Py<PyAny>,
    failures: Failures,
}

impl Iterator for Drawn {
    type Item = (mp_plan::Scene, Request, Option<Calls>);

    fn next(&mut self) -> Option<Self::Item> {
        let _work = Work::begin(&mp_plan::Cancel::new())?;
        let drawn = Python::attach(|py| {
            let mut iterator = self.iterator.bind(py).try_iter()?;
            let Some(item) = iterator.next() else { return Ok(None) };
            let (scene, json): (PyRef<'_, Scene>, String) = item?.extract()?;
            Ok(Some((scene.scene.clone(), request(&json)?, scene.calls().cloned())))
        });
        drawn.unwrap_or_else(|e: PyErr| {
            self.failures.with(|raised| raised.drawing = Some(e));
            None
        })
    }
}

#[pymethods]
impl Many {
    #[new]
    #[pyo3(signature = (problems, threads, cancel=None))]
    fn new(problems: Py<PyAny>, threads: usize, cancel: Option<&Cancel>) -> Self {
        let failures = Failures::default();
        let drawn = Drawn { iterator: problems, failures: failures.clone() };
        let theirs = cancel.map(|cancel| cancel.0.clone());
        let raised = failures.clone();
        let plan = move |(scene, request, calls): (mp_plan::Scene, Request, Option<Calls>),
                         cancel: &mp_plan::Cancel| {
            let calling = calls.as_ref().map(Calls::begin);
            let mut control = Control { cancel: cancel.clone(), ..Control::default() };
            let report = scene.plan_with(&request, &mut control);
            if let Some(e) = calling.and_then(|calling| Python::attach(|py| calling.raised(py))) {
                raised.with(|raised| drop(raised.robot.replace(e)));
            }
            report
        };
        Self::start(drawn, threads, theirs, failures, plan)
    }

    fn __iter__(this: PyRef<'_, Self>) -> PyRef<'_, Self> {
        this
    }

    /// The next report in parts, or the error of a problem that cannot be planned.
    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Py<PyAny>>> {
        if self.is_elsewhere() {
            let message =
                "these problems are planned by the process that was forked: call `plan_many` in this one";
            return Err(PyRuntimeError::new_err(message));
        }
        loop {
            let taken = py.detach(|| {
                let results = self.results.lock().unwrap_or_else(PoisonError::into_inner);
                results.as_ref().map(|results| results.recv_timeout(INTERVAL))
            });
            py.check_signals()?;
            if self.theirs.as_ref().is_some_and(mp_plan::Cancel::is_raised) {
                self.cancel.cancel();
            }
            if let Some(e) = self.failures.of_robot() {
                return Err(e);
            }
            match taken {
                Some(Ok(Ok(Ok(report)))) => {
                    return Ok(Some(parts(py, report)?.into_pyobject(py)?.into_any().unbind()));
                }
                Some(Ok(Ok(Err(e)))) => return Ok(Some(to_python(&e).into_value(py).into_any())),
                Some(Ok(Err(panic))) => return Err(internal(&*panic)),
                Some(Err(RecvTimeoutError::Timeout)) => {}
                None | Some(Err(RecvTimeoutError::Disconnected)) => {
                    self.close(py)?;
                    return self.failures.any().map_or(Ok(None), Err);
                }
            }
        }
    }

    /// Ends the work, and waits for its end.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        if self.is_elsewhere() {
            return Ok(());
        }
        let of = |mutex: &Mutex<Option<JoinHandle<()>>>| {
            mutex.lock().unwrap_or_else(PoisonError::into_inner).take()
        };
        let ended = py.detach(|| {
            // Without a receiver nothing waits for room.
            let results = self.results.lock().unwrap_or_else(PoisonError::into_inner).take();
            let thread = of(&self.thread);
            if results.is_some() {
                self.cancel.cancel();
            }
            drop(results);
            thread.map_or(Ok(()), JoinHandle::join)
        });
        ended.map_err(|panic| internal(&*panic))
    }
}

impl Many {
    /// Whether this process was forked from the one that plans.
    fn is_elsewhere(&self) -> bool {
        self.process != std::process::id()
    }

    /// Does `job` with all items, as [`mp_batch::plan_many`] does, in threads that the interpreter knows, and with functions that may fail.
    fn start<I: Send + 'static>(
        items: impl Iterator<Item = I> + Send + 'static,
        threads: usize,
        theirs: Option<mp_plan::Cancel>,
        failures: Failures,
        job: impl Fn(I, &mp_plan::Cancel) -> Result<Report, Error> + Send + Sync + 'static,
    ) -> Self {
        let cancel = mp_plan::Cancel::new();
        let (sender, receiver) = sync_channel(WAITING);
        let raised = cancel.clone();
        let work = move || {
            let plan = |_, item| match Work::begin(&raised) {
                Some(_work) => known_to_python(|| catch_unwind(AssertUnwindSafe(|| job(item, &raised)))),
                None => Ok(Err(Error::new(LEAVING))),
            };
            in_order(items, threads, &raised, plan, |_, result| {
                let goes_on = result.is_ok();
                match sender.send(result) {
                    Ok(()) if goes_on => ControlFlow::Continue(()),
                    // There was a panic, or nobody takes them any more.
                    _ => ControlFlow::Break(()),
                }
            });
        };
        Self {
            process: std::process::id(),
            results: Mutex::new(Some(receiver)),
            thread: Mutex::new(Some(std::thread::spawn(work))),
            cancel,
            theirs,
            failures,
        }
    }
}

/// Items of which each panics from `first` on, as a fault in planning would: tests look at what becomes of it.
#[pyfunction]
pub(crate) fn panics(message: String, first: usize, threads: usize) -> Many {
    Many::start(0..100, threads, None, Failures::default(), move |item, _| match item < first {
        true => Err(Error::new("no problem")),
        false => std::panic::panic_any(message.clone()),
    })
}

impl Drop for Many {
    fn drop(&mut self) {
        self.cancel.cancel();
    }
}
