//! Dynamic-domain RRT: nodes that failed once are only grown toward samples nearby.
//!
//! A. Yershova, L. Jaillet, T. Siméon and S. M. LaValle, *Dynamic-domain RRTs: efficient exploration by
//! controlling the sampling domain*, ICRA 2005, on the two trees of [RRT-Connect](super::rrt_connect). With
//! `adapt` above 0, and as [`adaptive`] by name, the radii are not fixed: L. Jaillet, A. Yershova, S. M.
//! LaValle and T. Siméon, *Adaptive tuning of the sampling domain for dynamic-domain RRTs*, IROS 2005.
//!
//! Each node has a radius, infinite at first. From one tree that holds the start and one that
//! holds the goal, repeat:
//! 1. draw samples, uniform in the space, until one is no farther from its nearest node in the tree
//!    whose turn it is than the radius of that node; after `tries` samples take the next;
//! 2. extend the tree from that node, one step at most, toward it; where that fails, an infinite
//!    radius becomes `radius`, another is multiplied by 1 - `adapt` but not below `least`; where
//!    it succeeds, a finite radius is multiplied by 1 + `adapt`;
//! 3. if that added a node, connect the other tree to it, regardless of radii;
//! 4. where the trees have met, verify the path: return it, or prune from the edge that failed;
//! 5. the other tree has the next turn.
//!
//! **When to use it.** Where the tree is enclosed, as in a bug trap: then most of the space is nearest to
//! nodes at a wall, and plain RRT runs into the walls again and again. Pays off where checking a motion costs
//! more than finding a nearest neighbour. The adaptive variant needs no good radius.
//!
//! The paper's radius is ten steps, of much shorter steps than here. `tries` is not in the paper: in spaces
//! of many dimensions nearly every sample may be refused.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `step`: longest step | (0, extent of the space] | 5% of the extent |
//! | `radius`: of nodes that failed for the first time, in steps | (0, ∞) | 2 |
//! | `adapt`: part by which a radius grows and shrinks | \[0, 1) | 0, adaptive 0.05 |
//! | `least`: smallest radius, in steps | (0, `radius`\] | 0.5 |
//! | `tries`: samples refused in a row before one is taken regardless | 0, 1, 2, … | 100 |
//! | `goal-bias`: probability of sampling a further goal state, where there is a sampler | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//! | `balance`: a tree with more than this times the nodes of the other one waits; 0 for strict turns | 0, or at least 1 | 0 |
//!
//! A point goes around a disc in the unit square:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Length, Rn, Rng, Straight};
//! use mp_tree::{Domain, DdRrt, Problem, Tuning};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//!
//! for domain in [Domain::fixed(), Domain::adaptive()] {
//!     let problem = Problem::new(&space, local.clone(), verifier.clone(), start, goal)?;
//!     let mut planner = DdRrt::new(problem, Tuning::default(), domain)?;
//!     let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//!     let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//!     assert_eq!((path.states.first(), path.states.last()), (Some(&start), Some(&goal)));
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::{BALANCE, GOAL_BIAS, NEEDS_BOTH_ENDS, PATIENCE, STEP};
use crate::{
    Acceptable, Append, BuildError, Connect, Extend, NearestSelector, Parameter, PlannerInfo, Purpose,
    Samples, Selector, Settings, TreePlannerParts, Tuning, TwoTrees,
};
use mp_cspace::{Hit, NearestNeighbors, NodeId, Rng, Space, Uniform};

