//! Robot problems and the files they name.

use super::{ObstacleShape, RobotFile, RobotPart, RobotProblem};
use crate::error::{Error, ErrorKind};
use crate::mesh::{read_mesh, read_mesh_of};
use crate::problem::{MAX_COORDINATE, PlacedBody};
use crate::source::{Disk, Files, MAX_TEXT_BYTES, decode};
use mp_geom::{TriMesh, pose_from_six, primitives};
use std::path::{Path, PathBuf};

/// Segments of a cylinder; the mesh contains it.
const SEGMENTS: u32 = 32;

impl RobotProblem {
    /// Whether the name of a file is that of a robot problem: it ends in `.toml`.
    #[must_use]
    pub fn is_named(path: &Path) -> bool {
        path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
    }

    /// Reads a robot problem, its URDF and SRDF and the meshes of obstacles. File names are relative to the file
    /// that has them.
    ///
    /// # Errors
    /// [`Error`] when a file cannot be read or makes no sense, with file, line and column.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::load_from(&Disk, path.as_ref())
    }

    /// The same of files from elsewhere. Meshes of the robot itself are read from the disk.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_from(files: &dyn Files, path: &Path) -> Result<Self, Error> {
        let shown = path.display().to_string();
        let file = RobotFile::parse(&shown, &files.read(path, MAX_TEXT_BYTES)?)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let text = |part: RobotPart, name: &str| {
            let place = folder.join(name);
            let read =
                || Ok(decode(&place.display().to_string(), &files.read(&place, MAX_TEXT_BYTES)?)?.to_owned());
            let read: Result<String, Error> = read();
            read.map(|text| (place.clone(), text)).map_err(|e| cited(&file, part, &e))
        };
        let (urdf_file, urdf) = text(RobotPart::Urdf, &file.urdf)?;
        let srdf = match &file.srdf {
            Some(name) => Some(text(RobotPart::Srdf, name)?.1),
            None => None,
        };
        let mut obstacles: Vec<PlacedBody> = Vec::new();
        for entry in &file.obstacles {
            let fault = |message: &str, help: &str| {
                let length = entry.span.end.saturating_sub(entry.span.start).max(1);
                let (at, message) = (entry.span.start, message.to_owned());
                Error::at(ErrorKind::Content, &file.file, &file.text, at, length, message).help(help)
            };
            let primitive = |made: Result<TriMesh, primitives::PrimitiveError>| {
                made.map(|mesh| (path.to_owned(), mesh))
                    .map_err(|e| fault(&e.to_string(), "give sizes in metres, not too small"))
            };
            let (from, mesh) = match &entry.shape {
                ObstacleShape::Box([x, y, z]) => primitive(primitives::cuboid(*x, *y, *z))?,
                ObstacleShape::Sphere(radius) => primitive(ball(*radius))?,
                ObstacleShape::Cylinder([radius, height]) => {
                    let around = radius / (std::f64::consts::PI / f64::from(SEGMENTS)).cos();
                    primitive(primitives::cylinder(around, *height, SEGMENTS))?
                }
                ObstacleShape::Mesh(name) => {
                    let place = folder.join(name);
                    // The same mesh often stands in many places: read it once.
                    match obstacles.iter().find(|o| o.file == place) {
                        Some(seen) => (place, seen.mesh.clone()),
                        None => {
                            let mesh = read_mesh_of(files, &place).map_err(|e| {
                                let message = format!("the mesh of {} is not usable: {e}", entry.name);
                                let help = e.remedy().unwrap_or("check the name of the file").to_owned();
                                fault(&message, &help).with_kind(e.kind())
                            })?;
                            (place, mesh)
                        }
                    }
                }
            };
            if mesh.vertices().iter().any(|v| v.iter().any(|c| c.abs() > MAX_COORDINATE)) {
                let message = format!("{} has a vertex beyond {MAX_COORDINATE:e} m", entry.name);
                return Err(fault(&message, "coordinates are metres: scale the mesh"));
            }
            let (name, pose) = (entry.name.clone(), pose_from_six(entry.pose));
            obstacles.push(PlacedBody { name, file: from, mesh, pose });
        }
        let name = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        let packages = file.packages.as_ref().map(|name| folder.join(name));
        Ok(Self { name, file, urdf_file, urdf, srdf, packages, obstacles })
    }

    /// Reads a mesh that the URDF names: a file relative to the URDF, `file://` and an absolute name, or
    /// `package://PACKAGE/NAME`. That is looked for in the folder of packages the problem gives, or else in the
    /// folders above the URDF, as `PACKAGE/NAME` and `share/PACKAGE/NAME`, and as `NAME` where the folder is called
    /// PACKAGE. `package:///NAME` names no package: it is looked for as `NAME` in the same folders.
    ///
    /// # Errors
    /// A message for people: which file, sought where.
    pub fn mesh(&self, name: &str) -> Result<TriMesh, String> {
        let place = self.place_of(name)?;
        let mesh = read_mesh(&place).map_err(|e| match e.remedy() {
            Some(remedy) => format!("{e} ({remedy})"),
            None => e.to_string(),
        })?;
        match mesh.vertices().iter().any(|v| v.iter().any(|c| c.abs() > MAX_COORDINATE)) {
            true => Err(format!("{} has a vertex beyond {MAX_COORDINATE:e} m", place.display())),
            false => Ok(mesh),
        }
    }

    /// Where a mesh is that the URDF names, as [`mesh`](Self::mesh) finds it; `None` when it is not there.
    #[must_use]
    pub fn mesh_file(&self, name: &str) -> Option<PathBuf> {
        self.place_of(name).ok()
    }

    fn place_of(&self, name: &str) -> Result<PathBuf, String> {
        let folder = self.urdf_file.parent().unwrap_or(Path::new(""));
        let Some(inside) = name.strip_prefix("package://") else {
            return Ok(folder.join(name.strip_prefix("file://").unwrap_or(name)));
        };
        let (package, rest) = inside.split_once('/').unwrap_or((inside, ""));
        // Further slashes would make it a name from the root of the disk.
        let rest = rest.trim_start_matches('/');
        if rest.is_empty() {
            return Err(format!("{name} names no file: write package://PACKAGE/FILE"));
        }
        let start = self.packages.as_deref().unwrap_or(folder);
        // The folder of a bare file name.
        let start = if start.as_os_str().is_empty() { Path::new(".") } else { start };
        let absolute = std::fs::canonicalize(start).map_err(|e| {
            let whose = if self.packages.is_some() { "`packages` of the problem" } else { "of the URDF" };
            format!("{name} cannot be sought in the folder {whose}, {}: {e}", start.display())
        })?;
        let above = if self.packages.is_some() { 1 } else { usize::MAX };
        for folder in absolute.ancestors().take(above) {
            if let Some(found) = in_folder(folder, package, rest) {
                return Ok(found);
            }
        }
        let (file, holds) = match package {
            "" => (rest.to_owned(), rest.split('/').next().unwrap_or(rest)),
            _ => (format!("{package}/{rest}"), package),
        };
        let start = absolute.display();
        Err(match self.packages {
            Some(_) => format!(
                "{name} is not there: {file} and share/{file} were sought in {start}, the folder `packages` of the \
                 problem; it must be the folder that holds {holds}"
            ),
            None => format!(
                "{name} is not there: {file} and share/{file} were sought in {start} and every folder above; say \
                 `packages = \"FOLDER\"` in the problem, the folder that holds {holds}"
            ),
        })
    }
}

