//! The primitive elements of a `<mesh>`: triangles, polygons, strips, fans and lines, with their inputs.

use super::document::{Document, Source, child};
use super::geometry::{Attribute, Geometry, Group};
use crate::error::{Error, ErrorKind};
use crate::text::{Token, clipped};
use nalgebra::Point3;
use roxmltree::{Node, NodeId};
use std::collections::HashMap;
use std::rc::Rc;

/// The kinds of primitive elements that are read.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum PrimitiveKind {
    Triangles,
    Polylist,
    Polygons,
    Strips,
    Fans,
    Lines,
    LineStrips,
}

impl PrimitiveKind {
    /// The kind of an element; `None` when it is not a primitive.
    pub(super) fn of(element: Node<'_, '_>) -> Option<Self> {
        Some(match element.tag_name().name() {
            "triangles" => Self::Triangles,
            "polylist" => Self::Polylist,
            "polygons" => Self::Polygons,
            "tristrips" => Self::Strips,
            "trifans" => Self::Fans,
            "lines" => Self::Lines,
            "linestrips" => Self::LineStrips,
            _ => return None,
        })
    }

    pub(super) fn is_lines(self) -> bool {
        matches!(self, Self::Lines | Self::LineStrips)
    }
}

/// The sources read so far, which the primitives of a geometry mostly share.
pub(super) struct Sources<'d, 'a> {
    document: &'d Document<'a>,
    known: HashMap<NodeId, Rc<Source>>,
    /// Where the positions of a source begin among those of the geometry.
    bases: HashMap<NodeId, usize>,
}

impl<'d, 'a> Sources<'d, 'a> {
    pub(super) fn new(document: &'d Document<'a>) -> Self {
        Self { document, known: HashMap::new(), bases: HashMap::new() }
    }

    fn get(&mut self, node: Node<'a, 'a>) -> Result<Rc<Source>, Error> {
        if let Some(known) = self.known.get(&node.id()) {
            return Ok(known.clone());
        }
        let source = Rc::new(self.document.source(node)?);
        self.known.insert(node.id(), source.clone());
        Ok(source)
    }

    /// The positions of a source, and where they begin in `geometry`.
    fn positions(
        &mut self,
        node: Node<'a, 'a>,
        geometry: &mut Geometry,
    ) -> Result<(Rc<Source>, usize), Error> {
        let source = self.get(node)?;
        if let Some(base) = self.bases.get(&node.id()) {
            return Ok((source, *base));
        }
        if !source.has_points() {
            let message = "the positions have less than three numbers";
            return Err(self.document.error(node, message).expected("X, Y and Z"));
        }
        if let Some(e) = &source.no_number {
            return Err(e.clone());
        }
        let base = geometry.positions.len();
        if base + source.count > super::MAX_INSTANCED {
            return Err(self.document.error(node, "too many vertices").with_kind(ErrorKind::TooLarge));
        }
        geometry.positions.extend((0..source.count).map(|i| Point3::from(source.point(i))));
        self.bases.insert(node.id(), base);
        Ok((source, base))
    }
}

/// Reads one primitive element into a geometry.
pub(super) struct Reader<'d, 'r, 'a> {
    document: &'d Document<'a>,
    primitive: Node<'a, 'a>,
    geometry: &'r mut Geometry,
    /// Numbers for each corner.
    stride: usize,
    /// Which of them is the index of the vertex.
    vertex: usize,
    positions: Rc<Source>,
    /// Where the positions of this primitive begin among those of the geometry.
    base: usize,
    /// For each attribute, which number of a corner is its row.
    attributes: Vec<(usize, Attribute)>,
    has_normals: bool,
}

impl<'d, 'r, 'a> Reader<'d, 'r, 'a> {
    pub(super) fn new(
        sources: &mut Sources<'d, 'a>,
        primitive: Node<'a, 'a>,
        geometry: &'r mut Geometry,
    ) -> Result<Self, Error> {
        let document = sources.document;
        let (mut stride, mut vertex, mut positions) = (1, 0, None);
        let (mut attributes, mut has_normals) = (Vec::new(), false);
        for input in primitive.children().filter(|c| c.tag_name().name() == "input") {
            let offset = document.count(input, "offset")?.unwrap_or(0);
            if offset > 255 {
                return Err(document.error(input, "an offset above 255").with_kind(ErrorKind::TooLarge));
            }
            stride = stride.max(offset + 1);
            let target = document.target(input, "source")?;
            if input.attribute("semantic") != Some("VERTEX") {
                has_normals |= attribute(sources, input, target, offset, &mut attributes)?;
                continue;
            }
            vertex = offset;
            for part in target.children().filter(|c| c.tag_name().name() == "input") {
                let source = document.target(part, "source")?;
                if part.attribute("semantic") == Some("POSITION") {
                    positions = Some(sources.positions(source, geometry)?);
                } else {
                    has_normals |= attribute(sources, part, source, offset, &mut attributes)?;
                }
            }
        }
        let (positions, base) = positions.ok_or_else(|| {
            let what = primitive.tag_name().name();
            document.error(primitive, format!("the {what} have no positions")).expected(
                "an <input semantic=\"VERTEX\"> whose <vertices> has an <input semantic=\"POSITION\">",
            )
        })?;
        Ok(Self { document, primitive, geometry, stride, vertex, positions, base, attributes, has_normals })
    }

