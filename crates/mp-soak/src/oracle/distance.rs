//! Distances in space between triangles, balls, capsules and cylinders.
//!
//! Triangles are compared by their own formulas here, since those of parry3d compare fourth powers of lengths
//! with a fixed number. Cylinders are compared by parry3d (the algorithm of Gilbert, Johnson and Keerthi), at
//! a size near one.

use nalgebra::{Isometry3, Point3, Vector3};
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::query;
use parry3d_f64::shape;

/// A convex piece of a body.
#[derive(Clone, Debug, PartialEq)]
pub enum Piece {
    /// A triangle: a surface without an inside.
    Triangle([Point3<f64>; 3]),
    /// All points within `radius` of the segment from `a` to `b`; a ball where both are the same.
    Capsule {
        /// One end of the middle line.
        a: Point3<f64>,
        /// The other end.
        b: Point3<f64>,
        /// The radius, metres.
        radius: f64,
    },
    /// A solid cylinder about its own Z axis.
    Cylinder {
        /// Where its middle is.
        pose: Isometry3<f64>,
        /// The radius, metres.
        radius: f64,
        /// Half of its height, metres.
        half: f64,
    },
}

impl Piece {
    /// The piece moved by `pose`.
    pub(super) fn moved(&self, pose: &Isometry3<f64>) -> Self {
        match self {
            Self::Triangle(corners) => Self::Triangle(corners.map(|p| pose * p)),
            Self::Capsule { a, b, radius } => Self::Capsule { a: pose * a, b: pose * b, radius: *radius },
            Self::Cylinder { pose: own, radius, half } => {
                Self::Cylinder { pose: pose * own, radius: *radius, half: *half }
            }
        }
    }

    /// A ball around the piece: its middle and radius.
    pub(super) fn ball(&self) -> (Point3<f64>, f64) {
        match self {
            Self::Triangle([a, b, c]) => {
                let middle = Point3::from((a.coords + b.coords + c.coords) / 3.0);
                let radius = [a, b, c].map(|p| (p - middle).norm()).into_iter().fold(0.0, f64::max);
                (middle, radius)
            }
            Self::Capsule { a, b, radius } => (nalgebra::center(a, b), 0.5 * (b - a).norm() + radius),
            Self::Cylinder { pose, radius, half } => {
                (Point3::from(pose.translation.vector), (radius * radius + half * half).sqrt())
            }
        }
    }

    /// An upper bound on how far a point of the piece is from the origin.
    pub(super) fn reach(&self) -> f64 {
        match self {
            Self::Triangle(corners) => corners.iter().map(|p| p.coords.norm()).fold(0.0, f64::max),
            Self::Capsule { a, b, radius } => a.coords.norm().max(b.coords.norm()) + radius,
            Self::Cylinder { .. } => {
                let (middle, radius) = self.ball();
                middle.coords.norm() + radius
            }
        }
    }
}

/// The distance (m) between two pieces; 0 where they touch.
pub(super) fn between(a: &Piece, b: &Piece) -> f64 {
    match (a, b) {
        (Piece::Triangle(a), Piece::Triangle(b)) => triangles(a, b),
        (Piece::Triangle(t), Piece::Capsule { a, b, radius })
        | (Piece::Capsule { a, b, radius }, Piece::Triangle(t)) => {
            (segment_triangle(a, b, t) - radius).max(0.0)
        }
        (Piece::Capsule { a, b, radius }, Piece::Capsule { a: c, b: d, radius: other }) => {
            (segments(a, b, c, d) - radius - other).max(0.0)
        }
        (Piece::Cylinder { pose, radius, half }, other) | (other, Piece::Cylinder { pose, radius, half }) => {
            by_parry(pose, *radius, *half, other)
        }
    }
}

