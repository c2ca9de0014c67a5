//! What differs between robots in the plane and in space.

use miette::{IntoDiagnostic, Result};
use mp::cspace::{
    DefaultNn, Embed, EmbedFactors, MaxDisplacement, MetricOn, Numbers, ScaledEuclidean, Se2, Se3, Space,
    SweptVolume, TrueMetricOn,
};
use mp::geom::{Aabb, TriMesh};
use mp::robot::{Placement, Planar, Spatial};
use nalgebra::{Point2, Point3};
use std::fmt::Debug;

/// A kind of rigid body.
pub(crate) trait Mover: Placement<State: PartialEq + Send + Sync + Numbers> {
    type Space: Embed
        + EmbedFactors
        + DefaultNn<Nn: 'static>
        + Space<State = Self::State>
        + Clone
        + Debug
        + Send
        + Sync;
    type Displacement: TrueMetricOn<Self::Space> + Clone;
    type Swept: MetricOn<Self::Space> + Clone + Debug;

    /// The space of configurations with the origin within `bounds`.
    fn space(bounds: &Aabb) -> Result<Self::Space>;
    /// The Euclidean metric with radians times `radius`.
    fn scaled(space: &Self::Space, radius: f64) -> Result<ScaledEuclidean>;
    /// How far the point of the robot moves that moves farthest.
    fn displacement(robot: &TriMesh) -> Result<Self::Displacement>;
    /// About how much volume the robot sweeps.
    fn swept(robot: &TriMesh) -> Result<Self::Swept>;
}

impl Mover for Spatial {
    type Space = Se3;
    type Displacement = MaxDisplacement<Point3<f64>>;
    type Swept = SweptVolume;

    fn space(bounds: &Aabb) -> Result<Se3> {
        Se3::new(bounds.min.coords, bounds.max.coords).into_diagnostic()
    }
    fn scaled(space: &Se3, radius: f64) -> Result<ScaledEuclidean> {
        ScaledEuclidean::new(space, [1.0, 1.0, 1.0, radius]).into_diagnostic()
    }
    fn displacement(robot: &TriMesh) -> Result<Self::Displacement> {
        MaxDisplacement::new(robot.vertices().to_vec()).into_diagnostic()
    }
    fn swept(robot: &TriMesh) -> Result<SweptVolume> {
        swept(robot)
    }
}

impl Mover for Planar {
    type Space = Se2;
    type Displacement = MaxDisplacement<Point2<f64>>;
    type Swept = SweptVolume;

    fn space(bounds: &Aabb) -> Result<Se2> {
        Se2::new(bounds.min.coords.xy(), bounds.max.coords.xy()).into_diagnostic()
    }
    fn scaled(space: &Se2, radius: f64) -> Result<ScaledEuclidean> {
        ScaledEuclidean::new(space, [1.0, 1.0, radius]).into_diagnostic()
    }
    fn displacement(robot: &TriMesh) -> Result<Self::Displacement> {
        let points: Vec<_> = robot.vertices().iter().map(Point3::xy).collect();
        MaxDisplacement::planar(points).into_diagnostic()
    }
    fn swept(robot: &TriMesh) -> Result<SweptVolume> {
        swept(robot)
    }
}

fn swept(robot: &TriMesh) -> Result<SweptVolume> {
    SweptVolume::new((0..robot.triangles().len()).map(|i| robot.triangle(i))).into_diagnostic()
}
