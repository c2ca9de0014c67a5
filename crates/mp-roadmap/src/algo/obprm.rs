//! OBPRM: nodes on and near the surfaces of obstacles.
//!
//! N. M. Amato and Y. Wu, *A randomized roadmap method for path and manipulation planning*, ICRA 1996; N. M.
//! Amato, O. B. Bayazit, L. K. Dale, C. Jones and D. Vallejo, *OBPRM: an obstacle-based PRM for 3D
//! workspaces*, WAFR 1998. As in §3.2 of A. Benitez et al., *Key elements for motion planning
//! algorithms*, 2010.
//!
//! For one obstacle after the other, by `nodes`:
//!
//! `prototype` (PROTOTYPE NODE GENERATION)
//! 1. C_in: the robot with its centre in that of the obstacle, rotated at random until it collides;
//! 2. D: `directions` random directions from there: toward uniform samples;
//! 3. for each, look for a free C_out, in equal steps as far as the surrounding spheres of robot and obstacle
//!    overlap;
//! 4. find where contact ends between C_in and C_out by binary search: a *contact* configuration.
//!
//! `contact` (GENERATE CONTACT CONFIGURATION)
//! 1. p_rob, a point of the robot, and p_obs, a point of the obstacle, both by `points`;
//! 2. C_in: the robot with p_rob in p_obs, rotated at random until it collides;
//! 3. d: one random direction; C_out and contact as above.
//!
//! `free`: from a contact configuration as in `contact`, a random length of at most `gap` farther in the same
//! direction.
//!
//! `shells`: a contact configuration, and `shells` more behind it, `gap` apart.
//!
//! A part `uniform` of the attempts are uniform samples; the papers have none, and so no nodes in scenes
//! without obstacles. Each node is connected, by `connect`, to its nearest nodes (`nearest`), or to the
//! `per-obstacle` nearest of each obstacle (`obstacles`); in stages: first by the local planner, then, to
//! nodes still in other components, by rotate-at-s at `turns` fractions of the motion: 1/2, 0 and 1, in this
//! order (see [`StagedConnector`]).
//!
//! The path found is verified; an edge that fails is blocked. An obstacle here is a connected part of the
//! scene ([`ObstacleGeometry`]); where its centre is outside of the space, or does not collide, points of its
//! surface are used.
//!
//! **When to use it.** For narrow passages between obstacles of moderate size. It needs [`ObstacleGeometry`],
//! which rigid bodies among meshes have. Of the four ways to make nodes `free` is the best: with 50,000
//! collision queries and certified motions it solved 98 of 140 runs in seven scenes, `shells` 88, `prototype`
//! 74, `contact` 73, uniform samples 80. With discrete motion checks, nearly all first paths by way of nodes
//! in contact fail the verification (docs/results/roadmaps.md).
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `nodes`: how nodes are generated | prototype, contact, free, shells | free |
//! | `points`: of robot and obstacle | centers, vertices, surface | surface |
//! | `directions`: of `prototype`, m | 1, 2, … 1000 | 10 |
//! | `gap`: of `free` and `shells`, in the metric of the space or with % of its extent | positive | 1% |
//! | `shells`: how many | 1, 2, … 100 | 3 |
//! | `uniform`: part of the attempts that are uniform samples | \[0, 1\] | 0.1 |
//! | `connect`: to which nodes | nearest, obstacles | nearest |
//! | `per-obstacle`: most of each obstacle, k | 1, 2, … 10⁶ | 3 |
//! | `turns`: fractions tried in the second stage | 0, 1, 2, 3 | 1 |
//! | `straight`: whether there is a first stage; `no` leaves rotate-at-s alone | yes, no | yes |
//! | `neighbours`: most neighbours tried per node | 1, 2, … 10⁶ | 15 |
//! | `radius`: longest distance of neighbours, in the metric of the space or with % of its extent | positive | 100% |
//! | `cycles`: also connects nodes of one component: shorter paths, for more motions | yes, no | no |
//! | `ends`, `ends-step`: trees that grow from start and goal beside the samples ([`EndGrowth`](crate::EndGrowth)): their part of the attempts, their longest step | \[0, 1); as `radius` | 0, 3% |
//!
//! A disc goes between two boxes:
//! ```
//! use mp_cspace::{Certified, Iterations, Outcome, Planner, Problem, Rng, Se2, Se2State, Straight};
//! use mp_geom::primitives::{cuboid, cylinder};
//! use mp_roadmap::{Obprm, Reachable, algo::obprm::OnSurfaces};
//! use mp_robot::{PlanarFlyer, Verifier};
//! use nalgebra::Isometry3;
//!
//! let wall = |name: &str, y| Ok::<_, Box<dyn std::error::Error>>((name.to_owned(), cuboid(0.5, 2.0, 1.0)?, Isometry3::translation(0.0, y, 0.0)));
//! let robot = PlanarFlyer::new(&cylinder(0.1, 0.2, 12)?, [wall("low", -1.15)?, wall("high", 1.15)?])?;
//! let space = Se2::new([-2.0, -1.0], [2.0, 1.0])?;
//! let local = Straight::new(&space, Certified::new(&space, robot.clone(), robot.tolerance())?);
//! let (start, goal) = (Se2State::new(-1.5, 0.8, 0.0), Se2State::new(1.5, -0.8, 0.0));
//!
//! let problem = Problem::new(&space, local, Verifier::new(&space, &robot)?, start, goal)?;
//! let reach = Reachable { neighbours: 10, radius: 2.0, cycles: false };
//! let mut planner = Obprm::new(problem, robot, reach, OnSurfaces::default())?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//! let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//! assert_eq!((path.states.first(), path.states.last()), (Some(&start), Some(&goal)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::pairs::{drew_uniform, part, uniform};
use crate::engine::settings::{CYCLES, NEIGHBOURS, RADIUS, length, reachable};
use crate::engine::staged::{CONNECT, PER_OBSTACLE, STRAIGHT, TURNS_RANGE, turns};
use crate::engine::{ENDS, ENDS_STEP};
use crate::{
    AStar, Candidate, ConnectionStages, EdgeChecker, MilestoneKind, NodeGenerator, Reachable, Roadmap,
    RoadmapPlanner, RoadmapPlannerParts, StagedConnector, Turns,
};
use mp_cspace::{
    BuildError, Length, LocalPlanner, Reversible, Rng, Space,
    obstacles::{ObstacleGeometry, PointOf},
    registry::{Parameter, PlannerInfo, Settings},
};
use rand::RngExt;

