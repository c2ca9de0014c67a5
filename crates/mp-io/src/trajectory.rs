//! Trajectories in files: comma-separated values with a column of times, `JointTrajectory` of ROS as JSON and YAML, alone or in messages
//! of MoveIt, and recordings in MCAP. docs/formats/trajectory.md describes them.

mod csv;
mod mcap;
mod ros;

pub use mcap::{RecordedBody, RecordedShape, Recording};

use mp_formats::columns::Column;
use mp_formats::error::{Error, ErrorKind};
use mp_formats::formats::Content;
use std::path::Path;

/// The points of a trajectory, as a file has them. Rows are in the order and in the units of [`joints`](Self::joints).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrajectoryFile {
    /// Name and unit (`rad` or `m`) of each joint.
    pub joints: Vec<Column>,
    /// The time (s) of each point.
    pub times: Vec<f64>,
    /// The position of each joint, at each point.
    pub positions: Vec<Vec<f64>>,
    /// The velocities (rad/s or m/s); empty if the file has none.
    pub velocities: Vec<Vec<f64>>,
    /// The accelerations (rad/s² or m/s²); empty if the file has none.
    pub accelerations: Vec<Vec<f64>>,
    /// Where joints are before (rad or m), by their names, in messages of MoveIt: also joints that are not in the trajectory.
    pub start: Vec<(String, f64)>,
    /// What is attached to the robot in messages of MoveIt, by name.
    pub attached: Vec<String>,
}

/// What is known of the joints of the robot beside their names and units.
#[derive(Clone, Copy, Debug, Default)]
pub struct KnownJoints<'r> {
    /// Which of the joints wanted turn without end, so that whole turns make no difference between the state before the trajectory, which
    /// messages of MoveIt have, and its first point. Those beyond the end do not.
    pub endless: &'r [bool],
    /// The joints that follow others. Messages of ROS may list them too, where they should be.
    pub followers: &'r [Follower],
}

/// A joint that follows another: it is at `multiplier` times the value of the leader plus `offset`.
#[derive(Clone, Debug, PartialEq)]
pub struct Follower {
    /// Its name.
    pub name: String,
    /// The name of the joint that it follows.
    pub leader: String,
    /// What the value of the leader is multiplied with.
    pub multiplier: f64,
    /// What is added (rad or m).
    pub offset: f64,
}

/// A format of files that hold a trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TrajectoryKind {
    /// Comma-separated values: a line of names with units, then one point on each line.
    Csv,
    /// `JointTrajectory` of ROS, as JSON.
    Json,
    /// The same as YAML.
    Yaml,
    /// A recording of ROS 2 in MCAP.
    Mcap,
}

/// The page that describes the formats.
const GUIDE: &str = "trajectory.md";

impl TrajectoryKind {
    /// The kind of a file, by the ending of its name.
    #[must_use]
    pub fn of(file: &Path) -> Option<Self> {
        Content::of(file).find_map(|content| match content {
            Content::CsvPath => Some(Self::Csv),
            Content::JsonPath => Some(Self::Json),
            Content::Map => Some(Self::Yaml),
            Content::Recording => Some(Self::Mcap),
            _ => None,
        })
    }
}

impl TrajectoryFile {
    /// A trajectory may begin so far (rad or m) from where the robot is: `allowed_start_tolerance` of MoveIt.
    pub const START: f64 = 0.01;

    /// Reads `bytes`, the content of a file that errors call `file`. Joints are matched by name to those `wanted`, and their units converted.
    /// `None` if the file has no times: then it is a path, or nothing that is known here.
    ///
    /// # Errors
    /// [`Error`] with line and column where they are known: also when a name is unknown, missing or there twice, a unit does not fit, and when
    /// times do not increase.
    pub fn parse(
        file: &str,
        bytes: &[u8],
        kind: TrajectoryKind,
        wanted: &[Column],
    ) -> Result<Option<Self>, Error> {
        Self::parse_of(file, bytes, kind, wanted, KnownJoints::default())
    }

