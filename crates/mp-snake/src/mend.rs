//! Corners where a bulge grazes.

use crate::bulge::{dot, unit};
use crate::{Field, Snake};
use mp_cspace::{KnownFree, Space};

impl<C: Space> Snake<'_, C> {
    /// Whether no piece of the curve is blocked, as `blocks` says, with corners added where that helps: where the
    /// field says that the middle of the first or the last piece is blocked, and at most one where something blocks a
    /// piece.
    pub(crate) fn fit(
        &mut self,
        curve: &mut Vec<C::State>,
        field: &mut impl Field<C::State>,
        wanted: f64,
        blocks: &mut impl FnMut(&C::State, &C::State, KnownFree) -> Option<f64>,
    ) -> bool {
        for at in [curve.len() - 2, 0] {
            let middle = self.space.interpolate(&curve[at], &curve[at + 1], 0.5);
            let blocked = field.clearance_at(&middle, &mut self.unused) <= 0.0;
            if blocked && !self.corner(curve, at, 0.5, field, wanted) {
                return false;
            }
        }
        let mut mended = false;
        let mut free = |snake: &mut Self, curve: &mut Vec<C::State>, at: usize, known: KnownFree| {
            let Some(part) = blocks(&curve[at], &curve[at + 1], known) else { return true };
            if mended || !snake.corner(curve, at, part, field, wanted) {
                return false;
            }
            mended = true;
            let order = if known == KnownFree::To { [at + 1, at] } else { [at, at + 1] };
            order.iter().all(|&at| blocks(&curve[at], &curve[at + 1], known).is_none())
        };
        // The last and the first piece first: they lead by what was in the way, and fail most.
        let (mut front, mut were) = (0, curve.len());
        if !free(self, curve, were - 2, KnownFree::To) {
            return false;
        }
        let back = 1 + curve.len() - were;
        while front + back < curve.len() - 1 {
            were = curve.len();
            if !free(self, curve, front, KnownFree::From) {
                return false;
            }
            front += 1 + curve.len() - were;
        }
        true
    }

    /// Adds a corner at part `at` of piece `piece`, pushed off by the field, across the piece, until it should be as
    /// clear as wanted. `false` where that does not clear it.
    fn corner(
        &mut self,
        curve: &mut Vec<C::State>,
        piece: usize,
        at: f64,
        field: &mut impl Field<C::State>,
        wanted: f64,
    ) -> bool {
        let (from, to) = (&curve[piece], &curve[piece + 1]);
        let q = self.space.interpolate(from, to, at);
        let Self { velocity: push, unused: way, scale, space, .. } = self;
        push.resize(scale.len(), 0.0);
        way.resize(scale.len(), 0.0);
        space.velocity_into(from, to, way);
        field.energy(&q, push);
        let by = wanted - field.clearance().unwrap_or(f64::INFINITY);
        way.iter_mut().zip(&*scale).for_each(|(w, s)| *w *= s);
        push.iter_mut().zip(&*scale).for_each(|(p, s)| *p /= -s);
        let along = dot(push, way) / dot(way, way).max(f64::MIN_POSITIVE);
        push.iter_mut().zip(&*way).for_each(|(p, w)| *p -= along * w);
        // NaN is refused too.
        if !(by > 0.0 && unit(push)) {
            return false;
        }
        push.iter_mut().zip(&*scale).for_each(|(p, s)| *p /= s);
        let Some(q) = space.moved(&q, push, by).filter(|q| space.contains(q)) else { return false };
        let clear = field.clearance_at(&q, way) > 0.0;
        if clear {
            curve.insert(piece + 1, q);
        }
        clear
    }
}
