//! One run: how it is paused, stepped and cancelled, and what it tells the page.

use super::messages::failure;
use crate::PathTrack;
use crate::bytes::path_head;
use crate::growth::Growth;
use crate::message::{Message, json};
use mp_cspace::{Cancel, Clock, Iterations, Progress, Stop};
use mp_plan::{Control, Error, PathRows, Report, Request, Run, Scene, SearchEvent, Stage, Watch};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What a run is told to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    /// To plan.
    Go,
    /// To wait.
    Pause,
    /// To do this number of iterations more, and then to wait.
    Step(u64),
}

/// What a run has to tell, until the page takes it.
#[derive(Debug)]
pub(crate) struct Outbox {
    run: u64,
    growth: Growth,
    progress: Option<Message>,
    /// The last path found, that the page does not have.
    found: Option<Message>,
    /// Whether it is time to tell of growth again.
    ready: bool,
    /// What is told as it is, in order.
    rest: VecDeque<Message>,
}

/// An outbox that the planning thread fills and others empty.
pub(crate) type SharedOutbox = Arc<Mutex<Outbox>>;

/// The outbox, also after a panic of its other user: it holds nothing that could be half changed.
pub(crate) fn locked(outbox: &Mutex<Outbox>) -> MutexGuard<'_, Outbox> {
    outbox.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Outbox {
    pub(crate) fn new(run: u64, scene: Scene, request: &Request) -> SharedOutbox {
        let growth = Growth::new(scene, [0.0; 3], request);
        Arc::new(Mutex::new(Self {
            run,
            growth,
            progress: None,
            found: None,
            ready: false,
            rest: VecDeque::new(),
        }))
    }

    /// The next event: growth before all that came later. Of several paths found since the last call only the last is told.
    pub(crate) fn take(&mut self) -> Option<Message> {
        let growth = if std::mem::take(&mut self.ready) { self.growth.take(self.run) } else { None };
        let state = growth.or_else(|| self.progress.take()).or_else(|| self.found.take());
        state.or_else(|| self.rest.pop_front())
    }

    /// Tells of the end of the run: what it led to, or that it failed.
    pub(crate) fn close(&mut self, told: Result<Message, Error>) {
        match told {
            Ok(message) => {
                self.ready = true;
                self.rest.push_back(message);
            }
            Err(error) => self.fail(&error),
        }
    }

    /// Tells that the run failed.
    pub(crate) fn fail(&mut self, error: &Error) {
        let failed = Message::event("failed", self.run);
        let (message, help) = failure(error);
        self.ready = true;
        self.rest.push_back(failed.with("message", message).with("help", help));
    }

    /// Tells that the run has ended with this report.
    fn end(&mut self, scene: &Scene, report: &Report) {
        let mut message = Message::event("done", self.run).with("report", json(report));
        let path = report.path.as_ref().and_then(|rows| {
            let rows =
                PathRows { format: scene.path_format(), columns: report.columns.clone(), rows: rows.clone() };
            let track = scene.track(&rows).ok()?;
            Some(PathTrack::of(&report.planner, report.verified, report.path_length, track))
        });
        self.ready = true;
        let path = path.map(|path| json(&path_head(&path, &mut message.data)));
        self.rest.push_back(message.with("path", path));
    }
}

/// Fills an outbox, and calls `wake` when there is something in it.
struct Recorder<'a> {
    outbox: &'a Mutex<Outbox>,
    wake: &'a dyn Fn(),
    clock: Clock,
    began: f64,
    stage: Stage,
}

/// The name of a stage in events.
fn word(stage: Stage) -> &'static str {
    match stage {
        Stage::Relaxing => "relaxing",
        Stage::Finishing => "finishing",
        _ => "planning",
    }
}

impl Recorder<'_> {
    fn tell(&mut self, state: &str, progress: Option<&Progress>) {
        let mut outbox = locked(self.outbox);
        let mut message = match (outbox.progress.take(), progress) {
            (Some(old), None) => old,
            _ => Message::event("progress", outbox.run),
        };
        message.set("state", state);
        if let Some(progress) = progress {
            message.set("iterations", progress.iterations);
            message.set("nodes", progress.nodes);
            message.set("motions", progress.motions);
            message.set("time_s", self.clock.now().as_secs_f64() - self.began);
        }
        outbox.progress = Some(message);
        outbox.ready = true;
        drop(outbox);
        (self.wake)();
    }
}