/// States tested to find one that is free.
const LOOKS: u32 = 16;
/// Halvings of the binary search.
const HALVINGS: u32 = 12;
/// Rotations tried to find one that collides.
const TRIES: usize = 10;

/// How nodes are generated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Strategy {
    /// Contact configurations in many directions from the centre of the obstacle.
    Prototype,
    /// Contact configurations with a point of the robot in a point of the obstacle.
    Contact,
    /// Free configurations behind contact.
    Free,
    /// Contact configurations with further ones behind them.
    Shells,
}

/// The parameters of OBPRM.
#[derive(Clone, Debug, PartialEq)]
pub struct OnSurfaces {
    /// How nodes are generated.
    pub strategy: Strategy,
    /// Which points of robot and obstacle are put into each other.
    pub points: PointOf,
    /// Directions of [`Strategy::Prototype`]; 1 or more.
    pub directions: usize,
    /// The greatest distance of free nodes from contact, and the distance between shells.
    pub gap: Length,
    /// Shells behind contact; 1 or more.
    pub shells: usize,
    /// Part of the attempts that are uniform samples.
    pub uniform: f64,
    /// How nodes are connected.
    pub stages: ConnectionStages,
}

impl Default for OnSurfaces {
    fn default() -> Self {
        Self {
            strategy: Strategy::Free,
            points: PointOf::Surface,
            directions: 10,
            gap: Length::Fraction(0.01),
            shells: 3,
            uniform: 0.1,
            stages: ConnectionStages { turns: Turns::first(1), ..ConnectionStages::default() },
        }
    }
}

const fn parameter(
    name: &'static str,
    range: &'static str,
    default: &'static str,
    doc: &'static str,
) -> Parameter {
    Parameter { name, range, default, doc }
}
const NODES: Parameter =
    parameter("nodes", "prototype, contact, free or shells", "free", "how nodes are generated");
const POINTS: Parameter =
    parameter("points", "centers, vertices or surface", "surface", "which points are put into each other");
