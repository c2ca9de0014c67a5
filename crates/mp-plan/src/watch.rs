//! Progress reports of a run, and how to stop it.

use crate::Request;
use mp_cspace::{
    Cancel, Clock, Configuration, Event, Interrupt, NodeId, Observer, Path, Progress, SparseClock, Stop,
    StopReason,
};
use std::time::Duration;

/// The stages of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Stage {
    /// Searching for a path.
    Planning,
    /// Relaxing the path found with a snake.
    Relaxing,
    /// Shortening the path and verifying what will be written.
    Finishing,
}

/// Receives reports during a run, in the thread that plans. The default methods do nothing.
pub trait Watch {
    /// A stage begins.
    fn stage(&mut self, _stage: Stage) {}
    /// The counts so far; at most ten times a second.
    fn progress(&mut self, _progress: &Progress) {}
    /// A path of this length in the metric of the space was found. An anytime planner finds several. `rows` makes its configurations as they would
    /// be written: verified, but not finished where the planner has verified them. A path that is proved only after the search is
    /// reported when it is finished.
    fn found(&mut self, _length: f64, _rows: &dyn Fn() -> Vec<Vec<f64>>) {}
    /// Whether [`event`](Self::event) is to be called, which costs time. Called once, when planning begins.
    fn wants_events(&self) -> bool {
        false
    }
    /// Called for what happens in the search, if [wanted](Self::wants_events), in the thread that plans.
    fn event(&mut self, _event: SearchEvent<'_>) {}
    /// Whether [`roadmap`](Self::roadmap) is to be called, for which the whole roadmap is copied.
    fn wants_roadmap(&self) -> bool {
        false
    }
    /// The roadmap when the search is over, if the planner builds one.
    fn roadmap(&mut self, _roadmap: GrownRoadmap) {}
}

/// Watches nothing.
impl Watch for () {}

/// A roadmap with its configurations as rows of numbers: for viewers. The vectors of nodes have the same length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GrownRoadmap {
    /// The configuration of each node.
    pub rows: Vec<Vec<f64>>,
    /// What each node is: `plain`, `guard`, `connection` or another kind of docs/formats/roadmap.md.
    pub kinds: Vec<&'static str>,
    /// The connected component of each node. Components are numbered from 0 by their first nodes.
    pub components: Vec<u32>,
    /// The two nodes of each edge that is not blocked.
    pub edges: Vec<[NodeId; 2]>,
}

/// An event of a search, with configurations as rows of numbers: for viewers and logs.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SearchEvent<'a> {
    /// A root was added to a tree, or a node to a roadmap.
    Rooted {
        /// Which tree: 0 from the start, 1 from the goal.
        tree: usize,
        /// Its index in the tree or roadmap.
        id: NodeId,
        /// Its configuration.
        row: Vec<f64>,
        /// Of a node of a roadmap, its kind, as in [`GrownRoadmap::kinds`]; `None` for the root of a tree.
        kind: Option<&'static str>,
    },
    /// A node was added under another.
    Added {
        /// Which tree: 0 from the start, 1 from the goal.
        tree: usize,
        /// Its index in the tree or roadmap.
        id: NodeId,
        /// The node it was reached from; in tree 1 the node it leads to.
        parent: NodeId,
        /// Its configuration.
        row: Vec<f64>,
        /// The configurations between parent and node at which their edge bends. Empty for a straight edge.
        through: Vec<Vec<f64>>,
    },
    /// A node got another parent.
    Rewired {
        /// Which tree: 0 from the start, 1 from the goal.
        tree: usize,
        /// The node that was moved within the tree.
        id: NodeId,
        /// The parent that it has from now on.
        parent: NodeId,
        /// The configurations between parent and node at which their edge bends. Empty for a straight edge.
        through: Vec<Vec<f64>>,
    },
    /// An edge was added to a roadmap.
    Linked {
        /// One end.
        from: NodeId,
        /// The other.
        to: NodeId,
    },
    /// An edge of a roadmap, added before, turned out to be blocked.
    Unlinked {
        /// One end.
        from: NodeId,
        /// The other.
        to: NodeId,
    },
    /// A state was sampled.
    Sampled {
        /// Its configuration.
        row: Vec<f64>,
    },
    /// The motion from a node toward a configuration was not free.
    Blocked {
        /// The configuration of the node.
        from: Vec<f64>,
        /// The configuration toward which the motion led; the motion may have been shorter.
        toward: Vec<f64>,
    },
    /// A candidate path failed verification.
    Rejected,
    /// Nodes were removed and the others renumbered, in unchanged order.
    Pruned {
        /// Which tree: 0 from the start, 1 from the goal.
        tree: usize,
        /// The former ids of the nodes that remain.
        survivors: &'a [NodeId],
    },
}

/// How a run is watched and stopped. By default nothing watches it, and only the budget of the request stops it.
///
/// A clone of `cancel` stops it from another thread, within some milliseconds. What was found until then is kept.
#[derive(Default)]
pub struct Control<'a> {
    /// Stops the run when it is raised.
    pub cancel: Cancel,
    /// Receives reports of the run.
    pub watch: Option<&'a mut dyn Watch>,
    /// A stop of your own, in addition to the budget of the request.
    pub stop: Option<&'a mut dyn Stop>,
    /// Whether [`search`](crate::search) returns the roadmap.
    pub keep_roadmap: bool,
    /// How much of the budget of time was spent before the run, for instance by loading the scene.
    pub spent: Duration,
    /// The clock of time budgets, of the times in reports and of progress reports: by default that of the system.
    pub clock: Clock,
}

