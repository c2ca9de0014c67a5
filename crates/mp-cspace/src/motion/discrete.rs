//! The sampled motion check.

use crate::Length;
use crate::{KnownFree, MotionCheck, MotionValidity, ParameterError, Space, Validity};

/// Checks a motion at states no farther apart than a resolution.
///
/// **What it does not promise:** between tested states anything may be hit. A wall thinner than
/// the resolution can be passed; [`Certified`](super::Certified) never does that.
///
/// The ends are tested first, then the states between in van der Corput (bit-reversed) order,
/// which finds obstacles of any size early. The states tested do not depend on the direction of the motion.
#[derive(Clone, Debug)]
pub struct Discrete<'c, C: Space, V> {
    /// The space to interpolate in.
    pub space: &'c C,
    /// Whether a state is free.
    pub valid: V,
    step: f64,
    batch: Vec<C::State>,
    times: Vec<f64>,
}

/// Motions of more parts than this are refused: only states far out of bounds need more.
const MAX_PARTS: f64 = 4e9;

impl<'c, C: Space, V: Validity<C::State>> Discrete<'c, C, V> {
    /// Checks motions in `space` by `valid` every `resolution`.
    ///
    /// # Errors
    /// When the resolution is not positive and finite, or below 10⁻⁹ of the extent.
    pub fn new(space: &'c C, valid: V, resolution: Length) -> Result<Self, ParameterError> {
        let step = resolution.resolution_in(space)?;
        Ok(Self { space, valid, step, batch: Vec::new(), times: Vec::new() })
    }

    /// The greatest distance between tested states, in the metric of the space.
    #[must_use]
    pub fn step(&self) -> f64 {
        self.step
    }

    /// The first fraction `i / parts`, `0 < i < parts` in bit-reversed order, that is not free; tests one
    /// state at a time.
    fn one_by_one(&mut self, from: &C::State, to: &C::State, parts: u64) -> Option<f64> {
        let mut q = from.clone();
        bit_reversed(parts).find_map(|i| {
            let t = i as f64 / parts as f64;
            self.space.interpolate_into(from, to, t, &mut q);
            (!self.valid.is_valid(&q)).then_some(t)
        })
    }

    /// The same in batches of `size`.
    fn in_batches(&mut self, from: &C::State, to: &C::State, parts: u64, size: usize) -> Option<f64> {
        let mut order = bit_reversed(parts);
        loop {
            self.times.clear();
            self.times.extend(order.by_ref().take(size).map(|i| i as f64 / parts as f64));
            let n = self.times.len();
            if n == 0 {
                return None;
            }
            while self.batch.len() < n {
                self.batch.push(from.clone());
            }
            for (q, t) in self.batch.iter_mut().zip(&self.times) {
                self.space.interpolate_into(from, to, *t, q);
            }
            if let Some(i) = self.valid.first_invalid(&self.batch[..n]) {
                return Some(self.times.get(i).copied().unwrap_or(0.0));
            }
        }
    }
}

/// The numbers `1..parts` ordered by their reversed bits: middle, quarters, eighths, …
pub(super) fn bit_reversed(parts: u64) -> impl Iterator<Item = u64> {
    let bits = u64::BITS - parts.saturating_sub(1).leading_zeros();
    let shift = (u64::BITS - bits) % u64::BITS;
    (1..1_u64 << bits).map(move |j| j.reverse_bits() >> shift).filter(move |&i| i < parts)
}

impl<C: Space, V: Validity<C::State>> MotionValidity<C::State> for Discrete<'_, C, V> {
    fn check_motion(&mut self, from: &C::State, to: &C::State) -> MotionCheck {
        self.check_extension(from, to, KnownFree::Neither)
    }

    fn check_extension(&mut self, from: &C::State, to: &C::State, known: KnownFree) -> MotionCheck {
        let parts = (self.space.distance(from, to) / self.step).ceil();
        if parts.is_nan() || parts > MAX_PARTS {
            return MotionCheck::Unproven { at: 0.0 };
        }
        if known != KnownFree::To && !self.valid.is_valid(to) {
            return MotionCheck::Collision { at: 1.0 };
        }
        if known != KnownFree::From && !self.valid.is_valid(from) {
            return MotionCheck::Collision { at: 0.0 };
        }
        let parts = parts as u64;
        let hit = match self.valid.batch_size() {
            0 | 1 => self.one_by_one(from, to, parts),
            size => self.in_batches(from, to, parts, size),
        };
        match hit {
            Some(at) => MotionCheck::Collision { at },
            None => MotionCheck::Free { clearance: 0.0 },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rn;
    use nalgebra::Vector1;

    fn line() -> Rn<1> {
        Rn::new([0.0], [1.0]).unwrap()
    }

    #[test]
    fn bit_reversal_visits_each_once() {
        for parts in 0..200 {
            let mut seen: Vec<u64> = bit_reversed(parts).collect();
            if parts == 8 {
                assert_eq!(seen, [4, 2, 6, 1, 5, 3, 7]);
            }
            seen.sort_unstable();
            assert_eq!(seen, (1..parts).collect::<Vec<_>>());
        }
    }

    #[test]
    fn tests_every_step_and_skips_the_known_end() {
        let space = line();
        let mut seen = Vec::new();
        let valid = |q: &Vector1<f64>| {
            seen.push(q.x);
            true
        };
        let mut check = Discrete::new(&space, valid, Length::Absolute(0.3)).unwrap();
        assert!(check.check_extension(&[0.0].into(), &[1.0].into(), KnownFree::From).is_free());
        assert_eq!(seen, [1.0, 0.5, 0.25, 0.75]);
    }

    /// A validity that tests states in batches.
    struct Batched(usize, f64);
    impl Validity<Vector1<f64>> for Batched {
        fn is_valid(&mut self, q: &Vector1<f64>) -> bool {
            (q.x - self.1).abs() > 0.02
        }
        fn batch_size(&self) -> usize {
            self.0
        }
    }

    #[test]
    fn batches_agree_with_single_states() {
        let space = line();
        for at in [0.0, 0.013, 0.37, 0.5, 0.99, 1.0, 2.0] {
            let check = |size| {
                let mut check = Discrete::new(&space, Batched(size, at), Length::Fraction(0.01)).unwrap();
                check.check_motion(&[0.0].into(), &[1.0].into())
            };
            assert_eq!(check(1).is_free(), at > 1.5);
            for size in [2, 7, 8, 1000] {
                assert_eq!(check(1), check(size));
            }
        }
    }

    #[test]
    fn refuses_bad_resolutions_and_states() {
        let space = line();
        for r in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-12] {
            assert!(Discrete::new(&space, |_: &Vector1<f64>| true, Length::Absolute(r)).is_err());
            assert!(Discrete::new(&space, |_: &Vector1<f64>| true, Length::Fraction(r)).is_err());
        }
        let mut check = Discrete::new(&space, |_: &Vector1<f64>| true, Length::Absolute(0.1)).unwrap();
        for x in [f64::NAN, f64::INFINITY, 1e300] {
            assert!(!check.check_motion(&[0.0].into(), &[x].into()).is_free());
        }
    }
}
