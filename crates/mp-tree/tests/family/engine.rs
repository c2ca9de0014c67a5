//! What the engine promises: stops, resumption, reproduction, events, goals, no duplicates.

use crate::common::*;
use mp_cspace::registry::Settings;
use mp_cspace::*;
use mp_tree::*;
use nalgebra::Vector2;

type Point = Vector2<f64>;
type Local<'c> = Straight<'c, Rn<2>, mp_cspace::erased::AnyCheck<'c, Vector2<f64>>>;

fn local<'c>(space: &'c Rn<2>, boxes: &Boxes<2>) -> Local<'c> {
    certified(space, boxes.clone(), 1e-3)
}

fn problem<'c>(
    space: &'c Rn<2>,
    boxes: &Boxes<2>,
    goal: impl Into<Goals<'c, Point>>,
) -> Problem<'c, Rn<2>, Local<'c>> {
    let (local, verifier) = (local(space, boxes), Exact(boxes.clone()));
    let problem = Problem::new(space, local, verifier, Point::new(0.1, 0.2), goal).unwrap();
    problem.with_obstacles(knowledge(space, boxes))
}

fn short() -> Tuning {
    Tuning { step: Length::Absolute(0.05), ..Tuning::default() }
}

fn any<'c>(name: &str, problem: Problem<'c, Rn<2>, Local<'c>>) -> AnyPlanner<'c, Point, ()> {
    build_with(name, problem, KdTree::<2>::new(), &Settings::parse(["step=0.05"]).unwrap()).unwrap()
}

fn goal() -> Point {
    Point::new(0.9, 0.2)
}

fn closed() -> Boxes<2> {
    hollow([0.9, 0.2], 0.05, 0.02, 0.0)
}

#[test]
fn budgets_are_kept_exactly() {
    let (space, boxes) = (square(), closed());
    for info in planners() {
        for n in [0, 1, 7, 500] {
            let mut planner = any(info.name, problem(&space, &boxes, goal()));
            let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(n), &mut ());
            assert_eq!(outcome, Outcome::Stopped(StopReason::Iterations));
            assert_eq!(planner.progress().iterations, n);
        }
        let mut planner = any(info.name, problem(&space, &boxes, goal()));
        let outcome = planner.solve(&mut Rng::seed(1), &mut Nodes(300), &mut ());
        assert_eq!(outcome, Outcome::Stopped(StopReason::Nodes));
        // RRT adds at most one node per iteration; a connection adds several.
        assert!(planner.progress().nodes >= 300 && (info.name != "rrt" || planner.progress().nodes == 300));
        let mut planner = any(info.name, problem(&space, &boxes, goal()));
        let outcome = planner.solve(&mut Rng::seed(1), &mut Motions(300), &mut ());
        assert_eq!(outcome, Outcome::Stopped(StopReason::Motions));
        assert!(planner.progress().motions >= 300);
    }
}

/// The goal is in a closed cell, where hardly any step is free: the tree from the start waits for the one
/// inside, if it is to.
#[test]
fn a_balanced_tree_waits_for_a_smaller_one() {
    let (space, boxes) = (square(), closed());
    let sizes = |balance: f64| {
        let tuning = Tuning { balance, ..short() };
        let mut planner =
            RrtConnect::with_index(problem(&space, &boxes, goal()), Linear::new(), tuning).unwrap();
        planner.solve(&mut Rng::seed(1), &mut Iterations(2000), &mut ());
        planner.trees().map(Tree::len)
    };
    let ([outside, inside], [waiting, ahead]) = (sizes(0.0), sizes(1.0));
    assert!(outside > 10 * inside, "{outside} {inside}");
    assert!(waiting < ahead + 40 && outside > 5 * waiting, "{waiting} {ahead} {outside}");
    // Where it may be three times as large, it is.
    let [waiting, ahead] = sizes(3.0);
    assert!(waiting > 2 * ahead && waiting < 3 * ahead + 40, "{waiting} {ahead}");
}

