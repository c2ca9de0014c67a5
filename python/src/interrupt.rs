//! Work without the lock of the interpreter, which Ctrl-C ends.
//!
//! Python runs the handlers of signals in its main thread only, between its own instructions. So the work is done in a thread of its own,
//! and the calling thread looks for signals meanwhile, and passes on reports of progress.

use crate::callback::{Calls, known_to_python};
use crate::error::internal;
use crate::leaving::{LEAVING, Work};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// How often signals are looked for.
pub(crate) const INTERVAL: Duration = Duration::from_millis(20);

/// Stops work from another thread. `cancel()` ends all work that it was given to; what was found until then is kept.
#[pyclass(frozen, module = "mp_motion._mp")]
#[derive(Clone, Debug, Default)]
pub(crate) struct Cancel(pub(crate) mp_plan::Cancel);

#[pymethods]
impl Cancel {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    fn cancel(&self) {
        self.0.cancel();
    }

    #[getter]
    fn cancelled(&self) -> bool {
        self.0.is_raised()
    }
}

/// What the work says while it goes on.
pub(crate) enum News {
    /// Counts: iterations, nodes, motions, rejected candidates.
    Progress([u64; 4]),
    /// A stage begins.
    Stage(&'static str),
    /// A path of this length was found.
    Found(f64),
    /// The work has ended.
    Done,
}

/// Sends what a run reports.
pub(crate) struct Reporter(pub(crate) Sender<News>);

impl mp_plan::Watch for Reporter {
    fn stage(&mut self, stage: mp_plan::Stage) {
        let name = match stage {
            mp_plan::Stage::Planning => "planning",
            mp_plan::Stage::Relaxing => "relaxing",
            _ => "finishing",
        };
        let _ = self.0.send(News::Stage(name));
    }
    fn progress(&mut self, progress: &mp_plan::Progress) {
        let counts = [progress.iterations, progress.nodes as u64, progress.motions, progress.rejected];
        let _ = self.0.send(News::Progress(counts));
    }
    fn found(&mut self, length: f64, _rows: &dyn Fn() -> Vec<Vec<f64>>) {
        let _ = self.0.send(News::Found(length));
    }
}

/// Does `job` without the lock of the interpreter. When a signal's handler raises an exception (as that of Ctrl-C does), or `progress`
/// does, `cancel` is raised; the job ends soon, and the exception comes with its result.
///
/// # Errors
/// When the interpreter ends, the job panics, or a function of an own robot raises an exception, which is kept in `calls` and ends the job as well.
pub(crate) fn work<T: Send>(
    py: Python<'_>,
    cancel: &mp_plan::Cancel,
    progress: Option<&Py<PyAny>>,
    calls: Option<&Calls>,
    job: impl FnOnce(Reporter) -> T + Send,
) -> PyResult<(T, Option<PyErr>)> {
    let _work = Work::begin(cancel).ok_or_else(|| PyRuntimeError::new_err(LEAVING))?;
    let calling = calls.map(Calls::begin);
    let (sender, receiver) = channel();
    // A receiver is for one thread at a time.
    let receiver = Mutex::new(receiver);
    let ended = sender.clone();
    let done = py.detach(|| {
        std::thread::scope(|scope| {
            let worker = scope.spawn(move || {
                let result = catch_unwind(AssertUnwindSafe(|| match calls {
                    Some(_) => known_to_python(|| job(Reporter(sender))),
                    None => job(Reporter(sender)),
                }));
                let _ = ended.send(News::Done);
                result
            });
            let raised =
                attend(&receiver.lock().unwrap_or_else(PoisonError::into_inner), cancel, progress, calls);
            (worker.join().unwrap_or_else(|panic| resume_unwind(panic)), raised)
        })
    });
    match done {
        (Ok(result), raised) => match calling.and_then(|calling| calling.raised(py)) {
            Some(e) => Err(e),
            None => Ok((result, raised)),
        },
        (Err(panic), _) => Err(internal(&*panic)),
    }
}

/// Panics as a fault in the work would: tests look at what becomes of it.
#[pyfunction]
pub(crate) fn panic(py: Python<'_>, message: String) -> PyResult<()> {
    work(py, &mp_plan::Cancel::new(), None, None, |_| std::panic::panic_any(message)).map(|((), _)| ())
}

/// Waits for the end of the work, and says why it was cancelled, if it was here.
fn attend(
    news: &Receiver<News>,
    cancel: &mp_plan::Cancel,
    progress: Option<&Py<PyAny>>,
    calls: Option<&Calls>,
) -> Option<PyErr> {
    let mut raised = None;
    let mut now = Shown::default();
    loop {
        let said = news.recv_timeout(INTERVAL);
        match said {
            Ok(News::Done) | Err(RecvTimeoutError::Disconnected) => return raised,
            _ if raised.is_some() => continue,
            _ => {}
        }
        if calls.is_some_and(Calls::is_raised) {
            cancel.cancel();
            continue;
        }
        let outcome = Python::attach(|py| {
            py.check_signals()?;
            match (said, progress) {
                (Ok(news), Some(callback)) => now.tell(py, news, callback),
                _ => Ok(()),
            }
        });
        if let Err(e) = outcome {
            cancel.cancel();
            raised = Some(e);
        }
    }
}

/// What a callback has been told.
#[derive(Default)]
struct Shown {
    stage: &'static str,
    counts: [u64; 4],
    length: Option<f64>,
}

impl Shown {
    fn tell(&mut self, py: Python<'_>, news: News, callback: &Py<PyAny>) -> PyResult<()> {
        match news {
            News::Progress(counts) => self.counts = counts,
            News::Stage(stage) => self.stage = stage,
            News::Found(length) => self.length = Some(length),
            News::Done => return Ok(()),
        }
        let members = PyDict::new(py);
        let [iterations, nodes, motions, rejected] = self.counts;
        members.set_item("stage", self.stage)?;
        members.set_item("iterations", iterations)?;
        members.set_item("nodes", nodes)?;
        members.set_item("motions", motions)?;
        members.set_item("rejected", rejected)?;
        members.set_item("length", self.length)?;
        callback.call1(py, (members,)).map(drop)
    }
}