impl std::fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Control").field("cancel", &self.cancel).finish_non_exhaustive()
    }
}

impl<'a> Control<'a> {
    /// Watched by `watch`, stopped by `cancel`.
    pub fn new(cancel: Cancel, watch: &'a mut dyn Watch) -> Self {
        Self { cancel, watch: Some(watch), ..Self::default() }
    }

    /// The time now, if the request has a budget of time.
    pub(crate) fn time_if_limited(&self, request: &Request) -> Option<Duration> {
        request.budget.time_s.map(|_| self.clock.now())
    }

    /// Counts the time since `began` as spent before the run.
    pub(crate) fn spend_since(&mut self, began: Option<Duration>) {
        self.spent += began.map_or(Duration::ZERO, |began| self.clock.now().saturating_sub(began));
    }

    /// What is left of the budget of time of a request, if it has one.
    pub(crate) fn left_of(&self, request: &Request) -> Option<Duration> {
        let time = Duration::try_from_secs_f64(request.budget.time_s?).ok()?;
        Some(time.saturating_sub(self.spent))
    }

    /// A token that ends work when the time of a request is up, or when the run is cancelled.
    pub(crate) fn interrupt_of(&self, request: &Request) -> Interrupt {
        match self.left_of(request) {
            None => Interrupt::new(self.cancel.clone()),
            Some(left) => self.interrupt_within(left),
        }
    }

    /// A token that ends work after the time `left`, or when the run is cancelled.
    pub(crate) fn interrupt_within(&self, left: Duration) -> Interrupt {
        Interrupt::by(self.cancel.clone(), self.clock, self.clock.now().saturating_add(left))
    }

    pub(crate) fn stage(&mut self, stage: Stage) {
        if let Some(watch) = &mut self.watch {
            watch.stage(stage);
        }
    }
}

/// The least time between two reports of progress.
const REPORT_INTERVAL: Duration = Duration::from_millis(100);

/// Passes progress to a watch, as a [`Stop`] that never stops anything, and events, as the [`Observer`] [`Events`]. A planner
/// never uses both at the same time.
pub(crate) struct WatchAdapter<'w, 'a> {
    pub(crate) watch: std::cell::RefCell<Option<&'w mut (dyn Watch + 'a)>>,
    timer: std::cell::RefCell<Timer>,
}

/// When progress was reported last.
struct Timer {
    clock: SparseClock,
    last_report: Duration,
}

impl<'w, 'a> WatchAdapter<'w, 'a> {
    pub(crate) fn new(watch: Option<&'w mut (dyn Watch + 'a)>, clock: Clock) -> Self {
        let timer = Timer { clock: SparseClock::new(clock), last_report: clock.now() };
        Self { watch: watch.into(), timer: timer.into() }
    }
}

impl Stop for &WatchAdapter<'_, '_> {
    fn check(&mut self, progress: &Progress) -> Option<StopReason> {
        if let Some(watch) = &mut *self.watch.borrow_mut()
            && let timer = &mut *self.timer.borrow_mut()
            && let Some(now) = timer.clock.read()
            && now.saturating_sub(timer.last_report) > REPORT_INTERVAL
        {
            timer.last_report = now;
            watch.progress(progress);
        }
        None
    }
}

/// Passes events to a watch, with states as rows of numbers.
pub(crate) struct Events<'t, 'w, 'a> {
    pub(crate) row: &'t dyn Fn(&Configuration) -> Vec<f64>,
    /// The rows of a path: maybe more than its states, as [`Robot::rows`](crate::Robot::rows).
    pub(crate) rows: &'t dyn Fn(&Path<Configuration>) -> Vec<Vec<f64>>,
    pub(crate) adapter: &'t WatchAdapter<'w, 'a>,
    pub(crate) wanted: bool,
}

impl Observer<Configuration> for Events<'_, '_, '_> {
    fn on(&mut self, event: Event<'_, Configuration>) {
        if !self.wanted {
            return;
        }
        let row = self.row;
        // Edges are stored forward in time; a tree from the goal has its parents later.
        let between = |tree: usize, through: &[Configuration]| {
            let mut rows: Vec<Vec<f64>> = through.iter().map(row).collect();
            if tree == 1 {
                rows.reverse();
            }
            rows
        };
        let event = match event {
            Event::Sampled(state) => SearchEvent::Sampled { row: row(state) },
            Event::Rooted { tree, id, state, kind } => {
                SearchEvent::Rooted { tree, id, row: row(state), kind }
            }
            Event::Added { tree, id, parent, state, through } => {
                SearchEvent::Added { tree, id, parent, row: row(state), through: between(tree, through) }
            }
            Event::Rewired { tree, id, parent, through } => {
                SearchEvent::Rewired { tree, id, parent, through: between(tree, through) }
            }
            Event::Linked { from, to } => SearchEvent::Linked { from, to },
            Event::Unlinked { from, to } => SearchEvent::Unlinked { from, to },
            Event::Blocked { from, toward } => SearchEvent::Blocked { from: row(from), toward: row(toward) },
            Event::Rejected => SearchEvent::Rejected,
            Event::Pruned { tree, survivors } => SearchEvent::Pruned { tree, survivors },
            _ => return,
        };
        if let Some(watch) = &mut *self.adapter.watch.borrow_mut() {
            watch.event(event);
        }
    }
}
