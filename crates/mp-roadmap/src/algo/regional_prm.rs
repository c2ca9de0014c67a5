//! Regional PRM: roadmaps of regions, built independently and connected at their borders.
//!
//! S. A. Jacobs, K. Manavi, J. Burgos, J. Denny, S. Thomas and N. M. Amato, *A scalable method for
//! parallelizing sampling-based motion planning algorithms*, ICRA 2012.
//!
//! Once:
//! 1. cut the space into `regions`, a grid of boxes of equal measure. Only numbers that run straight from a
//!    lower to an upper bound are cut: positions, joints with limits. Rotations, and joints that turn without
//!    end, are whole in each region;
//! 2. regions that share a face are adjacent.
//!
//! A round, in iterations that are independent of each other within each of the two steps:
//! 1. for each region: make `samples` attempts of [PRM](super::prm) without expansion. Draw a sample, uniform
//!    in the region and somewhat beyond its faces (`overlap`); if it is free, it becomes a node, and is
//!    connected to the nearest nodes of this region;
//! 2. for each pair of adjacent regions: pair each node of one with its nearest nodes of the other. In order
//!    of distance, ask the local planner for a motion between the two of each pair, unless they are in the
//!    same component of these two regions by now, at most `connections` times. From the second round on at
//!    least one of the two is new.
//!
//! Rounds follow each other until there is a path. The path found is verified; an edge that fails is blocked.
//! Start and goal are nodes of their regions. Nodes of a roadmap that is gone on with belong to the regions
//! where they are.
//!
//! The region with number r draws from stream (seed, r) in the first round. So the work may be done in any
//! order, by threads, or by the ranks of a cluster with [`InRegions::piece_of`]: the roadmap is the same to
//! the bit.
//!
//! Three things differ from the paper:
//! - Each region makes as many attempts, so that the roadmap is as dense everywhere as one of uniform
//!   samples. How many nodes come of them, and so how long they take, differs: A. Fidel, S. A. Jacobs, S.
//!   Sharma, N. M. Amato and L. Rauchwerger (*Using load balancing to scalably parallelize sampling-based
//!   motion planning algorithms*, IPDPS 2014) estimate it by the free volume of the region and move regions
//!   between processors. Here regions are handed out one by one, the dearest first by that estimate
//!   ([`Subdivision::sample`]).
//! - The paper connects the nearest nodes, or the largest components, of adjacent regions. Here the nearest
//!   pairs of different components are connected, large or small.
//! - The paper has one round.
//!
//! **When to use it.** For roadmaps too large for one machine, on the ranks of a cluster. On one machine, for
//! single paths, [PRM](super::prm) does as well.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `regions`: into how many regions the space is cut; numbers with small factors give compact ones | 1, 2, … 10⁶ | 16 |
//! | `samples`: attempts in each region and round | 1, 2, … 10⁹ | 32 |
//! | `overlap`: how far beyond its faces a region is sampled, as a part of its width | \[0, 1\] | 0.1 |
//! | `connections`: most motions tried in a round between two adjacent regions | 1, 2, … 10⁶ | 100 |
//! | `neighbours`: most neighbours tried per node, within the region and in each adjacent one | 1, 2, … 10⁶ | 15 |
//! | `radius`: longest distance of neighbours, in the metric of the space or with % of its extent | positive | 100% |
//! | `cycles`: also connects nodes of one component: shorter paths, for more motions | yes, no | no |
//!
//! A point goes around a disc in the unit square:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Problem, Length, Rn, Rng, Straight};
//! use mp_roadmap::{Reachable, RegionalPrm, Regions};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//!
//! let problem = Problem::new(&space, local, verifier, start, goal)?;
//! let reach = Reachable { neighbours: 10, radius: 0.5, cycles: false };
//! let mut planner = RegionalPrm::new(problem, Regions { regions: 4, ..Regions::default() }, reach)?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(1_000), &mut ());
//! let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//! assert_eq!((path.states.first(), path.states.last()), (Some(&start), Some(&goal)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod subdivision;

