//! Messages over MPI.

use mp_ranks::{Error, Link};
use mpi::environment::Universe;
use mpi::point_to_point::{Destination, MatchedReceiveVec, Source};
use mpi::topology::{Communicator, SimpleCommunicator};
use mpi::{Rank, Threading};
use std::cell::Cell;
use std::time::Duration;

/// How long it waits before it looks for messages again: the first time after there was one, and at most.
///
/// MPI cannot wake a thread up, and its own waiting keeps a core busy. To look takes some microseconds.
const WAIT: [Duration; 2] = [Duration::from_micros(30), Duration::from_millis(1)];

/// The world of an MPI job. It ends MPI when it is dropped.
pub(crate) struct MpiLink {
    world: SimpleCommunicator,
    _universe: Universe,
    /// Whether something could not be sent.
    broken: Cell<bool>,
    /// How long to wait next.
    wait: Cell<Duration>,
}

impl MpiLink {
    /// Begins MPI. `None` when it has begun before, or cannot be used by a program with several threads.
    pub(crate) fn new() -> Option<Self> {
        // Only the thread that calls this sends and receives.
        let (universe, threading) = mpi::initialize_with_threading(Threading::Funneled)?;
        (threading >= Threading::Funneled).then(|| Self {
            world: universe.world(),
            _universe: universe,
            broken: Cell::new(false),
            wait: Cell::new(WAIT[0]),
        })
    }

    /// Whether a message could not be sent, for which another rank may wait.
    pub(crate) fn is_broken(&self) -> bool {
        self.broken.get()
    }

    fn fault(&self, message: String) -> Error {
        self.broken.set(true);
        Error::Link(message)
    }

    /// Ends all ranks at once.
    pub(crate) fn abort(&self, code: u8) -> ! {
        self.world.abort(code.into())
    }
}

impl Link for MpiLink {
    fn rank(&self) -> usize {
        usize::try_from(self.world.rank()).unwrap_or(0)
    }
    fn ranks(&self) -> usize {
        usize::try_from(self.world.size()).unwrap_or(1)
    }
    fn send(&self, to: usize, message: Vec<u8>) -> Result<(), Error> {
        let known = Rank::try_from(to).ok().filter(|rank| *rank < self.world.size());
        let rank = known.ok_or_else(|| self.fault(format!("there is no rank {to}")))?;
        if i32::try_from(message.len()).is_err() {
            let length = message.len();
            return Err(self.fault(format!("a message of {length} bytes is too large: MPI takes 2 GiB")));
        }
        // Where a rank is gone, MPI itself ends the job.
        self.world.process_at_rank(rank).send(&message[..]);
        Ok(())
    }
    fn poll(&self) -> Result<Option<(usize, Vec<u8>)>, Error> {
        let Some(found) = self.world.any_process().immediate_matched_probe() else { return Ok(None) };
        self.wait.set(WAIT[0]);
        let (bytes, status) = found.matched_receive_vec::<u8>();
        let from = usize::try_from(status.source_rank());
        from.map(|from| Some((from, bytes))).map_err(|_| Error::Link("a message has no sender".to_owned()))
    }
    fn wait(&self, most: Duration) {
        let wait = self.wait.get();
        std::thread::park_timeout(wait.min(most));
        self.wait.set((wait + wait / 4).min(WAIT[1]));
    }
}
