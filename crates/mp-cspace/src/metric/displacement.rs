//! Maximum displacement.

use super::Metric;
use crate::{MetricTree, Se2, Se2State, Se3, Space, SpaceError, TrueMetric};
use nalgebra::{Isometry3, Point2, Point3};

/// The maximum displacement of any point of a rigid robot, `max ‖x(q) - x(q')‖` over its points
/// `x` (Benitez et al. 2010, *Key Elements for Motion Planning Algorithms*, eq. 6), in metres.
///
/// The displacement is a convex function of the point, so the maximum over a body is attained at
/// a vertex of its convex hull: give these (or all vertices of its mesh) and the value is exact.
/// Cost grows with the number of points. A true metric; it measures chords, so moving at constant
/// speed does not change it at a constant rate.
#[derive(Clone, Debug, PartialEq)]
pub struct MaxDisplacement<P> {
    points: Vec<P>,
    radius: f64,
}

impl MaxDisplacement<Point3<f64>> {
    /// The metric of a body in space, `points` (m) in the body's frame.
    ///
    /// # Errors
    /// When there is no point, or one is not finite.
    pub fn new(points: impl Into<Vec<Point3<f64>>>) -> Result<Self, SpaceError> {
        let points = points.into();
        let radius = max_radius(points.iter().map(|p| p.coords.norm()))?;
        Ok(Self { points, radius })
    }
}

impl MaxDisplacement<Point2<f64>> {
    /// The metric of a body in the plane, `points` (m) in the body's frame.
    ///
    /// # Errors
    /// When there is no point, or one is not finite.
    pub fn planar(points: impl Into<Vec<Point2<f64>>>) -> Result<Self, SpaceError> {
        let points = points.into();
        let radius = max_radius(points.iter().map(|p| p.coords.norm()))?;
        Ok(Self { points, radius })
    }
}

fn max_radius(norms: impl Iterator<Item = f64>) -> Result<f64, SpaceError> {
    let mut max = None;
    for norm in norms {
        if !norm.is_finite() {
            return Err(SpaceError::Weight { name: "the distance of a point from the origin", value: norm });
        }
        max = Some(norm.max(max.unwrap_or(0.0)));
    }
    max.ok_or(SpaceError::Empty { what: "the set of points" })
}

/// The largest of the distances whose squares these are. Written so that NaN stays: all are, of a pose that is not finite.
#[inline]
fn farthest(squares: impl Iterator<Item = f64>) -> f64 {
    squares.fold(0.0, |most, square| if square <= most { most } else { square }).sqrt()
}

impl Metric<Se3> for MaxDisplacement<Point3<f64>> {
    type Nn = MetricTree;

    fn distance(&self, _: &Se3, from: &Isometry3<f64>, to: &Isometry3<f64>) -> f64 {
        let (ra, rb) = (from.rotation.to_rotation_matrix(), to.rotation.to_rotation_matrix());
        let turn = rb.matrix() - ra.matrix();
        let shift = to.translation.vector - from.translation.vector;
        farthest(self.points.iter().map(|p| (turn * p.coords + shift).norm_squared()))
    }
    /// The diagonal of the box, and twice the farthest point's distance from the body's origin.
    fn extent(&self, space: &Se3) -> f64 {
        space.translations().extent() + 2.0 * self.radius
    }
}
impl TrueMetric<Se3> for MaxDisplacement<Point3<f64>> {}

impl Metric<Se2> for MaxDisplacement<Point2<f64>> {
    type Nn = MetricTree;

    fn distance(&self, _: &Se2, from: &Se2State, to: &Se2State) -> f64 {
        let ((sa, ca), (sb, cb)) = (mp_math::sin_cos(from.angle), mp_math::sin_cos(to.angle));
        let (c, s) = (cb - ca, sb - sa);
        let shift = to.translation - from.translation;
        let squared = |p: &Point2<f64>| {
            mp_math::powi(c * p.x - s * p.y + shift.x, 2) + mp_math::powi(s * p.x + c * p.y + shift.y, 2)
        };
        farthest(self.points.iter().map(squared))
    }
    /// The diagonal of the box, and twice the farthest point's distance from the body's origin.
    fn extent(&self, space: &Se2) -> f64 {
        space.translations().extent() + 2.0 * self.radius
    }
}
impl TrueMetric<Se2> for MaxDisplacement<Point2<f64>> {}
