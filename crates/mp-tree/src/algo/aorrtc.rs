//! AORRTC: RRT-Connect again and again in the space of states and costs, so that its paths become optimal.
//!
//! T. S. Wilson, W. Thomason, Z. Kingston and J. D. Gammell, *AORRTC: almost-surely asymptotically
//! optimal planning with RRT-Connect*, IEEE Robotics and Automation Letters 10(12), 2025; an
//! instance of AO-x: K. Hauser and Y. Zhou, *Asymptotically optimal planning by feasible kinodynamic
//! planning in a state–cost space*, IEEE T-RO 32(6), 2016.
//!
//! The first search is [RRT-Connect](super::rrt_connect). With the cost c of the best path, g the cost
//! from the root of a tree and ĝ, ĥ the distances to its root and to the other's, the next searches
//! begin with new trees and repeat:
//! 1. draw a sample x with ĝ(x) + ĥ(x) < c as [Informed RRT*](super::informed_rrt_star) does, and a cost
//!    b between ĝ(x) and c − ĥ(x);
//! 2. of the nodes v with g(v) + d(v, x) ≤ b find that nearest to (x, b) in states and costs, the one with
//!    the least d(v, x)² + (b − g(v))²; move from there one step toward x;
//! 3. draw a smaller cost for the new state, between ĝ and its present cost, and find its nearest node
//!    likewise: where that node is cheaper and the motion free it becomes the parent; repeat until it does
//!    not;
//! 4. connect the other tree to the new state, from the node nearest to it in states and costs by which
//!    the path would cost less than c;
//! 5. where the trees have met, verify the path, replace parts of it by single motions where these are
//!    free and cheaper, return it, and begin the next search with its cost;
//! 6. the other tree has the next turn. A search without success ends after 10 000 iterations, and each
//!    search after it may take 10 000 iterations more.
//!
//! The paper also smooths paths by B-splines. That is possible for straight motions only, and left out here.
//!
//! **When to use it.** Try it first when the length of the path matters: it has a path as soon as RRT-Connect
//! has one, and improves it from then on. Both ends must be known states (or the goal a sampler), motions
//! must run backward as well as forward, the metric should be symmetric and satisfy the triangle inequality,
//! and no motion should cost less than its distance. It lowers the [objective](crate::Problem::with_objective) of the
//! problem, which is the length by default.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `step`: longest step | (0, extent of the space] | 5% of the extent |
//! | `goal-bias`: probability of sampling a further goal state, where there is a sampler | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//!
//! A point goes around a disc, on ever shorter paths:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Length, Rn, Rng, Straight};
//! use mp_tree::{Aorrtc, Problem, Tuning, improve};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//!
//! let problem = Problem::new(&space, local, verifier, start, goal)?;
//! let mut planner = Aorrtc::new(problem, Tuning::default())?;
//! let (best, _) = improve(&mut planner, &mut Rng::seed(1), &mut Iterations(3_000), &mut (), |_, _| ());
//! let length = best.ok_or("no path")?.length(&space);
//! // Two tangents of 0.265 and an arc of 0.509.
//! assert!(length > 1.038 && length < 1.07, "{length}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::{GOAL_BIAS, NEEDS_BOTH_ENDS, PATIENCE, STEP};
use crate::engine::{constructors, joined};
use crate::{
    Append, BuildError, Connect, Core, Extender, Growing, Grown, Informed, Inserter, NearestSelector,
    PlannerInfo, SearchTree, Selector, Tree, Tuning,
};
use mp_cspace::{
    Direction, Event, Extension, Hit, LocalPlanner, NearestNeighbors, NodeId, Observer, PathOf, Planner,
    Progress, Reach, Rng, Space,
};
use rand::RngExt;

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "aorrtc",
    summary: "RRT-Connect for ever shorter paths until it is stopped; the first to try for short paths",
    citation: "Wilson, Thomason, Kingston and Gammell 2025",
    parameters: &[STEP, GOAL_BIAS, PATIENCE],
    aliases: &[],
    cannot: NEEDS_BOTH_ENDS,
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    Ok(Box::new(Aorrtc::with_index(args.problem, args.index, args.tuning)?))
}

