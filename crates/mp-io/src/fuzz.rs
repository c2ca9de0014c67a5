//! Entry points for fuzzing: one function for each format, to be called with any bytes at all.
//!
//! Each reads the bytes and, when they are valid, checks that writing and reading again gives the same. None
//! may panic, whatever the bytes. What refuses the bytes is returned: [`check_error`] shows it, which takes longer than
//! most readers do. `cargo xtask fuzz` calls them guided by coverage, and the test `fuzz` of this crate with the files that
//! were found so, and with mutated ones (`docs/fuzzing.md`).

use crate::{Column, csv_text, gempa_mesh_text, parse_csv, parse_mesh, stl_text};
use crate::{
    Environment, Error, ErrorKind, GridMap, InMemory, JointPath, OffDocument, OmplProblem, PathFile,
    PlanarFile, RobotFile, RosMap, SceneDocument, TrajectoryFile, TrajectoryKind,
};
pub use mp_formats::error::check_error;
use mp_formats::formats::collada::Scene;
use mp_formats::mesh::Axes;
use mp_geom::TriMesh;
use mp_stop::Interrupt;
use std::fmt::Debug;
use std::path::Path;

/// Reads any bytes. The error is the one that refuses them.
pub type Target = fn(&[u8]) -> Result<(), Error>;

/// The formats: a name, and the function to call.
pub const TARGETS: [(&str, Target); 27] = [
    ("off", off),
    ("gempa-mesh", gempa_mesh),
    ("gempa-environment", gempa_environment),
    ("gempa-path", gempa_path),
    ("json-path", json_path),
    ("stl", stl),
    ("obj", obj),
    ("collada", collada),
    ("ply", ply),
    ("gltf", gltf),
    ("points-text", points_text),
    ("points-pcd", points_pcd),
    ("points-npy", points_npy),
    ("points-las", points_las),
    ("ompl-app", ompl_app),
    ("robot-problem", robot_problem),
    ("mjcf", mjcf),
    ("joint-limits", joint_limits),
    ("joint-path", joint_path),
    ("json-joint-path", json_joint_path),
    ("csv-path", csv_path),
    ("trajectory", trajectory),
    ("planar-world", planar_world),
    ("ros-map", ros_map),
    ("map-image", map_image),
    ("scene-document", scene_document),
    ("errors", errors),
];

/// OFF documents.
///
/// # Errors
/// When the bytes are refused, as for all targets.
pub fn off(bytes: &[u8]) -> Result<(), Error> {
    let document = OffDocument::parse("f.off", bytes)?;
    assert_eq!(OffDocument::parse("f.off", document.to_text().as_bytes()).as_ref().ok(), Some(&document));
    document.to_mesh("f.off").map(drop)
}

/// Points as text.
///
/// # Errors
/// When the bytes are refused.
pub fn points_text(bytes: &[u8]) -> Result<(), Error> {
    points("f.xyz", bytes)
}

/// Points in PCD.
///
/// # Errors
/// When the bytes are refused.
pub fn points_pcd(bytes: &[u8]) -> Result<(), Error> {
    points("f.pcd", bytes)
}

/// Points in arrays of numpy.
///
/// # Errors
/// When the bytes are refused.
pub fn points_npy(bytes: &[u8]) -> Result<(), Error> {
    points("f.npy", bytes)
}

/// Points in LAS.
///
/// # Errors
/// When the bytes are refused.
pub fn points_las(bytes: &[u8]) -> Result<(), Error> {
    points("f.las", bytes)
}

/// Points of a file, and balls around them.
fn points(file: &str, bytes: &[u8]) -> Result<(), Error> {
    let at = mp_formats::points::parse_points(Path::new(file), bytes, Interrupt::never())?;
    let (count, mut kept) = (at.len(), 0);
    if let Ok(mesh) = mp_formats::points::balls(&mp_geom::Points::new(at, 0.1), |_| ()) {
        kept = mesh.vertices().len();
    }
    assert!(kept <= count && count <= bytes.len().max(1) * 100);
    Ok(())
}

/// GEMPA `.txt` meshes.
///
/// # Errors
/// When the bytes are refused.
pub fn gempa_mesh(bytes: &[u8]) -> Result<(), Error> {
    let mesh = parse_mesh("f.txt", bytes)?;
    same_triangles(&mesh, &parse_mesh("f.txt", gempa_mesh_text(&mesh).as_bytes()));
    Ok(())
}

/// GEMPA environments.
///
/// # Errors
/// When the bytes are refused.
pub fn gempa_environment(bytes: &[u8]) -> Result<(), Error> {
    round_trips(bytes, |b| Environment::parse("f.env", b), Environment::to_text)
}

/// GEMPA configuration files.
///
/// # Errors
/// When the bytes are refused.
pub fn gempa_path(bytes: &[u8]) -> Result<(), Error> {
    round_trips(bytes, |b| PathFile::parse("f.txt", b), PathFile::to_text)
}

