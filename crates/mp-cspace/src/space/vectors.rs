//! A space whose states are written as rows of numbers, and checks of such states.

use super::{Factored, Space, TrueMetric};
use crate::obstacles::{
    BodyFeatures, BodySphere, ClearanceGradient, ObstacleGeometry, ObstacleHints, PointOf,
};
use crate::{
    Clearance, ClearanceSearch, Configuration, Interrupt, IntervalClearance, KnownFree, LeastClearance,
    MotionCheck, MotionClearance, MotionInterval, MotionValidity, Rng, StateVector, Validity, layout::Layout,
};
use nalgebra::Vector3;
use std::cell::Cell;
use std::fmt::{self, Debug};
use std::marker::PhantomData;

/// Another space with its states written as rows of numbers: the same distances, samples and motions, to the
/// bit. Planners made by name, which are compiled for [`Configuration`], then plan in it. [`OnVectors`] does
/// the same for checks.
///
/// A row that is not a state is out of bounds, at an infinite distance from all others.
///
/// ```
/// use mp_cspace::{AsVectors, Configuration, Se2, Se2State, Space};
/// let se2 = Se2::new([0.0; 2], [4.0, 3.0])?;
/// let space = AsVectors(se2.clone());
/// let [a, b] = [Se2State::new(1.0, 1.0, 0.5), Se2State::new(2.0, 1.0, 1.0)];
/// let [u, v] = [&a, &b].map(Configuration::of);
/// assert_eq!(u.as_slice(), [1.0, 1.0, 0.5]);
/// assert_eq!(space.distance(&u, &v), se2.distance(&a, &b));
/// # Ok::<(), mp_cspace::SpaceError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct AsVectors<C>(pub C);

/// `then` of two states; `other` when one of the rows is not a state.
#[inline]
fn of_two<S: StateVector, T>(
    from: &Configuration,
    to: &Configuration,
    other: T,
    then: impl FnOnce(S, S) -> T,
) -> T {
    match (from.to(), to.to()) {
        (Some(from), Some(to)) => then(from, to),
        _ => other,
    }
}

impl<C: Space<State: StateVector>> Space for AsVectors<C> {
    type State = Configuration;

    #[inline]
    fn distance(&self, from: &Configuration, to: &Configuration) -> f64 {
        of_two(from, to, f64::INFINITY, |from, to| self.0.distance(&from, &to))
    }
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn extent(&self) -> f64 {
        self.0.extent()
    }
    fn interpolate_into(&self, from: &Configuration, to: &Configuration, t: f64, out: &mut Configuration) {
        match (from.to(), to.to()) {
            (Some(from), Some(to)) => out.set(&self.0.interpolate(&from, &to, t)),
            _ => out.clone_from(if t < 0.5 { from } else { to }),
        }
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> Configuration {
        Configuration::of(&self.0.unit_cube_to_state(u))
    }
    fn sample_uniform(&self, rng: &mut Rng) -> Configuration {
        Configuration::of(&self.0.sample_uniform(rng))
    }
    fn sample_between(
        &self,
        from: &Configuration,
        to: &Configuration,
        sum: f64,
        rng: &mut Rng,
    ) -> Option<Configuration> {
        self.0.sample_between(&from.to()?, &to.to()?, sum, rng).map(|q| Configuration::of(&q))
    }
    fn contains(&self, q: &Configuration) -> bool {
        q.to().is_some_and(|q| self.0.contains(&q))
    }
    fn moved(&self, from: &Configuration, velocity: &[f64], time: f64) -> Option<Configuration> {
        self.0.moved(&from.to()?, velocity, time).map(|q| Configuration::of(&q))
    }
    fn velocity_into(&self, from: &Configuration, to: &Configuration, out: &mut [f64]) -> bool {
        of_two(from, to, false, |from, to| self.0.velocity_into(&from, &to, out))
    }
    fn with_rotation_of(&self, position: &Configuration, rotation: &Configuration) -> Configuration {
        of_two(position, rotation, position.clone(), |position, rotation| {
            Configuration::of(&self.0.with_rotation_of(&position, &rotation))
        })
    }
}

impl<C: TrueMetric<C> + Space<State: StateVector>> TrueMetric for AsVectors<C> {}

impl<C: Factored<State: StateVector>> Factored for AsVectors<C> {
    fn factors(&self) -> usize {
        self.0.factors()
    }
    fn each_factor(&self, from: &Configuration, to: &Configuration, f: &mut impl FnMut(usize, f64)) {
        of_two(from, to, (), |from, to| self.0.each_factor(&from, &to, f));
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        self.0.factor_extent(factor)
    }
    fn interpolate_factor(
        &self,
        factor: usize,
        from: &Configuration,
        to: &Configuration,
        t: f64,
        out: &mut Configuration,
    ) {
        let Some(mut q) = out.to() else { return };
        of_two(from, to, (), |from, to| self.0.interpolate_factor(factor, &from, &to, t, &mut q));
        out.set(&q);
    }
    fn factor_layouts(&self) -> Vec<Layout> {
        self.0.factor_layouts()
    }
    fn embed_factors(&self, state: &Configuration, put: &mut impl FnMut(usize, f64)) {
        if let Some(q) = state.to() {
            self.0.embed_factors(&q, put);
        }
    }
}

/// A check of states `S`, for the rows of their numbers: see [`AsVectors`]. A row that is not a state is in
/// collision.
pub struct OnVectors<A, S> {
    check: A,
    state: PhantomData<fn(&S)>,
}

impl<A: Clone, S> Clone for OnVectors<A, S> {
    fn clone(&self) -> Self {
        Self::new(self.check.clone())
    }
}

impl<A: Debug, S> Debug for OnVectors<A, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("OnVectors").field(&self.check).finish()
    }
}

