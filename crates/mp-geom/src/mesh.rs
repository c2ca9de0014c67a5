//! The indexed triangle mesh.

use nalgebra::{Isometry3, Point3};
use std::ops::Range;
use std::sync::Arc;
use thiserror::Error;

/// Why a mesh could not be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// No triangles.
    #[error("the mesh has no triangles")]
    Empty,
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite: ({x}, {y}, {z})")]
    NotFinite {
        /// Which vertex, counted from 0.
        vertex: usize,
        /// Its first coordinate, as it was given.
        x: f64,
        /// Its second coordinate.
        y: f64,
        /// Its third coordinate.
        z: f64,
    },
    /// A triangle refers to a vertex that does not exist.
    #[error("triangle {triangle} refers to vertex {index}, but there are only {vertices} vertices")]
    IndexOutOfRange {
        /// Which triangle, counted from 0.
        triangle: usize,
        /// The index it names.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A strip, fan or polygon has fewer than three corners.
    #[error("{what} {index} has {corners} corners, at least 3 are needed")]
    TooFewCorners {
        /// "strip", "fan" or "polygon".
        what: &'static str,
        /// Which one, counted from 0.
        index: usize,
        /// The corners found, fewer than three.
        corners: usize,
    },
    /// More than `u32::MAX` vertices or triangles.
    #[error("the mesh has {count} {what}, more than a 32-bit index can name")]
    TooLarge {
        /// "vertices", "triangles" or "triangle corners".
        what: &'static str,
        /// How many of them the mesh has.
        count: usize,
    },
}

/// An error unless 32 bits can number `count` things.
fn check_count(what: &'static str, count: usize) -> Result<(), MeshError> {
    if u32::try_from(count).is_ok() { Ok(()) } else { Err(MeshError::TooLarge { what, count }) }
}

/// An error for the first vertex with a coordinate that is not finite.
pub(crate) fn check_finite(vertices: &[Point3<f64>]) -> Result<(), MeshError> {
    match vertices.iter().enumerate().find(|(_, p)| p.iter().any(|c| !c.is_finite())) {
        Some((vertex, p)) => Err(MeshError::NotFinite { vertex, x: p.x, y: p.y, z: p.z }),
        None => Ok(()),
    }
}

/// An indexed triangle mesh (boundary representation): a soup, with no promise of being closed,
/// manifold, oriented or free of degenerate triangles.
///
/// It is never empty, every coordinate is finite and every index in range: the constructors check this.
/// Clones share vertices and triangles.
///
/// A mesh is a surface. Some of its triangles, or all, may bound [solids](TriMesh::solids): then what is
/// inside of these belongs to the mesh too. [Primitives](crate::primitives) are solids; what is read from a
/// file is a surface until [`into_solid`](TriMesh::into_solid).
///
/// A mesh may also be [balls](TriMesh::balls), as of a point cloud: then each triangle is a single point.
#[derive(Clone, Debug)]
pub struct TriMesh {
    pub(crate) vertices: Arc<Vec<Point3<f64>>>,
    pub(crate) triangles: Arc<Vec<[u32; 3]>>,
    /// See [`solids`](Self::solids).
    pub(crate) solids: Arc<Vec<Range<u32>>>,
    /// See [`balls`](Self::balls).
    pub(crate) balls: Arc<Vec<(Range<u32>, f64)>>,
}

/// The same vertices and triangles in the same order, and the same solids and balls. Clones are not compared
/// number by number.
impl PartialEq for TriMesh {
    fn eq(&self, other: &Self) -> bool {
        self.solids == other.solids
            && self.balls == other.balls
            && (Arc::ptr_eq(&self.vertices, &other.vertices) || self.vertices == other.vertices)
            && (Arc::ptr_eq(&self.triangles, &other.triangles) || self.triangles == other.triangles)
    }
}

impl TriMesh {
    /// A mesh of `vertices` (metres) and `triangles` (vertex indices, counter-clockwise seen from outside
    /// by convention).
    ///
    /// # Errors
    /// [`MeshError`] when there are no triangles, a coordinate is not finite or an index is out of range.
    pub fn new(vertices: Vec<Point3<f64>>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        if triangles.is_empty() {
            return Err(MeshError::Empty);
        }
        check_count("vertices", vertices.len())?;
        check_count("triangles", triangles.len())?;
        check_finite(&vertices)?;
        for (triangle, t) in triangles.iter().enumerate() {
            if let Some(&index) = t.iter().find(|&&i| i as usize >= vertices.len()) {
                return Err(MeshError::IndexOutOfRange { triangle, index, vertices: vertices.len() });
            }
        }
        Ok(Self::surface(vertices.into(), triangles))
    }

    /// The vertices, in the order in which they were given: triangles name them by index.
    #[must_use]
    pub fn vertices(&self) -> &[Point3<f64>] {
        &self.vertices
    }

    /// The triangles, as vertex indices.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of triangle `i`.
    ///
    /// # Panics
    /// When `i` is out of range.
    #[must_use]
    #[inline]
    pub fn triangle(&self, i: usize) -> [Point3<f64>; 3] {
        self.triangles[i].map(|v| self.vertices[v as usize])
    }

