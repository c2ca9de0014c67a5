//! Any robot under a constraint of one's own: a function that says which configurations may be.

use super::motion::{AnyChecker, AnyMotion, AnyVerifier, Counting};
use super::{
    Appearance, Body, Column, Contact, Description, Deviation, End, Measured, Motion, MotionModel,
    PathFormat, Queries, Robot,
};
use crate::{Error, GoalPart, Length, MetricName};
use mp_cspace::erased::AnyFactored;
use mp_cspace::{
    Clearance, ClearanceSearch, Configuration, Curve, Demand, InputSystem, Interrupt, Interrupted,
    IntervalClearance, LeastClearance, MotionCheck, MotionClearance, MotionInterval, MotionValidity,
    ObstacleKnowledge, Space as _, Validity,
};
use mp_geom::Aabb;
use mp_io::Follower;
use nalgebra::{Isometry3, Point3};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Whether a constraint holds at a row of numbers.
type Holds = dyn Fn(&[f64]) -> bool + Send + Sync;

/// A function that says which configurations may be: see `Scene::under` of mp-plan.
///
/// Nothing is known of it between configurations, so that it is sampled along motions.
#[derive(Clone)]
pub struct Constraint {
    name: String,
    holds: Arc<Holds>,
    every: Length,
}

impl fmt::Debug for Constraint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Constraint")
            .field("name", &self.name)
            .field("every", &self.every)
            .finish_non_exhaustive()
    }
}

impl Constraint {
    /// The constraint that messages call `name`. `holds` is asked about rows of numbers as the columns of the scene say, at states of
    /// motions that are at most `every` apart; of a finished path at states four times as close. The same row must get the same answer.
    #[must_use]
    pub fn new(name: &str, every: Length, holds: impl Fn(&[f64]) -> bool + Send + Sync + 'static) -> Self {
        Self { name: name.to_owned(), holds: Arc::new(holds), every }
    }
}

/// How much closer the verifier looks than the check while planning.
const FINER: f64 = 4.0;
/// In how many parts a motion by inputs is measured: it is longer than its ends are apart.
const MEASURED: u32 = 64;

/// A robot under a [`Constraint`]. All but that it takes from the robot.
#[derive(Clone, Debug)]
pub struct Constrained {
    robot: Arc<dyn Robot>,
    constraint: Constraint,
    /// How far apart states are tested, in the metric of the space.
    every: f64,
}

impl Constrained {
    /// # Errors
    /// When the distance between tested states is not valid in the space of the robot.
    pub fn new(robot: Arc<dyn Robot>, constraint: Constraint) -> Result<Self, Error> {
        let every = constraint.every.resolution_in(&robot.any_space());
        let every = every.map_err(|e| Error::new(format!("the constraint `{}`: {e}", constraint.name)))?;
        Ok(Self { robot, constraint, every })
    }

    fn holds(&self, q: &Configuration) -> bool {
        (self.constraint.holds)(&self.robot.row(q))
    }

    /// How long a motion is, in the metric of the space: where it is not at even speed, as if it were as fast as at its fastest.
    fn length(&self, from: &Configuration, to: &Configuration) -> f64 {
        let space = self.robot.any_space();
        if self.robot.input_system().is_none() {
            return space.distance(from, to);
        }
        let mut ends = [from.clone(), from.clone()];
        let parts = (1..=MEASURED).map(|i| {
            ends.swap(0, 1);
            space.interpolate_into(from, to, f64::from(i) / f64::from(MEASURED), &mut ends[1]);
            space.distance(&ends[0], &ends[1])
        });
        f64::from(MEASURED) * parts.fold(0.0, f64::max)
    }

    /// The robot without the constraint.
    #[must_use]
    pub fn robot(&self) -> &Arc<dyn Robot> {
        &self.robot
    }

    /// Another robot under the same constraint.
    #[must_use]
    pub fn around(&self, robot: Arc<dyn Robot>) -> Arc<dyn Robot> {
        Arc::new(Self { robot, ..self.clone() })
    }
}

