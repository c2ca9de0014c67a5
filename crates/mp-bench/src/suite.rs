//! The suites: their names, what they take, and runs of several.

use crate::error::Result;
use crate::experiment::interrupted;
use crate::output::note;
use clap::ValueEnum;

/// A suite of measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Suite {
    /// RRT-Connect on rigid bodies, to the first solution.
    Rigid,
    /// Every planner on shipped scenes, to the first solution.
    Planners,
    /// Graded scenes, from easy ones to those that nothing here solves: `auto` and single planners, in processor time.
    Puzzles,
    /// Queries between two meshes.
    Collide,
    /// The experiment of Baizid et al.: RRT, and RRS, which bends blocked edges with snakes, in four worlds.
    Rrs,
    /// Experiments of Jouandeau et al. 2008: natural expansion; RSRT and RRT in growing clutter.
    Rsrt,
    /// Roadmaps: corridors of decreasing width, shipped scenes, many queries, growth, pictures.
    Roadmaps,
    /// Roadmaps by regions: what they answer, and how evenly their work is spread over ranks.
    Regions,
    /// Sweeps and portfolios on 1 to 10,000 ranks: measured costs, replayed.
    Scale,
    /// The speed of growth of an RRT without obstacles, against its size.
    Scaling,
    /// What proofs of paths cost: certifying, and replaying by `mp-verify-certificate`.
    Certificates,
    /// Descriptions of robots below a folder: which are planned for, and why not the rest.
    Robots,
    /// Arms on problem sets of MotionBenchMaker: planning, shortening, proof and the whole call.
    Arms,
    /// No measurement: generate the shipped scenes, or check that they are up to date.
    Assets,
    /// All measurements, one after the other; what fails is said at the end.
    All,
}

/// The suites that `all` runs: those that measure, the short ones first.
pub(crate) const MEASURED: [Suite; 11] = [
    Suite::Regions,
    Suite::Rigid,
    Suite::Certificates,
    Suite::Rrs,
    Suite::Scaling,
    Suite::Scale,
    Suite::Collide,
    Suite::Roadmaps,
    Suite::Rsrt,
    Suite::Planners,
    Suite::Puzzles,
];

impl Suite {
    /// About how long it takes on two cores, and with `--quick`.
    fn durations(self) -> [&'static str; 2] {
        match self {
            Self::Rigid => ["1 min", "10 s"],
            Self::Planners => ["hours", "4 min"],
            Self::Puzzles => ["a day", "5 min"],
            Self::Collide => ["30 min", "1 min"],
            Self::Rrs => ["3 min", "10 s"],
            Self::Rsrt => ["2 h", "2 min"],
            Self::Roadmaps => ["1 h", "3 min"],
            Self::Regions => ["1 min", "5 s"],
            Self::Scale => ["10 min", "30 s"],
            Self::Scaling => ["10 min", "1 min"],
            Self::Certificates => ["2 min", "30 s"],
            Self::Robots => ["10 min", "2 min"],
            Self::Arms => ["2 min", "10 s"],
            Self::Assets => ["10 s", "10 s"],
            Self::All => ["days", "20 min"],
        }
    }

    /// Its name on the command line, and what it is, in a line.
    fn words(self) -> [String; 2] {
        let value = self.to_possible_value().unwrap_or_default();
        let help = value.get_help().map(ToString::to_string).unwrap_or_default();
        [value.get_name().to_owned(), help]
    }
}

/// The suites, a line each.
pub(crate) fn list() -> String {
    let mut out =
        "Name a suite; --help has all options. About how long each takes, and with --quick:\n\n".to_owned();
    for suite in Suite::value_variants() {
        let ([name, what], [full, quick]) = (suite.words(), suite.durations());
        out += &format!("  {name:<13} {full:>8} {quick:>8}   {what}\n");
    }
    out.trim_end().to_owned()
}

/// Runs suites, also after one that fails. True when all were measured completely and as expected; else those that were not are said
/// at the end.
pub(crate) fn run_each(suites: &[Suite], mut run: impl FnMut(Suite) -> Result<bool>) -> Result<bool> {
    let (mut measured, mut failed) = (0, Vec::new());
    for suite in suites {
        let [name, what] = suite.words();
        note(&format!("{name}: {what}"));
        match run(*suite) {
            Ok(true) => measured += 1,
            Ok(false) => failed.push(format!("{name}: not all was measured, or as expected")),
            Err(error) => failed.push(format!("{name}: {}", error.report())),
        }
        if interrupted() {
            failed.push("interrupted: what comes after it was not begun".to_owned());
            break;
        }
    }
    note(&format!("{measured} of {} suites are measured", suites.len()));
    failed.iter().for_each(|line| note(line));
    Ok(failed.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_plan::Error;

    #[test]
    fn every_suite_is_listed_and_run_by_all() {
        let list = list();
        for suite in Suite::value_variants() {
            let [name, what] = suite.words();
            assert!(
                list.lines().any(|l| l.starts_with(&format!("  {name} ")) && l.ends_with(&what)),
                "{name}"
            );
            let alone = [Suite::Arms, Suite::Robots, Suite::Assets, Suite::All].contains(suite);
            assert!(MEASURED.contains(suite) != alone && !what.is_empty(), "{name}");
        }
    }

    #[test]
    fn a_suite_that_fails_ends_no_others() {
        let suites = [Suite::Rigid, Suite::Rrs, Suite::Scale, Suite::Collide];
        let mut begun = Vec::new();
        let complete = run_each(&suites, |suite| {
            begun.push(suite);
            match suite {
                Suite::Rigid => Err(Error::new("no such scene")),
                Suite::Scale => Ok(false),
                _ => Ok(true),
            }
        });
        assert_eq!((complete.unwrap(), begun), (false, suites.to_vec()));
        assert!(run_each(&suites, |_| Ok(true)).unwrap());
    }
}
