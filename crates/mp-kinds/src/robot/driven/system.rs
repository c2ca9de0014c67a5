//! How inputs move a robot, and which it has.

use crate::numbers::rounding;
use mp_control::{Car, Flow, InputSet, Unicycle};
use mp_cspace::{Configuration, Se2State, Space, StateVector};
use mp_io::Drive;
use std::borrow::Cow;
use std::f64::consts::FRAC_PI_2;

/// A circle has four places where it turns back in x or y. Going around again leads to the same ones.
const MOST_TURNS: f64 = 4.0;
/// Steering angles to either side, when their number is not given.
const STEERING: usize = 2;

/// How the states of a robot are written, and how inputs move them.
///
/// A state is a vector: the numbers of the configuration, the velocities of a robot with accelerations, and the input and the
/// duration (s) that led to it from the state before; zeros for a state that no input led to.
#[derive(Clone, Debug)]
pub(super) struct System {
    pub(super) drive: Drive,
    pub(super) duration: f64,
    /// How many numbers a configuration has.
    pub(super) numbers: usize,
    /// How many velocities a state has.
    pub(super) velocities: usize,
    /// How many numbers an input has.
    pub(super) inputs: usize,
    /// Whether the last number of a configuration is the time.
    pub(super) timed: bool,
}

/// The parts of a state.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    pub(super) q: Configuration,
    pub(super) velocity: Vec<f64>,
    pub(super) input: Vec<f64>,
    pub(super) duration: f64,
}

impl System {
    /// The number of numbers of a state.
    pub(super) fn len(&self) -> usize {
        self.numbers + self.velocities + self.inputs + 1
    }

