//! Positions at times: spaces for moving obstacles.

use crate::space::lerp;
use crate::{
    Factored, Goal, Interrupt, KdTree, KnownFree, MotionCheck, MotionValidity, Rng, Sampler, Space,
    SpaceError,
    error::weight,
    nn::{Embed, Layout},
};
use rand::RngExt;

/// The positions of a space at times from zero to a horizon (s). Motions lead forward in time only, and no
/// faster than a limit, in the metric of the space per second.
///
/// Distance: `√(d² + (v·Δt)²)` with `d` that of the positions and `v` the limit, where the motion is
/// possible: `d ≤ v·Δt`. Where it is not, the greatest such distance is added: a state from which the target
/// can be reached is then always nearer than one from which it cannot. So the extent is **twice** the
/// diagonal of space and time. Not symmetric, hence not a true metric.
///
/// Interpolation is straight: a motion at constant speed. [`ForwardInTime`] makes motion checks and verifiers
/// refuse impossible motions.
///
/// ```
/// use mp_cspace::{Rn, Space, space_time::SpaceTime};
/// let space = SpaceTime::new(Rn::<1>::new([0.0], [3.0])?, 4.0, 1.0)?;
/// let (a, b) = (([0.0].into(), 0.0), ([3.0].into(), 4.0));
/// assert_eq!(space.distance(&a, &b), 5.0);
/// assert!(space.can_move(&a, &b) && !space.can_move(&b, &a));
/// assert!(space.distance(&b, &a) > 5.0);
/// # Ok::<(), mp_cspace::SpaceError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceTime<C> {
    positions: C,
    horizon: f64,
    speed: f64,
    diagonal: f64,
}

/// The relative rounding allowed: of speeds, and of distances relative to the diagonal.
const ROUNDING: f64 = 1e-9;

impl<C: Space> SpaceTime<C> {
    /// `positions` from time zero to `horizon`, moved at `speed` at most.
    ///
    /// # Errors
    /// When the horizon or the speed is not positive and finite.
    pub fn new(positions: C, horizon: f64, speed: f64) -> Result<Self, SpaceError> {
        let horizon = weight("the horizon", horizon)?;
        let speed = weight("the speed limit", speed)?;
        let diagonal =
            weight("the extent of space and time", mp_math::hypot(positions.extent(), speed * horizon))?;
        Ok(Self { positions, horizon, speed, diagonal })
    }

    /// The space without the time.
    #[must_use]
    pub fn positions(&self) -> &C {
        &self.positions
    }

    /// The last time, seconds.
    #[must_use]
    pub fn horizon(&self) -> f64 {
        self.horizon
    }

    /// The greatest speed, in the metric of the positions per second.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Whether the motion from `from` to `to` is possible: forward in time and within the speed limit, or
    /// from a state to itself.
    pub fn can_move(&self, from: &(C::State, f64), to: &(C::State, f64)) -> bool {
        let (distance, time) = (self.positions.distance(&from.0, &to.0), to.1 - from.1);
        from == to || (time > 0.0 && distance <= self.speed * time * (1.0 + ROUNDING))
    }

    /// A position at any time, as a goal and as a sampler of times.
    #[must_use]
    pub fn at_any_time(&self, position: C::State) -> AtAnyTime<C::State> {
        AtAnyTime { position, horizon: self.horizon }
    }
}

impl<C: Space> Space for SpaceTime<C> {
    type State = (C::State, f64);
    #[inline]
    fn distance(&self, from: &(C::State, f64), to: &(C::State, f64)) -> f64 {
        let d = self.positions.distance(&from.0, &to.0);
        let most = self.speed * (to.1 - from.1);
        let length = (d * d + most * most).sqrt();
        // Whether the motion is possible, up to rounding.
        if d <= most * (1.0 + ROUNDING) + ROUNDING * self.diagonal { length } else { self.diagonal + length }
    }

