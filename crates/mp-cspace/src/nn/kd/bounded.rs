//! The k nearest by the bounds of their lanes alone: the metric is evaluated for the answers, and for few
//! others.

use super::super::Hit;
use super::super::collect::Collector;
use super::KdTree;
use crate::nn::states::EmbeddedStates;

/// The most neighbours looked for by bounds; more are found by the metric.
pub(super) const MOST: usize = 64;

/// How much farther than its bound a state of a [tight](crate::nn::Layout) layout may be, for the search to
/// succeed at once: without rotations and with them. The bound of an angle θ is 4 sin(θ/4), which is within
/// 2% up to θ = 78°.
const STRETCH: [f64; 2] = [1.00001, 1.02];

/// Collects all states within a limit, which falls as states come: to a little more than the `k`-th least
/// bound.
///
/// Distances of hits are squared bounds.
#[derive(Debug)]
pub(super) struct Bounded<'a> {
    k: usize,
    /// The least bounds in ascending order, after a number below all.
    least: [f32; MOST + 1],
    stretch: f64,
    /// What a bound is off by.
    pad: f64,
    /// Those within the limit, and some that were when it was greater.
    found: &'a mut Vec<Hit>,
}

impl Bounded<'_> {
    /// Puts `bound` in its place among the least.
    #[inline(always)]
    fn rank<const N: usize>(&mut self, bound: f32) {
        let mut old = [0.0; MOST + 1];
        old[..=N].copy_from_slice(&self.least[..=N]);
        for i in 0..N {
            let after = if old[i] > bound { old[i] } else { bound };
            self.least[i + 1] = if after < old[i + 1] { after } else { old[i + 1] };
        }
    }
}

impl Collector for Bounded<'_> {
    const MAY_REPEAT: bool = false;
    const BY_BOUND: bool = true;

    #[inline]
    fn limit(&self) -> f64 {
        f64::from(self.least[self.k]).sqrt() * self.stretch + self.pad
    }

    #[inline(always)]
    fn offer(&mut self, hit: Hit) -> bool {
        let bound = hit.distance as f32;
        match self.k {
            ..=16 => self.rank::<16>(bound),
            17..=32 => self.rank::<32>(bound),
            _ => self.rank::<MOST>(bound),
        }
        self.found.push(hit);
        true
    }
}

impl<const K: usize> KdTree<K> {
    /// Writes the `k` nearest states in order to `out`. Returns `false` where bounds do not suffice to tell
    /// which they are; then `out` has something else.
    pub(super) fn k_nearest_by_bounds(
        &self,
        states: &dyn EmbeddedStates,
        k: usize,
        out: &mut Vec<Hit>,
    ) -> bool {
        if !(2..=MOST).contains(&k) || !self.layout.tight {
            return false;
        }
        out.clear();
        let mut least = [f32::INFINITY; MOST + 1];
        least[0] = f32::NEG_INFINITY;
        let pad = self.pads(self.largest)[1];
        let stretch = STRETCH[usize::from(!self.layout.antipodes.is_empty())];
        let mut bounded = Bounded { k, least, stretch, pad, found: out };
        let reach = f64::from(self.search(states, &mut bounded));
        let limit = bounded.limit();
        // All states whose distance is at most the limit have been found, with a bound within the last reach.
        out.retain_mut(|hit| {
            let passes = hit.distance <= reach;
            if passes {
                hit.distance = states.to_query(hit.id);
            }
            passes && !hit.distance.is_nan()
        });
        out.sort_unstable_by(Hit::order);
        if out.len() < k {
            return limit == f64::INFINITY;
        }
        out.truncate(k);
        out[k - 1].distance <= limit
    }
}
