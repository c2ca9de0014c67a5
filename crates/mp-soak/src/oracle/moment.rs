//! Where the numbers of a path place the robot, and where it is between two rows.

use super::{Case, Mover};
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};
use std::f64::consts::{PI, TAU};

/// What a goal asks of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ask {
    /// The number must be this.
    Exactly(f64),
    /// A value in this interval.
    Between([f64; 2]),
    /// Nothing.
    Free,
}

/// How the numbers of a configuration place the robot.
#[derive(Clone, Debug, PartialEq)]
pub enum Moves {
    /// x and y.
    Point,
    /// x, y and the angle.
    Plane,
    /// x, y, z and the angles about Z, Y and X.
    Space,
    /// The values of joints of a tree; if the root floats, after the six numbers of its pose.
    Tree(Tree),
}

/// A tree of joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// Whether the root floats.
    pub floats: bool,
    /// The pose of the root if it does not float.
    pub base: Isometry3<f64>,
    /// The joints, each after the one above it.
    pub joints: Vec<Joint>,
    /// How many numbers the joints take.
    pub numbers: usize,
    /// For each number, whether a full turn makes no difference.
    pub circles: Vec<bool>,
}

/// A joint of a tree, and the frame behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// The frame above: 0 is the root, `i + 1` the frame behind joint `i`.
    pub above: usize,
    /// Its pose in that frame at value zero.
    pub origin: Isometry3<f64>,
    /// The unit vector that it turns about or slides along, in its own frame.
    pub axis: Vector3<f64>,
    /// Whether its value is a length along the axis (m), not an angle about it (rad).
    pub slides: bool,
    /// Which number gives its value, and the factor and offset of its value; `None` for a fixed joint.
    pub number: Option<(usize, f64, f64)>,
    /// The greatest value (m) if it slides.
    pub farthest: f64,
    /// Whether it is held at the value that its origin has: it moves nothing, but what is behind it is no part of what is before it.
    pub is_held: bool,
}

impl Joint {
    /// Whether it is no fixed joint.
    pub(crate) fn is_joint(&self) -> bool {
        self.number.is_some() || self.is_held
    }
}

/// How inputs move a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// What the inputs are.
    pub kind: DriveKind,
    /// The least and greatest value of each number of an input.
    pub limits: Vec<[f64; 2]>,
    /// The greatest absolute value of each velocity that is part of the state.
    pub velocities: Vec<f64>,
    /// The longest time (s) that an input is held.
    pub longest: f64,
}

/// What an input is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveKind {
    /// The speed (m/s) and the steering angle of a car with this distance (m) between its axles.
    Car(f64),
    /// The speed (m/s) and the turning rate (rad/s).
    Unicycle,
    /// A velocity of each degree of freedom.
    Velocities,
    /// An acceleration of each degree of freedom.
    Accelerations,
}

/// Where everything is at one moment.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Moment {
    pub(super) root: Isometry3<f64>,
    pub(super) joints: Vec<f64>,
    pub(super) velocities: Vec<f64>,
    pub(super) time: f64,
}

/// A row of a path, taken apart.
#[derive(Clone, Debug)]
pub(super) struct Row<'r> {
    pub(super) moment: Moment,
    /// The numbers of the configuration.
    pub(super) own: &'r [f64],
    pub(super) input: &'r [f64],
    pub(super) duration: f64,
}

/// The pose of six numbers.
pub(super) fn pose(six: &[f64]) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_euler_angles(six[5], six[4], six[3]);
    Isometry3::from_parts(Translation3::new(six[0], six[1], six[2]), turn)
}

