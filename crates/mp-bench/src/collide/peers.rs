//! Other programs, which get the same meshes and poses.
//!
//! A program is called as `PROGRAM PAIR --passes N --ndist M --cap S`, in a folder with `data/` and `out/` as
//! `--export` writes it. It prints lines of `key=value` words: `lib= pair= build_ms= heap_bytes=` when it has
//! built its trees, and `lib= pair= set= query= n= cpu_ns= cpu_min=` (nanoseconds per query, median and least
//! of its N passes) when it has answered the first `n` queries of a set. Answers are in
//! `out/LIB.PAIR.SET.QUERY.bin`, eight bytes each, `f64`, little end first: 0 or 1 for `collide` and
//! `tolerance`, metres for `distance` (0 or below when colliding; first M poses of each set), the number of
//! free poses before the first collision for `motion`. It may leave out queries. S is the limit in seconds
//! for each kind of query.

use super::ours::TreeBuild;
use super::record::{QueryId, TimedAnswers};
use crate::error::{IntoError, Result};
use mp_plan::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The limits of the queries of other programs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct QueryLimits {
    pub(crate) passes: usize,
    pub(crate) distances: usize,
    /// Seconds.
    pub(crate) cap: f64,
}

/// A line that a program printed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Line {
    TreeBuild(TreeBuild),
    Answered { what: QueryId, count: usize, median: f64, least: f64 },
}

impl Line {
    /// Parses a line; `None` when it is neither.
    pub(crate) fn parse(line: &str) -> Option<Self> {
        let of = |key: &str| line.split_whitespace().find_map(|w| w.strip_prefix(key)?.strip_prefix('='));
        let number = |key: &str| of(key)?.parse::<f64>().ok().filter(|v| v.is_finite() && *v >= 0.0);
        let lib = of("lib")?;
        if let (Some(set), Some(query)) = (of("set"), of("query")) {
            let median = number("cpu_ns")?;
            let least = number("cpu_min").unwrap_or(median);
            let count = of("n")?.parse().ok()?;
            return Some(Self::Answered { what: QueryId::new(lib, set, query), count, median, least });
        }
        let bytes = of("heap_bytes").and_then(|b| b.parse().ok()).unwrap_or(0);
        Some(Self::TreeBuild(TreeBuild { lib: lib.to_owned(), ms: number("build_ms")?, bytes }))
    }
}

/// The programs in `folder`, by name.
///
/// # Errors
/// When there are none.
pub(crate) fn find(folder: &Path) -> Result<Vec<PathBuf>> {
    let unreadable = || format!("cannot read the folder {}", folder.display());
    let folder = std::fs::canonicalize(folder).doing(unreadable)?;
    let entries = std::fs::read_dir(&folder).doing(unreadable)?;
    let mut found: Vec<PathBuf> = entries.flatten().map(|e| e.path()).filter(|p| executable(p)).collect();
    found.sort();
    match found.is_empty() {
        true => Err(Error::new(format!("there are no programs in {}", folder.display()))),
        false => Ok(found),
    }
}

#[cfg(unix)]
fn executable(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    path.metadata().is_ok_and(|m| m.is_file() && m.permissions().mode() & 0o111 != 0)
}

#[cfg(not(unix))]
fn executable(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "exe")
}

