//! What plans with a robot needs to know of its motions: by types, and behind pointers, so that what plans is compiled once for each
//! type of configuration, not once for each kind of robot.

use crate::counted::Counted;
use crate::roadmaps::RoadmapState;
use crate::robot::{Checker, Queries};
use crate::{Error, RobotKind};
use mp_cspace::erased::{AnyCheck, AnyFactored, AnySpace};
use mp_cspace::{
    Certified, Clearance, ClearanceSearch, Discrete, Factored, Interrupt, IntervalClearance, KnownFree,
    LeastClearance, MotionCheck, MotionClearance, MotionInterval, MotionValidity, ObstacleKnowledge,
    ParameterError, Resolution, StateVector, Validity,
};
use mp_tree::TreeState;
use std::fmt::{self, Debug};
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

/// A type of configuration that planners are compiled for.
pub trait Configuration: TreeState + RoadmapState + StateVector + 'static {}
impl<S: TreeState + RoadmapState + StateVector + 'static> Configuration for S {}

/// What a robot's configurations are.
pub trait Configured {
    /// A configuration.
    type State: Configuration;
}

/// A robot behind a pointer.
pub type AnyKind<S> = dyn RobotKind<State = S>;

/// The motions of a robot among its obstacles, by types. Implement it for a robot of your own, beside [`RobotKind`].
pub trait TypedMotion: Configured + Sized {
    /// The space of configurations, under its default metric.
    type Space: Factored<State = Self::State> + Clone + Send + Debug;
    /// The check of configurations and motions while planning.
    type Checker: Checker<Self::State> + 'static;
    /// The independent check of finished paths: it shares no code with the checker.
    type Verifier<'c>: MotionValidity<Self::State> + Clone + Send + Sync
    where
        Self: 'c;

    /// The space.
    fn space(&self) -> &Self::Space;
    /// The checker. Clone it to use it.
    fn checker(&self) -> &Self::Checker;
    /// A verifier.
    ///
    /// # Errors
    /// When the robot cannot be verified.
    fn verifier(&self) -> Result<Self::Verifier<'_>, Error>;
    /// What planners may know of the obstacles, from checkers that `counted` makes, whose queries are counted.
    /// By default nothing: planners that need such knowledge refuse the robot.
    fn obstacles<'c>(
        &'c self,
        _counted: &dyn Fn() -> Counted<'c, Self::Checker>,
    ) -> ObstacleKnowledge<'c, Self::State> {
        ObstacleKnowledge::default()
    }

    /// The same robot among the same obstacles, with another start and other goals, of which there is at least one. By
    /// default an error: override it for front ends in which ends are moved.
    ///
    /// # Errors
    /// When such robots cannot be given other ends.
    fn with_ends(&self, _start: Self::State, _goals: Vec<Self::State>) -> Result<Self, Error> {
        Err(Error::new("this robot cannot be given another start or goal")
            .help("make the scene again with other ends"))
    }
    /// The same scene, whose start was given by this row. By default that makes no difference.
    #[must_use]
    fn starting_as(self, _row: &[f64]) -> Self {
        self
    }
    /// The same robot, which keeps the clearance `kept` (m) from obstacles, in place of the one kept before:
    /// [`RobotKind::kept`] says which. What is nearer counts as in contact for checker and verifier, and the checker gives clearances that
    /// are less by this much. By default an error.
    ///
    /// # Errors
    /// When such robots cannot keep a clearance.
    fn keeping(&self, _kept: f64) -> Result<Self, Error> {
        Err(Error::new("this robot cannot keep a clearance from obstacles")
            .help("ask for none, or implement `TypedMotion::keeping` and `checker_keeping` for it"))
    }
    /// The checker of [`keeping`](Self::keeping); `None`, the default, where the robot cannot keep a clearance.
    fn checker_keeping(&self, _kept: f64) -> Option<Self::Checker> {
        None
    }
}

/// How queries are counted, and what ends them.
#[derive(Clone, Debug)]
pub struct Counting<'c> {
    queries: &'c AtomicU64,
    interrupt: Interrupt,
    exactly: bool,
}

