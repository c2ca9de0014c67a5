//! A box and a cylinder around each body of a scene, turned as its mesh is: a tight broad phase.

use super::Scene;
use crate::bvh::root_box::RootBox;
use crate::cover::{Cover, PlacedCover};
use crate::mesh::CollisionMesh;
use crate::pose::Relative;
use mp_geom::{Aabb, Sphere};
use nalgebra::{Isometry3, Point3};
use std::cell::Cell;

/// The cylinder of least volume around a mesh about an axis of its box; it is as high as the box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cylinder {
    axis: usize,
    radius: f64,
}

impl Cylinder {
    /// Around a mesh. O(n) for n triangles.
    pub(super) fn around(mesh: &CollisionMesh) -> Self {
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
pub(super) struct Around {
    bounds: RootBox,
    /// Of the cylinder.
    radius: f64,
    /// In the frame of the mesh.
    pub(super) cylinder: Cylinder,
}

impl Around {
    /// Around a mesh at a pose; `None` when they are beyond the limits.
    pub(super) fn new(mesh: &CollisionMesh, cylinder: Cylinder, pose: &Isometry3<f64>) -> Option<Self> {
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
    fn gap(&self, ball: &Sphere) -> f64 {
        let d = ball.center - self.bounds.center;
        let [x, y, z] = [0, 1, 2].map(|k| self.bounds.axes[k].dot(&d).abs());
        let half = &self.bounds.half;
        let [a, b, c] = [(x - half.x).max(0.0), (y - half.y).max(0.0), (z - half.z).max(0.0)];
        let across = ((x * x + y * y).sqrt() - self.radius).max(0.0);
        ((a * a + b * b).max(across * across) + c * c).sqrt() - ball.radius
    }
}

impl Scene {
    /// A lower bound (m) on the distance of the mesh of `cover` from all bodies, if that is at least `enough` (m), by balls against what is
    /// around bodies: by the ball around the mesh, else by the smaller balls. Infinite without bodies; `None` where balls leave it undecided.
    pub fn apart(&self, cover: &Cover, placed: &mut PlacedCover, enough: f64) -> Option<f64> {
        let ball = placed.around;
        let rounding = |size: f64| 1e-12 * (size + ball.center.coords.amax() + ball.radius);
        let least = Cell::new(f64::INFINITY);
        // Comparisons are written so that NaN is undecided.
        let enter = |bounds: &Aabb| {
            let size = bounds.min.coords.amax().max(bounds.max.coords.amax());
            let bound = bounds.distance(&ball.center) - ball.radius - rounding(size);
            let is_far = bound >= enough;
            if is_far {
                least.set(least.get().min(bound));
            }
            !is_far
        };
        let mut undecided = |index: u32| {
            let around = &self.bodies[index as usize].as_ref()?.around;
            let rounding = rounding(around.bounds.center.coords.amax() + around.bounds.half.sum());
            match placed.apart_from(cover, enough + rounding, |ball| around.gap(ball)) {
                Some(bound) => least.set(least.get().min(bound - rounding)),
                None => return Some(()),
            }
            None
        };
        let both =
            self.fixed.find(enter, &mut undecided).or_else(|| self.movable.find(enter, &mut undecided));
        both.is_none().then(|| least.get())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Query;
    use mp_geom::{TriMesh, primitives};
    use nalgebra::Vector3;

    /// What balls decide, trees say too, at random places among boxes, cylinders and a cloud, all turned.
    #[test]
    fn nothing_is_nearer_than_balls_say() {
        let pose = |t: f64, reach: f64| {
            let shift = Vector3::new(mp_math::sin(3.1 * t), mp_math::cos(1.3 * t), mp_math::sin(0.7 * t));
            Isometry3::new(shift * reach, Vector3::new(t, 0.3 * t, -t))
        };
        let points = (0..40).map(|i| Point3::from(pose(f64::from(i), 0.2).translation.vector)).collect();
        let shapes = [
            primitives::cuboid(0.1, 0.5, 0.9).unwrap(),
            primitives::cylinder(0.1, 0.4, 32).unwrap(),
            TriMesh::of_balls(points, 0.02).unwrap(),
        ];
        let link = primitives::cylinder(0.06, 0.5, 24).unwrap();
        let (cover, tree) = (Cover::new(&link), CollisionMesh::new(&link));
        let (mut scene, mut query, mut placed) = (Scene::new(), Query::default(), PlacedCover::default());
        assert_eq!(scene.apart(&cover, &mut placed, 1.0), Some(f64::INFINITY));
        for i in 0..9 {
            let shape = CollisionMesh::new(&shapes[i % 3]);
            scene.insert(i.to_string(), shape, pose(1.7 * i as f64, 1.5)).unwrap();
        }
        let mut decided = 0;
        for merged in [false, true] {
            for i in 0..600 {
                let at = pose(0.37 * f64::from(i), 1.8);
                let distance = scene.clearance(&mut query, &tree, &at, f64::INFINITY).0;
                for enough in [0.0, 0.05, 0.2] {
                    let around = link.bounding_sphere();
                    placed.place(Sphere { center: at * around.center, ..around }, &at);
                    let Some(bound) = scene.apart(&cover, &mut placed, enough) else { continue };
                    assert!(bound <= distance && bound >= enough - 1e-9, "{bound} {distance}");
                    decided += 1;
                }
            }
            if !merged {
                scene.merge_static();
            }
        }
        assert!(decided > 1500, "{decided}");
    }
}