/// An angle, turned fully until it is in [-π, π].
pub(super) fn wrapped(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

impl Moves {
    /// How many numbers a configuration has, without a time.
    #[must_use]
    pub fn numbers(&self) -> usize {
        match self {
            Self::Point => 2,
            Self::Plane => 3,
            Self::Space => 6,
            Self::Tree(tree) => tree.numbers + if tree.floats { 6 } else { 0 },
        }
    }

    /// The pose of the root, and the values of joints.
    fn placed(&self, numbers: &[f64]) -> (Isometry3<f64>, Vec<f64>) {
        match self {
            Self::Point => (Isometry3::translation(numbers[0], numbers[1], 0.0), Vec::new()),
            Self::Plane => (pose(&[numbers[0], numbers[1], 0.0, numbers[2], 0.0, 0.0]), Vec::new()),
            Self::Space => (pose(numbers), Vec::new()),
            Self::Tree(tree) if tree.floats => (pose(&numbers[..6]), numbers[6..].to_vec()),
            Self::Tree(tree) => (tree.base, numbers.to_vec()),
        }
    }
}

impl Case {
    /// Takes a row apart. An error says what is wrong with its length.
    pub(super) fn row<'r>(&self, row: &'r [f64]) -> Result<Row<'r>, String> {
        let own = self.moves.numbers();
        let timed = usize::from(self.timing.is_some());
        let (velocities, inputs) =
            self.drive.as_ref().map_or((0, 0), |drive| (drive.velocities.len(), drive.limits.len() + 1));
        // A path of a mesh in the plane is written as poses in space.
        let flat = self.moves == Moves::Plane && self.drive.is_none() && row.len() == 6 + timed;
        if !flat && row.len() != own + timed + velocities + inputs {
            return Err(format!(
                "a row has {} numbers, not {}",
                row.len(),
                own + timed + velocities + inputs
            ));
        }
        if !row.iter().all(|x| x.is_finite()) {
            return Err("a number is not finite".to_owned());
        }
        if flat {
            let root = pose(&row[..6]);
            let upright = (root.rotation * Vector3::z() - Vector3::z()).norm();
            if row[2] != 0.0 || upright > 1e-9 {
                return Err("a pose leaves the plane".to_owned());
            }
            let time = row.get(6).copied().unwrap_or(0.0);
            let moment = Moment { root, joints: Vec::new(), velocities: Vec::new(), time };
            return Ok(Row { moment, own: &row[..6], input: &[], duration: 0.0 });
        }
        let (numbers, rest) = row.split_at(own);
        let (time, rest) = rest.split_at(timed);
        let (velocity, rest) = rest.split_at(velocities);
        let (root, joints) = self.moves.placed(numbers);
        let time = time.first().copied().unwrap_or(0.0);
        let moment = Moment { root, joints, velocities: velocity.to_vec(), time };
        let (input, duration) = rest.split_at(inputs.saturating_sub(1));
        Ok(Row { moment, own: numbers, input, duration: duration.first().copied().unwrap_or(0.0) })
    }

    /// The poses of all frames of the robot, then of the obstacles that move.
    pub(super) fn frames(&self, moment: &Moment) -> Vec<Isometry3<f64>> {
        let mut frames = vec![moment.root];
        if let Moves::Tree(tree) = &self.moves {
            for joint in &tree.joints {
                let value =
                    joint.number.map_or(0.0, |(i, factor, offset)| factor * moment.joints[i] + offset);
                let own = match joint.slides {
                    true => Isometry3::from(Translation3::from(joint.axis * value)),
                    false => {
                        let turn = UnitQuaternion::from_axis_angle(&Unit::new_unchecked(joint.axis), value);
                        Isometry3::from_parts(Translation3::identity(), turn)
                    }
                };
                frames.push(frames[joint.above] * joint.origin * own);
            }
        }
        frames.extend(self.moving.iter().map(|mover| mover.at(moment.time)));
        frames
    }
}

/// The pose between two others: straight, and turning about a fixed axis by `angle`, part `t` of the way.
fn between(a: &Isometry3<f64>, b: &Isometry3<f64>, turn: &Turn, t: f64) -> Isometry3<f64> {
    let position = a.translation.vector + (b.translation.vector - a.translation.vector) * t;
    Isometry3::from_parts(Translation3::from(position), turn.at(t) * a.rotation)
}

/// A rotation about a fixed axis of the world.
#[derive(Clone, Debug)]
struct Turn {
    axis: Vector3<f64>,
    angle: f64,
}

impl Turn {
    /// The shortest rotation from `a` to `b`.
    fn shortest(a: &Isometry3<f64>, b: &Isometry3<f64>) -> Self {
        let difference = b.rotation * a.rotation.inverse();
        let (w, v) = (difference.w, difference.imag());
        let (w, v) = if w < 0.0 { (-w, -v) } else { (w, v) };
        let sine = v.norm();
        let axis = if sine > 0.0 { v / sine } else { Vector3::z() };
        Self { axis, angle: 2.0 * sine.atan2(w) }
    }

    /// The rotation the other way round.
    fn reversed(&self) -> Self {
        Self { axis: self.axis, angle: self.angle - TAU }
    }

    fn at(&self, t: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&Unit::new_unchecked(self.axis), self.angle * t)
    }
}

impl Mover {
    /// Its pose at a time (s).
    fn at(&self, time: f64) -> Isometry3<f64> {
        let after = self.rows.iter().position(|(t, _)| *t > time);
        match after {
            Some(0) => self.rows[0].1,
            None => self.rows[self.rows.len() - 1].1,
            Some(i) => {
                let ((t0, a), (t1, b)) = (&self.rows[i - 1], &self.rows[i]);
                between(a, b, &Turn::shortest(a, b), (time - t0) / (t1 - t0))
            }
        }
    }

