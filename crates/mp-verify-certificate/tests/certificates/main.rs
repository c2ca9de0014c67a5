//! Certificates of paths are replayed by `mp_verify_certificate`, which shares no code with the crates that make them; damaged ones are refused.

mod changed;
mod clouds;
mod curves;
mod look;

use mp_plan::{Interrupt, PathRows, Request, Scene};
use mp_verify_certificate::{is_of_meshes, is_of_path, verify};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock};

/// A path, and its certificate.
type Certified = (PathRows, String);

/// A path through a shipped scene, and its certificate: made once for all tests.
fn certified(name: &str) -> Certified {
    static MADE: Mutex<BTreeMap<String, Arc<OnceLock<Certified>>>> = Mutex::new(BTreeMap::new());
    let made = MADE.lock().unwrap().entry(name.to_owned()).or_default().clone();
    made.get_or_init(|| certified_in(&Scene::find(name).unwrap())).clone()
}

/// The same for any scene.
fn certified_in(scene: &Scene) -> Certified {
    let name = scene.name();
    let report = scene.plan(&Request::new(scene.default_planner())).unwrap();
    let rows = report.path.unwrap_or_else(|| panic!("{name}: {:?}", report.why));
    let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
    let clearance = report.clearance.unwrap();
    let certificate = scene.certificate(&path, clearance, &Interrupt::never()).unwrap();
    assert!(certificate.clearance() >= Some(0.5 * clearance), "{name}");
    (path, certificate.to_json().to_owned())
}

/// The text of a changed certificate, with the checksum that belongs to it.
fn sealed(mut file: Value) -> String {
    file.as_object_mut().unwrap().remove("checksum");
    let text = file.to_string();
    let text = text.strip_suffix('}').unwrap();
    format!("{text},\n\"checksum\":\"{:032x}\"}}", xxhash_rust::xxh3::xxh3_128(text.as_bytes()))
}

#[test]
fn every_shipped_scene_has_a_certificate_that_another_program_replays() {
    for name in mp_scenes::without_solution() {
        let (path, text) = certified(name);
        let proved = verify(&text).unwrap_or_else(|why| panic!("{name}: {why}"));
        assert_eq!((proved.scene.as_str(), proved.configurations), (name, path.rows.len()));
        assert!(proved.clearance > Some(0.0) && proved.parts >= proved.edges, "{name}");
        for file in [path.to_text(), path.to_json(), path.to_csv()] {
            assert_eq!(is_of_path(&text, &file), Ok(()), "{name}");
        }
        let mut other = path.clone();
        other.rows[1][0] += 1e-9;
        assert!(is_of_path(&text, &other.to_text()).is_err(), "{name}");
        other.rows.pop();
        assert!(is_of_path(&text, &other.to_csv()).is_err(), "{name}");
    }
}

/// The same numbers under other names are another path.
#[test]
fn the_columns_of_a_path_are_those_of_its_certificate() {
    let (path, text) = certified("arm");
    let csv = path.to_csv();
    let (header, rows) = csv.split_once('\n').unwrap();
    let turned = header.split(',').rev().collect::<Vec<_>>().join(",");
    let bare = header.replace(" [rad]", "");
    for (header, same) in [
        (header, true),
        (&bare, true),
        (&turned, false),
        ("a,b,c,d,e,f", false),
        (&header.replace("rad", "deg"), false),
    ] {
        assert_eq!(is_of_path(&text, &format!("{header}\n{rows}")).is_ok(), same, "{header}");
        let names: Vec<&str> = header.split(',').collect();
        let json = json!({ "columns": names, "path": path.rows }).to_string();
        assert_eq!(is_of_path(&text, &json).is_ok(), same, "{header}");
    }
}

