//! Bad input, refused before planning begins.

use crate::{MotionCheck, ParameterError};
use std::fmt;

/// Which end of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Endpoint {
    /// Where it begins.
    Start,
    /// Where it ends: the goal with this index among those listed.
    Goal(usize),
}

impl fmt::Display for Endpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Start => "start",
            Self::Goal(_) => "goal",
        })
    }
}

/// Why a problem or a planner could not be set up.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// An end of the path is not a state of the space.
    #[error("the {endpoint} is outside the space (out of bounds or not finite): {state}")]
    Outside {
        /// Which end.
        endpoint: Endpoint,
        /// The state, as `Debug` prints it.
        state: String,
    },
    /// The verifier does not find an end of the path free.
    #[error("the {endpoint} is not free ({}): {state}", describe(check))]
    NotFree {
        /// Which end.
        endpoint: Endpoint,
        /// The state, as `Debug` prints it.
        state: String,
        /// What the verifier found.
        check: MotionCheck,
    },
    /// The local planner lets no motion begin or end at an end of the path that the verifier finds free:
    /// its own check is stricter, for instance by its tolerance.
    #[error("the local planner refuses the {endpoint}, which is free but too close for its check: {state}")]
    Refused {
        /// Which end.
        endpoint: Endpoint,
        /// The state, as `Debug` prints it.
        state: String,
    },
    /// The metric gives no finite distance between start and goal.
    #[error("the distance from the start to the goal is {distance}, not a finite number")]
    Distance {
        /// The distance that the metric gives.
        distance: f64,
    },
    /// The goal is an empty set.
    #[error("no goal is given: list goal states, or give a region or a sampler")]
    NoGoal,
    /// The planner needs goal states and has only a region.
    #[error(
        "{planner} also grows from the goal: a region alone is not enough, give goal states or a sampler"
    )]
    NoGoalState {
        /// The planner that was asked for, by name.
        planner: &'static str,
    },
    /// The planner grows along obstacles and the problem has no hints of them.
    #[error(
        "{planner} follows obstacles: give the problem hints of them; robots that have none need another planner"
    )]
    NoHints {
        /// The planner that was asked for, by name.
        planner: &'static str,
    },
    /// The planner needs a clearance gradient and the problem has none.
    #[error(
        "{planner} needs the distance to obstacles and the direction in which it grows: give the problem a clearance gradient; robots that have none need another planner"
    )]
    NoGradient {
        /// The planner that was asked for, by name.
        planner: &'static str,
    },
    /// The planner needs the geometry of obstacles and the problem has none.
    #[error(
        "{planner} needs the geometry of obstacles: give it to the problem; robots that have none need another planner"
    )]
    NoGeometry {
        /// The planner that was asked for, by name.
        planner: &'static str,
    },
    /// A parameter is out of its range.
    #[error("parameter {name} is {value}, but must be {range}")]
    OutOfRange {
        /// Which parameter.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// The values allowed.
        range: String,
    },
    /// The inputs of a planner that moves by inputs are not valid.
    #[error("{reason}")]
    Inputs {
        /// What is wrong.
        reason: String,
    },
    /// A parameter of a motion check or verifier is out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A factory of problems could not make one.
    #[error("cannot make the problem: {reason}")]
    Unmade {
        /// Why not.
        reason: String,
    },
    /// A setting is not of the form `key=value`, or its value cannot be read.
    #[error("cannot read the setting `{setting}`: expected {expected}")]
    Malformed {
        /// The text that was given.
        setting: String,
        /// The form expected.
        expected: &'static str,
    },
    /// The planner has no such parameter.
    #[error("{planner} has no parameter `{name}`{}; it has: {}", hint(suggestion), known.join(", "))]
    UnknownParameter {
        /// The planner that was asked for, by name.
        planner: &'static str,
        /// The parameter that was set.
        name: String,
        /// The names there are.
        known: Vec<&'static str>,
        /// The one it resembles.
        suggestion: Option<&'static str>,
    },
    /// There is no such planner.
    #[error("there is no planner `{name}`{}; there are: {}", hint(suggestion), known.join(", "))]
    UnknownPlanner {
        /// The name that was asked for.
        name: String,
        /// The names there are.
        known: Vec<&'static str>,
        /// The one it resembles.
        suggestion: Option<&'static str>,
    },
}

impl BuildError {
    /// `value` if it is positive and finite.
    ///
    /// # Errors
    /// [`OutOfRange`](Self::OutOfRange) otherwise.
    pub fn positive(name: &'static str, value: f64) -> Result<f64, Self> {
        if value > 0.0 && value.is_finite() {
            return Ok(value);
        }
        Err(Self::OutOfRange { name, value, range: "positive and finite".to_owned() })
    }

    /// `value` if it is from `least` to `most`.
    ///
    /// # Errors
    /// [`OutOfRange`](Self::OutOfRange) otherwise.
    pub fn count_within(name: &'static str, value: u64, least: u64, most: u64) -> Result<u64, Self> {
        if (least..=most).contains(&value) {
            return Ok(value);
        }
        let range = format!("a whole number from {least} to {most}");
        Err(Self::OutOfRange { name, value: value as f64, range })
    }
}

fn describe(check: &MotionCheck) -> &'static str {
    match check {
        MotionCheck::Free { .. } => "free",
        MotionCheck::Collision { .. } => "in collision",
        MotionCheck::Unproven { .. } => "within tolerance of contact",
    }
}

fn hint(suggestion: &Option<&'static str>) -> String {
    suggestion.map_or_else(String::new, |name| format!(" (did you mean `{name}`?)"))
}
