//! The oriented box around a whole mesh, in `f64`: fitting, and a lower bound on distance.
//!
//! Gottschalk, Lin, Manocha, *OBBTree: A Hierarchical Structure for Rapid Interference Detection*,
//! SIGGRAPH 1996.

use mp_stop::Interrupted;
use nalgebra::{Matrix3, Point3, Vector3};

use crate::bvh::fit::orthonormal;
use crate::triangle::Triangle;

/// An oriented box: centre, three orthonormal axes, half its extent along each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RootBox {
    pub(crate) center: Point3<f64>,
    pub(crate) axes: [Vector3<f64>; 3],
    pub(crate) half: Vector3<f64>,
}

impl RootBox {
    /// A small box around `triangles`: the one of least surface along several frames (the principal axes of the surface,
    /// the frame of the largest triangle, the axes of the mesh). O(n).
    ///
    /// # Errors
    /// That of `go_on`, which is called after each pass.
    pub(crate) fn fit(
        triangles: impl Iterator<Item = Triangle> + Clone,
        go_on: &mut dyn FnMut() -> Result<(), Interrupted>,
    ) -> Result<Self, Interrupted> {
        let principal = principal_axes(triangles.clone());
        go_on()?;
        let of_largest = largest_triangle_axes(triangles.clone());
        go_on()?;
        let mut best = Self::around(triangles.clone(), principal);
        for frame in [of_largest, [Vector3::x(), Vector3::y(), Vector3::z()]] {
            go_on()?;
            let other = Self::around(triangles.clone(), frame);
            if other.surface() < best.surface() {
                best = other;
            }
        }
        Ok(best)
    }

    /// The smallest box with these axes.
    fn around(triangles: impl Iterator<Item = Triangle>, axes: [Vector3<f64>; 3]) -> Self {
        let (mut min, mut max) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
        for p in triangles.flatten() {
            let along = Vector3::new(axes[0].dot(&p.coords), axes[1].dot(&p.coords), axes[2].dot(&p.coords));
            min = min.inf(&along);
            max = max.sup(&along);
        }
        let middle = (min + max) * 0.5;
        let center = Point3::from(axes[0] * middle.x + axes[1] * middle.y + axes[2] * middle.z);
        Self { center, axes, half: (max - min) * 0.5 }
    }

    /// An eighth of the surface of the box, to compare boxes.
    fn surface(&self) -> f64 {
        let h = &self.half;
        h.x * h.y + h.y * h.z + h.z * h.x
    }

    /// Whether a point, given from the middle, is outside by more than `pad`.
    pub(crate) fn is_beyond(&self, from_center: &Vector3<f64>, pad: f64) -> bool {
        (0..3).any(|k| self.axes[k].dot(from_center).abs() > self.half[k] + pad)
    }

    /// Half extents of the axis-aligned box around this one.
    pub(crate) fn aligned_half(&self) -> Vector3<f64> {
        self.axes[0].abs() * self.half.x + self.axes[1].abs() * self.half.y + self.axes[2].abs() * self.half.z
    }

    /// A lower bound on the distance of two boxes (both in the same frame), less `slack`; at least 0.
    ///
    /// The larger of two distances: from each box to the box around the other that is aligned with it.
    pub(crate) fn distance_bound(&self, other: &Self, slack: f64) -> f64 {
        let d = other.center - self.center;
        let (ha, hb) = (&self.half, &other.half);
        let across = |i: usize, j: usize| self.axes[i].dot(&other.axes[j]).abs();
        let q = [0, 1, 2].map(|i| [across(i, 0), across(i, 1), across(i, 2)]);
        let (mut from_a, mut from_b) = (0.0, 0.0);
        for k in 0..3 {
            let reach = ha[k] + (hb[0] * q[k][0] + hb[1] * q[k][1] + hb[2] * q[k][2]);
            let gap = (self.axes[k].dot(&d).abs() - reach).max(0.0);
            from_a += gap * gap;
            let reach = hb[k] + (ha[0] * q[0][k] + ha[1] * q[1][k] + ha[2] * q[2][k]);
            let gap = (other.axes[k].dot(&d).abs() - reach).max(0.0);
            from_b += gap * gap;
        }
        (f64::max(from_a, from_b).sqrt() - slack).max(0.0)
    }
}

