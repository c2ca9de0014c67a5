//! Robots of the plane among areas that move on known trajectories.

use super::{DiscRobot, DiscVerifier, PolygonRobot, PolygonVerifier};
use crate::{CheckCounters, Trajectory};
use mp_cspace::{
    Clearance, Interrupt, MotionCheck, MotionClearance, MotionValidity, ParameterError, Se2State, Space,
    Validity, angle::angle_difference, space_time::SpaceTime,
};
use mp_geom::planar::{PlanarWorld, Polygon};
use nalgebra::{Isometry2, Isometry3, Vector2};
use std::sync::Arc;

/// Bounds are enlarged by this factor against rounding.
const ROUND_UP: f64 = 1.0 + 1e-9;
/// Parts of a motion shorter than this are not tested. What is not shown free by then is not free.
const SHORTEST: f64 = 1e-12;

/// A robot of the plane that can be among areas that move: [`DiscRobot`] or [`PolygonRobot`].
pub trait PlanarRobot: Validity<Self::Configuration> + MotionClearance<Self::Configuration> + Clone {
    /// Where the robot is: a position, with an angle if it turns.
    type Configuration: Clone;

    /// The same robot in another world.
    ///
    /// # Errors
    /// Those of making a robot.
    fn in_world(&self, world: PlanarWorld) -> Result<Self, ParameterError>;
    /// `q`, given in the world, as it is in the coordinates of `frame`.
    fn seen_from(frame: &Isometry2<f64>, q: &Self::Configuration) -> Self::Configuration;
    /// The pose of the robot's frame.
    fn place(q: &Self::Configuration) -> Isometry2<f64>;
    /// The largest distance (m) of a point of the robot from its origin.
    fn reach(&self) -> f64;
    /// The clearance (m) that motions found free keep, beyond [what it keeps](Self::clearance_kept).
    fn least_clearance(&self) -> f64;
    /// The same robot, which keeps this clearance (m) from obstacles.
    #[must_use]
    fn keeping_clearance(self, kept: f64) -> Self;
    /// The clearance (m) that it keeps.
    fn clearance_kept(&self) -> f64;
    /// The checks made by this clone so far.
    fn checks(&self) -> CheckCounters;
}

impl PlanarRobot for DiscRobot {
    type Configuration = Vector2<f64>;

    fn in_world(&self, world: PlanarWorld) -> Result<Self, ParameterError> {
        Self::new(world, self.radius())
    }
    fn seen_from(frame: &Isometry2<f64>, q: &Vector2<f64>) -> Vector2<f64> {
        frame.inverse_transform_point(&(*q).into()).coords
    }
    fn place(q: &Vector2<f64>) -> Isometry2<f64> {
        Isometry2::new(*q, 0.0)
    }
    fn reach(&self) -> f64 {
        self.radius()
    }
    fn least_clearance(&self) -> f64 {
        self.tolerance()
    }
    fn keeping_clearance(self, kept: f64) -> Self {
        self.keeping(kept)
    }
    fn clearance_kept(&self) -> f64 {
        self.kept()
    }
    fn checks(&self) -> CheckCounters {
        self.counters()
    }
}

impl PlanarRobot for PolygonRobot {
    type Configuration = Se2State;

    fn in_world(&self, world: PlanarWorld) -> Result<Self, ParameterError> {
        Ok(Self::new(world, self.body().clone()))
    }
    fn seen_from(frame: &Isometry2<f64>, q: &Se2State) -> Se2State {
        let place = frame.inverse_transform_point(&q.translation.into());
        Se2State::new(place.x, place.y, q.angle - frame.rotation.angle())
    }
    fn place(q: &Se2State) -> Isometry2<f64> {
        Isometry2::new(q.translation, q.angle)
    }
    fn reach(&self) -> f64 {
        self.radius()
    }
    fn least_clearance(&self) -> f64 {
        self.tolerance()
    }
    fn keeping_clearance(self, kept: f64) -> Self {
        self.keeping(kept)
    }
    fn clearance_kept(&self) -> f64 {
        self.kept()
    }
    fn checks(&self) -> CheckCounters {
        self.counters()
    }
}

#[derive(Clone, Debug)]
struct MovingArea {
    trajectory: Trajectory,
    /// The largest distance (m) of one of its points from the origin of its frame.
    radius: f64,
}

impl MovingArea {
    /// Its frame in the world at a time.
    fn frame(&self, time: f64) -> Isometry2<f64> {
        planar(&self.trajectory.pose(time))
    }
}

