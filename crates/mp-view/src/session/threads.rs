//! A session whose runs have threads: behind a server.

use super::run::{Driver, Order, Outbox, SharedOutbox, locked};
use super::workspace::{Opening, Workspace};
use super::{RunRequest, first_order, refusal};
use crate::message::Message;
use mp_cspace::{Cancel, Clock, Progress, Stop, StopReason};
use mp_plan::{Control, Error, Interrupt, Request, Scene};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

/// A session of one page. Requests may come from several threads; runs have threads of their own. When it is dropped, its runs
/// are cancelled and waited for.
///
/// ```
/// use mp_view::{Opening, Session};
/// let session = Session::new(Opening::default(), || {});
/// // Requests and replies are bytes: see docs/formats/session.md.
/// let reply = session.handle(b"not a message");
/// assert!(String::from_utf8_lossy(&reply).contains("error"));
/// assert!(session.take_event().is_none());
/// ```
pub struct Session {
    workspace: Mutex<Workspace>,
    runs: Mutex<Runs>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl fmt::Debug for Session {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Session").finish_non_exhaustive()
    }
}

/// The runs of a session by their numbers.
type Runs = BTreeMap<u64, RunThread>;

struct RunThread {
    orders: Arc<Orders>,
    outbox: SharedOutbox,
    thread: Option<JoinHandle<()>>,
}

/// The present order of a run.
struct Orders {
    order: Mutex<Order>,
    changed: Condvar,
    /// Raised when a new order has come.
    new: AtomicBool,
    cancel: Cancel,
}

impl Orders {
    fn give(&self, order: Order) {
        *unpoisoned(&self.order) = order;
        self.new.store(true, Ordering::Relaxed);
        self.changed.notify_all();
    }

    fn cancel(&self) {
        self.cancel.cancel();
        self.new.store(true, Ordering::Relaxed);
        // Under the lock, so that a thread that is about to wait does not miss it.
        drop(unpoisoned(&self.order));
        self.changed.notify_all();
    }

    fn is_cancelled(&self) -> bool {
        self.cancel.is_raised()
    }

    /// Whether the next order is to pause.
    fn is_pause(&self) -> bool {
        *unpoisoned(&self.order) == Order::Pause && !self.is_cancelled()
    }

    /// Waits for an order that is not to pause; returns when cancelled, too.
    fn next(&self) -> Order {
        let mut order = unpoisoned(&self.order);
        while *order == Order::Pause && !self.is_cancelled() {
            order = self.changed.wait(order).unwrap_or_else(PoisonError::into_inner);
        }
        self.new.store(false, Ordering::Relaxed);
        if self.is_cancelled() { Order::Go } else { *order }
    }

    /// Says what is left of an order, unless another one has come.
    fn left(&self, order: Order) {
        let mut present = unpoisoned(&self.order);
        if !self.new.load(Ordering::Relaxed) {
            *present = order;
        }
    }
}

