//! The axes of the boxes of nodes: those of least surface among several frames, in `f32` from a sample of triangles.
//!
//! A build fits one box for each node, so this is a rough and fast fit. The box at the root is fitted once more, in `f64`
//! from all triangles (`root_box`); the box of least volume, which takes far longer, is [`mp_geom::TriMesh::obb`].

use nalgebra::{Matrix3, Vector3};

use crate::bvh::split::{BuildTriangle, Vec4, along, max, min, surface};

/// Three orthonormal axes.
pub(crate) type Axes = [[f32; 3]; 3];

/// The axes of the mesh.
pub(crate) const MESH: Axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The most triangles of a sample.
const SAMPLE: usize = 48;

/// The turns by which boxes are made smaller: tangents of half the angle.
const TURNS: [f64; 3] = [0.05, 0.025, 0.0125];

/// The axes of a small box around `items`, the best of: the axes of the mesh; the principal axes of surface, corners and
/// normals; the largest triangle's normal and shortest edge.
pub(crate) fn frame(items: &[BuildTriangle]) -> Axes {
    let (sample, count) = sample(items);
    let mut best = BestAxes { corners: sample[..count].as_flattened(), surface: f32::INFINITY, frame: MESH };
    best.offer(&MESH);
    principal(&sample[..count], &mut best);
    best.frame
}

/// At most [`SAMPLE`] triangles, evenly spread over the list, and their number.
fn sample(items: &[BuildTriangle]) -> ([[Vec4; 3]; SAMPLE], usize) {
    let mut sample = [[[0.0; 4]; 3]; SAMPLE];
    let step = items.len().div_ceil(SAMPLE);
    let mut count = 0;
    for item in items.iter().step_by(step) {
        sample[count] = item.corners();
        count += 1;
    }
    (sample, count)
}

/// Turns `frame` by small angles about one axis after the other where the box around `items` shrinks. `None`
/// where it never does.
pub(crate) fn refine(items: &[BuildTriangle], frame: &Axes) -> Option<Axes> {
    let (sample, count) = sample(items);
    let corners = sample[..count].as_flattened();
    let mut axes = frame.map(|u| Vector3::from(u.map(f64::from)));
    let (lo, hi) = extent(corners.iter().copied(), &columns(frame));
    let mut size: [f32; 3] = std::array::from_fn(|k| hi[k] - lo[k]);
    let start = surface(&lo, &hi);
    let mut best = start;
    for half_tangent in TURNS {
        let square: f64 = half_tangent * half_tangent;
        let (sine, cosine) = (2.0 * half_tangent / (1.0 + square), (1.0 - square) / (1.0 + square));
        for (k, i, j) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            let [ci, cj, si, sj] = [axes[i] * cosine, axes[j] * cosine, axes[i] * sine, axes[j] * sine];
            // Both senses of rotation at once.
            let turned = [ci + sj, cj - si, ci - sj, cj + si];
            let columns = std::array::from_fn(|d| turned.map(|u| u[d] as f32));
            let (lo, hi) = extent(corners.iter().copied(), &columns);
            for (p, q) in [(0, 1), (2, 3)] {
                let (x, y) = (hi[p] - lo[p], hi[q] - lo[q]);
                let surface = x * y + size[k] * (x + y);
                if surface < best * 0.999 {
                    best = surface;
                    (size[i], size[j]) = (x, y);
                    (axes[i], axes[j]) = (turned[p], turned[q]);
                }
            }
        }
    }
    if best >= start {
        return None;
    }
    Some(rounded(&orthonormal(&axes[0], &axes[1])))
}

/// Right-handed unit axes: along `x`, and by Gram and Schmidt along `y`.
pub(crate) fn orthonormal(x: &Vector3<f64>, y: &Vector3<f64>) -> [Vector3<f64>; 3] {
    let x = x.normalize();
    let y = (y - x * x.dot(y)).normalize();
    [x, y, x.cross(&y)]
}

fn rounded(axes: &[Vector3<f64>; 3]) -> Axes {
    axes.map(|u| [u.x as f32, u.y as f32, u.z as f32])
}

/// The least and the greatest coordinate along each axis.
#[inline(always)]
pub(crate) fn extent(corners: impl IntoIterator<Item = Vec4>, columns: &[Vec4; 3]) -> (Vec4, Vec4) {
    let (mut lo, mut hi) = ([f32::INFINITY; 4], [f32::NEG_INFINITY; 4]);
    for p in corners {
        let x = along(columns, &p);
        (lo, hi) = (min(&x, &lo), max(&x, &hi));
    }
    (lo, hi)
}

