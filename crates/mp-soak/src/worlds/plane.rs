//! Worlds of the plane: discs, polygons, and robots that move by inputs.

use super::{World, by_rates, end, goals, line, list, lists, names, timed_motion, wide_goal};
use crate::draw::Draw;
use crate::oracle::{Body, Case, Drive, DriveKind, Mover, Moves, Shape, Timing};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Files accept coordinates up to twice this (m).
const FARTHEST: f64 = 5e8;

/// The sides of the room, before it is scaled.
const SIDE: f64 = 10.0;

/// An outline, before it is scaled.
#[derive(Clone, Debug)]
enum Outline {
    Rectangle([[f64; 2]; 2]),
    Circle([f64; 3]),
    /// The outer ring, then holes.
    Rings(Vec<Vec<[f64; 2]>>),
}

impl Outline {
    fn toml(&self) -> String {
        let ring = |ring: &Vec<[f64; 2]>| lists(ring.iter().map(|p| &p[..]));
        match self {
            Self::Rectangle([low, high]) => format!("rectangle = {}", lists([&low[..], &high[..]])),
            Self::Circle(numbers) => format!("circle = {}", list(numbers)),
            Self::Rings(rings) if rings.len() > 1 => {
                let holes: Vec<String> = rings[1..].iter().map(ring).collect();
                format!("polygon = {}\nholes = [{}]", ring(&rings[0]), holes.join(", "))
            }
            Self::Rings(rings) => format!("polygon = {}", ring(&rings[0])),
        }
    }

    fn shape(&self) -> Shape {
        match self {
            Self::Rectangle([[a, b], [c, d]]) => {
                Shape::Rings { rings: vec![vec![[*a, *b], [*c, *b], [*c, *d], [*a, *d]]], filled: true }
            }
            Self::Circle([x, y, radius]) => Shape::Disc { middle: [*x, *y], radius: *radius },
            Self::Rings(rings) => Shape::Rings { rings: rings.clone(), filled: true },
        }
    }

    fn round(&self) -> f64 {
        if let Self::Circle([.., radius]) = self { *radius } else { 0.0 }
    }
}

/// What is there before it is written.
struct Room {
    scale: f64,
    low: [f64; 2],
    high: [f64; 2],
    /// Where the origin of the robot may be, if that is less than the room.
    bounds: Option<[[f64; 2]; 2]>,
    /// The robot: its radius, or its corners.
    robot: Result<f64, Vec<[f64; 2]>>,
    obstacles: Vec<Outline>,
    moving: Vec<(Outline, Vec<[f64; 4]>)>,
}

/// A ring around a point, star-shaped: convex or not.
fn star(draw: &mut Draw, [x, y]: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let corners = draw.count(3, 9);
    let spiky = draw.chance(0.4);
    let begin = draw.within(0.0, 2.0 * PI);
    let corner = |i: usize| {
        let part = (i as f64 + draw.within(-0.3, 0.3)) / corners as f64;
        let out = radius * if spiky { draw.within(0.15, 1.0) } else { draw.within(0.85, 1.0) };
        let angle = begin + 2.0 * PI * part;
        [x + out * mp_math::cos(angle), y + out * mp_math::sin(angle)]
    };
    (0..corners).map(corner).collect()
}

impl Room {
    fn new(draw: &mut Draw, turning: bool) -> Self {
        let scale = if draw.chance(0.7) { 1.0 } else { draw.logarithmic(1e-4, 1e4) };
        let far = if draw.chance(0.85) { 0.0 } else { (scale * draw.logarithmic(10.0, 1e6)).min(FARTHEST) };
        let low = [draw.within(-far, far), draw.within(-far, far)];
        let high = [low[0] + scale * SIDE, low[1] + scale * SIDE * draw.within(0.4, 1.0)];
        let size = scale * draw.logarithmic(0.05, 0.8);
        let robot = match turning {
            false => Ok(size),
            true if draw.chance(0.3) => {
                // A long stick.
                let (half, thin) = (1.5 * size, size * draw.logarithmic(1e-3, 0.5));
                Err(vec![[-half, -thin], [half, -thin], [half, thin], [-half, thin]])
            }
            true => Err(star(draw, [0.0, 0.0], size)),
        };
        let mut room =
            Self { scale, low, high, bounds: None, robot, obstacles: Vec::new(), moving: Vec::new() };
        if draw.chance(0.3) {
            let inset = 0.02 * scale * SIDE;
            room.bounds = Some([[low[0] + inset, low[1] + inset], [high[0] - inset, high[1] - inset]]);
        }
        room
    }

