//! Meta-planners, which run other planners, by name.

use crate::algo::or_parallel::{RUNS, SLICE};
use crate::algo::restarts::{SCHEDULE, UNIT};
use crate::algo::rrs::{self, Flattened, with_bending_edges};
use crate::algo::rrt;
use crate::algo::rrt_connect::ext_ext;
use crate::algo::shared_tree::BATCH;
use crate::{
    AnyPlanner, BuildError, OrParallel, Parameter, PlannerInfo, Problem, Restarts, Schedule, Settings,
    SharedBiRrt, SharedTree, Tuning, Workers, build_with, planner, trace,
};
use mp_cspace::{Interrupt, MotionValidity, NearestNeighbors, Space, Straight};
use std::fmt;
use std::sync::{Arc, OnceLock};

/// A way to run another planner; its name is a prefix of the name of that planner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MetaPlanner {
    /// What stands before the name of the planner, such as `or-`.
    pub prefix: &'static str,
    /// What it is and when to use it, in a line.
    pub summary: &'static str,
    /// Its paper.
    pub citation: &'static str,
    /// Its own parameters, beside those of the planner it runs.
    pub parameters: &'static [Parameter],
    /// The names of the planners it can run; `None` for any planner and any meta-planner.
    pub around: Option<&'static [&'static str]>,
}

const OR: MetaPlanner = MetaPlanner {
    prefix: "or-",
    summary: "independent runs on all threads; the one with the fewest iterations wins",
    citation: "Carpin and Pagello 2002",
    parameters: &[RUNS, SLICE],
    around: None,
};

const SHARED: MetaPlanner = MetaPlanner {
    prefix: "shared-",
    summary: "trees grown by all threads, many samples at a time",
    citation: "Carpin and Pagello 2002",
    parameters: &[BATCH],
    around: Some(&[rrt::INFO.name, rrs::INFO.name, ext_ext::INFO.name]),
};

const RESTART: MetaPlanner = MetaPlanner {
    prefix: "restart-",
    summary: "starts again when it takes too long: fewer very long runs",
    citation: "Luby, Sinclair and Zuckerman 1993; Amato, Ashur and Har-Peled 2025",
    parameters: &[SCHEDULE, UNIT],
    around: None,
};

/// All meta-planners of the crate. They may be combined: `or-restart-rrt-connect` runs several planners that
/// restart.
#[must_use]
pub fn meta_planners() -> &'static [MetaPlanner] {
    &[OR, SHARED, RESTART]
}

/// The name of a planner, split into meta-planners and planner: `rrt`, `or-rrt-connect`, `restart-rrt`, …
///
/// ```
/// use mp_tree::{PlannerSpec, Settings};
/// let spec = PlannerSpec::new("restart-rrt-connect")?;
/// assert_eq!(spec.to_string(), "restart-rrt-connect");
/// assert!(spec.check(&Settings::parse(["unit=500", "step=10%"])?).is_ok());
/// assert!(spec.check(&Settings::parse(["runs=2"])?).is_err());
/// assert!(PlannerSpec::new("or-dijkstra").is_err());
/// # Ok::<(), mp_tree::BuildError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlannerSpec {
    /// The meta-planners, the outermost first.
    pub meta_planners: Vec<&'static MetaPlanner>,
    /// The innermost planner.
    pub planner: &'static PlannerInfo,
}

impl PlannerSpec {
    /// Most meta-planners around one planner.
    const DEEPEST: usize = 4;

    /// The planner called `name`.
    ///
    /// # Errors
    /// When there is no such planner; the error lists the names.
    pub fn new(name: &str) -> Result<Self, BuildError> {
        let mut rest = name;
        let mut meta_planners = Vec::new();
        loop {
            if let Ok(inner) = planner(rest) {
                let innermost = meta_planners.len().wrapping_sub(1);
                let runs = |(i, meta): (usize, &&MetaPlanner)| {
                    meta.around.is_none_or(|names| i == innermost && names.contains(&inner.name))
                };
                if !meta_planners.iter().enumerate().all(runs) {
                    planner(name).map(|_| ())?;
                }
                return Ok(Self { meta_planners, planner: inner });
            }
            let outer = self::meta_planners().iter().find_map(|w| Some((w, rest.strip_prefix(w.prefix)?)));
            match outer {
                Some((meta, inner)) if meta_planners.len() < Self::DEEPEST => {
                    meta_planners.push(meta);
                    rest = inner;
                }
                _ => planner(rest).map(|_| ())?,
            }
        }
    }

    /// Refuses settings that neither the planner nor a meta-planner has, and values that cannot be read. The
    /// range of the planner's own parameters is checked when it is made.
    ///
    /// # Errors
    /// When there is such a setting or value.
    pub fn check(&self, settings: &Settings) -> Result<(), BuildError> {
        let own = self.meta_planners.iter().flat_map(|meta| meta.parameters);
        settings.check_among(self.planner.name, own.chain(self.planner.parameters))?;
        Tuning::read(&self.planner_settings(settings), self.planner)?;
        Schedule::of(settings)?;
        [RUNS, SLICE, UNIT, BATCH].iter().try_for_each(|parameter| settings.count(parameter.name).map(|_| ()))
    }

