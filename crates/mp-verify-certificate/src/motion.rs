//! Where the bodies are along an edge of the path, and how far they go.

use crate::file::{Body, By, Frame, Model, Step};
use parry3d_f64::math::{Pose3 as Pose, Rot3 as Turn, Vec3};
use std::f64::consts::{PI, TAU};

/// An edge: the motion from one row of the path to the next.
pub(crate) struct Edge<'c> {
    model: &'c Model,
    from: &'c [f64],
    to: &'c [f64],
    /// The polynomial of each column, if the edge is not straight.
    curve: Option<&'c [[f64; 6]]>,
    /// How long it takes (s), if the rows say so.
    duration: f64,
    /// How far each frame goes in its parent over the whole edge, at most.
    ways: Vec<Way>,
}

/// How far a frame goes: metres and radians.
#[derive(Clone, Copy, Debug, Default)]
struct Way {
    slide: f64,
    turn: f64,
}

impl<'c> Edge<'c> {
    pub(crate) fn new(
        model: &'c Model,
        from: &'c [f64],
        to: &'c [f64],
        curve: Option<&'c [[f64; 6]]>,
    ) -> Result<Self, String> {
        let duration = match (&model.drive, model.time) {
            (Some(drive), _) => to[drive.duration],
            (None, Some(time)) => to[time] - from[time],
            (None, None) => 0.0,
        };
        if duration < 0.0 || (duration == 0.0 && model.time.is_some() && from != to) {
            return Err("time does not go forward".to_owned());
        }
        let mut edge = Self { model, from, to, curve, duration, ways: Vec::new() };
        if curve.is_some() {
            return Ok(edge);
        }
        edge.ways = model.frames.iter().map(|frame| edge.way(frame)).collect::<Result<_, _>>()?;
        Ok(edge)
    }

    /// How far a frame goes in its parent from the middle of a part of the edge to anywhere in it.
    fn way_in(&self, frame: usize, [begin, end]: [f64; 2]) -> Way {
        let half = 0.5 * (end - begin);
        let Some(curve) = self.curve else {
            let Way { slide, turn } = self.ways[frame];
            return Way { slide: half * slide, turn: half * turn };
        };
        let far = |column: usize| swing(&curve[column], 0.5 * (begin + end), half);
        match &self.model.frames[frame] {
            Frame::Fixed { .. } | Frame::Joint { column: None, .. } => Way::default(),
            Frame::Joint { slides: true, column: Some(column), factor, .. } => {
                Way { slide: far(*column) * factor.abs(), turn: 0.0 }
            }
            Frame::Joint { column: Some(column), factor, .. } => {
                Way { slide: 0.0, turn: far(*column) * factor.abs() }
            }
            Frame::Plane { first, yaw } => {
                Way { slide: far(*first).hypot(far(first + 1)), turn: yaw.map_or(0.0, far) }
            }
            // Such frames have no curves.
            Frame::Pose { .. } | Frame::Track { .. } => Way { slide: f64::INFINITY, turn: f64::INFINITY },
        }
    }

    fn way(&self, frame: &Frame) -> Result<Way, String> {
        Ok(match frame {
            Frame::Fixed { .. } | Frame::Track { .. } => Way::default(),
            Frame::Joint { column: None, .. } => Way::default(),
            Frame::Joint { slides, column: Some(column), factor, .. } => {
                let far = self.far(*column)? * factor.abs();
                if *slides { Way { slide: far, turn: 0.0 } } else { Way { slide: 0.0, turn: far } }
            }
            Frame::Plane { first, yaw } => {
                let turn = yaw.map_or(Ok(0.0), |yaw| self.far(yaw))?;
                Way { slide: self.far(*first)?.hypot(self.far(first + 1)?), turn }
            }
            Frame::Pose { first } if self.model.drive.is_some() => {
                let far = (0..6).map(|i| self.far(first + i)).collect::<Result<Vec<_>, _>>()?;
                let norm = |part: &[f64]| part.iter().map(|x| x * x).sum::<f64>().sqrt();
                Way { slide: norm(&far[..3]), turn: norm(&far[3..]) }
            }
            Frame::Pose { first } => {
                let [a, b] = [self.from, self.to].map(|row| six(row, *first));
                let turn = shortest(&a, &b)?.length();
                Way { slide: (b.translation - a.translation).length(), turn }
            }
        })
    }

