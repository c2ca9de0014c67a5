//! A trajectory, and the curve between its points.

use crate::TimeError;
use crate::polynomial::{Polynomial, derivative, extremes, range, value};
use mp_cspace::Curve;
use std::fmt;

/// The curve that a controller runs between two points. `joint_trajectory_controller` of ROS takes the highest for which both points have
/// the numbers: [`Trajectory::of_controller`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// Even motion from position to position.
    Linear,
    /// The cubic polynomial that has positions and velocities of both points.
    Cubic,
    /// The polynomial of degree five that has positions, velocities and accelerations of both points.
    Quintic,
}

impl fmt::Display for Interpolation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Linear => "linear",
            Self::Cubic => "cubic",
            Self::Quintic => "quintic",
        })
    }
}

/// The numbers of a trajectory: a row for each point, in which there is a number for each joint (rad or m, and these per s and s²).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Knots {
    /// The time (s) of each point.
    pub times: Vec<f64>,
    /// The positions of each point.
    pub positions: Vec<Vec<f64>>,
    /// The velocities; empty if they are not known.
    pub velocities: Vec<Vec<f64>>,
    /// The accelerations; empty if they are not known.
    pub accelerations: Vec<Vec<f64>>,
}

/// Where a trajectory is at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// The position of each joint.
    pub position: Vec<f64>,
    /// The velocity of each joint.
    pub velocity: Vec<f64>,
    /// The acceleration of each joint; at a point that of the piece behind it.
    pub acceleration: Vec<f64>,
}

/// The largest or the least amount of a number along a trajectory, and when it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme {
    /// The amount; of velocities and accelerations without the sign.
    pub amount: f64,
    /// When the number has this amount (s).
    pub time: f64,
}

/// The motion of joints over time: points, and the curve between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    joints: Vec<[String; 2]>,
    knots: Knots,
    interpolation: Interpolation,
}

