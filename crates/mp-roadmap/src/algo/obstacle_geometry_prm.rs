//! PRM by the geometry of obstacles: *far* configurations by spheres alone, *near* ones by an elastic band.
//!
//! A. Benitez and D. Vallejo, *New technique to improve probabilistic roadmap methods*, IBERAMIA 2004; A.
//! Benitez, D. Vallejo and M. A. Medina, *PRMs based on obstacle's geometry*, IAS-8, 2004. As in §3.5 of A.
//! Benitez et al., *Key elements for motion planning algorithms*, 2010.
//!
//! First approximation, for `far` attempts:
//! 1. draw a sample, uniform in the space;
//! 2. where the bounding sphere of the robot touches that of no obstacle, take the sample as a *far*
//!    configuration. Nothing else is tested: the robot is free there in every rotation.
//!
//! Expansion, by two kinds of attempts in turn:
//! - around one obstacle B after the other, from a uniform sample q: an elastic band, for *near*
//!   configurations;
//! - a uniform sample: taken where it is free; *salvaged* where it is not, by an elastic band around the
//!   obstacle B it touches.
//!
//! Elastic band around B, once for each of two kinds of configuration, from q:
//! 1. d: the direction from the centre of B to that of the robot at q;
//! 2. MIN and MAX, from the *volume*: the sum of the radii of balls of the same volume as robot and obstacle,
//!    and the sum of the radii of their bounding spheres;
//! 3. a *parallel* configuration has the long axis (*straightness*) of the robot along that of B, a
//!    *perpendicular* one in any direction across it;
//! 4. for k = 0, …, `bands` (CTE): put the robot at the distance MIN + (MAX − MIN)·k / `bands` from B along
//!    d, rotated about its own long axis by one golden angle more each time; take the first configuration
//!    that is free.
//!
//! Each node is connected to its nearest nodes by the local planner; where that fails and one of the two is
//! far, by turning in place there (see [`StagedConnector`]).
//!
//! The paper leaves open, and this implementation decides: how MIN and MAX depend on the volume, in which
//! steps the vector is scaled (the listing sets `scalar` to MIN and never changes it), and by which angle the
//! robot is rotated each time. The path found is verified; an edge that fails is blocked.
//!
//! **When to use it.** For scenes of separate, compact obstacles, with long robots. Where one obstacle
//! encloses the scene, as the walls of a room in one piece do, no configuration is far, and the bands lead
//! away from the passages. It needs [`ObstacleGeometry`], which rigid bodies among meshes have. With 50,000
//! collision queries it solved 16 of 20 runs of the scene `gempa-3`, where uniform samples solved one, and
//! none of `twisty`, where they solved 4. The band of the paper, which takes the free configuration nearest
//! to the obstacle, is not its strength, nor is the volume: it solved 88 of 140 runs in seven scenes, with
//! `bands=0` 90, with `volume=no` 116 (docs/results/roadmaps.md). In the plane `straightness` changes
//! nothing: the only axis to turn about is Z.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `far`: attempts of the first approximation | 0, 1, … 10⁹ | 100 |
//! | `bands`: steps of the elastic band, CTE; 0 tries one configuration at a random distance | 0, 1, … 10⁶ | 20 |
//! | `straightness`: puts the robot along and across the axis of the obstacle, not in a random rotation | yes, no | yes |
//! | `volume`: starts the band where the volumes of robot and obstacle say, not at 0 | yes, no | yes |
//! | `near`: every other attempt is around an obstacle, not uniform | yes, no | yes |
//! | `salvage`: moves samples that collide out of the obstacle, by the band | yes, no | yes |
//! | `connect`: to the nearest nodes, or to the nearest of each obstacle | nearest, obstacles | nearest |
//! | `per-obstacle`: most of each obstacle, k | 1, 2, … 10⁶ | 3 |
//! | `turns`: where a second stage turns in place: at far nodes, or at fractions of the motion | far, 0, 1, 2, 3 | far |
//! | `straight`: whether there is a first stage; `no` leaves turns in place alone | yes, no | yes |
//! | `neighbours`: most neighbours tried per node | 1, 2, … 10⁶ | 15 |
//! | `radius`: longest distance of neighbours, in the metric of the space or with % of its extent | positive | 100% |
//! | `cycles`: also connects nodes of one component: shorter paths, for more motions | yes, no | no |
//! | `ends`, `ends-step`: trees that grow from start and goal beside the samples ([`EndGrowth`](crate::EndGrowth)): their part of the attempts, their longest step | \[0, 1); as `radius` | 0, 3% |
//!
//! A rod goes around a block:
//! ```
//! use mp_cspace::{Certified, Iterations, Outcome, Planner, Problem, Rng, Se2, Se2State, Straight};
//! use mp_geom::primitives::cuboid;
//! use mp_roadmap::{ObstacleGeometryPrm, Reachable, algo::obstacle_geometry_prm::ByGeometry};
//! use mp_robot::{PlanarFlyer, Verifier};
//! use nalgebra::Isometry3;
//!
//! let block = ("block".to_owned(), cuboid(0.5, 1.5, 1.0)?, Isometry3::identity());
//! let robot = PlanarFlyer::new(&cuboid(0.6, 0.1, 0.2)?, [block])?;
//! let space = Se2::new([-2.0, -1.5], [2.0, 1.5])?;
//! let local = Straight::new(&space, Certified::new(&space, robot.clone(), robot.tolerance())?);
//! let (start, goal) = (Se2State::new(-1.5, 0.0, 0.0), Se2State::new(1.5, 0.0, 1.0));
//!
//! let problem = Problem::new(&space, local, Verifier::new(&space, &robot)?, start, goal)?;
//! let reach = Reachable { neighbours: 10, radius: 2.0, cycles: false };
//! let mut planner = ObstacleGeometryPrm::new(problem, robot, reach, ByGeometry::default())?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//! let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//! assert_eq!((path.states.first(), path.states.last()), (Some(&start), Some(&goal)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::settings::{CYCLES, NEIGHBOURS, RADIUS, reachable, yes};
use crate::engine::staged::{CONNECT, PER_OBSTACLE, STRAIGHT, TURNS_OR_FAR, turns};
use crate::engine::{ENDS, ENDS_STEP};
use crate::{
    AStar, Candidate, ConnectionStages, EdgeChecker, MilestoneKind, NodeGenerator, Reachable, Roadmap,
    RoadmapPlanner, RoadmapPlannerParts, StagedConnector, Turns,
};
use mp_cspace::{
    BuildError, LocalPlanner, Reversible, Rng, Space,
    obstacles::{BodyFeatures, BodySphere, ObstacleGeometry},
    registry::{Parameter, PlannerInfo, Settings},
};
use nalgebra::Vector3;
use rand::RngExt;
use std::f64::consts::TAU;

