//! The stream of events of a session, which lives as long as the stream.

use crate::session::{Running, Session, Sessions};
use crate::{ServeError, Wake};
use hyper::body::Bytes;
use std::future::{Future, poll_fn};
use std::pin::pin;
use std::sync::Arc;
use std::task::Poll;
use std::time::Duration;
use tokio::sync::OwnedSemaphorePermit;
use tokio::sync::mpsc::{Receiver, Sender, channel};
use tokio::task::spawn_blocking;
use tokio::time::timeout;

/// How long a new tab waits for the session of one that was just closed, as when a page is loaded again.
const PATIENCE: Duration = Duration::from_secs(1);

/// Opens a session, and gives its stream of events: each as u32 length (little-endian) and the message.
/// `None` when there are too many sessions.
///
/// # Errors
/// When the system gives no random numbers.
pub(crate) async fn stream(sessions: Arc<Sessions>) -> Result<Option<Receiver<Bytes>>, ServeError> {
    let Ok(Ok(place)) = timeout(PATIENCE, Arc::clone(&sessions.places).acquire_owned()).await else {
        return Ok(None);
    };
    let name = crate::token::Token::random()?.text().to_owned();
    // One at a time: an event is taken from the session when the connection can take it.
    let (sender, receiver) = channel(1);
    tokio::spawn(live(sessions, place, name, sender));
    Ok(Some(receiver))
}

/// The life of a session: until nobody reads its events, or it fails.
async fn live(sessions: Arc<Sessions>, place: OwnedSemaphorePermit, name: String, sender: Sender<Bytes>) {
    let wake = Wake::default();
    let opening = (Arc::clone(&sessions), wake.clone());
    let session = match spawn_blocking(move || (opening.0.open)(opening.1)).await {
        Ok(session) => session,
        Err(e) => return tracing::error!("a session failed when it was opened: {e}"),
    };
    let entry = Entry::new(sessions, place, name, session);
    let running = Arc::clone(&entry.running);
    first(carry(&entry.name, running, &wake, &sender), sender.closed()).await;
    tracing::debug!("a session ends");
    // To end a session may take a moment.
    drop(spawn_blocking(move || drop(entry)));
}

/// Carries events until the session fails or the reader is gone.
async fn carry(name: &str, running: Arc<Running>, wake: &Wake, sender: &Sender<Bytes>) {
    let mut next = Ok(Some(hello(name)));
    while let Ok(room) = sender.reserve().await {
        match next {
            Ok(Some(event)) => match framed(&event) {
                Some(bytes) => room.send(bytes),
                None => return tracing::error!("an event has {} bytes, which is too long", event.len()),
            },
            Ok(None) => wake.called().await,
            Err(e) => return tracing::error!("a session failed at its events: {e}"),
        }
        let taking = Arc::clone(&running);
        next = spawn_blocking(move || taking.session.take_event()).await;
    }
}

/// The length and the message; `None` when its length is not a u32.
fn framed(message: &[u8]) -> Option<Bytes> {
    let length = u32::try_from(message.len()).ok()?;
    Some([&length.to_le_bytes(), message].concat().into())
}

/// The first event, which tells the name of the session: a message without arrays.
fn hello(name: &str) -> Vec<u8> {
    let mut head = format!("{{\"event\":\"hello\",\"session\":\"{name}\"}}");
    let padded = head.len().next_multiple_of(8);
    head.extend(std::iter::repeat_n(' ', padded - head.len()));
    [b"MPV1", &(padded as u32).to_le_bytes()[..], head.as_bytes()].concat()
}

/// A session in the list, until it is dropped.
struct Entry {
    name: String,
    sessions: Arc<Sessions>,
    running: Arc<Running>,
    // The last one: the place is free when the session has ended.
    _place: OwnedSemaphorePermit,
}

impl Entry {
    fn new(
        sessions: Arc<Sessions>,
        place: OwnedSemaphorePermit,
        name: String,
        session: Box<dyn Session>,
    ) -> Self {
        let running = sessions.insert(name.clone(), session);
        Self { name, sessions, running, _place: place }
    }
}

impl Drop for Entry {
    fn drop(&mut self) {
        self.sessions.remove(&self.name);
    }
}

/// Waits for the first of two.
pub(crate) async fn first(a: impl Future<Output = ()>, b: impl Future<Output = ()>) {
    let (mut a, mut b) = (pin!(a), pin!(b));
    poll_fn(|context| match a.as_mut().poll(context) {
        Poll::Ready(()) => Poll::Ready(()),
        Poll::Pending => b.as_mut().poll(context),
    })
    .await;
}
