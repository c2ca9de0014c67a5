//! The command line from outside: exit codes, JSON, files, bad input.

use crate::common::{Dir, mp};
use serde_json::Value;

/// Every field of the JSON of one run, and whether it may be null.
const FIELDS: [(&str, bool); 35] = [
    ("version", false),
    ("scene", false),
    ("scene_file", false),
    ("space", false),
    ("solved", false),
    ("verified", false),
    ("stopped_by", true),
    ("why", true),
    ("planner", false),
    ("metric", false),
    ("motion", false),
    ("seed", false),
    ("iterations", false),
    ("nodes", false),
    ("edges", true),
    ("components", true),
    ("motion_checks", false),
    ("collision_checks", false),
    ("rejected", false),
    ("time_s", false),
    ("finish_s", false),
    ("stages", false),
    ("first_s", true),
    ("first_length", true),
    ("first_path", true),
    ("fingerprint", true),
    ("columns", false),
    ("path_length_found", true),
    ("path_length", true),
    ("clearance", true),
    ("shortened", false),
    ("path_file", true),
    ("picture_file", true),
    ("certificate_file", true),
    ("path", true),
];

fn assert_fields(report: &Value, solved: bool) {
    let object = report.as_object().unwrap();
    for (name, may_be_null) in FIELDS {
        let value = object.get(name).unwrap_or_else(|| panic!("no {name} in {report}"));
        assert!(may_be_null || !value.is_null(), "{name} is null");
    }
    // Of the planner `auto` also which search has won.
    let more = usize::from(solved && report["planner"] == "auto");
    assert_eq!(object.len(), FIELDS.len() + more, "{report}");
    assert_eq!(report["solved"], solved);
    assert_eq!(report["verified"], solved);
    assert_eq!(report["stopped_by"].is_null(), solved);
    assert_eq!(report["path"].is_array(), solved);
}

#[test]
fn plan_solves_verifies_and_writes() {
    let dir = Dir::new();
    let run = mp(&dir, &["plan", "window.env", "--json", "--out", "a/p.txt", "--picture", "a/p.png"]);
    assert_eq!(run.code, 0, "{run:?}");
    let report = run.json();
    assert_fields(&report, true);
    assert_eq!((&report["scene"], &report["planner"]), (&"window".into(), &"auto".into()));
    assert_eq!(report["won"], "rrt-connect balance=1");
    assert!(report["path_length"].as_f64() <= report["path_length_found"].as_f64());
    assert!(report["clearance"].as_f64().unwrap() > 0.0);
    let text = dir.read("a/p.txt");
    assert_eq!(text.lines().next(), Some(report["path"].as_array().unwrap().len().to_string().as_str()));
    assert!(dir.bytes("a/p.png").starts_with(b"\x89PNG"));
    assert_eq!(dir.entries("a"), ["p.png", "p.txt"], "no leftovers");

    let check = mp(&dir, &["check", "window.env", "a/p.txt", "--json"]);
    assert_eq!((check.code, &check.json()["free"]), (0, &true.into()), "{check:?}");
}

#[test]
fn a_roadmap_is_kept_and_gone_on_with() {
    let dir = Dir::new();
    let plan = |scene: &str, planner: &str, more: &[&str]| {
        let args = ["plan", scene, "--planner", planner, "--roadmap", "kept.roadmap", "--json"];
        mp(&dir, &[&args[..], more].concat())
    };
    let first = plan("plane.env", "prm", &[]);
    assert_eq!(first.code, 0, "{first:?}");
    assert_fields(&first.json(), true);
    assert!(first.json()["edges"].as_u64() >= Some(1), "{first:?}");
    // Start and goal are connected already.
    let second = plan("plane.env", "prm", &["--iterations", "1"]);
    assert_eq!(second.code, 0, "{second:?}");
    assert!(second.json()["nodes"].as_u64() >= first.json()["nodes"].as_u64());

    for (scene, more, words) in [
        ("window.env", &[][..], "another scene or robot"),
        ("plane.env", &["--metric", "manhattan"][..], "another scene or robot"),
    ] {
        let other = plan(scene, "prm", more);
        assert_eq!(other.code, 2, "{other:?}");
        assert!(other.stderr.contains(words), "{other:?}");
    }
    let tree = plan("plane.env", "rrt-connect", &[]);
    assert!(tree.code == 2 && tree.stderr.contains("has no roadmap"), "{tree:?}");
    let bytes = dir.bytes("kept.roadmap");
    dir.write("kept.roadmap", &bytes[..bytes.len() / 2]);
    let cut = plan("plane.env", "prm", &[]);
    assert!(cut.code == 2 && cut.stderr.contains("cut off"), "{cut:?}");
}

