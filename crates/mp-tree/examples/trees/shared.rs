//! A bug trap and walls in the plane, and how to print what a planner made of them.

use mp_control::{
    ControlSegment, DiscreteFlowCheck, DoubleIntegrator, InputPlanner, InputSet, OnPosition, ReplayFinely,
};
use mp_cspace::{
    Discrete, EventCounts, FineDiscrete, Iterations, KdTree, Length, Outcome, ParameterError, Planner,
    Product, Rn, Rng, Straight,
};
use mp_snake::{Repulsion, SnakePlanner};
use mp_tree::{BuildError, Goals, Problem, RrtConnect, Tuning, improve};
use nalgebra::Vector2;

pub(crate) type Point = Vector2<f64>;
pub(crate) type Result<T = ()> = std::result::Result<T, Box<dyn std::error::Error>>;
type Local<'c> = Straight<'c, Rn<2>, Discrete<'c, Rn<2>, fn(&Point) -> bool>>;

/// Whether a point is off a ring of walls that is open only at the right.
pub(crate) fn free(q: &Point) -> bool {
    let r = (q - Point::new(0.5, 0.5)).norm();
    !(0.2..0.3).contains(&r) || (q.x > 0.5 && (q.y - 0.5).abs() < 0.02)
}

/// The unit square.
pub(crate) fn square() -> Result<Rn<2>> {
    Ok(Rn::new([0.0, 0.0], [1.0, 1.0])?)
}

/// From the middle of the ring to a place outside, on the side away from the opening.
pub(crate) fn bug_trap(space: &Rn<2>) -> Result<Problem<'_, Rn<2>, Local<'_>>> {
    Ok(problem(space, free, [Point::new(0.5, 0.5), Point::new(0.05, 0.5)])?)
}

/// Around the end of a wall.
pub(crate) fn wall(space: &Rn<2>) -> Result<Problem<'_, Rn<2>, Local<'_>>> {
    let free = |q: &Point| (q.x - 0.5).abs() > 0.05 || q.y > 0.6;
    Ok(problem(space, free, [Point::new(0.1, 0.2), Point::new(0.9, 0.2)])?)
}

/// A planning problem from start to goal among what `free` leaves free.
pub(crate) fn problem(
    space: &Rn<2>,
    free: fn(&Point) -> bool,
    [start, goal]: [Point; 2],
) -> std::result::Result<Problem<'_, Rn<2>, Local<'_>>, BuildError> {
    let unmade = |error: ParameterError| BuildError::Unmade { reason: error.to_string() };
    let check = Discrete::new(space, free, Length::Fraction(0.005)).map_err(unmade)?;
    let verifier = FineDiscrete::new(space, free, Length::Fraction(0.0005)).map_err(unmade)?;
    Problem::new(space, Straight::new(space, check), verifier, start, goal)
}

/// RRT-Connect through a narrow gap in a wall.
pub(crate) fn through_gap(
    space: &Rn<2>,
) -> std::result::Result<RrtConnect<'_, Rn<2>, Local<'_>, KdTree<2>>, BuildError> {
    let free = |q: &Point| (q.x - 0.5).abs() > 0.1 || (q.y - 0.8).abs() < 0.01;
    RrtConnect::new(problem(space, free, [Point::new(0.1, 0.2), Point::new(0.9, 0.2)])?, tuning())
}

type Field = fn(&Point, f64, &mut [f64]) -> f64;
type Bending<'c> = SnakePlanner<'c, Rn<2>, Discrete<'c, Rn<2>, fn(&Point) -> bool>, Repulsion<Field>>;

/// The same with edges that bend: out of the ring of walls by the nearer side, its opening left out.
pub(crate) fn bending_trap(space: &Rn<2>) -> Result<Problem<'_, Rn<2>, Bending<'_>>> {
    let field: Field = |q, _, gradient| {
        let from = q - Point::new(0.5, 0.5);
        let out = if from.norm() < 0.25 { -from } else { from };
        gradient.copy_from_slice(out.try_normalize(0.0).unwrap_or(Point::x()).as_slice());
        (from.norm() - 0.25).abs() - 0.05
    };
    let check = Discrete::new(space, free as fn(&Point) -> bool, Length::Fraction(0.005))?;
    let verifier = FineDiscrete::new(space, free, Length::Fraction(0.0005))?;
    let (start, goal) = (Point::new(0.5, 0.5), Point::new(0.05, 0.5));
    Ok(Problem::new(space, SnakePlanner::new(space, check, field, 0.05)?, verifier, start, goal)?)
}

