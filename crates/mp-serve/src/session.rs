//! What a server asks of the program behind it.

use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::{Notify, Semaphore};

/// The program behind one tab. It is dropped when the tab is closed, which must end all that it does.
pub trait Session: Send + Sync + 'static {
    /// The reply to a request. It may take long, and is called from several threads.
    fn handle(&self, request: &[u8]) -> Vec<u8>;

    /// The next event, if there is one. The server asks for it when the tab has taken the last one, and after
    /// a [`Wake::wake`].
    fn take_event(&self) -> Option<Vec<u8>>;
}

/// Tells the server that a session has events. It can be called from any thread, and returns at once.
#[derive(Clone, Default)]
pub struct Wake(Arc<Notify>);

impl Wake {
    /// There are events: the server asks for them by [`Session::take_event`]. Calls are joined: one is
    /// enough.
    pub fn wake(&self) {
        self.0.notify_one();
    }

    /// Waits for the next call of [`wake`](Self::wake), or for one since the last time.
    pub(crate) async fn called(&self) {
        self.0.notified().await;
    }
}

impl fmt::Debug for Wake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Wake")
    }
}

/// A session that runs.
pub(crate) struct Running {
    pub(crate) session: Box<dyn Session>,
    /// Held by the one large request that may be in memory.
    pub(crate) large: tokio::sync::Mutex<()>,
}

pub(crate) struct Sessions {
    /// Opens another one.
    pub(crate) open: Box<dyn Fn(Wake) -> Box<dyn Session> + Send + Sync>,
    /// Places for further ones.
    pub(crate) places: Arc<Semaphore>,
    running: Mutex<HashMap<String, Arc<Running>>>,
}

impl Sessions {
    pub(crate) fn new(
        open: impl Fn(Wake) -> Box<dyn Session> + Send + Sync + 'static,
        places: usize,
    ) -> Self {
        let places = Arc::new(Semaphore::new(places));
        Self { open: Box::new(open), places, running: Mutex::default() }
    }

    pub(crate) fn insert(&self, name: String, session: Box<dyn Session>) -> Arc<Running> {
        let running = Arc::new(Running { session, large: tokio::sync::Mutex::default() });
        self.list().insert(name, Arc::clone(&running));
        running
    }

    pub(crate) fn find(&self, name: &str) -> Option<Arc<Running>> {
        self.list().get(name).cloned()
    }

    pub(crate) fn remove(&self, name: &str) {
        self.list().remove(name);
    }

    fn list(&self) -> MutexGuard<'_, HashMap<String, Arc<Running>>> {
        // Whoever panicked did not leave the map half changed.
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
