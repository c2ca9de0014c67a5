//! The pose of one mesh relative to another, checked.

use nalgebra::{Isometry3, Matrix3, Point3, Quaternion, Vector3};

use crate::bvh::root_box::RootBox;
use crate::mesh::PosedMesh;
use crate::triangle::Triangle;

/// Coordinates beyond this could overflow in the exact predicates; see the contract in the crate docs.
pub(crate) const LIMIT: f64 = 1e75;

/// How far from 1 the squared length of a quaternion may be.
const UNIT_TOLERANCE: f64 = 2e-6;

/// Boxes are kept apart only when the gap exceeds this much of the size of the problem: some fifty times
/// the rounding errors of fitting, transforming and testing a box.
const SLACK: f64 = 1e-13;

/// The pose of mesh `b` in the frame of mesh `a`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Relative {
    pub(crate) rotation: Matrix3<f64>,
    pub(crate) translation: Vector3<f64>,
    /// How much boxes are enlarged (metres), so that rounding never makes a query miss a contact.
    pub(crate) slack: f64,
}

impl Relative {
    /// Of two meshes: see [`Relative::between`].
    #[inline(always)]
    pub(crate) fn of((a, pose_wa): PosedMesh<'_>, (b, pose_wb): PosedMesh<'_>) -> Option<Self> {
        Self::between(pose_wa, a.radius(), pose_wb, b.radius())
    }

    /// `None` when a pose or a mesh (by `radius`, its largest coordinate) is not within the limits.
    #[inline(always)]
    pub(crate) fn between(
        pose_wa: &Isometry3<f64>,
        radius_a: f64,
        pose_wb: &Isometry3<f64>,
        radius_b: f64,
    ) -> Option<Self> {
        if !(is_rigid(pose_wa) && is_rigid(pose_wb) && radius_a <= LIMIT && radius_b <= LIMIT) {
            return None;
        }
        let (q_wa, q_wb) = (pose_wa.rotation.quaternion(), pose_wb.rotation.quaternion());
        let (t_wa, t_wb) = (&pose_wa.translation.vector, &pose_wb.translation.vector);
        let apart = t_wb - t_wa;
        // Static bodies are mostly not rotated; then the product below is not needed.
        let (rotation, translation) = if is_identity(q_wa) {
            (rotation_matrix(q_wb), apart)
        } else {
            let back = rotation_matrix(q_wa).transpose();
            let rotation = if q_wa == q_wb {
                Matrix3::identity()
            } else if is_identity(q_wb) {
                back
            } else {
                rotation_matrix(&(q_wa.conjugate() * q_wb))
            };
            (rotation, back * apart)
        };
        // Differences of world coordinates are exact to rounding of the world coordinates themselves, and
        // boxes and triangles see the same difference: only the relative size counts.
        let slack = SLACK * (radius_a + radius_b + translation.norm());
        Some(Self { rotation, translation, slack })
    }

    /// A point of `b` in the frame of `a`.
    #[inline(always)]
    pub(crate) fn point(&self, p: &Point3<f64>) -> Point3<f64> {
        let (r, t) = (&self.rotation, &self.translation);
        Point3::new(
            r.m11 * p.x + r.m12 * p.y + r.m13 * p.z + t.x,
            r.m21 * p.x + r.m22 * p.y + r.m23 * p.z + t.y,
            r.m31 * p.x + r.m32 * p.y + r.m33 * p.z + t.z,
        )
    }

    /// A triangle of `b` in the frame of `a`.
    #[inline(always)]
    pub(crate) fn triangle(&self, triangle: &Triangle) -> Triangle {
        [self.point(&triangle[0]), self.point(&triangle[1]), self.point(&triangle[2])]
    }

    /// A box of `b` in the frame of `a`.
    pub(crate) fn obb(&self, obb: &RootBox) -> RootBox {
        let r = &self.rotation;
        RootBox {
            center: self.point(&obb.center),
            axes: [r * obb.axes[0], r * obb.axes[1], r * obb.axes[2]],
            half: obb.half,
        }
    }
}

/// Whether `pose` is within the limits of the crate docs; NaN is not.
#[inline(always)]
pub(crate) fn is_rigid(pose: &Isometry3<f64>) -> bool {
    let t = &pose.translation.vector;
    ((pose.rotation.quaternion().norm_squared() - 1.0).abs() <= UNIT_TOLERANCE)
        & (t.x.abs() <= LIMIT)
        & (t.y.abs() <= LIMIT)
        & (t.z.abs() <= LIMIT)
}

#[inline(always)]
fn is_identity(q: &Quaternion<f64>) -> bool {
    (q.w == 1.0) & (q.i == 0.0) & (q.j == 0.0) & (q.k == 0.0)
}

/// A point of a body placed in the world.
pub(crate) fn to_world(pose: &Isometry3<f64>, p: &Point3<f64>) -> Point3<f64> {
    rotation_matrix(pose.rotation.quaternion()) * p + pose.translation.vector
}

/// The rotation by `q`, which need not be quite of unit length.
#[inline(always)]
pub(crate) fn rotation_matrix(q: &Quaternion<f64>) -> Matrix3<f64> {
    let s = 2.0 / q.norm_squared();
    let (w, x, y, z) = (q.w, q.i, q.j, q.k);
    Matrix3::new(
        1.0 - s * (y * y + z * z),
        s * (x * y - w * z),
        s * (x * z + w * y),
        s * (x * y + w * z),
        1.0 - s * (x * x + z * z),
        s * (y * z - w * x),
        s * (x * z - w * y),
        s * (y * z + w * x),
        1.0 - s * (x * x + y * y),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    /// The short cuts for poses without rotation give the formulas of the contract, bit for bit.
    #[test]
    fn short_cuts_change_nothing() {
        let here = Isometry3::translation(0.3, -1.7, 0.9);
        for k in 0..50 {
            let x = f64::from(k);
            let turn = UnitQuaternion::from_euler_angles(x, 0.7 * x, -1.3 * x);
            let there = Isometry3::from_parts(Vector3::new(x, 0.1, -x).into(), turn);
            for (a, b) in [(&here, &there), (&there, &here), (&there, &there), (&here, &here)] {
                let (q_a, q_b) = (a.rotation.quaternion(), b.rotation.quaternion());
                let found = Relative::between(a, 1.0, b, 1.0).unwrap();
                let equal = q_a == q_b;
                let rotation =
                    if equal { Matrix3::identity() } else { rotation_matrix(&(q_a.conjugate() * q_b)) };
                let apart = b.translation.vector - a.translation.vector;
                assert_eq!(found.rotation, rotation);
                assert_eq!(found.translation, rotation_matrix(q_a).tr_mul(&apart));
            }
        }
    }
}
