//! Inverse kinematics: configurations that place a link where it is wanted.
//!
//! Damped least squares (Levenberg 1944; Marquardt 1963; for robots Wampler 1986, *Manipulator inverse kinematic solutions based on vector
//! formulations and damped least-squares methods*) from many starts: the configuration given, then points of the Halton
//! sequence. Joints at a limit that would leave it are left out of a step. The same question always has the same answers.

use super::kinematics::{JointFrame, Kinematics};
use mp_cspace::{Configuration, Halton, JointRange, Joints, Rng, Sampler, Space};
use nalgebra::{Isometry3, Matrix6, SMatrix, Unit, Vector3, Vector6};

/// What may turn freely at the goal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum FreeTurn {
    /// Nothing: the whole orientation is asked for.
    #[default]
    None,
    /// The link about this axis of its own.
    About(Unit<Vector3<f64>>),
    /// Any orientation will do.
    All,
}

/// A place that a link is to have.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseGoal {
    /// The link that is to be there, by its name.
    pub link: String,
    /// Where it is to be, in the world.
    pub pose: Isometry3<f64>,
    /// How far (m) its origin may be from there, to both sides along x, y and z of the pose asked for: not at all, where it is not above zero.
    pub within: [f64; 3],
    /// What may turn freely.
    pub free: FreeTurn,
}

impl PoseGoal {
    /// The link exactly at `pose`.
    #[must_use]
    pub fn new(link: impl Into<String>, pose: Isometry3<f64>) -> Self {
        Self { link: link.into(), pose, within: [0.0; 3], free: FreeTurn::None }
    }

    /// What is missing for a link at `pose` to be where it is wanted: metres, and radians, in the world. Zero where the goal leaves room.
    #[must_use]
    pub fn error(&self, pose: &Isometry3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let offset = self.pose.rotation.inverse() * (self.pose.translation.vector - pose.translation.vector);
        let beyond = |i: usize| {
            let within = self.within[i].max(0.0);
            offset[i] - offset[i].clamp(-within, within)
        };
        let place = self.pose.rotation * Vector3::from_fn(|i, _| beyond(i));
        let turn = match self.free {
            FreeTurn::None => (self.pose.rotation * pose.rotation.inverse()).scaled_axis(),
            FreeTurn::All => Vector3::zeros(),
            FreeTurn::About(axis) => {
                let [from, to] = [pose.rotation * axis, self.pose.rotation * axis];
                let about = from.cross(&to);
                // The cosine alone does not tell angles below 1e-8.
                let angle = mp_math::atan2(about.norm(), from.dot(&to));
                match about.try_normalize(0.0) {
                    Some(about) => about * angle,
                    // The same, or opposite: about any axis across.
                    None => angle * across(&from),
                }
            }
        };
        (place, turn)
    }
}

/// A unit vector across `axis`.
fn across(axis: &Vector3<f64>) -> Vector3<f64> {
    let smallest = axis.iamin();
    axis.cross(&Vector3::ith(smallest, 1.0)).normalize()
}

/// Solutions are this near (m, rad) to the goal.
pub const IK_PRECISION: f64 = 1e-9;
/// Steps from one start.
const STEPS: usize = 60;
/// The search from a start ends when the error has not halved within this number of steps.
const PATIENCE: usize = 12;
/// Solutions closer than this (the distance of the space) are one.
const SAME: f64 = 1e-3;

/// Solves a [`PoseGoal`] for an arm whose base stands still.
///
/// The end of two bars of a metre, one metre to the side and one up, with the elbow on either side:
/// ```
/// use mp_robot::{ArmModel, FreeTurn, InverseKinematics, Joint, JointKind, Kinematics, Link, PoseGoal};
/// use nalgebra::{Isometry3, Vector3};
///
/// let turn = JointKind::Revolute { low: -3.0, high: 3.0 };
/// let along = Isometry3::translation(1.0, 0.0, 0.0);
/// let model = ArmModel {
///     links: ["base", "upper", "lower", "tip"].map(Link::new).to_vec(),
///     joints: vec![
///         Joint::new("shoulder", "base", "upper", turn).axis(Vector3::z()),
///         Joint::new("elbow", "upper", "lower", turn).axis(Vector3::z()).at(along),
///         Joint::new("end", "lower", "tip", JointKind::Fixed).at(along),
///     ],
///     ..ArmModel::default()
/// };
/// let kinematics = Kinematics::new(&model)?;
/// let goal = PoseGoal { free: FreeTurn::All, ..PoseGoal::new("tip", Isometry3::translation(1.0, 1.0, 0.0)) };
/// let mut solver = InverseKinematics::new(&kinematics, goal).ok_or("there is no such link")?;
/// let mut shoulders: Vec<f64> = solver.solutions(100, 10).iter().map(|q| q.as_slice()[0]).collect();
/// shoulders.sort_by(f64::total_cmp);
/// assert!(shoulders.len() == 2 && shoulders[0].abs() < 1e-6 && (shoulders[1] - 1.570_796).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct InverseKinematics<'a> {
    kinematics: &'a Kinematics,
    goal: PoseGoal,
    space: Joints<Configuration>,
    /// The joints above the link, with their frames, from the base on.
    chain: Vec<usize>,
    frame: usize,
    /// The pose of the link in its frame.
    link: Isometry3<f64>,
    /// Where the search begins; joints that do not move the link stay there.
    rest: Configuration,
    /// How many metres count as much as a radian.
    length: f64,
    frames: Vec<Isometry3<f64>>,
    columns: Vec<Vector6<f64>>,
    /// The number of the next start.
    start: u64,
    /// The solutions so far.
    found: Vec<Configuration>,
}