/// The check while planning.
#[derive(Clone, Debug)]
struct Check {
    inner: AnyChecker,
    robot: Constrained,
    /// The motion that was asked about last, and its length.
    last: Option<([Configuration; 2], f64)>,
}

impl Check {
    fn length(&mut self, from: &Configuration, to: &Configuration) -> f64 {
        match &self.last {
            Some(([a, b], length)) if a == from && b == to => *length,
            _ => {
                let length = self.robot.length(from, to);
                self.last = Some(([from.clone(), to.clone()], length));
                length
            }
        }
    }
}

impl Queries for Check {
    fn queries(&self) -> u64 {
        self.inner.queries()
    }
}

impl Validity<Configuration> for Check {
    fn is_valid(&mut self, q: &Configuration) -> bool {
        self.robot.holds(q) && self.inner.is_valid(q)
    }
}

impl Clearance<Configuration> for Check {
    fn clearance(&mut self, q: &Configuration, enough: f64) -> f64 {
        if self.robot.holds(q) { self.inner.clearance(q, enough) } else { 0.0 }
    }
    fn obstacle_clearance(&mut self, q: &Configuration, enough: f64) -> f64 {
        self.inner.obstacle_clearance(q, enough)
    }
    fn in_contact(&mut self, q: &Configuration) -> bool {
        !self.robot.holds(q) || self.inner.in_contact(q)
    }
}

impl MotionClearance<Configuration> for Check {
    fn motion_bound(&self, from: &Configuration, to: &Configuration) -> f64 {
        self.inner.motion_bound(from, to)
    }
    /// Free no farther than the constraint was tested.
    fn interval_clearance(&mut self, interval: &MotionInterval<'_, Configuration>) -> IntervalClearance {
        if !self.robot.holds(interval.middle) {
            return IntervalClearance::Collision { at: 0.0 };
        }
        let tested = 0.5 * self.robot.every / self.length(interval.from, interval.to);
        match self.inner.interval_clearance(interval) {
            IntervalClearance::FreeOver { part } => IntervalClearance::FreeOver { part: part.min(tested) },
            IntervalClearance::Free { clearance } => {
                let beyond = (clearance - interval.margin) / interval.travel;
                let part = if beyond >= 1.0 || interval.travel == 0.0 { beyond.max(1.0) } else { beyond };
                IntervalClearance::FreeOver { part: (part * interval.half).min(tested) }
            }
            refused => refused,
        }
    }
    fn least_along(&mut self, search: &ClearanceSearch<'_, Configuration>) -> LeastClearance {
        self.inner.least_along(search)
    }
    fn contact_first(&self) -> bool {
        self.inner.contact_first()
    }
}

/// The check of finished paths: the verifier of the robot, and then the constraint at states from one end to the other.
#[derive(Clone)]
struct Verifier<'c> {
    inner: AnyVerifier<'c>,
    robot: &'c Constrained,
}