/// A step that fits the trap.
pub(crate) fn tuning() -> Tuning {
    Tuning { step: Length::Absolute(0.1), ..Tuning::default() }
}

/// The seed given as the second argument.
pub(crate) fn rng() -> Result<Rng> {
    Ok(Rng::seed(std::env::args().nth(2).map_or(Ok(1), |text| text.parse())?))
}

/// Plans for ever shorter paths, and prints their lengths.
pub(crate) fn run_improving(mut planner: impl Planner<Point, Edge = ()>, space: &Rn<2>) -> Result {
    improve(&mut planner, &mut rng()?, &mut Iterations(5_000), &mut (), |path, progress| {
        println!("after {:5} iterations: {:.4}", progress.iterations, path.length(space));
    });
    Ok(())
}

/// Plans, and prints the path.
pub(crate) fn run(mut planner: impl Planner<Point>) -> Result {
    let mut seen = EventCounts::default();
    match planner.solve(&mut rng()?, &mut Iterations(50_000), &mut seen) {
        Outcome::Solved(path) => {
            for q in &path.states {
                println!("{:8.3} {:8.3}", q.x, q.y);
            }
            println!("{} motions, {seen:?}", planner.progress().motions);
        }
        Outcome::Stopped(reason) => println!("no path: {reason:?}"),
    }
    Ok(())
}

/// A position and its velocity.
pub(crate) type State = (Point, Point);
type Moving = Product<Rn<2>, Rn<2>>;
type Positions = OnPosition<fn(&Point) -> bool>;
type ByInputs<'c> =
    InputPlanner<'c, Moving, DoubleIntegrator<'c, Rn<2>>, Point, DiscreteFlowCheck<'c, Moving, Positions>>;

/// The unit square with velocities.
pub(crate) fn moving() -> Result<Moving> {
    Ok(Product::with_velocity(square()?, [0.4, 0.4])?)
}

/// From rest in the middle of the ring to anywhere outside, on the side away from the opening.
pub(crate) fn moving_trap(space: &Moving) -> Result<Problem<'_, Moving, ByInputs<'_>>> {
    let system = DoubleIntegrator::new(space.spaces().0)?;
    let valid = OnPosition(free as fn(&Point) -> bool);
    let check = DiscreteFlowCheck::new(space, valid.clone(), Length::Absolute(0.005))?;
    let local = InputPlanner::new(space, system, InputSet::grid([1.0, 1.0], 3)?, 0.15, check)?;
    let verifier = ReplayFinely::new(space, system, valid, Length::Absolute(0.0005))?;
    let beyond = Goals::region(|(q, _): &State| q.x < 0.15);
    Ok(Problem::new(space, local, verifier, (Point::new(0.5, 0.5), Point::zeros()), beyond)?)
}

/// Plans, and prints the path with its inputs.
pub(crate) fn run_legs(mut planner: impl Planner<State, Edge = ControlSegment<Point>>) -> Result {
    match planner.solve(&mut rng()?, &mut Iterations(500_000), &mut ()) {
        Outcome::Solved(path) => {
            println!("       x        y       vx       vy       ax       ay   for");
            for ((q, v), leg) in path.states.iter().zip(&path.edges) {
                let (a, time) = (leg.input, leg.duration);
                println!(
                    "{:8.3} {:8.3} {:8.3} {:8.3} {:8.3} {:8.3} {time:5.2} s",
                    q.x, q.y, v.x, v.y, a.x, a.y
                );
            }
            println!("{} nodes, {} expansions", planner.progress().nodes, planner.progress().motions);
        }
        Outcome::Stopped(reason) => println!("no path: {reason:?}"),
    }
    Ok(())
}
