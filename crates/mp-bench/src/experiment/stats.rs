//! Statistics of runs, some of which did not end in time.
//!
//! All runs of a group have the same cap, so a run that was cut short would have taken longer
//! than all others: the Kaplan–Meier median is the ordinary median, with such runs counted as infinite.

/// A median with a confidence interval; each is infinite when it is beyond the cap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Median {
    pub(crate) median: f64,
    /// The interval by order statistics that holds the true median with at least 95%, or as nearly as so few
    /// runs allow.
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Median {
    /// The median of values, which are infinite for runs that were cut short. `None` without values.
    pub(crate) fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len();
        if n == 0 {
            return None;
        }
        let k = outside(n);
        let median = 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
        Some(Self { median, low: sorted[k], high: sorted[n - 1 - k] })
    }

    /// The text of a table cell, with numbers formatted by `show` and `cap` in place of infinite ones.
    pub(crate) fn cell(&self, cap: &str, show: impl Fn(f64) -> String) -> String {
        let show = |v: f64| if v.is_finite() { show(v) } else { cap.to_owned() };
        format!("{} ({} – {})", show(self.median), show(self.low), show(self.high))
    }
}

/// The mean; `None` without values.
pub(crate) fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (sum, n) = values.into_iter().fold((0.0, 0), |(sum, n), v| (sum + v, n + 1));
    (n > 0).then(|| sum / f64::from(n))
}

/// The geometric mean; `None` without values.
pub(crate) fn geometric_mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    mean(values.into_iter().map(f64::ln)).map(f64::exp)
}

/// The 95% confidence interval of a probability, after `k` successes in `n` trials (Wilson 1927, *Probable inference,
/// the law of succession, and statistical inference*).
pub(crate) fn wilson(k: usize, n: usize) -> (f64, f64) {
    const Z: f64 = 1.959_964;
    let (n, p) = (n as f64, k as f64 / n as f64);
    let middle = (p + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
    let half = Z / (1.0 + Z * Z / n) * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    ((middle - half).max(0.0), (middle + half).min(1.0))
}

/// The number with about three digits, for a table cell.
pub(crate) fn short(v: f64) -> String {
    match v {
        v if v >= 100.0 => format!("{v:.0}"),
        v if v >= 1.0 => format!("{v:.2}"),
        v => format!("{v:.4}"),
    }
}

/// A time in seconds with three digits, at most to the microsecond, for a table cell.
pub(crate) fn seconds(v: f64) -> String {
    let digits = (2 - v.max(1e-9).log10().floor() as i32).clamp(0, 6) as usize;
    format!("{v:.digits$}")
}

/// How many of `n` sorted values to leave out on either side, so that those left hold the median with
/// 95%: the largest k with P(Bin(n, ½) < k) ≤ 2.5%, zero if there is none.
fn outside(n: usize) -> usize {
    let (mut term, mut sum, mut k) = (0.5_f64.powi(n as i32), 0.0, 0);
    while k < n / 2 {
        sum += term;
        if sum > 0.025 {
            break;
        }
        k += 1;
        term *= (n - k + 1) as f64 / k as f64;
    }
    // Fewer than k values are below the median with a probability of at most 2.5%: the k-th from each end, counted
    // from 1, is the limit.
    k.saturating_sub(1)
}

/// The ratio `a / b` of two medians, or its bound when one of them is beyond the cap.
pub(crate) fn ratio(a: &Median, b: &Median, cap: f64) -> String {
    match (a.median.is_finite(), b.median.is_finite()) {
        (true, true) => format!("{:.2}", a.median / b.median),
        (false, true) => format!("> {:.2}", cap / b.median),
        (true, false) => format!("< {:.2}", a.median / cap),
        (false, false) => "–".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of ten values the second and the ninth hold the median with 97.9% (Conover, table A3).
    #[test]
    fn intervals_are_the_tabulated_ones() {
        let values: Vec<f64> = (1..=10).map(f64::from).collect();
        assert_eq!(Median::of(values), Some(Median { median: 5.5, low: 2.0, high: 9.0 }));
        assert_eq!([5, 6, 8, 9, 12, 20].map(outside), [0, 0, 0, 1, 2, 5]);
        assert_eq!(Median::of([]), None);
    }

    /// 81 of 263 (Newcombe 1998, table I).
    #[test]
    fn intervals_of_shares_are_the_tabulated_ones() {
        let (low, high) = wilson(81, 263);
        assert!((low - 0.2553).abs() < 5e-5 && (high - 0.3662).abs() < 5e-5, "{low} {high}");
        assert_eq!(wilson(0, 20).0, 0.0);
        assert_eq!(wilson(20, 20).1, 1.0);
    }

    #[test]
    fn means_and_cells() {
        assert_eq!((mean([1.0, 3.0]), mean([])), (Some(2.0), None));
        assert!((geometric_mean([1.0, 4.0]).unwrap() - 2.0).abs() < 1e-15);
        assert_eq!(geometric_mean([]), None);
        assert_eq!([123.4, 1.234, 0.01234].map(short), ["123", "1.23", "0.0123"]);
        assert_eq!([123.4, 1.234, 0.01234].map(seconds), ["123", "1.23", "0.0123"]);
    }

    #[test]
    fn what_was_cut_short_is_beyond_all_others() {
        let inf = f64::INFINITY;
        let some = Median::of([1.0, 2.0, 3.0, inf, inf]).unwrap();
        assert_eq!((some.median, some.high), (3.0, inf));
        let most = Median::of([1.0, inf, inf]).unwrap();
        assert_eq!(most.median, inf);
        assert_eq!(some.cell("> 6", |v| v.to_string()), "3 (1 – > 6)");
        assert_eq!(ratio(&most, &some, 6.0), "> 2.00");
        assert_eq!(ratio(&some, &some, 6.0), "1.00");
        assert_eq!(ratio(&most, &most, 6.0), "–");
    }
}
