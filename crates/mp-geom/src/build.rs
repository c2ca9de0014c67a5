//! Meshes from soups, strips, fans and polygons.
//!
//! Key-elements paper (see the `pose` module), section 2.1 and figure 3: a soup repeats every point;
//! strips and fans share them.

use crate::{MeshError, TriMesh, triangulate::triangulate};
use mp_stop::{Interrupt, Interrupted};
use nalgebra::Point3;
use std::collections::HashMap;
use std::convert::Infallible;

/// Gives equal positions equal numbers, in order of first appearance.
#[derive(Default)]
pub(crate) struct Welder(HashMap<[u64; 3], u32>);

impl Welder {
    /// The number of position `p`. 0 and −0 are the same place.
    pub(crate) fn number(&mut self, p: &Point3<f64>) -> u32 {
        let next = self.0.len() as u32;
        *self.0.entry([p.x, p.y, p.z].map(|c| (c + 0.0).to_bits())).or_insert(next)
    }
}

fn check_corners(what: &'static str, index: usize, corners: usize) -> Result<(), MeshError> {
    if corners < 3 { Err(MeshError::TooFewCorners { what, index, corners }) } else { Ok(()) }
}

fn check_indices(vertices: usize, triangle: usize, indices: &[u32]) -> Result<(), MeshError> {
    match indices.iter().find(|&&i| i as usize >= vertices) {
        Some(&index) => Err(MeshError::IndexOutOfRange { triangle, index, vertices }),
        None => Ok(()),
    }
}

impl TriMesh {
    /// A mesh from a soup: three points a triangle. Points at identical coordinates become one vertex;
    /// triangles are kept as they are, degenerate ones too.
    ///
    /// # Errors
    /// As [`TriMesh::new`].
    pub fn from_soup(soup: &[[Point3<f64>; 3]]) -> Result<Self, MeshError> {
        let Ok(made) = Self::of_soup(soup, || Ok::<(), Infallible>(()));
        made
    }

    /// As [`from_soup`](Self::from_soup), unless `interrupt` says to end.
    ///
    /// # Errors
    /// When it was interrupted. Inside, as [`TriMesh::new`].
    pub fn from_soup_until(
        soup: &[[Point3<f64>; 3]],
        interrupt: &Interrupt,
    ) -> Result<Result<Self, MeshError>, Interrupted> {
        let mut interrupt = interrupt.clone();
        Self::of_soup(soup, || interrupt.go_on())
    }

    /// `go_on` is called for each thousand triangles.
    fn of_soup<E>(
        soup: &[[Point3<f64>; 3]],
        mut go_on: impl FnMut() -> Result<(), E>,
    ) -> Result<Result<Self, MeshError>, E> {
        if u32::try_from(soup.len().saturating_mul(3)).is_err() {
            let count = soup.len().saturating_mul(3);
            return Ok(Err(MeshError::TooLarge { what: "triangle corners", count }));
        }
        let mut welder = Welder::default();
        let mut vertices = Vec::new();
        let mut triangles = Vec::with_capacity(soup.len());
        for (i, corners) in soup.iter().enumerate() {
            if i % 1024 == 0 {
                go_on()?;
            }
            triangles.push(corners.map(|p| {
                let i = welder.number(&p);
                if i as usize == vertices.len() {
                    vertices.push(p);
                }
                i
            }));
        }
        Ok(Self::new(vertices, triangles))
    }

