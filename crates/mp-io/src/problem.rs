//! Problems for rigid bodies, read from any of their formats.

use crate::document;
use crate::environment::{self, Environment};
use crate::ompl;
use crate::problem_file::warn_of_degrees;
use mp_formats::error::{Error, ErrorKind};
use mp_formats::files::{Disk, Files, MAX_TEXT_BYTES, decode, stem};
use mp_formats::formats::Content;
use mp_formats::mesh::{MAX_COORDINATE, read_mesh_of, vertex_beyond};
use mp_formats::text::{Text, Token};
use mp_geom::{Aabb, TriMesh, pose_from_six};
use nalgebra::{Isometry3, Point3};
use std::fmt;
use std::path::{Path, PathBuf};

/// The space in which the robot moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum SpaceKind {
    /// SE(3): any position and any rotation.
    #[default]
    #[serde(rename = "SE3")]
    Se3,
    /// SE(2): a position in the plane z = 0 and a rotation about Z.
    #[serde(rename = "SE2")]
    Se2,
}

impl fmt::Display for SpaceKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Se3 => "SE3",
            Self::Se2 => "SE2",
        })
    }
}

/// A body: its mesh, and where that came from.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Its name in messages.
    pub name: String,
    /// The file of its mesh.
    pub file: PathBuf,
    /// Its mesh, in its own frame, metres.
    pub mesh: TriMesh,
}

/// A body at a pose in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedBody {
    /// Its name in messages.
    pub name: String,
    /// The file of its mesh.
    pub file: PathBuf,
    /// Its mesh, in its own frame, metres.
    pub mesh: TriMesh,
    /// Its pose in the world.
    pub pose: Isometry3<f64>,
}

/// A robot, obstacles, a start and a goal.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidProblem {
    /// The name of the file, without extension.
    pub name: String,
    /// The space in which the robot moves.
    pub space: SpaceKind,
    /// The body that moves, in its own frame.
    pub robot: Body,
    /// The bodies that stand still, each with its pose in the world.
    pub obstacles: Vec<PlacedBody>,
    /// The robot's pose in the world at the start.
    pub start: Isometry3<f64>,
    /// The robot's pose in the world at the goal.
    pub goal: Isometry3<f64>,
    /// The box in which the origin of the robot may be, if the file gives one. Contains start and goal.
    pub bounds: Option<Aabb>,
}

/// What kind of problem is in a file that is not one by its name.
fn told(text: &str) -> Option<Content> {
    if text.lines().any(|l| l.trim() == "[problem]") {
        return Some(Content::OmplApp);
    }
    let first = text.trim_start().get(..5);
    first.filter(|word| word.eq_ignore_ascii_case("Robot")).map(|_| Content::Environment)
}

