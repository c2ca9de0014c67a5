//! A session without threads: its runs are advanced by calls, as a worker of a page needs it.

use super::run::{Driver, Order, Outbox, SharedOutbox, locked};
use super::times::Timing;
use super::workspace::{Opening, Workspace};
use super::{RunRequest, first_order, refusal};
use crate::message::Message;
use mp_cspace::{Cancel, Clock, Deadline};
use mp_plan::{Control, Error, Interrupt, Request, Scene};
use std::collections::VecDeque;
use std::fmt;
use std::time::Duration;

/// A session that plans only while [`advance`](Self::advance) is called, and has at most one run at a time.
///
/// The data of a run stays in memory after its end: whoever has many runs takes a worker for each, as the page does.
pub struct Worker {
    workspace: Workspace,
    run: Option<Planning>,
    /// What gets times next.
    timing: Option<(Scene, Timing)>,
    replies: VecDeque<Message>,
    last: Option<SharedOutbox>,
    clock: Clock,
}

struct Planning {
    number: u64,
    driver: Driver<'static>,
    order: Order,
    cancel: Cancel,
    /// Whether the search is over, and only the path is to be finished.
    over: bool,
}

impl fmt::Debug for Worker {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Worker").finish_non_exhaustive()
    }
}

impl Worker {
    /// A session with nothing open, which reads the time from `clock`.
    #[must_use]
    pub fn new(clock: Clock) -> Self {
        let workspace = Workspace::new(Opening::default());
        Self { workspace, run: None, timing: None, replies: VecDeque::new(), last: None, clock }
    }

    /// Handles a request. [`take`](Self::take) gives its reply.
    pub fn send(&mut self, request: &[u8]) {
        let reply = Message::parse(request)
            .map_err(|e| Error::new(e.to_string()))
            .and_then(|request| self.reply(&request));
        self.replies.push_back(reply.unwrap_or_else(|error| refusal(&error)));
    }

    fn reply(&mut self, message: &Message) -> Result<Message, Error> {
        let Some((number, about)) = RunRequest::of(message)? else {
            return self.workspace.answer(message);
        };
        let own = self.run.as_mut().filter(|run| run.number == number);
        match (about, own) {
            (RunRequest::Plan { request, paused }, _) => {
                if self.run.is_some() {
                    return Err(Error::new("a run goes on already").help("one worker has one run"));
                }
                if request.threads > 1 {
                    return Err(Error::new("a page has one thread").help("take `threads` = 1"));
                }
                let scene = self.workspace.scene_to_plan(message)?.for_request(&request)?;
                let outbox = Outbox::new(number, scene.clone(), &request);
                // A run borrows these, and outlives this call.
                let (scene, request) = (&*Box::leak(Box::new(scene)), &*Box::leak(request));
                let prepared = &*Box::leak(Box::new(scene.prepare(request)?));
                let cancel = Cancel::new();
                let mut control = Control { clock: self.clock, cancel: cancel.clone(), ..Control::default() };
                let run = prepared.begin(&mut control)?;
                let driver =
                    Driver::new(scene, run, SharedOutbox::clone(&outbox), cancel.clone(), self.clock);
                self.run = Some(Planning { number, driver, order: first_order(paused), cancel, over: false });
                self.last = Some(outbox);
            }
            (RunRequest::Time(timing), _) => {
                if self.run.is_some() || self.timing.is_some() {
                    return Err(Error::new("a run goes on already").help("one worker has one run"));
                }
                let scene = self.workspace.opened()?.scene.clone();
                self.last = Some(Outbox::new(number, scene.clone(), &Request::default()));
                self.timing = Some((scene, timing));
            }
            (RunRequest::Order(order), Some(run)) => {
                run.order = order;
                if order == Order::Pause {
                    run.driver.tell("paused", &|| {});
                }
            }
            (RunRequest::Cancel, Some(run)) => {
                run.cancel.cancel();
                run.order = Order::Go;
            }
            // A run that has ended meanwhile needs no order.
            (_, None) => {}
        }
        Ok(Message::default())
    }

    /// Plans for about this long, or finishes a path that was found. Returns whether a run goes on that is not paused.
    pub fn advance(&mut self, time: Duration) -> bool {
        if let (Some((scene, timing)), Some(outbox)) = (self.timing.take(), &self.last) {
            // One call, maybe a long one: a page that cancels it ends its worker.
            let told = timing.timed(&scene, &Interrupt::never());
            locked(outbox).close(told);
            return false;
        }
        let Some(run) = &mut self.run else { return false };
        if run.order == Order::Pause {
            return false;
        }
        if run.over {
            if let Some(run) = self.run.take() {
                run.driver.finish(&|| {});
            }
            return false;
        }
        let advanced = run.driver.advance(run.order, &mut Deadline::by(self.clock, time), &|| {});
        run.order = advanced.left;
        if advanced.over {
            // To finish the path takes one call, maybe a long one: the page is told before.
            run.driver.tell("finishing", &|| {});
            run.over = true;
            run.order = Order::Go;
        }
        run.order != Order::Pause
    }

    /// The next message to the page: replies first, in the order of their requests, then events.
    pub fn take(&mut self) -> Option<Vec<u8>> {
        let reply = self.replies.pop_front();
        let message = reply.or_else(|| self.last.as_ref().and_then(|outbox| locked(outbox).take()));
        message.map(|message| message.to_bytes())
    }
}
