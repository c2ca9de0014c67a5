//! Planners that know what obstacles look like, and what they are made of.

use mp_cspace::erased::{AnyCheck, AnyGeometry, AnySpace};
use mp_cspace::obstacles::ObstacleGeometry;
use mp_cspace::registry::{PlannerInfo, Settings};
use mp_cspace::*;
use mp_geom::primitives::cuboid;
use mp_geom::{TriMesh, pose_from_six};
use mp_roadmap::algo::{obprm, obstacle_geometry_prm};
use mp_roadmap::*;
use mp_robot::{FreeFlyer, PlanarFlyer, Verifier};
use nalgebra::{Isometry3, Vector3};
use std::cell::Cell;

type Obstacle = (String, TriMesh, Isometry3<f64>);

fn block(name: &str, [x, y, z]: [f64; 3], at: [f64; 3]) -> Obstacle {
    (name.to_owned(), cuboid(x, y, z).unwrap(), pose_from_six([at[0], at[1], at[2], 0.0, 0.0, 0.0]))
}

/// A rod in the plane before a wall with a gap narrower than it is long.
fn corridor(gap: f64) -> PlanarFlyer {
    let size = [0.8, 2.0, 1.0];
    let y = 1.0 + 0.5 * gap;
    let walls = [block("low", size, [0.0, -y, 0.0]), block("high", size, [0.0, y, 0.0])];
    PlanarFlyer::new(&cuboid(0.8, 0.1, 0.2).unwrap(), walls).unwrap()
}

fn plane() -> Se2 {
    Se2::new([-2.0, -1.5], [2.0, 1.5]).unwrap()
}

/// Of motions: coarse, as tests are to be quick.
const TOLERANCE: f64 = 0.004;

type Local<'c> = Straight<'c, Se2, Certified<'c, Se2, PlanarFlyer>>;

fn ends() -> [Se2State; 2] {
    [Se2State::new(-1.4, 0.3, 1.5), Se2State::new(1.4, -0.3, -1.0)]
}

fn problem<'c>(space: &'c Se2, robot: &PlanarFlyer) -> Problem<'c, Se2, Local<'c>> {
    let [start, goal] = ends();
    let check = Certified::new(space, robot.clone(), TOLERANCE).unwrap();
    let verifier = Verifier::with_tolerance(space, robot, 0.2 * TOLERANCE).unwrap();
    knowing(Problem::new(space, Straight::new(space, check), verifier, start, goal).unwrap(), robot)
}

/// A problem that knows what obstacles look like.
fn knowing<'c, C: Space, L: LocalPlanner<C::State>>(
    problem: Problem<'c, C, L>,
    robot: &(impl ObstacleGeometry<C::State> + Clone + Send + Sync + 'c),
) -> Problem<'c, C, L> {
    let geometry = Some(AnyGeometry::new(robot.clone()));
    problem.with_obstacles(ObstacleKnowledge { geometry, ..ObstacleKnowledge::default() })
}

fn made<'c>(name: &str, settings: &str, space: &'c Se2, robot: &PlanarFlyer) -> AnyPlanner<'c, Se2State, ()> {
    let settings = Settings::parse(settings.split_whitespace()).unwrap();
    let index = <Se2 as DefaultNn>::Nn::default();
    build_with(name, problem(space, robot), index, &settings).unwrap()
}

/// Every strategy, and planners that need no geometry as well.
const ALL: [(&str, &str); 17] = [
    ("obprm", "nodes=prototype"),
    ("obprm", "nodes=contact points=centers"),
    ("obprm", "nodes=free points=vertices turns=0 gap=5%"),
    ("obprm", "nodes=free"),
    ("obprm", "nodes=shells"),
    ("obprm", "connect=obstacles turns=3"),
    ("ob-prm", "connect=obstacles per-obstacle=5 cycles=yes"),
    ("obstacle-geometry-prm", ""),
    ("geometry-prm", "far=0 bands=40"),
    ("gaussian-prm", ""),
    ("bridge-prm", "uniform=0.8"),
    ("prm", "turns=1"),
    ("gaussian-prm", "straight=no turns=3"),
    ("obprm", "straight=no"),
    ("geometry-prm", "straightness=no volume=no salvage=no"),
    ("geometry-prm", "bands=0 turns=1 connect=obstacles"),
    ("geometry-prm", "far=0 near=no"),
];

