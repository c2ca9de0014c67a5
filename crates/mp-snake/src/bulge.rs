//! Bulges: how a straight curve is bent around what blocks it, before a snake relaxes.

use crate::snake::{NODES, norm};
use crate::{Field, Snake};
use mp_cspace::{KnownFree, Space};
use std::ops::Range;

/// How the blocked nodes of a curve move aside together.
struct SideStep<'a> {
    /// The nodes between the ends that are blocked.
    blocked: Range<usize>,
    /// The direction in which they move: a unit vector (scaled).
    side: &'a [f64],
    /// The clearance they should have, their least clearance now, and how far they may move.
    wanted: f64,
    least: f64,
    longest: f64,
}

/// The greatest height of a bulge, as a part of the length of the curve. Higher bulges are rarely free.
const HIGHEST: f64 = 0.5;

/// The least increment of the height, as a part of the greatest height.
const STRIDE: f64 = 0.125;

/// The result of a [bulge](Snake::bulge).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Bulged {
    /// A bulge is free: the curve now consists of its corners.
    Fits,
    /// A bulge clears the nodes, but is not free: the curve is laid along it.
    Laid,
    /// On no side are the blocked nodes clear: the curve is unchanged.
    Nowhere,
}

impl<C: Space> Snake<'_, C> {
    /// Bends a straight curve around what blocks it, all of it to one side. If the bulge is not free, it is
    /// still a better start for [`deform`](Self::deform): the field pushes a curve that enters an obstacle by
    /// one face and leaves it by another to different sides along its length, and a curve perpendicular to a
    /// face to no side at all.
    ///
    /// The nodes from the first to the last blocked one move together to the side to which the field pushes
    /// them, until all have the clearance `wanted` (m). They move in steps of the clearance they lack, by at
    /// most half the length of the curve. If no node is blocked, the one of least clearance moves. The nodes
    /// just before and after them, moved as far, are the corners of the bulge, so that its ramps do not
    /// graze. A ramp whose middle is blocked gets one more corner, pushed away there, and so does the first
    /// piece that `blocks` reports, where it is blocked. When the bulge is not free, the other side is tried;
    /// where the field pushes along the curve only, the two axes most perpendicular to the curve, in both
    /// directions.
    ///
    /// `blocks` is called for each piece, with which of its ends are known to be free, and returns the
    /// fraction at which the piece is blocked: `None` where it is free.
    ///
    /// Evaluates the field once per node, and per step until a node is blocked, from the middle outward.
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

    /// Evaluates the field at each node between the ends of a straight curve.
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

    /// The height of the bulge at which the blocked nodes have the clearance wanted, or the most where none
    /// has.
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
            // Where all are clear already, little is lacking.
            let at_least = if least > 0.0 { 0.1 * spacing } else { stride };
            height += (step.wanted - least).max(at_least);
        }
        best.map(|b| b.1)
    }

    /// Sets the direction of [`moved_aside`](Self::moved_aside).
    fn set_side(&mut self, side: &[f64]) {
        self.velocity.clear();
        self.velocity.extend(side.iter().zip(&self.scale).map(|(x, s)| x / s));
        self.unused.resize(side.len(), 0.0);
    }

    /// The state moved by `by` in that direction, if it is in the space.
    fn moved_aside(&self, q: &C::State, by: f64) -> Option<C::State> {
        self.space.moved(q, &self.velocity, by).filter(|moved| self.space.contains(moved))
    }

    /// Whether no piece of the curve is blocked, according to `blocks`. Adds corners where they help: where
    /// the field finds the middle of the first or the last piece blocked, and at most one where `blocks`
    /// finds a piece blocked.
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
        // The last and the first piece first: they pass the obstacle, and fail most often.
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

    /// Adds a corner at fraction `at` of piece `piece`, pushed away by the field, across the piece, by the
    /// clearance it lacks. `false` where the corner is still blocked.
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
        // Refuses NaN too.
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

/// The part of the height of the bulge by which node `i` of `inner` moves: 1 for blocked nodes, less on the
/// ramps.
fn part(i: usize, blocked: &Range<usize>, inner: usize) -> f64 {
    let (up, down) =
        ((i + 1) as f64 / (blocked.start + 1) as f64, (inner - i) as f64 / (inner + 1 - blocked.end) as f64);
    up.min(down).min(1.0)
}

fn from_the_middle(range: &Range<usize>) -> impl Iterator<Item = usize> + use<> {
    let middle = (range.start + range.end) / 2;
    (middle..range.end).chain((range.start..middle).rev())
}

/// The field along a straight curve, and the sides to which to bend it. Numbers are scaled: lengths in the
/// metric.
#[derive(Clone, Debug, Default)]
pub(crate) struct Blockage {
    /// The vector from end to end.
    chord: Vec<f64>,
    /// The clearance of each node between the ends, and the gradient of the field there.
    clearances: Vec<f64>,
    gradients: Vec<f64>,
    /// The directions (unit vectors) to try, one after the other.
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

    /// From the first to the last node without clearance; the node of least clearance where all have some;
    /// `None` where the clearance is unknown.
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

    /// Finds the sides: where the field pushes the blocked nodes together, across the curve, and the
    /// opposite; where it pushes along the curve only, the two axes most perpendicular to it, in both
    /// directions.
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

    /// Adds the side opposite to the one at `begin`.
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
