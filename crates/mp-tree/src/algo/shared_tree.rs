//! One RRT grown by all threads: the *embarrassingly parallel* RRT.
//!
//! S. Carpin and E. Pagello, *On parallel RRTs for multi-robot systems*, Proc. 8th Conf. of the Italian
//! Association for Artificial Intelligence, 2002; described in N. Jouandeau, Y. Touati and A. Ali Cherif,
//! *Incremental motion planning with Las Vegas algorithms*, 2008, §3: processors share the tree and sample in
//! parallel. There each adds its node at once; here nodes are added in batches, so that the result does not
//! depend on the machine.
//!
//! From a tree that holds the start, repeat:
//! 1. draw `batch` samples, number i of the planner from stream (seed, i): uniform in the space, or with
//!    a small probability a goal state;
//! 2. in parallel, for each of them: find the node nearest to it, in the tree as it was before the
//!    batch, and move from there toward the sample, one step at most;
//! 3. add the ends of the motions found free, in the order of the samples, but none that is there
//!    already;
//! 4. where one is in the goal, verify the path: return it, or prune from the edge that failed.
//!
//! The seed is the first number drawn from the generator of the first step. One step is one batch.
//!
//! **When to use it.** Where [RRT](super::rrt) is the right planner, its motions are slow to check (a
//! millisecond and more) and there are several cores. The samples of a batch do not see each other's nodes,
//! so more motions are needed, especially while the tree is small. In the example `shared_tree`, whose tree
//! has some 200 nodes, batches of 4 need 14% more motions, batches of 8 18%, of 16 60%, and batches of 64
//! need 3.3 times as many (means of 200 seeds). Use batches of at least the number of threads, and small ones
//! for easy problems. Where the time of a run varies much, [independent runs](super::or_parallel) gain more.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `batch`: samples per iteration, for any number of threads | 1, 2, … 1024 | 8 |
//!
//! and those of [RRT](super::rrt). By name it is `shared-rrt`; [`build_from`](crate::build_from) makes it.
//!
//! Each sample of a batch has its own local planner, so there are `batch` of them, and one more for the
//! straight motion to the goal. If one panics, its sample is lost and [counted](SharedTree::panics); if all
//! of a batch panic, the step panics in the calling thread, with the message of the first. The tree stays
//! valid. Only the calling thread verifies, so nothing is gained with a slow verifier and a local planner
//! that is no longer trusted (`patience`).
//!
//! Two threads give the same path as one:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Length, Rn, Rng, Straight};
//! use mp_tree::{Goals, Problem, SharedTree, Tuning, Workers};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let problem = |_| {
//!     let far_side = Goals::region(|q: &Vector2<f64>| q.x > 0.95);
//!     Problem::new(&space, local.clone(), verifier.clone(), Vector2::new(0.1, 0.5), far_side)
//! };
//! let solve = |threads| {
//!     let mut planner = SharedTree::new(8, Workers::new(threads)?, Tuning::default(), problem)?;
//!     Ok::<_, mp_tree::BuildError>(planner.solve(&mut Rng::seed(1), &mut Iterations(1_000), &mut ()))
//! };
//! let outcome = solve(2)?;
//! assert!(matches!(outcome, Outcome::Solved(_)));
//! assert_eq!(outcome, solve(1)?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use crate::engine::BATCH;
use crate::engine::Batch;
use crate::{
    AppendDistinct, BuildError, Core, Grown, NearestSelector, Problem, SearchTree, Tree, Tuning, Workers,
};
use mp_cspace::{
    DefaultNn, Direction, Event, LocalPlanner, NearestNeighbors, NodeId, Observer, PathOf, Planner, Progress,
    Rng, Space,
};

/// One RRT grown by all threads: see the [module](self).
#[derive(Debug)]
pub struct SharedTree<'c, C: Space, L: LocalPlanner<C::State>, N> {
    core: Core<'c, C, L>,
    tree: SearchTree<C, L, NearestSelector<N>, AppendDistinct>,
    batch: Batch<C, L>,
    /// The samples of the batch that are goals.
    aimed: Vec<bool>,
    /// Nodes in the goal, to be verified.
    arrived: Vec<NodeId>,
}

