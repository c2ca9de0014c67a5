//! Standard input and output, formats by ending, requests, shipped scenes, completions and the manual.

use crate::common::{Dir, fed, finish, mp, start_silent};

#[test]
fn a_scene_comes_in_and_a_path_goes_out() {
    let dir = Dir::new();
    let scene = dir.read("window.env");
    let run = fed(&dir, &["plan", "-", "--out", "-", "--picture", "p.png"], &scene);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.stderr.contains("stdin: solved in"), "{run:?}");
    assert!(run.stdout.lines().skip(1).all(|line| line.split(' ').count() == 6), "{run:?}");
    let check = fed(&dir, &["check", "window.env", "-"], &run.stdout);
    assert_eq!(check.code, 0, "{check:?}");
    let both = fed(&dir, &["check", "-", "-"], "");
    assert!(both.code == 2 && both.stderr.contains("standard input"), "{both:?}");
    let taken = mp(&dir, &["plan", "window.env", "--out", "-", "--json"]);
    assert!(taken.code == 2 && taken.stderr.contains("standard output has other content"), "{taken:?}");
}

/// Standard input that says nothing is not waited for longer than there is time.
#[test]
fn a_silent_standard_input_takes_no_more_than_the_time() {
    let dir = Dir::new();
    let (run, _silent) = start_silent(&dir, &["plan", "-", "--time", "0.3", "--json"]);
    let run = finish(run);
    assert_eq!((run.code, &run.json()["stopped_by"]), (1, &serde_json::json!("time")), "{run:?}");
}

/// The names that Unix has for standard output are standard output.
#[cfg(unix)]
#[test]
fn devices_that_are_standard_output() {
    let dir = Dir::new();
    let dash = mp(&dir, &["plan", "window.env", "--out", "-"]);
    for name in ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"] {
        let run = mp(&dir, &["plan", "window.env", "--out", name]);
        assert!(run.code == 0 && run.stdout == dash.stdout, "{name}: {run:?}");
    }
    let error = mp(&dir, &["plan", "window.env", "--out", "/dev/null"]);
    assert!(error.code == 2 && error.stderr.contains("a device or a pipe"), "{error:?}");
}

/// Where there is no memory for a picture, that is said.
#[cfg(target_os = "linux")]
#[test]
fn pictures_without_memory_are_an_error() {
    let dir = Dir::new();
    let limited = |size: &str| {
        let line = format!("ulimit -v 4000000; exec \"$0\" render window.env --out p.png --size {size}");
        let run = std::process::Command::new("sh")
            .args(["-c", &line, env!("CARGO_BIN_EXE_mp")])
            .current_dir(dir.path(""))
            .output()
            .unwrap();
        (run.status.code(), String::from_utf8(run.stderr).unwrap())
    };
    let (code, text) = limited("8000x8000");
    assert!(code == Some(2) && text.contains("no memory for 8000 × 8000 pixels"), "{code:?} {text}");
    assert_eq!(limited("400x300").0, Some(0));
}

#[test]
fn paths_are_written_and_read_by_their_ending() {
    let dir = Dir::new();
    let mut rows = Vec::new();
    for name in ["p.txt", "p.json", "p.csv"] {
        let run = mp(&dir, &["plan", "plane.env", "--json", "--out", name]);
        assert_eq!(run.code, 0, "{run:?}");
        rows.push(run.json()["path"].clone());
        let check = mp(&dir, &["check", "plane.env", name]);
        assert_eq!(check.code, 0, "{check:?}");
        let check = fed(&dir, &["check", "plane.env", "-"], &dir.read(name));
        assert_eq!(check.code, 0, "{name}: {check:?}");
    }
    assert!(rows.iter().all(|row| *row == rows[0]));
    assert!(dir.read("p.csv").starts_with("x [m],y [m],z [m],alpha [rad],"), "{}", dir.read("p.csv"));
    assert_eq!(mp(&dir, &["info", "p.csv", "--json"]).json()["numbers"], 6);
}

#[test]
fn a_configuration_is_explained() {
    let dir = Dir::new();
    let free = mp(&dir, &["check", "window.env", "--at", "-2 1.4 0.2 0 0 0", "--json"]);
    assert_eq!((free.code, &free.json()["free"]), (0, &true.into()), "{free:?}");
    let hit = mp(&dir, &["check", "window.env", "--at=0,1.5,1,0,0,0"]);
    assert_eq!(hit.code, 1, "{hit:?}");
    for words in ["in collision with Obstacle #1 (", "nearest free configuration found is"] {
        assert!(hit.stdout.contains(words), "{hit:?}");
    }
}

