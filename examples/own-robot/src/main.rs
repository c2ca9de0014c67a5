//! A drawbridge of two leaves, a space and a check of its own: both must open for a mast, and neither may hit the other.

use mp_cspace::{Discrete, FineDiscrete, Iterations, Length, Outcome, Planner, Rng, Space, Straight};
use mp_tree::{Problem, Rrt, Tuning};

/// The angles of the leaves, radians from lying flat.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Leaves {
    left: f64,
    right: f64,
}

/// Both from flat to upright; the distance is the larger of the two changes.
struct Bridge;

/// Upright, radians.
const UP: f64 = 1.5;

impl Space for Bridge {
    type State = Leaves;
    fn distance(&self, a: &Leaves, b: &Leaves) -> f64 {
        (a.left - b.left).abs().max((a.right - b.right).abs())
    }
    fn dim(&self) -> usize {
        2
    }
    fn extent(&self) -> f64 {
        UP
    }
    fn interpolate_into(&self, a: &Leaves, b: &Leaves, t: f64, out: &mut Leaves) {
        let between = |a: f64, b: f64| if t < 0.5 { a + (b - a) * t } else { b - (b - a) * (1.0 - t) };
        *out = Leaves { left: between(a.left, b.left), right: between(a.right, b.right) };
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> Leaves {
        Leaves { left: UP * u[0], right: UP * u[1] }
    }
    fn sample_uniform(&self, rng: &mut Rng) -> Leaves {
        self.unit_cube_to_state(&[rng.unit(), rng.unit()])
    }
    fn contains(&self, q: &Leaves) -> bool {
        [q.left, q.right].iter().all(|angle| (0.0..=UP).contains(angle))
    }
}

impl mp_cspace::DefaultNn for Bridge {
    type Nn = mp_cspace::Linear;
}

/// The right leaf overlaps the left one: it may only be lower once that is up.
fn free(q: &Leaves) -> bool {
    q.left > 1.2 || q.right + 0.1 > q.left
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let local = Straight::new(&Bridge, Discrete::new(&Bridge, free, Length::Fraction(0.01))?);
    let verifier = FineDiscrete::new(&Bridge, free, Length::Fraction(0.001))?;
    let (start, goal) = (Leaves { left: 0.0, right: 0.0 }, Leaves { left: 1.5, right: 0.0 });
    let problem = Problem::new(&Bridge, local, verifier, start, goal)?;
    let mut planner = Rrt::new(problem, Tuning::default())?;
    match planner.solve(&mut Rng::seed(1), &mut Iterations(20_000), &mut ()) {
        Outcome::Solved(path) => path.states.iter().for_each(|q| println!("{q:?}")),
        Outcome::Stopped(reason) => return Err(format!("no path: {reason:?}").into()),
    }
    Ok(())
}
