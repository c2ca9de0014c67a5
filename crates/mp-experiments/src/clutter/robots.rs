//! The robots of the experiment: a free-flyer, and an arm with six joints.

use super::boxes::{Obstacle, Region, boxes};
use super::scene_text::{list, urdf};
use crate::Result;
use mp_cspace::{Clearance, Factored, MotionValidity, Rn, Se3, Space, Validity};
use mp_geom::{pose_from_six, primitives::cuboid, short_six_from_pose};
use mp_robot::{Arm, ArmModel, ArmVerifier, FreeFlyer, Joint, JointKind, Link, Spatial, Verifier};
use nalgebra::{Isometry3, SVector, UnitQuaternion, Vector3};

/// A number for each degree of freedom, of which both robots have six.
pub(super) type Six = SVector<f64, 6>;

/// A robot with all that planning needs: its problem without obstacles, where obstacles are put, and its
/// inputs.
#[derive(Clone, Debug)]
pub(super) struct Setup<Sp: Space> {
    pub(super) space: Sp,
    pub(super) start: Sp::State,
    pub(super) goal: Sp::State,
    /// The region and sizes of the obstacles.
    pub(super) region: Region,
    /// The velocity of each degree of freedom that makes one step in a second.
    pub(super) speeds: Six,
    /// The greatest velocities, per second, of the model with velocities. With the accelerations such that
    /// the problem without obstacles is solved with every set of inputs, so that obstacles are what is
    /// measured.
    pub(super) velocities: Six,
    /// The accelerations of that model, per second².
    pub(super) accelerations: Six,
    /// Weights of the factors of the space for the scaled metric: about how far each factor moves points.
    pub(super) weights: Vec<f64>,
    /// The resolution of discrete motion checks, in the space's own metric.
    pub(super) resolution: f64,
}

/// A robot of the experiment.
pub(super) trait TestRobot: Sync {
    /// The configuration space.
    type Space: Factored + Clone + Sync;
    /// The robot among obstacles.
    type Robot: Validity<<Self::Space as Space>::State> + Clone + Send;

    /// Its problem and inputs.
    fn setup(&self) -> &Setup<Self::Space>;
    /// Whether a configuration counts as the goal; the same for all metrics. With velocities the region is
    /// larger: in a small one a tree moved by accelerations stops only by luck, even without obstacles.
    fn arrived(&self, q: &<Self::Space as Space>::State, has_velocity: bool) -> bool;
    fn among(&self, obstacles: &[Obstacle]) -> Result<Self::Robot>;
    /// A verifier of motions, with other code than the robot's check.
    fn verifier<'a>(
        &'a self,
        robot: &Self::Robot,
    ) -> Result<impl MotionValidity<<Self::Space as Space>::State> + Send + use<'a, Self>>;
    /// The configuration of a row of a path file.
    fn configuration(&self, row: [f64; 6]) -> <Self::Space as Space>::State;
    /// The tables `[robot]` and `[motion]` of a scene file, with the goal that is the middle of the goal
    /// region here.
    fn tables(&self) -> String;
    /// Whether an obstacle keeps some clearance from start and goal.
    fn spares(&self, obstacle: &Obstacle) -> Result<bool>;

    /// `count` obstacles of an instance; the first n are those of its problem with n obstacles.
    fn obstacles(&self, count: usize, instance: u64) -> Result<Vec<Obstacle>> {
        boxes(&self.setup().region, count, instance, |o| self.spares(o))
    }

    /// Whether each of the rows of a path file is free among obstacles.
    fn are_free(&self, obstacles: &[Obstacle], rows: &[[f64; 6]]) -> Result<Vec<bool>> {
        let mut robot = self.among(obstacles)?;
        Ok(rows.iter().map(|row| robot.is_valid(&self.configuration(*row))).collect())
    }
}

/// A bar that flies from one corner of a room of 10 m to the opposite one.
#[derive(Clone, Debug)]
pub(super) struct Flyer(Setup<Se3>);

