//! Checkers whose queries are added to a common count, for reports and budgets.

use crate::Queries;
use mp_cspace::{
    Clearance, ClearanceSearch, Interrupt, IntervalClearance, LeastClearance, MotionClearance,
    MotionInterval, Progress, Rng, Stop, StopReason, Validity,
    obstacles::{BodyFeatures, BodySphere, ClearanceGradient, ObstacleGeometry, ObstacleHints, PointOf},
};
use nalgebra::Vector3;
use std::cell::Cell;
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};

/// A checker adds its queries to the common count once there are this many, because each addition takes time.
const MAX_UNREPORTED: u64 = 64;

thread_local! {
    /// How many queries this thread has reported. Only differences are used.
    static OF_THREAD: Cell<u64> = const { Cell::new(0) };
}

/// How many queries this thread has reported so far.
pub fn queries_of_thread() -> u64 {
    OF_THREAD.get()
}

/// A checker whose queries are added to a common count: now and then, and when it is dropped. Once it is interrupted, it queries
/// nothing any more: everything is in contact.
pub struct Counted<'a, R: Queries> {
    checker: R,
    /// How many of the checker's queries are in the common count.
    reported: u64,
    most_unreported: u64,
    queries: &'a AtomicU64,
    interrupt: Interrupt,
}

impl<'a, R: Queries> Counted<'a, R> {
    /// Adds the queries that `checker` answers from now on to `queries`.
    pub fn new(checker: R, queries: &'a AtomicU64) -> Self {
        let (reported, interrupt) = (checker.queries(), Interrupt::never());
        Self { reported, most_unreported: MAX_UNREPORTED, checker, queries, interrupt }
    }

    /// The same, which ends when `interrupt` says so.
    #[must_use]
    pub fn with_interrupt(mut self, interrupt: Interrupt) -> Self {
        self.interrupt = interrupt;
        self
    }

    /// Adds each query at once, so that the common count is always exact.
    pub fn exactly(mut self) -> Self {
        self.most_unreported = 1;
        self
    }

    fn report(&mut self) {
        let now = self.checker.queries();
        let new = now - self.reported;
        self.queries.fetch_add(new, Ordering::Relaxed);
        OF_THREAD.set(OF_THREAD.get() + new);
        self.reported = now;
    }

    /// The answer of the checker to a query; `ended` once it is interrupted.
    #[inline]
    fn query<T>(&mut self, ended: T, query: impl FnOnce(&mut R) -> T) -> T {
        if self.interrupt.ask() {
            return ended;
        }
        let answer = query(&mut self.checker);
        if self.checker.queries() - self.reported >= self.most_unreported {
            self.report();
        }
        answer
    }
}

/// Stops when the common count reaches a number of queries. Does not depend on a clock.
#[derive(Clone, Copy, Debug)]
pub struct QueryBudget<'a> {
    /// The common count.
    pub queries: &'a AtomicU64,
    /// The number at which it stops.
    pub most: u64,
}

impl Stop for QueryBudget<'_> {
    fn check(&mut self, _: &Progress) -> Option<StopReason> {
        (self.queries.load(Ordering::Relaxed) >= self.most).then_some(StopReason::Motions)
    }
}

impl<R: Queries + Clone> Clone for Counted<'_, R> {
    fn clone(&self) -> Self {
        let mut clone = Self::new(self.checker.clone(), self.queries);
        clone.most_unreported = self.most_unreported;
        clone.interrupt = self.interrupt.clone();
        clone
    }
}

impl<R: Queries> Drop for Counted<'_, R> {
    fn drop(&mut self) {
        self.report();
    }
}

impl<R: Queries + fmt::Debug> fmt::Debug for Counted<'_, R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Counted").field("checker", &self.checker).finish_non_exhaustive()
    }
}

impl<S, R: Validity<S> + Queries> Validity<S> for Counted<'_, R> {
    fn is_valid(&mut self, q: &S) -> bool {
        self.query(false, |checker| checker.is_valid(q))
    }
    fn first_invalid(&mut self, states: &[S]) -> Option<usize> {
        self.query(Some(0), |checker| checker.first_invalid(states))
    }
    fn batch_size(&self) -> usize {
        self.checker.batch_size()
    }
}

