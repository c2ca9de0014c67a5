//! MoveIt's `joint_limits.yaml`, beside the SRDF of a robot: how fast its joints may move.

use crate::yaml;
use mp_formats::files::{Files, MAX_TEXT_BYTES, decode};
use serde_json::Value;
use std::path::Path;

/// The name of the file.
const NAME: &str = "joint_limits.yaml";

/// Limits of velocity (rad/s or m/s), acceleration (per s²) and jerk (per s³) of joints, by name.
pub type JointRates = Vec<(String, [Option<f64>; 3])>;

/// What the file beside an SRDF says; nothing if there is none, or it cannot be read.
pub(super) fn beside(files: &dyn Files, srdf: &Path) -> JointRates {
    let file = srdf.with_file_name(NAME);
    if !files.holds(&file) {
        return JointRates::new();
    }
    let name = file.display().to_string();
    let read = |bytes: Vec<u8>| yaml::value(&name, decode(&name, &bytes)?);
    match files.read(&file, MAX_TEXT_BYTES).and_then(read) {
        Ok(value) => rates(&value),
        Err(e) => {
            tracing::warn!("{e}");
            JointRates::new()
        }
    }
}

fn rates(file: &Value) -> JointRates {
    let joints = file.get("joint_limits").and_then(Value::as_object);
    let rate = |joint: &Value, what: &str| {
        let is_there = joint.get(format!("has_{what}_limits")).and_then(Value::as_bool) == Some(true);
        let limit = joint.get(format!("max_{what}")).and_then(Value::as_f64);
        limit.filter(|limit| is_there && *limit > 0.0)
    };
    let each = |(name, joint): (&String, &Value)| {
        (name.clone(), ["velocity", "acceleration", "jerk"].map(|what| rate(joint, what)))
    };
    joints.into_iter().flatten().map(each).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_that_are_there_are_read() {
        let text = "default_velocity_scaling_factor: 0.1\njoint_limits:\n  lift:\n    has_velocity_limits: true\n    max_velocity: 2\n    \
                    has_acceleration_limits: true\n    max_acceleration: 3.75\n    has_jerk_limits: true\n    max_jerk: 50\n  elbow:\n    has_velocity_limits: false\n    max_velocity: 1.5\n";
        let value = yaml::value("l", text).unwrap();
        assert_eq!(
            rates(&value),
            [("elbow".to_owned(), [None; 3]), ("lift".to_owned(), [Some(2.0), Some(3.75), Some(50.0)])]
        );
        // Degrees by a tag that not all readers know are no radians.
        assert!(yaml::value("l", &text.replace("max_velocity: 2", "max_velocity: !degrees 120")).is_err());
        assert!(rates(&Value::Null).is_empty());
    }
}
