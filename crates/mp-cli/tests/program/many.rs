//! Lists of problems: what the program says, and what is left of it when it is killed.

use crate::common::{Dir, finish, mp, start};
use std::io::Write;
use std::time::{Duration, Instant};

/// Items that are solved, and one that cannot be planned.
const LIST: &str = r#"{"scene": "window", "seeds": {"from": 1, "count": 6}, "request": {"planner": "rrt-connect"}}
{"scene": "plane", "goal": [0, 0.7, 0, 0, 0, 0]}
{"scene": "closed", "request": {"budget": {"iterations": 300}}}
"#;

fn dir() -> Dir {
    let dir = Dir::new();
    dir.write("list.jsonl", LIST);
    dir
}

fn many<'a>(out: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["many", "list.jsonl", "--out", out], more].concat()
}

#[test]
fn a_list_is_planned_and_counted() {
    let dir = dir();
    let run = mp(&dir, &many("out/r.jsonl", &["--threads", "2"]));
    assert_eq!((run.code, run.stdout.trim()), (0, "8 problems: 6 solved, 1 unsolved, 1 failed"), "{run:?}");
    assert_eq!(dir.read("out/r.jsonl").lines().count(), 10);
    assert_eq!(dir.entries("out"), ["r.jsonl"]);
    // Again: nothing is left to do.
    let bytes = dir.bytes("out/r.jsonl");
    let run = mp(&dir, &many("out/r.jsonl", &[]));
    assert!(run.code == 0 && run.stderr.contains("going on after 8 of 8 items"), "{run:?}");
    assert!(bytes == dir.bytes("out/r.jsonl"));
    // A budget of time that ends runs is told.
    let run = mp(&dir, &many("t.jsonl", &["--time", "1e-9", "--times"]));
    assert!(run.code == 0 && run.stdout.contains("the time was up for 7"), "{run:?}");
    assert!(dir.read("t.jsonl").lines().next().unwrap().ends_with("\"times\":true,\"time_s\":1e-9}"));
}

#[test]
fn merged_shards_are_the_whole() {
    let dir = dir();
    assert_eq!(mp(&dir, &many("all.jsonl", &["--threads", "1"])).code, 0);
    for i in ["1", "2", "3"] {
        let (out, shard) = (format!("{i}.jsonl"), format!("{i}/3"));
        let run = mp(&dir, &many(&out, &["--shard", &shard]));
        assert!(run.code == 0 && run.stdout.starts_with(&format!("shard {i}/3: ")), "{run:?}");
    }
    let run = mp(&dir, &["merge", "merged.jsonl", "3.jsonl", "1.jsonl", "2.jsonl"]);
    assert!(run.code == 0 && run.stdout.contains("8 problems: 6 solved"), "{run:?}");
    assert!(dir.bytes("merged.jsonl") == dir.bytes("all.jsonl"));
    let run = mp(&dir, &["merge", "merged.jsonl", "3.jsonl", "1.jsonl"]);
    let again = "mp many list.jsonl --out shard-2-of-3.jsonl --shard 2/3";
    assert!(run.code == 2 && run.stderr.contains(again), "{run:?}");
    let run = mp(&dir, &again.split(' ').skip(1).collect::<Vec<_>>());
    assert_eq!(run.code, 0, "{run:?}");
    let run = mp(&dir, &["merge", "merged.jsonl", "3.jsonl", "1.jsonl", "shard-2-of-3.jsonl"]);
    assert!(run.code == 0 && dir.bytes("merged.jsonl") == dir.bytes("all.jsonl"), "{run:?}");
}