#[test]
fn without_json_a_person_gets_a_summary_and_files() {
    let dir = Dir::new();
    let run = mp(&dir, &["plan", "plane.env"]);
    assert_eq!(run.code, 0, "{run:?}");
    for words in ["plane: solved in", "nodes", "collision queries", "shortened and verified", "clearance"] {
        assert!(run.stdout.contains(words), "{words}: {}", run.stdout);
    }
    assert_eq!(dir.entries("out"), ["plane.path.txt", "plane.png"]);
    assert_eq!(mp(&dir, &["check", "plane", "out/plane.path.txt"]).code, 0);
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_any_number_of_threads() {
    let dir = Dir::new();
    let runs = |threads: &str, folder: &str, time: &str| {
        let out = format!("{folder}/{{scene}}-{{seed}}.txt");
        let args = ["plan", "window.env", "plane.env", "--runs", "2", "--seed", "3", "--json"];
        let run = mp(&dir, &[&args[..], &["--threads", threads, "--out", &out, "--time", time]].concat());
        assert_eq!(run.code, 0, "{run:?}");
        run.json()
    };
    let (one, two) = (runs("1", "one", "100"), runs("2", "two", "1e300"));
    let names = dir.entries("one");
    assert_eq!(names, ["plane-3.txt", "plane-4.txt", "window-3.txt", "window-4.txt"]);
    for name in names {
        assert_eq!(dir.read(&format!("one/{name}")), dir.read(&format!("two/{name}")), "{name}");
    }
    assert_ne!(dir.read("one/window-3.txt"), dir.read("one/window-4.txt"), "seeds differ");
    for (a, b) in one["runs"].as_array().unwrap().iter().zip(two["runs"].as_array().unwrap()) {
        assert_fields(a, true);
        for field in
            ["seed", "scene", "iterations", "nodes", "motion_checks", "collision_checks", "path", "clearance"]
        {
            assert_eq!(a[field], b[field], "{field}");
        }
    }
    assert_eq!(one["solved"], 4);
    assert_eq!(one["medians"][0]["scene"], "window");
    assert_eq!(one["medians"][1]["runs"], 2);
}

#[test]
fn what_cannot_be_solved_is_not_and_nothing_is_written() {
    let dir = Dir::new();
    for planner in ["rrt", "rrt-connect"] {
        for motion in ["certified", "discrete:1%"] {
            let args = ["plan", "closed.env", "--iterations", "2000", "--json", "--out", "p.txt"];
            let run = mp(&dir, &[&args[..], &["--planner", planner, "--motion", motion]].concat());
            assert_eq!(run.code, 1, "{run:?}");
            assert_fields(&run.json(), false);
            assert_eq!(run.json()["stopped_by"], "iterations");
            assert_eq!(run.json()["iterations"], 2000);
        }
    }
    let run = mp(&dir, &["plan", "closed.env", "--time", "0.2"]);
    assert_eq!(run.code, 1, "{run:?}");
    // On a busy machine loading may take all of it.
    let is_told = ["not solved", "not planned"].iter().any(|words| run.stdout.contains(words));
    assert!(is_told && run.stdout.contains("--time"), "{}", run.stdout);
    assert!(!dir.exists("p.txt") && !dir.exists("out"));
}

/// Loading counts: a budget that it uses up is one that is used up.
#[test]
fn loading_may_take_all_of_the_time() {
    let dir = Dir::new();
    let told = mp(&dir, &["plan", "closed.env", "--time", "1e-9"]);
    assert_eq!(told.code, 1, "{told:?}");
    assert!(
        told.stdout.starts_with("closed: not planned: the time is up (--time): loading took all of it\n")
    );
    assert!(told.stdout.contains("until the time was up\n  nothing was written"), "{told:?}");
    let report = mp(&dir, &["plan", "closed.env", "--time", "1e-9", "--json", "--out", "p.txt"]);
    assert_eq!(report.code, 1, "{report:?}");
    let report = report.json();
    assert_fields(&report, false);
    assert_eq!((&report["stopped_by"], &report["stages"][0]["stage"]), (&"time".into(), &"loading".into()));
    assert_eq!(report["stages"][0]["ended_by"], "time");
    assert!(!dir.exists("p.txt"));
    // Each of several scenes by itself.
    let both = mp(&dir, &["plan", "closed.env", "arm", "--time", "1e-9", "--json"]);
    assert_eq!((both.code, both.json()["runs"].as_array().unwrap().len()), (1, 2), "{both:?}");
    // What is wrong with a file is said nevertheless, if there is time.
    let wrong = mp(&dir, &["plan", "no-such-scene", "--time", "1e-9"]);
    assert_eq!(wrong.code, 2, "{wrong:?}");
}

#[test]
fn every_planner_metric_and_motion_check_gives_a_certified_path() {
    let dir = Dir::new();
    let metrics = ["default", "euclidean", "scaled", "manhattan", "max-displacement"];
    let cases = metrics.map(|m| (m, "rrt-connect", "certified"));
    let more = [("default", "rrt", "certified"), ("default", "rrt-connect", "discrete:2%")];
    for (metric, planner, motion) in cases.into_iter().chain(more) {
        for scene in ["window.env", "plane.env"] {
            let args = ["plan", scene, "--json", "--out", "p.json", "--metric", metric, "--planner", planner];
            let run = mp(&dir, &[&args[..], &["--motion", motion]].concat());
            assert_eq!(run.code, 0, "{metric} {planner} {motion}: {run:?}");
            assert_eq!(run.json()["metric"], metric);
            assert_eq!(mp(&dir, &["check", scene, "p.json"]).code, 0);
        }
    }
}

#[test]
fn planners_that_improve_use_the_budget_and_say_what_it_gave() {
    let dir = Dir::new();
    for planner in ["rrt-star", "informed-rrt-star"] {
        let args =
            ["plan", "plane.env", "--planner", planner, "--iterations", "2000", "--json", "--no-shorten"];
        let run = mp(&dir, &args);
        assert_eq!(run.code, 0, "{run:?}");
        let report = run.json();
        assert_fields(&report, true);
        assert_eq!(report["iterations"], 2000);
        let number = |field: &str| report[field].as_f64().unwrap();
        assert!(number("path_length") < number("first_length"), "{report}");
        assert!(number("first_s") < number("time_s"), "{report}");
        // Whatever the search measures by, all lengths are in the metric of the space.
        let other = mp(&dir, &[&args[..], &["--metric", "manhattan"]].concat()).json();
        dir.write("first.json", format!("{{\"path\": {}}}", other["first_path"]));
        let first = mp(&dir, &["check", "plane.env", "first.json", "--json"]).json();
        let [said, is] = [&other["first_length"], &first["path_length"]].map(|x| x.as_f64().unwrap());
        assert!((said - is).abs() < 1e-9 * is, "{other}");
        let short = mp(&dir, &[&args[..], &["--set", "near=0"]].concat());
        assert!(short.code == 2 && short.stderr.contains("near is 0"), "{short:?}");
    }
    let run = mp(&dir, &["plan", "plane.env", "--json"]);
    assert!(run.json()["first_s"].is_null());
}

#[test]
fn planners_that_run_planners_give_the_same_bytes_on_any_number_of_threads() {
    let dir = Dir::new();
    for planner in ["or-rrt-connect", "or-restart-rrt", "restart-rrt-connect"] {
        let runs = ["1", "2"].map(|threads| {
            let out = format!("{threads}.txt");
            let args = ["plan", "window.env", "--json", "--planner", planner, "--threads", threads];
            let run = mp(&dir, &[&args[..], &["--out", &out]].concat());
            assert_eq!(run.code, 0, "{run:?}");
            let report = run.json();
            assert_eq!(report["planner"], planner);
            (dir.read(&out), report["iterations"].clone(), report["collision_checks"].clone())
        });
        assert_eq!(runs[0], runs[1], "{planner}");
        assert_ne!(runs[0].2, 0);
    }
    let run = mp(&dir, &["plan", "window.env", "--planner", "or-rrt-conect"]);
    assert!(run.code == 2 && run.stderr.contains("or-rrt-conect"), "{run:?}");
    let run = mp(&dir, &["plan", "window.env", "--planner", "restart-rrt", "--set", "runs=3"]);
    assert!(run.code == 2 && run.stderr.contains("schedule"), "{run:?}");
    let run = mp(&dir, &["plan", "window.env", "--planner", "or-rrt", "--set", "runs=0"]);
    assert!(run.code == 2 && run.stderr.contains("from 1 to 1024"), "{run:?}");
}

#[test]
fn a_path_that_touches_something_is_refused_with_the_place() {
    let dir = Dir::new();
    dir.write("through.txt", "2\n-2 1.4 0.2 0 0 0\n2 1.3 1.8 0.7 0 0\n");
    let run = mp(&dir, &["check", "window.env", "through.txt"]);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.stdout.contains("hits Obstacle #"), "{}", run.stdout);
    assert!(run.stdout.contains("between configurations 1 and 2"), "{}", run.stdout);

    dir.write("elsewhere.txt", "2\n-2 1.4 0.2 0 0 0\n-2 1 1 0 0 0\n");
    let run = mp(&dir, &["check", "window.env", "elsewhere.txt", "--json"]);
    assert_eq!((run.code, &run.json()["free"]), (1, &false.into()));
    assert!(run.stdout.contains("does not end at the goal"), "{}", run.stdout);

    dir.write("tilted.txt", "2\n-2 0 0 0 0.1 0\n2 0 0 0 0 0\n");
    let run = mp(&dir, &["check", "plane.env", "tilted.txt"]);
    assert!(run.code == 1 && run.stdout.contains("leaves the plane"), "{run:?}");
}

