//! A plain sampled check, to verify finished paths where no clearance is known.

use crate::Length;
use crate::{MotionCheck, MotionValidity, ParameterError, Space, Validity};

/// Walks a motion from end to end in equal steps, testing every state on the way.
///
/// Meant to verify the paths of planners that use [`Discrete`](super::Discrete), at a step some
/// twenty times finer; it shares no code with it. Where a clearance is known a certified verifier
/// proves what this one only samples.
#[derive(Clone, Debug)]
pub struct FineDiscrete<'c, C, V> {
    space: &'c C,
    valid: V,
    step: f64,
}

impl<'c, C: Space, V: Validity<C::State>> FineDiscrete<'c, C, V> {
    /// Walks motions of `space` in steps no longer than `resolution`.
    ///
    /// # Errors
    /// When the resolution is not positive and finite, or below 10⁻⁹ of the extent.
    pub fn new(space: &'c C, valid: V, resolution: Length) -> Result<Self, ParameterError> {
        Ok(Self { space, valid, step: resolution.resolution_in(space)? })
    }
}

impl<C: Space, V: Validity<C::State>> MotionValidity<C::State> for FineDiscrete<'_, C, V> {
    fn check_motion(&mut self, from: &C::State, to: &C::State) -> MotionCheck {
        let length = self.space.distance(from, to);
        // Written so that NaN fails it too.
        let walkable = length / self.step < 1e10;
        if !walkable {
            return MotionCheck::Unproven { at: 0.0 };
        }
        let mut walked = 0.0;
        let mut steps = 0_u64;
        while walked < length {
            let t = walked / length;
            if !self.valid.is_valid(&self.space.interpolate(from, to, t)) {
                return MotionCheck::Collision { at: t };
            }
            steps += 1;
            walked = steps as f64 * self.step;
        }
        if self.valid.is_valid(from) && self.valid.is_valid(to) {
            MotionCheck::Free { clearance: 0.0 }
        } else {
            MotionCheck::Collision { at: 1.0 }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rn;
    use nalgebra::Vector1;

    #[test]
    fn finds_what_is_wider_than_a_step() {
        let space = Rn::<1>::new([0.0], [1.0]).unwrap();
        for i in 0..=100 {
            let at = f64::from(i) / 100.0;
            let valid = |q: &Vector1<f64>| (q.x - at).abs() > 0.006;
            let mut check = FineDiscrete::new(&space, valid, Length::Absolute(0.01)).unwrap();
            assert!(!check.check_motion(&[0.0].into(), &[1.0].into()).is_free());
            assert!(!check.check_motion(&[at].into(), &[at].into()).is_free());
        }
        let mut check = FineDiscrete::new(&space, |_: &Vector1<f64>| true, Length::Absolute(0.01)).unwrap();
        assert!(check.check_motion(&[0.0].into(), &[1.0].into()).is_free());
        assert!(!check.check_motion(&[0.0].into(), &[f64::NAN].into()).is_free());
    }
}