#[test]
fn what_cannot_be_is_refused_before_anything_runs() {
    let dir = dir();
    dir.write("bad.jsonl", "{\"scene\": \"window\"}\n{\"scene\": 1}\n");
    dir.write("missing.jsonl", "{\"scene\": \"window\"}\n{\"scene\": \"windo\"}\n");
    let before = dir.entries(".");
    for (args, words) in [
        (&["many", "list.jsonl", "--out", "list.jsonl"][..], "would overwrite the input list.jsonl"),
        (&["many", "list.jsonl", "--out", "./sill.off"], "would overwrite the input sill.off"),
        (&["many", "list.jsonl", "--out", "plane.env"], "would overwrite the input plane.env"),
        (&["many", "list.jsonl", "--out", "-"], "must be a file"),
        (&["many", "-", "--out", "r.jsonl"], "must be a file"),
        (&["many", "no.jsonl", "--out", "r.jsonl"], "no such file"),
        (&["many", "bad.jsonl", "--out", "r.jsonl"], "bad.jsonl:2:1"),
        (&["many", "missing.jsonl", "--out", "r.jsonl"], "missing.jsonl, line 2"),
        (&["many", "list.jsonl", "--out", "bad.jsonl"], "is no file of results"),
        (&["many", "list.jsonl", "--out", "r.jsonl", "--shard", "0/3"], "no shard 0 of 3"),
        (&["many", "list.jsonl", "--out", "r.jsonl", "--shard", "4/3"], "no shard 4 of 3"),
        (&["many", "list.jsonl", "--out", "r.jsonl", "--shard", "3"], "is not a shard"),
        (&["many", "list.jsonl", "--out", "r.jsonl", "--time", "0"], "above zero"),
        (&["many", "list.jsonl"], "--out"),
        (&["merge", "r.jsonl"], "SHARDS"),
        (&["merge", "bad.jsonl", "./bad.jsonl"], "would overwrite the input"),
        (&["merge", "r.jsonl", "bad.jsonl"], "is no file of results"),
    ] {
        let run = mp(&dir, args);
        assert!(run.code == 2 && run.stdout.is_empty() && run.stderr.contains(words), "{args:?}: {run:?}");
        assert_eq!(dir.entries("."), before, "{args:?}");
    }
}

/// A list that takes long enough to be killed.
fn long(dir: &Dir) {
    dir.write("list.jsonl", "{\"scene\": \"window\", \"seeds\": {\"from\": 1, \"count\": 120}}\n");
}

/// Waits until the results have so many bytes, at most a minute.
fn wait_for(dir: &Dir, out: &str, bytes: u64) {
    let began = Instant::now();
    while std::fs::metadata(dir.path(out)).map_or(0, |meta| meta.len()) < bytes {
        assert!(began.elapsed() < Duration::from_secs(60), "{bytes} bytes");
        std::thread::sleep(Duration::from_micros(200));
    }
}

/// Kills runs all along the log, each going on with what the one before has left, and compares the whole in the end.
fn kill_runs(times: u64) {
    let dir = dir();
    long(&dir);
    assert_eq!(mp(&dir, &many("all.jsonl", &["--threads", "2"])).code, 0);
    let all = dir.bytes("all.jsonl");
    let (mut killed, mut torn) = (0, 0);
    for i in 0..times {
        // Places in the log, which grows: a run that is behind waits for nothing.
        let place = all.len() as u64 * i / times;
        let mut child = start(&dir, &many("r.jsonl", &["--threads", ["1", "2", "3"][i as usize % 3]]));
        wait_for(&dir, "r.jsonl", place);
        std::thread::sleep(Duration::from_micros(i * 37 % 50 * 60));
        child.kill().unwrap();
        killed += u64::from(finish(child).code == -1);
        // What it leaves is the beginning of the whole; at most the last line is torn.
        let mut left = if dir.exists("r.jsonl") { dir.bytes("r.jsonl") } else { Vec::new() };
        assert!(all.starts_with(&left), "{i}: {}", String::from_utf8_lossy(&left));
        torn += u64::from(!left.is_empty() && !left.ends_with(b"\n"));
        // A system that loses its power may tear it anywhere.
        if i % 2 == 1 && !left.is_empty() {
            let header = left.iter().position(|b| *b == b'\n').unwrap() + 1;
            left.truncate((left.len() - (i as usize * 131) % 2000.min(left.len())).max(header));
            dir.write("r.jsonl", &left);
        }
    }
    let run = mp(&dir, &many("r.jsonl", &["--threads", "2"]));
    assert!(run.code == 0 && run.stdout.contains("120 problems: 120 solved"), "{run:?}");
    assert!(dir.bytes("r.jsonl") == all);
    assert!(killed > 0, "none was killed in time");
    #[cfg(unix)]
    assert!(!dir.entries(".").iter().any(|name| name.starts_with('.')), "{:?}", dir.entries("."));
    let _ =
        writeln!(std::io::stderr(), "{killed} of {times} runs killed, {torn} within a line: the same bytes");
}