#[test]
fn a_rod_goes_through_a_corridor() {
    let (space, robot) = (plane(), corridor(0.4));
    let mut verifier = Verifier::new(&space, &robot).unwrap();
    for (name, settings) in ALL {
        for seed in 0..2 {
            let mut planner = made(name, settings, &space, &robot);
            let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(20_000), &mut ());
            let Outcome::Solved(path) = outcome else {
                panic!("{name} {settings} seed {seed}: {:?}", planner.progress())
            };
            assert!(verify_path(&space, &path, &mut verifier).is_free(), "{name} {settings}");
            if seed > 0 {
                continue;
            }
            let again = made(name, settings, &space, &robot).solve(
                &mut Rng::seed(seed),
                &mut Iterations(20_000),
                &mut (),
            );
            assert!(again == Outcome::Solved(path), "the same seed, the same path");
        }
    }
}

#[test]
fn a_team_finds_what_one_finds() {
    let (space, robot) = (plane(), corridor(0.3));
    for name in ["prm", "obprm", "geometry-prm"] {
        let found = |checkers: usize| {
            let workers = Workers::new(checkers).unwrap();
            let parallel = ParallelProblem::new(workers, checkers, || Ok(problem(&space, &robot))).unwrap();
            let index = <Se2 as DefaultNn>::Nn::default();
            let mut planner = build_with(name, parallel, index, &Settings::default()).unwrap();
            let outcome = planner.solve(&mut Rng::seed(5), &mut Iterations(20_000), &mut ());
            (outcome, planner.map().states().to_vec(), planner.map().edges())
        };
        let alone = found(1);
        assert!(matches!(alone.0, Outcome::Solved(_)), "{name}");
        assert!(alone == found(3), "{name}");
    }
}

#[test]
fn a_closed_corridor_is_never_solved() {
    let (space, robot) = (plane(), corridor(0.05));
    for (name, settings) in [ALL[0], ALL[5], ALL[7], ALL[9]] {
        let mut planner = made(name, settings, &space, &robot);
        let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(40), &mut ());
        assert_eq!(outcome, Outcome::Stopped(StopReason::Iterations), "{name} {settings}");
    }
}

/// A bar must be turned to pass a window in a wall of four beams.
#[test]
fn a_bar_goes_through_a_window() {
    let frame = [
        block("left", [0.2, 1.0, 3.0], [0.0, -1.0, 0.0]),
        block("right", [0.2, 1.0, 3.0], [0.0, 1.0, 0.0]),
        block("low", [0.2, 1.0, 1.2], [0.0, 0.0, -0.9]),
        block("high", [0.2, 1.0, 1.2], [0.0, 0.0, 0.9]),
    ];
    let robot = FreeFlyer::new(&cuboid(1.2, 0.15, 0.15).unwrap(), frame).unwrap();
    let space = Se3::new([-1.5; 3], [1.5; 3]).unwrap();
    let (start, goal) =
        (pose_from_six([-1.0, 0.0, 0.0, 1.5, 0.0, 0.0]), pose_from_six([1.0, 0.2, 0.3, 1.0, 0.4, 0.0]));
    let (rows, placed) = (AsVectors(space.clone()), OnVectors::<_, Isometry3<f64>>::new(robot.clone()));
    let any = AnySpace::new(&rows);
    for name in ["obprm", "obstacle-geometry-prm"] {
        let check: AnyCheck<'_, Configuration> =
            Box::new(Certified::new(&rows, placed.clone(), robot.tolerance()).unwrap());
        let verifier = OnVectors::<_, Isometry3<f64>>::new(Verifier::new(&space, &robot).unwrap());
        let [start, goal] = [start, goal].map(|q| Configuration::of(&q));
        let problem = Problem::new(&any, Straight::new(&any, check), verifier, start, goal).unwrap();
        let parallel = AnyParallelProblem::from(knowing(problem, &placed));
        let (index, settings) = (AnyIndex::of(&rows), Settings::default());
        let mut planner = mp_roadmap::erased::build(name, parallel, index, &settings).unwrap();
        let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(40_000), &mut ());
        let Outcome::Solved(path) = outcome else { panic!("{name}: {:?}", planner.progress()) };
        let path = Path::straight(path.states.iter().map(|q| q.to().unwrap()).collect());
        assert!(verify_path(&space, &path, &mut Verifier::new(&space, &robot).unwrap()).is_free());
    }
}

