//! Transition-based RRT: its paths cost less than those of RRT.

use crate::common::*;
use mp_cspace::registry::Settings;
use mp_cspace::*;
use mp_tree::*;
use nalgebra::Vector2;

type Point = Vector2<f64>;

/// A hill in the middle, on a slope.
fn hill(q: &Point) -> f64 {
    1.0 + q.x + 20.0 * mp_math::exp(-mp_math::powi((q - Point::new(0.5, 0.5)).norm() / 0.15, 2))
}

/// The mean cost along a path, and its mechanical work: the sum of what it climbs.
fn paid(path: &Path<Point>, cost: impl Fn(&Point) -> f64) -> (f64, f64) {
    let (mut sum, mut count, mut work) = (0.0, 0.0, 0.0);
    for pair in path.states.windows(2) {
        let steps = ((pair[1] - pair[0]).norm() / 1e-3).ceil();
        let along: Vec<f64> =
            (0..=steps as usize).map(|i| cost(&pair[0].lerp(&pair[1], i as f64 / steps))).collect();
        (sum, count) = (sum + along.iter().sum::<f64>(), count + along.len() as f64);
        work += along.windows(2).map(|two| (two[1] - two[0]).max(0.0)).sum::<f64>();
    }
    (sum / count, work)
}

fn solved(mut planner: impl Planner<Point, Edge = ()>, seed: u64) -> Path<Point> {
    match planner.solve(&mut Rng::seed(seed), &mut Iterations(50_000), &mut ()) {
        Outcome::Solved(path) => path,
        Outcome::Stopped(_) => panic!("seed {seed}: {:?}", planner.progress()),
    }
}

#[test]
fn it_goes_around_a_hill() {
    // What stands on the top keeps RRT from leaping over it.
    let (space, top) = (square(), Boxes(vec![([0.49, 0.49], [0.51, 0.51])]));
    let tuning = Tuning { step: Length::Absolute(0.05), ..Tuning::default() };
    let problem = || {
        let local = certified(&space, top.clone(), 1e-3);
        let (start, goal) = (Point::new(0.1, 0.5), Point::new(0.9, 0.5));
        Problem::new(&space, local, Exact(top.clone()), start, goal).unwrap()
    };
    let mut sums = [(0.0, 0.0); 2];
    for seed in 0..20 {
        let planner = TRrt::new(problem(), hill, tuning, Temperature::default()).unwrap();
        let rrt = Rrt::new(problem(), tuning).unwrap();
        for (sum, path) in sums.iter_mut().zip([solved(planner, seed), solved(rrt, seed)]) {
            let (mean, work) = paid(&path, hill);
            *sum = (sum.0 + mean / 20.0, sum.1 + work / 20.0);
        }
    }
    let [ours, plain] = sums;
    assert!(ours.0 < 0.6 * plain.0 && ours.1 < 0.5 * plain.1, "T-RRT {ours:?}, RRT {plain:?}");
}

/// By name, without a gradient: the states of the objective of the problem are compared.
#[test]
fn by_name_it_takes_the_objective() {
    let (space, settings) = (square(), Settings::parse(["step=0.05"]).unwrap());
    let mean = |name: &str, seed| {
        let (start, goal) = (Point::new(0.1, 0.5), Point::new(0.9, 0.5));
        let top = Boxes(vec![([0.49, 0.49], [0.51, 0.51])]);
        let local =
            Straight::new(&space, Discrete::new(&space, top.clone(), Length::Fraction(0.01)).unwrap());
        let objective = StateCostIntegral::new(&space, hill, 1.0, Length::Fraction(0.01)).unwrap();
        let problem = Problem::new(&space, local, Exact(top), start, goal).unwrap();
        paid(
            &solved(build(name, problem.with_objective(Box::new(objective)), &settings).unwrap(), seed),
            hill,
        )
        .0
    };
    let [ours, plain] = ["t-rrt", "rrt"].map(|name| (0..10).map(|seed| mean(name, seed)).sum::<f64>());
    assert!(ours < 0.6 * plain, "T-RRT {ours}, RRT {plain}");
}

/// By name: through a narrow passage and a wide one, it takes the wide one more often, and keeps away from
/// walls.
#[test]
fn it_keeps_away_from_obstacles() {
    let space = square();
    // Passages in a wall: of 0.08 where the straight way leads, and of 0.4.
    let walls = [(-1.0, 0.26), (0.34, 0.5), (0.9, 2.0)];
    let boxes = Boxes(walls.map(|(low, high)| ([0.45, low], [0.55, high])).to_vec());
    let settings = Settings::parse(["step=0.05"]).unwrap();
    let clearance = |q: &Point| mp_math::powi(1.0 - (boxes.distance(q) / (0.1 * space.extent())).min(1.0), 2);
    let [mut ours, mut plain] = [0.0; 2];
    for seed in 0..20 {
        for (name, sum) in [("t-rrt", &mut ours), ("rrt", &mut plain)] {
            let local = certified(&space, boxes.clone(), 1e-3);
            let (start, goal) = (Point::new(0.1, 0.2), Point::new(0.9, 0.4));
            let problem = Problem::new(&space, local, Exact(boxes.clone()), start, goal).unwrap();
            let problem = problem.with_obstacles(knowledge(&space, &boxes));
            *sum += paid(&solved(build(name, problem, &settings).unwrap(), seed), clearance).0;
        }
    }
    assert!(ours < 0.7 * plain, "T-RRT {ours}, RRT {plain}");
}

#[test]
fn what_costs_too_much_is_never_entered() {
    let (space, empty) = (square(), Boxes::default());
    // A ring of infinite cost around the goal.
    let cost = |q: &Point| {
        let r = (q - Point::new(0.8, 0.5)).norm();
        if (0.05..0.15).contains(&r) { f64::INFINITY } else { 1.0 }
    };
    let local = certified(&space, empty.clone(), 1e-3);
    let problem =
        Problem::new(&space, local, Exact(empty), Point::new(0.1, 0.5), Point::new(0.8, 0.5)).unwrap();
    let tuning = Tuning { step: Length::Absolute(0.05), ..Tuning::default() };
    let mut planner = TRrt::new(problem, cost, tuning, Temperature::default()).unwrap();
    let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(5_000), &mut ());
    assert_eq!(outcome, Outcome::Stopped(StopReason::Iterations));
    assert!(planner.tree().states().iter().all(|q| cost(q).is_finite()));
}

#[test]
fn parameters_are_checked() {
    let (space, empty) = (square(), Boxes::default());
    let made = |with| {
        let local = certified(&space, empty.clone(), 1e-3);
        let (start, goal) = (Point::new(0.1, 0.5), Point::new(0.9, 0.5));
        let problem = Problem::new(&space, local, Exact(empty.clone()), start, goal).unwrap();
        TRrt::new(problem, hill, Tuning::default(), with).map(drop)
    };
    let good = Temperature::default();
    assert!(made(good).is_ok());
    for bad in [
        Temperature { initial: 0.0, ..good },
        Temperature { alpha: 1.0, ..good },
        Temperature { alpha: f64::NAN, ..good },
        Temperature { refine: -0.1, ..good },
    ] {
        assert!(matches!(made(bad), Err(BuildError::OutOfRange { .. })), "{bad:?}");
    }
}
