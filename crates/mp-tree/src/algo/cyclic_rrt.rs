//! The cyclic variant of RRT: grows a graph with cycles, and lists alternative paths in it.
//!
//! N. Jouandeau, Y. Touati and A. Ali Cherif, *Incremental motion planning with Las Vegas
//! algorithms*, 2008, §2.3, after S. M. LaValle, *Rapidly-exploring random trees: a new tool for path
//! planning*, TR 98-11, 1998. Alternatives are listed as in J. Y. Yen, *Finding the k shortest loopless
//! paths in a network*, Management Science 17, 1971.
//!
//! From a tree that holds the start, repeat:
//! 1. choose a sample and the node q_prox nearest to it, and move one step at most toward the sample, to
//!    q_new, as [RRT](super::rrt) does;
//! 2. find the node q_exist most similar to q_new, within `tolerance`, that is neither q_prox nor joined
//!    to it by an edge;
//! 3. where there is one and the local planner has a motion from q_prox exactly to it, add that motion
//!    as an edge beside the tree, which closes a cycle, and no node;
//! 4. otherwise add q_new to the tree;
//! 5. where that is in the goal, verify the path: return it, or prune from the edge that failed.
//!
//! A listed goal state is always added. Stepping on after a path is found adds more edges.
//! [`alternatives`](CyclicRrt::alternatives) then lists the cheapest paths through both kinds of edges,
//! each run either way where the local planner has the motion back, and
//! [`routes`](CyclicRrt::routes) paths that are far apart (I. Abraham, D. Delling, A. V. Goldberg and
//! R. F. Werneck, *Alternative routes in road networks*, ACM J. of Experimental Algorithmics 18, 2013).
//!
//! **When to use it.** To get a choice of paths, or to see which routes around the obstacles exist. For one
//! path RRT is better: edges that close cycles do not explore (§2.3).
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `tolerance`: how far apart similar states are, in steps | \[0, 1\] | none; by name 0.5 |
//!
//! and those of [RRT](super::rrt). A small tolerance makes few cycles; a large one makes many, and many paths
//! that differ little. A passage may need nodes closer together than the tolerance: they are added as soon as
//! the nodes similar to them are joined. Made [by name](crate::build) it finds a path as RRT does, a little
//! slower; [`Planner::routes`] lists routes.
//!
//! Two routes around a block:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Planner, Length, Rn, Rng, Straight};
//! use mp_tree::{CyclicRrt, Problem, Tuning};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).amax() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let problem = Problem::new(&space, local, verifier, Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5))?;
//!
//! let mut planner = CyclicRrt::new(problem, Tuning::default(), 0.5)?;
//! let mut rng = Rng::seed(1);
//! while planner.progress().iterations < 1_000 {
//!     planner.step(&mut rng, &mut ());
//! }
//! let routes = planner.routes(2, 0.3)?;
//! let above = |i: usize| routes[i].0.states.iter().any(|q| q.y > 0.8);
//! assert!(routes.len() == 2 && above(0) != above(1));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::{GOAL_BIAS, PATIENCE, STEP};
use crate::{
    AppendDistinct, BuildError, EdgeChecker, Extender, Growing, Grown, Inserter, NearestSelector, Parameter,
    PlannerInfo, Samples, Selector, SingleTree, Tree, TreePlannerParts, Tuning,
};
use mp_cspace::shortest::{shortest_paths, shortest_via};
use mp_cspace::{
    Direction, Extension, Hit, Interrupt, LocalPlanner, NearestNeighbors, NodeId, Observer, Path, PathOf,
    Planner, Progress, Reach, Rng, Space, Uniform,
};
use std::collections::BTreeMap;

/// How far apart similar states are.
const TOLERANCE: Parameter = Parameter {
    name: "tolerance",
    range: "in [0, 1], in steps",
    default: "0.5",
    doc: "states no farther apart are similar: they are joined by an edge instead of added",
};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "cyclic-rrt",
    summary: "RRT with cycles, to list routes that are far apart; for one path RRT is better",
    citation: "Jouandeau, Touati and Ali Cherif 2008; LaValle 1998",
    parameters: &[STEP, TOLERANCE, GOAL_BIAS, PATIENCE],
    aliases: &[],
    cannot: &[],
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let tolerance = args.settings.part_of(&TOLERANCE)?;
    Ok(Box::new(CyclicRrt::with_index(args.problem, args.index, args.tuning, tolerance)?))
}

/// Paths and their costs.
pub type Listed<S, E> = Vec<(Path<S, E>, f64)>;

/// The two nodes of an edge, in forward time.
type Ends = (NodeId, NodeId);

