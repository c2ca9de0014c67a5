//! Errors in the parameters of spaces, samplers, motion checks and path smoothers.

use thiserror::Error;

/// Why a space or a metric could not be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SpaceError {
    /// A bound is NaN or infinite, or the bounds are so far apart that distances overflow.
    #[error("bounds of axis {axis} must be finite with a finite difference, found {low} to {high}")]
    NotFinite {
        /// The index of the axis, from 0.
        axis: usize,
        /// Its lower bound.
        low: f64,
        /// Its upper bound.
        high: f64,
    },
    /// A lower bound is not below its upper bound.
    #[error("axis {axis} is empty: its lower bound {low} must be below its upper bound {high}")]
    EmptyRange {
        /// The index of the axis, from 0.
        axis: usize,
        /// Its lower bound.
        low: f64,
        /// Its upper bound.
        high: f64,
    },
    /// A weight is not a positive finite number.
    #[error("{name} must be positive and finite, found {value}")]
    Weight {
        /// Which weight.
        name: &'static str,
        /// The weight that was given.
        value: f64,
    },
    /// Two things that must have the same number of entries do not.
    #[error("expected {expected} {what}, found {found}")]
    Count {
        /// What is counted.
        what: &'static str,
        /// How many are needed.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A space has no dimension, or a robot no points.
    #[error("{what} must not be empty")]
    Empty {
        /// What is empty.
        what: &'static str,
    },
}

/// A parameter outside its range.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{name} must be {expected}, found {value}")]
pub struct ParameterError {
    /// The name of the parameter.
    pub name: &'static str,
    /// What it must be.
    pub expected: &'static str,
    /// What it was.
    pub value: f64,
}

impl ParameterError {
    /// `value` when it is positive and finite.
    ///
    /// # Errors
    /// Otherwise.
    pub fn positive(name: &'static str, value: f64) -> Result<f64, Self> {
        if value > 0.0 && value.is_finite() {
            Ok(value)
        } else {
            Err(Self { name, expected: "positive and finite", value })
        }
    }
}

/// `value` when it is positive and finite.
pub(crate) fn weight(name: &'static str, value: f64) -> Result<f64, SpaceError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(SpaceError::Weight { name, value }) }
}

/// Checks the bounds of every axis and returns the length of the box's diagonal.
pub(crate) fn diagonal(low: &[f64], high: &[f64]) -> Result<f64, SpaceError> {
    if low.len() != high.len() {
        return Err(SpaceError::Count { what: "upper bounds", expected: low.len(), found: high.len() });
    }
    if low.is_empty() {
        return Err(SpaceError::Empty { what: "the list of axes" });
    }
    let mut sum = 0.0;
    for (axis, (&low, &high)) in low.iter().zip(high).enumerate() {
        let size = high - low;
        // Below 1e150 the square does not overflow; NaN fails the comparison too.
        if !(low.is_finite() && high.is_finite() && size.abs() < 1e150) {
            return Err(SpaceError::NotFinite { axis, low, high });
        }
        if size <= 0.0 {
            return Err(SpaceError::EmptyRange { axis, low, high });
        }
        sum += size * size;
    }
    Ok(sum.sqrt())
}