/// Paths in JSON.
///
/// # Errors
/// When the bytes are refused.
pub fn json_path(bytes: &[u8]) -> Result<(), Error> {
    round_trips(bytes, |b| PathFile::parse_json("f.json", b, &[]), PathFile::to_json)
}

/// STL, text and binary.
///
/// # Errors
/// When the bytes are refused.
pub fn stl(bytes: &[u8]) -> Result<(), Error> {
    let mesh = parse_mesh("f.stl", bytes)?;
    same_triangles(&mesh, &parse_mesh("f.stl", stl_text(&mesh).as_bytes()));
    Ok(())
}

/// OBJ.
///
/// # Errors
/// When the bytes are refused.
pub fn obj(bytes: &[u8]) -> Result<(), Error> {
    parse_mesh("f.obj", bytes).map(drop)
}

/// PLY, text and binary.
///
/// # Errors
/// When the bytes are refused.
pub fn ply(bytes: &[u8]) -> Result<(), Error> {
    parse_mesh("f.ply", bytes).map(drop)
}

/// glTF, text and binary: binary files get the lengths of their parts.
///
/// # Errors
/// When the bytes are refused.
pub fn gltf(bytes: &[u8]) -> Result<(), Error> {
    let mut bytes = bytes.to_vec();
    let name = if bytes.starts_with(b"glTF") { "f.glb" } else { "f.gltf" };
    if let Some(end) =
        bytes.windows(4).position(|word| word == b"BIN\0").filter(|end| name == "f.glb" && *end >= 24)
    {
        let lengths = [end - 24, bytes.len() - end - 4].map(|length| (length as u32).to_le_bytes());
        bytes[12..16].copy_from_slice(&lengths[0]);
        bytes[end - 4..end].copy_from_slice(&lengths[1]);
    }
    parse_mesh(name, &bytes).map(drop)
}

/// COLLADA.
///
/// # Errors
/// When the bytes are refused.
pub fn collada(bytes: &[u8]) -> Result<(), Error> {
    let scene = Scene::parse("f.dae", bytes, Axes::YUp, mp_stop::Interrupt::never())?;
    let _ = scene.center();
    scene.to_mesh("f.dae").map(drop)
}

/// OMPL.app problems.
///
/// # Errors
/// When the bytes are refused.
pub fn ompl_app(bytes: &[u8]) -> Result<(), Error> {
    OmplProblem::parse("f.cfg", bytes).map(drop)
}

/// Robot problems.
///
/// # Errors
/// When the bytes are refused.
pub fn robot_problem(bytes: &[u8]) -> Result<(), Error> {
    RobotFile::parse("f.toml", bytes).map(drop)
}

/// Models of MuJoCo, and the URDF and SRDF that are made of them.
///
/// # Errors
/// When the bytes are refused.
pub fn mjcf(bytes: &[u8]) -> Result<(), Error> {
    const INCLUDED: &str =
        "<mujocoinclude><body name='included'><joint/><geom size='1'/></body></mujocoinclude>";
    let text = mp_formats::xml::text("f.xml", bytes)?.into_owned();
    let files = InMemory(|name: &str| (name != "f.xml").then_some(INCLUDED));
    let read = crate::mjcf::read(&files, Path::new("f.xml"), text)?;
    for (text, element) in [(&read.urdf, "link"), (&read.srdf, "robot")] {
        let document = roxmltree::Document::parse(text).expect("what is written is XML");
        assert!(document.descendants().any(|node| node.has_tag_name(element)));
    }
    let lines = read.urdf.lines().count();
    check_error(&read.origin.error(Some(lines), "the last line".to_owned()).help("none"));
    Ok(())
}

/// Paths of joint values.
///
/// # Errors
/// When the bytes are refused.
pub fn joint_path(bytes: &[u8]) -> Result<(), Error> {
    round_trips(bytes, |b| JointPath::parse("f.txt", b), JointPath::to_text)
}

/// Paths of joint values in JSON.
///
/// # Errors
/// When the bytes are refused.
pub fn json_joint_path(bytes: &[u8]) -> Result<(), Error> {
    round_trips(bytes, |b| JointPath::parse_json("f.json", b, &[]), JointPath::to_json)
}

/// Paths as comma-separated values.
///
/// # Errors
/// When the bytes are refused.
pub fn csv_path(bytes: &[u8]) -> Result<(), Error> {
    let [x, turn] = [Column::new("x", "m"), Column::new("turn", "rad")];
    for columns in [&[x, turn][..], &Column::of_pose(), &[]] {
        let read = parse_csv("f.csv", bytes, columns);
        if let Ok((named, rows)) = &read {
            let names: Vec<_> = named.iter().map(ToString::to_string).collect();
            let again = parse_csv("f.csv", csv_text(&names, rows).as_bytes(), columns);
            // Without names, rows of any length are taken: a line of names says how long they are.
            let fits = named.is_empty() || rows[0].len() == named.len();
            assert!(!fits || again.is_ok_and(|again| again == (named.clone(), rows.clone())), "{names:?}");
        }
        if columns.is_empty() {
            read?;
        }
    }
    Ok(())
}