#[test]
fn going_on_equals_one_long_run() {
    let (space, boxes) = (square(), slit(0.1, 0.8, 0.04));
    for info in planners() {
        for seed in 0..5 {
            let mut whole = any(info.name, problem(&space, &boxes, goal()));
            let once = whole.solve(&mut Rng::seed(seed), &mut Iterations(100_000), &mut ());
            assert!(matches!(once, Outcome::Solved(_)));
            let mut parts = any(info.name, problem(&space, &boxes, goal()));
            let mut rng = Rng::seed(seed);
            let mut budget = 0;
            let resumed = loop {
                budget += 37;
                match parts.solve(&mut rng, &mut Iterations(budget), &mut ()) {
                    Outcome::Stopped(_) => assert_eq!(parts.progress().iterations, budget),
                    solved => break solved,
                }
            };
            assert_eq!(once, resumed);
            assert_eq!(whole.progress(), parts.progress());
        }
    }
}

#[test]
fn a_seed_is_a_path() {
    let (space, boxes) = (square(), slit(0.1, 0.8, 0.04));
    for info in planners() {
        let solve = |seed| {
            let mut planner = any(info.name, problem(&space, &boxes, goal()));
            let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(100_000), &mut ());
            (outcome, planner.progress())
        };
        assert_eq!(solve(1), solve(1));
        assert_ne!(solve(1), solve(2));
    }
}

/// Rebuilds the trees from events alone.
#[derive(Default)]
struct Copycat(Vec<Vec<(Point, Option<NodeId>)>>);

impl Observer<Point> for Copycat {
    fn on(&mut self, event: Event<'_, Point>) {
        self.0.resize(2, Vec::new());
        match event {
            Event::Rooted { tree, id, state, .. } => {
                assert_eq!(id as usize, self.0[tree].len());
                self.0[tree].push((*state, None));
            }
            Event::Added { tree, id, parent, state, .. } => {
                assert_eq!(id as usize, self.0[tree].len());
                self.0[tree].push((*state, Some(parent)));
            }
            Event::Pruned { tree, survivors } => {
                let old = std::mem::take(&mut self.0[tree]);
                let renamed = |id| survivors.binary_search(&id).unwrap() as NodeId;
                self.0[tree] = survivors
                    .iter()
                    .map(|&id| (old[id as usize].0, old[id as usize].1.map(renamed)))
                    .collect();
            }
            _ => {}
        }
    }
}

fn assert_same(tree: &Tree<Point, ()>, copy: &[(Point, Option<NodeId>)]) {
    let nodes: Vec<_> = (0..tree.len() as NodeId).map(|id| (*tree.state(id), tree.parent(id))).collect();
    assert_eq!(nodes, copy);
}

/// A discrete check so coarse that candidates are refuted and pruned now and then.
fn coarse<'c>(space: &'c Rn<2>, boxes: &Boxes<2>) -> Problem<'c, Rn<2>, Local<'c>> {
    let check = Discrete::new(space, boxes.clone(), Length::Absolute(0.05)).unwrap();
    let ends = [Point::new(0.1, 0.1), Point::new(0.9, 0.1)];
    Problem::new(space, checked(space, check), Exact(boxes.clone()), ends[0], ends[1]).unwrap()
}

#[test]
fn events_tell_the_whole_story() {
    let (space, boxes) = (square(), slit(1e-3, 0.95, 0.05));
    let tuning = Tuning { patience: u64::MAX, ..short() };
    let mut rrt = Rrt::with_index(coarse(&space, &boxes), Linear::new(), tuning).unwrap();
    let mut copy = Copycat::default();
    rrt.solve(&mut Rng::seed(1), &mut Iterations(2_000), &mut copy);
    assert!(rrt.progress().rejected > 0);
    assert_same(rrt.tree(), &copy.0[0]);

    let mut connect = RrtConnect::with_index(coarse(&space, &boxes), Linear::new(), tuning).unwrap();
    let mut copy = Copycat::default();
    connect.solve(&mut Rng::seed(1), &mut Iterations(2_000), &mut copy);
    assert!(connect.progress().rejected > 0);
    for (tree, copy) in connect.trees().iter().zip(&copy.0) {
        assert_same(tree, copy);
    }
    assert_eq!(connect.progress().nodes, copy.0[0].len() + copy.0[1].len());
}

