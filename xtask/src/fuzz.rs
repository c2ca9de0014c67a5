//! `cargo xtask fuzz`: every reader under libFuzzer, which changes inputs and keeps those that reach new
//! code.

use crate::{bad, cargo, note, root};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::Instant;

const HELP: &str = "\
cargo xtask fuzz [--seconds N] [--executions N] [--minimise] [--built] [--out FOLDER] [TARGET…]

Runs the targets in turn, a minute each, or until each has had so many seconds or executions. Inputs that reach new code are
kept in FOLDER/TARGET/corpus (FOLDER: target/fuzz), and all executions so far are counted in FOLDER/tally.csv.

  --seconds N      for each target
  --executions N   for each target
  --minimise       afterwards, put the few inputs that reach all code that was reached into fuzz/corpus/TARGET
  --built          use the fuzzers in FOLDER, as they were built before
  --out FOLDER     where fuzzers, corpora, findings and the tally are";

/// How the compiler counts coverage. The crates are compiled with it, programs that build them are not: see
/// `--target`.
const COVERAGE: [&str; 5] = [
    "-Cpasses=sancov-module",
    "-Cllvm-args=-sanitizer-coverage-level=4",
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters",
    "-Cllvm-args=-sanitizer-coverage-pc-table",
    "-Cllvm-args=-sanitizer-coverage-trace-compares",
];

/// The length of a turn, after which the next target is fuzzed, in seconds.
const TURN: u64 = 60;

/// The most bytes of an input: longer ones are slow and reach nothing new.
const MAX_BYTES: u32 = 4096;

/// The most bytes of an input that is kept in the repository, except those with names.
const KEPT_BYTES: u32 = 256;

/// How long an input may take, in seconds. Most take some microseconds; the machine may be busy.
const MAX_SECONDS: u32 = 10;

/// The arguments of the command.
#[derive(Debug, Default, PartialEq)]
struct Options {
    seconds: Option<u64>,
    executions: Option<u64>,
    minimise: bool,
    built: bool,
    out: Option<PathBuf>,
    targets: Vec<String>,
}

/// What has been done for one target.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Row {
    executions: u64,
    seconds: f64,
    /// Edges of the control flow that were reached.
    edges: u64,
    findings: u64,
}

/// The rows of all targets, by name.
type Tally = BTreeMap<String, Row>;

/// Runs the command. The exit code is 1 when a target has failed.
pub(crate) fn run(arguments: &[OsString]) -> ExitCode {
    let arguments: Vec<String> = arguments.iter().map(|a| a.to_string_lossy().into_owned()).collect();
    if arguments.iter().any(|a| a == "--help" || a == "-h") {
        note(HELP);
        return ExitCode::SUCCESS;
    }
    match options(&arguments).and_then(|options| fuzz(&options)) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(message) => bad(&message),
    }
}

fn options(arguments: &[String]) -> Result<Options, String> {
    let mut options = Options::default();
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        let mut value = || rest.next().ok_or_else(|| format!("`{argument}` needs a value\n\n{HELP}"));
        let count = |text: &String| {
            let count = text.replace('_', "").parse::<u64>().ok().filter(|count| *count > 0);
            count.ok_or_else(|| format!("`{argument}` takes a whole number of at least 1, not `{text}`"))
        };
        match argument.as_str() {
            "--seconds" => options.seconds = Some(count(value()?)?),
            "--executions" => options.executions = Some(count(value()?)?),
            "--minimise" => options.minimise = true,
            "--built" => options.built = true,
            "--out" => options.out = Some(PathBuf::from(value()?)),
            other if other.starts_with('-') => return Err(format!("there is no option `{other}`\n\n{HELP}")),
            target => options.targets.push(target.to_owned()),
        }
    }
    Ok(options)
}

/// Builds and runs. Returns the number of targets that failed.
fn fuzz(options: &Options) -> Result<usize, String> {
    let corpora = root().join("fuzz/corpus");
    let mut targets = folders(&corpora)?;
    if let Some(unknown) = options.targets.iter().find(|t| !targets.contains(t)) {
        return Err(format!("there is no target `{unknown}`; there are {}", targets.join(", ")));
    }
    if !options.targets.is_empty() {
        targets.retain(|t| options.targets.contains(t));
    }
    let out = options.out.clone().unwrap_or_else(|| root().join("target/fuzz"));
    for target in &targets {
        create(&out.join(target).join("corpus"))?;
    }
    if !options.built {
        build(&targets, &out)?;
    }
    let failed = turns(options, &targets, &out)?;
    if options.minimise {
        for target in targets.iter().filter(|t| !failed.contains(t)) {
            minimise(target, &out)?;
        }
    }
    Ok(failed.len())
}