    /// As [`parse`](Self::parse), with what is known of the joints of the robot.
    ///
    /// # Errors
    /// As [`parse`](Self::parse), and when a joint is not where it should be as it follows another.
    pub fn parse_of(
        file: &str,
        bytes: &[u8],
        kind: TrajectoryKind,
        wanted: &[Column],
        known: KnownJoints<'_>,
    ) -> Result<Option<Self>, Error> {
        let read = match kind {
            TrajectoryKind::Csv => csv::parse(file, bytes, wanted)?,
            TrajectoryKind::Json => ros::parse_json(file, bytes, wanted, known)?,
            TrajectoryKind::Yaml => ros::parse_yaml(file, bytes, wanted, known)?,
            TrajectoryKind::Mcap => Some(mcap::parse(file, bytes, wanted, known)?),
        };
        let Some(read) = read else { return Ok(None) };
        if let Some(i) = read.times.windows(2).position(|t| t[1] <= t[0]) {
            let (before, time) = (read.times[i], read.times[i + 1]);
            let message =
                format!("the time of point {} is {time} s, and that of the point before {before} s", i + 2);
            return Err(Error::new(ErrorKind::Content, file, message)
                .expected("times that increase")
                .help("sort the points by their times, and keep one of those that are equal"));
        }
        if let Some(first) = read.times.first().filter(|time| **time < 0.0) {
            let message = format!("the time of point 1 is {first} s");
            return Err(Error::new(ErrorKind::Content, file, message)
                .expected("0 s or more")
                .help("count times from the beginning of the motion"));
        }
        Ok(Some(read))
    }

