//! The curve a snake begins with where the straight one is blocked.

use crate::snake::{NODES, norm};
use crate::{Field, Snake};
use mp_cspace::{KnownFree, Space};
use std::ops::Range;

/// A way for some nodes to go together.
struct SideStep<'a> {
    /// The nodes between the ends that are blocked.
    blocked: Range<usize>,
    /// A unit vector (scaled), whither they go.
    side: &'a [f64],
    /// The clearance they should have, where they have the least of it now, and how far they may go.
    wanted: f64,
    least: f64,
    longest: f64,
}

/// How far nodes go aside at most, as part of the length of the curve. Higher bulges rarely fit.
const HIGHEST: f64 = 0.5;

/// How far they go at least at a time, as part of how far they may.
const STRIDE: f64 = 0.125;

/// What came of a [bulge](Snake::bulge).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Bulged {
    /// There is one that fits: the curve is its corners.
    Fits,
    /// There is one, which does not fit: the curve is laid along it.
    Laid,
    /// There is no side where the blocked nodes are clear: the curve is as it was.
    Nowhere,
}

impl<C: Space> Snake<'_, C> {
    /// Bends a straight curve out of what blocks it, all of it to one side. That may do; else it is a better place to
    /// [begin](Self::deform) from: a curve that enters an obstacle by one face and leaves it by another is pushed
    /// to different sides along its way, and one that meets a face squarely to no side at all.
    ///
    /// The nodes from the first to the last that are blocked (where none is, the one of least clearance) go together to
    /// the side to which the field gradients them, until all have the clearance `wanted` (m); in strides of what they
    /// lack of it, at most as far as half the curve is long. A node before the first and one after the last of them, as
    /// far aside, are the corners of the bulge, so that its ramps do not graze. A ramp whose middle is blocked is pushed
    /// off there, and the first piece that `blocks` where it is blocked: it gets one more corner. When the bulge
    /// does not fit, they try the other side; where the field gradients along the curve only, the two axes most across it,
    /// both ways.
    ///
    /// `blocks` is asked of each piece, with the end of it that is known to be free, at which fraction something blocks
    /// it: `None` where it is free.
    ///
    /// Asks the field once per node, and in each stride until it meets a node that is blocked, in the middle first.
    pub fn bulge(
        &mut self,
        curve: &mut Vec<C::State>,
        field: &mut impl Field<C::State>,
        wanted: f64,
        mut blocks: impl FnMut(&C::State, &C::State, KnownFree) -> Option<f64>,
    ) -> Bulged {
        if curve.len() < 3 {
            return Bulged::Nowhere;
        }
        let mut blockage = std::mem::take(&mut self.blockage);
        let bulged = self.bulge_with(curve, field, wanted, &mut blockage, &mut blocks);
        self.blockage = blockage;
        bulged
    }

    fn bulge_with(
        &mut self,
        curve: &mut Vec<C::State>,
        field: &mut impl Field<C::State>,
        wanted: f64,
        blockage: &mut Blockage,
        blocks: &mut impl FnMut(&C::State, &C::State, KnownFree) -> Option<f64>,
    ) -> Bulged {
        self.find_blockage(curve, field, blockage);
        let Some(blocked) = blockage.blocked() else { return Bulged::Nowhere };
        let (dim, least, longest) = (self.dim(), blockage.least(), HIGHEST * norm(&blockage.chord));
        blockage.find_sides(&blocked);
        let mut corners = std::mem::take(&mut self.next);
        let mut lowest: Option<(&[f64], f64)> = None;
        let mut found = false;
        for side in blockage.sides.chunks_exact(dim) {
            let step = SideStep { blocked: blocked.clone(), side, wanted, least, longest };
            let Some(height) = self.height(&step, curve, field) else { continue };
            corners.clear();
            corners.push(curve[0].clone());
            let (first, last) = (blocked.start.saturating_sub(1), blocked.end.min(curve.len() - 3));
            self.set_side(side);
            corners.extend(self.moved_aside(&curve[first + 1], height));
            if last > first {
                corners.extend(self.moved_aside(&curve[last + 1], height));
            }
            corners.extend(curve.last().cloned());
            found = corners.len() > 2 && self.fit(&mut corners, field, wanted, blocks);
            if found {
                std::mem::swap(curve, &mut corners);
                break;
            }
            if lowest.is_none_or(|(_, h)| height < h) {
                lowest = Some((side, height));
            }
        }
        let bulged = match lowest {
            _ if found => Bulged::Fits,
            None => Bulged::Nowhere,
            Some((side, height)) => {
                self.set_side(side);
                for i in 0..curve.len() - 2 {
                    let part = part(i, &blocked, curve.len() - 2);
                    if let Some(q) = self.moved_aside(&curve[i + 1], part * height) {
                        curve[i + 1] = q;
                    }
                }
                Bulged::Laid
            }
        };
        self.next = corners;
        bulged
    }

    /// Asks the field at each node between the ends of a straight curve.
    fn find_blockage(
        &mut self,
        curve: &[C::State],
        field: &mut impl Field<C::State>,
        blockage: &mut Blockage,
    ) {
        let dim = self.dim();
        let inner = curve.len() - 2;
        blockage.chord.resize(dim, 0.0);
        self.space.velocity_into(&curve[0], &curve[inner + 1], &mut blockage.chord);
        blockage.chord.iter_mut().zip(&self.scale).for_each(|(x, s)| *x *= s);
        blockage.clearances.clear();
        blockage.gradients.resize(inner * dim, 0.0);
        for (q, push) in curve[1..].iter().zip(blockage.gradients.chunks_exact_mut(dim)) {
            field.energy(q, push);
            push.iter_mut().zip(&self.scale).for_each(|(x, s)| *x /= s);
            blockage.clearances.push(field.clearance().unwrap_or(f64::INFINITY));
        }
    }

    /// How far the blocked nodes go to be as clear as wanted; as clear as they get where that is not to be had.
    fn height(
        &mut self,
        step: &SideStep<'_>,
        curve: &[C::State],
        field: &mut impl Field<C::State>,
    ) -> Option<f64> {
        let spacing = self.params().spacing;
        let stride = (0.5 * spacing).max(STRIDE * step.longest);
        let mut height = (step.wanted - step.least).max(stride);
        let mut best: Option<(f64, f64)> = None;
        self.set_side(step.side);
        let Self { space, velocity, unused, .. } = self;
        while height <= step.longest {
            let mut least = f64::INFINITY;
            for i in from_the_middle(&step.blocked) {
                let moved = space.moved(&curve[i + 1], velocity, height).filter(|q| space.contains(q));
                let Some(q) = moved else { return best.map(|b| b.1) };
                least = least.min(field.clearance_at(&q, unused));
                if least <= 0.0 {
                    break;
                }
            }
            if least >= step.wanted {
                return Some(height);
            }
            if least > best.map_or(0.0, |b| b.0) {
                best = Some((least, height));
            } else if best.is_some() {
                break;
            }
            // Where they are clear already, little is lacking.
            let at_least = if least > 0.0 { 0.1 * spacing } else { stride };
            height += (step.wanted - least).max(at_least);
        }
        best.map(|b| b.1)
    }

    /// Sets out to a side, for [`moved_aside`](Self::moved_aside).
    fn set_side(&mut self, side: &[f64]) {
        self.velocity.clear();
        self.velocity.extend(side.iter().zip(&self.scale).map(|(x, s)| x / s));
        self.unused.resize(side.len(), 0.0);
    }

    /// The state `by` to the side, if it is in the space.
    fn moved_aside(&self, q: &C::State, by: f64) -> Option<C::State> {
        self.space.moved(q, &self.velocity, by).filter(|moved| self.space.contains(moved))
    }

    /// Whether no piece of the curve is blocked, as `blocks` says, with corners added where that helps: where the
    /// field says that the middle of the first or the last piece is blocked, and at most one where something blocks a
    /// piece.
    fn fit(
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

/// What part of the way of the blocked nodes node `i` of `inner` goes.
fn part(i: usize, blocked: &Range<usize>, inner: usize) -> f64 {
    let (up, down) =
        ((i + 1) as f64 / (blocked.start + 1) as f64, (inner - i) as f64 / (inner + 1 - blocked.end) as f64);
    up.min(down).min(1.0)
}

fn from_the_middle(range: &Range<usize>) -> impl Iterator<Item = usize> + use<> {
    let middle = (range.start + range.end) / 2;
    (middle..range.end).chain((range.start..middle).rev())
}

/// What a straight curve meets. Numbers are scaled: lengths in the metric.
#[derive(Clone, Debug, Default)]
pub(crate) struct Blockage {
    /// From end to end.
    chord: Vec<f64>,
    /// The clearance of each node between the ends, and the gradient of the field there.
    clearances: Vec<f64>,
    gradients: Vec<f64>,
    /// Directions (unit) to try, one after the other.
    sides: Vec<f64>,
}

impl Blockage {
    pub(crate) fn with_room(dim: usize) -> Self {
        Self {
            chord: Vec::with_capacity(dim),
            clearances: Vec::with_capacity(NODES),
            gradients: Vec::with_capacity(NODES * dim),
            sides: Vec::with_capacity(4 * dim),
        }
    }

    fn least(&self) -> f64 {
        self.clearances.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// From the first to the last node of no clearance; the one of least where all have some; `None` where it is unknown.
    fn blocked(&self) -> Option<Range<usize>> {
        let none = |c: &f64| *c <= 0.0;
        let mut clearances = self.clearances.iter();
        if let Some(first) = clearances.position(none) {
            let last = self.clearances.iter().rposition(none).unwrap_or(first);
            return Some(first..last + 1);
        }
        let least = self.least();
        let at = self.clearances.iter().position(|c| *c == least && c.is_finite())?;
        Some(at..at + 1)
    }

    /// Finds the sides: where the field gradients the blocked nodes together, across the curve, and back; where it gradients
    /// along the curve only, the two axes most across it, both ways.
    fn find_sides(&mut self, blocked: &Range<usize>) {
        let dim = self.chord.len();
        self.sides.clear();
        self.sides.resize(dim, 0.0);
        let mut strength = 0.0;
        for push in self.gradients[blocked.start * dim..blocked.end * dim].chunks_exact(dim) {
            self.sides.iter_mut().zip(push).for_each(|(s, p)| *s -= p);
            strength += norm(push);
        }
        let length = norm(&self.chord);
        if length <= 0.0 || !length.is_finite() {
            self.sides.clear();
            return;
        }
        let part = dot(&self.sides, &self.chord) / (length * length);
        self.sides.iter_mut().zip(&self.chord).for_each(|(s, w)| *s -= part * w);
        if norm(&self.sides) > 1e-6 * strength && unit(&mut self.sides) {
            self.and_back(0);
            return;
        }
        self.sides.clear();
        self.chord.iter_mut().for_each(|w| *w /= length);
        let mut axes: Vec<usize> = (0..dim).collect();
        axes.sort_by(|&i, &j| self.chord[i].abs().total_cmp(&self.chord[j].abs()));
        for &axis in axes.iter().take(2.min(dim - 1)) {
            let begin = self.sides.len();
            let chord = &self.chord;
            self.sides.extend((0..dim).map(|k| f64::from(u8::from(k == axis)) - chord[axis] * chord[k]));
            match unit(&mut self.sides[begin..]) {
                true => self.and_back(begin),
                false => self.sides.truncate(begin),
            }
        }
    }

    /// Adds the side opposite to that at `begin`.
    fn and_back(&mut self, begin: usize) {
        let dim = self.chord.len();
        self.sides.extend_from_within(begin..begin + dim);
        self.sides[begin + dim..].iter_mut().for_each(|x| *x = -*x);
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn unit(v: &mut [f64]) -> bool {
    let length = norm(v);
    v.iter_mut().for_each(|x| *x /= length);
    length > 0.0 && length.is_finite()
}
