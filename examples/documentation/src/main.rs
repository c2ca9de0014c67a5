//! The Rust of the README and of the guides, as a program: a test compares them line by line.

use std::error::Error;

/// README.md
fn plan_a_scene() -> Result<(), Box<dyn Error>> {
    use mp_plan::{Look, PathRows, PictureKind, Request, Scene};
    let scene = Scene::find("cubicles")?;
    let report = scene.plan(&Request::default().seed(1))?;
    let rows = report.path.ok_or("no path within the time")?;
    let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
    let picture = scene.picture(Some(&path), "seed 1", PictureKind::Png, &Look::default())?;
    std::fs::write("cubicles.png", picture)?;
    Ok(())
}

/// docs/guides/roadmap.md
fn ask_a_roadmap() -> Result<(), Box<dyn Error>> {
    use mp_plan::{Request, Scene};
    let scene = Scene::find("cubicles")?;
    let mut roadmap = scene.roadmap(&Request::new("prm").seed(1).nodes(2_000))?;
    let report = roadmap.query(&scene.start(), &scene.goals()[0])?;
    println!("{:?} m long by a roadmap", report.path_length);
    Ok(())
}

/// docs/own-robot.md
fn a_space_and_a_check() -> Result<(), Box<dyn Error>> {
    use mp_cspace::{Discrete, FineDiscrete, Iterations, Length, Outcome, Planner, Rn, Rng, Straight};
    use mp_tree::{Problem, RrtConnect, Tuning};
    use nalgebra::Vector2;

    let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
    let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
    let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
    let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
    let problem = Problem::new(&space, local, verifier, Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5))?;
    let mut planner = RrtConnect::new(problem, Tuning::default())?;
    if let Outcome::Solved(path) = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ()) {
        println!("{} states", path.states.len());
    }
    Ok(())
}

/// docs/own-robot.md
fn a_constraint() -> Result<(), Box<dyn Error>> {
    use mp_cspace::Length;
    use mp_plan::{Constraint, Request, Scene};

    let level = |row: &[f64]| row[4].abs() < 0.1 && row[5].abs() < 0.1;
    let upright = Constraint::new("upright", Length::Fraction(0.005), level);
    let report = Scene::find("cubicles")?.under(upright)?.plan(&Request::default())?;
    println!("{:?} m long, upright", report.path_length);
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    plan_a_scene()?;
    ask_a_roadmap()?;
    a_space_and_a_check()?;
    a_constraint()
}
