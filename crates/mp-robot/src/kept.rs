//! A clearance to keep from obstacles.

/// The clearance that is kept where `kept` (m) is asked for: none below zero, and an infinite one where it is not a number.
pub(crate) fn asked(kept: f64) -> f64 {
    if kept.is_nan() { f64::INFINITY } else { kept.max(0.0) }
}

/// The clearance beyond `kept` (m), of one that is exact below the limit that `clearance` is asked with. Where that is at least its limit,
/// so is this at least `enough`, whatever rounding does.
#[inline]
pub(crate) fn beyond(kept: f64, enough: f64, clearance: impl FnOnce(f64) -> f64) -> f64 {
    let limit = enough + kept;
    let found = clearance(limit);
    let beyond = found - kept;
    if found >= limit { beyond.max(enough) } else { beyond }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_enough_stays_enough(kept in 0.0..10.0_f64, enough in 1e-9..10.0_f64, more in 0.0..1.0_f64) {
            prop_assert!(beyond(kept, enough, |limit| limit + more) >= enough);
            let less = 0.5 * (kept + enough);
            prop_assert_eq!(beyond(kept, enough, |limit| less.min(limit)), less - kept);
            prop_assert_eq!(beyond(0.0, enough, |limit| limit * more), enough * more);
        }
    }
}
