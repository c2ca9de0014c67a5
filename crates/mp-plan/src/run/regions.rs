//! A roadmap by regions, in numbered items that may be done anywhere.

use crate::run::planners::PlannerKind;
use crate::run::prepared::Prepared;
use crate::run::scene_roadmap::of_map;
use crate::{Error, Request, Robot, SceneRoadmap};
use mp_cspace::{Configuration, Interrupt, NodeId, Rng};
use mp_kinds::counted::queries_of_thread;
use mp_roadmap::{AnyEdgeChecker, InRegions, PATIENCE, Piece, Roadmap, erased::AnyRegions};
use rand::RngExt;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// The planner whose roadmaps are made by regions.
pub(crate) const PLANNER: &str = "regional-prm";
/// The samples with which the cost of a region is estimated.
const SAMPLES: u32 = 64;
/// How many times as much a free sample costs as another: it is connected to others.
const NODE: f64 = 25.0;

/// The work on a roadmap by regions: an item for each region, then one for each pair of adjacent regions. Each item can be done anywhere, in
/// any order but that the two regions of a pair come first. The roadmap is the one that [`Scene::roadmap`](crate::Scene::roadmap) builds in
/// as many iterations as there are items, bit for bit.
///
/// [`Scene::regions`](crate::Scene::regions) makes it. The crate `mp-batch` does all of it, on the ranks of a cluster.
///
/// ```
/// use mp_plan::{Interrupt, Request, Scene};
/// let scene = Scene::find("easy")?;
/// let request = Request::new("regional-prm").set("regions", 4).set("samples", 200);
/// let (work, never) = (scene.regions(&request)?, Interrupt::never());
/// let built = (0..work.regions()).map(|region| work.build(region, &never)).collect::<Result<Vec<_>, _>>()?;
/// let connect = |item| {
///     let [one, other] = work.pair(item).unwrap_or_default();
///     work.connect(item, [&built[one as usize], &built[other as usize]], &never)
/// };
/// let connected = (work.regions()..work.items()).map(connect).collect::<Result<Vec<_>, _>>()?;
/// let mut roadmap = work.finish(&built, &connected)?;
/// assert!(roadmap.query(&scene.start(), &scene.goals()[0])?.solved);
/// # Ok::<(), mp_plan::Error>(())
/// ```
pub struct RegionalWork<'s> {
    work: RobotRegional<'s>,
    robot: &'s Arc<dyn Robot>,
    file: Option<String>,
    request: &'s Request,
}

impl fmt::Debug for RegionalWork<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (regions, items) = (self.regions(), self.items());
        f.debug_struct("RegionalWork")
            .field("regions", &regions)
            .field("items", &items)
            .finish_non_exhaustive()
    }
}

impl<'s> RegionalWork<'s> {
    pub(crate) fn new(
        robot: &'s Arc<dyn Robot>,
        file: Option<String>,
        request: &'s Request,
    ) -> Result<Self, Error> {
        Ok(Self { work: regional(&**robot, request)?, robot, file, request })
    }

    /// How many regions there are. Items below are regions.
    #[must_use]
    pub fn regions(&self) -> u64 {
        self.work.regions()
    }

    /// How many items there are: regions, and pairs of adjacent ones behind them.
    #[must_use]
    pub fn items(&self) -> u64 {
        self.work.items()
    }

    /// The regions that an item connects, the lower first; `None` for an item that is a region.
    #[must_use]
    pub fn pair(&self, item: u64) -> Option<[u64; 2]> {
        self.work.pair(item)
    }

    /// An estimate of the cost of a region, right in proportion: by the part of it that is free, of 64 samples. The same on every machine;
    /// no result depends on it.
    ///
    /// # Errors
    /// As [`build`](Self::build).
    pub fn estimate(&self, region: u64, interrupt: &Interrupt) -> Result<f64, Error> {
        Ok(1.0 + NODE * self.work.free_share(region, interrupt)?)
    }

    /// An estimate of the cost of connecting two regions, given their results: by the number of components, up to cycles. Right in proportion
    /// to those of other pairs.
    #[must_use]
    pub fn estimate_pair(built: [&[u8]; 2]) -> f64 {
        let components = |result| {
            let RegionalTally { nodes, edges, .. } = Self::tally(result);
            nodes.saturating_sub(edges).max(1) as f64
        };
        built.into_iter().map(components).sum()
    }

    /// Builds the roadmap of a region: its result.
    ///
    /// # Errors
    /// When it was interrupted, or start or goal of the scene are not free.
    pub fn build(&self, region: u64, interrupt: &Interrupt) -> Result<Vec<u8>, Error> {
        self.work.piece(region, &[], interrupt)
    }

    /// Connects the two regions of an item, given their results: its result.
    ///
    /// # Errors
    /// As [`build`](Self::build), and when the results are not those of regions.
    pub fn connect(&self, item: u64, built: [&[u8]; 2], interrupt: &Interrupt) -> Result<Vec<u8>, Error> {
        self.work.piece(item, &built, interrupt)
    }

    /// What an item took and made, by its result.
    #[must_use]
    pub fn tally(result: &[u8]) -> RegionalTally {
        let number = |i: usize| {
            let bytes = result.get(i * size_of::<u64>()..).and_then(<[u8]>::first_chunk);
            bytes.map_or(0, |number| u64::from_le_bytes(*number))
        };
        RegionalTally { queries: number(0), nodes: number(1), edges: number(2) }
    }

    /// The roadmap, of the results of all regions and of all pairs, in order.
    ///
    /// # Errors
    /// When there are more or fewer results than items, or they are not those of this work.
    pub fn finish(&self, built: &[Vec<u8>], connected: &[Vec<u8>]) -> Result<SceneRoadmap, Error> {
        let map = self.work.assemble(built, connected)?;
        let roadmap = of_map(Arc::clone(self.robot), self.request, map)?;
        Ok(SceneRoadmap { roadmap, file: self.file.clone() })
    }
}

