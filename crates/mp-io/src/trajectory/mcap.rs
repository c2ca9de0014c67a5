//! Recordings in MCAP: trajectories, states of joints, frames and shapes as messages of ROS 2, which Foxglove, RViz and rerun show.
//! docs/formats/trajectory.md says what is written and read, and docs/decisions/dependencies.md why no crate does this.

mod cdr;
mod container;
mod messages;

use super::KnownJoints;
use super::ros::{Message, Point, Time, made};
use crate::TrajectoryFile;
use container::{Recorded, Topic, messages as read_messages};
use messages::{
    JOINT_STATE, JOINT_TRAJECTORY, MARKERS, TRANSFORMS, joint_state, joint_trajectory, markers,
    read_joint_state, read_joint_trajectory, transforms,
};
use mp_formats::columns::Column;
use mp_formats::error::{Error, ErrorKind};
use nalgebra::Isometry3;

/// What is expected of a file.
const WHAT: &str = "an MCAP file with one JointTrajectory or RobotTrajectory, or with JointState, of ROS 2";

/// The frame in which everything is.
const WORLD: &str = "world";

/// `RobotTrajectory` of MoveIt.
const ROBOT_TRAJECTORY: &str = "moveit_msgs/msg/RobotTrajectory";

/// A trajectory with what shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// The trajectory as a controller takes it.
    pub trajectory: TrajectoryFile,
    /// Positions and velocities of its joints at moments that are near to each other.
    pub sampled: TrajectoryFile,
    /// The bodies that move first, then those that stand still.
    pub bodies: Vec<RecordedBody>,
    /// The poses of the bodies that move, at each moment.
    pub poses: Vec<Vec<Isometry3<f64>>>,
}

/// A body of a [`Recording`].
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedBody {
    /// What the file calls it.
    pub name: String,
    /// Its shape, in its own frame.
    pub shape: RecordedShape,
    /// Its pose in its frame: in the world if it stands still.
    pub pose: Isometry3<f64>,
    /// Red, green, blue and opacity, from 0 to 1.
    pub color: [f32; 4],
}

/// A shape of a [`Recording`], metres.
#[derive(Clone, Debug, PartialEq)]
pub enum RecordedShape {
    /// The corners of triangles, three for each.
    Triangles(Vec<[f64; 3]>),
    /// The ends of lines, two for each.
    Lines(Vec<[f64; 3]>),
}

fn error(file: &str, message: String) -> Error {
    Error::new(ErrorKind::Content, file, message)
        .help("the format is described in docs/formats/trajectory.md")
}

fn nanoseconds(time: f64) -> u64 {
    (time * 1e9).round().max(0.0) as u64
}

impl Recording {
    /// A trajectory with nothing that shows it.
    #[must_use]
    pub fn of(trajectory: TrajectoryFile) -> Self {
        let sampled = TrajectoryFile { joints: trajectory.joints.clone(), ..TrajectoryFile::default() };
        Self { trajectory, sampled, bodies: Vec::new(), poses: Vec::new() }
    }

    /// The content of an MCAP file: the trajectory (`/joint_trajectory`) and all shapes (`/bodies`) at its beginning, the joints (`/joint_states`) and
    /// the frames of the bodies that move (`/tf`) at each moment. Times count from zero.
    #[must_use]
    pub fn to_mcap(&self) -> Vec<u8> {
        let topics = [
            ("/joint_trajectory", JOINT_TRAJECTORY),
            ("/bodies", MARKERS),
            ("/joint_states", JOINT_STATE),
            ("/tf", TRANSFORMS),
        ];
        let topics =
            topics.map(|(name, kind)| Topic { name, schema: kind.name, definition: kind.definition() });
        let frames = self.frames();
        let moving = self.poses.first().map_or(0, Vec::len);
        let message = |topic, time, bytes| container::Message { topic, time, bytes };
        let mut messages = vec![
            message(0, 0, joint_trajectory(&self.trajectory)),
            message(1, 0, markers(&self.bodies, &frames)),
        ];
        for (i, time) in self.sampled.times.iter().enumerate() {
            let time = nanoseconds(*time);
            messages.push(message(2, time, joint_state(self, i)));
            let poses = self.poses.get(i).map_or(&[][..], Vec::as_slice);
            messages.push(message(3, time, transforms(&frames[..moving], poses, time)));
        }
        container::written(&topics, &messages)
    }