fn candidates<'c, G: NodeGenerator<Se2, Local<'c>>>(
    space: &'c Se2,
    robot: &PlanarFlyer,
    mut generator: G,
    attempts: std::ops::Range<u64>,
) -> Vec<Candidate<Se2State, ()>> {
    let check = Certified::new(space, robot.clone(), TOLERANCE).unwrap();
    let verifier = Verifier::new(space, robot).unwrap();
    let mut checker = EdgeChecker::new(space, Straight::new(space, check), verifier, 10);
    let (map, mut all, mut out) = (Roadmap::new(), Vec::new(), Vec::new());
    for attempt in attempts {
        let mut rng = Rng::stream(7, attempt);
        generator.generate(attempt, &map, &mut checker, &mut rng, &mut out);
        all.append(&mut out);
    }
    assert!(all.iter().all(|c| checker.admits(&c.state)), "all that is proposed is free");
    all
}

#[test]
fn nodes_of_obprm_are_on_surfaces() {
    let (space, mut robot) = (plane(), corridor(0.25));
    let gap = 0.01 * space.extent();
    for strategy in [Strategy::Prototype, Strategy::Contact, Strategy::Free, Strategy::Shells] {
        let with =
            OnSurfaces { strategy, gap: Length::Fraction(0.01), uniform: 0.0, ..OnSurfaces::default() };
        let generator = OnObstacles::new(&space, robot.clone(), with).unwrap();
        let all = candidates(&space, &robot, generator, 0..200);
        let of = |kind| all.iter().filter(move |c| c.kind == kind);
        let contacts = matches!(strategy, Strategy::Prototype | Strategy::Contact | Strategy::Shells);
        assert_eq!(of(MilestoneKind::Contact).count() > 100, contacts, "{strategy:?}");
        let near = matches!(strategy, Strategy::Free | Strategy::Shells);
        assert_eq!(of(MilestoneKind::Near).count() > 100, near, "{strategy:?}");
        for c in of(MilestoneKind::Contact) {
            assert!(robot.clearance(&c.state, 1.0) < 0.5 * TOLERANCE + 2e-3, "{strategy:?} {c:?}");
        }
        // Half an extent turns by no more than its share, so this bounds how far the robot moved.
        for c in of(MilestoneKind::Near) {
            assert!(robot.clearance(&c.state, 1.0) < TOLERANCE + 4.0 * gap, "{strategy:?} {c:?}");
        }
        assert!(all.iter().any(|c| c.obstacle == Some(0)) && all.iter().any(|c| c.obstacle == Some(1)));
    }
}

