//! A sampled check of several motions together, coarse to fine.

use crate::{Interrupt, Length, MotionCheck, MotionValidity, ParameterError, Space, Validity};
use std::fmt;

/// Motions of more parts than this are refused: only states far out of bounds need more.
const MAX_PARTS: f64 = 4e9;

/// What a motion must pass besides.
type Also<'c, S> = Box<dyn FnMut(&S, &S) -> bool + 'c>;

/// Tests motions at every 2ˡ-th of the states into which a verifier would cut them: steps no longer than a resolution. The level `l` can be lowered,
/// down to 0: then the states are those of the verifier, to the bit, and a robot that remembers its answers is asked nothing twice.
///
/// **What it does not promise:** between tested states anything may be hit.
///
/// Made for robots that take long to answer. [Several motions](Self::are_free) are tested together: first all of their ends, then their middles,
/// quarters, and so on, as all were for nothing if one of them hits something. Where something was hit is [remembered](Self::comes_near_collision).
pub struct CoarseToFine<'c, C: Space, V> {
    space: &'c C,
    valid: V,
    step: f64,
    level: u32,
    also: Option<Also<'c, C::State>>,
    collisions: Vec<C::State>,
    interrupt: Interrupt,
}

impl<C: Space, V> fmt::Debug for CoarseToFine<'_, C, V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut f = f.debug_struct("CoarseToFine");
        f.field("step", &self.step).field("level", &self.level).finish_non_exhaustive()
    }
}

impl<'c, C: Space, V: Validity<C::State>> CoarseToFine<'c, C, V> {
    /// Checks motions in `space` by `valid`, every 2^`level` steps that are no longer than `resolution`.
    ///
    /// # Errors
    /// When the resolution is not positive and finite, or below 10⁻⁹ of the extent.
    pub fn new(space: &'c C, valid: V, resolution: Length, level: u32) -> Result<Self, ParameterError> {
        let step = resolution.resolution_in(space)?;
        let (collisions, interrupt) = (Vec::new(), Interrupt::never());
        Ok(Self { space, valid, step, level, also: None, collisions, interrupt })
    }

    /// A motion must pass `also` too, which is asked last.
    #[must_use]
    pub fn and(self, also: impl FnMut(&C::State, &C::State) -> bool + 'c) -> Self {
        Self { also: Some(Box::new(also)), ..self }
    }

    /// Tests every 2^`level`-th state from now on.
    pub fn set_level(&mut self, level: u32) {
        self.level = level;
    }

    /// How far apart tested states are at most, in the metric of the space.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        self.step * mp_math::powi(2.0, i32::try_from(self.level).unwrap_or(i32::MAX))
    }

    /// Whether all of these motions, each from its first to its second state, are free.
    pub fn are_free(&mut self, motions: &[[&C::State; 2]]) -> bool {
        self.first_collision(motions).is_none()
            && self.also.as_mut().is_none_or(|also| motions.iter().all(|[from, to]| also(from, to)))
    }

    /// The fraction of its motion at which the first state was found that is not free.
    fn first_collision(&mut self, motions: &[[&C::State; 2]]) -> Option<f64> {
        let mut parts = Vec::with_capacity(motions.len());
        for [from, to] in motions {
            let n = (self.space.distance(from, to) / self.step).ceil();
            if n.is_nan() || n > MAX_PARTS {
                return Some(0.0);
            }
            parts.push((n as u64).max(1));
        }
        let mut order = coarse_to_fine(&parts, self.level);
        let mut batch: Vec<C::State> = Vec::new();
        let mut at: Vec<f64> = Vec::new();
        loop {
            batch.clear();
            at.clear();
            for (motion, i) in order.by_ref().take(self.valid.batch_size().max(1)) {
                let ([from, to], t) = (motions[motion], i as f64 / parts[motion] as f64);
                batch.push(self.space.interpolate(from, to, t));
                at.push(t);
            }
            if batch.is_empty() {
                return None;
            }
            if let Some(hit) = self.valid.first_invalid(&batch) {
                self.collisions.extend(batch.get(hit).cloned());
                return Some(at.get(hit).copied().unwrap_or(0.0));
            }
        }
    }

    /// Whether the motion comes near a state that was found not to be free: yes where it comes nearer than half of `reach`, in the metric of the
    /// space, no where it does not come nearer than `reach`, and in between as states of it say that are no farther apart.
    #[must_use]
    pub fn comes_near_collision(&self, from: &C::State, to: &C::State, reach: f64) -> bool {
        let length = self.space.distance(from, to);
        self.collisions.iter().rev().any(|q| self.comes_near(from, to, (0.5, 0.5 * length), q, reach))
    }

    /// The same for one state, and the part of the motion that reaches as far as `half` to both sides of its fraction `middle`.
    fn comes_near(
        &self,
        from: &C::State,
        to: &C::State,
        (middle, half): (f64, f64),
        q: &C::State,
        reach: f64,
    ) -> bool {
        let distance = self.space.distance(&self.space.interpolate(from, to, middle), q);
        if distance < reach || distance >= reach + half || half <= 0.5 * reach {
            return distance < reach;
        }
        let quarter = 0.5 * half;
        // A quarter of this part, as a fraction of the motion.
        let shift = quarter / self.space.distance(from, to);
        [middle - shift, middle + shift].iter().any(|m| self.comes_near(from, to, (*m, quarter), q, reach))
    }
}