/// The distance of a cylinder from another piece, by parry3d, in the frame of the cylinder and in units of
/// its size.
fn by_parry(pose: &Isometry3<f64>, radius: f64, half: f64, other: &Piece) -> f64 {
    let other = other.moved(&pose.inverse());
    let unit = radius.max(half).max(other.ball().1);
    // Cylinders of parry3d are about Y: (x, y, z) becomes (x, z, -y).
    let turned = |p: &Point3<f64>| Vector::new(p.x / unit, p.z / unit, -p.y / unit);
    let cylinder = shape::Cylinder::new(half / unit, radius / unit);
    let here = Pose::identity();
    let told = match &other {
        Piece::Triangle([a, b, c]) => {
            let triangle = shape::Triangle::new(turned(a), turned(b), turned(c));
            query::distance(&here, &cylinder, &here, &triangle)
        }
        Piece::Capsule { a, b, radius } => {
            let capsule = shape::Capsule::new(turned(a), turned(b), radius / unit);
            query::distance(&here, &cylinder, &here, &capsule)
        }
        Piece::Cylinder { pose, radius, half } => {
            let axis = pose.rotation * Vector3::z();
            let axis = Vector::new(axis.x, axis.z, -axis.y);
            let turn = Rotation::from_rotation_arc(Vector::Y, axis);
            let middle = turned(&Point3::from(pose.translation.vector));
            let second = shape::Cylinder::new(half / unit, radius / unit);
            query::distance(&here, &cylinder, &Pose::from_parts(middle, turn), &second)
        }
    };
    told.map_or(f64::NAN, |told| told.distance * unit)
}

