//! The check of configurations and motions by functions of Python.

use super::Numbers;
use crate::callback::Callback;
use mp_cspace::Configuration;
use mp_cspace::{Clearance, MotionClearance, Validity};
use mp_plan::Queries;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// At most this number of configurations are given to one call of `valid_many`.
const BATCH: usize = 64;

/// What is known of a robot.
#[derive(Debug)]
pub(super) enum Functions {
    /// Whether one configuration is free.
    One(Callback),
    /// Which of many are free.
    Many(Callback),
    /// The clearance (m), and how far (m) a motion moves any point.
    Clearance { clearance: Callback, displacement: Callback },
}

/// Which configurations were found free and which not, by their bits.
type Memory = Mutex<HashMap<Box<[u64]>, bool>>;

/// The check. Clones share the functions, and the memory.
#[derive(Clone, Debug)]
pub(crate) struct Check {
    functions: Arc<Functions>,
    numbers: Arc<Numbers>,
    queries: u64,
    memory: Option<Arc<Memory>>,
}

/// Configurations as arguments, one array of shape (columns,) each.
fn arguments<'py>(
    py: Python<'py>,
    numbers: &Numbers,
    states: &[&Configuration],
) -> PyResult<Bound<'py, PyTuple>> {
    PyTuple::new(py, states.iter().map(|q| PyArray1::from_vec(py, numbers.row(q))))
}

/// Configurations as one argument, of shape (configurations, columns).
fn batch<'py>(py: Python<'py>, numbers: &Numbers, states: &[Configuration]) -> PyResult<Bound<'py, PyTuple>> {
    let rows: Vec<f64> = states.iter().flat_map(|q| numbers.row(q)).collect();
    let array: Bound<'py, PyArray2<f64>> =
        PyArray1::from_vec(py, rows).reshape([states.len(), numbers.low.len()])?;
    PyTuple::new(py, [array])
}

/// A number that `function`, called `name`, gives for some configurations: not negative, maybe infinite where it is a clearance.
pub(super) fn number(
    function: &Callback,
    numbers: &Numbers,
    name: &'static str,
    states: &[&Configuration],
) -> Option<f64> {
    function.call(
        |py| arguments(py, numbers, states),
        |result| {
            let value: f64 = result.extract().map_err(|_| wrong(name, "a number", result))?;
            match name {
                "clearance" if !value.is_nan() => Ok(value),
                "distance" | "displacement" if value >= 0.0 && value.is_finite() => Ok(value),
                "clearance" => Err(PyValueError::new_err("clearance(…) has returned nan")),
                _ => Err(PyValueError::new_err(format!(
                    "{name}(…) has returned {value}: it must be finite and not negative"
                ))),
            }
        },
    )
}

/// Whether `function`, called `name`, finds a configuration free; not when it fails.
pub(super) fn is_free(function: &Callback, numbers: &Numbers, name: &'static str, q: &Configuration) -> bool {
    let read = |result: &Bound<'_, PyAny>| {
        result.extract::<bool>().map_err(|_| wrong(name, "True or False", result))
    };
    function.call(|py| arguments(py, numbers, &[q]), read).unwrap_or(false)
}

fn wrong(name: &str, expected: &str, result: &Bound<'_, PyAny>) -> PyErr {
    let found =
        result.get_type().name().map_or_else(|_| "something else".to_owned(), |name| name.to_string());
    PyTypeError::new_err(format!("{name}(…) must return {expected}, and has returned a {found}"))
}

impl Check {
    pub(super) fn new(functions: Functions, numbers: Arc<Numbers>) -> Self {
        Self { functions: Arc::new(functions), numbers, queries: 0, memory: None }
    }

    /// The same check, which remembers its answers about configurations, as long as a clone of it lives.
    pub(super) fn remembering(&self) -> Self {
        Self { memory: Some(Arc::default()), ..self.clone() }
    }

    pub(super) fn functions(&self) -> &Functions {
        &self.functions
    }

    pub(super) fn knows_clearance(&self) -> bool {
        matches!(*self.functions, Functions::Clearance { .. })
    }

