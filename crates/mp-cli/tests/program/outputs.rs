//! Files that are written: none is an input or another output, none is lost or torn, and a second process waits its turn.

use crate::common::{Dir, finish, mp, start, start_unread};
use std::io::Write;
use std::process::Child;
use std::time::{Duration, Instant};

/// Often enough for what takes seconds.
const OFTEN: Duration = Duration::from_millis(20);

/// Waits until `done`, at most a minute, and asks every so often.
fn wait_until(what: &str, every: Duration, mut done: impl FnMut() -> bool) {
    let began = Instant::now();
    while !done() {
        assert!(began.elapsed() < Duration::from_secs(60), "{what}");
        std::thread::sleep(every);
    }
}

/// A run that grows a roadmap and finds no path, until it is stopped.
fn growing(dir: &Dir, roadmap: &str) -> Child {
    start(dir, &["plan", "closed.env", "--planner", "prm", "--roadmap", roadmap, "--time", "60", "--json"])
}

#[test]
fn outputs_are_never_inputs() {
    let dir = Dir::new();
    let before: Vec<_> = dir.entries(".").iter().map(|name| (name.clone(), dir.bytes(name))).collect();
    dir.write("r.json", "{\"planner\": \"rrt\"}");
    let refuse = |args: &[&str], names: &[&str]| {
        let run = mp(&dir, args);
        let said = names.iter().all(|name| run.stderr.contains(name));
        assert!(run.code == 2 && run.stdout.is_empty() && said, "{args:?}: {run:?}");
    };
    refuse(&["plan", "window.env", "--out", "window.env"], &["--out", "window.env", "another file"]);
    refuse(&["plan", "window.env", "--out", "./window.env"], &["./window.env", "the input window.env"]);
    refuse(&["plan", "window.env", "--out", "sill.off"], &["the input sill.off"]);
    refuse(&["plan", "window.env", "--picture", "sill.off"], &["--picture sill.off", "the input sill.off"]);
    refuse(&["plan", "window", "--planner", "prm", "--roadmap", "window.env"], &["--roadmap", "window.env"]);
    refuse(&["plan", "window.env", "--request", "r.json", "--out", "r.json"], &["--out", "the input r.json"]);
    refuse(&["plan", "window.env", "--export", "window.env"], &["window.env is not a folder"]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("sill.off", dir.path("soft.txt")).unwrap();
        std::fs::hard_link(dir.path("sill.off"), dir.path("hard.txt")).unwrap();
        std::os::unix::fs::symlink(".", dir.path("here")).unwrap();
        refuse(&["plan", "window.env", "--out", "soft.txt"], &["soft.txt", "the input sill.off"]);
        refuse(&["plan", "window.env", "--out", "hard.txt"], &["hard.txt", "the input sill.off"]);
        refuse(&["plan", "window.env", "--out", "here/window.env"], &["the input window.env"]);
    }
    // So is the image of a field, before it is read.
    dir.write("field.png", "no picture");
    let picture = ["--picture", "field.png"];
    let plan = [&["plan", "window.env", "--relax", "image:field.png"], &picture[..]].concat();
    refuse(&plan, &["--picture", "the input field.png"]);
    let render = [&["render", "rrs-follow", "--field", "image:field.png"], &picture[..]].concat();
    refuse(&render, &["--picture", "the input field.png"]);
    // What a path is drawn from is an input too.
    dir.write("p.png", "1\n0 0 0 0 0 0\n");
    refuse(&["render", "window.env", "p.png", "--out", "./p.png"], &["the input p.png"]);
    // The first of two routes would be written over a mesh.
    dir.write("route.env", dir.read("window.env").replace("sill.off", "sill-1.csv"));
    std::fs::copy(dir.path("sill.off"), dir.path("sill-1.csv")).unwrap();
    refuse(&["plan", "route.env", "--routes", "2", "--out", "sill.csv"], &["--out sill-1.csv", "the input"]);
    for (name, bytes) in before {
        assert!(dir.bytes(&name) == bytes, "{name}");
    }
    assert!(!dir.entries(".").iter().any(|name| name.starts_with(".mp") || name == "out"));
}

