//! The command line.

use crate::bench::PAIRS;
use crate::plan::metrics;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::ffi::OsStr;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// Motion planning on the command line.
///
/// Exit code: 0 solved or true, 1 not solved within the budget or false, 2 bad input.
#[derive(Clone, Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", version, max_term_width = 110)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Clone, Debug, Subcommand)]
pub(crate) enum Command {
    /// Plan on a scene: solve, shorten, verify, and write the path and a picture.
    Plan(Box<Plan>),
    /// Verify a path with the independent checker: exit 0 only if it is certified free.
    Check(Check),
    /// Say what is in a mesh, scene or path file.
    Info(Info),
    /// Draw a scene, and a path through it, with no display.
    Render(Render),
    /// Write the shipped scenes again, or check that they are as made here.
    Assets(crate::assets::AssetsArgs),
    /// Measure, beside other programs where they are given.
    Bench(Bench),
    /// Formatting, lints, tests, documentation and tidiness: what CI runs.
    Ci(Ci),
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Plan {
    /// Scene files, or names of shipped scenes (default: the shipped sample).
    #[arg(value_name = "SCENE")]
    pub(crate) scenes: Vec<PathBuf>,
    /// Which planner. With `or-` before its name independent runs of it race on all threads; with `restart-` it
    /// begins anew when it takes too long.
    #[arg(long, value_name = "NAME", default_value = "rrt-connect",
          value_parser = PlannerName)]
    pub(crate) planner: String,
    /// How far apart two configurations are (`default`: ‖Δp‖ + 0.5·angle, in metres and radians).
    #[arg(long, value_name = "NAME", default_value = metrics::DEFAULT,
          value_parser = PossibleValuesParser::new(metrics::values()))]
    pub(crate) metric: String,
    /// All randomness flows from this number.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Stop after this many seconds.
    #[arg(long, value_name = "S", default_value = "60", value_parser = positive)]
    pub(crate) time: f64,
    /// Stop after this many iterations.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) iterations: Option<u64>,
    /// Longest edge of a tree, not of a roadmap: a distance of the metric, or a percentage of the extent of the space
    /// [default: 5%].
    #[arg(long, value_name = "ε")]
    pub(crate) step: Option<Length>,
    /// How motions are checked: `certified` (no wall is ever missed) or `discrete:R`, at steps of R (a
    /// distance of the metric, or a percentage of the extent). What is written is certified either way.
    #[arg(long, value_name = "CHECK", default_value = "certified")]
    pub(crate) motion: Motion,
    /// Plan this often, with seeds N, N + 1, …, and print a table.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) runs: u32,
    /// How many runs at once; of a single run, how many threads it may use. Results do not depend on it.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: u16,
    /// Set a parameter of the planner.
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// The file of a roadmap: goes on with it when it is there, and keeps what there is in the end. For the same
    /// scene, robot and metric, and planners that build roadmaps.
    #[arg(long, value_name = "FILE")]
    pub(crate) roadmap: Option<PathBuf>,
    /// Where the path goes: a GEMPA configuration file, or JSON if it ends in `.json`. `{scene}` and
    /// `{seed}` stand for their names.
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Where the picture goes (`.png`; of worlds in the plane `.svg` too). `{scene}` and `{seed}` stand for their names.
    #[arg(long, value_name = "FILE")]
    pub(crate) picture: Option<PathBuf>,
    /// Print one JSON object on standard output, and write only the files asked for.
    #[arg(long)]
    pub(crate) json: bool,
    /// Leave the path as the planner found it.
    #[arg(long)]
    pub(crate) no_shorten: bool,
    /// Instead of shortening the path, leave out what it does not need and let a snake relax it away from obstacles.
    #[arg(long)]
    pub(crate) relax: bool,
    /// Also write each scene to this folder as one JSON and two OFF files, for other planners.
    #[arg(long, value_name = "DIR")]
    pub(crate) export: Option<PathBuf>,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Check {
    /// A scene file, or the name of a shipped scene.
    pub(crate) scene: PathBuf,
    /// A path: GEMPA configuration file or `.json`.
    pub(crate) path: PathBuf,
    /// Print one JSON object on standard output.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Info {
    /// A mesh, scene or path file.
    pub(crate) file: PathBuf,
    /// Print one JSON object on standard output.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Render {
    /// A scene file, or the name of a shipped scene.
    pub(crate) scene: PathBuf,
    /// A path: GEMPA configuration file or `.json`.
    pub(crate) path: Option<PathBuf>,
    /// Where the picture goes (`.png`; of worlds in the plane `.svg` too).
    #[arg(long, value_name = "FILE")]
    pub(crate) picture: PathBuf,
    /// Width and height in pixels.
    #[arg(long, value_name = "W×H", default_value = "1280x960", value_parser = pixels)]
    pub(crate) size: (usize, usize),
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Bench {
    /// What to measure.
    #[arg(value_name = "SUITE")]
    pub(crate) suite: Suite,
    /// A shorter run.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Runs (seeds) of each case.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) runs: Option<u32>,
    /// Scenes to measure on (default: those of the suite); of `roadmaps` these alone.
    #[arg(long = "scene", value_name = "SCENE")]
    pub(crate) scenes: Vec<String>,
    /// Seconds a run may take.
    #[arg(long, value_name = "S", default_value = "60", value_parser = positive)]
    pub(crate) time: f64,
    /// Of the suite `rigid`: longest edge of a tree, as a percentage of the extent of the space or a distance of the metric.
    #[arg(long, value_name = "ε", default_value = "20%")]
    pub(crate) step: Length,
    /// Another program to measure beside ours, in turn; how it is called is in docs/benchmarks.md.
    #[arg(long, value_name = "PROGRAM")]
    pub(crate) peer: Option<PathBuf>,
    /// The folder for results.
    #[arg(long, value_name = "DIR", default_value = "out/bench")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) collide: BenchCollide,
    #[command(flatten)]
    pub(crate) rsrt: BenchRsrt,
    #[command(flatten)]
    pub(crate) rrs: BenchRrs,
}

/// What only the suites `rsrt`, `rrs` and `roadmaps` have.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Of the suites `rsrt`, `rrs` and `roadmaps`")]
pub(crate) struct BenchRsrt {
    /// Seconds of processor time a run of `rsrt` may take, for the paper's 60 s of 2008 [default: 6; 0.25 with
    /// --quick].
    #[arg(long, value_name = "S", value_parser = positive)]
    pub(crate) cap: Option<f64>,
    /// Collision queries a run of `roadmaps` may ask [default: 100000; 10000 with --quick].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) queries: Option<u64>,
    /// How many runs at once [default: one for each core]; what is found does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Measure anew what was measured before and is in the folder for results.
    #[arg(long)]
    pub(crate) fresh: bool,
}

/// What only the suite `rrs` has.
#[derive(Clone, Copy, Debug, Default, Args)]
#[command(next_help_heading = "Of the suite `rrs`")]
pub(crate) struct BenchRrs {
    /// Let a robot with noisy wheels and a noisy laser follow the paths instead.
    #[arg(long)]
    pub(crate) follow: bool,
    /// Compare for a body that flies instead: RRT and RRS on `gempa-3` or the scenes given, with the same steps.
    #[arg(long, conflicts_with = "follow")]
    pub(crate) flying: bool,
    /// Draw what pushes snakes, and a tree whose edges bend, instead.
    #[arg(long, conflicts_with_all = ["follow", "flying"])]
    pub(crate) pictures: bool,
}

/// What only the suite `collide` has.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Of the suite `collide`")]
pub(crate) struct BenchCollide {
    /// Pairs of meshes to measure on (default: all).
    #[arg(long = "pair", value_name = "PAIR", value_parser = PossibleValuesParser::new(PAIRS))]
    pub(crate) pairs: Vec<String>,
    /// Compare booleans with exact arithmetic instead; exit code 0 if all are right.
    #[arg(long)]
    pub(crate) referee: bool,
    /// Measure the cost of a query and of a tree against the number of triangles instead.
    #[arg(long, conflicts_with = "referee")]
    pub(crate) growth: bool,
    /// Poses of each pair for --referee [default: a million for all pairs together].
    #[arg(long, value_name = "N", requires = "referee")]
    pub(crate) poses: Option<usize>,
    /// The seed of the poses.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// A folder of other programs to measure in turn with ours; how they are called is in docs/benchmarks.md.
    #[arg(long, value_name = "DIR")]
    pub(crate) peers: Option<PathBuf>,
    /// Write meshes and poses to this folder, for other programs; without --peers, measure nothing.
    #[arg(long, value_name = "DIR")]
    pub(crate) export: Option<PathBuf>,
}

/// A suite of measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Suite {
    /// RRT-Connect on rigid bodies, to the first solution.
    Rigid,
    /// Every planner on shipped scenes, to the first solution.
    Planners,
    /// Queries between two meshes.
    Collide,
    /// The experiment of Baizid et al.: RRT and RRS, whose blocked edges are bent by snakes, in four worlds.
    Rrs,
    /// Experiments of Jouandeau et al. 2008: natural expansion; RSRT and RRT in growing clutter.
    Rsrt,
    /// Roadmaps: corridors that shrink, shipped scenes, many queries, growth, pictures.
    Roadmaps,
    /// Growth of an RRT where nothing is in the way, against its size.
    Scaling,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Ci {
    /// Leave the tests out.
    #[arg(long)]
    pub(crate) no_tests: bool,
}

/// A distance of the metric, or a share of the extent of the space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Length {
    /// In the unit of the metric.
    Absolute(f64),
    /// Of the extent, 1 being all of it.
    Fraction(f64),
}

