//! What the command line asks for, checked.

use super::metrics;
use crate::cli::{self, Motion};
use miette::{IntoDiagnostic, Result, miette};
use mp::tree::{Named, Settings, Workers};
use std::time::Duration;

/// How to plan.
#[derive(Clone, Debug)]
pub(crate) struct Options {
    pub(crate) planner: Named,
    /// Threads that a planner may use.
    pub(crate) workers: Workers,
    pub(crate) settings: Settings,
    pub(crate) metric: metrics::Kind,
    pub(crate) metric_name: String,
    pub(crate) motion: Motion,
    pub(crate) time: Duration,
    pub(crate) iterations: Option<u64>,
    pub(crate) shorten: bool,
    /// Relax the path instead.
    pub(crate) relax: bool,
}

impl Options {
    pub(crate) fn new(args: &cli::Plan) -> Result<Self> {
        let planner = Named::new(&args.planner).into_diagnostic()?;
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
        planner.check(&settings).into_diagnostic()?;
        let metric =
            metrics::named(&args.metric).ok_or_else(|| miette!("there is no metric `{}`", args.metric))?;
        let time = Duration::try_from_secs_f64(args.time).unwrap_or(Duration::MAX);
        Ok(Self {
            planner,
            workers: Workers::new(threads).into_diagnostic()?,
            settings,
            metric,
            metric_name: args.metric.clone(),
            motion: args.motion,
            time,
            iterations: args.iterations,
            shorten: !args.no_shorten && !args.relax,
            relax: args.relax,
        })
    }

    /// A planner with its defaults, to be measured beside others.
    pub(crate) fn comparable(planner: &str, motion: Motion, seconds: f64) -> Result<Self> {
        Ok(Self {
            planner: Named::new(planner).into_diagnostic()?,
            workers: Workers::alone(),
            settings: Settings::default(),
            metric: metrics::Kind::Default,
            metric_name: metrics::DEFAULT.to_owned(),
            motion,
            time: Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX),
            iterations: None,
            shorten: false,
            relax: false,
        })
    }
}