/// [`Domain::radius`].
const RADIUS: Parameter = Parameter {
    name: "radius",
    range: "positive and finite, in steps",
    default: "2",
    doc: "how far a sample may be from a node that failed",
};
/// [`Domain::tries`].
const TRIES: Parameter = Parameter {
    name: "tries",
    range: "a whole number",
    default: "100",
    doc: "samples refused in a row before one is taken regardless",
};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "dd-rrt",
    summary: "RRT-Connect that refuses samples far from nodes that failed; for traps and tight spaces",
    citation: "Yershova, Jaillet, Siméon and LaValle 2005",
    parameters: &[STEP, RADIUS, TRIES, GOAL_BIAS, PATIENCE, BALANCE],
    aliases: &["dynamic-domain"],
    cannot: NEEDS_BOTH_ENDS,
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let domain = Domain::fixed().read(args.settings)?;
    Ok(Box::new(DdRrt::with_index(args.problem, args.index, args.tuning, domain)?))
}

/// The variant whose radii adapt, by name.
pub mod adaptive {
    use super::*;

    /// [`Domain::adapt`].
    const ADAPT: Parameter = Parameter {
        name: "adapt",
        range: "in [0, 1)",
        default: "0.05",
        doc: "part by which the radius of a node grows with a success and shrinks with a failure",
    };
    /// [`Domain::least`].
    const LEAST: Parameter = Parameter {
        name: "least",
        range: "in (0, radius], in steps",
        default: "0.5",
        doc: "smallest radius of a node",
    };

    /// The entry of [`planners`](crate::planners).
    pub const INFO: PlannerInfo = PlannerInfo {
        name: "add-rrt",
        summary: "dynamic-domain RRT that tunes itself; for traps and tight spaces",
        citation: "Jaillet, Yershova, LaValle and Siméon 2005",
        parameters: &[STEP, RADIUS, ADAPT, LEAST, TRIES, GOAL_BIAS, PATIENCE, BALANCE],
        aliases: &["adaptive-dynamic-domain"],
        cannot: NEEDS_BOTH_ENDS,
    };

    pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
        let domain = Domain::adaptive().read(args.settings)?;
        Ok(Box::new(DdRrt::with_index(args.problem, args.index, args.tuning, domain)?))
    }
}

/// The parameters of the dynamic domain: how near a sample must be to a node that failed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// The radius of a node that has failed for the first time, in steps; positive.
    pub radius: f64,
    /// The part by which the radius grows with a success and shrinks with a failure, in \[0, 1).
    pub adapt: f64,
    /// The smallest radius, in steps; positive, at most `radius`.
    pub least: f64,
    /// After this many refusals in a row the next sample is taken regardless, so that planning does not
    /// stall.
    pub tries: u64,
}

impl Domain {
    /// The defaults of dynamic-domain RRT.
    #[must_use]
    pub fn fixed() -> Self {
        Self { radius: 2.0, adapt: 0.0, least: 0.5, tries: 100 }
    }

    /// The defaults of the adaptive dynamic domain.
    #[must_use]
    pub fn adaptive() -> Self {
        Self { adapt: 0.05, ..Self::fixed() }
    }

    /// The values that are set, the others as in `self`.
    ///
    /// # Errors
    /// When a value cannot be read.
    pub(crate) fn read(self, settings: &Settings) -> Result<Self, BuildError> {
        let radius = settings.number(RADIUS.name)?.unwrap_or(self.radius);
        let least = settings.number("least")?.unwrap_or(self.least.min(radius));
        let adapt = settings.number("adapt")?.unwrap_or(self.adapt);
        Ok(Self { radius, adapt, least, tries: settings.count(TRIES.name)?.unwrap_or(self.tries) })
    }
}

/// Selects the nearest node, unless it has failed and the target is beyond its radius. For joining always the
/// nearest node.
#[derive(Clone, Debug)]
pub struct DynamicDomain<S, N> {
    nearest: NearestSelector<N>,
    domain: Domain,
    radii: Vec<f64>,
    refused: u64,
    accepted: Option<(S, Hit)>,
}

