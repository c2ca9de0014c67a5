//! Parameters within their range.

use mp_cspace::ParameterError;

/// `value` when it is positive and finite.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64, ParameterError> {
    within(name, value, f64::MIN_POSITIVE, f64::MAX, "positive and finite")
}

/// `value` when it is finite and not negative.
pub(crate) fn not_negative(name: &'static str, value: f64) -> Result<f64, ParameterError> {
    within(name, value, 0.0, f64::MAX, "finite and not negative")
}

/// `value` when it is from `least` to `most`.
pub(crate) fn within(
    name: &'static str,
    value: f64,
    least: f64,
    most: f64,
    expected: &'static str,
) -> Result<f64, ParameterError> {
    if (least..=most).contains(&value) { Ok(value) } else { Err(ParameterError { name, expected, value }) }
}
