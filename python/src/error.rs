//! Errors of `mp-plan` as exceptions of `mp_motion`.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

/// An exception of the Python half, by the name of its class.
fn class<'py>(py: Python<'py>, known: &PyOnceLock<Py<PyAny>>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    let class = known.get_or_try_init(py, || {
        py.import("mp_motion._errors").and_then(|module| Ok(module.getattr(name)?.unbind()))
    })?;
    Ok(class.bind(py).clone())
}

/// `mp_motion.Error` with message, kind, remedy, and the place in a file if there is one.
pub(crate) fn to_python(error: &mp_plan::Error) -> PyErr {
    static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    Python::attach(|py| {
        let make = || {
            let file = error.file();
            let place = [file.and_then(mp_io::Error::line), file.and_then(mp_io::Error::column)];
            let (kind, name) = (error.kind().name(), file.map(mp_io::Error::file));
            let members = (error.message(), kind, error.remedy(), name, place[0], place[1], error.report());
            class(py, &CLASS, "_error")?.call1(members)
        };
        make().map_or_else(|e| e, PyErr::from_value)
    })
}

/// `mp_motion.InternalError`: a fault of this program, which is not the fault of who called it.
pub(crate) fn internal(payload: &(dyn std::any::Any + Send)) -> PyErr {
    static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let text = payload
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| payload.downcast_ref::<&str>().copied())
        .unwrap_or("no message");
    Python::attach(|py| match class(py, &CLASS, "InternalError").and_then(|class| class.call1((text,))) {
        Ok(value) => PyErr::from_value(value),
        Err(_) => PyRuntimeError::new_err(text.to_owned()),
    })
}

/// A result of `mp-plan` as one of Python.
pub(crate) trait ToPython<T> {
    fn to_python(self) -> PyResult<T>;
}

impl<T, E: Into<mp_plan::Error>> ToPython<T> for Result<T, E> {
    fn to_python(self) -> PyResult<T> {
        self.map_err(|e| to_python(&e.into()))
    }
}