impl<'c> Counting<'c> {
    /// Adds queries to `queries`, until `interrupt` says to end.
    #[must_use]
    pub fn new(queries: &'c AtomicU64, interrupt: Interrupt) -> Self {
        Self { queries, interrupt, exactly: false }
    }

    /// Adds each query at once if `exactly`, so that the common count is always exact.
    pub(crate) fn exactly(self, exactly: bool) -> Self {
        Self { exactly, ..self }
    }

    /// The checker, counted.
    pub fn of<R: Queries>(&self, checker: R) -> Counted<'c, R> {
        let counted = Counted::new(checker, self.queries).with_interrupt(self.interrupt.clone());
        if self.exactly { counted.exactly() } else { counted }
    }
}

/// How motions are checked.
#[derive(Clone, Copy, Debug)]
pub enum By<'c, S> {
    /// With a certificate of this tolerance (m).
    Certificates(f64),
    /// At states so far apart in this space.
    States(&'c AnySpace<'c, S>, Resolution),
}

/// The motions of a robot among its obstacles, behind pointers: [`TypedMotion`] gives them.
pub trait Motion: Configured {
    /// The space.
    fn any_space(&self) -> AnyFactored<'_, Self::State>;
    /// A checker.
    fn any_checker(&self) -> AnyChecker<Self::State>;
    /// A checker that keeps no clearance: what it measures is the distance to obstacles itself.
    fn any_measure(&self) -> AnyChecker<Self::State>;
    /// The same robot, which keeps a clearance from obstacles: [`TypedMotion::keeping`].
    ///
    /// # Errors
    /// When such robots cannot keep a clearance.
    fn any_keeping(&self, kept: f64) -> Result<Arc<AnyKind<Self::State>>, Error>;
    /// A verifier.
    ///
    /// # Errors
    /// When the robot cannot be verified.
    fn any_verifier(&self) -> Result<AnyVerifier<'_, Self::State>, Error>;
    /// The check of motions while planning.
    ///
    /// # Errors
    /// When tolerance or resolution are not valid.
    fn motions<'c>(
        &'c self,
        by: By<'c, Self::State>,
        counting: &Counting<'c>,
    ) -> Result<AnyCheck<'c, Self::State>, ParameterError>;
    /// What planners may know of the obstacles.
    fn any_obstacles<'c>(&'c self, counting: &Counting<'c>) -> ObstacleKnowledge<'c, Self::State>;
    /// The same robot with other ends, the start given by a row.
    ///
    /// # Errors
    /// When such robots cannot be given other ends.
    fn any_with_ends(
        &self,
        start: Self::State,
        goals: Vec<Self::State>,
        row: &[f64],
    ) -> Result<Arc<AnyKind<Self::State>>, Error>;
}

impl<K: TypedMotion + RobotKind> Motion for K {
    fn any_space(&self) -> AnyFactored<'_, Self::State> {
        AnyFactored::new(self.space())
    }
    fn any_checker(&self) -> AnyChecker<Self::State> {
        AnyChecker(Box::new(self.checker().clone()))
    }
    fn any_measure(&self) -> AnyChecker<Self::State> {
        AnyChecker(Box::new(self.checker_keeping(0.0).unwrap_or_else(|| self.checker().clone())))
    }
    fn any_keeping(&self, kept: f64) -> Result<Arc<AnyKind<Self::State>>, Error> {
        Ok(Arc::new(self.keeping(kept)?))
    }
    fn any_verifier(&self) -> Result<AnyVerifier<'_, Self::State>, Error> {
        Ok(AnyVerifier(Box::new(self.verifier()?)))
    }
    fn motions<'c>(
        &'c self,
        by: By<'c, Self::State>,
        counting: &Counting<'c>,
    ) -> Result<AnyCheck<'c, Self::State>, ParameterError> {
        let counted = counting.of(self.checker().clone());
        Ok(match by {
            By::Certificates(tolerance) => Box::new(Certified::new(self.space(), counted, tolerance)?),
            By::States(space, resolution) => Box::new(Discrete::new(space, counted, resolution)?),
        })
    }
    fn any_obstacles<'c>(&'c self, counting: &Counting<'c>) -> ObstacleKnowledge<'c, Self::State> {
        self.obstacles(&|| counting.of(self.checker().clone()))
    }
    fn any_with_ends(
        &self,
        start: Self::State,
        goals: Vec<Self::State>,
        row: &[f64],
    ) -> Result<Arc<AnyKind<Self::State>>, Error> {
        Ok(Arc::new(self.with_ends(start, goals)?.starting_as(row)))
    }
}

