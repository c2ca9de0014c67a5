//! Planners of erased problems, made by name: compiled here for the kinds of state that robots have.

use crate::{AnyIndex, AnyPlanner, AnyProblem, BuildError, Settings, Workers};
use std::fmt::Debug;
use std::sync::Arc;

/// Makes an erased problem, the same one on every call.
pub type ProblemFactory<'c, S> = Arc<dyn Fn() -> Result<AnyProblem<'c, S>, BuildError> + Send + Sync + 'c>;

/// A kind of state for which the planners are compiled: here those of SE(3), SE(2), the plane, and joints; others where
/// [`compile_for`](crate::compile_for) is called. Calling the method compiles no planner.
///
/// ```
/// use mp_cspace::erased::{AnyIndex, AnySpace};
/// use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Resolution, Rn, Rng, Straight};
/// use mp_tree::{ProblemFactory, Problem, Settings, TreeState, Workers};
/// use nalgebra::Vector2;
/// use std::sync::Arc;
///
/// let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
/// let any = AnySpace::new(&space);
/// let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
/// let make: ProblemFactory<Vector2<f64>> = Arc::new(|| {
///     let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
///     let check = Discrete::new(&space, free, Resolution::Fraction(0.01))?;
///     let verifier = FineDiscrete::new(&space, free, Resolution::Fraction(0.0005))?;
///     Problem::new(&any, Straight::new(&any, Box::new(check)), verifier, start, goal)
/// });
/// let (index, workers) = (AnyIndex::of(&space), Workers::single());
/// let mut planner = Vector2::tree_planner("rrt-connect", make, index, &Settings::default(), &workers)?;
/// let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
/// assert!(matches!(outcome, Outcome::Solved(_)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "the tree planners are not compiled for the state `{Self}`",
    label = "not a `TreeState`",
    note = "`mp_tree::compile_for!({Self});` compiles them, in the crate of the state"
)]
pub trait TreeState: Clone + Debug + PartialEq + Send + Sync + Sized {
    /// The planner called `name`, as [`build_from`](crate::build_from) makes it.
    ///
    /// # Errors
    /// As [`build_from`](crate::build_from).
    fn tree_planner<'c>(
        name: &str,
        make: ProblemFactory<'c, Self>,
        index: AnyIndex<Self>,
        settings: &Settings,
        workers: &Workers,
    ) -> Result<AnyPlanner<'c, Self, ()>, BuildError>
    where
        Self: 'c;
}

/// Compiles the planners for states of your own: implements [`TreeState`] for them.
///
/// ```
/// #[derive(Clone, Debug, PartialEq)]
/// struct Crane { boom: f64, rope: f64 }
/// mp_tree::compile_for!(Crane);
/// ```
#[macro_export]
macro_rules! compile_for {
    ($($state:ty),+ $(,)?) => {$(
        impl $crate::TreeState for $state {
            fn tree_planner<'c>(
                name: &str,
                make: $crate::ProblemFactory<'c, Self>,
                index: $crate::AnyIndex<Self>,
                settings: &$crate::Settings,
                workers: &$crate::Workers,
            ) -> ::core::result::Result<$crate::AnyPlanner<'c, Self, ()>, $crate::BuildError>
            where
                Self: 'c,
            {
                $crate::build_from(name, move || make(), index, settings, workers)
            }
        }
    )+};
}

// Not in unit tests, which do not need them and would compile all of them again.
#[cfg(not(test))]
compile_for!(nalgebra::Isometry3<f64>, mp_cspace::Se2State, nalgebra::Vector2<f64>, nalgebra::DVector<f64>,);
