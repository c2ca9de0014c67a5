//! Steering: inputs that lead from one state to another where there are no obstacles. With it paths are made shorter.

use super::DrivenScene;
use super::system::{Parts, System};
use crate::numbers::rounding;
use mp_control::{dubins, reeds_shepp};
use mp_cspace::angle::{angle_difference, wrap_angle};
use mp_cspace::shorten::Effort;
use mp_cspace::{Configuration, MotionValidity, Path, Rng, Space};
use rand::RngExt;

/// An input, and for how long it is held (s).
type Held = (Vec<f64>, f64);

/// Places on a path that are this near to a state, as a part of the duration between two states, are that state.
const NEAR: f64 = 0.02;
/// A stretch must become shorter by this part of the whole time.
const LEAST_GAIN: f64 = 1e-6;
/// Times that are tried for a motion with accelerations, each longer than the one before; and how often the shortest that
/// is possible is approached by halves.
const TIMES: i32 = 24;
const HALVINGS: u32 = 12;
/// Corrections of a motion whose rotations do not add up.
const CORRECTIONS: u32 = 20;

impl System {
    /// Inputs that lead from one state to another in less than `most` seconds, obstacles aside: the shortest curve of a car, a turn,
    /// a drive and a turn of a unicycle, a straight motion by velocities, and two accelerations. Times of the states do not count.
    fn steer<C: Space<State = Configuration>>(
        &self,
        positions: &C,
        from: &Parts,
        to: &Parts,
        most: f64,
    ) -> Option<Vec<Held>> {
        let held = match &self.drive {
            mp_io::Drive::Car { speed, wheelbase, steering, reverse } => {
                let ((a, _), (b, _)) = (self.pose(&from.q)?, self.pose(&to.q)?);
                let curve = if *reverse { reeds_shepp } else { dubins };
                let parts = curve(&a, &b, wheelbase / mp_math::tan(*steering)).into_iter();
                let input = |turn: f64, way: f64| vec![speed.copysign(way), steering * turn];
                parts.map(|part| (input(part.turn, part.length), part.length.abs() / speed)).collect()
            }
            mp_io::Drive::Unicycle { speed, turning, reverse } => {
                let ((a, _), (b, _)) = (self.pose(&from.q)?, self.pose(&to.q)?);
                let way = b.translation - a.translation;
                let ahead = if way.norm() > 0.0 { mp_math::atan2(way.y, way.x) } else { a.angle };
                let turn = |angle: f64| (vec![0.0, turning.copysign(angle)], angle.abs() / turning);
                let driven = |heading: f64, speed: f64| {
                    let drive = (vec![speed, 0.0], way.norm() / speed.abs());
                    vec![
                        turn(angle_difference(a.angle, heading)),
                        drive,
                        turn(angle_difference(heading, b.angle)),
                    ]
                };
                let forward = driven(ahead, *speed);
                match reverse.then(|| driven(wrap_angle(ahead + std::f64::consts::PI), -speed)) {
                    Some(backward) if time(&backward) < time(&forward) => backward,
                    _ => forward,
                }
            }
            mp_io::Drive::Velocities { speeds } => {
                let way = self.way(positions, from, to)?;
                let needed = |(way, speed): (&f64, &f64)| way.abs() / speed;
                let needed = way.iter().zip(speeds).map(needed).fold(0.0, f64::max);
                vec![(way.iter().map(|x| if needed > 0.0 { x / needed } else { 0.0 }).collect(), needed)]
            }
            mp_io::Drive::Accelerations { speeds, accelerations } => {
                self.accelerated(positions, (from, to), (speeds, accelerations), most)?
            }
        };
        (time(&held) < most).then(|| held.into_iter().filter(|(_, time)| *time > 0.0).collect())
    }

