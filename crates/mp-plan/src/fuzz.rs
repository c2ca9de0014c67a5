//! Entry points for fuzzing, as those of [`mp_io::fuzz`]: everything that is read above single files. Scenes with the files that
//! they name, robots, requests, options, reports, roadmaps.
//!
//! None may panic, hang or take memory out of proportion, whatever the bytes.

use crate::files::info::SceneInfo;
use crate::{Error, Length, MotionValidator, PathFileKind, RelaxField, Report, Request, Scene};
use mp_cspace::Configuration;
use mp_io::InMemory;
use mp_robot::{ArmModel, Kinematics};
use std::path::Path;
use std::str::FromStr;
use std::sync::OnceLock;

/// Reads any bytes. The error is the one that refuses them.
pub type Target = fn(&[u8]) -> Result<(), Error>;

/// What is read: a name, and the function to call.
pub const TARGETS: [(&str, Target); 13] = [
    ("scene-gempa", scene_gempa),
    ("scene-ompl", scene_ompl),
    ("scene-problem", scene_problem),
    ("scene-editor", scene_editor),
    ("scene-map", scene_map),
    ("urdf", urdf),
    ("srdf", srdf),
    ("request", request),
    ("options", options),
    ("report", report),
    ("checked-path", checked_path),
    ("roadmap", roadmap),
    ("plan-errors", errors),
];

/// GEMPA environments with their meshes.
///
/// # Errors
/// When the bytes are refused, as for all targets.
pub fn scene_gempa(bytes: &[u8]) -> Result<(), Error> {
    scene("f.env", bytes)
}

/// OMPL.app problems with their meshes.
///
/// # Errors
/// When the bytes are refused.
pub fn scene_ompl(bytes: &[u8]) -> Result<(), Error> {
    scene("f.cfg", bytes)
}

/// Problems in TOML: of arms, of rigid bodies, and in the plane, with meshes, robots and maps.
///
/// # Errors
/// When the bytes are refused.
pub fn scene_problem(bytes: &[u8]) -> Result<(), Error> {
    scene("f.toml", bytes)
}

/// Scenes of the editor.
///
/// # Errors
/// When the bytes are refused.
pub fn scene_editor(bytes: &[u8]) -> Result<(), Error> {
    scene("f.mp.json", bytes)
}

/// Maps of ROS with an image, of which scenes are made.
///
/// # Errors
/// When the bytes are refused.
pub fn scene_map(bytes: &[u8]) -> Result<(), Error> {
    scene("f.yaml", bytes)
}

/// Robots in URDF.
///
/// # Errors
/// When the bytes are refused.
pub fn urdf(bytes: &[u8]) -> Result<(), Error> {
    let model = ArmModel::from_urdf(text(bytes)?, |name| tetrahedron(name).map_err(|e| e.to_string()));
    Kinematics::new(&model.map_err(|e| Error::new(e.to_string()).help(e.remedy()))?)?;
    Ok(())
}

/// Pairs of links in SRDF.
///
/// # Errors
/// When the bytes are refused.
pub fn srdf(bytes: &[u8]) -> Result<(), Error> {
    let read = ArmModel::default().with_srdf(text(bytes)?);
    read.map(drop).map_err(|e| Error::new(e.to_string()).help(e.remedy()))
}

/// Requests to plan in JSON, with the names of planners and their settings.
///
/// # Errors
/// When the bytes are refused.
pub fn request(bytes: &[u8]) -> Result<(), Error> {
    let json =
        |e: serde_json::Error| Error::new(format!("not a request: {e}")).help("docs/formats describes it");
    let request: Request = serde_json::from_slice(bytes).map_err(json)?;
    let written = serde_json::to_string(&request).map_err(json)?;
    assert_eq!(serde_json::from_str::<Request>(&written).ok().as_ref(), Some(&request), "{written}");
    request.check()?;
    if request.roadmap.is_none() {
        small_scene().prepare(&request)?;
    }
    Ok(())
}

