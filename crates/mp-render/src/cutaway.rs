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
    // Two sweeps of a chamfer distance transform, in the max-plus sense.
    for y in 0..h {
        for x in 0..w {
            let i = y * w + x;
            let mut z = depth[i];
            if x > 0 {
                z = z.max(depth[i - 1] - step);
            }
            if y > 0 {
                z = z.max(depth[i - w] - step);
                if x > 0 {
                    z = z.max(depth[i - w - 1] - diagonal);
                }
                if x + 1 < w {
                    z = z.max(depth[i - w + 1] - diagonal);
                }
            }
            depth[i] = z;
        }
    }
    for y in (0..h).rev() {
        for x in (0..w).rev() {
            let i = y * w + x;
            let mut z = depth[i];
            if x + 1 < w {
                z = z.max(depth[i + 1] - step);
            }
            if y + 1 < h {
                z = z.max(depth[i + w] - step);
                if x + 1 < w {
                    z = z.max(depth[i + w + 1] - diagonal);
                }
                if x > 0 {
                    z = z.max(depth[i + w - 1] - diagonal);
                }
            }
            depth[i] = z;
        }
    }
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
