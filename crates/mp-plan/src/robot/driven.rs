//! Robots that move by inputs: cars, unicycles, and robots with limited velocities or accelerations.

use super::{Body, Column, End, Measured, Queries, RobotKind, Touch, no_metric};
use crate::goals::{GoalPart, examples};
use crate::{Error, MetricName};
use mp_control::{Car, Flow, InputSet, Unicycle};
use mp_cspace::nn::Layout;
use mp_cspace::{
    AnyFlow, Clearance, Demand, Embed, Factored, InputSystem, MotionCheck, MotionClearance, MotionValidity,
    Rng, Se2State, Space, StateVector, Validity,
};
use mp_geom::Aabb;
use mp_io::{Drive, Driven};
use nalgebra::{DVector, Isometry3, Point3};
use rand::RngExt;
use std::fmt::Debug;
use std::sync::Arc;

/// How far, as a part of the extent of the space, a state may be from where its input leads: rounding.
const ROUNDING: f64 = 1e-9;
/// Bounds are enlarged by this factor against rounding.
const ROUND_UP: f64 = 1.0 + 1e-9;
/// Parts of a motion shorter than this are not tested by the verifier. What is not shown free by then is not free.
const SHORTEST: f64 = 1e-12;
/// Steering angles to either side, when their number is not given.
const STEERING: usize = 2;

/// A kind of robot that can be moved by inputs.
pub trait SpeedBound: RobotKind<Space: Embed + 'static, State: StateVector, Checker: Debug> + Clone {
    /// An upper bound (m/s) on the speed of any point of the robot while no degree of freedom moves faster than its rate (m/s,
    /// rad/s).
    fn speed_bound(&self, rates: &[f64]) -> f64;
}

/// How the states of a robot are written, and how inputs move them.
///
/// A state is a vector: the numbers of the configuration, the velocities of a robot with accelerations, and the input and the
/// duration (s) that led to it from the state before; zeros for a state that no input led to.
#[derive(Clone, Debug)]
struct System {
    drive: Drive,
    duration: f64,
    /// How many numbers a configuration has.
    numbers: usize,
    /// How many velocities a state has.
    velocities: usize,
    /// How many numbers an input has.
    inputs: usize,
}

/// The parts of a state.
#[derive(Clone, Debug)]
struct Parts<S> {
    q: S,
    velocity: Vec<f64>,
    input: Vec<f64>,
    duration: f64,
}

impl System {
    /// The number of numbers of a state.
    fn len(&self) -> usize {
        self.numbers + self.velocities + self.inputs + 1
    }

    /// The parts of a vector, if it is a state.
    fn parts<S: StateVector>(&self, state: &DVector<f64>) -> Option<Parts<S>> {
        let all = state.as_slice();
        if all.len() != self.len() {
            return None;
        }
        let (q, rest) = all.split_at(self.numbers);
        let (velocity, rest) = rest.split_at(self.velocities);
        let (input, duration) = rest.split_at(self.inputs);
        let q = S::read(q)?;
        Some(Parts { q, velocity: velocity.to_vec(), input: input.to_vec(), duration: duration[0] })
    }

    /// The vector of a state.
    fn vector<S: StateVector>(&self, parts: &Parts<S>) -> DVector<f64> {
        let mut all = Vec::with_capacity(self.len());
        parts.q.write(&mut all);
        all.extend(&parts.velocity);
        all.extend(&parts.input);
        all.push(parts.duration);
        DVector::from_vec(all)
    }

