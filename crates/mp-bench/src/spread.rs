//! Experiments over ranks and in shards: the same bytes as alone.
//!
//! Each is run by the test program itself, as another process: how time passes and what is printed is one for
//! a process.

#![cfg(test)]

use crate::{Options, program, run_on};
use clap::Parser;
use mp_cspace::Cancel;
use mp_ranks::{Link, ThreadLink, threads};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output};
use std::rc::Rc;

/// The variables that say what a process of these tests runs, and on how many ranks.
const WORDS: &str = "MP_BENCH_SPREAD";
const RANKS: &str = "MP_BENCH_RANKS";

/// A small experiment of each paper.
const EXPERIMENTS: [&str; 3] = [
    "rrs --quick --runs 1",
    "rsrt --quick --runs 1 --part clutter --cap 0.001",
    "roadmaps --quick --runs 2 --experiment contact --queries 300",
];

/// Runs `words` by another process on `ranks` ranks; 0 for an ordinary run.
fn run(words: &str, ranks: usize, out: &Path) -> Output {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["spread::the_program", "--exact", "--ignored", "--nocapture"]);
    let words = format!("mp-bench {words} --counted-time --out {}", out.display());
    command.env(WORDS, words).env(RANKS, ranks.to_string()).output().unwrap()
}

#[test]
#[ignore = "started by the others"]
fn the_program() {
    let (Ok(words), Ok(ranks)) = (std::env::var(WORDS), std::env::var(RANKS)) else { return };
    let options = Options::parse_from(words.split(' '));
    let mut links = threads(ranks.parse().unwrap()).into_iter();
    if ranks == "0" {
        std::process::exit(program(&options).into());
    }
    let run = |link: ThreadLink| {
        let is_master = link.is_master();
        let ran = run_on(&options, Rc::new(link), &Cancel::new()).map(|ran| ran.complete);
        (is_master, ran)
    };
    // Here all ranks share one standard output: nobody prints.
    let codes = std::thread::scope(|scope| {
        let master = links.next().unwrap();
        let others: Vec<_> = links.map(|link| scope.spawn(|| run(link))).collect();
        let all = others.into_iter().map(|rank| rank.join().unwrap());
        let (_, ran) = run(master);
        all.map(|(_, ran)| ran).chain([ran]).collect::<Vec<_>>()
    });
    for ran in &codes {
        assert!(matches!(ran, Ok(true)), "{ran:?}");
    }
    std::process::exit(0);
}

/// The files of a folder but the logs, whose lines are in the order in which they were done.
fn published(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    let files = entries.filter(|path| !name(path).starts_with('.') && !name(path).ends_with(".jsonl"));
    files.map(|path| (name(&path), mp_store::read(&path, 1 << 26).unwrap())).collect()
}

fn assert_success(output: &Output) {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn an_experiment_of_each_paper_is_the_same_on_any_number_of_ranks_and_in_shards() {
    let dir = tempfile::tempdir().unwrap();
    for (nth, words) in EXPERIMENTS.iter().enumerate() {
        let folder = |name: &str| dir.path().join(format!("{nth}-{name}"));
        assert_success(&run(words, 0, &folder("alone")));
        let alone = published(&folder("alone"));
        assert!(alone.len() > 1, "{words}");
        // `mpi/check` has one rank too.
        let out = folder("ranks");
        assert_success(&run(words, 3, &out));
        assert_eq!(published(&out), alone, "{words} on 3 ranks");
        let shards: Vec<_> = (1..=3).map(|i| folder(&format!("shard-{i}"))).collect();
        for (i, shard) in shards.iter().enumerate() {
            assert_success(&run(&format!("{words} --shard {}/3", i + 1), 0, shard));
            assert!(published(shard).keys().eq(["shard.json"]), "{words}");
        }
        for (name, order) in [("merged", [0, 1, 2]), ("turned", [2, 0, 1])] {
            let given: Vec<_> = order.iter().map(|i| shards[*i].display().to_string()).collect();
            let out = folder(name);
            assert_success(&run(&format!("{words} --merge {}", given.join(" ")), 0, &out));
            assert_eq!(published(&out), alone, "{words} {name}");
        }
    }
}

#[test]
fn shards_that_do_not_belong_together_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let words = "rrs --quick --runs 1";
    let folder = |name: &str| dir.path().join(name);
    for i in 1..=2 {
        assert_success(&run(&format!("{words} --shard {i}/2"), 0, &folder(&format!("s{i}"))));
    }
    assert_success(&run("rrs --quick --runs 2 --shard 2/2", 0, &folder("other")));
    let refused = |shards: &[&str], expected: &[&str]| {
        let given: Vec<_> = shards.iter().map(|name| folder(name).display().to_string()).collect();
        let output = run(&format!("{words} --merge {}", given.join(" ")), 0, &folder("whole"));
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(expected.iter().all(|word| said.contains(word)), "{said}");
    };
    refused(&["s1"], &["shard 2/2 is missing", "--shard 2/2"]);
    refused(&["s1", "s2", "s1"], &["shard 1/2 is given twice", "s1"]);
    refused(&["s1", "other"], &["other", "another command"]);
    refused(&["s1", "nowhere"], &["nowhere", "has no shard"]);
    let file = folder("s2").join("shard.json");
    let text = String::from_utf8(mp_store::read(&file, 1 << 20).unwrap()).unwrap();
    let write = |text: String| mp_store::write(&file, text.as_bytes()).unwrap();
    write(text.replace(env!("CARGO_PKG_VERSION"), "0.0.9"));
    refused(&["s1", "s2"], &["version 0.0.9", "--shard 2/2"]);
    write(text.replace("\"complete\": true", "\"complete\": false"));
    refused(&["s1", "s2"], &["shard 2/2", "not complete"]);
    let output = run("scaling --shard 1/2", 0, &folder("time"));
    assert!(String::from_utf8_lossy(&output.stderr).contains("cannot be spread"));
}