impl<A, S> OnVectors<A, S> {
    /// `check` for rows.
    pub fn new(check: A) -> Self {
        Self { check, state: PhantomData }
    }

    /// The check of states.
    pub fn inner(&self) -> &A {
        &self.check
    }

    /// The check of states, mutable.
    pub fn inner_mut(&mut self) -> &mut A {
        &mut self.check
    }
}

impl<A: Validity<S>, S: StateVector> Validity<Configuration> for OnVectors<A, S> {
    fn is_valid(&mut self, q: &Configuration) -> bool {
        q.to().is_some_and(|q| self.check.is_valid(&q))
    }
    fn first_invalid(&mut self, states: &[Configuration]) -> Option<usize> {
        let read: Vec<S> = states.iter().map_while(Configuration::to).collect();
        self.check.first_invalid(&read).or((read.len() < states.len()).then_some(read.len()))
    }
    fn batch_size(&self) -> usize {
        self.check.batch_size()
    }
}

impl<A: Clearance<S>, S: StateVector> Clearance<Configuration> for OnVectors<A, S> {
    fn clearance(&mut self, q: &Configuration, enough: f64) -> f64 {
        q.to().map_or(0.0, |q| self.check.clearance(&q, enough))
    }
    fn obstacle_clearance(&mut self, q: &Configuration, enough: f64) -> f64 {
        q.to().map_or(0.0, |q| self.check.obstacle_clearance(&q, enough))
    }
    fn in_contact(&mut self, q: &Configuration) -> bool {
        q.to().is_none_or(|q| self.check.in_contact(&q))
    }
}

impl<A: MotionClearance<S>, S: StateVector + Clone> MotionClearance<Configuration> for OnVectors<A, S> {
    fn motion_bound(&self, from: &Configuration, to: &Configuration) -> f64 {
        of_two(from, to, f64::INFINITY, |from, to| self.check.motion_bound(&from, &to))
    }
    fn interval_clearance(&mut self, interval: &MotionInterval<'_, Configuration>) -> IntervalClearance {
        let MotionInterval { from, to, middle, half, travel, margin } = *interval;
        match (from.to(), to.to(), middle.to()) {
            (Some(from), Some(to), Some(middle)) => {
                let (from, to, middle) = (&from, &to, &middle);
                self.check.interval_clearance(&MotionInterval { from, to, middle, half, travel, margin })
            }
            _ => IntervalClearance::Collision { at: 0.0 },
        }
    }
    fn least_along(&mut self, search: &ClearanceSearch<'_, Configuration>) -> LeastClearance {
        let ClearanceSearch { from, to, ends, at, known, accuracy, states } = *search;
        let none = LeastClearance { bound: 0.0, found: 0.0, at: Some(0.0) };
        of_two(from, to, none, |from: S, to: S| {
            let left = Cell::new(false);
            let at = &|t: f64| {
                at(t).to().unwrap_or_else(|| {
                    left.set(true);
                    from.clone()
                })
            };
            let (from, to) = (&from, &to);
            let search = ClearanceSearch { from, to, ends, at, known, accuracy, states };
            let found = self.check.least_along(&search);
            if left.get() { none } else { found }
        })
    }
    fn contact_first(&self) -> bool {
        self.check.contact_first()
    }
}

impl<A: MotionValidity<S>, S: StateVector> MotionValidity<Configuration> for OnVectors<A, S> {
    fn check_motion(&mut self, from: &Configuration, to: &Configuration) -> MotionCheck {
        let unproven = MotionCheck::Unproven { at: 0.0 };
        of_two(from, to, unproven, |from, to| self.check.check_motion(&from, &to))
    }
    fn check_extension(&mut self, from: &Configuration, to: &Configuration, known: KnownFree) -> MotionCheck {
        let unproven = MotionCheck::Unproven { at: 0.0 };
        of_two(from, to, unproven, |from, to| self.check.check_extension(&from, &to, known))
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.check.interrupt_by(interrupt);
    }
    fn is_interrupted(&mut self) -> bool {
        self.check.is_interrupted()
    }
}