#[test]
fn far_is_told_by_spheres_and_near_lies_parallel_and_across() {
    let (space, robot) = (plane(), corridor(0.25));
    let generator =
        || AroundObstacles::new(robot.clone(), ByGeometry { far: 400, ..ByGeometry::default() }).unwrap();

    // No state is tested in the first approximation.
    let tests = Cell::new(0);
    let counts = |_: &Se2State| {
        tests.set(tests.get() + 1);
        true
    };
    let check = || Discrete::new(&space, counts, Length::Fraction(0.1)).unwrap();
    let mut checker =
        EdgeChecker::new(&space, Straight::new(&space, check()), Verifier::new(&space, &robot).unwrap(), 10);
    let (map, mut out, mut first) = (Roadmap::new(), Vec::new(), generator());
    for attempt in 0..400 {
        first.generate(attempt, &map, &mut checker, &mut Rng::stream(7, attempt), &mut out);
    }
    drop(checker);
    assert_eq!(tests.get(), 0);
    assert!(out.len() > 10 && out.iter().all(|c| c.kind == MilestoneKind::Far && robot.is_far(&c.state)));

    let all = candidates(&space, &robot, generator(), 400..800);
    let mut count = [0; 4];
    for c in &all {
        match c.kind {
            MilestoneKind::Far => assert!(robot.is_far(&c.state)),
            MilestoneKind::Near => count[0] += 1,
            MilestoneKind::Salvaged => count[1] += 1,
            MilestoneKind::Plain => count[2] += 1,
            _ => count[3] += 1,
        }
    }
    assert!(count[0] > 50 && count[1] > 10 && count[2] > 10 && count[3] == 0, "{count:?}");
    // In space the band's first kind has the axes of robot and obstacle parallel, its second across.
    let pillar = block("pillar", [0.4, 0.3, 2.0], [0.0; 3]);
    let rod = FreeFlyer::new(&cuboid(0.8, 0.1, 0.1).unwrap(), [pillar]).unwrap();
    let space = Se3::new([-2.0; 3], [2.0; 3]).unwrap();
    let check = Certified::new(&space, rod.clone(), rod.tolerance()).unwrap();
    let mut checker =
        EdgeChecker::new(&space, Straight::new(&space, check), Verifier::new(&space, &rod).unwrap(), 10);
    let mut generator =
        AroundObstacles::new(rod.clone(), ByGeometry { far: 0, ..ByGeometry::default() }).unwrap();
    let (map, mut pairs) = (Roadmap::new(), 0);
    for attempt in (0..200).step_by(2) {
        out_of(&mut generator, attempt, &map, &mut checker, &mut pairs);
    }
    assert!(pairs > 80, "{pairs}");
}

type Rod<'c> = Straight<'c, Se3, Certified<'c, Se3, FreeFlyer>>;

fn out_of(
    generator: &mut AroundObstacles<FreeFlyer>,
    attempt: u64,
    map: &Roadmap<Isometry3<f64>>,
    checker: &mut EdgeChecker<'_, Se3, Rod<'_>>,
    pairs: &mut u32,
) {
    let mut out = Vec::new();
    generator.generate(attempt, map, checker, &mut Rng::stream(3, attempt), &mut out);
    let axes: Vec<Vector3<f64>> = out.iter().map(|c| c.state.rotation * Vector3::x()).collect();
    if let [parallel, across] = axes[..] {
        assert!(parallel.z.abs() > 1.0 - 1e-9 && across.z.abs() < 1e-9);
        *pairs += 1;
    }
}

