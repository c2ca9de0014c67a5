//! Where the bodies of a model are along an edge, and how far they can move.

use crate::{DriveModel, ModelBody, ModelFrame, MotionModel, Step};
use mp_cspace::angle::{rotation_angle, slerp, wrap_angle};
use mp_geom::pose_from_six;
use mp_robot::Trajectory;
use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::PI;

/// Turns this near to half a turn (rad) could go either way.
const HALF_TURN: f64 = PI - 1e-7;

/// Bounds are enlarged by this factor: programs that replay them round in their own ways.
const ROUND_UP: f64 = 1.0 + 1e-6;

/// The motion from one row of a path to the next.
pub(super) struct Motion<'m> {
    model: &'m MotionModel,
    from: &'m [f64],
    to: &'m [f64],
    /// The polynomial of each column, if it is no straight motion.
    curve: Option<&'m [[f64; 6]]>,
    /// How far (m) each frame slides in its parent over the whole motion at most, and how far (rad) it turns.
    travels: Vec<[f64; 2]>,
    /// Of each frame that is a track.
    tracks: Vec<Option<Trajectory>>,
}

impl<'m> Motion<'m> {
    /// # Errors
    /// When the rows do not say which way the robot turns, or a number is not finite.
    pub(super) fn new(model: &'m MotionModel, from: &'m [f64], to: &'m [f64]) -> Result<Self, String> {
        let track = |frame: &ModelFrame| match frame {
            ModelFrame::Track { poses, .. } => {
                let pose = |row: &[f64; 8]| (row[0], isometry(std::array::from_fn(|i| row[i + 1])));
                Trajectory::new(poses.iter().map(pose)).map(Some).map_err(|e| e.to_string())
            }
            _ => Ok(None),
        };
        let tracks = model.frames.iter().map(track).collect::<Result<_, _>>()?;
        let mut motion = Self { model, from, to, curve: None, travels: Vec::new(), tracks };
        let rates = motion.rates()?;
        motion.travels = model.frames.iter().map(|frame| travel(frame, &rates)).collect();
        match motion.travels.iter().flatten().all(|x| x.is_finite()) {
            true => Ok(motion),
            false => Err("a number is not finite".to_owned()),
        }
    }

    /// The motion along the polynomials of a curve.
    ///
    /// # Errors
    /// When the robot has degrees of freedom that are no single numbers, moves by inputs or with time, or a number is not finite.
    pub(super) fn along(
        model: &'m MotionModel,
        from: &'m [f64],
        curve: &'m [[f64; 6]],
    ) -> Result<Self, String> {
        let single = model.steps.iter().all(|step| !matches!(step, Step::Pose(_)));
        if !single || model.drive.is_some() || model.time.is_some() || curve.len() != from.len() {
            return Err("there are no curves of such robots".to_owned());
        }
        if !curve.iter().flatten().all(|x| x.is_finite()) {
            return Err("a number is not finite".to_owned());
        }
        let tracks = model.frames.iter().map(|_| None).collect();
        Ok(Self { model, from, to: from, curve: Some(curve), travels: Vec::new(), tracks })
    }

    /// How far (m) a frame slides in its parent, and how far (rad) it turns, from the middle of a part of the motion to anywhere in it, at most.
    fn travelled(&self, frame: usize, [begin, end]: [f64; 2]) -> [f64; 2] {
        let half = 0.5 * (end - begin);
        let Some(curve) = self.curve else { return self.travels[frame].map(|travel| half * travel) };
        let rates: Vec<f64> = curve.iter().map(|c| strayed(c, 0.5 * (begin + end), half)).collect();
        travel(&self.model.frames[frame], &rates)
    }

    /// How long the motion takes, seconds; 0 if the rows do not say.
    fn duration(&self) -> f64 {
        match (&self.model.drive, self.model.time) {
            (Some(drive), _) => self.to[drive.duration],
            (None, Some(time)) => self.to[time] - self.from[time],
            (None, None) => 0.0,
        }
    }

