//! Curves of arms.

use super::reference_arm::{Placement, Travels};
use super::{ArmVerifier, MAX_PARTS, MAX_TRAVEL, PartCheck};
use mp_cspace::{Coordinates, Curve, MotionCheck, Space};

/// The first fault of a curve is found to this part of a piece.
const FIRST_FAULT: f64 = 1e-3;

/// A bound on the rounding of the range of a polynomial, as a part of its values.
const ROUNDING: f64 = 1e-12;

/// What each coefficient of a polynomial of degree 5 counts in its Bernstein coefficients.
const BERNSTEIN: [[f64; 6]; 6] = [
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 0.2, 0.0, 0.0, 0.0, 0.0],
    [1.0, 0.4, 0.1, 0.0, 0.0, 0.0],
    [1.0, 0.6, 0.3, 0.1, 0.0, 0.0],
    [1.0, 0.8, 0.6, 0.4, 0.2, 0.0],
    [1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
];

/// Between which numbers a polynomial stays where its variable is in \[a, b\]: the least and the largest of its Bernstein coefficients
/// there.
fn control_range(mut c: [f64; 6], a: f64, b: f64) -> [f64; 2] {
    // Shifted to begin at `a`, by Horner's scheme, then scaled.
    for first in 0..5 {
        for i in (first..5).rev() {
            c[i] += a * c[i + 1];
        }
    }
    let mut scale = 1.0;
    for x in &mut c {
        *x *= scale;
        scale *= b - a;
    }
    let point = |k: usize| (0..=k).map(|i| BERNSTEIN[k][i] * c[i]).sum::<f64>();
    let points: [f64; 6] = std::array::from_fn(point);
    if points.iter().any(|x| !x.is_finite()) {
        return [f64::NAN; 2];
    }
    points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(*x), high.max(*x)])
}

impl<C> ArmVerifier<'_, C>
where
    C: Space,
    C::State: Coordinates,
{
    /// Whether a curve is free; `None` where the base floats: its pose is no row of independent coordinates.
    pub(super) fn curve(&mut self, curve: &dyn Curve) -> Option<MotionCheck> {
        if self.tree.pose > 0 || curve.pieces() == 0 {
            return None;
        }
        let (start, travels) = self.around(curve, 0.0, curve.pieces() as f64);
        // Written so that NaN is refused.
        if !travels.joints.iter().all(|travel| *travel < MAX_TRAVEL) {
            return Some(MotionCheck::Unproven { at: 0.0 });
        }
        let start = C::State::from_fn(start.as_slice().len(), |i| curve.polynomial(0, i)[0]);
        if self.is_nested(&start) {
            return Some(MotionCheck::Collision { at: 0.0 });
        }
        Some(match self.prove_curve(curve) {
            MotionCheck::Free { clearance } => MotionCheck::Free { clearance },
            other if self.interrupt.raised().is_some() => other,
            _ if self.touches(&start) => MotionCheck::Collision { at: 0.0 },
            other => other,
        })
    }

    /// Proves a curve in parts, the first ones first. What is found at a part ends the search behind it only: the fault is the first one.
    fn prove_curve(&mut self, curve: &dyn Curve) -> MotionCheck {
        self.forget();
        let pieces = curve.pieces() as f64;
        let (mut least, mut hit, mut near_contact, mut placed) =
            (f64::INFINITY, None, None, Placement::default());
        let mut open = vec![(0.0, pieces, (0..self.pairs.len()).collect::<Vec<_>>())];
        let limit = self.parts + MAX_PARTS;
        while let Some((a, b, pairs)) = open.pop() {
            let at = 0.5 * (a + b);
            self.parts += 1;
            if self.parts > limit {
                return MotionCheck::Unproven { at: at / pieces };
            }
            let (middle, travels) = self.around(curve, a, b);
            match self.part(&middle, &travels, &pairs, &mut placed, &mut least) {
                PartCheck::Apart => continue,
                PartCheck::Near(near) => {
                    let [before, after] = near.pairs;
                    open.extend([(at, b, after), (a, at, before)]);
                    continue;
                }
                PartCheck::Collision => (hit, near_contact) = (Some(at), None),
                PartCheck::Unproven => near_contact = Some(at),
            }
            if self.interrupt.raised().is_some() {
                return MotionCheck::Unproven { at: at / pieces };
            }
            open.clear();
            if b - a > FIRST_FAULT {
                open.push((a, at, pairs));
            }
        }
        match (near_contact, hit) {
            (None, None) => MotionCheck::Free { clearance: least },
            (None, Some(hit)) => MotionCheck::Collision { at: hit / pieces },
            (Some(near), hit) => match hit.and_then(|hit| self.first_contact(curve, near, hit)) {
                Some(hit) => MotionCheck::Collision { at: hit / pieces },
                None => MotionCheck::Unproven { at: near / pieces },
            },
        }
    }

    /// Where a curve first touches something between two parameters, at the first of which it is too near to contact to tell and at the second
    /// in contact; `None` where it is clear of everything in between.
    fn first_contact(&mut self, curve: &dyn Curve, mut near: f64, mut hit: f64) -> Option<f64> {
        while hit - near > FIRST_FAULT {
            let at = 0.5 * (near + hit);
            let (q, _) = self.around(curve, at, at);
            if self.touches(&q) {
                hit = at;
            } else if self.is_near(&q) {
                near = at;
            } else {
                return None;
            }
        }
        Some(hit)
    }

    /// The configuration of a curve in the middle between two parameters, in pieces, and how far the coordinates are from it at most between
    /// them: polynomials stay between their control points.
    fn around(&self, curve: &dyn Curve, a: f64, b: f64) -> (C::State, Travels) {
        let (first, last) = (a.floor() as usize, (b.ceil() as usize).min(curve.pieces()));
        let at = 0.5 * (a + b);
        let value = |coordinate: usize| {
            let piece = (at.floor() as usize).min(curve.pieces() - 1);
            let [c @ .., highest] = curve.polynomial(piece, coordinate);
            c.iter().rev().fold(highest, |sum, c| sum * (at - piece as f64) + c)
        };
        let middle = C::State::from_fn(self.tree.coordinates.len(), value);
        let far = |(coordinate, middle): (usize, &f64)| {
            let piece = |i: usize| {
                let part = |x: f64| (x - i as f64).clamp(0.0, 1.0);
                let [low, high] = control_range(curve.polynomial(i, coordinate), part(a), part(b));
                [high - middle, middle - low]
            };
            // Written so that NaN stays.
            let most = |most: f64, x: f64| if x <= most { most } else { x };
            (first..last).flat_map(piece).fold(0.0, most) + ROUNDING * (1.0 + middle.abs())
        };
        let joints = middle.as_slice().iter().enumerate().map(far).collect();
        (middle, Travels { joints, ahead: None, base: None })
    }

    /// Whether any pair is too near to contact to tell at `q`.
    fn is_near(&mut self, q: &C::State) -> bool {
        let mut placed = Placement::default();
        self.tree.place(q.as_slice(), &mut placed);
        (0..self.pairs.len()).any(|i| {
            let needed = self.kept_from(&self.pairs[i]) + 2.0 * self.tolerance;
            self.distance(i, &placed, [needed; 2]).is_err()
        })
    }
}
