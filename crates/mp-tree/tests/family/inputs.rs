//! Planners that move by a set of inputs.

use crate::common::*;
use mp_control::*;
use mp_cspace::erased::AnySpace;
use mp_cspace::registry::Settings;
use mp_cspace::*;
use mp_tree::*;
use nalgebra::{SVector, Vector2};

type Point = Vector2<f64>;
type Moving = (Point, Point);

/// What a run came to: the path, and what the local planner counted.
type Run<S, E> = (Path<S, E>, InputCounters, Progress);

fn tuning(step: f64) -> Tuning {
    Tuning { step: Length::Absolute(step), ..Tuning::default() }
}

/// What planners ask of motions of a point by velocities.
trait Moves: LocalPlanner<Point, Edge = ControlSegment<Point>> + InputChoice {}
impl<L: LocalPlanner<Point, Edge = ControlSegment<Point>> + InputChoice> Moves for L {}

/// A point moved by velocities among boxes, straight edges that remember their input.
fn plan_positions<C>(
    space: &C,
    boxes: &Boxes<2>,
    order: Order,
    seed: u64,
) -> Run<Point, ControlSegment<SVector<f64, 2>>>
where
    C: DefaultNn<Nn: 'static> + Space<State = Point> + Clone + Send + 'static,
{
    let flow = Kinematic::new(space).unwrap();
    let check = Certified::new(space, boxes.clone(), 1e-3).unwrap();
    let inputs = InputSet::grid([0.1, 0.1], 5).unwrap();
    let mut local =
        InputPlanner::new(space, flow, inputs, 0.7, RecordedFlowCheck(Straight::new(space, check))).unwrap();
    let verifier = ReplayMotions::new(flow, Exact(boxes.clone()));
    let goal = Goals::region(Ball::new(space, Point::new(0.9, 0.2), 0.05).unwrap())
        .with_sampler(Exactly(Point::new(0.9, 0.2)));
    // Erased, so that the planners are compiled once for all metrics.
    let (any, index) = (AnySpace::new(space), AnyIndex::of(space));
    let moves: &mut dyn Moves = &mut local;
    let problem = Problem::new(&any, moves, verifier, Point::new(0.1, 0.2), goal).unwrap();
    let (path, progress) = match order {
        Order::TestAll => run(RrtInputs::with_index(problem, index, tuning(0.1)).unwrap(), seed),
        Order::SortFirst => run(Rsrt::with_index(problem, index, tuning(0.1)).unwrap(), seed),
    };
    for (pair, leg) in path.states.windows(2).zip(&path.edges) {
        assert_eq!(flow.integrate(&pair[0], &leg.input, leg.duration), pair[1], "an edge does not run again");
        assert!(!boxes.hit(&pair[0], &pair[1]));
    }
    assert!((path.states[path.states.len() - 1] - Point::new(0.9, 0.2)).norm() < 0.1);
    (path, local.counters(), progress)
}

fn run<S, P: Planner<S>>(mut planner: P, seed: u64) -> (Path<S, P::Edge>, Progress) {
    let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(50_000), &mut ());
    let Outcome::Solved(path) = outcome else { panic!("seed {seed}: {:?}", planner.progress()) };
    (path, planner.progress())
}

#[test]
fn positions_under_every_metric_by_fewer_tests() {
    fn both<C>(space: &C)
    where
        C: DefaultNn<Nn: 'static> + Space<State = Point> + Clone + Send + 'static,
    {
        let boxes = slit(0.2, 0.8, 0.1);
        for seed in 0..4 {
            let rates = [Order::TestAll, Order::SortFirst].map(|order| {
                let (path, counters, _) = plan_positions(space, &boxes, order, seed);
                assert_eq!(plan_positions(space, &boxes, order, seed).0, path, "not reproducible");
                counters.tested as f64 / counters.expansions as f64
            });
            assert!(rates[1] < 0.5 * rates[0], "tests per expansion: {rates:?}");
        }
    }
    both(&square());
    both(&WithMetric::new(square(), Manhattan));
    both(&WithMetric::new(square(), ScaledEuclidean::new(&square(), [1.0, 2.0]).unwrap()));
}

