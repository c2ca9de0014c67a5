//! The anytime loop with one tree.

use super::{
    Core, Extender, Grown, Inserter, Purpose, SearchTree, Selector, TargetSampler, Tree, TreePlannerParts,
};
use crate::trace;
use mp_cspace::{
    BuildError, Direction, Event, LocalPlanner, NodeId, Observer, Path, PathOf, Planner, Problem, Progress,
    Rng, Space, Stop, StopReason,
};

/// The least part of its cost by which a path must be better than the one before: less may be rounding.
const GAIN: f64 = 1e-9;

/// A planner that grows one tree from the start and returns ever cheaper verified paths: shorter ones, or by
/// the [objective](Problem::with_objective) of the problem.
///
/// As [`SingleTree`](crate::SingleTree), but it remembers which nodes are in the goal. Whenever the cheapest
/// path to any of them costs less than the path returned last, because of a new node or because the tree was
/// rewired, it is verified and returned. Listed goal states that are reached are no longer aimed at.
#[derive(Debug)]
pub struct Improving<'c, C: Space, L: LocalPlanner<C::State>, P, Se, G, A> {
    core: Core<'c, C, L>,
    tree: SearchTree<C, L, Se, A>,
    target_sampler: P,
    extender: G,
    /// The nodes in the goal, in the order in which they were found.
    arrived: Vec<NodeId>,
    /// How many nodes have been tested for lying in the region.
    tested: NodeId,
    best: f64,
}

impl<'c, C, L, P, Se, G, A> Improving<'c, C, L, P, Se, G, A>
where
    C: Space,
    L: LocalPlanner<C::State>,
    P: TargetSampler<C>,
    Se: Selector<C>,
    G: Extender<C, L>,
    A: Inserter<C, L>,
{
    /// A planner for a problem.
    ///
    /// # Errors
    /// When a parameter is out of range.
    pub fn assemble(
        problem: Problem<'c, C, L>,
        parts: TreePlannerParts<P, Se, G, A>,
    ) -> Result<Self, BuildError> {
        Ok(Self {
            core: Core::optimising(problem, &parts.tuning)?,
            tree: SearchTree::new(0, Direction::Forward, parts.selector, parts.inserter),
            target_sampler: parts.target_sampler,
            extender: parts.extender,
            arrived: Vec::new(),
            tested: 0,
            best: f64::INFINITY,
        })
    }

    /// The tree; empty before the first step.
    #[must_use]
    pub fn tree(&self) -> &Tree<C::State, L::Edge> {
        self.tree.nodes()
    }

    /// The cost of the path returned last; infinite before there is one.
    #[must_use]
    pub fn best(&self) -> f64 {
        self.best
    }

    /// Adds the root and tries the straight motions to the goals.
    fn begin(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) {
        // `better` finds a start that is in the goal.
        self.core.add_start(&mut self.tree, observer);
        while self.extender.allows_direct()
            && let Some(grown) = self.core.connect_directly(&mut self.tree, rng, observer)
        {
            if !self.core.goals.has_region() {
                self.note(grown);
            }
        }
    }

    /// Remembers a node that reached the state aimed at.
    fn note(&mut self, grown: Grown) {
        if let Grown::Reached(id) = grown
            && !self.arrived.contains(&id)
        {
            self.arrived.push(id);
        }
    }

    /// A goal not reached yet to aim at instead of exploring, with probability `goal_bias`.
    fn aim(&mut self, rng: &mut Rng) -> Option<C::State> {
        let goal = self.core.aim(rng)?;
        let known = |&id: &NodeId| *self.tree.nodes().state(id) == goal;
        if self.core.goals.has_region() || !self.arrived.iter().any(known) { Some(goal) } else { None }
    }

    /// The cheapest path, if it is better than the path returned last and passes verification.
    fn better(&mut self, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        while self.core.goals.has_region() && (self.tested as usize) < self.tree.nodes().len() {
            let reached = self.core.goals.reached(self.tree.nodes().state(self.tested));
            self.arrived.extend(reached.then_some(self.tested));
            self.tested += 1;
        }
        loop {
            let (cost, id) = cheapest(self.tree.nodes(), &self.arrived)?;
            if self.best < f64::INFINITY && cost >= self.best - GAIN * self.best.abs() {
                return None;
            }
            let pruned = |survivors: &[NodeId]| {
                self.extender.pruned(Direction::Forward, survivors);
                rename(&mut self.arrived, &mut self.tested, survivors);
            };
            if let Some(path) = self.core.path(&mut self.tree, id, observer, pruned) {
                self.best = cost;
                trace::improved(cost, self.tree.nodes().len());
                self.target_sampler.improved(cost);
                return Some(path);
            }
            if self.core.checker.is_interrupted() {
                return None;
            }
        }
    }
}