/// The columns of a frame, to multiply four at a time.
#[inline(always)]
pub(crate) fn columns(frame: &Axes) -> [Vec4; 3] {
    std::array::from_fn(|d| [frame[0][d], frame[1][d], frame[2][d], 0.0])
}

/// The best frame so far.
struct BestAxes<'a> {
    corners: &'a [Vec4],
    surface: f32,
    frame: Axes,
}

impl BestAxes<'_> {
    fn offer(&mut self, frame: &Axes) {
        let (lo, hi) = extent(self.corners.iter().copied(), &columns(frame));
        let surface = surface(&lo, &hi);
        if surface < self.surface * 0.999 && frame.as_flattened().iter().all(|x| x.is_finite()) {
            (self.surface, self.frame) = (surface, *frame);
        }
    }

    fn offer_axes(&mut self, axes: &[Vector3<f64>; 3]) {
        self.offer(&rounded(axes));
    }
}

/// Offers the frames that depend on the triangles.
fn principal(triangles: &[[Vec4; 3]], best: &mut BestAxes<'_>) {
    let at = |p: &Vec4| Vector3::new(f64::from(p[0]), f64::from(p[1]), f64::from(p[2]));
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
    let (mut surface, mut corners, mut normals) = (Moment::ZERO, Moment::ZERO, Moment::ZERO);
    for t in triangles {
        let p = [at(&t[0]) - mean, at(&t[1]) - mean, at(&t[2]) - mean];
        let n = (p[1] - p[0]).cross(&(p[2] - p[0]));
        let twice = n.norm() + f64::MIN_POSITIVE;
        let mut own = Moment::ZERO;
        for p in &p {
            own.add(p, 1.0);
        }
        corners.add_all(&own, 1.0);
        own.add(&(p[0] + p[1] + p[2]), 1.0);
        surface.add_all(&own, twice);
        normals.add(&n, 1.0 / twice);
    }
    for moment in [surface, corners, normals] {
        best.offer_axes(&moment.principal_axes());
    }
    // In a mesh of a box all triangles have a right angle, and the shortest edge lies along an axis of the box.
    let [a, b, c] = [at(&triangles[largest][0]), at(&triangles[largest][1]), at(&triangles[largest][2])];
    let mut edge = b - a;
    for other in [c - b, a - c] {
        if other.norm_squared() < edge.norm_squared() {
            edge = other;
        }
    }
    let normal = (b - a).cross(&(c - a)).try_normalize(f64::MIN_POSITIVE);
    // The edge of a sliver is orthogonal to the normal only after its component along the normal is removed.
    let along = normal.and_then(|n| (edge - n * n.dot(&edge)).try_normalize(f64::MIN_POSITIVE));
    if let (Some(n), Some(e)) = (normal, along) {
        best.offer_axes(&[e, n.cross(&e), n]);
    }
}

/// A sum of products of coordinates: a symmetric matrix as xx, yy, zz, xy, yz, zx.
#[derive(Clone, Copy)]
struct Moment([f64; 6]);

impl Moment {
    const ZERO: Self = Self([0.0; 6]);

    #[inline(always)]
    fn add(&mut self, p: &Vector3<f64>, weight: f64) {
        let w = p * weight;
        self.add_all(&Self([w.x * p.x, w.y * p.y, w.z * p.z, w.x * p.y, w.y * p.z, w.z * p.x]), 1.0);
    }

    #[inline(always)]
    fn add_all(&mut self, other: &Self, weight: f64) {
        for i in 0..6 {
            self.0[i] += other.0[i] * weight;
        }
    }

    /// The eigenvectors, by Jacobi's rotations.
    fn principal_axes(&self) -> [Vector3<f64>; 3] {
        let [xx, yy, zz, xy, yz, zx] = self.0;
        let mut m = Matrix3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz);
        let mut v = Matrix3::<f64>::identity();
        for _ in 0..8 {
            let mut done = true;
            for (p, q) in [(0, 1), (0, 2), (1, 2)] {
                if m[(p, q)].abs() <= 1e-6 * (m[(p, p)].abs() + m[(q, q)].abs()) {
                    continue;
                }
                done = false;
                let theta = (m[(q, q)] - m[(p, p)]) / (2.0 * m[(p, q)]);
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
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
            if done {
                break;
            }
        }
        orthonormal(&v.column(0).into(), &v.column(1).into())
    }
}