/// Each part of obstacle-geometry PRM can be left out, and only that is gone.
#[test]
fn parts_can_be_left_out() {
    let pillar = block("pillar", [0.7, 0.6, 2.4], [0.0; 3]);
    let rod = FreeFlyer::new(&cuboid(0.8, 0.1, 0.1).unwrap(), [pillar]).unwrap();
    let space = Se3::new([-2.0; 3], [2.0; 3]).unwrap();
    let verifier = Verifier::new(&space, &rod).unwrap();
    let check = Certified::new(&space, rod.clone(), rod.tolerance()).unwrap();
    let mut checker = EdgeChecker::new(&space, Straight::new(&space, check), verifier, 10);
    let mut of = |with: ByGeometry| {
        let mut generator = AroundObstacles::new(rod.clone(), with).unwrap();
        let (map, mut all, mut out) = (Roadmap::new(), Vec::new(), Vec::new());
        for attempt in 0..400 {
            generator.generate(attempt, &map, &mut checker, &mut Rng::stream(3, attempt), &mut out);
            all.append(&mut out);
        }
        let count = |kind| all.iter().filter(|c: &&Candidate<Isometry3<f64>, ()>| c.kind == kind).count();
        let kinds = [MilestoneKind::Near, MilestoneKind::Salvaged, MilestoneKind::Plain].map(count);
        let near = all.iter().filter(|c| matches!(c.kind, MilestoneKind::Near | MilestoneKind::Salvaged));
        let (mut parallel, mut nearest) = (0, f64::INFINITY);
        for c in near {
            parallel += usize::from((c.state.rotation * Vector3::x()).z.abs() > 1.0 - 1e-9);
            nearest = nearest.min(c.state.translation.vector.norm());
        }
        (kinds, parallel, nearest)
    };
    let all = ByGeometry { far: 0, ..ByGeometry::default() };
    let ([near, salvaged, plain], parallel, nearest) = of(all.clone());
    assert!(
        near > 300 && salvaged > 5 && plain > 20 && parallel > 150,
        "{near} {salvaged} {plain} {parallel}"
    );

    let (kinds, parallel, _) = of(ByGeometry { straightness: false, ..all.clone() });
    assert!(kinds[0] > 300 && parallel == 0, "{kinds:?} {parallel}");
    // The band begins at the centre of the obstacle: the rod fits into it, and obstacles are surfaces.
    let (_, _, closest) = of(ByGeometry { volume: false, ..all.clone() });
    assert!(closest < nearest, "{closest} {nearest}");
    let (kinds, ..) = of(ByGeometry { salvage: false, ..all.clone() });
    assert!(kinds[0] == near && kinds[1] == 0 && kinds[2] == plain, "{kinds:?}");
    let (kinds, ..) = of(ByGeometry { near: false, ..all.clone() });
    assert!(kinds[0] == 0 && kinds[1] > salvaged && kinds[2] > plain, "{kinds:?}");
    let (kinds, ..) = of(ByGeometry { bands: 0, ..all });
    assert!(kinds[0] > 50 && kinds[0] < near, "{kinds:?}");
}

/// Without turns, what is connected in stages is connected as PRM does it, to the bit, also with cycles.
#[test]
fn one_stage_is_the_connector_of_prm() {
    let (space, robot) = (plane(), corridor(0.3));
    for cycles in [false, true] {
        let reach = Reachable { neighbours: 15, radius: f64::INFINITY, cycles };
        let mut one = Prm::new(problem(&space, &robot), reach, Learning::default()).unwrap();
        let mut other = made("prm", if cycles { "cycles=yes" } else { "" }, &space, &robot);
        let grown = |planner: &mut dyn HasRoadmap<Se2State, ()>| {
            planner.build(&mut Rng::seed(3), &mut Nodes(700), &mut ());
            (planner.map().states().to_vec(), planner.map().edges(), planner.progress())
        };
        assert!(grown(&mut one) == grown(&mut *other), "cycles: {cycles}");
    }
}

/// Rotate-at-s alone makes edges that either turn or move.
#[test]
fn without_straight_motions_edges_turn_or_move() {
    let (space, robot) = (plane(), corridor(0.4));
    let mut planner = made("prm", "straight=no turns=1 expand=0", &space, &robot);
    planner.build(&mut Rng::seed(3), &mut Nodes(200), &mut ());
    let map = planner.map();
    let edges: Vec<_> = map.all_edges().map(|(edge, ..)| map.ends(edge).map(|id| *map.state(id))).collect();
    assert!(edges.len() > 50, "{}", edges.len());
    for [a, b] in edges {
        let (moved, turned) = ((a.translation - b.translation).norm(), (a.angle - b.angle).abs());
        assert!(moved < 1e-9 || turned < 1e-9, "{moved} {turned}");
    }
}