impl<'c, C: Space, L: LocalPlanner<C::State>, N: NearestNeighbors<C>> SharedTree<'c, C, L, N> {
    /// A tree grown by `batch` samples at a time, with the nearest neighbours that suit the space.
    /// `make(i)` makes the problem, always the same, once for each sample of a batch and once more; of
    /// all but the first only the local planner is used.
    ///
    /// # Errors
    /// When a parameter is out of range, or `make` fails.
    pub fn new(
        batch: u64,
        workers: Workers,
        tuning: Tuning,
        make: impl FnMut(u64) -> Result<Problem<'c, C, L>, BuildError>,
    ) -> Result<Self, BuildError>
    where
        C: DefaultNn<Nn = N>,
        N: Default,
    {
        Self::with_index(batch, workers, N::default(), tuning, make)
    }

    /// As [`new`](Self::new), with an empty index of your choice.
    ///
    /// # Errors
    /// When a parameter is out of range, or `make` fails.
    pub fn with_index(
        batch: u64,
        workers: Workers,
        index: N,
        tuning: Tuning,
        mut make: impl FnMut(u64) -> Result<Problem<'c, C, L>, BuildError>,
    ) -> Result<Self, BuildError> {
        let core = Core::new(make(0)?, &tuning)?;
        Ok(Self {
            core,
            tree: SearchTree::new(0, Direction::Forward, NearestSelector(index), AppendDistinct::default()),
            batch: Batch::new(batch, workers, make)?,
            aimed: Vec::new(),
            arrived: Vec::new(),
        })
    }

    /// The tree; empty before the first step.
    #[must_use]
    pub fn tree(&self) -> &Tree<C::State, L::Edge> {
        self.tree.nodes()
    }

    /// How many samples were lost to a panic of the local planner, without batches in which all were.
    #[must_use]
    pub fn panics(&self) -> u64 {
        self.batch.panics()
    }

    /// Adds the root and tries the straight motions to the goals.
    fn begin(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) {
        self.arrived.extend(self.core.add_start(&mut self.tree, observer));
        while let Some(grown) = self.core.connect_directly(&mut self.tree, rng, observer) {
            if let Grown::Reached(id) = grown {
                return self.arrived.push(id);
            }
        }
    }

    fn draw(&mut self) {
        let Self { core, batch, aimed, .. } = self;
        aimed.clear();
        batch.draw(|rng| {
            let goal = core.aim(rng);
            aimed.push(goal.is_some());
            goal
        });
    }

    fn merge(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) {
        for i in 0..self.batch.len() {
            let Some(target) = self.batch.target(i) else { continue };
            observer.on(Event::Sampled(target));
            let new = self.tree.nodes().len();
            let grown = self.batch.merge(i, &mut self.tree, &mut self.core.checker, rng, observer);
            let entered = match grown {
                Grown::Reached(id) if self.aimed[i] => Some(id),
                _ => {
                    let state = self.tree.nodes().states().get(new);
                    state.is_some_and(|state| self.core.goals.reached(state)).then_some(new as NodeId)
                }
            };
            // Several samples of a batch may be the same goal.
            self.arrived.extend(entered.filter(|id| !self.arrived.contains(id)));
        }
    }

    /// The first path to a node in the goal that passes verification. Nodes that are pruned meanwhile are
    /// dropped.
    fn arrive(&mut self, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        while !self.arrived.is_empty() {
            let id = self.arrived.remove(0);
            let rest = &mut self.arrived;
            let path = self.core.path(&mut self.tree, id, observer, |survivors| {
                let renamed = rest.iter().filter_map(|old| survivors.binary_search(old).ok());
                *rest = renamed.map(|new| new as NodeId).collect();
            });
            if path.is_some() {
                return path;
            }
        }
        None
    }
}

impl<C, L, N> Planner<C::State> for SharedTree<'_, C, L, N>
where
    C: Space,
    L: LocalPlanner<C::State> + Send,
    N: NearestNeighbors<C> + Sync,
{
    type Edge = L::Edge;

    fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        self.core.iterations += 1;
        self.batch.take_seed(rng);
        self.begin(rng, observer);
        if let Some(path) = self.arrive(observer) {
            return Some(path);
        }
        self.draw();
        let (space, step) = (self.core.checker.space(), self.core.checker.step());
        self.batch.work((space, step), &self.tree);
        self.merge(rng, observer);
        self.arrive(observer)
    }

    /// An iteration is a batch.
    fn progress(&self) -> Progress {
        let mut progress = self.core.progress(self.tree.nodes().len());
        progress.motions += self.batch.motions();
        progress
    }
}