impl<A: ClearanceGradient<S>, S: StateVector> ClearanceGradient<Configuration> for OnVectors<A, S> {
    fn clearance_gradient(&mut self, q: &Configuration, reach: f64, gradient: &mut [f64]) -> f64 {
        match q.to() {
            Some(q) => self.check.clearance_gradient(&q, reach, gradient),
            None => {
                gradient.fill(0.0);
                0.0
            }
        }
    }
}

impl<A: ObstacleHints<S>, S: StateVector> ObstacleHints<Configuration> for OnVectors<A, S> {
    fn touches(&mut self, q: &Configuration) -> bool {
        q.to().is_some_and(|q| self.check.touches(&q))
    }
    fn slide_along(
        &mut self,
        from: &Configuration,
        toward: &Configuration,
        hit: Option<&Configuration>,
        rng: &mut Rng,
    ) -> Option<Configuration> {
        let hit = match hit {
            Some(hit) => Some(hit.to()?),
            None => None,
        };
        let moved = self.check.slide_along(&from.to()?, &toward.to()?, hit.as_ref(), rng)?;
        Some(Configuration::of(&moved))
    }
    fn moved_by(&self, q: &Configuration, from: &Configuration, to: &Configuration) -> Configuration {
        match (q.to(), from.to(), to.to()) {
            (Some(q), Some(from), Some(to)) => Configuration::of(&self.check.moved_by(&q, &from, &to)),
            _ => q.clone(),
        }
    }
}

impl<A: ObstacleGeometry<S>, S: StateVector> ObstacleGeometry<Configuration> for OnVectors<A, S> {
    fn prepare(&self, interrupt: &Interrupt) -> bool {
        self.check.prepare(interrupt)
    }
    fn obstacles(&self) -> &[BodySphere] {
        self.check.obstacles()
    }
    fn robot(&self) -> BodySphere {
        self.check.robot()
    }
    fn obstacle_features(&self, obstacle: usize) -> Option<BodyFeatures> {
        self.check.obstacle_features(obstacle)
    }
    fn robot_features(&self) -> BodyFeatures {
        self.check.robot_features()
    }
    fn touched_obstacle(&mut self, q: &Configuration) -> Option<usize> {
        self.check.touched_obstacle(&q.to()?)
    }
    fn obstacle_point(&self, obstacle: usize, of: PointOf, rng: &mut Rng) -> Option<Vector3<f64>> {
        self.check.obstacle_point(obstacle, of, rng)
    }
    fn robot_point(&self, of: PointOf, rng: &mut Rng) -> Vector3<f64> {
        self.check.robot_point(of, rng)
    }
    fn world_point(&self, q: &Configuration, point: &Vector3<f64>) -> Vector3<f64> {
        q.to().map_or(*point, |q| self.check.world_point(&q, point))
    }
    fn moved_to(&self, q: &Configuration, point: &Vector3<f64>, place: &Vector3<f64>) -> Configuration {
        q.to().map_or_else(|| q.clone(), |q| Configuration::of(&self.check.moved_to(&q, point, place)))
    }
    fn aligned(&self, place: &Vector3<f64>, direction: &Vector3<f64>, angle: f64) -> Configuration {
        Configuration::of(&self.check.aligned(place, direction, angle))
    }
    fn is_far(&self, q: &Configuration) -> bool {
        q.to().is_some_and(|q| self.check.is_far(&q))
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
            let [u, v] = [&a, &b].map(Configuration::of);
            assert_eq!(u.to().as_ref(), Some(&a));
            assert_eq!(vectors.distance(&u, &v).to_bits(), space.distance(&a, &b).to_bits());
            assert_eq!(vectors.interpolate(&u, &v, 0.3), Configuration::of(&space.interpolate(&a, &b, 0.3)));
            assert!(vectors.contains(&u));
            for factor in 0..space.factors() {
                let (mut p, mut q) = (u.clone(), a.clone());
                vectors.interpolate_factor(factor, &u, &v, 0.7, &mut p);
                space.interpolate_factor(factor, &a, &b, 0.7, &mut q);
                assert_eq!(p, Configuration::of(&q));
            }
            let (mut x, mut y) = ([0.0; 32], [0.0; 32]);
            assert_eq!(vectors.embed(&u, &mut x), space.embed(&a, &mut y));
            assert_eq!(x, y);
        }
        let bad = Configuration::zeros(1);
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
