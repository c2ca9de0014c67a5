//! A batch of samples toward which a tree grows: their motions are found by several threads, and joined to
//! the tree in order.

use super::{Extender, Growing, Grown, Inserter, NearestSelector, SearchTree, Selector};
use mp_cspace::{
    BuildError, Direction, EdgeChecker, Event, Extension, Interrupt, LocalPlanner, NearestNeighbors, NodeId,
    Observer, Problem, ProblemParts, Reach, Rng, Space, Workers, registry::Parameter,
};
use rand::RngExt;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

/// How many samples a batch has.
pub const BATCH: Parameter = Parameter {
    name: "batch",
    range: "a whole number from 1 to 1024",
    default: "8",
    doc: "samples per iteration, for any number of threads; their motions are checked in parallel",
};

/// One sample of a batch, and the extension toward it.
#[derive(Debug)]
struct BatchSample<S, L: LocalPlanner<S>> {
    local: L,
    interrupt: Interrupt,
    rng: Rng,
    /// Whether a tree is to grow toward it.
    wanted: bool,
    /// Drawn by the thread that works on it, where it was not chosen before.
    target: Option<S>,
    found: Option<(NodeId, Extension<S, L::Edge>)>,
    panicked: Option<Box<dyn Any + Send>>,
}

impl<S: Clone + PartialEq, L: LocalPlanner<S>> BatchSample<S, L> {
    fn work<C: Space<State = S>, N: NearestNeighbors<C>>(
        &mut self,
        (space, step): (&C, f64),
        (points, direction): (&[S], Direction),
        index: &N,
    ) {
        if !self.wanted || self.interrupt.ask() {
            return;
        }
        let target = self.target.get_or_insert_with(|| space.sample_uniform(&mut self.rng));
        let Some(hit) = index.nearest(space, points, target) else { return };
        let from = &points[hit.id as usize];
        let extension = match from == target {
            true => Extension::Trapped,
            false => self.local.extend(from, target, direction, Reach::Step(step)),
        };
        self.found = Some((hit.id, extension));
    }
}

/// Inserts an extension found before.
struct FoundExtension<S, E>(Option<Extension<S, E>>);

impl<C: Space, L: LocalPlanner<C::State>> Extender<C, L> for FoundExtension<C::State, L::Edge> {
    fn extend<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        from: NodeId,
        growing: &mut Growing<'_, '_, C, L, Se, A>,
    ) -> Grown {
        self.0.take().map_or(Grown::Trapped, |extension| growing.insert(from, extension))
    }
}

/// The samples of a batch, and the threads that work on them. Sample number i of the planner is drawn from
/// stream (seed, i); the seed is the first number of the generator that is given first.
#[derive(Debug)]
pub(crate) struct Batch<C: Space, L: LocalPlanner<C::State>> {
    samples: Vec<BatchSample<C::State, L>>,
    workers: Workers,
    seed: Option<u64>,
    drawn: u64,
    motions: u64,
    panics: u64,
}

impl<C: Space, L: LocalPlanner<C::State>> Batch<C, L> {
    /// A batch of `size` samples. `make(i)`, with i from 1, makes the problem of which a sample takes the
    /// local planner.
    ///
    /// # Errors
    /// When the size is out of range, or `make` fails.
    pub(crate) fn new<'c>(
        size: u64,
        workers: Workers,
        make: impl FnMut(u64) -> Result<Problem<'c, C, L>, BuildError>,
    ) -> Result<Self, BuildError>
    where
        C: 'c,
    {
        if !(1..=1024).contains(&size) {
            let range = BATCH.range.to_owned();
            return Err(BuildError::OutOfRange { name: BATCH.name, value: size as f64, range });
        }
        let sample = |problem: Result<Problem<'c, C, L>, BuildError>| {
            let ProblemParts { local, interrupt, .. } = problem?.into_parts();
            let rng = Rng::seed(0);
            Ok(BatchSample {
                local,
                interrupt,
                rng,
                wanted: false,
                target: None,
                found: None,
                panicked: None,
            })
        };
        let samples = (1..=size).map(make).map(sample).collect::<Result<_, BuildError>>()?;
        Ok(Self { samples, workers, seed: None, drawn: 0, motions: 0, panics: 0 })
    }

    /// How many samples there are.
    pub(crate) fn len(&self) -> usize {
        self.samples.len()
    }

    /// How many motions were asked of the local planners.
    pub(crate) fn motions(&self) -> u64 {
        self.motions
    }

    /// How many samples were lost to a panic of the local planner, without batches in which all were.
    pub(crate) fn panics(&self) -> u64 {
        self.panics
    }

    /// Takes the seed, if there is none yet.
    pub(crate) fn take_seed(&mut self, rng: &mut Rng) {
        self.seed.get_or_insert_with(|| rng.random());
    }

    /// Draws new samples: with their streams `choose` may choose a target; the others are uniform.
    pub(crate) fn draw(&mut self, mut choose: impl FnMut(&mut Rng) -> Option<C::State>) {
        let seed = self.seed.unwrap_or_default();
        for sample in &mut self.samples {
            sample.rng = Rng::stream(seed, self.drawn);
            self.drawn += 1;
            (sample.wanted, sample.found) = (true, None);
            sample.target = choose(&mut sample.rng);
        }
    }

    /// Gives the samples other targets; those without are left out.
    pub(crate) fn aim(&mut self, mut target: impl FnMut(usize) -> Option<C::State>) {
        for (i, sample) in self.samples.iter_mut().enumerate() {
            (sample.target, sample.found) = (target(i), None);
            sample.wanted = sample.target.is_some();
        }
    }

    /// The target of a sample, if it was drawn.
    pub(crate) fn target(&self, i: usize) -> Option<&C::State> {
        self.samples[i].target.as_ref()
    }

    /// Finds, in parallel, a motion toward each sample from the node nearest to it, one step long at most.
    ///
    /// # Panics
    /// When the local planners of all samples panic.
    pub(crate) fn work<A: Inserter<C, L>, N: NearestNeighbors<C> + Sync>(
        &mut self,
        (space, step): (&C, f64),
        tree: &SearchTree<C, L, NearestSelector<N>, A>,
    ) where
        L: Send,
    {
        let nodes = (tree.nodes().states(), tree.nodes().direction());
        let index = &tree.selector().0;
        self.workers.each(&mut self.samples, |sample| {
            let work = AssertUnwindSafe(|| sample.work((space, step), nodes, index));
            sample.panicked = catch_unwind(work).err();
        });
        let count =
            |which: fn(&BatchSample<C::State, L>) -> bool| self.samples.iter().filter(|s| which(s)).count();
        let panicked = count(|sample| sample.panicked.is_some());
        if panicked < count(|sample| sample.wanted) {
            self.panics += panicked as u64;
        } else if let Some(panic) = self.samples.iter_mut().find_map(|sample| sample.panicked.take()) {
            resume_unwind(panic);
        }
    }

    /// Joins the motion that was found toward a sample to the tree.
    pub(crate) fn merge<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        i: usize,
        tree: &mut SearchTree<C, L, Se, A>,
        checker: &mut EdgeChecker<'_, C, L>,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Grown {
        let sample = &mut self.samples[i];
        let Some(target) = &sample.target else { return Grown::Trapped };
        let Some((from, extension)) = sample.found.take() else {
            observer.on(Event::Trapped { tree: tree.index() });
            return Grown::Trapped;
        };
        self.motions += u64::from(tree.nodes().state(from) != target);
        tree.grow_from(from, target, checker, &mut FoundExtension(Some(extension)), rng, observer)
    }
}