/// The pose in the plane of a pose in space.
fn planar(pose: &Isometry3<f64>) -> Isometry2<f64> {
    let turned = pose.rotation * nalgebra::Vector3::x();
    Isometry2::new(pose.translation.vector.xy(), mp_math::atan2(turned.y, turned.x))
}

/// A [`DiscRobot`] or [`PolygonRobot`], and the areas that move around it, each on its [`Trajectory`] whatever the robot does.
///
/// A state is a pair of a configuration and a time (s), as in [`SpaceTime`]. Touching is collision, and so is a robot inside of
/// a moving area or around one. Motion bounds are for the robot and the fastest area together, so
/// [`Certified`](mp_cspace::Certified) misses no obstacle, however thin.
#[derive(Clone, Debug)]
pub struct AmongMovingAreas<R> {
    body: R,
    moving: Arc<[MovingArea]>,
    /// For each area the robot in a world with that area alone, its frame at the origin.
    seen: Vec<R>,
}

impl<R: PlanarRobot> AmongMovingAreas<R> {
    /// `body` among its obstacles that stand still, and the areas `moving`: each an area in its own frame, and the trajectory of
    /// that frame in the world. Of its poses only x, y and the turn about Z count.
    ///
    /// # Errors
    /// When an area is too large to compute with.
    pub fn new(
        body: R,
        moving: impl IntoIterator<Item = (Polygon, Trajectory)>,
    ) -> Result<Self, ParameterError> {
        let (mut areas, mut seen) = (Vec::new(), Vec::new());
        for (polygon, trajectory) in moving {
            let radius = polygon.rings().iter().flatten().map(|p| p.coords.norm()).fold(0.0, f64::max);
            let world = PlanarWorld::new(vec![polygon], None);
            let expected = "such that its corners are finite and not too far away";
            let world =
                world.map_err(|_| ParameterError { name: "the moving area", expected, value: radius })?;
            seen.push(body.in_world(world)?);
            areas.push(MovingArea { trajectory, radius });
        }
        Ok(Self { body, moving: areas.into(), seen })
    }

    /// The same, which keeps the clearance `kept` (m) from all obstacles: see [`DiscRobot::keeping`].
    #[must_use]
    pub fn keeping(self, kept: f64) -> Self {
        let seen = self.seen.into_iter().map(|robot| robot.keeping_clearance(kept)).collect();
        Self { body: self.body.keeping_clearance(kept), seen, ..self }
    }

    /// The robot among the obstacles that stand still.
    #[must_use]
    pub fn body(&self) -> &R {
        &self.body
    }

    /// The checks made by this clone so far. Those against obstacles that stand still and against each that moves count
    /// separately.
    #[must_use]
    pub fn counters(&self) -> CheckCounters {
        let mut counters = self.body.checks();
        self.seen.iter().for_each(|robot| counters += robot.checks());
        counters
    }

    /// The trajectories of the moving areas, in the order in which they were given.
    pub fn trajectories(&self) -> impl Iterator<Item = &Trajectory> {
        self.moving.iter().map(|area| &area.trajectory)
    }

    /// The poses of the moving areas at a time, in the order in which they were given.
    pub fn poses(&self, time: f64) -> impl Iterator<Item = Isometry3<f64>> + '_ {
        self.moving.iter().map(move |area| area.trajectory.pose(time))
    }

    /// The speed (m/s) that no point of a moving area ever exceeds.
    #[must_use]
    pub fn greatest_speed(&self) -> f64 {
        let speed = |area: &MovingArea| area.trajectory.speed(area.radius, f64::NEG_INFINITY, f64::INFINITY);
        self.moving.iter().map(speed).fold(0.0, f64::max)
    }

    /// The indices of the moving areas that the robot touches.
    pub fn touching(&mut self, (q, time): &(R::Configuration, f64)) -> Vec<usize> {
        let touches = |(area, robot): (&MovingArea, &R)| {
            !robot.clone().keeping_clearance(0.0).is_valid(&R::seen_from(&area.frame(*time), q))
        };
        let each = self.moving.iter().zip(&self.seen).map(touches).enumerate();
        each.filter_map(|(i, touched)| touched.then_some(i)).collect()
    }
}

impl<R: PlanarRobot> Validity<(R::Configuration, f64)> for AmongMovingAreas<R> {
    fn is_valid(&mut self, q: &(R::Configuration, f64)) -> bool {
        !self.in_contact(q)
    }
}

