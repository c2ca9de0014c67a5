//! Conversions of solids and of shapes of all kinds.

use mp_geom::TriMesh;
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::shape::{self, SharedShape, TypedShape};

use super::hull::hull_of;
use super::meshes::{made_of, soup};
use super::poses::{toward, upright};
use super::{ParryError, around, mesh_from_parry, point_from_parry, pose_from_parry, pose_to_parry};
use crate::mesh::CollisionMesh;
use crate::solid::{Dimensions, Solid};

/// The shape that a shape of parry is converted to.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Shape {
    /// A mesh.
    Mesh {
        /// The surface (metres).
        mesh: TriMesh,
        /// Whether its inside belongs to it, as for a convex polyhedron.
        filled: bool,
    },
    /// A ball, capsule, box, cylinder, cone or half-space.
    Solid(Solid),
}

/// One part of a converted shape.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Part {
    /// Its shape.
    pub shape: Shape,
    /// Its pose in the frame of the shape of parry.
    pub pose: Isometry3<f64>,
}

impl Shape {
    /// A mesh of the shape: of a mesh or a box exact, of a curved solid a mesh that contains it and extends nowhere more than
    /// `excess` (metres) beyond it, to rounding. Needs some √(size/`excess`) triangles for a cylinder or cone and
    /// size/`excess` for a ball or capsule.
    ///
    /// # Errors
    /// [`ParryError::Unbounded`] for a half-space, [`ParryError::Parameter`] when `excess` is not positive or takes more than
    /// 4096 segments around (a ball: 1.3 million triangles).
    pub fn to_mesh(&self, excess: f64) -> Result<TriMesh, ParryError> {
        match self {
            Self::Mesh { mesh, .. } => Ok(mesh.clone()),
            Self::Solid(solid) => around::mesh(solid, excess),
        }
    }

    /// The tree of [`Shape::to_mesh`], [filled](CollisionMesh::filled) when the shape is, as all solids are: a body for a
    /// [`Scene`](crate::Scene).
    ///
    /// # Errors
    /// As [`Shape::to_mesh`], and [`ParryError::Fill`].
    pub fn to_collision_mesh(&self, excess: f64) -> Result<CollisionMesh, ParryError> {
        let mesh = CollisionMesh::new(&self.to_mesh(excess)?);
        let filled = !matches!(self, Self::Mesh { filled: false, .. });
        Ok(if filled { mesh.filled()? } else { mesh })
    }
}

/// The same solid as a shape of parry, and its pose there, in the frame of the solid.
///
/// ```
/// use mp_collide::{Solid, parry};
/// use nalgebra::Isometry3;
/// use parry3d_f64::{math::Pose, query, shape::Ball};
///
/// let pose_ws = Isometry3::translation(0.0, 0.0, 3.0);
/// let (cylinder, pose_sp) = parry::solid_to_parry(&Solid::cylinder(0.5, 2.0)?);
/// let pose_wp = parry::pose_to_parry(&pose_ws) * pose_sp;
/// let apart = query::distance(&pose_wp, &*cylinder, &Pose::IDENTITY, &Ball::new(1.0))?.distance;
/// assert!((apart - 1.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn solid_to_parry(solid: &Solid) -> (SharedShape, Pose) {
    let laid = pose_to_parry(&Isometry3::from_parts(Translation3::identity(), upright().inverse()));
    match solid.dimensions() {
        Dimensions::Ball { radius } => (SharedShape::ball(radius), Pose::IDENTITY),
        Dimensions::Capsule { radius, half } => (SharedShape::capsule_z(half, radius), Pose::IDENTITY),
        Dimensions::Cuboid { half } => (SharedShape::cuboid(half.x, half.y, half.z), Pose::IDENTITY),
        Dimensions::Cylinder { radius, half } => (SharedShape::cylinder(half, radius), laid),
        Dimensions::Cone { radius, half } => (SharedShape::cone(half, radius), laid),
        Dimensions::HalfSpace => (SharedShape::halfspace(Vector::Z), Pose::IDENTITY),
    }
}

