//! Robots that move by inputs: cars, unicycles, and robots with limited velocities or accelerations.

mod check;
mod drivable;
mod space;
mod steer;
mod system;

use super::model::{self, DriveModel, MotionModel};
use super::{
    Appearance, Body, Column, Contact, Description, End, HAIR, Measured, Motion, at_limit, no_metric,
};
use crate::goals::{GoalPart, examples};
use crate::numbers::rounding;
use crate::robot::motion::TypedMotion;
use crate::turns::{continued, turning};
use crate::{Error, MetricName};
use check::{DrivenChecker, DrivenVerifier};
pub use drivable::Drivable;
use mp_cspace::shorten::Effort;
use mp_cspace::{
    AnyFlow, Configuration, Demand, Embed, InputSystem, Interrupt, Interrupted, MotionCheck, MotionValidity,
    Path, Rng, Space,
};
use mp_geom::Aabb;
use mp_io::{Drive, Driven, Follower};
use nalgebra::{Isometry3, Point3};
use space::DrivenSpace;
use std::f64::consts::TAU;
use std::fmt::Debug;
use std::sync::Arc;
use system::{Parts, System};

/// Bounds are enlarged by this factor against rounding.
const ROUND_UP: f64 = 1.0 + 1e-9;

/// A kind of robot that can be moved by inputs.
pub trait SpeedBound:
    Motion
    + Description
    + Appearance
    + TypedMotion<Space: Embed + 'static, Checker: Debug>
    + Clone
    + Debug
    + Send
    + Sync
    + 'static
{
    /// Whether the last number of a configuration is the time (s).
    const TIMED: bool = false;

    /// An upper bound (m/s) on the speed at which any point of the robot and an obstacle come nearer while no degree of freedom
    /// moves faster than its rate (m/s, rad/s).
    fn speed_bound(&self, rates: &[f64]) -> f64;

    /// What the verifier says of a single configuration: free with its clearance (m), which need not be known farther than
    /// `enough`. By default it is asked about the motion from the configuration to itself; to be overridden where the clearance of
    /// that is only a lower bound.
    fn check_state<'c>(verifier: &mut Self::Verifier<'c>, q: &Configuration, _enough: f64) -> MotionCheck
    where
        Self: 'c,
    {
        verifier.check_motion(q, q)
    }

    /// Name and unit of each degree of freedom: by default those of the numbers of a configuration, without the time.
    fn degrees_of_freedom(&self) -> Vec<Column> {
        let mut columns = self.columns();
        columns.truncate(columns.len() - usize::from(Self::TIMED));
        columns
    }
}

/// The greatest speed of a robot moved by inputs, in the metric of its space per second.
pub fn greatest_speed<C: Space>(space: &C, driven: &Driven) -> f64 {
    let middle = space.unit_cube_to_state(&vec![0.5; space.dim()]);
    let moment = 1e-3;
    let moved = space.moved(&middle, &System::greatest_rates(&driven.drive), moment);
    // Distances of short motions are exact but for rounding.
    moved.map_or(f64::INFINITY, |moved| space.distance(&middle, &moved) / moment * (1.0 + 1e-6))
}

/// A robot of another kind that moves by inputs, each held for a time.
#[derive(Clone, Debug)]
pub struct DrivenScene {
    robot: Arc<dyn Drivable>,
    space: DrivenSpace,
    checker: DrivenChecker,
    start: Configuration,
    goals: Vec<Configuration>,
    goal_parts: Vec<Vec<GoalPart>>,
    columns: Vec<Column>,
}

impl DrivenScene {
    /// `robot` moved as `driven` says. It starts with `velocity`, if its velocities are part of its state, or at rest when
    /// that is empty. `goals` say what is asked of each number of the configuration, then of the velocities; what they do not
    /// mention is free.
    ///
    /// # Errors
    /// When the robot cannot move so.
    pub fn new(
        robot: impl Drivable,
        driven: &Driven,
        velocity: &[f64],
        goals: Vec<Vec<GoalPart>>,
    ) -> Result<Self, Error> {
        Self::of(Arc::new(robot), driven, velocity, goals)
    }

