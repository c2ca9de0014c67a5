//! Edges through intermediate states.

use crate::{MotionCheck, MotionValidity, Path, Reversible};
use std::sync::Arc;

/// An edge through vertices: states in forward time, between which the space interpolates. Without vertices
/// it is the straight motion. Clones share the vertices.
///
/// Every [`MotionValidity`] verifies such edges, motion by motion.
///
/// ```
/// use mp_cspace::{Path, PolylineEdge};
/// let path = Path { states: vec![0, 9], edges: vec![PolylineEdge::through(&[2, 5])] };
/// assert_eq!(path.flattened().states, [0, 2, 5, 9]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PolylineEdge<S>(Option<Arc<[S]>>);

impl<S> Default for PolylineEdge<S> {
    fn default() -> Self {
        Self::straight()
    }
}

impl<S> PolylineEdge<S> {
    /// A straight edge: it has no vertices between its ends.
    #[must_use]
    pub fn straight() -> Self {
        Self(None)
    }

    /// An edge that bends at `vertices`, in this order; its ends are not among them.
    #[must_use]
    pub fn through(vertices: &[S]) -> Self
    where
        S: Clone,
    {
        Self((!vertices.is_empty()).then(|| vertices.into()))
    }

    /// The vertices between the ends.
    #[must_use]
    pub fn vertices(&self) -> &[S] {
        self.0.as_deref().unwrap_or_default()
    }

    /// Checks each straight part of the edge from `from` to `to`. In the fraction reported every part counts
    /// alike, whatever its length.
    pub fn check(&self, from: &S, to: &S, check: &mut (impl MotionValidity<S> + ?Sized)) -> MotionCheck {
        let parts = (self.vertices().len() + 1) as f64;
        let (mut last, mut least) = (from, f64::INFINITY);
        for (i, next) in self.vertices().iter().chain([to]).enumerate() {
            let fraction = |at: f64| (i as f64 + at) / parts;
            match check.check_motion(last, next) {
                MotionCheck::Free { clearance } => least = least.min(clearance),
                MotionCheck::Collision { at } => return MotionCheck::Collision { at: fraction(at) },
                MotionCheck::Unproven { at } => return MotionCheck::Unproven { at: fraction(at) },
            }
            last = next;
        }
        MotionCheck::Free { clearance: least }
    }
}

impl<S: Clone> Reversible for PolylineEdge<S> {
    fn reversed(&self) -> Self {
        let backward: Vec<S> = self.vertices().iter().rev().cloned().collect();
        Self::through(&backward)
    }
}

impl<S: Clone> Path<S, PolylineEdge<S>> {
    /// The same path with the vertices of its edges as states, straight between them.
    #[must_use]
    pub fn flattened(&self) -> Path<S> {
        let mut states = Vec::with_capacity(self.states.len());
        for (i, q) in self.states.iter().enumerate() {
            states.push(q.clone());
            states.extend(self.edges.get(i).into_iter().flat_map(|edge| edge.vertices().iter().cloned()));
        }
        Path::straight(states)
    }
}
