//! The least clearance along a path, to a given accuracy.

use super::Path;
use crate::{ClearanceSearch, LeastClearance, MotionClearance, Space};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Where a path has the least clearance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tightest {
    /// A lower bound (m) on the clearance all along the path.
    pub clearance: f64,
    /// The clearance (m) actually found at `at`: an upper bound on the least.
    pub found: f64,
    /// The index of the edge.
    pub edge: usize,
    /// The fraction of that edge.
    pub at: f64,
}

/// A part of a motion: its ends `a` and `b`, each a fraction of it with a lower bound on the clearance there,
/// and a lower bound on the clearance between.
struct Part {
    bound: f64,
    a: (f64, f64),
    b: (f64, f64),
}

impl Part {
    /// The part between two places whose clearance is known, `travel` being the motion bound.
    /// From either end the clearance falls at most by the travel: the two descents meet at the bound.
    fn new(travel: f64, a: (f64, f64), b: (f64, f64)) -> Self {
        let bound = 0.5 * (a.1 + b.1 - travel * (b.0 - a.0));
        Self { bound, a, b }
    }
}

/// The greatest part in a heap is the one of least bound, ties by place.
impl Ord for Part {
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound).then(other.a.0.total_cmp(&self.a.0))
    }
}
impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Part {}

/// The most states looked at along an edge. A robot that slides along an obstacle has its least clearance everywhere:
/// there it takes as many states as the travel is longer than the accuracy.
const MAX_STATES: usize = 40_000;

/// The least clearance along `path`, its bounds at most `accuracy` metres apart; `None` for the
/// empty path.
///
/// First the states of the path, then edge by edge, by [`MotionClearance::least_along`]. A path in contact
/// gives zero. With an accuracy that is not positive, or takes over 40,000 states along an edge, the bounds known by
/// then are returned: still valid.
pub fn least_clearance<C, V>(
    space: &C,
    valid: &mut V,
    path: &Path<C::State>,
    accuracy: f64,
) -> Option<Tightest>
where
    C: Space,
    V: MotionClearance<C::State>,
{
    let edges = path.states.len().checked_sub(1)?;
    let mut at_states = Vec::with_capacity(edges + 1);
    let mut tightest = Tightest { clearance: 0.0, found: f64::INFINITY, edge: 0, at: 0.0 };
    for (i, q) in path.states.iter().enumerate() {
        let clearance = valid.clearance(q, f64::INFINITY).max(0.0);
        at_states.push(clearance);
        if clearance < tightest.found {
            // The last state is the end of the last edge.
            let edge = i.min(edges.saturating_sub(1));
            tightest = Tightest { found: clearance, edge, at: (i - edge) as f64, ..tightest };
        }
    }
    let mut bound = tightest.found;
    for edge in 0..edges {
        if tightest.found <= 0.0 {
            break;
        }
        let (from, to) = (&path.states[edge], &path.states[edge + 1]);
        let at = |t: f64| space.interpolate(from, to, t);
        let (ends, known) = ([at_states[edge], at_states[edge + 1]], tightest.found);
        let search = ClearanceSearch { from, to, ends, at: &at, known, accuracy, states: MAX_STATES };
        let least = valid.least_along(&search);
        bound = bound.min(least.bound);
        if let Some(at) = least.at {
            tightest = Tightest { found: least.found, edge, at, ..tightest };
        }
    }
    tightest.clearance = bound.min(tightest.found).max(0.0);
    Some(tightest)
}