    /// How far a column goes at most: the greatest rate times the time, or straight.
    fn far(&self, column: usize) -> Result<f64, String> {
        let (model, from, to) = (self.model, self.from, self.to);
        let Some(drive) = &model.drive else {
            let straight = to[column] - from[column];
            return match model.steps.iter().any(|step| matches!(step, Step::Circle(i) if *i == column)) {
                true => around(straight).map(f64::abs),
                false => Ok(straight.abs()),
            };
        };
        let input = &to[drive.inputs..drive.duration];
        // Which degree of freedom the column is: time is none.
        let degree = column - usize::from(model.time.is_some_and(|time| time < column));
        let rate = match drive.by {
            By::Car { wheelbase } => [input[0], 0.0, input[0] * input[1].tan() / wheelbase][degree].abs(),
            By::Unicycle => [input[0], 0.0, input[1]][degree].abs(),
            By::Velocities => input[degree].abs(),
            By::Accelerations => {
                let before = from[drive.velocities + degree];
                before.abs().max((before + input[degree] * self.duration).abs())
            }
        };
        Ok(rate * self.duration)
    }

    /// The configuration at the part `t` of the edge, from 0 to 1: the numbers, and the poses that stand for
    /// six of them.
    fn moment(&self, t: f64) -> (Vec<f64>, Vec<(usize, Pose)>) {
        let (model, from, to) = (self.model, self.from, self.to);
        let (mut row, mut poses) = (from.to_vec(), Vec::new());
        if let Some(curve) = self.curve {
            let value = |[a, b, c, d, e, f]: &[f64; 6]| a + t * (b + t * (c + t * (d + t * (e + t * f))));
            return (curve.iter().map(value).collect(), poses);
        }
        let after = t * self.duration;
        if let Some(time) = model.time {
            row[time] += after;
        }
        let Some(drive) = &model.drive else {
            for step in &model.steps {
                match *step {
                    Step::Line(i) => row[i] += t * (to[i] - from[i]),
                    Step::Circle(i) => row[i] += t * around(to[i] - from[i]).unwrap_or(0.0),
                    Step::Pose(first) => {
                        let [a, b] = [from, to].map(|row| six(row, first));
                        let turn = Turn::from_scaled_axis(t * shortest(&a, &b).unwrap_or(Vec3::ZERO));
                        let place = a.translation + t * (b.translation - a.translation);
                        poses.push((first, Pose::from_parts(place, turn * a.rotation)));
                    }
                }
            }
            return (row, poses);
        };
        let input = &to[drive.inputs..drive.duration];
        let by: Vec<f64> = match drive.by {
            By::Car { wheelbase } => {
                wheels(from, input[0], input[0] * input[1].tan() / wheelbase, after).into()
            }
            By::Unicycle => wheels(from, input[0], input[1], after).into(),
            By::Velocities => input.iter().map(|u| u * after).collect(),
            By::Accelerations => {
                let velocity = &from[drive.velocities..];
                let by = velocity.iter().zip(input).map(|(v, a)| v * after + 0.5 * a * after * after);
                by.collect()
            }
        };
        let mut by = by.into_iter();
        let mut next = || by.next().unwrap_or(f64::NAN);
        for step in &model.steps {
            match *step {
                Step::Line(i) | Step::Circle(i) => row[i] += next(),
                Step::Pose(first) => {
                    let a = six(from, first);
                    let [slide, turn] = [(); 2].map(|()| Vec3::new(next(), next(), next()));
                    let turn = Turn::from_scaled_axis(turn) * a.rotation;
                    poses.push((first, Pose::from_parts(a.translation + slide, turn)));
                }
            }
        }
        (row, poses)
    }

    /// The poses of all frames in the world at the part `t` of the edge.
    pub(crate) fn frames(&self, t: f64) -> Vec<Pose> {
        let (row, turned) = self.moment(t);
        let mut poses: Vec<Pose> = Vec::with_capacity(self.model.frames.len());
        for frame in &self.model.frames {
            let above = frame.parent().map_or(Pose::IDENTITY, |parent| poses[parent]);
            poses.push(match frame {
                Frame::Fixed { pose, .. } => above * seven(pose),
                Frame::Pose { first } => {
                    let is_it = |pose: &&(usize, Pose)| pose.0 == *first;
                    turned.iter().find(is_it).map_or(Pose::IDENTITY, |pose| pose.1)
                }
                Frame::Plane { first, yaw } => {
                    let place = Vec3::new(row[*first], row[first + 1], 0.0);
                    Pose::from_parts(place, Turn::from_rotation_z(yaw.map_or(0.0, |yaw| row[yaw])))
                }
                Frame::Joint { origin, axis, slides, column, factor, offset, .. } => {
                    let value = column.map_or(0.0, |column| row[column]) * factor + offset;
                    let by = Vec3::from_array(*axis) * value;
                    let moved = match slides {
                        true => Pose::from_translation(by),
                        false => Pose::from_rotation(Turn::from_scaled_axis(by)),
                    };
                    above * seven(origin) * moved
                }
                Frame::Track { time, poses } => track(poses, row[*time]),
            });
        }
        poses
    }

