//! What is in a mesh file.

use crate::files::inputs::Recording;
use crate::{Error, brief, count, plain};
use mp_geom::TriMesh;
use serde::Serialize;
use std::fmt;
use std::path::Path;

/// What is in a mesh file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeshInfo {
    /// The file, as it was named.
    pub file: String,
    /// The properties of the mesh.
    #[serde(flatten)]
    pub surface: Surface,
    /// What was decided or passed over when it was read.
    pub notes: Vec<String>,
}

/// The properties of a mesh, in metres. Counts of defects are 0 for a sound solid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Surface {
    /// Always `metres`.
    pub units: &'static str,
    /// How many triangles it has.
    pub triangles: usize,
    /// How many vertices it has.
    pub vertices: usize,
    /// The lower corner of the box around it.
    pub min: [f64; 3],
    /// The upper corner of the box around it.
    pub max: [f64; 3],
    /// The area of its surface, m².
    pub area: f64,
    /// Whether it bounds a volume: every edge joins two triangles of the same orientation.
    pub watertight: bool,
    /// Whether every edge joins at most two triangles, and no vertex joins parts.
    pub manifold: bool,
    /// Whether neighbouring triangles have the same orientation.
    pub oriented: bool,
    /// The number of connected parts.
    pub parts: usize,
    /// The number of edges that belong to one triangle only.
    pub boundary_edges: usize,
    /// The number of edges that belong to more than two triangles.
    pub crowded_edges: usize,
    /// The number of edges whose triangles have opposite orientations.
    pub misoriented_edges: usize,
    /// The number of vertices where parts of the surface touch in a point.
    pub pinched_vertices: usize,
    /// The number of triangles without area.
    pub degenerate_triangles: usize,
    /// The number of triangles that occur twice.
    pub duplicate_triangles: usize,
    /// Whether each triangle is there once for each side, as SketchUp writes surfaces. The warnings are then those of one side.
    pub two_sided: bool,
    /// What is wrong with it, in words.
    pub warnings: Vec<String>,
}

impl MeshInfo {
    /// Reads a mesh file.
    ///
    /// # Errors
    /// When the file cannot be read, or does not hold a valid mesh.
    pub fn read(file: &Path) -> Result<Self, Error> {
        let files = Recording::new(&mp_io::Disk);
        let mesh = mp_io::read_mesh_of(&files, file)?;
        Ok(Self { file: file.display().to_string(), surface: Surface::of(&mesh), notes: files.remarks() })
    }
}

impl Surface {
    /// The properties of a mesh.
    #[must_use]
    pub fn of(mesh: &TriMesh) -> Self {
        let (t, aabb) = (mesh.topology(), mesh.aabb());
        let area: f64 = (0..mesh.triangles().len())
            .map(|i| {
                let [a, b, c] = mesh.triangle(i);
                0.5 * (b - a).cross(&(c - a)).norm()
            })
            .sum();
        let encloses = mesh.encloses_volume();
        let anything = t.degenerate.len() < mesh.triangles().len();
        let mut shape = Self {
            units: "metres",
            triangles: mesh.triangles().len(),
            vertices: t.vertices,
            min: aabb.min.coords.into(),
            max: aabb.max.coords.into(),
            area,
            watertight: t.closed && t.oriented && encloses,
            manifold: t.manifold && anything,
            oriented: t.oriented && anything,
            parts: t.components,
            boundary_edges: t.boundary_edges.len(),
            crowded_edges: t.crowded_edges.len(),
            misoriented_edges: t.misoriented_edges.len(),
            pinched_vertices: t.pinched_vertices.len(),
            degenerate_triangles: t.degenerate.len(),
            duplicate_triangles: t.duplicates.len(),
            two_sided: false,
            warnings: Vec::new(),
        };
        if let Some(side) = mesh.one_side() {
            let side = Self::of(&side);
            (shape.two_sided, shape.watertight, shape.warnings) = (true, side.watertight, side.warnings);
            return shape;
        }
        shape.warnings = shape.defects();
        if anything && t.closed && t.oriented && !encloses {
            shape.warnings.push("the surface is closed, but flat: it bounds no volume".to_owned());
        }
        if !anything {
            shape.warnings.push("nothing is left of the surface: no triangle has an area".to_owned());
        }
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
    #[must_use]
    pub fn summary(&self) -> String {
        let sound = match (self.watertight, self.manifold) {
            (true, true) => "watertight",
            (true, false) => "watertight, not manifold",
            (false, _) => "not watertight",
        };
        format!("{}, {sound}", count(self.triangles, "triangle"))
    }
}

impl fmt::Display for MeshInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let s = &self.surface;
        let yes = |b: bool| if b { "yes" } else { "no" };
        let size: Vec<String> = (0..3).map(|k| brief(s.max[k] - s.min[k])).collect();
        let corner = |c: [f64; 3]| format!("({})", c.map(plain).join(", "));
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
        if s.two_sided {
            writeln!(
                f,
                "  sides     each triangle is there once for each side; warnings are those of one side"
            )?;
        }
        self.notes.iter().try_for_each(|note| writeln!(f, "  note      {note}"))?;
        match s.warnings.is_empty() {
            true => Ok(()),
            false => writeln!(f, "  warning   {}", s.warnings.join("; ")),
        }
    }
}
