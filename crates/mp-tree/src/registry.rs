//! Planners by name, for programs that choose at run time.

use crate::algo::*;
use crate::snakes::{Plain, bent};
use crate::*;
use mp_cspace::{DefaultNn, MotionValidity, NearestNeighbors, Planner, Space, Straight};

/// A planner chosen at run time.
pub type AnyPlanner<'c, S, E> = Box<dyn Planner<S, Edge = E> + Send + 'c>;

/// All planners of the crate.
#[must_use]
pub fn planners() -> &'static [PlannerInfo] {
    &[
        rrt::INFO,
        rrt_connect::INFO,
        bi_rrt::INFO,
        con_ext::INFO,
        con_con::INFO,
        rrt_star::INFO,
        informed_rrt_star::INFO,
        aorrtc::INFO,
        rrt_inputs::INFO,
        rsrt::INFO,
        cvp_rrt::INFO,
        rc_rrt::INFO,
        dd_rrt::INFO,
        add_rrt::INFO,
        mvb_rrt::INFO,
        utility_rrt::INFO,
        obrrt::INFO,
        cyclic_rrt::INFO,
        rrs::INFO,
        rrs_connect::INFO,
    ]
}

/// The planner called `name`, which may be one of its [other names](PlannerInfo::aliases).
///
/// # Errors
/// When there is none, with the names there are.
pub fn planner(name: &str) -> Result<&'static PlannerInfo, BuildError> {
    planners().iter().find(|info| info.is_called(name)).ok_or_else(|| unknown(name))
}

fn unknown(name: &str) -> BuildError {
    let known: Vec<_> = planners().iter().map(|info| info.name).collect();
    let aliases = planners().iter().flat_map(|info| info.aliases).copied();
    let suggestion = closest(name, known.iter().copied().chain(aliases));
    BuildError::UnknownPlanner { name: name.to_owned(), known, suggestion }
}

/// Makes the planner called `name`, with the nearest neighbours that suit the space. What it asks of obstacles it takes
/// from the [problem](Problem::with_obstacles).
///
/// # Errors
/// When there is no such planner, it has no such parameters, or refuses their values; when the problem does not know
/// of obstacles what the planner asks.
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
    mut problem: Problem<'c, C, Straight<'c, C, M>>,
    index: N,
    settings: &Settings,
) -> Result<AnyPlanner<'c, C::State, ()>, BuildError>
where
    C: Space<State: 'c>,
    M: MotionValidity<C::State> + Send + 'c,
    N: NearestNeighbors<C> + Clone + Send + 'c,
{
    let info = planner(name)?;
    let tuning = Tuning::read(settings, info)?;
    Ok(match info.name {
        "rrt" => Box::new(Rrt::with_index(problem, index, tuning)?),
        "rrt-connect" => Box::new(RrtConnect::with_index(problem, index, tuning)?),
        "bi-rrt" => Box::new(BiRrt::with_index(problem, index, tuning)?),
        "rrt-con-ext" => Box::new(RrtConExt::with_index(problem, index, tuning)?),
        "rrt-con-con" => Box::new(RrtConCon::with_index(problem, index, tuning)?),
        "aorrtc" => Box::new(Aorrtc::with_index(problem, index, tuning)?),
        "rrt-star" => Box::new(RrtStar::with_index(problem, index, tuning, rrt_star::near(settings)?)?),
        "informed-rrt-star" => {
            Box::new(InformedRrtStar::with_index(problem, index, tuning, rrt_star::near(settings)?)?)
        }
        "rrt-inputs" => {
            let problem = uniform::moved_by_inputs(problem, &tuning, settings)?;
            Box::new(RrtInputs::with_index(problem, index, tuning)?)
        }
        "rsrt" => {
            let problem = uniform::moved_by_inputs(problem, &tuning, settings)?;
            Box::new(Rsrt::with_index(problem, index, tuning)?)
        }
        "cvp-rrt" => {
            let problem = uniform::moved_by_inputs(problem, &tuning, settings)?;
            Box::new(CvpRrt::with_index(problem, index, tuning)?)
        }
        "rc-rrt" => {
            let apart = rc_rrt::apart(problem.space(), &tuning, settings)?;
            let problem = uniform::moved_by_inputs(problem, &tuning, settings)?;
            Box::new(RcRrt::with_index(problem, index, apart, tuning)?)
        }
        "obrrt" => {
            let hints =
                problem.take_obstacles().hints.ok_or(BuildError::NoHints { planner: obrrt::INFO.name })?;
            Box::new(Obrrt::with_index(problem, index, hints, tuning, GrowthWeights::default())?)
        }
        "cyclic-rrt" => {
            let tolerance = cyclic_rrt::tolerance(settings)?;
            Box::new(CyclicRrt::with_index(problem, index, tuning, tolerance)?)
        }
        "dd-rrt" => Box::new(DdRrt::with_index(problem, index, tuning, Domain::fixed().read(settings)?)?),
        "add-rrt" => Box::new(DdRrt::with_index(problem, index, tuning, Domain::adaptive().read(settings)?)?),
        "mvb-rrt" => {
            let samples = settings.count("samples")?.unwrap_or(5);
            Box::new(MvbRrt::with_index(problem, index, tuning, samples)?)
        }
        "utility-rrt" => {
            let candidates = settings.count("candidates")?.unwrap_or(4);
            Box::new(UtilityRrt::with_index(problem, index, tuning, candidates)?)
        }
        "rrs" => Box::new(Plain(Rrs::with_index(bent(info, problem, settings)?, index, tuning)?)),
        "rrs-connect" => {
            if !problem.goals().can_aim() {
                return Err(BuildError::NoGoalState { planner: info.name });
            }
            Box::new(Plain(RrsConnect::with_index(bent(info, problem, settings)?, index, tuning)?))
        }
        _ => return Err(unknown(name)),
    })
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