    /// The configuration and the velocity of a vector, if it is a state; then its input and its duration.
    pub(super) fn split<'s>(&self, all: &'s [f64]) -> Option<(Configuration, &'s [f64], &'s [f64])> {
        let (q, rest) = (all.len() == self.len()).then(|| all.split_at(self.numbers))?;
        let (velocity, rest) = rest.split_at(self.velocities);
        Some((q.into(), velocity, rest))
    }

    /// The parts of a vector, if it is a state.
    pub(super) fn parts(&self, state: &Configuration) -> Option<Parts> {
        let (q, velocity, rest) = self.split(state)?;
        let (duration, input) = rest.split_last()?;
        Some(Parts { q, velocity: velocity.to_vec(), input: input.to_vec(), duration: *duration })
    }

    /// The vector of a state.
    pub(super) fn vector(&self, parts: &Parts) -> Configuration {
        let all = parts.q.iter().chain(&parts.velocity).chain(&parts.input).chain([&parts.duration]);
        all.copied().collect()
    }

    /// The state that `input` leads to in `time` seconds.
    pub(super) fn flow<C: Space<State = Configuration>>(
        &self,
        positions: &C,
        from: &Parts,
        input: &[f64],
        time: f64,
    ) -> Parts {
        let wheels = |flow: &dyn Fn(&Se2State) -> Se2State| {
            let (pose, now) = self.pose(&from.q)?;
            let moved = Configuration::of(&flow(&pose));
            Some(moved.iter().copied().chain(now.map(|now| now + time)).collect())
        };
        let pair = || [input.first().copied().unwrap_or(0.0), input.get(1).copied().unwrap_or(0.0)];
        let mut velocity = from.velocity.clone();
        let q = match &self.drive {
            Drive::Car { wheelbase, .. } => {
                let car = Car::new(*wheelbase).ok();
                wheels(&|q| car.map_or(*q, |car| car.integrate(q, &pair(), time)))
            }
            Drive::Unicycle { .. } => wheels(&|q| Unicycle.integrate(q, &pair(), time)),
            Drive::Velocities { .. } => positions.moved(&from.q, &self.as_time_goes(input), time),
            Drive::Accelerations { .. } => {
                let mean: Vec<f64> = velocity.iter().zip(input).map(|(v, a)| v + 0.5 * time * a).collect();
                velocity.iter_mut().zip(input).for_each(|(v, a)| *v += time * a);
                positions.moved(&from.q, &self.as_time_goes(&mean), time)
            }
        };
        Parts { q: q.unwrap_or_else(|| from.q.clone()), velocity, input: input.to_vec(), duration: time }
    }

    /// The pose of a robot on wheels, and the time, if that is a part of its configuration.
    pub(super) fn pose(&self, q: &Configuration) -> Option<(Se2State, Option<f64>)> {
        let (now, numbers) = match q.split_last() {
            Some((now, numbers)) if self.timed => (Some(*now), numbers),
            _ => (None, q.as_slice()),
        };
        Some((Se2State::read(numbers)?, now))
    }

    /// A velocity of the configuration: with that of time, if time is a part of the configuration.
    fn as_time_goes<'v>(&self, velocity: &'v [f64]) -> Cow<'v, [f64]> {
        match self.timed {
            true => velocity.iter().copied().chain([1.0]).collect(),
            false => velocity.into(),
        }
    }

    /// The times (s) on the way from `from` by the input of `to` at which a number of the position has its least or greatest value,
    /// apart from the ends.
    pub(super) fn turning_times(&self, from: &Parts, to: &Parts) -> Vec<f64> {
        let input = &to.input;
        let rate = match &self.drive {
            Drive::Velocities { .. } => return Vec::new(),
            Drive::Accelerations { .. } => {
                let times = from.velocity.iter().zip(input).map(|(v, a)| -v / a);
                return times.filter(|time| *time > 0.0 && *time < to.duration).collect();
            }
            Drive::Car { wheelbase, .. } => input[0] * mp_math::tan(input[1]) / wheelbase,
            Drive::Unicycle { .. } => input[1],
        };
        if rate == 0.0 || input[0] == 0.0 {
            return Vec::new();
        }
        // Where the robot heads along an axis.
        let Some((pose, _)) = self.pose(&from.q) else { return Vec::new() };
        let [begin, end] = [pose.angle, pose.angle + rate * to.duration];
        let first = (begin.min(end) / FRAC_PI_2).ceil();
        let count = ((begin.max(end) / FRAC_PI_2).floor() - first + 1.0).clamp(0.0, MOST_TURNS) as usize;
        (0..count).map(|k| ((first + k as f64) * FRAC_PI_2 - begin) / rate).collect()
    }

    /// The greatest rate of each degree of freedom, as of [`rates`](Self::rates).
    pub(super) fn greatest_rates(drive: &Drive) -> Vec<f64> {
        match drive {
            Drive::Car { speed, wheelbase, steering, .. } => {
                vec![*speed, 0.0, speed * mp_math::tan(*steering) / wheelbase]
            }
            Drive::Unicycle { speed, turning, .. } => vec![*speed, 0.0, *turning],
            Drive::Velocities { speeds } | Drive::Accelerations { speeds, .. } => speeds.clone(),
        }
    }

    /// Upper bounds on the rate of each degree of freedom on the way from `from` by the input of `to`. The rates of a robot on
    /// wheels are those along its own axes.
    pub(super) fn rates(&self, from: &Parts, to: &Parts) -> Vec<f64> {
        let input = &to.input;
        match &self.drive {
            Drive::Car { wheelbase, .. } => {
                vec![input[0].abs(), 0.0, (input[0] * mp_math::tan(input[1]) / wheelbase).abs()]
            }
            Drive::Unicycle { .. } => vec![input[0].abs(), 0.0, input[1].abs()],
            Drive::Velocities { .. } => input.iter().map(|u| u.abs()).collect(),
            Drive::Accelerations { .. } => {
                let fastest = |(v, a): (&f64, &f64)| v.abs().max((v + a * to.duration).abs());
                from.velocity.iter().zip(input).map(fastest).collect()
            }
        }
    }

    /// How far the input of `to` moves each degree of freedom on the way from `from`: a robot on wheels along its own axes.
    pub(super) fn moved(&self, from: &Parts, to: &Parts) -> Vec<f64> {
        let (input, time) = (&to.input, to.duration);
        match &self.drive {
            Drive::Car { wheelbase, .. } => {
                vec![input[0] * time, 0.0, input[0] * mp_math::tan(input[1]) / wheelbase * time]
            }
            Drive::Unicycle { .. } => vec![input[0] * time, 0.0, input[1] * time],
            Drive::Velocities { .. } => input.iter().map(|u| u * time).collect(),
            Drive::Accelerations { .. } => {
                from.velocity.iter().zip(input).map(|(v, a)| (v + 0.5 * time * a) * time).collect()
            }
        }
    }

    /// The greatest velocity of each degree of freedom that is part of a state.
    pub(super) fn velocity_limits(&self) -> &[f64] {
        match &self.drive {
            Drive::Accelerations { speeds, .. } => speeds,
            _ => &[],
        }
    }

    /// The least and the greatest value of each number of an input.
    pub(super) fn input_limits(&self) -> Vec<[f64; 2]> {
        let both = |limits: &[f64]| limits.iter().map(|v| [-v, *v]).collect();
        let backward = |speed: f64, reverse: bool| if reverse { -speed } else { 0.0 };
        match &self.drive {
            Drive::Car { speed, steering, reverse, .. } => {
                vec![[backward(*speed, *reverse), *speed], [-steering, *steering]]
            }
            Drive::Unicycle { speed, turning, reverse } => {
                vec![[backward(*speed, *reverse), *speed], [-turning, *turning]]
            }
            Drive::Velocities { speeds } => both(speeds),
            Drive::Accelerations { accelerations, .. } => both(accelerations),
        }
    }

    /// Whether an input is within its limits.
    pub(super) fn allows(&self, input: &[f64]) -> bool {
        let within = |(u, [low, high]): (&f64, [f64; 2])| {
            let slack = rounding(high - low);
            (low - slack..=high + slack).contains(u)
        };
        input.iter().zip(self.input_limits()).all(within)
    }

    /// The inputs that planners choose among: in `directions` directions (0: the system's own choice), each at `levels` levels.
    /// Each level is a quarter of the one before.
    pub(super) fn choices(&self, directions: usize, levels: u32) -> Vec<Vec<f64>> {
        let scaled = |inputs: Vec<Vec<f64>>, scale: fn(&mut Vec<f64>, f64)| {
            let level = |level: u32| {
                let factor = mp_math::powi(0.25, level.min(99) as i32);
                let mut inputs = inputs.clone();
                inputs.iter_mut().for_each(|input| scale(input, factor));
                inputs
            };
            (0..levels).flat_map(level).collect::<Vec<_>>()
        };
        let whole: fn(&mut Vec<f64>, f64) = |input, factor| input.iter_mut().for_each(|u| *u *= factor);
        let spread = |limits: &[f64]| {
            let set = match directions {
                0 => InputSet::axes_dyn(limits),
                n => InputSet::spread_dyn(limits, n),
            };
            set.map(|set| set.inputs().iter().map(|u| u.as_slice().to_vec()).collect()).unwrap_or_default()
        };
        match &self.drive {
            Drive::Car { speed, steering, reverse, .. } => {
                let each_side = if directions == 0 { STEERING } else { directions.div_ceil(2) };
                let angle = |i: usize| steering * (i as f64 / each_side as f64 - 1.0);
                let angles = (0..=2 * each_side).map(angle);
                let ways = if *reverse { vec![*speed, -speed] } else { vec![*speed] };
                let inputs =
                    angles.flat_map(|angle| ways.iter().map(move |v| vec![*v, angle]).collect::<Vec<_>>());
                scaled(inputs.collect(), |input, factor| input[0] *= factor)
            }
            Drive::Unicycle { speed, turning, reverse } => {
                let ways = if *reverse { vec![*speed, 0.0, -speed] } else { vec![*speed, 0.0] };
                let turns = [0.0, *turning, -turning];
                let all = ways.iter().flat_map(|v| turns.map(|w| vec![*v, w]));
                scaled(all.filter(|u| u.iter().any(|x| *x != 0.0)).collect(), whole)
            }
            Drive::Velocities { speeds } => scaled(spread(speeds), whole),
            Drive::Accelerations { accelerations, .. } => {
                let mut inputs = scaled(spread(accelerations), whole);
                // Nothing changes the velocity.
                inputs.push(vec![0.0; accelerations.len()]);
                inputs
            }
        }
    }
}