fn assert_no_duplicates(tree: &Tree<Point, ()>) {
    let mut bits: Vec<_> = tree.states().iter().map(|q| [q.x.to_bits(), q.y.to_bits()]).collect();
    bits.sort_unstable();
    assert!(bits.windows(2).all(|pair| pair[0] != pair[1]), "two nodes have the same state");
}

#[test]
fn no_tree_holds_a_state_twice() {
    let space = square();
    let boxes = Boxes::default();
    for goal_bias in [0.05, 1.0] {
        let tuning = Tuning { goal_bias, ..short() };
        let mut rrt = Rrt::with_index(problem(&space, &boxes, goal()), Linear::new(), tuning).unwrap();
        let mut connect =
            RrtConnect::with_index(problem(&space, &boxes, goal()), Linear::new(), tuning).unwrap();
        let (mut a, mut b) = (Rng::seed(1), Rng::seed(1));
        for _ in 0..2_000 {
            rrt.step(&mut a, &mut ());
            connect.step(&mut b, &mut ());
        }
        assert_no_duplicates(rrt.tree());
        connect.trees().into_iter().for_each(assert_no_duplicates);
        if goal_bias == 1.0 {
            assert_eq!(rrt.tree().len(), 2, "aiming at a goal that is a node adds nothing");
        }
    }
}

/// Moves on the integer grid only, so that moves from different nodes end on the same states.
#[derive(Clone, Debug)]
struct Grid;

impl LocalPlanner<Point> for Grid {
    type Edge = ();
    fn extend(&mut self, from: &Point, toward: &Point, _: Direction, reach: Reach) -> Extension<Point, ()> {
        let ways = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]].map(|d| from + Point::from(d));
        let away = |q: &Point| (q - toward).norm();
        let end = ways.into_iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        match (reach, end) {
            (Reach::Step(_), Some(end)) if end == *toward => {
                Extension::Reached(Motion { end, edge: (), cost: 1.0 })
            }
            (Reach::Step(_), Some(end)) => Extension::Advanced(Motion { end, edge: (), cost: 1.0 }),
            _ => Extension::Trapped,
        }
    }
}

#[test]
fn finitely_many_moves_make_no_duplicates_either() {
    let space = Rn::<2>::new([0.0; 2], [10.0; 2]).unwrap();
    let parts = TreePlannerParts {
        target_sampler: Samples(Uniform(&space)),
        selector: NearestSelector(Linear::new()),
        extender: Extend,
        inserter: AppendDistinct::default(),
        tuning: Tuning { step: Length::Absolute(1.0), ..Tuning::default() },
    };
    let never = Goals::region(|_: &Point| false);
    let start = Point::new(5.0, 5.0);
    let free = Exact(Boxes::default());
    let problem = Problem::new(&space, Grid, free, start, never).unwrap();
    let mut planner = SingleTree::assemble(problem, parts).unwrap();
    planner.solve(&mut Rng::seed(1), &mut Iterations(5_000), &mut ());
    assert_no_duplicates(planner.tree());
    // The grid is 11 by 11; a move outside it from a border node may add a ring.
    assert!((80..=169).contains(&planner.tree().len()), "{}", planner.tree().len());
}

/// Straight motions that remember their ends, in forward time; `gain` is what x must gain.
pub(crate) struct Remembers<'c> {
    pub(crate) straight: Local<'c>,
    pub(crate) gain: f64,
}

impl<'c> Remembers<'c> {
    pub(crate) fn new(straight: Local<'c>) -> Self {
        Self { straight, gain: f64::NEG_INFINITY }
    }
}

impl LocalPlanner<Point> for Remembers<'_> {
    type Edge = [Point; 2];
    fn extend(
        &mut self,
        from: &Point,
        toward: &Point,
        direction: Direction,
        reach: Reach,
    ) -> Extension<Point, [Point; 2]> {
        let with_edge = |motion: Motion<Point, ()>| Motion {
            end: motion.end,
            edge: match direction {
                Direction::Forward => [*from, motion.end],
                Direction::Backward => [motion.end, *from],
            },
            cost: motion.cost,
        };
        match self.straight.extend(from, toward, direction, reach) {
            Extension::Advanced(m) | Extension::Reached(m) if m.end.x - from.x < self.gain => {
                Extension::Trapped
            }
            Extension::Trapped => Extension::Trapped,
            Extension::Advanced(motion) => Extension::Advanced(with_edge(motion)),
            Extension::Reached(motion) => Extension::Reached(with_edge(motion)),
        }
    }
}

