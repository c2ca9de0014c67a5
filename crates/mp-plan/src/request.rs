//! How to plan: plain data.

use crate::{Error, ErrorKind, MetricName, ObjectiveName, RelaxField};
use mp_cspace::{Length, registry::Settings};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// How to plan in a scene. Plain data: make it with [`Request::new`] and the methods below, or read it from JSON, where
/// every member may be left out.
///
/// ```
/// use mp_plan::{Finish, Request};
/// let request = Request::new("rrt-connect").seed(7).iterations(10_000).set("step", "10%");
/// let read: Request = serde_json::from_str(
///     r#"{"planner": "rrt-connect", "seed": 7, "settings": {"step": "10%"}, "budget": {"iterations": 10000}}"#,
/// )?;
/// assert_eq!(request, read);
/// assert_eq!(request.finish, Finish::Shorten);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Request {
    /// The name of the planner; [`planners`](crate::planners) lists them. With the prefix `or-`, independent runs race on all
    /// threads; with `restart-`, it starts again when it takes too long.
    pub planner: String,
    /// Parameters of the planner, by name.
    pub settings: BTreeMap<String, String>,
    /// How far apart two configurations are.
    pub metric: MetricName,
    /// How motions are checked while planning. The path returned is always verified with other code.
    pub motion: MotionValidator,
    /// The clearance (m) that the path keeps from obstacles all along; an arm's links may be nearer to each other. Zero takes the
    /// clearance of the [scene](crate::Scene::keeping), which is zero by default.
    #[serde(skip_serializing_if = "is_zero")]
    pub clearance: f64,
    /// What the path costs: planners that optimise lower it, and so does shortening. Where it is not the length, only robots whose clearance is
    /// known can be planned for.
    #[serde(skip_serializing_if = "ObjectiveName::is_length")]
    pub objective: ObjectiveName,
    /// When to give up.
    pub budget: Budget,
    /// The seed of all randomness.
    pub seed: u64,
    /// Threads that the planner may use, 1 to 1024. Results do not depend on it.
    pub threads: usize,
    /// What is done to the path that the planner found.
    pub finish: Finish,
    /// How many paths to plan, with this seed and the next ones, and to merge into a shorter one (Raveh, Enosh and Halperin 2011). 1, the
    /// default, plans one. Each takes about as long as the first.
    #[serde(skip_serializing_if = "is_one")]
    pub hybridize: usize,
    /// What pushes the path if it is relaxed.
    pub field: RelaxField,
    /// Whether to stop at the first path, also with an anytime planner.
    pub first_only: bool,
    /// Whether the report has the clearance of the path as near as it can be measured, which may take as long as planning. Otherwise it has the
    /// bound that its proof has given.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub sharp_clearance: bool,
    /// The file of a roadmap: read if it exists, grown, and written at the end. For planners that build roadmaps.
    pub roadmap: Option<PathBuf>,
}

/// When to give up. Iterations and queries are the same on every machine. Time is not, but it only ends a run and
/// changes nothing that was computed before.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Budget {
    /// Seconds of wall-clock time for all of a run, shortening and verifying included; the search has nine tenths of them. `None` for no
    /// limit.
    pub time_s: Option<f64>,
    /// Iterations of the planner's loop.
    pub iterations: Option<u64>,
    /// Collision and clearance queries.
    pub queries: Option<u64>,
    /// Nodes of the trees or the roadmap.
    pub nodes: Option<usize>,
}

/// What is done to the path that a planner found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Finish {
    /// The path stays as it is.
    AsFound,
    /// The path is shortened and its corners are rounded, at some distance from obstacles.
    #[default]
    Shorten,
    /// States that the path does not need are left out, and a snake relaxes it away from obstacles.
    Relax,
}

/// How motions are checked while planning. As text, `certified`, `discrete:1%` or `discrete:0.05`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum MotionValidator {
    /// By comparing clearance with bounds on the motion: no wall is missed, however thin.
    #[default]
    Certified,
    /// By testing configurations at this distance from each other.
    Discrete(Length),
}

impl fmt::Display for MotionValidator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Certified => f.write_str("certified"),
            Self::Discrete(length) => write!(f, "discrete:{length}"),
        }
    }
}

impl FromStr for MotionValidator {
    type Err = Error;
    fn from_str(s: &str) -> Result<Self, Error> {
        match (s, s.strip_prefix("discrete:")) {
            ("certified", _) => Ok(Self::Certified),
            (_, Some(resolution)) => Ok(Self::Discrete(resolution.parse()?)),
            ("discrete", _) => Err(Error::new("give the resolution, such as discrete:1% or discrete:0.05")),
            _ => Err(Error::new("expected `certified` or `discrete:R`, such as discrete:1%")),
        }
    }
}

crate::as_text!(MotionValidator);

/// Whether a member is left out: what was written before it was there stays the same.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
pub(crate) fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_one(value: &usize) -> bool {
    *value == 1
}

/// The most paths that are merged.
const MOST_PATHS: usize = 100;

/// A minute.
impl Default for Budget {
    fn default() -> Self {
        Self { time_s: Some(60.0), iterations: None, queries: None, nodes: None }
    }
}

/// The planner `auto`, seed 1, one thread, a minute; the path is shortened.
impl Default for Request {
    fn default() -> Self {
        Self {
            planner: "auto".to_owned(),
            settings: BTreeMap::new(),
            metric: MetricName::Default,
            motion: MotionValidator::Certified,
            clearance: 0.0,
            objective: ObjectiveName::Length,
            budget: Budget::default(),
            seed: 1,
            threads: 1,
            finish: Finish::Shorten,
            hybridize: 1,
            field: RelaxField::Clearance,
            first_only: false,
            sharp_clearance: false,
            roadmap: None,
        }
    }
}

