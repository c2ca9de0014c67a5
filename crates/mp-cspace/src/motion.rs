//! Motion checks: sampled at a resolution, certified by clearance, and a plain one to verify with.

mod certified;
mod discrete;
mod fine;

pub use certified::Certified;
pub use discrete::Discrete;
pub use fine::FineDiscrete;

use crate::{ParameterError, Space};

/// How far apart the tested states of a sampled motion check may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// A distance in the metric of the space.
    Length(f64),
    /// A fraction of the extent of the space; 0.01 is customary.
    Fraction(f64),
}

impl Resolution {
    /// The resolution as a distance in `space`.
    ///
    /// # Errors
    /// When it is not positive and finite, or below 10⁻⁹ of the extent.
    pub fn length_in<C: Space>(self, space: &C) -> Result<f64, ParameterError> {
        let length = match self {
            Self::Length(length) => ParameterError::positive("the resolution", length)?,
            Self::Fraction(f) => space.extent() * ParameterError::positive("the resolution", f)?,
        };
        if length >= 1e-9 * space.extent() && length.is_finite() {
            Ok(length)
        } else {
            let expected = "at least 1e-9 of the extent of the space";
            Err(ParameterError { name: "the resolution", expected, value: length })
        }
    }
}