/// Rows and names that another reader sees are not passed over, and what looks like a count may be a configuration.
#[test]
fn nothing_in_the_file_of_a_path_is_passed_over() {
    let (path, text) = certified("arm");
    let json = |key: &str, names: Vec<String>| json!({ (key): names, "path": path.rows }).to_string();
    let names: Vec<String> = path.columns.iter().map(|column| column.name.clone()).collect();
    for key in ["columns", "names", "joint_names", "jointNames", "name"] {
        assert_eq!(is_of_path(&text, &json(key, names.clone())), Ok(()), "{key}");
        let turned = names.iter().rev().cloned().collect();
        assert!(is_of_path(&text, &json(key, turned)).unwrap_err().contains("columns"), "{key}");
    }
    let csv = path.to_csv();
    assert_eq!(is_of_path(&text, &csv), Ok(()));
    let (header, rows) = csv.split_once('\n').unwrap();
    for more in ["\"0\",\"0\",\"0\",\"0\",\"0\",\"0\"", "0;0;0;0;0;0", "0,0,0,0,0,0 # x"] {
        let (one, others) = rows.split_once('\n').unwrap();
        let why = is_of_path(&text, &format!("{header}\n{one}\n{more}\n{others}")).unwrap_err();
        assert!(why.contains("is not numbers"), "{more}: {why}");
    }
    // Rows alone, the first of which begins with the number of the others.
    let rows = path.to_text();
    let (_, rows) = rows.split_once('\n').unwrap();
    assert_eq!(is_of_path(&text, rows), Ok(()));
    let first = format!("{} 0 0 0 0 0\n", path.rows.len());
    assert!(is_of_path(&text, &(first + rows)).unwrap_err().contains("configurations"));
}

/// One of each kind of robot and of motion.
const KINDS: [&str; 11] = [
    "accelerations",
    "arm",
    "blade",
    "crossing",
    "easy",
    "flyer",
    "parking",
    "planar-bugtrap",
    "rrs-low",
    "velocities",
    "wrench",
];

#[test]
fn a_certificate_of_which_one_number_was_changed_is_refused() {
    for name in KINDS {
        let (_, text) = certified(name);
        let body = text.rfind(",\n\"checksum\"").unwrap();
        let digits: Vec<usize> =
            text.bytes().enumerate().filter(|(_, c)| c.is_ascii_digit()).map(|d| d.0).collect();
        for i in (0..200).map(|i| digits[i * digits.len() / 200]).filter(|i| *i < body) {
            let mut changed = text.clone().into_bytes();
            changed[i] = if changed[i] == b'9' { b'8' } else { changed[i] + 1 };
            let why = verify(&String::from_utf8(changed).unwrap()).unwrap_err();
            assert!(why.contains("checksum"), "{why}");
        }
    }
}