impl MotionValidity<Configuration> for Verifier<'_> {
    fn check_motion(&mut self, from: &Configuration, to: &Configuration) -> MotionCheck {
        let checked = self.inner.check_motion(from, to);
        if !checked.is_free() {
            return checked;
        }
        let space = self.robot.robot.any_space();
        let parts = (FINER * self.robot.length(from, to) / self.robot.every).ceil().max(1.0);
        let mut q = from.clone();
        for i in 0..=parts as u64 {
            let at = i as f64 / parts;
            if self.is_interrupted() {
                return MotionCheck::Unproven { at };
            }
            space.interpolate_into(from, to, at, &mut q);
            if !self.robot.holds(&q) {
                return MotionCheck::Collision { at };
            }
        }
        checked
    }
    fn check_curve(&mut self, curve: &dyn Curve) -> Option<MotionCheck> {
        let checked = self.inner.check_curve(curve)?;
        if !checked.is_free() {
            return Some(checked);
        }
        let (space, pieces) = (self.robot.robot.any_space(), curve.pieces());
        let state = |piece: usize, u: f64| -> Configuration {
            let value = |i| curve.polynomial(piece, i).iter().rev().fold(0.0, |sum, c| sum * u + c);
            (0..self.robot.columns().len()).map(value).collect()
        };
        for piece in 0..pieces {
            // Parts in order, from the first on. A part is halved until Taylor's formula about its middle shows that nothing in it is far
            // from there. That its ends are near each other would not do: the curve may go far between them and come back.
            let mut open = vec![(0.0, 1.0)];
            while let Some((a, b)) = open.pop() {
                let at = |u: f64| (piece as f64 + u) / pieces as f64;
                if self.inner.is_interrupted() {
                    return Some(MotionCheck::Unproven { at: at(a) });
                }
                let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
                let reach = |i| {
                    let mut c = curve.polynomial(piece, i);
                    for first in 0..5 {
                        for k in (first..5).rev() {
                            c[k] += middle * c[k + 1];
                        }
                    }
                    c[1..].iter().rev().fold(0.0, |sum, c| (sum + c.abs()) * half)
                };
                let q = state(piece, middle);
                let reach: Vec<_> = (0..q.len()).map(reach).collect();
                let far: Configuration = q.iter().zip(&reach).map(|(q, reach)| q + reach).collect();
                // The distance of angles does not see whole turns.
                if reach.iter().any(|&reach| reach > 1.0)
                    || 2.0 * FINER * space.distance(&q, &far) > self.robot.every
                {
                    open.extend([(middle, b), (a, middle)]);
                } else if let Some(u) = [a, b].into_iter().find(|&u| !self.robot.holds(&state(piece, u))) {
                    return Some(MotionCheck::Collision { at: at(u) });
                }
            }
        }
        Some(checked)
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.inner.interrupt_by(interrupt);
    }
    fn is_interrupted(&mut self) -> bool {
        self.inner.is_interrupted()
    }
}

impl AnyMotion for Constrained {
    fn any_space(&self) -> AnyFactored<'_, Configuration> {
        self.robot.any_space()
    }
    fn any_checker(&self) -> AnyChecker {
        AnyChecker::new(Check { inner: self.robot.any_checker(), robot: self.clone(), last: None })
    }
    fn any_measure(&self) -> AnyChecker {
        self.robot.any_measure()
    }
    fn any_keeping(&self, kept: f64) -> Result<Arc<dyn Robot>, Error> {
        Ok(self.around(self.robot.any_keeping(kept)?))
    }
    fn any_with_goals(&self, kept: &[bool]) -> Option<Arc<dyn Robot>> {
        Some(self.around(self.robot.any_with_goals(kept)?))
    }
    fn any_verifier(&self) -> Result<AnyVerifier<'_>, Error> {
        Ok(AnyVerifier::new(Verifier { inner: self.robot.any_verifier()?, robot: self }))
    }
    fn any_obstacles<'c>(&'c self, counting: &Counting<'c>) -> ObstacleKnowledge<'c, Configuration> {
        self.robot.any_obstacles(counting)
    }
    fn any_with_ends(
        &self,
        start: Configuration,
        goals: Vec<Configuration>,
        row: &[f64],
    ) -> Result<Arc<dyn Robot>, Error> {
        Ok(self.around(self.robot.any_with_ends(start, goals, row)?))
    }
}

/// Methods that are those of the robot.
macro_rules! of_the_robot {
    ($(fn $name:ident(&self $(, $argument:ident: $type:ty)*) -> $answer:ty;)*) => {
        $(fn $name(&self $(, $argument: $type)*) -> $answer {
            self.robot.$name($($argument),*)
        })*
    };
}