    fn place(&self, draw: &mut Draw) -> [f64; 2] {
        [0, 1].map(|i| draw.within(self.low[i], self.high[i]))
    }

    fn outline(&self, draw: &mut Draw, at: [f64; 2], size: f64) -> Outline {
        let size = size * self.scale;
        match draw.below(6) {
            0 | 1 => {
                let half = [0, 1].map(|_| size * draw.logarithmic(0.02, 1.0));
                Outline::Rectangle([[at[0] - half[0], at[1] - half[1]], [at[0] + half[0], at[1] + half[1]]])
            }
            2 => Outline::Circle([at[0], at[1], size * draw.within(0.1, 0.8)]),
            3 => {
                // A frame with room inside of it.
                let outer = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
                let inner = draw.within(0.3, 0.97);
                let ring =
                    |by: f64| outer.map(|[x, y]| [at[0] + by * size * x, at[1] + by * size * y]).to_vec();
                Outline::Rings(vec![ring(1.0), ring(inner)])
            }
            _ => Outline::Rings(vec![star(draw, at, size)]),
        }
    }

    fn fill(&mut self, draw: &mut Draw, most: usize) {
        for _ in 0..draw.count(0, most) {
            let at = self.place(draw);
            let size = draw.within(0.3, 2.5);
            let outline = self.outline(draw, at, size);
            self.obstacles.push(outline);
        }
    }

    fn configuration(&self, draw: &mut Draw) -> Vec<f64> {
        let mut row = self.place(draw).to_vec();
        if self.robot.is_err() {
            row.push(if draw.chance(0.2) { *draw.one(&[0.0, PI, -0.5 * PI]) } else { draw.within(-PI, PI) });
        }
        row
    }

    fn case(&self) -> Case {
        let mut still: Vec<Body> = self
            .obstacles
            .iter()
            .enumerate()
            .map(|(i, outline)| Body::new(format!("obstacle {}", i + 1), outline.shape(), 0))
            .collect();
        let ([a, b], [c, d]) = (self.low, self.high);
        let walls = Shape::Rings { rings: vec![vec![[a, b], [c, b], [c, d], [a, d]]], filled: false };
        still.push(Body::new("walls", walls, 0));
        let row = |[time, x, y, angle]: &[f64; 4]| {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * *angle);
            (*time, Isometry3::from_parts(Translation3::new(*x, *y, 0.0), turn))
        };
        let moving = self.moving.iter().enumerate().map(|(i, (outline, rows))| Mover {
            body: Body::new(format!("mover {}", i + 1), outline.shape(), 0),
            rows: rows.iter().map(row).collect(),
        });
        let shape = match &self.robot {
            Ok(radius) => Shape::Disc { middle: [0.0; 2], radius: *radius },
            Err(ring) => Shape::Rings { rings: vec![ring.clone()], filled: true },
        };
        let [low, high] = self.bounds.unwrap_or([self.low, self.high]);
        let mut limits = vec![Some([low[0], high[0]]), Some([low[1], high[1]])];
        let moves = if self.robot.is_ok() {
            Moves::Point
        } else {
            limits.push(None);
            Moves::Plane
        };
        let extent = self.scale * SIDE;
        let far = [self.low, self.high].as_flattened().iter().fold(extent, |far, x| far.max(x.abs()));
        let case = Case::new(moves, vec![Body::new("robot", shape, 0)], limits, extent);
        Case { still, moving: moving.collect(), far, ..case }
    }

    fn margin(&self, case: &Case) -> f64 {
        let all = self.obstacles.iter().chain(self.moving.iter().map(|(outline, _)| outline));
        0.01 * all.map(Outline::round).fold(0.0, f64::max) + 1e-3 * case.robot[0].reach + 1e-8 * case.far
    }

    fn names(&self) -> Vec<String> {
        if self.robot.is_ok() { names(&["x", "y"]) } else { names(&["x", "y", "yaw"]) }
    }

    fn toml(&self, robot: &[String], motion: &[String]) -> String {
        let mut text = String::from("[world]\n");
        line(&mut text, format!("walls = {}", lists([&self.low[..], &self.high[..]])));
        if let Some([low, high]) = &self.bounds {
            line(&mut text, format!("bounds = {}", lists([&low[..], &high[..]])));
        }
        line(&mut text, "\n[robot]");
        match &self.robot {
            Ok(radius) => line(&mut text, format!("disc = {radius:?}")),
            Err(ring) => line(&mut text, format!("polygon = {}", lists(ring.iter().map(|p| &p[..])))),
        }
        robot.iter().for_each(|extra| line(&mut text, extra));
        line(&mut text, "\n[motion]");
        motion.iter().for_each(|extra| line(&mut text, extra));
        for (i, outline) in self.obstacles.iter().enumerate() {
            line(&mut text, format!("\n[[obstacle]]\nname = \"obstacle {}\"\n{}", i + 1, outline.toml()));
        }
        for (i, (outline, rows)) in self.moving.iter().enumerate() {
            line(&mut text, format!("\n[[moving]]\nname = \"mover {}\"\n{}", i + 1, outline.toml()));
            line(&mut text, format!("path = {}", lists(rows.iter().map(|row| &row[..]))));
        }
        text
    }

    fn world(self, case: Case, robot: &[String], motion: &[String]) -> World {
        let margin = self.margin(&case);
        World::of_toml(self.toml(robot, motion), BTreeMap::new(), case, margin)
    }
}

