//! Messages between ranks.

use crate::Error;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};

/// The rank that hands out work.
pub(crate) const MASTER: usize = 0;

/// Messages between ranks. Those from one rank to another arrive in the order in which they were sent.
///
/// Only one thread of each rank uses its link.
pub trait Link {
    /// The number of this rank, from 0.
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

    /// Whether this rank hands out the work.
    fn is_master(&self) -> bool {
        self.rank() == MASTER
    }
}

/// The link of a rank that is a thread of this process.
#[derive(Debug)]
pub struct ThreadLink {
    rank: usize,
    to: Vec<Sender<(usize, Vec<u8>)>>,
    arrived: Receiver<(usize, Vec<u8>)>,
}

/// The links of so many ranks, each for a thread of this process; at least one.
#[must_use]
pub fn threads(ranks: usize) -> Vec<ThreadLink> {
    let (senders, receivers): (Vec<_>, Vec<_>) = (0..ranks.max(1)).map(|_| channel()).unzip();
    let link = |(rank, arrived)| ThreadLink { rank, to: senders.clone(), arrived };
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
        let sent = self.to.get(to).map(|sender| sender.send((self.rank, message)));
        match sent {
            Some(Ok(())) => Ok(()),
            _ => Err(Error::Link(format!("rank {to} has ended"))),
        }
    }
    fn poll(&self) -> Result<Option<(usize, Vec<u8>)>, Error> {
        match self.arrived.try_recv() {
            Ok(message) => Ok(Some(message)),
            // This link has a sender to itself.
            Err(TryRecvError::Empty | TryRecvError::Disconnected) => Ok(None),
        }
    }
}