/// What an item of a [`RegionalWork`] took and made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RegionalTally {
    /// Collision and clearance queries.
    pub queries: u64,
    /// Nodes of a region.
    pub nodes: u64,
    /// Edges within a region, or between two.
    pub edges: u64,
}

/// The length of a tally in a result, bytes.
const TALLY: usize = 3 * size_of::<u64>();

/// The work for a robot.
struct RobotRegional<'s> {
    prepared: Prepared<'s>,
    regions: AnyRegions,
    /// That of the builder of a roadmap with this request.
    seed: u64,
}

/// The work of a request.
fn regional<'s>(kind: &'s dyn Robot, request: &'s Request) -> Result<RobotRegional<'s>, Error> {
    request.check_single("a roadmap by regions")?;
    let planner = PlannerKind::new(&request.planner)?;
    if !matches!(&planner, PlannerKind::Roadmap(info) if info.name == PLANNER) {
        return Err(
            Error::new(format!("{planner} builds no roadmap by regions")).help(format!("take {PLANNER}"))
        );
    }
    let budget = &request.budget;
    if budget.iterations.is_some() || budget.nodes.is_some() || budget.queries.is_some() {
        let help = "leave out the budgets of iterations, nodes and queries; say how large the roadmap shall be by the \
                    parameters `regions` and `samples`";
        return Err(
            Error::new("a roadmap by regions is one round of all regions, with no other budget").help(help)
        );
    }
    let prepared = Prepared::new(kind, request)?;
    let regions = InRegions::read(&prepared.space, prepared.index.clone(), &request.settings())?;
    let seed = Rng::seed(request.seed).random();
    Ok(RobotRegional { prepared, regions, seed })
}

fn piece(result: &[u8], members: Vec<NodeId>) -> Result<Piece<Configuration, ()>, Error> {
    let bytes = result.get(TALLY..).unwrap_or_default();
    Piece::from_bytes(bytes, members).map_err(|e| {
        Error::new(format!("a result of an item is not what it should be: {e}"))
            .help("give all ranks the same program, scene and request, and begin anew")
    })
}

fn add_region(map: &mut Roadmap<Configuration>, result: &[u8]) -> Result<Range<NodeId>, Error> {
    let before = map.len() as NodeId;
    piece(result, Vec::new())?.insert(map, |_, _, _| true);
    Ok(before..map.len() as NodeId)
}

impl RobotRegional<'_> {
    fn checker(&self, interrupt: &Interrupt) -> Result<AnyEdgeChecker<'_, Configuration>, Error> {
        match (self.prepared.problem_until(interrupt.clone()), interrupt.raised()) {
            // Once it is interrupted, start and goal count as not free.
            (_, Some(_)) => Err(Error::new("told to end")),
            (problem, None) => Ok(AnyEdgeChecker::of(problem?, PATIENCE).0),
        }
    }

    fn regions(&self) -> u64 {
        u64::from(self.regions.subdivision().regions())
    }

    fn items(&self) -> u64 {
        self.regions.items()
    }

    fn pair(&self, item: u64) -> Option<[u64; 2]> {
        self.regions.pair(item).map(|pair| pair.map(u64::from))
    }

    fn free_share(&self, region: u64, interrupt: &Interrupt) -> Result<f64, Error> {
        // Other random numbers than those of the roadmap.
        let (mut checker, mut rng) = (self.checker(interrupt)?, Rng::stream(!self.seed, region));
        let sample =
            |rng: &mut Rng| self.regions.subdivision().sample(&self.prepared.space, region as u32, rng);
        let free = (0..SAMPLES).filter(|_| checker.admits(&sample(&mut rng))).count();
        if interrupt.raised().is_some() {
            return Err(Error::new("told to end"));
        }
        Ok(free as f64 / f64::from(SAMPLES))
    }

    fn piece(&self, item: u64, built: &[&[u8]], interrupt: &Interrupt) -> Result<Vec<u8>, Error> {
        let mut map = Roadmap::new();
        for result in built {
            add_region(&mut map, result)?;
        }
        let mut checker = self.checker(interrupt)?;
        let before = queries_of_thread();
        let piece = mp_roadmap::erased::piece(&self.regions, item, &map, &mut checker, self.seed);
        if interrupt.raised().is_some() {
            return Err(Error::new("told to end"));
        }
        let queries = queries_of_thread() - before;
        let tally = [queries, piece.nodes() as u64, piece.edges() as u64];
        let mut bytes: Vec<u8> = tally.iter().flat_map(|number| number.to_le_bytes()).collect();
        bytes.extend(piece.to_bytes());
        Ok(bytes)
    }

    fn assemble(&self, built: &[Vec<u8>], connected: &[Vec<u8>]) -> Result<Roadmap<Configuration>, Error> {
        let results = [built.len() as u64, (built.len() + connected.len()) as u64];
        let items = [self.regions(), self.items()];
        if results != items {
            return Err(Error::new(format!(
                "expected {} results of regions and {} of pairs, found {} and {}",
                items[0],
                items[1] - items[0],
                built.len(),
                connected.len()
            )));
        }
        let mut map = Roadmap::new();
        let nodes = built.iter().map(|result| add_region(&mut map, result)).collect::<Result<Vec<_>, _>>()?;
        for (result, item) in connected.iter().zip(items[0]..) {
            let pair = self.regions.pair(item).unwrap_or_default();
            let members = pair.iter().flat_map(|&region| nodes[region as usize].clone()).collect();
            piece(result, members)?.insert(&mut map, |_, _, _| true);
        }
        Ok(map)
    }
}
