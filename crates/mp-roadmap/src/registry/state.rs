//! Planners of erased problems, made by name: compiled here for the kinds of state that robots have.

use crate::{
    AnyEdgeChecker, AnyIndex, AnyParallelProblem, AnyPlanner, BuildError, InRegions, IndexedRoadmap, Piece,
    Roadmap, Settings, Unanswered,
};
use mp_cspace::Path;
use std::fmt::Debug;

/// A roadmap of an erased problem, ready to answer queries.
pub type AnyRoadmap<S> = IndexedRoadmap<S, (), AnyIndex<S>>;

/// The regions of an erased space.
pub type AnyRegions<S> = InRegions<S, AnyIndex<S>>;

/// A kind of state for which the planners are compiled: here those of SE(3), SE(2), the plane, and joints; others where
/// [`compile_for`](crate::compile_for) is called. Calling the methods compiles no planner.
///
/// ```
/// use mp_cspace::erased::{AnyCheck, AnyIndex, AnySpace};
/// use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Problem, Resolution, Rn, Rng, Straight, registry::Settings};
/// use mp_roadmap::{AnyParallelProblem, RoadmapState};
/// use nalgebra::Vector2;
///
/// let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
/// let any = AnySpace::new(&space);
/// let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
/// let check: AnyCheck<_> = Box::new(Discrete::new(&space, free, Resolution::Fraction(0.01))?);
/// let verifier = FineDiscrete::new(&space, free, Resolution::Fraction(0.0005))?;
/// let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
/// let team = AnyParallelProblem::from(Problem::new(&any, Straight::new(&any, check), verifier, start, goal)?);
///
/// let mut planner = Vector2::roadmap_planner("prm", team, AnyIndex::of(&space), &Settings::default())?;
/// let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
/// assert!(matches!(outcome, Outcome::Solved(_)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "the roadmap planners are not compiled for the state `{Self}`",
    label = "not a `RoadmapState`",
    note = "`mp_roadmap::compile_for!({Self});` compiles them, in the crate of the state"
)]
pub trait RoadmapState: Clone + Debug + PartialEq + Send + Sync + Sized {
    /// The planner called `name`, as [`build_with`](crate::build_with) makes it.
    ///
    /// # Errors
    /// As [`build`](crate::build).
    fn roadmap_planner<'c>(
        name: &str,
        parallel: AnyParallelProblem<'c, Self>,
        index: AnyIndex<Self>,
        settings: &Settings,
    ) -> Result<AnyPlanner<'c, Self, ()>, BuildError>
    where
        Self: 'c;

    /// As [`IndexedRoadmap::answer`].
    ///
    /// # Errors
    /// When the roadmap has no path, with the reason.
    fn answer(
        roadmap: &mut AnyRoadmap<Self>,
        checker: &mut AnyEdgeChecker<'_, Self>,
        start: &Self,
        goal: &Self,
    ) -> Result<Path<Self>, Unanswered>;

    /// As [`IndexedRoadmap::routes`], without the lengths.
    ///
    /// # Errors
    /// When the roadmap has no path, with the reason.
    fn routes(
        roadmap: &mut AnyRoadmap<Self>,
        checker: &mut AnyEdgeChecker<'_, Self>,
        ends: [&Self; 2],
        k: usize,
        apart: f64,
    ) -> Result<Vec<Path<Self>>, Unanswered>;

    /// As [`IndexedRoadmap::verify`].
    fn verify_roadmap(roadmap: &mut AnyRoadmap<Self>, checker: &mut AnyEdgeChecker<'_, Self>) -> usize;

    /// As [`InRegions::piece_of`].
    fn regional_piece(
        regions: &AnyRegions<Self>,
        item: u64,
        map: &Roadmap<Self>,
        checker: &mut AnyEdgeChecker<'_, Self>,
        seed: u64,
    ) -> Piece<Self, ()>;
}

/// Compiles the planners for states of your own: implements [`RoadmapState`] for them.
///
/// ```
/// #[derive(Clone, Debug, PartialEq)]
/// struct Crane { boom: f64, rope: f64 }
/// mp_roadmap::compile_for!(Crane);
/// ```
#[macro_export]
macro_rules! compile_for {
    ($($state:ty),+ $(,)?) => {$(
        impl $crate::RoadmapState for $state {
            fn roadmap_planner<'c>(
                name: &str,
                parallel: $crate::AnyParallelProblem<'c, Self>,
                index: $crate::AnyIndex<Self>,
                settings: &$crate::Settings,
            ) -> ::core::result::Result<$crate::AnyPlanner<'c, Self, ()>, $crate::BuildError>
            where
                Self: 'c,
            {
                $crate::build_with(name, parallel, index, settings)
            }
            fn answer(
                roadmap: &mut $crate::AnyRoadmap<Self>,
                checker: &mut $crate::AnyEdgeChecker<'_, Self>,
                start: &Self,
                goal: &Self,
            ) -> ::core::result::Result<$crate::Path<Self>, $crate::Unanswered> {
                roadmap.answer(checker, start, goal)
            }
            fn routes(
                roadmap: &mut $crate::AnyRoadmap<Self>,
                checker: &mut $crate::AnyEdgeChecker<'_, Self>,
                ends: [&Self; 2],
                k: usize,
                apart: f64,
            ) -> ::core::result::Result<::std::vec::Vec<$crate::Path<Self>>, $crate::Unanswered> {
                let routes = roadmap.routes(checker, ends, k, apart)?;
                ::core::result::Result::Ok(routes.into_iter().map(|(path, _)| path).collect())
            }
            fn verify_roadmap(
                roadmap: &mut $crate::AnyRoadmap<Self>,
                checker: &mut $crate::AnyEdgeChecker<'_, Self>,
            ) -> usize {
                roadmap.verify(checker)
            }
            fn regional_piece(
                regions: &$crate::AnyRegions<Self>,
                item: u64,
                map: &$crate::Roadmap<Self>,
                checker: &mut $crate::AnyEdgeChecker<'_, Self>,
                seed: u64,
            ) -> $crate::Piece<Self, ()> {
                regions.piece_of(item, map, checker, seed)
            }
        }
    )+};
}

// Not in unit tests, which do not need them and would compile all of them again.
#[cfg(not(test))]
compile_for!(nalgebra::Isometry3<f64>, mp_cspace::Se2State, nalgebra::Vector2<f64>, nalgebra::DVector<f64>,);
