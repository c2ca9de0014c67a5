//! Meshes prepared for drawing: smooth normals and feature edges.

use crate::camera::Camera;
use crate::lights::Lights;
use crate::raster::{Corner, line, triangle};
use mp_geom::TriMesh;
use nalgebra::{Isometry3, Point3, Vector3};
use std::collections::HashMap;

/// Faces that meet at less than this angle are shaded as one smooth surface (cosine of 35°).
const SMOOTH: f64 = 0.82;

/// Meshes of more triangles than a picture has pixels are drawn flat and without edges, as they are: smooth
/// normals and edges take seven times the memory of the mesh.
const LARGE: usize = 1 << 21;

/// A mesh with the data for drawing it many times.
#[derive(Clone, Debug, Default)]
pub(crate) struct Model {
    /// Points and triangles of a mesh that is large.
    large: Option<TriMesh>,
    points: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
    /// Per corner of each triangle; none of a mesh that is large.
    normals: Vec<[Vector3<f64>; 3]>,
    /// Edges of one face, and edges where faces meet at an angle.
    pub(crate) edges: Vec<[u32; 2]>,
    /// The edges between faces that meet nearly flat.
    pub(crate) inner: Vec<[u32; 2]>,
    /// Distance of the farthest point from the origin, metres.
    pub(crate) radius: f64,
}

impl Model {
    pub(crate) fn new(mesh: &TriMesh) -> Self {
        if mesh.triangles().len() > LARGE {
            return Self::flat(mesh);
        }
        // Soups repeat their vertices: join equal ones, so that neighbours are known.
        let mut ids = HashMap::new();
        let mut points: Vec<Point3<f64>> = Vec::new();
        let welded: Vec<u32> = mesh
            .vertices()
            .iter()
            .map(|p| {
                *ids.entry([p.x, p.y, p.z].map(|c| (c + 0.0).to_bits())).or_insert_with(|| {
                    points.push(*p);
                    points.len() as u32 - 1
                })
            })
            .collect();
        let triangles: Vec<[u32; 3]> =
            mesh.triangles().iter().map(|t| t.map(|v| welded[v as usize])).collect();
        let faces: Vec<Vector3<f64>> = triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|v| points[v as usize]);
                (b - a).cross(&(c - a))
            })
            .collect();
        let normals = smooth_normals(points.len(), &triangles, &faces);
        let (edges, inner) = feature_edges(&triangles, &faces);
        let radius = radius(&points);
        Self { large: None, points, triangles, normals, edges, inner, radius }
    }

    /// The model of a large mesh, which it shares.
    fn flat(mesh: &TriMesh) -> Self {
        Self { radius: radius(mesh.vertices()), large: Some(mesh.clone()), ..Self::default() }
    }

    /// The model of a point, which is invisible.
    pub(crate) fn point() -> Self {
        Self { points: vec![Point3::origin()], ..Self::default() }
    }

    pub(crate) fn points(&self) -> &[Point3<f64>] {
        self.large.as_ref().map_or(&self.points, TriMesh::vertices)
    }

    /// Calls `fragment(sample, key, light)` for its triangles at `pose` (in the world).
    pub(crate) fn faces(
        &self,
        camera: &Camera,
        pose: &Isometry3<f64>,
        lights: &Lights,
        mut fragment: impl FnMut(usize, f32, f32),
    ) {
        let pose_cm = camera.pose_cw * pose;
        // Each once, but for large meshes, of which there is no room for a copy.
        let points = self.points();
        let seen: Vec<Point3<f64>> = self.points.iter().map(|p| pose_cm * p).collect();
        let seen = |v: u32| seen.get(v as usize).copied().unwrap_or_else(|| pose_cm * points[v as usize]);

        let lights = lights.seen_from(pose);
        let triangles = self.large.as_ref().map_or(&*self.triangles, TriMesh::triangles);
        for (i, t) in triangles.iter().enumerate() {
            let at = t.map(seen);
            let middle = points[t[0] as usize];
            let face = (points[t[1] as usize] - middle).cross(&(points[t[2] as usize] - middle));
            let normals = self.normals.get(i).copied().unwrap_or_else(|| [unit(&face); 3]);
            // Both sides are lit, as triangles of a soup may have any orientation.
            let toward = pose.inverse_transform_vector(&camera.toward_eye(&(pose * middle)));
            let side = if face.dot(&toward) < 0.0 { -1.0 } else { 1.0 };
            let corners: [Corner; 3] =
                std::array::from_fn(|i| Corner { at: at[i], light: lights.on(&(normals[i] * side)) });
            triangle(camera, corners, &mut fragment);
        }
    }

    /// Calls `fragment(sample, key, coverage)` for some of its edges at `pose` (in the world).
    pub(crate) fn lines(
        &self,
        edges: &[[u32; 2]],
        camera: &Camera,
        pose: &Isometry3<f64>,
        half: f32,
        mut fragment: impl FnMut(usize, f32, f32),
    ) {
        let pose_cm = camera.pose_cw * pose;
        for e in edges {
            let [a, b] = e.map(|v| pose_cm * self.points[v as usize]);
            line(camera, &a, &b, half, &mut fragment);
        }
    }
}