    /// The same vertices with other triangles, whose indices the caller knows to be in range: a surface.
    pub(crate) fn with_triangles(&self, triangles: Vec<[u32; 3]>) -> Self {
        Self::surface(Arc::clone(&self.vertices), triangles)
    }

    pub(crate) fn surface(vertices: Arc<Vec<Point3<f64>>>, triangles: Vec<[u32; 3]>) -> Self {
        Self { vertices, triangles: triangles.into(), solids: Arc::default(), balls: Arc::default() }
    }

    /// The mesh moved by `pose`, with the same solids. It shares the triangles with this one, and the
    /// vertices, too, if the pose is the identity.
    #[must_use]
    pub fn transformed(&self, pose: &Isometry3<f64>) -> Self {
        if *pose == Isometry3::identity() {
            return self.clone();
        }
        let vertices: Vec<_> = self.vertices.iter().map(|p| pose * p).collect();
        Self { vertices: vertices.into(), ..self.clone() }
    }

    /// All of `meshes` in one, with their solids and balls. `None` when there are none. A single one is
    /// cloned.
    #[must_use]
    pub fn merged<'a>(meshes: impl IntoIterator<Item = &'a TriMesh>) -> Option<Self> {
        let mut meshes = meshes.into_iter();
        let first = meshes.next()?;
        let Some(second) = meshes.next() else { return Some(first.clone()) };
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        let (mut solids, mut balls) = (Vec::new(), Vec::<(Range<u32>, f64)>::new());
        for m in [first, second].into_iter().chain(meshes) {
            let base = u32::try_from(vertices.len()).ok()?;
            let before = u32::try_from(triangles.len()).ok()?;
            vertices.extend_from_slice(&m.vertices);
            triangles.extend(m.triangles.iter().map(|t| t.map(|i| i.wrapping_add(base))));
            u32::try_from(triangles.len()).ok()?;
            let moved = |range: &Range<u32>| before + range.start..before + range.end;
            solids.extend(m.solids.iter().map(moved));
            for (range, radius) in m.balls.iter().map(|(range, radius)| (moved(range), *radius)) {
                match balls.last_mut() {
                    Some((run, same)) if *same == radius && run.end == range.start => run.end = range.end,
                    _ => balls.push((range, radius)),
                }
            }
        }
        Some(Self { solids: solids.into(), balls: balls.into(), ..Self::new(vertices, triangles).ok()? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners() -> Vec<Point3<f64>> {
        vec![Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)]
    }

    #[test]
    fn what_is_not_a_mesh() {
        assert_eq!(TriMesh::new(corners(), vec![]), Err(MeshError::Empty));
        assert_eq!(TriMesh::new(vec![], vec![]), Err(MeshError::Empty));
        let out_of_range = |index, vertices| Err(MeshError::IndexOutOfRange { triangle: 0, index, vertices });
        assert_eq!(TriMesh::new(vec![], vec![[0, 0, 0]]), out_of_range(0, 0));
        assert_eq!(TriMesh::new(corners(), vec![[0, 1, 3], [0, 1, 2]]), out_of_range(3, 3));
        assert_eq!(TriMesh::new(corners(), vec![[u32::MAX, 1, 2]]), out_of_range(u32::MAX, 3));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for k in 0..3 {
                let mut vertices = corners();
                vertices[2][k] = bad;
                let error = TriMesh::new(vertices, vec![[0, 1, 2]]).unwrap_err();
                assert!(matches!(error, MeshError::NotFinite { vertex: 2, .. }), "{error}");
            }
        }
        assert!(TriMesh::merged([]).is_none());
    }

    /// Copies that change nothing share all; others nothing that differs.
    #[test]
    fn copies_share_what_they_can() {
        let mesh = TriMesh::new(corners(), vec![[0, 1, 2]]).unwrap();
        let shared = |a: &TriMesh, b: &TriMesh| {
            [Arc::ptr_eq(&a.vertices, &b.vertices), Arc::ptr_eq(&a.triangles, &b.triangles)]
        };
        assert_eq!(shared(&mesh, &mesh.transformed(&Isometry3::identity())), [true, true]);
        let moved = mesh.transformed(&Isometry3::translation(0.0, 0.0, 1e-300));
        assert_eq!(shared(&mesh, &moved), [false, true]);
        assert!(moved.vertices().iter().all(|p| p.z == 1e-300));
        assert_eq!(shared(&mesh, &TriMesh::merged([&mesh]).unwrap()), [true, true]);
        let two = TriMesh::merged([&mesh, &moved]).unwrap();
        assert_eq!((two.vertices().len(), two.triangles()), (6, &[[0, 1, 2], [3, 4, 5]][..]));
    }

    #[test]
    #[cfg(target_pointer_width = "64")]
    fn more_than_32_bits_can_number_is_too_large() {
        let most = u32::MAX as usize;
        assert_eq!(check_count("vertices", most), Ok(()));
        let error = check_count("triangles", most + 1).unwrap_err();
        assert_eq!(error, MeshError::TooLarge { what: "triangles", count: most + 1 });
        let line = "the mesh has 4294967296 triangles, more than a 32-bit index can name";
        assert_eq!(error.to_string(), line);
    }
}
