//! Samplers: sources of states.

mod obstacles;

pub use obstacles::{Bridge, Gaussian};

use crate::{Exactly, ParameterError, Rng, Space};
use rand::RngExt;

/// A source of states.
pub trait Sampler<S> {
    /// The next state.
    fn sample(&mut self, rng: &mut Rng) -> S;
}

impl<S, T: Sampler<S> + ?Sized> Sampler<S> for &mut T {
    fn sample(&mut self, rng: &mut Rng) -> S {
        (**self).sample(rng)
    }
}
impl<S, T: Sampler<S> + ?Sized> Sampler<S> for Box<T> {
    fn sample(&mut self, rng: &mut Rng) -> S {
        (**self).sample(rng)
    }
}

/// Uniform samples of a space.
#[derive(Clone, Debug)]
pub struct Uniform<'c, C>(pub &'c C);

impl<C: Space> Sampler<C::State> for Uniform<'_, C> {
    #[inline]
    fn sample(&mut self, rng: &mut Rng) -> C::State {
        self.0.sample_uniform(rng)
    }
}

/// The Halton sequence over a space: samples that fill it more evenly than random ones (Halton
/// 1960, *On the efficiency of certain quasi-random sequences*), in bases 2, 3, 5, … one prime
/// for each dimension.
///
/// Deterministic: the random generator is not used. [`skip`](Halton::skip) gives each instance
/// another part of the sequence; [`leap`](Halton::leap) breaks the correlation of large bases,
/// noticeable above some eight dimensions (Kocis and Whiten 1997).
#[derive(Clone, Debug)]
pub struct Halton<'c, C> {
    space: &'c C,
    bases: Vec<u64>,
    point: Vec<f64>,
    index: u64,
    leap: u64,
}

impl<'c, C: Space> Halton<'c, C> {
    /// The sequence from its first point (index 1: index 0 is the corner of the cube).
    #[must_use]
    pub fn new(space: &'c C) -> Self {
        let bases = primes(space.dim());
        Self { space, point: vec![0.0; bases.len()], bases, index: 1, leap: 1 }
    }

    /// Leaves out the next `count` points.
    #[must_use]
    pub fn skip(self, count: u64) -> Self {
        Self { index: self.index.wrapping_add(count.wrapping_mul(self.leap)), ..self }
    }

    /// Takes only every `leap`-th point from here on; 409 is a good leap.
    ///
    /// # Errors
    /// When `leap` is zero or has a factor in common with a base (a prime beyond the bases has none), as
    /// the points would then not fill the space.
    pub fn leap(self, leap: u64) -> Result<Self, ParameterError> {
        if leap == 0 || self.bases.iter().any(|b| leap.is_multiple_of(*b)) {
            let expected = "coprime to the bases, the first primes, one for each dimension";
            return Err(ParameterError { name: "the leap", expected, value: leap as f64 });
        }
        Ok(Self { leap, ..self })
    }
}

impl<C: Space> Sampler<C::State> for Halton<'_, C> {
    fn sample(&mut self, _: &mut Rng) -> C::State {
        for (u, &base) in self.point.iter_mut().zip(&self.bases) {
            *u = radical_inverse(self.index, base);
        }
        self.index = self.index.wrapping_add(self.leap);
        self.space.unit_cube_to_state(&self.point)
    }
}

/// The digits of `n` in `base`, mirrored at the radix point: in \[0, 1).
fn radical_inverse(mut n: u64, base: u64) -> f64 {
    let step = 1.0 / base as f64;
    let (mut sum, mut scale) = (0.0, step);
    while n > 0 {
        sum += (n % base) as f64 * scale;
        n /= base;
        scale *= step;
    }
    sum.min(1.0 - f64::EPSILON)
}

/// The first `count` primes.
fn primes(count: usize) -> Vec<u64> {
    let mut primes: Vec<u64> = Vec::with_capacity(count);
    let mut n = 2;
    while primes.len() < count {
        if primes.iter().take_while(|p| *p * *p <= n).all(|p| n % p != 0) {
            primes.push(n);
        }
        n += 1;
    }
    primes
}