/// The principal axes of the surface of `triangles` (of their corners when that has no area).
fn principal_axes(triangles: impl Iterator<Item = Triangle> + Clone) -> [Vector3<f64>; 3] {
    // Relative to a corner: less cancellation for meshes far from their origin.
    let Some(origin) = triangles.clone().next().map(|t| t[0]) else {
        return [Vector3::x(), Vector3::y(), Vector3::z()];
    };
    let (mut weight, mut mean, mut moment) = (0.0, Vector3::zeros(), Matrix3::zeros());
    let (mut corners, mut corner_mean, mut corner_moment) = (0.0, Vector3::zeros(), Matrix3::zeros());
    for t in triangles {
        let p = t.map(|corner| corner - origin);
        let area = (p[1] - p[0]).cross(&(p[2] - p[0])).norm();
        let sum = p[0] + p[1] + p[2];
        let outer = p[0] * p[0].transpose() + p[1] * p[1].transpose() + p[2] * p[2].transpose();
        weight += area;
        mean += sum * (area / 3.0);
        // ∫ x xᵀ over a triangle = area/12 · (s sᵀ + Σ p pᵀ), s the sum of its corners.
        moment += (sum * sum.transpose() + outer) * (area / 12.0);
        corners += 3.0;
        corner_mean += sum;
        corner_moment += outer;
    }
    if weight <= 0.0 {
        (weight, mean, moment) = (corners, corner_mean, corner_moment);
    }
    let mean = mean / weight;
    eigenvectors(moment / weight - mean * mean.transpose())
}

/// The frame of the largest triangle: its longest edge, its normal, and the direction orthogonal to both.
fn largest_triangle_axes(triangles: impl Iterator<Item = Triangle>) -> [Vector3<f64>; 3] {
    let mut best = (0.0, [Vector3::x(), Vector3::y(), Vector3::z()]);
    for t in triangles {
        let edges = [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
        let longest = edges.iter().max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
        let normal = edges[0].cross(&edges[1]);
        let area = normal.norm();
        if let Some(longest) = longest
            && area > best.0
        {
            // Gram–Schmidt: the normal of a sliver is not quite at a right angle to its edges.
            let x = longest.normalize();
            let z = (normal / area - x * (normal / area).dot(&x)).normalize();
            if z.iter().all(|c| c.is_finite()) {
                best = (area, [x, z.cross(&x), z]);
            }
        }
    }
    best.1
}

/// The eigenvectors of a symmetric matrix, by Jacobi's rotations: orthonormal for any input.
fn eigenvectors(mut m: Matrix3<f64>) -> [Vector3<f64>; 3] {
    let mut v = Matrix3::identity();
    if m.iter().all(|c| c.is_finite()) {
        for _ in 0..12 {
            for (p, q) in [(0, 1), (0, 2), (1, 2)] {
                if m[(p, q)].abs() <= f64::MIN_POSITIVE {
                    continue;
                }
                let theta = (m[(q, q)] - m[(p, p)]) / (2.0 * m[(p, q)]);
                let t = theta.signum() / (theta.abs() + mp_math::hypot(theta, 1.0));
                let c = 1.0 / mp_math::hypot(t, 1.0);
                let s = t * c;
                let mut j = Matrix3::identity();
                (j[(p, p)], j[(q, q)], j[(p, q)], j[(q, p)]) = (c, c, s, -s);
                m = j.transpose() * m * j;
                v *= j;
            }
        }
    }
    // Rounding adds up over the rotations, and the axes of a box must be orthonormal to the last place.
    orthonormal(&v.column(0).into(), &v.column(1).into())
}
