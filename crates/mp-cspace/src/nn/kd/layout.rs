//! The part of a layout that a tree uses.

use super::ANY;
use crate::layout::{Layout, Symmetry};
use crate::nn::states::EmbeddedStates;

/// The coordinates of a space as a tree uses them, fixed by the first state.
#[derive(Clone, Debug)]
pub(super) struct TreeLayout<const K: usize> {
    /// Number of coordinates used.
    pub(super) dim: usize,
    /// Number of coordinates of the layout.
    full: usize,
    /// The group of each coordinate.
    pub(super) group: [u32; K],
    /// Past-the-end coordinate of each group.
    pub(super) ends: Vec<usize>,
    /// The period of each coordinate, infinite for one that has none.
    pub(super) period: [f64; K],
    /// The ranges of coordinates that mean the same when negated together.
    pub(super) antipodes: Vec<(usize, usize)>,
    /// Whether the distance is hardly more than its bound.
    pub(super) tight: bool,
    /// Coordinates of the first state, to which those of all others are relative, unless the
    /// coordinate takes part in a symmetry.
    origin: [f64; K],
}

impl<const K: usize> Default for TreeLayout<K> {
    fn default() -> Self {
        Self {
            dim: 0,
            full: 0,
            group: [0; K],
            ends: Vec::new(),
            period: [f64::INFINITY; K],
            antipodes: Vec::new(),
            tight: false,
            origin: [0.0; K],
        }
    }
}

impl<const K: usize> TreeLayout<K> {
    /// The layout of `states`, relative to the query.
    pub(super) fn new(states: &dyn EmbeddedStates) -> Self {
        let Layout { groups, symmetries, tight } = states.layout();
        let full = groups.last().copied().unwrap_or(0);
        let dim = if K == ANY { full.min(K) } else { K };
        let mut layout = Self { dim, full, tight: tight && full == dim, ..Self::default() };
        let mut start = 0;
        for end in groups {
            let end = end.min(dim);
            if end > start {
                layout.group[start..end].fill(layout.ends.len() as u32);
                layout.ends.push(end);
                start = end;
            }
        }
        // Coordinates past the layout's are zero, and may belong to any group.
        if layout.ends.is_empty() {
            layout.ends.push(dim);
        }
        layout.group[start..].fill(layout.ends.len() as u32 - 1);
        let last = layout.ends.len() - 1;
        layout.ends[last] = dim;
        let mut origin = layout.embed(|out| states.embed_query(out));
        for s in symmetries {
            match s {
                Symmetry::Period { coordinate, period } if coordinate < dim => {
                    layout.period[coordinate] = period;
                    origin[coordinate] = 0.0;
                }
                Symmetry::Antipode { start, end } if start < dim => {
                    let end = end.min(dim);
                    layout.antipodes.push((start, end));
                    origin[start..end].fill(0.0);
                }
                _ => {}
            }
        }
        layout.origin = origin;
        layout
    }

    /// The least square of the norm of the coordinates that mean the same when negated, over the antipodes.
    #[inline]
    pub(super) fn least_antipode(&self, x: &[f64; K]) -> f64 {
        let squares = self.antipodes.iter().map(|&(start, end)| x[start..end].iter().map(|x| x * x).sum());
        squares.fold(f64::INFINITY, f64::min)
    }

    /// The coordinates that the tree uses of those that `embed` writes, relative to the origin; all finite.
    #[inline]
    pub(super) fn embed(&self, embed: impl FnOnce(&mut [f64])) -> [f64; K] {
        let mut x = [0.0; K];
        if self.full <= K {
            embed(&mut x);
        } else if self.full <= ANY {
            let mut all = [0.0; ANY];
            embed(&mut all);
            x.copy_from_slice(&all[..K]);
        } else {
            let mut all = vec![0.0; self.full];
            embed(&mut all);
            x.copy_from_slice(&all[..K]);
        }
        for (x, o) in x.iter_mut().zip(&self.origin) {
            // Clamping never moves coordinates apart, and keeps their squares finite in `f32`.
            *x = if x.is_nan() { 0.0 } else { x.clamp(-1e17, 1e17) } - o;
        }
        x
    }
}