    /// Two accelerations, each held for half of the time, about the shortest that is possible within the limits.
    fn accelerated<C: Space<State = Configuration>>(
        &self,
        positions: &C,
        (from, to): (&Parts, &Parts),
        (speeds, limits): (&[f64], &[f64]),
        most: f64,
    ) -> Option<Vec<Held>> {
        let in_time = |time: f64| {
            let half = 0.5 * time;
            let mut way = self.way(positions, from, to)?;
            // Exact at once where the degrees of freedom are numbers and angles; rotations in space are corrected.
            for _ in 0..CORRECTIONS {
                let (mut first, mut second) = (Vec::new(), Vec::new());
                for ((way, v), w) in way.iter().zip(&from.velocity).zip(&to.velocity) {
                    let (far, faster) = (way - v * time, w - v);
                    let a = far / (half * half) - 0.5 * faster / half;
                    first.push(a);
                    second.push(faster / half - a);
                }
                let slow = |((a, v), speed): ((&f64, &f64), &f64)| (v + half * a).abs() <= *speed;
                let weak = |(a, limit): (&f64, &f64)| a.abs() <= *limit;
                let possible = first.iter().zip(&from.velocity).zip(speeds).all(slow)
                    && [&first, &second].iter().all(|input| input.iter().zip(limits).all(weak));
                if !possible {
                    return None;
                }
                let held = vec![(first, half), (second, half)];
                let off = self.way(positions, self.run(positions, from, &held).last()?, to)?;
                if off.iter().all(|x| x.abs() <= 0.01 * rounding(positions.extent())) {
                    return Some(held);
                }
                way.iter_mut().zip(off).for_each(|(way, off)| *way += off);
            }
            None
        };
        let tried = (1..=TIMES).map(|i| most * mp_math::powf(2.0, 0.25 * f64::from(i - TIMES)));
        let (mut low, mut best) = (0.0, None);
        for time in tried {
            if let Some(held) = in_time(time) {
                best = Some((time, held));
                break;
            }
            low = time;
        }
        let (mut high, mut held) = best?;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match in_time(middle) {
                Some(shorter) => (high, held) = (middle, shorter),
                None => low = middle,
            }
        }
        Some(held)
    }

    /// The states that inputs lead to, each held for no longer than the system says, in equal parts.
    fn run<C: Space<State = Configuration>>(&self, positions: &C, from: &Parts, held: &[Held]) -> Vec<Parts> {
        let (mut now, mut states) = (from.clone(), Vec::new());
        for (input, time) in held {
            let parts = (time / self.duration).ceil().max(1.0);
            for _ in 0..parts as usize {
                now = self.flow(positions, &now, input, time / parts);
                states.push(now.clone());
            }
        }
        states
    }

    /// The velocity that leads from one position to another in a second, one number for each degree of freedom. The times of both
    /// do not count.
    fn way<C: Space<State = Configuration>>(
        &self,
        positions: &C,
        from: &Parts,
        to: &Parts,
    ) -> Option<Vec<f64>> {
        let mut way = vec![0.0; positions.dim()];
        let known = positions.velocity_into(&from.q, &to.q, &mut way);
        if self.timed {
            way.pop();
        }
        known.then_some(way)
    }
}

/// How long inputs take together.
fn time(held: &[Held]) -> f64 {
    held.iter().map(|(_, time)| time).sum()
}

