//! The parameters that several planners have.

use mp_cspace::{
    BuildError, Length,
    registry::{Demand, Parameter, PlannerInfo, Settings},
};

const REGION: (Demand, &str) =
    (Demand::Region, "it also grows a tree from the goal, which needs a state to grow from");
const ONE_WAY: (Demand, &str) =
    (Demand::OneWay, "it also grows a tree from the goal, by motions that run backward");
/// An entry of [`PlannerInfo::cannot`](crate::PlannerInfo::cannot) of planners that grow along obstacles.
pub(crate) const NEEDS_HINTS: (Demand, &str) =
    (Demand::NoHints, "it grows along obstacles, and no hints of them are known of this robot");
/// An entry of [`PlannerInfo::cannot`](crate::PlannerInfo::cannot) of planners that are pushed by obstacles.
pub(crate) const NEEDS_GRADIENT: (Demand, &str) = (
    Demand::NoGradient,
    "it is pushed by obstacles, and no gradient of the clearance is known of this robot",
);

/// [`PlannerInfo::cannot`](crate::PlannerInfo::cannot) of planners that grow a tree from the goal.
pub const NEEDS_BOTH_ENDS: &[(Demand, &str)] = &[REGION, ONE_WAY];
/// That of those that also grow along obstacles.
pub(crate) const NEEDS_BOTH_ENDS_AND_HINTS: &[(Demand, &str)] = &[REGION, ONE_WAY, NEEDS_HINTS];
/// That of those that are also pushed by obstacles.
pub(crate) const NEEDS_BOTH_ENDS_AND_GRADIENT: &[(Demand, &str)] = &[REGION, ONE_WAY, NEEDS_GRADIENT];

/// [`Tuning::step`](crate::Tuning::step).
pub const STEP: Parameter = Parameter {
    name: "step",
    range: "in (0, extent of the space], or with % in (0%, 100%] of the extent",
    default: "5%",
    doc: "longest step, in the metric of the space",
};

/// [`Tuning::goal_bias`](crate::Tuning::goal_bias).
pub const GOAL_BIAS: Parameter = Parameter {
    name: "goal-bias",
    range: "in [0, 1]",
    default: "0.05",
    doc: "probability of aiming at the goal (with two trees: of sampling a new goal state)",
};

/// [`Tuning::patience`](crate::Tuning::patience).
pub const PATIENCE: Parameter = Parameter {
    name: "patience",
    range: "a whole number",
    default: "10",
    doc: "rejected paths after which every new edge is verified as it grows",
};

/// [`Tuning::balance`](crate::Tuning::balance).
pub const BALANCE: Parameter = Parameter {
    name: "balance",
    range: "0, or at least 1",
    default: "0",
    doc: "the tree with more than this times the nodes of the other one waits for it; 0: they take turns whatever their sizes",
};

/// The parameters every planner of the family has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Longest step, in (0, extent of the space]; by default a twentieth of the extent.
    pub step: Length,
    /// Probability of aiming at the goal rather than exploring, in \[0, 1\]; by default 0.05. Planners that
    /// grow a tree from the goal sample a new goal state with this probability, where there is a sampler.
    pub goal_bias: f64,
    /// After this many rejected paths the local planner is no longer trusted: each new edge is verified as it
    /// grows. By default 10; 0 verifies every edge.
    pub patience: u64,
    /// Of two trees, one with more than this times the nodes of the other does not explore until that has
    /// caught up (J. J. Kuffner and S. M. LaValle, *An efficient approach to path planning using balanced
    /// bidirectional RRT search*, CMU-RI-TR-05-34, 2005). At least 1, or 0 for strict turns, the default. It
    /// helps where one end is boxed in, unless hardly any step is free there.
    pub balance: f64,
}

impl Default for Tuning {
    fn default() -> Self {
        Self { step: Length::Fraction(0.05), goal_bias: 0.05, patience: 10, balance: 0.0 }
    }
}

impl Tuning {
    /// The parameters that are set, the others by default. Their range is checked when the planner is
    /// made.
    ///
    /// # Errors
    /// When `planner` has no parameter of a name that is set, or a value cannot be read.
    pub fn read(settings: &Settings, planner: &PlannerInfo) -> Result<Self, BuildError> {
        settings.check(planner)?;
        let default = Self::default();
        Ok(Self {
            step: settings.length(STEP.name)?.unwrap_or(default.step),
            goal_bias: settings.number(GOAL_BIAS.name)?.unwrap_or(default.goal_bias),
            patience: settings.count(PATIENCE.name)?.unwrap_or(default.patience),
            balance: settings.number(BALANCE.name)?.unwrap_or(default.balance),
        })
    }

    /// The goal bias.
    ///
    /// # Errors
    /// When it is out of range.
    pub fn checked_bias(&self) -> Result<f64, BuildError> {
        if (0.0..=1.0).contains(&self.goal_bias) {
            return Ok(self.goal_bias);
        }
        let range = "in [0, 1], a probability".to_owned();
        Err(BuildError::OutOfRange { name: "goal-bias", value: self.goal_bias, range })
    }

    /// The balance.
    ///
    /// # Errors
    /// When it is out of range.
    pub fn checked_balance(&self) -> Result<f64, BuildError> {
        if self.balance == 0.0 || self.balance >= 1.0 {
            return Ok(self.balance);
        }
        let range = "0, or at least 1".to_owned();
        Err(BuildError::OutOfRange { name: "balance", value: self.balance, range })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INFO: PlannerInfo = PlannerInfo {
        name: "p",
        summary: "",
        citation: "",
        parameters: &[STEP, GOAL_BIAS, PATIENCE],
        aliases: &[],
        cannot: &[],
    };

    #[test]
    fn reads_what_is_set() {
        let settings = Settings::parse(["step = 2.5", "patience=3", "step=10%"]).unwrap();
        let tuning = Tuning::read(&settings, &INFO).unwrap();
        assert_eq!(tuning, Tuning { step: Length::Fraction(0.1), patience: 3, ..Tuning::default() });
        assert_eq!(Tuning::read(&Settings::default(), &INFO).unwrap(), Tuning::default());
    }

    #[test]
    fn the_tables_defaults_are_the_defaults() {
        let settings =
            Settings::parse(INFO.parameters.iter().map(|p| format!("{}={}", p.name, p.default))).unwrap();
        assert_eq!(Tuning::read(&settings, &INFO).unwrap(), Tuning::default());
    }

    #[test]
    fn refuses_what_it_cannot_read() {
        for text in ["step=far", "step=%", "goal-bias=", "patience=-1", "patience=1.5"] {
            let error = Tuning::read(&Settings::parse([text]).unwrap(), &INFO).unwrap_err();
            assert!(matches!(error, BuildError::Malformed { .. }), "{text}: {error}");
        }
        let error = Tuning::read(&Settings::parse(["stepp=1"]).unwrap(), &INFO).unwrap_err();
        assert_eq!(
            error.to_string(),
            "p has no parameter `stepp` (did you mean `step`?); it has: step, goal-bias, patience"
        );
    }
}
