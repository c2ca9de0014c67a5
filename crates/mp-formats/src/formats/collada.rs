//! COLLADA 1.4 and 1.5: the meshes of the visual scene. See `docs/formats/meshes.md`.
//!
//! Node transforms are applied, then the unit of length. Then the up axis is turned to Y, as by assimp, the importer of
//! OMPL.app, so that its problem files mean the same here; or it is not, as for robot descriptions.

pub mod center;
mod document;
mod geometry;
mod primitive;
mod scene;
#[cfg(test)]
mod tests;

use crate::error::{Error, ErrorKind};
use crate::mesh::{Axes, Reading, build, mesh_error};
use document::Document;
use geometry::Geometry;
use mp_geom::TriMesh;
use mp_stop::Interrupt;
use nalgebra::{Matrix4, Point3};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::rc::Rc;

/// The most triangles and vertices that the instances of a scene may have together.
const MAX_INSTANCED: usize = 50_000_000;

/// A geometry and its place in the scene.
#[derive(Debug)]
pub(crate) struct Instance {
    geometry: Rc<Geometry>,
    /// From the frame of the geometry to the world.
    matrix: Matrix4<f64>,
}

/// The visual scene of a file.
#[derive(Debug)]
pub struct Scene {
    instances: Vec<Instance>,
    /// What the file says of its coordinates.
    pub(crate) asset: scene::Asset,
    /// Whether there are morphs.
    morphs: bool,
}

pub(crate) fn begins(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(4096)];
    let body = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    body.trim_ascii_start().starts_with(b"<") && head.windows(8).any(|word| word == b"<COLLADA")
}

/// Reads `bytes`, the content of a COLLADA file that errors call `file`: all meshes of its visual scene, in
/// metres, Y up, as one mesh.
pub(crate) fn read(file: &str, bytes: &[u8], reading: &mut Reading<'_>) -> Result<TriMesh, Error> {
    let scene = Scene::parse(file, bytes, reading.axes, reading.interrupt.clone())?;
    scene.remarks(reading.axes).iter().for_each(|remark| (reading.remark)(remark));
    scene.to_mesh(file)
}

impl Scene {
    /// Reads `bytes`, the content of a file that errors call `file`.
    ///
    /// # Errors
    /// [`Error`] when it is no COLLADA, or `interrupt` says to end.
    pub fn parse(file: &str, bytes: &[u8], axes: Axes, interrupt: Interrupt) -> Result<Self, Error> {
        let text = &*crate::xml::text(file, bytes)?;
        let options = roxmltree::ParsingOptions { nodes_limit: document::MAX_NODES, ..Default::default() };
        let xml = roxmltree::Document::parse_with_options(text, options)
            .map_err(|e| document::xml_error(file, text, &e))?;
        let document = Document::new(file, text, &xml, interrupt)?;
        let asset = scene::asset(&document)?;
        let (instances, morphs) = scene::instances(&document, asset.root(axes))?;
        Ok(Self { instances, asset, morphs })
    }

    /// What was made of axes, unit and morphs, for people.
    pub fn remarks(&self, axes: Axes) -> Vec<String> {
        let scene::Asset { unit, up, .. } = self.asset;
        let turned = match axes {
            Axes::OfFile => Some(format!("COLLADA with {up}, whose axes stay as they are")),
            Axes::YUp if up == "Y_UP" => None,
            Axes::YUp => Some(format!(
                "COLLADA with {up}, turned so that Y is up; robots in URDF and problems in TOML keep the axes of a file"
            )),
        };
        let scaled = (unit != 1.0)
            .then(|| format!("COLLADA in units of {unit} m, by which coordinates are multiplied"));
        let morphs = self.morphs.then(|| "morphs are not applied: meshes stay as they are stored".to_owned());
        turned.into_iter().chain(scaled).chain(morphs).collect()
    }

    /// All instances in one mesh.
    ///
    /// # Errors
    /// When they have no triangles, or too many.
    pub fn to_mesh(&self, file: &str) -> Result<TriMesh, Error> {
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        let mut meshes: HashMap<*const Geometry, TriMesh> = HashMap::new();
        for Instance { geometry, matrix } in &self.instances {
            if geometry.polygons().next().is_none() {
                continue;
            }
            let mesh = match meshes.entry(Rc::as_ptr(geometry)) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => {
                    new.insert(build(file, geometry.positions().to_vec(), geometry.polygons())?)
                }
            };
            if vertices.len() + mesh.vertices().len() > MAX_INSTANCED
                || triangles.len() + mesh.triangles().len() > MAX_INSTANCED
            {
                let message = format!("the scene has more than {MAX_INSTANCED} triangles or vertices");
                return Err(Error::new(ErrorKind::TooLarge, file, message).help("simplify the meshes"));
            }
            let base = vertices.len() as u32; // at most MAX_INSTANCED
            vertices.extend(mesh.vertices().iter().map(|p| transformed(matrix, p)));
            // A mirror turns triangles over.
            let mirrored = matrix.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
            let order = if mirrored { [0, 2, 1] } else { [0, 1, 2] };
            triangles.extend(mesh.triangles().iter().map(|t| order.map(|k| t[k] + base)));
        }
        TriMesh::new(vertices, triangles).map_err(|e| mesh_error(file, &e))
    }
}

/// `p` transformed by the affine part of `m` only, as the importer does.
fn transformed(m: &Matrix4<f64>, p: &Point3<f64>) -> Point3<f64> {
    Point3::from(m.fixed_view::<3, 3>(0, 0) * p.coords + m.fixed_view::<3, 1>(0, 3))
}
