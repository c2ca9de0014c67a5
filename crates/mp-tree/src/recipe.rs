//! What makes one variant of the family differ from another.

use crate::BuildError;
use mp_cspace::Space;

/// How far one step goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// A distance in the metric of the space.
    Length(f64),
    /// A fraction of the extent of the space.
    Fraction(f64),
}

impl Step {
    /// The step as a distance in `space`.
    ///
    /// # Errors
    /// When it is not positive, not finite, or longer than the extent of the space.
    pub fn length_in<C: Space>(self, space: &C) -> Result<f64, BuildError> {
        let extent = space.extent();
        let (value, most, length) = match self {
            Self::Length(length) => (length, extent, length),
            Self::Fraction(fraction) => (fraction, 1.0, fraction * extent),
        };
        if value > 0.0 && value <= most && length > 0.0 && length.is_finite() {
            return Ok(length);
        }
        let unit = match self {
            Self::Length(_) => "the extent of the space",
            Self::Fraction(_) => "as a fraction of the extent of the space",
        };
        Err(BuildError::OutOfRange { name: "step", value, range: format!("in (0, {most}], {unit}") })
    }
}

/// The parameters every planner of the family has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Longest step, in (0, extent of the space]; default a fifth of the extent.
    pub step: Step,
    /// Probability of aiming at the goal rather than exploring, in \[0, 1\]; default 0.05. Planners
    /// that grow a tree from the goal use it for sampling new goal states, where there is a
    /// sampler.
    pub goal_bias: f64,
    /// After this many rejected candidate paths the local planner is no longer believed: each
    /// new edge is verified as it grows. Default 10; 0 verifies every edge.
    pub patience: u64,
}

impl Default for Tuning {
    fn default() -> Self {
        Self { step: Step::Fraction(0.2), goal_bias: 0.05, patience: 10 }
    }
}

impl Tuning {
    pub(crate) fn checked_bias(&self) -> Result<f64, BuildError> {
        if (0.0..=1.0).contains(&self.goal_bias) {
            return Ok(self.goal_bias);
        }
        let range = "in [0, 1], a probability".to_owned();
        Err(BuildError::OutOfRange { name: "goal-bias", value: self.goal_bias, range })
    }
}

/// One variant of the family: a policy for each slot of the engine, and the parameters.
///
/// Planners with two trees have a pair of growths: one for exploring, one for joining.
#[derive(Clone, Copy, Debug)]
pub struct Recipe<P, Se, G, A> {
    /// What to grow toward next.
    pub propose: P,
    /// Which nodes to grow from.
    pub select: Se,
    /// How far to grow in one iteration.
    pub grow: G,
    /// How a new motion joins the tree.
    pub attach: A,
    /// The parameters.
    pub tuning: Tuning,
}
