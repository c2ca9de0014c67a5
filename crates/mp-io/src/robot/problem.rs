//! Robot problems and the files they name.

use super::srdf_near::srdf_near;
use super::{RobotFile, RobotPart};
use crate::error::Error;
use crate::files::{Disk, Files, MAX_TEXT_BYTES, stem};
use crate::problem::PlacedBody;
use crate::shape::Meshes;
use mp_geom::pose_from_six;
use nalgebra::Isometry3;
use std::path::{Path, PathBuf};

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
    /// The content of the SRDF: the one that the problem names, else the one that was found.
    pub srdf: Option<String>,
    /// Where the SRDF is, if the problem names none and one of this robot was found near the URDF.
    pub srdf_found: Option<PathBuf>,
    /// The name of an SRDF beside the URDF that is not taken.
    pub srdf_beside: Option<String>,
    /// The folder that `package://` means.
    pub packages: Option<PathBuf>,
    /// The obstacles. Round shapes are meshes that contain them.
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
        let (mut srdf, mut srdf_found, mut srdf_beside) = (srdf, None, None);
        if srdf.is_none() {
            let (found, beside) = srdf_near(files, &urdf_file, &urdf);
            match found.filter(|_| !file.without_srdf) {
                Some(found) => (srdf, srdf_found) = (Some(found.text), Some(found.file)),
                None => srdf_beside = beside,
            }
        }
        let (mut obstacles, mut meshes) = (Vec::new(), Meshes::new(files, path));
        for entry in &file.obstacles {
            let (from, mesh) = meshes.of(&file.source(), &entry.name, &entry.shape)?;
            let (name, pose) = (entry.name.clone(), pose_from_six(entry.pose));
            obstacles.push(PlacedBody { name, file: from, mesh, pose });
        }
        let packages = file.packages.as_ref().map(|name| folder.join(name));
        let name = stem(path);
        crate::trace::problem(&name, obstacles.len());
        let problem =
            Self { name, file, urdf_file, urdf, srdf, srdf_found, srdf_beside, packages, obstacles };
        problem.check_states()?;
        Ok(problem)
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

/// The error of a file that cannot be used, at the place that names it.
fn unusable(file: &RobotFile, part: RobotPart, e: &Error) -> Error {
    file.fault(part, &format!("this file is not usable: {e}"), e.remedy_of_named_file()).with_kind(e.kind())
}