impl<S, N> DynamicDomain<S, N> {
    /// A selector without nodes: an empty index, and the step (a distance) in which the domain is measured.
    ///
    /// # Errors
    /// When a value of the domain is out of range.
    pub fn new(index: N, domain: Domain, step: f64) -> Result<Self, BuildError> {
        let radius = BuildError::positive(RADIUS.name, domain.radius)?;
        if !(domain.least > 0.0 && domain.least <= radius) {
            let range = format!("in (0, {radius}], at most the radius");
            return Err(BuildError::OutOfRange { name: "least", value: domain.least, range });
        }
        if !(0.0..1.0).contains(&domain.adapt) {
            let range = "in [0, 1)".to_owned();
            return Err(BuildError::OutOfRange { name: "adapt", value: domain.adapt, range });
        }
        let domain = Domain { radius: radius * step, least: domain.least * step, ..domain };
        Ok(Self { nearest: NearestSelector(index), domain, radii: Vec::new(), refused: 0, accepted: None })
    }
}

impl<C: Space, N: NearestNeighbors<C>> Selector<C> for DynamicDomain<C::State, N> {
    fn select(
        &mut self,
        space: &C,
        points: &[C::State],
        target: &C::State,
        purpose: Purpose,
        rng: &mut Rng,
        out: &mut Vec<Hit>,
    ) {
        // A target that was accepted when it was sampled needs no second search.
        if let Some((_, hit)) = self.accepted.take_if(|(q, _)| purpose == Purpose::Explore && q == target) {
            out.clear();
            out.push(hit);
            return;
        }
        self.nearest.select(space, points, target, purpose, rng, out);
        let Some(hit) = out.first().filter(|_| purpose == Purpose::Explore) else { return };
        if hit.distance <= self.radii[hit.id as usize] || self.refused >= self.domain.tries {
            self.refused = 0;
            self.accepted = Some((target.clone(), *hit));
        } else {
            self.refused += 1;
            out.clear();
        }
    }
    fn near(&self, space: &C, points: &[C::State], q: &C::State, radius: f64, out: &mut Vec<Hit>) {
        self.nearest.near(space, points, q, radius, out);
    }
    fn inserted(&mut self, space: &C, points: &[C::State], id: NodeId, parent: Option<NodeId>) {
        self.accepted = None;
        self.radii.push(f64::INFINITY);
        self.nearest.inserted(space, points, id, parent);
    }
    fn feedback(&mut self, id: NodeId, purpose: Purpose, grew: bool) {
        self.accepted = None;
        if purpose != Purpose::Explore {
            return;
        }
        let Domain { radius, adapt, least, .. } = self.domain;
        let known = &mut self.radii[id as usize];
        *known = match (grew, known.is_finite()) {
            (true, _) => *known * (1.0 + adapt),
            (false, false) => radius,
            (false, true) => (*known * (1.0 - adapt)).max(least),
        };
    }
    fn pruned(&mut self, space: &C, points: &[C::State], survivors: &[NodeId]) {
        self.accepted = None;
        self.radii = survivors.iter().map(|&id| self.radii[id as usize]).collect();
        self.nearest.pruned(space, points, survivors);
    }
}

/// Dynamic-domain RRT: see the [module](self).
pub type DdRrt<'c, C, L, N> = TwoTrees<
    'c,
    C,
    L,
    Acceptable<Samples<Uniform<'c, C>>>,
    DynamicDomain<<C as Space>::State, N>,
    Extend,
    Connect,
    Append,
>;

constructors! {
    "Dynamic-domain RRT" DdRrt<C, L, N> where [N: Clone],
    |problem, index, tuning: Tuning, domain: Domain| {
        let target_sampler = Acceptable::new(Samples(Uniform(problem.space())));
        let target_sampler = target_sampler.with_interrupt(problem.interrupt().clone());
        let name = if domain.adapt > 0.0 { adaptive::INFO.name } else { INFO.name };
        let selector = DynamicDomain::new(index, domain, tuning.step.step_in(problem.space())?)?;
        let extender = (Extend, Connect::default());
        Self::assemble(name, problem, TreePlannerParts { target_sampler, selector, extender, inserter: Append, tuning })
    }
}
