//! Robots whose collision queries are counted, and the roadmaps made for them.

use super::mover::Mover;
use crate::arm::State;
use mp::cspace::erased::AnyGeometry;
use mp::cspace::{
    Clearance, ClearanceGradient, MotionBound, ObstacleGeometry, ObstacleHints, ObstacleKnowledge, Outline,
    PointOf, Progress, Rng, Room, Stop, StopReason, Stretch, Validity,
};
use mp::robot::{Arm, RigidBody};
use nalgebra::Vector3;
use std::sync::atomic::{AtomicU64, Ordering};

/// A roadmap with straight edges.
pub(crate) type AnyRoadmap<'p, S> = mp::roadmap::AnyPlanner<'p, S, ()>;

/// What counts collision queries.
pub(crate) trait Queries {
    /// How many were asked so far.
    fn queries(&self) -> u64;
}

impl<M: Mover> Queries for RigidBody<M> {
    fn queries(&self) -> u64 {
        let counters = self.counters();
        counters.collision_checks + counters.clearance_checks
    }
}

impl Queries for Arm {
    fn queries(&self) -> u64 {
        let counters = self.counters();
        counters.collision_checks + counters.clearance_checks
    }
}

/// Queries that a robot may have asked and not told yet: the sum is for budgets, and telling it takes time too.
const UNTOLD: u64 = 64;

/// A robot whose counters go into a common sum: once in a while, and when it is dropped.
pub(super) struct Counted<'a, R: Queries> {
    robot: R,
    /// What the robot had counted when it last told.
    before: u64,
    queries: &'a AtomicU64,
}

impl<'a, R: Queries> Counted<'a, R> {
    pub(super) fn new(robot: R, queries: &'a AtomicU64) -> Self {
        Self { before: robot.queries(), robot, queries }
    }

    fn tell(&mut self) {
        let now = self.robot.queries();
        self.queries.fetch_add(now - self.before, Ordering::Relaxed);
        self.before = now;
    }

    /// What the robot answers.
    fn asked<T>(&mut self, ask: impl FnOnce(&mut R) -> T) -> T {
        let answer = ask(&mut self.robot);
        if self.robot.queries() - self.before >= UNTOLD {
            self.tell();
        }
        answer
    }
}

/// Stops when so many queries were asked. What is done until then depends on no clock.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked<'a> {
    pub(super) queries: &'a AtomicU64,
    pub(super) most: u64,
}

impl Stop for Asked<'_> {
    fn check(&mut self, _: &Progress) -> Option<StopReason> {
        (self.queries.load(Ordering::Relaxed) >= self.most).then_some(StopReason::Motions)
    }
}

impl<R: Queries + Clone> Clone for Counted<'_, R> {
    fn clone(&self) -> Self {
        Self::new(self.robot.clone(), self.queries)
    }
}

impl<R: Queries> Drop for Counted<'_, R> {
    fn drop(&mut self) {
        self.tell();
    }
}

impl<S, R: Validity<S> + Queries> Validity<S> for Counted<'_, R> {
    fn is_valid(&mut self, q: &S) -> bool {
        self.asked(|robot| robot.is_valid(q))
    }
    fn first_invalid(&mut self, states: &[S]) -> Option<usize> {
        self.asked(|robot| robot.first_invalid(states))
    }
    fn batch_size(&self) -> usize {
        self.robot.batch_size()
    }
}
impl<S, R: Clearance<S> + Queries> Clearance<S> for Counted<'_, R> {
    fn clearance(&mut self, q: &S, enough: f64) -> f64 {
        self.asked(|robot| robot.clearance(q, enough))
    }
    fn in_contact(&mut self, q: &S) -> bool {
        self.asked(|robot| robot.in_contact(q))
    }
    fn room(&mut self, stretch: &Stretch<'_, S>) -> Room {
        self.asked(|robot| robot.room(stretch))
    }
    fn contact_first(&self) -> bool {
        self.robot.contact_first()
    }
}
impl<S, R: MotionBound<S> + Queries> MotionBound<S> for Counted<'_, R> {
    fn motion_bound(&self, from: &S, to: &S) -> f64 {
        self.robot.motion_bound(from, to)
    }
}