/// The golden angle (rad): any number of its multiples are spread evenly.
const GOLDEN: f64 = 2.399_963_229_728_653;

/// The parameters of obstacle-geometry PRM.
#[derive(Clone, Debug, PartialEq)]
pub struct ByGeometry {
    /// Attempts of the first approximation.
    pub far: u64,
    /// Steps of the elastic band; without steps it tries one configuration, at a random distance between MIN
    /// and MAX.
    pub bands: u64,
    /// Whether the robot is put along and across the axis of the obstacle; if not, each configuration has a
    /// random rotation.
    pub straightness: bool,
    /// Whether MIN comes from the volumes of robot and obstacle; if not, it is 0.
    pub volume: bool,
    /// Whether every other attempt is around an obstacle; if not, all attempts after the first approximation
    /// are uniform.
    pub near: bool,
    /// Whether samples that collide are salvaged; if not, they are dropped.
    pub salvage: bool,
    /// How nodes are connected.
    pub stages: ConnectionStages,
}

impl Default for ByGeometry {
    fn default() -> Self {
        Self {
            far: 100,
            bands: 20,
            straightness: true,
            volume: true,
            near: true,
            salvage: true,
            stages: ConnectionStages { turns: Turns::WhereFar, ..ConnectionStages::default() },
        }
    }
}

impl ByGeometry {
    /// The values that are set, the others by default.
    ///
    /// # Errors
    /// When a value cannot be read.
    pub fn read(settings: &Settings) -> Result<Self, BuildError> {
        Ok(Self {
            far: settings.count_of(&FAR)?,
            bands: settings.count_of(&BANDS)?,
            straightness: yes(settings, &STRAIGHTNESS)?,
            volume: yes(settings, &VOLUME)?,
            near: yes(settings, &NEAR)?,
            salvage: yes(settings, &SALVAGE)?,
            stages: Self::default().stages.read(settings)?,
        })
    }
}

