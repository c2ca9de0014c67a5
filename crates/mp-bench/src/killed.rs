//! Measurements that are killed: what was measured is kept, and goes on from there.
//!
//! Here and not in `tests`, and the test program itself is what is killed: another one would compile the
//! whole library a second time.

#![cfg(test)]

use crate::{Options, program};
use clap::Parser;
use std::ops::Range;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const LOG: &str = "planners-runs.jsonl";

/// The variable that says where the program measures into.
const OUT: &str = "MP_BENCH_KILLED_OUT";

/// A small measurement into `out`, by [`the_program`].
fn start(out: &Path) -> Child {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["killed::the_program", "--exact", "--ignored", "--nocapture"]).env(OUT, out);
    command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

#[test]
#[ignore = "started by the others"]
fn the_program() {
    let Some(out) = std::env::var_os(OUT) else { return };
    let words = ["mp-bench", "planners", "--scene", "easy", "--runs", "1", "--time", "0.2", "--out"];
    let options = Options::parse_from(words.map(Into::into).into_iter().chain([out]));
    std::process::exit(program(&options).into());
}

/// How many complete lines the log has.
fn lines(out: &Path) -> usize {
    let text = mp_store::read(&out.join(LOG), 1 << 24).unwrap_or_default();
    let text = String::from_utf8(text).unwrap();
    let complete: Vec<_> = text.split_inclusive('\n').filter(|line| line.ends_with('\n')).collect();
    for line in &complete {
        assert!(serde_json::from_str::<serde_json::Value>(line).is_ok(), "{line}");
    }
    complete.len()
}

/// Kills measurements into one folder, each of `kills` at another time of a second; what is in the log stays
/// there.
fn kill_measurements(kills: Range<usize>) {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("bench");
    let mut known = 0;
    for i in kills {
        let mut child = start(&out);
        std::thread::sleep(Duration::from_secs_f64((i as f64 * 0.618_033_988_75).fract()));
        child.kill().unwrap();
        child.wait().unwrap();
        let now = lines(&out);
        assert!(now >= known, "{now} runs after {known}");
        known = now;
    }
    let run = start(&out).wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(0), "{said}");
    assert!(known == 0 || said.contains(&format!("{known} of ")), "{known} are known: {said}");
    assert!(lines(&out) >= known.max(10));
    let left = std::fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name());
    let left: Vec<_> = left.filter(|name| name.to_string_lossy().starts_with('.')).collect();
    assert!(left.is_empty() || cfg!(not(unix)), "{left:?}");
}

#[test]
fn measurements_that_are_killed_lose_nothing() {
    kill_measurements(0..5);
}

/// As many as a release is tested with: `cargo test -p mp-bench killed -- --ignored`.
#[test]
#[ignore = "takes minutes"]
fn hundreds_of_measurements_that_are_killed_lose_nothing() {
    // A folder is full after some runs, and a kill in the tables says less.
    (0..300).step_by(10).for_each(|first| kill_measurements(first..first + 10));
}

#[test]
fn two_measurements_into_one_folder_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let mut first = start(dir.path());
    let began = Instant::now();
    while !dir.path().join(".mp.lock").exists() {
        assert!(began.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(5));
    }
    let second = start(dir.path()).wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&second.stderr).into_owned();
    first.kill().unwrap();
    first.wait().unwrap();
    assert_eq!(second.status.code(), Some(2), "{said}");
    assert!(said.contains("in use") && said.contains("another folder"), "{said}");
}