#[test]
fn outputs_are_files_of_their_own() {
    let dir = Dir::new();
    let refuse = |args: &[&str], names: &[&str]| {
        let run = mp(&dir, args);
        let said = names.iter().all(|name| run.stderr.contains(name));
        assert!(run.code == 2 && said, "{args:?}: {run:?}");
    };
    let prm = ["plan", "window.env", "--planner", "prm"];
    refuse(
        &[&prm[..], &["--out", "y.txt", "--roadmap", "./y.txt"]].concat(),
        &["--out y.txt", "--roadmap ./y.txt"],
    );
    refuse(&[&prm[..], &["--out", "new/../y.txt", "--roadmap", "y.txt"]].concat(), &["the same file"]);
    refuse(&[&prm[..], &["--picture", "y.svg", "--out", "y.svg"]].concat(), &["--picture y.svg"]);
    refuse(
        &["plan", "window.env", "plane.env", "--export", "e", "--out", "{scene}.csv", "--roadmap", "m"],
        &["--roadmap needs a single run"],
    );
    std::fs::create_dir(dir.path("e")).unwrap();
    refuse(&["plan", "window.env", "--export", "e", "--out", "e/window.json"], &["--export", "--out"]);
    #[cfg(unix)]
    {
        // Both lead to a file that is not there yet.
        std::os::unix::fs::symlink("later.txt", dir.path("early.txt")).unwrap();
        refuse(&[&prm[..], &["--out", "early.txt", "--roadmap", "later.txt"]].concat(), &["the same file"]);
        assert!(!dir.exists("later.txt"));
    }
}

/// Standard output is for one thing alone.
#[test]
fn only_one_output_is_standard_output() {
    let dir = Dir::new();
    for args in [
        &["plan", "window.env", "--out", "-", "--certificate", "-"][..],
        &["plan", "window.env", "--certificate", "-"],
        &["plan", "window.env", "--json", "--certificate", "-"],
        &["plan", "window.env", "--planner", "prm", "--roadmap", "-"],
        &["plan", "window.env", "--portfolio", "2", "--checkpoint", "-"],
    ] {
        let run = mp(&dir, args);
        let said = run.stderr.contains(" -: standard output has other content");
        assert!(run.code == 2 && run.stdout.is_empty() && said, "{args:?}: {run:?}");
    }
    assert_eq!(mp(&dir, &["plan", "window.env", "--out", "p.txt", "--picture", "p.png"]).code, 0);
    let run = mp(&dir, &["check", "window.env", "p.txt", "--certificate", "-"]);
    assert!(run.code == 2 && run.stderr.contains("standard output has other content"), "{run:?}");
    assert!(!dir.exists("-"));
}

/// A run of a portfolio deletes its checkpoint in the end, and nothing else.
#[test]
fn a_checkpoint_is_no_other_file() {
    let dir = Dir::new();
    dir.write("secret", "password=hunter2");
    let run = mp(&dir, &["plan", "window.env", "--portfolio", "2", "--checkpoint", "secret"]);
    assert!(run.code == 2 && run.stderr.contains("another job"), "{run:?}");
    assert_eq!(dir.read("secret"), "password=hunter2");
}

#[test]
fn one_process_at_a_time_grows_a_roadmap() {
    let dir = Dir::new();
    let mut first = growing(&dir, "maps/m.roadmap");
    wait_until("a lock", OFTEN, || dir.exists("maps/.m.roadmap.lock"));
    let second = mp(
        &dir,
        &["plan", "closed.env", "--planner", "prm", "--roadmap", "maps/m.roadmap", "--time", "1", "--json"],
    );
    let process = format!("process {}", first.id());
    assert_eq!(second.code, 2, "{second:?}");
    for words in ["maps/m.roadmap", "in use", "another file", if cfg!(unix) { &process } else { "process" }] {
        assert!(second.stderr.contains(words), "{words}: {second:?}");
    }
    first.kill().unwrap();
    finish(first);
    // A process that was killed leaves nothing locked.
    let again = mp(
        &dir,
        &["plan", "closed.env", "--planner", "prm", "--roadmap", "maps/m.roadmap", "--time", "1", "--json"],
    );
    assert_eq!(again.code, 1, "{again:?}");
    #[cfg(unix)]
    assert_eq!(dir.entries("maps"), ["m.roadmap"]);
}

/// A roadmap that cannot be written at the end, as its folder is gone or the disk is full, costs no path.
#[test]
fn a_lost_roadmap_leaves_the_path() {
    for (option, out) in [("--runs=1", "p.csv"), ("--routes=2", "p-1.csv")] {
        let dir = Dir::new();
        let run =
            ["plan", "window.env", "--planner", "prm-star", "--roadmap", "maps/m.roadmap", "--time", "2"];
        let child = start(&dir, &[&run[..], &[option, "--out", "p.csv", "--json"]].concat());
        wait_until("a lock", OFTEN, || dir.exists("maps/.m.roadmap.lock"));
        std::fs::remove_dir_all(dir.path("maps")).unwrap();
        let run = finish(child);
        assert!(run.code == 2 && run.stdout.contains("\"solved\":true"), "{option}: {run:?}");
        for words in ["maps/m.roadmap", "no such folder", "the path"] {
            assert!(run.stderr.contains(words), "{option}: {words}: {run:?}");
        }
        assert!(run.stdout.contains("\"roadmap_error\":\"maps/m.roadmap: "), "{run:?}");
        let check = mp(&dir, &["check", "window.env", out]);
        assert_eq!(check.code, 0, "{option}: {check:?}");
    }
}

