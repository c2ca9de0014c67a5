//! Objectives: what motions cost, for planners that look for the cheapest path.

use crate::{Length, ParameterError, Path, Space};

/// What straight motions cost; a path costs what its motions cost together. Closures implement it.
///
/// No motion may cost less than its distance in the space: the distance is the admissible bound by which
/// planners that optimise leave out what cannot be cheaper (S. Karaman and E. Frazzoli, *Sampling-based
/// algorithms for optimal motion planning*, IJRR 30(7), 2011). Multiply a cost that may be less, or put a
/// [metric](crate::WithMetric) on the space that is a bound of it.
///
/// A problem gets it by [`Problem::with_objective`](crate::Problem::with_objective); without one the cost is
/// the length.
pub trait Objective<S> {
    /// The cost of the straight motion, at least its distance.
    fn cost(&mut self, from: &S, to: &S) -> f64;

    /// The cost of a state, for planners that compare states; above zero where it is worse than elsewhere. By
    /// default 0.
    fn state_cost(&mut self, _q: &S) -> f64 {
        0.0
    }

    /// The cost of straight motions through all states of a path.
    fn path_cost(&mut self, path: &Path<S>) -> f64 {
        // The sum of no numbers is −0.
        0.0 + path.states.windows(2).map(|w| self.cost(&w[0], &w[1])).sum::<f64>()
    }
}

impl<S, F: FnMut(&S, &S) -> f64> Objective<S> for F {
    fn cost(&mut self, from: &S, to: &S) -> f64 {
        self(from, to)
    }
}

/// The length in the metric of the space.
#[derive(Clone, Copy, Debug)]
pub struct PathLength<'c, C>(pub &'c C);

impl<C: Space> Objective<C::State> for PathLength<'_, C> {
    fn cost(&mut self, from: &C::State, to: &C::State) -> f64 {
        self.0.distance(from, to)
    }
}

/// The integral ∫ (1 + w·c(q)) ds along the motion, of a weight w and a cost c of states, by the trapezoid
/// rule. In the unit of the metric.
///
/// Where c is negative or not a number on the average of a motion, the motion costs its length.
///
/// ```
/// use mp_cspace::{Length, Objective, Path, Rn, StateCostIntegral, nearness};
/// use nalgebra::Vector2;
/// let space = Rn::<2>::new([0.0; 2], [10.0; 2])?;
/// // Expensive within 2 m of a wall at x = 0.
/// let near_wall = |q: &Vector2<f64>| nearness(q.x, 2.0);
/// let mut objective = StateCostIntegral::new(&space, near_wall, 3.0, Length::Fraction(0.001))?;
/// let along = |x: f64| Path::straight(vec![Vector2::new(x, 0.0), Vector2::new(x, 4.0)]);
/// assert_eq!([0.0, 1.0, 2.0].map(|x| objective.path_cost(&along(x))), [16.0, 7.0, 4.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct StateCostIntegral<'c, C, F> {
    space: &'c C,
    cost: F,
    weight: f64,
    resolution: f64,
}

impl<'c, C: Space, F: FnMut(&C::State) -> f64> StateCostIntegral<'c, C, F> {
    /// The objective of this weight, whose states are at most `resolution` apart.
    ///
    /// # Errors
    /// When the weight is not above zero and finite, or the resolution is out of range.
    pub fn new(space: &'c C, cost: F, weight: f64, resolution: Length) -> Result<Self, ParameterError> {
        let weight = ParameterError::positive("the weight", weight)?;
        Ok(Self { space, cost, weight, resolution: resolution.resolution_in(space)? })
    }
}

impl<C: Space, F: FnMut(&C::State) -> f64> Objective<C::State> for StateCostIntegral<'_, C, F> {
    fn cost(&mut self, from: &C::State, to: &C::State) -> f64 {
        let length = self.space.distance(from, to);
        let parts = (length / self.resolution).ceil().max(1.0);
        let mut sum = 0.5 * ((self.cost)(from) + (self.cost)(to));
        for i in 1..parts as u64 {
            sum += (self.cost)(&self.space.interpolate(from, to, i as f64 / parts));
        }
        length * (1.0 + self.weight * (sum / parts).max(0.0))
    }

    fn state_cost(&mut self, q: &C::State) -> f64 {
        (self.cost)(q)
    }
}

/// The cost of being near obstacles, (1 − d/r)² for a clearance d (m) below the range r (m), else 0; 1 in
/// contact: for [`StateCostIntegral`] and T-RRT (L. Jaillet, J. Cortés and T. Siméon, *Sampling-based path
/// planning on configuration-space costmaps*, IEEE T-RO 26(4), 2010).
#[must_use]
pub fn nearness(clearance: f64, range: f64) -> f64 {
    mp_math::powi(1.0 - (clearance / range).clamp(0.0, 1.0), 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Rn, Rng};
    use nalgebra::Vector2;
    use proptest::prelude::*;
    use rand::RngExt;

    proptest! {
        /// The distance is admissible, also for costs that are wrong, and to the bit.
        #[test]
        fn no_motion_costs_less_than_its_distance(seed: u64, weight in 1e-3..1e3_f64, part in 0.001..1.0_f64) {
            let space = Rn::<2>::new([0.0; 2], [1.0; 2]).unwrap();
            let mut rng = Rng::seed(seed);
            let costs = [0.0, rng.random::<f64>(), -1.0, f64::NAN];
            for cost in costs {
                let mut wave = |q: &Vector2<f64>| cost * (q.x + q.y);
                let mut integral =
                    StateCostIntegral::new(&space, &mut wave, weight, Length::Fraction(part)).unwrap();
                let ends = [0; 2].map(|_| space.sample_uniform(&mut rng));
                let distance = space.distance(&ends[0], &ends[1]);
                prop_assert!(integral.cost(&ends[0], &ends[1]) >= distance);
                prop_assert_eq!(PathLength(&space).cost(&ends[0], &ends[1]), distance);
            }
        }
    }
}
