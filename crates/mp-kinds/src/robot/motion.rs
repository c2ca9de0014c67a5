//! What plans with a robot needs to know of its motions: by types, and behind pointers, so that what plans is compiled once for all
//! kinds of robots.

use crate::robot::counted::Counted;
use crate::robot::{Checker, Queries};
use crate::{Error, Robot};
use mp_cspace::erased::{AnyCheck, AnyFactored, AnySpace};
use mp_cspace::{
    Certified, Clearance, ClearanceSearch, Configuration, Curve, Discrete, Factored, Interrupt,
    IntervalClearance, KnownFree, LeastClearance, Length, MotionCheck, MotionClearance, MotionInterval,
    MotionValidity, ObstacleKnowledge, ParameterError, Space, Spaced, Validity,
};
use std::fmt::{self, Debug};
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

/// The motions of a robot among its obstacles, by types. Implement it for a robot of your own, beside the parts of [`Robot`]. A space and
/// checks whose states are no [`Configuration`] become such by [`AsVectors`](mp_cspace::AsVectors) and
/// [`OnVectors`](mp_cspace::OnVectors).
pub trait TypedMotion: Sized {
    /// The space of configurations, under its default metric.
    type Space: Factored<State = Configuration> + Clone + Send + Debug;
    /// The check of configurations and motions while planning.
    type Checker: Checker<Configuration> + 'static;
    /// The independent check of finished paths: it shares no code with the checker.
    type Verifier<'c>: MotionValidity<Configuration> + Clone + Send + Sync
    where
        Self: 'c;

    /// The space of its configurations.
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
    ) -> ObstacleKnowledge<'c, Configuration> {
        ObstacleKnowledge::default()
    }

    /// The same robot among the same obstacles, with another start and other goals, of which there is at least one. By
    /// default an error: override it for front ends in which ends are moved.
    ///
    /// # Errors
    /// When such robots cannot be given other ends.
    fn with_ends(&self, _start: Configuration, _goals: Vec<Configuration>) -> Result<Self, Error> {
        Err(Error::new("this robot cannot be given another start or goal")
            .help("make the scene again with other ends"))
    }
    /// The same robot with fewer goals: `kept` says of each one whether it stays. `None`, the default, for robots of which no goal is a place
    /// that several configurations reach.
    fn with_goals(&self, _kept: &[bool]) -> Option<Self> {
        None
    }
    /// The same scene, whose start was given by this row. By default that makes no difference.
    #[must_use]
    fn starting_as(self, _row: &[f64]) -> Self {
        self
    }
    /// The same robot, which keeps the clearance `kept` (m) from obstacles, in place of the one kept before:
    /// [`Motion::kept`](crate::Motion::kept) says which. What is nearer counts as in contact for checker and verifier, and the checker gives clearances that
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
    pub fn exactly(self, exactly: bool) -> Self {
        Self { exactly, ..self }
    }

    /// `checker`, which counts its queries here and stops when it is interrupted.
    pub fn of<R: Queries>(&self, checker: R) -> Counted<'c, R> {
        let counted = Counted::new(checker, self.queries).with_interrupt(self.interrupt.clone());
        if self.exactly { counted.exactly() } else { counted }
    }
}

/// How motions are checked.
#[derive(Clone, Copy, Debug)]
pub enum By {
    /// With a certificate of this tolerance (m).
    Certificates(f64),
    /// At states so far apart.
    States(Length),
    /// At states between which no point travels farther than `step` (m), each with a clearance of `clearance` (m).
    Spaces {
        /// The clearance, m.
        clearance: f64,
        /// How far points travel at most, m.
        step: f64,
    },
}

/// Strides of certified checks, as a part of the extent of the robot's own space.
const STRIDE: f64 = 0.02;

/// The check of the motions of a robot while planning, in its space under any metric. Behind pointers it is compiled once for all robots:
/// a call costs nanoseconds, an interval microseconds.
///
/// # Errors
/// When tolerance or resolution are not valid.
pub fn motions<'c>(
    kind: &dyn Robot,
    space: &'c AnySpace<'c, Configuration>,
    by: By,
    counting: &Counting<'c>,
) -> Result<AnyCheck<'c, Configuration>, ParameterError> {
    motions_of(kind.any_checker(), kind, space, by, counting)
}