/// The cheapest of some nodes, and its cost.
fn cheapest<S, E>(tree: &Tree<S, E>, nodes: &[NodeId]) -> Option<(f64, NodeId)> {
    let costs = nodes.iter().map(|&id| (tree.cost(id), id));
    costs.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
}

/// Gives nodes their new ids, after others were pruned.
fn rename(arrived: &mut Vec<NodeId>, tested: &mut NodeId, survivors: &[NodeId]) {
    *tested = survivors.partition_point(|&id| id < *tested) as NodeId;
    let renamed = |id: &NodeId| survivors.binary_search(id).ok().map(|new| new as NodeId);
    *arrived = arrived.iter().filter_map(renamed).collect();
}

impl<C, L, P, Se, G, A> Planner<C::State> for Improving<'_, C, L, P, Se, G, A>
where
    C: Space,
    L: LocalPlanner<C::State>,
    P: TargetSampler<C>,
    Se: Selector<C>,
    G: Extender<C, L>,
    A: Inserter<C, L>,
{
    type Edge = L::Edge;

    fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        self.core.iterations += 1;
        self.begin(rng, observer);
        if let Some(path) = self.better(observer) {
            return Some(path);
        }
        let (target, purpose) = match self.aim(rng) {
            Some(goal) => (goal, Purpose::Join),
            None => {
                let (points, selector) = self.tree.parts();
                (
                    self.target_sampler.next_target(rng, self.core.checker.space(), points, selector),
                    Purpose::Explore,
                )
            }
        };
        observer.on(Event::Sampled(&target));
        let grown =
            self.tree.toward(&target, purpose, &mut self.core.checker, &mut self.extender, rng, observer);
        if purpose == Purpose::Join && !self.core.goals.has_region() {
            self.note(grown);
        }
        self.better(observer)
    }

    fn progress(&self) -> Progress {
        self.core.progress(self.tree.nodes().len())
    }

    fn improves(&self) -> bool {
        true
    }
}

/// Runs a planner until it is stopped; returns the last path it found, and the reason. Calls `found` with
/// each path and the progress so far. A planner that does not [improve](Planner::improves) ends with its
/// first path.
///
/// ```
/// # use mp_cspace::{Discrete, FineDiscrete, Iterations, Length, Rn, Rng, Straight};
/// # use mp_tree::{Problem, RrtStar, Tuning, improve};
/// # use nalgebra::Vector2;
/// # let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
/// # let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
/// # let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
/// # let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
/// # let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
/// # let problem = Problem::new(&space, local, verifier, start, goal)?;
/// let mut planner = RrtStar::new(problem, Tuning::default())?;
/// let mut lengths = Vec::new();
/// let (best, _) = improve(&mut planner, &mut Rng::seed(1), &mut Iterations(3_000), &mut (), |path, _| {
///     lengths.push(path.length(&space));
/// });
/// assert!(lengths.len() > 1 && lengths.is_sorted_by(|a, b| a > b));
/// assert_eq!(best.unwrap().length(&space), *lengths.last().unwrap());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn improve<S, P: Planner<S> + ?Sized>(
    planner: &mut P,
    rng: &mut Rng,
    stop: &mut dyn Stop,
    observer: &mut dyn Observer<S>,
    mut found: impl FnMut(&Path<S, P::Edge>, Progress),
) -> (Option<Path<S, P::Edge>>, Option<StopReason>) {
    let mut best = None;
    loop {
        match planner.solve(rng, stop, observer) {
            mp_cspace::Outcome::Stopped(reason) => return (best, Some(reason)),
            mp_cspace::Outcome::Solved(path) => {
                found(&path, planner.progress());
                best = Some(path);
                if !planner.improves() {
                    return (best, None);
                }
            }
        }
    }
}
