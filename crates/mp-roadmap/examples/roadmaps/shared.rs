//! A bug trap and a narrow gap in the plane, and how to print what a planner made of them.

use mp_cspace::{Discrete, FineDiscrete, Iterations, Length, Outcome, Planner, Problem, Rn, Rng, Straight};
use mp_roadmap::Roadmap;
use nalgebra::Vector2;

pub(crate) type Point = Vector2<f64>;
pub(crate) type Result<T = ()> = std::result::Result<T, Box<dyn std::error::Error>>;
pub(crate) type Local<'c> = Straight<'c, Rn<2>, Discrete<'c, Rn<2>, fn(&Point) -> bool>>;

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
    problem(space, free, 0.005, [Point::new(0.5, 0.5), Point::new(0.05, 0.5)])
}

/// Through a narrow gap in a thick wall.
pub(crate) fn gap(space: &Rn<2>) -> Result<Problem<'_, Rn<2>, Local<'_>>> {
    let free = |q: &Point| (q.x - 0.5).abs() > 0.2 || (q.y - 0.7).abs() < 0.01;
    problem(space, free, 0.002, [Point::new(0.1, 0.2), Point::new(0.9, 0.2)])
}

fn problem(
    space: &Rn<2>,
    free: fn(&Point) -> bool,
    resolution: f64,
    [start, goal]: [Point; 2],
) -> Result<Problem<'_, Rn<2>, Local<'_>>> {
    let check = Discrete::new(space, free, Length::Fraction(resolution))?;
    let verifier = FineDiscrete::new(space, free, Length::Fraction(0.0005))?;
    Ok(Problem::new(space, Straight::new(space, check), verifier, start, goal)?)
}

/// The seed given as the second argument.
pub(crate) fn rng() -> Result<Rng> {
    Ok(Rng::seed(std::env::args().nth(2).map_or(Ok(1), |text| text.parse())?))
}

/// Plans, and prints the path.
pub(crate) fn run(planner: &mut impl Planner<Point>) -> Result {
    match planner.solve(&mut rng()?, &mut Iterations(100_000), &mut ()) {
        Outcome::Solved(path) => path.states.iter().for_each(|q| println!("{:8.3} {:8.3}", q.x, q.y)),
        Outcome::Stopped(reason) => println!("no path: {reason:?}"),
    }
    println!("{} motions", planner.progress().motions);
    Ok(())
}

/// What there is in a roadmap.
pub(crate) fn tell(map: &Roadmap<Point>) {
    println!("{} nodes, {} edges", map.len(), map.edges());
}
