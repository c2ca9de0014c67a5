//! Rasterization of triangles and lines.

use crate::camera::{Camera, Projected};
use nalgebra::Point3;

/// A corner of a triangle in the camera frame, and how brightly it is lit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    /// In the camera frame, metres.
    pub(crate) at: Point3<f64>,
    /// Brightness, 0 to about 1.
    pub(crate) light: f32,
}

/// Calls `fragment(sample, key, light)` for every sample whose centre the triangle covers. Triangles that
/// share an edge cover each sample of it once.
pub(crate) fn triangle(camera: &Camera, corners: [Corner; 3], mut fragment: impl FnMut(usize, f32, f32)) {
    if corners.iter().all(|c| c.at.z >= camera.near) {
        let v = corners.map(|c| (camera.project(&c.at), c.light));
        fill(camera, v, &mut fragment);
        return;
    }
    // Clip the part behind the near plane: at most four corners remain.
    let mut kept = Vec::with_capacity(4);
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        if a.at.z >= camera.near {
            kept.push(a);
        }
        if (a.at.z >= camera.near) != (b.at.z >= camera.near) {
            let t = (camera.near - a.at.z) / (b.at.z - a.at.z);
            let mut at = a.at + (b.at - a.at) * t;
            at.z = camera.near;
            kept.push(Corner { at, light: a.light + (b.light - a.light) * t as f32 });
        }
    }
    let v: Vec<_> = kept.iter().map(|c| (camera.project(&c.at), c.light)).collect();
    for i in 2..v.len() {
        fill(camera, [v[0], v[i - 1], v[i]], &mut fragment);
    }
}

fn fill(camera: &Camera, mut v: [(Projected, f32); 3], fragment: &mut impl FnMut(usize, f32, f32)) {
    v.sort_by(|a, b| a.0.y.total_cmp(&b.0.y));
    let [(a, la), (b, lb), (c, lc)] = v;
    let (ux, uy, wx, wy) = (b.x - a.x, b.y - a.y, c.x - a.x, c.y - a.y);
    let area = ux * wy - uy * wx;
    if area == 0.0 || !area.is_finite() {
        return;
    }
    // Slopes of the linear functions key(x, y) and light(x, y).
    let plane = |fa: f32, fb: f32, fc: f32| {
        let (u, w) = (fb - fa, fc - fa);
        ((u * wy - w * uy) / area, (w * ux - u * wx) / area)
    };
    let ((kx, ky), (lx, ly)) = (plane(a.key, b.key, c.key), plane(la, lb, lc));
    let cross = |p: Projected, q: Projected, y: f32| p.x + (y - p.y) * ((q.x - p.x) / (q.y - p.y));
    let first = |y: f32, limit: usize| (y - 0.5).ceil().clamp(0.0, limit as f32) as usize;
    let (lo, hi) = (a.key, a.key.max(b.key).max(c.key));
    let lo = lo.min(b.key).min(c.key);
    for row in first(a.y, camera.height)..first(c.y, camera.height) {
        let y = row as f32 + 0.5;
        let long = cross(a, c, y);
        let short = if y < b.y { cross(a, b, y) } else { cross(b, c, y) };
        let (from, to) = (first(long.min(short), camera.width), first(long.max(short), camera.width));
        for column in from..to {
            let (dx, dy) = (column as f32 + 0.5 - a.x, y - a.y);
            // Slivers have steep slopes: keep the key within the range of the corners.
            let key = (a.key + kx * dx + ky * dy).clamp(lo, hi);
            fragment(row * camera.width + column, key, (la + lx * dx + ly * dy).clamp(0.0, 1.5));
        }
    }
}

/// Calls `fragment(sample, key, coverage)` for the samples that a line with a half width of `half` samples
/// covers.
pub(crate) fn line(
    camera: &Camera,
    a: &Point3<f64>,
    b: &Point3<f64>,
    half: f32,
    fragment: impl FnMut(usize, f32, f32),
) {
    let (mut a, mut b) = (*a, *b);
    if a.z < camera.near && b.z < camera.near {
        return;
    }
    if a.z < camera.near {
        a += (b - a) * ((camera.near - a.z) / (b.z - a.z));
        a.z = camera.near;
    } else if b.z < camera.near {
        b += (a - b) * ((camera.near - b.z) / (a.z - b.z));
        b.z = camera.near;
    }
    stroke((camera.width, camera.height), camera.project(&a), camera.project(&b), half, fragment);
}

