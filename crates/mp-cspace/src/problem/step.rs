//! How far one step goes.

use super::BuildError;
use crate::Space;

/// How far one step goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// A distance in the metric of the space.
    Length(f64),
    /// A fraction of the extent of the space.
    Fraction(f64),
}

impl Step {
    /// The step as a distance in `space`.
    ///
    /// # Errors
    /// When it is not positive, not finite, or longer than the extent of the space.
    pub fn length_in<C: Space>(self, space: &C) -> Result<f64, BuildError> {
        let extent = space.extent();
        let (value, most, length) = match self {
            Self::Length(length) => (length, extent, length),
            Self::Fraction(fraction) => (fraction, 1.0, fraction * extent),
        };
        if value > 0.0 && value <= most && length > 0.0 && length.is_finite() {
            return Ok(length);
        }
        let unit = match self {
            Self::Length(_) => "the extent of the space",
            Self::Fraction(_) => "as a fraction of the extent of the space",
        };
        Err(BuildError::OutOfRange { name: "step", value, range: format!("in (0, {most}], {unit}") })
    }
}
