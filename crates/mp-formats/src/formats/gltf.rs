//! glTF 2.0, text and binary: the triangles of the scene. See `docs/formats/meshes.md`.

use crate::error::{Error, ErrorKind};
use crate::mesh::{Axes, LEFT_OUT, Reading, mesh_error};
use crate::text::clipped;
use mp_geom::TriMesh;
use mp_stop::Interrupt;
use nalgebra::{Matrix3, Matrix4, Point3, Quaternion, UnitQuaternion, Vector3};
use serde::Deserialize;
use std::collections::HashMap;

/// The most triangles and vertices of a scene.
const MAX_INSTANCED: usize = 50_000_000;
/// Nodes may be nested this deep.
const MAX_DEPTH: usize = 128;
/// The first bytes of binary files, and the names of their parts.
const MAGIC: &[u8; 4] = b"glTF";
const JSON: &[u8] = b"JSON";
const BIN: &[u8] = b"BIN\0";

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
#[derive(Default)]
struct Document {
    extensions_required: Vec<String>,
    extensions_used: Vec<String>,
    scene: usize,
    scenes: Vec<Scene>,
    nodes: Vec<Node>,
    meshes: Vec<Mesh>,
    skins: Vec<Skin>,
    accessors: Vec<Accessor>,
    buffer_views: Vec<View>,
    buffers: Vec<Buffer>,
}

#[derive(Deserialize)]
struct Scene {
    #[serde(default)]
    nodes: Vec<usize>,
}

#[derive(Deserialize)]
struct Node {
    #[serde(default)]
    children: Vec<usize>,
    mesh: Option<usize>,
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
    /// How much of each target is in its mesh, in place of what that says.
    weights: Option<Vec<f64>>,
    skin: Option<usize>,
    #[serde(default)]
    extensions: HashMap<String, serde::de::IgnoredAny>,
}

/// The nodes that move the vertices of a mesh.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Skin {
    joints: Vec<usize>,
    /// From the mesh to each joint; without, all are where the mesh is.
    inverse_bind_matrices: Option<usize>,
}

#[derive(Deserialize)]
struct Mesh {
    primitives: Vec<Primitive>,
    #[serde(default)]
    weights: Vec<f64>,
}

