//! Perspective and parallel cameras.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};

/// Field of view of the longer side of the picture, radians.
const FIELD_OF_VIEW: f64 = 0.62;

/// A point on the picture. `key` orders by depth, nearest first, and is linear across a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Projected {
    /// Samples from the left.
    pub(crate) x: f32,
    /// Samples from the top.
    pub(crate) y: f32,
    /// Smaller is nearer.
    pub(crate) key: f32,
}

/// A pinhole or parallel camera. In its frame x is right, y down, z forward.
#[derive(Clone, Debug)]
pub(crate) struct Camera {
    /// Camera from world.
    pub(crate) pose_cw: Isometry3<f64>,
    /// Width of the picture in samples.
    pub(crate) width: usize,
    /// Height of the picture in samples.
    pub(crate) height: usize,
    /// Focal length in samples (perspective), or samples per metre (parallel).
    scale: f64,
    perspective: bool,
    /// Depth of the nearest point that the picture shows, metres.
    nearest: f32,
    /// Nothing nearer than this is drawn, metres.
    pub(crate) near: f64,
}

/// The rotation of a camera that looks along `forward`, with `up` upwards.
fn basis(forward: &Vector3<f64>, up: &Vector3<f64>) -> UnitQuaternion<f64> {
    let forward = forward.normalize();
    let right = forward.cross(up).normalize();
    let down = forward.cross(&right);
    let rows = Matrix3::from_rows(&[right.transpose(), down.transpose(), forward.transpose()]);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rows))
}

/// The rotation (camera from world) of a camera that sees the scene from `azimuth` and `elevation`, radians,
/// with z upwards; from above and from below too.
pub(crate) fn seen_from(azimuth: f64, elevation: f64) -> UnitQuaternion<f64> {
    let ((sa, ca), (se, ce)) = (mp_math::sin_cos(azimuth), mp_math::sin_cos(elevation));
    let (toward_eye, right) = (Vector3::new(ca * ce, sa * ce, se), Vector3::new(-sa, ca, 0.0));
    let down = right.cross(&toward_eye);
    let rows = Matrix3::from_rows(&[right.transpose(), down.transpose(), -toward_eye.transpose()]);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rows))
}

impl Camera {
    /// A perspective camera `elevation` above the horizon at `azimuth`, as near as possible with
    /// all `points` inside `margin` (a fraction of the picture on each side).
    pub(crate) fn three_quarter(
        points: &[Point3<f64>],
        azimuth: f64,
        elevation: f64,
        (width, height): (usize, usize),
        margin: [f64; 4],
    ) -> Self {
        let toward_eye = Vector3::new(
            mp_math::cos(azimuth) * mp_math::cos(elevation),
            mp_math::sin(azimuth) * mp_math::cos(elevation),
            mp_math::sin(elevation),
        );
        Self::perspective(basis(&-toward_eye, &Vector3::z()), points, (width, height), margin)
    }

    /// A perspective camera turned by `rotation` (camera from world), as near as possible with all `points`
    /// inside `margin`.
    pub(crate) fn perspective(
        rotation: UnitQuaternion<f64>,
        points: &[Point3<f64>],
        (width, height): (usize, usize),
        margin: [f64; 4],
    ) -> Self {
        let (w, h) = (width as f64, height as f64);
        let focal = w.max(h) / 2.0 / mp_math::tan(FIELD_OF_VIEW / 2.0);
        let [left, top, right, bottom] = margin;
        // Tangents of the four sides of the view, the margins taken off.
        let (tl, tr) = ((w / 2.0 - left * w) / focal, (w / 2.0 - right * w) / focal);
        let (tt, tb) = ((h / 2.0 - top * h) / focal, (h / 2.0 - bottom * h) / focal);
        let most = |f: &dyn Fn(Vector3<f64>) -> f64| {
            points.iter().map(|p| f(rotation * p.coords)).fold(f64::NEG_INFINITY, f64::max)
        };
        // The eye e satisfies x - e.x <= tr (z - e.z) and e.x - x <= tl (z - e.z) for all points.
        let (r, l) = (most(&|p| p.x - tr * p.z), most(&|p| -p.x - tl * p.z));
        let (b, t) = (most(&|p| p.y - tb * p.z), most(&|p| -p.y - tt * p.z));
        let ez = (-(r + l) / (tr + tl)).min(-(b + t) / (tb + tt));
        let ex = ((r + tr * ez) + (-l - tl * ez)) / 2.0;
        let ey = ((b + tb * ez) + (-t - tt * ez)) / 2.0;
        let pose_cw = Isometry3::from_parts(Translation3::new(-ex, -ey, -ez), rotation);
        let nearest = -most(&|p| -p.z) - ez;
        let depth = (most(&|p| p.z) - ez).max(f64::MIN_POSITIVE);
        let nearest = nearest.max(1e-3 * depth);
        Self {
            pose_cw,
            width,
            height,
            scale: focal,
            perspective: true,
            nearest: nearest as f32,
            near: 0.1 * nearest,
        }
    }