#[test]
fn velocities_by_accelerations() {
    let space = Product::with_velocity(square(), [0.5, 0.5]).unwrap();
    let boxes = slit(0.1, 0.7, 0.2);
    let flow = DoubleIntegrator::new(space.spaces().0).unwrap();
    for seed in 0..3 {
        for order in [Order::TestAll, Order::SortFirst] {
            let valid = OnPosition(boxes.clone());
            let check = DiscreteFlowCheck::new(&space, valid.clone(), Length::Fraction(0.005)).unwrap();
            let inputs = InputSet::grid([1.0, 1.0], 3).unwrap();
            let mut local = InputPlanner::new(&space, flow, inputs, 0.2, check).unwrap();
            let fine = Length::Fraction(0.0005);
            let verifier = ReplayFinely::new(&space, flow, valid, fine).unwrap();
            let goal = Goals::region(|(q, _): &Moving| (q - Point::new(0.9, 0.2)).norm() < 0.1);
            let start = (Point::new(0.1, 0.2), Point::zeros());
            let problem = Problem::new(&space, &mut local, verifier, start, goal).unwrap();
            let path = match order {
                Order::TestAll => run(RrtInputs::new(problem, Tuning::default()).unwrap(), seed).0,
                Order::SortFirst => run(Rsrt::new(problem, Tuning::default()).unwrap(), seed).0,
            };
            // By the equations of motion, densely.
            let mut boxes = boxes.clone();
            for (pair, leg) in path.states.windows(2).zip(&path.edges) {
                let (q, v) = pair[0];
                for i in 0..=200 {
                    let t = leg.duration * f64::from(i) / 200.0;
                    let p = q + v * t + leg.input * (0.5 * t * t);
                    assert!(boxes.is_valid(&p) && space.spaces().0.contains(&p), "{p:?}");
                }
                assert!((pair[1].1 - (v + leg.input * leg.duration)).norm() < 1e-15);
                assert!(pair[1].1.amax() <= 0.5);
            }
        }
    }
}

/// The order changes the number of tests and nothing else; the condition changes the tree; both names have
/// all four corners.
#[test]
fn four_corners() {
    let (space, boxes) = (square(), slit(0.2, 0.8, 0.1));
    let mut other_trees = 0;
    for seed in 0..6 {
        let come = |name: &str, settings: &[&str]| {
            let all = ["step=0.1", "inputs=12"].iter().chain(settings).copied();
            let local = certified(&space, boxes.clone(), 1e-3);
            let (start, goal) = (Point::new(0.1, 0.2), Point::new(0.93, 0.27));
            let problem = Problem::new(&space, local, Exact(boxes.clone()), start, goal).unwrap();
            let mut planner = build(name, problem, &Settings::parse(all).unwrap()).unwrap();
            let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(50_000), &mut ());
            assert!(matches!(outcome, Outcome::Solved(_)), "{name} {settings:?}");
            let mut progress = planner.progress();
            // How many motions were tested is what differs.
            progress.motions = 0;
            (outcome, progress)
        };
        for accept in ["accept=nearer", "accept=any"] {
            let all = come("rrt-inputs", &["order=test-all", accept]);
            for name in ["rrt-inputs", "rsrt"] {
                assert_eq!(come(name, &["order=sort-first", accept]), all, "{accept}");
            }
        }
        let corners = [come("rrt-inputs", &[]), come("rsrt", &[])];
        assert_eq!(corners[0], come("rsrt", &["order=test-all", "accept=nearer"]));
        assert_eq!(corners[1], come("rrt-inputs", &["order=sort-first", "accept=any"]));
        other_trees += u32::from(corners[0] != corners[1]);
    }
    assert!(other_trees > 0, "the condition changed nothing");
}

/// No two nodes are on top of each other, though inputs lead back and forth.
#[test]
fn nodes_are_not_stacked() {
    let space = square();
    let flow = Kinematic::new(&space).unwrap();
    let check = Certified::new(&space, Boxes::default(), 1e-3).unwrap();
    let inputs = InputSet::axes([0.1, 0.1]).unwrap();
    let local =
        InputPlanner::new(&space, flow, inputs, 1.0, LocalFlowCheck(Straight::new(&space, check))).unwrap();
    let nowhere = Goals::region(|_: &Point| false);
    let problem =
        Problem::new(&space, local, Exact(Boxes::default()), Point::new(0.51, 0.52), nowhere).unwrap();
    let mut planner = Rsrt::new(problem, Tuning::default()).unwrap();
    let mut rng = Rng::seed(1);
    for _ in 0..5000 {
        planner.step(&mut rng, &mut ());
    }
    let states = planner.tree().states();
    // A grid of ten by ten, and no more.
    assert!(states.len() > 90 && states.len() <= 100, "{}", states.len());
    for (i, a) in states.iter().enumerate() {
        assert!(states[..i].iter().all(|b| (a - b).norm() > 0.05));
    }
}