    /// How far a point of it can move between two times (m).
    pub(super) fn travel(&self, from: f64, to: f64) -> f64 {
        let mut far = 0.0;
        for pair in self.rows.windows(2) {
            let ((t0, a), (t1, b)) = (&pair[0], &pair[1]);
            let part = ((to.min(*t1) - from.max(*t0)) / (t1 - t0)).max(0.0);
            let straight = (b.translation.vector - a.translation.vector).norm();
            far += part * (straight + Turn::shortest(a, b).angle * self.body.reach);
        }
        far
    }
}

/// The way between two rows.
pub(super) struct Edge<'e> {
    case: &'e Case,
    from: &'e Moment,
    way: Way,
    /// How far the origin of the root moves in all, at most (m).
    straight: f64,
    /// How far the root turns in all, at most (rad).
    turn: f64,
    /// How far each joint number moves in all, at most.
    joints: Vec<f64>,
    /// The time (s) it takes.
    pub(super) duration: f64,
    /// Whether there are two shortest ways, so that either may be meant.
    pub(super) ambiguous: bool,
}

/// How the robot goes.
enum Way {
    /// Evenly to another place, with differences of joints.
    Even { to: Isometry3<f64>, turn: Turn, joints: Vec<f64> },
    /// As a car or unicycle: states x, y, angle at even distances in time, and speed and turning rate.
    Wheels { knots: Vec<[f64; 3]>, speed: f64, rate: f64 },
    /// Each degree of freedom by velocity and acceleration.
    Rates { velocity: Vec<f64>, acceleration: Vec<f64> },
}

/// Angles nearer to half a turn than this have two shortest ways, rad.
const HALF_TURN: f64 = 1e-6;
/// A step of the integration turns a robot on wheels by no more, rad.
const STEP: f64 = 0.01;

impl<'e> Edge<'e> {
    /// The way from `from` to `to` that path files mean; `other_way` for the other one where there are two
    /// shortest ways.
    pub(super) fn new(case: &'e Case, from: &'e Moment, to: &Row<'_>, other_way: bool) -> Self {
        match &case.drive {
            None => Self::even(case, from, &to.moment, other_way),
            Some(drive) => Self::driven(case, from, drive, to),
        }
    }

    fn even(case: &'e Case, from: &'e Moment, to: &Moment, other_way: bool) -> Self {
        let mut turn = Turn::shortest(&from.root, &to.root);
        let mut ambiguous = turn.angle > PI - HALF_TURN;
        if other_way && ambiguous {
            turn = turn.reversed();
        }
        let circle = |i: usize| matches!(&case.moves, Moves::Tree(tree) if tree.circles[i]);
        let mut joints = Vec::new();
        for (i, (a, b)) in from.joints.iter().zip(&to.joints).enumerate() {
            let mut difference = if circle(i) { wrapped(b - a) } else { b - a };
            if circle(i) && difference.abs() > PI - HALF_TURN {
                ambiguous = true;
                if other_way {
                    difference -= TAU.copysign(difference);
                }
            }
            joints.push(difference);
        }
        Self {
            case,
            from,
            straight: (to.root.translation.vector - from.root.translation.vector).norm(),
            turn: turn.angle.abs(),
            joints: joints.iter().map(|d| d.abs()).collect(),
            duration: to.time - from.time,
            ambiguous,
            way: Way::Even { to: to.root, turn, joints },
        }
    }

    fn driven(case: &'e Case, from: &'e Moment, drive: &Drive, to: &Row<'_>) -> Self {
        let (input, time) = (to.input, to.duration);
        let edge = |way, straight, turn, joints| Self {
            case,
            from,
            way,
            straight,
            turn,
            joints,
            duration: time,
            ambiguous: false,
        };
        let rate = match drive.kind {
            DriveKind::Car(wheelbase) => input[0] * input[1].tan() / wheelbase,
            DriveKind::Unicycle => input[1],
            DriveKind::Velocities | DriveKind::Accelerations => {
                let zeros = vec![0.0; input.len()];
                let (velocity, acceleration) = match drive.kind {
                    DriveKind::Accelerations => (from.velocities.clone(), input.to_vec()),
                    _ => (input.to_vec(), zeros),
                };
                let most = |(v, a): (&f64, &f64)| v.abs().max((v + a * time).abs()) * time;
                let far: Vec<f64> = velocity.iter().zip(&acceleration).map(most).collect();
                let norm = |part: &[f64]| part.iter().map(|x| x * x).sum::<f64>().sqrt();
                let (straight, turn, joints) = match &case.moves {
                    Moves::Point => (norm(&far), 0.0, Vec::new()),
                    Moves::Plane => (norm(&far[..2]), far[2], Vec::new()),
                    Moves::Space => (norm(&far[..3]), norm(&far[3..]), Vec::new()),
                    Moves::Tree(_) => (0.0, 0.0, far),
                };
                return edge(Way::Rates { velocity, acceleration }, straight, turn, joints);
            }
        };
        let steps = ((rate * time).abs() / STEP).ceil().clamp(1.0, 1e6) as usize;
        let mut state = [from.root.translation.x, from.root.translation.y, angle_of(&from.root)];
        let mut knots = vec![state];
        for _ in 0..steps {
            state = wheels(state, input[0], rate, time / steps as f64);
            knots.push(state);
        }
        let straight = (input[0] * time).abs();
        edge(Way::Wheels { knots, speed: input[0], rate }, straight, (rate * time).abs(), Vec::new())
    }

