//! Benchmarks of the planners, compared with other programs if these are given.
//!
//! Each suite is a folder. Most suites are experiments: a list of cases, each of which is run once and its result
//! kept in a log, so that an interrupted measurement can be continued; then tables and charts of the log.
//! `experiment` is the base of them all. Results are Markdown on standard output, and files in a folder.

mod arms;
mod assets;
mod certificates;
mod clock;
mod collide;
mod error;
mod experiment;
mod killed;
mod options;
mod output;
mod peer;
mod planners;
mod plot;
mod published;
mod puzzles;
mod regions;
mod rigid;
mod roadmaps;
mod robots;
mod rrs;
mod rsrt;
mod scale;
mod scaling;
mod scenes;
mod spread;
mod suite;

use clap::Parser;
use experiment::shards;
pub use mp_plan::Error;
use std::io::Write;
use suite::Suite;

/// What to measure, and how: the command line.
///
/// Exit code: 0 measured completely and as expected, or only listed; 1 otherwise, 2 bad input.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "mp-bench",
    version,
    max_term_width = 110,
    about = "Run benchmarks, and compare with other programs if these are given"
)]
pub struct Options {
    /// What to measure; without it the suites are listed.
    #[arg(value_name = "SUITE")]
    suite: Option<Suite>,
    #[command(flatten)]
    common: options::Common,
    #[command(flatten)]
    rigid: rigid::Options,
    #[command(flatten)]
    collide: collide::Options,
    #[command(flatten)]
    rsrt: rsrt::Options,
    #[command(flatten)]
    roadmaps: roadmaps::Options,
    #[command(flatten)]
    rrs: rrs::Options,
    #[command(flatten)]
    puzzles: puzzles::Options,
    #[command(flatten)]
    robots: robots::Options,
    #[command(flatten)]
    arms: arms::Options,
    #[command(flatten)]
    assets: assets::Options,
}

impl Options {
    /// What is measured, and how, in a line: the same for all shards.
    fn identity(&self, suite: Suite) -> String {
        let mut same = self.clone();
        let c = &mut same.common;
        (c.shard, c.threads, c.fresh) = (mp_batch::Shard::WHOLE, None, false);
        (c.out, c.merge, c.peer) = Default::default();
        format!("{:?} {:?} {:?} {:?} {:?} {:?}", suite, c, same.rsrt, same.roadmaps, same.rrs, same.puzzles)
    }
}

/// How a suite ended that all ranks ran.
#[derive(Clone, Debug, PartialEq)]
pub struct SuiteOutcome {
    /// Whether it was measured completely.
    pub complete: bool,
    /// What each rank did; on the first one. A piece of work is its processor time, seconds, also where that is counted.
    pub shares: mp_ranks::Shares,
}

/// Runs a suite on all ranks: each of them calls this, with the same options. The first one writes and prints; the others do a part of the
/// runs. `cancel` ends it, on whichever rank it is raised; runs that are done are kept.
///
/// # Errors
/// As [`run`], and when the ranks cannot reach each other. Others may still wait for a rank that has an error.
pub fn run_on(
    options: &Options,
    link: std::rc::Rc<dyn mp_ranks::Link>,
    cancel: &mp_cspace::Cancel,
) -> Result<SuiteOutcome, Error> {
    if !link.is_master() {
        output::silence();
    }
    if options.suite == Some(Suite::All) {
        // A suite that fails on one rank alone would leave the others waiting.
        return Err(
            Error::new("`all` is measured by one process").help("name a suite to measure it on ranks")
        );
    }
    let (complete, shares) = experiment::ranks::with(link, cancel.clone(), || run(options));
    Ok(SuiteOutcome { complete: complete?, shares })
}

/// Runs a suite, or all, or lists them. True when it was measured completely, and all of what it printed was read.
///
/// # Errors
/// When a scene or a file is not valid, cannot be read or cannot be written.
pub fn run(options: &Options) -> Result<bool, Error> {
    let common = &options.common;
    if common.counted_time {
        clock::count();
    }
    let in_parts = common.shard != mp_batch::Shard::WHOLE || !common.merge.is_empty();
    match options.suite {
        // Nothing was asked for but what there is: no error, as for `cargo xtask` alone.
        None => output::print(&suite::list()).map(|()| true),
        Some(Suite::All) if in_parts => Err(Error::new("`all` is measured in one piece")
            .help("measure a suite at a time by --shard and --merge")),
        Some(suite) => run_suite(suite, options),
    }
}

fn run_suite(suite: Suite, options: &Options) -> Result<bool, Error> {
    let common = &options.common;
    let (whole, command) = (common.shard == mp_batch::Shard::WHOLE, options.identity(suite));
    if !common.merge.is_empty() {
        shards::begin(&common.out, &shards::merged(&common.merge, &command)?)?;
    }
    if !whole {
        shards::ShardFile::begin(&common.out, &command, common.shard)?;
    }
    let complete = match suite {
        Suite::Collide => collide::run(common, &options.collide),
        Suite::Planners => planners::run(common),
        Suite::Puzzles => puzzles::run(common, &options.puzzles),
        Suite::Rigid => rigid::run(common, &options.rigid),
        Suite::Rrs => rrs::run(common, &options.rrs),
        Suite::Rsrt => rsrt::run(common, &options.rsrt),
        Suite::Roadmaps => roadmaps::run(common, &options.roadmaps),
        Suite::Regions => regions::run(common),
        Suite::Scale => scale::run(common),
        Suite::Scaling => scaling::run(common),
        Suite::Certificates => certificates::run(common),
        Suite::Robots => robots::run(common, &options.robots),
        Suite::Arms => arms::run(common, &options.arms),
        Suite::Assets => assets::run(&options.assets),
        Suite::All => suite::run_each(&suite::MEASURED, |suite| run_suite(suite, options)),
    };
    let complete = complete?;
    if !whole && !experiment::interrupted() {
        shards::ShardFile::new(&command, common.shard, true).write(&common.out)?;
        output::note(&format!(
            "shard {} is measured; --merge with the folders of all shards goes on",
            common.shard
        ));
        return Ok(true);
    }
    Ok(complete && !output::is_closed())
}

/// The program `mp-bench`: [`run`], with what it logs and its error on standard error. Returns the exit code.
#[must_use]
pub fn program(options: &Options) -> u8 {
    let level = std::env::var("RUST_LOG").ok().and_then(|level| level.parse().ok());
    let level = level.unwrap_or(tracing_subscriber::filter::LevelFilter::WARN);
    tracing_subscriber::fmt().with_max_level(level).with_writer(std::io::stderr).init();
    match run(options) {
        Ok(complete) => u8::from(!complete),
        Err(error) => {
            let _ = writeln!(std::io::stderr().lock(), "{}", error.report());
            2
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definition_is_sound() {
        Options::command().debug_assert();
    }
}