#[test]
fn by_name_goals_are_reached_exactly_and_settings_checked() {
    let space = square();
    let boxes: Boxes<2> = slit(0.2, 0.8, 0.1);
    let (start, goal) = (Point::new(0.1, 0.2), Point::new(0.93, 0.27));
    let problem = || {
        let local = certified(&space, boxes.clone(), 1e-3);
        Problem::new(&space, local, Exact(boxes.clone()), start, goal).unwrap()
    };
    for name in ["rsrt", "rrt-inputs"] {
        for inputs in ["inputs=0", "inputs=16"] {
            let settings = Settings::parse(["step=0.1", inputs, "levels=2"]).unwrap();
            let mut planner = build(name, problem(), &settings).unwrap();
            let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(50_000), &mut ());
            let Outcome::Solved(path) = outcome else { panic!("{name} {inputs}: {outcome:?}") };
            assert_path(&space, &path, &start, |q| *q == goal, |q| boxes.distance(q) > 0.0);
            let longest = path.states.windows(2).map(|w| (w[1] - w[0]).norm()).fold(0.0, f64::max);
            assert!(longest <= 0.1 + 1e-12, "{longest}");
        }
        for bad in ["levels=0", "levels=21", "inputs=9999999999", "step=2"] {
            let error = build(name, problem(), &Settings::parse([bad]).unwrap()).map(drop).unwrap_err();
            assert!(matches!(error, BuildError::OutOfRange { .. }), "{bad}: {error}");
        }
        for bad in ["inputs=some", "order=any", "accept=all", "step=0"] {
            assert!(build(name, problem(), &Settings::parse([bad]).unwrap()).is_err(), "{bad}");
        }
    }
    assert!(build("rrt", problem(), &Settings::parse(["inputs=3"]).unwrap()).is_err());
}

type Drawn<'c> = InputPlanner<
    'c,
    Rn<2>,
    Kinematic<'c, Rn<2>>,
    Point,
    RecordedFlowCheck<Straight<'c, Rn<2>, Certified<'c, Rn<2>, Boxes<2>>>>,
>;

/// A point that moves by eight inputs, to the right of the square.
fn drawn<'c>(space: &'c Rn<2>, boxes: &Boxes<2>) -> Problem<'c, Rn<2>, Drawn<'c>> {
    let flow = Kinematic::new(space).unwrap();
    let check = Straight::new(space, Certified::new(space, boxes.clone(), 1e-3).unwrap());
    let inputs = InputSet::spread([0.06, 0.06], 8).unwrap();
    let local = InputPlanner::new(space, flow, inputs, 1.0, RecordedFlowCheck(check)).unwrap();
    let verifier = ReplayMotions::new(flow, Exact(boxes.clone()));
    Problem::new(space, local, verifier, Point::new(0.2, 0.3), Goals::region(|q: &Point| q.x > 0.9)).unwrap()
}

/// No input is tried twice at a node, so no two children of one have the same.
fn each_once<E: PartialEq>(tree: &Tree<Point, ControlSegment<E>>) {
    for a in 0..tree.len() as u32 {
        for b in 0..a {
            let twice = tree.parent(a).is_some() && tree.parent(a) == tree.parent(b);
            assert!(!twice || tree.edge(a) != tree.edge(b), "{a} and {b} hang on the same input of one node");
        }
    }
}

