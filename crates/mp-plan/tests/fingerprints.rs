//! Every planner by name on every shipped scene comes to the same, bit for bit, as when `fingerprints.txt` was made.
//!
//! A line is a case and what came of it: scene, planner, seed, iterations, options of the command line; then how it
//! ended, its counters, the bits of lengths and clearance, and a hash of the numbers of the path. A deliberate change
//! of behaviour is a change of the table, with its reason in the commit:
//!
//! ```text
//! cargo test --release -p mp-plan --test fingerprints
//! MP_WRITE_FINGERPRINTS=1 cargo test --release -p mp-plan --test fingerprints   # writes it anew
//! ```

use mp_plan::{Cancel, Finish, Report, Request, Scene, in_parallel};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

fn table() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fingerprints.txt")
}

/// The request of a case: planner, seed, iterations, options.
fn request(words: &[&str]) -> Request {
    let mut request =
        Request::new(words[0]).seed(words[1].parse().unwrap()).iterations(words[2].parse().unwrap());
    request.budget.time_s = None;
    let mut options = words[3..].iter();
    while let Some(option) = options.next() {
        let mut value = || *options.next().unwrap();
        match *option {
            "--metric" => request.metric = value().parse().unwrap(),
            "--motion" => request.motion = value().parse().unwrap(),
            "--step" => request = request.set("step", value()),
            "--relax" => request.finish = Finish::Relax,
            "--no-shorten" => request.finish = Finish::AsFound,
            other => panic!("{other}"),
        }
    }
    request
}

/// What came of a case.
fn line(case: &str, report: &Report) -> String {
    let bits = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), |v| format!("{:016x}", v.to_bits()));
    let ended = report.stopped_by.map_or("solved", |by| by.word());
    format!(
        "{case} = {ended} iterations {} nodes {} edges {} motions {} queries {} rejected {} found {} length {} clearance {} path {}",
        report.iterations,
        report.nodes,
        report.edges.map_or_else(|| "-".to_owned(), |n| n.to_string()),
        report.motion_checks,
        report.collision_checks,
        report.rejected,
        bits(report.path_length_found),
        bits(report.path_length),
        bits(report.clearance),
        report.fingerprint.as_deref().unwrap_or("-"),
    )
}

/// Runs the cases and compares them with the table.
fn compare() {
    let text = std::fs::read_to_string(table()).unwrap();
    let cases: Vec<(&str, &str)> =
        text.lines().map(|expected| (expected, expected.split_once(" = ").unwrap().0)).collect();
    let mut scenes: BTreeMap<&str, Scene> = BTreeMap::new();
    for (_, case) in &cases {
        let name = case.split(' ').next().unwrap();
        scenes.entry(name).or_insert_with(|| Scene::find(name).unwrap());
    }
    let run = |i: usize| {
        let words: Vec<&str> = cases[i].1.split(' ').collect();
        match scenes[words[0]].plan(&request(&words[1..])) {
            Ok(report) => line(cases[i].1, &report),
            Err(_) => format!("{} = error", cases[i].1),
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let lines: Vec<String> =
        in_parallel(cases.len(), threads, &Cancel::new(), run).into_iter().flatten().collect();
    if std::env::var_os("MP_WRITE_FINGERPRINTS").is_some() {
        std::fs::write(table(), lines.join("\n") + "\n").unwrap();
    }
    let differ = cases.iter().zip(&lines).filter(|((expected, _), found)| expected != found);
    let wrong: Vec<String> = differ.map(|((was, _), is)| format!("was {was}\nis  {is}")).collect();
    assert!(wrong.is_empty(), "{} of {} differ:\n{}", wrong.len(), lines.len(), wrong.join("\n"));
}

#[test]
fn all_is_as_it_was() {
    compare();
}

#[test]
fn every_planner_is_in_the_table_on_every_scene() {
    let text = std::fs::read_to_string(table()).unwrap();
    for scene in Scene::shipped() {
        for planner in mp_plan::planners() {
            let case = format!("{scene} {} 1 ", planner.name);
            assert!(text.lines().any(|line| line.starts_with(&case)), "{case}is not in the table");
        }
    }
}