const FAR: Parameter = Parameter {
    name: "far",
    range: "a whole number, 0 to 10⁹",
    default: "100",
    doc: "attempts of the first approximation",
};
const BANDS: Parameter = Parameter {
    name: "bands",
    range: "a whole number, 0 to 10⁶",
    default: "20",
    doc: "steps of the elastic band (CTE); 0 tries one configuration at a random distance",
};

const fn part(name: &'static str, doc: &'static str) -> Parameter {
    Parameter { name, range: "yes or no", default: "yes", doc }
}
const STRAIGHTNESS: Parameter = part(
    "straightness",
    "puts the robot along and across the axis of the obstacle, not in a random rotation",
);
const VOLUME: Parameter =
    part("volume", "starts the band (MIN) where the volumes of robot and obstacle say, not at 0");
const NEAR: Parameter = part("near", "every other attempt is around an obstacle, not uniform");
const SALVAGE: Parameter = part("salvage", "moves samples that collide out of the obstacle, by the band");

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "obstacle-geometry-prm",
    summary: "a roadmap of samples far from obstacles, by bounding spheres, and near them, by their axis and volume",
    citation: "Benitez and Vallejo 2004",
    parameters: &[
        FAR,
        BANDS,
        STRAIGHTNESS,
        VOLUME,
        NEAR,
        SALVAGE,
        CONNECT,
        PER_OBSTACLE,
        turns(TURNS_OR_FAR, "far"),
        STRAIGHT,
        NEIGHBOURS,
        RADIUS,
        CYCLES,
        ENDS,
        ENDS_STEP,
    ],
    aliases: &["geometry-prm"],
    cannot: crate::engine::settings::NEEDS_GEOMETRY,
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let (geometry, settings) = (args.geometry(INFO.name)?, args.settings);
    let parts = parts(geometry, reachable(args.space, settings)?, ByGeometry::read(settings)?)?;
    args.build(parts)
}

/// Far and near configurations: the generator of obstacle-geometry PRM.
#[derive(Clone, Debug)]
pub struct AroundObstacles<H> {
    hints: H,
    with: ByGeometry,
}

/// MIN and MAX of the elastic band between robot and obstacle, metres.
fn limits(bodies: [&BodySphere; 2], features: [&BodyFeatures; 2]) -> [f64; 2] {
    let equal = |k: usize| bodies[k].radius * mp_math::cbrt(features[k].volume_ratio);
    [equal(0) + equal(1), bodies[0].radius + bodies[1].radius]
}

/// A unit vector in a random direction, perpendicular to `axis` if given.
fn random_unit(axis: Option<&Vector3<f64>>, rng: &mut Rng) -> Vector3<f64> {
    let (z, angle) = (2.0 * rng.random::<f64>() - 1.0, TAU * rng.random::<f64>());
    let round = (1.0 - z * z).sqrt();
    let v = Vector3::new(round * mp_math::cos(angle), round * mp_math::sin(angle), z);
    match axis {
        None => v,
        Some(axis) => {
            let other = Vector3::ith(axis.iamin(), 1.0);
            let across = axis.cross(&other).try_normalize(0.0).unwrap_or(other);
            across * mp_math::cos(angle) + axis.cross(&across) * mp_math::sin(angle)
        }
    }
}

impl<H> AroundObstacles<H> {
    /// # Errors
    /// When a parameter is out of range.
    pub fn new(hints: H, with: ByGeometry) -> Result<Self, BuildError> {
        BuildError::count_within(FAR.name, with.far, 0, 1_000_000_000)?;
        BuildError::count_within(BANDS.name, with.bands, 0, 1_000_000)?;
        Ok(Self { hints, with })
    }

