//! Geoms as the shapes of links.

use super::document::{Element, Said};
use super::pairs::Bits;
use super::pose::onto;
use super::tree::{Inside, Reader};
use mp_formats::error::Error;
use mp_formats::text::clipped;
use mp_geom::{Shape, TriMesh};
use nalgebra::{Isometry3, Point3, Translation3, Unit, Vector3};
use std::collections::BTreeMap;

/// What the URDF calls the ball of radius 1 of which ellipsoids are made.
const BALL: &str = "mjcf://ellipsoid";

/// A mesh of a model.
pub(super) struct MeshAsset {
    /// The name that the URDF has for it.
    name: String,
    scale: [f64; 3],
    /// From its scaled frame to that of its geom.
    pose: Isometry3<f64>,
}

/// A shape of a link.
pub(super) struct GeomShape<'m> {
    pub(super) node: Element<'m>,
    pub(super) pose: Isometry3<f64>,
    pub(super) geometry: Geometry,
}

/// A shape as URDF has it (m).
pub(super) enum Geometry {
    Cuboid([f64; 3]),
    Sphere(f64),
    Capsule([f64; 2]),
    Cylinder([f64; 2]),
    Mesh(String, [f64; 3]),
}

/// The meshes of the model by their names.
pub(super) fn assets(reader: &mut Reader<'_, '_>) -> Result<BTreeMap<String, MeshAsset>, Error> {
    let mut found = BTreeMap::new();
    for node in reader.model.inside("asset").into_iter().filter(|node| node.has_tag_name("mesh")) {
        let said = reader.said(&Inside { node, pose: Isometry3::identity(), class: 0 })?;
        let file = node.attribute("file").map(|file| match reader.compiler.strips {
            true => file.rsplit(['/', '\\']).next().unwrap_or(file).to_owned(),
            false => file.replace('\\', "/"),
        });
        let stem = file.as_ref().map(|file| {
            let name = file.rsplit('/').next().unwrap_or(file);
            name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_owned()
        });
        let name = match (node.attribute("name"), stem) {
            (Some(name), _) => name.to_owned(),
            (None, Some(stem)) => stem,
            (None, None) => reader.model.own(node, "name")?.to_owned(),
        };
        let scale = said.numbers::<3>("scale")?.unwrap_or([1.0; 3]);
        let [w, x, y, z] = said.numbers::<4>("refquat")?.unwrap_or([1.0, 0.0, 0.0, 0.0]);
        let moved =
            mp_geom::pose_from_quaternion(said.numbers::<3>("refpos")?.unwrap_or_default(), w, x, y, z);
        let moved = moved.map_err(|_| said.wrong("refquat", "w x y z, not all of them 0"))?;
        // A point v of the file is at scale · turn⁻¹ · (v − place).
        let back = moved.rotation.inverse();
        if back.angle() > 0.0 && scale.iter().any(|s| *s != scale[0]) {
            return Err(said.wrong("scale", "three equal numbers, as the mesh has a refquat"));
        }
        let place = (back * -moved.translation.vector).component_mul(&Vector3::from(scale));
        let pose = Isometry3::from_parts(Translation3::from(place), back);
        let inside = match file {
            Some(file) => mesh_file(reader, node, &file),
            None => match made(&said)? {
                Some(mesh) => {
                    let key = format!("mjcf://mesh/{name}");
                    reader.made.insert(key.clone(), mesh);
                    key
                }
                None => continue,
            },
        };
        found.insert(name, MeshAsset { name: inside, scale, pose });
    }
    Ok(found)
}

/// The file of a mesh that `node` names, from the folder of the model on: in the folder of meshes, or else, if `node` is in a file of another folder, in
/// that folder below it, as MuJoCo has it.
fn mesh_file<'m>(reader: &Reader<'_, 'm>, node: Element<'m>, file: &str) -> String {
    let meshes = reader.compiler.meshes.trim_end_matches('/');
    if file.starts_with('/') {
        return file.to_owned();
    }
    let below = |folder: &str| {
        let parts = [meshes, folder, file].into_iter().filter(|part| !part.is_empty());
        parts.collect::<Vec<_>>().join("/")
    };
    let first = below("");
    let holds = |name: &str| reader.files.holds(&reader.model.place_of(name));
    match reader.model.subfolder(node).map(|folder| below(&folder)) {
        Some(second) if !holds(&first) && holds(&second) => second,
        _ => first,
    }
}

