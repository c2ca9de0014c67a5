//! Roadmaps that answer many queries.

use crate::callback::Calls;
use crate::error::{ToPython, to_python};
use crate::interrupt::{Cancel, work};
use crate::report::{ReportParts, parts};
use crate::scene::request;
use mp_plan::{Budget, Control, SceneRoadmap};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// A roadmap of a scene. One query at a time: others wait.
#[pyclass(frozen, module = "mp_motion._mp")]
#[derive(Debug)]
pub(crate) struct Roadmap {
    roadmap: Mutex<SceneRoadmap>,
    calls: Option<Calls>,
}

impl Roadmap {
    pub(crate) fn new(roadmap: SceneRoadmap, calls: Option<Calls>) -> Self {
        Self { roadmap: Mutex::new(roadmap), calls }
    }

    /// Does something with the roadmap, without the lock of the interpreter.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        cancel: Option<&Cancel>,
        progress: Option<&Py<PyAny>>,
        job: impl FnOnce(&mut SceneRoadmap, &mut Control<'_>) -> T + Send,
    ) -> PyResult<(T, Option<PyErr>)> {
        let cancel = cancel.map(|c| c.0.clone()).unwrap_or_default();
        let raised = cancel.clone();
        work(py, &cancel, progress, self.calls.as_ref(), move |mut reporter| {
            let mut roadmap = self.roadmap.lock().unwrap_or_else(PoisonError::into_inner);
            job(&mut roadmap, &mut Control::new(raised, &mut reporter))
        })
    }
}

#[pymethods]
impl Roadmap {
    #[pyo3(signature = (start, goal, cancel=None))]
    fn query<'py>(
        &self,
        py: Python<'py>,
        start: Vec<f64>,
        goal: Vec<f64>,
        cancel: Option<&Cancel>,
    ) -> PyResult<(ReportParts<'py>, Option<Py<PyAny>>)> {
        let (report, raised) =
            self.with(py, cancel, None, |map, control| map.query_with(&start, &goal, control))?;
        Ok((parts(py, report.to_python()?)?, raised.map(|e| e.into_value(py).into_any())))
    }

    #[pyo3(signature = (budget, cancel=None, progress=None))]
    fn grow(
        &self,
        py: Python<'_>,
        budget: &str,
        cancel: Option<&Cancel>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let budget: Budget = request(&format!("{{\"budget\": {budget}}}"))?.budget;
        let (grown, raised) =
            self.with(py, cancel, progress.as_ref(), |map, control| map.grow(budget, control))?;
        grown.to_python()?;
        raised.map_or(Ok(()), Err)
    }

    fn verify(&self, py: Python<'_>) -> PyResult<usize> {
        let (blocked, raised) = self.with(py, None, None, |map, _| map.verify())?;
        raised.map_or(Ok(()), Err)?;
        blocked.to_python()
    }

    fn save(&self, py: Python<'_>, file: PathBuf) -> PyResult<()> {
        let (saved, raised) = self.with(py, None, None, |map, _| map.save(&file))?;
        saved.map_err(|e| to_python(&e))?;
        raised.map_or(Ok(()), Err)
    }

    /// The numbers of nodes, edges and components.
    fn size(&self, py: Python<'_>) -> [usize; 3] {
        py.detach(|| {
            let mut map = self.roadmap.lock().unwrap_or_else(PoisonError::into_inner);
            [map.nodes(), map.edges(), map.components()]
        })
    }
}
