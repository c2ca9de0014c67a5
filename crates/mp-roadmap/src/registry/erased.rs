//! Planners of erased problems, made by name, and their roadmaps: compiled here, once for all spaces.

use crate::{
    AnyEdgeChecker, AnyIndex, AnyParallelProblem, AnyPlanner, BuildError, InRegions, IndexedRoadmap, Piece,
    Roadmap, Settings, Unanswered, build_with,
};
use mp_cspace::{Configuration, Path};

/// A roadmap of an erased problem, ready to answer queries.
pub type AnyRoadmap = IndexedRoadmap<Configuration, (), AnyIndex<Configuration>>;

/// The regions of an erased space.
pub type AnyRegions = InRegions<Configuration, AnyIndex<Configuration>>;

/// The planner called `name`, as [`build_with`] makes it, for [configurations](Configuration). Calling it
/// compiles no planner.
///
/// # Errors
/// As [`build`](crate::build).
///
/// ```
/// use mp_cspace::erased::{AnyCheck, AnyIndex, AnySpace};
/// use mp_cspace::{Configuration, Discrete, FineDiscrete, Iterations, Joints, Outcome, Problem, Length, Rng, Straight};
/// use mp_roadmap::{AnyParallelProblem, Settings, erased::build};
///
/// let space = Joints::<Configuration>::intervals(&[0.0, 0.0], &[1.0, 1.0])?;
/// let any = AnySpace::new(&space);
/// let free = |q: &Configuration| (q[0] - 0.5).hypot(q[1] - 0.5) > 0.3;
/// let check: AnyCheck<_> = Box::new(Discrete::new(&space, free, Length::Fraction(0.01))?);
/// let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
/// let (start, goal) = (Configuration::from([0.1, 0.5]), Configuration::from([0.9, 0.5]));
/// let team = AnyParallelProblem::from(Problem::new(&any, Straight::new(&any, check), verifier, start, goal)?);
///
/// let mut planner = build("prm", team, AnyIndex::of(&space), &Settings::default())?;
/// let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
/// assert!(matches!(outcome, Outcome::Solved(_)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn build<'c>(
    name: &str,
    parallel: AnyParallelProblem<'c, Configuration>,
    index: AnyIndex<Configuration>,
    settings: &Settings,
) -> Result<AnyPlanner<'c, Configuration, ()>, BuildError> {
    build_with(name, parallel, index, settings)
}

/// As [`IndexedRoadmap::answer`].
///
/// # Errors
/// When the roadmap has no path, with the reason.
pub fn answer(
    roadmap: &mut AnyRoadmap,
    checker: &mut AnyEdgeChecker<'_, Configuration>,
    start: &Configuration,
    goal: &Configuration,
) -> Result<Path<Configuration>, Unanswered> {
    roadmap.answer(checker, start, goal)
}

/// As [`IndexedRoadmap::routes`], without the lengths.
///
/// # Errors
/// When the roadmap has no path, with the reason.
pub fn routes(
    roadmap: &mut AnyRoadmap,
    checker: &mut AnyEdgeChecker<'_, Configuration>,
    ends: [&Configuration; 2],
    k: usize,
    apart: f64,
) -> Result<Vec<Path<Configuration>>, Unanswered> {
    Ok(roadmap.routes(checker, ends, k, apart)?.into_iter().map(|(path, _)| path).collect())
}

/// As [`IndexedRoadmap::verify`].
pub fn verify(roadmap: &mut AnyRoadmap, checker: &mut AnyEdgeChecker<'_, Configuration>) -> usize {
    roadmap.verify(checker)
}

/// As [`InRegions::piece_of`].
pub fn piece(
    regions: &AnyRegions,
    item: u64,
    map: &Roadmap<Configuration>,
    checker: &mut AnyEdgeChecker<'_, Configuration>,
    seed: u64,
) -> Piece<Configuration, ()> {
    regions.piece_of(item, map, checker, seed)
}