    /// How much nearer (m) two bodies in balls come at most than they are in the middle of the part from
    /// `begin` to `end` of the edge, where the frames are at `frames`.
    pub(crate) fn nearing(&self, a: &Ball, b: &Ball, frames: &[Pose], [begin, end]: [f64; 2]) -> f64 {
        let chain = |ball: &Ball| -> Vec<usize> {
            std::iter::successors(Some(ball.frame), |i| self.model.frames[*i].parent()).collect()
        };
        let (mut up_a, mut up_b) = (chain(a), chain(b));
        // What moves both moves neither relative to the other.
        while up_a.last().is_some() && up_a.last() == up_b.last() {
            up_a.pop();
            up_b.pop();
        }
        self.strays(a, &up_a, frames, [begin, end]) + self.strays(b, &up_b, frames, [begin, end])
    }

    /// How far `frames_above` move a point of a body away from where it is in the middle, at most. Let them
    /// move one after the other, the nearest to the body first: each finds the point where the ones before
    /// have brought it.
    fn strays(&self, ball: &Ball, frames_above: &[usize], frames: &[Pose], [begin, end]: [f64; 2]) -> f64 {
        let half = 0.5 * (end - begin);
        let center = frames[ball.frame].transform_point(ball.center);
        let mut strayed = 0.0;
        for &i in frames_above {
            let Way { slide, turn } = self.way_in(i, [begin, end]);
            let to_center = center - frames[i].translation;
            let lever = match &self.model.frames[i] {
                Frame::Fixed { .. } => 0.0,
                Frame::Pose { .. } => to_center.length(),
                Frame::Plane { .. } => to_center.x.hypot(to_center.y),
                Frame::Joint { axis, .. } => {
                    to_center.cross(frames[i].rotation * Vec3::from_array(*axis)).length()
                }
                Frame::Track { time, poses } => {
                    let at = |t: f64| self.from[*time] + t * self.duration;
                    strayed += half * self.duration * fastest(poses, ball.reach, [at(begin), at(end)]);
                    continue;
                }
            };
            strayed += slide + turn * (lever + ball.radius + strayed);
        }
        strayed
    }

    /// How far the row that follows is from where the edge leads: metres, of any point of the robot; and the
    /// velocities and the time.
    pub(crate) fn jump(&self) -> f64 {
        let (arrived, mut start) = (self.frames(1.0), self.to.to_vec());
        if let Some(drive) = &self.model.drive {
            start[drive.duration] = 0.0;
        }
        let Ok(there) = Edge::new(self.model, &start, &start, None) else { return f64::INFINITY };
        let there = there.frames(0.0);
        let off = self.model.bodies.iter().filter(|body| body.of_robot).flat_map(|body| {
            let [a, b] = [&arrived, &there].map(|frames| frames[body.frame]);
            let at = move |v: &[f64; 3]| Vec3::from_array(*v);
            body.vertices.iter().map(move |v| (a.transform_point(at(v)) - b.transform_point(at(v))).length())
        });
        let velocities = self.model.drive.iter().flat_map(|drive| {
            (drive.velocities..drive.inputs).map(|i| {
                let after = self.from[i] + self.duration * self.to[drive.inputs + i - drive.velocities];
                (after - self.to[i]).abs()
            })
        });
        let late = self.model.time.map(|time| (self.from[time] + self.duration - self.to[time]).abs());
        off.chain(velocities).chain(late).fold(0.0, f64::max)
    }
}

/// A ball around a body.
pub(crate) struct Ball {
    frame: usize,
    /// Its middle in the frame.
    center: Vec3,
    radius: f64,
    /// How far the body reaches from the origin of the frame.
    reach: f64,
}

impl Ball {
    pub(crate) fn new(body: &Body) -> Self {
        let points = || body.vertices.iter().map(|v| Vec3::from_array(*v));
        let low = points().fold(Vec3::INFINITY, Vec3::min);
        let high = points().fold(Vec3::NEG_INFINITY, Vec3::max);
        let center = 0.5 * (low + high);
        let from = |origin: Vec3| points().map(|p| (p - origin).length()).fold(0.0, f64::max) + body.radius;
        Self { frame: body.frame, center, radius: from(center), reach: from(Vec3::ZERO) }
    }
}

