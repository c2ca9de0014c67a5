//! Products of two spaces; nest them for more.

use super::{Factored, Rn, Space, TrueMetric};
use crate::{Rng, SpaceError, error::weight, layout::Layout};
use nalgebra::SVector;

/// The product of two spaces. Its states are pairs.
///
/// Distance: `√((wa·da)² + (wb·db)²)`.
///
/// ```
/// use mp_cspace::{Configuration, Joints, Product, Rn, Space};
/// use nalgebra::Vector1;
/// // A planar body on a rail: metres and radians, a radian counting as 0.3 m.
/// let rail = Rn::<1>::new([0.0], [2.0])?;
/// let space = Product::new(rail, 1.0, Joints::<Vector1<f64>>::circles(1)?, 0.3)?;
/// assert_eq!(space.dim(), 2);
/// assert_eq!(space.distance(&([0.0].into(), [0.0].into()), &([0.4].into(), [1.0].into())), 0.5);
/// # Ok::<(), mp_cspace::SpaceError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Product<A, B> {
    a: A,
    b: B,
    weight_a: f64,
    weight_b: f64,
}

impl<A: Space, B: Space> Product<A, B> {
    /// The product of `a` and `b`, each distance multiplied by its weight.
    ///
    /// # Errors
    /// When a weight is not positive and finite.
    pub fn new(a: A, weight_a: f64, b: B, weight_b: f64) -> Result<Self, SpaceError> {
        let weight_a = weight("the weight of the first space", weight_a)?;
        let weight_b = weight("the weight of the second space", weight_b)?;
        Ok(Self { a, b, weight_a, weight_b })
    }

    /// The two spaces.
    #[must_use]
    pub fn spaces(&self) -> (&A, &B) {
        (&self.a, &self.b)
    }

    /// Their weights.
    #[must_use]
    pub fn weights(&self) -> (f64, f64) {
        (self.weight_a, self.weight_b)
    }

    #[inline]
    fn norm(&self, a: f64, b: f64) -> f64 {
        let (a, b) = (self.weight_a * a, self.weight_b * b);
        (a * a + b * b).sqrt()
    }
}

impl<A: Space, const N: usize> Product<A, Rn<N>> {
    /// The states of `positions` with a velocity each: one number per degree of freedom, no greater
    /// than its limit. The weight of velocities (in seconds) makes their extent count as much as that of
    /// the positions; [`new`](Self::new) takes weights of your own.
    ///
    /// ```
    /// use mp_cspace::{Product, Se2, Space};
    /// let space = Product::with_velocity(Se2::new([0.0; 2], [4.0, 3.0])?, [1.0, 1.0, 2.0])?;
    /// assert_eq!(space.dim(), 6);
    /// assert!(Product::with_velocity(Se2::new([0.0; 2], [4.0, 3.0])?, [1.0, 1.0]).is_err());
    /// # Ok::<(), mp_cspace::SpaceError>(())
    /// ```
    ///
    /// # Errors
    /// When there are not as many limits as degrees of freedom, or one is not positive and finite.
    pub fn with_velocity(positions: A, limits: impl Into<SVector<f64, N>>) -> Result<Self, SpaceError> {
        let limits = limits.into();
        let (expected, found) = (positions.dim(), N);
        if expected != found {
            return Err(SpaceError::Count { what: "limits of velocities", expected, found });
        }
        limits.iter().try_for_each(|&limit| weight("the limit of a velocity", limit).map(drop))?;
        let velocities = Rn::new(-limits, limits)?;
        let weight = positions.extent() / velocities.extent();
        Self::new(positions, 1.0, velocities, weight)
    }
}

impl<A: TrueMetric, B: TrueMetric> TrueMetric for Product<A, B> {}

impl<A: Space, B: Space> Space for Product<A, B> {
    type State = (A::State, B::State);
    #[inline]
    fn distance(&self, from: &(A::State, B::State), to: &(A::State, B::State)) -> f64 {
        self.norm(self.a.distance(&from.0, &to.0), self.b.distance(&from.1, &to.1))
    }

