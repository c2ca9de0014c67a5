//! RSRT parks a car in a gap between two others, by arcs forward and in reverse.
//!
//! `cargo run -p mp-tree --example trees car [SEED]`

use mp_control::{Car, DiscreteFlowCheck, InputPlanner, ReplayFinely};
use mp_cspace::{Exactly, Iterations, Length, Outcome, Planner, Rng, Se2, Se2State};
use mp_tree::{Goals, Problem, Rsrt, Tuning};
use nalgebra::Point2;

/// Whether the outline of a car 4 m by 1.8 m, its rear axle 0.9 m from its back, stays on the road and
/// off the pavement and the cars parked there with a gap of 6 m between.
fn free(q: &Se2State) -> bool {
    let outline = (0..=20).flat_map(|i| {
        let (x, y) = (-0.9 + 0.2 * f64::from(i), -0.9 + 0.09 * f64::from(i));
        [(x, -0.9), (x, 0.9), (-0.9, y), (3.1, y)]
    });
    outline.map(|(x, y)| q.transform_point(&Point2::new(x, y))).all(|p| {
        let in_gap = p.x > 6.0 && p.x < 12.0;
        p.x > 0.0 && p.x < 18.0 && p.y < 6.0 && p.y > if in_gap { 0.0 } else { 2.2 }
    })
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seed = std::env::args().nth(2).map_or(Ok(1), |text| text.parse())?;
    let space = Se2::new([0.0, 0.0], [18.0, 6.0])?.with_rotation_weight(2.0)?;
    let car = Car::new(2.5)?;
    let check = DiscreteFlowCheck::new(&space, free, Length::Absolute(0.1))?;
    let mut local = InputPlanner::new(&space, car, Car::inputs(1.0, 0.6, 2)?, 0.6, check)?;
    let verifier = ReplayFinely::new(&space, car, free, Length::Absolute(0.01))?;
    let parked =
        |q: &Se2State| (6.9..9.0).contains(&q.translation.x) && q.translation.y < 1.2 && q.angle.abs() < 0.1;
    let goal = Goals::region(parked).with_sampler(Exactly(Se2State::new(8.0, 1.1, 0.0)));
    let problem = Problem::new(&space, &mut local, verifier, Se2State::new(2.0, 4.0, 0.0), goal)?;
    let mut planner = Rsrt::new(problem, Tuning { goal_bias: 0.1, ..Tuning::default() })?;
    let outcome = planner.solve(&mut Rng::seed(seed), &mut Iterations(200_000), &mut ());
    let nodes = planner.progress().nodes;
    drop(planner);
    match outcome {
        Outcome::Solved(path) => {
            for (q, leg) in path.states.iter().zip(&path.edges) {
                let (t, [speed, steering]) = (q.translation, leg.input);
                println!(
                    "{:7.3} {:7.3} {:7.3}   {speed:4.1} m/s, steering {steering:5.2} rad",
                    t.x, t.y, q.angle
                );
            }
            println!("{nodes} nodes, {:?}", local.counters());
        }
        Outcome::Stopped(reason) => println!("no path: {reason:?}"),
    }
    Ok(())
}