fn still(draw: &mut Draw, turning: bool) -> World {
    let mut room = Room::new(draw, turning);
    room.fill(draw, 9);
    let mut case = room.case();
    let margin = room.margin(&case);
    case.start = end(draw, &case, margin, |draw| room.configuration(draw));
    let length = 0.5 * room.scale;
    let free = |draw: &mut Draw| end(draw, &case, margin, |draw| room.configuration(draw));
    let (asked, goal) = goals(draw, &room.names(), &[length, length, 0.7], free);
    case.goals = asked;
    let motion = [format!("start = {}", list(&case.start)), goal];
    room.world(case, &[], &motion)
}

pub(super) fn disc(draw: &mut Draw) -> World {
    still(draw, false)
}

pub(super) fn polygon(draw: &mut Draw) -> World {
    still(draw, true)
}

/// Puts obstacles that move into a room. Returns for how long the robot has time.
fn add_moving(draw: &mut Draw, room: &mut Room) -> f64 {
    let horizon = draw.within(5.0, 60.0);
    for _ in 0..draw.count(1, 4) {
        let size = draw.within(0.1, 1.2);
        let at = [draw.within(-0.5, 0.5) * room.scale, draw.within(-0.5, 0.5) * room.scale];
        let outline = room.outline(draw, at, size);
        let mut time = draw.within(-0.1, 0.3) * horizon;
        let [mut x, mut y] = room.place(draw);
        let mut angle = draw.within(-PI, PI);
        let mut rows = Vec::new();
        for _ in 0..draw.count(1, 5) {
            rows.push([time, x, y, angle]);
            time += horizon * draw.within(0.05, 0.5);
            if draw.chance(0.8) {
                [x, y] = room.place(draw);
            }
            if draw.chance(0.6) {
                angle += draw.within(-2.5, 2.5);
            }
        }
        room.moving.push((outline, rows));
    }
    horizon
}