/// Values of options: lengths, checks of motions, metrics, fields, views, numbers.
///
/// # Errors
/// When no option has such a value.
pub fn options(bytes: &[u8]) -> Result<(), Error> {
    let text = text(bytes)?;
    let read = [
        same::<Length>(text),
        same::<MotionValidator>(text),
        same::<crate::MetricName>(text),
        same::<RelaxField>(text),
        text.parse::<mp_render::View>().map(drop).map_err(|e| Error::new(e.to_string())),
        text.parse::<mp_render::Mode>().map(drop).map_err(|e| Error::new(e.to_string())),
        crate::positive_number(text).map(drop).map_err(Error::new),
    ];
    read.into_iter().reduce(Result::or).unwrap_or(Ok(()))
}

/// Reports in JSON.
///
/// # Errors
/// When the bytes are refused.
pub fn report(bytes: &[u8]) -> Result<(), Error> {
    let report = Report::from_json(text(bytes)?)?;
    // A report may hold numbers that are not finite only if it was not read from JSON.
    let again = Report::from_json(&report.to_json()?)?;
    assert_eq!(again, report);
    Ok(())
}

/// Paths through a small scene, which are checked.
///
/// # Errors
/// When the bytes are refused.
pub fn checked_path(bytes: &[u8]) -> Result<(), Error> {
    let scene = small_scene();
    let path = scene.parse_path("f.csv", bytes, PathFileKind::Csv)?;
    let verdict = scene.check(&path)?;
    // What is free as it was read is free as it is written.
    let again = scene.parse_path("f.csv", path.to_csv().as_bytes(), PathFileKind::Csv)?;
    assert_eq!(scene.check(&again)?, verdict);
    Ok(())
}

/// Saved roadmaps, of the states that the first byte says. The beginning and the checksum are made right: those are not what is
/// difficult.
///
/// # Errors
/// When the bytes are refused.
pub fn roadmap(bytes: &[u8]) -> Result<(), Error> {
    /// Any number.
    const FINGERPRINT: u64 = 7;
    let empty = mp_roadmap::Roadmap::<Configuration, ()>::new().to_bytes(FINGERPRINT);
    // Magic number, version and fingerprint are before the counts.
    let mut file = empty[..20].to_vec();
    file.extend_from_slice(bytes);
    file.extend(xxhash_rust::xxh3::xxh3_64(&file).to_le_bytes());
    let read = mp_roadmap::Roadmap::<Configuration, ()>::from_bytes(&file, FINGERPRINT);
    let map =
        read.map_err(|e| Error::new(e.to_string()).help("delete the file, and build the roadmap anew"))?;
    let again = mp_roadmap::Roadmap::<Configuration, ()>::from_bytes(&map.to_bytes(FINGERPRINT), FINGERPRINT);
    let again = again.unwrap_or_else(|e| panic!("what was written cannot be read: {e}"));
    assert_eq!(again.to_bytes(FINGERPRINT), map.to_bytes(FINGERPRINT));
    Ok(())
}

/// Bytes for all targets, and what is said about those that are refused: the first line names a target, the rest is for it.
///
/// # Errors
/// When the bytes are refused; the error was checked.
pub fn errors(bytes: &[u8]) -> Result<(), Error> {
    let end = bytes.iter().position(|b| *b == b'\n').unwrap_or(bytes.len());
    let (name, rest) = bytes.split_at(end);
    let mut others = TARGETS.iter().filter(|(other, _)| *other != "plan-errors");
    let Some((_, target)) = others.find(|(other, _)| other.as_bytes() == name) else { return Ok(()) };
    target(rest.get(1..).unwrap_or_default()).inspect_err(check_error)
}