/// The vector of length 1 in this direction; some vector for zero.
fn unit(n: &Vector3<f64>) -> Vector3<f64> {
    n.try_normalize(0.0).unwrap_or_else(Vector3::z)
}

/// The largest distance of a point from the origin.
fn radius(points: &[Point3<f64>]) -> f64 {
    points.iter().map(|p| p.coords.norm()).fold(0.0, f64::max)
}

/// For each corner of each triangle, the mean normal of the faces around it that are at less than 35° to its
/// own.
fn smooth_normals(points: usize, triangles: &[[u32; 3]], faces: &[Vector3<f64>]) -> Vec<[Vector3<f64>; 3]> {
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); points];
    for (f, t) in triangles.iter().enumerate() {
        for &v in t {
            around[v as usize].push(f as u32);
        }
    }
    let units: Vec<_> = faces.iter().map(unit).collect();
    triangles
        .iter()
        .enumerate()
        .map(|(f, t)| {
            t.map(|v| {
                let near = around[v as usize].iter().map(|&g| g as usize);
                let sum: Vector3<f64> =
                    near.filter(|&g| units[g].dot(&units[f]) > SMOOTH).map(|g| faces[g]).sum();
                unit(&sum)
            })
        })
        .collect()
}

/// The edges that do not join two faces at less than 35°, and those that do.
fn feature_edges(triangles: &[[u32; 3]], faces: &[Vector3<f64>]) -> (Vec<[u32; 2]>, Vec<[u32; 2]>) {
    let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(triangles.len() * 3);
    for (f, t) in triangles.iter().enumerate() {
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            sides.push(([a.min(b), a.max(b)], f as u32));
        }
    }
    sides.sort_unstable();
    let (mut edges, mut inner) = (Vec::new(), Vec::new());
    for group in sides.chunk_by(|a, b| a.0 == b.0) {
        let [a, b] = group[0].0;
        let sharp = match group {
            [x, y] => {
                let (n, m) = (faces[x.1 as usize], faces[y.1 as usize]);
                // The absolute value, as neighbours may have opposite orientations.
                n.dot(&m).abs() < SMOOTH * n.norm() * m.norm()
            }
            _ => true,
        };
        if a != b {
            if sharp { &mut edges } else { &mut inner }.push([a, b]);
        }
    }
    (edges, inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_has_twelve_edges_and_flat_faces() {
        // Eight corners as a soup: every triangle with vertices of its own.
        let corner = |i: u32| Point3::new(f64::from(i & 1), f64::from((i >> 1) & 1), f64::from(i >> 2));
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let soup: Vec<_> =
            quads.iter().flat_map(|q| [q[0], q[1], q[2], q[0], q[2], q[3]]).map(corner).collect();
        let triangles = (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let model = Model::new(&TriMesh::new(soup, triangles).unwrap());
        assert_eq!((model.points.len(), model.edges.len(), model.inner.len()), (8, 12, 6));
        assert!(model.normals.iter().flatten().all(|n| (n.amax() - 1.0).abs() < 1e-12));
    }

    /// A large mesh is drawn without smooth normals and edges. Where faces are flat its pixels are those of
    /// the other way.
    #[test]
    fn large_meshes_are_drawn_flat() {
        let mesh = mp_geom::primitives::cuboid(1.0, 2.0, 3.0).unwrap();
        let camera = Camera::three_quarter(mesh.vertices(), 0.7, 0.4, (80, 60), [0.1; 4]);
        let drawn = |model: &Model| {
            let mut all = Vec::new();
            let pose = Isometry3::rotation(Vector3::new(0.1, 0.2, 0.3));
            model.faces(&camera, &pose, &Lights::of(&camera), |sample, key, light| {
                all.push((sample, key, light))
            });
            all
        };
        let (whole, flat) = (Model::new(&mesh), Model::flat(&mesh));
        assert_eq!((flat.points(), flat.radius), (mesh.vertices(), whole.radius));
        assert_eq!((flat.edges.len(), flat.inner.len()), (0, 0));
        let (whole, flat) = (drawn(&whole), drawn(&flat));
        assert!(whole.len() > 1000 && whole.len() == flat.len());
        for (a, b) in whole.iter().zip(&flat) {
            assert!(a.0 == b.0 && a.1 == b.1 && (a.2 - b.2).abs() < 1e-6, "{a:?} {b:?}");
        }
    }
}
