//! What planners made by name are made from.

mod uniform;

pub use uniform::{ACCEPT, INPUTS, LEVELS, ORDER};
pub(crate) use uniform::{make_by_inputs, moved_by_inputs};

use crate::{BuildError, Problem, Settings, Tuning};
use mp_cspace::{MotionValidity, NearestNeighbors, Planner, Space, Straight};

/// A planner chosen at run time.
pub type AnyPlanner<'c, S, E> = Box<dyn Planner<S, Edge = E> + Send + 'c>;

/// The types of a planner made by name: a tuple of space, motion check and index.
pub(crate) trait Types<'c> {
    type State: Clone + PartialEq + Send + Sync + std::fmt::Debug + 'c;
    type Space: Space<State = Self::State> + 'c;
    type Check: MotionValidity<Self::State> + Send + 'c;
    type Index: NearestNeighbors<Self::Space> + Clone + Send + 'c;
}

impl<'c, C, M, N> Types<'c> for (C, M, N)
where
    C: Space<State: 'c> + 'c,
    M: MotionValidity<C::State> + Send + 'c,
    N: NearestNeighbors<C> + Clone + Send + 'c,
{
    type State = C::State;
    type Space = C;
    type Check = M;
    type Index = N;
}

/// The local planner of planners made by name.
pub(crate) type Local<'c, T> = Straight<'c, <T as Types<'c>>::Space, <T as Types<'c>>::Check>;

/// What a planner is made from by name.
pub(crate) struct BuildArgs<'c, 's, T: Types<'c>> {
    /// The problem, with what is known of obstacles.
    pub(crate) problem: Problem<'c, T::Space, Local<'c, T>>,
    /// An empty index.
    pub(crate) index: T::Index,
    /// The parameters that every planner has.
    pub(crate) tuning: Tuning,
    /// All parameters that are set; the planner has parameters of these names.
    pub(crate) settings: &'s Settings,
}

/// The planner, or why it cannot be made.
pub(crate) type BuildResult<'c, T> = Result<AnyPlanner<'c, <T as Types<'c>>::State, ()>, BuildError>;

/// Makes one kind of planner.
pub(crate) type BuildFn<'c, 's, T> = fn(BuildArgs<'c, 's, T>) -> BuildResult<'c, T>;
