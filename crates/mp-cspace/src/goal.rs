//! Goals: sets of states to reach.

use crate::{Factored, ParameterError, Rng, Sampler, Space};
use rand::RngExt;

/// A set of states to reach.
pub trait Goal<S> {
    /// Whether `q` is in the goal set.
    fn reached(&self, q: &S) -> bool;
}
impl<S, F: Fn(&S) -> bool> Goal<S> for F {
    fn reached(&self, q: &S) -> bool {
        self(q)
    }
}

/// Exactly one state, as a goal and as a sampler.
#[derive(Clone, Debug, PartialEq)]
pub struct Exactly<S>(pub S);

impl<S: PartialEq> Goal<S> for Exactly<S> {
    fn reached(&self, q: &S) -> bool {
        *q == self.0
    }
}
impl<S: Clone> Sampler<S> for Exactly<S> {
    fn sample(&mut self, _: &mut Rng) -> S {
        self.0.clone()
    }
}

/// The states within a radius of one, in the metric of the space (inclusive).
#[derive(Clone, Debug)]
pub struct Ball<'c, C: Space> {
    space: &'c C,
    center: C::State,
    radius: f64,
}

impl<'c, C: Space> Ball<'c, C> {
    /// The ball of `radius` about `center`.
    ///
    /// # Errors
    /// When the radius is not positive and finite.
    pub fn new(space: &'c C, center: C::State, radius: f64) -> Result<Self, ParameterError> {
        Ok(Self { space, center, radius: ParameterError::positive("the radius", radius)? })
    }

    /// The state in the middle.
    #[must_use]
    pub fn center(&self) -> &C::State {
        &self.center
    }
}

impl<C: Space> Goal<C::State> for Ball<'_, C> {
    fn reached(&self, q: &C::State) -> bool {
        self.space.distance(q, &self.center) <= self.radius
    }
}

/// Samples lie on the motion from the centre toward a uniform sample of the space. They reach every part
/// of the ball, but are uniform in it only where the space looks alike in all directions.
impl<C: Space> Sampler<C::State> for Ball<'_, C> {
    fn sample(&mut self, rng: &mut Rng) -> C::State {
        let q = self.space.sample_uniform(rng);
        let distance = self.space.distance(&self.center, &q);
        let share: f64 = rng.random();
        let reach = self.radius * mp_math::powf(share, 1.0 / self.space.dim().max(1) as f64);
        if distance <= reach { q } else { self.space.interpolate(&self.center, &q, reach / distance) }
    }
}

/// A goal that fixes some components and leaves the others free: an arm whose last joints do not
/// matter, a body whose rotation does not.
///
/// Components are the [factors](Factored) of the space: x, y and rotation in SE(2); x, y, z and
/// rotation in SE(3). As a goal it holds the states whose fixed factors are within the tolerance,
/// each by its own distance (metres or radians). As a sampler it yields states with the fixed
/// factors exact and the others random.
///
/// ```
/// use mp_cspace::{Configuration, FixedFactors, Goal, Rng, Sampler, Se2, Se2State};
/// let space = Se2::new([0.0, 0.0], [1.0, 1.0])?;
/// let mut goal = FixedFactors::new(&space, Se2State::new(0.9, 0.1, 0.0), [0, 1], 0.01)?;
/// assert!(goal.reached(&Se2State::new(0.9, 0.105, 2.0)));
/// assert!(!goal.reached(&Se2State::new(0.9, 0.2, 0.0)));
/// let sample = goal.sample(&mut Rng::seed(1));
/// assert_eq!([sample.translation.x, sample.translation.y], [0.9, 0.1]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FixedFactors<'c, C: Space> {
    space: &'c C,
    state: C::State,
    fixed: Vec<bool>,
    tolerance: f64,
}

impl<'c, C: Factored> FixedFactors<'c, C> {
    /// The states that agree with `state` in the factors listed, up to `tolerance` (0: exactly, as
    /// its own samples do).
    ///
    /// # Errors
    /// When no factor is listed, or a listed one is not a factor of the space; when the tolerance is
    /// negative or not finite.
    pub fn new(
        space: &'c C,
        state: C::State,
        factors: impl IntoIterator<Item = usize>,
        tolerance: f64,
    ) -> Result<Self, ParameterError> {
        let mut fixed = vec![false; space.factors()];
        for factor in factors {
            let Some(entry) = fixed.get_mut(factor) else {
                let (name, expected) = ("a fixed factor", "below the number of factors of the space");
                return Err(ParameterError { name, expected, value: factor as f64 });
            };
            *entry = true;
        }
        if !fixed.contains(&true) {
            let (name, expected) = ("the number of fixed factors", "at least 1");
            return Err(ParameterError { name, expected, value: 0.0 });
        }
        if !(tolerance >= 0.0 && tolerance.is_finite()) {
            let (name, expected) = ("the tolerance", "finite and not negative");
            return Err(ParameterError { name, expected, value: tolerance });
        }
        Ok(Self { space, state, fixed, tolerance })
    }
}