    /// How far each column goes at most. Turns in space are three columns: their sum of squares counts.
    fn rates(&self) -> Result<Vec<f64>, String> {
        let (from, to) = (self.from, self.to);
        let mut rates = vec![0.0; from.len()];
        if let Some(drive) = &self.model.drive {
            let time = self.duration();
            let (velocity, input) = (&from[drive.velocities..], &to[drive.inputs..]);
            match drive.by {
                DriveModel::Car { wheelbase } => {
                    rates[0] = (input[0] * time).abs();
                    rates[2] = (input[0] * mp_math::tan(input[1]) / wheelbase * time).abs();
                }
                DriveModel::Unicycle => {
                    rates[0] = (input[0] * time).abs();
                    rates[2] = (input[1] * time).abs();
                }
                DriveModel::Velocities => {
                    self.columns().zip(input).for_each(|(i, u)| rates[i] = (u * time).abs());
                }
                DriveModel::Accelerations => {
                    let fastest = velocity.iter().zip(input).map(|(v, a)| v.abs().max((v + a * time).abs()));
                    self.columns().zip(fastest).for_each(|(i, v)| rates[i] = v * time);
                }
            }
            return Ok(rates);
        }
        for step in &self.model.steps {
            match *step {
                Step::Line(i) => rates[i] = (to[i] - from[i]).abs(),
                Step::Circle(i) => {
                    rates[i] = wrap_angle(to[i] - from[i]).abs();
                    if rates[i] > HALF_TURN {
                        return Err(HALF.to_owned());
                    }
                }
                Step::Pose(first) => {
                    let [a, b] = [from, to].map(|row| six(row, first));
                    (0..3).for_each(|i| rates[first + i] = (to[first + i] - from[first + i]).abs());
                    rates[first + 3] = rotation_angle(&a.rotation, &b.rotation);
                    if rates[first + 3] > HALF_TURN {
                        return Err(HALF.to_owned());
                    }
                }
            }
        }
        Ok(rates)
    }

    /// The columns of the degrees of freedom.
    fn columns(&self) -> impl Iterator<Item = usize> {
        self.model.steps.iter().flat_map(|step| match *step {
            Step::Pose(first) => first..first + 6,
            Step::Line(i) | Step::Circle(i) => i..i + 1,
        })
    }

    /// The row and the poses of steps that are poses at the part `t` of the motion, 0 to 1.
    fn row(&self, t: f64) -> (Vec<f64>, Vec<(usize, Isometry3<f64>)>) {
        let (from, to) = (self.from, self.to);
        let (mut row, mut poses) = (from.to_vec(), Vec::new());
        if let Some(curve) = self.curve {
            let value = |c: &[f64; 6]| c.iter().rev().fold(0.0, |sum, c| sum * t + c);
            return (curve.iter().map(value).collect(), poses);
        }
        if let Some(time) = self.model.time {
            row[time] = from[time] + t * self.duration();
        }
        let Some(drive) = &self.model.drive else {
            for step in &self.model.steps {
                match *step {
                    Step::Line(i) => row[i] = from[i] + t * (to[i] - from[i]),
                    Step::Circle(i) => row[i] = from[i] + t * wrap_angle(to[i] - from[i]),
                    Step::Pose(first) => {
                        let [a, b] = [from, to].map(|row| six(row, first));
                        let place = a.translation.vector.lerp(&b.translation.vector, t);
                        let turn = slerp(&a.rotation, &b.rotation, t);
                        poses.push((first, Isometry3::from_parts(place.into(), turn)));
                    }
                }
            }
            return (row, poses);
        };
        let time = t * self.duration();
        let (velocity, input) = (&from[drive.velocities..], &to[drive.inputs..]);
        let by = match drive.by {
            DriveModel::Car { wheelbase } => {
                arc(&mut row, input[0], input[0] * mp_math::tan(input[1]) / wheelbase, time);
                return (row, poses);
            }
            DriveModel::Unicycle => {
                arc(&mut row, input[0], input[1], time);
                return (row, poses);
            }
            DriveModel::Velocities => input.iter().map(|u| u * time).collect::<Vec<_>>(),
            DriveModel::Accelerations => {
                velocity.iter().zip(input).map(|(v, a)| (v + 0.5 * time * a) * time).collect()
            }
        };
        let mut by = by.into_iter();
        let mut next = || by.next().unwrap_or(0.0);
        for step in &self.model.steps {
            match *step {
                Step::Line(i) | Step::Circle(i) => row[i] += next(),
                Step::Pose(first) => {
                    let a = six(from, first);
                    let [slide, turn] = std::array::from_fn(|_| Vector3::new(next(), next(), next()));
                    let place = a.translation.vector + slide;
                    let turned = UnitQuaternion::from_scaled_axis(turn) * a.rotation;
                    poses.push((first, Isometry3::from_parts(place.into(), turned)));
                }
            }
        }
        (row, poses)
    }

