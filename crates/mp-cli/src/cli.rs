//! The command line.

use crate::examples;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use mp_batch::Shard;
use mp_io::ProblemChanges;
use mp_plan::{
    FreeTurns, Interpolation, Length, MetricName, Mode, MotionValidator, ObjectiveName, Pace, PlannerInfo,
    PortfolioSchedule, RelaxField, Request, positive_number,
};
use std::ffi::OsStr;
use std::path::PathBuf;
use std::str::FromStr;

/// Motion planning on the command line.
///
/// Exit code: 0 solved or true, 1 not solved within the budget or false, 2 bad input, 141 when the reader of standard output has
/// gone.
#[derive(Clone, Debug, Parser)]
#[command(name = "mp", bin_name = "mp", version, max_term_width = 110)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Clone, Debug, Subcommand)]
pub(crate) enum Command {
    /// Plan on a scene: solve, shorten, verify, and write the path and a picture.
    #[command(after_long_help = examples::PLAN)]
    Plan(Box<Plan>),
    /// Plan all problems of a list, thousands of them, and go on where that ended before.
    #[command(after_long_help = examples::MANY)]
    Many(Many),
    /// Merge the results of all shards of a list.
    #[command(after_long_help = examples::MERGE)]
    Merge(Merge),
    /// Verify a path with the independent checker: exit 0 only if it is certified free. Or explain one configuration.
    #[command(after_long_help = examples::CHECK)]
    Check(Check),
    /// Give a path of an arm times: along it as fast as the limits of its joints allow, with rounded corners, and the curve that a controller
    /// runs proved free.
    #[command(after_long_help = examples::TIME)]
    Time(Time),
    /// Describe a mesh, scene or path file.
    #[command(after_long_help = examples::INFO)]
    Info(Info),
    /// Find which links of a robot may touch, and write it as an SRDF, as the Setup Assistant of MoveIt does: those that a joint
    /// connects, that touch at the neutral configuration, always or never, in thousands of configurations.
    #[command(after_long_help = examples::SRDF)]
    Srdf(Srdf),
    /// Find configurations of an arm that place a link: inverse kinematics. The free ones first, from the nearest to the start on; one on each
    /// line, as `check --at` takes them.
    #[command(after_long_help = examples::IK)]
    Ik(Ik),
    /// Draw a scene, and a path through it, as a picture, film, page or meshes, with no display.
    #[command(after_long_help = examples::RENDER)]
    Render(Render),
    /// Open the viewer in the browser: look at a scene and a path, edit the scene, and plan.
    #[command(after_long_help = examples::VIEW)]
    View(View),
    /// List the shipped scenes: for a person in groups, with a sentence about each, and their names alone for programs.
    Scenes,
    /// List the robots that can be named: URDFs in the folders of `MP_ROBOTS`, `ROS_PACKAGE_PATH` and `AMENT_PREFIX_PATH`, the cache of
    /// `robot_descriptions` for Python (`ROBOT_DESCRIPTIONS_CACHE`), and the packages of Python.
    Robots(Robots),
    /// Run benchmarks, with the program `mp-bench`.
    #[command(disable_help_flag = true, after_long_help = examples::BENCH)]
    Bench(Passed),
    /// Replay a certificate, with the program `mp-verify-certificate`: exit 0 only if it proves its path free. With `--scene SCENE` also compare
    /// it with a scene: its bodies, where they stand, what is kept apart, and the ends of its path.
    #[command(disable_help_flag = true, after_long_help = examples::VERIFY)]
    VerifyCertificate(Passed),
    /// Print completions for a shell.
    #[command(after_long_help = examples::COMPLETIONS)]
    Completions {
        /// Which shell.
        shell: clap_complete::Shell,
    },
    /// Print the manual, as a page for `man`.
    #[command(after_long_help = examples::MAN)]
    Man,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Plan {
    /// Scene files, or names of shipped scenes or robots (default: the shipped sample); `-` for standard input. `mp scenes` and `mp
    /// robots` list names.
    #[arg(value_name = "SCENE")]
    pub(crate) scenes: Vec<PathBuf>,
    /// Which planner. With `or-` before its name, independent runs of it race on all threads; with `restart-`, it
    /// starts again when it takes too long [default: auto, which takes turns and begins with rrt-connect; rrt among obstacles that
    /// move; rsrt for robots that move by inputs; rrt-connect where --portfolio would have many of auto; cyclic-rrt with --routes].
    #[arg(long, value_name = "NAME", value_parser = PlannerName)]
    pub(crate) planner: Option<String>,
    /// How far apart two configurations are (`default`, of a body: ‖Δp‖ + 0.5·angle, in metres and radians).
    #[arg(long, value_name = "NAME", default_value = "default",
          value_parser = PossibleValuesParser::new(metrics()).map(|name| metric(&name)))]
    pub(crate) metric: MetricName,
    /// The seed of all random numbers.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Stop after this many seconds, loading, shortening and verifying included. The search may take nine tenths of them.
    #[arg(long, value_name = "S", default_value = "60", value_parser = positive_number)]
    pub(crate) time: f64,
    /// Stop when the program takes this much memory, such as 500MB or 1.5GiB.
    #[arg(long, value_name = "SIZE", value_parser = crate::memory::size)]
    pub(crate) memory: Option<u64>,
    /// Stop after this many iterations.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) iterations: Option<u64>,
    /// Longest edge of a tree, not of a roadmap: a distance of the metric, or a percentage of the extent of the space
    /// [default: 5%].
    #[arg(long, value_name = "ε", value_parser = parsed::<Length>)]
    pub(crate) step: Option<Length>,
    /// How motions are checked: `certified` (no wall is ever missed) or `discrete:R`, at steps of R (a
    /// distance of the metric, or a percentage of the extent). The path that is written is certified in both cases.
    #[arg(long, value_name = "CHECK", default_value = "certified", value_parser = parsed::<MotionValidator>)]
    pub(crate) motion: MotionValidator,
    /// Keep this clearance from obstacles all along, metres: planning, shortening, the proof and the certificate mind it. The links of an
    /// arm may be nearer to each other.
    #[arg(long, value_name = "M", value_parser = positive_number)]
    pub(crate) clearance: Option<f64>,
    /// What the path costs: `length`, or `clearance:WEIGHT:RANGE`, ∫ (1 + WEIGHT·(1 − d/RANGE)²) ds for a clearance d below the RANGE (m); both
    /// may be left out, and are then 10 and a fifth of the size of the robot. Planners that improve their paths (aorrtc, rrt-star,
    /// informed-rrt-star) lower it, t-rrt prefers states that cost little, and shortening lowers it, whatever the planner.
    #[arg(long, value_name = "COST", default_value = "length", value_parser = explained::<ObjectiveName>)]
    pub(crate) objective: ObjectiveName,
    /// Plan this many times, with seeds N, N + 1, …, and print a table.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) runs: u32,
    /// Find this many routes that are far apart, and write each to a file of its own: `-1`, `-2`, … is put before the ending of
    /// the files. For cyclic-rrt, which is taken unless another planner is named, and planners whose roadmaps have
    /// cycles, such as prm-star.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=100))]
    pub(crate) routes: Option<u16>,
    /// How far apart routes are found: each is somewhere farther from all routes before it. Shortened they may be nearer. A distance of the
    /// metric, or a percentage of the extent of the space.
    #[arg(long, value_name = "DISTANCE", default_value = "10%", requires = "routes", value_parser = parsed::<Length>)]
    pub(crate) apart: Length,
    /// Race this many runs with random numbers of their own: the one with the fewest iterations wins, whichever is ready first. For
    /// problems that some seeds solve many times sooner than others. As many more follow when a schedule ends them without a path, until
    /// the time is up; with `--iterations` none do.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1 << 30),
          conflicts_with_all = ["routes", "roadmap"])]
    pub(crate) portfolio: Option<u64>,
    /// How many iterations each run of a portfolio may make: as many as it needs (`none`), or units by the schedule `luby`,
    /// `counter`, `zeta` or `wide`, as `restart-` planners one after the other.
    #[arg(long, value_name = "NAME", default_value = "none", requires = "portfolio",
          value_parser = PossibleValuesParser::new(PortfolioSchedule::ALL.map(PortfolioSchedule::name))
              .map(|name| name.parse::<PortfolioSchedule>().unwrap_or_default()))]
    pub(crate) schedule: PortfolioSchedule,
    /// Iterations of a unit of the schedule.
    #[arg(long, value_name = "N", default_value_t = 1000, requires = "portfolio",
          value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    pub(crate) unit: u64,
    /// How many runs of a portfolio race at a time, in memory too. The next ones begin when none of these has a path.
    #[arg(long, value_name = "N", default_value_t = 64, requires = "portfolio",
          value_parser = clap::value_parser!(u64).range(1..=1 << 20))]
    pub(crate) round: u64,
    /// Keep finished runs of a portfolio in this file, and go on with those in it: a program that was interrupted or killed loses no
    /// more than one round. The file is deleted in the end.
    #[arg(long, value_name = "FILE", requires = "portfolio")]
    pub(crate) checkpoint: Option<PathBuf>,
    /// How many runs at once; for a single run or a portfolio, how many threads it may use. Results do not depend on it.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: u16,
    /// Set a parameter of the planner.
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// A request in JSON, as a file or `-`: planner, settings, seed, budgets and what else it may say, in place of the options for
    /// these, which cannot stand beside it.
    #[arg(long, value_name = "FILE",
          conflicts_with_all = ["planner", "metric", "seed", "time", "iterations", "step", "motion", "clearance", "objective",
                                "set", "roadmap", "report", "no_shorten", "hybridize", "relax"])]
    pub(crate) request: Option<PathBuf>,
    /// The file of a roadmap: it is loaded when it exists, and the grown roadmap is saved there. For planners that
    /// build roadmaps, and rigid bodies; scene, robot, metric and clearance must stay the same.
    #[arg(long, value_name = "FILE")]
    pub(crate) roadmap: Option<PathBuf>,
    /// The file for the path, in the format of its ending: `.txt`, `.json` or `.csv`; `-` for text on standard
    /// output. `{scene}` and `{seed}` are replaced by scene and seed.
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// The file for the picture (`.png`; for worlds in the plane also `.svg`), a film (`.gif`, `.mp4`), the page of the
    /// viewer (`.html`), which opens in a browser without a network, the scene as the page reads it (`.mpv`), or meshes with
    /// the motion (`.glb`). Page and `.mpv` show the trees or the roadmap of the run too. `{scene}` and `{seed}` are
    /// replaced by scene and seed. `mp render` has more choices.
    #[arg(long, value_name = "FILE")]
    pub(crate) picture: Option<PathBuf>,
    /// The file for the certificate: a proof that the path is free, which `mp verify-certificate` replays with code of its own.
    /// `{scene}` and `{seed}` are replaced by scene and seed.
    #[arg(long, value_name = "FILE", conflicts_with = "routes")]
    pub(crate) certificate: Option<PathBuf>,
    /// The file for the trajectory of an arm: the path with times, as fast as the limits of its joints allow, whose curve is proved free. `.csv`, or
    /// JointTrajectory of ROS as `.json` or `.yaml`, or a recording of ROS 2 that shows it all as `.mcap`. `{scene}` and `{seed}` are replaced by scene and seed.
    #[arg(long, value_name = "FILE", conflicts_with = "routes")]
    pub(crate) trajectory: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) pace: PaceOptions,
    /// Print one JSON object on standard output, and write only the files asked for.
    #[arg(long)]
    pub(crate) json: bool,
    /// With --json: measure the clearance of the path as near as can be. The report has the bound that the proof gives otherwise.
    #[arg(long, value_name = "WHAT", value_parser = ["clearance"])]
    pub(crate) report: Option<String>,
    /// Keep the path as the planner found it.
    #[arg(long)]
    pub(crate) no_shorten: bool,
    /// Plan this many paths, with seeds N, N + 1, …, and merge them into a shorter one. Each takes as long as the first; eight are many.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=100),
          conflicts_with_all = ["no_shorten", "relax", "routes", "portfolio"])]
    pub(crate) hybridize: u8,
    /// Instead of shortening the path, remove detours and let a snake relax it in a field: `clearance`, the default (obstacles
    /// repel); in the plane also `paper` (eq. 3 of Baizid et al.), `risk` (the landscape of risk of inexact motion and sensing;
    /// `risk:2` for twice the noise) and `image:FILE` (dark pixels of a PNG or PGM image over the bounds of the robot repel). A picture of a world in the plane shows the field too.
    #[arg(long, value_name = "FIELD", num_args = 0..=1, default_missing_value = "clearance", value_parser = relax_field)]
    pub(crate) relax: Option<RelaxField>,
    /// Also write each scene to this folder as one JSON and two OFF files, for other planners.
    #[arg(long, value_name = "DIR")]
    pub(crate) export: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) changes: Changes,
}

