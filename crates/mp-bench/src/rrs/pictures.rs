//! Pictures: the field that pushes snakes in a world, a tree with bent edges, a path relaxed, the landscape
//! of risk.

use crate::error::{IntoError, Result};
use crate::experiment::Lab;
use crate::plot::save_drawing;
use mp_cspace::shorten::reduce;
use mp_cspace::{Cancel, Clock, Iterations, Outcome, Planner, Rn, Rng, least_clearance};
use mp_experiments::rrs::{Case, ITERATIONS, MARGIN, Planned, PreparedWorld, RANGE, planned, risk_of, rrs};
use mp_render::{Drawing, Item};
use mp_scenes::source::disc_scenes::{disc_scene, tight};
use mp_snake::risk::RiskMaps;
use mp_snake::{Bending, Grid, Params, Repulsion, relax};
use nalgebra::Point2;
use std::cell::Cell;

const WORLD: &str = "high";
/// Longest step, metres.
const STEP: f64 = 1.0;
const SIZE: (usize, usize) = (1100, 720);
const STRAIGHT: u32 = 0x9aa5b1;
const BENT: u32 = 0x1f77b4;
const PATH: u32 = 0xc77d0a;

/// Draws all pictures. Always true.
pub(super) fn run(lab: &Lab) -> Result<bool> {
    let prepared = PreparedWorld::new(disc_scene(WORLD, 0).into_error()?).into_error()?;
    for (name, drawing) in
        [("field", field(&prepared)), ("tree", tree(&prepared)?), ("relaxed", relaxed(&prepared)?)]
    {
        save_drawing(&lab.file(&format!("rrs-{WORLD}-{name}")), &drawing, SIZE)?;
    }
    for (name, drawing) in risk()? {
        save_drawing(&lab.file(&format!("rrs-{name}")), &drawing, (1100, 520))?;
    }
    Ok(true)
}

fn world(prepared: &PreparedWorld, title: &str, subtitle: String) -> Drawing {
    Drawing::of_world(
        prepared.robot.world(),
        [[0.0; 2], prepared.scene.size].map(Point2::from),
        title,
        subtitle,
    )
}

/// What a planner finds in a world.
fn found(prepared: &PreparedWorld, case: &Case) -> Result<Option<Planned>> {
    planned(prepared, case, Clock::default(), &Cancel::new()).into_error()
}

/// The energy of repulsion `½·(1 − c/range)²` below the obstacles.
fn field(prepared: &PreparedWorld) -> Drawing {
    let subtitle =
        format!("energy of a snake where the robot is less than {:.0} cm from an obstacle", 100.0 * RANGE);
    let mut drawing = world(prepared, "What pushes snakes", subtitle);
    // 1 at a clearance of zero, where the robot touches an obstacle.
    shade(&mut drawing, &prepared.map, |clearance| {
        mp_math::powi((1.0 - clearance / RANGE).clamp(0.0, 1.0), 2)
    });
    drawing
}

/// Draws a map below all else, from white where `part` of its value is zero to red where it is 1.
fn shade(drawing: &mut Drawing, map: &Grid, part: impl Fn(f64) -> f64) {
    let parts: Vec<f64> = map.values().iter().map(|value| part(*value)).collect();
    let shades = Item::shades(map.origin().into(), map.cell(), map.size().0, &parts);
    drawing.items.splice(0..0, shades);
}

/// Fig. 2 d: a whole path, and the same relaxed by a snake, above the field.
fn relaxed(prepared: &PreparedWorld) -> Result<Drawing> {
    let space = Rn::<2>::new([0.0; 2], prepared.scene.size).into_error()?;
    let case = Case { world: WORLD.into(), planner: "rrt-upto".into(), step: 50, trial: 0 };
    let found = found(prepared, &case)?.and_then(|(_, path)| path);
    let Some(path) = found else { return Ok(field(prepared)) };
    let mut robot = prepared.robot.clone();
    let path = reduce(&space, &mut robot, &path);
    let mut repulsion = Repulsion::new(&prepared.map, RANGE).into_error()?;
    let params = Params { iterations: 200, ..Params::for_range(RANGE).into_error()? };
    let after = relax(&space, &mut robot, &mut repulsion, &path, params, 1.15).into_error()?.path;
    let mut safety = |path| 100.0 * least_clearance(&space, &mut robot, path, 1e-4).map_or(0.0, |t| t.found);
    let subtitle = format!(
        "{:.0} cm long, {:.1} cm from obstacles (grey), relaxed {:.0} cm and {:.1} cm (orange)",
        100.0 * path.length(&space),
        safety(&path),
        100.0 * after.length(&space),
        safety(&after)
    );
    let mut drawing = world(prepared, "A path of RRT, relaxed by a snake", subtitle);
    shade(&mut drawing, &prepared.map, |clearance| {
        mp_math::powi((1.0 - clearance / RANGE).clamp(0.0, 1.0), 2)
    });
    for (path, colour, width) in [(&path, 0x2b3440, 2.0), (&after, PATH, 3.5)] {
        let line = path.states.iter().map(|q| Point2::from(*q)).collect();
        drawing.items.push(Item::lines(vec![line], colour, width));
    }
    Ok(drawing)
}