impl RigidProblem {
    /// Reads a problem and its meshes: a GEMPA environment file (`.env`, `.txt`), an OMPL.app problem
    /// (`.cfg`) or a scene of the editor (`.mp.json`, see [`SceneDocument`](crate::SceneDocument)). Files of other names are told apart by their content.
    ///
    /// # Errors
    /// [`Error`] when a file cannot be read or makes no sense, with file, line and column.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::load_from(&Disk, path.as_ref())
    }

    /// As [`load`](Self::load), with the files read through `files`.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_from(files: &dyn Files, path: &Path) -> Result<Self, Error> {
        let named = Content::of(path).next();
        if let Some(Content::Document | Content::JsonPath) = named {
            return document::load(files, path);
        }
        let (file, bytes) = (path.display().to_string(), files.read(path, MAX_TEXT_BYTES)?);
        let text = decode(&file, &bytes)?;
        let is_rigid =
            |content| matches!(content, Content::Environment | Content::OmplApp | Content::Document);
        match named.filter(|content| is_rigid(*content) || content.is_mesh()).or_else(|| told(text)) {
            Some(Content::Environment) => {
                Self::from_environment(files, path, &Text { file: &file, text, guide: environment::GUIDE })
            }
            Some(Content::OmplApp) => {
                ompl::load(files, path, &Text { file: &file, text, guide: ompl::GUIDE })
            }
            _ => Err(Error::new(ErrorKind::Unsupported, &file, "this is not a problem that is read here")
                .expected(format!("the problem of a rigid body: {}", Content::endings(is_rigid)))
                .help(
                    "a mesh or a path is not a problem: give the file that names the robot and the obstacles",
                )),
        }
    }

    /// The box in which the origin of the robot may be: [`bounds`](Self::bounds), or, when the file gives none, a box
    /// around all obstacles, start and goal, enlarged on every side by the diameter of the robot about its
    /// origin or a tenth of the diagonal of the box, whichever is more, so that it can go around everything.
    #[must_use]
    pub fn position_bounds(&self) -> Aabb {
        self.bounds.unwrap_or_else(|| {
            let ends = [self.start, self.goal].map(|p| Point3::from(p.translation.vector));
            let all = self
                .obstacles
                .iter()
                .map(|o| o.mesh.transformed(&o.pose).aabb())
                .fold(Aabb::of_points(&ends), |all, b| all.union(&b));
            let diameter = 2.0 * self.robot.mesh.radius_about(&Point3::origin());
            let margin = diameter.max(0.1 * all.diagonal());
            all.enlarged(if margin > 0.0 { margin } else { 1.0 })
        })
    }

    fn from_environment(files: &dyn Files, path: &Path, text: &Text<'_>) -> Result<Self, Error> {
        let (env, places) = environment::parse(text)?;
        let Environment { start, goal, .. } = env;
        let space = env.space.unwrap_or_default();
        check_size(text, places.start, "the initial configuration", &start[..3])?;
        check_size(text, places.goal, "the goal configuration", &goal[..3])?;
        if space == SpaceKind::Se2 {
            check_planar(text, places.start, "initial", &start)?;
            check_planar(text, places.goal, "goal", &goal)?;
        }
        let bounds = match (env.bounds, places.bounds) {
            (Some([a, b, c, d, e, f]), Some(place)) => {
                check_size(text, place, "the bounds", &[a, b, c, d, e, f])?;
                let bounds = Aabb::new(Point3::new(a, b, c), Point3::new(d, e, f));
                check_inside(text, places.start, "initial", &start, &bounds)?;
                check_inside(text, places.goal, "goal", &goal, &bounds)?;
                Some(bounds)
            }
            _ => None,
        };
        let folder = path.parent().unwrap_or(Path::new(""));
        let (file, mesh) = body_mesh(files, text, folder, places.robot, "the robot")?;
        let robot = Body { name: "robot".to_owned(), file, mesh };
        let mut obstacles: Vec<PlacedBody> = Vec::new();
        for (i, o) in env.obstacles.iter().enumerate() {
            let name = format!("Obstacle #{}", o.number);
            check_size(text, places.poses[i], "the pose", &o.pose[..3])?;
            // Many obstacles often share a mesh: read it once.
            let seen = (0..i).find(|&k| env.obstacles[k].mesh == o.mesh);
            let (file, mesh) = match seen {
                Some(k) => (obstacles[k].file.clone(), obstacles[k].mesh.clone()),
                None => body_mesh(files, text, folder, places.meshes[i], &name)?,
            };
            obstacles.push(PlacedBody { name, file, mesh, pose: pose_from_six(o.pose) });
        }
        let name = stem(path);
        let poses = obstacles.iter().map(|o| &*o.name).zip(env.obstacles.iter().map(|o| o.pose));
        warn_of_degrees(files, path, [("the start", start), ("the goal", goal)].into_iter().chain(poses));
        let (start, goal) = (pose_from_six(start), pose_from_six(goal));
        crate::trace::problem(&name, obstacles.len());
        Ok(Self { name, space, robot, obstacles, start, goal, bounds })
    }
}

/// Reads the mesh named at `place`.
fn body_mesh(
    files: &dyn Files,
    text: &Text<'_>,
    folder: &Path,
    place: Token<'_>,
    what: &str,
) -> Result<(PathBuf, TriMesh), Error> {
    let (file, mesh) = cited(text, folder, place, what, |f| read_mesh_of(files, f))?;
    check_mesh(text, place, &file, &mesh)?;
    Ok((file, mesh))
}

/// The file named at `place` and what `read` makes of it; errors say where it is named.
pub(crate) fn cited<T>(
    text: &Text<'_>,
    folder: &Path,
    place: Token<'_>,
    what: &str,
    read: impl FnOnce(&Path) -> Result<T, Error>,
) -> Result<(PathBuf, T), Error> {
    let file = folder.join(place.text);
    match read(&file) {
        Ok(mesh) => Ok((file, mesh)),
        // A file that cannot be opened is an error of this line; bad content is an error of that file.
        Err(e) if e.kind() == ErrorKind::Io => {
            let message = format!("the mesh of {what} is not readable: {}: {}", e.file(), e.message());
            Err(text.error(place, message).help(e.remedy_of_named_file()).with_kind(ErrorKind::Io))
        }
        Err(e) => Err(e.cited_at(text.place(place))),
    }
}

/// Refuses a mesh with coordinates too large to compute with.
pub(crate) fn check_mesh(
    text: &Text<'_>,
    place: Token<'_>,
    file: &Path,
    mesh: &TriMesh,
) -> Result<(), Error> {
    match vertex_beyond(mesh) {
        None => Ok(()),
        Some(v) => {
            let message = format!("vertex ({:e}, {:e}, {:e}) is beyond {MAX_COORDINATE:e} m", v.x, v.y, v.z);
            Err(Error::new(ErrorKind::Content, file.display(), message)
                .help("coordinates are metres: scale the mesh")
                .cited_at(text.place(place)))
        }
    }
}