    /// A parallel camera that looks down at `points`, x to the right and y up.
    pub(crate) fn top(points: &[Point3<f64>], (width, height): (usize, usize), margin: [f64; 4]) -> Self {
        Self::parallel(basis(&-Vector3::z(), &Vector3::y()), points, (width, height), margin)
    }

    /// A parallel camera turned by `rotation` (camera from world) that shows all `points` inside `margin`, as
    /// large as possible.
    pub(crate) fn parallel(
        rotation: UnitQuaternion<f64>,
        points: &[Point3<f64>],
        (width, height): (usize, usize),
        margin: [f64; 4],
    ) -> Self {
        let (mut lo, mut hi) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
        for p in points {
            let p = rotation * p.coords;
            (lo, hi) = (lo.inf(&p), hi.sup(&p));
        }
        let [left, top, right, bottom] = margin;
        let (w, h) = (width as f64, height as f64);
        let (fw, fh) = (w * (1.0 - left - right), h * (1.0 - top - bottom));
        let size = (hi - lo).sup(&Vector3::repeat(1e-9));
        let scale = (fw / size.x).min(fh / size.y);
        // The centre of the points goes to the centre of the area inside the margins.
        let (ox, oy) = ((left * w + fw / 2.0 - w / 2.0) / scale, (top * h + fh / 2.0 - h / 2.0) / scale);
        let centre = (lo + hi) / 2.0;
        let shift = Translation3::new(ox - centre.x, oy - centre.y, 1.0 + size.z - lo.z);
        let pose_cw = Isometry3::from_parts(shift, rotation);
        Self { pose_cw, width, height, scale, perspective: false, nearest: 1.0, near: 0.0 }
    }

    /// A camera at `eye` that looks at `target`, which is in the middle of the picture. `field_of_view`
    /// (radians) is that of the height at the target, for parallel cameras too. `points` are what the picture
    /// is of.
    pub(crate) fn placed(
        [eye, target]: [Point3<f64>; 2],
        field_of_view: f64,
        parallel: bool,
        points: &[Point3<f64>],
        (width, height): (usize, usize),
    ) -> Self {
        let forward = target - eye;
        let distance = forward.norm();
        let upright = forward.xy().norm() > 1e-9 * distance;
        let rotation = basis(&forward, &if upright { Vector3::z() } else { Vector3::y() });
        let pose_cw = Isometry3::from_parts(Translation3::from(-(rotation * eye.coords)), rotation);
        let focal = height as f64 / 2.0 / mp_math::tan(field_of_view / 2.0);
        let first = points.iter().map(|p| (pose_cw * p).z).fold(f64::INFINITY, f64::min);
        let nearest = first.clamp(1e-2 * distance, distance);
        Self {
            pose_cw,
            width,
            height,
            scale: if parallel { focal / distance } else { focal },
            perspective: !parallel,
            nearest: nearest as f32,
            near: if parallel { 0.0 } else { 0.1 * nearest },
        }
    }