/// Fig. 1: where a robot passes that follows a path inexactly, where obstacles are that were seen inexactly,
/// and the risk, the product of both. Each is drawn relative to its greatest value.
fn risk() -> Result<Vec<(String, Drawing)>> {
    let prepared = PreparedWorld::with_margin(tight(), MARGIN).into_error()?;
    let space = Rn::<2>::new([0.0; 2], prepared.scene.size).into_error()?;
    let case = Case { world: "follow".into(), planner: "rrs-upto".into(), step: 50, trial: 0 };
    let found = found(&prepared, &case)?.and_then(|(_, path)| path);
    let Some(path) = found else { return Ok(Vec::new()) };
    let path = reduce(&space, &mut prepared.robot.clone(), &path);
    let titles = [
        ("risk-passing", "Where the robot passes", "probability that a step of the path ends here"),
        ("risk-occupied", "Where obstacles are", "probability that the robot touches an obstacle here"),
        ("risk", "The landscape of risk", "the product of both: what pushes snakes away"),
    ];
    let RiskMaps { passing, occupied, risk } = risk_of(&prepared, &space, &path).into_error()?;
    let draw = |((name, title, subtitle), map): ((&str, &str, &str), Grid)| {
        let most = map.values().iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let mut drawing = world(&prepared, title, subtitle.into());
        shade(&mut drawing, &map, |value| (value / most).sqrt());
        let line = path.states.iter().map(|q| Point2::from(*q)).collect();
        drawing.items.push(Item::lines(vec![line], 0x2b3440, 1.5));
        (name.to_owned(), drawing)
    };
    Ok(titles.into_iter().zip([passing, occupied, risk]).map(draw).collect())
}

/// The tree when the path was found: straight edges, bent ones, and the path.
fn tree(prepared: &PreparedWorld) -> Result<Drawing> {
    let space = Rn::<2>::new([0.0; 2], prepared.scene.size).into_error()?;
    let (counters, field) = (Cell::default(), Repulsion::new(&prepared.map, RANGE).into_error()?);
    let planner = rrs(prepared, &space, STEP, false, field, Bending::default(), &counters);
    let mut planner = planner.into_error()?;
    let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(ITERATIONS), &mut ());
    let tree = planner.tree();
    let (mut straight, mut bent) = (Vec::new(), Vec::new());
    for id in 1..tree.len() as u32 {
        let (Some(parent), Some(edge)) = (tree.parent(id), tree.edge(id)) else { continue };
        let through = [tree.state(parent)].into_iter().chain(edge.vertices()).chain([tree.state(id)]);
        let line: Vec<Point2<f64>> = through.map(|q| Point2::from(*q)).collect();
        if edge.vertices().is_empty() { straight.push(line) } else { bent.push(line) }
    }
    let subtitle = format!(
        "{} straight edges and {} bent ones, after {} iterations",
        straight.len(),
        bent.len(),
        planner.progress().iterations
    );
    let mut drawing = world(prepared, "A tree of RRS", subtitle);
    drawing.items.push(Item::lines(straight, STRAIGHT, 1.5));
    drawing.items.push(Item::lines(bent, BENT, 1.5));
    if let Outcome::Solved(path) = outcome {
        let line = path.flattened().states.iter().map(|q| Point2::from(*q)).collect();
        drawing.items.push(Item::lines(vec![line], PATH, 3.5));
    }
    Ok(drawing)
}