/// Also with a checksum that belongs to the change, a proof that does not hold is refused.
#[test]
fn a_proof_that_does_not_hold_is_refused() {
    for name in KINDS {
        let (_, text) = certified(name);
        let file: Value = serde_json::from_str(&text).unwrap();
        assert!(verify(&sealed(file.clone())).is_ok(), "{name}");
        let refused = |what: &str, change: &dyn Fn(&mut Value)| {
            let mut changed = file.clone();
            change(&mut changed);
            assert_ne!(changed, file, "{name}: {what}");
            verify(&sealed(changed)).map(|_| ()).expect_err(&format!("{name}: {what}"))
        };
        let scaled = |value: &mut Value, factor: f64| *value = json!(value.as_f64().unwrap() * factor);

        let why = refused("more clearance than proved", &|file| scaled(&mut file["clearance"], 1.01));
        assert!(why.contains("do not leave"), "{name}: {why}");
        let pairs = file["model"]["pairs"].as_array().unwrap().len();
        let edges = file["edges"].as_array().unwrap().len();
        for (edge, pair) in [(0, 0), (edges / 2, pairs / 2), (edges - 1, pairs - 1)] {
            let why = refused("less distance", &|file| scaled(&mut file["edges"][edge][pair][0][1], 0.99));
            assert!(why.contains("do not leave"), "{name}: {why}");
            let why = refused("more distance", &|file| scaled(&mut file["edges"][edge][pair][0][1], 1e9));
            assert!(why.contains("m apart"), "{name}: {why}");
            let parts = file["edges"][edge][pair].as_array().unwrap().len();
            let why = refused("an end left out", &|file| {
                scaled(&mut file["edges"][edge][pair][parts - 1][0], 0.999);
            });
            assert!(why.contains("ends at") || why.contains("out of order"), "{name}: {why}");
            let why = refused("a part left out", &|file| {
                file["edges"][edge][pair].as_array_mut().unwrap().remove(0);
            });
            assert!(["ends at", "do not leave", "m apart"].iter().any(|w| why.contains(w)), "{name}: {why}");
            refused("parts that go back", &|file| {
                let first = file["edges"][edge][pair][0].clone();
                file["edges"][edge][pair].as_array_mut().unwrap().push(first);
            });
        }
        let why = refused("a pair left out", &|file| {
            file["model"]["pairs"].as_array_mut().unwrap().pop();
            file["edges"]
                .as_array_mut()
                .unwrap()
                .iter_mut()
                .for_each(|edge| drop(edge.as_array_mut().unwrap().pop()));
        });
        assert!(why.contains("nothing is said"), "{name}: {why}");
        let why = refused("a robot as large as the world", &|file| {
            file["model"]["bodies"][0]["radius"] = json!(1e3)
        });
        assert!(["do not leave", "m apart"].iter().any(|w| why.contains(w)), "{name}: {why}");
        let rows = file["path"].as_array().unwrap().len();
        refused("a detour", &|file| {
            let at = &mut file["path"][rows / 2][0];
            *at = json!(at.as_f64().unwrap() + 1.0);
        });
        refused("no detour", &|file| {
            file["path"].as_array_mut().unwrap().drain(1..rows - 1);
            file["edges"].as_array_mut().unwrap().truncate(1);
        });
        refused("an obstacle where the robot is", &|file| {
            let robot = file["model"]["bodies"][0].clone();
            let pair = file["model"]["pairs"].as_array().unwrap().last().unwrap().clone();
            let body = usize::try_from(pair["body"].as_u64().unwrap()).unwrap();
            let robot = if body == 0 { robot } else { file["model"]["bodies"][body].clone() };
            let other = usize::try_from(pair["others"][0].as_u64().unwrap()).unwrap();
            let obstacle = &mut file["model"]["bodies"][other];
            for member in ["frame", "vertices", "pieces", "parts"] {
                obstacle[member] = robot[member].clone();
            }
        });
    }
}

/// Compares one body of a certificate with a mesh.
fn compared(certificate: &str, name: &str, mesh: impl AsRef<[u8]>) -> Result<Vec<String>, String> {
    is_of_meshes(certificate, &[(name.to_owned(), mesh.as_ref().to_vec())])
}

#[test]
fn bodies_are_the_meshes_of_the_files_of_their_scene() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../mp-scenes/assets/scenes");
    let mut scenes: Vec<_> = std::fs::read_dir(scenes).unwrap().map(|entry| entry.unwrap().path()).collect();
    scenes.retain(|path| path.extension().is_some_and(|e| e == "env"));
    assert!(scenes.len() > 10);
    for path in scenes {
        let problem = mp_io::RigidProblem::load(&path).unwrap();
        if mp_scenes::puzzle(&problem.name).is_some() {
            continue; // They take minutes.
        }
        let (_, certificate) = certified(&problem.name);
        let robot = (&problem.robot.name, &problem.robot.file);
        let obstacles = problem.obstacles.iter().map(|o| (&o.name, &o.file));
        let read =
            |(name, file): (&String, &std::path::PathBuf)| (name.clone(), std::fs::read(file).unwrap());
        let files: Vec<(String, Vec<u8>)> = std::iter::once(robot).chain(obstacles).map(read).collect();
        assert_eq!(is_of_meshes(&certificate, &files), Ok(vec![]), "{}", problem.name);
        // Each with the file of another body: only the same geometry passes.
        for ((name, own), (_, other)) in files.iter().zip(files.iter().cycle().skip(1)) {
            assert_eq!(compared(&certificate, name, other).is_ok(), own == other, "{}: {name}", problem.name);
        }
    }
}

