//! Random worlds: the files of a problem, and the same problem as the oracle knows it.

mod arms;
mod bodies;
mod jobs;
mod plane;
mod rigid;
mod shipped;

use crate::draw::Draw;
use crate::oracle::{Ask, Case, Drive, DriveKind, Timing};
use std::collections::BTreeMap;
use std::fmt::Write;

/// A problem without a planner.
#[derive(Clone, Debug)]
pub struct World {
    /// The file of the scene.
    pub main: String,
    /// The contents of all files by name.
    pub files: BTreeMap<String, Vec<u8>>,
    /// The problem as the oracle knows it.
    pub case: Case,
    /// A start or goal with more clearance (m) must be accepted: round bodies are meshes a little larger than
    /// they are, and checks have tolerances.
    pub margin: f64,
}

impl World {
    /// The world of a problem in TOML, beside other files.
    fn of_toml(text: String, mut files: BTreeMap<String, Vec<u8>>, case: Case, margin: f64) -> Self {
        let main = "scene.toml".to_owned();
        files.insert(main.clone(), text.into_bytes());
        Self { main, files, case, margin }
    }
}

/// A kind of world that is drawn, such as boxes or an arm.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// The word for it on the command line and in tallies.
    pub name: &'static str,
    /// What such a world holds, in a sentence.
    pub summary: &'static str,
    /// How often it is drawn, beside the others.
    pub weight: u32,
    make: fn(&mut Draw) -> World,
}

impl Kind {
    const fn new(
        name: &'static str,
        summary: &'static str,
        weight: u32,
        make: fn(&mut Draw) -> World,
    ) -> Self {
        Self { name, summary, weight, make }
    }

    /// A random world of this kind.
    #[must_use]
    pub fn make(&self, draw: &mut Draw) -> World {
        (self.make)(draw)
    }

    /// The kind called `name`.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        KINDS.iter().find(|kind| kind.name == name)
    }

    /// A kind drawn at random, by the weights.
    pub fn drawn(draw: &mut Draw) -> &'static Self {
        let mut left = draw.below(KINDS.iter().map(|kind| kind.weight as usize).sum());
        for kind in &KINDS {
            match left.checked_sub(kind.weight as usize) {
                Some(rest) => left = rest,
                None => return kind,
            }
        }
        &KINDS[0]
    }
}

/// All kinds of worlds.
pub const KINDS: [Kind; 14] = [
    Kind::new("space", "rigid body in space among figures", 4, rigid::space),
    Kind::new("soup", "rigid body among loose triangles", 4, rigid::soup),
    Kind::new("flat-mesh", "mesh that stays in the plane", 2, rigid::flat),
    Kind::new("space-moving", "rigid body, obstacles move", 2, rigid::moving),
    Kind::new("flyer", "rigid body by inputs, obstacles may move", 1, rigid::flyer),
    Kind::new("disc", "disc in the plane", 4, plane::disc),
    Kind::new("polygon", "polygon in the plane", 4, plane::polygon),
    Kind::new("plane-moving", "disc or polygon, obstacles move", 3, plane::moving),
    Kind::new("driven", "car, unicycle, … in the plane", 3, plane::driven),
    Kind::new("driven-moving", "car, unicycle, …, obstacles move", 2, plane::driven_moving),
    Kind::new("arm", "arm, also by inputs", 4, arms::arm),
    Kind::new("floating", "body with joints that flies", 2, arms::floating),
    Kind::new(
        "jobs",
        "arms on bases that move or stand, held joints, things carried, two robots, clouds of points",
        4,
        jobs::jobs,
    ),
    Kind::new("shipped", "shipped scenes, other starts and goals", 1, shipped::shipped),
];

/// A list of numbers as TOML writes it.
fn list(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(|x| format!("{x:?}")).collect();
    format!("[{}]", numbers.join(", "))
}

/// Rows of numbers as TOML writes them.
fn lists<'r>(rows: impl IntoIterator<Item = &'r [f64]>) -> String {
    let rows: Vec<String> = rows.into_iter().map(list).collect();
    format!("[{}]", rows.join(", "))
}

/// How many ends are drawn before one is taken as it is.
const TRIES: usize = 60;
/// Starts and goals that are taken as drawn, free or not.
const UNSEEN: f64 = 0.02;

