//! The two robots of the plane, as the commands see them.

use crate::plan::counted::{Knows, Queries};
use miette::{IntoDiagnostic, Result, miette};
use mp::cspace::{
    Clearance, ClearanceGradient, DefaultNn, Factored, MotionBound, MotionValidity, Numbers, ObstacleHints,
    Rn, Se2, Se2State, Validity,
};
use mp::geom::flat::FlatWorld;
use mp::io::FlatBody;
use mp::robot::{DiscRobot, DiscVerifier, PolygonRobot, PolygonVerifier};
use nalgebra::{Isometry2, Point2, Vector2};
use std::fmt::Debug;
use std::sync::Arc;

/// A robot of the plane.
pub(crate) trait FlatMover:
    Validity<Self::State>
    + Clearance<Self::State>
    + MotionBound<Self::State>
    + ObstacleHints<Self::State>
    + ClearanceGradient<Self::State>
    + Knows<Self::State>
    + Clone
    + Debug
    + Send
    + Sync
{
    type State: Clone + Debug + PartialEq + Send + Sync + Numbers;
    type Space: Factored<State = Self::State>
        + DefaultNn<Nn: Default + Clone + Send + Sync>
        + Clone
        + Debug
        + 'static;
    type Verifier<'c>: MotionValidity<Self::State> + Clone + Send + Sync
    where
        Self: 'c;
    /// What reports call the space.
    const SPACE: &'static str;

    fn new(world: Arc<FlatWorld>, body: &FlatBody) -> Result<Self>;
    fn space(bounds: [[f64; 2]; 2]) -> Result<Self::Space>;
    fn verifier<'c>(&self, space: &'c Self::Space) -> Self::Verifier<'c>;
    fn world(&self) -> &Arc<FlatWorld>;
    fn tolerance(&self) -> f64;
    /// The largest distance of a point of the robot from its origin, metres.
    fn radius(&self) -> f64;
    /// From and to the numbers of a file.
    fn state(row: &[f64]) -> Self::State;
    fn row(q: &Self::State) -> Vec<f64>;
    /// The rings around the robot at `q`.
    fn rings(&self, q: &Self::State) -> Vec<Vec<Point2<f64>>>;
    /// Where its origin is.
    fn place(q: &Self::State) -> Vector2<f64>;
    /// The same turn elsewhere.
    fn moved(q: &Self::State, by: Vector2<f64>) -> Self::State;
}

impl Queries for DiscRobot {
    fn queries(&self) -> u64 {
        let counters = self.counters();
        counters.collision_checks + counters.clearance_checks
    }
}

impl Queries for PolygonRobot {
    fn queries(&self) -> u64 {
        let counters = self.counters();
        counters.collision_checks + counters.clearance_checks
    }
}

impl Knows<Vector2<f64>> for DiscRobot {}
impl Knows<Se2State> for PolygonRobot {}

impl FlatMover for DiscRobot {
    type State = Vector2<f64>;
    type Space = Rn<2>;
    type Verifier<'c> = DiscVerifier;
    const SPACE: &'static str = "R2";

    fn new(world: Arc<FlatWorld>, body: &FlatBody) -> Result<Self> {
        match body {
            FlatBody::Disc(radius) => Self::new(world, *radius).into_diagnostic(),
            FlatBody::Polygon(_) => Err(miette!("the robot is a polygon, not a disc")),
        }
    }
    fn space([low, high]: [[f64; 2]; 2]) -> Result<Rn<2>> {
        Rn::new(low, high).into_diagnostic()
    }
    fn verifier(&self, _: &Rn<2>) -> DiscVerifier {
        DiscVerifier::new(self)
    }
    fn world(&self) -> &Arc<FlatWorld> {
        self.world()
    }
    fn tolerance(&self) -> f64 {
        self.tolerance()
    }
    fn radius(&self) -> f64 {
        self.radius()
    }
    fn state(row: &[f64]) -> Vector2<f64> {
        Vector2::new(row[0], row[1])
    }
    fn row(q: &Vector2<f64>) -> Vec<f64> {
        vec![q.x, q.y]
    }
    fn rings(&self, q: &Vector2<f64>) -> Vec<Vec<Point2<f64>>> {
        let corner = |i: u32| {
            let (s, c) = (f64::from(i) * std::f64::consts::TAU / 48.0).sin_cos();
            Point2::from(q + Vector2::new(c, s) * self.radius())
        };
        vec![(0..48).map(corner).collect()]
    }
    fn place(q: &Vector2<f64>) -> Vector2<f64> {
        *q
    }
    fn moved(q: &Vector2<f64>, by: Vector2<f64>) -> Vector2<f64> {
        q + by
    }
}

impl FlatMover for PolygonRobot {
    type State = Se2State;
    type Space = Se2;
    type Verifier<'c> = PolygonVerifier<'c, Se2>;
    const SPACE: &'static str = "SE2";

    fn new(world: Arc<FlatWorld>, body: &FlatBody) -> Result<Self> {
        match body {
            FlatBody::Polygon(polygon) => Ok(Self::new(world, polygon.clone())),
            FlatBody::Disc(_) => Err(miette!("the robot is a disc, not a polygon")),
        }
    }
    fn space([low, high]: [[f64; 2]; 2]) -> Result<Se2> {
        Se2::new(low, high).into_diagnostic()
    }
    fn verifier<'c>(&self, space: &'c Se2) -> PolygonVerifier<'c, Se2> {
        PolygonVerifier::new(space, self)
    }
    fn world(&self) -> &Arc<FlatWorld> {
        self.world()
    }
    fn tolerance(&self) -> f64 {
        self.tolerance()
    }
    fn radius(&self) -> f64 {
        self.radius()
    }
    fn state(row: &[f64]) -> Se2State {
        Se2State::new(row[0], row[1], row[2])
    }
    fn row(q: &Se2State) -> Vec<f64> {
        vec![q.translation.x, q.translation.y, q.angle]
    }
    fn rings(&self, q: &Se2State) -> Vec<Vec<Point2<f64>>> {
        self.body().transformed(&Isometry2::new(q.translation, q.angle)).rings().to_vec()
    }
    fn place(q: &Se2State) -> Vector2<f64> {
        q.translation
    }
    fn moved(q: &Se2State, by: Vector2<f64>) -> Se2State {
        Se2State { translation: q.translation + by, ..*q }
    }
}