    pub(super) fn read(mut self, kind: PrimitiveKind) -> Result<(), Error> {
        let first = self.geometry.ends.len();
        let lists: Vec<_> = self.primitive.children().filter(|c| c.tag_name().name() == "p").collect();
        if let Some(holes) = child(self.primitive, "ph") {
            return Err(self
                .document
                .error(holes, "a polygon with holes")
                .with_kind(ErrorKind::Unsupported)
                .help("export the mesh as triangles"));
        }
        let stated = self.document.count(self.primitive, "count")?;
        let found = match kind {
            PrimitiveKind::Polylist => self.polylist(&lists)?,
            PrimitiveKind::Triangles => self.triangles(&lists)?,
            PrimitiveKind::Polygons
            | PrimitiveKind::Strips
            | PrimitiveKind::Fans
            | PrimitiveKind::Lines
            | PrimitiveKind::LineStrips => {
                for list in &lists {
                    let numbers = self.numbers(*list)?;
                    match kind {
                        PrimitiveKind::Strips => self.strip(*list, &numbers)?,
                        PrimitiveKind::Fans => self.fan(*list, &numbers)?,
                        PrimitiveKind::Lines => self.lines(*list, &numbers)?,
                        PrimitiveKind::LineStrips => self.line_strip(*list, &numbers)?,
                        _ => self.polygon(*list, &numbers)?,
                    }
                }
                lists.len()
            }
        };
        // SketchUp writes wrong counts of lines.
        if let Some(n) = stated.filter(|&n| n != found && !kind.is_lines()) {
            let tag = self.primitive.tag_name().name();
            let message = format!("<{tag} count=\"{n}\"> has {found}");
            return Err(self.document.error(self.primitive, message).expected("as many as it counts"));
        }
        self.geometry.groups.push(Group {
            faces: first..self.geometry.ends.len(),
            attributes: self.attributes.into_iter().map(|(_, a)| a).collect(),
            has_normals: self.has_normals,
        });
        Ok(())
    }

    fn triangles(&mut self, lists: &[Node<'a, 'a>]) -> Result<usize, Error> {
        let mut found = 0;
        for list in lists {
            let numbers = self.numbers(*list)?;
            let triangles = numbers.chunks_exact(3 * self.stride);
            if !triangles.remainder().is_empty() {
                let message = format!("<p> has {} corners", numbers.len() / self.stride);
                return Err(self.document.error(*list, message).expected("three for each triangle"));
            }
            for triangle in triangles {
                self.polygon(*list, triangle)?;
                found += 1;
            }
        }
        Ok(found)
    }

    fn polylist(&mut self, lists: &[Node<'a, 'a>]) -> Result<usize, Error> {
        let Some(sizes) = child(self.primitive, "vcount") else {
            if lists.is_empty() {
                return Ok(0);
            }
            return Err(self.document.error(self.primitive, "<polylist> without <vcount>"));
        };
        let mut numbers = Vec::new();
        for list in lists {
            numbers.extend(self.numbers(*list)?);
        }
        let (mut used, mut found) = (0, 0);
        for word in self.document.words(sizes) {
            self.document.go_on()?;
            let n = self.document.text.count(word, "the number of corners of a polygon")?;
            let end = n.checked_mul(self.stride).and_then(|len| len.checked_add(used));
            let Some(polygon) = end.and_then(|end| numbers.get(used..end)) else {
                let left = (numbers.len() - used) / self.stride;
                let message = format!("polygon {found} has {n} corners, but only {left} are left");
                return Err(self
                    .document
                    .text
                    .error(word, message)
                    .expected("as many corners in <p> as <vcount> adds up to"));
            };
            self.polygon(sizes, polygon)?;
            used += polygon.len();
            found += 1;
        }
        if used == numbers.len() {
            return Ok(found);
        }
        let message = format!("<vcount> adds up to {} corners", used / self.stride);
        let expected = format!("{}, as <p> has", numbers.len() / self.stride);
        Err(self.document.error(sizes, message).expected(expected))
    }

