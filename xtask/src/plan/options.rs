//! What the command line asks for, checked.

use super::chosen::Chosen;
use super::metrics;
use crate::cli::{self, Motion};
use miette::{IntoDiagnostic, Result, miette};
use mp::cspace::{Settings, Workers};
use std::path::PathBuf;
use std::time::Duration;

/// How to plan.
#[derive(Clone, Debug)]
pub(crate) struct Options {
    pub(crate) planner: Chosen,
    /// Threads that a planner may use.
    pub(crate) workers: Workers,
    pub(crate) threads: usize,
    pub(crate) settings: Settings,
    pub(crate) metric: metrics::Kind,
    pub(crate) metric_name: String,
    pub(crate) motion: Motion,
    pub(crate) time: Duration,
    /// Seconds of processor time, beside.
    pub(crate) processor: Option<f64>,
    /// Collision queries, beside.
    pub(crate) queries: Option<u64>,
    pub(crate) iterations: Option<u64>,
    /// To the first path, also of a planner that goes on for better ones.
    pub(crate) bare: bool,
    pub(crate) shorten: bool,
    /// Relax the path instead.
    pub(crate) relax: bool,
    /// The file of the roadmap to go on with.
    pub(crate) roadmap: Option<PathBuf>,
}

impl Options {
    pub(crate) fn new(args: &cli::Plan) -> Result<Self> {
        let planner = Chosen::new(&args.planner)?;
        let single = args.scenes.len() <= 1 && args.runs == 1;
        let threads = if single { usize::from(args.threads) } else { 1 };
        let mut settings = Settings::default();
        if let Some(step) = args.step {
            settings.set("step", &step.to_string());
        }
        for text in &args.set {
            match text.split_once('=') {
                Some((key, value)) if !key.trim().is_empty() => settings.set(key.trim(), value.trim()),
                _ => return Err(miette!(help = "write KEY=VALUE", "cannot read the setting `{text}`")),
            }
        }
        planner.check(&settings)?;
        if args.roadmap.is_some() {
            if !single {
                return Err(miette!(
                    help = "name one scene, without --runs",
                    "--roadmap goes with a single run"
                ));
            }
            if !matches!(planner, Chosen::Roadmap(_)) {
                let help = "take a planner that builds a roadmap, such as --planner prm";
                return Err(miette!(help = help, "{planner} has no roadmap to keep"));
            }
        }
        let metric =
            metrics::named(&args.metric).ok_or_else(|| miette!("there is no metric `{}`", args.metric))?;
        let time = Duration::try_from_secs_f64(args.time).unwrap_or(Duration::MAX);
        Ok(Self {
            planner,
            workers: Workers::new(threads).into_diagnostic()?,
            threads,
            settings,
            metric,
            metric_name: args.metric.clone(),
            motion: args.motion,
            time,
            processor: None,
            queries: None,
            iterations: args.iterations,
            bare: false,
            shorten: !args.no_shorten && !args.relax,
            relax: args.relax,
            roadmap: args.roadmap.clone(),
        })
    }

    /// A planner with its defaults, to be measured beside others.
    pub(crate) fn comparable(planner: &str, motion: Motion, seconds: f64) -> Result<Self> {
        Ok(Self {
            planner: Chosen::new(planner)?,
            workers: Workers::alone(),
            threads: 1,
            settings: Settings::default(),
            metric: metrics::Kind::Default,
            metric_name: metrics::DEFAULT.to_owned(),
            motion,
            time: Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX),
            processor: None,
            queries: None,
            iterations: None,
            bare: true,
            shorten: false,
            relax: false,
            roadmap: None,
        })
    }
}