/// A search without success ends after this many iterations more than the one before.
const PATIENT: u64 = 10_000;
/// Most smaller costs drawn for one new state.
const RESAMPLED: usize = 100;
/// The least part of its cost by which a path must be better.
const GAIN: f64 = 1e-9;

/// Trees with fewer nodes than this many times those that would be asked for are searched node by node: the cost alone rules out most.
const FEW: usize = 16;

/// The node nearest to `q` in states and costs, of those through which `q` costs at most `bound`.
fn nearest_within<C: Space, E, Se: Selector<C>>(
    space: &C,
    tree: &Tree<C::State, E>,
    selector: &Se,
    q: &C::State,
    bound: f64,
) -> Option<NodeId> {
    let nearer = |best: Option<(f64, NodeId)>, id: NodeId, distance: f64| {
        let found = (mp_math::hypot(distance, bound - tree.cost(id)), id);
        let nearest = best.is_none_or(|best| found.0.total_cmp(&best.0).then(id.cmp(&best.1)).is_lt());
        if tree.cost(id) + distance <= bound && nearest { Some(found) } else { best }
    };
    let (mut hits, mut k): (Vec<Hit>, usize) = (Vec::new(), 8);
    while k * FEW <= tree.len() {
        selector.k_nearest(space, tree.states(), q, k, &mut hits);
        let best = hits.iter().fold(None, |best, hit| nearer(best, hit.id, hit.distance));
        let farthest = hits.last().map_or(f64::INFINITY, |hit| hit.distance);
        // Nodes not seen yet are at least that far away in states alone.
        if hits.len() < k || best.is_some_and(|(distance, _)| distance <= farthest) {
            return best.map(|(_, id)| id);
        }
        k *= 2;
    }
    let best = (0..tree.len() as NodeId).fold(None, |best: Option<(f64, NodeId)>, id| {
        let left = bound - tree.cost(id);
        // It is at least that far away in costs alone.
        let may_be_nearer = left >= 0.0 && best.is_none_or(|(distance, _)| left <= distance);
        if may_be_nearer { nearer(best, id, space.distance(tree.state(id), q)) } else { best }
    });
    best.map(|(_, id)| id)
}

/// One step, whose end is given ever cheaper parents.
struct Resampled<F>(F);

impl<C: Space, L: LocalPlanner<C::State>, F: Fn(Direction, &C::State) -> f64> Extender<C, L>
    for Resampled<F>
{
    fn extend<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        from: NodeId,
        growing: &mut Growing<'_, '_, C, L, Se, A>,
    ) -> Grown {
        let direction = growing.tree().direction();
        let (origin, target) = (growing.tree().state(from).clone(), growing.target().clone());
        let reach = Reach::Step(growing.checker().step());
        let extension = growing.checker().extend(&origin, &target, direction, reach);
        let (mut parent, mut motion, reached) = match extension {
            Extension::Trapped => return Grown::Trapped,
            Extension::Advanced(motion) => (from, motion, false),
            Extension::Reached(motion) => (from, motion, true),
        };
        let least = (self.0)(direction, &motion.end);
        for _ in 0..RESAMPLED {
            let cost = growing.tree().cost(parent) + motion.cost;
            if cost.partial_cmp(&least) != Some(std::cmp::Ordering::Greater) {
                break;
            }
            let bound = least + (cost - least) * growing.rng().random::<f64>();
            let space = growing.checker().space();
            let nearest = nearest_within(space, growing.tree(), growing.selector(), &motion.end, bound);
            let Some(id) = nearest.filter(|&id| id != parent) else { break };
            let state = growing.tree().state(id).clone();
            match growing.checker().reach(&state, &motion.end, direction) {
                Some(cheaper) if growing.tree().cost(id) + cheaper.cost < cost => {
                    (parent, motion) = (id, cheaper)
                }
                _ => break,
            }
        }
        growing.insert(parent, if reached { Extension::Reached(motion) } else { Extension::Advanced(motion) })
    }
}