    /// The camera moved so that it sees at `centre` what it saw at `from`, and turned around the vertical
    /// axis there by `angle` radians, counter-clockwise seen from above.
    pub(crate) fn moved(&self, from: &Point3<f64>, centre: &Point3<f64>, angle: f64) -> Self {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -angle);
        let turned = Isometry3::from_parts(Translation3::from(from.coords), turn);
        Self { pose_cw: self.pose_cw * turned * Translation3::from(-centre.coords), ..self.clone() }
    }

    /// The position on the picture of a point of the camera frame, whose z must be at least `near`.
    pub(crate) fn project(&self, p: &Point3<f64>) -> Projected {
        let (cx, cy) = (self.width as f64 / 2.0, self.height as f64 / 2.0);
        let (s, key) = if self.perspective { (self.scale / p.z, -1.0 / p.z) } else { (self.scale, p.z) };
        Projected { x: (cx + s * p.x) as f32, y: (cy + s * p.y) as f32, key: key as f32 }
    }

    /// The depth of `key`, metres.
    pub(crate) fn depth(&self, key: f32) -> f32 {
        if self.perspective { -1.0 / key } else { key }
    }

    /// The weight of a translucent surface at `key` when it is blended with others.
    pub(crate) fn prominence(&self, key: f32) -> f32 {
        if self.perspective {
            (mp_math::exp(f64::from(6.0 - 6.0 * self.depth(key) / self.nearest)) as f32).max(1e-9)
        } else {
            1.0
        }
    }

    /// The width of a sample at `depth` metres, metres.
    pub(crate) fn sample_size(&self, depth: f32) -> f32 {
        if self.perspective { depth / self.scale as f32 } else { 1.0 / self.scale as f32 }
    }

    /// Direction from the point `p` of the world to the eye, not normalised.
    pub(crate) fn toward_eye(&self, p: &Point3<f64>) -> Vector3<f64> {
        if self.perspective {
            self.pose_cw.inverse_transform_point(&Point3::origin()) - p
        } else {
            self.pose_cw.inverse_transform_vector(&-Vector3::z())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> Vec<Point3<f64>> {
        (0..8).map(|i| Point3::new(f64::from(i & 1), f64::from((i >> 1) & 1), f64::from(i >> 2))).collect()
    }

    #[test]
    fn everything_fits_and_something_touches_the_margin() {
        for azimuth in [0.3, 2.0, -1.0] {
            let camera = Camera::three_quarter(&cube(), azimuth, 0.5, (400, 300), [0.1; 4]);
            let on: Vec<_> = cube().iter().map(|p| camera.project(&(camera.pose_cw * p))).collect();
            let (x0, x1) = on.iter().fold((f32::MAX, f32::MIN), |(a, b), p| (a.min(p.x), b.max(p.x)));
            let (y0, y1) = on.iter().fold((f32::MAX, f32::MIN), |(a, b), p| (a.min(p.y), b.max(p.y)));
            assert!(x0 > 39.9 && x1 < 360.1 && y0 > 29.9 && y1 < 270.1, "{x0} {x1} {y0} {y1}");
            assert!((x1 - x0 - 320.0).abs() < 0.1 || (y1 - y0 - 240.0).abs() < 0.1);
        }
    }

    /// The target is in the middle, what is higher is higher on the picture, and the field of view is that of
    /// the height.
    #[test]
    fn placed_cameras_look_at_their_target() {
        for (eye, parallel) in [([3.0, -4.0, 2.0], false), ([3.0, -4.0, 2.0], true), ([0.5, 0.5, 9.0], false)]
        {
            let (eye, target) = (Point3::from(eye), Point3::new(0.5, 0.5, 0.5));
            let camera = Camera::placed([eye, target], 0.6, parallel, &cube(), (400, 300));
            let at = |p: Point3<f64>| camera.project(&(camera.pose_cw * p));
            let middle = at(target);
            assert!((middle.x - 200.0).abs() < 1e-3 && (middle.y - 150.0).abs() < 1e-3);
            let up = camera.pose_cw.inverse_transform_vector(&-Vector3::y());
            let top = at(target + up * (eye - target).norm() * mp_math::tan(0.3));
            assert!(top.y.abs() < 1e-3, "{top:?}");
            let moved = camera.moved(&target, &Point3::new(7.0, 8.0, 9.0), 1.0);
            let middle = moved.project(&(moved.pose_cw * Point3::new(7.0, 8.0, 9.0)));
            assert!((middle.x - 200.0).abs() < 1e-3 && (middle.y - 150.0).abs() < 1e-3);
        }
    }

    #[test]
    fn directions_have_x_y_or_z_upwards() {
        let upwards = |azimuth: f64, elevation: f64| {
            let rotation = seen_from(azimuth.to_radians(), elevation.to_radians());
            (rotation.inverse() * -Vector3::y(), rotation.inverse() * -Vector3::z())
        };
        for (azimuth, elevation, up, back) in [
            (-90.0, 0.0, Vector3::z(), -Vector3::y()),
            (0.0, 0.0, Vector3::z(), Vector3::x()),
            (-90.0, 90.0, Vector3::y(), Vector3::z()),
            (-90.0, -90.0, -Vector3::y(), -Vector3::z()),
        ] {
            let (u, b) = upwards(azimuth, elevation);
            assert!((u - up).norm() < 1e-12 && (b - back).norm() < 1e-12, "{azimuth} {elevation}: {u} {b}");
        }
    }

    #[test]
    fn from_above_x_is_right_and_y_up() {
        let camera = Camera::top(&cube(), (400, 300), [0.1; 4]);
        let at = |x, y, z| camera.project(&(camera.pose_cw * Point3::new(x, y, z)));
        assert!(at(1.0, 0.0, 0.0).x > at(0.0, 0.0, 0.0).x);
        assert!(at(0.0, 1.0, 0.0).y < at(0.0, 0.0, 0.0).y);
        assert!(at(0.0, 0.0, 1.0).key < at(0.0, 0.0, 0.0).key, "higher is nearer");
        assert!(at(0.0, 0.0, 1.0).key > 0.0);
    }
}