#[derive(Deserialize)]
struct Primitive {
    attributes: HashMap<String, usize>,
    indices: Option<usize>,
    mode: Option<u32>,
    /// What is added to the attributes, times the weights.
    #[serde(default)]
    targets: Vec<HashMap<String, usize>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: Option<usize>,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    count: usize,
    #[serde(rename = "type")]
    kind: String,
    sparse: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct View {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

#[derive(Deserialize)]
struct Buffer {
    uri: Option<String>,
}

/// Whether bytes begin like a binary file.
pub(crate) fn begins(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Reads `bytes`, the content of a file that errors call `file`: all triangles of its scene, at the places of their nodes, as one mesh.
pub(crate) fn read(file: &str, bytes: &[u8], reading: &mut Reading<'_>) -> Result<TriMesh, Error> {
    let (json, rest) = if begins(bytes) { parts(file, bytes)? } else { (bytes, None) };
    let text = crate::files::decode(file, json)?;
    let document: Document = crate::json::parse(file, text, "glTF 2.0", HELP)?;
    let changes = |name: &&String| !NEUTRAL.iter().any(|known| name.starts_with(known));
    if let Some(extension) = document.extensions_required.iter().find(changes) {
        return Err(needed(file, extension));
    }
    let mut scene = Triangles {
        file,
        document: &document,
        buffers: Vec::new(),
        vertices: Vec::new(),
        triangles: Vec::new(),
        left_out: false,
    };
    for (i, buffer) in document.buffers.iter().enumerate() {
        let bytes = match &buffer.uri {
            None => rest
                .filter(|_| i == 0)
                .ok_or_else(|| scene.wrong(format!("buffer {i} has no bytes")))?
                .to_vec(),
            Some(uri) => match uri.strip_prefix("data:").and_then(|data| data.split_once(";base64,")) {
                Some((_, data)) => base64(data)
                    .ok_or_else(|| scene.wrong(format!("the bytes of buffer {i} are not base64")))?,
                None => (reading.beside)(uri)?,
            },
        };
        scene.buffers.push(bytes);
    }
    scene.collect(reading)?;
    let remark = match reading.axes {
        Axes::OfFile => Some("glTF, in which y is up: its axes stay as they are"),
        Axes::YUp => None,
    };
    remark.into_iter().for_each(|remark| (reading.remark)(remark));
    if scene.left_out {
        (reading.remark)(LEFT_OUT);
    }
    // Files say that they can be read without these.
    for extension in document.extensions_used.iter().filter(changes) {
        (reading.remark)(&format!("the extension {} is not read", clipped(extension)));
    }
    // Corners at seams of colour are there once for each side.
    let mesh = TriMesh::new(scene.vertices, scene.triangles).map_err(|e| mesh_error(file, &e))?;
    let soup: Vec<_> = (0..mesh.triangles().len()).map(|i| mesh.triangle(i)).collect();
    let mesh = TriMesh::from_soup_until(&soup, &reading.interrupt).map_err(|_| Error::interrupted(file))?;
    mesh.map_err(|e| mesh_error(file, &e))
}

const HELP: &str = "export the mesh again, as glTF 2.0";

/// Extensions by which positions are stored in other ways.
const COMPRESSED: [&str; 4] = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_mesh_quantization",
];

/// How extensions begin that leave triangles as they are: they are about looks, lights, and words about the file.
const NEUTRAL: [&str; 13] = [
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "KHR_techniques_",
    "KHR_xmp",
    "KHR_animation_",
    "EXT_texture_",
    "EXT_lights_",
    "EXT_materials_",
    "MSFT_texture_",
    "MSFT_packing_",
    "ADOBE_materials_",
    "FB_ngon_encoding",
];

/// The extension by which a mesh is in several places of a node: they would be missing.
const INSTANCES: &str = "EXT_mesh_gpu_instancing";

/// The error of an extension without which a file says that it cannot be read.
fn needed(file: &str, extension: &str) -> Error {
    let (message, help) = match COMPRESSED.contains(&extension) {
        true => (
            format!("the mesh is compressed by {extension}, which is not read"),
            "export it without compression".to_owned(),
        ),
        false => (
            format!("the file needs the extension {}, which is not read", clipped(extension)),
            "export it without this extension".to_owned(),
        ),
    };
    Error::new(ErrorKind::Unsupported, file, message).help(help)
}

/// A vertex, whose frame is at `place`.
fn placed(place: &Matrix4<f64>, p: &[f64]) -> Point3<f64> {
    let (turn, moved) = (place.fixed_view::<3, 3>(0, 0), place.fixed_view::<3, 1>(0, 3));
    Point3::from(turn * Vector3::new(p[0], p[1], p[2]) + moved)
}

/// The JSON of a binary file, and the bytes after it.
fn parts<'a>(file: &str, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>), Error> {
    let wrong = |message: &str| Error::new(ErrorKind::Format, file, message).help(HELP);
    let number = |at: usize| {
        let four = bytes.get(at..at + 4).and_then(|four| four.try_into().ok());
        four.map(|four| u32::from_le_bytes(four) as usize).ok_or_else(|| wrong("the file is cut short"))
    };
    let version = number(4)?;
    if version != 2 {
        return Err(wrong(&format!("this is binary glTF of version {version}, not 2")));
    }
    let part = |at: usize, name: &[u8]| {
        let length = number(at)?;
        let body = bytes.get(at + 8..).and_then(|rest| rest.get(..length));
        let body = body.ok_or_else(|| wrong("a part of the file is longer than the file"))?;
        match &bytes[at + 4..at + 8] == name {
            true => Ok((body, at + 8 + length)),
            false => {
                Err(wrong(&format!("the part at byte {at} is not {}", String::from_utf8_lossy(&name[..3]))))
            }
        }
    };
    let (json, end) = part(12, JSON)?;
    let rest = if end < bytes.len() { Some(part(end, BIN)?.0) } else { None };
    Ok((json, rest))
}

/// Bytes of base64, of which some writers make lines; `None` when the text is none.
fn base64(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count) = (0u32, 0);
    for c in text.trim_end().trim_end_matches('=').bytes().filter(|c| !c.is_ascii_whitespace()) {
        let value = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        (bits, count) = (bits << 6 | u32::from(value), count + 6);
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    Some(bytes)
}

struct Triangles<'a> {
    file: &'a str,
    document: &'a Document,
    buffers: Vec<Vec<u8>>,
    vertices: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
    /// Whether points or lines were left out.
    left_out: bool,
}

