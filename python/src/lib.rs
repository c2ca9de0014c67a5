//! The native half of the Python package `mp_motion`: thin bindings of `mp-plan` and `mp-view`. Names that users see, defaults, units
//! and documentation are in the Python half, `python/mp_motion`.

mod callback;
mod error;
mod interrupt;
mod leaving;
mod many;
mod own;
mod render;
mod report;
mod results;
mod roadmap;
mod scene;
mod tables;

/// The native module.
#[pyo3::pymodule]
mod _mp {
    #[pymodule_export]
    use crate::interrupt::{Cancel, panic};
    #[pymodule_export]
    use crate::many::{Many, panics};
    #[pymodule_export]
    use crate::results::Results;
    #[pymodule_export]
    use crate::roadmap::Roadmap;
    #[pymodule_export]
    use crate::scene::{Scene, mesh_off, read_mesh};
    #[pymodule_export]
    use crate::tables::{default_request, meta_planners, metrics, planners, shipped};
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::leaving::register(module)
    }
}
