//! Triangle meshes, primitives, poses and bounding volumes for motion planning.
//!
//! - [`TriMesh`]: the indexed mesh, from a soup, strips, fans or polygons; [`TriMesh::topology`] reports
//!   its defects.
//! - [`Aabb`], [`Obb`], [`Sphere`]: bounding volumes.
//! - [`MassProperties`]: volume, centroid, inertia, principal axes.
//! - [`Features`]: size, place and direction of a body for obstacle-geometry planners; [`TriMesh::parts`]: its components.
//! - [`Shape`]: what robots and obstacles are made of: meshes, boxes, spheres, capsules, hulls, ground, points.
//! - [`thin`]: point clouds with one point for each cell of a grid; [`TriMesh::of_balls`]: a ball around each.
//! - [`primitives`]: closed solids; [`TriMesh::into_solid`]: a closed mesh as one.
//! - [`planar`]: polygons in the plane.
//! - [`pose_from_six`] and others: poses to and from numbers; [`six_tuples`] of a motion.
//!
//! Lengths are metres, angles radians.

mod aabb;
mod balls;
mod build;
mod features;
mod mass;
mod mesh;
mod obb;
pub mod planar;
mod pose;
pub mod primitives;
mod shape;
mod six_tuples;
mod solid;
mod sphere;
mod spread;
mod thin;
mod topology;
mod triangulate;

pub use aabb::Aabb;
pub use features::Features;
pub use mass::{MassError, MassProperties, PrincipalAxes};
pub use mesh::{MeshError, TriMesh};
pub use obb::Obb;
pub use pose::{
    PoseError, ROTATION_TOLERANCE, matrix_from_pose, pose_from_matrix, pose_from_quaternion, pose_from_six,
    rotation_from_matrix, short_six_from_pose, six_from_pose,
};
pub use primitives::PrimitiveError;
pub use shape::{HeightField, PRIMITIVES, Points, Primitive, Shape, convex_hull};
pub use six_tuples::{continued_six, displacement_bound, six_tuples};
pub use solid::SolidError;
pub use sphere::{Sphere, minimal_sphere};
pub use spread::evenly;
pub use thin::{ThinError, Thinned, thin};
pub use topology::{NO_COMPONENT, Topology};