/// Trajectories of a robot of two joints, in all their formats.
///
/// # Errors
/// When the bytes are a trajectory in none of them, and are refused by one.
pub fn trajectory(bytes: &[u8]) -> Result<(), Error> {
    use TrajectoryKind::{Csv, Json, Mcap, Yaml};
    let columns = [Column::new("lift", "m"), Column::new("elbow", "rad")];
    let parse = |bytes: &[u8], kind| TrajectoryFile::parse("f", bytes, kind, &columns);
    let all = [Csv, Json, Yaml, Mcap].map(|kind| parse(bytes, kind).map(|read| (read, kind)));
    for (read, kind) in all.iter().flatten() {
        let Some(read) = read else { continue };
        match (parse(&read.to_bytes(*kind), *kind), kind) {
            (again, Csv) => assert_eq!(again.ok().flatten().as_ref(), Some(read)),
            // Times that are no whole nanoseconds may meet.
            (again, _) => assert!(again.ok().flatten().is_none_or(|again| again.positions == read.positions)),
        }
    }
    let is_one = all.iter().flatten().any(|(read, _)| read.is_some());
    all.into_iter().find_map(Result::err).filter(|_| !is_one).map_or(Ok(()), Err)
}

/// Limits of joints of MoveIt.
///
/// # Errors
/// When the bytes are refused.
pub fn joint_limits(bytes: &[u8]) -> Result<(), Error> {
    crate::robot::limits_of_joints("f.yaml", bytes).map(drop)
}

/// Worlds in the plane.
///
/// # Errors
/// When the bytes are refused.
pub fn planar_world(bytes: &[u8]) -> Result<(), Error> {
    PlanarFile::parse("f.toml", bytes).map(drop)
}

/// Maps of ROS.
///
/// # Errors
/// When the bytes are refused.
pub fn ros_map(bytes: &[u8]) -> Result<(), Error> {
    RosMap::parse("f.yaml", bytes).map(drop)
}

/// Images, and the outline of their dark pixels.
///
/// # Errors
/// When the bytes are refused.
pub fn map_image(bytes: &[u8]) -> Result<(), Error> {
    let grid = GridMap::parse("f.png", bytes)?;
    // Too many corners are an error without a file, which the reader of the problem adds.
    let _ =
        grid.outline_with_alpha(0.5, [0.0; 2], |brightness| brightness < 128.0, &mp_stop::Interrupt::never());
    Ok(())
}

/// Scenes of the editor.
///
/// # Errors
/// When the bytes are refused.
pub fn scene_document(bytes: &[u8]) -> Result<(), Error> {
    let document = SceneDocument::parse("f.mp.json", bytes)?;
    let again = SceneDocument::parse("f.mp.json", document.to_text().as_bytes());
    assert_eq!(again.as_ref().ok(), Some(&document));
    let missing = |file: &str| Err(Error::new(ErrorKind::Io, file, "there is no such mesh"));
    let _ = document.problem("f.mp.json", &missing);
    Ok(())
}

/// Files of all formats, and what is said about those that are refused: the first line names a target, the rest is
/// for it.
///
/// # Errors
/// When the bytes are refused; the error was checked.
pub fn errors(bytes: &[u8]) -> Result<(), Error> {
    let end = bytes.iter().position(|b| *b == b'\n').unwrap_or(bytes.len());
    let (name, rest) = bytes.split_at(end);
    let others = TARGETS.iter().filter(|(other, _)| *other != "errors");
    let Some((_, target)) = others.into_iter().find(|(other, _)| other.as_bytes() == name) else {
        return Ok(());
    };
    target(rest.get(1..).unwrap_or_default()).inspect_err(check_error)
}

/// Checks that the writer's text of a valid file reads back as the same value.
fn round_trips<T: PartialEq + Debug>(
    bytes: &[u8],
    read: impl Fn(&[u8]) -> Result<T, Error>,
    text: impl Fn(&T) -> String,
) -> Result<(), Error> {
    let value = read(bytes)?;
    assert_eq!(read(text(&value).as_bytes()).ok(), Some(value));
    Ok(())
}

fn same_triangles(mesh: &TriMesh, again: &Result<TriMesh, Error>) {
    let all = |m: &TriMesh| (0..m.triangles().len()).map(|i| m.triangle(i)).collect::<Vec<_>>();
    assert_eq!(again.as_ref().ok().map(all), Some(all(mesh)));
}