/// Refuses numbers beyond [`MAX_COORDINATE`]; `what` has them.
pub(crate) fn check_size(text: &Text<'_>, place: Token<'_>, what: &str, values: &[f64]) -> Result<(), Error> {
    match values.iter().find(|v| v.abs() > MAX_COORDINATE) {
        None => Ok(()),
        Some(v) => Err(text
            .error(place, format!("{what} has {v:e}, more than {MAX_COORDINATE:e} m"))
            .help("coordinates are metres")
            .with_kind(ErrorKind::Content)),
    }
}

fn check_planar(text: &Text<'_>, place: Token<'_>, which: &str, six: &[f64; 6]) -> Result<(), Error> {
    if six[2] == 0.0 && six[4] == 0.0 && six[5] == 0.0 {
        return Ok(());
    }
    Err(text
        .error(place, format!("the {which} configuration leaves the plane"))
        .expected("z, β and γ equal to 0, as the file says `Space SE2`")
        .help("write x y 0 α 0 0, or remove the line `Space SE2`")
        .with_kind(ErrorKind::Content))
}

fn check_inside(
    text: &Text<'_>,
    place: Token<'_>,
    which: &str,
    six: &[f64; 6],
    bounds: &Aabb,
) -> Result<(), Error> {
    for (i, axis) in ["x", "y", "z"].iter().enumerate() {
        let (v, low, high) = (six[i], bounds.min[i], bounds.max[i]);
        if v < low || v > high {
            return Err(text
                .error(place, format!("the {which} configuration is out of bounds: {axis} = {v}"))
                .expected(format!("{axis} from {low} to {high}, as `Bounds` says"))
                .help("move the configuration or widen `Bounds`")
                .with_kind(ErrorKind::Content));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{write_gempa_mesh, write_off};
    use mp_geom::primitives;

    const ENV: &str = "Robot\nrobot.txt\n0 0 0 0 0 0\n5 0 0 1 0 0\nObstacle #1\nwall.off\n2 0 0 0 0 0\n\
                       Obstacle #4\nwall.off\n3 0 0 0 0.5 0\nEnd\nSpace SE3\nBounds -1 -1 -1 6 1 1\n";

    fn folder() -> tempfile::TempDir {
        let dir = tempfile::tempdir().unwrap();
        write_gempa_mesh(dir.path().join("robot.txt"), &primitives::cuboid(0.1, 0.1, 0.1).unwrap()).unwrap();
        write_off(dir.path().join("wall.off"), &primitives::cuboid(0.1, 1.0, 1.0).unwrap()).unwrap();
        dir
    }

    #[test]
    fn loads_an_environment_and_its_meshes() {
        let dir = folder();
        let path = dir.path().join("scene.env");
        std::fs::write(&path, ENV).unwrap();
        let p = RigidProblem::load(&path).unwrap();
        assert_eq!((p.name.as_str(), p.space), ("scene", SpaceKind::Se3));
        assert_eq!(p.robot.mesh.triangles().len(), 12);
        assert_eq!(
            p.obstacles.iter().map(|o| o.name.as_str()).collect::<Vec<_>>(),
            ["Obstacle #1", "Obstacle #4"]
        );
        assert_eq!(p.obstacles[1].pose, pose_from_six([3.0, 0.0, 0.0, 0.0, 0.5, 0.0]));
        assert_eq!(p.bounds.unwrap().max, Point3::new(6.0, 1.0, 1.0));
    }

    #[test]
    fn faults_of_meshes_name_the_mesh_and_the_line_that_names_it() {
        let dir = folder();
        let path = dir.path().join("scene.env");
        std::fs::write(&path, ENV.replacen("wall.off", "wal.off", 1)).unwrap();
        let e = RigidProblem::load(&path).unwrap_err();
        assert_eq!((e.kind(), e.line(), e.column()), (ErrorKind::Io, Some(6), Some(1)));
        assert!(e.message().contains("no such file"), "{e}");
        std::fs::write(&path, ENV).unwrap();
        std::fs::write(dir.path().join("wall.off"), "OFF 1 1 0\n0 0 0\n3 0 0 1\n").unwrap();
        let e = RigidProblem::load(&path).unwrap_err();
        assert_eq!((e.line(), e.column()), (Some(3), Some(7)));
        assert!(e.file().ends_with("wall.off") && e.to_string().ends_with("scene.env:6:1)"), "{e}");
    }
}