/// A disc or polygon among obstacles of which some move.
pub(super) fn moving(draw: &mut Draw) -> World {
    let turning = draw.chance(0.5);
    let mut room = Room::new(draw, turning);
    room.fill(draw, 5);
    let begin = if draw.chance(0.7) { 0.0 } else { draw.within(0.0, 5.0) };
    let horizon = begin + add_moving(draw, &mut room);
    let mut case = room.case();
    let margin = room.margin(&case);
    let speed = room.scale * draw.logarithmic(0.3, 30.0);
    let first = if draw.chance(0.6) { begin } else { begin + 0.3 * (horizon - begin) };
    case.timing = Some(Timing { speed: Some(speed), start: begin, goal: [first, horizon] });
    let at = |draw: &mut Draw, time: f64| {
        let mut row = room.configuration(draw);
        row.push(time);
        row
    };
    case.start = end(draw, &case, margin, |draw| at(draw, begin));
    let length = 0.5 * room.scale;
    let free = |draw: &mut Draw| {
        let mut row = end(draw, &case, margin, |draw| at(draw, horizon));
        row.pop();
        row
    };
    let (asked, goal) = goals(draw, &room.names(), &[length, length, 0.7], free);
    case.goals = asked;
    let motion = timed_motion(&case, goal);
    room.world(case, &[], &motion)
}

/// A car, a unicycle, or a robot with limited velocities or accelerations.
pub(super) fn driven(draw: &mut Draw) -> World {
    by_inputs(draw, false)
}

/// The same among obstacles that move.
pub(super) fn driven_moving(draw: &mut Draw) -> World {
    by_inputs(draw, true)
}

fn by_inputs(draw: &mut Draw, moves: bool) -> World {
    let which = draw.below(4);
    let turning = which < 2 || draw.chance(0.5);
    let mut room = Room::new(draw, turning);
    room.fill(draw, 5);
    let horizon = if moves { add_moving(draw, &mut room) } else { 0.0 };
    let mut case = room.case();
    let margin = room.margin(&case);
    let scale = room.scale;
    let time = draw.logarithmic(0.05, 2.0);
    let speed = scale * draw.logarithmic(0.3, 6.0);
    let reverse = draw.chance(0.6);
    let back = if reverse { -speed } else { 0.0 };
    let degrees = if turning { 3 } else { 2 };
    let rate = |draw: &mut Draw, i: usize| {
        if i < 2 { scale * draw.logarithmic(0.3, 6.0) } else { draw.within(0.3, 4.0) }
    };
    let speeds: Vec<f64> = (0..degrees).map(|i| rate(draw, i)).collect();
    let on_wheels = |kind: DriveKind, turn: f64, own: String| {
        let limits = vec![[back, speed], [-turn, turn]];
        let lines = format!("{own}\nspeed = {speed:?}\nreverse = {reverse}\nduration = {time:?}");
        (Drive { kind, limits, velocities: Vec::new(), longest: time }, vec![lines])
    };
    let (drive, robot) = match which {
        0 => {
            let wheelbase = scale * draw.logarithmic(0.1, 3.0);
            let steering = draw.within(0.1, 1.2);
            let own = format!("kind = \"car\"\nwheelbase = {wheelbase:?}\nsteering = {steering:?}");
            on_wheels(DriveKind::Car(wheelbase), steering, own)
        }
        1 => {
            let turn = draw.within(0.2, 4.0);
            on_wheels(DriveKind::Unicycle, turn, format!("kind = \"unicycle\"\nturning = {turn:?}"))
        }
        2 => by_rates(time, speeds, None),
        _ => by_rates(time, speeds, Some((0..degrees).map(|i| 2.0 * rate(draw, i)).collect())),
    };
    let resting = drive.velocities.len();
    case.drive = Some(drive);
    case.timing = moves.then_some(Timing { speed: None, start: 0.0, goal: [0.0, horizon] });
    let whole = |draw: &mut Draw, time: f64| {
        let mut row = room.configuration(draw);
        if moves {
            row.push(time);
        }
        row.extend(std::iter::repeat_n(0.0, resting));
        row
    };
    case.start = end(draw, &case, margin, |draw| whole(draw, 0.0));
    let row = end(draw, &case, margin, |draw| whole(draw, horizon));
    let wide = scale * draw.within(0.3, 1.2);
    let (goal, goal_text) = wide_goal(draw, &room.names(), &row[..degrees], &[wide, wide, 1.0][..degrees]);
    case.goals = vec![goal];
    let mut motion = vec![format!("start = {}", list(&case.start[..degrees])), goal_text];
    if moves {
        motion.push(format!("horizon = {horizon:?}"));
    }
    room.world(case, &robot, &motion)
}
