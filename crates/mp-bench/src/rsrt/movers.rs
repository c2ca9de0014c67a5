//! What moves: a free-flyer, and an arm with six joints.

use super::clutter::{Obstacle, Region, boxes};
use crate::error::{IntoError, Result};
use mp_cspace::{Clearance, Factored, MotionValidity, Rn, Se3, Space, Validity};
use mp_geom::primitives::cuboid;
use mp_robot::{Arm, ArmModel, ArmVerifier, FreeFlyer, Joint, JointKind, Link, Spatial, Verifier};
use nalgebra::{Isometry3, SVector, UnitQuaternion, Vector3};

/// As many numbers as both movers have degrees of freedom.
pub(super) type Six = SVector<f64, 6>;

/// A mover with a world of its own for each problem, and how it is told to move.
pub(super) trait Mover: Sync {
    /// Its configurations.
    type Space: Factored + Clone + Sync;
    /// Among obstacles.
    type Robot: Validity<<Self::Space as Space>::State> + Clone + Send;

    fn space(&self) -> &Self::Space;
    fn start(&self) -> &<Self::Space as Space>::State;
    fn goal(&self) -> &<Self::Space as Space>::State;
    /// Whether a configuration is near enough to the goal: whatever the metric, the same.
    fn arrived(&self, q: &<Self::Space as Space>::State) -> bool;
    fn among(&self, obstacles: &[Obstacle]) -> Result<Self::Robot>;
    /// Proves motions, by other code than the robot's.
    fn verifier<'a>(
        &'a self,
        robot: &Self::Robot,
    ) -> Result<impl MotionValidity<<Self::Space as Space>::State> + Send + use<'a, Self>>;
    /// The room for obstacles.
    fn region(&self) -> Region;
    /// Whether an obstacle leaves start and goal free, with room to spare.
    fn spares(&self, obstacle: &Obstacle) -> Result<bool>;
    /// The velocity that moves each degree of freedom by one step in a second.
    fn speeds(&self) -> Six;
    /// Greatest velocities of the model that has them, and its accelerations: per second and per second².
    fn limits(&self) -> (Six, Six);
    /// Weights of the factors of the space for the scaled metric: about how far they move points.
    fn weights(&self) -> Vec<f64>;
    /// States farther apart than this, in the space's own metric, are not tested side by side.
    fn resolution(&self) -> f64;

    /// The obstacles of an instance, as many as there may be; the first n are those of its problem of n.
    fn obstacles(&self, count: usize, instance: u64) -> Result<Vec<Obstacle>> {
        boxes(&self.region(), count, instance, |o| self.spares(o))
    }
}

/// A bar that flies from one corner of a room of 10 m to the opposite one.
#[derive(Clone, Debug)]
pub(super) struct Flyer {
    space: Se3,
    start: Isometry3<f64>,
    goal: Isometry3<f64>,
}

/// Sides of the bar, metres.
const BAR: [f64; 3] = [1.0, 0.5, 0.25];
/// The side of the room, metres.
const ROOM: f64 = 10.0;

impl Flyer {
    pub(super) fn new() -> Result<Self> {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.0, 1.5));
        Ok(Self {
            space: Se3::new([0.0; 3], [ROOM; 3]).into_error()?,
            start: Isometry3::translation(1.0, 1.0, 1.0),
            goal: Isometry3::from_parts(Vector3::repeat(ROOM - 1.0).into(), turn),
        })
    }
}

impl Mover for Flyer {
    type Space = Se3;
    type Robot = FreeFlyer;

    fn space(&self) -> &Se3 {
        &self.space
    }
    fn start(&self) -> &Isometry3<f64> {
        &self.start
    }
    fn goal(&self) -> &Isometry3<f64> {
        &self.goal
    }
    fn arrived(&self, q: &Isometry3<f64>) -> bool {
        (q.translation.vector - self.goal.translation.vector).norm() < 0.75
            && q.rotation.angle_to(&self.goal.rotation) < 0.75
    }
    fn among(&self, obstacles: &[Obstacle]) -> Result<FreeFlyer> {
        let bar = cuboid(BAR[0], BAR[1], BAR[2]).into_error()?;
        FreeFlyer::new(&bar, obstacles.iter().cloned()).into_error()
    }
    fn verifier<'a>(
        &'a self,
        robot: &FreeFlyer,
    ) -> Result<impl MotionValidity<Isometry3<f64>> + Send + use<'a>> {
        Verifier::<_, Spatial>::new(&self.space, robot).into_error()
    }
    fn region(&self) -> Region {
        Region { low: [0.0; 3], high: [ROOM; 3], sides: (0.4, 1.4) }
    }
    fn spares(&self, obstacle: &Obstacle) -> Result<bool> {
        let mut robot = self.among(std::slice::from_ref(obstacle))?;
        Ok([&self.start, &self.goal].into_iter().all(|q| robot.clearance(q, 0.3) >= 0.3))
    }
    fn speeds(&self) -> Six {
        Six::from([0.5, 0.5, 0.5, 0.5, 0.5, 0.5])
    }
    fn limits(&self) -> (Six, Six) {
        (Six::from([1.0; 6]), Six::from([0.5; 6]))
    }
    fn weights(&self) -> Vec<f64> {
        let radius = Vector3::from(BAR).norm() / 2.0;
        vec![1.0, 1.0, 1.0, radius]
    }
    fn resolution(&self) -> f64 {
        0.1
    }
}

