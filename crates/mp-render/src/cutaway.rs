//! Opens the view onto the path: obstacles in front of it are drawn translucent.
//!
//! Around each visible point of the path a cone toward the viewer is cleared (adaptive cutaways, Burns and
//! Finkelstein 2008): the depth of the path, less a slope times the distance on the picture.

use crate::camera::Camera;

/// For every sample, the key before which obstacles become translucent. `path` holds the keys of the path's nearest
/// surface, infinite where there is no path; `slope` is metres of depth per metre across; obstacles within `slack`
/// metres of the path stay opaque.
pub(crate) fn thresholds(camera: &Camera, path: &[f32], slope: f32, slack: f32) -> Vec<f32> {
    let (w, h) = (camera.width, camera.height);
    let mut depth: Vec<f32> =
        path.iter().map(|&k| if k.is_finite() { camera.depth(k) } else { f32::NEG_INFINITY }).collect();
    let (sum, n) =
        depth.iter().filter(|z| z.is_finite()).fold((0.0f64, 0u32), |(s, n), &z| (s + f64::from(z), n + 1));
    if n == 0 {
        return vec![f32::NEG_INFINITY; w * h];
    }
    let step = slope * camera.sample_size((sum / f64::from(n)) as f32);
    let diagonal = step * std::f32::consts::SQRT_2;
    // Two sweeps of a chamfer distance transform, in the max-plus sense: from the neighbours before each sample, and from those behind.
    let mut spread = |i: usize, sign: isize| {
        for (dx, dy, away) in [(-1, 0, step), (0, -1, step), (-1, -1, diagonal), (1, -1, diagonal)] {
            let (x, y) = ((i % w).checked_add_signed(sign * dx), (i / w).checked_add_signed(sign * dy));
            if let (Some(x), Some(y)) = (x.filter(|x| *x < w), y.filter(|y| *y < h)) {
                depth[i] = depth[i].max(depth[y * w + x] - away);
            }
        }
    };
    (0..w * h).for_each(|i| spread(i, 1));
    (0..w * h).rev().for_each(|i| spread(i, -1));
    depth.iter().map(|&z| camera.key_of(z - slack)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    #[test]
    fn the_cone_narrows_toward_the_viewer() {
        let points = [Point3::new(-1.0, -1.0, -1.0), Point3::new(1.0, 1.0, 1.0)];
        let camera = Camera::top(&points, (33, 33), [0.0; 4]);
        let mut path = vec![f32::INFINITY; 33 * 33];
        path[16 * 33 + 16] = 2.0;
        let cut = thresholds(&camera, &path, 1.0, 0.0);
        let size = camera.sample_size(2.0);
        assert!((cut[16 * 33 + 16] - 2.0).abs() < 1e-5);
        assert!((cut[16 * 33 + 26] - (2.0 - 10.0 * size)).abs() < 1e-4);
        assert!((cut[6 * 33 + 16] - (2.0 - 10.0 * size)).abs() < 1e-4);
        assert!(
            thresholds(&camera, &[f32::INFINITY; 33 * 33], 1.0, 0.0).iter().all(|k| *k == f32::NEG_INFINITY)
        );
    }
}