    /// The poses of the frames in the world at the part `t` of the motion; `None` for a model whose frames are out of order.
    pub(super) fn frames(&self, t: f64) -> Option<Vec<Isometry3<f64>>> {
        let (row, poses) = self.row(t);
        let mut out: Vec<Isometry3<f64>> = Vec::with_capacity(self.model.frames.len());
        for (frame, track) in self.model.frames.iter().zip(&self.tracks) {
            let above = |parent: &usize| out.get(*parent).copied();
            let pose = match frame {
                ModelFrame::Fixed { parent: None, pose } => isometry(*pose),
                ModelFrame::Fixed { parent: Some(parent), pose } => above(parent)? * isometry(*pose),
                ModelFrame::Pose { first } => poses.iter().find(|(i, _)| i == first)?.1,
                ModelFrame::Plane { first, yaw } => {
                    let turn = yaw.map_or(0.0, |yaw| row[yaw]);
                    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
                    Isometry3::from_parts(Translation3::new(row[*first], row[first + 1], 0.0), turn)
                }
                ModelFrame::Joint { parent, origin, axis, slides, column, factor, offset } => {
                    let value = column.map_or(0.0, |column| row[column]) * factor + offset;
                    let by = Vector3::from(*axis) * value;
                    let moved = match slides {
                        true => Isometry3::translation(by.x, by.y, by.z),
                        false => Isometry3::from_parts(
                            Translation3::identity(),
                            UnitQuaternion::from_scaled_axis(by),
                        ),
                    };
                    above(parent)? * isometry(*origin) * moved
                }
                ModelFrame::Track { time, .. } => track.as_ref()?.pose(row[*time]),
            };
            out.push(pose);
        }
        Some(out)
    }

    /// The poses of the bodies.
    pub(super) fn poses(&self, t: f64) -> Option<Vec<Isometry3<f64>>> {
        let frames = self.frames(t)?;
        self.model.bodies.iter().map(|body| frames.get(body.frame).copied()).collect()
    }

    /// A bound (m) on how much nearer two bodies come, from their places at `frames` in the middle of the part of the motion between
    /// `ends`, until anywhere in it.
    pub(super) fn bound(
        &self,
        a: &ModelBody,
        b: &ModelBody,
        frames: &[Isometry3<f64>],
        ends: [f64; 2],
    ) -> f64 {
        let on_b: Vec<usize> = self.above(b.frame).collect();
        let meet = self.above(a.frame).find(|frame| on_b.contains(frame));
        (self.moved(a, meet, frames, ends) + self.moved(b, meet, frames, ends)) * ROUND_UP
    }

    fn above(&self, frame: usize) -> impl Iterator<Item = usize> {
        let parent = |frame: &usize| match self.model.frames.get(*frame)? {
            ModelFrame::Fixed { parent, .. } => *parent,
            ModelFrame::Joint { parent, .. } => Some(*parent),
            _ => None,
        };
        std::iter::successors(Some(frame), parent)
    }