/// As [`line()`], between points of the picture.
pub(crate) fn stroke(
    (width, height): (usize, usize),
    a: Projected,
    b: Projected,
    half: f32,
    mut fragment: impl FnMut(usize, f32, f32),
) {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let length2 = dx * dx + dy * dy;
    let reach = half + 0.5;
    let clamp = |v: f32, limit: usize| v.clamp(0.0, limit as f32) as usize;
    let rows = clamp((a.y.min(b.y) - reach).floor(), height)..clamp((a.y.max(b.y) + reach).ceil(), height);
    for row in rows {
        let y = row as f32 + 0.5;
        // The part of the line that this row can be near, then the columns of that part.
        let (mut t0, mut t1) = (0.0f32, 1.0f32);
        if dy.abs() > 1e-3 {
            let (p, q) = ((y - reach - a.y) / dy, (y + reach - a.y) / dy);
            // A wide line extends by its half width, measured along the line.
            let slack = reach / length2.sqrt();
            (t0, t1) = ((p.min(q) - slack).max(0.0), (p.max(q) + slack).min(1.0));
        }
        let (xa, xb) = (a.x + dx * t0, a.x + dx * t1);
        let columns = clamp((xa.min(xb) - reach).floor(), width)..clamp((xa.max(xb) + reach).ceil(), width);
        for column in columns {
            let (px, py) = (column as f32 + 0.5 - a.x, y - a.y);
            let t = if length2 > 0.0 { ((px * dx + py * dy) / length2).clamp(0.0, 1.0) } else { 0.0 };
            let (x, y) = (px - t * dx, py - t * dy);
            let away = (x * x + y * y).sqrt();
            let coverage = (half + 0.5 - away).clamp(0.0, 1.0) * (2.0 * half).min(1.0);
            if coverage > 0.0 {
                fragment(row * width + column, a.key + (b.key - a.key) * t, coverage);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        let points = [Point3::new(-1.0, -1.0, -1.0), Point3::new(1.0, 1.0, 1.0)];
        Camera::top(&points, (64, 64), [0.0; 4])
    }

    fn corner(x: f64, y: f64) -> Corner {
        Corner { at: camera().pose_cw * Point3::new(x, y, 0.0), light: 0.5 }
    }

    #[test]
    fn a_fan_covers_a_square_once() {
        let camera = camera();
        let rim = [(-0.9, -0.9), (0.13, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)];
        let mut hits = vec![0; 64 * 64];
        for i in 0..rim.len() {
            let ((x0, y0), (x1, y1)) = (rim[i], rim[(i + 1) % rim.len()]);
            let t = [corner(0.071, 0.22), corner(x0, y0), corner(x1, y1)];
            triangle(&camera, t, |i, _, _| hits[i] += 1);
        }
        assert!(hits.iter().all(|&h| h <= 1));
        let covered = hits.iter().filter(|&&h| h == 1).count() as f64;
        assert!((covered - 57.6 * 57.6).abs() < 130.0, "{covered}");
    }

    #[test]
    fn what_is_behind_the_eye_is_cut() {
        let points = [Point3::new(-1.0, -1.0, -1.0), Point3::new(1.0, 1.0, 1.0)];
        let camera = Camera::three_quarter(&points, 0.5, 0.5, (64, 64), [0.1; 4]);
        let mut n = 0;
        let c = |x, y, z| Corner { at: Point3::new(x, y, z), light: 1.0 };
        triangle(&camera, [c(0.0, 0.0, -5.0), c(1.0, 0.0, 5.0), c(0.0, 1.0, 5.0)], |_, key, _| {
            assert!(camera.depth(key) >= camera.near as f32 * 0.999);
            n += 1;
        });
        assert!(n > 0);
        triangle(&camera, [c(0.0, 0.0, -5.0), c(1.0, 0.0, -5.0), c(0.0, 1.0, -5.0)], |_, _, _| panic!());
    }

    #[test]
    fn a_line_covers_about_its_length_times_its_width() {
        for (x, y) in [(0.8, 0.0), (0.0, 0.8), (0.5, 0.6)] {
            let mut sum = 0.0;
            let (a, b) = (corner(-x, -y).at, corner(x, y).at);
            line(&camera(), &a, &b, 1.0, |_, _, c| sum += f64::from(c));
            let length = 64.0 * mp_math::hypot(x, y);
            assert!((sum / (2.0 * length) - 1.0).abs() < 0.08, "{sum} {length}");
        }
    }
}