/// What replaces or joins parts of a scene.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "The problem")]
pub(crate) struct Changes {
    /// Another start: numbers separated by commas or blanks, or the name of a state in the SRDF of the robot.
    #[arg(long, alias = "start", value_name = "START", allow_hyphen_values = true)]
    pub(crate) from: Option<String>,
    /// Another goal, in place of all others; with several, a path ends at any of them. Numbers, a name, or what stands in a goal of a
    /// problem, such as "link = 'hand', pose = [0.5, 0, 0.3, 0, 3.14, 0]".
    #[arg(long, alias = "goal", value_name = "GOAL", allow_hyphen_values = true)]
    pub(crate) to: Vec<String>,
    /// One more obstacle: what stands in an obstacle of a problem, such as "box = [0.4, 0.4, 0.02], at = [0.5, 0, 0.3]".
    #[arg(long, value_name = "OBSTACLE")]
    pub(crate) obstacle: Vec<String>,
    /// An argument of a robot with macros (`.xacro`), which a program with the feature `xacro` expands.
    #[arg(long, value_name = "NAME:=VALUE")]
    pub(crate) arg: Vec<String>,
}

impl Changes {
    /// As libraries take them.
    pub(crate) fn of_problem(&self) -> ProblemChanges {
        let Self { from, to, obstacle, arg } = self.clone();
        ProblemChanges { from, to, obstacles: obstacle, arguments: arg }
    }
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Many {
    /// The list: a text file with one JSON object a line, such as {"scene": "cubicles", "seeds": {"from": 1, "count": 100}}. Scenes
    /// are shipped ones, or files relative to the list. docs/formats/many.md describes it.
    pub(crate) list: PathBuf,
    /// The file for the results, JSON lines: a report for each problem and seed, in order, or the error for which there is none. If it
    /// is there already, from a run that was interrupted or killed, this one goes on with it.
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// How many problems at once [default: one for each core]. Results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Plan only the part I of N of the list, I from 1. `mp merge` puts the results of all parts together.
    #[arg(long, value_name = "I/N", default_value = "1/1", value_parser = parsed::<Shard>)]
    pub(crate) shard: Shard,
    /// The budget of time of each problem that names none, seconds [default: 60]. Where time ends a run, results depend on the
    /// machine: name budgets of iterations or nodes in the list, and give enough time.
    #[arg(long, value_name = "S", value_parser = positive_number)]
    pub(crate) time: Option<f64>,
    /// Write times into the reports. Results are then not the same twice.
    #[arg(long)]
    pub(crate) times: bool,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Merge {
    /// The file for the merged results: the bytes of a run of the whole list.
    pub(crate) out: PathBuf,
    /// The results of all shards, in any order.
    #[arg(required = true)]
    pub(crate) shards: Vec<PathBuf>,
}

/// How the curve between points of a trajectory is chosen: `None` is the controller's choice.
pub(crate) type Curve = Option<Interpolation>;

fn curve(name: &str) -> Curve {
    match name {
        "linear" => Some(Interpolation::Linear),
        "cubic" => Some(Interpolation::Cubic),
        "quintic" => Some(Interpolation::Quintic),
        _ => None,
    }
}

/// How a path is timed.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Trajectories")]
pub(crate) struct PaceOptions {
    /// The part of the limits of velocity that a trajectory uses.
    #[arg(long, value_name = "PART", default_value = "1", value_parser = positive_number)]
    pub(crate) velocity_scale: f64,
    /// The part of the limits of acceleration that it uses.
    #[arg(long, value_name = "PART", default_value = "1", value_parser = positive_number)]
    pub(crate) acceleration_scale: f64,
    /// The part of the limits of jerk that it uses; where the robot has none, jerk is not limited.
    #[arg(long, value_name = "PART", default_value = "1", value_parser = positive_number)]
    pub(crate) jerk_scale: f64,
    /// How far from corners of the path it may pass, in radians and metres of all joints together, where that is free; 0: it stops at each.
    #[arg(long, value_name = "DISTANCE", default_value = "0.1")]
    pub(crate) deviation: f64,
}

impl PaceOptions {
    /// As libraries take them.
    pub(crate) fn pace(&self) -> Pace {
        let Self { velocity_scale, acceleration_scale, jerk_scale, deviation } = *self;
        Pace { velocity: velocity_scale, acceleration: acceleration_scale, jerk: jerk_scale, deviation }
    }
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Time {
    /// A scene with an arm: a file, or the name of a shipped scene.
    pub(crate) scene: PathBuf,
    /// A path that is free: text, `.json` or `.csv`; `-` for standard input.
    pub(crate) path: PathBuf,
    /// The file for the trajectory: `.csv`, JointTrajectory of ROS as `.json` or `.yaml`, or a recording as `.mcap` [default: CSV on standard output].
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Write points this many times a second, and prove the curve between those. Without it there are as few points as the curve needs.
    #[arg(long, value_name = "HZ", value_parser = positive_number)]
    pub(crate) rate: Option<f64>,
    #[command(flatten)]
    pub(crate) pace: PaceOptions,
    #[command(flatten)]
    pub(crate) changes: Changes,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Check {
    /// A scene file, or the name of a shipped scene; `-` for standard input.
    pub(crate) scene: PathBuf,
    /// A path: text, `.json` or `.csv`; or a trajectory of an arm: `.csv` with times, `.json` or `.yaml` as ROS and MoveIt write them, `.mcap`; `-` for
    /// standard input. Of a motion of several parts, the paths of its parts in order, or of the first ones.
    #[arg(required_unless_present = "at")]
    pub(crate) paths: Vec<PathBuf>,
    /// The curve between the points of a trajectory. `controller`: what joint_trajectory_controller of ROS runs, quintic where there are
    /// accelerations, else cubic where there are velocities, else linear.
    #[arg(long = "as", value_name = "CURVE", conflicts_with = "at",
          value_parser = PossibleValuesParser::new(["controller", "linear", "cubic", "quintic"]).map(|name| curve(&name)))]
    pub(crate) curve: Option<Curve>,
    /// Explain this configuration instead: numbers separated by blanks or commas.
    #[arg(long, value_name = "NUMBERS", conflicts_with = "paths", allow_hyphen_values = true)]
    pub(crate) at: Option<String>,
    /// The clearance from obstacles that is asked for, metres: what comes nearer is not free.
    #[arg(long, value_name = "M", value_parser = positive_number)]
    pub(crate) clearance: Option<f64>,
    /// The file for the certificate: a proof that the path is free, which `mp verify-certificate` replays with code of its own.
    #[arg(long, value_name = "FILE", conflicts_with = "at")]
    pub(crate) certificate: Option<PathBuf>,
    /// Print one JSON object on standard output.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) changes: Changes,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Srdf {
    /// A robot: a URDF, or a robot problem, whose limits of joints count.
    pub(crate) robot: PathBuf,
    /// The file for the SRDF [default: standard output]. Called like the URDF and beside it, it is found.
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Replace the file, if it is there already.
    #[arg(long, requires = "out")]
    pub(crate) replace: bool,
    /// Leave out links that were never seen to touch, so that they go on being compared: slower, and nothing can be missed.
    #[arg(long)]
    pub(crate) check_never: bool,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Ik {
    /// A scene with an arm, or a URDF.
    pub(crate) scene: PathBuf,
    /// The link to place, such as the tool.
    #[arg(long, value_name = "LINK")]
    pub(crate) link: String,
    /// Where it is to be in the world, "x y z α β γ": metres, then radians about Z, Y and X.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, conflicts_with = "position")]
    pub(crate) pose: Option<String>,
    /// Where its origin is to be, "x y z", turned in any way.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true)]
    pub(crate) position: Option<String>,
    /// What may turn freely: the link about its own `x`, `y` or `z`, or `all`.
    #[arg(long, value_name = "AXIS", default_value = "none", requires = "pose", value_parser = parsed::<FreeTurns>)]
    pub(crate) free: FreeTurns,
    /// How far the origin may be off along each axis of the pose, metres.
    #[arg(long, value_name = "M", value_parser = positive_number)]
    pub(crate) within: Option<f64>,
    /// Where searches begin, and what the free ones are sorted by: see `mp plan --from`.
    #[arg(long, value_name = "START", allow_hyphen_values = true)]
    pub(crate) from: Option<String>,
    /// One more obstacle: see `mp plan --obstacle`.
    #[arg(long, value_name = "OBSTACLE")]
    pub(crate) obstacle: Vec<String>,
    /// At most this many free ones.
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) most: u16,
    /// Also those in collision.
    #[arg(long)]
    pub(crate) all: bool,
    /// Print one JSON array on standard output.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Robots {
    /// Only robots with this in their names.
    pub(crate) word: Option<String>,
    /// Print one JSON array on standard output.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Info {
    /// A mesh, scene or path file, or the name of a shipped scene.
    pub(crate) file: PathBuf,
    /// Print one JSON object on standard output.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) changes: Changes,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct Render {
    /// A scene file, or the name of a shipped scene; `-` for standard input.
    pub(crate) scene: PathBuf,
    /// A path: text, `.json` or `.csv`; `-` for standard input.
    pub(crate) path: Option<PathBuf>,
    /// The file, in the format of its ending: a picture (`.png`; for worlds in the plane also `.svg`), a film (`.gif`, or
    /// `.mp4` by an installed ffmpeg), the page of the viewer (`.html`), which opens in a browser without a network, the scene
    /// that the page shows (`.mpv`), or meshes with the motion for other programs (`.glb`).
    #[arg(long, visible_alias = "out", value_name = "FILE")]
    pub(crate) picture: PathBuf,
    #[command(flatten)]
    pub(crate) drawing: Drawing,
    #[command(flatten)]
    pub(crate) changes: Changes,
}

/// How pictures and films are drawn.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct Drawing {
    /// Width and height in pixels [default: 1280x960; films 640x480].
    #[arg(long, value_name = "W×H", value_parser = pixels)]
    pub(crate) size: Option<(usize, usize)>,
    /// How bodies are drawn [default: solid].
    #[arg(long, value_name = "MODE", value_parser =
          PossibleValuesParser::new(Mode::ALL.map(|(_, name)| name)).map(|name| name.parse().unwrap_or(Mode::Solid)))]
    pub(crate) mode: Option<Mode>,
    /// From where a scene in space is seen: `front`, `back`, `left`, `right`, `top`, `bottom`, `iso`, or
    /// `eye=x,y,z target=x,y,z fov=degrees` (of the height); with `ortho` after it in parallel projection
    /// [default: where the path is seen best].
    #[arg(long, value_name = "VIEW", value_parser = parsed::<mp_plan::View>)]
    pub(crate) camera: Option<mp_plan::View>,
    /// All configurations of the path at once, or one at a time, with start and goal translucent [default: all; films step].
    #[arg(long, value_name = "HOW")]
    pub(crate) animation: Option<Animation>,
    /// The moment of the path that a picture shows, as a fraction of its length, 0 to 1 [default: 0.5 with
    /// `--animation step`].
    #[arg(long, value_name = "T", value_parser = fraction)]
    pub(crate) at: Option<f64>,
    /// Below a world in the plane, show the field that pushes snakes: `clearance`, `paper`, `risk` (of the path), `image:FILE`;
    /// see `mp plan --relax`.
    #[arg(long, value_name = "FIELD", value_parser = relax_field)]
    pub(crate) field: Option<RelaxField>,
    /// In a page (`.html`), put the planner inside too, so that whoever opens it can plan in it, without a network.
    #[arg(long)]
    pub(crate) with_planner: bool,
    /// In a film, turn the camera once around the scene.
    #[arg(long)]
    pub(crate) turntable: bool,
    /// In a film, keep the robot in the middle.
    #[arg(long)]
    pub(crate) follow: bool,
    /// How long a film or the motion in a `.glb` takes, seconds [default: 8].
    #[arg(long, value_name = "S", value_parser = positive_number)]
    pub(crate) seconds: Option<f64>,
    /// How many frames per second a film has [default: 20].
    #[arg(long, value_name = "N", value_parser = positive_number)]
    pub(crate) fps: Option<f64>,
    /// How many frames of a film are drawn at once [default: one for each core]. The film does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