/// The motion and the part of each state that is tested, of motions that are cut into these numbers of parts.
fn coarse_to_fine(parts: &[u64], level: u32) -> impl Iterator<Item = (usize, u64)> {
    let ends = parts.iter().enumerate().flat_map(|(motion, n)| [(motion, *n), (motion, 0)]);
    let levels = u64::BITS - parts.iter().max().map_or(0, |n| n.leading_zeros());
    let between = (level..levels).rev().flat_map(move |level| {
        parts.iter().enumerate().flat_map(move |(motion, n)| {
            let odd = (1_u64 << level..*n).step_by(2 << level);
            odd.map(move |i| (motion, i))
        })
    });
    ends.chain(between)
}

impl<C: Space, V: Validity<C::State>> MotionValidity<C::State> for CoarseToFine<'_, C, V> {
    fn check_motion(&mut self, from: &C::State, to: &C::State) -> MotionCheck {
        match self.first_collision(&[[from, to]]) {
            Some(at) => MotionCheck::Collision { at },
            None if self.also.as_mut().is_none_or(|also| also(from, to)) => {
                MotionCheck::Free { clearance: 0.0 }
            }
            None => MotionCheck::Unproven { at: 0.0 },
        }
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.interrupt = interrupt.clone();
    }
    fn is_interrupted(&mut self) -> bool {
        self.interrupt.ask()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Rn, Rng};
    use nalgebra::{Vector1, Vector2};

    #[test]
    fn the_finest_level_has_each_state_once_and_coarser_ones_are_its_beginning() {
        for n in 1..200 {
            let all: Vec<_> = coarse_to_fine(&[n], 0).collect();
            let mut sorted: Vec<u64> = all.iter().map(|(_, i)| *i).collect();
            sorted.sort_unstable();
            assert_eq!(sorted, (0..=n).collect::<Vec<_>>());
            for level in 1..9 {
                let some: Vec<_> = coarse_to_fine(&[n], level).collect();
                assert_eq!(some, all[..some.len()]);
                assert_eq!(some.len() as u64, 2 + (n - 1) / (1 << level));
            }
        }
        let two: Vec<_> = coarse_to_fine(&[4, 2], 0).collect();
        assert_eq!(two, [(0, 4), (0, 0), (1, 2), (1, 0), (0, 2), (0, 1), (0, 3), (1, 1)]);
    }

    #[test]
    fn motions_are_tested_at_its_level_in_batches_or_one_by_one() {
        struct Batched<'a>(usize, &'a mut Vec<f64>);
        impl Validity<Vector1<f64>> for Batched<'_> {
            fn is_valid(&mut self, q: &Vector1<f64>) -> bool {
                self.1.push(q.x);
                (q.x - 0.25).abs() > 0.1
            }
            fn batch_size(&self) -> usize {
                self.0
            }
        }
        let space = Rn::<1>::new([0.0], [1.0]).unwrap();
        let at = Vector1::new;
        for size in [1, 2, 64] {
            let mut seen = Vec::new();
            let valid = Batched(size, &mut seen);
            let mut check = CoarseToFine::new(&space, valid, Length::Absolute(0.0625), 2).unwrap();
            assert_eq!(check.spacing(), 0.25);
            assert!(check.are_free(&[[&at(0.5), &at(1.0)], [&at(0.75), &at(0.5)]]));
            assert_eq!(check.check_motion(&at(0.0), &at(1.0)), MotionCheck::Collision { at: 0.25 });
            // What is farther along was tested before the eighth.
            assert!(!check.comes_near_collision(&at(0.0), &at(0.2), 0.04));
            assert!(check.comes_near_collision(&at(0.0), &at(0.2), 0.12));
            assert_eq!(seen, [1.0, 0.5, 0.5, 0.75, 0.75, 1.0, 0.0, 0.5, 0.25]);
        }
        let mut check = CoarseToFine::new(&space, |_: &Vector1<f64>| true, Length::Absolute(0.1), 0).unwrap();
        assert!(check.check_motion(&at(0.0), &at(1.0)).is_free());
        assert!(!check.check_motion(&at(0.0), &at(f64::NAN)).is_free());
        let mut check = check.and(|_, to| to.x < 0.5);
        assert!(!check.check_motion(&at(0.0), &at(1.0)).is_free());
        assert!(!check.are_free(&[[&at(0.0), &at(0.1)], [&at(0.0), &at(1.0)]]));
    }

    /// Beside the distance of a point to a segment.
    #[test]
    fn motions_near_collisions_are_known() {
        let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
        let mut rng = Rng::seed(7);
        let (mut near, mut far) = (0, 0);
        for _ in 0..2000 {
            let [a, b, q] = [0; 3].map(|_| space.sample_uniform(&mut rng));
            let mut check =
                CoarseToFine::new(&space, |_: &Vector2<f64>| false, Length::Absolute(0.1), 0).unwrap();
            assert!(!check.check_motion(&q, &q).is_free());
            let u = b - a;
            let t = ((q - a).dot(&u) / u.norm_squared()).clamp(0.0, 1.0);
            let distance = (a + u * t - q).norm();
            match check.comes_near_collision(&a, &b, 0.1) {
                true => near += usize::from(distance < 0.1),
                false => far += usize::from(distance > 0.05),
            }
        }
        assert_eq!(near + far, 2000);
        assert!(near > 200 && far > 200);
    }
}