/// AORRTC: see the [module](self).
#[derive(Debug)]
pub struct Aorrtc<'c, C: Space, L: LocalPlanner<C::State>, N> {
    core: Core<'c, C, L>,
    trees: [SearchTree<C, L, NearestSelector<N>, Append>; 2],
    /// An empty index.
    index: N,
    informed: Informed<'c, C>,
    rooted: usize,
    tried: usize,
    best: f64,
    turn: usize,
    /// The iteration in which the search began, and how many iterations it may take.
    since: u64,
    allowed: u64,
}

constructors! {
    "AORRTC" Aorrtc<C, L, N> where [N: Clone],
    |problem, index, tuning: Tuning| {
        if !problem.goals().can_aim() {
            return Err(BuildError::NoGoalState { planner: INFO.name });
        }
        let informed = Informed::of(&problem);
        Ok(Self {
            core: Core::optimising(problem, &tuning)?,
            informed,
            trees: Self::trees_with(&index),
            index,
            rooted: 0,
            tried: 0,
            best: f64::INFINITY,
            turn: 0,
            since: 0,
            allowed: PATIENT,
        })
    }
}

impl<'c, C: Space, L: LocalPlanner<C::State>, N: NearestNeighbors<C> + Clone> Aorrtc<'c, C, L, N> {
    fn trees_with(index: &N) -> [SearchTree<C, L, NearestSelector<N>, Append>; 2] {
        let tree = |i, direction| SearchTree::new(i, direction, NearestSelector(index.clone()), Append);
        [tree(0, Direction::Forward), tree(1, Direction::Backward)]
    }

    /// The trees of the current search, from the start and from the goal.
    #[must_use]
    pub fn trees(&self) -> [&Tree<C::State, L::Edge>; 2] {
        [self.trees[0].nodes(), self.trees[1].nodes()]
    }

    /// Adds the roots that are missing, and tries the straight motions to goals that were not tried yet.
    fn begin(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        if let Some(root) = self.core.add_start(&mut self.trees[0], observer)
            && self.best > 0.0
        {
            self.best = 0.0;
            return Some(self.trees[0].nodes().path(root));
        }
        let space = self.core.checker.space();
        while let Some(goal) = self.core.goals.listed().get(self.rooted) {
            self.rooted += 1;
            if !self.trees[1].contains(space, goal) {
                self.trees[1].add_root(space, goal.clone(), observer);
            }
        }
        while let Some(goal) = self.core.goals.listed().get(self.tried) {
            self.tried += 1;
            let roots = 0..self.trees[1].nodes().len() as NodeId;
            let mut roots = roots.filter(|&id| self.trees[1].nodes().state(id) == goal);
            let root = roots.find(|&id| self.trees[1].nodes().parent(id).is_none());
            let grown = self.trees[0].connect_directly(0, goal, &mut self.core.checker, rng, observer);
            if let (Grown::Reached(id), Some(root)) = (grown, root)
                && let Some(path) = self.candidate([id, root], rng, observer)
            {
                return Some(path);
            }
        }
        None
    }

    /// Begins a search with new trees.
    fn renew(&mut self, observer: &mut dyn Observer<C::State>) {
        self.trees = Self::trees_with(&self.index);
        self.rooted = 0;
        self.since = self.core.iterations;
        for tree in 0..2 {
            observer.on(Event::Pruned { tree, survivors: &[] });
        }
    }

    /// The node of a tree to grow from toward `q`, at a cost of at most `bound`.
    fn choose(&mut self, tree: usize, q: &C::State, bound: f64) -> Option<NodeId> {
        let space = self.core.checker.space();
        let tree = &mut self.trees[tree];
        if bound < f64::INFINITY {
            return nearest_within(space, tree.nodes(), tree.selector(), q, bound);
        }
        let mut hits = Vec::new();
        tree.selector().k_nearest(space, tree.nodes().states(), q, 1, &mut hits);
        hits.first().map(|hit| hit.id)
    }

