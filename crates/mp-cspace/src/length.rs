//! Lengths in the metric of a space, in its unit or as parts of its extent.

use crate::{BuildError, ParameterError, Space};
use std::fmt;
use std::str::FromStr;

/// A length in the metric of a space: how far one step goes, how far apart states are tested. As text, `0.5`
/// or `20%`.
///
/// ```
/// use mp_cspace::{Length, Rn};
/// let space = Rn::<2>::new([0.0; 2], [3.0, 4.0])?;
/// assert_eq!("20%".parse::<Length>()?, Length::Fraction(0.2));
/// assert_eq!(Length::Fraction(0.2).step_in(&space)?, 1.0);
/// assert_eq!(Length::Absolute(0.5).to_string(), "0.5");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// In the unit of the metric.
    Absolute(f64),
    /// A part of the extent of the space; 1 is the whole extent.
    Fraction(f64),
}

impl Length {
    /// A step of this length in `space`.
    ///
    /// # Errors
    /// When it is not positive, not finite, or longer than the extent of the space.
    pub fn step_in<C: Space>(self, space: &C) -> Result<f64, BuildError> {
        let extent = space.extent();
        let (value, most, length) = match self {
            Self::Absolute(length) => (length, extent, length),
            Self::Fraction(fraction) => (fraction, 1.0, fraction * extent),
        };
        if value > 0.0 && value <= most && length > 0.0 && length.is_finite() {
            return Ok(length);
        }
        let unit = match self {
            Self::Absolute(_) => "the extent of the space",
            Self::Fraction(_) => "as a fraction of the extent of the space",
        };
        Err(BuildError::OutOfRange { name: "step", value, range: format!("in (0, {most}], {unit}") })
    }

    /// The resolution of a sampled motion check: how far apart the states are that it tests in `space`. 1% of
    /// the extent is customary.
    ///
    /// # Errors
    /// When it is not positive and finite, or below 10⁻⁹ of the extent.
    pub fn resolution_in<C: Space>(self, space: &C) -> Result<f64, ParameterError> {
        let length = match self {
            Self::Absolute(length) => ParameterError::positive("the resolution", length)?,
            Self::Fraction(f) => space.extent() * ParameterError::positive("the resolution", f)?,
        };
        if length >= 1e-9 * space.extent() && length.is_finite() {
            Ok(length)
        } else {
            let expected = "at least 1e-9 of the extent of the space";
            Err(ParameterError { name: "the resolution", expected, value: length })
        }
    }

    /// The length in `space`, whatever it is.
    #[must_use]
    pub fn in_space<C: Space>(self, space: &C) -> f64 {
        match self {
            Self::Absolute(length) => length,
            Self::Fraction(part) => part * space.extent(),
        }
    }
}

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Absolute(length) => write!(f, "{length}"),
            Self::Fraction(fraction) => write!(f, "{}%", 100.0 * fraction),
        }
    }
}

/// Why a text is no [`Length`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LengthError {
    /// The text is not a number.
    #[error("not a number")]
    NoNumber,
    /// The number is not finite, or not above zero.
    #[error("must be a finite number above zero")]
    NotPositive,
    /// It is longer than the space.
    #[error("more than 100% of the extent")]
    BeyondExtent,
}

impl FromStr for Length {
    type Err = LengthError;
    fn from_str(text: &str) -> Result<Self, LengthError> {
        match text.strip_suffix('%') {
            Some(percent) => match positive(percent)? / 100.0 {
                // The least numbers have no hundredth.
                0.0 => Err(LengthError::NotPositive),
                part if part <= 1.0 => Ok(Self::Fraction(part)),
                _ => Err(LengthError::BeyondExtent),
            },
            None => positive(text).map(Self::Absolute),
        }
    }
}

fn positive(text: &str) -> Result<f64, LengthError> {
    match text.trim().parse::<f64>() {
        Ok(v) if v.is_finite() && v > 0.0 => Ok(v),
        Ok(_) => Err(LengthError::NotPositive),
        Err(_) => Err(LengthError::NoNumber),
    }
}
