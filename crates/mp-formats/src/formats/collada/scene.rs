//! `<visual_scene>`: the tree of nodes, which gives geometries their places.

use super::document::{Document, child};
use super::geometry::Geometry;
use super::{Instance, MAX_INSTANCED};
use crate::error::{Error, ErrorKind};
use crate::mesh::Axes;
use crate::text::clipped;
use nalgebra::{Matrix4, Rotation3, Unit, Vector3};
use roxmltree::{Node, NodeId};
use std::collections::HashMap;
use std::rc::Rc;

/// The deepest nesting of nodes, instances included; deeper nodes are taken to contain themselves.
const MAX_DEPTH: usize = 128;
/// The most nodes and instances of a scene.
const MAX_VISITED: usize = 1_000_000;

/// All instances of geometries, in the order of the importer: those of a node, then of its children, then
/// of the nodes it instantiates.
/// The second is whether there are morphs among them.
pub(super) fn instances<'a>(
    document: &Document<'a>,
    root: Matrix4<f64>,
) -> Result<(Vec<Instance>, bool), Error> {
    let scene = visual_scene(document)?;
    let mut walk = Walk {
        document,
        geometries: HashMap::new(),
        instances: Vec::new(),
        morphs: false,
        visited: 0,
        corners: 0,
    };
    walk.node(scene, root, 0)?;
    let has_faces = |n: &Node<'_, '_>| {
        n.tag_name().name() == "geometry" && n.descendants().any(|n| n.tag_name().name() == "p")
    };
    if walk.instances.is_empty() && document.root.descendants().any(|n| has_faces(&n)) {
        return Err(document
            .error(scene, "the scene shows no geometry, and the file has some")
            .expected("nodes with <instance_geometry>")
            .help("export the mesh again: what only physics uses is not read"));
    }
    Ok((walk.instances, walk.morphs))
}

fn visual_scene<'a>(document: &Document<'a>) -> Result<Node<'a, 'a>, Error> {
    if let Some(instance) = child(document.root, "scene").and_then(|s| child(s, "instance_visual_scene")) {
        return document.target(instance, "url");
    }
    let mut all = document.root.descendants().filter(|n| n.tag_name().name() == "visual_scene");
    match (all.next(), all.next()) {
        (Some(only), None) => Ok(only),
        _ => Err(document
            .error(document.root, "the file does not say which scene it shows")
            .expected("<scene><instance_visual_scene url=\"#id\"/></scene>")),
    }
}

/// What `<asset>` says of the coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asset {
    /// The unit of length, metres.
    pub(crate) unit: f64,
    /// `X_UP`, `Y_UP` or `Z_UP`; the second when the file does not say.
    pub(crate) up: &'static str,
    /// The turn of the up axis to Y.
    turn: Matrix4<f64>,
}

impl Asset {
    /// The transform from the file's unit and axes to metres and `axes`.
    pub(super) fn root(&self, axes: Axes) -> Matrix4<f64> {
        let scale = Matrix4::new_scaling(self.unit);
        match axes {
            Axes::OfFile => scale,
            Axes::YUp => scale * self.turn,
        }
    }
}