    fn of(
        robot: Arc<dyn Drivable>,
        driven: &Driven,
        velocity: &[f64],
        mut goals: Vec<Vec<GoalPart>>,
    ) -> Result<Self, Error> {
        let own = robot.columns();
        let degrees = robot.degrees();
        let names: Vec<(String, String)> = degrees.iter().map(|c| (c.name.clone(), c.unit.clone())).collect();
        let inputs = driven.input_names(&names);
        let velocities = match driven.drive {
            Drive::Accelerations { .. } => degrees.len(),
            _ => 0,
        };
        let mut columns = own;
        columns.extend(
            degrees
                .iter()
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
            numbers: robot.start().len(),
            velocities,
            inputs: inputs.len(),
            timed: robot.is_timed(),
        };
        let space = DrivenSpace::new(Arc::clone(&robot), system);
        let mut start = space.at_rest(robot.start().clone());
        start.velocity.iter_mut().zip(velocity).for_each(|(v, given)| *v = *given);
        at_velocity_limits(&space.system, &mut start.velocity);
        let start = space.system.vector(&start);
        let checker = DrivenChecker::new(&robot, &space, robot.any_checker());
        let ends = vec![start.clone()];
        let mut scene = Self { robot, space, checker, start, goals: ends, goal_parts: goals, columns };
        scene.goals = scene.examples();
        Ok(scene)
    }

    /// A configuration for each goal, which no input led to.
    fn examples(&self) -> Vec<Configuration> {
        examples(self, &self.goal_parts)
    }

    /// The parts of a state; those of the start, at rest, if `q` does not have the numbers of a state.
    fn parts(&self, q: &Configuration) -> Parts {
        self.space.parts(q).unwrap_or_else(|| self.space.at_rest(self.robot.start().clone()))
    }
}

/// Puts velocities that are a [`HAIR`] beyond their limits at these.
fn at_velocity_limits(system: &System, velocity: &mut [f64]) {
    for (v, most) in velocity.iter_mut().zip(system.velocity_limits()) {
        *v = at_limit(*v, [-most, *most], HAIR);
    }
}

impl TypedMotion for DrivenScene {
    type Space = DrivenSpace;
    type Checker = DrivenChecker;
    type Verifier<'c> = DrivenVerifier<'c>;
    fn space(&self) -> &Self::Space {
        &self.space
    }
    /// Goals keep the widths of the intervals of the first goal of the scene.
    fn with_ends(&self, start: Configuration, goals: Vec<Configuration>) -> Result<Self, Error> {
        let first = self.goal_parts.first().cloned().unwrap_or_default();
        let around = |q: &Configuration| {
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
        let places = goals.iter().map(|q| self.parts(q).q).collect();
        let robot = self.robot.with_other_ends(parts.q.clone(), places)?;
        (parts.input, parts.duration) = (vec![0.0; self.space.system.inputs], 0.0);
        let start = self.space.system.vector(&parts);
        let mut scene = Self { robot, start, goal_parts, ..self.clone() };
        scene.goals = scene.examples();
        Ok(scene)
    }
    fn checker(&self) -> &DrivenChecker {
        &self.checker
    }
    fn verifier(&self) -> Result<DrivenVerifier<'_>, Error> {
        Ok(DrivenVerifier { scene: self, verifier: self.robot.state_verifier()? })
    }
    fn starting_as(mut self, row: &[f64]) -> Self {
        let own = self.robot.given_start().len().min(row.len());
        self.robot = self.robot.started_as(&row[..own]);
        self
    }
    fn keeping(&self, kept: f64) -> Result<Self, Error> {
        let robot = self.robot.that_keeps(kept)?;
        let checker = DrivenChecker::new(&robot, &self.space, robot.any_checker());
        Ok(Self { robot, checker, ..self.clone() })
    }
    fn checker_keeping(&self, kept: f64) -> Option<DrivenChecker> {
        Some(DrivenChecker::new(&self.robot, &self.space, self.robot.checker_that_keeps(kept)?))
    }
}