/// What is shown of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Animation {
    /// All configurations at once.
    All,
    /// One configuration.
    Step,
}

#[derive(Clone, Debug, Args)]
pub(crate) struct View {
    /// A scene file, or the name of a shipped scene; `-` for standard input. Also a mesh, which becomes a robot to build a scene
    /// around, or a file of the viewer (`.mpv`). Without it, the page shows the shipped scenes.
    pub(crate) scene: Option<PathBuf>,
    /// A path: text, `.json` or `.csv`; `-` for standard input.
    pub(crate) path: Option<PathBuf>,
    /// Show the shipped scenes, to choose one of them, as without SCENE.
    #[arg(long, conflicts_with = "scene")]
    pub(crate) gallery: bool,
    /// Print the address, and do not open a browser.
    #[arg(long)]
    pub(crate) no_browser: bool,
    /// The port to listen on [default: a free one].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1024..))]
    pub(crate) port: Option<u16>,
    /// The folder where the page saves files [default: that of the scene, or the current one].
    #[arg(long, value_name = "DIR")]
    pub(crate) folder: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) changes: Changes,
}

/// Arguments for another program.
#[derive(Clone, Debug, Args)]
pub(crate) struct Passed {
    /// The arguments of that program.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "ARGUMENTS")]
    pub(crate) arguments: Vec<std::ffi::OsString>,
}

