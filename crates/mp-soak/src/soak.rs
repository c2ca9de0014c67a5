//! Many problems, one after the other: goes on where it was interrupted, and writes each finding down.

use crate::tally::Tally;
use crate::trial::{Problem, Trial, Wanted};
use mp_plan::{Cancel, in_parallel};
use mp_store::Lock;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The tally is written after this many problems.
const BLOCK: u64 = 200;
/// A tally is small.
const MAX_TALLY_BYTES: u64 = 1 << 24;

/// What to do.
#[derive(Clone, Debug)]
pub struct Options {
    /// The folder of the tally and the findings.
    pub out: PathBuf,
    /// Problems 0 to this number less one.
    pub problems: u64,
    /// The seed of the problems.
    pub seed: u64,
    /// How many problems at a time.
    pub threads: usize,
    /// Which problems are wanted.
    pub wanted: Wanted,
}

/// The file of the tally in a folder.
fn tally_file(out: &Path) -> PathBuf {
    out.join("tally.json")
}

/// Reads the tally of a folder; `None` if there is none.
///
/// # Errors
/// When it cannot be read.
pub fn read_tally(out: &Path) -> Result<Option<Tally>, String> {
    let file = tally_file(out);
    if !file.exists() {
        return Ok(None);
    }
    let bytes = mp_store::read(&file, MAX_TALLY_BYTES).map_err(|e| e.to_string())?;
    Tally::from_json(&bytes).map(Some).map_err(|e| format!("{}: {e}", file.display()))
}

/// Runs the problems that the folder does not have yet, until `stop` is raised: then it ends after the
/// problems that have begun. `progress` is told of the tally now and then.
///
/// # Errors
/// When the folder cannot be read or written, another process grows it, or it is of another seed or other
/// problems.
pub fn run(options: &Options, stop: &Cancel, progress: &mut dyn FnMut(&Tally)) -> Result<Tally, String> {
    let out = &options.out;
    mp_store::make_folder(out).map_err(|e| e.to_string())?;
    let _lock = Lock::of_folder(out).map_err(|e| e.to_string())?;
    let new = || Tally::new(options.seed, options.wanted.clone());
    let mut tally = read_tally(out)?.unwrap_or_else(new);
    if tally.seed != options.seed || tally.wanted != options.wanted {
        return Err(format!(
            "{} has the tally of seed {} and other problems than asked for: take another folder",
            out.display(),
            tally.seed
        ));
    }
    while tally.next < options.problems && !stop.is_raised() {
        let end = options.problems.min(tally.next + BLOCK);
        for done in block(options, tally.next..end, stop)? {
            tally.add(&done.trial, done.extent, done.seconds);
            tally.next = done.number + 1;
        }
        mp_store::write(&tally_file(out), tally.to_json().as_bytes()).map_err(|e| e.to_string())?;
        progress(&tally);
    }
    Ok(tally)
}

/// A problem that was run.
struct Done {
    number: u64,
    trial: Trial,
    extent: f64,
    seconds: f64,
}

/// Runs the problems of a block, in the order of their numbers. When `stop` is raised, those that have not
/// begun are left out.
fn block(options: &Options, numbers: Range<u64>, stop: &Cancel) -> Result<Vec<Done>, String> {
    let one = |i: usize| {
        let (number, began) = (numbers.start + i as u64, Instant::now());
        let problem = Problem::new(options.seed, number, &options.wanted);
        let trial = problem.run(&options.wanted);
        if !trial.findings.is_empty() || trial.out_of_time {
            let sort = if trial.findings.is_empty() { "late" } else { "findings" };
            let folder = options.out.join(sort).join(format!("{}-{number}", options.seed));
            write_problem(&problem, &trial, &folder, options, number)?;
        }
        let (extent, seconds) = (problem.world.case.extent, began.elapsed().as_secs_f64());
        Ok(Done { number, trial, extent, seconds })
    };
    let count = (numbers.end - numbers.start) as usize;
    in_parallel(count, options.threads, stop, one).into_iter().flatten().collect()
}

/// Writes a problem to a folder: its files, request and path, and what was found with the commands that
/// repeat it.
///
/// # Errors
/// When a file cannot be written.
pub fn write_problem(
    problem: &Problem,
    trial: &Trial,
    folder: &Path,
    options: &Options,
    number: u64,
) -> Result<(), String> {
    let write = |name: &str, bytes: &[u8]| {
        let file = folder.join(name);
        mp_store::make_folder(mp_store::folder_of(&file)).map_err(|e| e.to_string())?;
        mp_store::write(&file, bytes).map_err(|e| e.to_string())
    };
    for (name, bytes) in &problem.world.files {
        write(name, bytes)?;
    }
    let main = &problem.world.main;
    let mut text = String::new();
    for finding in &trial.findings {
        text += &format!("{}: {}\n", finding.sort, finding.what);
    }
    text += &format!("\nmp-soak --seed {} --problem {number}", options.seed);
    if let Some(kind) = &options.wanted.kind {
        text += &format!(" --only {kind}");
    }
    if let Some(planner) = &options.wanted.planner {
        text += &format!(" --planner {planner}");
    }
    text.push('\n');
    if let Some(request) = &trial.request {
        let json = serde_json::to_string_pretty(request).map_err(|e| e.to_string())?;
        write("request.json", json.as_bytes())?;
        text += &format!("mp plan {main} --request request.json --out again.txt\n");
    }
    if let Some(path) = &trial.path {
        write("path.txt", path.as_bytes())?;
        text += &format!("mp check {main} path.txt\n");
    }
    write("finding.txt", text.as_bytes())
}
