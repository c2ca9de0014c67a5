//! The metrics by name.

/// Used when none is named.
pub(crate) const DEFAULT: &str = "default";

/// What distances between configurations can mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// ‖Δp‖ + w·θ: the space's own.
    Default,
    /// √(‖Δp‖² + θ²).
    Euclidean,
    /// √(‖Δp‖² + (r·θ)²), r the radius of the robot.
    Scaled,
    /// |Δx| + |Δy| + |Δz| + θ.
    Manhattan,
    /// The farthest that any point of the robot moves.
    MaxDisplacement,
    /// About how much volume the robot sweeps.
    SweptVolume,
}

const METRICS: [(&str, Kind, &str); 6] = [
    ("default", Kind::Default, "‖Δp‖ + 0.5·θ"),
    ("euclidean", Kind::Euclidean, "√(‖Δp‖² + θ²)"),
    ("scaled", Kind::Scaled, "√(‖Δp‖² + (r·θ)²), r the radius of the robot about its origin"),
    ("manhattan", Kind::Manhattan, "|Δx| + |Δy| + |Δz| + θ"),
    ("max-displacement", Kind::MaxDisplacement, "how far the point of the robot moves that moves farthest"),
    (
        "swept-volume",
        Kind::SweptVolume,
        "about how much volume the robot sweeps, m³; slow for robots of many triangles",
    ),
];

/// Their names, each with its formula (metres; θ in radians).
pub(crate) fn values() -> Vec<clap::builder::PossibleValue> {
    METRICS.iter().map(|(name, _, help)| clap::builder::PossibleValue::new(*name).help(*help)).collect()
}

/// The metric called `name`.
pub(crate) fn named(name: &str) -> Option<Kind> {
    METRICS.iter().find(|(n, ..)| *n == name).map(|(_, kind, _)| *kind)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_the_default() {
        assert_eq!(named(DEFAULT), Some(Kind::Default));
        assert_eq!(named("chebyshev"), None);
    }
}