impl Motion for Constrained {
    of_the_robot! {
        fn start(&self) -> &Configuration;
        fn goals(&self) -> &[Configuration];
        fn goal_parts(&self) -> Option<&[Vec<GoalPart>]>;
        fn can_move(&self, from: &Configuration, to: &Configuration) -> bool;
        fn demands(&self) -> &'static [Demand];
        fn input_system(&self) -> Option<InputSystem<'_, Configuration>>;
        fn default_planner(&self) -> &'static str;
        fn has_joints(&self) -> bool;
        fn effort(&self) -> mp_cspace::shorten::Effort;
        fn make_ready(&self, interrupt: &Interrupt) -> Result<(), Interrupted>;
        fn tolerance(&self) -> f64;
        fn kept(&self) -> f64;
        fn sampled(&self) -> Option<Length>;
        fn accuracy(&self) -> f64;
        fn shortcut_clearance(&self) -> f64;
        fn measured(&self, metric: MetricName) -> Result<Measured<'_>, Error>;
    }
    fn shortened(
        &self,
        path: &mp_cspace::Path<Configuration>,
        check: &mut dyn MotionValidity<Configuration>,
        effort: mp_cspace::shorten::Effort,
        rng: &mut mp_cspace::Rng,
    ) -> Option<mp_cspace::Path<Configuration>> {
        self.robot.shortened(path, check, effort, rng)
    }
    fn remembering(&self) -> Option<Arc<dyn Robot>> {
        Some(self.around(self.robot.remembering()?))
    }
    fn nearest_free(&self, q: &Configuration) -> Option<Configuration> {
        self.robot.nearest_free(q).filter(|q| self.holds(q))
    }
}

impl Description for Constrained {
    of_the_robot! {
        fn name(&self) -> &str;
        fn space_name(&self) -> String;
        fn touching(&self, q: &Configuration) -> Vec<Contact>;
        fn held(&self) -> Vec<(String, f64, bool)>;
        fn followers(&self) -> Vec<Follower>;
        fn closest(&self, q: &Configuration) -> Option<(String, f64)>;
        fn remedy(&self, touching: &[Contact]) -> Option<String>;
        fn enclosures(&self, q: &Configuration) -> Vec<[String; 2]>;
        fn lint(&self) -> Vec<String>;
        fn ends_error(&self) -> Option<String>;
        fn bounds_remedy(&self, q: &Configuration) -> String;
        fn out_of_bounds(&self, q: &Configuration) -> String;
        fn end_error(&self, end: End, message: String, help: String) -> Error;
        fn columns(&self) -> Vec<Column>;
        fn limits(&self) -> Vec<Option<[f64; 2]>>;
        fn rates(&self) -> Option<Vec<[Option<f64>; 3]>>;
        fn path_format(&self) -> PathFormat;
        fn row(&self, q: &Configuration) -> Vec<f64>;
        fn state(&self, row: &[f64]) -> Configuration;
        fn rows(&self, path: &mp_cspace::Path<Configuration>) -> Vec<Vec<f64>>;
        fn given_start(&self) -> Vec<f64>;
        fn export(&self, folder: &Path) -> Result<PathBuf, Error>;
        fn row_fault(&self, row: &[f64]) -> Option<&'static str>;
        fn row_error(&self, rows: &[Vec<f64>]) -> Option<String>;
        fn deviation(&self, q: &Configuration, wanted: &Configuration) -> Deviation;
        fn reaches_place(&self, q: &Configuration) -> bool;
        fn in_words(&self, q: &Configuration) -> String;
    }
    fn broken(&self, q: &Configuration) -> Option<String> {
        match self.holds(q) {
            true => self.robot.broken(q),
            false => Some(self.constraint.name.clone()),
        }
    }
    fn details(&self) -> Vec<(String, String)> {
        let mut details = self.robot.details();
        let Constraint { name, every, .. } = &self.constraint;
        details.push(("constraint".to_owned(), format!("{name}, at states {every} apart")));
        details
    }
    fn motion_model(&self) -> Result<MotionModel, Error> {
        Err(Error::new(format!(
            "no certificate can hold the constraint `{}`: it is a function",
            self.constraint.name
        ))
        .help("certify the path in the scene without it: the certificate is about collisions"))
    }
}

impl Appearance for Constrained {
    of_the_robot! {
        fn bodies(&self) -> Vec<Body>;
        fn moving_obstacles(&self) -> usize;
        fn poses(&self, q: &Configuration) -> Vec<Isometry3<f64>>;
        fn traced(&self, q: &Configuration) -> Point3<f64>;
        fn seconds(&self, from: &Configuration, to: &Configuration) -> Option<f64>;
        fn picture_spacing(&self) -> f64;
        fn picture_bounds(&self) -> Option<Aabb>;
        fn is_planar(&self) -> bool;
    }
}
