//! Area, volume, centroid, inertia and principal axes.
//!
//! Volume integrals are sums over the tetrahedra spanned by each triangle and a reference point, as in
//! S. Lien and J. T. Kajiya, "A symbolic method for calculating the integral properties of arbitrary
//! nonconvex polyhedra", IEEE CG&A 4(10), 1984.

use crate::TriMesh;
use nalgebra::{Matrix3, Point3, Rotation3, UnitQuaternion, Vector3};
use thiserror::Error;

/// Why a mesh has no mass properties.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MassError {
    /// The surface does not bound a solid.
    #[error(
        "the mesh does not bound a solid: {boundary} boundary edges, {crowded} edges of an odd number of \
         triangles or more than two, {misoriented} edges between triangles turned against each other"
    )]
    NotSolid {
        /// Edges of one triangle.
        boundary: usize,
        /// Edges of more than two triangles.
        crowded: usize,
        /// Edges between triangles of opposite orientation.
        misoriented: usize,
    },
    /// The surface is closed but encloses nothing.
    #[error("the mesh encloses no volume")]
    NoVolume,
}

/// Properties of the solid a mesh bounds, for unit density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// Volume, m³ (with unit density also the mass); positive also for a mesh that is inside out.
    pub volume: f64,
    /// Centre of mass, metres.
    pub centroid: Point3<f64>,
    /// Inertia tensor about the centroid, along the axes of the mesh's frame, m⁵.
    pub inertia: Matrix3<f64>,
}

/// Principal moments and axes of inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalAxes {
    /// Moments about the axes, ascending, m⁵: along the first axis the solid is longest.
    pub moments: Vector3<f64>,
    /// Turns X, Y, Z into the axes; right-handed.
    pub rotation: UnitQuaternion<f64>,
}

impl MassProperties {
    /// Principal moments and axes. Where moments are equal, some orthogonal axes are chosen.
    #[must_use]
    pub fn principal_axes(&self) -> PrincipalAxes {
        let (moments, axes) = sorted_eigen(&self.inertia);
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
        PrincipalAxes { moments, rotation }
    }
}

/// Eigenvalues in ascending order and right-handed unit eigenvectors of a symmetric matrix; the identity
/// for one that overflowed.
pub(crate) fn sorted_eigen(m: &Matrix3<f64>) -> (Vector3<f64>, Matrix3<f64>) {
    if m.iter().any(|v| !v.is_finite()) {
        // The iteration would not terminate.
        return (m.diagonal(), Matrix3::identity());
    }
    let eigen = m.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let [x, y] = [0, 1].map(|k| {
        let v = eigen.eigenvectors.column(order[k]).normalize();
        // The sign is free: make the largest entry positive.
        if v[v.iamax()] < 0.0 { -v } else { v }
    });
    let z = x.cross(&y).normalize();
    (Vector3::from_fn(|k, _| eigen.eigenvalues[order[k]]), Matrix3::from_columns(&[x, z.cross(&x), z]))
}

impl TriMesh {
    /// Area of all triangles, m².
    #[must_use]
    pub fn area(&self) -> f64 {
        (0..self.triangles().len()).map(|i| self.triangle_area(i)).sum()
    }

    /// Area of triangle `i`, m².
    ///
    /// # Panics
    /// When `i` is out of range.
    #[must_use]
    pub fn triangle_area(&self, i: usize) -> f64 {
        let [a, b, c] = self.triangle(i);
        (b - a).cross(&(c - a)).norm() * 0.5
    }

    /// The volume enclosed, m³: negative when a closed mesh is inside out. Without meaning, and dependent on
    /// the frame, for a mesh that is not closed.
    #[must_use]
    pub fn signed_volume(&self) -> f64 {
        self.moments(&self.aabb().center()).0
    }

    /// Whether its [`signed_volume`](Self::signed_volume) is more than rounding.
    #[must_use]
    pub fn encloses_volume(&self) -> bool {
        self.signed_volume().abs() > 1e-14 * self.area() * self.aabb().diagonal()
    }

    /// Volume, centroid and inertia of the solid bounded by the mesh, which may have several parts, cavities,
    /// and parts touching in edges or vertices. Where parts overlap the overlap counts twice.
    ///
    /// # Errors
    /// [`MassError`] when the mesh is not closed and consistently oriented, or encloses nothing.
    pub fn mass_properties(&self) -> Result<MassProperties, MassError> {
        let t = self.topology();
        if t.edges > 0 && !(t.closed && t.oriented) {
            let (boundary, crowded) = (t.boundary_edges.len(), t.crowded_edges.len());
            return Err(MassError::NotSolid { boundary, crowded, misoriented: t.misoriented_edges.len() });
        }
        let bounds = self.aabb();
        let reference = bounds.center();
        let (volume, first, second) = self.moments(&reference);
        if !self.encloses_volume() {
            return Err(MassError::NoVolume);
        }
        let offset = first / volume;
        let covariance = (second - first * offset.transpose()) * volume.signum();
        Ok(MassProperties {
            volume: volume.abs(),
            centroid: reference + offset,
            inertia: Matrix3::identity() * covariance.trace() - covariance,
        })
    }