impl<R: PlanarRobot> Clearance<(R::Configuration, f64)> for AmongMovingAreas<R> {
    fn clearance(&mut self, (q, time): &(R::Configuration, f64), enough: f64) -> f64 {
        let mut least = self.body.clearance(q, enough);
        for (area, robot) in self.moving.iter().zip(&mut self.seen) {
            let enough = enough.min(least);
            least = least.min(robot.clearance(&R::seen_from(&area.frame(*time), q), enough));
        }
        least
    }

    fn in_contact(&mut self, (q, time): &(R::Configuration, f64)) -> bool {
        let mut each = self.moving.iter().zip(&mut self.seen);
        !self.body.is_valid(q)
            || each.any(|(area, robot)| !robot.is_valid(&R::seen_from(&area.frame(*time), q)))
    }
}

impl<R: PlanarRobot> MotionClearance<(R::Configuration, f64)> for AmongMovingAreas<R> {
    /// How far the robot and the fastest moving area travel, added.
    fn motion_bound(&self, from: &(R::Configuration, f64), to: &(R::Configuration, f64)) -> f64 {
        let speed = |area: &MovingArea| area.trajectory.speed(area.radius, from.1, to.1);
        let fastest = self.moving.iter().map(speed).fold(0.0, f64::max);
        (self.body.motion_bound(&from.0, &to.0) + fastest * (to.1 - from.1).abs()) * ROUND_UP
    }
}

/// Proves motions of a robot of the plane in space and time free of collision, with other code than planners use.
///
/// A verifier of the plane checks against the obstacles that stand still. For each moving area its answers for single moments,
/// seen from the area, are compared with how much nearer robot and area can come, and the motion is halved until all of it is
/// shown free. Only the space and the trajectories are shared with the checker: they define what the motions are.
///
/// The answer is [`Unproven`](MotionCheck::Unproven) for motions back in time or beyond the speed limit, and for motions with
/// a tested moment of less clearance than the tolerance, a tenth of the robot's.
#[derive(Clone, Debug)]
pub struct MovingAreasVerifier<'c, C, V> {
    space: &'c SpaceTime<C>,
    standing: V,
    moving: Arc<[MovingArea]>,
    seen: Vec<V>,
    radius: f64,
    /// The clearance (m) of motions found free.
    margin: f64,
}

impl<'c, C> MovingAreasVerifier<'c, C, DiscVerifier> {
    /// The verifier of a disc that moves in `space`.
    #[must_use]
    pub fn of_disc(space: &'c SpaceTime<C>, robot: &AmongMovingAreas<DiscRobot>) -> Self {
        Self::new(space, robot, DiscVerifier::new)
    }
}

impl<'c, C: Space<State = Se2State>> MovingAreasVerifier<'c, C, PolygonVerifier<'c, C>> {
    /// The verifier of a polygon that moves in `space`.
    #[must_use]
    pub fn of_polygon(space: &'c SpaceTime<C>, robot: &AmongMovingAreas<PolygonRobot>) -> Self {
        Self::new(space, robot, |robot| PolygonVerifier::new(space.positions(), robot))
    }
}

impl<'c, C, V> MovingAreasVerifier<'c, C, V> {
    fn new<R: PlanarRobot>(
        space: &'c SpaceTime<C>,
        robot: &AmongMovingAreas<R>,
        verifier: impl Fn(&R) -> V,
    ) -> Self {
        Self {
            space,
            standing: verifier(&robot.body),
            moving: Arc::clone(&robot.moving),
            seen: robot.seen.iter().map(&verifier).collect(),
            radius: robot.body.reach(),
            margin: robot.body.clearance_kept() + 0.1 * robot.body.least_clearance(),
        }
    }
}

/// A configuration of the plane, as verifiers see it.
pub trait PlanarConfiguration: Clone {
    /// The configuration as it is seen from a frame with this origin and angle.
    fn seen_in(&self, origin: Vector2<f64>, angle: f64) -> Self;
    /// The position (m) of its origin and its angle (rad); zero for a robot that does not turn.
    fn position_and_angle(&self) -> (Vector2<f64>, f64);
}

impl PlanarConfiguration for Vector2<f64> {
    fn seen_in(&self, origin: Vector2<f64>, angle: f64) -> Self {
        let (s, c) = mp_math::sin_cos(angle);
        let d = self - origin;
        Vector2::new(c * d.x + s * d.y, c * d.y - s * d.x)
    }
    fn position_and_angle(&self) -> (Vector2<f64>, f64) {
        (*self, 0.0)
    }
}

