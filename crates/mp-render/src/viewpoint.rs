//! The choice of a viewpoint that shows the path of a scene best.

use crate::body::Body;
use crate::camera::Camera;
use crate::lights::Lights;
use nalgebra::Point3;

/// The size of the coarse pictures by which viewpoints are judged.
pub(crate) const COARSE: (usize, usize) = (160, 120);

/// A viewpoint, and how much of the path is visible from it, 0 to 1.
pub(crate) struct Viewpoint {
    pub(crate) azimuth: f64,
    pub(crate) elevation: f64,
    pub(crate) visible: f64,
}

/// Tries viewpoints all around and takes the one from which most of `path` is visible and spread widest on
/// the picture; the usual one, from the front right, is taken unless another is clearly better.
pub(crate) fn choose(frame: &[Point3<f64>], obstacles: &[Body], path: &[&Body]) -> Viewpoint {
    let marks = marks(path);
    let mut best: Option<(f64, Viewpoint)> = None;
    // Not along an axis, where walls would be seen edge on.
    let azimuths = [-60.0f64, -30.0, 30.0, 60.0, 120.0, 150.0, 210.0, 240.0];
    for (e, elevation) in [32.0f64, 50.0].map(f64::to_radians).into_iter().enumerate() {
        for (a, azimuth) in azimuths.map(f64::to_radians).into_iter().enumerate() {
            let camera = Camera::three_quarter(frame, azimuth, elevation, COARSE, [0.05; 4]);
            let (visible, spread) = judge(&camera, obstacles, &marks);
            let habit = if a == 0 { 0.06 } else { 0.0 } + if e == 0 { 0.03 } else { 0.0 };
            let score = visible + 0.6 * spread + habit;
            if best.as_ref().is_none_or(|(s, _)| score > *s + 1e-9) {
                best = Some((score, Viewpoint { azimuth, elevation, visible }));
            }
        }
    }
    best.map_or(Viewpoint { azimuth: -1.0, elevation: 0.55, visible: 1.0 }, |(_, view)| view)
}

/// How much of `path` a coarse camera sees, 0 to 1.
pub(crate) fn visible(camera: &Camera, obstacles: &[Body], path: &[&Body]) -> f64 {
    judge(camera, obstacles, &marks(path)).0
}

/// Some points of each body.
fn marks(path: &[&Body]) -> Vec<Point3<f64>> {
    let of_body = |robot: &&Body| {
        let points = robot.model.points();
        let pose = robot.pose_wb;
        points.iter().step_by(points.len().div_ceil(12).max(1)).map(|p| pose * p).collect::<Vec<_>>()
    };
    path.iter().flat_map(of_body).collect()
}

/// The fraction of `marks` that is visible, and how far they spread on the picture, as a fraction of its
/// width.
fn judge(camera: &Camera, obstacles: &[Body], marks: &[Point3<f64>]) -> (f64, f64) {
    let mut nearest = vec![f32::INFINITY; camera.width * camera.height];
    let lights = Lights::of(camera);
    for o in obstacles {
        o.model.faces(camera, &o.pose_wb, &lights, |i, key, _| nearest[i] = nearest[i].min(key));
    }
    let (mut seen, mut lo, mut hi) = (0usize, [f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
    for p in marks {
        let p = camera.project(&(camera.pose_cw * p));
        (lo, hi) = ([lo[0].min(p.x), lo[1].min(p.y)], [hi[0].max(p.x), hi[1].max(p.y)]);
        let (x, y) = (p.x.max(0.0) as usize, p.y.max(0.0) as usize);
        if x < camera.width && y < camera.height && p.key <= nearest[y * camera.width + x] {
            seen += 1;
        }
    }
    if marks.is_empty() {
        return (0.0, 0.0);
    }
    let spread =
        mp_math::hypot(f64::from(hi[0] - lo[0]), f64::from(hi[1] - lo[1])) / f64::from(COARSE.0 as u32);
    (seen as f64 / marks.len() as f64, spread.min(1.0))
}