#[test]
fn info_tells_meshes_scenes_and_paths_apart() {
    let dir = Dir::new();
    dir.write("p.txt", "2\n0 0 0 0 0 0\n1 0 0 0 0 0\n");
    for (file, kind) in [("robot.off", "mesh"), ("window.env", "scene"), ("p.txt", "path")] {
        let run = mp(&dir, &["info", file, "--json"]);
        assert_eq!((run.code, &run.json()["kind"]), (0, &kind.into()), "{run:?}");
        assert!(mp(&dir, &["info", file]).stdout.starts_with(file));
    }
    let mesh = mp(&dir, &["info", "robot.off", "--json"]).json();
    assert_eq!((&mesh["triangles"], &mesh["watertight"]), (&12.into(), &true.into()));
    let scene = mp(&dir, &["info", "window.env", "--json"]).json();
    assert_eq!(scene["robot"], "space");
    assert_eq!(scene["bodies"].as_array().unwrap().len(), 5);
    assert_eq!(mp(&dir, &["info", "p.txt", "--json"]).json()["length"], 1.0);
}

#[test]
fn pictures_are_the_same_twice() {
    let dir = Dir::new();
    dir.write("p.txt", "3\n-2 0 1 0 0 0\n0 0 1 0.3 0 0\n2 0 1 0.7 0 0\n");
    for name in ["a.png", "b.png"] {
        let run = mp(&dir, &["render", "window.env", "p.txt", "--picture", name, "--size", "320x240"]);
        assert_eq!(run.code, 0, "{run:?}");
    }
    let picture = dir.bytes("a.png");
    assert_eq!(picture, dir.bytes("b.png"));
    let mut reader = png::Decoder::new(std::io::Cursor::new(picture)).read_info().unwrap();
    let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut rgb).unwrap();
    assert_eq!((frame.width, frame.height, frame.color_type), (320, 240, png::ColorType::Rgb));
    let some = |f: fn(&[u8; 3]) -> bool| rgb.as_chunks().0.iter().filter(|p| f(p)).count();
    assert!(some(|[r, g, b]| *g > 90 && *r < 80 && *b < 110) > 50, "the start is green");
    assert!(some(|[r, g, b]| *r > 120 && *g < 90 && *b < 90) > 50, "the goal is red");
}