impl PlanarConfiguration for Se2State {
    fn seen_in(&self, origin: Vector2<f64>, angle: f64) -> Self {
        Self { translation: self.translation.seen_in(origin, angle), angle: self.angle - angle }
    }
    fn position_and_angle(&self) -> (Vector2<f64>, f64) {
        (self.translation, self.angle)
    }
}

impl<C, V, Q> MovingAreasVerifier<'_, C, V>
where
    C: Space<State = Q>,
    Q: PlanarConfiguration,
    V: MotionValidity<Q>,
{
    /// The clearance kept from the moving area `i` over the motion, or the check that failed. `travel` is how far a point of
    /// the robot moves over the motion.
    fn against(&mut self, i: usize, from: &(Q, f64), to: &(Q, f64), travel: f64) -> Result<f64, MotionCheck> {
        let (area, verifier) = (&self.moving[i], &mut self.seen[i]);
        let mut least = f64::INFINITY;
        let mut open = vec![(0.0_f64, 1.0_f64)];
        while let Some((a, b)) = open.pop() {
            let (at, half) = (0.5 * (a + b), 0.5 * (b - a));
            let (q, time) = self.space.interpolate(from, to, at);
            let when = |t: f64| from.1 + (to.1 - from.1) * t;
            let speed = area.trajectory.speed(area.radius, when(a), when(b));
            let approach = half * (travel + speed * (to.1 - from.1));
            let pose = area.trajectory.pose(time);
            let (_, _, angle) = pose.rotation.euler_angles();
            let seen = q.seen_in(pose.translation.vector.xy(), angle);
            match verifier.check_motion(&seen, &seen) {
                MotionCheck::Free { clearance } if clearance >= (approach + self.margin) * ROUND_UP => {
                    least = least.min(clearance - approach);
                }
                MotionCheck::Collision { .. } => return Err(MotionCheck::Collision { at }),
                MotionCheck::Free { clearance } if clearance >= self.margin && half >= SHORTEST => {
                    open.extend([(at, b), (a, at)]);
                }
                _ => return Err(MotionCheck::Unproven { at }),
            }
        }
        Ok(least)
    }
}

