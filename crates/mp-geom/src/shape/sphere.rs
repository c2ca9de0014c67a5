//! Spheres.

use super::{Made, Primitive};
use crate::TriMesh;
use crate::primitives::{positive, sphere};
use nalgebra::Point3;

/// The radius. It stays a ball.
pub(super) const KIND: Primitive = Primitive {
    name: "sphere",
    lengths: &["radius"],
    mesh: |lengths| TriMesh::of_balls(vec![Point3::origin()], lengths[0]),
};

/// A mesh around a ball: a [`sphere`] enlarged until no face cuts the ball.
pub(super) fn around(radius: f64, subdivisions: u32) -> Made {
    let unit = sphere(1.0, subdivisions)?;
    let scale = positive("radius", radius / inner_radius(&unit))?;
    Ok(unit.scaled([scale; 3])?)
}

/// The radius of the largest ball about the origin in a convex mesh around it.
fn inner_radius(mesh: &TriMesh) -> f64 {
    let heights = (0..mesh.triangles().len()).map(|i| {
        let [a, b, c] = mesh.triangle(i);
        let normal = (b - a).cross(&(c - a));
        normal.dot(&a.coords) / normal.norm()
    });
    heights.fold(f64::INFINITY, f64::min)
}