    fn dim(&self) -> usize {
        self.positions.dim() + 1
    }
    fn extent(&self) -> f64 {
        2.0 * self.diagonal
    }
    #[inline]
    fn interpolate_into(&self, from: &Self::State, to: &Self::State, t: f64, out: &mut Self::State) {
        self.positions.interpolate_into(&from.0, &to.0, t, &mut out.0);
        out.1 = lerp(from.1, to.1, t);
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> Self::State {
        let n = self.positions.dim();
        (self.positions.unit_cube_to_state(&u[..n]), self.horizon * u[n])
    }
    fn sample_uniform(&self, rng: &mut Rng) -> Self::State {
        (self.positions.sample_uniform(rng), self.horizon * rng.random::<f64>())
    }
    fn contains(&self, q: &Self::State) -> bool {
        self.positions.contains(&q.0) && (0.0..=self.horizon).contains(&q.1)
    }
    /// The last number of a velocity is that of time: 1 for motions as they happen.
    fn moved(&self, from: &Self::State, velocity: &[f64], time: f64) -> Option<Self::State> {
        let (clock, velocity) = velocity.split_last()?;
        Some((self.positions.moved(&from.0, velocity, time)?, from.1 + clock * time))
    }
    fn velocity_into(&self, from: &Self::State, to: &Self::State, out: &mut [f64]) -> bool {
        let Some((clock, velocity)) = out.split_last_mut() else { return false };
        *clock = to.1 - from.1;
        self.positions.velocity_into(&from.0, &to.0, velocity)
    }
}

/// Factors: those of the positions, then time, in seconds.
impl<C: Factored> Factored for SpaceTime<C> {
    fn factors(&self) -> usize {
        self.positions.factors() + 1
    }
    fn each_factor(&self, from: &Self::State, to: &Self::State, f: &mut impl FnMut(usize, f64)) {
        self.positions.each_factor(&from.0, &to.0, f);
        f(self.positions.factors(), (to.1 - from.1).abs());
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        if factor == self.positions.factors() { self.horizon } else { self.positions.factor_extent(factor) }
    }
    fn interpolate_factor(
        &self,
        factor: usize,
        from: &Self::State,
        to: &Self::State,
        t: f64,
        out: &mut Self::State,
    ) {
        if factor == self.positions.factors() {
            out.1 = lerp(from.1, to.1, t);
        } else {
            self.positions.interpolate_factor(factor, &from.0, &to.0, t, &mut out.0);
        }
    }
    fn factor_layouts(&self) -> Vec<Layout> {
        [self.positions.factor_layouts(), vec![Layout::euclidean(1)]].concat()
    }
    fn embed_factors(&self, state: &Self::State, put: &mut impl FnMut(usize, f64)) {
        self.positions.embed_factors(&state.0, put);
        put(self.positions.factors(), state.1);
    }
}

impl<C: Embed> Embed for SpaceTime<C> {
    fn layout(&self) -> Layout {
        self.positions.layout().beside(Layout::euclidean(1)).loose()
    }
    #[inline]
    fn embed(&self, state: &Self::State, out: &mut [f64]) -> usize {
        let n = self.positions.embed(&state.0, out);
        out[n] = self.speed * state.1;
        n + 1
    }
}
impl<C: Embed> crate::DefaultNn for SpaceTime<C> {
    type Nn = KdTree;
}

/// A position at any time: see [`SpaceTime::at_any_time`].
#[derive(Clone, Debug, PartialEq)]
pub struct AtAnyTime<S> {
    position: S,
    horizon: f64,
}

impl<S: PartialEq> Goal<(S, f64)> for AtAnyTime<S> {
    fn reached(&self, q: &(S, f64)) -> bool {
        q.0 == self.position
    }
}
impl<S: Clone> Sampler<(S, f64)> for AtAnyTime<S> {
    fn sample(&mut self, rng: &mut Rng) -> (S, f64) {
        (self.position.clone(), self.horizon * rng.random::<f64>())
    }
}

/// A motion check or verifier that refuses motions back in time or beyond the speed limit, and asks another
/// one about the rest.
#[derive(Clone, Debug)]
pub struct ForwardInTime<'c, C, M> {
    /// The space with time, which knows the speed limit.
    pub space: &'c SpaceTime<C>,
    /// The check of possible motions.
    pub check: M,
}

impl<C: Space, M: MotionValidity<(C::State, f64)>> MotionValidity<(C::State, f64)>
    for ForwardInTime<'_, C, M>
{
    fn check_motion(&mut self, from: &(C::State, f64), to: &(C::State, f64)) -> MotionCheck {
        self.check_extension(from, to, KnownFree::Neither)
    }
    fn check_extension(
        &mut self,
        from: &(C::State, f64),
        to: &(C::State, f64),
        known: KnownFree,
    ) -> MotionCheck {
        if self.space.can_move(from, to) {
            self.check.check_extension(from, to, known)
        } else {
            MotionCheck::Unproven { at: 0.0 }
        }
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.check.interrupt_by(interrupt);
    }
    fn is_interrupted(&mut self) -> bool {
        self.check.is_interrupted()
    }
}
