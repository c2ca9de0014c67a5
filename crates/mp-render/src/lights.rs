//! The lights of a scene.

use crate::camera::Camera;
use nalgebra::{Isometry3, Vector3};

/// A key light over the viewer's shoulder, a weak one from the other side, and the sky.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lights {
    key: Vector3<f64>,
    fill: Vector3<f64>,
    up: Vector3<f64>,
}

impl Lights {
    /// Lights that go with the camera.
    pub(crate) fn of(camera: &Camera) -> Self {
        let from = |x: f64, y: f64, z: f64| {
            camera.pose_cw.inverse_transform_vector(&Vector3::new(x, y, z)).normalize()
        };
        Self { key: from(-0.75, -0.55, -0.75), fill: from(0.9, -0.1, -0.45), up: Vector3::z() }
    }

    /// The same lights in the frame of a body at `pose`.
    pub(crate) fn seen_from(&self, pose: &Isometry3<f64>) -> Self {
        let turn = |v: &Vector3<f64>| pose.inverse_transform_vector(v);
        Self { key: turn(&self.key), fill: turn(&self.fill), up: turn(&self.up) }
    }

    /// The brightness of a surface with this normal.
    pub(crate) fn on(&self, normal: &Vector3<f64>) -> f32 {
        let lambert = |l: &Vector3<f64>| normal.dot(l).max(0.0);
        let sky = 0.5 + 0.5 * normal.dot(&self.up);
        (0.16 + 0.62 * lambert(&self.key) + 0.14 * lambert(&self.fill) + 0.26 * sky) as f32
    }
}