/// Branch and bound on the motion bound (Piyavskii 1972, Shubert 1972): the part of least bound is halved
/// first.
pub(crate) fn by_motion_bound<S, V>(valid: &mut V, search: &ClearanceSearch<'_, S>) -> LeastClearance
where
    V: MotionClearance<S> + ?Sized,
{
    let travel = valid.motion_bound(search.from, search.to);
    let [start, end] = search.ends;
    let mut least = LeastClearance { bound: 0.0, found: search.known, at: None };
    let mut parts = BinaryHeap::from([Part::new(travel, (0.0, start), (1.0, end))]);
    for _ in 0..search.states {
        let settled = parts.peek().is_none_or(|p| p.bound >= least.found - search.accuracy);
        if settled || least.found <= 0.0 {
            break;
        }
        let Some(Part { a, b, .. }) = parts.pop() else { break };
        let at = 0.5 * (a.0 + b.0);
        // A clearance that would settle both halves.
        let enough = 2.0 * least.found - a.1.min(b.1) + (at - a.0) * travel;
        let clearance = valid.clearance(&(search.at)(at), enough.max(least.found)).max(0.0);
        if clearance < least.found {
            (least.found, least.at) = (clearance, Some(at));
        }
        let middle = (at, clearance);
        parts.extend([Part::new(travel, a, middle), Part::new(travel, middle, b)]);
    }
    least.bound = parts.peek().map_or(least.found, |p| p.bound);
    least
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Clearance;
    use crate::Rn;
    use nalgebra::Vector2;

    /// A point beside a disc of radius 1 about the origin.
    struct Disc(usize);
    impl Clearance<Vector2<f64>> for Disc {
        fn clearance(&mut self, q: &Vector2<f64>, enough: f64) -> f64 {
            self.0 += 1;
            (q.norm() - 1.0).min(enough)
        }
    }
    impl MotionClearance<Vector2<f64>> for Disc {
        fn motion_bound(&self, a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
            (b - a).norm()
        }
    }

    #[test]
    fn finds_the_tightest_place() {
        let space = Rn::<2>::new([-5.0, -5.0], [5.0, 5.0]).unwrap();
        let path =
            |points: &[(f64, f64)]| Path::straight(points.iter().map(|&(x, y)| Vector2::new(x, y)).collect());
        let mut disc = Disc(0);
        let bent = path(&[(-4.0, 3.0), (-4.0, 1.25), (3.5, 1.25), (3.5, -3.0)]);
        for accuracy in [0.1, 1e-3, 1e-6] {
            let t = least_clearance(&space, &mut disc, &bent, accuracy).unwrap();
            assert!(t.clearance <= 0.25 && 0.25 <= t.found && t.found - t.clearance <= accuracy);
            assert_eq!(t.edge, 1);
        }
        assert!(disc.0 < 4000, "{} queries", disc.0);
        let through = path(&[(-4.0, 0.1), (4.0, 0.1)]);
        assert_eq!(least_clearance(&space, &mut disc, &through, 1e-3).unwrap().clearance, 0.0);
        let standing = least_clearance(&space, &mut disc, &path(&[(3.0, 0.0)]), 1e-3).unwrap();
        assert_eq!((standing.clearance, standing.found), (2.0, 2.0));
        assert_eq!(least_clearance(&space, &mut disc, &path(&[]), 1e-3), None);
    }

    /// A point above the floor y = 0.
    struct Floor(usize);
    impl Clearance<Vector2<f64>> for Floor {
        fn clearance(&mut self, q: &Vector2<f64>, enough: f64) -> f64 {
            self.0 += 1;
            q.y.min(enough)
        }
    }
    impl MotionClearance<Vector2<f64>> for Floor {
        fn motion_bound(&self, a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
            (b - a).norm()
        }
    }

    /// It is least everywhere: no search would end soon.
    #[test]
    fn a_slide_takes_few_states() {
        let space = Rn::<2>::new([-5.0, 0.0], [5.0, 5.0]).unwrap();
        let slide = Path::straight([-4.0, 0.0, 4.0].map(|x| Vector2::new(x, 0.1)).to_vec());
        let mut floor = Floor(0);
        let t = least_clearance(&space, &mut floor, &slide, 1e-9).unwrap();
        assert!(floor.0 <= 2 * MAX_STATES + 3, "{} queries", floor.0);
        assert!(t.found == 0.1 && (0.0999..=0.1).contains(&t.clearance), "{t:?}");
    }
}
