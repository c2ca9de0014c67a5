//! What made a result: the program's version, the machine, the command and the day.

use super::table::Table;
use crate::clock;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;
use std::time::{SystemTime, UNIX_EPOCH};

/// Options whose value says where files are, not what is measured.
const PLACES: [&str; 6] = ["--out", "--merge", "--peer", "--shard", "--threads", "--dir"];

/// The commit of the checkout in which the program runs, with `-dirty` where files differ from it; `None`
/// without one, and where time is counted, as such results are the same on every machine.
pub(crate) fn commit() -> Option<&'static str> {
    static COMMIT: OnceLock<Option<String>> = OnceLock::new();
    let ask = || {
        let git = Command::new("git")
            .args(["describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"])
            .output();
        let said = git.ok().filter(|out| out.status.success())?;
        Some(String::from_utf8_lossy(&said.stdout).trim().to_owned()).filter(|text| !text.is_empty())
    };
    if clock::is_counted() { None } else { COMMIT.get_or_init(ask).as_deref() }
}

/// Lines about the runs of a table, each with its name: nothing where time is counted.
pub(crate) fn lines(table: &Table) -> Vec<(&'static str, String)> {
    if clock::is_counted() {
        return Vec::new();
    }
    let commits = match table.commits.is_empty() {
        true => commit().unwrap_or("unknown").to_owned(),
        false => commits(&table.commits),
    };
    vec![
        ("command", command(std::env::args())),
        ("commit", commits),
        ("machine", machine()),
        ("date", today()),
    ]
}

/// The commits at which runs were made; with the number of runs where there are several.
fn commits(of_runs: &BTreeMap<String, usize>) -> String {
    let said = |(commit, runs): (&String, &usize)| match of_runs.len() {
        1 => commit.clone(),
        _ => format!("{commit} ({runs} runs)"),
    };
    of_runs.iter().map(said).collect::<Vec<_>>().join(", ")
}

/// The command line, without folders and programs, which differ from machine to machine.
fn command(arguments: impl Iterator<Item = String>) -> String {
    let (mut said, mut place) = (vec!["cargo xtask bench".to_owned()], false);
    for argument in arguments.skip(1) {
        // All up to the next option is of a place, as there may be several folders.
        if argument.starts_with("--") {
            place = PLACES.contains(&argument.split('=').next().unwrap_or_default());
        }
        if !place {
            said.push(argument);
        }
    }
    said.join(" ")
}

/// The processor and the number of its cores.
fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let info = mp_store::read(Path::new("/proc/cpuinfo"), 1 << 24).unwrap_or_default();
    let info = String::from_utf8_lossy(&info);
    let model = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let model = model.map_or(std::env::consts::ARCH, |(_, model)| model.trim());
    format!("{model}, {cores} {}, {}", if cores == 1 { "core" } else { "cores" }, std::env::consts::OS)
}

/// The day in UTC, as `2026-11-26`.
fn today() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    day(seconds / 86_400)
}

/// The date of the day number `since_1970`, counted from 0 at 1 January 1970 (Hinnant 2021, `civil_from_days`).
fn day(since_1970: u64) -> String {
    let days = since_1970 + 719_468; // since the first of March of the year 0
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let march_based = (5 * of_year + 2) / 153;
    let day = of_year - (153 * march_based + 2) / 5 + 1;
    let month = if march_based < 10 { march_based + 3 } else { march_based - 9 };
    let year = year_of_era + 400 * era + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days() {
        let of = [0, 59, 11_016, 20_783, 47_540].map(day);
        assert_eq!(of, ["1970-01-01", "1970-03-01", "2000-02-29", "2026-11-26", "2100-02-28"]);
    }

    #[test]
    fn commands_do_not_name_places() {
        let line = "mp-bench rsrt --out /home/me/out --part clutter --merge a b --runs 3 --out=x --quick --threads 2";
        let said = command(line.split(' ').map(str::to_owned));
        assert_eq!(said, "cargo xtask bench rsrt --part clutter --runs 3 --quick");
    }

    #[test]
    fn several_commits_are_all_said() {
        let of = |all: &[(&str, usize)]| all.iter().map(|(name, n)| ((*name).to_owned(), *n)).collect();
        assert_eq!(commits(&of(&[("abc", 3)])), "abc");
        assert_eq!(commits(&of(&[("abc", 3), ("def", 1)])), "abc (3 runs), def (1 runs)");
    }
}