    /// The state that `input` leads to in `time` seconds.
    fn flow<C: Space<State: StateVector>>(
        &self,
        positions: &C,
        from: &Parts<C::State>,
        input: &[f64],
        time: f64,
    ) -> Parts<C::State> {
        let wheels = |flow: &dyn Fn(&Se2State) -> Se2State| {
            let (mut numbers, mut moved) = (Vec::new(), Vec::new());
            from.q.write(&mut numbers);
            Se2State::read(&numbers).map(|q| flow(&q))?.write(&mut moved);
            C::State::read(&moved)
        };
        let pair = || [input.first().copied().unwrap_or(0.0), input.get(1).copied().unwrap_or(0.0)];
        let mut velocity = from.velocity.clone();
        let q = match &self.drive {
            Drive::Car { wheelbase, .. } => {
                let car = Car::new(*wheelbase).ok();
                wheels(&|q| car.map_or(*q, |car| car.integrate(q, &pair(), time)))
            }
            Drive::Unicycle { .. } => wheels(&|q| Unicycle.integrate(q, &pair(), time)),
            Drive::Velocities { .. } => positions.moved(&from.q, input, time),
            Drive::Accelerations { .. } => {
                let mean: Vec<f64> = velocity.iter().zip(input).map(|(v, a)| v + 0.5 * time * a).collect();
                velocity.iter_mut().zip(input).for_each(|(v, a)| *v += time * a);
                positions.moved(&from.q, &mean, time)
            }
        };
        Parts { q: q.unwrap_or_else(|| from.q.clone()), velocity, input: input.to_vec(), duration: time }
    }

    /// Upper bounds on the rate of each degree of freedom on the way from `from` by the input of `to`. The rates of a robot on
    /// wheels are those along its own axes.
    fn rates<S>(&self, from: &Parts<S>, to: &Parts<S>) -> Vec<f64> {
        let input = &to.input;
        match &self.drive {
            Drive::Car { wheelbase, .. } => {
                vec![input[0].abs(), 0.0, (input[0] * input[1].tan() / wheelbase).abs()]
            }
            Drive::Unicycle { .. } => vec![input[0].abs(), 0.0, input[1].abs()],
            Drive::Velocities { .. } => input.iter().map(|u| u.abs()).collect(),
            Drive::Accelerations { .. } => {
                let fastest = |(v, a): (&f64, &f64)| v.abs().max((v + a * to.duration).abs());
                from.velocity.iter().zip(input).map(fastest).collect()
            }
        }
    }

    /// The greatest velocity of each degree of freedom that is part of a state.
    fn velocity_limits(&self) -> &[f64] {
        match &self.drive {
            Drive::Accelerations { speeds, .. } => speeds,
            _ => &[],
        }
    }

