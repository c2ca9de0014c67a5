//! What obstacles suggest: where to go along them, and around them.

use crate::Rng;
use nalgebra::Vector3;

/// Suggests states along obstacles, for planners that grow by them, such as obstacle-based RRT.
///
/// What is suggested need be neither free nor within the space: planners check. States have a position, and
/// may have a rotation besides; for a point, position is all there is.
pub trait ObstacleHints<S> {
    /// Whether the robot at `q` touches an obstacle.
    fn touches(&mut self, q: &S) -> bool;

    /// `from` moved along an obstacle, with the same rotation, by as far as `toward` is from it in position:
    /// along the obstacle touched at `hit`, or when that is `None` along any. `None` where nothing is touched,
    /// or there is nothing along which to move.
    fn along(&mut self, from: &S, toward: &S, hit: Option<&S>, rng: &mut Rng) -> Option<S>;

    /// `q` moved and turned by what leads from `from` to `to`.
    fn carried(&self, q: &S, from: &S, to: &S) -> S;
}

impl<S, H: ObstacleHints<S> + ?Sized> ObstacleHints<S> for &mut H {
    fn touches(&mut self, q: &S) -> bool {
        (**self).touches(q)
    }
    fn along(&mut self, from: &S, toward: &S, hit: Option<&S>, rng: &mut Rng) -> Option<S> {
        (**self).along(from, toward, hit, rng)
    }
    fn carried(&self, q: &S, from: &S, to: &S) -> S {
        (**self).carried(q, from, to)
    }
}

/// A body from afar: where it is, how large, how full, and which way it runs. Metres; in the plane z is 0.
///
/// The last two are *straightness* and *volume* of Benitez and Vallejo 2004.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyFeatures {
    /// Centre of the surrounding sphere.
    pub center: Vector3<f64>,
    /// Radius of the surrounding sphere: no point of the body is farther from the centre.
    pub radius: f64,
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

/// What obstacles look like, for planners that place the robot about them: OBPRM, and PRM by obstacle geometry.
///
/// Here obstacles are *parts*: what hangs together is one, however many bodies a scene is made of. As with
/// hints, states that are made need be neither free nor within the space.
pub trait ObstacleGeometry<S>: ObstacleHints<S> {
    /// The obstacles, in the world.
    fn obstacles(&self) -> &[BodyFeatures];

    /// The robot, in its own frame.
    fn robot(&self) -> BodyFeatures;

    /// The index of an obstacle that the robot at `q` touches.
    fn touched(&mut self, q: &S) -> Option<usize>;

    /// A point (m) of an obstacle, in the world. `None` when there is no such obstacle.
    fn obstacle_point(&self, obstacle: usize, of: PointOf, rng: &mut Rng) -> Option<Vector3<f64>>;

    /// A point (m) of the robot, in its own frame.
    fn robot_point(&self, of: PointOf, rng: &mut Rng) -> Vector3<f64>;

    /// Where the robot at `q` has a point of its own frame, in the world.
    fn place_of(&self, q: &S, point: &Vector3<f64>) -> Vector3<f64>;

    /// The robot moved, without turning, from `q` to where a point of its frame comes to `place`, as near as its
    /// freedom allows.
    fn brought(&self, q: &S, point: &Vector3<f64>, place: &Vector3<f64>) -> S;

    /// The robot with its centre at `place` and its straightness along `direction`, turned about it by `angle` (rad).
    /// In the plane, where it can be turned about nothing but Z, it is turned about that. A robot
    /// that cannot turn is only moved.
    fn aligned(&self, place: &Vector3<f64>, direction: &Vector3<f64>, angle: f64) -> S;

    /// Whether the sphere around the robot at `q` touches that of no obstacle. The robot is free there, however
    /// it is turned. O(obstacles), without a test for collision.
    fn is_far(&self, q: &S) -> bool {
        let robot = self.robot();
        let place = self.place_of(q, &robot.center);
        self.obstacles().iter().all(|o| (o.center - place).norm() > o.radius + robot.radius)
    }
}

impl<S, H: ObstacleGeometry<S> + ?Sized> ObstacleGeometry<S> for &mut H {
    fn obstacles(&self) -> &[BodyFeatures] {
        (**self).obstacles()
    }
    fn robot(&self) -> BodyFeatures {
        (**self).robot()
    }
    fn touched(&mut self, q: &S) -> Option<usize> {
        (**self).touched(q)
    }
    fn obstacle_point(&self, obstacle: usize, of: PointOf, rng: &mut Rng) -> Option<Vector3<f64>> {
        (**self).obstacle_point(obstacle, of, rng)
    }
    fn robot_point(&self, of: PointOf, rng: &mut Rng) -> Vector3<f64> {
        (**self).robot_point(of, rng)
    }
    fn place_of(&self, q: &S, point: &Vector3<f64>) -> Vector3<f64> {
        (**self).place_of(q, point)
    }
    fn brought(&self, q: &S, point: &Vector3<f64>, place: &Vector3<f64>) -> S {
        (**self).brought(q, point, place)
    }
    fn aligned(&self, place: &Vector3<f64>, direction: &Vector3<f64>, angle: f64) -> S {
        (**self).aligned(place, direction, angle)
    }
    fn is_far(&self, q: &S) -> bool {
        (**self).is_far(q)
    }
}

impl<S, H: ObstacleHints<S> + ?Sized> ObstacleHints<S> for Box<H> {
    fn touches(&mut self, q: &S) -> bool {
        (**self).touches(q)
    }
    fn along(&mut self, from: &S, toward: &S, hit: Option<&S>, rng: &mut Rng) -> Option<S> {
        (**self).along(from, toward, hit, rng)
    }
    fn carried(&self, q: &S, from: &S, to: &S) -> S {
        (**self).carried(q, from, to)
    }
}
