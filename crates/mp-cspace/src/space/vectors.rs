//! A space whose states are written as vectors of numbers.

use super::{Factored, Space};
use crate::{Rng, StateVector, layout::Layout};
use nalgebra::DVector;

/// Another space with its states written as vectors: the same distances, samples and motions, to the bit. Planners compiled for
/// vectors then plan in it.
///
/// A vector that is not a state is out of bounds, at an infinite distance from all others.
///
/// ```
/// use mp_cspace::{AsVectors, Se2, Se2State, Space};
/// let se2 = Se2::new([0.0; 2], [4.0, 3.0])?;
/// let space = AsVectors(se2.clone());
/// let [a, b] = [Se2State::new(1.0, 1.0, 0.5), Se2State::new(2.0, 1.0, 1.0)];
/// let [u, v] = [&a, &b].map(AsVectors::<Se2>::vector);
/// assert_eq!(u.as_slice(), [1.0, 1.0, 0.5]);
/// assert_eq!(space.distance(&u, &v), se2.distance(&a, &b));
/// # Ok::<(), mp_cspace::SpaceError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct AsVectors<C>(pub C);

impl<C: Space<State: StateVector>> AsVectors<C> {
    /// The numbers of a state.
    pub fn vector(q: &C::State) -> DVector<f64> {
        let mut numbers = Vec::with_capacity(16);
        q.write(&mut numbers);
        DVector::from_vec(numbers)
    }

    /// The state with these numbers, if there is one.
    #[must_use]
    pub fn state(numbers: &DVector<f64>) -> Option<C::State> {
        StateVector::read(numbers.as_slice())
    }

    /// `read` of two states; `other` when one of the vectors is not a state.
    fn of_two<T>(
        from: &DVector<f64>,
        to: &DVector<f64>,
        other: T,
        read: impl FnOnce(C::State, C::State) -> T,
    ) -> T {
        match (Self::state(from), Self::state(to)) {
            (Some(from), Some(to)) => read(from, to),
            _ => other,
        }
    }
}

impl<C: Space<State: StateVector>> Space for AsVectors<C> {
    type State = DVector<f64>;

    fn distance(&self, from: &DVector<f64>, to: &DVector<f64>) -> f64 {
        Self::of_two(from, to, f64::INFINITY, |from, to| self.0.distance(&from, &to))
    }
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn extent(&self) -> f64 {
        self.0.extent()
    }
    fn interpolate_into(&self, from: &DVector<f64>, to: &DVector<f64>, t: f64, out: &mut DVector<f64>) {
        let nearer = if t < 0.5 { from } else { to };
        *out = Self::of_two(from, to, nearer.clone(), |from, to| {
            Self::vector(&self.0.interpolate(&from, &to, t))
        });
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> DVector<f64> {
        Self::vector(&self.0.unit_cube_to_state(u))
    }
    fn sample_uniform(&self, rng: &mut Rng) -> DVector<f64> {
        Self::vector(&self.0.sample_uniform(rng))
    }
    fn contains(&self, q: &DVector<f64>) -> bool {
        Self::state(q).is_some_and(|q| self.0.contains(&q))
    }
    fn moved(&self, from: &DVector<f64>, velocity: &[f64], time: f64) -> Option<DVector<f64>> {
        self.0.moved(&Self::state(from)?, velocity, time).map(|q| Self::vector(&q))
    }
    fn velocity_into(&self, from: &DVector<f64>, to: &DVector<f64>, out: &mut [f64]) -> bool {
        Self::of_two(from, to, false, |from, to| self.0.velocity_into(&from, &to, out))
    }
}

impl<C: Factored<State: StateVector>> Factored for AsVectors<C> {
    fn factors(&self) -> usize {
        self.0.factors()
    }
    fn each_factor(&self, from: &DVector<f64>, to: &DVector<f64>, f: &mut impl FnMut(usize, f64)) {
        Self::of_two(from, to, (), |from, to| self.0.each_factor(&from, &to, f));
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        self.0.factor_extent(factor)
    }
    fn interpolate_factor(
        &self,
        factor: usize,
        from: &DVector<f64>,
        to: &DVector<f64>,
        t: f64,
        out: &mut DVector<f64>,
    ) {
        let Some(mut q) = Self::state(out) else { return };
        Self::of_two(from, to, (), |from, to| self.0.interpolate_factor(factor, &from, &to, t, &mut q));
        *out = Self::vector(&q);
    }
    fn factor_layouts(&self) -> Vec<Layout> {
        self.0.factor_layouts()
    }
    fn embed_factors(&self, state: &DVector<f64>, put: &mut impl FnMut(usize, f64)) {
        if let Some(q) = Self::state(state) {
            self.0.embed_factors(&q, put);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nn::Embed;
    use crate::space_time::SpaceTime;
    use crate::{Rn, Se2, Se3};

    fn same<C: Factored<State: StateVector + PartialEq> + Embed + Clone>(space: C) {
        let (vectors, mut rng) = (AsVectors(space.clone()), Rng::seed(2));
        for _ in 0..50 {
            let [a, b] = [(); 2].map(|()| space.sample_uniform(&mut rng));
            let [u, v] = [&a, &b].map(AsVectors::<C>::vector);
            assert_eq!(AsVectors::<C>::state(&u).as_ref(), Some(&a));
            assert_eq!(vectors.distance(&u, &v).to_bits(), space.distance(&a, &b).to_bits());
            assert_eq!(
                vectors.interpolate(&u, &v, 0.3),
                AsVectors::<C>::vector(&space.interpolate(&a, &b, 0.3))
            );
            assert!(vectors.contains(&u));
            for factor in 0..space.factors() {
                let (mut p, mut q) = (u.clone(), a.clone());
                vectors.interpolate_factor(factor, &u, &v, 0.7, &mut p);
                space.interpolate_factor(factor, &a, &b, 0.7, &mut q);
                assert_eq!(p, AsVectors::<C>::vector(&q));
            }
            let (mut x, mut y) = ([0.0; 32], [0.0; 32]);
            assert_eq!(vectors.embed(&u, &mut x), space.embed(&a, &mut y));
            assert_eq!(x, y);
        }
        let bad = DVector::from_vec(vec![0.0; 1]);
        let good = vectors.sample_uniform(&mut rng);
        assert!(!vectors.contains(&bad) && vectors.distance(&good, &bad) == f64::INFINITY);
    }

    #[test]
    fn vectors_stand_for_states() {
        let se2 = Se2::new([0.0; 2], [4.0, 3.0]).unwrap();
        same(SpaceTime::new(se2, 5.0, 1.0).unwrap());
        same(SpaceTime::new(Rn::<2>::new([0.0; 2], [1.0; 2]).unwrap(), 2.0, 0.5).unwrap());
        same(SpaceTime::new(Se3::new([0.0; 3], [1.0; 3]).unwrap(), 5.0, 1.0).unwrap());
    }
}
