//! Fitting a box: the one of least surface among several frames.

use nalgebra::{Matrix3, Vector3};

use super::Obb;
use crate::triangle::Triangle;

type Frame = [[f64; 3]; 3];

/// At most so many triangles are looked at to choose a frame; the extent is always that of all.
const SAMPLE: usize = 48;

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A small box around `triangles` (centred coordinates), conservative in `f32`.
pub(crate) fn fit(triangles: &[[[f64; 3]; 3]]) -> Obb {
    let step = triangles.len().div_ceil(SAMPLE);
    let sample: Vec<[[f64; 3]; 3]> = triangles.iter().step_by(step).copied().collect();
    let mut best: Option<(f64, Frame)> = None;
    for frame in candidates(&sample) {
        let (lo, hi) = extent(&sample, &frame);
        let h = [hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]];
        let surface = h[0] * h[1] + h[1] * h[2] + h[2] * h[0];
        if best.is_none_or(|(s, _)| surface < s * 0.999) {
            best = Some((surface, frame));
        }
    }
    let frame = best.map_or([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], |(_, f)| f);
    around(triangles, &frame)
}

/// The box with these axes: rounded to `f32` first, then grown around the triangles in `f64`.
fn around(triangles: &[[[f64; 3]; 3]], frame: &Frame) -> Obb {
    let axes: [[f32; 3]; 3] = frame.map(|u| u.map(|x| x as f32));
    let wide: Frame = axes.map(|u| u.map(f64::from));
    let (lo, hi) = extent(triangles, &wide);
    let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * (lo[k] + hi[k]));
    let center: [f32; 3] =
        std::array::from_fn(|d| (0..3).map(|k| wide[k][d] * middle[k]).sum::<f64>() as f32);
    let half: [f32; 3] = std::array::from_fn(|k| {
        // The rounded axes are not quite orthogonal: measure from where the centre really is. A box test
        // takes them for orthonormal; `Frames::pad` covers that.
        let at = dot(&wide[k], &center.map(f64::from));
        ((hi[k] - at).max(at - lo[k]) * (1.0 + 3e-7)) as f32
    });
    let frame = std::array::from_fn(|d| [center[d], axes[0][d], axes[1][d], axes[2][d]]);
    Obb::new(frame, half)
}

/// The least and the greatest coordinate along each axis.
fn extent(triangles: &[[[f64; 3]; 3]], frame: &Frame) -> ([f64; 3], [f64; 3]) {
    let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in triangles.iter().flatten() {
        for k in 0..3 {
            let x = dot(&frame[k], p);
            lo[k] = if x < lo[k] { x } else { lo[k] };
            hi[k] = if x > hi[k] { x } else { hi[k] };
        }
    }
    (lo, hi)
}

/// The axes of the mesh; principal axes of surface, corners and normals; and the largest triangle's
/// normal with each of its edges.
fn candidates(triangles: &[[[f64; 3]; 3]]) -> Vec<Frame> {
    let mut frames: Vec<Frame> = vec![[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]];
    let at = |p: &[f64; 3]| Vector3::new(p[0], p[1], p[2]);
    let (mut area, mut mean) = (0.0, Vector3::zeros());
    let (mut largest, mut largest_area) = (0, -1.0);
    for (i, t) in triangles.iter().enumerate() {
        let [a, b, c] = [at(&t[0]), at(&t[1]), at(&t[2])];
        let twice = (b - a).cross(&(c - a)).norm() + f64::MIN_POSITIVE;
        area += twice;
        mean += (a + b + c) * (twice / 3.0);
        if twice > largest_area {
            (largest, largest_area) = (i, twice);
        }
    }
    mean /= area;
    let (mut surface, mut corners, mut normals) = (Matrix3::zeros(), Matrix3::zeros(), Matrix3::zeros());
    for t in triangles {
        let p = [at(&t[0]) - mean, at(&t[1]) - mean, at(&t[2]) - mean];
        let n = (p[1] - p[0]).cross(&(p[2] - p[0]));
        let twice = n.norm() + f64::MIN_POSITIVE;
        let sum = p[0] + p[1] + p[2];
        let own = p[0] * p[0].transpose() + p[1] * p[1].transpose() + p[2] * p[2].transpose();
        surface += (sum * sum.transpose() + own) * twice;
        corners += own;
        normals += n * n.transpose() / twice;
    }
    frames.extend([surface, corners, normals].map(principal_axes));
    let t = &triangles[largest];
    let normal = (at(&t[1]) - at(&t[0])).cross(&(at(&t[2]) - at(&t[0]))).try_normalize(f64::MIN_POSITIVE);
    if let Some(n) = normal {
        for k in 0..3 {
            // Orthogonal to the normal of a sliver only after taking the normal's part away.
            let e = at(&t[(k + 1) % 3]) - at(&t[k]);
            if let Some(e) = (e - n * n.dot(&e)).try_normalize(f64::MIN_POSITIVE) {
                frames.push([e, n.cross(&e), n].map(|v| [v.x, v.y, v.z]));
            }
        }
    }
    frames.retain(|f| f.iter().flatten().all(|x| x.is_finite()));
    frames
}

/// The eigenvectors of a symmetric matrix, by Jacobi's rotations.
fn principal_axes(mut m: Matrix3<f64>) -> Frame {
    let mut v = Matrix3::<f64>::identity();
    for _ in 0..8 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if m[(p, q)].abs() <= 1e-14 * (m[(p, p)].abs() + m[(q, q)].abs()) {
                continue;
            }
            let theta = (m[(q, q)] - m[(p, p)]) / (2.0 * m[(p, q)]);
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = t * c;
            for k in 0..3 {
                let (x, y) = (m[(k, p)], m[(k, q)]);
                (m[(k, p)], m[(k, q)]) = (c * x - s * y, s * x + c * y);
            }
            for k in 0..3 {
                let (x, y) = (m[(p, k)], m[(q, k)]);
                (m[(p, k)], m[(q, k)]) = (c * x - s * y, s * x + c * y);
                let (x, y) = (v[(k, p)], v[(k, q)]);
                (v[(k, p)], v[(k, q)]) = (c * x - s * y, s * x + c * y);
            }
        }
    }
    let x: Vector3<f64> = v.column(0).normalize();
    let y: Vector3<f64> = v.column(1).into();
    let y = (y - x * x.dot(&y)).normalize();
    [x, y, x.cross(&y)].map(|v| [v.x, v.y, v.z])
}

/// The triangles of a mesh relative to `center`.
pub(crate) fn centred(triangle: &Triangle, center: &nalgebra::Point3<f64>) -> [[f64; 3]; 3] {
    triangle.map(|p| [p.x - center.x, p.y - center.y, p.z - center.z])
}