    /// A bound (m) on how far the frames below `stop` move a point of a body.
    ///
    /// A frame that turns moves a point by at most the angle times its distance from the axis: the one at `frames`, plus how far the
    /// frames nearer to the body have moved it.
    fn moved(
        &self,
        body: &ModelBody,
        stop: Option<usize>,
        frames: &[Isometry3<f64>],
        [begin, end]: [f64; 2],
    ) -> f64 {
        let half = 0.5 * (end - begin);
        let (center, radius) = body.ball();
        let center = frames[body.frame] * center;
        let mut moved = 0.0;
        for i in self.above(body.frame).take_while(|frame| Some(*frame) != stop) {
            let [slide, turn] = self.travelled(i, [begin, end]);
            let origin = Point3::from(frames[i].translation.vector);
            let from_axis = match &self.model.frames[i] {
                ModelFrame::Fixed { .. } => continue,
                ModelFrame::Pose { .. } => (center - origin).norm(),
                ModelFrame::Plane { .. } => (center - origin).xy().norm(),
                ModelFrame::Joint { axis, .. } => {
                    (center - origin).cross(&(frames[i].rotation * Vector3::from(*axis))).norm()
                }
                ModelFrame::Track { time, .. } => {
                    let at = |t: f64| self.from[*time] + t * self.duration();
                    let far = body.vertices.iter().map(|v| Vector3::from(*v).norm()).fold(0.0, f64::max);
                    let speed = self.tracks[i]
                        .as_ref()
                        .map_or(f64::INFINITY, |track| track.speed(far + body.radius, at(begin), at(end)));
                    moved += half * self.duration() * speed;
                    continue;
                }
            };
            moved += slide + turn * (from_axis + radius + moved);
        }
        moved
    }
}

/// How far (m) a frame slides in its parent and how far (rad) it turns, where each column goes so far.
fn travel(frame: &ModelFrame, rates: &[f64]) -> [f64; 2] {
    match frame {
        ModelFrame::Fixed { .. } | ModelFrame::Track { .. } => [0.0; 2],
        ModelFrame::Pose { first } => {
            let norm = |i: usize| rates[i..i + 3].iter().map(|r| r * r).sum::<f64>().sqrt();
            [norm(*first), norm(first + 3)]
        }
        ModelFrame::Plane { first, yaw } => {
            [mp_math::hypot(rates[*first], rates[first + 1]), yaw.map_or(0.0, |yaw| rates[yaw])]
        }
        ModelFrame::Joint { slides, column, factor, .. } => {
            let travel = column.map_or(0.0, |column| rates[column] * factor.abs());
            if *slides { [travel, 0.0] } else { [0.0, travel] }
        }
    }
}

/// How far a polynomial goes from its value at `middle` within `half`, at most: the sum of the terms of its Taylor series there.
fn strayed(c: &[f64; 6], middle: f64, half: f64) -> f64 {
    let (mut shifted, mut sum, mut power) = (*c, 0.0, 1.0);
    // Each round of Horner's scheme leaves one more coefficient at the middle.
    for k in 0..6 {
        for i in (k..5).rev() {
            shifted[i] += middle * shifted[i + 1];
        }
        if k > 0 {
            power *= half;
            sum += shifted[k].abs() * power;
        }
    }
    sum
}

/// What is wrong with half a turn.
const HALF: &str = "the robot turns half way round, and the path does not say which way";

/// The pose of six columns.
fn six(row: &[f64], first: usize) -> Isometry3<f64> {
    pose_from_six(std::array::from_fn(|i| row[first + i]))
}

/// The pose of seven numbers.
fn isometry([x, y, z, i, j, k, w]: [f64; 7]) -> Isometry3<f64> {
    let turn = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
    Isometry3::from_parts(Translation3::new(x, y, z), turn)
}

/// Moves x, y, yaw at the front of a row at `speed` (m/s) while they turn at `rate` (rad/s) for `time` seconds.
fn arc(row: &mut [f64], speed: f64, rate: f64, time: f64) {
    let half = 0.5 * rate * time;
    let chord =
        speed * time * if half.abs() < 1e-4 { 1.0 - half * half / 6.0 } else { mp_math::sin(half) / half };
    let (s, c) = mp_math::sin_cos(row[2] + half);
    row[0] += chord * c;
    row[1] += chord * s;
    row[2] += rate * time;
}
