//! Planners by name: of trees, with meta-planners or without, and of roadmaps.

use super::{auto, roadmaps};
use crate::{Error, ErrorKind, RelaxField, Request, Robot};
use mp_cspace::registry::{PlannerInfo, Settings};
use mp_cspace::{BuildError, Demand, Interrupt};
use mp_kinds::Counting;
use mp_tree::algo::rrs::FIELD;
use std::fmt;
use std::sync::atomic::AtomicU64;

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

const BY_INPUTS: &str = "it moves robots by inputs, and the file says nothing of those of this robot";

/// What planners must be able to do to plan for the robot: what its motions demand, and to do without what is not known of its obstacles.
/// `costs` says whether its states cost something even so.
pub(crate) fn demands(kind: &dyn Robot, costs: bool) -> Vec<Demand> {
    let unused = AtomicU64::new(0);
    let known = kind.any_obstacles(&Counting::new(&unused, Interrupt::never()));
    let unknown = [
        (known.hints.is_none(), Demand::NoHints),
        (known.gradient.is_none(), Demand::NoGradient),
        (known.gradient.is_none() && !costs, Demand::NoCost),
        (known.geometry.is_none(), Demand::NoGeometry),
    ];
    let unknown = unknown.into_iter().filter_map(|(missing, demand)| missing.then_some(demand));
    kind.demands().iter().copied().chain(unknown).collect()
}

/// Why the planner cannot plan for a robot with these demands; `None` if it can.
pub(crate) fn reason_against(info: &PlannerInfo, demands: &[Demand]) -> Option<&'static str> {
    let by_inputs = || {
        let one_way = demands.contains(&Demand::OneWay) && !demands.contains(&Demand::Inputs);
        (one_way && info.can(Demand::Inputs)).then_some(BY_INPUTS)
    };
    demands.iter().find_map(|demand| info.reason_against(*demand)).or_else(by_inputs)
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
    pub(crate) fn meets(&self, kind: &dyn Robot, demands: &[Demand]) -> Result<(), Error> {
        let info = match self {
            Self::Auto => &auto::INFO,
            Self::Tree(spec) => spec.planner,
            Self::Roadmap(info) => info,
        };
        let Some(reason) = reason_against(info, demands) else { return Ok(()) };
        let able = planners().filter(|info| reason_against(info, demands).is_none());
        let names = able.map(|info| info.name).collect::<Vec<_>>().join(", ");
        let say = match reason == BY_INPUTS {
            true => "say how the robot moves, such as `kind = \"velocities\"`, or ",
            false => "",
        };
        let message = format!("{self} cannot plan for {}: {reason}", kind.name());
        Err(Error::new(message).help(format!("{say}take one of: {names}")).of_kind(ErrorKind::Planner))
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
