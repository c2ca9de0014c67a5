//! Shapes: what robots and obstacles are made of, as people give them, and the meshes that are checked in
//! their place.
//!
//! A file for each. All but [`Shape::Mesh`] are solids ([`TriMesh::solids`]): what is wholly inside of one
//! collides with it. Round shapes become meshes of flat faces that contain them, so that what is free of the
//! mesh is free of the shape.

mod capsule;
mod cone;
mod cuboid;
mod cylinder;
mod height_field;
mod hull;
mod points;
mod sphere;
mod tetrahedron;
mod torus;

pub use height_field::HeightField;
pub use hull::convex_hull;
pub use points::Points;
pub(crate) use points::ball;

use crate::{MeshError, PrimitiveError, TriMesh};
use nalgebra::Point3;
use std::f64::consts::PI;

type Made = Result<TriMesh, PrimitiveError>;

/// A solid that a few lengths describe, centred on the origin of its frame, with its axis along Z.
#[derive(Clone, Copy, Debug)]
pub struct Primitive {
    /// What files call it.
    pub name: &'static str,
    /// What its lengths (m) are, in order.
    pub lengths: &'static [&'static str],
    mesh: fn(&[f64]) -> Made,
}

impl PartialEq for Primitive {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// The primitives, each with its name in files.
pub const PRIMITIVES: [Primitive; 7] =
    [cuboid::KIND, sphere::KIND, cylinder::KIND, capsule::KIND, cone::KIND, torus::KIND, tetrahedron::KIND];

/// A shape in its own frame, metres.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// A mesh: a surface, or with [solids](TriMesh::solids).
    Mesh(TriMesh),
    /// A solid with these lengths (m).
    Primitive(Primitive, Vec<f64>),
    /// The convex hull of points.
    Hull(Vec<Point3<f64>>),
    /// Ground of varying height.
    HeightField(HeightField),
    /// Balls around points, such as those of a camera.
    Points(Points),
}

impl Shape {
    /// The primitive that files call `name`, with these lengths (m); `None` when there is none of the name,
    /// or it has another number of lengths.
    #[must_use]
    pub fn primitive(name: &str, lengths: &[f64]) -> Option<Self> {
        let kind = PRIMITIVES.into_iter().find(|kind| kind.name == name)?;
        (kind.lengths.len() == lengths.len()).then(|| Self::Primitive(kind, lengths.to_vec()))
    }

    /// The mesh that is checked in its place. It contains the shape: faces are flat, so that round shapes
    /// grow, by less than 0.5% of the radius (cylinders, cones), 1% (capsules) and 2% (tori). Spheres and
    /// points are [balls](TriMesh::balls).
    ///
    /// ```
    /// use mp_geom::Shape;
    ///
    /// let capsule = Shape::primitive("capsule", &[0.1, 0.5]).unwrap().mesh()?;
    /// assert!((capsule.aabb().max.z - 0.35).abs() < 0.001);
    /// assert_eq!(capsule.solids().len(), 1);
    /// # Ok::<(), mp_geom::PrimitiveError>(())
    /// ```
    ///
    /// # Errors
    /// [`PrimitiveError`] when a length is not above zero, or there is nothing that has an inside.
    pub fn mesh(&self) -> Made {
        match self {
            Self::Mesh(mesh) => Ok(mesh.clone()),
            Self::Primitive(kind, lengths) => (kind.mesh)(lengths),
            Self::Hull(points) => convex_hull(points),
            Self::HeightField(field) => field.mesh(),
            Self::Points(points) => points.mesh(),
        }
    }
}

impl From<TriMesh> for Shape {
    fn from(mesh: TriMesh) -> Self {
        Self::Mesh(mesh)
    }
}

/// Segments around a round shape.
const SEGMENTS: u32 = 32;

/// How much larger than a circle a polygon of [`SEGMENTS`] sides around it is.
fn grown() -> f64 {
    1.0 / mp_math::cos(PI / f64::from(SEGMENTS))
}

/// Refuses points with coordinates that are not finite.
fn finite(points: &[Point3<f64>]) -> Result<(), MeshError> {
    crate::mesh::check_finite(points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::capsule;

    /// Whether a solid mesh has a point inside, or so near to its surface that rounding decides.
    fn holds(mesh: &TriMesh, p: Point3<f64>) -> bool {
        // Seen from a point on a face, the surface covers half of all directions.
        mesh.winding_number(&p) > 0.4
    }

    fn of(name: &str, lengths: &[f64]) -> TriMesh {
        let mesh = Shape::primitive(name, lengths).unwrap().mesh().unwrap().faceted();
        assert!(mesh.topology().is_solid(), "{name}");
        mesh
    }

    /// A shape and its lengths, a point on its surface, and the direction away from it.
    type Case<'a> = (&'a str, &'a [f64], [f64; 3], [f64; 3]);

    /// Points on the surface of round shapes are in their meshes, and points a little farther out are not.
    #[test]
    fn meshes_contain_their_shapes() {
        let round = |i: u32| mp_math::sin_cos(0.0937 * f64::from(i));
        for i in 0..400 {
            let ((s, c), (t, u)) = (round(i), round(7 * i + 1));
            let [x, y, z] = [c * u, s * u, t];
            let cases: [Case<'_>; 5] = [
                ("sphere", &[0.5], [0.5 * x, 0.5 * y, 0.5 * z], [x, y, z]),
                ("cylinder", &[0.5, 2.0], [0.5 * c, 0.5 * s, 0.999 * t], [c, s, 0.0]),
                ("capsule", &[0.5, 2.0], [0.5 * x, 0.5 * y, 0.5 * z + z.signum()], [x, y, z]),
                (
                    "cone",
                    &[0.5, 2.0],
                    [0.25 * c * (1.0 - t), 0.25 * s * (1.0 - t), t],
                    [0.97 * c, 0.97 * s, 0.2425],
                ),
                ("torus", &[1.0, 0.5], [c * (1.0 + 0.5 * u), s * (1.0 + 0.5 * u), 0.5 * t], [x, y, z]),
            ];
            for (name, lengths, on, away) in cases {
                let mesh = of(name, lengths);
                let (on, away) = (Point3::from(on), nalgebra::Vector3::from(away));
                assert!(holds(&mesh, on - 1e-9 * away), "{name} {on}");
                assert!(!holds(&mesh, on + 0.04 * away), "{name} {on}");
            }
        }
        assert_eq!(of("box", &[1.0, 2.0, 3.0]).signed_volume(), 6.0);
    }

    #[test]
    fn shapes_of_no_size_are_refused() {
        for kind in PRIMITIVES {
            for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
                let mut lengths = vec![0.1; kind.lengths.len()];
                lengths[kind.lengths.len() - 1] = bad;
                assert!(
                    Shape::primitive(kind.name, &lengths).unwrap().mesh().is_err(),
                    "{} {bad}",
                    kind.name
                );
            }
            assert_eq!(Shape::primitive(kind.name, &[1.0; 9]), None);
        }
        assert_eq!(Shape::primitive("teapot", &[1.0]), None);
        assert_eq!(Shape::from(capsule(1.0, 1.0, 8, 2).unwrap()).mesh(), capsule(1.0, 1.0, 8, 2));
    }
}
