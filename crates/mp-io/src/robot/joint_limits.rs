//! MoveIt's `joint_limits.yaml`, beside the SRDF of a robot: how far and how fast its joints may move.

use crate::yaml;
use mp_formats::encoding::decode_mesh;
use mp_formats::error::{Error, ErrorKind};
use mp_formats::files::{Files, MAX_TEXT_BYTES};
use mp_formats::text::clipped;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The name of the file.
const NAME: &str = "joint_limits.yaml";

/// What to do about a file that cannot be used.
const HELP: &str =
    "correct the file, or move it away from the SRDF; `srdf = false` in a robot problem reads neither";

/// The limits that a `joint_limits.yaml` gives to joints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointLimits {
    /// Where the file is; empty if there is none.
    pub file: PathBuf,
    /// The joints that it names.
    pub joints: Vec<LimitsOfJoint>,
    /// The parts of the limits of velocity and of acceleration that MoveIt takes where a request names none.
    pub parts: [Option<f64>; 2],
}

/// The limits that a `joint_limits.yaml` gives to a joint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LimitsOfJoint {
    /// The name of the joint.
    pub joint: String,
    /// The lower and the upper limit (rad or m).
    pub positions: [Option<f64>; 2],
    /// Limits of velocity (rad/s or m/s), acceleration (per s²) and jerk (per s³).
    pub rates: [Option<f64>; 3],
}

/// What the file beside an SRDF says; nothing if there is none.
///
/// # Errors
/// [`Error`] when it cannot be read, or says of a joint what is no limit.
pub(super) fn beside(files: &dyn Files, srdf: &Path) -> Result<JointLimits, Error> {
    let file = srdf.with_file_name(NAME);
    if !files.holds(&file) {
        return Ok(JointLimits::default());
    }
    let name = file.display().to_string();
    let read = |bytes: Vec<u8>| parse(&name, &bytes);
    let limits = files.read(&file, MAX_TEXT_BYTES).and_then(read).map_err(|e| e.help(HELP))?;
    Ok(JointLimits { file, ..limits })
}

/// What a file that errors call `name` says.
pub(crate) fn parse(name: &str, bytes: &[u8]) -> Result<JointLimits, Error> {
    let text = &*decode_mesh(name, bytes)?;
    let mut file = &yaml::value(name, text)?;
    // Where parameters of ROS 2 are, around what MoveIt takes from files of its own.
    for around in ["/**", "ros__parameters", "robot_description_planning"] {
        file = file.get(around).unwrap_or(file);
    }
    let part = |what| file.get(format!("default_{what}_scaling_factor")).and_then(Value::as_f64);
    let parts = ["velocity", "acceleration"].map(part);
    let joints = match file.get("joint_limits") {
        None | Some(Value::Null) => return Ok(JointLimits { parts, ..JointLimits::default() }),
        Some(Value::Object(joints)) => joints,
        Some(_) => {
            let wrong = Entry { name, text, joint: "", values: &Value::Null };
            return Err(wrong
                .error("joint_limits", "`joint_limits` has no joints")
                .expected("joints by name"));
        }
    };
    let joints = joints.iter().map(|(joint, values)| Entry { name, text, joint, values }.limits());
    Ok(JointLimits { file: PathBuf::new(), joints: joints.collect::<Result<_, _>>()?, parts })
}

/// What the file says of a joint.
struct Entry<'a> {
    /// The name of the file.
    name: &'a str,
    text: &'a str,
    joint: &'a str,
    values: &'a Value,
}

