//! Pictures of worlds in the plane.

use super::{FlatMover, Task};
use crate::output;
use crate::render;
use miette::{IntoDiagnostic, Result};
use mp::render::palette::{GOAL, MIDDLE, PATH, START};
use mp::render::{Drawing, Item};
use nalgebra::Point2;
use std::path::Path;

/// Between two copies of the robot its origin moves about this many radii.
const SPACING: f64 = 1.5;

fn picture<M: FlatMover>(task: &Task<M>, states: &[M::State], subtitle: String) -> Drawing {
    use mp::cspace::Space;
    let corners = task.problem.bounds.map(Point2::from);
    let mut drawing = Drawing::of_world(task.robot.world(), corners, task.problem.name.clone(), subtitle);
    let spacing = SPACING * task.robot.radius().max(1e-3 * task.space.extent());
    let mut line = Vec::new();
    for w in states.windows(2) {
        let length = (M::place(&w[1]) - M::place(&w[0])).norm();
        let copies = (length / spacing).ceil().clamp(1.0, 1000.0);
        for i in 0..copies as usize {
            let q = task.space.interpolate(&w[0], &w[1], i as f64 / copies);
            line.push(Point2::from(M::place(&q)));
            drawing.items.push(Item::area(task.robot.rings(&q), MIDDLE).faint(0.3));
        }
    }
    line.extend(states.last().map(|q| Point2::from(M::place(q))));
    drawing.items.push(Item::lines(vec![line], PATH, 2.5));
    let goal = states.last().unwrap_or(&task.goals[0]);
    for (q, colour) in [(&task.start, START), (goal, GOAL)] {
        drawing.items.push(Item::area(task.robot.rings(q), colour));
    }
    drawing
}

/// Writes the picture of `task` with the path `rows` in it, as its ending says: SVG or PNG.
pub(crate) fn draw<M: FlatMover>(
    file: &Path,
    task: &Task<M>,
    path: Option<&mp::io::JointPath>,
    subtitle: String,
    size: Option<(usize, usize)>,
) -> Result<()> {
    let states = path.map(|path| task.path(path)).transpose()?.unwrap_or_default();
    let drawing = picture(task, &states, subtitle);
    let size = size.unwrap_or(render::SIZE);
    match file.extension().is_some_and(|e| e.eq_ignore_ascii_case("svg")) {
        true => output::write(file, drawing.svg(size).into_diagnostic()?.as_bytes()),
        false => render::write(file, &drawing.pixels(size).into_diagnostic()?),
    }
}