impl Request {
    /// A request for the planner called `planner`, with defaults for everything else.
    #[must_use]
    pub fn new(planner: impl Into<String>) -> Self {
        Self { planner: planner.into(), ..Self::default() }
    }

    /// Sets a parameter of the planner.
    #[must_use]
    pub fn set(mut self, name: impl Into<String>, value: impl ToString) -> Self {
        self.settings.insert(name.into(), value.to_string());
        self
    }

    /// Sets parameters of the planner that are written as `KEY=VALUE`.
    ///
    /// # Errors
    /// When a text is not written so.
    pub fn set_each(self, texts: &[String]) -> Result<Self, Error> {
        texts.iter().try_fold(self, |request, text| match text.split_once('=') {
            Some((key, value)) if !key.trim().is_empty() => Ok(request.set(key.trim(), value.trim())),
            _ => Err(Error::new(format!("cannot read the setting `{text}`")).help("write KEY=VALUE")),
        })
    }

    /// A request in JSON, the content of `file`. Its [values](Self::check) are not checked.
    ///
    /// # Errors
    /// When it is not a request.
    pub fn parse(file: impl AsRef<std::path::Path>, text: &[u8]) -> Result<Self, Error> {
        serde_json::from_slice(text).map_err(|e| {
            Error::new(format!("{} is not a request: {e}", file.as_ref().display()))
                .help("docs/formats/report.md describes requests")
        })
    }

    /// Sets the seed of all random numbers: the same one gives the same path.
    #[must_use]
    pub fn seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// Sets how distances between configurations are measured.
    #[must_use]
    pub fn metric(self, metric: MetricName) -> Self {
        Self { metric, ..self }
    }

    /// Sets how motions are checked.
    #[must_use]
    pub fn motion(self, motion: MotionValidator) -> Self {
        Self { motion, ..self }
    }

    /// Sets the clearance (m) that the path keeps from obstacles.
    #[must_use]
    pub fn clearance(self, clearance: f64) -> Self {
        Self { clearance, ..self }
    }

    /// Sets what the path costs.
    #[must_use]
    pub fn objective(self, objective: ObjectiveName) -> Self {
        Self { objective, ..self }
    }

    /// Sets the budget of time, in seconds.
    #[must_use]
    pub fn time(mut self, seconds: f64) -> Self {
        self.budget.time_s = Some(seconds);
        self
    }

    /// Sets the budget of iterations.
    #[must_use]
    pub fn iterations(mut self, iterations: u64) -> Self {
        self.budget.iterations = Some(iterations);
        self
    }

    /// Sets the budget of nodes of trees or roadmap.
    #[must_use]
    pub fn nodes(mut self, nodes: usize) -> Self {
        self.budget.nodes = Some(nodes);
        self
    }

    /// Sets on how many threads the planner works.
    #[must_use]
    pub fn threads(self, threads: usize) -> Self {
        Self { threads, ..self }
    }

    /// Sets what is done to the path found.
    #[must_use]
    pub fn finish(self, finish: Finish) -> Self {
        Self { finish, ..self }
    }

    /// Plans this many paths and merges them into a shorter one.
    #[must_use]
    pub fn hybridize(self, paths: usize) -> Self {
        Self { hybridize: paths, ..self }
    }

    /// Asks for the clearance of the path as near as it can be measured.
    #[must_use]
    pub fn sharp_clearance(self) -> Self {
        Self { sharp_clearance: true, ..self }
    }

    /// Relaxes the path found in this field.
    #[must_use]
    pub fn relax(self, field: RelaxField) -> Self {
        Self { finish: Finish::Relax, field, ..self }
    }

    /// Checks what does not depend on the scene: whether planner and settings exist, and the budget is a number.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check(&self) -> Result<(), Error> {
        let planner = crate::run::planners::PlannerKind::new(&self.planner)?;
        self.check_for(&planner).map_err(|e| e.of_kind(ErrorKind::Request))
    }

    fn check_for(&self, planner: &crate::run::planners::PlannerKind) -> Result<(), Error> {
        planner.check(&self.settings())?;
        planner.field(self)?;
        if let Some(time) = self.budget.time_s
            && (time.is_nan() || time <= 0.0)
        {
            return Err(
                Error::new(format!("the budget of time is {time} s")).help("give a number above zero")
            );
        }
        crate::scene::check_clearance(self.clearance)?;
        if !(1..=MOST_PATHS).contains(&self.hybridize) {
            let help = format!("give 1 to {MOST_PATHS}: 8 are many");
            return Err(Error::new(format!("cannot merge {} paths", self.hybridize)).help(help));
        }
        if self.hybridize > 1 && self.finish != Finish::Shorten {
            let help = "leave one of the two out";
            return Err(
                Error::new("paths are merged to be shorter, and this one is not shortened").help(help)
            );
        }
        if self.roadmap.is_some() && !planner.is_roadmap() {
            let help = "take a planner that builds a roadmap, such as prm";
            return Err(Error::new(format!("{planner} has no roadmap to keep")).help(help));
        }
        mp_cspace::Workers::checked(self.threads)?;
        Ok(())
    }

    /// As [`check`](Self::check), for `what`, which merges no paths.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check_single(&self, what: &str) -> Result<(), Error> {
        if self.hybridize > 1 {
            let e = Error::new(format!("{what} cannot merge paths")).help("leave `hybridize` out");
            return Err(e.of_kind(ErrorKind::Request));
        }
        self.check()
    }

    /// The parameters as planners read them.
    pub(crate) fn settings(&self) -> Settings {
        let mut settings = Settings::default();
        self.settings.iter().for_each(|(name, value)| settings.set(name, value));
        settings
    }
}
