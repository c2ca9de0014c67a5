//! Samplers near obstacles: the Gaussian strategy and the bridge test.

use super::Sampler;
use crate::{ParameterError, Rng, Space, Validity};

/// A state between `q` and a state drawn uniformly, at a normally distributed distance from `q`: of mean
/// zero and standard deviation `sigma`, its sign dropped.
fn normal_neighbor<C: Space>(space: &C, q: &C::State, sigma: f64, rng: &mut Rng) -> C::State {
    let other = space.sample_uniform(rng);
    let normal = rng.normal();
    let (most, distance) = (space.distance(q, &other), (sigma * normal).abs());
    if distance >= most { other } else { space.interpolate(q, &other, distance / most) }
}

macro_rules! obstacle_sampler {
    ($name:ident) => {
        impl<'c, C: Space, V: Validity<C::State>> $name<'c, C, V> {
            /// Samples of `space`, where `valid` tells which states are free; `sigma` is the standard
            /// deviation of the distance, in the metric of the space.
            ///
            /// # Errors
            /// When `sigma` is not positive and finite.
            pub fn new(space: &'c C, valid: V, sigma: f64) -> Result<Self, ParameterError> {
                let sigma = ParameterError::positive("sigma", sigma)?;
                Ok(Self { space, valid, sigma, tries: 1000 })
            }

            /// The same with another limit of tries per sample; 0 counts as 1.
            #[must_use]
            pub fn with_tries(self, tries: u32) -> Self {
                Self { tries: tries.max(1), ..self }
            }

            /// The test that tells which states are free.
            pub fn valid(&self) -> &V {
                &self.valid
            }
        }

        /// When all tries up to the limit fail, the sample is drawn uniformly and need not be free.
        impl<C: Space, V: Validity<C::State>> Sampler<C::State> for $name<'_, C, V> {
            fn sample(&mut self, rng: &mut Rng) -> C::State {
                let found = (0..self.tries).find_map(|_| self.attempt(rng));
                found.unwrap_or_else(|| self.space.sample_uniform(rng))
            }
        }
    };
}

/// The Gaussian sampling strategy (Boor, Overmars and van der Stappen 1999, *The Gaussian sampling strategy
/// for probabilistic roadmap planners*): free states near obstacles. Their density is that of the obstacles
/// blurred by a Gaussian.
///
/// Draws two states, one uniform and one at a normally distributed distance from it. If exactly one of them
/// is free, that is the sample.
#[derive(Clone, Debug)]
pub struct Gaussian<'c, C, V> {
    space: &'c C,
    valid: V,
    sigma: f64,
    tries: u32,
}

obstacle_sampler!(Gaussian);

impl<C: Space, V: Validity<C::State>> Gaussian<'_, C, V> {
    /// One try, of two tests; among few obstacles most tries fail.
    pub fn attempt(&mut self, rng: &mut Rng) -> Option<C::State> {
        let one = self.space.sample_uniform(rng);
        let two = normal_neighbor(self.space, &one, self.sigma, rng);
        match (self.valid.is_valid(&one), self.valid.is_valid(&two)) {
            (true, false) => Some(one),
            (false, true) => Some(two),
            _ => None,
        }
    }
}

/// The bridge test (Hsu, Jiang, Reif and Sun 2003, *The bridge test for sampling narrow passages with
/// probabilistic roadmap planners*): free states between obstacles, in narrow passages.
///
/// Draws two states, one uniform and one at a normally distributed distance from it. If neither is free but
/// the state in the middle between them is, that is the sample. Few tries succeed: mix it with uniform
/// samples.
#[derive(Clone, Debug)]
pub struct Bridge<'c, C, V> {
    space: &'c C,
    valid: V,
    sigma: f64,
    tries: u32,
}

obstacle_sampler!(Bridge);

impl<C: Space, V: Validity<C::State>> Bridge<'_, C, V> {
    /// One try: one test where the first state is free, at most three.
    pub fn attempt(&mut self, rng: &mut Rng) -> Option<C::State> {
        let one = self.space.sample_uniform(rng);
        if self.valid.is_valid(&one) {
            return None;
        }
        let two = normal_neighbor(self.space, &one, self.sigma, rng);
        if self.valid.is_valid(&two) {
            return None;
        }
        let middle = self.space.interpolate(&one, &two, 0.5);
        self.valid.is_valid(&middle).then_some(middle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rn;
    use nalgebra::Vector2;

    type Square = Rn<2>;

    /// Two walls with a passage of width 0.04 between, at x = 0.5.
    fn free(q: &Vector2<f64>) -> bool {
        (q.x - 0.5).abs() > 0.1 || (q.y - 0.5).abs() < 0.02
    }

    fn square() -> Square {
        Rn::new([0.0, 0.0], [1.0, 1.0]).unwrap()
    }

    fn in_passage(q: &Vector2<f64>) -> bool {
        (q.x - 0.5).abs() <= 0.1 && free(q)
    }

    /// The distance from the walls.
    fn to_wall(q: &Vector2<f64>) -> f64 {
        let x = ((q.x - 0.5).abs() - 0.1).max(0.0);
        if x > 0.0 { x } else { 0.02 - (q.y - 0.5).abs() }
    }

    fn share(samples: &[Vector2<f64>]) -> f64 {
        samples.iter().filter(|q| in_passage(q)).count() as f64 / samples.len() as f64
    }

    #[test]
    fn gaussian_samples_are_free_and_near_obstacles() {
        let space = square();
        let mut rng = Rng::seed(1);
        let mut near = Gaussian::new(&space, free, 0.02).unwrap();
        let samples: Vec<_> = (0..2000).map(|_| near.sample(&mut rng)).collect();
        assert!(samples.iter().all(|q| free(q) && space.contains(q)));
        let mut distances: Vec<f64> = samples.iter().map(to_wall).collect();
        distances.sort_by(f64::total_cmp);
        // Half a normal distribution of 0.02: nearly all within 3 sigma.
        assert!(distances[1000] < 0.02 && distances[1980] < 0.06, "{} {}", distances[1000], distances[1980]);
        // Uniform ones would have 0.008 / 0.808 there.
        assert!(share(&samples) > 0.03, "{}", share(&samples));
    }

    #[test]
    fn bridges_are_in_the_passage() {
        let space = square();
        let mut rng = Rng::seed(2);
        let mut bridge = Bridge::new(&space, free, 0.05).unwrap().with_tries(100_000);
        let samples: Vec<_> = (0..500).map(|_| bridge.sample(&mut rng)).collect();
        assert!(samples.iter().all(free));
        assert!(share(&samples) > 0.95, "{}", share(&samples));
    }

    #[test]
    fn without_obstacles_they_are_uniform_after_some_tries() {
        let space = square();
        let mut rng = Rng::seed(3);
        let mut tests = 0;
        let all = |_: &Vector2<f64>| {
            tests += 1;
            true
        };
        let mut near = Gaussian::new(&space, all, 0.02).unwrap().with_tries(10);
        assert!(near.attempt(&mut rng).is_none());
        assert!(space.contains(&near.sample(&mut rng)));
        assert_eq!(tests, 22);
        for sigma in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Gaussian::new(&space, free, sigma).is_err() && Bridge::new(&space, free, sigma).is_err());
        }
    }
}
