//! Pictures of the field that pushes snakes in a world, and of a tree with bent edges.

use super::solve::{ITERATIONS, PreparedWorld, RANGE, rrs};
use crate::error::{IntoError, Result};
use crate::experiment::Lab;
use crate::plot::save_drawing;
use mp_cspace::{Iterations, Outcome, Planner, Rn, Rng};
use mp_render::{Drawing, Item};
use mp_scenes::source::disc_scenes::disc_scene;
use nalgebra::{Point2, Vector2};

const WORLD: &str = "high";
/// Longest step, metres.
const STEP: f64 = 1.0;
const SIZE: (usize, usize) = (1100, 720);
const STRAIGHT: u32 = 0x9aa5b1;
const BENT: u32 = 0x1f77b4;
const PATH: u32 = 0xc77d0a;
/// The number of shades of the field, and the colour of the strongest.
const SHADES: u32 = 24;
const HOT: [f64; 3] = [178.0, 24.0, 43.0];

/// Draws both pictures. Always true.
pub(super) fn run(lab: &Lab) -> Result<bool> {
    let prepared = PreparedWorld::new(disc_scene(WORLD, 0).into_error()?)?;
    for (name, drawing) in [("field", field(&prepared)), ("tree", tree(&prepared)?)] {
        save_drawing(&lab.file(&format!("rrs-{WORLD}-{name}")), &drawing, SIZE)?;
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

/// The energy of repulsion `½·(1 − c/range)²` below the obstacles: one item for each shade, made of runs of cells.
fn field(prepared: &PreparedWorld) -> Drawing {
    let subtitle =
        format!("energy of a snake where the robot is less than {:.0} cm from an obstacle", 100.0 * RANGE);
    let mut drawing = world(prepared, "What pushes snakes", subtitle);
    let (map, (width, height)) = (&prepared.map, prepared.map.size());
    // 1 at a clearance of zero, where the robot touches an obstacle.
    let shade = |i: usize| {
        let near = (1.0 - map.values()[i] / RANGE).clamp(0.0, 1.0);
        (near * near * f64::from(SHADES)).round() as u32
    };
    let corner = |column: usize, row: usize| {
        Point2::from(map.origin() + Vector2::new(column as f64, row as f64) * map.cell())
    };
    let mut rings = vec![Vec::new(); SHADES as usize + 1];
    for row in 0..height {
        let mut begin = 0;
        for column in 1..=width {
            let value = shade(row * width + begin);
            if column < width && shade(row * width + column) == value {
                continue;
            }
            let (low, high) = (corner(begin, row), corner(column, row + 1));
            rings[value as usize].push(vec![
                low,
                Point2::new(high.x, low.y),
                high,
                Point2::new(low.x, high.y),
            ]);
            begin = column;
        }
    }
    let colour = |value: usize| {
        let part = value as f64 / f64::from(SHADES);
        HOT.iter().fold(0, |rgb, c| rgb << 8 | (255.0 + (c - 255.0) * part) as u32)
    };
    let shades = rings.into_iter().enumerate().skip(1).filter(|(_, r)| !r.is_empty());
    drawing
        .items
        .splice(0..0, shades.map(|(value, rings)| Item::area(rings, colour(value))).collect::<Vec<_>>());
    drawing
}

/// The tree when the path was found: straight edges, bent ones, and the path.
fn tree(prepared: &PreparedWorld) -> Result<Drawing> {
    let space = Rn::<2>::new([0.0; 2], prepared.scene.size).into_error()?;
    let mut planner = rrs(prepared, &space, STEP, false).into_error()?;
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
