//! Exact collision detection between meshes, with trees of oriented bounding boxes.
//!
//! * [`CollisionMesh`]: the tree of a mesh, built once, immutable, shared between threads.
//! * [`Query`]: one per thread; intersection, distance, clearance, tolerance, depth, batches of poses,
//!   intervals of motions.
//! * [`Scene`]: many named bodies with a broad phase and allowed pairs; [filled](CollisionMesh::filled) bodies, as those of
//!   [primitives](mp_geom::primitives), collide with what is inside of them.
//! * [`triangle`]: the exact triangle–triangle test and the distance between triangles.
//! * [`mod@reference`]: a second, plain implementation sharing no code with the first, to check it.
//!
//! ```
//! use mp_collide::{CollisionMesh, Query};
//! use mp_geom::TriMesh;
//! use nalgebra::{Isometry3, Point3};
//!
//! let corner = vec![Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)];
//! let mesh = CollisionMesh::new(&TriMesh::new(corner, vec![[0, 1, 2]])?);
//! let mut query = Query::default();
//! let (here, above) = (Isometry3::identity(), Isometry3::translation(0.0, 0.0, 0.25));
//! assert!(query.intersects(&mesh, &here, &mesh, &here));
//! assert!(!query.intersects(&mesh, &above, &mesh, &here));
//! assert_eq!(query.distance(&mesh, &above, &mesh, &here).distance, 0.25);
//! # Ok::<(), mp_geom::MeshError>(())
//! ```
//!
//! # Contract
//! A mesh is the union of its triangles as closed sets: a surface, not a solid (a body wholly inside a
//! closed shell collides with it only in a [`Scene`] and for [`Query::meets`], and when the shell is
//! [filled](CollisionMesh::filled)).
//! **Touching counts as collision.** Meshes are soups: cracks,
//! holes, coplanar, overlapping and degenerate triangles (segments and points) are all welcome.
//!
//! A query of `a` at `pose_wa` and `b` at `pose_wb` transforms the triangles of `b` into the frame of `a`
//! in `f64`, each coordinate rounded as `((r0·x + r1·y) + r2·z) + t`, with the rotation matrix of the relative
//! quaternion computed as `1 − s·(y·y + z·z)`, `s·(x·y − w·z)`, …, `s = 2/‖q‖²`. For those rounded triangles the
//! answer of [`Query::intersects`] is *exact*: decided as in real arithmetic. The rounding of the
//! transform itself (a few units in the last place of the largest coordinate, about 1e-15 relative) is
//! outside the contract, so two meshes that truly touch at a general pose may be found apart by that
//! much, and swapping `a` and `b` may change such an answer. Where the two rotations are equal bit for bit,
//! the relative rotation is exactly the identity; where the whole poses are, nothing is rounded and the
//! answer is exact for the meshes as given. Coordinates that are not zero are to lie within 1e-75 and
//! 1e75 in magnitude for exactness (beyond, intermediate products could underflow or overflow).
//!
//! Distances are accurate to about 1e-14 of the size of the two triangles and their distance from the
//! origin of `a`, hence to better than 1e-12 relative for distances above 1% of that size. A
//! distance is zero exactly when [`Query::intersects`] says so.
//!
//! # Point clouds
//! A mesh that is [balls](mp_geom::TriMesh::balls) has a tree of its own, of the centres. All queries know it. Their answers are those of the plain
//! distance from a centre to a triangle, in `f64`, less the radius: about 1e-15 of the coordinates.
//!
//! # Bad input
//! Queries are total: they neither fail nor panic. A pose with a component that is not finite, beyond 1e75,
//! or whose quaternion is not of unit length (within 1e-6; smaller deviations are normalised away), and a
//! mesh with a coordinate beyond 1e75 or not a number (moved by a pose that is not finite), count as *in
//! collision with everything*: `intersects` is `true`,
//! distance and clearance are 0. So a planner never passes through what cannot be decided.

/// An array of three values, for `k` = 0, 1, 2. A closure that is not inlined would be compiled without the
/// instruction set of the kernel around it.
macro_rules! three {
    ($k:ident => $value:expr) => {
        [
            {
                let $k = 0;
                $value
            },
            {
                let $k = 1;
                $value
            },
            {
                let $k = 2;
                $value
            },
        ]
    };
}

mod around;
mod broad;
mod bvh;
mod cloud;
mod counters;
mod cover;
mod depth;
mod filled;
mod kernels;
mod mesh;
mod pose;
mod query;
mod scene;
mod separation;

pub mod reference;
pub mod triangle;

pub use counters::Counters;
pub use cover::{
    Contacts, Cover, MOST_BALLS, PlacedCover, WideCover, wide_apart, wide_apart_here, wide_within,
    wide_within_here,
};
pub use filled::FillError;
pub use mesh::CollisionMesh;
pub use mp_simd::Isa;
pub use query::Query;
pub use query::interval::{IntervalCheck, RigidMotion};
pub use scene::{Body, BodyId, Contact, Scene, SceneError};
pub use separation::Separation;
