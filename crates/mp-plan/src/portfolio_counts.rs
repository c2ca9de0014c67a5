//! What a report says of a portfolio. It is known without the work itself, which needs `mp-ranks`.

use crate::Error;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// The caps of the runs of a portfolio: of run i the i-th length, in units, of the schedule that
/// [`restart-`](mp_tree::algo::restarts) planners go through one after the other. In addition each run has the budgets of its request.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PortfolioSchedule {
    /// No caps: all runs of a round race to the end (Carpin and Pagello 2002).
    #[default]
    None,
    /// 1, 1, 2, 1, 1, 2, 4, 1, … (Luby, Sinclair and Zuckerman 1993).
    Luby,
    /// Counter search: at the count n = 1, 2, 3, … every length whose square divides n (Amato, Ashur and Har-Peled 2025).
    Counter,
    /// Length t with probability 6/(π·t)² (the same); lengths are drawn from stream *(seed, 0)*.
    Zeta,
    /// Wide search (Ashur and Har-Peled 2025) up to the beginning of its last run: of N runs, run i has ⌊N/i⌋ units; of further N runs twice
    /// as many.
    Wide,
}

impl PortfolioSchedule {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::None, Self::Luby, Self::Counter, Self::Zeta, Self::Wide];

    /// Its name on the command line and in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Luby => "luby",
            Self::Counter => "counter",
            Self::Zeta => "zeta",
            Self::Wide => "wide",
        }
    }
}

impl fmt::Display for PortfolioSchedule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for PortfolioSchedule {
    type Err = Error;
    fn from_str(name: &str) -> Result<Self, Error> {
        Self::ALL.into_iter().find(|schedule| schedule.name() == name).ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            Error::new(format!("there is no schedule `{name}`")).help(format!("there are: {names}"))
        })
    }
}

/// The runs of a portfolio, in its [report](crate::Report::portfolio). Unless time or a cancel has ended it, all numbers are the same on any number
/// of threads and ranks.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PortfolioCounts {
    /// How many runs it has, unless it goes on.
    pub runs: u64,
    /// Their caps.
    pub schedule: PortfolioSchedule,
    /// Iterations of a run of length 1.
    pub unit: u64,
    /// Runs of a round.
    pub round: u64,
    /// How many runs were begun: those of the rounds up to the winner's.
    pub begun: u64,
    /// The run whose path this is, from 1.
    pub winner: Option<u64>,
    /// How many iterations the result needs, in all runs that were begun: those of the winner in each run of its round, or fewer where a run
    /// ended before, and all of the rounds before. What was done beyond that is not counted: that is in the outcome of the portfolio.
    pub iterations: u64,
}
