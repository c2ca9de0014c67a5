//! Robot problems and the files they name.

use super::joint_limits::{self, JointLimits};
use super::srdf_near::srdf_near;
use super::{RobotEntry, RobotFile, RobotFilePart, RobotPart};
use crate::mjcf::{self, Mjcf};
use crate::problem::PlacedBody;
use crate::problem_file::warn_of_degrees;
use crate::shape::Meshes;
use mp_formats::error::{Error, ErrorKind};
use mp_formats::files::{Disk, Files, MAX_TEXT_BYTES, stem};
use mp_geom::pose_from_six;
use std::path::{Path, PathBuf};

/// A robot of a problem: its description, with the files that it names but for its meshes.
#[derive(Clone, Debug, PartialEq)]
pub struct DescribedRobot {
    /// Where the description is.
    pub urdf_file: PathBuf,
    /// The content of the URDF, or the URDF that was made of a model of MuJoCo.
    pub urdf: String,
    /// The content of the SRDF: the one that the problem names, else the one that was found, else what a model of MuJoCo says.
    pub srdf: Option<String>,
    /// Where the SRDF is, if the problem names none and one of this robot was found near the URDF.
    pub srdf_found: Option<PathBuf>,
    /// How far and how fast its joints may move, as the `joint_limits.yaml` of MoveIt beside the SRDF says.
    pub joint_limits: JointLimits,
    /// The name of an SRDF near the URDF that is not taken, relative to the folder of the URDF.
    pub srdf_beside: Option<String>,
    /// The folder that `package://` means.
    pub packages: Option<PathBuf>,
    /// Whether its meshes are solids.
    pub solid: bool,
    /// If the description is of MuJoCo: what the URDF and its pairs were made of.
    pub(super) mjcf: Option<Mjcf>,
}

/// Arms, obstacles, a start and goals; all files are read except the meshes of the robots.
#[derive(Clone, Debug)]
pub struct RobotProblem {
    /// The name of the file, without extension.
    pub name: String,
    /// The content of the file.
    pub file: RobotFile,
    /// The robots, in the order of the file.
    pub robots: Vec<DescribedRobot>,
    /// The obstacles. Round shapes are meshes that contain them.
    pub obstacles: Vec<PlacedBody>,
    /// What links carry, each in the frame of its link; in the order of the file.
    pub attached: Vec<PlacedBody>,
}

impl RobotProblem {
    /// Whether both problems have the same robots: of the same files with the same descriptions, at the same places, with the same
    /// limits, none of which are for a start, and the same joints that move. Where not all do, the start may say where others are held.
    #[must_use]
    pub fn same_robots(&self, other: &Self) -> bool {
        let same = |(a, b): (&RobotEntry, &RobotEntry)| {
            (&a.name, a.base, a.floating, a.planar) == (&b.name, b.base, b.floating, b.planar)
                && (&a.limits, &a.hold, &a.driven) == (&b.limits, &b.hold, &b.driven)
                && a.max_rates == b.max_rates
                && (a.limit_tolerance, b.limit_tolerance) == (0.0, 0.0)
                && a.moving == b.moving
        };
        let (a, b) = (&self.file, &other.file);
        self.robots == other.robots
            && a.robots.iter().zip(&b.robots).all(same)
            && (&a.attached, &self.attached) == (&b.attached, &other.attached)
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
    /// [`mesh_from`](DescribedRobot::mesh_from).
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
        let robots = (0..file.robots.len()).map(|i| described(files, folder, &file, i));
        let robots = robots.collect::<Result<_, _>>()?;
        let mut meshes = Meshes::new(files, path);
        let mut body = |name: &String, shape, pose| {
            let (from, mesh) = meshes.of(&file.source(), name, shape)?;
            Ok::<_, Error>(PlacedBody { name: name.clone(), file: from, mesh, pose: pose_from_six(pose) })
        };
        let obstacles = file.obstacles.iter().map(|entry| body(&entry.name, &entry.shape, entry.pose));
        let obstacles: Vec<_> = obstacles.collect::<Result<_, _>>()?;
        let attached = file.attached.iter().map(|entry| body(&entry.name, &entry.shape, entry.pose));
        let attached = attached.collect::<Result<_, _>>()?;
        let name = stem(path);
        let bases = file.robots.iter().map(|robot| ("the base", robot.base));
        let attached_poses = file.attached.iter().map(|entry| (&*entry.name, entry.pose));
        let poses = file.obstacles.iter().map(|entry| (&*entry.name, entry.pose));
        warn_of_degrees(files, path, bases.chain(poses).chain(attached_poses));
        crate::trace::problem(&name, obstacles.len());
        Ok(Self { name, file, robots, obstacles, attached })
    }
}

