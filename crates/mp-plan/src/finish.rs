//! Finishing a path: shortens it, writes it as text, and verifies what the text says.

pub(crate) mod certificate;
pub(crate) mod check;
pub(crate) mod relax;
pub(crate) mod trajectory;

use crate::finish::check::fault_text;
use crate::finish::relax::relax_if_requested;
use crate::path::states;
use crate::report::{RunStage, StageTime};
use crate::{Control, Error, Finish, PathRows, Request, Robot, Stage, StoppedBy};
use mp_cspace::{Configuration, Interrupt, Path};
use mp_kinds::proof::{clearance, verified};
use mp_kinds::{hybridized, shorten};
use std::time::Duration;

/// The parts of the time left that shortening may take, and shortening and verifying the result together. The rest is for verifying the
/// path as found.
const SHORTENING_PART: f64 = 0.25;
const SHORT_PART: f64 = 0.5;

/// A path that passed the verifier after it was written as text and read again.
#[derive(Clone, Debug, PartialEq)]
pub struct Finished {
    /// The path, as it was read again.
    pub path: PathRows,
    /// Its length, in the metric of the space.
    pub length: f64,
    /// A lower bound (m) on the clearance along it; `None` where none is known, or there was no time to compute one.
    pub clearance: Option<f64>,
    /// Whether it was shortened.
    pub shortened: bool,
}

/// Finishes a path from elsewhere, between any two configurations.
pub(crate) fn finish_given(
    kind: &dyn Robot,
    path: &PathRows,
    request: &Request,
    control: &mut Control<'_>,
) -> Result<Finished, Error> {
    let _span = tracing::info_span!("finish", scene = kind.name()).entered();
    crate::finish::relax::check(kind, request)?;
    request.objective.check(kind)?;
    let began = control.clock.now();
    let time = request.budget.time_s.and_then(|time| Duration::try_from_secs_f64(time).ok());
    let left = |control: &Control<'_>| {
        time.map(|time| time.saturating_sub(control.clock.now().saturating_sub(began)))
    };
    let ended =
        |by: StoppedBy| Error::new(format!("the path was not verified: {by}")).help("give it more time");
    let given = Path::straight(states(kind, path)?);
    let interrupt = match time {
        None => Interrupt::new(control.cancel.clone()),
        Some(time) => control.interrupt_within(time),
    };
    if let Some(fault) = verified(kind, &given, &interrupt)?.fault {
        return Err(match interrupt.raised() {
            Some(reason) => ended(reason.into()),
            None => Error::new(format!("the path is not free: {}", fault_text(kind, &given, fault)))
                .help("only free paths are shortened: plan from one of its configurations to another"),
        });
    }
    let rest = left(control);
    let (relaxed, _) = relax_if_requested(kind, request, given, control, rest)?;
    let rest = left(control);
    let planned = control.clock.now().saturating_sub(began);
    let began = control.clock.now();
    let proposed = Proposed { path: &relaxed, others: &[], proved: true, time: planned, began };
    finish(kind, &proposed, request, control, rest, &mut Vec::new())?.map_err(ended)
}

/// A path that a search has found.
pub(crate) struct Proposed<'p> {
    pub(crate) path: &'p Path<Configuration>,
    /// Other paths, which may be shorter once all are shortened: to a nearer goal, or of more searches. With the seed to shorten each.
    pub(crate) others: &'p [(Path<Configuration>, u64)],
    /// Whether each edge of the path was verified.
    pub(crate) proved: bool,
    /// How long the search took.
    pub(crate) time: Duration,
    /// When work on the path began.
    pub(crate) began: Duration,
}

/// How many times longer than its search the proof of a path takes at most, as a rule: where the search has proved nothing, and where it has
/// proved the path once.
const PROOF_PER_SEARCH: [u32; 2] = [16, 4];