    /// The index of the first of many configurations that is not free; the first of all when the function fails.
    fn first_of_many(&self, function: &Callback, states: &[Configuration]) -> Option<usize> {
        let read = |result: &Bound<'_, PyAny>| {
            let expected = "an array of truth values";
            let free: PyReadonlyArray1<'_, bool> =
                result.extract().map_err(|_| wrong("valid_many", expected, result))?;
            let free = free.as_array();
            match free.len() == states.len() {
                true => Ok(free.iter().position(|free| !free)),
                false => Err(PyValueError::new_err(format!(
                    "valid_many(…) has returned {} truth values for {} configurations",
                    free.len(),
                    states.len()
                ))),
            }
        };
        function.call(|py| batch(py, &self.numbers, states), read).unwrap_or(Some(0))
    }

    /// What is remembered of a configuration.
    fn known(&self, q: &Configuration) -> Option<bool> {
        let memory = self.memory.as_ref()?;
        memory.lock().unwrap_or_else(PoisonError::into_inner).get(&bits(q)).copied()
    }

    fn remember(&self, q: &Configuration, free: bool) {
        if let Some(memory) = &self.memory {
            memory.lock().unwrap_or_else(PoisonError::into_inner).insert(bits(q), free);
        }
    }

    fn ask(&mut self, q: &Configuration) -> bool {
        self.queries += 1;
        match &*self.functions {
            Functions::One(valid) => is_free(valid, &self.numbers, "valid", q),
            Functions::Many(valid) => self.first_of_many(valid, std::slice::from_ref(q)).is_none(),
            Functions::Clearance { clearance, .. } => {
                number(clearance, &self.numbers, "clearance", &[q]).unwrap_or(0.0) > 0.0
            }
        }
    }

    /// The index of the first state that is not free. What is remembered is not asked.
    fn first_of_new(&mut self, valid: &Callback, states: &[Configuration]) -> Option<usize> {
        let known: Vec<_> = states.iter().map(|q| self.known(q)).collect();
        let hit = known.iter().position(|known| *known == Some(false));
        let before = &known[..hit.unwrap_or(known.len())];
        let (new, asked): (Vec<_>, Vec<_>) =
            (0..before.len()).filter(|i| before[*i].is_none()).map(|i| (i, states[i].clone())).unzip();
        if asked.is_empty() {
            return hit;
        }
        self.queries += asked.len() as u64;
        let found = self.first_of_many(valid, &asked);
        // Of those behind the first one that is not free nothing is said.
        asked[..found.unwrap_or(asked.len())].iter().for_each(|q| self.remember(q, true));
        match found {
            None => hit,
            Some(found) => {
                self.remember(&asked[found], false);
                Some(new[found])
            }
        }
    }
}

/// A configuration by its bits.
fn bits(q: &Configuration) -> Box<[u64]> {
    q.iter().map(|x| x.to_bits()).collect()
}

impl Validity<Configuration> for Check {
    fn is_valid(&mut self, q: &Configuration) -> bool {
        self.known(q).unwrap_or_else(|| {
            let free = self.ask(q);
            self.remember(q, free);
            free
        })
    }
    fn first_invalid(&mut self, states: &[Configuration]) -> Option<usize> {
        match &*Arc::clone(&self.functions) {
            Functions::Many(valid) => self.first_of_new(valid, states),
            _ => states.iter().position(|q| !self.is_valid(q)),
        }
    }
    fn batch_size(&self) -> usize {
        if matches!(*self.functions, Functions::Many(_)) { BATCH } else { 1 }
    }
}

impl Clearance<Configuration> for Check {
    fn clearance(&mut self, q: &Configuration, _: f64) -> f64 {
        let Functions::Clearance { clearance, .. } = &*self.functions else { return 0.0 };
        self.queries += 1;
        number(clearance, &self.numbers, "clearance", &[q]).unwrap_or(0.0)
    }
}

impl MotionClearance<Configuration> for Check {
    fn motion_bound(&self, from: &Configuration, to: &Configuration) -> f64 {
        let Functions::Clearance { displacement, .. } = &*self.functions else { return 0.0 };
        number(displacement, &self.numbers, "displacement", &[from, to]).unwrap_or(f64::INFINITY)
    }
}

impl Queries for Check {
    fn queries(&self) -> u64 {
        self.queries
    }
}
