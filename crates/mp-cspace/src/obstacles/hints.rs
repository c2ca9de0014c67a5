//! Hints by obstacles: states along them, and robot states placed at them.

use crate::{Interrupt, Rng};
use nalgebra::Vector3;

/// Suggests states along obstacles, for planners that grow along them.
///
/// A suggested state need be neither free nor within the space: planners check it. States have a position,
/// and may have a rotation; a point robot has a position only.
pub trait ObstacleHints<S> {
    /// Whether the robot at `q` touches an obstacle.
    fn touches(&mut self, q: &S) -> bool;

    /// `from` moved along an obstacle, without turning, by the distance in position between `from` and
    /// `toward`: along the obstacle touched at `hit`, or along any when `hit` is `None`. `None` where no
    /// obstacle is touched, or there is none to move along.
    fn slide_along(&mut self, from: &S, toward: &S, hit: Option<&S>, rng: &mut Rng) -> Option<S>;

    /// `q` moved and turned by the motion that leads from `from` to `to`.
    fn moved_by(&self, q: &S, from: &S, to: &S) -> S;
}

macro_rules! behind {
    ($($pointer:ty),*) => {$(
    impl<S, H: ObstacleHints<S> + ?Sized> ObstacleHints<S> for $pointer {
        fn touches(&mut self, q: &S) -> bool {
            (**self).touches(q)
        }
        fn slide_along(&mut self, from: &S, toward: &S, hit: Option<&S>, rng: &mut Rng) -> Option<S> {
            (**self).slide_along(from, toward, hit, rng)
        }
        fn moved_by(&self, q: &S, from: &S, to: &S) -> S {
            (**self).moved_by(q, from, to)
        }
    }
    )*};
}
behind!(&mut H, Box<H>);

/// The sphere around a body. Metres; in the plane z is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodySphere {
    /// Its centre.
    pub center: Vector3<f64>,
    /// Its radius: no point of the body is farther from the centre.
    pub radius: f64,
}

/// A coarse description of a body: its longest axis and its fullness, *straightness* and *volume* of Benitez and Vallejo 2004.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyFeatures {
    /// Unit vector along the longest side.
    pub axis: Vector3<f64>,
    /// Volume of the body over that of its surrounding sphere, in \[0, 1\].
    pub volume_ratio: f64,
}

/// Which points of a body to take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PointOf {
    /// Its centre: always the same point.
    Center,
    /// A vertex: a corner of one of its triangles, each as likely.
    Vertex,
    /// A point of its surface, uniformly.
    Surface,
}

/// The geometry of obstacles, for planners that place the robot at them.
///
/// Here an obstacle is a connected *part*, however many bodies the scene is made of. As with hints, the
/// states returned need be neither free nor within the space.
pub trait ObstacleGeometry<S>: ObstacleHints<S> {
    /// Computes what the other methods need, where that takes long. Returns `false` when `interrupt` said to
    /// end before that was done.
    fn prepare(&self, _interrupt: &Interrupt) -> bool {
        true
    }

    /// The spheres around the obstacles, in the world.
    fn obstacles(&self) -> &[BodySphere];

    /// The sphere around the robot, in its own frame.
    fn robot(&self) -> BodySphere;

    /// The features of an obstacle, in the world: they may be found when they are first asked for. `None` when there is no such
    /// obstacle.
    fn obstacle_features(&self, obstacle: usize) -> Option<BodyFeatures>;

    /// The features of the robot, in its own frame.
    fn robot_features(&self) -> BodyFeatures;

    /// The index of an obstacle that the robot at `q` touches.
    fn touched_obstacle(&mut self, q: &S) -> Option<usize>;

    /// A point (m) of an obstacle, in the world. `None` when there is no such obstacle.
    fn obstacle_point(&self, obstacle: usize, of: PointOf, rng: &mut Rng) -> Option<Vector3<f64>>;

    /// A point (m) of the robot, in its own frame.
    fn robot_point(&self, of: PointOf, rng: &mut Rng) -> Vector3<f64>;

    /// The place in the world (m) of a `point` of the robot's own frame, the robot at `q`.
    fn world_point(&self, q: &S, point: &Vector3<f64>) -> Vector3<f64>;

    /// `q` moved, without turning, so that a `point` of the robot's frame comes to `place` in the world, as
    /// near as the robot's degrees of freedom allow.
    fn moved_to(&self, q: &S, point: &Vector3<f64>, place: &Vector3<f64>) -> S;

    /// The state with the robot's centre at `place` and its [axis](BodyFeatures::axis) along `direction`,
    /// turned about that by `angle` (rad). In the plane it is turned about Z, the only axis there. A robot
    /// that cannot turn is only moved.
    fn aligned(&self, place: &Vector3<f64>, direction: &Vector3<f64>, angle: f64) -> S;

    /// Whether the sphere around the robot at `q` is apart from those around all obstacles. The robot is then
    /// free in any rotation about its centre. O(obstacles), without a collision test.
    fn is_far(&self, q: &S) -> bool {
        let robot = self.robot();
        let place = self.world_point(q, &robot.center);
        self.obstacles().iter().all(|o| (o.center - place).norm() > o.radius + robot.radius)
    }
}