/// Extends by one step, or adds an edge to a similar node: the extender of [`CyclicRrt`], which stores these
/// edges.
#[derive(Clone, Debug)]
pub struct Cyclic<S, E> {
    tolerance: f64,
    /// States that are always added, however similar to others.
    goals: Vec<S>,
    edges: BTreeMap<Ends, (E, f64)>,
    /// The answers of the verifier, and for motions back those of the local planner.
    asked: BTreeMap<Ends, Option<(E, f64)>>,
    near: Vec<Hit>,
}

impl<S: Clone + PartialEq, E: Clone> Cyclic<S, E> {
    /// Whether two nodes are the same or have an edge between them.
    fn joined(&self, tree: &Tree<S, E>, a: NodeId, b: NodeId) -> bool {
        let edge = self.edges.contains_key(&(a, b)) || self.edges.contains_key(&(b, a));
        a == b || edge || tree.parent(a) == Some(b) || tree.parent(b) == Some(a)
    }

    /// Both kinds of edges with their costs.
    fn all_edges(&self, tree: &Tree<S, E>) -> Vec<(Ends, f64)> {
        let hanging = (0..tree.len() as NodeId)
            .filter_map(|id| Some(((tree.parent(id)?, id), tree.edge_cost(id).unwrap_or_default())));
        hanging.chain(self.edges.iter().map(|(&ends, &(_, cost))| (ends, cost))).collect()
    }

    /// The arcs that leave each node, without dead ends. From goals only the arc to an extra last node, where
    /// all paths end. An edge that was not verified yet is assumed to be free, and to cost the same either
    /// way.
    fn arcs(&self, tree: &Tree<S, E>, goals: &[NodeId]) -> Vec<Vec<(u32, f64)>> {
        let edges = self.all_edges(tree);
        let mut around = vec![Vec::new(); tree.len()];
        for &((a, b), _) in &edges {
            around[a as usize].push(b);
            around[b as usize].push(a);
        }
        let mut degree: Vec<usize> = around.iter().map(Vec::len).collect();
        let kept = |id: NodeId| id == 0 || goals.contains(&id);
        let mut dead: Vec<NodeId> =
            (0..tree.len() as NodeId).filter(|&id| degree[id as usize] < 2 && !kept(id)).collect();
        while let Some(id) = dead.pop() {
            degree[id as usize] = 0;
            for &other in &around[id as usize] {
                let left = &mut degree[other as usize];
                *left = left.saturating_sub(1);
                if *left == 1 && !kept(other) {
                    dead.push(other);
                }
            }
        }
        let mut arcs = vec![Vec::new(); tree.len() + 1];
        for ((a, b), cost) in edges {
            for (from, to) in [(a, b), (b, a)] {
                let cost = match self.asked.get(&(from, to)) {
                    Some(answer) => answer.as_ref().map(|&(_, cost)| cost),
                    None => Some(cost),
                };
                let alive = [from, to].iter().all(|&id| degree[id as usize] > 0 || kept(id));
                if let (Some(cost), true, false) = (cost, alive, goals.contains(&from)) {
                    arcs[from as usize].push((to, cost));
                }
            }
        }
        for &goal in goals {
            arcs[goal as usize].push((tree.len() as u32, 0.0));
        }
        arcs
    }