impl Triangles<'_> {
    fn wrong(&self, message: impl Into<String>) -> Error {
        Error::new(ErrorKind::Content, self.file, message).help(HELP)
    }

    /// Takes the meshes of all nodes of the scene.
    fn collect(&mut self, reading: &mut Reading<'_>) -> Result<(), Error> {
        let Document { scene, scenes, nodes, .. } = self.document;
        let children: std::collections::HashSet<_> = nodes.iter().flat_map(|node| &node.children).collect();
        let roots = match scenes.get(*scene) {
            Some(scene) => scene.nodes.clone(),
            None if scenes.is_empty() => (0..nodes.len()).filter(|i| !children.contains(i)).collect(),
            None => return Err(self.wrong(format!("there is no scene {scene}"))),
        };
        let mut places = vec![None; nodes.len()];
        let mut order = Vec::new();
        let mut stack: Vec<_> = roots.iter().rev().map(|&node| (node, Matrix4::identity(), 1)).collect();
        while let Some((i, around, depth)) = stack.pop() {
            if reading.interrupt.ask() {
                return Err(Error::interrupted(self.file));
            }
            let node = nodes.get(i).ok_or_else(|| self.wrong(format!("there is no node {i}")))?;
            if places[i].is_some() || depth > MAX_DEPTH {
                return Err(
                    self.wrong(format!("node {i} is in two places, or nested more than {MAX_DEPTH} deep"))
                );
            }
            let place = around * self.matrix(i, node)?;
            places[i] = Some(place);
            order.push((i, node, place));
            stack.extend(node.children.iter().rev().map(|&child| (child, place, depth + 1)));
        }
        let shows = order.iter().any(|(_, node, _)| node.mesh.is_some());
        if !shows && !self.document.meshes.is_empty() {
            return Err(self.wrong("the scene shows no mesh, and the file has some"));
        }
        for (i, node, place) in order {
            if node.extensions.contains_key(INSTANCES) {
                return Err(needed(self.file, INSTANCES));
            }
            let Some(mesh) = node.mesh else { continue };
            let all = self.document.meshes.get(mesh);
            let all =
                all.ok_or_else(|| self.wrong(format!("node {i} has the mesh {mesh}, which is not there")))?;
            let weights = node.weights.as_ref().unwrap_or(&all.weights);
            let interrupt = &mut reading.interrupt;
            let joints = node.skin.map(|skin| self.joints(skin, &places, interrupt)).transpose()?;
            for (k, primitive) in all.primitives.iter().enumerate() {
                let what = format!("primitive {k} of mesh {mesh}");
                self.add(&what, primitive, weights, &place, joints.as_deref(), interrupt)?;
            }
        }
        Ok(())
    }

    /// For each joint of a skin, from the mesh to where the joint takes it.
    fn joints(
        &self,
        number: usize,
        places: &[Option<Matrix4<f64>>],
        interrupt: &mut Interrupt,
    ) -> Result<Vec<Matrix4<f64>>, Error> {
        let wrong = |what: &str| self.wrong(format!("skin {number} {what}"));
        let skin = self.document.skins.get(number).ok_or_else(|| wrong("is not there"))?;
        let bind =
            skin.inverse_bind_matrices.map(|bind| self.numbers(bind, "MAT4", interrupt)).transpose()?;
        let joint = |(k, &joint): (usize, &usize)| {
            let place = places.get(joint).copied().flatten();
            let place = place.ok_or_else(|| wrong("has a joint that is not in the scene"))?;
            let Some(bind) = &bind else { return Ok(place) };
            let bind = bind.get(16 * k..16 * k + 16);
            Ok(place
                * Matrix4::from_column_slice(bind.ok_or_else(|| wrong("has more joints than matrices"))?))
        };
        skin.joints.iter().enumerate().map(joint).collect()
    }

    /// Where joints take vertices: for each the mean of its places, by the weights of the joints.
    fn skinned(
        &self,
        what: &str,
        primitive: &Primitive,
        joints: &[Matrix4<f64>],
        positions: &[f64],
        interrupt: &mut Interrupt,
    ) -> Result<Vec<Point3<f64>>, Error> {
        let mut sums = vec![(0.0, Vector3::zeros()); positions.len() / 3];
        let sets = (0..).map_while(|set| {
            let accessor = |name| primitive.attributes.get(&format!("{name}_{set}")).copied();
            accessor("JOINTS").zip(accessor("WEIGHTS"))
        });
        for (numbers, weights) in sets {
            let (numbers, weights) =
                (self.numbers(numbers, "VEC4", interrupt)?, self.numbers(weights, "VEC4", interrupt)?);
            for (k, (joint, weight)) in numbers.iter().zip(weights).enumerate().take(4 * sums.len()) {
                let joint = joints.get(*joint as usize).filter(|_| weight >= 0.0);
                let joint =
                    joint.ok_or_else(|| self.wrong(format!("{what} has a joint that its skin has not")))?;
                sums[k / 4].0 += weight;
                sums[k / 4].1 += placed(joint, &positions[3 * (k / 4)..]).coords * weight;
            }
        }
        let mean = |(weight, sum): (f64, Vector3<f64>)| (weight > 0.0).then(|| Point3::from(sum / weight));
        let means = sums.into_iter().map(mean).collect::<Option<_>>();
        means.ok_or_else(|| self.wrong(format!("{what} has vertices that no joint of its skin moves")))
    }

    fn matrix(&self, i: usize, node: &Node) -> Result<Matrix4<f64>, Error> {
        let matrix = match node.matrix {
            Some(columns) => Matrix4::from_column_slice(&columns),
            None => {
                let [x, y, z, w] = node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
                let turn = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
                let scale = Matrix3::from_diagonal(&Vector3::from(node.scale.unwrap_or([1.0; 3])));
                let mut matrix = Matrix4::identity();
                matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&(turn.to_rotation_matrix().matrix() * scale));
                matrix
                    .fixed_view_mut::<3, 1>(0, 3)
                    .copy_from(&Vector3::from(node.translation.unwrap_or_default()));
                matrix
            }
        };
        match matrix.iter().all(|x| x.is_finite()) {
            true => Ok(matrix),
            false => {
                Err(self.wrong(format!("the place of node {i} is no matrix, or its rotation has length 0")))
            }
        }
    }

    /// Adds a primitive, whose frame is at `place`, with so much of each of its targets. Where there are joints, they alone say where it is.
    fn add(
        &mut self,
        what: &str,
        primitive: &Primitive,
        weights: &[f64],
        place: &Matrix4<f64>,
        joints: Option<&[Matrix4<f64>]>,
        interrupt: &mut Interrupt,
    ) -> Result<(), Error> {
        let mode = primitive.mode.unwrap_or(4);
        if !(4..=6).contains(&mode) {
            self.left_out = true;
            return Ok(());
        }
        let positions = primitive.attributes.get("POSITION");
        let &positions = positions.ok_or_else(|| self.wrong(format!("{what} has no POSITION")))?;
        let mut positions = self.numbers(positions, "VEC3", interrupt)?;
        let count = positions.len() / 3;
        for (target, &weight) in primitive.targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            let Some(&moved) = target.get("POSITION") else { continue };
            let moved = self.numbers(moved, "VEC3", interrupt)?;
            if moved.len() != positions.len() {
                return Err(
                    self.wrong(format!("{what} has a target of {} vertices, and {count}", moved.len() / 3))
                );
            }
            positions.iter_mut().zip(&moved).for_each(|(x, moved)| *x += weight * moved);
        }
        let corners: Vec<u32> = match primitive.indices {
            Some(accessor) => {
                self.numbers(accessor, "SCALAR", interrupt)?.into_iter().map(|i| i as u32).collect()
            }
            None => (0..count as u32).collect(),
        };
        if let Some(corner) = corners.iter().find(|corner| **corner as usize >= count) {
            return Err(self.wrong(format!("{what} has the vertex {corner}, and {count} vertices")));
        }
        if self.vertices.len() + count > MAX_INSTANCED || self.triangles.len() + corners.len() > MAX_INSTANCED
        {
            let message = format!("the scene has more than {MAX_INSTANCED} triangles or vertices");
            return Err(Error::new(ErrorKind::TooLarge, self.file, message).help("simplify the meshes"));
        }
        let base = self.vertices.len() as u32; // at most MAX_INSTANCED
        match joints {
            Some(joints) => {
                let points = self.skinned(what, primitive, joints, &positions, interrupt)?;
                self.vertices.extend(points);
            }
            None => self.vertices.extend(positions.chunks_exact(3).map(|p| placed(place, p))),
        }
        let triangles: Vec<[u32; 3]> = match mode {
            4 => corners.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
            5 => corners.windows(3).enumerate().map(|(i, t)| [t[0], t[1 + i % 2], t[2 - i % 2]]).collect(),
            _ => corners.windows(2).skip(1).map(|t| [corners[0], t[0], t[1]]).collect(),
        };
        // A mirror turns triangles over.
        let first = joints.and_then(<[_]>::first).unwrap_or(place);
        let mirrored = first.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
        let order = if mirrored { [0, 2, 1] } else { [0, 1, 2] };
        self.triangles.extend(triangles.into_iter().map(|t| order.map(|k| t[k] + base)));
        Ok(())
    }

    /// The numbers of an accessor of this kind: coordinates, or indices of vertices.
    fn numbers(&self, number: usize, kind: &str, interrupt: &mut Interrupt) -> Result<Vec<f64>, Error> {
        let wrong = |what: &str| self.wrong(format!("accessor {number} {what}"));
        let accessor = self.document.accessors.get(number).ok_or_else(|| wrong("is not there"))?;
        let (width, columns) = match (kind, accessor.component_type) {
            ("VEC3", 5126) => (4, 3),
            ("VEC4", 5126) => (4, 4),
            ("VEC4", 5121) => (1, 4),
            ("VEC4", 5123) => (2, 4),
            ("MAT4", 5126) => (4, 16),
            ("SCALAR", 5121) => (1, 1),
            ("SCALAR", 5123) => (2, 1),
            ("SCALAR", 5125) => (4, 1),
            _ => {
                return Err(wrong(
                    "has numbers of another type: positions are floats, and indices whole numbers above 0",
                ));
            }
        };
        if accessor.kind != kind {
            return Err(wrong(&format!("is {}, not {kind}", clipped(&accessor.kind))));
        }
        let view = accessor.buffer_view.filter(|_| accessor.sparse.is_none());
        let view = view.ok_or_else(|| wrong("is sparse, or has no buffer view, which is not read"))?;
        let view = self
            .document
            .buffer_views
            .get(view)
            .ok_or_else(|| wrong("has a buffer view that is not there"))?;
        let buffer = self.buffers.get(view.buffer).ok_or_else(|| wrong("has a buffer that is not there"))?;
        let bytes = buffer.get(view.byte_offset..).and_then(|rest| rest.get(..view.byte_length));
        let bytes = bytes.and_then(|bytes| bytes.get(accessor.byte_offset..));
        let (size, stride) = (width * columns, view.byte_stride.unwrap_or(width * columns));
        let needed = accessor.count.saturating_sub(1).checked_mul(stride).and_then(|n| n.checked_add(size));
        let bytes =
            bytes.filter(|bytes| stride >= size && needed.is_some_and(|needed| needed <= bytes.len()));
        let bytes = bytes.ok_or_else(|| wrong("is longer than its bytes"))?;
        let four = |b: &[u8]| [b[0], b[1], b[2], b[3]];
        let read = |b: &[u8]| match accessor.component_type {
            5126 => f64::from(f32::from_le_bytes(four(b))),
            5121 => f64::from(b[0]),
            5123 => f64::from(u16::from_le_bytes([b[0], b[1]])),
            _ => f64::from(u32::from_le_bytes(four(b))),
        };
        let mut numbers = Vec::with_capacity(accessor.count * columns);
        for i in 0..accessor.count {
            if i % 1024 == 0 && interrupt.ask() {
                return Err(Error::interrupted(self.file));
            }
            numbers.extend(bytes[i * stride..][..size].chunks_exact(width).map(read));
        }
        Ok(numbers)
    }
}

#[cfg(test)]
mod tests;
