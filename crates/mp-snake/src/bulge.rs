//! The curve a snake begins with where the straight one is blocked.

use crate::snake::{Shape, norm};
use crate::{Field, Snake};
use mp_cspace::Space;
use std::ops::Range;

/// How high the bulges tried are, in units of the depth of the deepest node and a spacing.
const HEIGHTS: [f64; 3] = [1.0, 2.0, 4.0];

impl<C: Space> Snake<'_, C> {
    /// Bends a curve out of what blocks it, all of it to one side, as a better place to
    /// [begin](Self::deform) from: a curve that enters an obstacle by one face and leaves it by another is pushed
    /// to different sides along its way, and one that meets a face squarely to no side at all.
    ///
    /// Bulges of a few heights, over the nodes of negative clearance, are tried to the side to which the field
    /// pushes those nodes together, and to the other; where it pushes them along the curve only, along the two axes
    /// most across it. It becomes the first whose nodes are all clear, else the one of least energy, which may be
    /// the curve itself. Asks the field at most seven times per node, thirteen times where there is no side.
    pub fn bulge(&mut self, curve: &mut Vec<C::State>, field: &mut impl Field<C::State>) {
        let dim = self.dim();
        if curve.len() < 3 {
            return;
        }
        let mut shape = Shape::default();
        self.measure(curve, field, &mut shape);
        let blocked = |c: &f64| *c <= 0.0;
        let (Some(first), Some(last)) =
            (shape.clearances.iter().position(blocked), shape.clearances.iter().rposition(blocked))
        else {
            return;
        };
        let inner = shape.clearances.len();
        let height = |i: usize| {
            let (up, down) =
                ((i + 1) as f64 / (first + 1) as f64, (inner - i) as f64 / (inner - last) as f64);
            up.min(down).min(1.0) * (self.params().spacing - shape.clearance())
        };
        let heights: Vec<f64> = (0..inner).map(height).collect();
        let (mut least, mut best) = (shape.energy.total(), None);
        let mut bulged = Vec::with_capacity(curve.len());
        for side in sides(&shape, first..last + 1, dim) {
            *self.step_mut() = heights.iter().flat_map(|h| side.iter().map(move |s| s * h)).collect();
            for height in HEIGHTS.iter().flat_map(|height| [*height, -height]) {
                self.displaced(curve, height, &mut bulged);
                let energy = self.energy(&bulged, field).total();
                if self.measured().clearance() > 0.0 {
                    *curve = bulged;
                    return;
                }
                if energy < least {
                    least = energy;
                    best = Some(std::mem::take(&mut bulged));
                }
            }
        }
        if let Some(best) = best {
            *curve = best;
        }
    }
}

/// The directions (unit, scaled) to try for the blocked nodes: where the field pushes them together, across the curve;
/// where it pushes along the curve only, the two axes most across it.
fn sides(shape: &Shape, blocked: Range<usize>, dim: usize) -> Vec<Vec<f64>> {
    let mut side = vec![0.0; dim];
    let mut strength = 0.0;
    for push in shape.pushes[blocked.start * dim..blocked.end * dim].chunks_exact(dim) {
        side.iter_mut().zip(push).for_each(|(s, p)| *s -= p);
        strength += norm(push);
    }
    if norm(&side) > 1e-6 * strength {
        return unit(side).into_iter().collect();
    }
    let way: Vec<f64> = (0..dim).map(|k| shape.ways.iter().skip(k).step_by(dim).sum()).collect();
    let Some(way) = unit(way) else { return Vec::new() };
    let mut axes: Vec<usize> = (0..dim).collect();
    axes.sort_by(|&i, &j| way[i].abs().total_cmp(&way[j].abs()));
    let across =
        |&axis: &usize| unit((0..dim).map(|k| f64::from(u8::from(k == axis)) - way[axis] * way[k]).collect());
    axes.iter().take(2.min(dim - 1)).filter_map(across).collect()
}

fn unit(mut v: Vec<f64>) -> Option<Vec<f64>> {
    let length = norm(&v);
    v.iter_mut().for_each(|x| *x /= length);
    (length > 0.0 && length.is_finite()).then_some(v)
}
