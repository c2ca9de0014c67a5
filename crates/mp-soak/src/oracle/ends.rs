//! Whether a path begins at the start, ends at a goal, stays within its limits, and goes as the robot can.

use super::moment::{Edge, Moment, Row, angle_of, pose, wrapped};
use super::{Ask, Case, Fault, Moves};
use std::f64::consts::PI;
use std::ops::Range;

/// How far, as a part of the extent or in radians, a number of a path may be from where it has to be: the
/// text of a path has angles, and near β = π/2 these lose half of their digits.
const NEAR: f64 = 1e-6;
/// The same for limits.
const ROUNDING: f64 = 1e-8;
/// How far a time may be from the one asked, seconds.
const NEAR_TIME: f64 = 1.001e-3;

impl Case {
    /// The numbers of a configuration at a moment; of a pose in space only the position.
    fn numbers(&self, moment: &Moment) -> Vec<f64> {
        let p = moment.root.translation;
        match &self.moves {
            Moves::Point => vec![p.x, p.y],
            Moves::Plane => vec![p.x, p.y, angle_of(&moment.root)],
            Moves::Space => vec![p.x, p.y, p.z],
            Moves::Tree(tree) if tree.floats => {
                // The angles of the root have no limits.
                let root = [p.x, p.y, p.z, 0.0, 0.0, 0.0];
                root.into_iter().chain(moment.joints.iter().copied()).collect()
            }
            Moves::Tree(_) => moment.joints.clone(),
        }
    }

    fn check_numbers(&self, moment: &Moment) -> Result<(), String> {
        let slack = ROUNDING * (self.extent + 1e-3 * self.far);
        for (i, (x, limits)) in self.numbers(moment).iter().zip(&self.limits).enumerate() {
            if let Some([low, high]) = limits
                && !(low - slack..=high + slack).contains(x)
            {
                return Err(format!("number {} is {x}, not from {low} to {high}", i + 1));
            }
        }
        Ok(())
    }

    /// A row as `mp check` reads it: joints that are no more than a hundred-thousandth (rad or m) beyond a limit are at it.
    pub fn at_limits(&self, row: &[f64]) -> Vec<f64> {
        const HAIR: f64 = 1e-5;
        let first = match &self.moves {
            Moves::Tree(tree) if tree.floats => 6,
            Moves::Tree(_) => 0,
            _ => return row.to_vec(),
        };
        let mut row = row.to_vec();
        for (x, limits) in row.iter_mut().zip(&self.limits).skip(first) {
            if let Some([low, high]) = limits
                && (*x - x.clamp(*low, *high)).abs() <= HAIR
            {
                *x = x.clamp(*low, *high);
            }
        }
        row
    }

    /// Whether a row is within its limits, but for the input that leads there.
    pub(super) fn check_limits(&self, row: &Row<'_>) -> Result<(), String> {
        self.check_numbers(&row.moment)?;
        let most = self.drive.iter().flat_map(|drive| &drive.velocities);
        match row.moment.velocities.iter().zip(most).find(|(v, most)| v.abs() > **most * (1.0 + ROUNDING)) {
            Some((v, most)) => Err(format!("a velocity of {v} is beyond {most}")),
            None => Ok(()),
        }
    }

    /// Whether the input that leads to a row, and its duration, are within their limits.
    fn check_input(&self, row: &Row<'_>) -> Result<(), String> {
        let Some(drive) = &self.drive else { return Ok(()) };
        for (u, [low, high]) in row.input.iter().zip(&drive.limits) {
            let slack = ROUNDING * (high - low);
            if !(low - slack..=high + slack).contains(u) {
                return Err(format!("an input of {u} is not from {low} to {high}"));
            }
        }
        match (0.0..=drive.longest * (1.0 + ROUNDING)).contains(&row.duration) {
            true => Ok(()),
            false => Err(format!(
                "an input is held for {} s, at most {} s are allowed",
                row.duration, drive.longest
            )),
        }
    }

    /// Whether rows are within their limits, and lead from the start to a goal.
    pub(super) fn check_rows(&self, rows: &[Row<'_>]) -> Result<(), Fault> {
        let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
            return Err(Fault::Invalid("the path has no rows".to_owned()));
        };
        for (i, row) in rows.iter().enumerate() {
            // No input leads to the first row.
            let input = if i > 0 { self.check_input(row) } else { Ok(()) };
            let within = self.check_limits(row).and(input);
            within.map_err(|what| Fault::Invalid(format!("in row {}, {what}", i + 1)))?;
        }
        let inputs = self.drive.as_ref().map_or(0, |drive| drive.limits.len() + 1);
        let start: Vec<f64> = self.start.iter().copied().chain(std::iter::repeat_n(0.0, inputs)).collect();
        let start = self.row(&start).map_err(Fault::Invalid)?;
        let off = |what| Fault::Ends(format!("it does not begin at the start: {what}"));
        self.check_same(&first.moment, &start.moment).map_err(off)?;
        let faults: Vec<String> =
            self.goals.iter().filter_map(|goal| self.check_goal(goal, last).err()).collect();
        match (faults.len() < self.goals.len(), faults.first()) {
            (false, Some(fault)) => Err(Fault::Ends(format!("it does not end at a goal: {fault}"))),
            _ => Ok(()),
        }
    }

