//! Scenes for a small round robot: the four worlds of Baizid et al., *RRS: rapidly-exploring random snakes*, figure 4,
//! rebuilt. The paper gives their sizes, the numbers of obstacles and pictures that are too small to measure; all
//! else was chosen to fit its descriptions.

use super::Error;
use super::scene::Files;
use mp_cspace::{Clearance, MotionValidity, Rng, Validity};
use mp_geom::planar::{PlanarWorld, Polygon};
use mp_robot::DiscRobot;
use nalgebra::{Point2, Vector2};
use rand::RngExt;
use std::collections::VecDeque;
use std::fmt::Write as _;
use std::sync::Arc;

/// The radius of the robot, metres: that of a Khepera III.
pub const RADIUS: f64 = 0.065;

/// A walled room with obstacles, a start and a goal; coordinates are multiples of a tenth of a millimetre.
#[derive(Clone, Debug, PartialEq)]
pub struct DiscScene {
    /// Width and height of the walled room, metres; the origin is a corner.
    pub size: [f64; 2],
    /// The corners of each obstacle.
    pub obstacles: Vec<Vec<[f64; 2]>>,
    /// Where the robot starts.
    pub start: [f64; 2],
    /// Where the robot is to go.
    pub goal: [f64; 2],
}

impl DiscScene {
    /// The robot in its world.
    ///
    /// # Errors
    /// When an obstacle is not a polygon, or the room has no area.
    pub fn robot(&self) -> Result<DiscRobot, Error> {
        let polygons = self.obstacles.iter().map(|ring| Polygon::outlined(ring.iter().copied()));
        let polygons = polygons.collect::<Result<Vec<_>, _>>().map_err(Error::new)?;
        let world = PlanarWorld::new(polygons, Some([[0.0; 2], self.size])).map_err(Error::new)?;
        DiscRobot::new(Arc::new(world), RADIUS).map_err(Error::new)
    }

    /// The text of the scene file; `about` is the comment on its first line.
    fn text(&self, about: &str) -> String {
        let point = |p: &[f64; 2]| format!("[{}, {}]", p[0], p[1]);
        let mut out = format!(
            "# {about}\n\n[world]\nwalls = [[0, 0], {}]\n\n[robot]\ndisc = {RADIUS}\n\n[motion]\nstart = {}\ngoal = {}\n",
            point(&self.size),
            point(&self.start),
            point(&self.goal)
        );
        for ring in &self.obstacles {
            let points: Vec<String> = ring.iter().map(point).collect();
            let _ = write!(out, "\n[[obstacle]]\npolygon = [{}]\n", points.join(", "));
        }
        out
    }
}

/// Adds the four worlds of the paper, the one in which a robot follows paths, and a roomier version of that.
pub(super) fn add(files: &mut Files) {
    for (name, scene, about) in [
        ("rrs-maze", maze(), "A maze with one way through; 3 × 3 m."),
        ("rrs-low", low(), "17 obstacles; 4 × 3 m."),
        ("rrs-high", high(), "48 obstacles; 7 × 4 m."),
        ("rrs-random", random(0), "A random world of 50 to 80 obstacles; 7 × 4 m."),
        (
            "rrs-corridor",
            tight(),
            "The world of Figure 10 (§6), as rebuilt here, in which paths are followed; 34 obstacles, 5 × 2 m.",
        ),
        (
            "rrs-follow",
            follow(),
            "A roomier version of rrs-corridor, for demonstrations: what is said of Figure 10 is measured there. Nine obstacles, 5 × 2 m.",
        ),
    ] {
        files.insert(format!("scenes/{name}.toml"), scene.text(about).into_bytes());
    }
}

/// The corners of a rectangle.
fn bar(low: [f64; 2], high: [f64; 2]) -> Vec<[f64; 2]> {
    vec![low, [high[0], low[1]], high, [low[0], high[1]]]
}

/// Three walls, each with a gap at alternating ends, and a spur.
fn maze() -> DiscScene {
    let obstacles = vec![
        bar([0.0, 0.72], [2.4, 0.78]),
        bar([0.6, 1.47], [3.0, 1.53]),
        bar([0.0, 2.22], [2.4, 2.28]),
        bar([1.47, 2.28], [1.53, 2.6]),
    ];
    DiscScene { size: [3.0, 3.0], obstacles, start: [0.35, 0.35], goal: [0.4, 2.65] }
}

/// Scattered bars and blocks with room to pass between any two.
fn low() -> DiscScene {
    let scene = DiscScene { size: [4.0, 3.0], obstacles: vec![], start: [0.25, 0.25], goal: [3.75, 2.75] };
    scattered(scene, 17, [0.18, 0.42], 2.6 * RADIUS, 11)
}