impl Entry<'_> {
    fn limits(&self) -> Result<LimitsOfJoint, Error> {
        if !matches!(self.values, Value::Null | Value::Object(_)) {
            let message = format!("`{}` has no limits", clipped(self.joint));
            return Err(self
                .error("", message)
                .expected("`max_velocity` and the like, each in a line below it"));
        }
        let rate = |what: &str, sign: f64| {
            let key = format!("max_{what}");
            match self.limit(what, &key)?.map(|limit| limit * sign) {
                Some(limit) if limit <= 0.0 => {
                    let message = format!("`{key}` is {limit}: a joint could not move");
                    Err(self.error(&key, message).expected("a number above zero"))
                }
                limit => Ok(limit),
            }
        };
        let positions = [self.limit("position", "min_position")?, self.limit("position", "max_position")?];
        if let [Some(low), Some(high)] = positions
            && low > high
        {
            let message = format!("`min_position` is {low}, above `max_position`, which is {high}");
            return Err(self.error("min_position", message));
        }
        // Pilz writes how hard a joint may brake below zero. Joints speed up and slow down by one limit here.
        let braking = self.limit("deceleration", "max_deceleration")?.map_or(1.0, f64::signum);
        let accelerations = [rate("acceleration", 1.0)?, rate("deceleration", braking)?];
        let acceleration = accelerations.into_iter().flatten().reduce(f64::min);
        let rates = [rate("velocity", 1.0)?, acceleration, rate("jerk", 1.0)?];
        Ok(LimitsOfJoint { joint: self.joint.to_owned(), positions, rates })
    }

    /// The number at `key`, unless `has_…_limits` says that there is none. Where that is not written, the number counts, as in MoveIt.
    fn limit(&self, what: &str, key: &str) -> Result<Option<f64>, Error> {
        let has = format!("has_{what}_limits");
        if !self.is_true(&has)? {
            return Ok(None);
        }
        match self.values.get(key) {
            None | Some(Value::Null) => Ok(None),
            Some(value) => value.as_f64().map(Some).ok_or_else(|| {
                let message = format!("`{key}` is {}, which is no number", clipped(&value.to_string()));
                self.error(key, message).expected("a number")
            }),
        }
    }

    /// Whether a word of YAML 1.1 or 1.2 says so, or nothing is said.
    fn is_true(&self, key: &str) -> Result<bool, Error> {
        let word = match self.values.get(key) {
            None | Some(Value::Null) => return Ok(true),
            Some(Value::Bool(is)) => return Ok(*is),
            Some(Value::String(word)) => word.clone(),
            Some(value) => value.to_string(),
        };
        match word.to_ascii_lowercase().as_str() {
            "true" | "yes" | "on" | "y" => Ok(true),
            "false" | "no" | "off" | "n" => Ok(false),
            _ => {
                let message = format!("`{key}` is `{}`, which is neither true nor false", clipped(&word));
                Err(self.error(key, message).expected("true or false"))
            }
        }
    }

    /// An error in the line of `key`, if that is found below the name of the joint.
    fn error(&self, key: &str, message: impl Into<String>) -> Error {
        let begins = |line: &str, word: &str| {
            let key = line.trim_start().split(':').next().unwrap_or_default().trim_end();
            word.is_empty() || key.trim_matches(['"', '\'']) == word
        };
        let indent = |line: &str| line.len() - line.trim_start().len();
        let mut lines = self.text.lines().enumerate().skip_while(|(_, line)| !begins(line, self.joint));
        let first = lines.clone().next();
        let low = first.map_or(0, |(_, line)| indent(line));
        let own = |(_, line): &(usize, &str)| {
            self.joint.is_empty() || begins(line, self.joint) || indent(line) > low
        };
        let line = lines.by_ref().take_while(own).find(|(_, line)| begins(line, key)).or(first);
        match line {
            Some((line, _)) => Error::in_line(ErrorKind::Content, self.name, self.text, line + 1, message),
            None => Error::new(ErrorKind::Content, self.name, message),
        }
        .help(HELP)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// The line of an error of the joints `text`, and what it says.
    fn wrong(text: &str) -> (Option<usize>, String) {
        let error = parse("l", format!("joint_limits:\n{text}").as_bytes()).unwrap_err();
        mp_formats::error::check_error(&error);
        (error.line(), error.report())
    }

    fn of(joint: &str, positions: [Option<f64>; 2], rates: [Option<f64>; 3]) -> LimitsOfJoint {
        LimitsOfJoint { joint: joint.to_owned(), positions, rates }
    }

    #[test]
    fn limits_that_are_there_are_read() {
        let text = "default_velocity_scaling_factor: 0.1\njoint_limits:\n  lift:\n    has_velocity_limits: true\n    max_velocity: 2\n    \
                    has_acceleration_limits: true\n    max_acceleration: 3.75\n    has_jerk_limits: true\n    max_jerk: 50\n  elbow:\n    has_velocity_limits: false\n    max_velocity: 1.5\n";
        let rates = [Some(2.0), Some(3.75), Some(50.0)];
        let limits = |text: &str| parse("l", text.as_bytes()).unwrap().joints;
        assert_eq!(parse("l", text.as_bytes()).unwrap().parts, [Some(0.1), None]);
        assert_eq!(limits(text), [of("elbow", [None; 2], [None; 3]), of("lift", [None; 2], rates)]);
        assert!(limits("").is_empty() && limits("joint_limits:\n").is_empty());
        assert_eq!(limits("joint_limits:\n  lift:\n"), [of("lift", [None; 2], [None; 3])]);
        // Joints brake no harder than they may; Pilz writes that below zero.
        for (more, least) in [("-2", 2.0), ("2", 2.0), ("-5", 3.75)] {
            let pilz = format!("has_deceleration_limits: true\n    max_deceleration: {more}\n    has_jerk");
            let lift = &limits(&text.replacen("has_jerk", &pilz, 1))[1];
            assert_eq!(lift.rates, [Some(2.0), Some(least), Some(50.0)], "{more}");
        }
        // As parameters of ROS 2, and with a comment in another encoding.
        let deep = "/**:\n  ros__parameters:\n    robot_description_planning:\n      joint_limits: {lift: {max_jerk: 50}}\n";
        assert_eq!(limits(deep), [of("lift", [None; 2], [None, None, Some(50.0)])]);
        assert_eq!(
            parse("l", b"joint_limits: {lift: {max_jerk: 50}} # \xfc\n").unwrap().joints,
            limits(deep)
        );
    }

    #[test]
    fn positions_are_limits_as_in_moveit() {
        let limits = |of: &str| {
            parse("l", format!("joint_limits:\n  j: {{{of}}}\n").as_bytes()).unwrap().joints[0].positions
        };
        let both = "min_position: -1, max_position: 2";
        assert_eq!(limits(both), [Some(-1.0), Some(2.0)]);
        assert_eq!(limits(&format!("has_position_limits: true, {both}")), [Some(-1.0), Some(2.0)]);
        assert_eq!(limits(&format!("has_position_limits: false, {both}")), [None; 2]);
        assert_eq!(limits("max_position: 2"), [None, Some(2.0)]);
        assert_eq!(
            limits("min_position: !degrees -90, max_position: !radians 2"),
            [Some(-FRAC_PI_2), Some(2.0)]
        );
    }

    #[test]
    fn words_that_mean_true_and_false() {
        let is = |word: &str| {
            let text = format!("joint_limits:\n  j:\n    has_velocity_limits: {word}\n    max_velocity: 2\n");
            parse("l", text.as_bytes()).unwrap().joints[0].rates[0].is_some()
        };
        for word in ["true", "True", "TRUE", "yes", "Yes", "YES", "on", "On", "ON", "y", "~", "\"true\""] {
            assert!(is(word), "{word}");
        }
        for word in ["false", "False", "FALSE", "no", "No", "NO", "off", "Off", "OFF", "n", "'no'"] {
            assert!(!is(word), "{word}");
        }
        for word in ["ture", "1", "0", "[true]"] {
            let (line, said) = wrong(&format!(
                "  i:\n    max_jerk: 1\n  j:\n    max_velocity: 2\n    has_velocity_limits: {word}\n"
            ));
            assert_eq!(line, Some(6), "{said}");
            assert!(said.contains("has_velocity_limits") && said.contains("true or false"), "{said}");
        }
    }

    #[test]
    fn what_is_no_limit_is_an_error_in_its_line() {
        for (text, at, words) in [
            ("  j:\n    max_velocity: !furlongs 2\n", 3, "tag"),
            ("  j:\n    max_velocity: 2\n    max_velocity: 3\n", 4, "twice"),
            ("  j:\n    max_velocity: fast\n", 3, "`max_velocity` is \"fast\""),
            ("  j:\n    has_velocity_limits: true\n    max_velocity: 0\n", 4, "above zero"),
            (
                "  i:\n    max_jerk: 3\n  \"j\" :\n    min_position: 2\n    max_position: 1\n",
                5,
                "above `max_position`",
            ),
            ("  j:\n    max_deceleration: 0\n", 3, "`max_deceleration` is 0"),
            ("  j: {max_jerk: x}\n  k:\n    max_jerk: 2\n", 2, "`max_jerk` is \"x\""),
            ("  j: 5\n", 2, "`j` has no limits"),
            ("  - j\n", 1, "`joint_limits` has no joints"),
        ] {
            let (line, said) = wrong(text);
            assert!(line == Some(at) && said.contains(words), "{text}: {said}");
        }
    }
}