/// A bracket: two faces that are not convex, and quadrilaterals.
const BRACKET: &str = "OFF # a bracket\n12 8 0\n\n0 0 0\n0.9 0 0\n0.9 0.3 0\n0.3 0.3 0 # the inner corner\n0.3 0.9 0\n0 0.9 0\n\
    0 0 0.1\n0.9 0 0.1\n0.9 0.3 0.1\n0.3 0.3 0.1\n0.3 0.9 0.1\n0 0.9 0.1\n\
    6 5 4 3 2 1 0\n6 6 7 8 9 10 11 255 0 0\n4 0 1 7 6\n4 1 2 8 7 0.5 0.5 0.5\n4 2 3 9 8\n4 3 4 10 9\n4 4 5 11 10\n4 5 0 6 11\n";

/// A certificate in a scene with these two meshes: the robot, and an obstacle called `Obstacle #7`.
fn certified_among(folder: &Path, robot: (&str, &[u8]), obstacle: (&str, &[u8])) -> String {
    for (name, bytes) in [robot, obstacle] {
        std::fs::write(folder.join(name), bytes).unwrap();
    }
    let scene = format!(
        "Robot\n{}\n0 0 0.5 0 0 0\n3 0 0.5 1 0 0\nObstacle #7\n{}\n1.5 0 0 0 0 0\nEnd\n",
        robot.0, obstacle.0
    );
    std::fs::write(folder.join("scene.env"), scene).unwrap();
    certified_in(&Scene::find(folder.join("scene.env").to_str().unwrap()).unwrap()).1
}

#[test]
fn a_body_is_compared_with_a_mesh_in_any_format() {
    let folder = tempfile::tempdir().unwrap();
    let mesh =
        mp_io::OffDocument::parse("bracket.off", BRACKET.as_bytes()).unwrap().to_mesh("bracket.off").unwrap();
    // Half of the faces before their vertices, indices from both ends.
    let numbers: Vec<&str> = BRACKET.lines().filter(|line| !line.is_empty()).skip(2).collect();
    let (vertices, faces) = numbers.split_at(12);
    let mut obj = "# exported\nmtllib b.mtl\no bracket\n".to_owned();
    let words = |face: &str| -> Vec<usize> {
        let words: Vec<usize> = face.split(' ').map_while(|word| word.parse().ok()).collect();
        words[1..=words[0]].to_vec()
    };
    let face = |face: &str, index: &dyn Fn(usize) -> String| {
        let corners: Vec<String> = words(face).into_iter().map(index).collect();
        format!("f {}\n", corners.join(" "))
    };
    obj.extend(faces[..4].iter().map(|f| face(f, &|i| format!("{}/1/{}", i + 1, i + 1))));
    obj.extend(vertices.iter().map(|v| format!("v {}\nvn 0 0 1\n", v.split('#').next().unwrap())));
    obj.extend(faces[4..].iter().map(|f| face(f, &|i| (i as i64 - 12).to_string())));
    let mut binary = b"solid, but binary".to_vec();
    binary.resize(80, b' ');
    binary.extend(u32::try_from(mesh.triangles().len()).unwrap().to_le_bytes());
    let mut soup = format!("{}\n", mesh.triangles().len());
    for i in 0..mesh.triangles().len() {
        let corners = mesh.triangle(i);
        binary.extend([0; 12]);
        corners.iter().flat_map(|p| p.iter()).for_each(|x| binary.extend((*x as f32).to_le_bytes()));
        binary.extend([0; 2]);
        corners.iter().for_each(|p| soup += &format!("{} {} {} ", p.x, p.y, p.z));
        soup += if i % 2 == 0 { "\n" } else { "# the next\n" };
    }
    let text = mp_io::stl_text(&mesh);
    let files: [(&str, &[u8]); 5] = [
        ("b.off", BRACKET.as_bytes()),
        ("b.obj", obj.as_bytes()),
        ("b.stl", text.as_bytes()),
        ("bin.stl", &binary),
        ("b.txt", soup.as_bytes()),
    ];
    let robot = ("r.off", mp_io::off_text(&mp_geom::primitives::tetrahedron(0.1).unwrap()));
    for (name, bytes) in files {
        let certificate = certified_among(folder.path(), (robot.0, robot.1.as_bytes()), (name, bytes));
        let others = compared(&certificate, "Obstacle #7", bytes);
        assert_eq!(others, Ok(vec!["robot".to_owned()]), "{name}");
        // The same numbers are the same mesh in any format; those of binary STL are rounded.
        for (other, bytes) in files.iter().filter(|file| file.0 != name) {
            let rounded = [name, other].contains(&"bin.stl");
            assert_eq!(compared(&certificate, "Obstacle #7", bytes).is_ok(), !rounded, "{name} {other}");
        }
    }
}

