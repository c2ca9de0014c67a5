//! The linear scan.

use super::collect::{Collector, KNearest, OneNearest, WithinRadius};
use super::{Hit, NearestNeighbors, NodeId};
use crate::Space;

/// Measures the distance of every state: exact for any metric, symmetric or not, and the fastest index
/// below a few dozen states. `nearest` and `within` take time linear in the number of states.
#[derive(Clone, Debug, Default)]
pub struct Linear {
    ids: Ids,
}

/// Which states were inserted: nearly always the first `n`, which need no list.
#[derive(Clone, Debug)]
enum Ids {
    First(usize),
    Listed(Vec<NodeId>),
}

impl Default for Ids {
    fn default() -> Self {
        Self::First(0)
    }
}

impl Linear {
    /// An empty index.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Offers every state to `collector`.
    #[inline]
    fn scan<C: Space>(&self, space: &C, points: &[C::State], q: &C::State, collector: &mut impl Collector) {
        let mut measure = |id: NodeId, p: &C::State| {
            let distance = space.distance(p, q);
            if distance <= collector.limit() {
                collector.offer(Hit { id, distance });
            }
        };
        match &self.ids {
            Ids::First(n) => points[..*n].iter().zip(0..).for_each(|(p, id)| measure(id, p)),
            Ids::Listed(ids) => ids.iter().for_each(|&id| measure(id, &points[id as usize])),
        }
    }
}

impl<C: Space> NearestNeighbors<C> for Linear {
    fn inserted(&mut self, _space: &C, points: &[C::State], id: NodeId) {
        assert!((id as usize) < points.len(), "no state has id {id}");
        match &mut self.ids {
            Ids::First(n) if *n == id as usize => *n += 1,
            Ids::First(n) => self.ids = Ids::Listed((0..*n as NodeId).chain([id]).collect()),
            Ids::Listed(ids) => ids.push(id),
        }
    }

    fn clear(&mut self) {
        self.ids = Ids::default();
    }

    fn nearest(&self, space: &C, points: &[C::State], q: &C::State) -> Option<Hit> {
        OneNearest::of(|nearest| self.scan(space, points, q, nearest))
    }

    fn k_nearest(&self, space: &C, points: &[C::State], q: &C::State, k: usize, out: &mut Vec<Hit>) {
        KNearest::of(k, out, |nearest| self.scan(space, points, q, nearest));
    }

    fn within(&self, space: &C, points: &[C::State], q: &C::State, radius: f64, out: &mut Vec<Hit>) {
        WithinRadius::of(radius, out, |within| self.scan(space, points, q, within));
    }
}