/// As it is given on the command line.
impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Absolute(length) => write!(f, "{length}"),
            Self::Fraction(fraction) => write!(f, "{}%", 100.0 * fraction),
        }
    }
}

impl FromStr for Length {
    type Err = String;
    fn from_str(s: &str) -> Result<Self, String> {
        match s.strip_suffix('%') {
            Some(percent) => match positive(percent)? {
                p if p <= 100.0 => Ok(Self::Fraction(p / 100.0)),
                _ => Err("more than 100% of the extent".into()),
            },
            None => positive(s).map(Self::Absolute),
        }
    }
}

/// How motions are checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Motion {
    /// Clearance against motion bounds: nothing is missed.
    Certified,
    /// At steps of this length.
    Discrete(Length),
}

impl FromStr for Motion {
    type Err = String;
    fn from_str(s: &str) -> Result<Self, String> {
        match (s, s.strip_prefix("discrete:")) {
            ("certified", _) => Ok(Self::Certified),
            (_, Some(resolution)) => resolution.parse().map(Self::Discrete),
            ("discrete", _) => Err("give the resolution, such as discrete:1% or discrete:0.05".into()),
            _ => Err("expected `certified` or `discrete:R`, such as discrete:1%".into()),
        }
    }
}

/// Takes the name of a planner, wrapped or not.
#[derive(Clone, Debug)]
struct PlannerName;