    /// The frame of each body: one of its own, with a name that no other has, or the world.
    fn frames(&self) -> Vec<String> {
        let moving = self.poses.first().map_or(0, Vec::len);
        let mut frames: Vec<String> = Vec::new();
        for (i, body) in self.bodies.iter().enumerate() {
            let mut name = if i < moving { body.name.clone() } else { WORLD.to_owned() };
            let mut number = 1;
            while i < moving && (name == WORLD || frames.contains(&name)) {
                number += 1;
                name = format!("{} {number}", body.name);
            }
            frames.push(name);
        }
        frames
    }
}

/// A trajectory of an MCAP file: its only JointTrajectory or RobotTrajectory, or else its JointStates, which are joined by lines.
///
/// # Errors
/// As [`TrajectoryFile::parse`], and when there are several trajectories, or none.
pub(super) fn parse(
    file: &str,
    bytes: &[u8],
    wanted: &[Column],
    known: KnownJoints<'_>,
) -> Result<TrajectoryFile, Error> {
    let same = |schema: &str, name: &str| schema == name || schema == name.replace("/msg/", "/");
    let all = read_messages(file, bytes, |schema| {
        let known = [JOINT_TRAJECTORY.name, ROBOT_TRAJECTORY, JOINT_STATE.name];
        known.iter().any(|name| schema == *name || schema == name.replace("/msg/", "/"))
    })?;
    let broken =
        |it: &Recorded| error(file, format!("a message of {} ends too early, or is not of ROS 2", it.topic));
    if let Some(other) = all.iter().find(|it| it.encoding != "cdr") {
        let message =
            format!("messages of {} are in `{}`", other.topic, mp_formats::text::clipped(&other.encoding));
        return Err(error(file, message).expected("`cdr`, as ROS 2 records them"));
    }
    let is_state = |it: &&Recorded| same(&it.schema, JOINT_STATE.name);
    let (states, trajectories): (Vec<_>, Vec<_>) = all.iter().partition(is_state);
    match trajectories.as_slice() {
        [] => {}
        [only] => {
            let several = same(&only.schema, ROBOT_TRAJECTORY);
            let message = read_joint_trajectory(&only.bytes, several).ok_or_else(|| broken(only))?;
            return made(file, message, wanted, known);
        }
        more => return Err(error(file, format!("there are {} trajectories", more.len())).expected("one")),
    }
    let Some(first) = states.first() else {
        return Err(error(file, "there is no trajectory, and no state of joints".to_owned()).expected(WHAT));
    };
    if let Some(other) = states.iter().find(|it| it.topic != first.topic) {
        let message = format!("there are states of joints of {} and of {}", first.topic, other.topic);
        return Err(error(file, message).expected("one topic"));
    }
    let mut names = Vec::new();
    let mut points = Vec::new();
    let mut begin = None;
    for it in states {
        let ([sec, nanosec], its, positions) = read_joint_state(&it.bytes).ok_or_else(|| broken(it))?;
        let stamp = match [sec, nanosec] {
            [0, 0] => i128::from(it.time),
            _ => i128::from(sec) * 1_000_000_000 + i128::from(nanosec),
        };
        let since = stamp - *begin.get_or_insert(stamp);
        if points.is_empty() {
            names = its;
        } else if names != its {
            return Err(error(file, format!("the joints of {} change", it.topic))
                .expected("the same ones in the same order in all its messages")
                .help("record a topic to which one program alone writes"));
        }
        let time_from_start = Time::Seconds(since as f64 / 1e9);
        points.push(Point { positions, velocities: Vec::new(), accelerations: Vec::new(), time_from_start });
    }
    made(file, Message::of_joints(names, points), wanted, known)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TrajectoryKind;

    fn wanted() -> Vec<Column> {
        [("lift", "m"), ("elbow", "rad")].map(|(name, unit)| Column::new(name, unit)).to_vec()
    }

    fn recording() -> Recording {
        let trajectory = TrajectoryFile {
            joints: wanted(),
            times: vec![0.0, 0.5, 12.000000001],
            positions: vec![vec![0.1, -2.0], vec![1e-9, 3.0], vec![0.25, 1.5]],
            velocities: vec![vec![0.0, 0.0], vec![1e-7, -0.3], vec![0.0, 0.0]],
            ..TrajectoryFile::default()
        };
        let body = |name: &str, shape| RecordedBody {
            name: name.to_owned(),
            shape,
            pose: Isometry3::translation(1.0, 0.0, 0.0),
            color: [0.5, 0.5, 0.5, 1.0],
        };
        let triangle = RecordedShape::Triangles(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        Recording {
            sampled: trajectory.clone(),
            trajectory,
            bodies: vec![
                body("arm", triangle.clone()),
                body("arm", triangle),
                body("wall", RecordedShape::Lines(vec![[0.0; 3], [1.0; 3]])),
            ],
            poses: vec![vec![Isometry3::identity(); 2]; 3],
        }
    }

    fn read(bytes: &[u8]) -> Result<TrajectoryFile, String> {
        parse("t.mcap", bytes, &wanted(), KnownJoints::default()).map_err(|e| e.report())
    }

    #[test]
    fn what_is_written_reads_back() {
        let made = recording();
        assert_eq!(made.frames(), ["arm", "arm 2", "world"]);
        let bytes = made.to_mcap();
        assert_eq!(read(&bytes).unwrap(), made.trajectory);
        assert_eq!(TrajectoryKind::of("a/t.MCAP".as_ref()), Some(TrajectoryKind::Mcap));
        // With accelerations, and joints in another order.
        let full = TrajectoryFile { accelerations: vec![vec![1.0, 2.0]; 3], ..made.trajectory.clone() };
        let bytes = Recording { trajectory: full.clone(), ..made.clone() }.to_mcap();
        assert_eq!(read(&bytes).unwrap(), full);
        let turned = [Column::new("elbow", "rad"), Column::new("lift", "m")];
        assert_eq!(parse("t", &bytes, &turned, KnownJoints::default()).unwrap().positions[0], [-2.0, 0.1]);
        for cut in 0..bytes.len() {
            // What is behind the data is not needed.
            if let Ok(read) = read(&bytes[..cut]) {
                assert_eq!(read, full);
            }
        }
    }

    /// A file of messages of one type.
    fn of(kind: &messages::Type, all: &[(u64, Vec<u8>)]) -> Vec<u8> {
        let topics = [Topic { name: "/t", schema: kind.name, definition: kind.definition() }];
        let all = all.iter().map(|(time, bytes)| container::Message {
            topic: 0,
            time: *time,
            bytes: bytes.clone(),
        });
        container::written(&topics, &all.collect::<Vec<_>>())
    }

    #[test]
    fn states_of_joints_are_joined_by_lines() {
        let made = recording();
        let all: Vec<_> = (0..3).map(|i| (i as u64, joint_state(&made, i))).collect();
        let read_back = read(&of(&JOINT_STATE, &all)).unwrap();
        assert_eq!(read_back, TrajectoryFile { velocities: Vec::new(), ..made.trajectory.clone() });
        let two = [0, 1].map(|_| (0, joint_trajectory(&made.trajectory)));
        assert!(read(&of(&JOINT_TRAJECTORY, &two)).unwrap_err().contains("2 trajectories"));
        assert!(read(&of(&JOINT_STATE, &all[..0])).unwrap_err().contains("no trajectory"));
        let twice = [all[1].clone(), all[1].clone()];
        let error = TrajectoryFile::parse("t", &of(&JOINT_STATE, &twice), TrajectoryKind::Mcap, &wanted());
        assert!(error.unwrap_err().report().contains("times that increase"));
        let short = [(0, all[0].1[..30].to_vec())];
        assert!(read(&of(&JOINT_STATE, &short)).unwrap_err().contains("/t ends too early"));
        let states = |made: &Recording| [0, 1].map(|i| (i as u64, joint_state(made, i)));
        let mut odd = recording();
        odd.sampled.positions[1][0] = f64::NAN;
        assert!(read(&of(&JOINT_STATE, &states(&odd))).unwrap_err().contains("a position of point 2 is NaN"));
        odd = recording();
        odd.sampled.joints.swap(0, 1);
        let [[first, _], [_, second]] = [states(&made), states(&odd)];
        assert!(read(&of(&JOINT_STATE, &[first, second])).unwrap_err().contains("one program alone"));
        assert!(read(b"PK").unwrap_err().contains("does not begin as MCAP"));
    }
}
