//! Robots whose checks are functions of Python: `mp_motion.Robot`.

mod check;
mod verifier;

use crate::callback::{Callback, Calls};
use check::{Check, Functions};
use mp_cspace::erased::{AnyIndex, AnySpace};
use mp_cspace::{
    Configuration, JointRange, Joints, LengthError, Linear, Metric, Rng, ScaledEuclidean, Space, Validity,
    WithMetric,
};
use mp_plan::{
    Appearance, Body, Column, Contact, Description, Deviation, Error, Length, Measured, MetricName, Motion,
    Robot, TypedMotion,
};
use nalgebra::Isometry3;
use pyo3::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;
use verifier::Verifier;

/// Where it moves.
type OwnSpace = WithMetric<Joints<Configuration>, ScaledEuclidean>;

/// What the Python half says of a robot: its members there have the same names.
#[derive(Debug, FromPyObject)]
pub(crate) struct Given {
    name: String,
    columns: Vec<(String, String)>,
    low: Vec<f64>,
    high: Vec<f64>,
    periodic: Vec<bool>,
    weights: Vec<f64>,
    valid: Option<Py<PyAny>>,
    valid_many: Option<Py<PyAny>>,
    clearance: Option<Py<PyAny>>,
    displacement: Option<Py<PyAny>>,
    distance: Option<Py<PyAny>>,
    verify: Option<Py<PyAny>>,
    resolution: String,
    tolerance: f64,
}

/// The numbers of a configuration: Python's, and those of states.
#[derive(Clone, Debug)]
struct Numbers {
    low: Vec<f64>,
    high: Vec<f64>,
    periodic: Vec<bool>,
}

impl Numbers {
    /// Radians for each unit of a periodic number.
    fn factor(&self, i: usize) -> f64 {
        2.0 * PI / (self.high[i] - self.low[i])
    }

    /// Whether state and row have the same number.
    fn is_same(&self, i: usize) -> bool {
        !self.periodic[i] || (self.low[i] == -PI && self.high[i] == PI)
    }

    fn row(&self, state: &Configuration) -> Vec<f64> {
        let number = |(i, x): (usize, &f64)| match self.is_same(i) {
            true => *x,
            false => (self.low[i] + (x + PI) / self.factor(i)).min(self.high[i]),
        };
        state.iter().enumerate().map(number).collect()
    }

    fn state(&self, row: &[f64]) -> Configuration {
        let number = |(i, x): (usize, &f64)| match self.is_same(i) {
            true => *x,
            false => (x - self.low[i]) * self.factor(i) - PI,
        };
        row.iter().enumerate().map(number).collect()
    }
}

/// A robot whose checks are functions of Python.
#[derive(Clone, Debug)]
pub(crate) struct Own {
    name: Arc<str>,
    columns: Arc<[Column]>,
    numbers: Arc<Numbers>,
    space: OwnSpace,
    check: Check,
    distance: Option<Arc<Callback>>,
    verify: Option<Arc<Callback>>,
    resolution: Length,
    tolerance: f64,
    start: Configuration,
    goals: Vec<Configuration>,
}

impl Own {
    /// The robot with these ends, and where exceptions of its functions are kept.
    pub(crate) fn new(given: Given, start: &[f64], goals: &[Vec<f64>]) -> Result<(Self, Calls), Error> {
        let calls = Calls::default();
        let one = |function: Option<Py<PyAny>>| function.map(|f| Arc::new(Callback::new(f, &calls)));
        let numbers = Numbers { low: given.low, high: given.high, periodic: given.periodic };
        let range = |i: usize| match numbers.periodic[i] {
            true => JointRange::Circle,
            false => JointRange::Interval { low: numbers.low[i], high: numbers.high[i] },
        };
        let joints = Joints::new((0..numbers.low.len()).map(range).collect::<Vec<_>>())?;
        let unit = |i: usize| if numbers.periodic[i] { 1.0 / numbers.factor(i) } else { 1.0 };
        let weights: Vec<_> = given.weights.iter().enumerate().map(|(i, w)| w * unit(i)).collect();
        let metric = ScaledEuclidean::new(&joints, weights)?;
        let numbers = Arc::new(numbers);
        let functions = match (given.clearance, given.displacement, given.valid_many, given.valid) {
            (Some(clearance), Some(displacement), ..) => Functions::Clearance {
                clearance: Callback::new(clearance, &calls),
                displacement: Callback::new(displacement, &calls),
            },
            (_, _, Some(many), _) => Functions::Many(Callback::new(many, &calls)),
            (_, _, _, Some(one)) => Functions::One(Callback::new(one, &calls)),
            _ => {
                return Err(Error::new("the robot has no check")
                    .help("give `valid`, `valid_many`, or `clearance` and `displacement`"));
            }
        };
        let row = |row: &[f64]| match row.len() == numbers.low.len() {
            true => Ok(joints.wrapped(&numbers.state(row))),
            false => Err(Error::new(format!("an end has {} numbers, not {}", row.len(), numbers.low.len()))
                .help("give one number for each bound of the space")),
        };
        let (start, goals) = (row(start)?, goals.iter().map(|goal| row(goal)).collect::<Result<_, _>>()?);
        let own = Self {
            name: given.name.into(),
            columns: given.columns.into_iter().map(|(name, unit)| Column::new(name, unit)).collect(),
            check: Check::new(functions, Arc::clone(&numbers)),
            distance: one(given.distance),
            verify: one(given.verify),
            resolution: given
                .resolution
                .parse()
                .map_err(|e: LengthError| Error::from(e).context("the resolution"))?,
            tolerance: given.tolerance,
            space: WithMetric::new(joints, metric),
            numbers,
            start,
            goals,
        };
        Ok((own, calls))
    }
}