fn described(files: &dyn Files, folder: &Path, file: &RobotFile, i: usize) -> Result<DescribedRobot, Error> {
    let entry = &file.robots[i];
    let text = |part: RobotPart, name: &str| {
        let place = folder.join(name);
        match read_robot_text(files, &place) {
            Ok(text) => Ok((place, text)),
            Err(e) => Err(unusable(file, RobotFilePart::Robot(i, part), &e)),
        }
    };
    let (urdf_file, mut urdf) = text(RobotPart::Urdf, &entry.urdf)?;
    let mut mjcf = None;
    if mjcf::is_mjcf(&urdf) {
        let read = mjcf::read(files, &urdf_file, urdf)?;
        if let (Some(first), true) =
            (read.scenery.first(), entry.floating.is_some() || entry.planar.is_some())
        {
            let others = read.scenery.len() - 1;
            let more = if others == 0 { String::new() } else { format!(" and {others} more") };
            let first = mp_formats::text::clipped(first);
            let message = format!(
                "bodies of the model that stand around the robot would move with the base: \"{first}\"{more}"
            );
            let help = "name a model of the robot alone, and make obstacles of what stands around it";
            return Err(file.fault(RobotFilePart::Robot(i, RobotPart::Base), &message, help));
        }
        urdf = read.urdf.clone();
        mjcf = Some(read);
    }
    let (named, srdf) = match &entry.srdf {
        Some(name) => text(RobotPart::Srdf, name).map(|(place, text)| (Some(place), Some(text)))?,
        None => (None, None),
    };
    let (mut srdf, mut srdf_found, mut srdf_beside) = (srdf, None, None);
    if srdf.is_none() {
        let (found, beside) = srdf_near(files, &urdf_file, &urdf);
        match found.filter(|_| !entry.without_srdf) {
            Some(found) => (srdf, srdf_found) = (Some(found.text), Some(found.file)),
            None => srdf_beside = beside,
        }
    }
    let own = mjcf.as_ref().filter(|_| srdf.is_none() && !entry.without_srdf);
    srdf = srdf.or(own.map(|mjcf| mjcf.srdf.clone()));
    let joint_limits = named.as_ref().or(srdf_found.as_ref()).map(|srdf| joint_limits::beside(files, srdf));
    let packages = entry.packages.as_ref().map(|name| folder.join(name));
    Ok(DescribedRobot {
        urdf_file,
        urdf,
        srdf,
        srdf_found,
        joint_limits: joint_limits.transpose()?.unwrap_or_default(),
        srdf_beside,
        packages,
        solid: entry.solid,
        mjcf,
    })
}

impl DescribedRobot {
    /// Whether the description is a model of MuJoCo, of which [`urdf`](Self::urdf) was made.
    #[must_use]
    pub fn is_mjcf(&self) -> bool {
        self.mjcf.is_some()
    }

    /// An error in a line of the URDF, counted from 1, or in all of it. Of a URDF that was made of another format the error is where the line comes
    /// from.
    #[must_use]
    pub fn error(&self, line: Option<usize>, message: String) -> Error {
        let (kind, file) = (ErrorKind::Content, self.urdf_file.display());
        match (&self.mjcf, line) {
            (Some(mjcf), _) => mjcf.origin.error(line, message),
            (None, Some(line)) => Error::in_line(kind, file, &self.urdf, line, message),
            (None, None) => Error::new(kind, file, message),
        }
    }
}

/// The text of a URDF or SRDF, in the encoding that it declares.
///
/// # Errors
/// [`Error`] when it cannot be read, is no text, or has elements that would take hours to read.
pub fn read_robot_text(files: &dyn Files, path: &Path) -> Result<String, Error> {
    let bytes = files.read(path, MAX_TEXT_BYTES)?;
    Ok(mp_formats::xml::text(&path.display().to_string(), &bytes)?.into_owned())
}

/// The error of a file that cannot be used, at the place that names it.
fn unusable(file: &RobotFile, part: RobotFilePart, e: &Error) -> Error {
    file.fault(part, &format!("this file is not usable: {e}"), e.remedy_of_named_file()).with_kind(e.kind())
}
