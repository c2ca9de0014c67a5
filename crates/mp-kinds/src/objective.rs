//! Objectives by name: what paths cost.

use crate::motion::Counting;
use crate::{Error, ErrorKind, Robot, positive_number};
use mp_cspace::erased::{AnyObjective, AnySpace};
use mp_cspace::{Clearance, Configuration, Interrupt, Length, Path, StateCostIntegral, nearness};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;
use std::sync::atomic::AtomicU64;

/// The weight of clearance, where none is given.
const WEIGHT: f64 = 10.0;

/// The range, where none is given, as a multiple of the tolerance: for the robots of this crate a fifth of their size.
const RANGE: f64 = 2000.0;

/// How far apart the states are whose clearances are integrated, as a part of the extent of the space.
const RESOLUTION: Length = Length::Fraction(0.01);

/// What a path costs. As text, `length`, `clearance`, `clearance:WEIGHT` or `clearance:WEIGHT:RANGE`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum ObjectiveName {
    /// Its length, in the metric of the space.
    #[default]
    Length,
    /// Its length and being [near](nearness) obstacles: ∫ (1 + weight·(1 − d/range)²) ds, where the clearance d is below the
    /// range.
    Clearance {
        /// How much more a motion in contact costs than one that is far away.
        weight: f64,
        /// The range, m. `None` for 2000 times the [tolerance](crate::Motion::tolerance): a fifth of the size of the robots of this crate.
        range: Option<f64>,
    },
}

impl ObjectiveName {
    /// Whether it is the length.
    #[must_use]
    pub fn is_length(&self) -> bool {
        *self == Self::Length
    }

    /// Refuses a robot that the objective does not suit.
    ///
    /// # Errors
    /// When the robot knows no clearance.
    pub fn check(self, kind: &dyn Robot) -> Result<(), Error> {
        if self.is_length() || kind.sampled().is_none() {
            return Ok(());
        }
        let what = format!("the clearance of {} is not known, so it cannot be an objective", kind.name());
        let help = "leave the objective out, or give the robot a clearance";
        Err(Error::new(what).help(help).of_kind(ErrorKind::Request))
    }

    /// The objective in a space of the robot; `None` for the length. Its clearances are counted.
    ///
    /// # Errors
    /// When the robot knows no clearance.
    pub fn make<'c>(
        self,
        kind: &dyn Robot,
        space: &'c AnySpace<'c, Configuration>,
        counting: &Counting<'c>,
    ) -> Result<Option<AnyObjective<'c, Configuration>>, Error> {
        let Self::Clearance { weight, range } = self else { return Ok(None) };
        self.check(kind)?;
        let range = range.unwrap_or_else(|| RANGE * kind.tolerance());
        let mut checker = counting.of(kind.any_measure());
        let near = move |q: &Configuration| nearness(checker.obstacle_clearance(q, range), range);
        Ok(Some(Box::new(StateCostIntegral::new(space, near, weight, RESOLUTION)?)))
    }

    /// What a path of the robot costs.
    ///
    /// # Errors
    /// When the robot knows no clearance.
    pub fn cost(self, kind: &dyn Robot, path: &Path<Configuration>) -> Result<f64, Error> {
        let (space, unused) = (AnySpace::new(&kind.any_space()), AtomicU64::new(0));
        let objective = self.make(kind, &space, &Counting::new(&unused, Interrupt::never()))?;
        Ok(objective.map_or_else(|| path.length(&space), |mut objective| objective.path_cost(path)))
    }
}

impl fmt::Display for ObjectiveName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length => f.write_str("length"),
            Self::Clearance { weight, range: Some(range) } => write!(f, "clearance:{weight}:{range}"),
            Self::Clearance { weight: WEIGHT, .. } => f.write_str("clearance"),
            Self::Clearance { weight, .. } => write!(f, "clearance:{weight}"),
        }
    }
}

impl FromStr for ObjectiveName {
    type Err = Error;
    fn from_str(s: &str) -> Result<Self, Error> {
        let number = |what: &str, text: &str| {
            let wrong = |e| Error::new(format!("the {what} of the objective is `{text}`: {e}"));
            positive_number(text).map_err(|e| wrong(e).help("give numbers, such as clearance:10:0.2"))
        };
        let mut parts = s.splitn(3, ':');
        match (parts.next(), parts.next(), parts.next()) {
            (Some("length"), None, _) => Ok(Self::Length),
            (Some("clearance"), weight, range) => Ok(Self::Clearance {
                weight: weight.map_or(Ok(WEIGHT), |weight| number("weight", weight))?,
                range: range.map(|range| number("range", range)).transpose()?,
            }),
            _ => Err(Error::new(format!("there is no objective `{s}`"))
                .help("there are: length, clearance, clearance:WEIGHT, clearance:WEIGHT:RANGE")),
        }
    }
}

crate::as_text!(ObjectiveName);
