//! Collectors: where the searches of all indexes put their answers.

use super::{Hit, NodeId};

/// Receives states in the order a search finds them, and says how far the search must reach.
pub(super) trait Collector {
    /// Whether offering a state again is harmless.
    const MAY_REPEAT: bool;
    /// Whether states are offered with the squares of their bounds for distances.
    const BY_BOUND: bool = false;
    /// States farther than this are not wanted; at this distance they may be.
    fn limit(&self) -> f64;
    /// Considers one state; `false` when it was not wanted.
    fn offer(&mut self, hit: Hit) -> bool;
}

/// The one nearest state.
#[derive(Debug)]
pub(super) struct OneNearest(Hit);

impl OneNearest {
    /// The answer of `search`.
    #[inline]
    pub(super) fn of(search: impl FnOnce(&mut Self)) -> Option<Hit> {
        let mut nearest = Self(Hit { id: NodeId::MAX, distance: f64::INFINITY });
        search(&mut nearest);
        (nearest.0.id != NodeId::MAX).then_some(nearest.0)
    }
}

impl Collector for OneNearest {
    const MAY_REPEAT: bool = true;

    #[inline]
    fn limit(&self) -> f64 {
        self.0.distance
    }

    #[inline]
    fn offer(&mut self, hit: Hit) -> bool {
        let better = hit.precedes(&self.0);
        if better {
            self.0 = hit;
        }
        better
    }
}

/// The `k` nearest states: a heap in `out`, the worst on top.
#[derive(Debug)]
pub(super) struct KNearest<'a> {
    k: usize,
    out: &'a mut Vec<Hit>,
}

impl<'a> KNearest<'a> {
    /// Fills `out` with the sorted answer of `search`, which is not called when `k` is 0.
    #[inline]
    pub(super) fn of(k: usize, out: &'a mut Vec<Hit>, search: impl FnOnce(&mut Self)) {
        out.clear();
        if k > 0 {
            let mut nearest = Self { k, out };
            search(&mut nearest);
            nearest.out.sort_unstable_by(Hit::order);
        }
    }

    /// Moves the hit at `i` up to where its parent is no better.
    fn sift_up(&mut self, mut i: usize) {
        while i > 0 && self.out[(i - 1) / 2].precedes(&self.out[i]) {
            self.out.swap(i, (i - 1) / 2);
            i = (i - 1) / 2;
        }
    }

    /// Moves the hit on top down to where no child is worse.
    fn sift_down(&mut self) {
        let mut i = 0;
        loop {
            let (left, right) = (2 * i + 1, 2 * i + 2);
            let mut worst = i;
            for child in [left, right] {
                if child < self.out.len() && self.out[worst].precedes(&self.out[child]) {
                    worst = child;
                }
            }
            if worst == i {
                return;
            }
            self.out.swap(i, worst);
            i = worst;
        }
    }
}

impl Collector for KNearest<'_> {
    const MAY_REPEAT: bool = false;

    #[inline]
    fn limit(&self) -> f64 {
        if self.out.len() < self.k {
            f64::INFINITY
        } else {
            self.out.first().map_or(f64::NEG_INFINITY, |worst| worst.distance)
        }
    }

    fn offer(&mut self, hit: Hit) -> bool {
        if hit.distance.is_nan() {
            return false;
        }
        if self.out.len() < self.k {
            self.out.push(hit);
            self.sift_up(self.out.len() - 1);
            return true;
        }
        match self.out.first_mut() {
            Some(worst) if hit.precedes(worst) => {
                *worst = hit;
                self.sift_down();
                true
            }
            _ => false,
        }
    }
}

/// All states within a radius.
#[derive(Debug)]
pub(super) struct WithinRadius<'a> {
    radius: f64,
    out: &'a mut Vec<Hit>,
}

impl<'a> WithinRadius<'a> {
    /// Fills `out` with the sorted answer of `search`.
    #[inline]
    pub(super) fn of(radius: f64, out: &'a mut Vec<Hit>, search: impl FnOnce(&mut Self)) {
        out.clear();
        let mut within = Self { radius, out };
        search(&mut within);
        within.out.sort_unstable_by(Hit::order);
    }
}

impl Collector for WithinRadius<'_> {
    const MAY_REPEAT: bool = false;

    #[inline]
    fn limit(&self) -> f64 {
        self.radius
    }

    #[inline]
    fn offer(&mut self, hit: Hit) -> bool {
        let inside = hit.distance <= self.radius;
        if inside {
            self.out.push(hit);
        }
        inside
    }
}