impl Watch for Recorder<'_> {
    fn stage(&mut self, stage: Stage) {
        self.stage = stage;
        self.tell(word(stage), None);
    }
    fn progress(&mut self, progress: &Progress) {
        self.tell(word(self.stage), Some(progress));
    }
    fn found(&mut self, length: f64, rows: &dyn Fn() -> Vec<Vec<f64>>) {
        let mut outbox = locked(self.outbox);
        let mut message = Message::event("found", outbox.run).with("length", length);
        let rows = message.array(&rows().concat());
        outbox.found = Some(message.with("rows", rows));
        outbox.ready = true;
        drop(outbox);
        (self.wake)();
    }
    fn wants_events(&self) -> bool {
        true
    }
    fn event(&mut self, event: SearchEvent<'_>) {
        locked(self.outbox).growth.note(&event);
    }
}

/// A run and what belongs to it.
pub(crate) struct Driver<'p> {
    scene: &'p Scene,
    run: Run<'p>,
    outbox: SharedOutbox,
    cancel: Cancel,
    clock: Clock,
    /// The time that the run has taken, seconds.
    spent: f64,
}

impl<'p> Driver<'p> {
    pub(crate) fn new(
        scene: &'p Scene,
        run: Run<'p>,
        outbox: SharedOutbox,
        cancel: Cancel,
        clock: Clock,
    ) -> Self {
        Self { scene, run, outbox, cancel, clock, spent: 0.0 }
    }

    /// Plans as `order` says, until `pause` stops it. Returns whether the search is over, and whether the steps of the order
    /// are done.
    pub(crate) fn advance(&mut self, order: Order, pause: &mut dyn Stop, wake: &dyn Fn()) -> Advanced {
        let begin = self.clock.now().as_secs_f64();
        let began = begin - self.spent;
        let before = self.run.progress().iterations;
        let mut recorder =
            Recorder { outbox: &self.outbox, wake, clock: self.clock, began, stage: Stage::Planning };
        let mut control = Control::new(self.cancel.clone(), &mut recorder);
        control.clock = self.clock;
        let over = match order {
            Order::Go => self.run.advance(pause, &mut control),
            Order::Pause => false,
            Order::Step(count) => {
                let mut both = Iterations(before.saturating_add(count)).or(pause);
                self.run.advance(&mut both, &mut control)
            }
        };
        drop(control);
        let progress = self.run.progress();
        let done = progress.iterations - before;
        let left = match order {
            Order::Step(count) if done >= count => Order::Pause,
            Order::Step(count) => Order::Step(count - done),
            order => order,
        };
        let state = if left == Order::Pause { "paused" } else { "planning" };
        recorder.tell(state, Some(&progress));
        self.spent += self.clock.now().as_secs_f64() - begin;
        Advanced { over, left }
    }

    /// Tells what the run does between two advances: `paused` or `finishing`.
    pub(crate) fn tell(&self, state: &str, wake: &dyn Fn()) {
        let mut recorder =
            Recorder { outbox: &self.outbox, wake, clock: self.clock, began: 0.0, stage: Stage::Planning };
        recorder.tell(state, None);
    }

    /// Finishes the path and tells the result.
    pub(crate) fn finish(self, wake: &dyn Fn()) {
        let began = self.clock.now().as_secs_f64() - self.spent;
        let outbox = Arc::clone(&self.outbox);
        let mut recorder =
            Recorder { outbox: &outbox, wake, clock: self.clock, began, stage: Stage::Planning };
        let mut control = Control::new(self.cancel, &mut recorder);
        control.clock = self.clock;
        match self.run.finish(&mut control) {
            Ok(report) => locked(&outbox).end(self.scene, &report),
            Err(error) => locked(&outbox).fail(&error),
        }
        wake();
    }
}

/// What an advance has led to.
pub(crate) struct Advanced {
    /// Whether the search is over.
    pub(crate) over: bool,
    pub(crate) left: Order,
}