impl<C: Factored> Goal<C::State> for FixedFactors<'_, C> {
    fn reached(&self, q: &C::State) -> bool {
        let mut within = true;
        self.space.each_factor(q, &self.state, &mut |i, d| within &= !self.fixed[i] || d <= self.tolerance);
        within
    }
}

impl<C: Factored> Sampler<C::State> for FixedFactors<'_, C> {
    fn sample(&mut self, rng: &mut Rng) -> C::State {
        let mut q = self.space.sample_uniform(rng);
        for factor in (0..self.fixed.len()).filter(|&i| self.fixed[i]) {
            let from = q.clone();
            self.space.interpolate_factor(factor, &from, &self.state, 1.0, &mut q);
        }
        q
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Configuration, Joints, Rn, Se3};
    use nalgebra::Vector2;

    /// Samples have the fixed factors exactly, and vary over much of the range of the others.
    fn holds<C: Factored>(space: &C, fixed: &[usize]) {
        let mut rng = Rng::seed(2);
        let state = space.sample_uniform(&mut rng);
        let mut goal = FixedFactors::new(space, state.clone(), fixed.iter().copied(), 0.0).unwrap();
        let mut farthest = vec![0.0_f64; space.factors()];
        for _ in 0..300 {
            let q = goal.sample(&mut rng);
            assert!(space.contains(&q) && goal.reached(&q), "{q:?}");
            space.each_factor(&q, &state, &mut |i, d| farthest[i] = farthest[i].max(d));
            assert!(!goal.reached(&space.sample_uniform(&mut rng)));
        }
        for (i, far) in farthest.iter().enumerate() {
            let free = *far > 0.4 * space.factor_extent(i);
            assert_eq!(free, !fixed.contains(&i), "factor {i} varies by {far}");
        }
    }

    #[test]
    fn some_components_are_fixed_and_others_free() {
        let body = Se3::new([0.0; 3], [1.0; 3]).unwrap();
        let arm = Joints::<Configuration>::intervals(&[-1.0; 5], &[1.0; 5]).unwrap();
        for fixed in [vec![0, 1, 2], vec![3], vec![1]] {
            holds(&body, &fixed);
            holds(&arm, &fixed);
        }
        let goal = FixedFactors::new(&arm, Configuration::zeros(5), [1, 1, 4], 0.1).unwrap();
        assert!(goal.reached(&Configuration::from(vec![1.0, 0.1, 1.0, 1.0, -0.05])));
        assert!(!goal.reached(&Configuration::from(vec![0.0, 0.0, 0.0, 0.0, 0.11])));
        // What is not a number is a mark of components that are free, and is reached by nothing in those that are fixed.
        let only = Configuration::from(vec![f64::NAN, 0.1, f64::NAN, f64::NAN, f64::NAN]);
        let reached = |fixed: usize| {
            FixedFactors::new(&arm, only.clone(), [fixed], 0.1).unwrap().reached(&Configuration::zeros(5))
        };
        assert!(reached(1) && !reached(0));
        let refused = |factors: &[usize], tolerance| {
            let goal = FixedFactors::new(&arm, Configuration::zeros(5), factors.iter().copied(), tolerance);
            goal.unwrap_err().to_string()
        };
        assert!(refused(&[], 0.1).contains("at least 1"));
        assert!(refused(&[5], 0.1).contains("below the number of factors"));
        assert!(refused(&[1], -0.1).contains("not negative"));
        assert!(refused(&[1], f64::NAN).contains("finite"));
    }

    #[test]
    fn balls_hold_their_samples() {
        let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
        let mut ball = Ball::new(&space, Vector2::new(0.9, 0.9), 0.2).unwrap();
        let mut rng = Rng::seed(1);
        for _ in 0..1000 {
            let q = ball.sample(&mut rng);
            assert!(space.contains(&q) && (q - ball.center()).norm() <= 0.2 + 1e-12);
        }
        assert!(ball.reached(&Vector2::new(0.9, 0.75)) && !ball.reached(&Vector2::new(0.9, 0.65)));
        assert!(Ball::new(&space, Vector2::zeros(), 0.0).is_err());
        assert!(Exactly(1.0).reached(&1.0) && !Exactly(1.0).reached(&1.5));
        assert_eq!(Exactly(1.0).sample(&mut rng), 1.0);
    }
}