/// More of the same.
fn high() -> DiscScene {
    let scene = DiscScene { size: [7.0, 4.0], obstacles: vec![], start: [0.25, 0.25], goal: [6.75, 3.75] };
    scattered(scene, 48, [0.15, 0.4], 2.4 * RADIUS, 12)
}

/// A roomier version of [`tight`], for demonstrations: a few obstacles.
fn follow() -> DiscScene {
    let scene = DiscScene { size: [5.0, 2.0], obstacles: vec![], start: [0.3, 1.0], goal: [4.7, 1.0] };
    scattered(scene, 9, [0.15, 0.35], 4.0 * RADIUS, 13)
}

/// The world of Figure 10, in which paths are followed (§6): a room of 5 × 2 m full of obstacles, between which passages of 1.3 to 2
/// widths of the robot tell paths apart. It is ours, as the paper does not describe its own.
pub fn tight() -> DiscScene {
    let scene = DiscScene { size: [5.0, 2.0], obstacles: vec![], start: [0.3, 1.0], goal: [4.7, 1.0] };
    scattered(scene, 34, [0.12, 0.24], 2.6 * RADIUS, 21)
}

/// 50 to 80 obstacles, which may touch each other; start and goal are free, connected, and at least 3 m apart.
fn random(trial: u64) -> DiscScene {
    let mut attempt = 0;
    loop {
        attempt += 1;
        let mut rng = Rng::stream(1000 + trial, attempt);
        let count = rng.random_range(50..=80);
        let size = [7.0, 4.0];
        let obstacles = (0..count).map(|_| block(&mut rng, size, [0.1, 0.3])).collect();
        let mut scene = DiscScene { size, obstacles, start: [0.0; 2], goal: [0.0; 2] };
        let Ok(mut robot) = scene.robot() else { continue };
        let mut free = || {
            let q = [0, 1].map(|k| rounded(rng.random_range(0.0..size[k])));
            (robot.clearance(&q.into(), 1.0) > 0.01).then_some(q)
        };
        let mut found = (0..200).filter_map(|_| free());
        let (Some(start), Some(goal)) = (found.next(), found.next()) else { continue };
        (scene.start, scene.goal) = (start, goal);
        let apart = (Vector2::from(goal) - Vector2::from(start)).norm();
        if apart >= 3.0 && connected(&scene) {
            return scene;
        }
    }
}

fn rounded(v: f64) -> f64 {
    (v * 1e4).round() / 1e4
}

/// A convex block of four to six corners at a random place; its corners lie on an ellipse with a longer radius from `radii`.
fn block(rng: &mut Rng, size: [f64; 2], [small, large]: [f64; 2]) -> Vec<[f64; 2]> {
    let center = Vector2::new(rng.random_range(0.0..size[0]), rng.random_range(0.0..size[1]));
    let corners = rng.random_range(4..=6);
    let (long, slim) = (rng.random_range(small..large), rng.random_range(0.3..1.0));
    let turn = rng.random_range(0.0..std::f64::consts::PI);
    let phase = rng.random_range(0.0..1.0);
    let corner = |i: usize| {
        let (s, c) = mp_math::sin_cos(std::f64::consts::TAU * (i as f64 + phase) / f64::from(corners));
        let (sin, cos) = mp_math::sin_cos(turn);
        let (x, y) = (long * c, long * slim * s);
        [rounded(center.x + cos * x - sin * y), rounded(center.y + sin * x + cos * y)]
    };
    (0..corners as usize).map(corner).collect()
}

/// `scene` with `count` random blocks inside the room, at least `gap` metres from each other, and away from start
/// and goal.
fn scattered(mut scene: DiscScene, count: usize, radii: [f64; 2], gap: f64, seed: u64) -> DiscScene {
    let mut rng = Rng::seed(seed);
    let world_of = |rings: &[Vec<[f64; 2]>]| {
        let polygons = rings.iter().filter_map(|ring| Polygon::outlined(ring.iter().copied()).ok());
        PlanarWorld::new(polygons.collect(), None).ok()
    };
    let ends = [scene.start, scene.goal].map(Point2::from);
    let mut others = world_of(&scene.obstacles);
    while scene.obstacles.len() < count {
        let ring = block(&mut rng, scene.size, radii);
        let inside = ring.iter().all(|p| {
            p[0] > 0.05 && p[1] > 0.05 && p[0] < scene.size[0] - 0.05 && p[1] < scene.size[1] - 0.05
        });
        // A world takes long to make: that of the others is made again only when there is one more of them.
        let (true, Some(world)) = (inside, &others) else { continue };
        let sides = ring.iter().zip(ring.iter().skip(1).chain(ring.first()));
        let mut sides = sides.map(|(a, b)| (Point2::from(*a), Point2::from(*b)));
        if !sides.all(|(a, b)| world.nearest_to_segment(&a, &b, gap).is_none() && !world.contains(&a)) {
            continue;
        }
        let Some(own) = world_of(std::slice::from_ref(&ring)) else { continue };
        if own.edges() > 0 && ends.iter().all(|p| own.signed_distance(p) > 2.5 * RADIUS) {
            scene.obstacles.push(ring);
            others = world_of(&scene.obstacles);
        }
    }
    scene
}