/// Samples a goal with a given probability, else another sampler's state.
#[derive(Clone, Debug)]
pub struct GoalBias<A, G> {
    sampler: A,
    goal: G,
    probability: f64,
}

impl<A, S> GoalBias<A, Exactly<S>> {
    /// With `probability` the state `goal`, else a state of `sampler`. 0.05 is customary.
    ///
    /// # Errors
    /// When the probability is not in \[0, 1\].
    pub fn new(sampler: A, goal: S, probability: f64) -> Result<Self, ParameterError> {
        Self::with_goals(sampler, Exactly(goal), probability)
    }
}

impl<A, G> GoalBias<A, G> {
    /// With `probability` a state of the sampler `goals`, else a state of `sampler`.
    ///
    /// # Errors
    /// When the probability is not in \[0, 1\].
    pub fn with_goals(sampler: A, goals: G, probability: f64) -> Result<Self, ParameterError> {
        if !(0.0..=1.0).contains(&probability) {
            let (name, expected) = ("the probability of the goal", "in [0, 1]");
            return Err(ParameterError { name, expected, value: probability });
        }
        Ok(Self { sampler, goal: goals, probability })
    }
}

impl<S, A: Sampler<S>, G: Sampler<S>> Sampler<S> for GoalBias<A, G> {
    #[inline]
    fn sample(&mut self, rng: &mut Rng) -> S {
        if rng.random::<f64>() < self.probability { self.goal.sample(rng) } else { self.sampler.sample(rng) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Configuration, Joints, Rn};
    use nalgebra::Vector2;

    #[test]
    fn halton_is_the_known_sequence() {
        let square = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
        let mut halton = Halton::new(&square);
        let mut rng = Rng::seed(0);
        let expected = [(1.0 / 2.0, 1.0 / 3.0), (1.0 / 4.0, 2.0 / 3.0), (3.0 / 4.0, 1.0 / 9.0)];
        for (x, y) in expected {
            assert!((halton.sample(&mut rng) - Vector2::new(x, y)).norm() < 1e-15);
        }
        let (mut from_third, mut all) = (Halton::new(&square).skip(2), Halton::new(&square));
        let third = [all.sample(&mut rng), all.sample(&mut rng), all.sample(&mut rng)][2];
        assert_eq!(from_third.sample(&mut rng), third);
        assert_eq!(rng, Rng::seed(0), "the generator is left alone");
    }

    /// Each eighth of every axis gets its share, in 12 dimensions, with leaps too.
    #[test]
    fn halton_fills_every_axis() {
        let cube = Joints::<Configuration>::intervals(&[0.0; 12], &[1.0; 12]).unwrap();
        assert!(Halton::new(&cube).leap(6).is_err() && Halton::new(&cube).leap(0).is_err());
        let mut rng = Rng::seed(0);
        let n = 4000;
        for mut halton in [Halton::new(&cube), Halton::new(&cube).skip(1000).leap(409).unwrap()] {
            let points: Vec<_> = (0..n).map(|_| halton.sample(&mut rng)).collect();
            for axis in 0..12 {
                for part in 0..8 {
                    let inside = points.iter().filter(|p| (p[axis] * 8.0) as usize == part).count();
                    assert!(inside.abs_diff(n / 8) < n / 80, "axis {axis} part {part}: {inside}");
                }
            }
        }
    }

    #[test]
    fn goals_come_as_often_as_asked() {
        let square = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
        let goal = Vector2::new(0.5, 0.25);
        let mut rng = Rng::seed(3);
        for probability in [0.0, 0.3, 1.0] {
            let mut sampler = GoalBias::new(Uniform(&square), goal, probability).unwrap();
            let hits = (0..10_000).filter(|_| sampler.sample(&mut rng) == goal).count();
            assert!((hits as f64 / 10_000.0 - probability).abs() < 0.02);
        }
        for p in [-0.1, 1.1, f64::NAN] {
            assert!(GoalBias::new(Uniform(&square), goal, p).is_err());
        }
    }
}