/// Sides of the bar, metres.
const BAR: [f64; 3] = [1.0, 0.5, 0.25];
/// The side of the room, metres.
const ROOM: f64 = 10.0;

impl Flyer {
    pub(super) fn new() -> Result<Self> {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.0, 1.5));
        let radius = Vector3::from(BAR).norm() / 2.0;
        Ok(Self(Setup {
            space: Se3::new([0.0; 3], [ROOM; 3])?,
            start: Isometry3::translation(1.0, 1.0, 1.0),
            goal: Isometry3::from_parts(Vector3::repeat(ROOM - 1.0).into(), turn),
            region: Region { low: [0.0; 3], high: [ROOM; 3], sides: (0.4, 1.4) },
            speeds: Six::from([0.5; 6]),
            velocities: Six::from([1.0; 6]),
            accelerations: Six::from([1.0; 6]),
            weights: vec![1.0, 1.0, 1.0, radius],
            resolution: 0.1,
        }))
    }
}

impl TestRobot for Flyer {
    type Space = Se3;
    type Robot = FreeFlyer;

    fn setup(&self) -> &Setup<Se3> {
        &self.0
    }
    fn arrived(&self, q: &Isometry3<f64>, has_velocity: bool) -> bool {
        let within = if has_velocity { 1.5 } else { 0.75 };
        let goal = &self.0.goal;
        (q.translation.vector - goal.translation.vector).norm() < within
            && q.rotation.angle_to(&goal.rotation) < within
    }
    fn among(&self, obstacles: &[Obstacle]) -> Result<FreeFlyer> {
        let bar = cuboid(BAR[0], BAR[1], BAR[2])?;
        Ok(FreeFlyer::new(&bar, obstacles.iter().cloned())?)
    }
    fn verifier<'a>(
        &'a self,
        robot: &FreeFlyer,
    ) -> Result<impl MotionValidity<Isometry3<f64>> + Send + use<'a>> {
        Ok(Verifier::<_, Spatial>::new(&self.0.space, robot)?)
    }
    fn configuration(&self, row: [f64; 6]) -> Isometry3<f64> {
        pose_from_six(row)
    }
    fn tables(&self) -> String {
        let (sides, low, high) = (list(&BAR), list(&[0.0; 3]), list(&[ROOM; 3]));
        let [start, goal] = [&self.0.start, &self.0.goal].map(|q| list(&short_six_from_pose(q)));
        format!(
            "[robot]\nbox = {sides}\nbounds = [{low}, {high}]\n\n[motion]\nstart = {start}\ngoal = {goal}\n"
        )
    }
    fn spares(&self, obstacle: &Obstacle) -> Result<bool> {
        let mut robot = self.among(std::slice::from_ref(obstacle))?;
        Ok([&self.0.start, &self.0.goal].into_iter().all(|q| robot.clearance(q, 0.3) >= 0.3))
    }
}

/// An arm with six revolute joints and links of boxes, among boxes in the air.
#[derive(Clone, Debug)]
pub(super) struct SixAxes {
    arm: Arm,
    setup: Setup<Rn<6>>,
}

/// The file of the arm, seen from the folder of the shipped files.
pub(super) const ARM_FILE: &str = "robots/rsrt-arm.urdf";
/// The limit of each joint in both directions, radians.
const TURN: f64 = 2.6;
/// Distances from the axis of each joint to the tip of the straight arm, metres; rough values for the roll
/// joints.
const ARMS: [f64; 6] = [1.5, 1.5, 1.0, 0.3, 0.5, 0.15];

impl SixAxes {
    pub(super) fn new() -> Result<Self> {
        let arm = Arm::new(&model()?, [])?;
        let setup = Setup {
            space: Rn::new([-TURN; 6], [TURN; 6])?,
            start: Six::from([-1.2, 0.6, 0.9, 0.0, 0.6, 0.0]),
            goal: Six::from([1.4, 0.3, 1.2, 1.0, -0.7, 1.0]),
            region: Region { low: [-1.6, -1.6, 0.0], high: [1.6, 1.6, 1.8], sides: (0.05, 0.3) },
            speeds: Six::from([0.2; 6]),
            velocities: Six::from([0.4; 6]),
            accelerations: Six::from([0.4; 6]),
            weights: ARMS.to_vec(),
            resolution: 0.05,
        };
        Ok(Self { arm, setup })
    }

