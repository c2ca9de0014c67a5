//! Opens the view onto the path: obstacles in front of it are drawn translucent.
//!
//! Around each visible point of the path a cone toward the viewer is cleared (adaptive cutaways, Burns and
//! Finkelstein 2008): the depth of the path, less a slope times the distance on the picture.

use crate::camera::Camera;

/// For every sample, the key before which obstacles become translucent. `path` holds the keys of the path's
/// nearest surface, infinite where there is no path; `slope` is metres of depth per metre across; obstacles
/// within `slack` metres of the path stay opaque.
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
    // Two sweeps of a chamfer distance transform, in the max-plus sense: from the neighbours before each
    // sample, and from those behind.
    for _ in 0..2 {
        sweep(&mut depth, w, step, step * std::f32::consts::SQRT_2);
        depth.reverse();
    }
    depth.iter().map(|&z| camera.key_of(z - slack)).collect()
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