    /// Verifies an edge in one direction, once. Returns whether that changes the arcs.
    fn ask<C, L>(&mut self, tree: &Tree<S, E>, checker: &mut EdgeChecker<'_, C, L>, (from, to): Ends) -> bool
    where
        C: Space<State = S>,
        L: LocalPlanner<S, Edge = E>,
    {
        if self.asked.contains_key(&(from, to)) {
            return false;
        }
        let (a, b) = (tree.state(from), tree.state(to));
        let hangs = |child: NodeId, parent| match (tree.parent(child) == Some(parent), tree.edge(child)) {
            (true, Some(edge)) => Some((edge.clone(), tree.edge_cost(child).unwrap_or_default())),
            _ => None,
        };
        let verified = tree.parent(to) == Some(from) && tree.is_verified(to);
        let (believed, forward) = match hangs(to, from).or_else(|| self.edges.get(&(from, to)).cloned()) {
            Some(edge) => (edge.1, Some(edge)),
            None => {
                let back = hangs(from, to).or_else(|| self.edges.get(&(to, from)).cloned());
                let new = checker.reach(a, b, Direction::Forward).map(|motion| (motion.edge, motion.cost));
                (back.map_or(f64::NAN, |edge| edge.1), new)
            }
        };
        let answer = forward.filter(|(edge, _)| verified || checker.passes(a, edge, b, Direction::Forward));
        let changed = answer.as_ref().is_none_or(|&(_, cost)| cost != believed);
        self.asked.insert((from, to), answer);
        changed
    }
}

impl<C: Space, L: LocalPlanner<C::State>> Extender<C, L> for Cyclic<C::State, L::Edge> {
    fn extend<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        from: NodeId,
        growing: &mut Growing<'_, '_, C, L, Se, A>,
    ) -> Grown {
        let (space, step) = (growing.checker().space(), growing.checker().step());
        let (direction, target) = (growing.tree().direction(), growing.target().clone());
        let a = growing.tree().state(from).clone();
        let extension = growing.checker().extend(&a, &target, direction, Reach::Step(step));
        let (Extension::Advanced(motion) | Extension::Reached(motion)) = &extension else {
            return Grown::Trapped;
        };
        if !self.goals.contains(&motion.end) {
            let tree = growing.tree();
            growing.selector().near(space, tree.states(), &motion.end, self.tolerance, &mut self.near);
            let other = self.near.iter().map(|hit| hit.id).find(|&id| !self.joined(tree, from, id));
            let state = other.map(|id| (id, tree.state(id).clone()));
            if let Some((to, b)) = state
                && let Some(cycle) = growing.checker().reach(&a, &b, direction)
            {
                self.edges.insert((from, to), (cycle.edge, cycle.cost));
                return Grown::Trapped;
            }
        }
        growing.insert(from, extension)
    }

    fn pruned(&mut self, _: Direction, survivors: &[NodeId]) {
        let renamed = |old| survivors.binary_search(&old).ok().map(|new| new as NodeId);
        let both = |(from, to)| Some((renamed(from)?, renamed(to)?));
        let edges = std::mem::take(&mut self.edges).into_iter();
        self.edges = edges.filter_map(|(ends, edge)| Some((both(ends)?, edge))).collect();
        let asked = std::mem::take(&mut self.asked).into_iter();
        self.asked = asked.filter_map(|(ends, answer)| Some((both(ends)?, answer))).collect();
    }
}

type Inner<'c, C, L, N, S, E> =
    SingleTree<'c, C, L, Samples<Uniform<'c, C>>, NearestSelector<N>, Cyclic<S, E>, AppendDistinct>;

/// The cyclic variant of RRT: see the [module](self).
#[derive(Debug)]
pub struct CyclicRrt<'c, C: Space, L: LocalPlanner<C::State>, N> {
    inner: Inner<'c, C, L, N, C::State, L::Edge>,
    /// The last states of the paths returned so far.
    arrived: Vec<C::State>,
}

constructors! {
    "The cyclic variant of RRT, where states within `tolerance` steps are similar," CyclicRrt<C, L, N>,
    |problem, index, tuning: Tuning, tolerance: f64| {
        if !(0.0..=1.0).contains(&tolerance) {
            let range = "in [0, 1], in steps".to_owned();
            return Err(BuildError::OutOfRange { name: "tolerance", value: tolerance, range });
        }
        let extender = Cyclic {
            tolerance: tolerance * tuning.step.step_in(problem.space())?,
            goals: problem.goals().listed().to_vec(),
            edges: BTreeMap::new(),
            asked: BTreeMap::new(),
            near: Vec::new(),
        };
        let (target_sampler, inserter) = (Samples(Uniform(problem.space())), AppendDistinct::default());
        let parts = TreePlannerParts { target_sampler, selector: NearestSelector(index), extender, inserter, tuning };
        Ok(Self { inner: SingleTree::assemble(problem, parts)?, arrived: Vec::new() })
    }
}

impl<'c, C: Space, L: LocalPlanner<C::State>, N: NearestNeighbors<C>> CyclicRrt<'c, C, L, N> {
    /// The tree; empty before the first step.
    #[must_use]
    pub fn tree(&self) -> &Tree<C::State, L::Edge> {
        self.inner.tree()
    }

    /// The edges beside the tree: from node, to node.
    pub fn cycles(&self) -> impl Iterator<Item = (NodeId, NodeId)> {
        self.inner.extender().edges.keys().copied()
    }

    /// The `k` cheapest paths, each with its cost, that visit no node twice, from the start to the goal
    /// states of the paths returned so far; the cheapest first, ties by node. No paths before the first path
    /// is returned. The cheapest often differ little: [`routes`](Self::routes) are far apart.
    ///
    /// Each edge has passed the verifier; edges that fail are left out from then on. The local planner makes
    /// the motions back. Both answers are cached. Costs a search of the graph for each node of each path.
    pub fn alternatives(&mut self, k: usize) -> Listed<C::State, L::Edge> {
        self.list(|_, tree, arcs, interrupt| shortest_paths(arcs, 0, tree.len() as u32, k, interrupt))
    }

