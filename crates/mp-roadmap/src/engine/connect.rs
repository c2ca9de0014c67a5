//! How candidates become nodes, and which edges they get.

use super::prefetch::{Prefetched, Prefetching, QueryMeter};
use super::{Candidate, EdgeChecker, ParentMotion, Roadmap, Tag};
use mp_cspace::{
    BuildError, Direction, Event, Extension, Hit, LocalPlanner, Motion, NearestNeighbors, NodeId, Observer,
    Reach, Reversible, Space,
};

/// What a connector works with: the roadmap, the neighbours of a configuration, the local planner.
#[allow(missing_debug_implementations)] // observers have none
pub struct Growing<'a, 'c, C: Space, L: LocalPlanner<C::State>, N> {
    pub(crate) map: &'a mut Roadmap<C::State, L::Edge>,
    pub(crate) index: &'a mut N,
    pub(crate) checker: &'a mut EdgeChecker<'c, C, L>,
    pub(crate) observer: &'a mut dyn Observer<C::State>,
    /// Motions to the candidate that were prefetched.
    pub(crate) answers: Prefetched<C::State, L::Edge>,
    pub(crate) meter: Option<QueryMeter<'c>>,
    /// Whether motions are taken from the local planner without being counted or verified: those of a
    /// [piece](super::Piece).
    pub(crate) uncounted: bool,
}

impl<'c, C, L, N> Growing<'_, 'c, C, L, N>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    N: NearestNeighbors<C>,
{
    /// For a [piece](super::Piece) of a roadmap.
    pub(crate) fn of_piece<'a>(
        map: &'a mut Roadmap<C::State, L::Edge>,
        index: &'a mut N,
        checker: &'a mut EdgeChecker<'c, C, L>,
        observer: &'a mut dyn Observer<C::State>,
    ) -> Growing<'a, 'c, C, L, N> {
        Growing { map, index, checker, observer, answers: Vec::new(), meter: None, uncounted: true }
    }

    /// The space in which nodes are.
    #[must_use]
    pub fn space(&self) -> &'c C {
        self.checker.space()
    }

    /// The roadmap, to which nodes and edges are added.
    pub fn map(&mut self) -> &mut Roadmap<C::State, L::Edge> {
        self.map
    }

    /// Makes and verifies motions.
    pub fn checker(&mut self) -> &mut EdgeChecker<'c, C, L> {
        self.checker
    }

    /// Writes the `k` nodes nearest to `q` in order of distance, none farther than `radius`, to `out`.
    pub fn near(&self, q: &C::State, k: usize, radius: f64, out: &mut Vec<Hit>) {
        let (space, states) = (self.checker.space(), self.map.states());
        self.index.k_nearest(space, states, q, k, out);
        out.retain(|hit| hit.distance <= radius);
    }

    /// The motion from a node to `q`, if the local planner has one. Counts as an attempt of the node.
    pub fn reach(&mut self, from: NodeId, q: &C::State) -> Option<Motion<C::State, L::Edge>> {
        let motion = self.ask(from, q);
        if motion.is_none() {
            self.observer.on(Event::Blocked { from: self.map.state(from), toward: q });
        }
        self.map.tried(from, motion.is_none());
        motion
    }

    /// The motion from a node to the candidate, prefetched or made now.
    fn ask(&mut self, from: NodeId, q: &C::State) -> Option<Motion<C::State, L::Edge>> {
        match self.answers.iter_mut().find(|answer| answer.from == from) {
            Some(answer) => {
                let motion = answer.motion.take();
                if let Some(meter) = self.meter {
                    meter.used(std::mem::take(&mut answer.queries));
                }
                self.checker.replay(self.map.state(from), motion, q)
            }
            None if self.uncounted => {
                let local = self.checker.local();
                match local.extend(self.map.state(from), q, Direction::Forward, Reach::Full) {
                    Extension::Reached(motion) => Some(motion),
                    _ => None,
                }
            }
            None => self.checker.reach(self.map.state(from), q, Direction::Forward),
        }
    }

    /// Adds a candidate as a node, without edges but the one from its [parent](Candidate::parent).
    pub fn add(&mut self, candidate: Candidate<C::State, L::Edge>) -> NodeId {
        let tag = Tag { kind: candidate.kind, obstacle: candidate.obstacle, ..Tag::default() };
        let id = self.map.add(candidate.state, tag);
        self.index.inserted(self.checker.space(), self.map.states(), id);
        let kind = Some(candidate.kind.name());
        self.observer.on(Event::Rooted { tree: 0, id, state: self.map.state(id), kind });
        if let Some(ParentMotion { from: Some(from), motion }) = candidate.parent {
            self.link(from, id, motion);
        }
        id
    }

    /// Adds the edge of a motion from one node to another.
    pub fn link(&mut self, from: NodeId, to: NodeId, motion: Motion<C::State, L::Edge>) {
        self.map.link(from, to, motion.edge, motion.cost);
        self.observer.on(Event::Linked { from, to });
    }

    /// Adds an edge between two nodes that is not checked yet.
    pub fn guess(&mut self, from: NodeId, to: NodeId, length: f64) {
        self.map.guess(from, to, length);
        self.observer.on(Event::Linked { from, to });
    }

    /// Tries to connect each of `near`, in order, to a node, unless the two are in one component by then.
    /// With `cycles` also then, unless there is an edge already.
    pub(crate) fn link_near(&mut self, near: &[Hit], to: NodeId, cycles: bool) {
        for hit in near {
            if self.checker.is_interrupted() {
                return;
            }
            if !self.map.connected(hit.id, to) || (cycles && !self.map.has_link(hit.id, to)) {
                self.try_link(hit.id, to);
            }
        }
    }

    /// Tries to connect a node to another; counts as an attempt of both. Returns whether there is an edge
    /// now.
    pub fn try_link(&mut self, from: NodeId, to: NodeId) -> bool {
        let q = self.map.state(to).clone();
        let motion = self.ask(from, &q);
        let failed = motion.is_none();
        self.map.tried(from, failed);
        self.map.tried(to, failed);
        match motion {
            Some(motion) => self.link(from, to, motion),
            None => self.observer.on(Event::Blocked { from: self.map.state(from), toward: &q }),
        }
        !failed
    }
}

