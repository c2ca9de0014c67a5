//! Medians of runs some of which did not end in time.
//!
//! All runs of a group have the same cap, so what is known of a run that was cut short is that it takes longer
//! than all others: the Kaplan–Meier median is the ordinary one, with such runs counted as infinite.

/// A median with a confidence interval. Infinite where the cap hides it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Median {
    pub(crate) median: f64,
    /// The interval by order statistics that holds the true median with at least 95%, or as nearly as so few
    /// runs allow.
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Median {
    /// Of values, infinite for those that were cut short. `None` of nothing.
    pub(crate) fn of(values: &[f64]) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len();
        if n == 0 {
            return None;
        }
        let median = match n.is_multiple_of(2) {
            true => 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]),
            false => sorted[n / 2],
        };
        let k = outside(n);
        Some(Self { median, low: sorted[k], high: sorted[n - 1 - k] })
    }

    /// As a cell of a table, in units of `unit`; `cap` stands for what is beyond it.
    pub(crate) fn cell(&self, cap: &str, show: impl Fn(f64) -> String) -> String {
        let show = |v: f64| if v.is_finite() { show(v) } else { cap.to_owned() };
        format!("{} ({} – {})", show(self.median), show(self.low), show(self.high))
    }
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
    // k values are below with at most 2.5%, so the k-th from the end, counted from 1, is the limit.
    k.saturating_sub(1)
}

/// `a / b` of two medians, with what the cap leaves of it.
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
        assert_eq!(Median::of(&values), Some(Median { median: 5.5, low: 2.0, high: 9.0 }));
        assert_eq!([5, 6, 8, 9, 12, 20].map(outside), [0, 0, 0, 1, 2, 5]);
        assert_eq!(Median::of(&[]), None);
    }

    #[test]
    fn what_was_cut_short_is_beyond_all_others() {
        let inf = f64::INFINITY;
        let some = Median::of(&[1.0, 2.0, 3.0, inf, inf]).unwrap();
        assert_eq!((some.median, some.high), (3.0, inf));
        let most = Median::of(&[1.0, inf, inf]).unwrap();
        assert_eq!(most.median, inf);
        assert_eq!(some.cell("> 6", |v| v.to_string()), "3 (1 – > 6)");
        assert_eq!(ratio(&most, &some, 6.0), "> 2.00");
        assert_eq!(ratio(&some, &some, 6.0), "1.00");
        assert_eq!(ratio(&most, &most, 6.0), "–");
    }
}