    /// Where everything is at the part `t` of the way.
    pub(super) fn at(&self, t: f64) -> Moment {
        let (from, time) = (self.from, t * self.duration);
        let mut moment = Moment { time: from.time + time, ..from.clone() };
        match &self.way {
            Way::Even { to, turn, joints } => {
                moment.root = between(&from.root, to, turn, t);
                moment.joints = from.joints.iter().zip(joints).map(|(q, d)| q + d * t).collect();
            }
            Way::Wheels { knots, speed, rate } => {
                let steps = knots.len() - 1;
                let knot = ((t * steps as f64) as usize).min(steps);
                let rest = (t - knot as f64 / steps as f64) * self.duration;
                let [x, y, angle] = wheels(knots[knot], *speed, *rate, rest);
                moment.root = pose(&[x, y, 0.0, angle, 0.0, 0.0]);
            }
            Way::Rates { velocity, acceleration } => {
                let rates = || velocity.iter().zip(acceleration);
                let moved: Vec<f64> = rates().map(|(v, a)| time * v + 0.5 * time * time * a).collect();
                let place = from.root.translation.vector;
                match &self.case.moves {
                    Moves::Tree(_) => {
                        moment.joints = from.joints.iter().zip(&moved).map(|(q, d)| q + d).collect();
                    }
                    Moves::Point => {
                        moment.root.translation.vector = place + Vector3::new(moved[0], moved[1], 0.0)
                    }
                    Moves::Plane => {
                        let angle = angle_of(&from.root) + moved[2];
                        moment.root = pose(&[place.x + moved[0], place.y + moved[1], 0.0, angle, 0.0, 0.0]);
                    }
                    Moves::Space => {
                        let turn =
                            UnitQuaternion::from_scaled_axis(Vector3::new(moved[3], moved[4], moved[5]));
                        let place = place + Vector3::new(moved[0], moved[1], moved[2]);
                        moment.root =
                            Isometry3::from_parts(Translation3::from(place), turn * from.root.rotation);
                    }
                }
                if !moment.velocities.is_empty() {
                    moment.velocities = rates().map(|(v, a)| v + time * a).collect();
                }
            }
        }
        moment
    }

    /// An upper bound on how far any point of a body of the robot moves (m) in the whole way.
    pub(super) fn travel(&self, body: usize) -> f64 {
        let body = &self.case.robot[body];
        let Moves::Tree(tree) = &self.case.moves else { return self.straight + self.turn * body.reach };
        // From the body upward: how far it reaches from each joint above it.
        let (mut frame, mut reach, mut far) = (body.frame, body.reach, 0.0);
        while frame > 0 {
            let joint = &tree.joints[frame - 1];
            if let Some((i, factor, _)) = joint.number {
                far += factor.abs() * self.joints[i] * if joint.slides { 1.0 } else { reach };
            }
            reach += joint.origin.translation.vector.norm() + if joint.slides { joint.farthest } else { 0.0 };
            frame = joint.above;
        }
        far + self.straight + self.turn * reach
    }
}

/// The angle of a pose in the plane.
pub(super) fn angle_of(pose: &Isometry3<f64>) -> f64 {
    2.0 * pose.rotation.k.atan2(pose.rotation.w)
}

/// One step of Runge and Kutta's method of order four: x' = v cos a, y' = v sin a, a' = w.
fn wheels([x, y, angle]: [f64; 3], speed: f64, rate: f64, time: f64) -> [f64; 3] {
    let slope = |at: f64| (speed * (angle + rate * at).cos(), speed * (angle + rate * at).sin());
    let (begin, middle, end) = (slope(0.0), slope(0.5 * time), slope(time));
    let mean = |a: f64, b: f64, c: f64| (a + 4.0 * b + c) / 6.0 * time;
    [x + mean(begin.0, middle.0, end.0), y + mean(begin.1, middle.1, end.1), angle + rate * time]
}

impl Edge<'_> {
    /// How long it is, where a radian counts as half a metre (m).
    pub(super) fn metric(&self) -> f64 {
        self.straight + 0.5 * self.turn
    }
}