    /// The least and the greatest value of each number of an input.
    fn input_limits(&self) -> Vec<[f64; 2]> {
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
    fn allows(&self, input: &[f64]) -> bool {
        let within = |(u, [low, high]): (&f64, [f64; 2])| {
            let slack = ROUNDING * (high - low);
            (low - slack..=high + slack).contains(u)
        };
        input.iter().zip(self.input_limits()).all(within)
    }

    /// The inputs that planners choose among: `directions` of them, or the system's own choice, each at so many levels, every
    /// one a quarter of the one before.
    fn choices(&self, directions: usize, levels: u32) -> Vec<Vec<f64>> {
        let scaled = |inputs: Vec<Vec<f64>>, scale: fn(&mut Vec<f64>, f64)| {
            let level = |level: u32| {
                let factor = 0.25_f64.powi(level.min(99) as i32);
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

/// The states of a robot that moves by inputs. Its interpolation follows the input that led to a state.
///
/// Distance: that of the configurations; with velocities, the square root of the sum of its square and that of the distance of
/// the velocities, which are weighted so that their extent is that of the configurations.
#[derive(Clone, Debug)]
pub struct DrivenSpace<C> {
    positions: C,
    system: Arc<System>,
    /// Seconds: what a velocity counts as a distance.
    weight: f64,
}

impl<C: Space<State: StateVector>> DrivenSpace<C> {
    fn new(positions: C, system: System) -> Self {
        let across = 2.0 * system.velocity_limits().iter().map(|v| v * v).sum::<f64>().sqrt();
        let weight = if across > 0.0 { positions.extent() / across } else { 0.0 };
        Self { positions, system: Arc::new(system), weight }
    }

    fn parts(&self, q: &DVector<f64>) -> Option<Parts<C::State>> {
        self.system.parts(q)
    }

    /// How far the state `to` is from where its input leads from `from`; infinite when it has no input, or one beyond its limits.
    fn off_course(&self, from: &Parts<C::State>, to: &Parts<C::State>) -> f64 {
        let held = to.duration > 0.0 && to.duration <= self.system.duration * ROUND_UP;
        if !(held && self.system.allows(&to.input)) {
            return f64::INFINITY;
        }
        self.apart(&self.system.flow(&self.positions, from, &to.input, to.duration), to)
    }

    fn apart(&self, from: &Parts<C::State>, to: &Parts<C::State>) -> f64 {
        let of_velocity = from.velocity.iter().zip(&to.velocity).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        let of_position = self.positions.distance(&from.q, &to.q);
        if from.velocity.is_empty() {
            of_position
        } else {
            of_position.hypot(self.weight * of_velocity.sqrt())
        }
    }

    /// Whether the input of `to` leads there from `from`.
    fn follows(&self, from: &Parts<C::State>, to: &Parts<C::State>) -> bool {
        self.off_course(from, to) <= ROUNDING * self.extent()
    }

    fn at_rest(&self, q: C::State) -> Parts<C::State> {
        let system = &self.system;
        Parts { q, velocity: vec![0.0; system.velocities], input: vec![0.0; system.inputs], duration: 0.0 }
    }
}

impl<C: Space<State: StateVector>> Space for DrivenSpace<C> {
    type State = DVector<f64>;

    fn distance(&self, from: &DVector<f64>, to: &DVector<f64>) -> f64 {
        match [from, to].map(|q| self.parts(q)) {
            [Some(from), Some(to)] => self.apart(&from, &to),
            _ => f64::INFINITY,
        }
    }
    fn dim(&self) -> usize {
        self.positions.dim() + self.system.velocities
    }
    fn extent(&self) -> f64 {
        let extent = self.positions.extent();
        if self.system.velocities == 0 { extent } else { extent.hypot(extent) }
    }
    fn interpolate_into(&self, from: &DVector<f64>, to: &DVector<f64>, t: f64, out: &mut DVector<f64>) {
        let ends = [from, to].map(|q| self.parts(q));
        *out = match ends {
            _ if t <= 0.0 || from == to => from.clone(),
            _ if t >= 1.0 => to.clone(),
            [Some(a), Some(b)] if self.follows(&a, &b) => {
                self.system.vector(&self.system.flow(&self.positions, &a, &b.input, t * b.duration))
            }
            [Some(a), Some(b)] => {
                let mut straight = self.at_rest(self.positions.interpolate(&a.q, &b.q, t));
                let between = a.velocity.iter().zip(&b.velocity).map(|(v, w)| v + (w - v) * t);
                straight.velocity = between.collect();
                self.system.vector(&straight)
            }
            _ => {
                if t < 0.5 {
                    from.clone()
                } else {
                    to.clone()
                }
            }
        };
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> DVector<f64> {
        let n = self.positions.dim();
        let mut state = self.at_rest(self.positions.unit_cube_to_state(&u[..n]));
        let limits = self.system.velocity_limits();
        state.velocity = limits.iter().zip(&u[n..]).map(|(limit, u)| limit * (2.0 * u - 1.0)).collect();
        self.system.vector(&state)
    }
    fn sample_uniform(&self, rng: &mut Rng) -> DVector<f64> {
        let mut state = self.at_rest(self.positions.sample_uniform(rng));
        let limits = self.system.velocity_limits();
        state.velocity = limits.iter().map(|limit| limit * (2.0 * rng.random::<f64>() - 1.0)).collect();
        self.system.vector(&state)
    }
    fn contains(&self, q: &DVector<f64>) -> bool {
        let Some(parts) = self.parts(q) else { return false };
        let slow = |(v, limit): (&f64, &f64)| v.abs() <= limit * ROUND_UP;
        self.positions.contains(&parts.q)
            && parts.velocity.iter().zip(self.system.velocity_limits()).all(slow)
            && parts.input.iter().chain([&parts.duration]).all(|x| x.is_finite())
    }
}

/// Factors: those of the configurations, then the velocities.
impl<C: Factored<State: StateVector>> Factored for DrivenSpace<C> {
    fn factors(&self) -> usize {
        self.positions.factors() + self.system.velocities
    }
    fn each_factor(&self, from: &DVector<f64>, to: &DVector<f64>, f: &mut impl FnMut(usize, f64)) {
        let [Some(from), Some(to)] = [from, to].map(|q| self.parts(q)) else { return };
        self.positions.each_factor(&from.q, &to.q, f);
        let first = self.positions.factors();
        for (i, (a, b)) in from.velocity.iter().zip(&to.velocity).enumerate() {
            f(first + i, (b - a).abs());
        }
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        match factor.checked_sub(self.positions.factors()) {
            None => self.positions.factor_extent(factor),
            Some(i) => self.system.velocity_limits().get(i).map_or(0.0, |limit| 2.0 * limit),
        }
    }
    fn interpolate_factor(
        &self,
        factor: usize,
        from: &DVector<f64>,
        to: &DVector<f64>,
        t: f64,
        out: &mut DVector<f64>,
    ) {
        let [Some(from), Some(to), Some(mut q)] = [from, to, &*out].map(|q| self.parts(q)) else { return };
        match factor.checked_sub(self.positions.factors()) {
            None => self.positions.interpolate_factor(factor, &from.q, &to.q, t, &mut q.q),
            Some(i) => {
                if let (Some(v), Some(a), Some(b)) =
                    (q.velocity.get_mut(i), from.velocity.get(i), to.velocity.get(i))
                {
                    *v = a + (b - a) * t;
                }
            }
        }
        *out = self.system.vector(&q);
    }
    fn factor_layouts(&self) -> Vec<Layout> {
        let velocities = std::iter::repeat_n(Layout::euclidean(1), self.system.velocities);
        self.positions.factor_layouts().into_iter().chain(velocities).collect()
    }
    fn embed_factors(&self, state: &DVector<f64>, put: &mut impl FnMut(usize, f64)) {
        let Some(parts) = self.parts(state) else { return };
        self.positions.embed_factors(&parts.q, put);
        let first = self.positions.factors();
        parts.velocity.iter().enumerate().for_each(|(i, v)| put(first + i, *v));
    }
}

impl<C: Embed<State: StateVector>> Embed for DrivenSpace<C> {
    fn layout(&self) -> Layout {
        match self.system.velocities {
            0 => self.positions.layout(),
            n => self.positions.layout().beside(Layout::euclidean(n)),
        }
    }
    fn embed(&self, state: &DVector<f64>, out: &mut [f64]) -> usize {
        let Some(parts) = self.parts(state) else { return self.layout().dim() };
        let n = self.positions.embed(&parts.q, out);
        parts.velocity.iter().zip(&mut out[n..]).for_each(|(v, x)| *x = self.weight * v);
        n + parts.velocity.len()
    }
}

/// Whether a robot that moves by inputs is free, and how far its motions move it.
#[derive(Clone, Debug)]
pub struct DrivenChecker<K: SpeedBound> {
    robot: Arc<K>,
    space: DrivenSpace<K::Space>,
    checker: K::Checker,
}

impl<K: SpeedBound> Queries for DrivenChecker<K> {
    fn queries(&self) -> u64 {
        self.checker.queries()
    }
}

impl<K: SpeedBound> Validity<DVector<f64>> for DrivenChecker<K> {
    fn is_valid(&mut self, q: &DVector<f64>) -> bool {
        self.space.parts(q).is_some_and(|parts| self.checker.is_valid(&parts.q))
    }
}

impl<K: SpeedBound> Clearance<DVector<f64>> for DrivenChecker<K> {
    /// None outside of the bounds, which curved motions may leave.
    fn clearance(&mut self, q: &DVector<f64>, enough: f64) -> f64 {
        match self.space.parts(q) {
            Some(parts) if self.space.positions.contains(&parts.q) => {
                self.checker.clearance(&parts.q, enough)
            }
            _ => 0.0,
        }
    }
    fn in_contact(&mut self, q: &DVector<f64>) -> bool {
        self.space.parts(q).is_none_or(|parts| self.checker.in_contact(&parts.q))
    }
}

impl<K: SpeedBound> MotionClearance<DVector<f64>> for DrivenChecker<K> {
    fn motion_bound(&self, from: &DVector<f64>, to: &DVector<f64>) -> f64 {
        if from == to {
            return 0.0;
        }
        match [from, to].map(|q| self.space.parts(q)) {
            [Some(from), Some(to)] if to.duration > 0.0 => {
                self.robot.speed_bound(&self.space.system.rates(&from, &to)) * to.duration * ROUND_UP
            }
            // Straight motions are made nowhere; pictures of paths that are not valid ask for them.
            [Some(from), Some(to)] => self.checker.motion_bound(&from.q, &to.q),
            _ => f64::INFINITY,
        }
    }
}

/// Proves motions by inputs free of collision: replays the input, and asks the verifier of the robot about single moments. Its
/// answers are compared with how far the robot moves, and the motion is halved until all of it is shown free.
///
/// The answer is [`Unproven`](MotionCheck::Unproven) for a state that its input does not lead to, and for motions with a tested
/// moment of less clearance than the tolerance, a tenth of the robot's.
#[derive(Clone, Debug)]
pub struct DrivenVerifier<'c, K: SpeedBound> {
    scene: &'c DrivenScene<K>,
    verifier: K::Verifier<'c>,
}

impl<K: SpeedBound> MotionValidity<DVector<f64>> for DrivenVerifier<'_, K> {
    fn check_motion(&mut self, from: &DVector<f64>, to: &DVector<f64>) -> MotionCheck {
        let space = &self.scene.space;
        let [Some(a), Some(b)] = [from, to].map(|q| space.contains(q).then(|| space.parts(q)).flatten())
        else {
            return MotionCheck::Unproven { at: 0.0 };
        };
        if from == to {
            return self.verifier.check_motion(&a.q, &a.q);
        }
        let gap = space.off_course(&a, &b);
        if gap > ROUNDING * space.extent() {
            return MotionCheck::Unproven { at: 1.0 };
        }
        let travel = self.scene.robot.speed_bound(&space.system.rates(&a, &b)) * b.duration * ROUND_UP;
        let tolerance = 0.1 * self.scene.robot.tolerance();
        let mut least = f64::INFINITY;
        let mut open = vec![(0.0_f64, 1.0_f64)];
        while let Some((begin, end)) = open.pop() {
            let (at, half) = (0.5 * (begin + end), 0.5 * (end - begin));
            let now = space.system.flow(&space.positions, &a, &b.input, at * b.duration);
            let near = half * travel;
            match self.verifier.check_motion(&now.q, &now.q) {
                _ if !space.positions.contains(&now.q) => return MotionCheck::Unproven { at },
                MotionCheck::Free { clearance } if clearance >= (near + tolerance) * ROUND_UP => {
                    least = least.min(clearance - near);
                }
                MotionCheck::Free { clearance } if clearance >= tolerance && half >= SHORTEST => {
                    open.extend([(at, end), (begin, at)]);
                }
                MotionCheck::Collision { .. } => return MotionCheck::Collision { at },
                _ => return MotionCheck::Unproven { at },
            }
        }
        // The last state itself, as written.
        match self.verifier.check_motion(&b.q, &b.q) {
            MotionCheck::Free { clearance } => MotionCheck::Free { clearance: least.min(clearance) },
            MotionCheck::Collision { .. } => MotionCheck::Collision { at: 1.0 },
            MotionCheck::Unproven { .. } => MotionCheck::Unproven { at: 1.0 },
        }
    }
}

/// A robot of another kind that moves by inputs, each held for a time.
#[derive(Clone, Debug)]
pub struct DrivenScene<K: SpeedBound> {
    robot: Arc<K>,
    space: DrivenSpace<K::Space>,
    checker: DrivenChecker<K>,
    start: DVector<f64>,
    goals: Vec<DVector<f64>>,
    goal_parts: Vec<Vec<GoalPart>>,
    columns: Vec<Column>,
}

impl<K: SpeedBound> DrivenScene<K> {
    /// `robot` moved as `driven` says. It starts with `velocity`, if its velocities are part of its state, or at rest when
    /// that is empty. `goals` say what is asked of each number of the configuration, then of the velocities; what they do not
    /// mention is free.
    ///
    /// # Errors
    /// When the robot cannot move so.
    pub fn new(
        robot: K,
        driven: &Driven,
        velocity: &[f64],
        mut goals: Vec<Vec<GoalPart>>,
    ) -> Result<Self, Error> {
        let own = robot.columns();
        let mut numbers = Vec::new();
        robot.start().write(&mut numbers);
        let names: Vec<(String, String)> = own.iter().map(|c| (c.name.clone(), c.unit.clone())).collect();
        let inputs = driven.input_names(&names);
        let velocities = match driven.drive {
            Drive::Accelerations { .. } => own.len(),
            _ => 0,
        };
        let mut columns = own.clone();
        columns.extend(
            own.iter()
                .take(velocities)
                .map(|c| Column::new(format!("v_{}", c.name), format!("{}/s", c.unit))),
        );
        goals.iter_mut().for_each(|goal| goal.resize(columns.len(), GoalPart::Free));
        columns.extend(inputs.iter().map(|(name, unit)| Column::new(name, unit)));
        columns.push(Column::new("duration", "s"));
        goals.iter_mut().for_each(|goal| goal.resize(columns.len(), GoalPart::Free));
        let system = System {
            drive: driven.drive.clone(),
            duration: driven.duration,
            numbers: numbers.len(),
            velocities,
            inputs: inputs.len(),
        };
        let space = DrivenSpace::new(robot.space().clone(), system);
        let mut start = space.at_rest(robot.start().clone());
        start.velocity.iter_mut().zip(velocity).for_each(|(v, given)| *v = *given);
        let start = space.system.vector(&start);
        let robot = Arc::new(robot);
        let checker = DrivenChecker {
            robot: Arc::clone(&robot),
            space: space.clone(),
            checker: robot.checker().clone(),
        };
        let ends = vec![start.clone()];
        let mut scene = Self { robot, space, checker, start, goals: ends, goal_parts: goals, columns };
        scene.goals = scene.examples();
        Ok(scene)
    }

    /// A configuration for each goal, which no input led to.
    fn examples(&self) -> Vec<DVector<f64>> {
        examples(self, &self.goal_parts)
    }

    /// The parts of a state; the start for a vector that is none.
    fn parts(&self, q: &DVector<f64>) -> Parts<K::State> {
        self.space.parts(q).unwrap_or_else(|| self.space.at_rest(self.robot.start().clone()))
    }
}

impl<K: SpeedBound> RobotKind for DrivenScene<K> {
    type State = DVector<f64>;
    type Space = DrivenSpace<K::Space>;
    type Checker = DrivenChecker<K>;
    type Verifier<'c>
        = DrivenVerifier<'c, K>
    where
        Self: 'c;

    fn name(&self) -> &str {
        self.robot.name()
    }
    fn space_name(&self) -> String {
        let by = match self.space.system.drive {
            Drive::Car { .. } => "a car",
            Drive::Unicycle { .. } => "a unicycle",
            Drive::Velocities { .. } => "by velocities",
            Drive::Accelerations { .. } => "by accelerations",
        };
        format!("{}, {by}", self.robot.space_name())
    }
    fn space(&self) -> &Self::Space {
        &self.space
    }
    fn start(&self) -> &DVector<f64> {
        &self.start
    }
    fn goals(&self) -> &[DVector<f64>] {
        &self.goals
    }
    fn goal_parts(&self) -> Option<&[Vec<GoalPart>]> {
        Some(&self.goal_parts)
    }

    /// Goals keep the widths of the intervals of the first goal of the scene.
    fn with_ends(&self, start: DVector<f64>, goals: Vec<DVector<f64>>) -> Result<Self, Error> {
        let first = self.goal_parts.first().cloned().unwrap_or_default();
        let around = |q: &DVector<f64>| {
            let part = |(part, x): (&GoalPart, f64)| match *part {
                GoalPart::Between([low, high]) => {
                    let half = 0.5 * (high - low);
                    GoalPart::Between([x - half, x + half])
                }
                GoalPart::Exactly(_) => GoalPart::Exactly(x),
                GoalPart::Free => GoalPart::Free,
            };
            first.iter().zip(self.row(q)).map(part).collect()
        };
        let goal_parts = goals.iter().map(around).collect();
        let mut parts = self.parts(&start);
        let robot = self.robot.with_ends(parts.q.clone(), goals.iter().map(|q| self.parts(q).q).collect())?;
        (parts.input, parts.duration) = (vec![0.0; self.space.system.inputs], 0.0);
        let start = self.space.system.vector(&parts);
        let mut scene = Self { robot: Arc::new(robot), start, goal_parts, ..self.clone() };
        scene.goals = scene.examples();
        Ok(scene)
    }

    fn can_move(&self, from: &DVector<f64>, to: &DVector<f64>) -> bool {
        match [from, to].map(|q| self.space.parts(q)) {
            [Some(a), Some(b)] => from == to || self.space.follows(&a, &b),
            _ => false,
        }
    }
    fn demands(&self) -> &'static [Demand] {
        &[Demand::OneWay, Demand::Inputs]
    }
    fn input_system(&self) -> Option<InputSystem<'_, DVector<f64>>> {
        let space = &self.space;
        let flow: AnyFlow<'_, DVector<f64>> =
            Arc::new(move |from: &DVector<f64>, input: &[f64], time| match space.parts(from) {
                Some(parts) => space.system.vector(&space.system.flow(&space.positions, &parts, input, time)),
                None => from.clone(),
            });
        let system = Arc::clone(&self.space.system);
        let inputs = Arc::new(move |directions, levels| system.choices(directions, levels));
        Some(InputSystem { flow, inputs, duration: self.space.system.duration })
    }
    fn default_planner(&self) -> &'static str {
        "rsrt"
    }

    fn checker(&self) -> &DrivenChecker<K> {
        &self.checker
    }
    fn verifier(&self) -> Result<DrivenVerifier<'_, K>, Error> {
        Ok(DrivenVerifier { scene: self, verifier: self.robot.verifier()? })
    }
    fn tolerance(&self) -> f64 {
        self.robot.tolerance()
    }
    fn accuracy(&self) -> f64 {
        self.robot.accuracy()
    }
    fn measured(&self, metric: MetricName) -> Result<Measured<'_, DVector<f64>>, Error> {
        match metric {
            MetricName::Default => Ok(Measured::by_coordinates(&self.space)),
            _ => Err(no_metric(metric, "a robot that moves by inputs", &[MetricName::Default])),
        }
    }

    fn touching(&self, q: &DVector<f64>) -> Vec<Touch> {
        self.robot.touching(&self.parts(q).q)
    }
    fn nearest_free(&self, q: &DVector<f64>) -> Option<DVector<f64>> {
        let mut parts = self.parts(q);
        parts.q = self.robot.nearest_free(&parts.q)?;
        Some(self.space.system.vector(&parts))
    }
    fn lint(&self) -> Vec<String> {
        self.robot.lint()
    }
    fn fault(&self, end: End, message: String, help: String) -> Error {
        self.robot.fault(end, message, help)
    }

    fn columns(&self) -> Vec<Column> {
        self.columns.clone()
    }
    fn limits(&self) -> Vec<Option<[f64; 2]>> {
        let system = &self.space.system;
        let velocities = system.velocity_limits().iter().map(|v| Some([-v, *v]));
        let inputs = system.input_limits().into_iter().map(Some);
        let limits = self.robot.limits().into_iter().chain(velocities).chain(inputs);
        limits.chain([Some([0.0, system.duration])]).collect()
    }
    fn details(&self) -> Vec<(String, String)> {
        let mut details = self.robot.details();
        details.retain(|(name, _)| name != "goal is");
        let system = &self.space.system;
        let brief = crate::brief;
        let list = |values: &[f64]| values.iter().map(|v| brief(*v)).collect::<Vec<_>>().join(" ");
        let moves = match &system.drive {
            Drive::Car { speed, wheelbase, steering, reverse } => format!(
                "a car: {} m/s{}, {} m between its axles, steers by {} rad, turns in circles of {} m",
                brief(*speed),
                if *reverse { "" } else { " forward only" },
                brief(*wheelbase),
                brief(*steering),
                brief(wheelbase / steering.tan())
            ),
            Drive::Unicycle { speed, turning, reverse } => format!(
                "a unicycle: {} m/s{}, turns by {} rad/s",
                brief(*speed),
                if *reverse { "" } else { " forward only" },
                brief(*turning)
            ),
            Drive::Velocities { speeds } => format!("velocities up to {}", list(speeds)),
            Drive::Accelerations { speeds, accelerations } => {
                format!("velocities up to {}, accelerations up to {}", list(speeds), list(accelerations))
            }
        };
        details.push(("moves by".to_owned(), moves));
        details.push(("inputs".to_owned(), format!("each held for up to {} s", brief(system.duration))));
        let free = self.columns.len() - system.inputs - 1;
        let goals = self.goal_parts.iter().map(|goal| crate::goals::written(self, &goal[..free]));
        details.extend(goals.map(|goal| ("goal is".to_owned(), goal)));
        details
    }
    fn row(&self, q: &DVector<f64>) -> Vec<f64> {
        let parts = self.parts(q);
        let mut row = self.robot.row(&parts.q);
        row.extend(parts.velocity);
        row.extend(parts.input);
        row.push(parts.duration);
        row
    }
    fn state(&self, row: &[f64]) -> DVector<f64> {
        let system = &self.space.system;
        let own = row.len().saturating_sub(system.velocities + system.inputs + 1);
        let (q, rest) = row.split_at(own);
        let (velocity, rest) = rest.split_at(system.velocities);
        let (input, duration) = rest.split_at(system.inputs);
        let [velocity, input] = [velocity, input].map(<[f64]>::to_vec);
        let duration = duration.first().copied().unwrap_or(0.0);
        system.vector(&Parts { q: self.robot.state(q), velocity, input, duration })
    }
    fn odd_rows(&self, rows: &[Vec<f64>]) -> Option<String> {
        let system = &self.space.system;
        let states: Vec<_> = rows.iter().map(|row| self.parts(&self.state(row))).collect();
        let off = states.windows(2).map(|pair| self.space.off_course(&pair[0], &pair[1]));
        let (i, off) = off.enumerate().find(|(_, off)| *off > ROUNDING * self.space.extent())?;
        let b = &states[i + 1];
        Some(match off.is_finite() {
            true => format!(
                "configuration {} is not where its input leads from the one before, but {} off",
                i + 2,
                crate::brief(off)
            ),
            false if !system.allows(&b.input) => {
                format!("the input of configuration {} is beyond its limits", i + 2)
            }
            false => format!(
                "the input of configuration {} is held for {} s, not for up to {} s",
                i + 2,
                crate::brief(b.duration),
                crate::brief(system.duration)
            ),
        })
    }

    fn bodies(&self) -> Vec<Body> {
        self.robot.bodies()
    }
    fn poses(&self, q: &DVector<f64>) -> Vec<Isometry3<f64>> {
        self.robot.poses(&self.parts(q).q)
    }
    fn traced(&self, q: &DVector<f64>) -> Point3<f64> {
        self.robot.traced(&self.parts(q).q)
    }
    fn seconds(&self, _: &DVector<f64>, to: &DVector<f64>) -> Option<f64> {
        Some(self.parts(to).duration.max(0.0))
    }
    fn picture_spacing(&self) -> f64 {
        self.robot.picture_spacing()
    }
    fn picture_bounds(&self) -> Option<Aabb> {
        self.robot.picture_bounds()
    }
    fn is_planar(&self) -> bool {
        self.robot.is_planar()
    }
}