/// The distance between two triangles.
fn triangles(a: &[Point3<f64>; 3], b: &[Point3<f64>; 3]) -> f64 {
    let edges = |t: &[Point3<f64>; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let (of_a, of_b) = (edges(a), edges(b));
    let pierced = of_a.iter().any(|[p, q]| pierces(p, q, b)) || of_b.iter().any(|[p, q]| pierces(p, q, a));
    if pierced {
        return 0.0;
    }
    let mut least = f64::INFINITY;
    for [p, q] in &of_a {
        for [r, s] in &of_b {
            least = least.min(segments(p, q, r, s));
        }
    }
    for (p, t) in a.iter().map(|p| (p, b)).chain(b.iter().map(|p| (p, a))) {
        least = least.min(point_triangle(p, t));
    }
    least
}

/// The distance of a segment from a triangle.
fn segment_triangle(p: &Point3<f64>, q: &Point3<f64>, t: &[Point3<f64>; 3]) -> f64 {
    if pierces(p, q, t) {
        return 0.0;
    }
    let edges = [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let least = edges.iter().map(|[r, s]| segments(p, q, r, s)).fold(f64::INFINITY, f64::min);
    least.min(point_triangle(p, t)).min(point_triangle(q, t))
}

/// Six times the signed volume of a tetrahedron.
fn volume(a: &Point3<f64>, b: &Point3<f64>, c: &Point3<f64>, d: &Point3<f64>) -> f64 {
    (b - a).cross(&(c - a)).dot(&(d - a))
}

/// Whether the segment from `p` to `q` goes through a triangle, from one side of its plane to the other.
fn pierces(p: &Point3<f64>, q: &Point3<f64>, [a, b, c]: &[Point3<f64>; 3]) -> bool {
    let (from, to) = (volume(a, b, c, p), volume(a, b, c, q));
    if from * to >= 0.0 {
        return false;
    }
    let around = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    around.iter().all(|v| *v > 0.0) || around.iter().all(|v| *v < 0.0)
}

/// The distance of a point from a segment.
fn point_segment(p: &Point3<f64>, a: &Point3<f64>, b: &Point3<f64>) -> f64 {
    let along = b - a;
    let square = along.norm_squared();
    let t = if square > 0.0 { ((p - a).dot(&along) / square).clamp(0.0, 1.0) } else { 0.0 };
    (p - (a + along * t)).norm()
}

/// The distance between two segments: the least at the ends, or between the nearest points of both lines.
///
/// Whatever rounding does to the parameters, the result is the distance of two points of the segments.
fn segments(p: &Point3<f64>, q: &Point3<f64>, r: &Point3<f64>, s: &Point3<f64>) -> f64 {
    let ends = point_segment(p, r, s).min(point_segment(q, r, s));
    let least = ends.min(point_segment(r, p, q)).min(point_segment(s, p, q));
    let (u, v, w) = (q - p, s - r, p - r);
    let (a, b, c, d, e) = (u.dot(&u), u.dot(&v), v.dot(&v), u.dot(&w), v.dot(&w));
    let det = a * c - b * b;
    if det <= 0.0 {
        return least;
    }
    let s_at = (b * e - c * d) / det;
    let t_at = (a * e - b * d) / det;
    if (0.0..=1.0).contains(&s_at) && (0.0..=1.0).contains(&t_at) {
        return least.min(((p + u * s_at) - (r + v * t_at)).norm());
    }
    least
}

/// The distance of a point from a triangle's inside; infinite where it is not above the inside. Edges are
/// left to others.
fn point_triangle(p: &Point3<f64>, [a, b, c]: &[Point3<f64>; 3]) -> f64 {
    let normal = (b - a).cross(&(c - a));
    let square = normal.norm_squared();
    if square == 0.0 {
        return f64::INFINITY;
    }
    let above = |from: &Point3<f64>, to: &Point3<f64>| (to - from).cross(&(p - from)).dot(&normal) >= 0.0;
    if above(a, b) && above(b, c) && above(c, a) {
        return (p - a).dot(&normal).abs() / square.sqrt();
    }
    f64::INFINITY
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::Draw;

    fn point(draw: &mut Draw) -> Point3<f64> {
        Point3::new(draw.within(-1.0, 1.0), draw.within(-1.0, 1.0), draw.within(-1.0, 1.0))
    }

    fn to_parry(corners: &[Point3<f64>; 3]) -> shape::Triangle {
        let [a, b, c] = corners.map(|p| Vector::new(p.x, p.y, p.z));
        shape::Triangle::new(a, b, c)
    }

    #[test]
    fn triangles_agree_with_parry() {
        let mut draw = Draw::new(1, 1);
        let here = Pose::identity();
        let mut touching = 0;
        for _ in 0..3000 {
            let (a, b) = ([0; 3].map(|_| point(&mut draw)), [0; 3].map(|_| point(&mut draw)));
            let theirs = query::distance(&here, &to_parry(&a), &here, &to_parry(&b)).unwrap().distance;
            let ours = triangles(&a, &b);
            touching += u32::from(ours == 0.0);
            assert!((ours - theirs).abs() < 1e-6, "{a:?} {b:?}: {ours} {theirs}");
        }
        assert!(touching > 300, "{touching}");
    }

    #[test]
    fn cylinders_stand_about_z() {
        let cylinder =
            Piece::Cylinder { pose: Isometry3::translation(1.0, 2.0, 3.0), radius: 0.5, half: 2.0 };
        let ball =
            |x, y, z| Piece::Capsule { a: Point3::new(x, y, z), b: Point3::new(x, y, z), radius: 0.25 };
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-7, "{found} {expected}");
        near(between(&cylinder, &ball(3.0, 2.0, 4.5)), 1.25);
        near(between(&cylinder, &ball(1.0, 2.0, 6.0)), 0.75);
        near(between(&ball(1.0, 2.0, 4.9), &cylinder), 0.0);
        let lying = Isometry3::rotation(Vector3::x() * std::f64::consts::FRAC_PI_2);
        let lying =
            Piece::Cylinder { pose: Isometry3::translation(4.0, 2.0, 3.0) * lying, radius: 0.5, half: 2.0 };
        near(between(&cylinder, &lying), 2.0);
        let triangle = Piece::Triangle([
            Point3::new(2.0, -1.0, 0.0),
            Point3::new(2.0, 9.0, 0.0),
            Point3::new(2.0, 2.0, 9.0),
        ]);
        near(between(&triangle, &cylinder), 0.5);
    }
}
