//! A planner by name: a tree, wrapped or not, or a roadmap.

use miette::{IntoDiagnostic, Result};
use mp::cspace::{PlannerInfo, Settings};
use mp::tree::Named;
use std::fmt;

/// Which planner.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Chosen {
    Tree(Named),
    Roadmap(&'static PlannerInfo),
}

impl Chosen {
    /// The planner called `name`.
    pub(crate) fn new(name: &str) -> Result<Self> {
        match mp::roadmap::planner(name) {
            Ok(info) => Ok(Self::Roadmap(info)),
            Err(_) => Named::new(name).map(Self::Tree).into_diagnostic(),
        }
    }

    /// Refuses settings that it does not have.
    pub(crate) fn check(&self, settings: &Settings) -> Result<()> {
        match self {
            Self::Tree(named) => named.check(settings).into_diagnostic(),
            Self::Roadmap(info) => settings.check(info).into_diagnostic(),
        }
    }
}

impl fmt::Display for Chosen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tree(named) => named.fmt(f),
            Self::Roadmap(info) => f.write_str(info.name),
        }
    }
}
