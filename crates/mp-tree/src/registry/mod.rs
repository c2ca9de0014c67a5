//! Planners by name, for programs that choose at run time.

// Unit tests need none of it, and would compile all planners again.
#[cfg(not(test))]
pub mod erased;
mod meta;

pub use meta::{MetaPlanner, PlannerSpec, build_from, meta_planners};

use crate::algo;
use crate::by_name::{AnyPlanner, BuildArgs};
use crate::{BuildError, PlannerInfo, Problem, Settings, Tuning};
use mp_cspace::{DefaultNn, MotionValidity, NearestNeighbors, Space, Straight};

/// All planners of the crate.
#[must_use]
pub fn planners() -> &'static [PlannerInfo] {
    algo::PLANNERS
}

/// The planner called `name`, which may be one of its [other names](PlannerInfo::aliases).
///
/// # Errors
/// When there is no such planner; the error lists the names.
pub fn planner(name: &str) -> Result<&'static PlannerInfo, BuildError> {
    let found = planners().iter().find(|info| info.is_called(name));
    found.ok_or_else(|| BuildError::unknown_planner(name, planners()))
}

/// Makes the planner called `name`, with the nearest neighbours that suit the space. Hints, gradient and
/// geometry of obstacles come from the [problem](Problem::with_obstacles).
///
/// # Errors
/// When there is no such planner, it has no such parameters, or refuses their values; when the problem lacks
/// the knowledge of obstacles that the planner needs.
pub fn build<'c, C, M>(
    name: &str,
    problem: Problem<'c, C, Straight<'c, C, M>>,
    settings: &Settings,
) -> Result<AnyPlanner<'c, C::State, ()>, BuildError>
where
    C: DefaultNn<State: 'c, Nn: 'c>,
    M: MotionValidity<C::State> + Send + 'c,
{
    build_with(name, problem, C::Nn::default(), settings)
}

/// As [`build`], with an empty index of your choice.
///
/// # Errors
/// As [`build`].
pub fn build_with<'c, C, M, N>(
    name: &str,
    problem: Problem<'c, C, Straight<'c, C, M>>,
    index: N,
    settings: &Settings,
) -> Result<AnyPlanner<'c, C::State, ()>, BuildError>
where
    C: Space<State: 'c> + 'c,
    M: MotionValidity<C::State> + Send + 'c,
    N: NearestNeighbors<C> + Clone + Send + 'c,
{
    let (info, make) =
        algo::find::<(C, M, N)>(name).ok_or_else(|| BuildError::unknown_planner(name, planners()))?;
    let tuning = Tuning::read(settings, info)?;
    make(BuildArgs { problem, index, tuning, settings })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_and_unique() {
        let mut names: Vec<&str> =
            planners().iter().flat_map(|p| [p.name].into_iter().chain(p.aliases.iter().copied())).collect();
        for name in &names {
            assert!(planner(name).is_ok_and(|info| info.is_called(name)));
        }
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count, "two planners share a name");
        for (known, alias) in [
            ("bi-rrt", "rrt-ext-ext"),
            ("rrt-connect", "rrt-ext-con"),
            ("rrt-con-ext", "rrt-con-ext"),
            ("rrt-con-con", "rrt-con-con"),
        ] {
            assert_eq!(planner(alias).unwrap().name, known);
        }
        let message = planner("rrt-ext-cno").unwrap_err().to_string();
        assert!(message.contains("did you mean `rrt-ext-con`?"), "{message}");
    }
}