/// The methods of [`Checker`] as a trait object.
trait ErasedChecker<S>: Validity<S> + MotionClearance<S> + Queries + Send + Sync {
    fn boxed(&self) -> Box<dyn ErasedChecker<S>>;
}

impl<S, R: Checker<S> + 'static> ErasedChecker<S> for R {
    fn boxed(&self) -> Box<dyn ErasedChecker<S>> {
        Box::new(self.clone())
    }
}

/// Any [`Checker`] behind a pointer.
pub struct AnyChecker<S>(Box<dyn ErasedChecker<S>>);

impl<S> Clone for AnyChecker<S> {
    fn clone(&self) -> Self {
        Self((*self.0).boxed())
    }
}

impl<S> Debug for AnyChecker<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AnyChecker").field("queries", &self.0.queries()).finish_non_exhaustive()
    }
}

impl<S> Queries for AnyChecker<S> {
    fn queries(&self) -> u64 {
        self.0.queries()
    }
}

impl<S> Validity<S> for AnyChecker<S> {
    fn is_valid(&mut self, q: &S) -> bool {
        self.0.is_valid(q)
    }
    fn first_invalid(&mut self, states: &[S]) -> Option<usize> {
        self.0.first_invalid(states)
    }
    fn batch_size(&self) -> usize {
        self.0.batch_size()
    }
}

impl<S> Clearance<S> for AnyChecker<S> {
    fn clearance(&mut self, q: &S, enough: f64) -> f64 {
        self.0.clearance(q, enough)
    }
    fn in_contact(&mut self, q: &S) -> bool {
        self.0.in_contact(q)
    }
}

impl<S> MotionClearance<S> for AnyChecker<S> {
    fn motion_bound(&self, from: &S, to: &S) -> f64 {
        self.0.motion_bound(from, to)
    }
    fn interval_clearance(&mut self, interval: &MotionInterval<'_, S>) -> IntervalClearance {
        self.0.interval_clearance(interval)
    }
    fn least_along(&mut self, search: &ClearanceSearch<'_, S>) -> LeastClearance {
        self.0.least_along(search)
    }
    fn contact_first(&self) -> bool {
        self.0.contact_first()
    }
}

/// The methods of a verifier as a trait object.
trait ErasedVerifier<'c, S>: MotionValidity<S> + Send + Sync {
    fn boxed(&self) -> Box<dyn ErasedVerifier<'c, S> + 'c>;
}

impl<'c, S, V: MotionValidity<S> + Clone + Send + Sync + 'c> ErasedVerifier<'c, S> for V {
    fn boxed(&self) -> Box<dyn ErasedVerifier<'c, S> + 'c> {
        Box::new(self.clone())
    }
}

/// Any verifier behind a pointer.
pub struct AnyVerifier<'c, S>(Box<dyn ErasedVerifier<'c, S> + 'c>);

impl<S> Clone for AnyVerifier<'_, S> {
    fn clone(&self) -> Self {
        Self((*self.0).boxed())
    }
}

impl<S> Debug for AnyVerifier<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AnyVerifier").finish_non_exhaustive()
    }
}

impl<S> MotionValidity<S> for AnyVerifier<'_, S> {
    fn check_motion(&mut self, from: &S, to: &S) -> MotionCheck {
        self.0.check_motion(from, to)
    }
    fn check_extension(&mut self, from: &S, to: &S, known: KnownFree) -> MotionCheck {
        self.0.check_extension(from, to, known)
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.0.interrupt_by(interrupt);
    }
    fn is_interrupted(&mut self) -> bool {
        self.0.is_interrupted()
    }
}
