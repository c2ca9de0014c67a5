//! Options that several suites have.

use clap::Args;
use mp_batch::Shard;
use mp_plan::positive_number;
use std::path::PathBuf;

/// The options of several suites.
#[derive(Clone, Debug, Args)]
#[group(skip)]
pub(crate) struct Common {
    /// A shorter run.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Runs (seeds) of each case.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) runs: Option<u32>,
    /// Scenes to measure on (default: those of the suite); with `roadmaps`, only these are measured;
    /// with `rsrt`, the problems with these words in their names.
    #[arg(long = "scene", value_name = "SCENE")]
    pub(crate) scenes: Vec<String>,
    /// Seconds a run may take.
    #[arg(long, value_name = "S", default_value = "60", value_parser = positive_number)]
    pub(crate) time: f64,
    /// Another program to measure as well; docs/benchmarks.md says how it is called.
    #[arg(long, value_name = "PROGRAM")]
    pub(crate) peer: Option<PathBuf>,
    /// The folder for results.
    #[arg(long, value_name = "DIR", default_value = "out/bench")]
    pub(crate) out: PathBuf,
    /// How many runs at once, in suites whose results do not depend on it [default: one for each core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Measure a part only, I of N, in suites whose results do not depend on the machine's load; `--merge`
    /// puts the parts together.
    #[arg(long, value_name = "I/N", default_value = "1/1", hide_default_value = true)]
    pub(crate) shard: Shard,
    /// Begin with what was measured in these folders, one for each shard. In any order; all of them, of the
    /// same command.
    #[arg(long, value_name = "DIR", num_args = 1.., conflicts_with_all = ["shard", "fresh"])]
    pub(crate) merge: Vec<PathBuf>,
    /// Count how often the time is asked for instead of measuring it: then all results are the same on every
    /// machine, and times mean nothing.
    #[arg(long)]
    pub(crate) counted_time: bool,
    /// Measure again what the folder for results already has.
    #[arg(long)]
    pub(crate) fresh: bool,
}

impl Common {
    /// The defaults.
    #[cfg(test)]
    pub(crate) fn test() -> Self {
        #[derive(clap::Parser)]
        struct Only {
            #[command(flatten)]
            common: Common,
        }
        <Only as clap::Parser>::parse_from(["test"]).common
    }

    /// The scenes that were given, or `own`, those of the suite.
    pub(crate) fn scenes_or(&self, own: &[&str]) -> Vec<String> {
        match self.scenes.as_slice() {
            [] => own.iter().map(|name| (*name).to_owned()).collect(),
            given => given.to_vec(),
        }
    }

    /// The number of runs of each case: as given, else `quick` or `full`.
    pub(crate) fn runs_or(&self, quick: u32, full: u32) -> u32 {
        self.runs.unwrap_or(if self.quick { quick } else { full })
    }
}
