//! Generators that find states near obstacles by pairs of samples; some attempts are uniform samples instead.

use super::constructors;
use super::settings::{length, reachable};
use super::{
    AStar, Candidate, ConnectionStages, EdgeChecker, MilestoneKind, NearestConnector, NodeGenerator,
    Reachable, Roadmap, RoadmapPlanner, RoadmapPlannerParts, StagedConnector,
};
use mp_cspace::{
    BuildError, Length, LocalPlanner, Reversible, Rng, Space,
    registry::{Parameter, Settings},
};
use rand::RngExt;
use std::fmt::Debug;
use std::marker::PhantomData;

/// How far apart the states of a pair are, and how often a uniform sample is drawn instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixing {
    /// Standard deviation of the distance, in (0, extent of the space].
    pub sigma: Length,
    /// Part of the attempts that are uniform samples instead, in \[0, 1\]; without obstacles only these find
    /// states.
    pub uniform: f64,
}

impl Mixing {
    pub(crate) fn checked<C: Space>(&self, space: &C) -> Result<(f64, f64), BuildError> {
        Ok((length(&sigma(""), self.sigma, space)?, part(UNIFORM, self.uniform)?))
    }

    pub(crate) fn read(self, settings: &Settings) -> Result<Self, BuildError> {
        Ok(Self {
            sigma: settings.length(SIGMA)?.unwrap_or(self.sigma),
            uniform: settings.number(UNIFORM)?.unwrap_or(self.uniform),
        })
    }
}

const SIGMA: &str = "sigma";
const UNIFORM: &str = "uniform";

pub(crate) const fn sigma(default: &'static str) -> Parameter {
    Parameter {
        name: SIGMA,
        range: "in (0, extent of the space], or with % in (0%, 100%] of the extent",
        default,
        doc: "standard deviation of the distance between the states of a pair",
    }
}

pub(crate) const fn uniform(default: &'static str) -> Parameter {
    Parameter {
        name: UNIFORM,
        range: "in [0, 1]",
        default,
        doc: "part of the attempts that are uniform samples instead",
    }
}

/// `value` if it is in \[0, 1\].
pub(crate) fn part(name: &'static str, value: f64) -> Result<f64, BuildError> {
    if (0.0..=1.0).contains(&value) {
        return Ok(value);
    }
    Err(BuildError::OutOfRange { name, value, range: "in [0, 1]".to_owned() })
}

/// Which pairs of states are drawn, and which state of a pair is taken.
pub trait PairRule: Copy + Debug + Send {
    /// One attempt: a free state, or none. `sigma` is the standard deviation of the distance of the pair,
    /// positive and in the metric of the space.
    fn attempt<C: Space>(
        space: &C,
        free: impl FnMut(&C::State) -> bool,
        sigma: f64,
        rng: &mut Rng,
    ) -> Option<C::State>;
}

/// Free states by pairs, and some uniform samples: the generator of Gaussian and of bridge-test PRM.
#[derive(Clone, Copy, Debug)]
pub struct Pairs<R> {
    sigma: f64,
    uniform: f64,
    rule: PhantomData<R>,
}

impl<R: PairRule> Pairs<R> {
    /// # Errors
    /// When a parameter is out of range.
    pub fn new<C: Space>(space: &C, mixing: Mixing) -> Result<Self, BuildError> {
        let (sigma, uniform) = mixing.checked(space)?;
        Ok(Self { sigma, uniform, rule: PhantomData })
    }

    /// The parts of a planner with this generator.
    ///
    /// # Errors
    /// When a parameter is out of range.
    pub fn parts<C: Space>(
        space: &C,
        reach: Reachable,
        mixing: Mixing,
    ) -> Result<RoadmapPlannerParts<Self, NearestConnector, AStar>, BuildError> {
        Ok(RoadmapPlannerParts::new(Self::new(space, mixing)?, NearestConnector::new(reach)?))
    }

    pub(crate) fn read<C: Space>(
        space: &C,
        settings: &Settings,
        mixing: Mixing,
    ) -> Result<RoadmapPlannerParts<Self, StagedConnector, AStar>, BuildError> {
        let reach = reachable(space, settings)?;
        let connector = StagedConnector::new(reach, ConnectionStages::default().read(settings)?)?;
        Ok(Self::parts(space, reach, mixing.read(settings)?)?.connected_by(connector))
    }
}

impl<R, C, L> NodeGenerator<C, L> for Pairs<R>
where
    R: PairRule,
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
    fn generate(
        &mut self,
        _: u64,
        _: &Roadmap<C::State, L::Edge>,
        checker: &mut EdgeChecker<'_, C, L>,
        rng: &mut Rng,
        out: &mut Vec<Candidate<C::State, L::Edge>>,
    ) {
        if drew_uniform(self.uniform, checker, rng, out) {
            return;
        }
        let space = checker.space();
        let found = R::attempt(space, |q: &C::State| checker.admits(q), self.sigma, rng);
        out.extend(found.map(|q| Candidate::new(q, MilestoneKind::Near)));
    }

    fn independent(&self, _: &Roadmap<C::State, L::Edge>) -> u64 {
        u64::MAX
    }
}

/// The planner that generates nodes by [`Pairs`] under a rule.
pub type PairsPlanner<'c, C, L, N, R> = RoadmapPlanner<'c, C, L, Pairs<R>, NearestConnector, AStar, N>;

constructors! {
    "The planner" PairsPlanner<C, L, N, R> where [R: PairRule],
    |space, reach: Reachable, mixing: Mixing| Pairs::parts(space, reach, mixing)
}

/// Decides whether this attempt is a uniform sample; if so, writes it to `out` if it is free. Returns the
/// decision.
pub(crate) fn drew_uniform<C, L>(
    probability: f64,
    checker: &mut EdgeChecker<'_, C, L>,
    rng: &mut Rng,
    out: &mut Vec<Candidate<C::State, L::Edge>>,
) -> bool
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
    let draw = rng.random::<f64>() < probability;
    if draw {
        let q = checker.space().sample_uniform(rng);
        if checker.admits(&q) {
            out.push(Candidate::new(q, MilestoneKind::Plain));
        }
    }
    draw
}