/// Parses the name of a planner, with or without the prefix of a meta-planner.
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
            Some(name) if Request::new(name).check().is_ok() => Ok(name.to_owned()),
            _ => PossibleValuesParser::new(planners()).parse_ref(command, arg, value),
        }
    }
    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(planners()))
    }
}

/// The names of the planners, with summaries.
fn planners() -> impl Iterator<Item = PossibleValue> {
    mp_plan::planners().map(|p: &PlannerInfo| {
        let also = match p.aliases {
            [] => String::new(),
            names => format!(" (also {})", names.join(", ")),
        };
        PossibleValue::new(p.name).aliases(p.aliases).help(format!("{}{also}", p.summary))
    })
}

fn metrics() -> Vec<PossibleValue> {
    MetricName::ALL.iter().map(|(_, name, help)| PossibleValue::new(*name).help(*help)).collect()
}

/// The metric of a name that was checked before.
fn metric(name: &str) -> MetricName {
    name.parse().unwrap_or_default()
}

fn parsed<T: FromStr<Err: ToString>>(text: &str) -> Result<T, String> {
    text.parse().map_err(|e: T::Err| e.to_string())
}

/// As [`parsed`], with what to do about an error.
fn explained<T: FromStr<Err = mp_plan::Error>>(text: &str) -> Result<T, String> {
    text.parse().map_err(|e: mp_plan::Error| format!("{e}; {}", e.remedy().unwrap_or_default()))
}

/// The field of `--relax`, which may have been left out before the name of a scene.
fn relax_field(text: &str) -> Result<RelaxField, String> {
    explained(text).map_err(|e| format!("{e}. A scene stands before --relax"))
}

/// A number from 0 to 1.
fn fraction(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|t| (0.0..=1.0).contains(t));
    number.ok_or_else(|| "expected a fraction of the length of the path, from 0 to 1".into())
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
mod tests;