impl<'a> InverseKinematics<'a> {
    /// For the goal; `None` when there is no such link, the base floats, or no joint moves the link.
    #[must_use]
    pub fn new(kinematics: &'a Kinematics, goal: PoseGoal) -> Option<Self> {
        let space: Joints<Configuration> = kinematics.space().ok()?;
        let attached = kinematics.attached().iter().find(|link| link.name == goal.link)?;
        let (mut chain, mut at, mut length) =
            (Vec::new(), attached.frame, attached.pose.translation.vector.norm());
        while at > 0 {
            chain.push(at);
            let joint = &kinematics.joint_frames()[at - 1];
            length += joint.origin.translation.vector.norm() + joint.slide;
            at = joint.parent;
        }
        chain.reverse();
        let count = space.ranges().len();
        (!chain.is_empty()).then(|| Self {
            kinematics,
            goal,
            space,
            frame: attached.frame,
            link: attached.pose,
            chain,
            rest: Configuration::from(kinematics.neutral()),
            // A radian at the end of the arm moves it as far as it is long; orientation counts for a part of that.
            length: (0.3 * length).max(1e-3),
            frames: Vec::new(),
            columns: vec![Vector6::zeros(); count],
            start: 0,
            found: Vec::new(),
        })
    }

    /// The same search, which begins at `q`, by default the neutral configuration. Joints that do not move the link stay as they are there.
    #[must_use]
    pub fn beginning_at(self, q: &Configuration) -> Self {
        Self { rest: q.clone(), ..self }
    }

    /// The distance (m) of the goal from the base, and the farthest that the link can be from there by the lengths of the arm.
    #[must_use]
    pub fn reach(&self) -> [f64; 2] {
        let joint = |frame: &usize| &self.kinematics.joint_frames()[frame - 1];
        let lengths =
            self.chain.iter().map(joint).map(|j: &JointFrame| j.origin.translation.vector.norm() + j.slide);
        let first = self.kinematics.joint_frames()[self.chain[0] - 1].origin.translation.vector;
        let base = self.kinematics.base * nalgebra::Point3::from(first);
        let farthest = lengths.skip(1).sum::<f64>()
            + self.link.translation.vector.norm()
            + self.kinematics.joint_frames()[self.chain[0] - 1].slide;
        [(self.goal.pose.translation.vector - base.coords).norm(), farthest]
    }

    /// Where the link is at `q`.
    #[must_use]
    pub fn pose_at(&mut self, q: &[f64]) -> Isometry3<f64> {
        self.kinematics.frames_into(q, &mut self.frames);
        self.frames[self.frame] * self.link
    }

    /// The size of the error at `q`: its part in metres, and in radians.
    fn error_at(&mut self, q: &[f64]) -> ([f64; 2], Vector6<f64>) {
        let pose = self.pose_at(q);
        let (place, turn) = self.goal.error(&pose);
        let turned = turn * self.length;
        let error = Vector6::new(place.x, place.y, place.z, turned.x, turned.y, turned.z);
        ([place.norm(), turn.norm()], error)
    }

