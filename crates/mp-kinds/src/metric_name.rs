//! Metrics by name.

use crate::Error;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// How the distance between two configurations is measured. For arms, `θ` and `Δp` are the changes of the joints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MetricName {
    /// ‖Δp‖ + 0.5·θ: the metric of the space itself.
    #[default]
    Default,
    /// √(‖Δp‖² + θ²).
    Euclidean,
    /// √(‖Δp‖² + (r·θ)²), r the radius of the robot.
    Scaled,
    /// |Δx| + |Δy| + |Δz| + θ.
    Manhattan,
    /// How far the point of the robot moves that moves farthest.
    MaxDisplacement,
    /// Approximately the volume that the robot sweeps, m³.
    SweptVolume,
}

impl MetricName {
    /// All metrics, each with its name and its formula (metres; θ in radians).
    pub const ALL: [(MetricName, &'static str, &'static str); 6] = [
        (MetricName::Default, "default", "‖Δp‖ + 0.5·θ"),
        (MetricName::Euclidean, "euclidean", "√(‖Δp‖² + θ²)"),
        (MetricName::Scaled, "scaled", "√(‖Δp‖² + (r·θ)²), r the radius of the robot about its origin"),
        (MetricName::Manhattan, "manhattan", "|Δx| + |Δy| + |Δz| + θ"),
        (
            MetricName::MaxDisplacement,
            "max-displacement",
            "how far the point of the robot moves that moves farthest",
        ),
        (
            MetricName::SweptVolume,
            "swept-volume",
            "about how much volume the robot sweeps, m³; slow for robots of many triangles",
        ),
    ];

    /// Its name on the command line and in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(metric, ..)| *metric == self).map_or("default", |(_, name, _)| name)
    }
}

impl fmt::Display for MetricName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for MetricName {
    type Err = Error;
    fn from_str(name: &str) -> Result<Self, Error> {
        let found = Self::ALL.iter().find(|(_, n, _)| *n == name).map(|(metric, ..)| *metric);
        found.ok_or_else(|| {
            let names: Vec<_> = Self::ALL.iter().map(|(_, name, _)| *name).collect();
            Error::new(format!("there is no metric `{name}`"))
                .help(format!("there are: {}", names.join(", ")))
        })
    }
}
