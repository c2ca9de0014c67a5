//! Numbers as text for people, a hash of numbers, and how far apart numbers count as equal.

/// How far apart two states of a space of this extent may be and count as the same: a thousandth of a millimetre at most, however large the
/// space, of which speed times time is a part.
pub(crate) fn rounding(extent: f64) -> f64 {
    (1e-9 * extent).min(1e-6)
}

/// A number with about four digits: for lengths and the like, not for configurations, which people paste back ([`plain`]).
#[must_use]
pub fn brief(v: f64) -> String {
    let magnitude = v.abs();
    let text = if magnitude != 0.0 && !(1e-3..1e6).contains(&magnitude) {
        return format!("{v:.3e}");
    } else if magnitude >= 100.0 {
        format!("{v:.1}")
    } else {
        format!("{v:.3}")
    };
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

/// A lower bound above zero, brief: never more than it is.
#[must_use]
pub fn at_least(v: f64) -> String {
    let near = brief(v);
    if near.parse::<f64>().is_ok_and(|shown| shown <= v) {
        return near;
    }
    // It was rounded up: one of its last digit less.
    let digit = match near.split_once('e') {
        Some((_, exponent)) => mp_math::powi(10.0, exponent.parse().unwrap_or(0) - 3),
        None if v >= 100.0 => 0.1,
        None => 1e-3,
    };
    brief(v - 0.5 * digit)
}

/// Two numbers that are compared: brief, unless they would look the same.
pub fn told_apart(a: f64, b: f64) -> [String; 2] {
    let short = [a, b].map(brief);
    if short[0] != short[1] || a == b { short } else { [a, b].map(|v| v.to_string()) }
}

/// `1 triangle`, `2 triangles`.
#[must_use]
pub fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// The finite number above zero that an option of a command line gives.
///
/// # Errors
/// A message when it is not such a number.
pub fn positive_number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(v) if v.is_finite() && v > 0.0 => Ok(v),
        Ok(_) => Err("must be a finite number above zero".into()),
        Err(_) => Err("not a number".into()),
    }
}

/// A hash of the bits of numbers (XXH3), as saved roadmaps have it.
pub fn fingerprint(numbers: impl IntoIterator<Item = f64>) -> u64 {
    let mut hash = xxhash_rust::xxh3::Xxh3::new();
    numbers.into_iter().for_each(|x| hash.update(&x.to_le_bytes()));
    hash.digest()
}

/// A number as in scene files, which can be pasted back: at most nine decimals, fifteen of less than a thousandth, no trailing zeros, no
/// negative zero. From 10⁶ on it reads back to the same bits.
#[must_use]
pub fn plain(v: f64) -> String {
    match v.abs() {
        size if size >= 1e16 => format!("{v:e}"),
        size if size >= 1e6 => v.to_string(),
        // What rounding leaves of a zero.
        size if size < 1e-11 => "0".into(),
        size => (rounded(v, if size < 1e-3 { 15 } else { 9 }) + 0.0).to_string(),
    }
}

/// A number with so many decimals.
#[must_use]
pub fn rounded(v: f64, decimals: i32) -> f64 {
    let unit = mp_math::powi(10.0, decimals);
    (v * unit).round() / unit
}

/// Numbers that can be pasted back, separated by blanks.
pub fn plain_row(row: &[f64]) -> String {
    row.iter().map(|v| plain(*v)).collect::<Vec<_>>().join(" ")
}
