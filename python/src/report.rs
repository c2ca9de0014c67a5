//! Results as arrays, and text that the Python half makes dataclasses of.

use crate::error::ToPython;
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Rows of numbers as an array of shape (rows, columns).
pub(crate) fn array<'py>(
    py: Python<'py>,
    rows: &[Vec<f64>],
    columns: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    if rows.is_empty() {
        return Ok(PyArray2::zeros(py, [0, columns], false));
    }
    PyArray2::from_vec2(py, rows).map_err(|e| PyValueError::new_err(e.to_string()))
}

/// An array of shape (rows, columns) as rows of numbers.
pub(crate) fn rows(array: &PyReadonlyArray2<'_, f64>) -> Vec<Vec<f64>> {
    array.as_array().rows().into_iter().map(|row| row.to_vec()).collect()
}

/// A report: its JSON form without the paths, the path, and the first path.
pub(crate) type ReportParts<'py> =
    (String, Option<Bound<'py, PyArray2<f64>>>, Option<Bound<'py, PyArray2<f64>>>);

/// Takes a report apart.
pub(crate) fn parts(py: Python<'_>, mut report: mp_plan::Report) -> PyResult<ReportParts<'_>> {
    let columns = report.columns.len();
    let [path, first] = [report.path.take(), report.first_path.take()]
        .map(|path| path.map(|rows| array(py, &rows, columns)).transpose());
    Ok((report.to_json().to_python()?, path?, first?))
}
