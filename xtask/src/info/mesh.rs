//! What is in a mesh file.

use super::{brief, count};
use miette::Result;
use mp::geom::TriMesh;
use serde::Serialize;
use std::fmt;
use std::path::Path;

#[derive(Clone, Debug, Serialize)]
pub(crate) struct Facts {
    kind: &'static str,
    file: String,
    #[serde(flatten)]
    shape: Shape,
}

/// What is known of a mesh. Metres; counts of defects are 0 for a sound solid.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Shape {
    units: &'static str,
    pub(crate) triangles: usize,
    vertices: usize,
    pub(crate) min: [f64; 3],
    pub(crate) max: [f64; 3],
    area: f64,
    /// Every edge has two sides, oriented one way: it bounds a volume.
    pub(crate) watertight: bool,
    manifold: bool,
    oriented: bool,
    parts: usize,
    boundary_edges: usize,
    crowded_edges: usize,
    misoriented_edges: usize,
    pinched_vertices: usize,
    degenerate_triangles: usize,
    duplicate_triangles: usize,
    pub(crate) warnings: Vec<String>,
}

impl Facts {
    pub(crate) fn read(file: &Path) -> Result<Self> {
        let mesh = mp::io::read_mesh(file)?;
        Ok(Self { kind: "mesh", file: file.display().to_string(), shape: Shape::of(&mesh) })
    }
}

impl Shape {
    pub(crate) fn of(mesh: &TriMesh) -> Self {
        let (t, aabb) = (mesh.topology(), mesh.aabb());
        let area = (0..mesh.triangles().len())
            .map(|i| {
                let [a, b, c] = mesh.triangle(i);
                0.5 * (b - a).cross(&(c - a)).norm()
            })
            .sum();
        let mut shape = Self {
            units: "metres",
            triangles: mesh.triangles().len(),
            vertices: t.vertices,
            min: aabb.min.coords.into(),
            max: aabb.max.coords.into(),
            area,
            watertight: t.closed && t.oriented,
            manifold: t.manifold,
            oriented: t.oriented,
            parts: t.components,
            boundary_edges: t.boundary_edges.len(),
            crowded_edges: t.crowded_edges.len(),
            misoriented_edges: t.misoriented_edges.len(),
            pinched_vertices: t.pinched_vertices.len(),
            degenerate_triangles: t.degenerate.len(),
            duplicate_triangles: t.duplicates.len(),
            warnings: Vec::new(),
        };
        shape.warnings = shape.defects();
        shape
    }

    fn defects(&self) -> Vec<String> {
        let defects = [
            (self.boundary_edges, "boundary edge", "the surface has holes, or is a sheet"),
            (self.crowded_edges, "edge", "shared by more than two triangles"),
            (self.misoriented_edges, "edge", "where neighbours are turned against each other"),
            (self.pinched_vertices, "vertex", "where parts of the surface touch in a point"),
            (self.degenerate_triangles, "triangle", "without area"),
            (self.duplicate_triangles, "triangle", "that are there twice"),
        ];
        let some = defects.into_iter().filter(|(n, ..)| *n > 0);
        let plural = |n: usize, what: &str| match (n, what) {
            (1, _) => format!("1 {what}"),
            (_, "vertex") => format!("{n} vertices"),
            _ => count(n, what),
        };
        some.map(|(n, what, meaning)| match what {
            "boundary edge" => format!("{}: {meaning}", plural(n, what)),
            _ => format!("{} {meaning}", plural(n, what)),
        })
        .collect()
    }

    /// One line for a list of bodies.
    pub(crate) fn summary(&self) -> String {
        let sound = match (self.watertight, self.manifold) {
            (true, true) => "watertight",
            (true, false) => "watertight, not manifold",
            (false, _) => "not watertight",
        };
        format!("{}, {sound}", count(self.triangles, "triangle"))
    }
}

impl fmt::Display for Facts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let s = &self.shape;
        let yes = |b: bool| if b { "yes" } else { "no" };
        let size: Vec<String> = (0..3).map(|k| brief(s.max[k] - s.min[k])).collect();
        let corner = |c: [f64; 3]| format!("({})", c.map(brief).join(", "));
        writeln!(f, "{}: a mesh", self.file)?;
        writeln!(
            f,
            "  {}, {} vertices, {}",
            count(s.triangles, "triangle"),
            s.vertices,
            count(s.parts, "part")
        )?;
        writeln!(f, "  size      {} m, from {} to {}", size.join(" × "), corner(s.min), corner(s.max))?;
        writeln!(f, "  area      {} m²", brief(s.area))?;
        writeln!(
            f,
            "  surface   watertight {}, manifold {}, oriented {}",
            yes(s.watertight),
            yes(s.manifold),
            yes(s.oriented)
        )?;
        match s.warnings.is_empty() {
            true => Ok(()),
            false => writeln!(f, "  warning   {}", s.warnings.join("; ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp::geom::primitives::cuboid;

    #[test]
    fn a_box_is_sound_and_an_open_one_is_not() {
        let whole = cuboid(1.0, 2.0, 3.0).unwrap();
        let shape = Shape::of(&whole);
        assert!(shape.watertight && shape.warnings.is_empty(), "{:?}", shape.warnings);
        assert!((shape.area - 22.0).abs() < 1e-12);
        let open = TriMesh::new(whole.vertices().to_vec(), whole.triangles()[2..].to_vec()).unwrap();
        let shape = Shape::of(&open);
        assert!(!shape.watertight);
        assert_eq!(shape.warnings, ["4 boundary edges: the surface has holes, or is a sheet"]);
    }
}
