//! The part of a layout that a tree looks at.

use super::ANY;
use crate::layout::{Layout, Symmetry};
use crate::nn::Embed;

/// What a tree knows of its space, fixed by the first state.
#[derive(Clone, Debug)]
pub(super) struct Shape<const K: usize> {
    /// Coordinates looked at.
    pub(super) dim: usize,
    /// Coordinates of the layout.
    full: usize,
    /// The group of each coordinate.
    pub(super) group: [u32; K],
    /// Past-the-end coordinate of each group.
    pub(super) ends: Vec<usize>,
    /// The period of each coordinate, infinite for one that has none.
    pub(super) period: [f64; K],
    /// The ranges of coordinates that mean the same when negated together.
    pub(super) antipodes: Vec<(usize, usize)>,
    pub(super) slack: f64,
    /// Coordinates of the first state, to which those of all others are relative, unless the
    /// coordinate takes part in a symmetry.
    origin: [f64; K],
}

impl<const K: usize> Default for Shape<K> {
    fn default() -> Self {
        Self {
            dim: 0,
            full: 0,
            group: [0; K],
            ends: Vec::new(),
            period: [f64::INFINITY; K],
            antipodes: Vec::new(),
            slack: 0.0,
            origin: [0.0; K],
        }
    }
}

impl<const K: usize> Shape<K> {
    /// The shape of `space`, its first state being `first`.
    pub(super) fn new<C: Embed>(space: &C, first: &C::State) -> Self {
        let Layout { groups, symmetries, slack } = space.layout();
        let full = groups.last().copied().unwrap_or(0);
        let dim = if K == ANY { full.min(K) } else { K };
        let mut shape = Self { dim, full, slack, ..Self::default() };
        let mut start = 0;
        for end in groups {
            let end = end.min(dim);
            if end > start {
                shape.group[start..end].fill(shape.ends.len() as u32);
                shape.ends.push(end);
                start = end;
            }
        }
        // Coordinates past the layout's are zero, and may belong anywhere.
        if shape.ends.is_empty() {
            shape.ends.push(dim);
        }
        shape.group[start..].fill(shape.ends.len() as u32 - 1);
        let last = shape.ends.len() - 1;
        shape.ends[last] = dim;
        let mut origin = shape.embed(space, first);
        for s in symmetries {
            match s {
                Symmetry::Period { coordinate, period } if coordinate < dim => {
                    shape.period[coordinate] = period;
                    origin[coordinate] = 0.0;
                }
                Symmetry::Antipode { start, end } if start < dim => {
                    let end = end.min(dim);
                    shape.antipodes.push((start, end));
                    origin[start..end].fill(0.0);
                }
                _ => {}
            }
        }
        shape.origin = origin;
        shape
    }

    /// The coordinates of `state` that the tree looks at, relative to the origin; all finite.
    #[inline]
    pub(super) fn embed<C: Embed>(&self, space: &C, state: &C::State) -> [f64; K] {
        let mut x = [0.0; K];
        if self.full <= K {
            space.embed(state, &mut x);
        } else if self.full <= ANY {
            let mut all = [0.0; ANY];
            space.embed(state, &mut all);
            x.copy_from_slice(&all[..K]);
        } else {
            let mut all = vec![0.0; self.full];
            space.embed(state, &mut all);
            x.copy_from_slice(&all[..K]);
        }
        for (x, o) in x.iter_mut().zip(&self.origin) {
            // Clamping never moves coordinates apart, and leaves room to square them in `f32`.
            *x = if x.is_nan() { 0.0 } else { x.clamp(-1e17, 1e17) } - o;
        }
        x
    }
}
