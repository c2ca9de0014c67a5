//! Two trees grown by all threads: the *embarrassingly parallel* Bi-RRT.
//!
//! S. Carpin and E. Pagello, *On parallel RRTs for multi-robot systems*, Proc. 8th Conf. of the Italian
//! Association for Artificial Intelligence, 2002; named in N. Jouandeau, Y. Touati and A. Ali Cherif,
//! *Incremental motion planning with Las Vegas algorithms*, 2008, §3, as the way to share the graph "with a
//! parallel q_new sampling". The trees are those of [Bi-RRT](super::rrt_connect); they grow in batches, as
//! the tree of [`shared_tree`](super::shared_tree) does, so that the result does not depend on the machine.
//!
//! From one tree that holds the start and one that holds the goal, repeat:
//! 1. draw `batch` samples, uniform in the space, number i of the planner from stream (seed, i);
//! 2. explore, in parallel: for each of them, find the node nearest to it in the tree whose turn it is, as it
//!    was before the batch, and move from there toward the sample, one step at most;
//! 3. add the ends of the motions found free, in the order of the samples, but none that is there already;
//! 4. join, in parallel: for each of these ends, find the node nearest to it in the other tree, and move from
//!    there toward it, one step at most; add what is free, in the same order;
//! 5. wherever the trees have met, in that order, verify the path: return it, or prune from the edge that
//!    failed;
//! 6. the other tree has the next turn.
//!
//! The seed is the first number drawn from the generator of the first step. One step is one batch.
//!
//! **When to use it.** Where Bi-RRT is the right planner, its motions are slow to check (a millisecond and
//! more) and there are several cores. Both halves of a batch are parallel. The nodes of a batch do not see
//! each other, so more motions are needed than by Bi-RRT: on average over 200 seeds of the scene `rrs-high`,
//! whose trees have 65 nodes, 10% more with batches of 4, 21% with 8 and 4.4 times as many with 64; of
//! `easy`, whose trees have 180, 8%, 7% and 72% more. Use batches of at least the number of threads, and
//! small ones for easy problems. Where the time of a run varies much, [independent runs](super::or_parallel)
//! gain more.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `batch`: samples per iteration, for any number of threads | 1, 2, … 1024 | 8 |
//!
//! and those of [Bi-RRT](super::rrt_connect). By name it is `shared-bi-rrt`;
//! [`build_from`](crate::build_from) makes it. Panics of the local planner lose samples as in
//! [`shared_tree`](super::shared_tree).
//!
//! Two threads give the same path as one:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Length, Rn, Rng, Straight};
//! use mp_tree::{Problem, SharedBiRrt, Tuning, Workers};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//! let problem = |_| Problem::new(&space, local.clone(), verifier.clone(), start, goal);
//! let solve = |threads| {
//!     let mut planner = SharedBiRrt::new(8, Workers::new(threads)?, Tuning::default(), problem)?;
//!     Ok::<_, mp_tree::BuildError>(planner.solve(&mut Rng::seed(1), &mut Iterations(1_000), &mut ()))
//! };
//! let outcome = solve(2)?;
//! assert!(matches!(outcome, Outcome::Solved(_)));
//! assert_eq!(outcome, solve(1)?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::engine::{Batch, TreePair};
use crate::{AppendDistinct, BuildError, Grown, NearestSelector, Problem, Purpose, Tree, Tuning, Workers};
use mp_cspace::{
    DefaultNn, Direction, Event, LocalPlanner, NearestNeighbors, NodeId, Observer, PathOf, Planner, Progress,
    Rng, Space,
};

/// Two trees grown by all threads: see the [module](self).
#[derive(Debug)]
pub struct SharedBiRrt<'c, C: Space, L: LocalPlanner<C::State>, N> {
    pair: TreePair<'c, C, L, NearestSelector<N>, AppendDistinct>,
    batch: Batch<C, L>,
    /// Where the trees have met, to be verified: a node of each.
    met: Vec<[NodeId; 2]>,
}

impl<'c, C: Space, L: LocalPlanner<C::State>, N: NearestNeighbors<C>> SharedBiRrt<'c, C, L, N> {
    /// Two trees grown by `batch` samples at a time, with the nearest neighbours that suit the space.
    /// `make(i)` makes the problem, always the same, once for each sample of a batch and once more; of
    /// all but the first only the local planner is used.
    ///
    /// # Errors
    /// When a parameter is out of range, there is no state to root the goal tree at, or `make` fails.
    pub fn new(
        batch: u64,
        workers: Workers,
        tuning: Tuning,
        make: impl FnMut(u64) -> Result<Problem<'c, C, L>, BuildError>,
    ) -> Result<Self, BuildError>
    where
        C: DefaultNn<Nn = N>,
        N: Default + Clone,
    {
        Self::with_index(batch, workers, N::default(), tuning, make)
    }

