//! Verification of finished paths.

use super::Path;
use crate::{MotionCheck, MotionValidity, Space, trace};
use std::fmt;

/// The first thing found wrong with a path.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PathFault {
    /// It has no state.
    Empty,
    /// A state is out of the bounds of the space, or not finite.
    OutOfBounds {
        /// Its index.
        state: usize,
    },
    /// The motion along an edge was not found free.
    Motion {
        /// The index of the edge, that of the state it starts from.
        edge: usize,
        /// What was found.
        check: MotionCheck,
    },
}

impl fmt::Display for PathFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |at: f64| 100.0 * at;
        match *self {
            Self::Empty => write!(f, "the path has no state"),
            Self::OutOfBounds { state } => write!(f, "state {state} is out of bounds"),
            Self::Motion { edge, check: MotionCheck::Collision { at } } => {
                write!(f, "edge {edge} collides at {:.1}% of its length", percent(at))
            }
            Self::Motion { edge, check: MotionCheck::Unproven { at } } => {
                write!(f, "edge {edge} is too near contact at {:.1}% of its length", percent(at))
            }
            Self::Motion { edge, check: MotionCheck::Free { .. } } => write!(f, "edge {edge} is free"),
        }
    }
}

/// What the verification of a path found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathReport {
    /// Edges that the path has, whether or not they were reached before a fault.
    pub edges: usize,
    /// Length in the metric of the space.
    pub length: f64,
    /// Lower bound (m) on the clearance along all edges; zero when there is a fault or the check
    /// gives no clearance.
    pub clearance: f64,
    /// The first fault, `None` when the path is free.
    pub fault: Option<PathFault>,
}

impl PathReport {
    /// Whether nothing was found wrong.
    #[must_use]
    pub fn is_free(&self) -> bool {
        self.fault.is_none()
    }
}

/// Verifies a path state by state and edge by edge with `check`, which should share no code with
/// the check the planner used.
///
/// A path of one state is checked as a motion from that state to itself.
pub fn verify_path<C: Space>(
    space: &C,
    path: &Path<C::State>,
    check: &mut impl MotionValidity<C::State>,
) -> PathReport {
    let (edges, length) = (path.states.len().saturating_sub(1), path.length(space));
    let (clearance, fault) = match first_fault(space, &path.states, check) {
        Ok(clearance) => (clearance, None),
        Err(fault) => (0.0, Some(fault)),
    };
    let report = PathReport { edges, length, clearance, fault };
    trace::verified(&report);
    report
}

/// The least clearance over the edges, or the first fault.
fn first_fault<C: Space>(
    space: &C,
    states: &[C::State],
    check: &mut impl MotionValidity<C::State>,
) -> Result<f64, PathFault> {
    let Some(last) = states.last() else { return Err(PathFault::Empty) };
    if let Some(state) = states.iter().position(|q| !space.contains(q)) {
        return Err(PathFault::OutOfBounds { state });
    }
    let mut least = f64::INFINITY;
    let ends = states.iter().zip(states.iter().skip(1).chain([last]));
    // The pair of the last state with itself is checked only when there is no other pair.
    for (edge, (a, b)) in ends.take((states.len() - 1).max(1)).enumerate() {
        match check.check_motion(a, b) {
            MotionCheck::Free { clearance } => least = least.min(clearance),
            check => return Err(PathFault::Motion { edge, check }),
        }
    }
    Ok(least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FineDiscrete, Length, Rn};
    use nalgebra::Vector1;

    #[test]
    fn the_first_fault_is_named() {
        let space = Rn::<1>::new([0.0], [1.0]).unwrap();
        let valid = |q: &Vector1<f64>| (q.x - 0.5).abs() > 0.05;
        let mut check = FineDiscrete::new(&space, valid, Length::Absolute(0.01)).unwrap();
        let mut fault = |xs: &[f64]| {
            let path = Path::straight(xs.iter().map(|&x| Vector1::new(x)).collect());
            verify_path(&space, &path, &mut check).fault
        };
        assert_eq!(fault(&[]), Some(PathFault::Empty));
        assert_eq!(fault(&[0.1, 0.4, 0.2]), None);
        assert_eq!(fault(&[0.1]), None);
        assert!(matches!(fault(&[0.5]), Some(PathFault::Motion { edge: 0, .. })));
        assert_eq!(fault(&[0.1, 1.4, 0.2]), Some(PathFault::OutOfBounds { state: 1 }));
        assert_eq!(fault(&[0.1, f64::NAN]), Some(PathFault::OutOfBounds { state: 1 }));
        let Some(PathFault::Motion { edge: 1, check }) = fault(&[0.1, 0.3, 0.8, 0.1]) else {
            panic!("the second edge crosses the obstacle")
        };
        assert!((check.failed_at().unwrap() - 0.3).abs() < 0.03);
    }

    #[test]
    fn reports_read_well() {
        let fault = PathFault::Motion { edge: 3, check: MotionCheck::Collision { at: 0.25 } };
        assert_eq!(fault.to_string(), "edge 3 collides at 25.0% of its length");
    }
}
