//! The mean of the vertices, which OMPL.app uses as the origin of a robot.
//!
//! Its importer works in single precision, gives polygons without normals their face normals, and then merges
//! the corners of a group that agree in position, normal, texture coordinates and colour. The mean is over the
//! vertices that are left, those of lines included, in all instances.

use super::geometry::{Geometry, Group};
use super::{Instance, Scene};
use nalgebra::{Matrix4, Vector3};
use std::collections::HashMap;

/// Attributes at most this far apart count as equal.
const SAME: f32 = 1e-5;
/// The most vertices of one position that are compared; further ones always count as new.
const MAX_COMPARED: usize = 64;

impl Scene {
    /// The mean of all vertices, as OMPL.app computes it.
    pub fn center(&self) -> Vector3<f64> {
        let mut center = Center::default();
        let mut joined: HashMap<(*const Geometry, usize), Vec<[f32; 3]>> = HashMap::new();
        for Instance { geometry, matrix } in &self.instances {
            for (g, group) in geometry.groups.iter().enumerate() {
                let key = (std::rc::Rc::as_ptr(geometry), g);
                let vertices = joined.entry(key).or_insert_with(|| join(geometry, group));
                center.add(vertices, matrix);
            }
        }
        center.mean()
    }
}

/// The mean of the vertices of a mesh without normals: corners are merged when position and
/// face normal agree.
pub fn center_of_mesh(mesh: &mp_geom::TriMesh) -> Vector3<f64> {
    let geometry = Geometry::of_mesh(mesh);
    let mut center = Center::default();
    for group in &geometry.groups {
        center.add(&join(&geometry, group), &Matrix4::identity());
    }
    center.mean()
}

#[derive(Default)]
struct Center {
    sum: Vector3<f32>,
    count: usize,
}

impl Center {
    fn add(&mut self, vertices: &[[f32; 3]], matrix: &Matrix4<f64>) {
        let m = matrix.map(|v| v as f32);
        for v in vertices {
            self.sum += m.fixed_view::<3, 3>(0, 0) * Vector3::from(*v) + m.fixed_view::<3, 1>(0, 3);
        }
        self.count += vertices.len();
    }

    fn mean(&self) -> Vector3<f64> {
        if self.count == 0 {
            return Vector3::zeros();
        }
        (self.sum / self.count as f32).map(f64::from)
    }
}

/// The vertices of a group, each once, in order of first use.
fn join(geometry: &Geometry, group: &Group) -> Vec<[f32; 3]> {
    let mut out: Vec<[f32; 3]> = Vec::new();
    let mut attributes: Vec<f32> = Vec::new();
    // How many numbers each attribute has, the face normal first.
    let sizes: Vec<usize> =
        std::iter::once(3).chain(group.attributes.iter().map(|a| a.source.width())).collect();
    let width: usize = sizes.iter().sum();
    let mut by_position: HashMap<[u32; 3], Vec<usize>> = HashMap::new();
    let mut corner = 0;
    for face in group.faces.clone() {
        let corners = geometry.face(face);
        let normal = if group.has_normals { Vector3::zeros() } else { newell(geometry, corners) };
        for &c in corners {
            let mut own: Vec<f32> = normal.iter().map(|v| *v as f32).collect();
            for attribute in &group.attributes {
                own.extend(attribute.source.row(attribute.rows[corner] as usize).iter().map(|v| *v as f32));
            }
            corner += 1;
            let position: [f32; 3] = geometry.position(c).coords.map(|v| v as f32).into();
            // Adding 0 turns −0 into 0.
            let candidates = by_position.entry(position.map(|v| (v + 0.0).to_bits())).or_default();
            let same = |i: &usize| {
                let (mut theirs, mut own) = (&attributes[i * width..], own.as_slice());
                sizes.iter().all(|&size| {
                    let pair = own.iter().zip(theirs).take(size);
                    (own, theirs) = (&own[size..], &theirs[size..]);
                    pair.map(|(a, b)| (a - b) * (a - b)).sum::<f32>() <= SAME * SAME
                })
            };
            if !candidates.iter().rev().take(MAX_COMPARED).any(same) {
                candidates.push(out.len());
                out.push(position);
                attributes.extend(own);
            }
        }
    }
    debug_assert_eq!(attributes.len(), out.len() * width);
    out
}

/// The unit normal of a polygon; zero when it has no area, as a line.
fn newell(geometry: &Geometry, corners: &[u32]) -> Vector3<f64> {
    let p = |i: usize| geometry.position(corners[i % corners.len()]).coords;
    let origin = p(0);
    let sum: Vector3<f64> = (0..corners.len()).map(|i| (p(i) - origin).cross(&(p(i + 1) - origin))).sum();
    sum.try_normalize(0.0).unwrap_or_default()
}
