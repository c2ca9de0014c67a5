//! Robot problems and the files they name.

use super::{ObstacleEntry, ObstacleShape, RobotFile, RobotPart};
use crate::error::Error;
use crate::files::{Disk, Files, MAX_TEXT_BYTES, stem};
use crate::formats::Content;
use crate::mesh::{Axes, read_mesh_with, solid_mesh, stand_in};
use crate::problem::{MAX_COORDINATE, PlacedBody, vertex_beyond};
use crate::toml_problem::TomlText;
use mp_geom::{TriMesh, pose_from_six, primitives};
use nalgebra::Isometry3;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Segments of the mesh around a cylinder; the mesh contains the cylinder.
const SEGMENTS: u32 = 32;

/// An arm, obstacles, a start and goals; all files are read except the meshes of the robot.
#[derive(Clone, Debug)]
pub struct RobotProblem {
    /// The name of the file, without extension.
    pub name: String,
    /// The content of the file.
    pub file: RobotFile,
    /// Where the URDF is.
    pub urdf_file: PathBuf,
    /// The content of the URDF.
    pub urdf: String,
    /// The content of the SRDF.
    pub srdf: Option<String>,
    /// The name of an SRDF beside the URDF, if the problem names none.
    pub srdf_beside: Option<String>,
    /// The folder that `package://` means.
    pub packages: Option<PathBuf>,
    /// The obstacles. Spheres and cylinders are meshes that contain them.
    pub obstacles: Vec<PlacedBody>,
}

impl RobotProblem {
    /// The pose of the root link in the world.
    #[must_use]
    pub fn base(&self) -> Isometry3<f64> {
        pose_from_six(self.file.base)
    }

    /// Whether both problems have the same robot: of the same files with the same descriptions, at the same place, with the same limits,
    /// none of which are for a start.
    #[must_use]
    pub fn same_robot(&self, other: &Self) -> bool {
        let (a, b) = (&self.file, &other.file);
        (&self.urdf_file, &self.urdf, &self.srdf) == (&other.urdf_file, &other.urdf, &other.srdf)
            && (&self.packages, a.base, a.floating) == (&other.packages, b.base, b.floating)
            && (&a.limits, &self.srdf_beside) == (&b.limits, &other.srdf_beside)
            && (a.limit_tolerance, b.limit_tolerance, a.solid) == (0.0, 0.0, b.solid)
    }

    /// Reads a robot problem, its URDF and SRDF and the meshes of obstacles. File names are relative to the problem
    /// file.
    ///
    /// # Errors
    /// [`Error`] when a file cannot be read or makes no sense, with file, line and column.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::load_from(&Disk, path.as_ref())
    }

    /// As [`load`](Self::load), with the files read through `files`. The meshes of the robot itself are read later: by
    /// [`mesh_from`](Self::mesh_from).
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_from(files: &dyn Files, path: &Path) -> Result<Self, Error> {
        Self::of_bytes(files, path, &files.read(path, MAX_TEXT_BYTES)?)
    }

    /// As [`load_from`](Self::load_from), from the content of the file.
    pub(crate) fn of_bytes(files: &dyn Files, path: &Path, bytes: &[u8]) -> Result<Self, Error> {
        let file = RobotFile::parse(&path.display().to_string(), bytes)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let text = |part: RobotPart, name: &str| {
            let place = folder.join(name);
            match read_robot_text(files, &place) {
                Ok(text) => Ok((place, text)),
                Err(e) => Err(unusable(&file, part, &e)),
            }
        };
        let (urdf_file, urdf) = text(RobotPart::Urdf, &file.urdf)?;
        let srdf = match &file.srdf {
            Some(name) => Some(text(RobotPart::Srdf, name)?.1),
            None => None,
        };
        let srdf_beside = if srdf.is_none() { srdf_beside(files, &urdf_file) } else { None };
        let (mut obstacles, mut figures) = (Vec::new(), Figures::new(files, path));
        for entry in &file.obstacles {
            let (from, mesh) = figures.mesh(&file.source(), entry)?;
            let (name, pose) = (entry.name.clone(), pose_from_six(entry.pose));
            obstacles.push(PlacedBody { name, file: from, mesh, pose });
        }
        let packages = file.packages.as_ref().map(|name| folder.join(name));
        Ok(Self { name: stem(path), file, urdf_file, urdf, srdf, srdf_beside, packages, obstacles })
    }
}

/// The text of a URDF or SRDF, in the encoding that it declares.
///
/// # Errors
/// [`Error`] when it cannot be read, is no text, or has elements that would take hours to read.
pub fn read_robot_text(files: &dyn Files, path: &Path) -> Result<String, Error> {
    let bytes = files.read(path, MAX_TEXT_BYTES)?;
    Ok(crate::xml::text(&path.display().to_string(), &bytes)?.into_owned())
}

/// The name of an SRDF in the folder of a URDF: the one of the same name, or else the first.
fn srdf_beside(files: &dyn Files, urdf: &Path) -> Option<String> {
    let own = urdf.with_extension(Content::RobotSemantics.ending());
    if files.holds(&own) {
        return own.file_name().map(|name| name.to_string_lossy().into_owned());
    }
    let names = files.names_in(urdf.parent().unwrap_or(Path::new("")));
    let is_one =
        |name: &String| Content::of(Path::new(name)).any(|content| content == Content::RobotSemantics);
    names.into_iter().find(is_one)
}

