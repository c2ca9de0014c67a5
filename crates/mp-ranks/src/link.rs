//! Messages between ranks.

use crate::Error;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::Thread;
use std::time::Duration;

/// The rank that hands out work.
pub(crate) const MASTER: usize = 0;

/// Messages between ranks. Those from one rank to another arrive in the order in which they were sent.
///
/// Only one thread of each rank uses its link.
pub trait Link {
    /// This rank: 0 is the master, which hands out work.
    fn rank(&self) -> usize;
    /// How many ranks there are.
    fn ranks(&self) -> usize;
    /// Sends a message to another rank.
    ///
    /// # Errors
    /// When the other rank cannot be reached.
    fn send(&self, to: usize, message: Vec<u8>) -> Result<(), Error>;
    /// A message that has arrived, with the rank of its sender. Does not wait.
    ///
    /// # Errors
    /// When no rank can be reached any more.
    fn poll(&self) -> Result<Option<(usize, Vec<u8>)>, Error>;
    /// Waits until a message has arrived, someone [unparks](Thread::unpark) this thread, or as long as seems
    /// good for a link that cannot tell that messages arrive, but not longer than `most`. May return at any
    /// time.
    fn wait(&self, most: Duration) {
        std::thread::park_timeout(most.min(Duration::from_millis(1)));
    }

    /// Whether this rank hands out the work.
    fn is_master(&self) -> bool {
        self.rank() == MASTER
    }
}

/// The link of a rank that is a thread of this process.
#[derive(Debug)]
pub struct ThreadLink {
    rank: usize,
    to: Vec<Mailbox>,
    arrived: Receiver<(usize, Vec<u8>)>,
}

/// Where messages to a rank go.
#[derive(Clone, Debug)]
struct Mailbox {
    sender: Sender<(usize, Vec<u8>)>,
    /// Who looked last, and may be waiting.
    reader: Arc<Mutex<Option<Thread>>>,
}

impl Mailbox {
    fn reader(&self) -> std::sync::MutexGuard<'_, Option<Thread>> {
        self.reader.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The links of `ranks` ranks, each for a thread of this process; at least one.
#[must_use]
pub fn threads(ranks: usize) -> Vec<ThreadLink> {
    let (senders, receivers): (Vec<_>, Vec<_>) = (0..ranks.max(1)).map(|_| channel()).unzip();
    let to: Vec<_> = senders.into_iter().map(|sender| Mailbox { sender, reader: Arc::default() }).collect();
    let link = |(rank, arrived)| ThreadLink { rank, to: to.clone(), arrived };
    receivers.into_iter().enumerate().map(link).collect()
}

impl Link for ThreadLink {
    fn rank(&self) -> usize {
        self.rank
    }
    fn ranks(&self) -> usize {
        self.to.len()
    }
    fn send(&self, to: usize, message: Vec<u8>) -> Result<(), Error> {
        let mailbox = self.to.get(to);
        let sent = mailbox.filter(|mailbox| mailbox.sender.send((self.rank, message)).is_ok());
        let mailbox = sent.ok_or_else(|| Error::Link(format!("rank {to} has ended")))?;
        if let Some(reader) = &*mailbox.reader() {
            reader.unpark();
        }
        Ok(())
    }
    fn poll(&self) -> Result<Option<(usize, Vec<u8>)>, Error> {
        // Before it looks: what comes later wakes it.
        *self.to[self.rank].reader() = Some(std::thread::current());
        // This link has a sender to itself, so an error means that there is nothing.
        Ok(self.arrived.try_recv().ok())
    }
    fn wait(&self, most: Duration) {
        std::thread::park_timeout(most);
    }
}
