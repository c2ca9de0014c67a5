//! What is around a body: a box, and a cylinder.

use crate::bvh::root_box::RootBox;
use crate::mesh::CollisionMesh;
use crate::pose::Relative;
use mp_geom::Sphere;
use mp_simd::wide::{Wide, Wide3};
use nalgebra::{Isometry3, Point3};

/// The cylinder of least volume around a mesh about an axis of its box; it is as high as the box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cylinder {
    axis: usize,
    radius: f64,
}

impl Cylinder {
    /// Around a mesh. O(n) for n triangles.
    pub(crate) fn around(mesh: &CollisionMesh) -> Self {
        let own = &mesh.tree().bounding;
        let radius = |axis: usize| {
            let from_axis = |p: &Point3<f64>| {
                let d = p - own.center;
                d.norm_squared() - own.axes[axis].dot(&d) * own.axes[axis].dot(&d)
            };
            mesh.tree().triangles.iter().flatten().map(from_axis).fold(0.0, f64::max).sqrt()
        };
        let radii = [0, 1, 2].map(radius);
        let volume = |axis: &usize| radii[*axis] * radii[*axis] * own.half[*axis];
        let axis = (0..3).min_by(|a, b| volume(a).total_cmp(&volume(b))).unwrap_or(0);
        Self { axis, radius: radii[axis] }
    }
}

/// What is around a body, in the world, a little enlarged so that rounding never cuts anything off: the box around its mesh, and the cylinder
/// about the last axis of the box.
#[derive(Clone, Debug)]
pub(crate) struct Around {
    bounds: RootBox,
    /// Of the cylinder.
    radius: f64,
    /// In the frame of the mesh.
    pub(crate) cylinder: Cylinder,
}

impl Around {
    /// Around a mesh at a pose; `None` when they are beyond the limits.
    pub(crate) fn new(mesh: &CollisionMesh, cylinder: Cylinder, pose: &Isometry3<f64>) -> Option<Self> {
        let relative = Relative::between(&Isometry3::identity(), 0.0, pose, mesh.radius())?;
        let more = relative.slack + mesh.rounding();
        let Cylinder { axis, radius } = cylinder;
        let mut bounds = relative.obb(&mesh.tree().bounding);
        bounds.half.add_scalar_mut(more);
        bounds.axes.swap(axis, 2);
        bounds.half.swap_rows(axis, 2);
        Some(Self { bounds, radius: radius + more, cylinder })
    }

    /// A lower bound on the distance of a ball; negative where it overlaps both.
    #[inline]
    pub(crate) fn gap(&self, ball: &Sphere) -> f64 {
        let d = ball.center - self.bounds.center;
        let [x, y, z] = [0, 1, 2].map(|k| self.bounds.axes[k].dot(&d).abs());
        let half = &self.bounds.half;
        let [a, b, c] = [(x - half.x).max(0.0), (y - half.y).max(0.0), (z - half.z).max(0.0)];
        let across = ((x * x + y * y).sqrt() - self.radius).max(0.0);
        ((a * a + b * b).max(across * across) + c * c).sqrt() - ball.radius
    }

    /// The same for balls at eight places.
    #[inline(always)]
    pub(crate) fn wide_gap(&self, center: &Wide3, radius: f64) -> Wide {
        let (o, half, zero) = (&self.bounds.center, &self.bounds.half, Wide::splat(0.0));
        let d = [center[0] - o.x, center[1] - o.y, center[2] - o.z];
        let axes = &self.bounds.axes;
        let [x, y, z] = three!(k => (d[0] * axes[k].x + d[1] * axes[k].y + d[2] * axes[k].z).abs());
        let [a, b, c] = [(x - half.x).max(zero), (y - half.y).max(zero), (z - half.z).max(zero)];
        let across = ((x * x + y * y).sqrt() - self.radius).max(zero);
        ((a * a + b * b).max(across * across) + c * c).sqrt() - radius
    }

    /// Its largest coordinate and its size, about.
    #[inline(always)]
    pub(crate) fn size(&self) -> f64 {
        self.bounds.center.coords.amax() + self.bounds.half.sum()
    }
}