/// As [`motions`], of this checker of the robot.
pub(crate) fn motions_of<'c>(
    checker: AnyChecker,
    kind: &dyn Robot,
    space: &'c AnySpace<'c, Configuration>,
    by: By,
    counting: &Counting<'c>,
) -> Result<AnyCheck<'c, Configuration>, ParameterError> {
    let counted = counting.of(checker);
    Ok(match by {
        By::Certificates(tolerance) => {
            let certified = Certified::new(space, counted, tolerance)?;
            Box::new(certified.with_stride(STRIDE * kind.any_space().extent())?)
        }
        By::States(resolution) => Box::new(Discrete::new(space, counted, resolution)?),
        By::Spaces { clearance, step } => Box::new(Spaced::new(space, counted, clearance, step)?),
    })
}

/// The motions of a robot among its obstacles, behind pointers: [`TypedMotion`] gives them.
pub trait AnyMotion {
    /// The space of its configurations, behind a pointer.
    fn any_space(&self) -> AnyFactored<'_, Configuration>;
    /// A new checker of configurations and motions, behind a pointer.
    fn any_checker(&self) -> AnyChecker;
    /// A checker that keeps no clearance: what it measures is the distance to obstacles itself.
    fn any_measure(&self) -> AnyChecker;
    /// A checker that keeps another clearance from obstacles: [`TypedMotion::checker_keeping`]. By default `None`.
    fn any_checker_keeping(&self, _kept: f64) -> Option<AnyChecker> {
        None
    }
    /// The same robot, which keeps a clearance from obstacles: [`TypedMotion::keeping`].
    ///
    /// # Errors
    /// When such robots cannot keep a clearance.
    fn any_keeping(&self, kept: f64) -> Result<Arc<dyn Robot>, Error>;
    /// A verifier.
    ///
    /// # Errors
    /// When the robot cannot be verified.
    fn any_verifier(&self) -> Result<AnyVerifier<'_>, Error>;
    /// What planners may know of the obstacles.
    fn any_obstacles<'c>(&'c self, counting: &Counting<'c>) -> ObstacleKnowledge<'c, Configuration>;
    /// The same robot without some of its goals: [`TypedMotion::with_goals`].
    fn any_with_goals(&self, kept: &[bool]) -> Option<Arc<dyn Robot>>;
    /// The same robot with other ends, the start given by a row.
    ///
    /// # Errors
    /// When such robots cannot be given other ends.
    fn any_with_ends(
        &self,
        start: Configuration,
        goals: Vec<Configuration>,
        row: &[f64],
    ) -> Result<Arc<dyn Robot>, Error>;
}

impl<K: TypedMotion + Robot> AnyMotion for K {
    fn any_space(&self) -> AnyFactored<'_, Configuration> {
        AnyFactored::new(self.space())
    }
    fn any_checker(&self) -> AnyChecker {
        AnyChecker::new(self.checker().clone())
    }
    fn any_measure(&self) -> AnyChecker {
        AnyChecker::new(self.checker_keeping(0.0).unwrap_or_else(|| self.checker().clone()))
    }
    fn any_checker_keeping(&self, kept: f64) -> Option<AnyChecker> {
        self.checker_keeping(kept).map(AnyChecker::new)
    }
    fn any_keeping(&self, kept: f64) -> Result<Arc<dyn Robot>, Error> {
        Ok(Arc::new(self.keeping(kept)?))
    }
    fn any_with_goals(&self, kept: &[bool]) -> Option<Arc<dyn Robot>> {
        Some(Arc::new(self.with_goals(kept)?))
    }
    fn any_verifier(&self) -> Result<AnyVerifier<'_>, Error> {
        Ok(AnyVerifier::new(self.verifier()?))
    }
    fn any_obstacles<'c>(&'c self, counting: &Counting<'c>) -> ObstacleKnowledge<'c, Configuration> {
        self.obstacles(&|| counting.of(self.checker().clone()))
    }
    fn any_with_ends(
        &self,
        start: Configuration,
        goals: Vec<Configuration>,
        row: &[f64],
    ) -> Result<Arc<dyn Robot>, Error> {
        Ok(Arc::new(self.with_ends(start, goals)?.starting_as(row)))
    }
}

/// The methods of [`Checker`] as a trait object.
trait ErasedChecker: Validity<Configuration> + MotionClearance<Configuration> + Queries + Send + Sync {
    fn boxed(&self) -> Box<dyn ErasedChecker>;
}

impl<R: Checker<Configuration> + 'static> ErasedChecker for R {
    fn boxed(&self) -> Box<dyn ErasedChecker> {
        Box::new(self.clone())
    }
}

