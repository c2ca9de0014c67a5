//! Certificates of paths are replayed by `mp_verify_certificate`, which shares no code with this crate; damaged ones are refused.

use mp_plan::{Interrupt, PathRows, Request, Scene};
use mp_verify_certificate::{is_of_path, verify};
use serde_json::{Value, json};

/// A path through a shipped scene, and its certificate.
fn certified(name: &str) -> (PathRows, String) {
    let scene = Scene::find(name).unwrap();
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
    for name in Scene::shipped() {
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
            (obstacle["frame"], obstacle["vertices"], obstacle["pieces"]) =
                (robot["frame"].clone(), robot["vertices"].clone(), robot["pieces"].clone());
        });
    }
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