#[test]
fn what_cannot_be_made_says_why() {
    let (space, robot) = (plane(), corridor(0.25));
    for name in ["obprm", "geometry-prm"] {
        let blind = problem(&space, &robot).with_obstacles(ObstacleKnowledge::default());
        let error = build(name, blind, &Settings::default()).err().unwrap();
        assert!(error.to_string().contains("geometry of obstacles"), "{error}");
    }
    let refused = |name: &str, setting: &str| {
        let settings = Settings::parse([setting]).unwrap();
        let index = <Se2 as DefaultNn>::Nn::default();
        build_with(name, problem(&space, &robot), index, &settings).err()
    };
    for setting in [
        "nodes=many",
        "points=2",
        "directions=0",
        "gap=0",
        "shells=0",
        "uniform=1.5",
        "connect=all",
        "per-obstacle=x",
        "turns=4",
        "turns=far",
        "straight=maybe",
        "neighbours=0",
        "bands=3",
    ] {
        assert!(refused("obprm", setting).is_some(), "{setting}");
    }
    for setting in ["bands=-1", "far=-1", "far=9999999999", "sigma=1", "turns=near", "salvage=often"] {
        assert!(refused("obstacle-geometry-prm", setting).is_some(), "{setting}");
    }
    for (name, setting) in
        [("gaussian-prm", "sigma=0"), ("bridge-prm", "uniform=-1"), ("gaussian-prm", "sigma=900")]
    {
        assert!(refused(name, setting).is_some(), "{name} {setting}");
    }
    let unconnected = refused("prm", "straight=no").unwrap();
    assert!(unconnected.to_string().contains("cannot be connected"), "{unconnected}");
    let within = Reachable { neighbours: 5, radius: 1.0, cycles: false };
    let none = ConnectionStages { among: NeighborSet::EachObstacle(0), ..ConnectionStages::default() };
    assert!(StagedConnector::new(within, none).is_err());
    let beyond = ConnectionStages { turns: Turns::At(vec![0.5, 1.5]), ..ConnectionStages::default() };
    assert!(StagedConnector::new(within, beyond).is_err());
    // Tables and defaults agree.
    let defaults = |info: PlannerInfo| {
        Settings::parse(info.parameters.iter().map(|p| format!("{}={}", p.name, p.default))).unwrap()
    };
    assert_eq!(OnSurfaces::read(&defaults(obprm::INFO)).unwrap(), OnSurfaces::default());
    assert_eq!(ByGeometry::read(&defaults(obstacle_geometry_prm::INFO)).unwrap(), ByGeometry::default());
}

/// Erased problems of rows are planned as generic ones of states, to the bit: every planner, alone and by a
/// team.
#[test]
fn erased_problems_are_planned_the_same() {
    let (space, robot) = (plane(), corridor(0.3));
    let (rows, placed) = (AsVectors(space.clone()), OnVectors::<_, Se2State>::new(robot.clone()));
    let any = AnySpace::new(&rows);
    let erased = || {
        let check: AnyCheck<'_, Configuration> =
            Box::new(Certified::new(&rows, placed.clone(), TOLERANCE).unwrap());
        let verifier = Verifier::with_tolerance(&space, &robot, 0.2 * TOLERANCE).unwrap();
        let verifier = OnVectors::<_, Se2State>::new(verifier);
        let [start, goal] = ends().map(|q| Configuration::of(&q));
        Ok(knowing(Problem::new(&any, Straight::new(&any, check), verifier, start, goal)?, &placed))
    };
    for info in planners() {
        for checkers in [1, 2] {
            let workers = || Workers::new(checkers).unwrap();
            let settings = Settings::default();
            let parallel = ParallelProblem::new(workers(), checkers, || Ok(problem(&space, &robot))).unwrap();
            let mut one =
                build_with(info.name, parallel, <Se2 as DefaultNn>::Nn::default(), &settings).unwrap();
            let parallel = ParallelProblem::new(workers(), checkers, erased).unwrap();
            let mut other =
                mp_roadmap::erased::build(info.name, parallel, AnyIndex::of(&rows), &settings).unwrap();
            assert!(found(&mut *one) == found(&mut *other), "{} {checkers}", info.name);
        }
    }
}

/// What a planner finds, in rows, and what it did for it.
fn found<S: StateVector>(
    planner: &mut dyn HasRoadmap<S, ()>,
) -> (Result<Vec<Configuration>, StopReason>, Progress, Vec<Configuration>, usize) {
    let rows = |states: &[S]| states.iter().map(Configuration::of).collect::<Vec<_>>();
    let outcome = match planner.solve(&mut Rng::seed(5), &mut Iterations(3_000), &mut ()) {
        Outcome::Solved(path) => Ok(rows(&path.states)),
        Outcome::Stopped(reason) => Err(reason),
    };
    (outcome, planner.progress(), rows(planner.map().states()), planner.map().edges())
}
