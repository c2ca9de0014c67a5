//! Goals.

use crate::{ParameterError, Rng, Sampler, Space};
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

/// Samples lie in the ball, toward uniform samples of the space: not uniform in the ball unless
/// the space looks alike in all directions, but everywhere in it.
impl<C: Space> Sampler<C::State> for Ball<'_, C> {
    fn sample(&mut self, rng: &mut Rng) -> C::State {
        let q = self.space.sample_uniform(rng);
        let distance = self.space.distance(&self.center, &q);
        let share: f64 = rng.random();
        let reach = self.radius * share.powf(1.0 / self.space.dim().max(1) as f64);
        if distance <= reach { q } else { self.space.interpolate(&self.center, &q, reach / distance) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rn;
    use nalgebra::Vector2;

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