impl<C, V, Q> MotionValidity<(Q, f64)> for MovingAreasVerifier<'_, C, V>
where
    C: Space<State = Q>,
    Q: PlanarConfiguration + PartialEq,
    V: MotionValidity<Q>,
{
    fn check_motion(&mut self, from: &(Q, f64), to: &(Q, f64)) -> MotionCheck {
        if !(self.space.contains(from) && self.space.contains(to) && self.space.can_move(from, to)) {
            return MotionCheck::Unproven { at: 0.0 };
        }
        let standing = self.standing.check_motion(&from.0, &to.0);
        let MotionCheck::Free { clearance: mut least } = standing else { return standing };
        let [(a, begin), (b, end)] = [&from.0, &to.0].map(PlanarConfiguration::position_and_angle);
        let travel = (b - a).norm() + self.radius * angle_difference(begin, end).abs();
        for i in 0..self.seen.len() {
            match self.against(i, from, to, travel) {
                Ok(clearance) => least = least.min(clearance),
                Err(check) => return check,
            }
        }
        MotionCheck::Free { clearance: least }
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.standing.interrupt_by(interrupt);
        self.seen.iter_mut().for_each(|verifier| verifier.interrupt_by(interrupt));
    }
    fn is_interrupted(&mut self) -> bool {
        self.standing.is_interrupted()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_cspace::{Certified, Rn, Rng, Se2};
    use rand::RngExt;

    fn through(y: f64, speed: f64) -> Trajectory {
        let at = |x: f64, angle: f64| {
            Isometry3::new(nalgebra::Vector3::new(x, y, 0.0), nalgebra::Vector3::new(0.0, 0.0, angle))
        };
        Trajectory::new([(0.0, at(-2.0, 0.0)), (4.0 / speed, at(2.0, 2.5))]).unwrap()
    }

    fn world() -> PlanarWorld {
        let still = Polygon::rectangle([-0.2, 1.2], [0.2, 1.5]).unwrap();
        PlanarWorld::new(vec![still], Some([[-3.0, -3.0], [3.0, 3.0]])).unwrap()
    }

    fn areas() -> [(Polygon, Trajectory); 2] {
        let bar = Polygon::rectangle([-0.8, -0.002], [0.8, 0.002]).unwrap();
        let box_ = Polygon::rectangle([-0.3, -0.2], [0.3, 0.2]).unwrap();
        [(bar, through(-0.5, 1.0)), (box_, through(0.7, 2.0))]
    }

    /// Random motions: what is certified is verified, and what a fine scan finds in contact is neither.
    fn agree<R, C, V>(
        space: &SpaceTime<C>,
        robot: AmongMovingAreas<R>,
        mut verifier: V,
        scan: impl Fn(&(R::Configuration, f64)) -> bool,
    ) where
        R: PlanarRobot<Configuration = C::State>,
        C: Space,
        V: MotionValidity<(C::State, f64)>,
    {
        let mut rng = Rng::seed(4);
        let tolerance = robot.body().least_clearance();
        let mut certified = Certified::new(space, robot, tolerance).unwrap();
        let (mut free, mut hit) = (0, 0);
        while free < 12 || hit < 12 {
            let from = space.sample_uniform(&mut rng);
            let far = space.sample_uniform(&mut rng);
            let to = space.interpolate(&from, &far, rng.random_range(0.05..0.4));
            if !space.can_move(&from, &to) {
                continue;
            }
            let found = certified.check_motion(&from, &to);
            let verified = verifier.check_motion(&from, &to);
            let touches = (0..=60).any(|i| scan(&space.interpolate(&from, &to, f64::from(i) / 60.0)));
            if found.is_free() {
                assert!(verified.is_free() && !touches, "{from:?} {to:?} {verified:?}");
                free += 1;
            }
            if touches {
                assert!(!verified.is_free());
                hit += 1;
            }
        }
    }

    #[test]
    fn a_disc_among_moving_areas() {
        let robot = AmongMovingAreas::new(DiscRobot::new(world(), 0.1).unwrap(), areas()).unwrap();
        let space = SpaceTime::new(Rn::<2>::new([-3.0; 2], [3.0; 2]).unwrap(), 4.0, 2.0).unwrap();
        let verifier = MovingAreasVerifier::of_disc(&space, &robot);
        // Another way to the same answer: the areas moved to where they are, in one world.
        let scan = |(q, time): &(Vector2<f64>, f64)| {
            let at = |(polygon, way): &(Polygon, Trajectory)| polygon.transformed(&planar(&way.pose(*time)));
            let mut all: Vec<Polygon> = areas().iter().map(at).collect();
            all.push(Polygon::rectangle([-0.2, 1.2], [0.2, 1.5]).unwrap());
            let world = PlanarWorld::new(all, Some([[-3.0, -3.0], [3.0, 3.0]])).unwrap();
            !DiscRobot::new(world, 0.1).unwrap().is_valid(q)
        };
        agree(&space, robot, verifier, scan);
    }

    #[test]
    fn a_polygon_among_moving_areas() {
        let body = Polygon::rectangle([-0.25, -0.05], [0.1, 0.05]).unwrap();
        let robot = AmongMovingAreas::new(PolygonRobot::new(world(), body.clone()), areas()).unwrap();
        let space = SpaceTime::new(Se2::new([-3.0; 2], [3.0; 2]).unwrap(), 4.0, 3.0).unwrap();
        let verifier = MovingAreasVerifier::of_polygon(&space, &robot);
        let scan = |(q, time): &(Se2State, f64)| {
            let at = |(polygon, way): &(Polygon, Trajectory)| polygon.transformed(&planar(&way.pose(*time)));
            let mut all: Vec<Polygon> = areas().iter().map(at).collect();
            all.push(Polygon::rectangle([-0.2, 1.2], [0.2, 1.5]).unwrap());
            let world = PlanarWorld::new(all, Some([[-3.0, -3.0], [3.0, 3.0]])).unwrap();
            !PolygonRobot::new(world, body.clone()).is_valid(q)
        };
        agree(&space, robot, verifier, scan);
    }

    #[test]
    fn what_touches_is_named() {
        let mut robot = AmongMovingAreas::new(DiscRobot::new(world(), 0.1).unwrap(), areas()).unwrap();
        assert_eq!(robot.touching(&(Vector2::new(-2.0, -0.5), 0.0)), [0]);
        assert_eq!(robot.touching(&(Vector2::new(-2.0, 0.7), 0.0)), [1]);
        assert!(robot.touching(&(Vector2::new(0.0, 0.0), 0.0)).is_empty());
        assert!(robot.in_contact(&(Vector2::new(0.0, 1.3), 0.0)), "the obstacle that stands still");
        assert!(robot.counters().queries() > 0);
    }
}