    /// ∫dV, ∫x dV and ∫x·xᵀ dV about `reference`.
    fn moments(&self, reference: &Point3<f64>) -> (f64, Vector3<f64>, Matrix3<f64>) {
        let (mut zeroth, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
        for i in 0..self.triangles().len() {
            let [a, b, c] = self.triangle(i).map(|p| p - reference);
            let six_volumes = a.dot(&b.cross(&c));
            let sum = a + b + c;
            zeroth += six_volumes / 6.0;
            first += sum * (six_volumes / 24.0);
            let squares = a * a.transpose() + b * b.transpose() + c * c.transpose();
            second += (sum * sum.transpose() + squares) * (six_volumes / 120.0);
        }
        (zeroth, first, second)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{pose_from_six, primitives::*};
    use nalgebra::{Isometry3, Point2};
    use proptest::prelude::*;

    fn pose() -> impl Strategy<Value = Isometry3<f64>> {
        prop::array::uniform6(-3.0..3.0_f64).prop_map(pose_from_six)
    }

    proptest! {
        #[test]
        fn of_a_box_anywhere(x in 0.1..5.0_f64, y in 0.1..5.0_f64, z in 0.1..5.0_f64, pose in pose()) {
            let mesh = cuboid(x, y, z).unwrap().transformed(&pose);
            let m = mesh.mass_properties().unwrap();
            let v = x * y * z;
            prop_assert!((m.volume - v).abs() < 1e-12 * v.max(1.0));
            prop_assert!((mesh.area() - 2.0 * (x * y + y * z + z * x)).abs() < 1e-12 * 100.0);
            prop_assert!((m.centroid.coords - pose.translation.vector).norm() < 1e-11);
            let exact = Vector3::new(y * y + z * z, z * z + x * x, x * x + y * y) * (v / 12.0);
            let r = pose.rotation.to_rotation_matrix().into_inner();
            let inertia = r * Matrix3::from_diagonal(&exact) * r.transpose();
            prop_assert!((m.inertia - inertia).amax() < 1e-10 * exact.amax());
            let p = m.principal_axes();
            let mut sorted: Vec<_> = exact.iter().copied().collect();
            sorted.sort_by(f64::total_cmp);
            prop_assert!((p.moments - Vector3::from_vec(sorted)).amax() < 1e-10 * exact.amax());
            let q = p.rotation.to_rotation_matrix().into_inner();
            prop_assert!((q * Matrix3::from_diagonal(&p.moments) * q.transpose() - inertia).amax() < 1e-10 * exact.amax());
            prop_assert!((q.determinant() - 1.0).abs() < 1e-12);
        }

        #[test]
        fn the_parts_add_up(pose in pose(), w in 0.2..2.0_f64) {
            // An L cut in two boxes, with the parallel axis theorem.
            let l = [(0.0, 0.0), (3.0, 0.0), (3.0, w), (1.0, w), (1.0, 2.5 + w), (0.0, 2.5 + w)].map(|(x, y)| Point2::new(x, y));
            let whole = prism(&l, 0.0, 1.5).unwrap().transformed(&pose).mass_properties().unwrap();
            let boxes = [(3.0, w, 1.5, 0.5 * w), (1.0, 2.5, 0.5, w + 1.25)]
                .map(|(x, y, cx, cy)| cuboid(x, y, 1.5).unwrap().transformed(&(pose * Isometry3::translation(cx, cy, 0.75))));
            let parts = boxes.map(|b| b.mass_properties().unwrap());
            let volume: f64 = parts.iter().map(|p| p.volume).sum();
            prop_assert!((whole.volume - volume).abs() < 1e-11);
            let centroid: Vector3<f64> = parts.iter().map(|p| p.centroid.coords * (p.volume / volume)).sum();
            prop_assert!((whole.centroid.coords - centroid).norm() < 1e-11);
            let inertia: Matrix3<f64> = parts.iter().map(|p| {
                let d = p.centroid.coords - centroid;
                p.inertia + (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * p.volume
            }).sum();
            prop_assert!((whole.inertia - inertia).amax() < 1e-10);
        }
    }

    #[test]
    fn of_round_things() {
        let ball = sphere(1.0, 5).unwrap().mass_properties().unwrap();
        assert!((ball.volume - 4.18879).abs() < 0.01);
        assert!((ball.inertia - Matrix3::identity() * (0.4 * ball.volume)).amax() < 0.01);
        let rod =
            capsule(0.1, 4.0, 24, 6).unwrap().transformed(&pose_from_six([1.0, 2.0, 3.0, 0.3, 0.7, 0.1]));
        let axis = rod.mass_properties().unwrap().principal_axes().rotation * Vector3::x();
        let along = pose_from_six([0.0, 0.0, 0.0, 0.3, 0.7, 0.1]) * Vector3::z();
        assert!(axis.dot(&along).abs() > 1.0 - 1e-12);
    }

    #[test]
    fn inside_out_hollow_open_and_flat() {
        let cube = cuboid(2.0, 2.0, 2.0).unwrap();
        assert_eq!(cube.reversed().signed_volume(), -8.0);
        let (a, b) = (cube.mass_properties().unwrap(), cube.reversed().mass_properties().unwrap());
        assert_eq!(a, b);
        let cavity = cuboid(1.0, 1.0, 1.0).unwrap().reversed();
        let hollow = TriMesh::merged([&cube, &cavity]).unwrap().mass_properties().unwrap();
        assert!((hollow.volume - 7.0).abs() < 1e-14);
        let open = TriMesh::new(cube.vertices().to_vec(), cube.triangles()[1..].to_vec()).unwrap();
        assert_eq!(
            open.mass_properties(),
            Err(MassError::NotSolid { boundary: 3, crowded: 0, misoriented: 0 })
        );
        let [a, b, c] = cube.triangle(0);
        let sheet = TriMesh::from_soup(&[[a, b, c], [c, b, a]]).unwrap();
        assert_eq!(sheet.mass_properties(), Err(MassError::NoVolume));
    }
}