/// A lock, also after a panic: nothing behind these locks is ever half changed.
fn unpoisoned<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Session {
    /// A session. `wake` is called from any thread when there are events; it must return at once.
    pub fn new(opening: Opening, wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self { workspace: Mutex::new(Workspace::new(opening)), runs: Mutex::default(), wake: Arc::new(wake) }
    }

    /// The reply to a request.
    #[must_use]
    pub fn handle(&self, request: &[u8]) -> Vec<u8> {
        let reply = Message::parse(request)
            .map_err(|e| Error::new(e.to_string()))
            .and_then(|request| self.reply(&request));
        reply.unwrap_or_else(|error| refusal(&error)).to_bytes()
    }

    fn reply(&self, message: &Message) -> Result<Message, Error> {
        let Some((run, about)) = RunRequest::of(message)? else {
            return unpoisoned(&self.workspace).answer(message);
        };
        let scene = match &about {
            RunRequest::Plan { .. } => Some(unpoisoned(&self.workspace).scene_to_plan(message)?),
            RunRequest::Time(_) => Some(unpoisoned(&self.workspace).opened()?.scene.clone()),
            _ => None,
        };
        let mut runs = unpoisoned(&self.runs);
        if scene.is_some() && runs.contains_key(&run) {
            return Err(Error::new(format!("run {run} goes on already")));
        }
        let wake = Arc::clone(&self.wake);
        match (about, scene) {
            (RunRequest::Plan { request, paused }, Some(scene)) => {
                // What is wrong with start, goal and request is the reply, not an event.
                let scene = scene.for_request(&request)?;
                scene.prepare(&request)?;
                let outbox = Outbox::new(run, scene.clone(), &request);
                let work = move |orders: &Orders, outbox: &SharedOutbox, wake: &dyn Fn()| {
                    drive(&scene, &request, orders, outbox, wake)
                };
                runs.insert(run, begin(outbox, first_order(paused), wake, work));
            }
            (RunRequest::Time(timing), Some(scene)) => {
                let outbox = Outbox::new(run, scene.clone(), &Request::default());
                let work = move |orders: &Orders, outbox: &SharedOutbox, _: &dyn Fn()| {
                    let told = timing.timed(&scene, &Interrupt::new(orders.cancel.clone()));
                    locked(outbox).close(told);
                    Ok(())
                };
                runs.insert(run, begin(outbox, Order::Go, wake, work));
            }
            // A run that has ended meanwhile needs no order.
            (RunRequest::Order(order), _) => runs.get(&run).iter().for_each(|run| run.orders.give(order)),
            (RunRequest::Cancel, _) => runs.get(&run).iter().for_each(|run| run.orders.cancel()),
            (RunRequest::Plan { .. } | RunRequest::Time(_), None) => {}
        }
        Ok(Message::default())
    }

    /// The next event, if there is one. Growth and progress are joined until they are taken.
    #[must_use]
    pub fn take_event(&self) -> Option<Vec<u8>> {
        let mut runs = unpoisoned(&self.runs);
        let mut ended = Vec::new();
        let mut event = None;
        for (number, run) in runs.iter() {
            let over = run.thread.as_ref().is_none_or(JoinHandle::is_finished);
            event = locked(&run.outbox).take();
            if event.is_some() {
                break;
            }
            if over {
                ended.push(*number);
            }
        }
        ended.iter().for_each(|number| drop(runs.remove(number)));
        event.map(|message| message.to_bytes())
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        let mut runs = unpoisoned(&self.runs);
        runs.values().for_each(|run| run.orders.cancel());
        for run in runs.values_mut() {
            if let Some(thread) = run.thread.take() {
                // It has told already when it panicked.
                let _ = thread.join();
            }
        }
    }
}

/// Begins a run in a thread of its own, which does this work.
fn begin(
    outbox: SharedOutbox,
    order: Order,
    wake: Arc<dyn Fn() + Send + Sync>,
    work: impl FnOnce(&Orders, &SharedOutbox, &dyn Fn()) -> Result<(), Error> + Send + 'static,
) -> RunThread {
    let order = Mutex::new(order);
    let orders = Arc::new(Orders {
        order,
        changed: Condvar::new(),
        new: AtomicBool::new(false),
        cancel: Cancel::new(),
    });
    let own = (Arc::clone(&orders), Arc::clone(&outbox));
    let thread = std::thread::spawn(move || {
        let (orders, outbox) = own;
        if let Err(error) = work(&orders, &outbox, &*wake) {
            locked(&outbox).fail(&error);
        }
        wake();
    });
    RunThread { orders, outbox, thread: Some(thread) }
}

/// Plans as the orders say, until the run is over.
fn drive(
    scene: &Scene,
    request: &Request,
    orders: &Orders,
    outbox: &SharedOutbox,
    wake: &dyn Fn(),
) -> Result<(), Error> {
    let clock = Clock::default();
    let prepared = scene.prepare(request)?;
    let run = prepared.begin(&mut Control { clock, cancel: orders.cancel.clone(), ..Control::default() })?;
    let mut driver = Driver::new(scene, run, Arc::clone(outbox), orders.cancel.clone(), clock);
    loop {
        if orders.is_pause() {
            driver.tell("paused", wake);
        }
        let order = orders.next();
        let advanced = driver.advance(order, &mut When(|| orders.new.load(Ordering::Relaxed)), wake);
        if advanced.over {
            break;
        }
        orders.left(advanced.left);
    }
    driver.finish(wake);
    Ok(())
}

/// Stops when a function says so.
struct When<F>(F);

impl<F: FnMut() -> bool> Stop for When<F> {
    fn check(&mut self, _: &Progress) -> Option<StopReason> {
        (self.0)().then_some(StopReason::Cancelled)
    }
}