#[test]
fn another_mesh_under_the_name_of_a_body_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let robot = mp_io::off_text(&mp_geom::primitives::tetrahedron(0.1).unwrap());
    let certificate =
        certified_among(folder.path(), ("r.off", robot.as_bytes()), ("b.off", BRACKET.as_bytes()));
    let compared = |name: &str, mesh: &str| compared(&certificate, name, mesh);
    assert_eq!(compared("robot", &robot), Ok(vec!["Obstacle #7".to_owned()]));
    for (what, changed) in [
        ("another mesh", robot.clone()),
        ("a corner in the last bit", BRACKET.replace("0.3 0.9 0\n", "0.3 0.9000000000000001 0\n")),
        ("another corner of a face", BRACKET.replace("4 0 1 7 6\n", "4 0 1 7 5\n")),
        ("a face the other way round", BRACKET.replace("4 0 1 7 6\n", "4 6 7 1 0\n")),
        ("a face that crosses itself", BRACKET.replace("4 0 1 7 6\n", "4 0 7 1 6\n")),
        ("a face more", BRACKET.replace("12 8 0", "12 9 0") + "3 0 1 2\n"),
        ("a face less", BRACKET.replace("12 8 0", "12 7 0").replace("4 5 0 6 11\n", "")),
    ] {
        assert_ne!(changed, BRACKET, "{what}");
        let why = compared("Obstacle #7", &changed).unwrap_err();
        assert!(why.contains("Obstacle #7 is not the mesh"), "{what}: {why}");
    }
    for unread in [
        "",
        "OFF",
        "OFF\n1 1\n0 0 0",
        "OFF\n1 1 0\n0 0\n3 0 0 0\n",
        "OFF\n1 1 0\n0 0 0\n3 0 0 1\n",
        "COFF\n0 0 0\n",
        "OFF\n99999999999999999999 1 0\n",
        "OFF\n0 18446744073709551615 0\n",
        "OFF\n1 1 0\n0 0 0\n18446744073709551615 0\n",
        "v 0 0 0\nf 1 2 0\n",
        "v 0 0 0\nf -9223372036854775808 1 1\n",
        "curv 1 2\n",
        "solid\nvertex 1 2\n",
        "2\n0 0 0 1 0 0 0 1 0\n",
    ] {
        let why = compared("Obstacle #7", unread).unwrap_err();
        assert!(why.contains("cannot read"), "{unread:?}: {why}");
    }
    let why = compared("wall", BRACKET).unwrap_err();
    assert!(why.contains("no body is called wall") && why.contains("Obstacle #7"), "{why}");
}

#[test]
fn what_cannot_be_certified_is_said() {
    let scene = Scene::find("easy").unwrap();
    let path = |rows: Vec<Vec<f64>>| PathRows { format: scene.path_format(), columns: scene.columns(), rows };
    let (start, goal) = (scene.start(), scene.goals().remove(0));
    let refused = |rows| scene.certificate(&path(rows), 0.0, &Interrupt::never()).unwrap_err().to_string();
    let straight = refused(vec![start.clone(), goal]);
    assert!(straight.contains("between configurations 1 and 2") && straight.contains("hits"), "{straight}");
    assert!(refused(vec![]).contains("no configurations"));
    let mut turned = start.clone();
    turned[3] += std::f64::consts::PI;
    assert!(refused(vec![start.clone(), turned]).contains("half way round"));
    // A path of one configuration is proved too.
    let alone = scene.certificate(&path(vec![start]), 0.0, &Interrupt::never()).unwrap();
    assert_eq!(verify(alone.to_json()).unwrap().edges, 0);
}
