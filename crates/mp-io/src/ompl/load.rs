//! OMPL.app problems and the meshes they name.

use super::config;
use crate::problem::{Body, PlacedBody, RigidProblem, SpaceKind, check_mesh, check_size, cited};
use mp_formats::error::{Error, ErrorKind};
use mp_formats::files::{Files, MAX_MESH_BYTES, stem};
use mp_formats::formats::Content;
use mp_formats::formats::collada::{Scene, center::center_of_mesh};
use mp_formats::mesh::{Axes, read_mesh_of};
use mp_formats::text::Text;
use mp_geom::{Aabb, TriMesh};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use std::path::Path;

/// The problem in `text`, the content of the file `path`.
///
/// As in OMPL.app, the origin of the robot is the mean of its vertices (in the plane, z stays), and the bounds
/// are the volume, or without one the box around the world, enlarged to contain start and goal.
pub(crate) fn load(files: &dyn Files, path: &Path, text: &Text<'_>) -> Result<RigidProblem, Error> {
    let (read, places) = config::parse(text)?;
    if let (Some(kind), Some(place)) = (&read.control, places.control) {
        return Err(text
            .error(place, format!("this is a problem with dynamics, `{kind}`"))
            .expected("a problem without `control`")
            .help(
                "only rigid bodies that move freely are planned for; remove the line to ignore the dynamics",
            )
            .with_kind(ErrorKind::Unsupported));
    }
    check_size(text, places.start, "the start", read.start.position.coords.as_slice())?;
    check_size(text, places.goal, "the goal", read.goal.position.coords.as_slice())?;

    let folder = path.parent().unwrap_or(Path::new(""));
    let (file, (mesh, center)) =
        cited(text, folder, places.robot, "the robot", |f| mesh_and_center(files, f))?;
    check_mesh(text, places.robot, &file, &mesh)?;
    let shift = match read.space {
        SpaceKind::Se3 => -center,
        SpaceKind::Se2 => Vector3::new(-center.x, -center.y, 0.0),
    };
    let mesh =
        mesh.transformed(&Isometry3::from_parts(Translation3::from(shift), UnitQuaternion::identity()));
    let robot = Body { name: "robot".to_owned(), file, mesh };

    let mut obstacles = Vec::new();
    if let (Some(place), true) = (places.world, read.world.is_some()) {
        let (file, mesh) = cited(text, folder, place, "the world", |f| read_mesh_of(files, f))?;
        check_mesh(text, place, &file, &mesh)?;
        obstacles.push(PlacedBody { name: "world".to_owned(), file, mesh, pose: Isometry3::identity() });
    }

    // As in OMPL.app, a volume without extent is ignored.
    let sides = if read.space == SpaceKind::Se2 { 2 } else { 3 };
    let volume = read.volume.filter(|v| (0..sides).map(|i| v[i + 3] - v[i]).product::<f64>() >= f64::EPSILON);
    let mut bounds = match volume {
        Some(v) => Aabb::new(Point3::new(v[0], v[1], v[2]), Point3::new(v[3], v[4], v[5])),
        None => obstacles.iter().fold(Aabb::empty(), |all, o| all.union(&o.mesh.aabb())),
    };
    if read.space == SpaceKind::Se2 {
        (bounds.min.z, bounds.max.z) = (0.0, 0.0);
    }
    bounds = bounds.union(&Aabb::of_points(&[read.start.position, read.goal.position]));
    check_size(text, places.robot, "the volume", bounds.min.coords.as_slice())?;
    check_size(text, places.robot, "the volume", bounds.max.coords.as_slice())?;

    Ok(RigidProblem {
        name: read.name.unwrap_or_else(|| stem(path)),
        space: read.space,
        robot,
        obstacles,
        start: read.start.pose(),
        goal: read.goal.pose(),
        bounds: Some(bounds),
    })
}

/// A mesh and the mean of its vertices.
fn mesh_and_center(files: &dyn Files, path: &Path) -> Result<(TriMesh, Vector3<f64>), Error> {
    let bytes = files.read(path, MAX_MESH_BYTES)?;
    if Content::of_mesh(path, &bytes) == Some(Content::Collada) {
        let file = path.display().to_string();
        let scene = Scene::parse(&file, &bytes, Axes::YUp, files.interrupt())?;
        scene.remarks(Axes::YUp).iter().for_each(|remark| files.note(path, remark));
        return Ok((scene.to_mesh(&file)?, scene.center()));
    }
    drop(bytes);
    let mesh = read_mesh_of(files, path)?;
    let center = center_of_mesh(&mesh);
    Ok((mesh, center))
}
