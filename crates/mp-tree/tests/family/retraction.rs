//! Retraction-based RRT: blocked steps go on along the obstacle.

use crate::common::checked;
use mp_cspace::{Discrete, FineDiscrete, Iterations, Length, Outcome, Planner, Rn, Rng};
use mp_tree::{Problem, RetractionRrt, RrtConnect, Tuning};
use nalgebra::Vector2;

type Point = Vector2<f64>;

/// Half the width of the corridor.
const HALF: f64 = 0.004;
/// A number by which lengths along axes become lengths along diagonals.
const TURN: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// How far to one side of the middle of the corridor, which leads along y = x, and how far along it from the
/// middle of the square.
fn across_and_along(q: &Point) -> (f64, f64) {
    ((q.y - q.x) * TURN, (q.x + q.y - 1.0) * TURN)
}

/// A lower bound on the distance to the walls: from a funnel through a corridor into a funnel.
fn clearance(q: &Point) -> f64 {
    let (across, along) = across_and_along(q);
    (HALF + (along.abs() - 0.3).max(0.0) - across.abs()) * TURN
}

fn free(q: &Point) -> bool {
    clearance(q) > 0.0
}

fn gradient(q: &Point, _reach: f64, gradient: &mut [f64]) -> f64 {
    let (across, along) = across_and_along(q);
    let widens = if along.abs() > 0.3 { along.signum() } else { 0.0 };
    let out = -across.signum();
    gradient.copy_from_slice(&[0.5 * (widens - out), 0.5 * (widens + out)]);
    clearance(q)
}

/// The iterations of a planner with a seed. A path that it finds is free.
fn iterations<P: Planner<Point, Edge = ()>>(mut planner: P, seed: u64) -> u64 {
    let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(20_000), &mut ());
    if let Outcome::Solved(path) = outcome {
        for pair in path.states.windows(2) {
            for i in 0..=1000 {
                let q = pair[0].lerp(&pair[1], f64::from(i) / 1000.0);
                assert!(free(&q), "{q}");
            }
        }
    }
    planner.progress().iterations
}

#[test]
fn a_long_corridor_is_passed_in_a_fraction_of_the_iterations() {
    let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
    let problem = || {
        let local = checked(&space, Discrete::new(&space, free, Length::Fraction(0.0005)).unwrap());
        let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0001)).unwrap();
        Problem::new(&space, local, verifier, Point::new(0.05, 0.15), Point::new(0.95, 0.85)).unwrap()
    };
    let (mut with, mut without) = (0, 0);
    for seed in 1..=10 {
        with += iterations(RetractionRrt::new(problem(), gradient, 8, Tuning::default()).unwrap(), seed);
        without += iterations(RrtConnect::new(problem(), Tuning::default()).unwrap(), seed);
    }
    assert!(4 * with < without, "{with} iterations, {without} without sliding");
}

#[test]
fn without_slides_it_is_rrt_connect() {
    let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0]).unwrap();
    let open = |q: &Point| (q - Point::new(0.5, 0.5)).norm() > 0.3;
    let problem = || {
        let local = checked(&space, Discrete::new(&space, open, Length::Fraction(0.01)).unwrap());
        let verifier = FineDiscrete::new(&space, open, Length::Fraction(0.001)).unwrap();
        Problem::new(&space, local, verifier, Point::new(0.1, 0.5), Point::new(0.9, 0.5)).unwrap()
    };
    for seed in 1..=5 {
        let mut rrrt = RetractionRrt::new(problem(), gradient, 0, Tuning::default()).unwrap();
        let mut connect = RrtConnect::new(problem(), Tuning::default()).unwrap();
        let [mut one, mut other] = [Rng::seed(seed), Rng::seed(seed)];
        let found = rrrt.solve(&mut one, &mut Iterations(10_000), &mut ());
        let known = connect.solve(&mut other, &mut Iterations(10_000), &mut ());
        let (Outcome::Solved(found), Outcome::Solved(known)) = (found, known) else { panic!("seed {seed}") };
        assert_eq!(found.states, known.states);
    }
}