impl<S, R: Clearance<S> + Queries> Clearance<S> for Counted<'_, R> {
    fn clearance(&mut self, q: &S, enough: f64) -> f64 {
        self.query(0.0, |checker| checker.clearance(q, enough))
    }
    fn obstacle_clearance(&mut self, q: &S, enough: f64) -> f64 {
        self.query(0.0, |checker| checker.obstacle_clearance(q, enough))
    }
    fn in_contact(&mut self, q: &S) -> bool {
        self.query(true, |checker| checker.in_contact(q))
    }
}

impl<S, R: MotionClearance<S> + Queries> MotionClearance<S> for Counted<'_, R> {
    fn motion_bound(&self, from: &S, to: &S) -> f64 {
        self.checker.motion_bound(from, to)
    }
    fn interval_clearance(&mut self, interval: &MotionInterval<'_, S>) -> IntervalClearance {
        let ended = IntervalClearance::Collision { at: 0.0 };
        self.query(ended, |checker| checker.interval_clearance(interval))
    }
    fn intervals_at_once(&self) -> usize {
        self.checker.intervals_at_once()
    }
    fn look_ahead(&mut self, intervals: &[MotionInterval<'_, S>]) {
        self.checker.look_ahead(intervals);
    }
    fn least_along(&mut self, search: &ClearanceSearch<'_, S>) -> LeastClearance {
        let ended = LeastClearance { bound: 0.0, found: search.known, at: None };
        self.query(ended, |checker| checker.least_along(search))
    }
    fn contacts_at_once(&self) -> usize {
        self.checker.contacts_at_once()
    }
    fn first_within(&mut self, states: &[&S], clearance: f64) -> Option<usize> {
        self.query(Some(0), |checker| checker.first_within(states, clearance))
    }
    fn contact_first(&self) -> bool {
        self.checker.contact_first()
    }
}

impl<S, R: ObstacleHints<S> + Queries> ObstacleHints<S> for Counted<'_, R> {
    fn touches(&mut self, q: &S) -> bool {
        self.query(true, |checker| checker.touches(q))
    }
    fn slide_along(&mut self, from: &S, toward: &S, hit: Option<&S>, rng: &mut Rng) -> Option<S> {
        self.query(None, |checker| checker.slide_along(from, toward, hit, rng))
    }
    fn moved_by(&self, q: &S, from: &S, to: &S) -> S {
        self.checker.moved_by(q, from, to)
    }
}

impl<S, R: ClearanceGradient<S> + Queries> ClearanceGradient<S> for Counted<'_, R> {
    fn clearance_gradient(&mut self, q: &S, reach: f64, gradient: &mut [f64]) -> f64 {
        gradient.fill(0.0);
        self.query(0.0, |checker| checker.clearance_gradient(q, reach, gradient))
    }
}

impl<S, R: ObstacleGeometry<S> + Queries> ObstacleGeometry<S> for Counted<'_, R> {
    fn prepare(&self, interrupt: &Interrupt) -> bool {
        self.checker.prepare(interrupt)
    }
    fn obstacles(&self) -> &[BodySphere] {
        self.checker.obstacles()
    }
    fn robot(&self) -> BodySphere {
        self.checker.robot()
    }
    fn obstacle_features(&self, obstacle: usize) -> Option<BodyFeatures> {
        self.checker.obstacle_features(obstacle)
    }
    fn robot_features(&self) -> BodyFeatures {
        self.checker.robot_features()
    }
    fn touched_obstacle(&mut self, q: &S) -> Option<usize> {
        self.query(None, |checker| checker.touched_obstacle(q))
    }
    fn obstacle_point(&self, obstacle: usize, of: PointOf, rng: &mut Rng) -> Option<Vector3<f64>> {
        self.checker.obstacle_point(obstacle, of, rng)
    }
    fn robot_point(&self, of: PointOf, rng: &mut Rng) -> Vector3<f64> {
        self.checker.robot_point(of, rng)
    }
    fn world_point(&self, q: &S, point: &Vector3<f64>) -> Vector3<f64> {
        self.checker.world_point(q, point)
    }
    fn moved_to(&self, q: &S, point: &Vector3<f64>, place: &Vector3<f64>) -> S {
        self.checker.moved_to(q, point, place)
    }
    fn aligned(&self, place: &Vector3<f64>, direction: &Vector3<f64>, angle: f64) -> S {
        self.checker.aligned(place, direction, angle)
    }
    fn is_far(&self, q: &S) -> bool {
        self.checker.is_far(q)
    }
}
