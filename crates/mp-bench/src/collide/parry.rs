//! The queries with parry3d in double precision, in the same process.

use super::ours::TreeBuild;
use super::pairs::Pair;
use super::poses::QueryPoses;
use super::record::{QueryId, TimedAnswers, timed_once};
use crate::clock::nanoseconds;
use crate::error::{IntoError, Result};
use mp_geom::TriMesh;
use nalgebra::Isometry3;
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::query::{distance, intersection_test};
use parry3d_f64::shape;

const PARRY: &str = "parry";

/// The meshes of a pair in parry3d.
#[derive(Clone, Debug)]
pub(crate) struct Parry {
    a: shape::TriMesh,
    b: shape::TriMesh,
}

impl Parry {
    pub(crate) fn new(pair: &Pair) -> Result<(Self, TreeBuild)> {
        let begin = nanoseconds();
        let parry = Self { a: mesh_to_parry(&pair.a)?, b: mesh_to_parry(&pair.b)? };
        let ms = (nanoseconds() - begin) * 1e-6;
        // parry3d does not report its memory.
        Ok((parry, TreeBuild { lib: PARRY.to_owned(), ms, bytes: 0 }))
    }

    /// Runs the queries, each set and kind of query until `cap` seconds are used up.
    pub(crate) fn ask(&self, poses: &QueryPoses, distances: usize, cap: f64) -> Result<Vec<TimedAnswers>> {
        let here = Pose::identity();
        let mut all = Vec::new();
        for (set, poses) in [("uniform", &poses.uniform), ("near", &poses.near)] {
            let poses: Vec<Pose> = poses.iter().map(pose_to_parry).collect();
            let mut failed = None;
            let mut checked = |answer: std::result::Result<f64, parry3d_f64::query::Unsupported>| {
                answer.unwrap_or_else(|e| {
                    failed = Some(e);
                    f64::NAN
                })
            };
            all.push(timed_once(QueryId::new(PARRY, set, "collide"), &poses, cap * 1e9, |pose| {
                checked(
                    intersection_test(&here, &self.a, pose, &self.b).map(|told| f64::from(told.intersecting)),
                )
            }));
            let some = &poses[..distances.min(poses.len())];
            all.push(timed_once(QueryId::new(PARRY, set, "distance"), some, cap * 1e9, |pose| {
                checked(distance(&here, &self.a, pose, &self.b).map(|d| d.distance))
            }));
            failed.map_or(Ok(()), Err).into_error()?;
        }
        Ok(all)
    }
}

/// The same vertices and triangles, with parry's tree.
fn mesh_to_parry(mesh: &TriMesh) -> Result<shape::TriMesh> {
    let vertices = mesh.vertices().iter().map(|p| Vector::new(p.x, p.y, p.z)).collect();
    shape::TriMesh::new(vertices, mesh.triangles().to_vec()).into_error()
}

/// The same pose, to the bit.
fn pose_to_parry(pose: &Isometry3<f64>) -> Pose {
    let (at, q) = (pose.translation.vector, pose.rotation.quaternion());
    Pose::from_parts(Vector::new(at.x, at.y, at.z), Rotation::from_xyzw(q.i, q.j, q.k, q.w))
}
