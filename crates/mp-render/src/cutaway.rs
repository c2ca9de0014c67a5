//! Opens the view onto the path: obstacles in front of it fade out.
//!
//! Around each visible point of the path a cone toward the viewer is cleared (adaptive cutaways, Burns and
//! Finkelstein 2008): the depth of the path, less a slope times the distance on the picture. Copies of the
//! robot make the cones wavy and a cut along them torn: the depths are made smooth, and obstacles go from
//! opaque to faint over a wide rim.

use crate::camera::Camera;
use crate::scene::SUPERSAMPLING;

/// The slope of the cone in which obstacles are open, as a multiple of that beyond which they are opaque.
const STEEP: f32 = 2.0;
/// The greatest width of the rim, as a fraction of the height of the picture.
const RIM: f32 = 0.02;
/// Depths are averaged twice over so much to each side, as a fraction of the height of the picture.
const SMOOTH: f32 = 0.01;

/// For every pixel, the depths (metres) between which obstacles fade out.
pub(crate) struct Cutaway {
    /// Up to the first they are open, from the second on opaque.
    depths: Vec<[f32; 2]>,
    /// Samples in a row.
    width: u32,
    /// How far they are open where there are no depths.
    elsewhere: f32,
}

impl Cutaway {
    /// Obstacles are open everywhere, or nowhere.
    pub(crate) fn everywhere(open: bool) -> Self {
        Self { depths: Vec::new(), width: 1, elsewhere: f32::from(u8::from(open)) }
    }

    /// `path` holds the keys of the path's nearest surface, infinite where there is no path; `slope` is
    /// metres of depth per metre across; obstacles within `slack` metres of the path stay opaque.
    pub(crate) fn before(camera: &Camera, path: &[f32], slope: f32, slack: f32) -> Self {
        // The fields are so smooth that one value for each pixel is enough.
        let (width, height) = (camera.width / SUPERSAMPLING, camera.height / SUPERSAMPLING);
        let (mut depth, mut sum, mut n) = (vec![f32::NEG_INFINITY; width * height], 0.0, 0u32);
        for (y, row) in path.chunks_exact(camera.width).enumerate() {
            let depth = &mut depth[y / SUPERSAMPLING * width..][..width];
            for (x, &key) in row.iter().enumerate().filter(|(_, key)| key.is_finite()) {
                let z = camera.depth(key);
                depth[x / SUPERSAMPLING] = z.max(depth[x / SUPERSAMPLING]);
                (sum, n) = (sum + f64::from(z), n + 1);
            }
        }
        if n == 0 {
            return Self::everywhere(false);
        }
        let step = slope * SUPERSAMPLING as f32 * camera.sample_size((sum / f64::from(n)) as f32);
        let mut open = cones(depth.clone(), width, STEEP * step);
        let mut opaque = cones(depth, width, step);
        for field in [&mut open, &mut opaque] {
            smooth(field, width, (SMOOTH * height as f32) as usize);
        }
        let rim = RIM * height as f32 * step;
        let depths = open.iter().zip(&opaque);
        let depths =
            depths.map(|(open, opaque)| [open.max(opaque - rim), *opaque].map(|z| z - slack)).collect();
        Self { depths, width: camera.width as u32, elsewhere: 0.0 }
    }

    /// How far an obstacle at a depth is open: 0 where it is opaque, 1 where it is faint.
    #[inline]
    pub(crate) fn at(&self, i: usize, depth: f32) -> f32 {
        const SIDE: u32 = SUPERSAMPLING as u32;
        if self.depths.is_empty() {
            return self.elsewhere;
        }
        let (y, x) = (i as u32 / self.width / SIDE, i as u32 % self.width / SIDE);
        let [open, opaque] = self.depths[(y * (self.width / SIDE) + x) as usize];
        if depth <= open {
            1.0
        } else if depth < opaque {
            let t = (opaque - depth) / (opaque - open);
            t * t
        } else {
            0.0
        }
    }
}

/// The cones of all samples: each depth less `step` for every sample across, the largest counts.
fn cones(mut depth: Vec<f32>, width: usize, step: f32) -> Vec<f32> {
    // Two sweeps of a chamfer distance transform, in the max-plus sense: from the neighbours before each
    // sample, and from those behind.
    for _ in 0..2 {
        sweep(&mut depth, width, step, step * std::f32::consts::SQRT_2);
        depth.reverse();
    }
    depth
}

/// Raises each depth to those of its neighbours to the left and in the row above, less the way from there.
fn sweep(depth: &mut [f32], width: usize, step: f32, diagonal: f32) {
    for y in 0..depth.len() / width {
        let (above, row) = depth.split_at_mut(y * width);
        let row = &mut row[..width];
        if let Some(above) = y.checked_sub(1).map(|y| &above[y * width..]) {
            for (x, z) in row.iter_mut().enumerate() {
                let beside = |x: usize| above.get(x).map_or(f32::NEG_INFINITY, |z| z - diagonal);
                *z = z.max(above[x] - step).max(beside(x.wrapping_sub(1))).max(beside(x + 1));
            }
        }
        for x in 1..width {
            row[x] = row[x].max(row[x - 1] - step);
        }
    }
}