    /// The path through two nodes with the same state, shortened, if it is better than the last and passes
    /// verification; the part from a failed edge on is pruned.
    fn candidate(
        &mut self,
        meeting: [NodeId; 2],
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Option<PathOf<C, L>> {
        for (tree, id) in self.trees.iter_mut().zip(meeting) {
            if !tree.verify(id, &mut self.core.checker, observer, |_| ()) {
                return None;
            }
        }
        let [a, b] = self.trees();
        if a.cost(meeting[0]) + b.cost(meeting[1]) >= self.best * (1.0 - GAIN) {
            return None;
        }
        let mut costs: Vec<f64> = a.lineage(meeting[0]).filter_map(|id| a.edge_cost(id)).collect();
        costs.reverse();
        costs.extend(b.lineage(meeting[1]).filter_map(|id| b.edge_cost(id)));
        let mut path = joined([a.path(meeting[0]), b.path(meeting[1])]);
        self.shorten(&mut path, &mut costs, rng);
        self.best = costs.iter().sum();
        self.informed.found(self.best);
        self.allowed = PATIENT;
        self.renew(observer);
        Some(path)
    }

    /// Replaces parts of a path by single verified motions that are cheaper.
    fn shorten(&mut self, path: &mut PathOf<C, L>, costs: &mut Vec<f64>, rng: &mut Rng) {
        for _ in 0..2 * path.edges.len() {
            if path.edges.len() < 2 {
                return;
            }
            let i = rng.random_range(0..path.edges.len() - 1);
            let j = rng.random_range(i + 2..path.states.len());
            let cost: f64 = costs[i..j].iter().sum();
            let (from, to) = (&path.states[i], &path.states[j]);
            if self.core.checker.space().distance(from, to) >= cost * (1.0 - GAIN) {
                continue;
            }
            let Some(motion) = self.core.checker.reach(from, to, Direction::Forward) else { continue };
            if motion.cost < cost && self.core.checker.passes(from, &motion.edge, to, Direction::Forward) {
                path.states.drain(i + 1..j);
                path.edges.splice(i..j, [motion.edge]);
                costs.splice(i..j, [motion.cost]);
            }
        }
    }
}

impl<C: Space, L: LocalPlanner<C::State>, N: NearestNeighbors<C> + Clone> Planner<C::State>
    for Aorrtc<'_, C, L, N>
{
    type Edge = L::Edge;

    fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        self.core.iterations += 1;
        if self.best < f64::INFINITY && self.core.iterations - self.since > self.allowed {
            self.allowed += PATIENT;
            self.renew(observer);
        }
        if let Some(path) = self.begin(rng, observer) {
            return Some(path);
        }
        if self.core.goals.has_sampler() {
            self.core.sample_goal(&mut self.trees[1], rng, observer);
        }
        let (turn, other) = (self.turn, 1 - self.turn);
        self.turn = other;
        let target = self.informed.sample(rng);
        observer.on(Event::Sampled(&target));
        let direction = self.trees[turn].nodes().direction();
        let least = self.informed.least(direction, &target);
        let most = self.best - self.informed.least(self.trees[other].nodes().direction(), &target);
        if most < least {
            return None;
        }
        let bound = if most < f64::INFINITY { least + (most - least) * rng.random::<f64>() } else { most };
        let from = self.choose(turn, &target, bound)?;
        let (tree, checker, informed) = (&mut self.trees[turn], &mut self.core.checker, &self.informed);
        let mut extender = Resampled(
            |direction, q: &C::State| if most < f64::INFINITY { informed.least(direction, q) } else { most },
        );
        let grown = tree.grow_from(from, &target, checker, &mut extender, rng, observer);
        let (Grown::Advanced(i) | Grown::Reached(i)) = grown else { return None };
        let state = self.trees[turn].nodes().state(i).clone();
        let from = self.choose(other, &state, self.best - self.trees[turn].nodes().cost(i))?;
        let (tree, checker) = (&mut self.trees[other], &mut self.core.checker);
        let joined = tree.grow_from(from, &state, checker, &mut Connect::default(), rng, observer);
        let Grown::Reached(j) = joined else { return None };
        self.candidate(if turn == 0 { [i, j] } else { [j, i] }, rng, observer)
    }

    fn progress(&self) -> Progress {
        let nodes = self.trees.iter().map(|tree| tree.nodes().len()).sum();
        self.core.progress(nodes)
    }

    fn improves(&self) -> bool {
        true
    }
}