#[test]
fn runs_that_are_killed_go_on_to_the_same_bytes() {
    kill_runs(12);
}

/// As many as a release is tested with: `cargo test -p mp-motion-cli --test program many -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes"]
fn hundreds_of_runs_that_are_killed_go_on_to_the_same_bytes() {
    kill_runs(300);
}

#[test]
fn one_process_at_a_time_writes_results() {
    let dir = dir();
    dir.write("list.jsonl", "{\"scene\": \"closed\", \"seeds\": {\"from\": 1, \"count\": 1000}}\n");
    let mut first = start(&dir, &many("r.jsonl", &["--time", "600"]));
    wait_for(&dir, "r.jsonl", 1);
    let second = mp(&dir, &many("r.jsonl", &["--time", "600"]));
    assert!(second.code == 2 && second.stderr.contains("in use"), "{second:?}");
    first.kill().unwrap();
    finish(first);
}

/// The first Ctrl-C keeps what was done, and says how to go on.
#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_was_done() {
    let dir = dir();
    // What is last takes long, so that the signal comes before the end.
    let first = "{\"scene\": \"window\", \"seeds\": {\"from\": 1, \"count\": 30}}";
    let last = "{\"scene\": \"closed\", \"request\": {\"budget\": {\"iterations\": 20000}}, \"seeds\": [1, 2, 3, 4]}";
    dir.write("list.jsonl", format!("{first}\n{last}\n"));
    assert_eq!(mp(&dir, &many("all.jsonl", &["--threads", "2"])).code, 0);
    let all = dir.bytes("all.jsonl");
    let child = start(&dir, &many("r.jsonl", &["--threads", "2"]));
    wait_for(&dir, "r.jsonl", all.len() as u64 / 3);
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let run = finish(child);
    assert!(run.code == 1 && run.stderr.contains("of 34 items; the same command goes on"), "{run:?}");
    let left = dir.bytes("r.jsonl");
    assert!(all.starts_with(&left) && left.ends_with(b"\n"));
    let run = mp(&dir, &many("r.jsonl", &["--threads", "2"]));
    assert!(run.code == 0 && run.stderr.contains("going on after"), "{run:?}");
    assert!(dir.bytes("r.jsonl") == all);
}

/// Ctrl-C while scenes are read is no bad input, and parsers of others do not delay it.
#[cfg(unix)]
#[test]
fn ctrl_c_while_scenes_are_read() {
    let dir = Dir::new();
    let box_at =
        |i: usize| format!("[[obstacle]]\nbox = [0.01, 0.01, 0.01]\npose = [{i}, 2, 3, 0.1, 0.2, 0.3]\n");
    let head = "[robot]\nsphere = 0.1\n[motion]\nstart = [0, 0, 0, 0, 0, 0]\ngoal = [1, 0, 0, 0, 0, 0]\n";
    dir.write("many.toml", &(head.to_owned() + &(0..200_000).map(box_at).collect::<String>()));
    dir.write("l.jsonl", "{\"scene\": \"many.toml\"}\n");
    let child = start(&dir, &["many", "l.jsonl", "--out", "o.jsonl"]);
    std::thread::sleep(Duration::from_millis(500));
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let run = finish(child);
    assert_eq!(
        (run.code, run.stderr.trim()),
        (1, "interrupted while the scenes of the list were read"),
        "{run:?}"
    );
    assert!(!dir.exists("o.jsonl"));
}