    /// The content of a file of this kind. Numbers have the digits that read back to the same bits; times are whole nanoseconds but in CSV. In MCAP
    /// there is the trajectory alone: a [`Recording`] shows it too.
    #[must_use]
    pub fn to_bytes(&self, kind: TrajectoryKind) -> Vec<u8> {
        let text = match kind {
            TrajectoryKind::Csv => csv::text(self),
            TrajectoryKind::Json => ros::json_text(self),
            TrajectoryKind::Yaml => ros::yaml_text(self),
            TrajectoryKind::Mcap => return Recording::of(self.clone()).to_mcap(),
        };
        text.into_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn wanted() -> Vec<Column> {
        [("lift", "m"), ("elbow", "rad")].map(|(name, unit)| Column::new(name, unit)).to_vec()
    }

    fn read(text: &str, kind: TrajectoryKind) -> Result<Option<TrajectoryFile>, String> {
        TrajectoryFile::parse("t", text.as_bytes(), kind, &wanted()).map_err(|e| e.report())
    }

    fn sample() -> TrajectoryFile {
        TrajectoryFile {
            joints: wanted(),
            times: vec![0.0, 0.5, 12.000000001],
            positions: vec![vec![0.1, -2.0], vec![1e-9, 3.0], vec![0.25, PI]],
            velocities: vec![vec![0.0, 0.0], vec![1e-7, -0.3], vec![0.0, 0.0]],
            ..TrajectoryFile::default()
        }
    }

    const KINDS: [TrajectoryKind; 3] = [TrajectoryKind::Csv, TrajectoryKind::Json, TrajectoryKind::Yaml];

    #[test]
    fn what_is_written_reads_back() {
        let plain = sample();
        let bare = TrajectoryFile { velocities: Vec::new(), ..sample() };
        let full = TrajectoryFile { accelerations: vec![vec![1.0, 2.0]; 3], ..sample() };
        for kind in KINDS {
            for made in [&plain, &bare, &full] {
                let text = String::from_utf8(made.to_bytes(kind)).unwrap();
                assert_eq!(read(&text, kind).unwrap().as_ref(), Some(made), "{text}");
                // Lines of Windows.
                assert_eq!(read(&text.replace('\n', "\r\n"), kind).unwrap().as_ref(), Some(made), "{text}");
            }
        }
        assert_eq!(
            bare.to_bytes(TrajectoryKind::Csv).split(|b| *b == b'\n').next(),
            Some(&b"time [s],lift [m],elbow [rad]"[..])
        );
        let yaml = String::from_utf8(plain.to_bytes(TrajectoryKind::Yaml)).unwrap();
        assert!(yaml.contains("time_from_start: {sec: 12, nanosec: 1}"), "{yaml}");
        // Numbers that YAML 1.1 takes for numbers too.
        assert!(yaml.contains("0.000000001") && !yaml.contains("e-"), "{yaml}");
    }

    #[test]
    fn columns_are_found_by_name_unit_and_kind() {
        let numbers = |text: &str| {
            let read = read(text, TrajectoryKind::Csv).unwrap().unwrap();
            (read.times, read.positions, read.velocities)
        };
        let same =
            (vec![0.0, 0.5], vec![vec![0.25, PI], vec![0.5, 0.0]], vec![vec![1.0, 0.0], vec![0.0, 2.0 * PI]]);
        for text in [
            "time,lift,elbow,lift_velocity,elbow_velocity\n0,0.25,3.141592653589793,1,0\n0.5,0.5,0,0,6.283185307179586\n",
            "t [ms];elbow [deg];lift [cm];v_elbow [deg/s];v_lift\n0;180;25;0;1\n500;0;50;360;0\n",
            "time_from_start\televation_is_no_joint\n",
            ",elbow_vel [deg/s],lift_vel,time_ms,elbow_deg,lift_mm\r\n0,0,1,0,180,250\r\n1,360,0,500,0,500\r\n",
        ] {
            if text.contains("no_joint") {
                assert!(read(text, TrajectoryKind::Csv).unwrap_err().contains("is no number"), "{text}");
                continue;
            }
            assert_eq!(numbers(text), same, "{text}");
        }
        // Paths have no times.
        for text in ["lift,elbow\n0,1\n", "0,1\n2,3\n", ""] {
            assert_eq!(read(text, TrajectoryKind::Csv).unwrap(), None, "{text}");
        }
        for (text, words) in [
            ("time,lift,elbow,elbow\n0,1,2,3\n", "the same number"),
            ("time,lift\n0,1\n", "no column for elbow"),
            ("time\n0\n", "no column for lift"),
            ("t\t\t\t\r\r 1", "no column for lift"),
            ("time,lift,wrist\n0,1,2\n", "t:1:11"),
            ("time,t,lift,elbow\n0,1,2,3\n", "time"),
            ("time,lift,elbow,elbow_velocity\n0,1,2,3\n", "no column for lift"),
            ("time,lift [deg],elbow\n0,1,2\n", "cannot be converted"),
            ("time [m],lift,elbow\n0,1,2\n", "cannot be converted"),
            ("time,lift,elbow\n0,1,2\n1,2\n", "t:3:1"),
            ("time,lift,elbow\n0,1,x\n", "not a number"),
            ("time,lift,elbow\n0,1,2\n0,1,2\n", "times that increase"),
            ("time,lift,elbow\n-1,1,2\n", "0 s or more"),
            ("time,lift,elbow\n", "ends too early"),
        ] {
            let error = read(text, TrajectoryKind::Csv).unwrap_err();
            assert!(error.contains(words), "{text}: {error}");
        }
    }

    #[test]
    fn messages_of_ros_and_moveit_are_read() {
        let point = |time: &str, positions: &str| {
            format!(
                "{{\"positions\": {positions}, \"velocities\": [], \"effort\": [], \"time_from_start\": {time}}}"
            )
        };
        let points =
            |times: [&str; 2]| format!("[{}, {}]", point(times[0], "[1, 0.25]"), point(times[1], "[2, 0.5]"));
        let joints = r#""header": {"frame_id": ""}, "joint_names": ["elbow", "lift"]"#;
        let times = [r#"{"sec": 0, "nanosec": 0}"#, r#"{"sec": 1, "nanosec": 500000000}"#];
        let plain = format!("{{{joints}, \"points\": {}}}", points(times));
        let inside = format!(
            r#"{{"joint_trajectory": {plain}, "multi_dof_joint_trajectory": {{"joint_names": [], "points": []}}}}"#
        );
        for text in [
            plain.clone(),
            format!(
                "{{{joints}, \"points\": {}}}",
                points([r#"{"secs": 0, "nsecs": 0}"#, r#"{"secs": 1, "nsecs": 500000000}"#])
            ),
            format!("{{{joints}, \"points\": {}}}", points(["0", "1.5"])),
            inside.clone(),
            format!(r#"{{"model_id": "arm", "trajectory": [{inside}], "trajectory_start": {{}}}}"#),
        ] {
            let read = read(&text, TrajectoryKind::Json).unwrap().unwrap();
            assert_eq!(
                (read.times, read.positions),
                (vec![0.0, 1.5], vec![vec![0.25, 1.0], vec![0.5, 2.0]]),
                "{text}"
            );
            assert!(read.velocities.is_empty());
            // JSON is YAML.
            assert!(super::tests::read(&text, TrajectoryKind::Yaml).unwrap().is_some(), "{text}");
        }
        let yaml = "joint_names:\n- elbow\n- \"lift\"\npoints:\n- positions: [1.0, 0.25]\n  velocities:\n  - 0\n  - .5\n  time_from_start:\n    sec: 0\n    nanosec: 0\n---\n";
        let read_yaml = read(yaml, TrajectoryKind::Yaml).unwrap().unwrap();
        assert_eq!(
            (read_yaml.positions, read_yaml.velocities),
            (vec![vec![0.25, 1.0]], vec![vec![0.5, 0.0]])
        );
        assert_eq!(read(r#"{"path": [[1, 2]]}"#, TrajectoryKind::Json).unwrap(), None);
        assert_eq!(read("image: a.png\n", TrajectoryKind::Yaml).unwrap(), None);
        for (from, to, words) in [
            ("\"lift\"", "\"wrist\"", "`wrist` is no number"),
            ("\"lift\"", "\"elbow\"", "the same number"),
            ("[2, 0.5]", "[2]", "point 2 has 1 position"),
            ("[2, 0.5]", "[2, null]", "t:1"),
            ("\"sec\": 1", "\"sec\": 0, \"x\": 0", ""),
            (
                "\"velocities\": [], \"effort\": [], \"time_from_start\": {\"sec\": 1",
                "\"velocities\": [0, 1], \"time_from_start\": {\"sec\": 1",
                "point 1 has no velocities",
            ),
            ("500000000", "-3", "the nanoseconds of the time of point 2"),
            ("500000000", "1000000000", "expected 0 to 999999999"),
            ("{\"sec\": 0", "{\"sec\": -5", "the time of point 1 is -5 s; expected 0 s or more"),
            ("{\"sec\": 0, \"nanosec\": 0}", "-0.5", "the time of point 1 is -0.5 s"),
            ("{\"sec\": 0, \"nanosec\": 0}", "{\"sec\": 2, \"nanosec\": 0}", "times that increase"),
        ] {
            assert!(plain.contains(from), "{from}");
            match read(&plain.replace(from, to), TrajectoryKind::Json) {
                Err(error) => assert!(error.contains(words), "{to}: {error}"),
                Ok(_) => assert!(words.is_empty(), "{to}"),
            }
        }
        // Where the robot is comes first.
        for (lift, words) in [("0.255", ""), ("0.3", "lift is 0.3 there and 0.25 at the first point")] {
            let state =
                format!(r#"{{"joint_state": {{"name": ["finger", "lift"], "position": [9, {lift}]}}}}"#);
            let text = format!(r#"{{"trajectory": [{inside}], "trajectory_start": {state}}}"#);
            match read(&text, TrajectoryKind::Json) {
                Ok(_) => assert!(words.is_empty(), "{lift}"),
                Err(error) => assert!(!words.is_empty() && error.contains(words), "{error}"),
            }
        }
        // Whole turns make no difference where a joint has no limits.
        for (turns, endless, begins) in [
            (0.0, false, true),
            (1.0, false, false),
            (1.0, true, true),
            (-2.0, true, true),
            (0.5, true, false),
        ] {
            let state = format!(
                r#"{{"joint_state": {{"name": ["elbow"], "position": [{}]}}}}"#,
                1.0 + turns * 2.0 * PI
            );
            let text = format!(r#"{{"trajectory": [{inside}], "trajectory_start": {state}}}"#);
            let read = |text: &str| {
                let known = KnownJoints { endless: &[false, endless], followers: &[] };
                TrajectoryFile::parse_of("t", text.as_bytes(), TrajectoryKind::Json, &wanted(), known).is_ok()
            };
            assert_eq!(read(&text), begins, "{turns} {endless}");
        }
        // Joints that follow others, as in `/joint_states`, where they should be.
        let finger =
            Follower { name: "finger".to_owned(), leader: "elbow".to_owned(), multiplier: -0.5, offset: 0.1 };
        let known = KnownJoints { followers: &[finger], ..KnownJoints::default() };
        let with = |at: f64, velocity: f64| {
            let text = format!(
                r#"{{"joint_names": ["finger", "elbow", "lift"], "points": [
                {{"positions": [-0.4, 1, 0], "velocities": [0, 0, 0], "time_from_start": {{"sec": 0, "nanosec": 0}}}},
                {{"positions": [{at}, 1.2, 0.3], "velocities": [{velocity}, 2, 0], "time_from_start": {{"sec": 1, "nanosec": 0}}}}]}}"#
            );
            let read = |known| {
                TrajectoryFile::parse_of("t", text.as_bytes(), TrajectoryKind::Json, &wanted(), known)
            };
            assert!(read(KnownJoints::default()).unwrap_err().report().contains("`finger` is no number"));
            read(known).map_err(|e| e.report())
        };
        let read_with = with(-0.50004, -1.0).unwrap().unwrap();
        assert_eq!(read_with.positions, [[0.0, 1.0], [0.3, 1.2]]);
        assert_eq!(read_with.velocities, [[0.0, 0.0], [0.0, 2.0]]);
        for (refused, words) in [
            (with(-0.6, -1.0), "positions of point 2: finger is -0.6"),
            (with(-0.5, 1.0), "velocities of point 2"),
        ] {
            assert!(refused.as_ref().unwrap_err().contains(words), "{refused:?}");
        }
        let two = format!(r#"{{"trajectory": [{inside}, {inside}]}}"#);
        assert!(read(&two, TrajectoryKind::Json).unwrap_err().contains("2 trajectories"));
        let base = r#"{"joint_trajectory": {"joint_names": [], "points": []}, "multi_dof_joint_trajectory": {"joint_names": ["base"], "points": []}}"#;
        assert!(read(base, TrajectoryKind::Json).unwrap_err().contains("several degrees of freedom"));
        // Units that would be skipped, as in paths.
        let text = ros::json_text(&sample());
        for (said, fine) in
            [(r#""units": "deg""#, false), (r#""degrees": true"#, false), (r#""units": "rad""#, true)]
        {
            let text = text.replacen('{', &format!("{{{said}, "), 1);
            for text in [text.clone(), format!(r#"{{"joint_trajectory": {text}}}"#)] {
                let read = read(&text, TrajectoryKind::Json);
                assert!(
                    read.is_ok() == fine
                        && read.err().is_none_or(|e| e.contains("not in radians and metres")),
                    "{said}"
                );
            }
        }
        assert!(
            read(
                "joint_names: [&a lift, *a]\npoints: [{positions: [0, 0], time_from_start: 0}]\n",
                TrajectoryKind::Yaml
            )
            .unwrap_err()
            .contains("the same number")
        );
        assert!(read("points: [\n", TrajectoryKind::Yaml).is_err());
    }
}