impl Motion for DrivenScene {
    fn start(&self) -> &Configuration {
        &self.start
    }
    fn goals(&self) -> &[Configuration] {
        &self.goals
    }
    fn goal_parts(&self) -> Option<&[Vec<GoalPart>]> {
        Some(&self.goal_parts)
    }
    fn can_move(&self, from: &Configuration, to: &Configuration) -> bool {
        match [from, to].map(|q| self.space.parts(q)) {
            [Some(a), Some(b)] => from == to || self.space.follows(&a, &b),
            _ => false,
        }
    }
    fn demands(&self) -> &'static [Demand] {
        &[Demand::OneWay, Demand::Inputs]
    }
    fn input_system(&self) -> Option<InputSystem<'_, Configuration>> {
        let space = &self.space;
        let flow: AnyFlow<'_, Configuration> =
            Arc::new(move |from: &Configuration, input: &[f64], time| match space.parts(from) {
                Some(parts) => {
                    space.system.vector(&space.system.flow(&space.positions(), &parts, input, time))
                }
                None => from.clone(),
            });
        let system = Arc::clone(&self.space.system);
        let inputs = Arc::new(move |directions, levels| system.choices(directions, levels));
        Some(InputSystem { flow, inputs, duration: self.space.system.duration })
    }
    fn default_planner(&self) -> &'static str {
        "rsrt"
    }
    fn shortened(
        &self,
        path: &Path<Configuration>,
        check: &mut dyn MotionValidity<Configuration>,
        effort: Effort,
        rng: &mut Rng,
    ) -> Option<Path<Configuration>> {
        Some(self.shortened_path(path, check, effort, rng))
    }
    fn make_ready(&self, interrupt: &Interrupt) -> Result<(), Interrupted> {
        self.robot.make_ready(interrupt)
    }
    fn tolerance(&self) -> f64 {
        self.robot.tolerance()
    }
    fn kept(&self) -> f64 {
        self.robot.kept()
    }
    fn accuracy(&self) -> f64 {
        self.robot.accuracy()
    }
    fn measured(&self, metric: MetricName) -> Result<Measured<'_>, Error> {
        match metric {
            MetricName::Default => Ok(Measured::by_coordinates(&self.space)),
            _ => Err(no_metric(metric, "a robot that moves by inputs", &[MetricName::Default])),
        }
    }
    fn nearest_free(&self, q: &Configuration) -> Option<Configuration> {
        let mut parts = self.parts(q);
        parts.q = self.robot.nearest_free(&parts.q)?;
        Some(self.space.system.vector(&parts))
    }
}

