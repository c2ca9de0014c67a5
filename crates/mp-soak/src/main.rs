//! `mp-soak`: random problems for every planner, judged by an oracle.

use clap::Parser;
use mp_plan::{Cancel, Request};
use mp_soak::soak::{Options, read_tally, run, write_problem};
use mp_soak::tally::{Tally, grouped};
use mp_soak::trial::{Problem, Wanted};
use mp_soak::worlds::{KINDS, Kind};
use mp_stop::signals;
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Plans random problems with every planner, and has each path judged by an oracle that shares no code with
/// the planners.
///
/// Exit code: 0 nothing found, 1 findings, 2 bad input.
#[derive(Clone, Debug, Parser)]
#[command(name = "mp-soak", max_term_width = 110)]
struct Arguments {
    /// The folder for the tally and the findings. A run that was interrupted goes on there.
    #[arg(long, value_name = "DIR", required_unless_present_any = ["problem", "tally"])]
    out: Option<PathBuf>,
    /// How many problems, counted from the first of the seed.
    #[arg(long, value_name = "N", default_value_t = 10_000)]
    problems: u64,
    /// The seed of the problems.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// How many problems at a time. What is found does not depend on it.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: u16,
    /// Only worlds of this kind.
    #[arg(long, value_name = "KIND", value_parser = clap::builder::PossibleValuesParser::new(KINDS.map(|kind| kind.name)))]
    only: Option<String>,
    /// Only this planner, perhaps with the prefix of a meta-planner.
    #[arg(long, value_name = "NAME", value_parser = planner)]
    planner: Option<String>,
    /// Run the problem of this number only, and say all about it; with --out, write its files to that folder.
    #[arg(long, value_name = "N")]
    problem: Option<u64>,
    /// Print the tally of this folder, in Markdown.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["out", "problem"])]
    tally: Option<PathBuf>,
}

fn planner(name: &str) -> Result<String, String> {
    Request::new(name).check().map(|()| name.to_owned()).map_err(|e| e.report())
}

fn main() -> ExitCode {
    match soak(&Arguments::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(message) => {
            note(&format!("error: {message}"));
            ExitCode::from(2)
        }
    }
}

/// Prints a line on standard error.
fn note(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Prints a text on standard output.
fn print(text: &str) {
    let _ = write!(std::io::stdout().lock(), "{text}");
}

/// True when nothing was found.
fn soak(arguments: &Arguments) -> Result<bool, String> {
    let options = Options {
        out: arguments.out.clone().unwrap_or_default(),
        problems: arguments.problems,
        seed: arguments.seed,
        threads: arguments.threads.into(),
        wanted: Wanted { kind: arguments.only.clone(), planner: arguments.planner.clone() },
    };
    if let Some(folder) = &arguments.tally {
        let tally =
            read_tally(folder)?.ok_or_else(|| format!("there is no tally in {}", folder.display()))?;
        print(&tally.to_markdown());
        return Ok(tally.all.findings == 0);
    }
    if let Some(number) = arguments.problem {
        return one(&options, number);
    }
    let stop = Cancel::new();
    let raised = stop.clone();
    signals::on_first(signals::BY_HAND, move || raised.cancel()).map_err(|e| e.to_string())?;
    let live = std::io::stderr().is_terminal();
    let mut told = Instant::now();
    let mut progress = |tally: &Tally| {
        if told.elapsed() > Duration::from_secs(if live { 1 } else { 60 }) {
            told = Instant::now();
            note(&state(tally, &options));
        }
    };
    let tally = run(&options, &stop, &mut progress)?;
    note(&state(&tally, &options));
    Ok(tally.all.findings == 0)
}

/// A run in a line.
fn state(tally: &Tally, options: &Options) -> String {
    let [next, problems, solved, findings] =
        [tally.next, options.problems, tally.all.solved, tally.all.findings].map(grouped);
    let each = 1e3 * tally.all.seconds / tally.all.problems.max(1) as f64;
    format!("{next} of {problems} problems, {solved} solved, {findings} findings, {each:.1} ms each")
}

/// Runs one problem. True when nothing was found.
fn one(options: &Options, number: u64) -> Result<bool, String> {
    let problem = Problem::new(options.seed, number, &options.wanted);
    let trial = problem.run(&options.wanted);
    let summary = Kind::named(trial.kind).map_or("", |kind| kind.summary);
    print(&format!("world    {}: {summary}\nplanner  {}\n", trial.kind, trial.planner));
    if let Some(request) = &trial.request {
        print(&format!("request  {}\n", serde_json::to_string(request).map_err(|e| e.to_string())?));
    }
    print(&format!("outcome  {:?}\n", trial.outcome));
    if let Some(refusal) = &trial.refusal {
        print(&format!("refused  {refusal}\n"));
    }
    if let Some(judged) = &trial.judged {
        print(&format!("oracle   {judged:?}\n"));
    }
    for finding in &trial.findings {
        print(&format!("FOUND    {}: {}\n", finding.sort, finding.what));
    }
    if !options.out.as_os_str().is_empty() {
        write_problem(&problem, &trial, &options.out, options, number)?;
    }
    Ok(trial.findings.is_empty())
}
