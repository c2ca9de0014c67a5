//! `<geometry>`: the positions and faces of all its primitives.

use super::document::{Document, Source, child};
use super::primitive::{PrimitiveKind, Reader, Sources};
use crate::error::{Error, ErrorKind};
use mp_geom::TriMesh;
use nalgebra::Point3;
use roxmltree::Node;
use std::rc::Rc;

/// The faces of a geometry: polygons, and lines, which are faces of two corners.
#[derive(Debug, Default)]
pub(super) struct Geometry {
    /// The positions that polygons use, then those that only lines use.
    pub(super) positions: Vec<Point3<f64>>,
    /// How many of them polygons use.
    of_polygons: usize,
    /// The corners of all faces, as indices of positions.
    pub(super) corners: Vec<u32>,
    /// Where each face ends in `corners`.
    pub(super) ends: Vec<usize>,
    /// The `<triangles>`, `<lines>` … it is made of.
    pub(super) groups: Vec<Group>,
}

/// Faces that share their inputs.
#[derive(Debug)]
pub(super) struct Group {
    /// Which faces of the geometry they are.
    pub(super) faces: std::ops::Range<usize>,
    /// The data of corners besides positions.
    pub(super) attributes: Vec<Attribute>,
    /// Whether its polygons do without face normals: normals are among the attributes, or filled in.
    pub(super) has_normals: bool,
}

/// Data of corners: the row of `source` for each corner of the group.
#[derive(Debug)]
pub(super) struct Attribute {
    pub(super) source: Rc<Source>,
    pub(super) rows: Vec<u32>,
}

impl Geometry {
    /// The triangles of a mesh, in one group without attributes.
    pub(super) fn of_mesh(mesh: &TriMesh) -> Self {
        let positions = mesh.vertices().to_vec();
        let mut geometry = Self { of_polygons: positions.len(), positions, ..Self::default() };
        for t in mesh.triangles() {
            geometry.corners.extend(t);
            geometry.ends.push(geometry.corners.len());
        }
        let faces = 0..geometry.ends.len();
        geometry.groups.push(Group { faces, attributes: Vec::new(), has_normals: false });
        geometry
    }

    /// The position of index `i`.
    pub(super) fn position(&self, i: u32) -> &Point3<f64> {
        &self.positions[i as usize]
    }

    /// The positions that polygons use.
    pub(super) fn positions(&self) -> &[Point3<f64>] {
        &self.positions[..self.of_polygons]
    }

    /// The corners of face `i`.
    pub(super) fn face(&self, i: usize) -> &[u32] {
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        &self.corners[start..self.ends[i]]
    }

    /// The corners of all polygons.
    pub(super) fn polygons(&self) -> impl Iterator<Item = &[u32]> + Clone {
        (0..self.ends.len()).map(|i| self.face(i)).filter(|face| is_polygon(face))
    }

    /// Reads the element `<geometry>`.
    pub(super) fn read<'a>(document: &Document<'a>, node: Node<'a, 'a>) -> Result<Self, Error> {
        let Some(mesh) = child(node, "mesh") else {
            return Err(document
                .error(node, "a geometry without <mesh>")
                .expected("<mesh>: polygons")
                .with_kind(ErrorKind::Unsupported)
                .help("export curves and solids as polygons"));
        };
        let mut geometry = Self::default();
        let mut sources = Sources::new(document);
        for primitive in mesh.children().filter(Node::is_element) {
            // Sources, vertices and extras are not primitives.
            let Some(kind) = PrimitiveKind::of(primitive) else { continue };
            // Writers leave empty groups behind, some without inputs.
            let empty = kind.is_lines() || child(primitive, "p").is_none();
            if empty && document.count(primitive, "count")?.unwrap_or(0) == 0 {
                continue;
            }
            Reader::new(&mut sources, primitive, &mut geometry)?.read(kind)?;
        }
        geometry.sort_positions();
        geometry.fill_in_normals();
        Ok(geometry)
    }

    /// Puts the positions of polygons before those that only lines use, and drops unused ones.
    fn sort_positions(&mut self) {
        let mut new = vec![u32::MAX; self.positions.len()];
        let mut kept = Vec::new();
        for polygons in [true, false] {
            let mut start = 0;
            for &end in &self.ends {
                let face = &mut self.corners[start..end];
                start = end;
                if is_polygon(face) != polygons {
                    continue;
                }
                for c in face {
                    let slot = &mut new[*c as usize];
                    if *slot == u32::MAX {
                        *slot = kept.len() as u32; // fewer than the positions, whose indices are u32
                        kept.push(self.positions[*c as usize]);
                    }
                    *c = *slot;
                }
            }
            if polygons {
                self.of_polygons = kept.len();
            }
        }
        self.positions = kept;
    }

    /// As the importer does: when a group has normals, all corners of the groups before it get one common normal.
    fn fill_in_normals(&mut self) {
        let last = self.groups.iter().rposition(|group| group.has_normals && !group.faces.is_empty());
        for group in &mut self.groups[..last.unwrap_or(0)] {
            group.has_normals = true;
        }
    }
}

/// Whether the corners are those of a polygon, not of a line.
fn is_polygon(face: &[u32]) -> bool {
    face.len() > 2
}