/// Builds the fuzzer of each target.
fn build(targets: &[String], out: &Path) -> Result<(), String> {
    let host = host()?;
    let folder = root().join("fuzz");
    note("building the fuzzers: minutes at the first time, a second each later");
    for target in targets {
        let mut command = cargo();
        command.args(["build", "--release", "--quiet", "--manifest-path"]).arg(folder.join("Cargo.toml"));
        command.args(["--target", &host]).arg("--target-dir").arg(folder.join("target"));
        command.env("MP_FUZZ_TARGET", target).env("CARGO_ENCODED_RUSTFLAGS", COVERAGE.join("\u{1f}"));
        match command.status() {
            Ok(status) if status.success() => {}
            Ok(_) => {
                return Err(format!(
                    "the fuzzer of {target} could not be built: it needs a compiler of C++ for libFuzzer (on Debian and \
                     Ubuntu `apt-get install g++`)"
                ));
            }
            Err(e) => return Err(format!("cannot run cargo: {e}")),
        }
        let built = folder.join("target").join(&host).join("release/mp-fuzz");
        let kept = fuzzer(target, out);
        std::fs::copy(&built, &kept)
            .map_err(|e| format!("cannot copy {} to {}: {e}", built.display(), kept.display()))?;
    }
    Ok(())
}

/// Targets take turns until each has had its share. Returns those that failed.
fn turns(options: &Options, targets: &[String], out: &Path) -> Result<Vec<String>, String> {
    let path = out.join("tally.csv");
    let mut tally = match path.exists() {
        true => parse(&read(&path)?).ok_or_else(|| format!("{} is not a tally", path.display()))?,
        false => Tally::new(),
    };
    let seconds = options.seconds.unwrap_or(if options.executions.is_some() { u64::MAX } else { TURN });
    let executions = options.executions.unwrap_or(u64::MAX);
    let mut left: Vec<(&String, u64, u64)> = targets.iter().map(|t| (t, seconds, executions)).collect();
    let mut failed = Vec::new();
    while !left.is_empty() {
        for (target, seconds, executions) in &mut left {
            let share = TURN.min(*seconds);
            let turn = turn(target, out, share, *executions)?;
            *seconds -= share;
            *executions = executions.saturating_sub(turn.executions);
            if turn.findings > 0 {
                failed.push(target.clone());
                (*seconds, *executions) = (0, 0);
                note(&format!("FAILED {target}: see {}", out.join(&**target).display()));
            }
            let row = tally.entry(target.clone()).or_default();
            row.executions += turn.executions;
            row.seconds += turn.seconds;
            row.edges = row.edges.max(turn.edges);
            row.findings += turn.findings;
            let all = row.executions;
            write(&path, &text(&tally))?;
            let rate = turn.executions as f64 / turn.seconds.max(1e-9);
            note(&format!(
                "{target}: {} executions, {rate:.0} in a second, {} edges; {all} in all",
                turn.executions, turn.edges
            ));
        }
        left.retain(|(_, seconds, executions)| *seconds > 0 && *executions > 0);
    }
    let all: u64 = tally.values().map(|row| row.executions).sum();
    note(&format!("{all} executions of {} targets so far, counted in {}", tally.len(), path.display()));
    Ok(failed)
}

/// Runs the fuzzer of a target for some time.
fn turn(target: &str, out: &Path, seconds: u64, executions: u64) -> Result<Row, String> {
    let folder = out.join(target);
    let mut command = Command::new(fuzzer(target, out));
    command.arg(folder.join("corpus")).arg(root().join("fuzz/corpus").join(target));
    command.arg(format!("-max_len={MAX_BYTES}")).arg(format!("-timeout={MAX_SECONDS}"));
    command.arg(format!("-max_total_time={seconds}"));
    if executions < u64::MAX {
        command.arg(format!("-runs={executions}"));
    }
    command.arg("-print_final_stats=1").arg(format!("-artifact_prefix={}/finding-", folder.display()));
    let words = root().join("fuzz/dictionaries").join(format!("{target}.dict"));
    if words.is_file() {
        command.arg(format!("-dict={}", words.display()));
    }
    let began = Instant::now();
    let ended = command.stdin(Stdio::null()).stdout(Stdio::null()).output();
    let ended = ended.map_err(|e| format!("cannot run the fuzzer of {target}: {e}"))?;
    let log = String::from_utf8_lossy(&ended.stderr);
    write(&folder.join("log.txt"), &log)?;
    let number = |text: &str| text.split_whitespace().next()?.parse().ok();
    let last = |before: &str| log.rsplit_once(before).and_then(|(_, after)| number(after));
    let executions = last("stat::number_of_executed_units:").ok_or_else(|| {
        format!("the fuzzer of {target} did not say what it did: see {}", folder.join("log.txt").display())
    })?;
    Ok(Row {
        executions,
        seconds: began.elapsed().as_secs_f64(),
        edges: last(" cov: ").unwrap_or(0),
        findings: u64::from(!ended.status.success()),
    })
}