/// Any [`Checker`] behind a pointer.
pub struct AnyChecker(Box<dyn ErasedChecker>);

impl AnyChecker {
    /// `checker`, behind a pointer.
    pub(crate) fn new(checker: impl Checker<Configuration> + 'static) -> Self {
        Self(Box::new(checker))
    }
}

impl Clone for AnyChecker {
    fn clone(&self) -> Self {
        Self((*self.0).boxed())
    }
}

impl Debug for AnyChecker {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AnyChecker").field("queries", &self.0.queries()).finish_non_exhaustive()
    }
}

impl Queries for AnyChecker {
    fn queries(&self) -> u64 {
        self.0.queries()
    }
}

impl Validity<Configuration> for AnyChecker {
    fn is_valid(&mut self, q: &Configuration) -> bool {
        self.0.is_valid(q)
    }
    fn first_invalid(&mut self, states: &[Configuration]) -> Option<usize> {
        self.0.first_invalid(states)
    }
    fn batch_size(&self) -> usize {
        self.0.batch_size()
    }
}

impl Clearance<Configuration> for AnyChecker {
    fn clearance(&mut self, q: &Configuration, enough: f64) -> f64 {
        self.0.clearance(q, enough)
    }
    fn obstacle_clearance(&mut self, q: &Configuration, enough: f64) -> f64 {
        self.0.obstacle_clearance(q, enough)
    }
    fn in_contact(&mut self, q: &Configuration) -> bool {
        self.0.in_contact(q)
    }
}

impl MotionClearance<Configuration> for AnyChecker {
    fn motion_bound(&self, from: &Configuration, to: &Configuration) -> f64 {
        self.0.motion_bound(from, to)
    }
    fn interval_clearance(&mut self, interval: &MotionInterval<'_, Configuration>) -> IntervalClearance {
        self.0.interval_clearance(interval)
    }
    fn intervals_at_once(&self) -> usize {
        self.0.intervals_at_once()
    }
    fn look_ahead(&mut self, intervals: &[MotionInterval<'_, Configuration>]) {
        self.0.look_ahead(intervals);
    }
    fn least_along(&mut self, search: &ClearanceSearch<'_, Configuration>) -> LeastClearance {
        self.0.least_along(search)
    }
    fn contacts_at_once(&self) -> usize {
        self.0.contacts_at_once()
    }
    fn first_within(&mut self, states: &[&Configuration], clearance: f64) -> Option<usize> {
        self.0.first_within(states, clearance)
    }
    fn contact_first(&self) -> bool {
        self.0.contact_first()
    }
}

/// The methods of a verifier as a trait object.
trait ErasedVerifier: MotionValidity<Configuration> + Send + Sync {
    fn boxed<'c>(&self) -> Box<dyn ErasedVerifier + 'c>
    where
        Self: 'c;
}

impl<V: MotionValidity<Configuration> + Clone + Send + Sync> ErasedVerifier for V {
    fn boxed<'c>(&self) -> Box<dyn ErasedVerifier + 'c>
    where
        Self: 'c,
    {
        Box::new(self.clone())
    }
}

/// Any verifier behind a pointer.
pub struct AnyVerifier<'c>(Box<dyn ErasedVerifier + 'c>);

impl<'c> AnyVerifier<'c> {
    /// `verifier`, behind a pointer.
    pub(crate) fn new(verifier: impl MotionValidity<Configuration> + Clone + Send + Sync + 'c) -> Self {
        Self(Box::new(verifier))
    }
}

impl Clone for AnyVerifier<'_> {
    fn clone(&self) -> Self {
        Self((*self.0).boxed())
    }
}

impl Debug for AnyVerifier<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AnyVerifier").finish_non_exhaustive()
    }
}

impl MotionValidity<Configuration> for AnyVerifier<'_> {
    fn check_motion(&mut self, from: &Configuration, to: &Configuration) -> MotionCheck {
        self.0.check_motion(from, to)
    }
    fn check_extension(&mut self, from: &Configuration, to: &Configuration, known: KnownFree) -> MotionCheck {
        self.0.check_extension(from, to, known)
    }
    fn check_curve(&mut self, curve: &dyn Curve) -> Option<MotionCheck> {
        self.0.check_curve(curve)
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.0.interrupt_by(interrupt);
    }
    fn is_interrupted(&mut self) -> bool {
        self.0.is_interrupted()
    }
}
