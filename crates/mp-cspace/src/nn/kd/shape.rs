//! The part of a layout that a tree looks at.

use super::super::embed::{Layout, Symmetry};
use super::MAX_DIM;
use crate::Embed;

/// What a tree knows of its space, fixed by the first state.
#[derive(Clone, Debug, Default)]
pub(super) struct Shape {
    /// Coordinates looked at.
    pub(super) dim: usize,
    /// Coordinates of the layout.
    full: usize,
    /// The group of each coordinate.
    pub(super) group: [u8; MAX_DIM],
    /// Past-the-end coordinate of each group.
    pub(super) ends: Vec<usize>,
    /// The period of each coordinate, infinite for one that has none.
    pub(super) period: [f64; MAX_DIM],
    /// The ranges of coordinates that mean the same when negated together.
    pub(super) antipodes: Vec<(usize, usize)>,
    pub(super) slack: f64,
    /// Coordinates of the first state, to which those of all others are relative, unless the
    /// coordinate takes part in a symmetry.
    pub(super) origin: [f64; MAX_DIM],
}

impl Shape {
    /// The shape of `space`, seen through at most `dim` coordinates (0: as many as there are).
    pub(super) fn new<C: Embed>(space: &C, dim: usize, first: &C::State) -> Self {
        let Layout { groups, symmetries, slack } = space.layout();
        let full = groups.last().copied().unwrap_or(0);
        let dim = if dim == 0 { full } else { dim }.min(MAX_DIM);
        let mut shape = Self { dim, full, slack, ..Self::default() };
        // Coordinates past the layout's are zero, and may belong anywhere.
        let mut start = 0;
        for end in groups {
            let end = end.min(dim);
            if end > start {
                shape.group[start..end].fill(shape.ends.len() as u8);
                shape.ends.push(end);
                start = end;
            }
        }
        if start < dim {
            shape.group[start..dim].fill(shape.ends.len().saturating_sub(1) as u8);
            match shape.ends.last_mut() {
                Some(last) => *last = dim,
                None => shape.ends.push(dim),
            }
        }
        let mut origin = shape.embed(space, first);
        shape.period = [f64::INFINITY; MAX_DIM];
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
    pub(super) fn embed<C: Embed>(&self, space: &C, state: &C::State) -> [f64; MAX_DIM] {
        let mut x = [0.0; MAX_DIM];
        if self.full <= MAX_DIM {
            space.embed(state, &mut x);
        } else {
            let mut all = vec![0.0; self.full];
            space.embed(state, &mut all);
            x.copy_from_slice(&all[..MAX_DIM]);
        }
        for (x, o) in x.iter_mut().zip(&self.origin) {
            // Clamping never moves coordinates apart, and leaves room to square them in `f32`.
            *x = if x.is_nan() { 0.0 } else { x.clamp(-1e17, 1e17) } - o;
        }
        x
    }
}
