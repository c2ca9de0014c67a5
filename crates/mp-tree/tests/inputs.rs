//! Planners that move by a set of inputs.

mod common;
use common::*;
use mp_cspace::inputs::*;
use mp_cspace::*;
use mp_tree::*;
use nalgebra::{SVector, Vector2};

type Point = Vector2<f64>;
type Moving = (Point, Point);

/// What a run came to: the path, and what the local planner counted.
type Run<S, E> = (Path<S, E>, InputCounters, Progress);

fn tuning(step: f64) -> Tuning {
    Tuning { step: Step::Length(step), ..Tuning::default() }
}

/// A point moved by velocities among boxes, straight edges that remember their input.
fn plan_positions<C>(space: &C, boxes: &Boxes<2>, order: Order, seed: u64) -> Run<Point, Leg<SVector<f64, 2>>>
where
    C: DefaultNn + Space<State = Point>,
{
    let flow = Kinematic::new(space).unwrap();
    let check = Certified::new(space, boxes.clone(), 1e-3).unwrap();
    let inputs = InputSet::grid([0.1, 0.1], 5).unwrap();
    let mut local =
        InputPlanner::new(space, flow, inputs, 0.7, Recorded(Straight::new(space, check))).unwrap();
    let verifier = ReplayMotions::new(flow, Exact(boxes.clone()));
    let goal = Goals::region(Ball::new(space, Point::new(0.9, 0.2), 0.05).unwrap())
        .with_sampler(Exactly(Point::new(0.9, 0.2)));
    let problem = Problem::new(space, &mut local, verifier, Point::new(0.1, 0.2), goal).unwrap();
    let (path, progress) = match order {
        Order::TestAll => run(RrtInputs::new(problem, tuning(0.1)).unwrap(), seed),
        Order::SortFirst => run(Rsrt::new(problem, tuning(0.1)).unwrap(), seed),
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
    fn both<C: DefaultNn + Space<State = Point>>(space: &C) {
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
            let check = Along::new(&space, valid.clone(), Resolution::Fraction(0.005)).unwrap();
            let inputs = InputSet::grid([1.0, 1.0], 3).unwrap();
            let mut local = InputPlanner::new(&space, flow, inputs, 0.2, check).unwrap();
            let fine = Resolution::Fraction(0.0005);
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

/// No two nodes are on top of each other, though inputs lead back and forth.
#[test]
fn nodes_are_not_stacked() {
    let space = square();
    let flow = Kinematic::new(&space).unwrap();
    let check = Certified::new(&space, Boxes::default(), 1e-3).unwrap();
    let inputs = InputSet::axes([0.1, 0.1]).unwrap();
    let local = InputPlanner::new(&space, flow, inputs, 1.0, Between(Straight::new(&space, check))).unwrap();
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
        let local = Straight::new(&space, Certified::new(&space, boxes.clone(), 1e-3).unwrap());
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
        for bad in ["levels=0", "levels=21", "inputs=9999999999", "step=0", "step=2"] {
            let error = build(name, problem(), &Settings::parse([bad]).unwrap()).map(drop).unwrap_err();
            assert!(matches!(error, BuildError::OutOfRange { .. }), "{bad}: {error}");
        }
        assert!(build(name, problem(), &Settings::parse(["inputs=some"]).unwrap()).is_err());
    }
    assert!(build("rrt", problem(), &Settings::parse(["inputs=3"]).unwrap()).is_err());
}