/// Growth is written on the way: whoever is killed loses some seconds of it.
#[test]
fn a_killed_run_leaves_its_roadmap() {
    let dir = Dir::new();
    let mut child = growing(&dir, "m.roadmap");
    wait_until("a checkpoint", OFTEN, || dir.exists("m.roadmap"));
    child.kill().unwrap();
    finish(child);
    let run = mp(
        &dir,
        &["plan", "closed.env", "--planner", "prm", "--roadmap", "m.roadmap", "--iterations", "1", "--json"],
    );
    assert!(run.json()["nodes"].as_u64() > Some(100), "{run:?}");
}

/// Kills runs while they write a checkpoint of a roadmap that grows, and checks every time that it is the old or the new one:
/// `times` on each of so many `files`, all at once, as checkpoints are seconds apart.
fn kill_growths(files: u32, times: u32) {
    let dir = Dir::new();
    let kill = |file: u32| {
        let (folder, roadmap) = (format!("maps{file}"), format!("maps{file}/m.roadmap"));
        let temporary = || dir.entries(&folder).into_iter().filter(|name| name.starts_with(".mp-"));
        std::fs::create_dir(dir.path(&folder)).unwrap();
        let (mut nodes, mut cut) = (0, 0);
        for i in 0..times {
            let mut child = growing(&dir, &roadmap);
            // Temporary files that are empty only show that the folder takes them; those that were cut are removed before.
            let length =
                |name: String| std::fs::metadata(dir.path(&folder).join(name)).map_or(0, |m| m.len());
            let old: Vec<String> = temporary().collect();
            let written = || temporary().any(|name| !old.contains(&name) && length(name) > 0);
            wait_until("a checkpoint", Duration::from_millis(1), written);
            if i % 2 == 1 {
                wait_until("the end of a checkpoint", Duration::from_millis(1), || !written());
            }
            std::thread::sleep(Duration::from_micros(u64::from(i * 37 % 50) * 60));
            child.kill().unwrap();
            assert_ne!(finish(child).code, 0);
            cut += u32::from(temporary().any(|name| !old.contains(&name)));
            if dir.exists(&roadmap) {
                let go_on = ["--roadmap", &roadmap, "--iterations", "1", "--json"];
                let run = mp(&dir, &[&["plan", "closed.env", "--planner", "prm"], &go_on[..]].concat());
                let now = run.json()["nodes"].as_u64().unwrap();
                assert!(now >= nodes, "{now} nodes after {nodes}");
                nodes = now;
            }
        }
        assert!(nodes > 100, "{nodes} nodes");
        #[cfg(unix)]
        assert_eq!(dir.entries(&folder), ["m.roadmap"]);
        (nodes, cut)
    };
    let grown: Vec<(u64, u32)> = std::thread::scope(|scope| {
        let kill = &kill;
        let threads: Vec<_> = (0..files).map(|file| scope.spawn(move || kill(file))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    let (nodes, cut): (Vec<u64>, Vec<u32>) = grown.into_iter().unzip();
    let (most, cut) = (nodes.iter().max().unwrap(), cut.iter().sum::<u32>());
    let _ = writeln!(
        std::io::stderr(),
        "{} runs killed while their roadmaps grew to {most} nodes, {cut} within a checkpoint: nothing lost or torn",
        files * times
    );
}

#[test]
fn roadmaps_of_runs_that_are_killed_within_a_checkpoint_are_whole() {
    kill_growths(2, 2);
}

/// As many as a release is tested with: `cargo test -p mp-motion-cli --test program outputs -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes"]
fn hundreds_of_roadmaps_of_runs_that_are_killed_within_a_checkpoint_are_whole() {
    kill_growths(10, 25);
}

/// A reader that goes away is not worth a message, but the exit code tells that not all was read.
#[test]
fn a_closed_output_is_told_by_the_exit_code() {
    let dir = Dir::new();
    for args in [
        &["plan", "plane.env", "--json"][..],
        &["plan", "plane.env", "--out", "-", "--picture", "p.png"],
        &["plan", "plane.env"],
        &["info", "plane.env"],
        &["scenes"],
    ] {
        let run = finish(start_unread(&dir, args));
        assert!(run.code == 141 && !run.stderr.contains("error"), "{args:?}: {run:?}");
    }
    assert!(dir.exists("out/plane.path.txt") && dir.exists("p.png"), "the files are written all the same");
}

/// Without a standard output the first file that is opened could take its number, and what is printed would end in it.
#[cfg(unix)]
#[test]
fn without_an_output_nothing_is_printed_into_files() {
    let dir = Dir::new();
    let run =
        format!("exec '{}' plan plane.env --json --out p.txt --picture p.png >&-", env!("CARGO_BIN_EXE_mp"));
    let status =
        std::process::Command::new("sh").args(["-c", &run]).current_dir(dir.path(".")).status().unwrap();
    assert_eq!(status.code(), Some(0));
    assert!(is_whole(&dir.read("p.txt")), "{}", dir.read("p.txt"));
    check_picture(&dir.bytes("p.png"));
}

/// The numbers of the path in a file, or `None` when it is torn: not what the program writes.
fn is_whole(text: &str) -> bool {
    let mut lines = text.lines();
    let count = lines.next().and_then(|first| first.trim().parse::<usize>().ok());
    let rows: Vec<usize> =
        lines.map(|line| line.split(' ').filter(|w| w.parse::<f64>().is_ok()).count()).collect();
    text.ends_with('\n') && count == Some(rows.len()) && rows.iter().all(|numbers| *numbers == 6)
}

/// Reads a whole PNG.
fn check_picture(png: &[u8]) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    reader.finish().unwrap();
}

/// Kills runs at times spread over what a run takes, and checks every time that each file is the old or the new one.
fn kill_runs(times: usize) {
    let dir = Dir::new();
    let plan = ["plan", "window.env", "--planner", "prm", "--no-shorten", "--json"];
    let files = ["--out", "p.txt", "--picture", "p.png", "--roadmap", "m.roadmap"];
    let args = |seed: &'static str| [&plan[..], &files, &["--seed", seed]].concat();
    let began = Instant::now();
    assert_eq!(mp(&dir, &args("1")).code, 0);
    let whole = began.elapsed();
    let (mut killed, mut ended, mut nodes) = (0, 0, 0);
    for i in 0..times {
        // The golden ratio spreads the times evenly, however many there are.
        let after = whole.mul_f64(1.1 * (i as f64 * 0.618_033_988_75).fract());
        let mut child = start(&dir, &args(["1", "2", "3"][i % 3]));
        std::thread::sleep(after);
        child.kill().unwrap();
        let run = finish(child);
        if run.code == -1 {
            killed += 1
        } else {
            ended += 1
        }
        assert!(is_whole(&dir.read("p.txt")), "{i}: {}", dir.read("p.txt"));
        check_picture(&dir.bytes("p.png"));
        // A run that continues the roadmap reads it whole; it never shrinks.
        if i % 20 == 19 || i + 1 == times {
            let check = [
                "plan",
                "window.env",
                "--planner",
                "prm",
                "--roadmap",
                "m.roadmap",
                "--iterations",
                "1",
                "--json",
            ];
            let now = mp(&dir, &check).json()["nodes"].as_u64().unwrap();
            assert!(now >= nodes, "{now} nodes after {nodes}");
            nodes = now;
        }
    }
    assert_eq!(mp(&dir, &args("4")).code, 0);
    let left: Vec<String> = dir.entries(".").into_iter().filter(|name| name.starts_with('.')).collect();
    assert!(left.is_empty(), "{left:?}");
    assert!(killed > 0, "{killed} killed, {ended} ended before");
    let _ = writeln!(std::io::stderr(), "{killed} runs killed, {ended} ended before: nothing lost or torn");
}

#[test]
fn runs_that_are_killed_lose_and_tear_nothing() {
    kill_runs(20);
}

/// As many as a release is tested with: `cargo test -p mp-motion-cli --test program outputs -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes"]
fn a_thousand_runs_that_are_killed_lose_and_tear_nothing() {
    kill_runs(1000);
}

/// What `--memory` allows is used up, and the run ends with a report.
#[test]
fn memory_is_a_budget() {
    let dir = Dir::new();
    let told =
        mp(&dir, &["plan", "closed.env", "--planner", "rrt", "--memory", "40MB", "--time", "600", "--json"]);
    let report = told.json();
    assert_eq!((told.code, &report["stopped_by"]), (1, &serde_json::json!("memory")), "{told:?}");
    assert_eq!(report["why"], "the memory is used up");
    assert!(report["nodes"].as_u64().unwrap() > 1000, "{report}");

    let told = mp(&dir, &["plan", "closed.env", "--memory", "1kB"]);
    assert!(told.code == 2 && told.stderr.contains("the program itself takes"), "{told:?}");
    let told = mp(&dir, &["plan", "closed.env", "--memory", "much"]);
    assert!(told.code == 2 && told.stderr.contains("500MB"), "{told:?}");
}
