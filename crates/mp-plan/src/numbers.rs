//! Numbers as text for people, and a hash of numbers.

/// A number with about four digits.
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
pub(crate) fn fingerprint(numbers: impl IntoIterator<Item = f64>) -> u64 {
    let mut hash = xxhash_rust::xxh3::Xxh3::new();
    numbers.into_iter().for_each(|x| hash.update(&x.to_le_bytes()));
    hash.digest()
}

/// A number as in scene files: at most nine decimals, no trailing zeros, no negative zero.
#[must_use]
pub fn plain(v: f64) -> String {
    ((v * 1e9).round() / 1e9 + 0.0).to_string()
}
