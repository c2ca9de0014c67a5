//! Entry points for fuzzing: one function for each format, to be called with any bytes at all.
//!
//! Each reads the bytes and, when they are valid, checks that writing and reading again gives the same. None
//! may panic, whatever the bytes. The test `fuzz` of this crate calls them with mutated files, as many as
//! `MP_FUZZ_ITERATIONS` says; `docs/fuzzing.md` tells how to call them from a coverage-guided fuzzer.

use crate::collada::Scene;
use crate::{
    Environment, Error, ErrorKind, GridMap, JointPath, OffDocument, OmplProblem, PathFile, PlanarFile,
    RobotFile, RosMap, SceneDocument,
};
use crate::{csv_text, gempa_mesh_text, parse_csv, parse_gempa_mesh, parse_obj, parse_stl, stl_text};
use mp_geom::TriMesh;
use std::fmt::Debug;

/// Reads any bytes; returns whether they were valid.
pub type Target = fn(&[u8]) -> bool;

/// The formats: a name, and the function to call.
pub const TARGETS: [(&str, Target); 17] = [
    ("off", off),
    ("gempa-mesh", gempa_mesh),
    ("gempa-environment", gempa_environment),
    ("gempa-path", gempa_path),
    ("json-path", json_path),
    ("stl", stl),
    ("obj", obj),
    ("collada", collada),
    ("ompl-app", ompl_app),
    ("robot-problem", robot_problem),
    ("joint-path", joint_path),
    ("json-joint-path", json_joint_path),
    ("csv-path", csv_path),
    ("planar-world", planar_world),
    ("ros-map", ros_map),
    ("map-image", map_image),
    ("scene-document", scene_document),
];

/// OFF documents.
pub fn off(bytes: &[u8]) -> bool {
    let Some(document) = valid(OffDocument::parse("f.off", bytes)) else { return false };
    let again = valid(OffDocument::parse("f.off", document.to_text().as_bytes()));
    assert_eq!(again.as_ref(), Some(&document));
    valid(document.to_mesh("f.off")).is_some()
}

/// GEMPA `.txt` meshes.
pub fn gempa_mesh(bytes: &[u8]) -> bool {
    let Some(mesh) = valid(parse_gempa_mesh("f.txt", bytes)) else { return false };
    same_triangles(&mesh, valid(parse_gempa_mesh("f.txt", gempa_mesh_text(&mesh).as_bytes())));
    true
}

/// GEMPA environments.
pub fn gempa_environment(bytes: &[u8]) -> bool {
    round_trips(bytes, |b| Environment::parse("f.env", b), Environment::to_text)
}

/// GEMPA configuration files.
pub fn gempa_path(bytes: &[u8]) -> bool {
    round_trips(bytes, |b| PathFile::parse("f.txt", b), PathFile::to_text)
}

/// Paths in JSON.
pub fn json_path(bytes: &[u8]) -> bool {
    round_trips(bytes, |b| PathFile::parse_json("f.json", b), PathFile::to_json)
}

/// STL, text and binary.
pub fn stl(bytes: &[u8]) -> bool {
    let Some(mesh) = valid(parse_stl("f.stl", bytes)) else { return false };
    same_triangles(&mesh, valid(parse_stl("f.stl", stl_text(&mesh).as_bytes())));
    true
}

/// OBJ.
pub fn obj(bytes: &[u8]) -> bool {
    valid(parse_obj("f.obj", bytes)).is_some()
}

/// COLLADA.
pub fn collada(bytes: &[u8]) -> bool {
    let Some(scene) = valid(Scene::parse("f.dae", bytes)) else { return false };
    let _ = scene.center();
    valid(scene.to_mesh("f.dae")).is_some()
}

/// OMPL.app problems.
pub fn ompl_app(bytes: &[u8]) -> bool {
    valid(OmplProblem::parse("f.cfg", bytes)).is_some()
}

/// Robot problems.
pub fn robot_problem(bytes: &[u8]) -> bool {
    valid(RobotFile::parse("f.toml", bytes)).is_some()
}

/// Paths of joint values.
pub fn joint_path(bytes: &[u8]) -> bool {
    round_trips(bytes, |b| JointPath::parse("f.txt", b), JointPath::to_text)
}

/// Paths of joint values in JSON.
pub fn json_joint_path(bytes: &[u8]) -> bool {
    round_trips(bytes, |b| JointPath::parse_json("f.json", b), JointPath::to_json)
}

/// Paths as comma-separated values.
pub fn csv_path(bytes: &[u8]) -> bool {
    round_trips(bytes, |b| parse_csv("f.csv", b), |rows| csv_text(&[], rows))
}

/// Worlds in the plane.
pub fn planar_world(bytes: &[u8]) -> bool {
    valid(PlanarFile::parse("f.toml", bytes)).is_some()
}

/// Maps of ROS.
pub fn ros_map(bytes: &[u8]) -> bool {
    valid(RosMap::parse("f.yaml", bytes)).is_some()
}

/// Images, and the outline of their dark pixels.
pub fn map_image(bytes: &[u8]) -> bool {
    let Some(grid) = valid(GridMap::parse("f.png", bytes)) else { return false };
    grid.outline(0.5, [0.0; 2], |brightness| brightness < 128.0, &mp_stop::Interrupt::never()).is_ok()
}

/// Scenes of the editor.
pub fn scene_document(bytes: &[u8]) -> bool {
    let Some(document) = valid(SceneDocument::parse("f.mp.json", bytes)) else { return false };
    let again = valid(SceneDocument::parse("f.mp.json", document.to_text().as_bytes()));
    assert_eq!(again.as_ref(), Some(&document));
    let missing = |file: &str| Err(Error::new(ErrorKind::Io, file, "there is no such mesh"));
    let _ = valid(document.problem("f.mp.json", &missing));
    true
}

/// Whether the bytes are valid. Checks that writing the value and reading it again gives the same.
fn round_trips<T: PartialEq + Debug>(
    bytes: &[u8],
    read: impl Fn(&[u8]) -> Result<T, Error>,
    text: impl Fn(&T) -> String,
) -> bool {
    let Some(value) = valid(read(bytes)) else { return false };
    assert_eq!(valid(read(text(&value).as_bytes())), Some(value));
    true
}

/// The value that was read. Checks of an error that it can be shown: one line, a place inside the file, a remedy.
fn valid<T>(read: Result<T, Error>) -> Option<T> {
    let error = match read {
        Ok(value) => return Some(value),
        Err(error) => error,
    };
    let line = error.to_string();
    assert!(!line.contains('\n') && line.chars().count() < 500, "{line}");
    assert!(error.line().is_none_or(|l| l > 0) && error.column().is_none_or(|c| c > 0));
    assert!(error.remedy().is_some(), "{line}");
    let report = error.report();
    assert!(report.lines().count() <= 4 && report.chars().count() < 500, "{report}");
    None
}

fn same_triangles(mesh: &TriMesh, again: Option<TriMesh>) {
    let all = |m: &TriMesh| (0..m.triangles().len()).map(|i| m.triangle(i)).collect::<Vec<_>>();
    assert_eq!(again.map(|m| all(&m)), Some(all(mesh)));
}
