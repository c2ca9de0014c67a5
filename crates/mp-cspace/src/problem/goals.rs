//! The goals of a problem.

use crate::{Goal, Rng, Sampler};
use rand::RngExt;
use std::fmt;

/// The states to reach: one, several, a region, or whatever a sampler yields.
///
/// A planner that only tests whether it has arrived needs a region or states; one that aims, or
/// grows a tree from the goal, needs states or a sampler.
///
/// ```
/// use mp_cspace::Goals;
/// let _ = Goals::from(0.7_f64);
/// let _ = Goals::states([0.7, 0.9]);
/// let _ = Goals::region(|q: &f64| *q > 0.7);
/// ```
pub struct Goals<'g, S> {
    states: Vec<S>,
    region: Option<Box<dyn Goal<S> + Send + 'g>>,
    sampler: Option<Box<dyn Sampler<S> + Send + 'g>>,
}

impl<'g, S> Goals<'g, S> {
    /// Any of these states.
    pub fn states(states: impl IntoIterator<Item = S>) -> Self {
        Self { states: states.into_iter().collect(), region: None, sampler: None }
    }

    /// Any state of a region.
    pub fn region(region: impl Goal<S> + Send + 'g) -> Self {
        Self { states: Vec::new(), region: Some(Box::new(region)), sampler: None }
    }

    /// Any state that `sampler` yields.
    pub fn sampled(sampler: impl Sampler<S> + Send + 'g) -> Self {
        Self { states: Vec::new(), region: None, sampler: Some(Box::new(sampler)) }
    }

    /// Also aims at the samples of `sampler`; those outside the region, if there is one, are
    /// ignored.
    #[must_use]
    pub fn with_sampler(mut self, sampler: impl Sampler<S> + Send + 'g) -> Self {
        self.sampler = Some(Box::new(sampler));
        self
    }

    /// Whether there are states or a sampler to aim at.
    #[must_use]
    pub fn can_aim(&self) -> bool {
        !self.states.is_empty() || self.sampler.is_some()
    }

    /// The listed states.
    #[must_use]
    pub fn listed(&self) -> &[S] {
        &self.states
    }

    pub(super) fn listed_mut(&mut self) -> &mut Vec<S> {
        &mut self.states
    }

    pub(super) fn is_empty(&self) -> bool {
        self.region.is_none() && !self.can_aim()
    }

    /// Whether `q` lies in the region; `false` without a region.
    #[must_use]
    pub fn reached(&self, q: &S) -> bool {
        self.region.as_ref().is_some_and(|region| region.reached(q))
    }

    /// Whether there is a region, so that every new state must be tested.
    #[must_use]
    pub fn has_region(&self) -> bool {
        self.region.is_some()
    }

    /// Whether there is a sampler.
    #[must_use]
    pub fn has_sampler(&self) -> bool {
        self.sampler.is_some()
    }

    /// A new sample of the goal, if there is a sampler and the sample lies in the region, if any.
    pub fn sample(&mut self, rng: &mut Rng) -> Option<S> {
        let state = self.sampler.as_mut()?.sample(rng);
        self.region.as_ref().is_none_or(|region| region.reached(&state)).then_some(state)
    }

    /// A state to aim at: one of those listed, each equally likely, or else a sample.
    pub fn aim(&mut self, rng: &mut Rng) -> Option<S>
    where
        S: Clone,
    {
        match self.states.len() {
            0 => self.sample(rng),
            1 => Some(self.states[0].clone()),
            n => Some(self.states[rng.random_range(0..n)].clone()),
        }
    }
}

impl<S> From<S> for Goals<'_, S> {
    fn from(state: S) -> Self {
        Self::states([state])
    }
}

impl<S: fmt::Debug> fmt::Debug for Goals<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Goals")
            .field("states", &self.states)
            .field("region", &self.region.is_some())
            .field("sampler", &self.sampler.is_some())
            .finish()
    }
}