    /// At most `k` paths that are far apart. The first is the cheapest path. Each further one is the cheapest
    /// path through a node that is far from all paths before it: farther than `apart`, in the metric of the
    /// space, from points on them half a step apart. The parts to and from that node are shortest paths.
    /// There is no detour at the node: within a cost of `apart` before and behind it no path is cheaper.
    /// Otherwise as [`alternatives`](Self::alternatives); costs a search of the graph for each node tried.
    ///
    /// # Errors
    /// When `apart` is negative or not a number.
    pub fn routes(&mut self, k: usize, apart: f64) -> Result<Listed<C::State, L::Edge>, BuildError> {
        if apart.is_nan() || apart < 0.0 {
            let range = "not negative, a distance".to_owned();
            return Err(BuildError::OutOfRange { name: "apart", value: apart, range });
        }
        let step = self.inner.parts().1.step();
        Ok(self.list(|space, tree, arcs, interrupt| {
            let mut found: Vec<(f64, Vec<u32>)> = Vec::new();
            let mut open: Vec<NodeId> = (0..tree.len() as NodeId).collect();
            while found.len() < k {
                let via = open.iter().copied();
                let Some(route) = shortest_via(arcs, [0, tree.len() as u32], apart, via, interrupt) else {
                    break;
                };
                let states: Vec<&C::State> =
                    route.1[..route.1.len() - 1].iter().map(|&id| tree.state(id)).collect();
                let between = states.windows(2).flat_map(|pair| {
                    let pieces = (2.0 * space.distance(pair[0], pair[1]) / step).ceil().clamp(1.0, 1e4);
                    (0..pieces as u32).map(move |i| (pair, f64::from(i) / pieces))
                });
                let mut on: Vec<C::State> =
                    between.map(|(pair, t)| space.interpolate(pair[0], pair[1], t)).collect();
                on.extend(states.last().map(|&end| end.clone()));
                open.retain(|&id| on.iter().all(|on| space.distance(on, tree.state(id)) > apart));
                found.push(route);
            }
            found
        }))
    }

    /// Lists the paths that `choose` finds between node 0 and the last, once all their edges are verified.
    fn list(
        &mut self,
        choose: impl Fn(&C, &Tree<C::State, L::Edge>, &[Vec<(u32, f64)>], &Interrupt) -> Vec<(f64, Vec<u32>)>,
    ) -> Listed<C::State, L::Edge> {
        let (tree, checker, cyclic) = self.inner.parts();
        let is_goal = |id: &NodeId| self.arrived.contains(tree.state(*id));
        let goals: Vec<NodeId> = (0..tree.len() as NodeId).filter(is_goal).collect();
        if goals.is_empty() {
            return Vec::new();
        }
        loop {
            let arcs = cyclic.arcs(tree, &goals);
            let mut found = choose(checker.space(), tree, &arcs, checker.interrupt());
            let mut changed = false;
            if checker.is_interrupted() {
                return Vec::new();
            }
            for (_, nodes) in &mut found {
                nodes.pop();
                for pair in nodes.windows(2) {
                    changed |= cyclic.ask(tree, checker, (pair[0], pair[1]));
                }
            }
            if changed {
                continue;
            }
            let edge = |pair: &[NodeId]| Some(cyclic.asked.get(&(pair[0], pair[1]))?.as_ref()?.0.clone());
            let path = |nodes: &[NodeId]| Path {
                states: nodes.iter().map(|&id| tree.state(id).clone()).collect(),
                edges: nodes.windows(2).filter_map(edge).collect(),
            };
            return found.iter().map(|(cost, nodes)| (path(nodes), *cost)).collect();
        }
    }
}

impl<C, L, N> Planner<C::State> for CyclicRrt<'_, C, L, N>
where
    C: Space,
    L: LocalPlanner<C::State>,
    N: NearestNeighbors<C>,
{
    type Edge = L::Edge;

    fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        let path = self.inner.step(rng, observer)?;
        let end = path.states.last().filter(|end| !self.arrived.contains(end));
        self.arrived.extend(end.cloned());
        Some(path)
    }

    fn progress(&self) -> Progress {
        self.inner.progress()
    }

    fn routes(&mut self, k: usize, apart: f64) -> Option<Vec<PathOf<C, L>>> {
        let routes = CyclicRrt::routes(self, k, apart).ok()?;
        Some(routes.into_iter().map(|(path, _)| path).collect())
    }
}