const DIRECTIONS: Parameter =
    parameter("directions", "a whole number, 1 to 1000", "10", "directions of `prototype` (m)");
const GAP: Parameter = parameter(
    "gap",
    "in (0, extent of the space], or with % in (0%, 100%] of the extent",
    "1%",
    "greatest distance of `free` nodes from contact, and distance between `shells`",
);
const SHELLS: Parameter = parameter("shells", "a whole number, 1 to 100", "3", "shells behind contact");

impl OnSurfaces {
    /// The values that are set, the others by default.
    ///
    /// # Errors
    /// When a value cannot be read.
    pub fn read(settings: &Settings) -> Result<Self, BuildError> {
        let default = Self::default();
        let strategy = |word: &str| match word {
            "prototype" => Some(Strategy::Prototype),
            "contact" => Some(Strategy::Contact),
            "free" => Some(Strategy::Free),
            "shells" => Some(Strategy::Shells),
            _ => None,
        };
        let points = |word: &str| match word {
            "centers" => Some(PointOf::Center),
            "vertices" => Some(PointOf::Vertex),
            "surface" => Some(PointOf::Surface),
            _ => None,
        };
        Ok(Self {
            strategy: settings.choice(NODES.name, NODES.range, strategy)?.unwrap_or(default.strategy),
            points: settings.choice(POINTS.name, POINTS.range, points)?.unwrap_or(default.points),
            directions: settings.count_of(&DIRECTIONS)? as usize,
            gap: settings.length(GAP.name)?.unwrap_or(default.gap),
            shells: settings.count_of(&SHELLS)? as usize,
            uniform: settings.number("uniform")?.unwrap_or(default.uniform),
            stages: default.stages.read(settings)?,
        })
    }
}

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "obprm",
    summary: "a roadmap of samples on and near the surfaces of obstacles",
    citation: "Amato and Wu 1996; Amato, Bayazit, Dale, Jones and Vallejo 1998",
    parameters: &[
        NODES,
        POINTS,
        DIRECTIONS,
        GAP,
        SHELLS,
        uniform("0.1"),
        CONNECT,
        PER_OBSTACLE,
        turns(TURNS_RANGE, "1"),
        STRAIGHT,
        NEIGHBOURS,
        RADIUS,
        CYCLES,
        ENDS,
        ENDS_STEP,
    ],
    aliases: &["ob-prm"],
    cannot: crate::engine::settings::NEEDS_GEOMETRY,
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let (geometry, reach) = (args.geometry(INFO.name)?, reachable(args.space, args.settings)?);
    let parts = parts(args.space, geometry, reach, OnSurfaces::read(args.settings)?)?;
    args.build(parts)
}

/// Configurations on and near the surfaces of obstacles: the generator of OBPRM.
#[derive(Clone, Debug)]
pub struct OnObstacles<H> {
    hints: H,
    with: OnSurfaces,
    gap: f64,
}

impl<H> OnObstacles<H> {
    /// # Errors
    /// When a parameter is out of range.
    pub fn new<C: Space>(space: &C, hints: H, with: OnSurfaces) -> Result<Self, BuildError> {
        BuildError::count_within(DIRECTIONS.name, with.directions as u64, 1, 1000)?;
        BuildError::count_within(SHELLS.name, with.shells as u64, 1, 100)?;
        part("uniform", with.uniform)?;
        Ok(Self { hints, gap: length(&GAP, with.gap, space)?, with })
    }

    /// C_in: a configuration within the space that collides with the obstacle, or with others near it.
    fn inside<C, L>(
        &self,
        obstacle: usize,
        checker: &mut EdgeChecker<'_, C, L>,
        rng: &mut Rng,
    ) -> Option<C::State>
    where
        C: Space,
        L: LocalPlanner<C::State, Edge: Reversible>,
        H: ObstacleGeometry<C::State>,
    {
        let space = checker.space();
        let asked =
            if self.with.strategy == Strategy::Prototype { PointOf::Center } else { self.with.points };
        (0..TRIES).find_map(|i| {
            // Where such points do not collide, as the centre of a ring, points of the surface are used.
            let of = if i < TRIES / 2 { asked } else { PointOf::Surface };
            let turned = space.sample_uniform(rng);
            let point = self.hints.robot_point(of, rng);
            let place = self.hints.obstacle_point(obstacle, of, rng)?;
            let q = self.hints.moved_to(&turned, &point, &place);
            (space.contains(&q) && !checker.admits(&q)).then_some(q)
        })
    }