/// The page of the viewer: the same twice, nothing from elsewhere, and the scene inside is what the program wrote.
#[test]
fn pages_hold_scene_and_path() {
    let dir = Dir::new();
    dir.write("p.txt", "3\n-2 0 1 0 0 0\n0 0 1 0.3 0 0\n2 0 1 0.7 0 0\n");
    for name in ["a.html", "b.html", "scene.mpv"] {
        let run = mp(&dir, &["render", "window.env", "p.txt", "--out", name]);
        assert_eq!(run.code, 0, "{run:?}");
    }
    let page = dir.read("a.html");
    assert_eq!(page, dir.read("b.html"));
    assert!(page.starts_with("<!doctype html>") && page.contains("<canvas") && !page.contains("https://"));
    let scene = mp_view::SceneFile::parse(&dir.bytes("scene.mpv")).unwrap();
    assert_eq!((scene.name.as_str(), scene.bodies.len(), scene.paths.len()), ("window", 5, 1));
    assert!(!scene.paths[0].verified, "this path goes through a wall");

    let run = mp(&dir, &["plan", "window.env", "--out", "q.txt", "--picture", "run.html", "--json"]);
    assert_eq!((run.code, &run.json()["picture_file"]), (0, &"run.html".into()), "{run:?}");
    assert!(dir.read("run.html").len() > 100_000);
    let run = mp(&dir, &["render", "window.env", "--out", "x.pdf"]);
    assert!(run.code != 0 && run.stderr.contains(".pdf"), "{run:?}");
}