#[test]
fn a_request_is_plain_data() {
    let dir = Dir::new();
    let text = r#"{"planner": "rrt", "seed": 3, "settings": {"step": "10%"}, "finish": "as-found"}"#;
    dir.write("r.json", text);
    let run = mp(&dir, &["plan", "window.env", "--request", "r.json", "--json"]);
    assert_eq!(run.code, 0, "{run:?}");
    let report = run.json();
    assert_eq!((&report["planner"], &report["seed"]), (&"rrt".into(), &3.into()));
    assert_eq!(report["shortened"], false);
    let args =
        ["plan", "window.env", "--planner", "rrt", "--seed", "3", "--step", "10%", "--no-shorten", "--json"];
    assert_eq!(mp(&dir, &args).json()["fingerprint"], report["fingerprint"]);
    assert_eq!(fed(&dir, &["plan", "window.env", "--request", "-", "--json"], text).code, 0);
    // What a request says, options cannot.
    for option in [["--clearance", "0.1"], ["--seed", "4"], ["--time", "9"], ["--report", "clearance"]] {
        let both = mp(&dir, &[&["plan", "window.env", "--request", "r.json"][..], &option].concat());
        assert!(both.code == 2 && both.stderr.contains(option[0]), "{both:?}");
    }
    // Without a planner, the scene has its own.
    dir.write("car.json", r#"{"settings": {"inputs": "5"}, "budget": {"iterations": 9}}"#);
    let car = mp(&dir, &["plan", "parking", "--request", "car.json", "--json"]);
    assert_eq!((car.code, &car.json()["planner"]), (1, &"rsrt".into()), "{car:?}");
    dir.write("map.json", r#"{"planner": "prm", "roadmap": "map"}"#);
    let several = mp(&dir, &["plan", "window.env", "--request", "map.json", "--runs", "2"]);
    assert!(several.code == 2 && several.stderr.contains("needs a single run"), "{several:?}");
    let bad = fed(&dir, &["plan", "window.env", "--request", "-"], r#"{"planer": "rrt"}"#);
    assert!(bad.code == 2 && bad.stderr.contains("planer"), "{bad:?}");
}

#[test]
fn shipped_scenes_need_no_folder() {
    let dir = Dir::empty();
    let names = mp(&dir, &["scenes"]);
    assert!(names.stdout.lines().any(|name| name == "cubicles"), "{names:?}");
    for (scene, planner) in [("easy", "rrt-connect"), ("rrs-low", "rrs"), ("arm", "rrt-connect")] {
        let run = mp(
            &dir,
            &["plan", scene, "--planner", planner, "--json", "--out", "p.txt", "--picture", "p.png"],
        );
        assert_eq!(run.code, 0, "{run:?}");
        assert_eq!(mp(&dir, &["check", scene, "p.txt"]).code, 0);
        assert_eq!(mp(&dir, &["render", scene, "p.txt", "--picture", "q.png"]).code, 0);
        assert_eq!(mp(&dir, &["info", scene]).code, 0);
    }
    let none = mp(&dir, &["plan", "cubicels"]);
    assert!(none.code == 2 && none.stderr.contains("did you mean `cubicles`?"), "{none:?}");
}

#[test]
fn a_path_that_is_not_free_is_drawn_and_said_to_be() {
    let dir = Dir::new();
    dir.write("through.txt", "2\n-2 1.4 0.2 0 0 0\n2 1.3 1.8 0.7 0 0\n");
    let run = mp(&dir, &["render", "window.env", "through.txt", "--picture", "p.png", "--size", "320x240"]);
    assert!(run.code == 0 && run.stderr.contains("would not pass") && dir.exists("p.png"), "{run:?}");
    // The picture says it too.
    assert_eq!(mp(&dir, &["plan", "rrs-low", "--json", "--out", "q.txt"]).code, 0);
    let path = dir.read("q.txt");
    let rows: Vec<&str> = path.lines().skip(1).collect();
    dir.write("straight.txt", format!("2 2\n{}\n{}\n", rows[0], rows[rows.len() - 1]));
    for (path, marked) in [("q.txt", false), ("straight.txt", true)] {
        let run = mp(&dir, &["render", "rrs-low", path, "--picture", "q.svg"]);
        let told =
            [run.stderr.contains("would not pass"), dir.read("q.svg").contains("NOT A VALID PATH: hits")];
        assert!(run.code == 0 && told == [marked; 2], "{path}: {told:?} {run:?}");
    }
}

#[test]
fn shells_and_man_are_served() {
    let dir = Dir::empty();
    for shell in ["bash", "zsh", "fish"] {
        let run = mp(&dir, &["completions", shell]);
        assert!(run.code == 0 && run.stdout.contains("rrt-connect"), "{shell}: {run:?}");
    }
    let man = mp(&dir, &["man"]);
    assert!(man.code == 0 && man.stdout.contains(".TH"), "{man:?}");
    for words in ["plan", "\\-\\-planner", "certified free", ".SH EXAMPLES"] {
        assert!(man.stdout.contains(words), "{words}");
    }
}

#[test]
fn logs_go_to_standard_error() {
    let dir = Dir::new();
    let run = crate::common::finish(crate::common::start_with(
        &dir,
        &["plan", "plane.env", "--json"],
        &[("RUST_LOG", "info")],
    ));
    assert_eq!(run.code, 0, "{run:?}");
    for words in ["loaded", "planned", "outcome"] {
        assert!(run.stderr.contains(words), "{words}: {run:?}");
    }
    run.json();
}