/// Replaces the corpus of a target by few inputs that reach as much: those that people have named, such as
/// `good-1`, and what was found.
fn minimise(target: &str, out: &Path) -> Result<(), String> {
    let kept = root().join("fuzz/corpus").join(target);
    let (found, least) = (out.join(target).join("corpus"), out.join(target).join("least"));
    let _ = std::fs::remove_dir_all(&least);
    create(&least)?;
    let failed = |e: std::io::Error| format!("cannot minimise the corpus of {target}: {e}");
    // libFuzzer names inputs by a hash.
    let named = |name: &str| name.len() != 40 || name.contains(|c: char| !c.is_ascii_hexdigit());
    for name in files(&kept)?.iter().filter(|name| named(name)) {
        std::fs::copy(kept.join(name), least.join(name)).map_err(failed)?;
    }
    // Edges alone, and not how often each is passed: this is what keeps corpora small.
    let mut command = Command::new(fuzzer(target, out));
    command.args(["-set_cover_merge=1", "-use_counters=0"]).arg(format!("-max_len={KEPT_BYTES}"));
    command.arg(&least).arg(&found).arg(&kept).stdout(Stdio::null()).stderr(Stdio::null());
    if !command.status().is_ok_and(|status| status.success()) {
        return Err(format!(
            "the corpus of {target} could not be minimised: does it hold an input that fails?"
        ));
    }
    for name in files(&kept)? {
        std::fs::remove_file(kept.join(name)).map_err(failed)?;
    }
    let (mut count, mut bytes) = (0, 0);
    for name in files(&least)? {
        bytes += std::fs::copy(least.join(&name), kept.join(&name)).map_err(failed)?;
        count += 1;
    }
    note(&format!("{target}: {count} inputs, {bytes} bytes"));
    Ok(())
}

fn fuzzer(target: &str, out: &Path) -> PathBuf {
    out.join(target).join("fuzzer")
}

/// The name of this kind of machine. With a target named, cargo compiles its own programs without the flags.
fn host() -> Result<String, String> {
    let compiler = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let out = Command::new(compiler).arg("-vV").output().map_err(|e| format!("cannot run rustc: {e}"))?;
    let text = String::from_utf8_lossy(&out.stdout);
    let host = text.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned).ok_or_else(|| "rustc does not say for which machine it compiles".to_owned())
}

/// The tally as a table of comma-separated values.
fn text(tally: &Tally) -> String {
    let mut out = String::from("target,executions,seconds,edges,findings\n");
    for (target, row) in tally {
        let _ =
            writeln!(out, "{target},{},{:.0},{},{}", row.executions, row.seconds, row.edges, row.findings);
    }
    out
}

/// Reads [`text`]; `None` when it is something else.
fn parse(text: &str) -> Option<Tally> {
    text.lines().skip(1).map(row).collect()
}

fn row(line: &str) -> Option<(String, Row)> {
    let mut cells = line.split(',');
    let target = cells.next()?.to_owned();
    let mut number = || cells.next()?.parse().ok();
    let (executions, seconds) = (number()?, number()? as f64);
    Some((target, Row { executions, seconds, edges: number()?, findings: number()? }))
}

/// The names of what is in a folder, in order.
fn names(folder: &Path, wanted: fn(&Path) -> bool) -> Result<Vec<String>, String> {
    let failed = |e: std::io::Error| format!("cannot list {}: {e}", folder.display());
    let entries: Result<Vec<_>, _> = std::fs::read_dir(folder).map_err(failed)?.collect();
    let entries = entries.map_err(failed)?;
    let wanted = entries.iter().filter(|entry| wanted(&entry.path()));
    let mut names: Vec<String> =
        wanted.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    Ok(names)
}

fn folders(folder: &Path) -> Result<Vec<String>, String> {
    names(folder, Path::is_dir)
}

fn files(folder: &Path) -> Result<Vec<String>, String> {
    names(folder, Path::is_file)
}

fn create(folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|e| format!("cannot make the folder {}: {e}", folder.display()))
}

fn read(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|e| format!("cannot read {}: {e}", path.display()))
}

/// Writes a file whole: a night may end at any moment.
fn write(path: &Path, text: &str) -> Result<(), String> {
    let new = path.with_extension("new");
    let written = std::fs::write(&new, text).and_then(|()| std::fs::rename(&new, path));
    written.map_err(|e| format!("cannot write {}: {e}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tally_is_read_as_it_was_written() {
        let row = Row { executions: 12, seconds: 60.0, edges: 345, findings: 1 };
        let tally = Tally::from([("off".to_owned(), row), ("stl".to_owned(), Row::default())]);
        assert_eq!(parse(&text(&tally)), Some(tally));
        assert_eq!(parse("target,executions\noff,x\n"), None);
    }

    #[test]
    fn options_are_read() {
        let read = |line: &str| options(&line.split(' ').map(str::to_owned).collect::<Vec<_>>());
        let some = read("off --seconds 5 stl --executions 1_000 --minimise --built --out a").unwrap();
        let targets = vec!["off".to_owned(), "stl".to_owned()];
        let out = Some(PathBuf::from("a"));
        let all =
            Options { seconds: Some(5), executions: Some(1000), minimise: true, built: true, out, targets };
        assert_eq!(some, all);
        for (line, word) in
            [("--seconds", "needs a value"), ("--seconds 0", "at least 1"), ("--secs 1", "no option")]
        {
            assert!(read(line).unwrap_err().contains(word), "{line}");
        }
    }
}
