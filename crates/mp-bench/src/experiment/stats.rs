//! Statistics of runs, some of which did not end in time.
//!
//! All runs of a group have the same cap, so a run that was cut short would have taken longer
//! than all others: the Kaplan–Meier median is the ordinary median, with such runs counted as infinite.

use mp_cspace::Rng;
use rand::RngExt;

/// A median with a confidence interval; each is infinite when it is beyond the cap.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

/// The median of the ratios `a / b` of pairs, with its interval by order statistics. `None` stands for a run
/// that was cut short, so longer than the other: the ratio counts as infinite or as zero. Pairs of two such
/// runs say nothing and are left out. `None` without other pairs; with it the number of pairs used.
pub(crate) fn paired_ratio(
    pairs: impl IntoIterator<Item = (Option<f64>, Option<f64>)>,
) -> Option<(Median, usize)> {
    let ratio = |pair: (Option<f64>, Option<f64>)| match pair {
        (Some(a), Some(b)) => Some(a / b),
        (None, Some(_)) => Some(f64::INFINITY),
        (Some(_), None) => Some(0.0),
        (None, None) => None,
    };
    let ratios: Vec<f64> = pairs.into_iter().filter_map(ratio).collect();
    Some((Median::of(ratios.iter().copied())?, ratios.len()))
}

/// The share of runs that are still going on after a time: the Kaplan–Meier estimate, as the corners of its
/// steps. Each run is the time it took, and whether it ended then or was cut short.
pub(crate) fn survival(runs: impl IntoIterator<Item = (f64, bool)>) -> Vec<(f64, f64)> {
    let mut runs: Vec<(f64, bool)> = runs.into_iter().collect();
    // At the same time, runs that ended count before those that were cut short.
    runs.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
    let (mut share, mut steps) = (1.0, vec![(0.0, 1.0)]);
    for (i, &(time, ended)) in runs.iter().enumerate() {
        steps.push((time, share));
        if ended {
            share *= 1.0 - 1.0 / (runs.len() - i) as f64;
            steps.push((time, share));
        }
    }
    steps
}

/// The mean time of runs, each no longer than `cap`: the area under their [`survival`] up to there. Where
/// some runs were cut short it is a lower bound of the mean.
pub(crate) fn restricted_mean(runs: impl IntoIterator<Item = (f64, bool)>, cap: f64) -> f64 {
    let steps = survival(runs);
    let area = |w: &[(f64, f64)]| (w[1].0.min(cap) - w[0].0.min(cap)) * w[0].1;
    let last = steps[steps.len() - 1];
    steps.windows(2).map(area).sum::<f64>() + (cap - last.0).max(0.0) * last.1
}

/// Resamplings of a bootstrap interval.
const RESAMPLINGS: usize = 2_000;

/// The 95% interval of a statistic of `n` items by the percentile bootstrap (Efron 1979, *Bootstrap
/// methods*): `of` takes the numbers of the items drawn. It draws the same items in every run.
pub(crate) fn bootstrap(n: usize, of: impl Fn(&[usize]) -> f64) -> (f64, f64) {
    let mut rng = Rng::seed(1979);
    let mut drawn = vec![0; n];
    let mut values: Vec<f64> = (0..RESAMPLINGS)
        .map(|_| {
            drawn.iter_mut().for_each(|item| *item = rng.random_range(0..n));
            of(&drawn)
        })
        .collect();
    values.sort_by(f64::total_cmp);
    let outside = RESAMPLINGS / 40;
    (values[outside], values[RESAMPLINGS - 1 - outside])
}

/// The mean; `None` without values.
pub(crate) fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (sum, n) = values.into_iter().fold((0.0, 0), |(sum, n), v| (sum + v, n + 1));
    (n > 0).then(|| sum / f64::from(n))
}

/// The geometric mean; `None` without values.
pub(crate) fn geometric_mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    mean(values.into_iter().map(mp_math::ln)).map(mp_math::exp)
}