/// A configuration with more than the margin of clearance, if one is found; rarely any configuration.
fn end(draw: &mut Draw, case: &Case, margin: f64, mut make: impl FnMut(&mut Draw) -> Vec<f64>) -> Vec<f64> {
    let any = draw.chance(UNSEEN);
    let mut row = make(draw);
    for _ in 0..TRIES {
        if any || case.clearance_at(&row).is_ok_and(|clearance| clearance > margin) {
            break;
        }
        row = make(draw);
    }
    row
}

/// Goals around free configurations, and how TOML writes them.
fn goals(
    draw: &mut Draw,
    names: &[String],
    lengths: &[f64],
    mut free: impl FnMut(&mut Draw) -> Vec<f64>,
) -> (Vec<Vec<Ask>>, String) {
    let count = if draw.chance(0.2) { draw.count(2, 3) } else { 1 };
    let regions = draw.chance(0.25);
    let mut all = Vec::new();
    let mut texts = Vec::new();
    for _ in 0..count {
        let row = free(draw);
        if !regions {
            texts.push(list(&row));
            all.push(row.iter().map(|x| Ask::Exactly(*x)).collect());
            continue;
        }
        let mut goal = vec![Ask::Free; row.len()];
        let mut parts = Vec::new();
        for (i, x) in row.iter().enumerate() {
            match draw.below(3) {
                0 if i > 0 => {}
                1 => {
                    let ends = [x - draw.unit() * lengths[i], x + draw.unit() * lengths[i]];
                    goal[i] = Ask::Between(ends);
                    parts.push(format!("{} = {}", names[i], list(&ends)));
                }
                _ => {
                    goal[i] = Ask::Exactly(*x);
                    parts.push(format!("{} = {x:?}", names[i]));
                }
            }
        }
        texts.push(format!("{{ {} }}", parts.join(", ")));
        all.push(goal);
    }
    let text = match texts.len() {
        1 => format!("goal = {}", texts[0]),
        _ => format!("goals = [{}]", texts.join(", ")),
    };
    (all, text)
}

/// A goal as an interval of each number, for robots that move by inputs. Numbers of width zero are free.
fn wide_goal(draw: &mut Draw, names: &[String], row: &[f64], widths: &[f64]) -> (Vec<Ask>, String) {
    let mut goal = vec![Ask::Free; row.len()];
    let mut parts = Vec::new();
    for (i, (x, width)) in row.iter().zip(widths).enumerate() {
        // Numbers after the first two may be free.
        if i < 2 || (*width > 0.0 && draw.chance(0.3)) {
            let ends = [x - width, x + width];
            goal[i] = Ask::Between(ends);
            parts.push(format!("{} = {}", names[i], list(&ends)));
        }
    }
    (goal, format!("goal = {{ {} }}", parts.join(", ")))
}

/// How a robot moves by velocities, or by accelerations if there are any: as the oracle has it, and as TOML
/// writes it.
fn by_rates(longest: f64, speeds: Vec<f64>, accelerations: Option<Vec<f64>>) -> (Drive, Vec<String>) {
    let mut lines = vec![format!("speeds = {}", list(&speeds)), format!("duration = {longest:?}")];
    let limits = |most: &[f64]| most.iter().map(|x| [-x, *x]).collect();
    let drive = match accelerations {
        None => {
            lines.push("kind = \"velocities\"".to_owned());
            let limits = limits(&speeds);
            Drive { kind: DriveKind::Velocities, limits, velocities: Vec::new(), longest }
        }
        Some(most) => {
            lines.push(format!("kind = \"accelerations\"\naccelerations = {}", list(&most)));
            let limits = limits(&most);
            Drive { kind: DriveKind::Accelerations, limits, velocities: speeds, longest }
        }
    };
    (drive, lines)
}

/// The motion of a robot among obstacles that move, as TOML writes it.
fn timed_motion(case: &Case, goal: String) -> Vec<String> {
    let configuration = &case.start[..case.start.len() - 1];
    let mut lines = vec![format!("start = {}", list(configuration)), goal];
    if let Some(Timing { speed, start, goal: [first, last] }) = case.timing {
        lines.extend(speed.map(|speed| format!("speed = {speed:?}")));
        lines.push(format!("start_time = {start:?}\nhorizon = {last:?}"));
        if first > start {
            lines.push(format!("goal_time = {}", list(&[first, last])));
        }
    }
    lines
}

/// Writes a line.
fn line(text: &mut String, line: impl std::fmt::Display) {
    // Writing to a String does not fail.
    let _ = writeln!(text, "{line}");
}

/// Names as text.
fn names(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}