impl DrivenScene {
    /// Replaces stretches of the path, between two random places of it, by steering from one to the other, where that takes less
    /// time, is no longer and is free, again and again. Behind such a stretch the inputs stay as they are; what they lead to is computed anew, as
    /// it differs by rounding. The path still ends at a goal.
    pub(super) fn shortened_path(
        &self,
        path: &Path<Configuration>,
        check: &mut dyn MotionValidity<Configuration>,
        effort: Effort,
        rng: &mut Rng,
    ) -> Path<Configuration> {
        let (system, positions) = (&self.space.system, &self.space.positions());
        let mut states: Vec<_> = path.states.iter().map(|q| self.parts(q)).collect();
        let after = |from: &Parts, input: &[f64], time: f64| system.flow(positions, from, input, time);
        let length =
            |states: &[Parts]| -> f64 { states.windows(2).map(|w| self.space.apart(&w[0], &w[1])).sum() };
        let mut failures = 0;
        for attempt in 0..effort.attempts {
            if failures >= effort.patience || states.len() < 3 || check.is_interrupted() {
                break;
            }
            failures += 1;
            let mut times = vec![0.0];
            times.extend(states[1..].iter().scan(0.0, |now, state| {
                *now += state.duration;
                Some(*now)
            }));
            let whole = times[times.len() - 1];
            // At first all of the path.
            let [x, y] = [0, 1].map(|_| whole * rng.random::<f64>());
            let (begin, end) = if attempt == 0 { (0.0, whole) } else { (x.min(y), x.max(y)) };
            let edge_at = |at: f64| times.partition_point(|&end| end <= at).clamp(1, times.len() - 1) - 1;
            // The edge on which a place is, and how far along it, from 0 to 1.
            let place = |at: f64| {
                let edge = edge_at(at);
                let part = (at - times[edge]) / states[edge + 1].duration;
                match part {
                    p if p < NEAR => (edge, 0.0),
                    p if p > 1.0 - NEAR => (edge, 1.0),
                    p => (edge, p),
                }
            };
            let ((first, left), (last, right)) = (place(begin), place(end));
            if first >= last {
                continue;
            }
            let on = |edge: usize, part: f64| match part {
                p if p <= 0.0 => states[edge].clone(),
                p if p >= 1.0 => states[edge + 1].clone(),
                p => after(&states[edge], &states[edge + 1].input, p * states[edge + 1].duration),
            };
            let (from, to) = (on(first, left), on(last, right));
            let taken = times[last] + right * states[last + 1].duration
                - times[first]
                - left * states[first + 1].duration;
            let most = taken - LEAST_GAIN * whole;
            if most <= 0.0 {
                continue;
            }
            let Some(held) = system.steer(positions, &from, &to, most) else { continue };
            let mut new = states[..=first].to_vec();
            if left > 0.0 {
                new.push(from.clone());
            }
            new.extend(system.run(positions, &from, &held));
            let mut now = new[new.len() - 1].clone();
            let rounding = rounding(positions.extent());
            let is_at = |now: &Parts, to: &Parts| {
                system.way(positions, now, to).is_some_and(|off| off.iter().all(|x| x.abs() <= rounding))
            };
            if !is_at(&now, &to) {
                continue;
            }
            if right < 1.0 {
                now = after(&now, &states[last + 1].input, (1.0 - right) * states[last + 1].duration);
                new.push(now.clone());
            }
            let changed = new.len();
            for state in &states[last + 2..] {
                now = after(&now, &state.input, state.duration);
                new.push(now.clone());
            }
            // Where time counts, what comes later has changed too, and where an input in two parts does not lead to the same state as
            // in one: rotations in space at accelerations.
            let all = system.timed || !is_at(&new[changed - 1], &states[last + 1]);
            let until = if all { new.len() } else { changed };
            let vectors: Vec<_> = new[first..until].iter().map(|state| system.vector(state)).collect();
            let free = vectors.windows(2).all(|w| check.check_motion(&w[0], &w[1]).is_free());
            if free && length(&new) <= length(&states) && self.is_at_goal(&now) {
                states = new;
                failures = 0;
            }
        }
        Path::straight(states.iter().map(|state| system.vector(state)).collect())
    }

    fn is_at_goal(&self, state: &Parts) -> bool {
        let q = self.space.system.vector(state);
        let rounding = rounding(self.space.extent().max(1.0));
        self.goal_parts.iter().any(|goal| {
            let there = crate::goals::next_to(self, goal, &q);
            self.space.distance(&q, &there) <= rounding
        })
    }
}
