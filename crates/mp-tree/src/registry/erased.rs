//! Planners of erased problems, made by name: compiled here, once for all spaces.

use crate::{AnyIndex, AnyPlanner, AnyProblem, BuildError, Settings, Workers, build_from};
use mp_cspace::Configuration;
use std::sync::Arc;

/// Makes an erased problem, the same one on every call.
pub type ProblemFactory<'c> =
    Arc<dyn Fn() -> Result<AnyProblem<'c, Configuration>, BuildError> + Send + Sync + 'c>;

/// The planner called `name`, as [`build_from`] makes it, for [configurations](Configuration). Calling it
/// compiles no planner.
///
/// # Errors
/// As [`build_from`].
///
/// ```
/// use mp_cspace::erased::{AnyIndex, AnySpace};
/// use mp_cspace::{Configuration, Discrete, FineDiscrete, Iterations, Joints, Outcome, Length, Rng, Straight};
/// use mp_tree::{Problem, Settings, Workers, erased::{ProblemFactory, build}};
/// use std::sync::Arc;
///
/// let space = Joints::<Configuration>::intervals(&[0.0, 0.0], &[1.0, 1.0])?;
/// let any = AnySpace::new(&space);
/// let (start, goal) = (Configuration::from([0.1, 0.5]), Configuration::from([0.9, 0.5]));
/// let make: ProblemFactory = Arc::new(|| {
///     let free = |q: &Configuration| (q[0] - 0.5).hypot(q[1] - 0.5) > 0.3;
///     let check = Discrete::new(&space, free, Length::Fraction(0.01))?;
///     let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
///     Problem::new(&any, Straight::new(&any, Box::new(check)), verifier, start.clone(), goal.clone())
/// });
/// let (index, workers) = (AnyIndex::of(&space), Workers::single());
/// let mut planner = build("rrt-connect", make, index, &Settings::default(), &workers)?;
/// let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
/// assert!(matches!(outcome, Outcome::Solved(_)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn build<'c>(
    name: &str,
    make: ProblemFactory<'c>,
    index: AnyIndex<Configuration>,
    settings: &Settings,
    workers: &Workers,
) -> Result<AnyPlanner<'c, Configuration, ()>, BuildError> {
    build_from(name, move || make(), index, settings, workers)
}