/// Demands that edges are what they claim.
struct Replays(Boxes<2>);

impl Verify<Point, [Point; 2]> for Replays {
    fn verify_state(&mut self, _: &Point) -> MotionCheck {
        MotionCheck::Free { clearance: 0.0 }
    }
    fn verify_edge(&mut self, from: &Point, edge: &[Point; 2], to: &Point) -> MotionCheck {
        assert_eq!([*from, *to], *edge);
        Exact(self.0.clone()).check_motion(from, to)
    }
}

type Remembered<'c> = AnyPlanner<'c, Point, [Point; 2]>;

const REMEMBERING: [&str; 14] = [
    "rrt",
    "rrt-connect",
    "bi-rrt",
    "rrt-con-ext",
    "rrt-con-con",
    "rrt-star",
    "informed-rrt-star",
    "aorrtc",
    "dd-rrt",
    "add-rrt",
    "mvb-rrt",
    "utility-rrt",
    "cyclic-rrt",
    "obrrt",
];

/// Planners by type, of a local planner that no planner by name has.
fn remembering<'c>(
    name: &str,
    problem: Problem<'c, Rn<2>, Remembers<'c>>,
    boxes: &Boxes<2>,
    tuning: Tuning,
) -> Result<Remembered<'c>, BuildError> {
    let index = Linear::new();
    Ok(match name {
        "rrt" => Box::new(Rrt::with_index(problem, index, tuning)?),
        "rrt-connect" => Box::new(RrtConnect::with_index(problem, index, tuning)?),
        "bi-rrt" => Box::new(BiRrt::with_index(problem, index, tuning)?),
        "rrt-con-ext" => Box::new(RrtConExt::with_index(problem, index, tuning)?),
        "rrt-con-con" => Box::new(RrtConCon::with_index(problem, index, tuning)?),
        "rrt-star" => Box::new(RrtStar::with_index(problem, index, tuning, Near::default())?),
        "informed-rrt-star" => {
            Box::new(InformedRrtStar::with_index(problem, index, tuning, Near::default())?)
        }
        "aorrtc" => Box::new(Aorrtc::with_index(problem, index, tuning)?),
        "dd-rrt" => Box::new(DdRrt::with_index(problem, index, tuning, Domain::fixed())?),
        "add-rrt" => Box::new(DdRrt::with_index(problem, index, tuning, Domain::adaptive())?),
        "mvb-rrt" => Box::new(MvbRrt::with_index(problem, index, tuning, 5)?),
        "utility-rrt" => Box::new(UtilityRrt::with_index(problem, index, tuning, 4)?),
        "cyclic-rrt" => Box::new(CyclicRrt::new(problem, tuning, 0.0)?),
        _ => Box::new(Obrrt::with_index(problem, index, boxes.clone(), tuning, GrowthWeights::default())?),
    })
}

#[test]
fn edges_are_in_forward_time() {
    let (space, boxes) = (square(), slit(0.1, 0.8, 0.1));
    for name in REMEMBERING {
        for patience in [0, 10] {
            let local = Remembers::new(local(&space, &boxes));
            let start = Point::new(0.1, 0.2);
            let problem = Problem::new(&space, local, Replays(boxes.clone()), start, goal()).unwrap();
            let mut planner = remembering(name, problem, &boxes, Tuning { patience, ..short() }).unwrap();
            let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(50_000), &mut ());
            let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
            for (pair, edge) in path.states.windows(2).zip(&path.edges) {
                assert_eq!(pair, edge);
            }
        }
    }
}