    /// As [`new`](Self::new), with an empty index of your choice.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_index(
        batch: u64,
        workers: Workers,
        index: N,
        tuning: Tuning,
        mut make: impl FnMut(u64) -> Result<Problem<'c, C, L>, BuildError>,
    ) -> Result<Self, BuildError>
    where
        N: Clone,
    {
        let parts = (NearestSelector(index), AppendDistinct::default());
        let pair = TreePair::new("shared-bi-rrt", make(0)?, &tuning, parts)?;
        Ok(Self { pair, batch: Batch::new(batch, workers, make)?, met: Vec::new() })
    }

    /// The trees from the start and from the goal; empty before the first step.
    #[must_use]
    pub fn trees(&self) -> [&Tree<C::State, L::Edge>; 2] {
        [self.pair.trees[0].nodes(), self.pair.trees[1].nodes()]
    }

    /// How many samples were lost to a panic of the local planner, without batches in which all were.
    #[must_use]
    pub fn panics(&self) -> u64 {
        self.batch.panics()
    }

    /// The first path through nodes where the trees have met that passes verification.
    fn arrive(&mut self, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        while !self.met.is_empty() {
            let meeting = self.met.remove(0);
            let path = self.pair.candidate(meeting, observer, &mut renaming(&mut self.met));
            if path.is_some() {
                return path;
            }
        }
        None
    }
}

/// Gives the nodes of pairs their new ids after a tree was pruned, and drops pairs of which a node is gone.
fn renaming(pairs: &mut Vec<[NodeId; 2]>) -> impl FnMut(Direction, &[NodeId]) {
    |direction, survivors| {
        let tree = usize::from(direction == Direction::Backward);
        pairs.retain_mut(|pair| match survivors.binary_search(&pair[tree]) {
            Ok(new) => {
                pair[tree] = new as NodeId;
                true
            }
            Err(_) => false,
        });
    }
}

impl<C, L, N> SharedBiRrt<'_, C, L, N>
where
    C: Space,
    L: LocalPlanner<C::State> + Send,
    N: NearestNeighbors<C> + Sync,
{
    /// Grows a tree toward the samples of the batch, or toward the nodes of the other tree that these gave.
    fn grow(
        &mut self,
        (tree, purpose): (usize, Purpose),
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Vec<Grown> {
        let size = self.batch.len();
        let (tree, checker) = (&mut self.pair.trees[tree], &mut self.pair.core.checker);
        self.batch.work((checker.space(), checker.step()), tree);
        let merge = |i| {
            if let (Purpose::Explore, Some(target)) = (purpose, self.batch.target(i)) {
                observer.on(Event::Sampled(target));
            }
            self.batch.merge(i, tree, checker, rng, observer)
        };
        (0..size).map(merge).collect()
    }
}

impl<C, L, N> Planner<C::State> for SharedBiRrt<'_, C, L, N>
where
    C: Space,
    L: LocalPlanner<C::State> + Send,
    N: NearestNeighbors<C> + Sync,
{
    type Edge = L::Edge;

    fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        self.batch.take_seed(rng);
        if let Some(path) = self.pair.begin(true, rng, observer, &mut renaming(&mut self.met)) {
            return Some(path);
        }
        if let Some(path) = self.arrive(observer) {
            return Some(path);
        }
        let turn = self.pair.next_turn();
        self.batch.draw(|_| None);
        let ends: Vec<Option<NodeId>> =
            self.grow((turn, Purpose::Explore), rng, observer).into_iter().map(Grown::node).collect();
        let nodes = self.pair.trees[turn].nodes();
        self.batch.aim(|i| ends[i].map(|id| nodes.state(id).clone()));
        let joined = self.grow((turn ^ 1, Purpose::Join), rng, observer);
        for (end, joined) in ends.into_iter().zip(joined) {
            let (Some(i), Grown::Reached(j)) = (end, joined) else { continue };
            let meeting = if turn == 0 { [i, j] } else { [j, i] };
            if !self.met.contains(&meeting) {
                self.met.push(meeting);
            }
        }
        self.arrive(observer)
    }

    /// An iteration is a batch.
    fn progress(&self) -> Progress {
        let mut progress = self.pair.progress();
        progress.motions += self.batch.motions();
        progress
    }
}