/// Runs `program` on `pair` in `folder`.
///
/// # Errors
/// When it cannot be run, fails, or some of the answers it announces are missing.
pub(crate) fn ask(
    program: &Path,
    folder: &Path,
    pair: &str,
    limits: QueryLimits,
) -> Result<(Vec<TreeBuild>, Vec<TimedAnswers>)> {
    let [passes, distances] = [limits.passes, limits.distances].map(|n| n.to_string());
    let done = Command::new(program)
        .current_dir(folder)
        .args([pair, "--passes", &passes, "--ndist", &distances, "--cap", &limits.cap.to_string()])
        .output()
        .doing(|| format!("cannot run {}", program.display()))?;
    if !done.status.success() {
        let help = String::from_utf8_lossy(&done.stderr).into_owned();
        let message = format!("{} {pair} failed: {}", program.display(), done.status);
        return Err(Error::new(message).help(help));
    }
    let (mut builds, mut records) = (Vec::new(), Vec::new());
    for line in String::from_utf8_lossy(&done.stdout).lines().filter_map(Line::parse) {
        match line {
            Line::TreeBuild(build) => builds.push(build),
            Line::Answered { what, count, median, least } => {
                let file = format!("{}.{pair}.{}.{}.bin", what.lib, what.set, what.query);
                let answers = answers(&folder.join("out").join(file), count)?;
                records.push(TimedAnswers { what, medians: vec![median], least, answers });
            }
        }
    }
    Ok((builds, records))
}

/// The largest file of answers that is read, bytes (1 GiB).
const MAX_ANSWER_BYTES: u64 = 1 << 30;

/// The answers in `file`. For `motion` there are fewer than `count`, which counts poses.
fn answers(file: &Path, count: usize) -> Result<Vec<f64>> {
    let bytes = mp_store::read(file, MAX_ANSWER_BYTES)?;
    let answers = bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).take(count);
    Ok(answers.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_understood() {
        let line = "lib=x_OBB pair=piano set=near query=collide n=10000 hits=5 cpu_ns=12.5 cpu_min=11.0 wall_ns=9 passes=3 ";
        let what = QueryId::new("x_OBB", "near", "collide");
        let answered = Line::Answered { what: what.clone(), count: 10_000, median: 12.5, least: 11.0 };
        assert_eq!(Line::parse(line), Some(answered));
        let line = "lib=x_OBB set=near query=collide cpu_ns=2 n=3";
        assert_eq!(Line::parse(line), Some(Line::Answered { what, count: 3, median: 2.0, least: 2.0 }));
        let line = "lib=x pair=alpha build_ms=1.50 heap_bytes=1024 memusage=0";
        let build = TreeBuild { lib: "x".into(), ms: 1.5, bytes: 1024 };
        assert_eq!(Line::parse(line), Some(Line::TreeBuild(build)));
        for bad in [
            "",
            "hello",
            "lib=x",
            "lib=x set=near query=collide",
            "set=near query=collide cpu_ns=1 n=1",
            "lib=x set=a query=b cpu_ns=nan n=1",
            "lib=x set=a query=b cpu_ns=1 n=-1",
            "lib=x build_ms=-1",
        ] {
            assert_eq!(Line::parse(bad), None, "{bad}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn programs_are_run_and_their_answers_read() {
        use std::os::unix::fs::PermissionsExt;
        let (programs, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        assert!(find(programs.path()).unwrap_err().to_string().contains("no programs"));
        std::fs::write(programs.path().join("readme"), "x").unwrap();
        let program = programs.path().join("peer");
        let script = "#!/bin/sh\n[ $1 = bad ] && exit 3\nmkdir -p out\n\
            printf '\\0\\0\\0\\0\\0\\0\\360?' > out/z.$1.near.collide.bin\n\
            echo lib=z build_ms=2; echo lib=z set=near query=collide n=1 cpu_ns=$3\n";
        std::fs::write(&program, script).unwrap();
        std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
        let found = find(programs.path()).unwrap();
        assert_eq!(found, [program.canonicalize().unwrap()]);
        let limits = QueryLimits { passes: 7, distances: 1, cap: 1.0 };
        let (builds, records) = ask(&found[0], folder.path(), "piano", limits).unwrap();
        assert_eq!(builds, [TreeBuild { lib: "z".into(), ms: 2.0, bytes: 0 }]);
        let what = QueryId::new("z", "near", "collide");
        assert_eq!(records, [TimedAnswers { what, medians: vec![7.0], least: 7.0, answers: vec![1.0] }]);
        assert!(ask(&found[0], folder.path(), "bad", limits).is_err());
    }
}
