//! Goals of which some numbers are fixed, some are in intervals, and some are free.

use crate::Robot;
use crate::numbers::rounding;
use crate::turns::turning;
use mp_cspace::angle::wrap_angle;
use mp_cspace::{Clearance, Configuration, Goals, Rng, Sampler, Space};
pub use mp_io::GoalPart;
use rand::RngExt;

/// How often a free configuration of a goal is looked for.
const TRIES: usize = 1000;

/// Where the row of a configuration would have to be to be at a goal: the same row if it is there. `turning` says which
/// numbers are the same after a full turn.
fn row_at(turning: &[bool], goal: &[GoalPart], mut row: Vec<f64>) -> Vec<f64> {
    for (i, (part, x)) in goal.iter().zip(&mut row).enumerate() {
        match *part {
            GoalPart::Exactly(v) => *x = v,
            GoalPart::Between([low, high]) if turning.get(i) == Some(&true) => {
                let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
                let off = wrap_angle(*x - middle);
                if off.abs() > half {
                    *x = middle + half.copysign(off);
                }
            }
            GoalPart::Between([low, high]) => *x = x.max(low).min(high),
            GoalPart::Free => {}
        }
    }
    row
}

/// The configuration nearest to `q`, number by number, that is at a goal: `q` itself if it is there.
pub fn next_to(kind: &dyn Robot, goal: &[GoalPart], q: &Configuration) -> Configuration {
    kind.state(&row_at(&turning(kind), goal, kind.row(q)))
}

fn drawn(kind: &dyn Robot, goal: &[GoalPart], rng: &mut Rng) -> Configuration {
    let mut row = kind.row(&kind.any_space().sample_uniform(rng));
    for (part, x) in goal.iter().zip(&mut row) {
        match *part {
            GoalPart::Exactly(v) => *x = v,
            GoalPart::Between([low, high]) => *x = low + (high - low) * rng.random::<f64>(),
            GoalPart::Free => {}
        }
    }
    kind.state(&row)
}

/// Draws from the goals of a robot, each equally likely.
struct FromGoals<'k> {
    kind: &'k dyn Robot,
    goals: &'k [Vec<GoalPart>],
}

impl Sampler<Configuration> for FromGoals<'_> {
    fn sample(&mut self, rng: &mut Rng) -> Configuration {
        let which = if self.goals.len() > 1 { rng.random_range(0..self.goals.len()) } else { 0 };
        drawn(self.kind, &self.goals[which], rng)
    }
}

/// The goals of a robot, for planners: the configurations, or what they may be.
pub fn of_kind(kind: &dyn Robot) -> Goals<'_, Configuration> {
    let Some(goals) = kind.goal_parts() else { return Goals::states(kind.goals().iter().cloned()) };
    let rounding = rounding(kind.any_space().extent().max(1.0));
    let turning = turning(kind);
    let reached = move |q: &Configuration| {
        let row = kind.row(q);
        let there = |goal: &Vec<GoalPart>| kind.state(&row_at(&turning, goal, row.clone()));
        goals.iter().any(|goal| kind.any_space().distance(q, &there(goal)) <= rounding)
    };
    Goals::region(reached).with_sampler(FromGoals { kind, goals })
}

/// One configuration for each goal, free if one is found: with the numbers of the start where the goal leaves them free, or
/// else drawn at random, always the same.
pub fn examples(kind: &dyn Robot, goals: &[Vec<GoalPart>]) -> Vec<Configuration> {
    let (mut checker, mut rng) = (kind.any_checker(), Rng::seed(0));
    let enough = 2.0 * kind.tolerance();
    let example = |goal: &Vec<GoalPart>| {
        let mut row = row_at(&turning(kind), goal, kind.row(kind.start()));
        for (part, x) in goal.iter().zip(&mut row) {
            if let GoalPart::Between([low, high]) = part {
                *x = 0.5 * (low + high);
            }
        }
        let first = kind.state(&row);
        let mut free =
            |q: &Configuration| kind.any_space().contains(q) && checker.clearance(q, enough) >= enough;
        if free(&first) {
            return first;
        }
        (0..TRIES).map(|_| drawn(kind, goal, &mut rng)).find(&mut free).unwrap_or(first)
    };
    goals.iter().map(example).collect()
}

/// The configurations of goals of which every number is given; `None` when one is not.
pub fn rows(goals: &[Vec<GoalPart>]) -> Option<Vec<Vec<f64>>> {
    let value = |part: &GoalPart| match part {
        GoalPart::Exactly(v) => Some(*v),
        _ => None,
    };
    goals.iter().map(|goal| goal.iter().map(value).collect()).collect()
}

/// A goal as people write it: `x 1.5 to 1.7, y 2, yaw free`.
pub fn written(kind: &dyn Robot, goal: &[GoalPart]) -> String {
    let part = |(column, part): (crate::Column, &GoalPart)| match part {
        GoalPart::Exactly(v) => format!("{} {}", column.name, crate::plain(*v)),
        GoalPart::Between([low, high]) => {
            format!("{} {} to {}", column.name, crate::plain(*low), crate::plain(*high))
        }
        GoalPart::Free => format!("{} free", column.name),
    };
    kind.columns().into_iter().zip(goal).map(part).collect::<Vec<_>>().join(", ")
}