    /// The fraction of the motion from `inside` to `toward` at which contact ends, if it ends before the
    /// robot is past the obstacle.
    fn contact<C, L>(
        &self,
        obstacle: usize,
        [inside, toward]: [&C::State; 2],
        checker: &mut EdgeChecker<'_, C, L>,
    ) -> Option<f64>
    where
        C: Space,
        L: LocalPlanner<C::State, Edge: Reversible>,
        H: ObstacleGeometry<C::State>,
    {
        let (space, robot) = (checker.space(), self.hints.robot());
        let places = [inside, toward].map(|q| self.hints.world_point(q, &robot.center));
        let reach = 2.0 * (self.hints.obstacles().get(obstacle)?.radius + robot.radius);
        let most = (reach / (places[1] - places[0]).norm()).min(1.0);
        let mut admits = |at: f64| checker.admits(&space.interpolate(inside, toward, at));
        let step = most / f64::from(LOOKS);
        let (mut free, mut low) = (0.0, 0.0);
        for i in 1..=LOOKS {
            let at = step * f64::from(i);
            if admits(at) {
                free = at;
                break;
            }
            low = at;
        }
        if free == 0.0 {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + free);
            *(if admits(middle) { &mut free } else { &mut low }) = middle;
        }
        Some(free)
    }
}

impl<C, L, H> NodeGenerator<C, L> for OnObstacles<H>
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
        let obstacles = self.hints.obstacles().len() as u64;
        let OnSurfaces { strategy, directions, shells, uniform, .. } = self.with;
        if drew_uniform(if obstacles == 0 { 1.0 } else { uniform }, checker, rng, out) {
            return;
        }
        let obstacle = (attempt % obstacles) as usize;
        let Some(inside) = self.inside(obstacle, checker, rng) else { return };
        let space = checker.space();
        for _ in 0..if strategy == Strategy::Prototype { directions } else { 1 } {
            let toward = space.sample_uniform(rng);
            let Some(contact) = self.contact(obstacle, [&inside, &toward], checker) else { continue };
            let gap = self.gap / space.distance(&inside, &toward);
            let mut take = |at: f64, kind: MilestoneKind, checker: &mut EdgeChecker<'_, C, L>| {
                let q = space.interpolate(&inside, &toward, at);
                // Contact configurations were tested before.
                if at <= 1.0 && (kind == MilestoneKind::Contact || checker.admits(&q)) {
                    out.push(Candidate::new(q, kind).of(obstacle as u32));
                }
            };
            match strategy {
                Strategy::Prototype | Strategy::Contact => take(contact, MilestoneKind::Contact, checker),
                Strategy::Free => take(contact + gap * rng.random::<f64>(), MilestoneKind::Near, checker),
                Strategy::Shells => {
                    take(contact, MilestoneKind::Contact, checker);
                    for shell in 1..=shells {
                        take(contact + gap * shell as f64, MilestoneKind::Near, checker);
                    }
                }
            }
        }
    }

    fn independent(&self, _: &Roadmap<C::State, L::Edge>) -> u64 {
        u64::MAX
    }
}

/// OBPRM: see the [module](self).
pub type Obprm<'c, C, L, N, H> = RoadmapPlanner<'c, C, L, OnObstacles<H>, StagedConnector, AStar, N>;

constructors! {
    "OBPRM" Obprm<C, L, N, H> where [H: ObstacleGeometry<C::State> + Clone],
    |space, hints: H, reach: Reachable, with: OnSurfaces| parts(space, hints, reach, with)
}

/// The parts of OBPRM.
///
/// # Errors
/// When a parameter is out of range.
pub fn parts<C: Space, H>(
    space: &C,
    hints: H,
    reach: Reachable,
    with: OnSurfaces,
) -> Result<RoadmapPlannerParts<OnObstacles<H>, StagedConnector, AStar>, BuildError> {
    let connector = StagedConnector::new(reach, with.stages.clone())?;
    Ok(RoadmapPlannerParts::new(OnObstacles::new(space, hints, with)?, connector))
}