fn solve<'c>(name: &str, problem: Problem<'c, Rn<2>, Local<'c>>) -> Path<Point> {
    let mut planner = any(name, problem);
    match planner.solve(&mut Rng::seed(1), &mut Iterations(50_000), &mut ()) {
        Outcome::Solved(path) => path,
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn goal_sets_of_every_kind() {
    let (space, boxes) = (square(), slit(0.1, 0.8, 0.1));
    let good = [Point::new(0.9, 0.2), Point::new(0.9, 0.9)];
    let (in_wall, outside) = (Point::new(0.5, 0.2), Point::new(1.5, 0.2));
    for info in planners() {
        let listed = Goals::states([in_wall, good[0], outside, good[1], good[1]]);
        let path = solve(info.name, problem(&space, &boxes, listed));
        assert!(good.contains(path.states.last().unwrap()));

        let ball = Ball::new(&space, good[0], 0.05).unwrap();
        let sampled = Goals::region(ball.clone()).with_sampler(ball.clone());
        let path = solve(info.name, problem(&space, &boxes, sampled));
        assert!(ball.reached(path.states.last().unwrap()));

        // Most of these samples are in the wall: no roots, and no goals.
        let strip = |rng: &mut Rng| Point::new(0.45 + 0.11 * space.sample_uniform(rng).x, 0.2);
        let path = solve(info.name, problem(&space, &boxes, Goals::sampled(FromFn(strip))));
        assert!(boxes.distance(path.states.last().unwrap()) > 0.0);

        let here = solve(info.name, problem(&space, &boxes, Point::new(0.1, 0.2)));
        assert_eq!(here, Path { states: vec![Point::new(0.1, 0.2)], edges: vec![] });
    }
    let region = Goals::region(|q: &Point| q.x > 0.8);
    assert!(solve("rrt", problem(&space, &boxes, region)).states.last().unwrap().x > 0.8);
    let already = Goals::region(|q: &Point| q.x < 0.8);
    assert_eq!(solve("rrt", problem(&space, &boxes, already)).states.len(), 1);
}

struct FromFn<F>(F);

impl<F: FnMut(&mut Rng) -> Point> Sampler<Point> for FromFn<F> {
    fn sample(&mut self, rng: &mut Rng) -> Point {
        (self.0)(rng)
    }
}

#[test]
fn a_solved_planner_goes_on() {
    let (space, boxes) = (square(), slit(0.1, 0.8, 0.1));
    for info in planners() {
        let mut planner = any(info.name, problem(&space, &boxes, goal()));
        let mut rng = Rng::seed(1);
        for _ in 0..3 {
            let budget = planner.progress().iterations + 50_000;
            let Outcome::Solved(path) = planner.solve(&mut rng, &mut Iterations(budget), &mut ()) else {
                panic!("{}", info.name)
            };
            assert_path(&space, &path, &Point::new(0.1, 0.2), |q| *q == goal(), |q| boxes.distance(q) > 0.0);
        }
    }
}

#[test]
fn a_tiny_step_does_not_keep_a_planner_from_its_stop() {
    let (space, boxes) = (square(), slit(0.1, 0.8, 0.1));
    let tuning = Tuning { step: Length::Absolute(1e-7), ..Tuning::default() };
    let problem = problem(&space, &boxes, goal());
    let mut planner = RrtConnect::with_index(problem, Nothing, tuning).unwrap();
    planner.solve(&mut Rng::seed(1), &mut Iterations(3), &mut ());
    assert!(planner.progress().nodes <= 3 * 10_001 + 2);
}

/// An index that knows only the first node.
#[derive(Clone, Debug)]
struct Nothing;

impl<C: Space> NearestNeighbors<C> for Nothing {
    fn inserted(&mut self, _: &C, _: &[C::State], _: NodeId) {}
    fn clear(&mut self) {}
    fn nearest(&self, space: &C, points: &[C::State], q: &C::State) -> Option<Hit> {
        points.first().map(|p| Hit { id: 0, distance: space.distance(p, q) })
    }
    fn k_nearest(&self, space: &C, points: &[C::State], q: &C::State, _: usize, out: &mut Vec<Hit>) {
        out.clear();
        out.extend(self.nearest(space, points, q));
    }
    fn within(&self, _: &C, _: &[C::State], _: &C::State, _: f64, out: &mut Vec<Hit>) {
        out.clear();
    }
}