pub(super) fn asset(document: &Document<'_>) -> Result<Asset, Error> {
    let own = child(document.root, "asset");
    let unit = own.map_or(Ok(None), |asset| unit(document, asset))?.unwrap_or(1.0);
    // Any part may have one of its own, which nobody writes and nothing reads.
    let assets =
        document.root.descendants().filter(|node| node.tag_name().name() == "asset" && Some(*node) != own);
    for other in assets {
        if self::unit(document, other)?.is_some_and(|other| other != unit) {
            return Err(document
                .error(other, format!("this part of the file is in another unit than the rest ({unit} m)"))
                .with_kind(ErrorKind::Unsupported)
                .help("export the mesh in one unit"));
        }
    }
    let turn = Matrix4::identity();
    let Some(asset) = own else { return Ok(Asset { unit, up: "Y_UP", turn }) };
    let up = child(asset, "up_axis");
    let name = up.and_then(|u| document.words(u).next()).map_or("Y_UP", |w| w.text);
    #[rustfmt::skip]
    let (up, turn) = match name {
        "X_UP" => ("X_UP", Matrix4::new(
            0.0, -1.0, 0.0, 0.0,
            1.0,  0.0, 0.0, 0.0,
            0.0,  0.0, 1.0, 0.0,
            0.0,  0.0, 0.0, 1.0,
        )),
        "Z_UP" => ("Z_UP", Matrix4::new(
            1.0,  0.0, 0.0, 0.0,
            0.0,  0.0, 1.0, 0.0,
            0.0, -1.0, 0.0, 0.0,
            0.0,  0.0, 0.0, 1.0,
        )),
        "Y_UP" => ("Y_UP", turn),
        other => {
            let message = format!("`{}` is not an axis", clipped(other));
            return Err(document.error(up.unwrap_or(asset), message).expected("X_UP, Y_UP or Z_UP"));
        }
    };
    Ok(Asset { unit, up, turn })
}

/// The length (m) of the unit that an `<asset>` says.
fn unit(document: &Document<'_>, asset: Node<'_, '_>) -> Result<Option<f64>, Error> {
    let Some((node, meter)) = child(asset, "unit").and_then(|u| Some((u, u.attribute("meter")?))) else {
        return Ok(None);
    };
    let unit = meter.trim().parse().ok().filter(|m: &f64| m.is_finite() && *m > 0.0).ok_or_else(|| {
        let message = format!("meter=\"{}\" is not a length", clipped(meter));
        document.error(node, message).expected("a number above 0, the length of the unit in metres")
    })?;
    Ok(Some(unit))
}

struct Walk<'d, 'a> {
    document: &'d Document<'a>,
    geometries: HashMap<NodeId, Rc<Geometry>>,
    instances: Vec<Instance>,
    /// Whether a geometry is instantiated as a morph.
    morphs: bool,
    visited: usize,
    corners: usize,
}

