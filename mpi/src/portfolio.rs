//! `portfolio`: many runs of one request race.

use crate::output::{Teller, note, print};
use crate::request::Problem;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use mp_batch::{Portfolio, PortfolioOptions};
use mp_plan::{
    Claims, Control, Error, PathFileKind, PathRows, PortfolioSchedule, Progress, Request, Scene, Watch,
    write_file,
};
use mp_ranks::Link;
use mp_stop::Cancel;
use std::path::PathBuf;

/// The options of `mp plan --portfolio`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Race {
    #[command(flatten)]
    problem: Problem,
    /// How many runs there are. As many follow until the time is up when their caps are reached, unless there is another budget.
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u64).range(1..=1 << 30))]
    runs: u64,
    /// How many iterations each run may make: as many as it needs (`none`), or units by a schedule.
    #[arg(long, value_name = "NAME", default_value = "none",
          value_parser = PossibleValuesParser::new(PortfolioSchedule::ALL.map(PortfolioSchedule::name))
              .map(|name| name.parse::<PortfolioSchedule>().unwrap_or_default()))]
    schedule: PortfolioSchedule,
    /// Iterations of a unit of the schedule.
    #[arg(long, value_name = "N", default_value_t = 1000,
          value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    unit: u64,
    /// How many runs race at a time, on all ranks together. The next ones begin when none of these has a path.
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u64).range(1..=1 << 20))]
    round: u64,
    /// Keep finished runs in this file, and go on with those in it. The file is deleted in the end.
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// The file for the path, in the format of its ending: `.txt`, `.json` or `.csv`.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The file for the report, in JSON, without times: the same bytes for any number of ranks.
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
}

impl Race {
    /// Refuses what cannot be planned, and outputs that are inputs, or each other.
    fn check(&self, scene: &Scene, request: &Request) -> Result<(), Error> {
        let kept = scene.for_request(request)?;
        kept.check_ends()?;
        kept.prepare(request)?;
        let mut claims = Claims::default();
        scene.inputs_on_disk().iter().for_each(|file| claims.input(file));
        for (option, file) in
            [("--checkpoint", &self.checkpoint), ("--out", &self.out), ("--report", &self.report)]
        {
            file.iter().try_for_each(|file| claims.output(option, file))?;
        }
        self.out.iter().try_for_each(|file| PathFileKind::of(file).map(drop))
    }
}

/// Tells how far the runs are.
struct Watcher(Teller);

impl Watch for Watcher {
    fn progress(&mut self, progress: &Progress) {
        let iterations = progress.iterations;
        self.0.say(|| format!("{iterations} iterations of runs that are over"));
    }
}

/// Plans. True when there is a path.
pub(crate) fn run(args: &Race, link: &dyn Link, cancel: &Cancel) -> Result<bool, Error> {
    let suits = |scene: &Scene| Portfolio::default_planner(scene).to_owned();
    let problem = args.problem.on_ranks(link, cancel, suits, |scene, request| args.check(scene, request))?;
    // The first rank says why.
    let Some((scene, request)) = problem else { return Ok(true) };
    let portfolio =
        Portfolio { runs: args.runs, schedule: args.schedule, unit: args.unit, round: args.round };
    let options = PortfolioOptions { threads: args.problem.threads(), checkpoint: args.checkpoint.clone() };
    let mut watcher = Watcher(Teller::new());
    let mut control = Control::new(cancel.clone(), &mut watcher);
    let outcome = portfolio.plan_on(link, &scene, &request, &options, &mut control)?;
    let Some(outcome) = outcome else { return Ok(true) };
    if outcome.known > 0 {
        note(&format!("went on after {} runs", outcome.known));
    }
    let work: Vec<String> = outcome.work.iter().map(|rank| rank.iterations.to_string()).collect();
    note(&format!("iterations of each rank: {}; efficiency {:.3}", work.join(", "), outcome.efficiency()));
    let report = outcome.report.without_times();
    if let (Some(file), Some(rows)) = (&args.out, &report.path) {
        let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows: rows.clone() };
        write_file(file, path.to_file(PathFileKind::of(file)?).as_bytes())?;
    }
    if let Some(file) = &args.report {
        write_file(file, (report.to_json()? + "\n").as_bytes())?;
    }
    let counts = report.portfolio.as_ref();
    print(&match (report.solved, counts.and_then(|counts| counts.winner)) {
        (true, Some(winner)) => format!(
            "solved: run {winner} of {} with {} iterations; {:.6} m long",
            args.runs,
            report.iterations,
            report.path_length.unwrap_or_default()
        ),
        _ => format!(
            "not solved: {} runs begun; {}",
            counts.map_or(0, |counts| counts.begun),
            report.why.as_deref().unwrap_or("no path")
        ),
    })?;
    Ok(report.solved)
}
