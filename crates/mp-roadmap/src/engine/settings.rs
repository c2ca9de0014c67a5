//! Parameters that several planners have.

use super::Reachable;
use mp_cspace::{
    BuildError, Length, Space,
    registry::{Demand, Parameter, Settings},
};

/// [`PlannerInfo::cannot`](mp_cspace::registry::PlannerInfo::cannot) of roadmaps.
pub const UNDIRECTED: &[(Demand, &str)] = &[ONE_WAY];
/// That of roadmaps that place the robot at obstacles.
pub(crate) const NEEDS_GEOMETRY: &[(Demand, &str)] = &[
    ONE_WAY,
    (Demand::NoGeometry, "it places the robot at obstacles by its mesh, and only rigid bodies have one"),
];
const ONE_WAY: (Demand, &str) =
    (Demand::OneWay, "its edges are used in both directions, so motions must run backward too");

/// [`Reachable::neighbours`].
pub const NEIGHBOURS: Parameter = Parameter {
    name: "neighbours",
    range: "a whole number, 1 to 10⁶",
    default: "15",
    doc: "most neighbours to which a node is connected (K)",
};

/// [`Reachable::radius`].
pub const RADIUS: Parameter = Parameter {
    name: "radius",
    range: "in (0, extent of the space], or with % in (0%, 100%] of the extent",
    default: "100%",
    doc: "longest distance of neighbours that are connected (MAXDIST)",
};

/// [`Reachable::cycles`].
pub const CYCLES: Parameter = Parameter {
    name: "cycles",
    range: "yes or no",
    default: "no",
    doc: "also connects nodes of one component: shorter paths, for more motions",
};

/// Whether `parameter` is set to yes, or is yes by default.
///
/// # Errors
/// When it is neither yes nor no.
pub fn yes(settings: &Settings, parameter: &Parameter) -> Result<bool, BuildError> {
    let word = |text: &str| match text {
        "yes" => Some(true),
        "no" => Some(false),
        _ => None,
    };
    let set = settings.choice(parameter.name, "yes or no", word)?;
    Ok(set.unwrap_or(parameter.default == "yes"))
}

/// [`NEIGHBOURS`], [`RADIUS`] and [`CYCLES`] as set, or by default.
///
/// # Errors
/// When a value cannot be read or is out of range.
pub fn reachable<C: Space>(space: &C, settings: &Settings) -> Result<Reachable, BuildError> {
    let radius = match settings.length(RADIUS.name)? {
        Some(step) => length(&RADIUS, step, space)?,
        None => f64::INFINITY,
    };
    let neighbours = settings.count_of(&NEIGHBOURS)? as usize;
    Reachable { neighbours, radius, cycles: yes(settings, &CYCLES)? }.check()
}

/// The length of a step that is the value of `parameter`.
///
/// # Errors
/// When it is not positive or longer than the extent of the space.
pub fn length<C: Space>(parameter: &Parameter, step: Length, space: &C) -> Result<f64, BuildError> {
    step.step_in(space).map_err(|error| match error {
        BuildError::OutOfRange { value, range, .. } => {
            BuildError::OutOfRange { name: parameter.name, value, range }
        }
        other => other,
    })
}
