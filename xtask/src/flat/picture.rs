//! Pictures of worlds in the plane.

use super::{FlatMover, Task};
use crate::output;
use crate::render::{Drawing, Item, SIZE, write as write_pixels};
use miette::Result;
use mp::geom::flat::FlatWorld;
use nalgebra::Point2;
use std::path::Path;

const OBSTACLE: u32 = 0x8d99a8;
const WALL: u32 = 0x2b3440;
const PATH: u32 = 0xc77d0a;
const SWEPT: u32 = 0xe6b422;
const START: u32 = 0x2e9e5b;
const GOAL: u32 = 0xcf3a3a;

/// Between two copies of the robot its origin moves about this many radii.
const SPACING: f64 = 1.5;

/// The world alone, within `bounds`.
pub(crate) fn world(world: &FlatWorld, [low, high]: [[f64; 2]; 2], title: &str, subtitle: String) -> Drawing {
    let (low, high) = match world.walls() {
        Some([l, h]) => (l.inf(&low.into()), h.sup(&high.into())),
        None => (low.into(), high.into()),
    };
    let mut items: Vec<Item> =
        world.polygons().iter().map(|p| Item::area(p.rings().to_vec(), OBSTACLE)).collect();
    let corners = |[l, h]: [Point2<f64>; 2]| vec![l, Point2::new(h.x, l.y), h, Point2::new(l.x, h.y), l];
    items.push(match world.walls() {
        Some(walls) => Item::lines(vec![corners(walls)], WALL, 4.0),
        None => Item::lines(vec![corners([low, high])], OBSTACLE, 1.0),
    });
    Drawing { title: title.to_owned(), subtitle, low, high, items }
}

fn picture<M: FlatMover>(task: &Task<M>, states: &[M::State], subtitle: String) -> Drawing {
    use mp::cspace::Space;
    let mut drawing = world(task.robot.world(), task.problem.bounds, &task.problem.name, subtitle);
    let spacing = SPACING * task.robot.radius().max(1e-3 * task.space.extent());
    let mut line = Vec::new();
    for w in states.windows(2) {
        let length = (M::place(&w[1]) - M::place(&w[0])).norm();
        let copies = (length / spacing).ceil().clamp(1.0, 1000.0);
        for i in 0..copies as usize {
            let q = task.space.interpolate(&w[0], &w[1], i as f64 / copies);
            line.push(Point2::from(M::place(&q)));
            drawing.items.push(Item::area(task.robot.rings(&q), SWEPT).faint(0.3));
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
    let size = size.unwrap_or(SIZE);
    match file.extension().is_some_and(|e| e.eq_ignore_ascii_case("svg")) {
        true => output::write(file, drawing.svg(size).as_bytes()),
        false => write_pixels(file, &drawing.pixels(size)),
    }
}