/// Converts a shape of parry: one part with its pose, or as many as a compound has, in its order. A
/// [`SharedShape`] is given as `&*shape`.
///
/// * Balls, capsules, cuboids, cylinders, cones and half-spaces are [`Solid`]s; a capsule without length is a ball.
/// * Meshes, height fields and voxels are surfaces; voxels are solid in parry, so the caller must take care of bodies wholly
///   inside of them. Convex polyhedra are filled meshes, made anew from their points (parry joins faces that are nearly in
///   one plane, which may leave cracks); flat ones are surfaces.
/// * Triangles, segments and polylines are meshes, of triangles with two corners in one place where needed.
/// * Shapes with a round border, and custom ones, are errors.
///
/// # Errors
/// [`ParryError::Mesh`], [`ParryError::Size`], [`ParryError::BadPose`], [`ParryError::BadNormal`], [`ParryError::Round`],
/// [`ParryError::Custom`], [`ParryError::TooClose`], or one of these in a [`ParryError::Part`].
pub fn from_parry(shape: &dyn shape::Shape) -> Result<Vec<Part>, ParryError> {
    let here = |shape| Ok(vec![Part { shape, pose: Isometry3::identity() }]);
    let surface = |mesh| here(Shape::Mesh { mesh, filled: false });
    let standing = |solid| {
        let pose = Isometry3::from_parts(Translation3::identity(), upright());
        Ok(vec![Part { shape: Shape::Solid(solid), pose }])
    };
    let round = |what, border| Err(ParryError::Round { what, border });
    match shape.as_typed_shape() {
        TypedShape::Ball(ball) => here(Shape::Solid(Solid::ball(ball.radius)?)),
        TypedShape::Cuboid(cuboid) => {
            let size = cuboid.half_extents * 2.0;
            here(Shape::Solid(Solid::cuboid(size.x, size.y, size.z)?))
        }
        TypedShape::Capsule(capsule) => Ok(vec![from_capsule(capsule)?]),
        TypedShape::Cylinder(cylinder) => {
            standing(Solid::cylinder(cylinder.radius, 2.0 * cylinder.half_height)?)
        }
        TypedShape::Cone(cone) => standing(Solid::cone(cone.radius, 2.0 * cone.half_height)?),
        TypedShape::HalfSpace(half_space) => {
            let n = half_space.normal;
            let turn = toward(&point_from_parry(n).coords);
            let turn = turn.ok_or(ParryError::BadNormal { x: n.x, y: n.y, z: n.z })?;
            let pose = Isometry3::from_parts(Translation3::identity(), turn);
            Ok(vec![Part { shape: Shape::Solid(Solid::half_space()), pose }])
        }
        TypedShape::Segment(segment) => surface(soup([[segment.a, segment.b, segment.b]])?),
        TypedShape::Polyline(line) => surface(soup(line.segments().map(|s| [s.a, s.b, s.b]))?),
        TypedShape::Triangle(triangle) => surface(soup([[triangle.a, triangle.b, triangle.c]])?),
        TypedShape::TriMesh(mesh) => surface(mesh_from_parry(mesh)?),
        TypedShape::HeightField(field) => surface(soup(field.triangles().map(|t| [t.a, t.b, t.c]))?),
        TypedShape::Voxels(voxels) => {
            let (vertices, triangles) = voxels.to_trimesh();
            surface(made_of(&vertices, triangles)?)
        }
        TypedShape::ConvexPolyhedron(polyhedron) => here(from_polyhedron(polyhedron)?),
        TypedShape::Compound(compound) => {
            let mut parts = Vec::new();
            for (part, (pose, shape)) in compound.shapes().iter().enumerate() {
                let of_part = |error| ParryError::Part { part, source: Box::new(error) };
                let pose_cp = pose_from_parry(pose).map_err(of_part)?;
                let moved = |inner: Part| Part { pose: pose_cp * inner.pose, ..inner };
                parts.extend(from_parry(&**shape).map_err(of_part)?.into_iter().map(moved));
            }
            Ok(parts)
        }
        TypedShape::RoundCuboid(round_) => round("cuboid", round_.border_radius),
        TypedShape::RoundTriangle(round_) => round("triangle", round_.border_radius),
        TypedShape::RoundCylinder(round_) => round("cylinder", round_.border_radius),
        TypedShape::RoundCone(round_) => round("cone", round_.border_radius),
        TypedShape::RoundConvexPolyhedron(round_) => round("convex polyhedron", round_.border_radius),
        TypedShape::Custom(_) => Err(ParryError::Custom),
    }
}

fn from_polyhedron(polyhedron: &shape::ConvexPolyhedron) -> Result<Shape, ParryError> {
    let (vertices, triangles) = polyhedron.to_trimesh();
    // Checks that all numbers are finite.
    let mesh = made_of(&vertices, triangles)?;
    match hull_of(mesh.vertices()) {
        Ok(mesh) => Ok(Shape::Mesh { mesh, filled: true }),
        Err(ParryError::Flat) => Ok(Shape::Mesh { mesh, filled: false }),
        Err(other) => Err(other),
    }
}

fn from_capsule(capsule: &shape::Capsule) -> Result<Part, ParryError> {
    let [a, b] = [capsule.segment.a, capsule.segment.b].map(point_from_parry);
    if !(a.iter().chain(b.iter()).all(|c| c.is_finite())) {
        return Err(ParryError::BadPose);
    }
    // Halves first: their sum and difference are finite where the ends are.
    let middle = Translation3::from(a.coords * 0.5 + b.coords * 0.5);
    let half = b.coords * 0.5 - a.coords * 0.5;
    let (solid, turn) = match toward(&half) {
        // Along an axis the length is exact.
        Some(turn) => {
            let largest = half.amax();
            let length = 2.0 * largest * (half / largest).norm();
            (Solid::capsule(capsule.radius, length)?, turn)
        }
        None => (Solid::ball(capsule.radius)?, UnitQuaternion::identity()),
    };
    Ok(Part { shape: Shape::Solid(solid), pose: Isometry3::from_parts(middle, turn) })
}