/// The 95% confidence interval of a probability, after `k` successes in `n` trials (Wilson 1927, *Probable
/// inference, the law of succession, and statistical inference*).
pub(crate) fn wilson(k: usize, n: usize) -> (f64, f64) {
    const Z: f64 = 1.959_964;
    let (n, p) = (n as f64, k as f64 / n as f64);
    let middle = (p + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
    let half = Z / (1.0 + Z * Z / n) * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    ((middle - half).max(0.0), (middle + half).min(1.0))
}

/// The 95% [interval](wilson) of a probability in percent, for a table cell.
pub(crate) fn wilson_percent(k: usize, n: usize) -> String {
    let (low, high) = wilson(k, n);
    format!("{:.0}–{:.0}%", 100.0 * low, 100.0 * high)
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
    let digits = (2 - mp_math::log10(v.max(1e-9)).floor() as i32).clamp(0, 6) as usize;
    format!("{v:.digits$}")
}

/// How many of `n` sorted values to leave out on either side, so that those left hold the median with
/// 95%: the largest k with P(Bin(n, ½) < k) ≤ 2.5%, zero if there is none.
fn outside(n: usize) -> usize {
    // By logarithms: of more than a thousand values the first terms are less than any number.
    let (mut term, mut sum, mut k) = (-mp_math::ln(2.0) * n as f64, 0.0, 0);
    while k < n / 2 {
        sum += mp_math::exp(term);
        if sum > 0.025 {
            break;
        }
        k += 1;
        term += mp_math::ln((n - k + 1) as f64 / k as f64);
    }
    // Fewer than k values are below the median with a probability of at most 2.5%: the k-th from each end,
    // counted from 1, is the limit.
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
        // By the exact integers.
        assert_eq!([100, 1000, 1075, 2000].map(outside), [39, 468, 504, 955]);
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

    /// Remission times of 6-MP (Freireich 1963), as in Kaplan–Meier tables of textbooks: 0.8571 after 6
    /// weeks, 0.8067 after 7, 0.7529 after 10, 0.6902 after 13, 0.6275 after 16, 0.5378 after 22, 0.4482
    /// after 23.
    #[test]
    fn survival_is_the_tabulated_one() {
        let ended = [6, 6, 6, 7, 10, 13, 16, 22, 23].map(|t| (f64::from(t), true));
        let cut = [6, 9, 10, 11, 17, 19, 20, 25, 32, 32, 34, 35].map(|t| (f64::from(t), false));
        let steps = survival(ended.into_iter().chain(cut));
        let after = |t: f64| steps.iter().rev().find(|s| s.0 <= t).unwrap().1;
        for (t, share) in [
            (6.0, 0.8571),
            (7.0, 0.8067),
            (10.0, 0.7529),
            (13.0, 0.6902),
            (16.0, 0.6275),
            (22.0, 0.5378),
            (23.0, 0.4482),
        ] {
            assert!((after(t) - share).abs() < 5e-5, "{t}: {}", after(t));
        }
        // All end, or are cut at the cap: the mean of what they took.
        assert!((restricted_mean([(1.0, true), (2.0, true), (6.0, true)], 6.0) - 3.0).abs() < 1e-12);
        assert!((restricted_mean([(1.0, true), (5.0, false), (5.0, false)], 5.0) - 11.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn pairs_and_bootstrap() {
        let some = Some;
        let pairs = [
            (some(4.0), some(2.0)),
            (None, some(1.0)),
            (some(1.0), None),
            (None, None),
            (some(9.0), some(3.0)),
        ];
        let (median, used) = paired_ratio(pairs).unwrap();
        assert_eq!((median.median, median.low, median.high, used), (2.5, 0.0, f64::INFINITY, 4));
        assert!(paired_ratio([(None, None)]).is_none());
        // The mean of 0..100 has a standard error of 2.887: the interval is about 49.5 ± 5.66.
        let mean_of = |drawn: &[usize]| drawn.iter().sum::<usize>() as f64 / drawn.len() as f64;
        let (low, high) = bootstrap(100, mean_of);
        assert!((low - 43.84).abs() < 0.7 && (high - 55.16).abs() < 0.7, "{low} {high}");
        assert_eq!((low, high), bootstrap(100, mean_of));
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