impl TypedValueParser for PlannerName {
    type Value = String;
    fn parse_ref(
        &self,
        command: &clap::Command,
        arg: Option<&clap::Arg>,
        value: &OsStr,
    ) -> Result<String, clap::Error> {
        match value.to_str() {
            Some(name) if mp::tree::Named::new(name).is_ok() || mp::roadmap::planner(name).is_ok() => {
                Ok(name.to_owned())
            }
            _ => PossibleValuesParser::new(planners()).parse_ref(command, arg, value),
        }
    }
    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(planners().into_iter()))
    }
}

/// The planners by name.
fn planners() -> Vec<PossibleValue> {
    let value = |p: &mp::tree::PlannerInfo| {
        let also = match p.aliases {
            [] => String::new(),
            names => format!(" (also {})", names.join(", ")),
        };
        PossibleValue::new(p.name).aliases(p.aliases).help(format!("{}{also}", p.summary))
    };
    mp::tree::planners().iter().chain(mp::roadmap::planners()).map(value).collect()
}

/// A finite number above zero.
fn positive(s: &str) -> Result<f64, String> {
    match s.trim().parse::<f64>() {
        Ok(v) if v.is_finite() && v > 0.0 => Ok(v),
        Ok(_) => Err("must be a finite number above zero".into()),
        Err(_) => Err("not a number".into()),
    }
}

/// `WxH`, both from 64 to 8192.
fn pixels(s: &str) -> Result<(usize, usize), String> {
    let sides = s.split_once(['x', '×']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    match sides {
        Some((w, h)) if (64..=8192).contains(&w) && (64..=8192).contains(&h) => Ok((w, h)),
        Some(_) => Err("each side must be from 64 to 8192".into()),
        None => Err("expected WIDTHxHEIGHT, such as 1280x960".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definition_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn lengths_and_motions() {
        assert_eq!("20%".parse(), Ok(Length::Fraction(0.2)));
        assert_eq!("0.5".parse(), Ok(Length::Absolute(0.5)));
        assert_eq!("discrete:1%".parse(), Ok(Motion::Discrete(Length::Fraction(0.01))));
        for bad in ["", "0", "-1", "nan", "inf", "101%", "0%", "%", "x"] {
            assert!(bad.parse::<Length>().is_err(), "{bad}");
            assert!(format!("discrete:{bad}").parse::<Motion>().is_err(), "{bad}");
        }
    }
}
