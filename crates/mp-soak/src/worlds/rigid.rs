//! Rigid bodies among figures and loose triangles.

use super::bodies::{Form, form, loose, mesh_file, pose};
use super::{World, by_rates, end, goals, line, list, lists, names, timed_motion, wide_goal};
use crate::draw::Draw;
use crate::oracle::{Ask, Body, Case, Mover, Moves, Timing};
use nalgebra::{Isometry3, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Files accept coordinates up to twice this (m).
const FARTHEST: f64 = 5e8;

/// The half of each side of the room, before it is scaled.
const HALF: f64 = 5.0;

/// What is there before it is written.
struct Room {
    scale: f64,
    offset: Vector3<f64>,
    low: [f64; 3],
    high: [f64; 3],
    robot: Form,
    obstacles: Vec<(Form, [f64; 6])>,
    moving: Vec<(Form, Vec<[f64; 7]>)>,
    flat: bool,
}

/// A factor for all lengths: mostly one.
fn scale(draw: &mut Draw) -> f64 {
    if draw.chance(0.7) { 1.0 } else { draw.logarithmic(1e-4, 1e4) }
}

/// Where the middle of everything is: mostly at the origin.
fn offset(draw: &mut Draw, scale: f64) -> Vector3<f64> {
    if draw.chance(0.85) {
        return Vector3::zeros();
    }
    let far = (scale * draw.logarithmic(10.0, 1e6)).min(FARTHEST);
    Vector3::new(draw.within(-far, far), draw.within(-far, far), draw.within(-far, far))
}

/// An angle, also one of the special ones.
fn angle(draw: &mut Draw) -> f64 {
    if draw.chance(0.2) {
        *draw.one(&[0.0, 0.5 * PI, PI, -0.5 * PI, 0.25 * PI])
    } else {
        draw.within(-PI, PI)
    }
}

/// Three angles of a pose.
fn turned(draw: &mut Draw) -> [f64; 3] {
    if draw.chance(0.3) {
        return [0.0; 3];
    }
    [angle(draw), draw.within(-1.5, 1.5), angle(draw)]
}

impl Room {
    fn new(draw: &mut Draw) -> Self {
        let scale = scale(draw);
        let offset = offset(draw, scale);
        let half = scale * HALF;
        let corner = |sign: f64| [0, 1, 2].map(|i| offset[i] + sign * half);
        let (low, high) = (corner(-1.0), corner(1.0));
        let robot = Form::Box([1.0; 3]);
        Self { scale, offset, low, high, robot, obstacles: Vec::new(), moving: Vec::new(), flat: false }
    }

    /// Makes it a room of robots that stay in the plane, which is z = 0.
    fn flatten(&mut self) {
        self.flat = true;
        self.offset.z = 0.0;
        (self.low[2], self.high[2]) = (-HALF * self.scale, HALF * self.scale);
    }

    /// Adds obstacles, of which each is up to `largest` wide before it is scaled; `meshes` if all are meshes.
    fn furnish(&mut self, draw: &mut Draw, [least, most]: [usize; 2], largest: f64, meshes: bool) {
        for i in 0..draw.count(least, most) {
            let name = format!("obstacle-{}", i + 1);
            let size = draw.within(0.5, largest);
            let mut form = form(draw, size * self.scale, &name);
            if meshes {
                form = form.meshed(mesh_file(draw, &name));
            }
            let six = self.somewhere(draw);
            self.obstacles.push((form, six));
        }
    }

    fn place(&self, draw: &mut Draw) -> [f64; 3] {
        [0, 1, 2].map(|i| draw.within(self.low[i], self.high[i]))
    }

    fn somewhere(&self, draw: &mut Draw) -> [f64; 6] {
        let [x, y, mut z] = self.place(draw);
        if self.flat {
            z = self.scale * draw.within(-0.5, 0.5);
        }
        let [a, b, c] = turned(draw);
        [x, y, z, a, b, c]
    }

    fn configuration(&self, draw: &mut Draw) -> Vec<f64> {
        let [x, y, z] = self.place(draw);
        let [a, b, c] = turned(draw);
        if self.flat { vec![x, y, a] } else { vec![x, y, z, a, b, c] }
    }

    /// All bodies as the oracle knows them, without start and goals.
    fn case(&self) -> Case {
        let still = self.obstacles.iter().enumerate();
        let still: Vec<Body> =
            still.map(|(i, (form, six))| form.body(&format!("obstacle {}", i + 1), &pose(*six), 0)).collect();
        let moving = self.moving.iter().enumerate().map(|(i, (form, rows))| Mover {
            body: form.body(&format!("mover {}", i + 1), &Isometry3::identity(), 0),
            rows: rows.iter().map(|[t, six @ ..]| (*t, pose(*six))).collect(),
        });
        let own = (0..3).map(|i| Some([self.low[i], self.high[i]]));
        let (moves, limits) = match self.flat {
            true => (Moves::Plane, own.take(2).chain([None]).collect()),
            false => (Moves::Space, own.chain([None, None, None]).collect()),
        };
        let (robot, extent) = (self.robot.body("robot", &Isometry3::identity(), 0), 2.0 * HALF * self.scale);
        let far = self.offset.amax() + extent;
        Case { still, moving: moving.collect(), far, ..Case::new(moves, vec![robot], limits, extent) }
    }

    /// The clearance beyond which a start must be accepted.
    fn margin(&self, case: &Case) -> f64 {
        let forms =
            self.obstacles.iter().map(|(form, _)| form).chain(self.moving.iter().map(|(form, _)| form));
        let round = forms.chain([&self.robot]).map(Form::round).fold(0.0, f64::max);
        0.05 * round + 1e-3 * case.robot[0].reach + 1e-8 * case.far
    }

    fn names(&self) -> Vec<String> {
        if self.flat {
            names(&["x", "y", "alpha"])
        } else {
            names(&["x", "y", "z", "alpha", "beta", "gamma"])
        }
    }

    /// The widths of intervals of goals.
    fn widths(&self) -> Vec<f64> {
        let length = 0.4 * self.scale;
        if self.flat { vec![length, length, 0.5] } else { vec![length, length, length, 0.5, 0.05, 0.5] }
    }

    /// The file, with these lines in its tables.
    fn toml(&self, robot: &[String], motion: &[String]) -> (String, BTreeMap<String, Vec<u8>>) {
        let mut files = BTreeMap::new();
        let mut text = String::new();
        line(&mut text, "[robot]");
        line(&mut text, self.robot.toml());
        self.robot.write(&mut files);
        line(&mut text, format!("bounds = {}", lists([&self.low[..], &self.high[..]])));
        if self.flat {
            line(&mut text, "planar = true");
        }
        robot.iter().for_each(|extra| line(&mut text, extra));
        line(&mut text, "\n[motion]");
        motion.iter().for_each(|extra| line(&mut text, extra));
        for (i, (form, six)) in self.obstacles.iter().enumerate() {
            line(&mut text, format!("\n[[obstacle]]\nname = \"obstacle {}\"\n{}", i + 1, form.toml()));
            line(&mut text, format!("pose = {}", list(six)));
            form.write(&mut files);
        }
        for (i, (form, rows)) in self.moving.iter().enumerate() {
            line(&mut text, format!("\n[[moving]]\nname = \"mover {}\"\n{}", i + 1, form.toml()));
            line(&mut text, format!("path = {}", lists(rows.iter().map(|row| &row[..]))));
            form.write(&mut files);
        }
        (text, files)
    }

    /// The file of an environment: all shapes are meshes, and there is one goal.
    fn environment(&self, case: &Case) -> (String, BTreeMap<String, Vec<u8>>) {
        let mut files = BTreeMap::new();
        let mut text = String::new();
        let row = |numbers: &[f64]| numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(" ");
        let six = |q: &[f64]| if self.flat { row(&[q[0], q[1], 0.0, q[2], 0.0, 0.0]) } else { row(q) };
        let file = |form: &Form| match form {
            Form::Mesh(_, file) => file.clone(),
            _ => String::new(),
        };
        self.robot.write(&mut files);
        let goal: Vec<f64> =
            case.goals[0].iter().map(|ask| if let Ask::Exactly(x) = ask { *x } else { 0.0 }).collect();
        line(&mut text, format!("Robot\n{}\n{}\n{}\n", file(&self.robot), six(&case.start), six(&goal)));
        for (i, (form, six)) in self.obstacles.iter().enumerate() {
            form.write(&mut files);
            line(&mut text, format!("Obstacle #{}\n{}\n{}\n", i + 1, file(form), row(six)));
        }
        line(&mut text, format!("End\nSpace {}", if self.flat { "SE2" } else { "SE3" }));
        let [mut low, mut high] = [self.low, self.high];
        if self.flat {
            (low[2], high[2]) = (0.0, 0.0);
        }
        line(&mut text, format!("Bounds {} {}", row(&low), row(&high)));
        (text, files)
    }

    /// Draws start and goals, and writes all of it.
    fn finish(self, draw: &mut Draw) -> World {
        let mut case = self.case();
        let margin = self.margin(&case);
        case.start = end(draw, &case, margin, |draw| self.configuration(draw));
        let free = |draw: &mut Draw| end(draw, &case, margin, |draw| self.configuration(draw));
        let (asked, goal) = goals(draw, &self.names(), &self.widths(), free);
        case.goals = asked;
        let meshes = self.obstacles.iter().map(|(form, _)| form).chain([&self.robot]);
        let all_meshes = meshes.into_iter().all(|form| matches!(form, Form::Mesh(..)));
        let one_goal =
            case.goals.len() == 1 && case.goals[0].iter().all(|ask| matches!(ask, Ask::Exactly(_)));
        if all_meshes && one_goal && draw.chance(0.7) {
            let (text, mut files) = self.environment(&case);
            let main = "scene.env".to_owned();
            files.insert(main.clone(), text.into_bytes());
            return World { main, files, case, margin };
        }
        let (text, files) = self.toml(&[], &[format!("start = {}", list(&case.start)), goal]);
        World::of_toml(text, files, case, margin)
    }
}

/// A rigid body in space among figures.
pub(super) fn space(draw: &mut Draw) -> World {
    let mut room = Room::new(draw);
    let size = draw.within(0.3, 2.5);
    room.robot = form(draw, size * room.scale, "robot");
    room.furnish(draw, [1, 10], 6.0, false);
    if draw.chance(0.3) {
        // All of it as meshes, for environments.
        let robot = mesh_file(draw, "robot");
        room.robot = room.robot.meshed(robot);
        let as_mesh = |(i, (form, six)): (usize, (Form, [f64; 6]))| {
            (form.meshed(mesh_file(draw, &format!("obstacle-{}", i + 1))), six)
        };
        room.obstacles = room.obstacles.into_iter().enumerate().map(as_mesh).collect();
    }
    room.finish(draw)
}

/// A rigid body, perhaps of loose triangles too, among loose triangles.
pub(super) fn soup(draw: &mut Draw) -> World {
    let mut room = Room::new(draw);
    let size = draw.within(0.2, 2.0) * room.scale;
    room.robot = match draw.chance(0.5) {
        true => {
            let count = draw.count(1, 8);
            Form::Mesh(loose(draw, count, 0.5 * size), mesh_file(draw, "robot"))
        }
        false => {
            let file = mesh_file(draw, "robot");
            form(draw, size, "robot").meshed(file)
        }
    };
    for i in 0..draw.count(1, 4) {
        let count = draw.count(1, 16);
        let half = draw.within(0.5, HALF) * room.scale;
        let form = Form::Mesh(loose(draw, count, half), mesh_file(draw, &format!("obstacle-{}", i + 1)));
        let six = room.somewhere(draw);
        room.obstacles.push((form, six));
    }
    room.finish(draw)
}

/// A mesh that stays in the plane.
pub(super) fn flat(draw: &mut Draw) -> World {
    let mut room = Room::new(draw);
    room.flatten();
    let size = draw.within(0.3, 2.0);
    room.robot = form(draw, size * room.scale, "robot");
    let meshes = draw.chance(0.4);
    if meshes {
        let file = mesh_file(draw, "robot");
        room.robot = room.robot.meshed(file);
    }
    room.furnish(draw, [1, 8], 4.0, meshes);
    room.finish(draw)
}

/// Times and poses of something that moves across a room.
fn trajectory(draw: &mut Draw, room: &Room, horizon: f64) -> Vec<[f64; 7]> {
    let mut time = draw.within(-0.1, 0.3) * horizon;
    let mut six = room.somewhere(draw);
    let mut rows = Vec::new();
    for _ in 0..draw.count(1, 5) {
        rows.push([time, six[0], six[1], six[2], six[3], six[4], six[5]]);
        time += horizon * draw.within(0.05, 0.5);
        if draw.chance(0.7) {
            let [x, y, z] = room.place(draw);
            (six[0], six[1], six[2]) = (x, y, z);
        }
        if draw.chance(0.7) {
            six[3] += draw.within(-2.5, 2.5);
        }
    }
    rows
}

/// A rigid body among obstacles of which some move.
pub(super) fn moving(draw: &mut Draw) -> World {
    let mut room = Room::new(draw);
    if draw.chance(0.3) {
        room.flatten();
    }
    let (mut case, horizon) = timed(draw, &mut room);
    let speed = room.scale * draw.logarithmic(0.3, 30.0);
    let margin = room.margin(&case);
    let begin = if draw.chance(0.7) { 0.0 } else { draw.within(0.0, 5.0) };
    let horizon = begin + horizon;
    let [first, last] =
        if draw.chance(0.6) { [begin, horizon] } else { [begin + 0.3 * (horizon - begin), horizon] };
    case.timing = Some(Timing { speed: Some(speed), start: begin, goal: [first, last] });
    let with_time = |mut q: Vec<f64>, time: f64| {
        q.push(time);
        q
    };
    case.start = end(draw, &case, margin, |draw| with_time(room.configuration(draw), begin));
    let free = |draw: &mut Draw| {
        let mut q = end(draw, &case, margin, |draw| with_time(room.configuration(draw), last));
        q.pop();
        q
    };
    let (asked, goal) = goals(draw, &room.names(), &room.widths(), free);
    case.goals = asked;
    let (text, files) = room.toml(&[], &timed_motion(&case, goal));
    World::of_toml(text, files, case, margin)
}

/// Fills a room with what stands still and what moves. Returns the case and for how long the robot has time.
fn timed(draw: &mut Draw, room: &mut Room) -> (Case, f64) {
    let size = draw.within(0.3, 1.5);
    room.robot = form(draw, size * room.scale, "robot");
    room.furnish(draw, [0, 4], 4.0, false);
    let horizon = draw.within(5.0, 60.0);
    for i in 0..draw.count(1, 3) {
        let size = draw.within(0.3, 2.0);
        let form = form(draw, size * room.scale, &format!("mover-{}", i + 1));
        let rows = trajectory(draw, room, horizon);
        room.moving.push((form, rows));
    }
    (room.case(), horizon)
}

/// A rigid body that moves by velocities or accelerations.
pub(super) fn flyer(draw: &mut Draw) -> World {
    let mut room = Room::new(draw);
    let (mut case, horizon) = timed(draw, &mut room);
    let moves = draw.chance(0.4);
    if !moves {
        room.moving.clear();
        case.moving.clear();
    }
    let margin = room.margin(&case);
    let by_velocities = draw.chance(0.5);
    let far = 2.0 * HALF * room.scale;
    let time = draw.logarithmic(0.05, 2.0);
    let limit = |draw: &mut Draw, i: usize, length: f64| {
        if i < 3 { length * draw.within(0.1, 0.6) } else { draw.within(0.2, 3.0) }
    };
    let speeds: Vec<f64> = (0..6).map(|i| limit(draw, i, far)).collect();
    let accelerations: Vec<f64> = (0..6).map(|i| 2.0 * limit(draw, i, far)).collect();
    let (drive, robot) = by_rates(time, speeds, (!by_velocities).then_some(accelerations));
    let resting = drive.velocities.len();
    case.drive = Some(drive);
    case.timing = moves.then_some(Timing { speed: None, start: 0.0, goal: [0.0, horizon] });
    let whole = |mut q: Vec<f64>, time: f64| {
        if moves {
            q.push(time);
        }
        q.extend(std::iter::repeat_n(0.0, resting));
        q
    };
    case.start = end(draw, &case, margin, |draw| whole(room.configuration(draw), 0.0));
    let row = end(draw, &case, margin, |draw| whole(room.configuration(draw), horizon));
    let wide = room.scale * draw.within(1.5, 4.0);
    let (goal, text) = wide_goal(draw, &room.names(), &row[..6], &[wide, wide, wide, 1.5, 0.0, 1.5]);
    case.goals = vec![goal];
    let mut motion = vec![format!("start = {}", list(&case.start[..6])), text];
    if moves {
        motion.push(format!("horizon = {horizon:?}"));
    }
    let (text, files) = room.toml(&robot, &motion);
    World::of_toml(text, files, case, margin)
}