/// An arm with six revolute joints and links of boxes, on a table among boxes in the air.
#[derive(Clone, Debug)]
pub(super) struct SixAxes {
    arm: Arm,
    space: Rn<6>,
    start: Six,
    goal: Six,
}

/// How far each joint turns, radians either way.
const TURN: f64 = 2.6;
/// Distances from the axis of each joint to the tip of the straight arm, metres; about so for the roll joints.
const ARMS: [f64; 6] = [1.5, 1.5, 1.0, 0.3, 0.5, 0.15];

impl SixAxes {
    pub(super) fn new() -> Result<Self> {
        let arm = Arm::new(&model()?, []).into_error()?;
        let (start, goal) =
            (Six::from([-1.2, 0.6, 0.9, 0.0, 0.6, 0.0]), Six::from([1.4, 0.3, 1.2, 1.0, -0.7, 1.0]));
        Ok(Self { arm, space: Rn::new([-TURN; 6], [TURN; 6]).into_error()?, start, goal })
    }
}

/// Base, shoulder, elbow and a wrist of three axes: 0.35 m up, 0.5 m, 0.5 m and 0.5 m out.
fn model() -> Result<ArmModel> {
    let turn = JointKind::Revolute { low: -TURN, high: TURN };
    let up = |z: f64| Isometry3::translation(0.0, 0.0, z);
    let link = |name: &str, side: f64, length: f64| -> Result<Link> {
        let shape = cuboid(side, side, length).into_error()?;
        Ok(Link::new(name).with(&shape, &up(0.5 * length)))
    };
    let joint = |name: &str, parent: &str, child: &str, z: f64, axis: Vector3<f64>| {
        Joint::new(name, parent, child, turn).at(up(z)).axis(axis)
    };
    Ok(ArmModel {
        links: vec![
            link("base", 0.24, 0.15)?,
            link("turret", 0.18, 0.2)?,
            link("upper arm", 0.12, 0.5)?,
            link("forearm", 0.1, 0.3)?,
            link("roll", 0.09, 0.2)?,
            link("wrist", 0.08, 0.2)?,
            link("hand", 0.12, 0.15)?,
        ],
        joints: vec![
            joint("pan", "base", "turret", 0.15, Vector3::z()),
            joint("shoulder", "turret", "upper arm", 0.2, Vector3::y()),
            joint("elbow", "upper arm", "forearm", 0.5, Vector3::y()),
            joint("forearm roll", "forearm", "roll", 0.3, Vector3::z()),
            joint("wrist pitch", "roll", "wrist", 0.2, Vector3::y()),
            joint("hand roll", "wrist", "hand", 0.2, Vector3::z()),
        ],
        ..ArmModel::default()
    })
}

impl Mover for SixAxes {
    type Space = Rn<6>;
    type Robot = Arm;

    fn space(&self) -> &Rn<6> {
        &self.space
    }
    fn start(&self) -> &Six {
        &self.start
    }
    fn goal(&self) -> &Six {
        &self.goal
    }
    fn arrived(&self, q: &Six) -> bool {
        self.space.distance(q, &self.goal) < 0.5
    }
    fn among(&self, obstacles: &[Obstacle]) -> Result<Arm> {
        self.arm.among(obstacles.iter().cloned()).into_error()
    }
    fn verifier<'a>(&'a self, robot: &Arm) -> Result<impl MotionValidity<Six> + Send + use<'a>> {
        ArmVerifier::new(&self.space, robot).into_error()
    }
    fn region(&self) -> Region {
        Region { low: [-1.6, -1.6, 0.0], high: [1.6, 1.6, 1.8], sides: (0.05, 0.3) }
    }
    fn spares(&self, obstacle: &Obstacle) -> Result<bool> {
        let mut robot = self.among(std::slice::from_ref(obstacle))?;
        let ends = [&self.start, &self.goal];
        let clear = |robot: &mut Arm, q: &Six| robot.clearance(q, 0.04) >= 0.04;
        // Nothing in the base and what turns on it, or no problem could be solved.
        let o = obstacle.2.translation.vector;
        Ok(!(o.xy().norm() < 0.35 && o.z < 0.5) && ends.into_iter().all(|q| clear(&mut robot, q)))
    }
    fn speeds(&self) -> Six {
        Six::from([0.2; 6])
    }
    fn limits(&self) -> (Six, Six) {
        (Six::from([0.8; 6]), Six::from([0.4; 6]))
    }
    fn weights(&self) -> Vec<f64> {
        ARMS.to_vec()
    }
    fn resolution(&self) -> f64 {
        0.05
    }
}