/// Makes the meshes of obstacles.
pub(crate) struct Figures<'a> {
    files: &'a dyn Files,
    /// The file of the problem.
    path: &'a Path,
    /// The meshes read so far, with their files.
    read: Vec<(PathBuf, TriMesh)>,
    /// Those of them that are solids.
    solids: Vec<(PathBuf, TriMesh)>,
    /// The primitives made so far, by the bits of their sizes: equal ones share a mesh.
    made: HashMap<(&'static str, [u64; 3]), TriMesh>,
    /// A unit sphere, and the radius of the ball inside, once there is a sphere.
    ball: Option<(f64, TriMesh)>,
}

impl<'a> Figures<'a> {
    /// For the problem in the file `path`, to which names are relative.
    pub(crate) fn new(files: &'a dyn Files, path: &'a Path) -> Self {
        Self { files, path, read: Vec::new(), solids: Vec::new(), made: HashMap::new(), ball: None }
    }

    /// The file and the mesh of an obstacle. Spheres and cylinders become meshes that contain them.
    pub(crate) fn mesh(
        &mut self,
        source: &TomlText<'_>,
        entry: &ObstacleEntry,
    ) -> Result<(PathBuf, TriMesh), Error> {
        let fault = |message: &str, help: &str| source.error(&entry.span, message).help(help);
        let (from, mesh) = match &entry.shape {
            ObstacleShape::Box(sizes) => (self.path.to_owned(), self.primitive("box", *sizes, &fault)?),
            ObstacleShape::Sphere(radius) => {
                (self.path.to_owned(), self.primitive("sphere", [*radius, 0.0, 0.0], &fault)?)
            }
            ObstacleShape::Cylinder([radius, height]) => {
                (self.path.to_owned(), self.primitive("cylinder", [*radius, *height, 0.0], &fault)?)
            }
            ObstacleShape::Mesh(name) => {
                let place = self.path.parent().unwrap_or(Path::new("")).join(name);
                let seen =
                    |read: &[(PathBuf, TriMesh)]| read.iter().find(|(file, _)| *file == place).cloned();
                let unusable = |e: Error| {
                    let message = format!("the mesh of {} is not usable: {e}", entry.name);
                    fault(&message, e.remedy_of_named_file()).with_kind(e.kind())
                };
                // Many obstacles often share a mesh: read it once.
                let known = match seen(&self.read) {
                    Some(known) => known,
                    None => {
                        let mesh = read_mesh_with(self.files, &place, Axes::OfFile).map_err(unusable)?;
                        let known = (place.clone(), mesh);
                        self.read.push(known.clone());
                        known
                    }
                };
                match (entry.solid && !self.files.only_reads(), seen(&self.solids)) {
                    (false, _) => known,
                    (true, Some(solid)) => solid,
                    (true, None) => {
                        let file = place.display().to_string();
                        let solid = (place.clone(), solid_mesh(&file, known.1).map_err(unusable)?);
                        self.solids.push(solid.clone());
                        solid
                    }
                }
            }
        };
        if vertex_beyond(&mesh).is_some() {
            let message = format!("{} has a vertex beyond {MAX_COORDINATE:e} m", entry.name);
            return Err(fault(&message, "coordinates are metres: scale the mesh"));
        }
        Ok((from, mesh))
    }

    /// The mesh of a primitive with these sizes: sides; a radius; a radius and a height.
    fn primitive(
        &mut self,
        kind: &'static str,
        sizes @ [x, y, z]: [f64; 3],
        fault: &dyn Fn(&str, &str) -> Error,
    ) -> Result<TriMesh, Error> {
        if self.files.interrupt().ask() {
            return Err(Error::interrupted(self.path.display()));
        }
        if self.files.only_reads() {
            return stand_in(&self.path.display().to_string());
        }
        let key = (kind, sizes.map(f64::to_bits));
        if let Some(known) = self.made.get(&key) {
            return Ok(known.clone());
        }
        let made = match kind {
            "box" => primitives::cuboid(x, y, z),
            "sphere" => self.ball(x),
            _ => {
                let around = x / mp_math::cos(std::f64::consts::PI / f64::from(SEGMENTS));
                primitives::cylinder(around, y, SEGMENTS)
            }
        };
        let made = made.map_err(|e| fault(&e.to_string(), "give sizes in metres, not too small"))?;
        self.made.insert(key, made.clone());
        Ok(made)
    }

    /// A mesh around a ball.
    fn ball(&mut self, radius: f64) -> Result<TriMesh, primitives::PrimitiveError> {
        let (inner, unit) = match &self.ball {
            Some(known) => known,
            None => self.ball.insert(unit_sphere()?),
        };
        Ok(unit.scaled([primitives::positive("radius", radius / inner)?; 3])?)
    }
}

/// The error of a file that cannot be used, at the place that names it.
fn unusable(file: &RobotFile, part: RobotPart, e: &Error) -> Error {
    file.fault(part, &format!("this file is not usable: {e}"), e.remedy_of_named_file()).with_kind(e.kind())
}

/// A unit sphere, and the radius of the largest ball about its middle that it contains.
fn unit_sphere() -> Result<(f64, TriMesh), primitives::PrimitiveError> {
    let unit = primitives::sphere(1.0, 3)?;
    let inner = (0..unit.triangles().len()).map(|i| {
        let [a, b, c] = unit.triangle(i);
        (b - a).cross(&(c - a)).normalize().dot(&a.coords)
    });
    Ok((inner.fold(1.0, f64::min), unit))
}