    fn planner_settings(&self, settings: &Settings) -> Settings {
        settings.only(self.planner.parameters)
    }
}

impl fmt::Display for PlannerSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.meta_planners.iter().try_for_each(|meta| f.write_str(meta.prefix))?;
        f.write_str(self.planner.name)
    }
}

/// As [`build_with`](crate::build_with), for meta-planners too. `make` makes the problem, once for each run;
/// the runs use `workers`.
///
/// # Errors
/// As [`build`](crate::build), and when `make` fails.
pub fn build_from<'c, C, M, N>(
    name: &str,
    make: impl Fn() -> Result<Problem<'c, C, Straight<'c, C, M>>, BuildError> + Send + Sync + 'c,
    index: N,
    settings: &Settings,
    workers: &Workers,
) -> Result<AnyPlanner<'c, C::State, ()>, BuildError>
where
    C: Space<State: 'c> + 'c,
    M: MotionValidity<C::State> + Send + 'c,
    N: NearestNeighbors<C> + Clone + Send + Sync + 'c,
{
    let spec = PlannerSpec::new(name)?;
    spec.check(settings)?;
    trace::made(&spec);
    let (settings, workers) = (settings.clone(), workers.clone());
    let factory = Factory { make: Arc::new(make), index, settings, workers, spec, interrupt: Arc::default() };
    factory.planner(0)
}

type Make<'c, C, M> = dyn Fn() -> Result<Problem<'c, C, Straight<'c, C, M>>, BuildError> + Send + Sync + 'c;

/// Makes planners any number of times.
struct Factory<'c, C: Space, M: MotionValidity<C::State>, N> {
    make: Arc<Make<'c, C, M>>,
    index: N,
    settings: Settings,
    workers: Workers,
    spec: PlannerSpec,
    /// The interrupt of the problems, once one was made.
    interrupt: Arc<OnceLock<Interrupt>>,
}

impl<'c, C: Space, M: MotionValidity<C::State>, N: Clone> Clone for Factory<'c, C, M, N> {
    fn clone(&self) -> Self {
        let Self { make, index, settings, workers, spec, interrupt } = self;
        Self {
            make: Arc::clone(make),
            index: index.clone(),
            settings: settings.clone(),
            workers: workers.clone(),
            spec: spec.clone(),
            interrupt: Arc::clone(interrupt),
        }
    }
}

impl<'c, C, M, N> Factory<'c, C, M, N>
where
    C: Space<State: 'c> + 'c,
    M: MotionValidity<C::State> + Send + 'c,
    N: NearestNeighbors<C> + Clone + Send + Sync + 'c,
{
    fn problem(&self) -> Result<Problem<'c, C, Straight<'c, C, M>>, BuildError> {
        let problem = (self.make)()?;
        self.interrupt.get_or_init(|| problem.interrupt().clone());
        Ok(problem)
    }

    /// The planner inside the first `depth` meta-planners.
    fn planner(&self, depth: usize) -> Result<AnyPlanner<'c, C::State, ()>, BuildError> {
        let count = |parameter: Parameter| self.settings.count_of(&parameter);
        match self.spec.meta_planners.get(depth) {
            None => {
                let settings = self.spec.planner_settings(&self.settings);
                build_with(self.spec.planner.name, self.problem()?, self.index.clone(), &settings)
            }
            Some(meta) if **meta == OR => {
                let workers = self.workers.clone();
                let run = |_| self.planner(depth + 1);
                let planner = OrParallel::new(count(RUNS)?, count(SLICE)?, workers, run)?;
                Ok(Box::new(planner.with_interrupt(self.interrupt.get().cloned().unwrap_or_default())))
            }
            Some(meta) if **meta == SHARED => {
                let (info, settings) = (self.spec.planner, self.spec.planner_settings(&self.settings));
                let tuning = Tuning::read(&settings, info)?;
                let (batch, workers, index) = (count(BATCH)?, self.workers.clone(), self.index.clone());
                Ok(if info.name == rrs::INFO.name {
                    let make = |_| with_bending_edges(info.name, self.problem()?, &settings);
                    Box::new(Flattened(SharedTree::with_index(batch, workers, index, tuning, make)?))
                } else if info.name == ext_ext::INFO.name {
                    Box::new(SharedBiRrt::with_index(batch, workers, index, tuning, |_| self.problem())?)
                } else {
                    Box::new(SharedTree::with_index(batch, workers, index, tuning, |_| self.problem())?)
                })
            }
            Some(_) => {
                let inner = self.clone();
                let attempt = move |_| inner.planner(depth + 1);
                Ok(Box::new(Restarts::new(Schedule::of(&self.settings)?, count(UNIT)?, attempt)?))
            }
        }
    }
}
