//! Conversions from and to shapes of [`parry3d_f64`], the collision library of Rapier; convex hulls and decompositions.
//!
//! Only with the feature `parry`, which is off by default; types of parry are in the public API of this module and nowhere
//! else. Types of parry are written with the path of its crate: `parry3d_f64::shape::TriMesh` beside
//! [`mp_geom::TriMesh`]. Scenes of Rapier and Bevy are converted shape by shape. Shapes of `rapier3d-f64`, and of Avian with
//! its feature `f64`, are of these types; those of single precision (`parry3d`) must first be made anew in `f64`.
//!
//! # Frames
//! Lengths are metres on both sides. The axis of a cylinder or a cone is Y in parry and Z here; capsules lie along any
//! segment in parry, along Z about the origin here; half-spaces have any normal in parry, Z here. So a converted shape comes
//! with the pose at which it is the same set of points; the rotation costs rounding, about 1e-16 of the size.
//!
//! # What is solid
//! A mesh is a surface on both sides. Convex polyhedra are solids in parry, and become [filled](Shape::Mesh) meshes.
//!
//! ```
//! use mp_collide::{CollisionMesh, Query, Scene, parry};
//! use nalgebra::{Isometry3, Vector3};
//! use parry3d_f64::math::{Pose, Vector};
//! use parry3d_f64::shape::SharedShape;
//!
//! // A collider as Rapier has it: a table top on one round leg, along Y, and where it stands.
//! let table = SharedShape::compound(vec![
//!     (Pose::translation(0.0, 0.75, 0.0), SharedShape::cuboid(0.6, 0.02, 0.4)),
//!     (Pose::translation(0.0, 0.365, 0.0), SharedShape::cylinder(0.365, 0.04)),
//! ]);
//! let pose_wc = parry::pose_from_parry(&Pose::translation(2.0, 0.0, 1.0))?;
//!
//! // Each part is a body; round ones become meshes around them, here by 1 mm at most.
//! let mut scene = Scene::new();
//! for part in parry::from_parry(&*table)? {
//!     let mesh = part.shape.to_collision_mesh(0.001)?;
//!     scene.insert("table", mesh, pose_wc * part.pose)?;
//! }
//!
//! // What moves among them: below the top there is room beside the leg.
//! let box_ = CollisionMesh::new(&mp_geom::primitives::cuboid(0.3, 0.3, 0.3)?);
//! let mut query = Query::default();
//! assert!(!scene.collides(&mut query, &box_, &Isometry3::translation(2.3, 0.4, 1.0)));
//! assert!(scene.collides(&mut query, &box_, &Isometry3::translation(2.1, 0.4, 1.0)));
//! assert!(scene.collides(&mut query, &box_, &Isometry3::new(Vector3::new(2.3, 0.7, 1.0), Vector3::y())));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod around;
mod decomposition;
mod error;
mod hull;
mod meshes;
mod poses;
mod shapes;

pub use decomposition::{Decomposition, convex_decomposition};
pub use error::ParryError;
pub use hull::convex_hull;
pub use meshes::{mesh_from_parry, mesh_to_parry};
pub use poses::{point_from_parry, point_to_parry, pose_from_parry, pose_to_parry};
pub use shapes::{Part, Shape, from_parry, solid_to_parry};

/// The result of `work`, or an error when parry panics: it asserts the preconditions of its algorithms.
fn guarded<T>(what: &'static str, work: impl FnOnce() -> T) -> Result<T, ParryError> {
    // Unwind-safe: `work` only reads what it borrows.
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)).map_err(|_| ParryError::Failed { what })
}