/// Averages over squares of `reach` places to each side, twice; beyond the picture its border goes on.
fn smooth(field: &mut [f32], width: usize, reach: usize) {
    let height = field.len() / width;
    let share = 1.0 / (2 * reach + 1) as f64;
    // Along rows, each by itself; then along columns, all at once, as memory is read by rows.
    for (length, lanes) in [(width, 1), (height, width)].repeat(2) {
        let before = field.to_vec();
        for (before, field) in before.chunks(length * lanes).zip(field.chunks_mut(length * lanes)) {
            let at = |k: usize| &before[k.saturating_sub(reach).min(length - 1) * lanes..][..lanes];
            let mut sums = vec![0.0; lanes];
            for k in 0..=2 * reach {
                sums.iter_mut().zip(at(k)).for_each(|(sum, z)| *sum += f64::from(*z));
            }
            for (k, field) in field.chunks_mut(lanes).enumerate() {
                let ends = at(k).iter().zip(at(k + 2 * reach + 1));
                for ((z, sum), (old, new)) in field.iter_mut().zip(&mut sums).zip(ends) {
                    *z = (*sum * share) as f32;
                    *sum += f64::from(*new) - f64::from(*old);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    /// A camera of `side` × `side` pixels, and the keys of a path at depth 2 in some of its pixels.
    fn seen(side: usize, path: impl Fn(f32, f32) -> bool) -> (Camera, Vec<f32>) {
        let (points, width) =
            ([Point3::new(-1.0, -1.0, -1.0), Point3::new(1.0, 1.0, 1.0)], side * SUPERSAMPLING);
        let at = |i: usize| (i / SUPERSAMPLING) as f32;
        let key = |i: usize| if path(at(i % width), at(i / width)) { 2.0 } else { f32::INFINITY };
        (Camera::top(&points, (width, width), [0.0; 4]), (0..width * width).map(key).collect())
    }

    #[test]
    fn the_cone_narrows_toward_the_viewer() {
        let (camera, path) = seen(33, |x, y| x == 16.0 && y == 16.0);
        let cut = Cutaway::before(&camera, &path, 1.0, 0.0);
        let size = SUPERSAMPLING as f32 * camera.sample_size(2.0);
        let at = |x: usize, y: usize| SUPERSAMPLING * (y * camera.width + x);
        for (x, y, away) in [(16, 16, 0.0), (26, 16, 10.0), (16, 6, 10.0)] {
            let (i, rim) = (at(x, y), (away * size).min(RIM * 33.0 * size));
            let depth = 2.0 - away * size;
            assert_eq!([depth + 1e-4, depth - rim - 1e-4].map(|z| cut.at(i, z)), [0.0, 1.0], "{x} {y}");
            let half = cut.at(i, depth - 0.5 * rim);
            assert!(away == 0.0 || (half - 0.25).abs() < 1e-3, "{x} {y}: {half}");
        }
        // Near the path the rim is half of the opening.
        assert!(cut.at(at(17, 16), 2.0 - 1.3 * size) < 0.5 && cut.at(at(17, 16), 2.0 - 2.0 * size) == 1.0);
        let nothing = Cutaway::before(&camera, &seen(33, |_, _| false).1, 1.0, 0.0);
        assert!((0..path.len()).all(|i| nothing.at(i, 1e-9) == 0.0));
    }

    /// Where the opening ends in a wall before a row of discs, in pixels: the rim is a straight line, not an arc
    /// for each disc.
    #[test]
    fn copies_leave_no_waves_in_the_rim() {
        let (side, size) = (400, 2.0 / 400.0);
        let (camera, path) = seen(side, |x, y| {
            let (dx, dy) = (x - 20.0 * (x / 20.0).round(), y - 200.0);
            dx * dx + dy * dy < 144.0
        });
        let cut = Cutaway::before(&camera, &path, 2.0, 0.0);
        let rim = |level: f32, x: usize, wall: f32| {
            let open = |y: &usize| cut.at(SUPERSAMPLING * (y * camera.width + x), wall) > level;
            (0..200).find(open).unwrap() as f32
        };
        for wall in [2.0 - 20.0 * size, 2.0 - 80.0 * size] {
            for level in [0.0, 0.25, 0.9] {
                let ends: Vec<f32> = (100..300).map(|x| rim(level, x, wall)).collect();
                let (low, high) = ends.iter().fold((400.0f32, 0.0f32), |(l, h), &y| (l.min(y), h.max(y)));
                assert!(high - low <= 1.0, "{wall} {level}: {low} to {high}");
                let expected = 188.0 - (2.0 - wall) / (2.0 * size);
                assert!((low - expected).abs() < 12.0, "{wall} {level}: {low} {expected}");
            }
        }
    }
}