    /// The text of [`ARM_FILE`].
    pub(super) fn urdf(&self) -> String {
        let about = "The arm of Jouandeau, Touati and Ali Cherif 2008, §4, as rebuilt here: six joints, links of boxes.";
        urdf("rsrt-arm", about, self.arm.model())
    }
}

/// Base, shoulder, elbow and a wrist of three axes: 0.35 m high, then links of 0.5 m, 0.5 m and 0.5 m.
fn model() -> Result<ArmModel> {
    let turn = JointKind::Revolute { low: -TURN, high: TURN };
    let up = |z: f64| Isometry3::translation(0.0, 0.0, z);
    let link = |name: &str, side: f64, length: f64| -> Result<Link> {
        let shape = cuboid(side, side, length)?;
        Ok(Link::new(name).with(&shape, &up(0.5 * length)))
    };
    let joint = |name: &str, parent: &str, child: &str, z: f64, axis: Vector3<f64>| {
        Joint::new(name, parent, child, turn).at(up(z)).axis(axis)
    };
    Ok(ArmModel {
        links: vec![
            link("base", 0.24, 0.15)?,
            link("turret", 0.18, 0.2)?,
            link("upper_arm", 0.12, 0.5)?,
            link("forearm", 0.1, 0.3)?,
            link("roll", 0.09, 0.2)?,
            link("wrist", 0.08, 0.2)?,
            link("hand", 0.12, 0.15)?,
        ],
        joints: vec![
            joint("pan", "base", "turret", 0.15, Vector3::z()),
            joint("shoulder", "turret", "upper_arm", 0.2, Vector3::y()),
            joint("elbow", "upper_arm", "forearm", 0.5, Vector3::y()),
            joint("forearm_roll", "forearm", "roll", 0.3, Vector3::z()),
            joint("wrist_pitch", "roll", "wrist", 0.2, Vector3::y()),
            joint("hand_roll", "wrist", "hand", 0.2, Vector3::z()),
        ],
        ..ArmModel::default()
    })
}

impl TestRobot for SixAxes {
    type Space = Rn<6>;
    type Robot = Arm;

    fn setup(&self) -> &Setup<Rn<6>> {
        &self.setup
    }
    fn arrived(&self, q: &Six, has_velocity: bool) -> bool {
        self.setup.space.distance(q, &self.setup.goal) < if has_velocity { 1.5 } else { 0.5 }
    }
    fn among(&self, obstacles: &[Obstacle]) -> Result<Arm> {
        Ok(self.arm.among(obstacles.iter().cloned())?)
    }
    fn verifier<'a>(&'a self, robot: &Arm) -> Result<impl MotionValidity<Six> + Send + use<'a>> {
        Ok(ArmVerifier::new(&self.setup.space, robot)?)
    }
    fn configuration(&self, row: [f64; 6]) -> Six {
        row.into()
    }
    fn tables(&self) -> String {
        let [start, goal] = [&self.setup.start, &self.setup.goal].map(|q| list(q.as_slice()));
        format!("[robot]\nurdf = \"../{ARM_FILE}\"\n\n[motion]\nstart = {start}\ngoal = {goal}\n")
    }
    fn spares(&self, obstacle: &Obstacle) -> Result<bool> {
        let mut robot = self.among(std::slice::from_ref(obstacle))?;
        let ends = [&self.setup.start, &self.setup.goal];
        let clear = |robot: &mut Arm, q: &Six| robot.clearance(q, 0.04) >= 0.04;
        // No obstacle in the base and the turret, or no problem could be solved.
        let o = obstacle.2.translation.vector;
        Ok(!(o.xy().norm() < 0.35 && o.z < 0.5) && ends.into_iter().all(|q| clear(&mut robot, q)))
    }
}