    /// A mesh from triangle strips: corners k, k+1, k+2 of a strip are a triangle, every second one turned
    /// so that all face the side of the first. Triangles that repeat an index, by which strips are joined,
    /// are left out.
    ///
    /// # Errors
    /// As [`TriMesh::new`], and [`MeshError::TooFewCorners`] for a strip of less than three.
    pub fn from_strips<S: AsRef<[u32]>>(
        vertices: Vec<Point3<f64>>,
        strips: impl IntoIterator<Item = S>,
    ) -> Result<Self, MeshError> {
        let mut triangles = Vec::new();
        for (index, strip) in strips.into_iter().enumerate() {
            let strip = strip.as_ref();
            check_corners("strip", index, strip.len())?;
            for (k, w) in strip.windows(3).enumerate() {
                if w[0] != w[1] && w[1] != w[2] && w[2] != w[0] {
                    triangles.push(if k % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] });
                }
            }
        }
        Self::new(vertices, triangles)
    }

    /// A mesh from triangle fans: the first corner of a fan with each two consecutive others.
    /// Triangles that repeat an index are left out.
    ///
    /// # Errors
    /// As [`TriMesh::new`], and [`MeshError::TooFewCorners`] for a fan of less than three.
    pub fn from_fans<F: AsRef<[u32]>>(
        vertices: Vec<Point3<f64>>,
        fans: impl IntoIterator<Item = F>,
    ) -> Result<Self, MeshError> {
        let mut triangles = Vec::new();
        for (index, fan) in fans.into_iter().enumerate() {
            let fan = fan.as_ref();
            check_corners("fan", index, fan.len())?;
            for w in fan[1..].windows(2) {
                if fan[0] != w[0] && w[0] != w[1] && w[1] != fan[0] {
                    triangles.push([fan[0], w[0], w[1]]);
                }
            }
        }
        Self::new(vertices, triangles)
    }

    /// A mesh from planar polygons, convex or concave, without holes; each becomes `corners − 2` triangles
    /// of its own orientation.
    ///
    /// A polygon that is not quite planar is triangulated as seen along its Newell normal. One that crosses
    /// itself gets some triangulation of its corners.
    ///
    /// # Errors
    /// As [`TriMesh::new`] (`IndexOutOfRange` counts polygons instead of triangles), and
    /// [`MeshError::TooFewCorners`] for a polygon of less than three.
    pub fn from_polygons<P: AsRef<[u32]>>(
        vertices: Vec<Point3<f64>>,
        polygons: impl IntoIterator<Item = P>,
    ) -> Result<Self, MeshError> {
        let mut triangles = Vec::new();
        let mut corners = Vec::new();
        for (index, polygon) in polygons.into_iter().enumerate() {
            let polygon = polygon.as_ref();
            check_corners("polygon", index, polygon.len())?;
            check_indices(vertices.len(), index, polygon)?;
            if let [a, b, c] = *polygon {
                triangles.push([a, b, c]);
                continue;
            }
            corners.clear();
            corners.extend(polygon.iter().map(|&i| vertices[i as usize]));
            triangles.extend(triangulate(&corners).into_iter().map(|t| t.map(|k| polygon[k])));
        }
        Self::new(vertices, triangles)
    }

    /// The same triangles and solids, with vertices at identical coordinates merged and unused vertices
    /// dropped.
    #[must_use]
    pub fn welded(&self) -> Self {
        let soup: Vec<_> = (0..self.triangles().len()).map(|i| self.triangle(i)).collect();
        Self::from_soup(&soup)
            .map_or_else(|_| self.clone(), |welded| Self { solids: self.solids.clone(), ..welded })
    }

    /// The same triangles, without vertices that none of them has. A surface.
    #[must_use]
    pub fn without_unused_vertices(self) -> Self {
        let mut names = vec![u32::MAX; self.vertices().len()];
        self.triangles().iter().flatten().for_each(|&v| names[v as usize] = 0);
        if names.iter().all(|&name| name == 0) {
            return self;
        }
        let used = names.iter_mut().filter(|name| **name == 0);
        used.zip(0..).for_each(|(name, number)| *name = number);
        let kept = self.vertices().iter().zip(&names).filter(|(_, name)| **name != u32::MAX);
        let vertices: Vec<_> = kept.map(|(vertex, _)| *vertex).collect();
        let triangles = self.triangles().iter().map(|t| t.map(|v| names[v as usize])).collect();
        Self::surface(vertices.into(), triangles)
    }

    /// The mesh turned inside out: every triangle reversed. It is a surface: around solids there is room now.
    #[must_use]
    pub fn reversed(&self) -> Self {
        self.with_triangles(self.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Vec<Point3<f64>> {
        [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0), (2.0, 0.0), (2.0, 1.0)]
            .map(|(x, y)| Point3::new(x, y, 0.0))
            .to_vec()
    }

    #[test]
    fn unused_vertices_are_dropped_and_the_others_keep_their_order() {
        let mesh = TriMesh::new(grid(), vec![[5, 3, 2], [2, 0, 5]]).unwrap();
        let used = mesh.clone().without_unused_vertices();
        assert_eq!(used.vertices(), [0, 2, 3, 5].map(|i: usize| grid()[i]));
        assert_eq!(used.triangles(), [[3, 2, 1], [1, 0, 3]]);
        assert_eq!(used.clone().without_unused_vertices(), used);
    }

    fn upward(mesh: &TriMesh) -> Vec<bool> {
        (0..mesh.triangles().len())
            .map(|i| {
                let [a, b, c] = mesh.triangle(i);
                (b - a).cross(&(c - a)).z > 0.0
            })
            .collect()
    }

    #[test]
    fn a_soup_is_welded() {
        let g = grid();
        let minus_zero = Point3::new(-0.0, 0.0, -0.0);
        let m =
            TriMesh::from_soup(&[[g[0], g[2], g[1]], [g[1], g[2], g[3]], [minus_zero, g[4], g[2]]]).unwrap();
        assert_eq!(m.vertices().len(), 5);
        assert_eq!(m.triangles(), [[0, 1, 2], [2, 1, 3], [0, 4, 1]]);
        assert_eq!(m.triangle(1), [g[1], g[2], g[3]]);
        assert_eq!(m.welded(), m);
    }

    #[test]
    fn strips_alternate_and_fans_turn_one_way() {
        let strip = TriMesh::from_strips(grid(), [[0, 2, 1, 3]]).unwrap();
        assert_eq!(strip.triangles(), [[0, 2, 1], [1, 2, 3]]);
        let all: [&[u32]; 2] = [&[0, 2, 1, 3], &[2, 4, 3, 5]];
        let strip = TriMesh::from_strips(grid(), all).unwrap();
        assert_eq!(upward(&strip), [true; 4]);
        // Joined by repeated indices.
        let joined = TriMesh::from_strips(grid(), [[0, 2, 1, 3, 3, 2, 2, 4, 3, 5]]).unwrap();
        assert_eq!(joined.triangles().len(), 4);
        assert_eq!(upward(&joined), [true; 4]);
        let fan = TriMesh::from_fans(grid(), [[0, 2, 4, 5, 3, 1]]).unwrap();
        assert_eq!(fan.triangles(), [[0, 2, 4], [0, 4, 5], [0, 5, 3], [0, 3, 1]]);
    }

    #[test]
    fn a_concave_polygon() {
        let arrow =
            [(0.0, 0.0), (2.0, 1.0), (0.0, 2.0), (1.0, 1.0)].map(|(x, y)| Point3::new(x, 0.0, y)).to_vec();
        let m = TriMesh::from_polygons(arrow, [[0_u32, 1, 2, 3]]).unwrap();
        // The only diagonal inside is 1–3.
        let mut t: Vec<_> = m
            .triangles()
            .iter()
            .map(|t| {
                let mut t = *t;
                t.sort_unstable();
                t
            })
            .collect();
        t.sort_unstable();
        assert_eq!(t, [[0, 1, 3], [1, 2, 3]]);
    }

    #[test]
    fn what_cannot_be_built() {
        let short = |what| Err(MeshError::TooFewCorners { what, index: 1, corners: 2 });
        let two: [&[u32]; 2] = [&[0, 1, 2], &[0, 1]];
        assert_eq!(TriMesh::from_strips(grid(), two), short("strip"));
        assert_eq!(TriMesh::from_fans(grid(), two), short("fan"));
        assert_eq!(TriMesh::from_polygons(grid(), two), short("polygon"));
        let range = MeshError::IndexOutOfRange { triangle: 0, index: 9, vertices: 6 };
        assert_eq!(TriMesh::from_polygons(grid(), [[0_u32, 1, 3, 9]]), Err(range.clone()));
        assert_eq!(TriMesh::from_strips(grid(), [[0_u32, 1, 9]]), Err(range));
        assert_eq!(TriMesh::from_soup(&[]), Err(MeshError::Empty));
        let nan = Point3::new(0.0, f64::NAN, 0.0);
        assert!(matches!(TriMesh::from_soup(&[[nan; 3]]), Err(MeshError::NotFinite { .. })));
    }
}