    /// Whether two moments are the same.
    fn check_same(&self, a: &Moment, b: &Moment) -> Result<(), String> {
        let off = (a.root.translation.vector - b.root.translation.vector).norm();
        if off > NEAR * self.extent {
            return Err(format!("{off} m off"));
        }
        let turned = a.root.rotation.angle_to(&b.root.rotation);
        if turned > NEAR {
            return Err(format!("turned by {turned}"));
        }
        let circle = |i: usize| matches!(&self.moves, Moves::Tree(tree) if tree.circles[i]);
        for (i, (x, y)) in a.joints.iter().zip(&b.joints).enumerate() {
            let off = if circle(i) { wrapped(x - y) } else { x - y };
            if off.abs() > NEAR {
                return Err(format!("joint {} is {off} off", i + 1));
            }
        }
        for (v, w) in a.velocities.iter().zip(&b.velocities) {
            if (v - w).abs() > NEAR * (1.0 + w.abs()) {
                return Err(format!("a velocity of {v} instead of {w}"));
            }
        }
        match self.timing.is_none() || (a.time - b.time).abs() <= NEAR_TIME {
            true => Ok(()),
            false => Err(format!("at {} s instead of {} s", a.time, b.time)),
        }
    }

    fn check_goal(&self, goal: &[Ask], row: &Row<'_>) -> Result<(), String> {
        let turns = match &self.moves {
            Moves::Space => true,
            Moves::Tree(tree) => tree.floats,
            Moves::Point | Moves::Plane => false,
        };
        let mut numbers: Vec<f64> = match &self.moves {
            Moves::Plane => self.numbers(&row.moment),
            _ => row.own.to_vec(),
        };
        let exact: Vec<f64> = goal
            .iter()
            .take(6)
            .filter_map(|ask| if let Ask::Exactly(x) = ask { Some(*x) } else { None })
            .collect();
        let mut skip = 0..0;
        if turns && exact.len() == 6 {
            // Angles may be written in several ways.
            let off = pose(&exact).rotation.angle_to(&row.moment.root.rotation);
            if off > NEAR {
                return Err(format!("turned by {off}"));
            }
            skip = 3..6;
        }
        numbers.extend(&row.moment.velocities);
        let first = self.check_asked(goal, &numbers, skip.clone());
        let second = || {
            // The same orientation has two triples of angles.
            let mut numbers = numbers.clone();
            let turned = [numbers[3] + PI, PI - numbers[4], numbers[5] + PI];
            numbers[3..6].copy_from_slice(&turned);
            self.check_asked(goal, &numbers, skip.clone())
        };
        first.or_else(|what| if turns { second() } else { Err(what) })?;
        match &self.timing {
            Some(timing)
                if !(timing.goal[0] - NEAR_TIME..=timing.goal[1] + NEAR_TIME).contains(&row.moment.time) =>
            {
                Err(format!(
                    "at {} s, not from {} s to {} s",
                    row.moment.time, timing.goal[0], timing.goal[1]
                ))
            }
            _ => Ok(()),
        }
    }

    /// Whether numbers are what a goal asks, apart from those to skip.
    fn check_asked(&self, goal: &[Ask], numbers: &[f64], skip: Range<usize>) -> Result<(), String> {
        let own = self.moves.numbers();
        for (i, (x, ask)) in numbers.iter().zip(goal).enumerate().filter(|(i, _)| !skip.contains(i)) {
            let angle = i < own && self.limits.get(i).is_some_and(Option::is_none);
            let length = match &self.moves {
                Moves::Point => i < 2,
                Moves::Plane => i < 2,
                Moves::Space => i < 3,
                Moves::Tree(tree) => tree.floats && i < 3,
            };
            let near = if length { NEAR * self.extent } else { NEAR };
            let off = |from: f64| if angle { wrapped(x - from).abs() } else { (x - from).abs() };
            let there = match *ask {
                Ask::Free => true,
                Ask::Exactly(value) => off(value) <= near,
                Ask::Between([low, high]) => off(0.5 * (low + high)) <= 0.5 * (high - low) + near,
            };
            if !there {
                return Err(format!("number {} is {x}, and has to be {ask:?}", i + 1));
            }
        }
        Ok(())
    }

    /// Whether the robot can go along an edge. On curved ones it looks at `places` places whether the robot
    /// is within its limits.
    pub(super) fn check_edge(
        &self,
        edge: &Edge<'_>,
        from: &Moment,
        to: &Row<'_>,
        places: usize,
    ) -> Result<(), String> {
        if let Some(timing) = &self.timing {
            let taken = to.moment.time - from.time;
            if taken < 0.0 {
                return Err(format!("time goes back by {} s", -taken));
            }
            if let Some(speed) = timing.speed {
                let way = edge.metric();
                if way > speed * taken * (1.0 + 1e-6) + ROUNDING * self.extent {
                    return Err(format!("it goes {way} m in {taken} s, faster than {speed} m/s"));
                }
            }
        }
        if self.drive.is_none() {
            return Ok(());
        }
        let led = edge.at(1.0);
        self.check_same(&to.moment, &led).map_err(|what| format!("the input leads elsewhere: {what}"))?;
        (0..=places).try_for_each(|i| self.check_numbers(&edge.at(i as f64 / places as f64)))
    }
}

impl Case {
    /// A configuration that a goal asks for, if it asks for one only: with the time if obstacles move, and at
    /// rest.
    #[must_use]
    pub fn example(&self, goal: &[Ask]) -> Option<Vec<f64>> {
        let exact = |ask: &Ask| if let Ask::Exactly(x) = ask { Some(*x) } else { None };
        let mut row: Vec<f64> = goal.iter().map(exact).collect::<Option<_>>()?;
        // At another time something else may be there.
        if self.timing.is_some() {
            return None;
        }
        row.resize(self.start.len(), 0.0);
        Some(row)
    }
}