/// Shortens a path if the request says so, and verifies what will be written, within the time `left`. If the shortened path does
/// not pass, or not in time, the path as found is used. `stages` gets what was done.
///
/// # Errors
/// Inside: why there is no path. The path as found, written and read again, does not pass either, or not in time.
pub(crate) fn finish(
    kind: &dyn Robot,
    proposed: &Proposed<'_>,
    request: &Request,
    control: &mut Control<'_>,
    left: Option<Duration>,
    stages: &mut Vec<StageTime>,
) -> Result<Result<Finished, StoppedBy>, Error> {
    let remembering = kind.remembering();
    let kind = remembering.as_deref().unwrap_or(kind);
    let found = proposed.path;
    let measured =
        |written: &Written, finished: Finished, interrupt: &Interrupt| match request.sharp_clearance {
            true => measured(kind, written, finished, interrupt),
            false => finished,
        };
    control.stage(Stage::Finishing);
    let mut timed = Timed { control, stages, began: proposed.began, left };
    let mut proved = None;
    if request.finish == Finish::Shorten {
        // What is read back is another path than the planner has found, as a rule: its proof comes first where half of the time left may be too
        // little for it.
        let written = Written::of(kind, found)?;
        let known = proposed.proved && written.read.states == found.states;
        let enough = proposed.time.saturating_mul(PROOF_PER_SEARCH[usize::from(proposed.proved)]);
        if !known && left.is_some_and(|left| left < enough) {
            let interrupt = timed.interrupt(1.0);
            proved = verified_as_written(kind, found, &written, known, &interrupt)?.ok();
            timed.ends(RunStage::Verifying, &interrupt);
        }
        let for_short = if known || proved.is_some() { 1.0 } else { SHORT_PART };
        let rest = timed.left.map_or(Duration::ZERO, |left| left.mul_f64(1.0 - for_short));
        let interrupt = timed.interrupt(SHORTENING_PART);
        let (short, is_proved) = cheapest(kind, proposed, request, &interrupt)?;
        timed.ends(RunStage::Shortening, &interrupt);
        if short.states != found.states {
            let interrupt = timed.interrupt_before(rest);
            let written = Written::of(kind, &short)?;
            // A verifier that samples is not asked again about what it has just passed, to the bit.
            let finished = match is_proved && written.read.states == short.states {
                true => Ok(Finished {
                    length: short.length(&kind.any_space()),
                    path: written.rows,
                    clearance: None,
                    shortened: true,
                }),
                false => verified_as_written(kind, &short, &written, false, &interrupt)?
                    .map(|finished| Finished { shortened: true, ..measured(&written, finished, &interrupt) }),
            };
            timed.ends(RunStage::Verifying, &interrupt);
            if let Ok(finished) = finished {
                return Ok(Ok(finished));
            }
            tracing::info!("the shortened path does not pass the verifier: the path as found is written");
        }
    }
    let written = Written::of(kind, found)?;
    if let Some(proved) = proved {
        return Ok(Ok(measured(&written, proved, &timed.interrupt(1.0))));
    }
    let interrupt = timed.interrupt(1.0);
    let known = proposed.proved && written.read.states == found.states;
    let prove = |interrupt: &Interrupt| {
        let finished = verified_as_written(kind, found, &written, known, interrupt)?;
        Ok::<_, Error>(finished.map(|finished| measured(&written, finished, interrupt)))
    };
    let mut finished = prove(&interrupt)?;
    timed.ends(RunStage::Verifying, &interrupt);
    // A cancelled run keeps its path, even if this takes as long as the verification, and the memory that it needs.
    if matches!(finished, Err(StoppedBy::Interrupted | StoppedBy::Memory)) {
        let interrupt = timed.interrupt_by_deadline();
        finished = prove(&interrupt)?;
        timed.ends(RunStage::Verifying, &interrupt);
    }
    Ok(finished.map_err(|by| if by == StoppedBy::Time { StoppedBy::Unverified } else { by }))
}

/// The cheapest of the paths after shortening, and whether each edge of it was verified. If that is [requested](Request::hybridize), it is made
/// of pieces of all.
fn cheapest(
    kind: &dyn Robot,
    proposed: &Proposed<'_>,
    request: &Request,
    interrupt: &Interrupt,
) -> Result<(Path<Configuration>, bool), Error> {
    let objective = request.objective;
    let given =
        [(proposed.path, request.seed)].into_iter().chain(proposed.others.iter().map(|(p, s)| (p, *s)));
    let shortened = given.map(|(path, seed)| shorten(kind, path, seed, objective, interrupt));
    let mut all = shortened.collect::<Result<Vec<_>, _>>()?;
    if request.hybridize > 1 && all.len() > 1 {
        let paths: Vec<_> = all.iter().map(|(path, _)| path.clone()).collect();
        if let Some(merged) = hybridized(kind, &paths, objective, interrupt)? {
            all.push(shorten(kind, &merged, request.seed, objective, interrupt)?);
        }
    }
    let mut best = (f64::INFINITY, 0);
    for (i, (path, _)) in all.iter().enumerate().filter(|_| all.len() > 1) {
        let cost = objective.cost(kind, path)?;
        if cost < best.0 {
            best = (cost, i);
        }
    }
    Ok(all.swap_remove(best.1))
}

