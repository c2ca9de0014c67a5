//! Trees that grow from start and goal, beside the nodes of the generator.
//!
//! A roadmap of samples does not get out of a narrow place around the start or goal: few samples are in
//! there. L. E. Kavraki, P. Švestka, J.-C. Latombe and M. H. Overmars (*Probabilistic roadmaps for path
//! planning in high-dimensional configuration spaces*, 1996) leave it by random-bounce walks when they answer
//! a query. Here trees leave it, as an RRT does (S. M. LaValle, *Rapidly-exploring random trees*, 1998). A
//! uniform sample is drawn. The nearest to it, of up to 64 random nodes of the tree, takes a step toward it.
//! The end of the step becomes a node of the roadmap, and is connected as others are.

use super::settings::length;
use super::{
    Builder, Candidate, Connector, EdgeChecker, MilestoneKind, NodeGenerator, ParentMotion, Roadmap,
};
use mp_cspace::{
    BuildError, Direction, Extension, Length, LocalPlanner, NearestNeighbors, NodeId, Observer, Reach,
    Reversible, Rng, Space,
    registry::{Parameter, Settings},
};
use rand::RngExt;
use std::ops::Range;

/// The part of the attempts of an [`EndGrowth`].
pub const ENDS: Parameter = Parameter {
    name: "ends",
    range: "in [0, 1)",
    default: "0",
    doc: "the part of the attempts that grow trees from start and goal; 0.5 gets out of narrow places",
};

/// The step of an [`EndGrowth`].
pub const ENDS_STEP: Parameter = Parameter {
    name: "ends-step",
    range: "in (0, extent of the space], or with % in (0%, 100%] of the extent",
    default: "3%",
    doc: "longest step of the trees from start and goal",
};

/// The most random nodes of a tree that are compared with a sample. Trees are local: an index for each would
/// be of little use.
const LOOKS: usize = 64;

/// How trees grow from start and goals. By default they do not.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EndGrowth {
    part: f64,
    step: f64,
}

impl EndGrowth {
    /// Trees that get this `part` of the attempts, in \[0, 1), in steps of at most `step`.
    ///
    /// # Errors
    /// When a parameter is out of range.
    pub fn new<C: Space>(space: &C, part: f64, step: Length) -> Result<Self, BuildError> {
        if !(0.0..1.0).contains(&part) {
            return Err(BuildError::OutOfRange {
                name: ENDS.name,
                value: part,
                range: ENDS.range.to_owned(),
            });
        }
        Ok(Self { part, step: length(&ENDS_STEP, step, space)? })
    }

    /// As the settings say.
    ///
    /// # Errors
    /// As [`new`](Self::new), and when a value cannot be read.
    pub fn read<C: Space>(space: &C, settings: &Settings) -> Result<Self, BuildError> {
        let part = settings.number(ENDS.name)?.unwrap_or_default();
        Self::new(space, part, settings.length(ENDS_STEP.name)?.unwrap_or(Length::Fraction(0.03)))
    }
}

/// The trees that grow from start and goals.
#[derive(Clone, Debug)]
pub(crate) struct EndTrees {
    growth: EndGrowth,
    /// The nodes of the tree of the start, and of that of all goals.
    trees: [Vec<NodeId>; 2],
    attempts: u64,
    grown: u64,
}

impl EndTrees {
    pub(crate) fn new(growth: EndGrowth) -> Self {
        Self { growth, trees: [Vec::new(), Vec::new()], attempts: 0, grown: 0 }
    }

    /// Begins anew with these nodes.
    pub(crate) fn plant(&mut self, start: NodeId, goals: &[NodeId]) {
        (self.attempts, self.grown) = (0, 0);
        self.trees = [vec![start], goals.to_vec()];
    }

    /// Adds further goals.
    pub(crate) fn add_goals(&mut self, goals: &[NodeId]) {
        self.trees[1].extend(goals);
    }

    /// Whether the next attempt is for the trees. Counts attempts.
    pub(crate) fn is_next(&mut self) -> bool {
        self.attempts += 1;
        let due = (self.attempts as f64 * self.growth.part) as u64 > self.grown;
        due && self.trees.iter().any(|tree| !tree.is_empty())
    }

    /// Lets one of the trees make a step; they take turns. Returns the ids of the nodes that were added.
    pub(crate) fn grow<C, L, G, K, N>(
        &mut self,
        builder: &mut Builder<'_, C, L, G, K, N>,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Range<NodeId>
    where
        C: Space,
        L: LocalPlanner<C::State, Edge: Reversible>,
        G: NodeGenerator<C, L>,
        K: Connector<C, L>,
        N: NearestNeighbors<C>,
    {
        let Builder { map, checker, .. } = &mut *builder;
        let before = map.len() as NodeId;
        self.grown += 1;
        let turn = (self.grown % 2) as usize;
        let turn = if self.trees[turn].is_empty() { 1 - turn } else { turn };
        let Some(candidate) = self.step(turn, map, checker, rng) else { return before..before };
        builder.adopt(candidate, observer);
        let after = builder.map.len() as NodeId;
        self.trees[turn].extend(before..after);
        before..after
    }

    /// A step of a tree.
    fn step<C: Space, L: LocalPlanner<C::State>>(
        &self,
        turn: usize,
        map: &Roadmap<C::State, L::Edge>,
        checker: &mut EdgeChecker<'_, C, L>,
        rng: &mut Rng,
    ) -> Option<Candidate<C::State, L::Edge>> {
        let tree = &self.trees[turn];
        let (space, q) = (checker.space(), checker.space().sample_uniform(rng));
        let distance = |id: &NodeId| space.distance(map.state(*id), &q);
        let nearer = |a: &NodeId, b: &NodeId| distance(a).total_cmp(&distance(b));
        let near = if tree.len() <= LOOKS {
            tree.iter().copied().min_by(nearer)
        } else {
            (0..LOOKS).map(|_| tree[rng.random_range(0..tree.len())]).min_by(nearer)
        };
        let near = near?;
        let from = map.state(near).clone();
        let step = checker.extend(&from, &q, Direction::Forward, Reach::Step(self.growth.step));
        let (Extension::Advanced(motion) | Extension::Reached(motion)) = step else { return None };
        // A step may vanish in rounding.
        if motion.end == from {
            return None;
        }
        let mut candidate = Candidate::new(motion.end.clone(), MilestoneKind::Expanded);
        candidate.parent = Some(ParentMotion { from: Some(near), motion });
        Some(candidate)
    }
}
