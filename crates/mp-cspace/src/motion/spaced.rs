//! The sampled motion check of robots that test several states at once.

use super::discrete::bit_reversed;
use crate::{KnownFree, MotionCheck, MotionClearance, MotionValidity, ParameterError, Space};

/// How many states are tested together.
const AT_ONCE: usize = 8;

/// Motions of more steps than this are refused: only states far out of bounds need more.
const MAX_STEPS: f64 = 1e9;

/// Tests motions for a clearance at states between which no point of the robot travels farther than a step.
///
/// **What it does not promise:** between tested states a point may come nearer, by half a step at most. It is a filter before
/// [`Certified`](super::Certified), for robots that [test eight states](MotionClearance::first_within) at about the cost of one: where motions
/// pass near obstacles it asks for a few of these where a certificate takes many intervals.
///
/// The ends and the middle are tested first, then states evenly between in bit-reversed order. Of the shortest motion eight states are tested
/// too, as they cost no more than one.
#[derive(Clone, Debug)]
pub struct Spaced<'c, C: Space, V> {
    /// The space to interpolate in.
    pub space: &'c C,
    /// The robot among its obstacles.
    pub valid: V,
    clearance: f64,
    step: f64,
    /// Scratch memory.
    states: [Option<C::State>; AT_ONCE],
}

impl<'c, C, V> Spaced<'c, C, V>
where
    C: Space,
    V: MotionClearance<C::State>,
{
    /// Tests motions in `space` for `clearance` (m), every `step` (m).
    ///
    /// # Errors
    /// When one of these is not positive and finite.
    pub fn new(space: &'c C, valid: V, clearance: f64, step: f64) -> Result<Self, ParameterError> {
        let clearance = ParameterError::positive("the clearance", clearance)?;
        let step = ParameterError::positive("the step", step)?;
        Ok(Self { space, valid, clearance, step, states: [const { None }; AT_ONCE] })
    }
}

impl<C, V> MotionValidity<C::State> for Spaced<'_, C, V>
where
    C: Space,
    V: MotionClearance<C::State>,
{
    fn check_motion(&mut self, from: &C::State, to: &C::State) -> MotionCheck {
        self.check_extension(from, to, KnownFree::Neither)
    }

    fn check_extension(&mut self, from: &C::State, to: &C::State, _: KnownFree) -> MotionCheck {
        let steps = (self.valid.motion_bound(from, to) / self.step).ceil();
        // Written so that NaN fails it too.
        let is_usual = steps < MAX_STEPS;
        if !is_usual {
            return MotionCheck::Unproven { at: 0.0 };
        }
        // One state more than steps, and as many as are tested together anyway.
        let parts = (steps as u64 + 1).next_multiple_of(AT_ONCE as u64) - 1;
        let mut order = [parts, 0].into_iter().chain(bit_reversed(parts));
        loop {
            let mut at = [0.0; AT_ONCE];
            let mut count = 0;
            for i in order.by_ref().take(AT_ONCE) {
                at[count] = i as f64 / parts as f64;
                let state = self.states[count].get_or_insert_with(|| from.clone());
                self.space.interpolate_into(from, to, at[count], state);
                count += 1;
            }
            if count == 0 {
                return MotionCheck::Free { clearance: (self.clearance - 0.5 * self.step).max(0.0) };
            }
            let states: [&C::State; AT_ONCE] =
                std::array::from_fn(|k| self.states[k].as_ref().unwrap_or(from));
            if let Some(found) = self.valid.first_within(&states[..count], self.clearance) {
                return MotionCheck::Collision { at: at.get(found).copied().unwrap_or(0.0) };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Clearance, Rn, Rng};
    use nalgebra::Vector2;

    /// A point beside a disc; counts what is asked.
    struct Disc(u32);
    impl Clearance<Vector2<f64>> for Disc {
        fn clearance(&mut self, q: &Vector2<f64>, _: f64) -> f64 {
            self.0 += 1;
            ((q - Vector2::new(0.5, 0.5)).norm() - 0.2).max(0.0)
        }
    }
    impl MotionClearance<Vector2<f64>> for Disc {
        fn motion_bound(&self, from: &Vector2<f64>, to: &Vector2<f64>) -> f64 {
            (to - from).norm()
        }
    }

    /// How near the segment comes to the disc.
    fn along(a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
        let (u, c) = (b - a, Vector2::new(0.5, 0.5));
        let t = ((c - a).dot(&u) / u.norm_squared()).clamp(0.0, 1.0);
        (a + u * t - c).norm() - 0.2
    }

    #[test]
    fn what_it_finds_free_is_nearer_by_half_a_step_at_most() {
        let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
        let mut rng = Rng::seed(3);
        let (mut free, mut refused) = (0, 0);
        for round in 0..4000 {
            let step = [0.01, 0.1, 0.5][round % 3];
            let mut check = Spaced::new(&space, Disc(0), 0.05, step).unwrap();
            let (a, b) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
            match check.check_motion(&a, &b) {
                MotionCheck::Free { clearance } => {
                    let steps = (b - a).norm() / step;
                    assert!(along(&a, &b) >= 0.05 - step / 2.0 && along(&a, &b) >= clearance - 1e-12);
                    let asked = f64::from(check.valid.0);
                    assert!(asked % 8.0 == 0.0 && asked > steps && asked < steps + 10.0, "{asked} {steps}");
                    free += 1;
                }
                MotionCheck::Collision { at } => {
                    assert!((a.lerp(&b, at) - Vector2::new(0.5, 0.5)).norm() - 0.2 < 0.05);
                    refused += 1;
                }
                MotionCheck::Unproven { .. } => panic!(),
            }
        }
        assert!(free > 500 && refused > 500);
    }

    #[test]
    fn refuses_bad_steps_and_states() {
        let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Spaced::new(&space, Disc(0), bad, 0.1).is_err());
            assert!(Spaced::new(&space, Disc(0), 0.1, bad).is_err());
        }
        let mut check = Spaced::new(&space, Disc(0), 0.05, 0.1).unwrap();
        let origin = Vector2::new(0.0, 0.0);
        assert!(check.check_motion(&origin, &origin).is_free());
        for x in [f64::NAN, f64::INFINITY, 1e300] {
            assert!(!check.check_motion(&origin, &Vector2::new(x, 0.0)).is_free());
        }
    }
}