/// The mesh of an element that names no file: the triangles that it lists, or the hull of its vertices.
fn made(said: &Said<'_, '_>) -> Result<Option<TriMesh>, Error> {
    let Some(numbers) = said.row("vertex")? else { return Ok(None) };
    let vertices: Vec<_> = numbers.chunks_exact(3).map(|v| Point3::new(v[0], v[1], v[2])).collect();
    let wrong = |key: &str, e: String| said.wrong(key, format!("the corners of a body: {e}"));
    if let Some(faces) = said.text("face") {
        let corners = faces.split_ascii_whitespace().map(|word| word.parse::<u32>());
        let corners =
            corners.collect::<Result<Vec<_>, _>>().map_err(|_| said.wrong("face", "whole numbers"))?;
        let triangles = corners.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        return TriMesh::new(vertices, triangles).map(Some).map_err(|e| wrong("face", e.to_string()));
    }
    Shape::Hull(vertices).mesh().map(Some).map_err(|e| wrong("vertex", e.to_string()))
}

impl<'m> Reader<'_, 'm> {
    /// Adds the geoms among `inside` that collide to a link.
    pub(super) fn geoms(&mut self, link: usize, inside: &[Inside<'m>]) -> Result<(), Error> {
        for at in inside.iter().filter(|at| at.node.has_tag_name("geom")) {
            let said = self.said(at)?;
            let bits = Bits::of(&said)?;
            let paired = self.paired.found(at.node, link);
            if bits.never() && !paired {
                continue;
            }
            if let Some((geometry, pose)) = self.geometry(link, &said)? {
                self.links[link].shapes.push(GeomShape { node: at.node, pose: at.pose * pose, geometry });
                self.links[link].bits = self.links[link].bits.and(bits);
            }
        }
        Ok(())
    }

    /// The shape of a geom, and its pose in the frames around it; `None` when it is left out, and a note says so.
    fn geometry(
        &mut self,
        link: usize,
        said: &Said<'_, 'm>,
    ) -> Result<Option<(Geometry, Isometry3<f64>)>, Error> {
        let (kind, mesh) = (said.text("type"), said.text("mesh"));
        let what = format!("{} of \"{}\"", kind.unwrap_or("sphere"), self.links[link].name);
        let mut pose = self.compiler.pose(said)?;
        match (kind, mesh) {
            (Some("plane" | "hfield" | "sdf"), _) => {
                self.left_out("planes, height fields and sdf are not read: name an obstacle in a robot problem in their place", &what);
                return Ok(None);
            }
            (Some("box" | "sphere" | "capsule" | "cylinder" | "ellipsoid" | "mesh") | None, Some(name)) => {
                let Some(asset) = self.meshes.get(name) else {
                    let message = format!("there is no mesh \"{}\" with a file or vertices", clipped(name));
                    return Err(said.model.error(said.node, message).help("name one of <asset>"));
                };
                let found = (Geometry::Mesh(asset.name.clone(), asset.scale), pose * asset.pose);
                if kind != Some("mesh") {
                    self.left_out("meshes are taken in place of the shapes that are fitted to them", &what);
                }
                return Ok(Some(found));
            }
            _ => {}
        }
        let mut size = [0.0; 3];
        let given = said.joined_row("size")?;
        size.iter_mut().zip(&given).for_each(|(size, given)| *size = *given);
        let long = matches!(kind, Some("capsule" | "cylinder" | "box" | "ellipsoid"));
        if let Some([a, b, c, d, e, f]) = said.numbers::<6>("fromto")?.filter(|_| long) {
            let (from, to) = (Vector3::new(a, b, c), Vector3::new(d, e, f));
            let axis = Unit::try_new(from - to, 1e-10)
                .ok_or_else(|| said.wrong("fromto", "two points that differ"))?;
            let half = 0.5 * (to - from).norm();
            size = if matches!(kind, Some("capsule" | "cylinder")) {
                [size[0], half, 0.0]
            } else {
                [size[0], size[0], half]
            };
            pose = Isometry3::from_parts(Translation3::from(0.5 * (from + to)), onto(axis));
        }
        let needed = match kind {
            Some("sphere") | None => 1,
            Some("capsule" | "cylinder") => 2,
            Some("box" | "ellipsoid") => 3,
            _ => return Err(said.wrong("type", "box, sphere, capsule, cylinder, ellipsoid, mesh or plane")),
        };
        if size[..needed].iter().any(|x| *x <= 0.0) {
            let expected = format!("{needed} numbers above 0: half of its lengths (m)");
            return Err(said.wrong("size", expected));
        }
        let [x, y, z] = size;
        let geometry = match kind {
            Some("box") => Geometry::Cuboid([2.0 * x, 2.0 * y, 2.0 * z]),
            Some("capsule") => Geometry::Capsule([x, 2.0 * y]),
            Some("cylinder") => Geometry::Cylinder([x, 2.0 * y]),
            Some("ellipsoid") => {
                let ball = Shape::primitive("sphere", &[1.0]).and_then(|ball| ball.mesh().ok());
                ball.into_iter().for_each(|ball| drop(self.made.insert(BALL.to_owned(), ball)));
                Geometry::Mesh(BALL.to_owned(), size)
            }
            _ => Geometry::Sphere(x),
        };
        Ok(Some((geometry, pose)))
    }
}