impl Trajectory {
    /// A trajectory of joints, each with its name and its unit (`rad` or `m`).
    ///
    /// # Errors
    /// When there is no point, times do not increase, a row does not have a number for each joint, a number is not finite, or the curve
    /// needs velocities or accelerations that are not there.
    pub fn new<'n>(
        joints: impl IntoIterator<Item = (&'n str, &'n str)>,
        knots: Knots,
        interpolation: Interpolation,
    ) -> Result<Self, TimeError> {
        let joints: Vec<_> =
            joints.into_iter().map(|(name, unit)| [name.to_owned(), unit.to_owned()]).collect();
        let points = knots.times.len();
        if points == 0 {
            return Err(TimeError::TooFew { found: 0, least: 1 });
        }
        let lists = [
            ("rows of positions", &knots.positions, true, ""),
            ("rows of velocities", &knots.velocities, interpolation != Interpolation::Linear, "velocities"),
            (
                "rows of accelerations",
                &knots.accelerations,
                interpolation == Interpolation::Quintic,
                "accelerations",
            ),
        ];
        for (what, rows, needed, missing) in lists {
            if rows.is_empty() && !missing.is_empty() {
                if needed {
                    return Err(TimeError::Missing { curve: interpolation, what: missing });
                }
                continue;
            }
            if rows.len() != points {
                return Err(TimeError::Count { what, expected: points, found: rows.len() });
            }
            if let Some(row) = rows.iter().find(|row| row.len() != joints.len()) {
                let (expected, found) = (joints.len(), row.len());
                return Err(TimeError::Count { what: "numbers of a point", expected, found });
            }
            if let Some(point) = rows.iter().position(|row| !row.iter().all(|x| x.is_finite())) {
                return Err(TimeError::NotFinite { point });
            }
        }
        if let Some(point) = knots.times.iter().position(|t| !t.is_finite()) {
            return Err(TimeError::NotFinite { point });
        }
        if let Some(i) = knots.times.windows(2).position(|t| t[1] <= t[0]) {
            return Err(TimeError::Times { point: i + 1, time: knots.times[i + 1], before: knots.times[i] });
        }
        Ok(Self { joints, knots, interpolation })
    }

    /// As [`new`](Self::new), with the curve that `joint_trajectory_controller` of ROS runs: quintic where accelerations are known, else
    /// cubic where velocities are, else linear.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of_controller<'n>(
        joints: impl IntoIterator<Item = (&'n str, &'n str)>,
        knots: Knots,
    ) -> Result<Self, TimeError> {
        let curve = match (knots.velocities.is_empty(), knots.accelerations.is_empty()) {
            (true, _) => Interpolation::Linear,
            (false, true) => Interpolation::Cubic,
            (false, false) => Interpolation::Quintic,
        };
        Self::new(joints, knots, curve)
    }

    /// Name and unit of each joint.
    pub fn joints(&self) -> impl ExactSizeIterator<Item = (&str, &str)> {
        self.joints.iter().map(|[name, unit]| (name.as_str(), unit.as_str()))
    }

    /// The points.
    #[must_use]
    pub fn knots(&self) -> &Knots {
        &self.knots
    }

    /// The points, and nothing else.
    pub(crate) fn into_knots(self) -> Knots {
        self.knots
    }

    /// The curve between points.
    #[must_use]
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// The times (s) of the first and the last point.
    #[must_use]
    pub fn span(&self) -> [f64; 2] {
        [self.knots.times[0], self.knots.times[self.knots.times.len() - 1]]
    }

    /// How long it takes (s) from the first point to the last.
    #[must_use]
    pub fn duration(&self) -> f64 {
        let [first, last] = self.span();
        last - first
    }

    /// The piece that a time is in: the last one that begins by then.
    fn piece(&self, time: f64) -> usize {
        let behind = self.knots.times.partition_point(|t| *t <= time);
        behind.saturating_sub(1).min(self.knots.times.len().saturating_sub(2))
    }

    /// The polynomial of a joint over a piece, in seconds from the beginning of the piece.
    fn seconds(&self, piece: usize, joint: usize) -> Polynomial {
        let Knots { times, positions, velocities, accelerations } = &self.knots;
        let p = positions[piece][joint];
        if times.len() == 1 {
            return [p, 0.0, 0.0, 0.0, 0.0, 0.0];
        }
        let h = times[piece + 1] - times[piece];
        let slope = (positions[piece + 1][joint] - p) / h;
        let of = |rows: &[Vec<f64>]| [rows[piece][joint], rows[piece + 1][joint]];
        match self.interpolation {
            Interpolation::Linear => [p, slope, 0.0, 0.0, 0.0, 0.0],
            Interpolation::Cubic => {
                let [v, w] = of(velocities);
                [p, v, (3.0 * slope - 2.0 * v - w) / h, (v + w - 2.0 * slope) / (h * h), 0.0, 0.0]
            }
            Interpolation::Quintic => {
                let ([v, w], [a, b]) = (of(velocities), of(accelerations));
                let [ah, bh] = [0.5 * a * h, 0.5 * b * h];
                [
                    p,
                    v,
                    0.5 * a,
                    (10.0 * slope - 6.0 * v - 4.0 * w - 3.0 * ah + bh) / (h * h),
                    (-15.0 * slope + 8.0 * v + 7.0 * w + 3.0 * ah - 2.0 * bh) / (h * h * h),
                    (6.0 * slope - 3.0 * (v + w) - ah + bh) / (h * h * h * h),
                ]
            }
        }
    }

    /// Where it is at a time (s); before the first point and behind the last one where these are.
    #[must_use]
    pub fn at(&self, time: f64) -> Sample {
        let [first, last] = self.span();
        let time = time.clamp(first, last);
        let piece = self.piece(time);
        let x = time - self.knots.times[piece];
        let mut sample = Sample { position: Vec::new(), velocity: Vec::new(), acceleration: Vec::new() };
        let of_last = |rows: &[Vec<f64>]| rows.last().filter(|_| time == last).cloned();
        for joint in 0..self.joints.len() {
            let c = self.seconds(piece, joint);
            let v = derivative(&c);
            sample.position.push(value(&c, x));
            sample.velocity.push(value(&v, x));
            sample.acceleration.push(value(&derivative(&v), x));
        }
        // Rounding is no motion: what stands still at the end does so exactly.
        let Knots { positions, velocities, accelerations, .. } = &self.knots;
        sample.position = of_last(positions).unwrap_or(sample.position);
        if self.interpolation != Interpolation::Linear {
            sample.velocity = of_last(velocities).unwrap_or(sample.velocity);
        }
        if self.interpolation == Interpolation::Quintic {
            sample.acceleration = of_last(accelerations).unwrap_or(sample.acceleration);
        }
        sample
    }

    /// Between which values a joint stays from one time (s) to another: exact but for rounding, which is allowed for.
    #[must_use]
    pub fn range(&self, joint: usize, from: f64, to: f64) -> [f64; 2] {
        let (first, last) = (self.piece(from), self.piece(to));
        let piece = |i: usize| {
            let begin = self.knots.times[i];
            let end = self.knots.times.get(i + 1).map_or(0.0, |end| end - begin);
            range(&self.seconds(i, joint), (from - begin).clamp(0.0, end), (to - begin).clamp(0.0, end))
        };
        let all = (first..=last).map(piece);
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [l, h]| [low.min(l), high.max(h)])
    }

    /// The least and the largest value of a joint, signed, and when.
    #[must_use]
    pub fn extremes(&self, joint: usize) -> [Extreme; 2] {
        let start = Extreme { amount: self.knots.positions[0][joint], time: self.knots.times[0] };
        let mut found = [start; 2];
        for (piece, times) in self.knots.times.windows(2).enumerate() {
            let [low, high] = extremes(&self.seconds(piece, joint), 0.0, times[1] - times[0]);
            if low.0 < found[0].amount {
                found[0] = Extreme { amount: low.0, time: times[0] + low.1 };
            }
            if high.0 > found[1].amount {
                found[1] = Extreme { amount: high.0, time: times[0] + high.1 };
            }
        }
        found
    }

    /// The largest velocity of a joint, and when.
    #[must_use]
    pub fn fastest(&self, joint: usize) -> Extreme {
        self.largest(joint, 1)
    }

    /// The largest acceleration of a joint, and when. The velocities of a linear curve jump: of each point it has the least that any motion through
    /// this and both next to it, at their times, needs somewhere (the mean value theorem).
    #[must_use]
    pub fn hardest(&self, joint: usize) -> Extreme {
        let mut most = self.largest(joint, 2);
        if self.interpolation == Interpolation::Linear {
            for (i, times) in self.knots.times.windows(3).enumerate() {
                let [before, after] = [i, i + 1].map(|piece| self.seconds(piece, joint)[1]);
                let amount = (after - before).abs() / (0.5 * (times[2] - times[0]));
                if amount > most.amount {
                    most = Extreme { amount, time: times[1] };
                }
            }
        }
        most
    }

    /// The largest change of the acceleration of a joint within a millisecond, per second (rad/s³ or m/s³), and when: the jerk that a controller
    /// sees at 1 kHz, where jumps of the acceleration count too. Before and behind the trajectory the robot stands still.
    #[must_use]
    pub fn jerkiest(&self, joint: usize) -> Extreme {
        const WINDOW: f64 = 1e-3;
        let times = &self.knots.times;
        let [first, last] = self.span();
        // Between two of these the change is a cubic polynomial of the beginning of the millisecond.
        let mut ends: Vec<f64> = times.iter().flat_map(|t| [t - WINDOW, *t]).collect();
        ends.sort_by(f64::total_cmp);
        let mut most = Extreme { amount: 0.0, time: first };
        for w in ends.windows(2).filter(|w| w[1] > w[0]) {
            let middle = 0.5 * (w[0] + w[1]);
            let [from, to] = [middle, middle + WINDOW].map(|time| {
                let piece = (time > first && time < last).then(|| self.piece(time))?;
                Some((derivative(&derivative(&self.seconds(piece, joint))), times[piece]))
            });
            let of = |piece: &Option<(Polynomial, f64)>, time: f64| {
                piece.as_ref().map_or(0.0, |(c, begin)| value(c, time - begin))
            };
            let at = |u: f64| w[0] + u * (w[1] - w[0]);
            let [a, b, c, d] =
                [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|u| of(&to, at(u) + WINDOW) - of(&from, at(u)));
            let cubic = [
                a,
                0.5 * (-11.0 * a + 18.0 * b - 9.0 * c + 2.0 * d),
                4.5 * (2.0 * a - 5.0 * b + 4.0 * c - d),
                4.5 * (3.0 * b - a - 3.0 * c + d),
                0.0,
                0.0,
            ];
            let bound: f64 = cubic.iter().map(|c| c.abs()).sum();
            if bound <= most.amount * WINDOW {
                continue;
            }
            for (change, u) in extremes(&cubic, 0.0, 1.0) {
                let amount = change.abs() / WINDOW;
                if amount > most.amount {
                    most = Extreme { amount, time: (at(u) + 0.5 * WINDOW).clamp(first, last) };
                }
            }
        }
        most
    }

    /// The acceleration of a joint at a time (s); at a point that of the piece behind it.
    pub(crate) fn acceleration(&self, joint: usize, time: f64) -> f64 {
        let piece = self.piece(time);
        value(&derivative(&derivative(&self.seconds(piece, joint))), time - self.knots.times[piece])
    }

    /// The acceleration of a joint just before a point that is not the first.
    pub(crate) fn acceleration_before(&self, joint: usize, point: usize) -> f64 {
        let length = self.knots.times[point] - self.knots.times[point - 1];
        value(&derivative(&derivative(&self.seconds(point - 1, joint))), length)
    }

    fn largest(&self, joint: usize, derivatives: usize) -> Extreme {
        let mut most = Extreme { amount: 0.0, time: self.knots.times[0] };
        for (piece, times) in self.knots.times.windows(2).enumerate() {
            let c = (0..derivatives).fold(self.seconds(piece, joint), |c, _| derivative(&c));
            for (amount, x) in extremes(&c, 0.0, times[1] - times[0]) {
                if amount.abs() > most.amount {
                    most = Extreme { amount: amount.abs(), time: times[0] + x };
                }
            }
        }
        most
    }

    /// The same curve with points `rate` times a second, and its last point. Between them the curve is as before, but for what happens
    /// within a part of a second that has no point.
    ///
    /// # Errors
    /// When the rate is not above zero, or there would be more than ten million points.
    pub fn resampled(&self, rate: f64) -> Result<Self, TimeError> {
        const MOST: f64 = 1e7;
        let [first, last] = self.span();
        // The first point at least, unless the last one is the first.
        let count = ((last - first) * rate - 1e-9).ceil().max(f64::from(u8::from(last > first)));
        // Written so that NaN is refused.
        if !(rate > 0.0 && count < MOST) {
            return Err(TimeError::Rate { rate, most: MOST / (last - first) });
        }
        self.with_points((0..count as usize).map(|i| first + i as f64 / rate).chain([last]))
    }

    /// The same curve with points at whole nanoseconds, as messages of ROS have them.
    ///
    /// # Errors
    /// When points are nearer to each other than that.
    pub fn in_nanoseconds(&self) -> Result<Self, TimeError> {
        self.with_points(self.knots.times.iter().map(|t| (*t * 1e9).round() / 1e9))
    }

    /// The curve through what this one has at other times (s), the last of which is its end, but for rounding: it ends as this one does.
    fn with_points(&self, times: impl Iterator<Item = f64>) -> Result<Self, TimeError> {
        let mut knots = Knots { times: times.collect(), ..Knots::default() };
        for time in &knots.times {
            let sample = self.at(*time);
            knots.positions.push(sample.position);
            if self.interpolation != Interpolation::Linear {
                knots.velocities.push(sample.velocity);
            }
            if self.interpolation == Interpolation::Quintic {
                knots.accelerations.push(sample.acceleration);
            }
        }
        // Just before the end it still moves.
        let Knots { positions, velocities, accelerations, .. } = &self.knots;
        let rows = [(&mut knots.positions, positions), (&mut knots.velocities, velocities)];
        for (new, old) in rows.into_iter().chain([(&mut knots.accelerations, accelerations)]) {
            if let (Some(new), Some(old)) = (new.last_mut(), old.last()) {
                new.clone_from(old);
            }
        }
        Self::new(self.joints(), knots, self.interpolation)
    }

    /// The same curve in space, `factor` times as slow; the factor is above zero and finite.
    #[must_use]
    pub fn slower(mut self, factor: f64) -> Self {
        let first = self.knots.times[0];
        self.knots.times.iter_mut().for_each(|t| *t = first + (*t - first) * factor);
        self.knots.velocities.iter_mut().flatten().for_each(|v| *v /= factor);
        self.knots.accelerations.iter_mut().flatten().for_each(|a| *a /= factor * factor);
        self
    }
}