/// Checks that an error can be shown.
///
/// # Panics
/// When it cannot.
pub fn check_error(error: &Error) {
    let line = error.to_string();
    assert!(!line.contains(char::is_control) && line.chars().count() < 500, "{line}");
    let report = error.report();
    assert!(report.chars().count() < 1000, "{report}");
    assert!(!report.contains(|c: char| c.is_control() && !matches!(c, '\n' | '\t')), "{report:?}");
    if let Some(file) = error.file() {
        mp_io::fuzz::check_error(file);
    }
}

/// Loads a scene from these bytes and the files below, and describes it.
fn scene(name: &str, bytes: &[u8]) -> Result<(), Error> {
    let files = InMemory(|path: &str| match path.rsplit_once('.').map_or("", |(_, ending)| ending) {
        _ if path == name => Some(bytes),
        "off" => Some(TETRAHEDRON.as_bytes()),
        "urdf" => Some(ARM.as_bytes()),
        "srdf" => Some(MAY_TOUCH.as_bytes()),
        "yaml" => Some(MAP.as_bytes()),
        "pgm" => Some(IMAGE.as_bytes()),
        _ => None,
    });
    let scene = Scene::load_from(&files, Path::new(name))?;
    let _ = SceneInfo::of(&scene);
    Ok(())
}

/// A scene that takes no time: a tetrahedron beside another.
fn small_scene() -> &'static Scene {
    static SCENE: OnceLock<Scene> = OnceLock::new();
    SCENE.get_or_init(|| {
        let text = "Robot\nr.off\n0 0 0 0 0 0\n4 0 0 0 0 0\nObstacle #1\no.off\n2 0 0 0 0 0\nEnd\n";
        let files = InMemory(|path: &str| {
            Some(if path.ends_with("env") { text.as_bytes() } else { TETRAHEDRON.as_bytes() })
        });
        Scene::load_from(&files, Path::new("small.env")).unwrap_or_else(|e| panic!("{e}"))
    })
}

fn text(bytes: &[u8]) -> Result<&str, Error> {
    std::str::from_utf8(bytes).map_err(|e| Error::new(format!("not a text: {e}")).help("save it as UTF-8"))
}

/// Checks that a value is written as it reads.
fn same<T: FromStr<Err: Into<Error>> + ToString + PartialEq>(text: &str) -> Result<(), Error> {
    let value: T = text.parse().map_err(Into::into)?;
    let written = value.to_string();
    assert!(written.parse::<T>().ok() == Some(value), "{text:?} is written as {written:?}");
    Ok(())
}

fn tetrahedron(name: &str) -> Result<mp_geom::TriMesh, mp_io::Error> {
    mp_io::read_mesh_of(&InMemory(|_: &str| Some(TETRAHEDRON)), Path::new(name))
}

/// A mesh.
const TETRAHEDRON: &str = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

/// An arm with two joints.
const ARM: &str = "<robot name=\"a\"><link name=\"base\"/><link name=\"upper\"><collision><origin xyz=\"0.5 0 0\"/><geometry>\
<box size=\"1 0.1 0.1\"/></geometry></collision></link><link name=\"lower\"><collision><geometry><mesh filename=\"m.off\"/>\
</geometry></collision></link><joint name=\"j1\" type=\"revolute\"><parent link=\"base\"/><child link=\"upper\"/>\
<axis xyz=\"0 0 1\"/><limit lower=\"-2\" upper=\"2\"/></joint><joint name=\"j2\" type=\"revolute\"><origin xyz=\"1 0 0\"/>\
<parent link=\"upper\"/><child link=\"lower\"/><axis xyz=\"0 1 0\"/><limit lower=\"-1\" upper=\"1\"/></joint></robot>";

/// Which links of it may touch.
const MAY_TOUCH: &str = "<robot name=\"a\"><disable_collisions link1=\"upper\" link2=\"lower\"/></robot>";

const MAP: &str = "image: m.pgm\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
const IMAGE: &str =
    "P2\n5 4\n255\n255 255 255 255 255\n255 255 0 255 255\n255 255 0 255 255\n255 255 255 255 255\n";