/// What is timed: the stages of finishing a path.
struct Timed<'t, 'c> {
    control: &'t Control<'c>,
    stages: &'t mut Vec<StageTime>,
    /// When the present stage began.
    began: Duration,
    /// The time left by then.
    left: Option<Duration>,
}

impl Timed<'_, '_> {
    /// A token for the part `part` of the time left.
    fn interrupt(&self, part: f64) -> Interrupt {
        match self.left {
            None => Interrupt::new(self.control.cancel.clone()),
            Some(left) => self.control.interrupt_within(left.mul_f64(part)),
        }
    }

    /// A token for the time left but `rest`.
    fn interrupt_before(&self, rest: Duration) -> Interrupt {
        match self.left {
            None => Interrupt::new(self.control.cancel.clone()),
            Some(left) => self.control.interrupt_within(left.saturating_sub(rest)),
        }
    }

    /// A token for the time left, which a cancel does not end.
    fn interrupt_by_deadline(&self) -> Interrupt {
        let at = |left| self.control.clock.now().saturating_add(left);
        self.left.map_or_else(Interrupt::never, |left| {
            Interrupt::by(mp_cspace::Cancel::new(), self.control.clock, at(left))
        })
    }

    /// Notes a stage that has just ended.
    fn ends(&mut self, stage: RunStage, interrupt: &Interrupt) {
        let now = self.control.clock.now();
        let time = now.saturating_sub(self.began);
        self.began = now;
        self.left = self.left.map(|left| left.saturating_sub(time));
        self.stages.push(StageTime::new(stage, time, interrupt.raised()));
    }
}

/// A path written as text, and read again.
struct Written {
    rows: PathRows,
    read: Path<Configuration>,
}

impl Written {
    fn of(kind: &dyn Robot, path: &Path<Configuration>) -> Result<Self, Error> {
        let rows = PathRows { format: kind.path_format(), columns: kind.columns(), rows: kind.rows(path) };
        let rows = rows.read_back()?;
        let read = Path::straight(rows.rows.iter().map(|row| kind.state(row)).collect());
        Ok(Self { rows, read })
    }
}

/// `path` as it is `written`, if the verifier passes that. `known` says that the planner has verified just this path.
///
/// # Errors
/// Inside: whether it does not pass, or was not verified because `interrupt` said to end.
fn verified_as_written(
    kind: &dyn Robot,
    path: &Path<Configuration>,
    written: &Written,
    known: bool,
    interrupt: &Interrupt,
) -> Result<Result<Finished, StoppedBy>, Error> {
    let _span = tracing::info_span!("verify").entered();
    let Written { rows, read } = written;
    let report = verified(kind, read, interrupt)?;
    let finished = |clearance| Finished {
        path: rows.clone(),
        length: path.length(&kind.any_space()),
        clearance,
        shortened: false,
    };
    if let Some(fault) = report.fault {
        return Ok(match interrupt.raised() {
            Some(_) if known => Ok(finished(None)),
            Some(reason) => Err(reason.into()),
            None => {
                tracing::info!("{fault}");
                Err(StoppedBy::Verification)
            }
        });
    }
    Ok(Ok(finished(kind.sampled().is_none().then_some(report.clearance))))
}

/// With a better bound on the clearance, if there is time for one.
fn measured(kind: &dyn Robot, written: &Written, finished: Finished, interrupt: &Interrupt) -> Finished {
    let Some(known) = finished.clearance else { return finished };
    let clearance = clearance(kind, &written.read, kind.accuracy(), interrupt);
    Finished { clearance: Some(clearance.map_or(known, |c| c.max(known))), ..finished }
}