/// The pose of x, y, z, α, β, γ: Rz(α)·Ry(β)·Rx(γ).
fn six(row: &[f64], first: usize) -> Pose {
    let [x, y, z, alpha, beta, gamma] = std::array::from_fn(|i| row[first + i]);
    let turn = Turn::from_rotation_z(alpha) * Turn::from_rotation_y(beta) * Turn::from_rotation_x(gamma);
    Pose::from_parts(Vec3::new(x, y, z), turn)
}

/// The pose of x, y, z, i, j, k, w.
fn seven(&[x, y, z, i, j, k, w]: &[f64; 7]) -> Pose {
    Pose::from_parts(Vec3::new(x, y, z), Turn::from_xyzw(i, j, k, w).normalize())
}

/// The shortest turn from one pose to another, in the world: the axis times the angle.
fn shortest(a: &Pose, b: &Pose) -> Result<Vec3, String> {
    let mut by = b.rotation * a.rotation.inverse();
    if by.w < 0.0 {
        by = -by;
    }
    let sine = Vec3::new(by.x, by.y, by.z);
    let angle = 2.0 * sine.length().atan2(by.w);
    around(angle)?;
    Ok(sine.try_normalize().map_or(Vec3::ZERO, |axis| axis * angle))
}

/// How far a polynomial is from its value at `middle` within `half`, at most: its derivatives there, each times the power of `half`
/// over the factorial that it has in Taylor's formula.
fn swing(coefficients: &[f64; 6], middle: f64, half: f64) -> f64 {
    let mut derivative = coefficients.to_vec();
    let (mut sum, mut weight) = (0.0, 1.0);
    for order in 1..6 {
        derivative = derivative.iter().enumerate().skip(1).map(|(i, c)| i as f64 * c).collect();
        weight *= half / f64::from(order);
        sum += weight * derivative.iter().rev().fold(0.0, |sum, c| sum * middle + c).abs();
    }
    sum
}

/// The shorter way round a circle.
fn around(angle: f64) -> Result<f64, String> {
    let angle = angle - TAU * (angle / TAU).round();
    match angle.abs() < PI - 1e-8 {
        true => Ok(angle),
        false => Err("the robot turns half way round, and nothing says which way".to_owned()),
    }
}

/// How x, y and yaw change on wheels, at a speed (m/s) and a rate (rad/s): along an arc.
fn wheels(from: &[f64], speed: f64, rate: f64, time: f64) -> [f64; 3] {
    let turn = rate * time;
    // The difference of sines over the turn, without dividing by what may be zero.
    let sinc = |x: f64| if x.abs() < 1e-5 { 1.0 - x * x / 6.0 } else { x.sin() / x };
    let (sin, cos) = (from[2] + 0.5 * turn).sin_cos();
    let chord = speed * time * sinc(0.5 * turn);
    [chord * cos, chord * sin, turn]
}

fn track(poses: &[[f64; 8]], time: f64) -> Pose {
    let pose = |row: &[f64; 8]| seven(&std::array::from_fn(|i| row[i + 1]));
    let (first, last) = (&poses[0], &poses[poses.len() - 1]);
    if time <= first[0] {
        return pose(first);
    }
    let Some(pair) = poses.windows(2).find(|pair| time < pair[1][0]) else { return pose(last) };
    let (a, b) = (pose(&pair[0]), pose(&pair[1]));
    let t = (time - pair[0][0]) / (pair[1][0] - pair[0][0]);
    let turn = Turn::from_scaled_axis(t * shortest(&a, &b).unwrap_or(Vec3::ZERO));
    Pose::from_parts(a.translation + t * (b.translation - a.translation), turn * a.rotation)
}

/// The greatest speed (m/s) on a track of what is within `radius` of its origin, between two times.
fn fastest(poses: &[[f64; 8]], radius: f64, [begin, end]: [f64; 2]) -> f64 {
    let pose = |row: &[f64; 8]| seven(&std::array::from_fn(|i| row[i + 1]));
    let met = poses.windows(2).filter(|pair| pair[0][0] <= end && pair[1][0] >= begin);
    let speed = met.map(|pair| {
        let (a, b) = (pose(&pair[0]), pose(&pair[1]));
        let turn = shortest(&a, &b).map_or(f64::INFINITY, Vec3::length);
        ((b.translation - a.translation).length() + radius * turn) / (pair[1][0] - pair[0][0])
    });
    speed.fold(0.0, f64::max)
}