    #[inline]
    fn dim(&self) -> usize {
        self.a.dim() + self.b.dim()
    }
    #[inline]
    fn extent(&self) -> f64 {
        self.norm(self.a.extent(), self.b.extent())
    }
    #[inline]
    fn interpolate_into(&self, from: &Self::State, to: &Self::State, t: f64, out: &mut Self::State) {
        self.a.interpolate_into(&from.0, &to.0, t, &mut out.0);
        self.b.interpolate_into(&from.1, &to.1, t, &mut out.1);
    }
    #[inline]
    fn unit_cube_to_state(&self, u: &[f64]) -> Self::State {
        let (ua, ub) = u.split_at(self.a.dim());
        (self.a.unit_cube_to_state(ua), self.b.unit_cube_to_state(ub))
    }
    #[inline]
    fn sample_uniform(&self, rng: &mut Rng) -> Self::State {
        (self.a.sample_uniform(rng), self.b.sample_uniform(rng))
    }
    #[inline]
    fn contains(&self, q: &Self::State) -> bool {
        self.a.contains(&q.0) && self.b.contains(&q.1)
    }
    #[inline]
    fn moved(&self, from: &Self::State, velocity: &[f64], time: f64) -> Option<Self::State> {
        let (a, b) = velocity.split_at_checked(self.a.dim())?;
        Some((self.a.moved(&from.0, a, time)?, self.b.moved(&from.1, b, time)?))
    }
    #[inline]
    fn velocity_into(&self, from: &Self::State, to: &Self::State, out: &mut [f64]) -> bool {
        let Some((a, b)) = out.split_at_mut_checked(self.a.dim()) else { return false };
        self.a.velocity_into(&from.0, &to.0, a) && self.b.velocity_into(&from.1, &to.1, b)
    }
    fn interpolate(&self, from: &Self::State, to: &Self::State, t: f64) -> Self::State {
        (self.a.interpolate(&from.0, &to.0, t), self.b.interpolate(&from.1, &to.1, t))
    }
}

/// Factors: those of the first space, then those of the second, without the weights.
impl<A: Factored, B: Factored> Factored for Product<A, B> {
    fn factors(&self) -> usize {
        self.a.factors() + self.b.factors()
    }
    #[inline]
    fn each_factor(&self, from: &Self::State, to: &Self::State, f: &mut impl FnMut(usize, f64)) {
        let first = self.a.factors();
        self.a.each_factor(&from.0, &to.0, f);
        // A plain reference to `f` would make the type grow with every nesting.
        let shifted: &mut dyn FnMut(usize, f64) = &mut |i, d| f(first + i, d);
        self.b.each_factor(&from.1, &to.1, &mut |i, d| shifted(i, d));
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        match factor.checked_sub(self.a.factors()) {
            None => self.a.factor_extent(factor),
            Some(rest) => self.b.factor_extent(rest),
        }
    }
    fn interpolate_factor(
        &self,
        factor: usize,
        from: &Self::State,
        to: &Self::State,
        t: f64,
        out: &mut Self::State,
    ) {
        match factor.checked_sub(self.a.factors()) {
            None => self.a.interpolate_factor(factor, &from.0, &to.0, t, &mut out.0),
            Some(rest) => self.b.interpolate_factor(rest, &from.1, &to.1, t, &mut out.1),
        }
    }
    fn factor_layouts(&self) -> Vec<Layout> {
        let (a, b) = self.spaces();
        [a.factor_layouts(), b.factor_layouts()].concat()
    }
    #[inline]
    fn embed_factors(&self, state: &(A::State, B::State), put: &mut impl FnMut(usize, f64)) {
        let (a, b) = self.spaces();
        let first = a.factors();
        a.embed_factors(&state.0, put);
        // A plain reference to `put` would make the type grow with every nesting.
        let put: &mut dyn FnMut(usize, f64) = put;
        b.embed_factors(&state.1, &mut |i, x| put(first + i, x));
    }
}