    /// How a unit of each coordinate moves the link: metres, and radians times the length. The frames are those of the last
    /// [`pose_at`](Self::pose_at).
    fn jacobian(&mut self, at: &Isometry3<f64>) {
        self.columns.iter_mut().for_each(|column| *column = Vector6::zeros());
        for &frame in &self.chain {
            let joint = &self.kinematics.joint_frames()[frame - 1];
            let pose = &self.frames[frame];
            let axis = pose.rotation * joint.axis.into_inner() * joint.scale;
            let (moved, turned) = match joint.slides {
                true => (axis, Vector3::zeros()),
                false => (axis.cross(&(at.translation.vector - pose.translation.vector)), axis * self.length),
            };
            let column = &mut self.columns[joint.coordinate];
            *column += Vector6::new(moved.x, moved.y, moved.z, turned.x, turned.y, turned.z);
        }
        // What the goal leaves free does not count.
        let axes = self.goal.pose.rotation.to_rotation_matrix();
        let offset =
            self.goal.pose.rotation.inverse() * (self.goal.pose.translation.vector - at.translation.vector);
        for i in (0..3).filter(|i| self.goal.within[*i] > 0.0 && offset[*i].abs() <= self.goal.within[*i]) {
            let axis = axes.matrix().column(i).into_owned();
            for column in &mut self.columns {
                let moved = Vector3::new(column[0], column[1], column[2]);
                let left = moved - axis * axis.dot(&moved);
                (column[0], column[1], column[2]) = (left.x, left.y, left.z);
            }
        }
        let about = match self.goal.free {
            FreeTurn::None => return,
            FreeTurn::All => None,
            FreeTurn::About(axis) => Some(at.rotation * axis.into_inner()),
        };
        for column in &mut self.columns {
            let turned = Vector3::new(column[3], column[4], column[5]);
            let left = about.map_or_else(Vector3::zeros, |axis| turned - axis * axis.dot(&turned));
            (column[3], column[4], column[5]) = (left.x, left.y, left.z);
        }
    }

    /// The solution that descending from `q` leads to, if it leads to one.
    pub fn from(&mut self, q: &Configuration) -> Option<Configuration> {
        let mut q = q.clone();
        let (mut norms, mut error) = self.error_at(q.as_slice());
        let (mut damping, mut best, mut since) = (1e-2, f64::INFINITY, 0);
        for _ in 0..STEPS {
            // NaN is not near.
            if norms.iter().all(|norm| *norm <= IK_PRECISION) {
                return Some(self.space.wrapped(&q));
            }
            let size = error.norm();
            (best, since) = if size < 0.5 * best { (size, 0) } else { (best, since + 1) };
            if since > PATIENCE {
                return None;
            }
            let at = self.frames[self.frame] * self.link;
            self.jacobian(&at);
            // A step is tried with more and more damping until it helps.
            let mut helped = false;
            for _ in 0..6 {
                let step = self.step(&q, &error, damping * size)?;
                let (new_norms, new_error) = self.error_at(step.as_slice());
                if new_error.norm() < size {
                    (q, norms, error, helped) = (step, new_norms, new_error, true);
                    damping = (0.2 * damping).max(1e-9);
                    break;
                }
                damping = (8.0 * damping).min(1e6);
            }
            if !helped {
                return None;
            }
        }
        None
    }

    /// A step against `error` within the limits; `None` when none is left. Joints that would leave their limits stay there, and the
    /// others do their part.
    fn step(&self, q: &Configuration, error: &Vector6<f64>, damping: f64) -> Option<Configuration> {
        let mut held = vec![false; self.columns.len()];
        loop {
            let mut normal: Matrix6<f64> = SMatrix::identity() * damping.max(1e-14);
            for (column, _) in self.columns.iter().zip(&held).filter(|(_, held)| !**held) {
                normal += column * column.transpose();
            }
            let weights = normal.cholesky()?.solve(error);
            let (mut to, mut pressed) = (q.clone(), false);
            for (i, column) in self.columns.iter().enumerate() {
                if held[i] {
                    continue;
                }
                let (at, moved) = (q.as_slice()[i], q.as_slice()[i] + column.dot(&weights));
                let within = match self.space.ranges()[i] {
                    JointRange::Circle => moved,
                    JointRange::Interval { low, high } => moved.clamp(low, high),
                };
                held[i] = within == at && moved != at;
                pressed |= held[i];
                to.as_mut_slice()[i] = within;
            }
            if !pressed {
                return Some(to);
            }
            if held.iter().all(|held| *held) {
                return None;
            }
        }
    }

    /// The next start: first where the search begins, then points of the Halton sequence.
    fn next_start(&mut self) -> Configuration {
        let number = self.start;
        self.start += 1;
        let mut q = self.rest.clone();
        if number > 0 {
            let sample = Halton::new(&self.space).skip(number - 1).sample(&mut Rng::seed(0));
            for &frame in &self.chain {
                let i = self.kinematics.joint_frames()[frame - 1].coordinate;
                q.as_mut_slice()[i] = sample.as_slice()[i];
            }
        }
        q
    }

    /// The solution that the search from the next start finds; `None` if it finds none, or one that was found
    /// before.
    pub fn next_solution(&mut self) -> Option<Configuration> {
        let start = self.next_start();
        let q = self.from(&start)?;
        if self.found.iter().any(|known| self.space.distance(known, &q) <= SAME) {
            return None;
        }
        self.found.push(q.clone());
        Some(q)
    }

    /// Different solutions, from the next `starts` starts, at most `most` of them.
    pub fn solutions(&mut self, starts: u64, most: usize) -> Vec<Configuration> {
        let mut found = Vec::new();
        for _ in 0..starts {
            found.extend(self.next_solution());
            if found.len() >= most {
                break;
            }
        }
        found
    }
}