impl Description for DrivenScene {
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
    fn touching(&self, q: &Configuration) -> Vec<Contact> {
        self.robot.touching(&self.parts(q).q)
    }
    fn held(&self) -> Vec<(String, f64, bool)> {
        self.robot.held()
    }
    fn followers(&self) -> Vec<Follower> {
        self.robot.followers()
    }
    fn closest(&self, q: &Configuration) -> Option<(String, f64)> {
        self.robot.closest(&self.parts(q).q)
    }
    fn remedy(&self, touching: &[Contact]) -> Option<String> {
        self.robot.remedy(touching)
    }
    fn enclosures(&self, q: &Configuration) -> Vec<[String; 2]> {
        self.robot.enclosures(&self.parts(q).q)
    }
    fn lint(&self) -> Vec<String> {
        self.robot.lint()
    }
    fn end_error(&self, end: End, message: String, help: String) -> Error {
        self.robot.end_error(end, message, help)
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
        details.retain(|(name, _)| !["goal is", "speed"].contains(&name.as_str()));
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
                brief(wheelbase / mp_math::tan(*steering))
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
    fn row(&self, q: &Configuration) -> Vec<f64> {
        let parts = self.parts(q);
        let mut row = self.robot.row(&parts.q);
        row.extend(parts.velocity);
        row.extend(parts.input);
        row.push(parts.duration);
        row
    }
    fn state(&self, row: &[f64]) -> Configuration {
        let system = &self.space.system;
        let own = row.len().saturating_sub(system.velocities + system.inputs + 1);
        let (q, rest) = row.split_at(own);
        let (velocity, rest) = rest.split_at(system.velocities);
        let (input, duration) = rest.split_at(system.inputs);
        let [mut velocity, input] = [velocity, input].map(<[f64]>::to_vec);
        at_velocity_limits(system, &mut velocity);
        let duration = duration.first().copied().unwrap_or(0.0);
        system.vector(&Parts { q: self.robot.state(q), velocity, input, duration })
    }
    /// Angles without limits go on as far as inputs turn them, which may be more than half a turn.
    fn rows(&self, path: &Path<Configuration>) -> Vec<Vec<f64>> {
        let states: Vec<_> = path.states.iter().map(|q| self.parts(q)).collect();
        let rows = path.states.iter().map(|q| self.row(q)).collect();
        let turning = turning(self);
        let mut rows = continued(&turning, &self.given_start(), rows);
        // The angles of a body in space are not those that inputs turn it by.
        let named =
            self.columns.iter().zip(self.robot.degrees()).map(|(column, degree)| column.name == degree.name);
        let turning: Vec<_> = turning.into_iter().zip(named).map(|(turns, named)| turns && named).collect();
        for k in 1..rows.len() {
            let moved = self.space.system.moved(&states[k - 1], &states[k]);
            for (i, by) in moved.into_iter().enumerate().filter(|(i, _)| turning[*i]) {
                rows[k][i] += ((rows[k - 1][i] + by - rows[k][i]) / TAU).round() * TAU;
            }
        }
        rows
    }
    fn given_start(&self) -> Vec<f64> {
        let mut row = self.row(self.start());
        row.iter_mut().zip(self.robot.given_start()).for_each(|(x, given)| *x = given);
        row
    }
    fn row_fault(&self, row: &[f64]) -> Option<&'static str> {
        self.robot.row_fault(&row[..self.robot.columns().len()])
    }
    fn row_error(&self, rows: &[Vec<f64>]) -> Option<String> {
        let system = &self.space.system;
        let states: Vec<_> = rows.iter().map(|row| self.parts(&self.state(row))).collect();
        let off = states.windows(2).map(|pair| self.space.off_course(&pair[0], &pair[1]));
        let (i, off) = off.enumerate().find(|(_, off)| *off > rounding(self.space.extent()))?;
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
            false => {
                let [held, most] = crate::numbers::told_apart(b.duration, system.duration);
                format!("the input of configuration {} is held for {held} s, not for up to {most} s", i + 2)
            }
        })
    }
    fn motion_model(&self) -> Result<MotionModel, Error> {
        let (system, own) = (&self.space.system, self.robot.columns().len());
        let by = match system.drive {
            mp_io::Drive::Car { wheelbase, .. } => DriveModel::Car { wheelbase },
            mp_io::Drive::Unicycle { .. } => DriveModel::Unicycle,
            mp_io::Drive::Velocities { .. } => DriveModel::Velocities,
            mp_io::Drive::Accelerations { .. } => DriveModel::Accelerations,
        };
        let inputs = own + system.velocities;
        let drive = model::Drive { by, velocities: own, inputs, duration: inputs + system.inputs };
        Ok(MotionModel { drive: Some(drive), ..self.robot.motion_model()? })
    }
}

impl Appearance for DrivenScene {
    fn bodies(&self) -> Vec<Body> {
        self.robot.bodies()
    }
    fn moving_obstacles(&self) -> usize {
        self.robot.moving_obstacles()
    }
    fn poses(&self, q: &Configuration) -> Vec<Isometry3<f64>> {
        self.robot.poses(&self.parts(q).q)
    }
    fn traced(&self, q: &Configuration) -> Point3<f64> {
        self.robot.traced(&self.parts(q).q)
    }
    fn seconds(&self, _: &Configuration, to: &Configuration) -> Option<f64> {
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
