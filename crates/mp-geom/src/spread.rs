//! Evenly spaced places along a path, for pictures of a robot that moves along it.

/// Places spread evenly along edges of these lengths, about `spacing` apart, 11 to 69 of them: the index of
/// an edge and a fraction of it. No places on a path of no length.
#[must_use]
pub fn evenly(lengths: &[f64], spacing: f64) -> Vec<(usize, f64)> {
    let mut at = vec![0.0];
    for length in lengths {
        at.push(at[at.len() - 1] + length);
    }
    let total = at[at.len() - 1];
    if lengths.is_empty() || total.is_nan() || total <= 0.0 {
        return Vec::new();
    }
    let n = (total / spacing.max(1e-9)).clamp(12.0, 70.0) as usize;
    let mut segment = 0;
    let place = |i: usize| {
        let s = total * i as f64 / n as f64;
        while segment + 2 < at.len() && at[segment + 1] < s {
            segment += 1;
        }
        let length = at[segment + 1] - at[segment];
        let t = if length > 0.0 { ((s - at[segment]) / length).clamp(0.0, 1.0) } else { 0.0 };
        (segment, t)
    };
    (1..n).map(place).collect()
}
