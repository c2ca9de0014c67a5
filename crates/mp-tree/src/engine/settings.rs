//! Parameters that several planners have.

use mp_cspace::registry::{Demand, Parameter};

/// [`PlannerInfo::cannot`](crate::PlannerInfo::cannot) of planners that grow a tree from the goal.
pub const NEEDS_BOTH_ENDS: &[(Demand, &str)] = &[
    (Demand::Region, "it also grows a tree from the goal, which needs a state to grow from"),
    (Demand::OneWay, "it also grows a tree from the goal, by motions run backward"),
];

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