/// Whether a grid of free motions leads from start to goal.
fn connected(scene: &DiscScene) -> bool {
    const CELL: f64 = 0.04;
    let Ok(mut robot) = scene.robot() else { return false };
    let counts = scene.size.map(|s| (s / CELL) as usize);
    let at = |i: usize, j: usize| Vector2::new((i as f64 + 0.5) * CELL, (j as f64 + 0.5) * CELL);
    let cell = |q: [f64; 2]| [0, 1].map(|k| ((q[k] / CELL) as usize).min(counts[k] - 1));
    let (from, to) = (cell(scene.start), cell(scene.goal));
    for (q, [i, j]) in [(scene.start, from), (scene.goal, to)] {
        if !robot.check_motion(&q.into(), &at(i, j)).is_free() {
            return false;
        }
    }
    let mut seen = vec![false; counts[0] * counts[1]];
    let mut open = VecDeque::from([from]);
    seen[from[1] * counts[0] + from[0]] = true;
    while let Some([i, j]) = open.pop_front() {
        if [i, j] == to {
            return true;
        }
        for (di, dj) in [(1, 0), (0, 1), (-1, 0), (0, -1)] {
            let (Some(x), Some(y)) = (i.checked_add_signed(di), j.checked_add_signed(dj)) else { continue };
            if x >= counts[0] || y >= counts[1] || seen[y * counts[0] + x] {
                continue;
            }
            if robot.check_motion(&at(i, j), &at(x, y)).is_free() {
                seen[y * counts[0] + x] = true;
                open.push_back([x, y]);
            }
        }
    }
    false
}

/// A scene by name: `maze`, `low`, `high`, or `random`, which is another one for each `trial`.
///
/// # Errors
/// When there is no such scene.
pub fn disc_scene(name: &str, trial: u64) -> Result<DiscScene, Error> {
    let scene = match name {
        "maze" => maze(),
        "low" => low(),
        "high" => high(),
        "random" => random(trial),
        _ => return Err(Error::new(format!("there is no scene `{name}`"))),
    };
    let mut robot = scene.robot()?;
    match [scene.start, scene.goal].iter().all(|q| robot.is_valid(&(*q).into())) {
        true => Ok(scene),
        false => Err(Error::new(format!("start or goal of the scene `{name}` is not free"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_as_in_the_paper_and_can_be_solved() {
        for (scene, count, size) in
            [(maze(), 4, [3.0, 3.0]), (low(), 17, [4.0, 3.0]), (high(), 48, [7.0, 4.0])]
        {
            assert_eq!((scene.obstacles.len(), scene.size), (count, size));
            assert!(connected(&scene));
        }
        assert!(connected(&follow()) && connected(&tight()));
        assert_eq!((tight().obstacles.len(), tight().size), (34, follow().size));
        for trial in 0..3 {
            let scene = random(trial);
            assert!((50..=80).contains(&scene.obstacles.len()) && connected(&scene));
            assert_eq!(scene, random(trial));
        }
        let blocked = DiscScene { obstacles: vec![bar([0.0, 1.0], [3.0, 1.1])], ..maze() };
        assert!(!connected(&blocked));
    }

    /// The files contain the scenes exactly.
    #[test]
    fn files_read_back() {
        let scene = high();
        let file = mp_io::PlanarFile::parse("high.toml", scene.text("48").as_bytes()).unwrap();
        let rings = |p: &Polygon| p.rings()[0].iter().map(|p| [p.x, p.y]).collect::<Vec<_>>();
        assert_eq!(file.obstacles.iter().map(|o| rings(&o.polygon)).collect::<Vec<_>>(), scene.obstacles);
        assert_eq!((file.walls, file.start), (Some([[0.0; 2], scene.size]), scene.start.to_vec()));
    }
}
