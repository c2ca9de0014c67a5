//! Plans for a six-joint arm, with certified motions and a verified path:
//! `cargo run --release -p mp --example arm -- crates/mp-scenes/assets/scenes/arm.toml`
#![allow(clippy::print_stdout)] // an example talks

use mp::io::RobotProblem;
use mp::prelude::*;
use nalgebra::SVector;

type Q = SVector<f64, 6>;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).unwrap_or_else(|| "crates/mp-scenes/assets/scenes/arm.toml".into());
    let task = RobotProblem::load(&file)?;
    let ([robot], [entry]) = (task.robots.as_slice(), task.file.robots.as_slice()) else {
        return Err("this example is for one robot".into());
    };
    let mut model = ArmModel::from_urdf(&robot.urdf, |name| robot.mesh(name))?;
    model.base = entry.pose();
    let obstacles = task.obstacles.iter().map(|o| (o.name.clone(), o.mesh.clone(), o.pose));
    let arm = Arm::new(&model, obstacles)?;
    // Six coordinates, known when compiling; `Configuration` takes any number.
    let space = arm.space::<Q>()?;
    let state = |values: &[f64]| {
        let fits = values.len() == 6;
        fits.then(|| Q::from_column_slice(values)).ok_or("this example is for six joints")
    };
    let start = state(task.file.start.row())?;
    let goals = task.file.goals.iter().map(|goal| match goal.values() {
        Some(values) => state(values),
        None => Err("this example is for goals that give all joints"),
    });
    let goals = goals.collect::<Result<Vec<_>, _>>()?;

    let (tolerance, verifier) = (arm.tolerance(), ArmVerifier::new(&space, &arm)?);
    let local = Straight::new(&space, Certified::new(&space, arm, tolerance)?);
    let problem = Problem::new(&space, local, verifier, start, Goals::states(goals))?;
    let mut planner = RrtConnect::new(problem, Tuning::default())?;
    match planner.solve(&mut Rng::seed(1), &mut Iterations(100_000), &mut ()) {
        Outcome::Solved(path) => {
            for q in &path.states {
                println!("{}", q.iter().map(|x| format!("{x:8.3}")).collect::<String>());
            }
        }
        Outcome::Stopped(reason) => println!("no path: {reason:?}"),
    }
    Ok(())
}
