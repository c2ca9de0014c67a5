//! Angles without limits in rows of numbers.

use crate::Description;
use mp_cspace::angle::angle_difference;
use std::f64::consts::TAU;

/// Which numbers of a configuration are angles without limits, that is, the same after a full turn.
pub fn turning<K: Description + ?Sized>(kind: &K) -> Vec<bool> {
    let limits = kind.limits();
    let turns = |(i, column): (usize, crate::Column)| {
        column.unit == "rad" && limits.get(i).is_some_and(Option::is_none)
    };
    kind.columns().into_iter().enumerate().map(turns).collect()
}

/// Rows of a path, in which numbers that are the same after a full turn, as `turning` says, go on from row to row by the shorter
/// way and begin as in `given`: they may leave (-π, π], and never jump.
pub fn continued(turning: &[bool], given: &[f64], mut rows: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    // The row before: as the space has it, and as it is written.
    let (mut own, mut written) = (given.to_vec(), given.to_vec());
    for row in &mut rows {
        let next = row.clone();
        for (i, x) in row.iter_mut().enumerate().filter(|(i, _)| turning.get(*i) == Some(&true)) {
            let (Some(own), Some(written)) = (own.get(i), written.get(i)) else { continue };
            let by = angle_difference(*own, *x);
            let turns = ((written + by - *x) / TAU).round();
            // Whole turns are added to the number itself, so that rounding does not add up.
            if by.abs() <= 1e-12 {
                *x = *written;
            } else if turns != 0.0 {
                *x += turns * TAU;
            }
        }
        (own, written) = (next, row.clone());
    }
    rows
}
