//! Several routes of one scene, and portfolios of runs, by the command line.

use crate::common::{Dir, mp};

/// A block in the middle of a room: there are two ways around it.
const BLOCK: &str = "[world]\nwalls = [[0, 0], [4, 4]]\n[robot]\ndisc = 0.1\n[motion]\nstart = [0.4, 2]\ngoal = [3.6, 2]\n\
    [[obstacle]]\nrectangle = [[1.2, 1], [2.8, 3]]\n";

/// Whether the path in a file goes above the block.
fn is_above(dir: &Dir, file: &str) -> bool {
    let heights = dir.read(file);
    let heights = heights.lines().skip(1).filter_map(|line| line.split(' ').nth(1)?.parse::<f64>().ok());
    let (low, high) = heights.fold((4.0_f64, 0.0_f64), |(low, high), y| (low.min(y), high.max(y)));
    assert!((low < 1.0) != (high > 3.0), "from {low} to {high}");
    high > 3.0
}

#[test]
fn two_ways_around_a_block_are_two_routes() {
    let dir = Dir::empty();
    dir.write("block.toml", BLOCK);
    for planner in ["cyclic-rrt", "prm-star", "prm"] {
        let out = format!("{planner}.txt");
        let mut args = vec!["plan", "block.toml", "--planner", planner, "--routes", "2"];
        args.extend(["--out", &out, "--picture", "p.svg"]);
        // By default its roadmap has none.
        if planner == "prm" {
            args.extend(["--set", "cycles=yes"]);
        }
        let run = mp(&dir, &args);
        assert_eq!(run.code, 0, "{planner}: {run:?}");
        let files = [1, 2].map(|i| format!("{planner}-{i}.txt"));
        assert_ne!(is_above(&dir, &files[0]), is_above(&dir, &files[1]), "{planner}");
        for file in &files {
            let check = mp(&dir, &["check", "block.toml", file]);
            assert!(check.code == 0 && check.stdout.contains("certified free"), "{check:?}");
        }
        assert!(dir.exists("p-1.svg") && dir.exists("p-2.svg") && !dir.exists("p.svg"));
    }
    // The same again, bit for bit.
    let first = dir.read("cyclic-rrt-2.txt");
    assert_eq!(mp(&dir, &["plan", "block.toml", "--routes", "2", "--out", "again.txt"]).code, 0);
    assert_eq!(dir.read("again-2.txt"), first);
}

#[test]
fn routes_that_are_found_before_the_time_is_up_are_kept() {
    let dir = Dir::empty();
    dir.write("block.toml", BLOCK);
    for planner in ["cyclic-rrt", "prm-star"] {
        let args = ["--planner", planner, "--routes", "9", "--apart", "30%", "--time", "2", "--json"];
        let run = mp(&dir, &[&["plan", "block.toml"][..], &args].concat());
        assert!(run.code == 1 && run.stderr.contains("2 of 9 routes"), "{run:?}");
        let json = run.json();
        assert!(json["runs"].as_array().unwrap().iter().all(|run| run["verified"] == true), "{json}");
    }
}

#[test]
fn what_cannot_be_is_said() {
    let dir = Dir::empty();
    dir.write("block.toml", BLOCK);
    // Nothing is so far apart.
    let run = mp(
        &dir,
        &["plan", "block.toml", "--routes", "3", "--apart", "90%", "--iterations", "2000", "--json"],
    );
    assert!(run.code == 1 && run.stderr.contains("1 of 3 routes"), "{run:?}");
    assert_eq!(run.json()["runs"].as_array().map(Vec::len), Some(1), "{run:?}");
    for (args, words) in [
        (&["--planner", "rrt-connect"][..], "rrt-connect finds one path"),
        (&["--planner", "restart-cyclic-rrt"], "finds one path"),
        (&["--planner", "prm"], "without cycles"),
        (&["--runs", "2"], "--routes needs a single run"),
        (&["--out", "-"], "a file for each route"),
        (&["--apart", "0"], "above zero"),
        (&["--relax"], "not relaxed"),
    ] {
        let run = mp(&dir, &[&["plan", "block.toml", "--routes", "2"], args].concat());
        assert!(run.code == 2 && run.stderr.contains(words), "{words}: {run:?}");
    }
    let alone = mp(&dir, &["plan", "block.toml", "--apart", "10%"]);
    assert!(alone.code == 2 && alone.stderr.contains("--routes"), "{alone:?}");
    let free = BLOCK.replace("goal = [3.6, 2]", "goal = { x = 3.6 }");
    dir.write("free.toml", free);
    let run = mp(&dir, &["plan", "free.toml", "--routes", "2", "--planner", "prm-star"]);
    assert!(run.code == 2 && run.stderr.contains("leaves nothing free"), "{run:?}");
    assert_eq!(mp(&dir, &["plan", "parking", "--routes", "2"]).code, 2);
}

#[test]
fn a_portfolio_is_the_same_on_any_number_of_threads() {
    let dir = Dir::empty();
    dir.write("block.toml", BLOCK);
    let plan = |threads: &str, out: &str| {
        let words = [
            "plan",
            "block.toml",
            "--planner",
            "rrt",
            "--portfolio",
            "12",
            "--schedule",
            "luby",
            "--unit",
            "90",
        ];
        let more = ["--round", "4", "--threads", threads, "--checkpoint", "kept", "--out", out];
        mp(&dir, &[&words[..], &more].concat())
    };
    let runs = [("1", "one.txt"), ("3", "three.txt")].map(|(threads, out)| plan(threads, out));
    for run in &runs {
        let told = |line: &&str| {
            line.contains("run ") && line.contains(" won, ") && line.contains(" iterations in all")
        };
        assert!(run.code == 0 && run.stdout.lines().any(|line| told(&line)), "{run:?}");
    }
    assert!(dir.read("one.txt") == dir.read("three.txt") && !dir.exists("kept"));
    let run = mp(&dir, &["plan", "block.toml", "--portfolio", "3", "--iterations", "1", "--json"]);
    let portfolio = &run.json()["portfolio"];
    assert_eq!(
        (run.code, &portfolio["winner"], &portfolio["iterations"]),
        (1, &().into(), &3.into()),
        "{run:?}"
    );
    for (args, words) in [
        (&["--portfolio", "0"][..], "--portfolio"),
        (&["--portfolio", "3", "--schedule", "fast"], "luby"),
        (&["--portfolio", "3", "--runs", "2"], "--portfolio needs a single run"),
        (&["--portfolio", "3", "--routes", "2"], "--routes"),
        (&["--portfolio", "3", "--checkpoint", "block.toml"], "--checkpoint"),
        (&["--unit", "7"], "--portfolio"),
    ] {
        let run = mp(&dir, &[&["plan", "block.toml"], args].concat());
        assert!(run.code == 2 && run.stderr.contains(words), "{words}: {run:?}");
    }
}
