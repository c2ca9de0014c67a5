//! Results of lists of problems, item by item.

use crate::error::{ToPython, to_python};
use crate::report::parts;
use crate::scene::json;
use mp_batch::ListResults;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// The results in a file, one after the other.
#[pyclass(frozen, module = "mp_motion._mp")]
#[derive(Debug)]
pub(crate) struct Results {
    /// In a box: its checksum must be aligned as objects of Python are not.
    results: Mutex<Box<ListResults>>,
    header: String,
}

#[pymethods]
impl Results {
    #[new]
    fn new(py: Python<'_>, file: PathBuf, partial: bool) -> PyResult<Self> {
        let results = py.detach(|| ListResults::open(&file)).to_python()?;
        let header = json(results.header())?;
        let results = if partial { results.partial() } else { results };
        Ok(Self { results: Mutex::new(Box::new(results)), header })
    }

    /// What they are of, as JSON.
    #[getter]
    fn header(&self) -> &str {
        &self.header
    }

    fn __iter__(this: PyRef<'_, Self>) -> PyRef<'_, Self> {
        this
    }

    /// The number of the next item, and its report in parts or its error.
    fn __next__(&self, py: Python<'_>) -> PyResult<Option<(u64, Py<PyAny>)>> {
        let next = py.detach(|| self.results.lock().unwrap_or_else(PoisonError::into_inner).next());
        let Some(result) = next.transpose().to_python()? else { return Ok(None) };
        let item = result.item;
        let outcome = match result.into_result() {
            Ok(report) => parts(py, report)?.into_pyobject(py)?.into_any().unbind(),
            Err(e) => to_python(&e).into_value(py).into_any(),
        };
        Ok(Some((item, outcome)))
    }
}