    /// The elastic band around an obstacle from `q`: parallel and perpendicular configurations that are free.
    fn band<C, L>(
        &self,
        obstacle: usize,
        (q, kind): (&C::State, MilestoneKind),
        checker: &mut EdgeChecker<'_, C, L>,
        rng: &mut Rng,
        out: &mut Vec<Candidate<C::State, L::Edge>>,
    ) where
        C: Space,
        L: LocalPlanner<C::State, Edge: Reversible>,
        H: ObstacleGeometry<C::State>,
    {
        let robot = self.hints.robot();
        let Some(body) = self.hints.obstacles().get(obstacle).copied() else { return };
        let Some(features) = self.hints.obstacle_features(obstacle) else { return };
        let away = (self.hints.world_point(q, &robot.center) - body.center).try_normalize(0.0);
        let away = away.unwrap_or_else(|| random_unit(None, rng));
        let [mut min, max] = limits([&robot, &body], [&self.hints.robot_features(), &features]);
        if !self.with.volume {
            min = 0.0;
        }
        let along = [features.axis, random_unit(Some(&features.axis), rng)];
        for direction in along {
            let first = TAU * rng.random::<f64>();
            let mut interrupt = checker.interrupt().clone();
            let found = (0..=self.with.bands).take_while(|_| !interrupt.ask()).find_map(|k| {
                let part = match self.with.bands {
                    0 => rng.random::<f64>(),
                    steps => k as f64 / steps as f64,
                };
                let place = body.center + away * (min + (max - min) * part);
                let (direction, angle) = match self.with.straightness {
                    true => (direction, first + GOLDEN * k as f64),
                    // Any direction of the long axis, and any angle about it: each rotation is equally
                    // likely.
                    false => (random_unit(None, rng), TAU * rng.random::<f64>()),
                };
                let q = self.hints.aligned(&place, &direction, angle);
                checker.admits(&q).then_some(q)
            });
            out.extend(found.map(|q| Candidate::new(q, kind).of(obstacle as u32)));
        }
    }
}

impl<C, L, H> NodeGenerator<C, L> for AroundObstacles<H>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    H: ObstacleGeometry<C::State>,
{
    fn generate(
        &mut self,
        attempt: u64,
        _: &Roadmap<C::State, L::Edge>,
        checker: &mut EdgeChecker<'_, C, L>,
        rng: &mut Rng,
        out: &mut Vec<Candidate<C::State, L::Edge>>,
    ) {
        if !self.hints.prepare(checker.interrupt()) {
            return;
        }
        let q = checker.space().sample_uniform(rng);
        let obstacles = self.hints.obstacles().len() as u64;
        if attempt < self.with.far {
            if self.hints.is_far(&q) {
                out.push(Candidate::new(q, MilestoneKind::Far));
            }
        } else if self.with.near && obstacles > 0 && attempt.is_multiple_of(2) {
            let obstacle = (attempt / 2 % obstacles) as usize;
            self.band(obstacle, (&q, MilestoneKind::Near), checker, rng, out);
        } else if checker.admits(&q) {
            let kind = if self.hints.is_far(&q) { MilestoneKind::Far } else { MilestoneKind::Plain };
            out.push(Candidate::new(q, kind));
        } else if self.with.salvage
            && let Some(obstacle) = self.hints.touched_obstacle(&q)
        {
            self.band(obstacle, (&q, MilestoneKind::Salvaged), checker, rng, out);
        }
    }

    fn independent(&self, _: &Roadmap<C::State, L::Edge>) -> u64 {
        u64::MAX
    }
}

/// Obstacle-geometry PRM: see the [module](self).
pub type ObstacleGeometryPrm<'c, C, L, N, H> =
    RoadmapPlanner<'c, C, L, AroundObstacles<H>, StagedConnector, AStar, N>;

constructors! {
    "Obstacle-geometry PRM" ObstacleGeometryPrm<C, L, N, H> where [H: ObstacleGeometry<C::State> + Clone],
    |_, hints: H, reach: Reachable, with: ByGeometry| parts(hints, reach, with)
}

/// The parts of obstacle-geometry PRM.
///
/// # Errors
/// When a parameter is out of range.
pub fn parts<H>(
    hints: H,
    reach: Reachable,
    with: ByGeometry,
) -> Result<RoadmapPlannerParts<AroundObstacles<H>, StagedConnector, AStar>, BuildError> {
    let connector = StagedConnector::new(reach, with.stages.clone())?;
    Ok(RoadmapPlannerParts::new(AroundObstacles::new(hints, with)?, connector))
}