impl Curve for Trajectory {
    fn pieces(&self) -> usize {
        self.knots.times.len() - 1
    }

    fn polynomial(&self, piece: usize, coordinate: usize) -> [f64; 6] {
        let end = self.knots.times.get(piece + 1);
        let h = end.map_or(0.0, |end| end - self.knots.times[piece]);
        let mut scale = 1.0;
        self.seconds(piece, coordinate).map(|c| {
            let scaled = c * scale;
            scale *= h;
            scaled
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knots(velocities: &[f64], accelerations: &[f64]) -> Knots {
        let rows = |numbers: &[f64]| numbers.iter().map(|x| vec![*x]).collect();
        Knots {
            times: vec![0.5, 1.5, 3.0],
            positions: rows(&[1.0, 3.0, 2.0]),
            velocities: rows(velocities),
            accelerations: rows(accelerations),
        }
    }

    #[test]
    fn the_curve_has_what_its_points_say() {
        let (v, a) = ([0.5, -1.0, 2.0], [3.0, -2.0, 1.0]);
        for (knots, curve) in [
            (knots(&[], &[]), Interpolation::Linear),
            (knots(&v, &[]), Interpolation::Cubic),
            (knots(&v, &a), Interpolation::Quintic),
        ] {
            let made = Trajectory::of_controller([("j", "rad")], knots.clone()).unwrap();
            assert_eq!((made.interpolation(), made.duration()), (curve, 2.5));
            for (i, time) in knots.times.iter().enumerate() {
                // Both sides of a point, but for the ends.
                for time in [time - 1e-9, *time, time + 1e-9] {
                    let at = made.at(time);
                    assert!((at.position[0] - knots.positions[i][0]).abs() < 1e-8);
                    if curve != Interpolation::Linear {
                        assert!((at.velocity[0] - v[i]).abs() < 1e-6, "{curve} {time} {at:?}");
                    }
                    if curve == Interpolation::Quintic {
                        assert!((at.acceleration[0] - a[i]).abs() < 1e-5, "{curve} {time} {at:?}");
                    }
                }
            }
            let [low, high] = made.range(0, 0.7, 2.9);
            let samples = (0..=1000).map(|i| made.at(0.7 + 2.2 * f64::from(i) / 1000.0).position[0]);
            let (least, most) = samples.fold((9.0_f64, -9.0_f64), |(l, h), x| (l.min(x), h.max(x)));
            assert!(low <= least && most <= high && least - low < 1e-3 && high - most < 1e-3);
            let slow = made.clone().slower(2.0);
            assert!((slow.at(0.5 + 2.0 * 0.8).position[0] - made.at(1.3).position[0]).abs() < 1e-12);
            assert!((slow.fastest(0).amount - 0.5 * made.fastest(0).amount).abs() < 1e-12);
            assert!((slow.hardest(0).amount - 0.25 * made.hardest(0).amount).abs() < 1e-12);
        }
    }

    /// A parabola of which only points are known has its acceleration, whatever the times are.
    #[test]
    fn straight_lines_have_the_accelerations_that_their_points_need() {
        let times = vec![0.0, 0.1, 0.5, 0.6, 1.3];
        let positions: Vec<Vec<f64>> = times.iter().map(|t| vec![3.0 * t * t - t]).collect();
        let made = Trajectory::of_controller([("j", "rad")], Knots { times, positions, ..Knots::default() });
        assert!((made.unwrap().hardest(0).amount - 6.0).abs() < 1e-12);
        let corner = Knots {
            times: vec![0.0, 1.0, 2.0],
            positions: vec![vec![0.0], vec![0.4], vec![0.0]],
            ..Knots::default()
        };
        let most = Trajectory::of_controller([("j", "rad")], corner).unwrap().hardest(0);
        assert_eq!((most.amount, most.time), (0.8, 1.0));
    }

    /// Where the last time is rounded down, it is a little before the end.
    #[test]
    fn a_curve_in_nanoseconds_ends_standing_still() {
        for end in [3.000_000_000_4, 3.000_000_000_6] {
            let rest = knots(&[0.0, -1.0, 0.0], &[3.0, -2.0, 0.0]);
            let given = Knots { times: vec![0.5, 1.5, end], ..rest };
            let made = Trajectory::of_controller([("j", "rad")], given).unwrap().in_nanoseconds().unwrap();
            let Knots { times, positions, velocities, accelerations } = made.knots();
            assert_eq!(times[2], (end * 1e9).round() / 1e9);
            assert_eq!([&positions[2], &velocities[2], &accelerations[2]], [&[2.0], &[0.0], &[0.0]]);
        }
    }

    #[test]
    fn the_curve_in_parts_is_the_curve() {
        let made =
            Trajectory::of_controller([("j", "rad")], knots(&[0.5, -1.0, 2.0], &[3.0, -2.0, 1.0])).unwrap();
        for (piece, begin, length) in [(0, 0.5, 1.0), (1, 1.5, 1.5)] {
            for u in [0.0, 0.3, 0.8] {
                let by_curve = value(&made.polynomial(piece, 0), u);
                assert!((by_curve - made.at(begin + u * length).position[0]).abs() < 1e-12);
            }
        }
        let sampled = made.resampled(4.0).unwrap();
        assert_eq!(sampled.knots().times.len(), 11);
        for t in [0.5, 0.6, 1.5, 2.2, 2.999] {
            // The points of 4 Hz fall on those of the trajectory.
            assert!((sampled.at(t).position[0] - made.at(t).position[0]).abs() < 1e-9);
        }
        assert_eq!(made.resampled(3.0).unwrap().span(), made.span());
        // However low the rate, it does not begin where it ends.
        assert_eq!(made.resampled(1e-300).unwrap().span(), made.span());
        assert!(made.resampled(0.0).is_err() && made.resampled(f64::NAN).is_err());
        // 2.5 seconds.
        assert_eq!(made.resampled(1e9), Err(TimeError::Rate { rate: 1e9, most: 4e6 }));
    }

    #[test]
    fn jerk_is_that_of_samples() {
        let made =
            Trajectory::of_controller([("j", "rad")], knots(&[0.5, -1.0, 2.0], &[3.0, -2.0, 1.0])).unwrap();
        let of = |t: f64| if (0.5..3.0).contains(&t) { made.at(t).acceleration[0] } else { 0.0 };
        let jerk = |i: i32| {
            let t = 0.4 + f64::from(i) * 1e-5;
            (of(t + 1e-3) - of(t)).abs() / 1e-3
        };
        let (samples, most) = ((0..270_000).map(jerk).fold(0.0, f64::max), made.jerkiest(0));
        assert!(samples <= most.amount * (1.0 + 1e-9) && most.amount < samples * 1.01, "{samples} {most:?}");
        // The acceleration begins with 3 rad/s² at once, which is the most.
        assert!((most.amount - 3e3).abs() < 100.0 && (most.time - 0.5).abs() < 1e-3, "{most:?}");
    }

    #[test]
    fn what_is_no_trajectory_is_refused() {
        let message =
            |knots: Knots, curve| Trajectory::new([("j", "rad")], knots, curve).unwrap_err().to_string();
        let linear = Interpolation::Linear;
        assert!(message(Knots::default(), linear).contains("not enough points"));
        assert!(message(knots(&[], &[]), Interpolation::Cubic).contains("cubic curve needs velocities"));
        assert!(message(knots(&[0.0; 3], &[]), Interpolation::Quintic).contains("needs accelerations"));
        assert!(message(knots(&[0.0; 2], &[]), linear).contains("2 rows of velocities, not 3"));
        let wrong = |change: fn(&mut Knots)| {
            let mut knots = knots(&[], &[]);
            change(&mut knots);
            message(knots, linear)
        };
        assert!(wrong(|k| k.times[1] = 0.5).contains("point 2 is 0.5 s, not after"));
        assert!(wrong(|k| k.positions[2].push(1.0)).contains("2 numbers of a point, not 1"));
        assert!(wrong(|k| k.positions[2][0] = f64::NAN).contains("point 3 is not finite"));
    }
}
