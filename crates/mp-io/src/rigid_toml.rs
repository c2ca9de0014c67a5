//! Rigid bodies among meshes in TOML: obstacles that move, and goals that leave something free.

use crate::drive::{DriveTable, Driven};
use crate::problem::{Body, PlacedBody, RigidProblem, SpaceKind};
use crate::problem_file::warn_of_degrees;
use crate::robot::{ObstacleTable, entry};
use crate::shape::{Meshes, Shaped};
use crate::toml_problem::{Exactly, GoalPart, MotionTable, Timing, TomlText, timed_rows};
use mp_formats::error::Error;
use mp_formats::files::{Files, MAX_TEXT_BYTES, decode, stem};
use mp_geom::{Aabb, TriMesh, pose_from_six};
use nalgebra::Point3;
use serde::Deserialize;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;

/// The page that describes the format.
const GUIDE: &str = "the format is described in docs/formats/rigid-problem.md";

/// The names of the numbers of a configuration, in space and in the plane.
const NAMES: [&str; 6] = ["x", "y", "z", "alpha", "beta", "gamma"];
/// The degrees of freedom of a robot that moves by inputs.
const DEGREES: [&str; 6] = ["x", "y", "z", "turn_x", "turn_y", "turn_z"];
/// The numbers that are not zero in the plane.
const IN_THE_PLANE: [usize; 3] = [0, 1, 3];

/// A mesh that moves.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidMoving {
    /// Its name in messages.
    pub name: String,
    /// Its mesh, in its own frame, metres.
    pub mesh: TriMesh,
    /// Where its frame is: time (s), then the six numbers of a pose, at increasing times.
    pub path: Vec<[f64; 7]>,
}