pub use subdivision::Subdivision;

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::settings::{CYCLES, NEIGHBOURS, RADIUS, UNDIRECTED, reachable};
use crate::engine::{Moment, Part};
use crate::{
    AStar, Candidate, Connector, EdgeChecker, Growing, MilestoneKind, NearestConnector, NodeGenerator, Piece,
    Reachable, Roadmap, RoadmapPlanner, RoadmapPlannerParts,
};
use mp_cspace::{
    BuildError, DefaultNn, LocalPlanner, NearestNeighbors, NodeId, Problem, Reversible, Rng, Space,
    registry::{Parameter, PlannerInfo, Settings},
};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The parameters of regional PRM.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regions {
    /// Into how many regions the space is cut; 1 or more.
    pub regions: usize,
    /// Attempts in each region and round; 1 or more.
    pub samples: usize,
    /// How far beyond its faces a region is sampled, as a part of its width; in \[0, 1\].
    pub overlap: f64,
    /// Most motions tried in a round between two adjacent regions; 1 or more.
    pub connections: usize,
}

impl Default for Regions {
    fn default() -> Self {
        Self { regions: 16, samples: 32, overlap: 0.1, connections: 100 }
    }
}

impl Regions {
    /// The values that are set, the others by default.
    ///
    /// # Errors
    /// When a value cannot be read.
    pub fn read(settings: &Settings) -> Result<Self, BuildError> {
        let count = |parameter| Ok::<_, BuildError>(settings.count_of(parameter)? as usize);
        Ok(Self {
            regions: count(&REGIONS)?,
            samples: count(&SAMPLES)?,
            overlap: settings.number(OVERLAP.name)?.unwrap_or(Self::default().overlap),
            connections: count(&CONNECTIONS)?,
        })
    }

    fn check(self) -> Result<Self, BuildError> {
        BuildError::count_within(REGIONS.name, self.regions as u64, 1, 1_000_000)?;
        BuildError::count_within(SAMPLES.name, self.samples as u64, 1, 1_000_000_000)?;
        BuildError::count_within(CONNECTIONS.name, self.connections as u64, 1, 1_000_000)?;
        if !(0.0..=1.0).contains(&self.overlap) {
            let range = OVERLAP.range.to_owned();
            return Err(BuildError::OutOfRange { name: OVERLAP.name, value: self.overlap, range });
        }
        Ok(self)
    }
}

const REGIONS: Parameter = Parameter {
    name: "regions",
    range: "a whole number, 1 to 10⁶",
    default: "16",
    doc: "into how many regions the space is cut; numbers with small factors give compact ones",
};
const SAMPLES: Parameter = Parameter {
    name: "samples",
    range: "a whole number, 1 to 10⁹",
    default: "32",
    doc: "attempts in each region and round",
};
const OVERLAP: Parameter = Parameter {
    name: "overlap",
    range: "in [0, 1]",
    default: "0.1",
    doc: "how far beyond its faces a region is sampled, as a part of its width",
};
const CONNECTIONS: Parameter = Parameter {
    name: "connections",
    range: "a whole number, 1 to 10⁶",
    default: "100",
    doc: "most motions tried in a round between two adjacent regions",
};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "regional-prm",
    summary: "roadmaps of regions, connected at their borders; for roadmaps too large for one machine",
    citation: "Jacobs, Manavi, Burgos, Denny, Thomas and Amato 2012",
    parameters: &[REGIONS, SAMPLES, OVERLAP, CONNECTIONS, NEIGHBOURS, RADIUS, CYCLES],
    aliases: &[],
    cannot: UNDIRECTED,
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let generator = InRegions::read(args.space, args.index(), args.settings)?;
    let connector = generator.connector.clone();
    args.build(RoadmapPlannerParts::new(generator, connector))
}

/// Roadmaps of regions, and the edges between them, as [pieces](Piece). An item of a round is a region, or
/// behind all regions a pair of adjacent ones.
#[derive(Clone, Debug)]
pub struct InRegions<S, N> {
    subdivision: Arc<Subdivision<S>>,
    /// An empty index.
    index: N,
    connector: NearestConnector,
    samples: usize,
    connections: usize,
    /// The number of the next attempt.
    next: u64,
    /// How many nodes there were when the round began.
    old: NodeId,
    /// The roadmap when regions began to grow, or to be connected. What came later, such as edges that a
    /// query has blocked, would make pieces depend on each other.
    moment: Moment,
    /// The nodes of each region that has any, in order, and how many there are in all, at that moment.
    members: Arc<BTreeMap<u32, Vec<NodeId>>>,
    seen: NodeId,
}