impl<S, R: ObstacleHints<S> + Queries> ObstacleHints<S> for Counted<'_, R> {
    fn touches(&mut self, q: &S) -> bool {
        self.asked(|robot| robot.touches(q))
    }
    fn along(&mut self, from: &S, toward: &S, hit: Option<&S>, rng: &mut Rng) -> Option<S> {
        self.asked(|robot| robot.along(from, toward, hit, rng))
    }
    fn turned(&self, position: &S, rotation: &S) -> S {
        self.robot.turned(position, rotation)
    }
    fn carried(&self, q: &S, from: &S, to: &S) -> S {
        self.robot.carried(q, from, to)
    }
}

impl<S, R: ClearanceGradient<S> + Queries> ClearanceGradient<S> for Counted<'_, R> {
    fn clearance_gradient(&mut self, q: &S, reach: f64, gradient: &mut [f64]) -> f64 {
        self.asked(|robot| robot.clearance_gradient(q, reach, gradient))
    }
}

impl<S, R: ObstacleGeometry<S> + Queries> ObstacleGeometry<S> for Counted<'_, R> {
    fn obstacles(&self) -> &[Outline] {
        self.robot.obstacles()
    }
    fn robot(&self) -> Outline {
        self.robot.robot()
    }
    fn touched(&mut self, q: &S) -> Option<usize> {
        self.asked(|robot| robot.touched(q))
    }
    fn obstacle_point(&self, obstacle: usize, of: PointOf, rng: &mut Rng) -> Option<Vector3<f64>> {
        self.robot.obstacle_point(obstacle, of, rng)
    }
    fn robot_point(&self, of: PointOf, rng: &mut Rng) -> Vector3<f64> {
        self.robot.robot_point(of, rng)
    }
    fn place_of(&self, q: &S, point: &Vector3<f64>) -> Vector3<f64> {
        self.robot.place_of(q, point)
    }
    fn brought(&self, q: &S, point: &Vector3<f64>, place: &Vector3<f64>) -> S {
        self.robot.brought(q, point, place)
    }
    fn aligned(&self, place: &Vector3<f64>, direction: &Vector3<f64>, angle: f64) -> S {
        self.robot.aligned(place, direction, angle)
    }
    fn is_far(&self, q: &S) -> bool {
        self.robot.is_far(q)
    }
}

/// A robot that planners are made for by name, with what is known of its obstacles.
pub(crate) trait Knows<S>:
    Queries + ObstacleHints<S> + ClearanceGradient<S> + Clone + Send + Sync
{
    /// What planners may ask; the robot's queries go into `queries`.
    fn knowledge<'c>(&self, queries: &'c AtomicU64) -> ObstacleKnowledge<'c, S>
    where
        Self: 'c,
    {
        let counted = Counted::new(self.clone(), queries);
        let mut field = counted.clone();
        ObstacleKnowledge {
            hints: Some(Box::new(counted)),
            gradient: Some(Box::new(move |q, reach, gradient| field.clearance_gradient(q, reach, gradient))),
            geometry: None,
        }
    }
}

impl Knows<State> for Arm {}

impl<M: Mover> Knows<M::State> for RigidBody<M> {
    fn knowledge<'c>(&self, queries: &'c AtomicU64) -> ObstacleKnowledge<'c, M::State>
    where
        Self: 'c,
    {
        let counted = Counted::new(self.clone(), queries);
        let mut field = counted.clone();
        ObstacleKnowledge {
            hints: Some(Box::new(counted.clone())),
            gradient: Some(Box::new(move |q, reach, gradient| field.clearance_gradient(q, reach, gradient))),
            geometry: Some(AnyGeometry::new(counted)),
        }
    }
}