#[test]
fn scenes_are_exported_for_other_planners() {
    let dir = Dir::new();
    let run = mp(&dir, &["plan", "window.env", "plane.env", "--export", "other", "--json"]);
    assert_eq!(run.code, 0, "{run:?}");
    let window: Value = serde_json::from_str(&dir.read("other/window.json")).unwrap();
    assert_eq!((&window["space"], &window["resolution_fraction"]), (&"SE3".into(), &0.01.into()));
    for mesh in [&window["robot"]["mesh"], &window["env"]["mesh"]] {
        assert!(dir.read(&format!("other/{}", mesh.as_str().unwrap())).starts_with("OFF"));
    }
    assert!(dir.exists("other/plane.json"));
}

#[cfg(unix)]
#[test]
fn ctrl_c_stops_at_once_and_says_so() {
    let dir = Dir::new();
    let child = crate::common::start(&dir, &["plan", "closed.env", "--json", "--out", "p.txt"]);
    std::thread::sleep(std::time::Duration::from_millis(1500));
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let run = crate::common::finish(child);
    assert_eq!(run.code, 1, "{run:?}");
    assert_eq!(run.json()["stopped_by"], "interrupted");
    assert!(run.json()["iterations"].as_u64().unwrap() > 0);
    assert!(!dir.exists("p.txt"));
}

/// As `timeout` ends a program: it sends the signal to it and to its group.
#[cfg(unix)]
#[test]
fn a_signal_that_comes_twice_keeps_what_was_found() {
    for signal in ["-TERM", "-INT"] {
        keeps_what_was_found(signal);
    }
}

#[cfg(unix)]
fn keeps_what_was_found(signal: &str) {
    let dir = Dir::new();
    let child = crate::common::start(
        &dir,
        &[
            "plan",
            "window.env",
            "--planner",
            "rrt-star",
            "--iterations",
            "1000000000",
            "--json",
            "--out",
            "p.txt",
        ],
    );
    std::thread::sleep(std::time::Duration::from_millis(1500));
    let id = child.id().to_string();
    // Signals that come together are one.
    let twice = format!("kill {signal} {id}; sleep 0.005; kill {signal} {id}");
    assert!(std::process::Command::new("sh").args(["-c", &twice]).status().unwrap().success());
    let run = crate::common::finish(child);
    assert_eq!(run.code, 0, "{run:?}");
    let planning =
        run.json()["stages"].as_array().unwrap().iter().find(|s| s["stage"] == "planning").cloned();
    assert_eq!(planning.unwrap()["ended_by"], "interrupted");
    assert_eq!(mp(&dir, &["check", "window.env", "p.txt"]).code, 0);
}