#[test]
fn untried_inputs_lead_through_a_passage() {
    let space = square();
    let boxes: Boxes<2> = slit(0.1, 0.8, 0.1);
    for seed in 0..4 {
        let mut cvp = CvpRrt::new(drawn(&space, &boxes), Tuning::default()).unwrap();
        let mut rc = RcRrt::new(drawn(&space, &boxes), 0.015, Tuning::default()).unwrap();
        let outcomes = [
            cvp.solve(&mut Rng::seed(seed), &mut Iterations(50_000), &mut ()),
            rc.solve(&mut Rng::seed(seed), &mut Iterations(50_000), &mut ()),
        ];
        each_once(cvp.tree());
        each_once(rc.tree());
        for outcome in outcomes {
            let Outcome::Solved(path) = outcome else { panic!("seed {seed}: {outcome:?}") };
            assert!(path.states[path.states.len() - 1].x > 0.9);
            for (pair, leg) in path.states.windows(2).zip(&path.edges) {
                assert_eq!(pair[0] + leg.input, pair[1]);
                assert!(!boxes.hit(&pair[0], &pair[1]));
            }
        }
    }
}

#[test]
fn resolution_completeness_ends_where_there_is_no_path() {
    let space = square();
    let closed: Boxes<2> = Boxes(vec![([0.5, -1.0], [0.6, 2.0])]);
    let mut planner = RcRrt::new(drawn(&space, &closed), 0.02, Tuning::default()).unwrap();
    let mut rng = Rng::seed(1);
    let outcome = planner.solve(&mut rng, &mut Iterations(1_000_000), &mut ());
    assert_eq!(outcome, Outcome::Stopped(StopReason::Exhausted));
    let progress = planner.progress();
    assert!(progress.exhausted && progress.iterations < 50_000, "{progress:?}");
    each_once(planner.tree());
    // Asked again it says so again; a single step does no harm.
    let again = planner.solve(&mut rng, &mut Iterations(u64::MAX), &mut ());
    assert_eq!(again, Outcome::Stopped(StopReason::Exhausted));
    assert!(planner.step(&mut rng, &mut ()).is_none());
    assert_eq!(planner.progress().nodes, progress.nodes);
    // The nodes keep apart, parents and children aside.
    let tree = planner.tree();
    for a in 0..tree.len() as u32 {
        for b in 0..a {
            let kin = tree.parent(a) == Some(b) || tree.parent(b) == Some(a);
            assert!(kin || (tree.state(a) - tree.state(b)).norm() > 0.02);
        }
    }
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(RcRrt::new(drawn(&space, &closed), bad, Tuning::default()).is_err());
    }
}

#[test]
fn violations_are_passed_on_to_ancestors() {
    let space = square();
    let mut selector = LeastViolated::new(NearestSelector(Linear::new()), 4);
    let points = [Point::new(0.1, 0.1), Point::new(0.2, 0.1), Point::new(0.3, 0.1)];
    for (id, parent) in [(0, None), (1, Some(0)), (2, Some(1))] {
        selector.inserted(&space, &points[..=id as usize], id, parent);
    }
    let feedback = |selector: &mut LeastViolated<_>, id, grew| {
        Selector::<Rn<2>>::feedback(selector, id, Purpose::Explore, grew);
    };
    feedback(&mut selector, 2, false);
    assert_eq!([0, 1, 2].map(|id| selector.frequency(id)), [1.0 / 64.0, 1.0 / 16.0, 0.25]);
    feedback(&mut selector, 2, true);
    assert_eq!(selector.frequency(2), 0.25);
    for _ in 0..9 {
        feedback(&mut selector, 2, false);
    }
    assert_eq!(selector.frequency(2), 1.0);
    // Certain to fail: the next one is taken.
    let (mut out, mut rng) = (Vec::new(), Rng::seed(1));
    let mut taken = [0; 3];
    for _ in 0..1000 {
        selector.select(&space, &points, &points[2], Purpose::Explore, &mut rng, &mut out);
        out.iter().for_each(|hit| taken[hit.id as usize] += 1);
    }
    // Node 1 failed to 62.5 %, node 0 to 15.6 %: taken with the rest of the probability.
    assert!(taken[2] == 0 && (310..440).contains(&taken[1]) && (460..600).contains(&taken[0]), "{taken:?}");
    // Pruning renames parents.
    selector.pruned(&space, &[points[0], points[2]], &[0, 2]);
    assert_eq!(selector.frequency(1), 1.0);
    let before = selector.frequency(0);
    feedback(&mut selector, 1, false);
    assert_eq!(selector.frequency(0), before);
}
