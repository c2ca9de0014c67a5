//! `trajectory_msgs/JointTrajectory` of ROS as JSON and YAML, also inside of `RobotTrajectory` and `DisplayTrajectory` of MoveIt.

use super::{Follower, GUIDE, KnownJoints, TrajectoryFile};
use crate::yaml;
use mp_formats::columns::{Column, Fault, HELP, Matching, bracketed};
use mp_formats::error::{Error, ErrorKind};
use mp_formats::files::decode;
use mp_formats::json;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Any of the messages. Other members are skipped.
#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Message {
    joint_names: Option<Vec<String>>,
    points: Option<Vec<Point>>,
    joint_trajectory: Option<Box<Message>>,
    multi_dof_joint_trajectory: Option<Joints>,
    trajectory: Option<Several>,
    trajectory_start: Option<State>,
    #[serde(flatten)]
    others: BTreeMap<String, Value>,
}

/// Where the robot is before, in messages of MoveIt.
#[derive(Default, Deserialize)]
#[serde(default)]
struct State {
    joint_state: JointState,
    attached_collision_objects: Vec<Attached>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Attached {
    object: Named,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Named {
    id: String,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct JointState {
    name: Vec<String>,
    position: Vec<f64>,
}

const START: f64 = TrajectoryFile::START;

/// What `trajectory` is: a list in DisplayTrajectory, one in answers of MoveIt's services.
#[derive(Deserialize)]
#[serde(untagged)]
enum Several {
    List(Vec<Message>),
    One(Box<Message>),
}

#[derive(Deserialize)]
struct Joints {
    #[serde(default)]
    joint_names: Vec<String>,
}

#[derive(Deserialize)]
pub(super) struct Point {
    #[serde(default)]
    pub(super) positions: Vec<f64>,
    #[serde(default)]
    pub(super) velocities: Vec<f64>,
    #[serde(default)]
    pub(super) accelerations: Vec<f64>,
    pub(super) time_from_start: Time,
}

impl Message {
    /// A `JointTrajectory`.
    pub(super) fn of_joints(names: Vec<String>, points: Vec<Point>) -> Self {
        Self { joint_names: Some(names), points: Some(points), ..Self::default() }
    }

    /// A `RobotTrajectory` of a `JointTrajectory`, beside one of these joints of several degrees of freedom.
    pub(super) fn beside(self, joint_names: Vec<String>) -> Self {
        Self {
            joint_trajectory: Some(Box::new(self)),
            multi_dof_joint_trajectory: Some(Joints { joint_names }),
            ..Self::default()
        }
    }
}

/// Seconds, or a duration of ROS 2 or of ROS.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a duration: `{\"sec\": 1, \"nanosec\": 500000000}`")]
pub(super) enum Time {
    Seconds(f64),
    Duration {
        #[serde(alias = "secs")]
        sec: i64,
        #[serde(alias = "nsecs", alias = "nsec")]
        nanosec: i64,
    },
}

impl Time {
    /// `None` when there are more nanoseconds than in a second, or fewer than none.
    fn seconds(&self) -> Option<f64> {
        match *self {
            Self::Seconds(seconds) => Some(seconds),
            // One rounding, so that whole nanoseconds read back.
            Self::Duration { sec, nanosec } => (0..1_000_000_000)
                .contains(&nanosec)
                .then(|| (i128::from(sec) * 1_000_000_000 + i128::from(nanosec)) as f64 / 1e9),
        }
    }
}

/// What is expected.
const WHAT: &str = "{\"joint_names\": [\"NAME\", …], \"points\": [{\"positions\": […], \"time_from_start\": {\"sec\": 0, \"nanosec\": 0}}, …]}";

fn guide() -> String {
    format!("the format is described in docs/formats/{GUIDE}")
}

/// Whether an object may be one of the messages.
fn is_message(value: &Value) -> bool {
    ["points", "joint_trajectory", "trajectory"].iter().any(|key| value.get(key).is_some())
}

/// As [`TrajectoryFile::parse_of`].
pub(super) fn parse_json(
    file: &str,
    bytes: &[u8],
    wanted: &[Column],
    known: KnownJoints<'_>,
) -> Result<Option<TrajectoryFile>, Error> {
    let text = decode(file, bytes)?;
    // What is no JSON is said by what reads the path.
    if !serde_json::from_str::<Value>(text).is_ok_and(|value| is_message(&value)) {
        return Ok(None);
    }
    let message: Message = json::parse(file, text, WHAT, &guide())?;
    made(file, message, wanted, known).map(Some)
}

/// As [`TrajectoryFile::parse_of`].
pub(super) fn parse_yaml(
    file: &str,
    bytes: &[u8],
    wanted: &[Column],
    known: KnownJoints<'_>,
) -> Result<Option<TrajectoryFile>, Error> {
    let value = yaml::value(file, decode(file, bytes)?)?;
    if !is_message(&value) {
        return Ok(None);
    }
    let message = serde_json::from_value(value)
        .map_err(|e| Error::new(ErrorKind::Format, file, e.to_string()).expected(WHAT).help(guide()))?;
    made(file, message, wanted, known).map(Some)
}

/// Leader and follower are written in so many digits at least, rad or m.
const FOLLOWS: f64 = 1e-4;

/// A follower beside its leader in the rows of a message.
struct Beside<'f> {
    at: usize,
    leader: usize,
    by: &'f Follower,
}

impl<'f> Beside<'f> {
    /// The followers among joints of these names, which are no numbers of a configuration themselves.
    fn all(names: &[String], followers: &'f [Follower]) -> Vec<Self> {
        let named = |name: &str| names.iter().position(|other| other == name);
        let both = |by: &'f Follower| Some(Self { at: named(&by.name)?, leader: named(&by.leader)?, by });
        followers.iter().filter_map(both).collect()
    }

    /// How far the follower is from where it should be, if that is too far. The offset counts for positions alone.
    fn off(&self, row: &[f64], offset: f64) -> Option<String> {
        let (Follower { name, leader, multiplier, .. }, at) = (self.by, row[self.at]);
        let wanted = multiplier * row[self.leader] + offset;
        let there = (at - wanted).abs() <= FOLLOWS * multiplier.abs().max(1.0);
        (!there).then(|| format!("{name} is {at}, and as it follows {leader} it would be {wanted}"))
    }
}

/// The trajectory of a message.
pub(super) fn made(
    file: &str,
    message: Message,
    wanted: &[Column],
    known: KnownJoints<'_>,
) -> Result<TrajectoryFile, Error> {
    let error = |message: String| Error::new(ErrorKind::Content, file, message).help(guide());
    let with_units = message.joint_names.iter().flatten().any(|name| bracketed(name).is_some());
    if let Some(key) = json::foreign_units(&message.others).filter(|_| !with_units) {
        return Err(error(json::not_in_radians(key))
            .expected("\"joint_names\": [\"NAME [deg]\", …]")
            .help("say the unit of each joint by its name, or remove this member if it is not so"));
    }
    let several = message.multi_dof_joint_trajectory.is_some_and(|joints| !joints.joint_names.is_empty());
    if several {
        return Err(error("a joint of several degrees of freedom moves, such as a base".to_owned()));
    }
    let State { joint_state: start, attached_collision_objects } =
        message.trajectory_start.unwrap_or_default();
    let attached: Vec<_> =
        attached_collision_objects.into_iter().map(|attached| attached.object.id).collect();
    let begins = |mut read: TrajectoryFile| {
        read.start = start.name.iter().cloned().zip(start.position.iter().copied()).collect();
        read.attached.clone_from(&attached);
        let off = |(i, (column, first)): (usize, (&Column, &f64))| {
            let at = start.name.iter().position(|name| *name == column.name)?;
            let state = start.position.get(at)?;
            let turns =
                if known.endless.get(i) == Some(&true) { ((state - first) / TAU).round() } else { 0.0 };
            let there = (state - first - turns * TAU).abs() <= START;
            (!there).then(|| format!("{} is {state} there and {first} at the first point", column.name))
        };
        let first = read.positions.first().into_iter().flatten();
        match read.joints.iter().zip(first).enumerate().find_map(off) {
            None => Ok(read),
            Some(off) => Err(error(format!("it does not begin at `trajectory_start`: {off}"))
                .expected(format!("at most {START} between them, as MoveIt has it"))),
        }
    };
    match (message.joint_trajectory, message.trajectory) {
        (Some(inner), _) | (None, Some(Several::One(inner))) => {
            return made(file, *inner, wanted, known).and_then(begins);
        }
        (None, Some(Several::List(mut all))) => {
            let count = all.len();
            return match (all.pop(), count) {
                (Some(only), 1) => made(file, only, wanted, known).and_then(begins),
                _ => Err(error(format!("there are {count} trajectories")).expected("one")),
            };
        }
        (None, None) => {}
    }
    let (Some(names), Some(points)) = (message.joint_names, message.points) else {
        return Err(error("there are no `joint_names` or no `points`".to_owned()).expected(WHAT));
    };
    if points.is_empty() {
        return Err(error("the trajectory has no points".to_owned()));
    }
    let faulty = |fault: Fault| error(fault.message).expected(fault.expected).help(HELP);
    let beside = Beside::all(&names, known.followers);
    let own = |at: usize| beside.iter().all(|follower| follower.at != at);
    let matched: Vec<_> =
        names.iter().enumerate().filter(|(at, _)| own(*at)).map(|(_, n)| n.clone()).collect();
    let matching = Matching::new(&matched, wanted).map_err(faulty)?;
    let mut read = TrajectoryFile { joints: wanted.to_vec(), ..TrajectoryFile::default() };
    let has = |numbers: fn(&Point) -> &Vec<f64>| points.iter().any(|point| !numbers(point).is_empty());
    let (velocities, accelerations) = (has(|point| &point.velocities), has(|point| &point.accelerations));
    for (i, point) in points.iter().enumerate() {
        let time = point.time_from_start.seconds().ok_or_else(|| {
            error(format!("the nanoseconds of the time of point {} are not those of a second", i + 1))
                .expected("0 to 999999999: whole seconds are in `sec`")
        })?;
        if !time.is_finite() {
            return Err(error(format!("the time of point {} is not finite", i + 1)));
        }
        read.times.push(time);
        for (what, numbers, needed, rows) in [
            ("position", &point.positions, true, &mut read.positions),
            ("velocity", &point.velocities, velocities, &mut read.velocities),
            ("acceleration", &point.accelerations, accelerations, &mut read.accelerations),
        ] {
            if !needed {
                continue;
            }
            let several =
                format!("{}s", what.strip_suffix('y').map_or(what.to_owned(), |stem| format!("{stem}ie")));
            if numbers.len() != names.len() {
                let found = match numbers.len() {
                    0 => format!("no {several}"),
                    1 => format!("1 {what}"),
                    count => format!("{count} {several}"),
                };
                let expected = format!("one for each of the {} joints", names.len());
                return Err(error(format!("point {} has {found}", i + 1)).expected(expected));
            }
            if let Some(number) = numbers.iter().find(|number| !number.is_finite()) {
                return Err(error(format!("a {what} of point {} is {number}", i + 1))
                    .expected("finite numbers")
                    .help("leave this point out, or record it again"));
            }
            let offset = |follower: &Beside<'_>| if what == "position" { follower.by.offset } else { 0.0 };
            if let Some(off) = beside.iter().find_map(|it| it.off(numbers, offset(it))) {
                return Err(error(format!("the {several} of point {}: {off}", i + 1))
                    .expected(format!("at most {FOLLOWS} between them"))
                    .help("leave the joints that follow others out: they move with them"));
            }
            let numbers: Vec<_> =
                numbers.iter().enumerate().filter(|(at, _)| own(*at)).map(|(_, number)| *number).collect();
            rows.push(matching.configuration(&numbers).map_err(faulty)?);
        }
    }
    Ok(read)
}

/// A list of numbers that JSON, YAML 1.1 and YAML 1.2 read as such: with a point, and without an exponent.
fn list(numbers: Option<&Vec<f64>>) -> String {
    let word = |x: &f64| {
        let word = x.to_string();
        if word.contains('.') { word } else { word + ".0" }
    };
    let words: Vec<String> = numbers.into_iter().flatten().map(word).collect();
    format!("[{}]", words.join(", "))
}

/// Whole seconds, and nanoseconds.
fn duration(time: f64) -> [i64; 2] {
    let all = (time * 1e9).round() as i64;
    [all.div_euclid(1_000_000_000), all.rem_euclid(1_000_000_000)]
}

/// The names of the joints, between quotes.
fn names(trajectory: &TrajectoryFile) -> String {
    let names: Vec<_> = trajectory.joints.iter().map(|joint| &joint.name).collect();
    serde_json::to_string(&names).unwrap_or_default()
}

/// Positions, velocities and accelerations of each point as lists, and its time: seconds and nanoseconds.
fn points(trajectory: &TrajectoryFile) -> impl Iterator<Item = ([String; 3], [i64; 2])> {
    let TrajectoryFile { times, positions, velocities, accelerations, .. } = trajectory;
    let point = |(i, time): (usize, &f64)| {
        ([positions.get(i), velocities.get(i), accelerations.get(i)].map(list), duration(*time))
    };
    times.iter().enumerate().map(point)
}

/// As [`TrajectoryFile::to_text`].
pub(super) fn json_text(trajectory: &TrajectoryFile) -> String {
    let mut out = format!("{{\"joint_names\": {}, \"points\": [", names(trajectory));
    for (i, ([p, v, a], [sec, nanosec])) in points(trajectory).enumerate() {
        let _ = write!(
            out,
            "{}\n{{\"positions\": {p}, \"velocities\": {v}, \"accelerations\": {a}, \"effort\": [], \
             \"time_from_start\": {{\"sec\": {sec}, \"nanosec\": {nanosec}}}}}",
            if i > 0 { "," } else { "" }
        );
    }
    out + "\n]}\n"
}

/// As [`TrajectoryFile::to_text`].
pub(super) fn yaml_text(trajectory: &TrajectoryFile) -> String {
    let mut out = format!("joint_names: {}\npoints:\n", names(trajectory));
    for ([p, v, a], [sec, nanosec]) in points(trajectory) {
        let _ = writeln!(
            out,
            "- positions: {p}\n  velocities: {v}\n  accelerations: {a}\n  effort: []\n  \
             time_from_start: {{sec: {sec}, nanosec: {nanosec}}}"
        );
    }
    out
}