/// A page, and a scene file, of a run show the trees or the roadmap that the run has grown.
#[test]
fn pictures_of_runs_have_what_the_run_has_grown() {
    let dir = Dir::new();
    let file = |planner: &str, more: &[&str]| {
        let args =
            ["plan", "window.env", "--json", "--planner", planner, "--seed", "3", "--picture", "s.mpv"];
        let run = mp(&dir, &[&args, more].concat());
        assert_eq!(run.code, 0, "{run:?}");
        (mp_view::SceneFile::parse(&dir.bytes("s.mpv")).unwrap(), run.json())
    };
    let (scene, report) = file("rrt-connect", &[]);
    assert_eq!(
        scene.trees.iter().map(|t| t.name.as_str()).collect::<Vec<_>>(),
        ["from the start", "from the goal"]
    );
    let nodes: usize = scene.trees.iter().map(|tree| tree.parents.len()).sum();
    assert_eq!(report["nodes"], nodes);
    for (tree, end) in scene.trees.iter().zip([&scene.start, &scene.goals[0]]) {
        assert_eq!(tree.parents.iter().filter(|&&parent| parent == -1).count(), 1);
        let root = end.poses[..3].iter().map(|&x| x as f32).collect::<Vec<_>>();
        assert_eq!(tree.nodes[..3], root, "the root is where the tree begins");
    }
    assert!(scene.roadmap.is_none());

    // A tree that is pruned and rewired.
    let (scene, report) = file("rrt-star", &["--iterations", "3000"]);
    assert_eq!(report["nodes"], scene.trees[0].parents.len());

    let (scene, report) = file("visibility-prm", &[]);
    let map = scene.roadmap.unwrap();
    assert!(scene.trees.is_empty());
    assert_eq!((&report["nodes"], &report["edges"]), (&map.kind.len().into(), &(map.edges.len() / 2).into()));
    assert_eq!(report["components"], 1 + map.component.iter().max().unwrap());
    assert!(map.kind.contains(&1) && map.kind.contains(&2), "guards and connections: {:?}", map.kind);
    for ends in map.edges.chunks(2) {
        assert_eq!(map.component[ends[0] as usize], map.component[ends[1] as usize]);
    }

    // A roadmap that is continued from a file is shown whole.
    let known = file("prm", &["--roadmap", "r.map"]).0.roadmap.unwrap();
    let (scene, report) = file("prm", &["--roadmap", "r.map"]);
    let map = scene.roadmap.unwrap();
    assert_eq!(map.nodes[..known.nodes.len()], known.nodes);
    assert_eq!(report["nodes"], map.kind.len());

    // The path is the same whether or not the search is shown.
    let alone = mp(&dir, &["plan", "window.env", "--planner", "rrt-connect", "--json", "--seed", "3"]).json();
    let (_, shown) = file("rrt-connect", &[]);
    assert_eq!((&alone["path"], &alone["nodes"]), (&shown["path"], &shown["nodes"]));
}

/// A signal for `mp bench` is one for the program that measures: it went on alone, and what it said then was lost.
#[cfg(unix)]
#[test]
fn a_signal_reaches_the_program_that_measures() {
    use std::io::{BufRead, BufReader};
    let dir = Dir::new();
    // By a shell: a file that this process has just written may still be open in one that another test starts.
    let make = r#"cp "$1" mp && printf '#!/bin/sh\n%s\n' "trap 'exit 7' TERM; echo begun; while :; do sleep 0.05; done" > mp-bench && chmod +x mp-bench"#;
    let mut shell = std::process::Command::new("sh");
    let made = shell.args(["-c", make, "sh", env!("CARGO_BIN_EXE_mp")]).current_dir(dir.path(".")).status();
    assert!(made.unwrap().success());
    let program = dir.path("mp");
    let mut command = std::process::Command::new(&program);
    let mut child = command.args(["bench", "rigid"]).stdout(std::process::Stdio::piped()).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
    assert_eq!(line, "begun\n");
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(7));
}