/// A rigid body among meshes of which some move, with goals that may leave something free; all files are read.
#[derive(Clone, Debug)]
pub struct RigidTask {
    /// The robot, the obstacles that stand still, the start, and an example of the first goal.
    pub problem: RigidProblem,
    /// The obstacles that move.
    pub moving: Vec<RigidMoving>,
    /// When the robot moves, if there are obstacles that move.
    pub timing: Option<Timing>,
    /// How the robot moves by inputs, if it does: its degrees of freedom are x, y, z, and turns about the axes of the world.
    pub driven: Option<Driven>,
    /// Its velocity at the start, one number for each degree of freedom; empty when it is at rest.
    pub velocity: Vec<f64>,
    /// What each goal asks of each of the six numbers, and then of the velocities if they are part of the state; at least one goal.
    pub goals: Vec<Vec<GoalPart>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    robot: Spanned<Shaped<RobotTable>>,
    motion: MotionTable,
    #[serde(default)]
    obstacle: Vec<Spanned<Shaped<ObstacleTable>>>,
    #[serde(default)]
    moving: Vec<Spanned<Shaped<MovingTable>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RobotTable {
    bounds: Option<Spanned<Exactly<Exactly<f64, 3>, 2>>>,
    planar: Option<bool>,
    kind: Option<Spanned<String>>,
    duration: Option<Spanned<f64>>,
    speeds: Option<Spanned<Vec<f64>>>,
    accelerations: Option<Spanned<Vec<f64>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MovingTable {
    name: Option<String>,
    path: Spanned<Vec<Vec<f64>>>,
}

impl RigidTask {
    /// Reads the problem at `path` and its meshes, whose names are relative to it.
    ///
    /// # Errors
    /// [`Error`] when a file cannot be read or makes no sense, with file, line and column.
    pub fn load_from(files: &dyn Files, path: &Path) -> Result<Self, Error> {
        Self::of_bytes(files, path, &files.read(path, MAX_TEXT_BYTES)?)
    }

    /// As [`load_from`](Self::load_from), from the content of the file.
    pub(crate) fn of_bytes(files: &dyn Files, path: &Path, bytes: &[u8]) -> Result<Self, Error> {
        let file = path.display().to_string();
        let text = decode(&file, bytes)?;
        let source = TomlText { file: &file, text, guide: GUIDE };
        let File { robot, motion, obstacle, moving } = source.read()?;
        let robot_span = robot.span();
        let mut meshes = Meshes::new(files, path);
        let body = robot.get_ref().shape(&source, "robot", &robot_span);
        let robot = robot.into_inner().own;
        let planar = robot.planar.unwrap_or(false);
        let table = DriveTable::by_numbers(robot.kind, robot.duration, robot.speeds, robot.accelerations);
        let driven = driven(&source, &robot_span, table, planar)?;
        let (from, mesh) = meshes.of(&source, "robot", &body?)?;
        // What moves has facets.
        let robot_body = Body { name: "robot".to_owned(), file: from, mesh: mesh.faceted() };

        let (mut obstacles, mut poses) = (Vec::new(), Vec::new());
        for (i, table) in obstacle.iter().enumerate() {
            let entry = entry(&source, i, table)?;
            if let Some(near) = &entry.self_filter {
                let message = "only points on robots of links are left out";
                return Err(source
                    .error(&near.span(), message)
                    .expected("no `self_filter` with a rigid body"));
            }
            let (file, mesh) = meshes.of(&source, &entry.name, &entry.shape)?;
            poses.push((entry.name.clone(), entry.pose));
            obstacles.push(PlacedBody { name: entry.name, file, mesh, pose: pose_from_six(entry.pose) });
        }
        let mut movers = Vec::new();
        for (i, table) in moving.iter().enumerate() {
            let MovingTable { name, path } = &table.get_ref().own;
            let name = name.clone().unwrap_or_else(|| format!("moving obstacle {}", i + 1));
            let shape = table.get_ref().shape(&source, &name, &table.span())?;
            let (_, mesh) = meshes.of(&source, &name, &shape)?;
            let expected = "rows [TIME, x, y, z] or [TIME, x, y, z, α, β, γ], times increasing";
            let shown = mp_formats::text::clipped(&name).to_string();
            let rows = timed_rows(&source, &shown, path, [6, 3], expected)?;
            let row = |row: &Vec<f64>| std::array::from_fn(|i| row.get(i).copied().unwrap_or(0.0));
            movers.push(RigidMoving { name, mesh, path: rows.iter().map(row).collect() });
        }

        let own: Vec<usize> = if planar { IN_THE_PLANE.to_vec() } else { (0..6).collect() };
        let names: Vec<String> = own.iter().map(|&i| NAMES[i].to_owned()).collect();
        let numbers = names.join(", ");
        let mut state_names = names.clone();
        if let Some(driven) = &driven {
            let degrees = driven.state_names(&DEGREES.map(str::to_owned));
            state_names.extend_from_slice(&degrees[DEGREES.len()..]);
        }
        let check = |what: &str, q: &Spanned<Vec<f64>>| {
            source.check(what, q.get_ref(), &q.span())?;
            if [own.len(), state_names.len()].contains(&q.get_ref().len()) {
                return Ok(());
            }
            let message = format!("{what} has {} numbers", q.get_ref().len());
            Err(source.error(&q.span(), message).expected(format!("{}: {numbers}", own.len())))
        };
        let by_inputs = driven.is_some();
        let motion = motion.read(&source, by_inputs && !movers.is_empty(), check)?;
        if let Some(place) = motion.places.tolerance.as_ref().filter(|_| !by_inputs) {
            let message = "only robots that move by inputs need a tolerance";
            return Err(source.error(place, message).expected("intervals in the goal: { x = [1.0, 1.2] }"));
        }
        match (movers.is_empty(), &motion.places.speed) {
            (false, None) if !by_inputs => {
                let message = "obstacles move, and the robot has no speed";
                let expected = "`speed = METRES_PER_SECOND` in [motion]";
                return Err(source.error(&motion.places.start, message).expected(expected));
            }
            (true, Some(place)) => {
                let message = "the robot has a speed, and nothing else moves";
                return Err(source
                    .error(place, message)
                    .expected("obstacles that move: `[[moving]]`, or no speed"));
            }
            _ => {}
        }
        let six = |values: &[f64]| {
            let mut six = [0.0; 6];
            own.iter().zip(values).for_each(|(&i, v)| six[i] = *v);
            six
        };
        let mut goals = Vec::new();
        for (i, goal) in motion.goals.iter().enumerate() {
            let place = motion.places.goal(i);
            let parts = goal.parts("the goal", &state_names, names.len(), motion.tolerance);
            let mut parts =
                parts.map_err(|[message, expected]| source.error(place, message).expected(expected))?;
            if by_inputs && parts.iter().any(|part| matches!(part, GoalPart::Exactly(_))) {
                let message = "a robot that moves by inputs cannot reach these numbers exactly";
                return Err(source
                    .error(place, message)
                    .expected("`tolerance = 0.1` in [motion], or intervals: { x = [1.0, 1.2] }"));
            }
            let velocities = parts.split_off(names.len());
            let mut all = vec![GoalPart::Exactly(0.0); 6];
            own.iter().zip(parts).for_each(|(&i, part)| all[i] = part);
            let pitch = std::f64::consts::FRAC_PI_2;
            let steep = match all[4] {
                GoalPart::Exactly(v) => v.abs() > pitch,
                GoalPart::Between([low, high]) => low < -pitch || high > pitch,
                GoalPart::Free => false,
            };
            if steep && (by_inputs || goal.values().is_none()) {
                let message = "beta of a goal that leaves something free is beyond a quarter turn";
                return Err(source.error(place, message).expected("beta from -π/2 to π/2"));
            }
            all.extend(velocities);
            goals.push(all);
        }
        let bounds = match &robot.bounds {
            None => None,
            Some(given) => {
                let Exactly([Exactly(low), Exactly(high)]) = *given.get_ref();
                source.check("the bounds", &[low, high].concat(), &given.span())?;
                // In the plane only x and y count.
                let axes = if planar { 2 } else { 3 };
                if (0..axes).any(|i| low[i] >= high[i]) {
                    let message = "the bounds enclose nothing";
                    return Err(source
                        .error(&given.span(), message)
                        .expected("the lower corner, then the upper"));
                }
                Some(Aabb::new(Point3::from(low), Point3::from(high)))
            }
        };
        let example = |part: &GoalPart, start: f64| match *part {
            GoalPart::Exactly(v) => v,
            GoalPart::Between([low, high]) => 0.5 * (low + high),
            GoalPart::Free => start,
        };
        let start = six(&motion.start[..own.len()]);
        let velocity = motion.start[own.len()..].to_vec();
        let goal: [f64; 6] = std::array::from_fn(|i| example(&goals[0][i], start[i]));
        let poses = poses.iter().map(|(name, pose)| (&**name, *pose));
        warn_of_degrees(files, path, [("the start", start), ("the goal", goal)].into_iter().chain(poses));
        let problem = RigidProblem {
            name: stem(path),
            space: if planar { SpaceKind::Se2 } else { SpaceKind::Se3 },
            robot: robot_body,
            obstacles,
            start: pose_from_six(start),
            goal: pose_from_six(goal),
            bounds,
        };
        crate::trace::problem(&problem.name, problem.obstacles.len() + movers.len());
        Ok(Self { problem, moving: movers, timing: motion.timing, driven, velocity, goals })
    }
}

/// How the robot moves by inputs, if it does.
fn driven(
    source: &TomlText<'_>,
    robot: &Range<usize>,
    table: DriveTable,
    planar: bool,
) -> Result<Option<Driven>, Error> {
    if let Some(kind) = table.kind.as_ref().filter(|_| planar) {
        let message = "a mesh in the plane does not move by inputs here";
        return Err(source
            .error(&kind.span(), message)
            .expected("a world of the plane with a polygon, or a mesh in space: no `planar`"));
    }
    let driven = table.read(source, robot, &["velocities", "accelerations"])?;
    if let Some(driven) = &driven {
        let wrong = driven.check(&DEGREES.map(str::to_owned));
        wrong.map_err(|[message, expected]| source.error(robot, message).expected(expected))?;
    }
    Ok(driven)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toml_problem::tests::is_clear;
    use mp_formats::files::Disk;

    const GOOD: &str = "[robot]\nbox = [0.4, 0.2, 0.2]\nbounds = [[-3, -3, -1], [3, 3, 1]]\n\n[motion]\n\
        start = [-2, 0, 0, 0, 0, 0]\ngoal = { x = 2, y = [-1, 1] }\nspeed = 1\n\n[[obstacle]]\nsphere = 0.3\n\
        pose = [0, 1, 0, 0, 0, 0]\n\n[[moving]]\nname = \"door\"\nbox = [0.1, 2, 2]\n\
        path = [[0, 0, 0, 0], [4, 0, 3, 0, 1, 0, 0]]\n";

    fn load(text: &str) -> Result<RigidTask, Error> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("task.toml");
        std::fs::write(&path, text).unwrap();
        RigidTask::load_from(&Disk, &path)
    }

    #[test]
    fn a_task_is_read() {
        let task = load(GOOD).unwrap();
        assert_eq!(task.problem.obstacles[0].name, "obstacle 1");
        assert_eq!(
            (task.moving[0].name.as_str(), task.moving[0].path[1]),
            ("door", [4.0, 0.0, 3.0, 0.0, 1.0, 0.0, 0.0])
        );
        assert_eq!(
            task.goals[0][..3],
            [GoalPart::Exactly(2.0), GoalPart::Between([-1.0, 1.0]), GoalPart::Free]
        );
        assert_eq!(task.timing.unwrap().speed, Some(1.0));
        let flat =
            GOOD.replace("bounds", "planar = true\nbounds").replace("[-2, 0, 0, 0, 0, 0]", "[-2, 0, 0.5]");
        let task = load(&flat).unwrap();
        assert_eq!((task.problem.space, task.goals[0][2]), (SpaceKind::Se2, GoalPart::Exactly(0.0)));
    }

    #[test]
    fn faults_have_their_place() {
        for (from, to, line, words) in [
            ("box = [0.4", "box = [0", 2, "the length in x of the box"),
            ("[-3, -3, -1]", "[-3, 4, -1]", 3, "enclose nothing"),
            ("[-2, 0, 0, 0, 0, 0]", "[-2, 0, 0]", 6, "the start has 3"),
            ("{ x = 2", "{ x = 2, beta = 2", 7, "a quarter turn"),
            ("{ x = 2", "{ yaw = 2", 7, "`yaw`"),
            ("speed = 1\n", "", 6, "no speed"),
            ("[4, 0, 3, 0, 1, 0, 0]", "[4, 0, 3]", 17, "has 3 numbers"),
            ("[4, 0, 3, 0, 1, 0, 0]", "[4, 0, 3, 0, 3.141592653589793, 0, 0]", 17, "which way it turns"),
            ("[4, 0, 3, 0, 1, 0, 0]", "[4, 0, 3, 0, 0, 0, -3.141592653589793]", 17, "which way it turns"),
            (
                "[0, 1, 0, 0, 0, 0]",
                "[0, 1, 0, 0, 0, 0, 1]",
                12,
                "invalid length 7, expected an array of length 6",
            ),
            ("pose = [0, 1, 0, 0, 0, 0]", "at = [0, 1, 0, 0]", 12, "length 4"),
            ("[3, 3, 1]]", "[3, 3, 1, 0]]", 3, "length 4"),
            ("[3, 3, 1]]", "[3, 3, 1], [0, 0, 0]]", 3, "length 3"),
            ("sphere = 0.3", "mesh = \"lost.off\"", 11, "no such file"),
            ("speed = 1", "tolerance = 1", 8, "only robots that move by inputs"),
        ] {
            assert!(GOOD.contains(from), "{from}");
            let error = load(&GOOD.replacen(from, to, 1)).unwrap_err();
            assert!(is_clear(&error, line, words), "{to}: {error}");
        }
    }
}