/// Slot: which candidates become nodes, and with which edges. It may refuse candidates.
pub trait Connector<C: Space, L: LocalPlanner<C::State>> {
    /// Adds a candidate by [`Growing::add`], or refuses it. Refuses none if not overridden.
    fn connect<N: NearestNeighbors<C>>(
        &mut self,
        candidate: Candidate<C::State, L::Edge>,
        growing: &mut Growing<'_, '_, C, L, N>,
    ) -> Option<NodeId> {
        Some(self.adopt(candidate, growing))
    }

    /// Adds a candidate that must not be refused: an end of the path.
    fn adopt<N: NearestNeighbors<C>>(
        &mut self,
        candidate: Candidate<C::State, L::Edge>,
        growing: &mut Growing<'_, '_, C, L, N>,
    ) -> NodeId;

    /// Prefetches the motions that connecting a candidate will probably need. Motions that are not prefetched
    /// are made later, so only the time depends on this.
    fn prefetch<N: NearestNeighbors<C>>(&self, _prefetching: &mut Prefetching<'_, '_, C, L, N>) {}

    /// Continues with a roadmap that this connector did not make, or not all of it.
    fn resumed(&mut self, _map: &Roadmap<C::State, L::Edge>) {}

    /// Whether further attempts cannot improve the roadmap.
    fn exhausted(&self) -> bool {
        false
    }
}

/// How many neighbours of a node are tried, and how far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reachable {
    /// At most this many; 1 or more.
    pub neighbours: usize,
    /// None farther than this, in the metric of the space; infinite for no limit.
    pub radius: f64,
    /// Also neighbours in the same component, which makes cycles: shorter paths, for more motions.
    pub cycles: bool,
}

impl Reachable {
    /// # Errors
    /// When there are no neighbours, or the radius is not positive.
    pub fn check(self) -> Result<Self, BuildError> {
        BuildError::count_within("neighbours", self.neighbours as u64, 1, 1_000_000)?;
        if self.radius.is_nan() || self.radius <= 0.0 {
            let range = "positive".to_owned();
            return Err(BuildError::OutOfRange { name: "radius", value: self.radius, range });
        }
        Ok(self)
    }
}

/// Every candidate becomes a node, and is connected to its nearest neighbours in order of distance.
#[derive(Clone, Debug)]
pub struct NearestConnector {
    pub(crate) within: Reachable,
    near: Vec<Hit>,
    /// Edges are not checked.
    lazy: bool,
}

impl NearestConnector {
    /// # Errors
    /// When there are no neighbours, or the radius is not positive.
    pub fn new(within: Reachable) -> Result<Self, BuildError> {
        Ok(Self { within: within.check()?, near: Vec::new(), lazy: false })
    }

    /// The same, but edges are only checked when a path leads along them, and cycles are kept.
    ///
    /// # Errors
    /// When there are no neighbours, or the radius is not positive.
    pub fn unchecked(within: Reachable) -> Result<Self, BuildError> {
        let within = Reachable { cycles: true, ..within }.check()?;
        Ok(Self { within, near: Vec::new(), lazy: true })
    }
}

impl<C, L> Connector<C, L> for NearestConnector
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
    fn prefetch<N: NearestNeighbors<C>>(&self, prefetching: &mut Prefetching<'_, '_, C, L, N>) {
        if !self.lazy {
            prefetching.reach_nearest(&self.within);
        }
    }

    fn adopt<N: NearestNeighbors<C>>(
        &mut self,
        candidate: Candidate<C::State, L::Edge>,
        growing: &mut Growing<'_, '_, C, L, N>,
    ) -> NodeId {
        let Reachable { neighbours, radius, cycles } = self.within;
        growing.near(&candidate.state, neighbours, radius, &mut self.near);
        let id = growing.add(candidate);
        if !self.lazy {
            growing.link_near(&self.near, id, cycles);
            return id;
        }
        for hit in &self.near {
            if growing.checker().is_interrupted() {
                break;
            }
            if !growing.map().has_link(hit.id, id) {
                growing.guess(hit.id, id, hit.distance);
            }
        }
        id
    }
}