    /// The numbers of `<p>`, `stride` of them for each corner.
    fn numbers(&self, list: Node<'a, 'a>) -> Result<Vec<u32>, Error> {
        let mut out = Vec::new();
        for word in self.document.words(list) {
            self.document.go_on()?;
            let index = self.index(word, out.len() % self.stride)?;
            out.push(index);
        }
        match out.len() % self.stride {
            0 => Ok(out),
            n => {
                let message = format!("the last corner of <p> has {n} numbers");
                Err(self
                    .document
                    .error(list, message)
                    .expected(format!("{}, one for each offset", self.stride)))
            }
        }
    }

    fn index(&self, word: Token<'_>, offset: usize) -> Result<u32, Error> {
        let text = &self.document.text;
        let Ok(index) = word.text.parse::<u32>() else {
            let message = format!("`{}` is not an index", clipped(word.text));
            return Err(text.error(word, message).expected("a whole number from 0"));
        };
        let sources = self.attributes.iter().filter(|(o, _)| *o == offset).map(|(_, a)| &a.source);
        let vertex = (offset == self.vertex).then_some(&self.positions);
        let limit = sources.chain(vertex).map(|s| s.count).min();
        match limit {
            Some(n) if index as usize >= n => Err(text
                .error(word, format!("index {index} is out of range"))
                .expected(format!("an index from 0 to {}", n.saturating_sub(1)))),
            _ => Ok(index),
        }
    }

    /// Adds the polygon of `numbers`, `stride` of them for each corner.
    fn polygon(&mut self, place: Node<'_, '_>, numbers: &[u32]) -> Result<(), Error> {
        if numbers.is_empty() {
            return Err(self.document.error(place, "a polygon without corners").expected("three or more"));
        }
        // One of fewer than three corners is no surface: it counts as a line.
        self.face(place, numbers)
    }

    /// Adds the face of `numbers`.
    fn face(&mut self, place: Node<'_, '_>, numbers: &[u32]) -> Result<(), Error> {
        let n = numbers.len() / self.stride;
        if self.geometry.corners.len() + n > super::MAX_INSTANCED {
            return Err(self.document.error(place, "too many corners").with_kind(ErrorKind::TooLarge));
        }
        for corner in numbers.chunks_exact(self.stride) {
            // Both below MAX_INSTANCED, hence below u32::MAX.
            self.geometry.corners.push(corner[self.vertex] + self.base as u32);
            for (offset, attribute) in &mut self.attributes {
                attribute.rows.push(corner[*offset]);
            }
        }
        self.geometry.ends.push(self.geometry.corners.len());
        Ok(())
    }

    fn strip(&mut self, place: Node<'_, '_>, numbers: &[u32]) -> Result<(), Error> {
        let corners: Vec<_> = numbers.chunks_exact(self.stride).collect();
        for (i, w) in corners.windows(3).enumerate() {
            let triangle = if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
            self.polygon(place, &triangle.concat())?;
        }
        Ok(())
    }

    fn fan(&mut self, place: Node<'_, '_>, numbers: &[u32]) -> Result<(), Error> {
        let corners: Vec<_> = numbers.chunks_exact(self.stride).collect();
        for w in corners.get(1..).unwrap_or_default().windows(2) {
            self.polygon(place, &[corners[0], w[0], w[1]].concat())?;
        }
        Ok(())
    }

    fn lines(&mut self, place: Node<'_, '_>, numbers: &[u32]) -> Result<(), Error> {
        let lines = numbers.chunks_exact(2 * self.stride);
        if !lines.remainder().is_empty() {
            let message = format!("<p> has {} ends of lines", numbers.len() / self.stride);
            return Err(self.document.error(place, message).expected("two for each line"));
        }
        lines.into_iter().try_for_each(|line| self.face(place, line))
    }

    fn line_strip(&mut self, place: Node<'_, '_>, numbers: &[u32]) -> Result<(), Error> {
        let corners: Vec<_> = numbers.chunks_exact(self.stride).collect();
        corners.windows(2).try_for_each(|line| self.face(place, &line.concat()))
    }
}

/// Adds the attribute of an input; returns whether it holds normals.
fn attribute<'a>(
    sources: &mut Sources<'_, 'a>,
    input: Node<'a, 'a>,
    source: Node<'a, 'a>,
    offset: usize,
    attributes: &mut Vec<(usize, Attribute)>,
) -> Result<bool, Error> {
    let semantic = input.attribute("semantic").unwrap_or_default();
    if !matches!(semantic, "NORMAL" | "TEXCOORD" | "COLOR" | "TEXTANGENT" | "TEXBINORMAL") {
        return Ok(false);
    }
    let source = sources.get(source)?;
    attributes.push((offset, Attribute { source, rows: Vec::new() }));
    Ok(semantic == "NORMAL")
}