impl<'a> Walk<'_, 'a> {
    fn node(&mut self, node: Node<'a, 'a>, parent: Matrix4<f64>, depth: usize) -> Result<(), Error> {
        self.visited += 1;
        if depth > MAX_DEPTH || self.visited > MAX_VISITED {
            return Err(self
                .document
                .error(node, "nodes instantiate each other without end")
                .expected(format!("at most {MAX_DEPTH} levels and {MAX_VISITED} nodes"))
                .with_kind(ErrorKind::TooLarge));
        }
        let matrix = parent * self.transform(node)?;
        if matrix.iter().any(|v| !v.is_finite()) {
            return Err(self.document.error(node, "the transforms of the node overflow"));
        }
        for part in node.children() {
            match part.tag_name().name() {
                "instance_geometry" => self.geometry(self.document.target(part, "url")?, part, matrix)?,
                "instance_controller" => self.controller(part, matrix)?,
                _ => {}
            }
        }
        for part in node.children().filter(|c| c.tag_name().name() == "node") {
            self.node(part, matrix, depth + 1)?;
        }
        for part in node.children().filter(|c| c.tag_name().name() == "instance_node") {
            let target = self.document.target(part, "url")?;
            if target.tag_name().name() != "node" {
                return Err(self.document.error(part, "this instance is not of a node").expected("<node>"));
            }
            self.node(target, matrix, depth + 1)?;
        }
        Ok(())
    }

    /// The geometry of a controller, or of the controller that it is of: that of a skin as its `<bind_shape_matrix>` places it.
    fn controller(&mut self, part: Node<'a, 'a>, mut matrix: Matrix4<f64>) -> Result<(), Error> {
        let mut target = self.document.target(part, "url")?;
        let mut deep = 0;
        while target.tag_name().name() == "controller" {
            let skin = child(target, "skin").or_else(|| child(target, "morph"));
            self.morphs |= skin.is_some_and(|skin| skin.tag_name().name() == "morph");
            let skin = skin.filter(|_| deep < MAX_DEPTH);
            let skin = skin.ok_or_else(|| self.document.error(target, "a controller of nothing"))?;
            if let Some(bind) = child(skin, "bind_shape_matrix") {
                matrix *= Matrix4::from_row_slice(&self.document.numbers::<16>(bind)?);
            }
            if matrix.iter().any(|v| !v.is_finite()) {
                return Err(self.document.error(skin, "the transforms of the skin overflow"));
            }
            target = self.document.target(skin, "source")?;
            deep += 1;
        }
        self.geometry(target, part, matrix)
    }

    fn geometry(
        &mut self,
        target: Node<'a, 'a>,
        place: Node<'a, 'a>,
        matrix: Matrix4<f64>,
    ) -> Result<(), Error> {
        if target.tag_name().name() != "geometry" {
            let tag = clipped(target.tag_name().name());
            return Err(self.document.error(place, format!("this refers to <{tag}>")).expected("<geometry>"));
        }
        let geometry = match self.geometries.get(&target.id()) {
            Some(known) => known.clone(),
            None => {
                let read = Rc::new(Geometry::read(self.document, target)?);
                self.geometries.insert(target.id(), read.clone());
                read
            }
        };
        self.corners += geometry.corners.len();
        if self.corners > 3 * MAX_INSTANCED {
            return Err(self.document.error(place, "the scene is too large").with_kind(ErrorKind::TooLarge));
        }
        self.instances.push(Instance { geometry, matrix });
        Ok(())
    }

    /// The product of the transforms of a node, in their order.
    fn transform(&self, node: Node<'a, 'a>) -> Result<Matrix4<f64>, Error> {
        let mut all = Matrix4::identity();
        for part in node.children() {
            let document = self.document;
            all *= match part.tag_name().name() {
                "matrix" => Matrix4::from_row_slice(&document.numbers::<16>(part)?),
                "translate" => Matrix4::new_translation(&Vector3::from(document.numbers::<3>(part)?)),
                "scale" => Matrix4::new_nonuniform_scaling(&Vector3::from(document.numbers::<3>(part)?)),
                "rotate" => {
                    let [x, y, z, degrees] = document.numbers::<4>(part)?;
                    match Unit::try_new(Vector3::new(x, y, z), 0.0) {
                        Some(axis) => {
                            Rotation3::from_axis_angle(&axis, degrees.to_radians()).to_homogeneous()
                        }
                        None => Matrix4::identity(),
                    }
                }
                "lookat" => self.look_at(part)?,
                "skew" => {
                    return Err(document
                        .error(part, "<skew> is not read")
                        .with_kind(ErrorKind::Unsupported)
                        .help("apply the transforms of the nodes before exporting"));
                }
                _ => continue,
            };
        }
        Ok(all)
    }

    fn look_at(&self, part: Node<'a, 'a>) -> Result<Matrix4<f64>, Error> {
        let v = self.document.numbers::<9>(part)?;
        let [eye, target, up] = [0, 3, 6].map(|i| Vector3::new(v[i], v[i + 1], v[i + 2]));
        let bad = || self.document.error(part, "<lookat> gives no direction");
        let forward = (target - eye).try_normalize(0.0).ok_or_else(bad)?;
        let up = up.try_normalize(0.0).ok_or_else(bad)?;
        let right = forward.cross(&up).try_normalize(0.0).ok_or_else(bad)?;
        let mut m = Matrix4::identity();
        // As of `gluLookAt`: the direction that is up need not be square to that of the look.
        for (column, value) in [right, right.cross(&forward), -forward, eye].iter().enumerate() {
            m.fixed_view_mut::<3, 1>(0, column).copy_from(value);
        }
        Ok(m)
    }
}
