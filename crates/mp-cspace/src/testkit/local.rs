//! Axioms of local planners.

use crate::{Direction, Extension, LocalPlanner, Reach, Rng, Space};
use std::fmt::Debug;

/// Checks a [`LocalPlanner`] on random pairs of states. A full reach is all or nothing, and a motion that
/// reaches the target ends at it exactly. An advance moves, by at most a step. Costs are finite and not
/// negative. The same question gets the same answer. For planners that step by time rather than distance give
/// `step` as infinite.
///
/// # Panics
/// When an axiom is violated, naming it and the states.
pub fn check_local_planner<C, L>(space: &C, planner: &mut L, step: f64, seed: u64)
where
    C: Space,
    L: LocalPlanner<C::State>,
{
    let slack = 1e-9 * space.extent();
    let mut rng = Rng::seed(seed);
    for _ in 0..200 {
        let (a, b) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
        for direction in [Direction::Forward, Direction::Backward] {
            for reach in [Reach::Full, Reach::Step(step)] {
                let case = format!("{direction:?}, {reach:?}\n  from {a:?}\n  to   {b:?}");
                let extension = planner.extend(&a, &b, direction, reach);
                let again = planner.extend(&a, &b, direction, reach);
                assert!(
                    end_of(&extension) == end_of(&again),
                    "local planner: the same question gets the same answer, violated: {case}"
                );
                check_extension(&|a, b| space.distance(a, b), slack, &extension, &a, &b, reach, &case);
            }
        }
    }
}

fn end_of<S, E>(extension: &Extension<S, E>) -> Option<(&S, f64)> {
    match extension {
        Extension::Trapped => None,
        Extension::Advanced(m) | Extension::Reached(m) => Some((&m.end, m.cost)),
    }
}

fn check_extension<S: PartialEq + Debug, E>(
    distance: &dyn Fn(&S, &S) -> f64,
    slack: f64,
    extension: &Extension<S, E>,
    from: &S,
    to: &S,
    reach: Reach,
    case: &str,
) {
    if let Some((_, cost)) = end_of(extension) {
        assert!(
            cost.is_finite() && cost >= 0.0,
            "local planner: costs are finite and not negative, violated: {cost}: {case}"
        );
    }
    match extension {
        Extension::Trapped => {}
        Extension::Reached(m) => {
            assert!(
                m.end == *to,
                "local planner: what is reached is exactly the target, violated by {:?}: {case}",
                m.end
            );
            if let Reach::Step(step) = reach {
                let d = distance(from, to);
                assert!(
                    d <= step + slack,
                    "local planner: nothing beyond the step {step} is reached, violated at {d}: {case}"
                );
            }
        }
        Extension::Advanced(m) => {
            let Reach::Step(step) = reach else {
                panic!(
                    "local planner: a full reach is all or nothing, violated: advanced to {:?}: {case}",
                    m.end
                )
            };
            let d = distance(from, &m.end);
            assert!(
                d <= step + slack,
                "local planner: an advance stays within the step {step}, violated: {d}: {case}"
            );
            assert!(d > 0.0, "local planner: an advance is of use, violated: it stays where it was: {case}");
        }
    }
}