/// The distance that a function of Python gives. The extent is that of the space.
#[derive(Clone, Debug)]
struct Distance {
    function: Arc<Callback>,
    numbers: Arc<Numbers>,
    extent: f64,
}

impl Metric<Joints<Configuration>> for Distance {
    type Nn = Linear;

    fn distance(&self, _: &Joints<Configuration>, from: &Configuration, to: &Configuration) -> f64 {
        check::number(&self.function, &self.numbers, "distance", &[from, to]).unwrap_or(0.0)
    }
    fn extent(&self, _: &Joints<Configuration>) -> f64 {
        self.extent
    }
}

/// How many configurations are tried to find a free one.
const TRIES: u32 = 200;

impl TypedMotion for Own {
    type Space = OwnSpace;
    type Checker = Check;
    type Verifier<'c> = Verifier<'c>;
    fn space(&self) -> &OwnSpace {
        &self.space
    }
    fn with_ends(&self, start: Configuration, goals: Vec<Configuration>) -> Result<Self, Error> {
        let wrapped = |q: &Configuration| self.space.space().wrapped(q);
        Ok(Self { start: wrapped(&start), goals: goals.iter().map(wrapped).collect(), ..self.clone() })
    }
    fn checker(&self) -> &Check {
        &self.check
    }
    fn verifier(&self) -> Result<Verifier<'_>, Error> {
        Ok(Verifier::new(self))
    }
}

impl Motion for Own {
    fn start(&self) -> &Configuration {
        &self.start
    }
    fn goals(&self) -> &[Configuration] {
        &self.goals
    }
    fn tolerance(&self) -> f64 {
        self.tolerance
    }
    fn sampled(&self) -> Option<Length> {
        (!self.check.knows_clearance()).then_some(self.resolution)
    }
    fn remembering(&self) -> Option<Arc<dyn Robot>> {
        self.sampled()?;
        Some(Arc::new(Self { check: self.check.remembering(), ..self.clone() }))
    }
    fn measured(&self, metric: MetricName) -> Result<Measured<'_>, Error> {
        let joints = self.space.space();
        match (metric, &self.distance) {
            (MetricName::Default, Some(function)) => {
                let (function, numbers) = (Arc::clone(function), Arc::clone(&self.numbers));
                let distance = Distance { function, numbers, extent: self.space.extent() };
                let space = WithMetric::new(joints.clone(), distance);
                Ok(Measured { index: AnyIndex::new(&space, Linear::new()), space: AnySpace::new(&space) })
            }
            (MetricName::Default, None) => Ok(Measured::by_coordinates(&self.space)),
            (MetricName::Euclidean, _) => {
                let unit =
                    |i: usize| if self.numbers.periodic[i] { 1.0 / self.numbers.factor(i) } else { 1.0 };
                let weights: Vec<_> = (0..self.columns.len()).map(unit).collect();
                let metric = ScaledEuclidean::new(joints, weights)?;
                Ok(Measured::by_coordinates(&WithMetric::new(joints.clone(), metric)))
            }
            _ => Err(Error::new(format!("a robot of your own has no metric `{metric}`")).help(
                "there are `default` and `euclidean`; give the robot a `distance`, or the space `weights`",
            )),
        }
    }
    fn nearest_free(&self, q: &Configuration) -> Option<Configuration> {
        let (mut check, mut rng) = (self.check.clone(), Rng::seed(1));
        let near = |i| {
            let other = self.space.sample_uniform(&mut rng);
            self.space.interpolate(q, &other, f64::from(i) / f64::from(TRIES))
        };
        (1..=TRIES).map(near).find(|near| check.is_valid(near))
    }
}

impl Description for Own {
    fn name(&self) -> &str {
        &self.name
    }
    fn space_name(&self) -> String {
        format!("{} numbers", self.columns.len())
    }
    fn touching(&self, _: &Configuration) -> Vec<Contact> {
        Vec::new()
    }
    fn columns(&self) -> Vec<Column> {
        self.columns.to_vec()
    }
    fn limits(&self) -> Vec<Option<[f64; 2]>> {
        let n = &self.numbers;
        (0..n.low.len()).map(|i| (!n.periodic[i]).then_some([n.low[i], n.high[i]])).collect()
    }
    fn row(&self, q: &Configuration) -> Vec<f64> {
        self.numbers.row(q)
    }
    fn state(&self, row: &[f64]) -> Configuration {
        self.space.space().wrapped(&self.numbers.state(row))
    }
    fn deviation(&self, q: &Configuration, wanted: &Configuration) -> Deviation {
        Deviation { off: self.space.distance(q, wanted), allowed: 1e-6 * self.space.extent(), unit: "" }
    }
}

impl Appearance for Own {
    fn bodies(&self) -> Vec<Body> {
        Vec::new()
    }
    fn poses(&self, _: &Configuration) -> Vec<Isometry3<f64>> {
        Vec::new()
    }
    fn picture_spacing(&self) -> f64 {
        1.0
    }
}