impl<S: Clone, N: Clone> InRegions<S, N> {
    /// Regions of a space. `index` is empty.
    ///
    /// # Errors
    /// When a parameter is out of range.
    pub fn new<C: Space<State = S>>(
        space: &C,
        index: N,
        regions: Regions,
        reach: Reachable,
    ) -> Result<Self, BuildError> {
        let Regions { regions, samples, overlap, connections } = regions.check()?;
        Ok(Self {
            subdivision: Arc::new(Subdivision::new(space, regions, overlap)?),
            index,
            connector: NearestConnector::new(reach)?,
            samples,
            connections,
            next: 0,
            old: 0,
            moment: Moment::default(),
            members: Arc::default(),
            seen: 0,
        })
    }

    /// As the settings of the planner say.
    ///
    /// # Errors
    /// When a value cannot be read or is out of range.
    pub fn read<C: Space<State = S>>(space: &C, index: N, settings: &Settings) -> Result<Self, BuildError> {
        Self::new(space, index, Regions::read(settings)?, reachable(space, settings)?)
    }

    /// How the space is cut.
    #[must_use]
    pub fn subdivision(&self) -> &Subdivision<S> {
        &self.subdivision
    }

    /// How many items a round has: regions, and pairs of them.
    #[must_use]
    pub fn items(&self) -> u64 {
        u64::from(self.subdivision.regions()) + self.subdivision.pairs().len() as u64
    }

    /// The pair of regions that an item of a round connects; `None` for a region.
    #[must_use]
    pub fn pair(&self, item: u64) -> Option<[u32; 2]> {
        let pair = item.checked_sub(u64::from(self.subdivision.regions()))?;
        self.subdivision.pairs().get(pair as usize).copied()
    }

    /// What item number `item` of the first round adds to the roadmap. The roadmap of a region is made from
    /// an empty `map`, and edges between two regions from a `map` that has just those two pieces, the lower
    /// region first. In a [`Builder`](crate::Builder) the seed is the first number drawn.
    pub fn piece_of<C, L>(
        &self,
        item: u64,
        map: &Roadmap<S, L::Edge>,
        checker: &mut EdgeChecker<'_, C, L>,
        seed: u64,
    ) -> Piece<S, L::Edge>
    where
        C: Space<State = S>,
        L: LocalPlanner<S, Edge: Reversible>,
        N: NearestNeighbors<C>,
    {
        let mut first = self.clone();
        (first.old, first.seen, first.members) = (0, 0, Arc::default());
        first.look(map, checker.space());
        first.made(item, map, checker, &mut Rng::stream(seed, item))
    }

    /// Notes the moment, and the regions of nodes that are new.
    fn look<C: Space<State = S>, E>(&mut self, map: &Roadmap<S, E>, space: &C) {
        self.moment = Moment::of(map);
        let members = Arc::make_mut(&mut self.members);
        for id in self.seen..map.len() as NodeId {
            let q = map.state(id);
            let known = map.tag(id).obstacle.filter(|&region| self.subdivision.holds(space, region, q));
            let region = known.unwrap_or_else(|| self.subdivision.region_of(space, q));
            members.entry(region).or_default().push(id);
        }
        self.seen = map.len() as NodeId;
    }

    fn members(&self, region: u32) -> &[NodeId] {
        self.members.get(&region).map_or(&[], Vec::as_slice)
    }

    fn made<C, L>(
        &self,
        item: u64,
        map: &Roadmap<S, L::Edge>,
        checker: &mut EdgeChecker<'_, C, L>,
        rng: &mut Rng,
    ) -> Piece<S, L::Edge>
    where
        C: Space<State = S>,
        L: LocalPlanner<S, Edge: Reversible>,
        N: NearestNeighbors<C>,
    {
        match self.pair(item) {
            None => self.grown(item as u32, map, checker, rng),
            Some(pair) => self.joined(pair, map, checker),
        }
    }

    /// More nodes of a region, with their edges.
    fn grown<C, L>(
        &self,
        region: u32,
        map: &Roadmap<S, L::Edge>,
        checker: &mut EdgeChecker<'_, C, L>,
        rng: &mut Rng,
    ) -> Piece<S, L::Edge>
    where
        C: Space<State = S>,
        L: LocalPlanner<S, Edge: Reversible>,
        N: NearestNeighbors<C>,
    {
        let (space, mut index) = (checker.space(), self.index.clone());
        let mut part = Part::of(map, self.members(region).to_vec(), self.moment);
        (0..part.map.len() as NodeId).for_each(|id| index.inserted(space, part.map.states(), id));
        let (mut connector, mut unseen) = (self.connector.clone(), ());
        let mut growing = Growing::of_piece(&mut part.map, &mut index, checker, &mut unseen);
        for _ in 0..self.samples {
            if growing.checker().is_interrupted() {
                break;
            }
            let q = self.subdivision.sample(space, region, rng);
            if growing.checker().admits(&q) {
                let candidate = Candidate::new(q, MilestoneKind::Plain).of(region);
                connector.connect(candidate, &mut growing);
            }
        }
        part.piece()
    }

