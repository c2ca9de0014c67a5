//! Cyclic RRT: the ways round two blocks, and the cheapest paths.
//!
//! `cargo run -p mp-tree --example trees cyclic_rrt [SEED]`

use mp_cspace::{Discrete, FineDiscrete, Length, Planner, Rn, Rng, Straight};
use mp_tree::{CyclicRrt, Problem, Tuning};
use nalgebra::Vector2;

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seed = std::env::args().nth(2).map_or(Ok(1), |text| text.parse())?;
    let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
    let block = |q: &Vector2<f64>, y: f64| (q.x - 0.5).abs() < 0.2 && (q.y - y).abs() < 0.15;
    let free = |q: &Vector2<f64>| !block(q, 0.3) && !block(q, 0.75);
    let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.005))?);
    let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
    let problem = Problem::new(&space, local, verifier, Vector2::new(0.1, 0.3), Vector2::new(0.9, 0.3))?;
    let tuning = Tuning { step: Length::Absolute(0.1), ..Tuning::default() };
    let mut planner = CyclicRrt::new(problem, tuning, 0.5)?;
    let mut rng = Rng::seed(seed);
    while planner.progress().iterations < 3_000 {
        planner.step(&mut rng, &mut ());
    }
    println!("{} nodes, {} edges beside the tree", planner.tree().len(), planner.cycles().count());
    for (route, cost) in planner.routes(3, 0.3)? {
        let middle = route.states.iter().min_by(|a, b| (a.x - 0.5).abs().total_cmp(&(b.x - 0.5).abs()));
        println!("a route by y = {:.2}: cost {cost:.3}", middle.map_or(f64::NAN, |q| q.y));
    }
    for (_, cost) in planner.alternatives(5) {
        println!("one of the five cheapest: {cost:.3}");
    }
    Ok(())
}
