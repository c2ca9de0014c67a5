//! Planners by name: of trees, with meta-planners or without, and of roadmaps.

use super::{auto, roadmaps};
use crate::{Error, ErrorKind, RelaxField, Request, Robot};
use mp_cspace::registry::{PlannerInfo, Settings};
use mp_cspace::{BuildError, Demand};
use mp_tree::algo::rrs::FIELD;
use std::fmt;

/// All planners by name: `auto`, planners of trees, planners of roadmaps. The name of a planner of trees may have the prefix `or-` or `restart-`,
/// and those of some also `shared-`: see [`meta_planners`].
pub fn planners() -> impl Iterator<Item = &'static PlannerInfo> {
    std::iter::once(&auto::INFO).chain(mp_tree::planners()).chain(roadmaps::planners())
}

/// The planners by name that build roadmaps.
#[must_use]
pub fn roadmap_planners() -> &'static [PlannerInfo] {
    roadmaps::planners()
}

/// The meta-planners, whose names are prefixes of the name of a planner.
#[must_use]
pub fn meta_planners() -> &'static [mp_tree::MetaPlanner] {
    mp_tree::meta_planners()
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum PlannerKind {
    /// The portfolio [`auto`].
    Auto,
    /// Grows trees.
    Tree(mp_tree::PlannerSpec),
    /// Builds a roadmap.
    Roadmap(&'static PlannerInfo),
}

impl PlannerKind {
    /// The planner called `name`.
    pub(crate) fn new(name: &str) -> Result<Self, Error> {
        if auto::INFO.is_called(name) {
            return Ok(Self::Auto);
        }
        if let Some(info) = roadmaps::planner(name) {
            return Ok(Self::Roadmap(info));
        }
        mp_tree::PlannerSpec::new(name).map(Self::Tree).map_err(|error| {
            // The error of mp-tree lists only planners of trees.
            let names = planners().flat_map(|p| [p.name].into_iter().chain(p.aliases.iter().copied()));
            let known = planners().map(|p| p.name).collect::<Vec<_>>().join(", ");
            let help = match (&error, mp_cspace::registry::closest(name, names)) {
                (BuildError::UnknownPlanner { .. }, Some(near)) => {
                    format!("did you mean `{near}`? There are: {known}")
                }
                (BuildError::UnknownPlanner { .. }, None) => format!("there are: {known}"),
                _ => return Error::from(error),
            };
            Error::new(format!("there is no planner `{name}`")).help(help).of_kind(ErrorKind::Planner)
        })
    }

    /// Refuses settings that the planner does not have.
    pub(crate) fn check(&self, settings: &Settings) -> Result<(), Error> {
        match self {
            Self::Auto => auto::check(settings)?,
            Self::Tree(spec) => spec.check(settings)?,
            Self::Roadmap(info) => settings.check(info)?,
        }
        Ok(())
    }

    /// The field that pushes its snakes, if it has snakes.
    pub(crate) fn field(&self, request: &Request) -> Result<Option<RelaxField>, Error> {
        let snakes = |spec: &mp_tree::PlannerSpec| spec.planner.parameters.contains(&FIELD);
        match (self, request.settings.get(FIELD.name)) {
            (Self::Tree(spec), Some(name)) if snakes(spec) => Ok(Some(name.parse()?)),
            _ => Ok(None),
        }
    }

    /// Refuses a robot that demands what the planner cannot do.
    pub(crate) fn meets(&self, kind: &dyn Robot) -> Result<(), Error> {
        let info = match self {
            Self::Auto => &auto::INFO,
            Self::Tree(spec) => spec.planner,
            Self::Roadmap(info) => info,
        };
        let demands = kind.demands();
        let by_inputs = demands.contains(&Demand::Inputs);
        let able = |info: &&PlannerInfo| {
            demands.iter().all(|demand| info.can(*demand)) && (by_inputs || !info.can(Demand::Inputs))
        };
        let names = || planners().filter(able).map(|info| info.name).collect::<Vec<_>>().join(", ");
        let cannot = |why: &str| {
            Error::new(format!("{self} cannot plan for {}: {why}", kind.name())).of_kind(ErrorKind::Planner)
        };
        let Some(reason) = demands.iter().find_map(|demand| info.reason_against(*demand)) else {
            if demands.is_empty() || able(&info) {
                return Ok(());
            }
            let why = "it moves robots by inputs, and the file says nothing of those of this robot";
            let help = format!(
                "say how the robot moves, such as `kind = \"velocities\"`, or take one of: {}",
                names()
            );
            return Err(cannot(why).help(help));
        };
        Err(cannot(reason).help(format!("take one of: {}", names())))
    }

    pub(crate) fn is_roadmap(&self) -> bool {
        matches!(self, Self::Roadmap(_))
    }
}

impl fmt::Display for PlannerKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str(auto::INFO.name),
            Self::Tree(spec) => spec.fmt(f),
            Self::Roadmap(info) => f.write_str(info.name),
        }
    }
}