    /// Edges between two regions.
    fn joined<C, L>(
        &self,
        [one, other]: [u32; 2],
        map: &Roadmap<S, L::Edge>,
        checker: &mut EdgeChecker<'_, C, L>,
    ) -> Piece<S, L::Edge>
    where
        C: Space<State = S>,
        L: LocalPlanner<S, Edge: Reversible>,
        N: NearestNeighbors<C>,
    {
        let (space, mut index) = (checker.space(), self.index.clone());
        let border = self.members(one).len() as NodeId;
        let members = [self.members(one), self.members(other)].concat();
        let old: Vec<bool> = members.iter().map(|&id| id < self.old).collect();
        let mut part = Part::of(map, members, self.moment);
        (border..part.map.len() as NodeId).for_each(|id| index.inserted(space, part.map.states(), id));
        let Reachable { neighbours, radius, cycles } = self.connector.within;
        let mut unseen = ();
        let mut growing = Growing::of_piece(&mut part.map, &mut index, checker, &mut unseen);
        let (mut near, mut close) = (Vec::new(), Vec::new());
        for id in 0..border {
            if growing.checker().is_interrupted() {
                break;
            }
            let q = growing.map().state(id).clone();
            growing.near(&q, neighbours, radius, &mut near);
            let new = near.iter().filter(|hit| !(old[id as usize] && old[hit.id as usize]));
            close.extend(new.map(|hit| (hit.distance, id, hit.id)));
        }
        close.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut left = self.connections;
        for (_, from, to) in close {
            if left == 0 || growing.checker().is_interrupted() {
                break;
            }
            if cycles || !growing.map().connected(from, to) {
                left -= 1;
                growing.try_link(from, to);
            }
        }
        part.piece()
    }
}

impl<C, L, N> NodeGenerator<C, L> for InRegions<C::State, N>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    N: NearestNeighbors<C> + Clone,
{
    fn begin(&mut self, attempt: u64, map: &Roadmap<C::State, L::Edge>, space: &C) {
        self.next = attempt;
        let item = attempt % self.items();
        if item == 0 {
            self.old = map.len() as NodeId;
        }
        if item == 0 || item == u64::from(self.subdivision.regions()) {
            self.look(map, space);
        }
    }

    /// All that an attempt adds: there are no candidates.
    fn piece(
        &mut self,
        attempt: u64,
        map: &Roadmap<C::State, L::Edge>,
        checker: &mut EdgeChecker<'_, C, L>,
        rng: &mut Rng,
    ) -> Option<Piece<C::State, L::Edge>> {
        Some(self.made(attempt % self.items(), map, checker, rng))
    }

    /// Until all regions have grown, or all of their pairs are connected.
    fn independent(&self, _: &Roadmap<C::State, L::Edge>) -> u64 {
        let (item, regions) = (self.next % self.items(), u64::from(self.subdivision.regions()));
        if item < regions { regions - item } else { self.items() - item }
    }
}

/// Regional PRM: see the [module](self).
pub type RegionalPrm<'c, C, L, N> =
    RoadmapPlanner<'c, C, L, InRegions<<C as Space>::State, N>, NearestConnector, AStar, N>;

impl<'c, C, L, N> RegionalPrm<'c, C, L, N>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    N: NearestNeighbors<C> + Clone,
{
    /// Regional PRM with the nearest neighbours that suit the space.
    ///
    /// # Errors
    /// When a parameter is out of range.
    pub fn new(problem: Problem<'c, C, L>, regions: Regions, reach: Reachable) -> Result<Self, BuildError>
    where
        C: DefaultNn<Nn = N>,
        N: Default,
    {
        Self::with_index(problem, N::default(), regions, reach)
    }

    /// Regional PRM with an empty index of your choice.
    ///
    /// # Errors
    /// When a parameter is out of range.
    pub fn with_index(
        problem: Problem<'c, C, L>,
        index: N,
        regions: Regions,
        reach: Reachable,
    ) -> Result<Self, BuildError> {
        let generator = InRegions::new(problem.space(), index.clone(), regions, reach)?;
        let connector = generator.connector.clone();
        Ok(Self::assemble(problem, index, RoadmapPlannerParts::new(generator, connector)))
    }
}