/// The file `rest` of a package in or below `folder`, if it is there.
fn in_folder(folder: &Path, package: &str, rest: &str) -> Option<PathBuf> {
    let in_package = |folder: PathBuf| folder.join(package).join(rest);
    let own = package.is_empty() || folder.file_name().is_some_and(|name| name == package);
    let places = [
        Some(in_package(folder.to_owned())),
        Some(in_package(folder.join("share"))),
        own.then(|| folder.join(rest)),
    ];
    places.into_iter().flatten().find(|place| place.is_file())
}

/// The fault of a file, at the place that names it when it cannot be opened.
fn cited(file: &RobotFile, part: RobotPart, e: &Error) -> Error {
    let help = e.remedy().unwrap_or("check the name of the file").to_owned();
    file.fault(part, &format!("this file is not usable: {e}"), &help).with_kind(e.kind())
}

/// A mesh around a ball.
fn ball(radius: f64) -> Result<TriMesh, primitives::PrimitiveError> {
    let unit = primitives::sphere(1.0, 3)?;
    let inner = (0..unit.triangles().len()).map(|i| {
        let [a, b, c] = unit.triangle(i);
        (b - a).cross(&(c - a)).normalize().dot(&a.coords)
    });
    primitives::sphere(radius / inner.fold(1.0, f64::min), 3)
}
