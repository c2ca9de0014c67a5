//! Numbered work items over the ranks of a cluster.
//!
//! All ranks run the same program and come to the same calls of [`run`]. The first rank is the master. It
//! hands out the items of a [`Job`] one by one, to itself too, as earlier ones are finished, and takes their
//! results. A result depends on its item alone, so the whole is the same for any number of ranks, whoever did
//! what, and when.
//!
//! - A [`Link`] carries messages. [`threads`] makes links between threads; that of MPI is elsewhere.
//! - A [`Checkpoint`] keeps results, so that a job that was killed goes on.
//! - [`Shares`] says what each rank did.
//! - [`Pace`] keeps searches that race side by side.
//! - [`simulate`] replays measured costs for any number of ranks.
//!
//! ```
//! use mp_ranks::{ItemContext, Items, Options, run, threads};
//!
//! let square = |item: u64, _: &ItemContext| Ok((item * item).to_le_bytes().to_vec());
//! let mut squares = [0; 100];
//! let mut job = Items::new(0..100, |item, _rank, result: Vec<u8>| {
//!     squares[item as usize] = u64::from_le_bytes(result.try_into().map_err(|_| "eight bytes")?);
//!     Ok(())
//! });
//! // Three ranks, here threads.
//! let mut others = threads(3);
//! let master = others.remove(0);
//! std::thread::scope(|scope| {
//!     for link in others {
//!         scope.spawn(move || run(&link, &Options::default(), None, &square));
//!     }
//!     run(&master, &Options::default(), Some(&mut job), &square)
//! })?;
//! assert_eq!(squares[99], 9801);
//! # Ok::<(), mp_ranks::Error>(())
//! ```

mod checkpoint;
mod job;
mod link;
mod pace;
mod run;
mod shares;
mod simulate;

pub use checkpoint::Checkpoint;
pub use job::{Items, Job};
pub use link::{Link, ThreadLink, threads};
pub use pace::Pace;
pub use run::{ItemContext, JobEnd, Options, Work, broadcast, run};
pub use shares::Shares;
pub use simulate::{Policy, Simulated, simulate};

/// What ends a job on all ranks.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Messages cannot be sent or received.
    #[error("the ranks cannot reach each other: {0}")]
    Link(String),
    /// An item cannot be done, or its result cannot be taken.
    #[error("item {item}, done by rank {rank}: {message}")]
    Item {
        /// The number of the item, counted from 0.
        item: u64,
        /// Who did it.
        rank: usize,
        /// What is wrong.
        message: String,
    },
    /// A rank came to another call than the master: they are different programs, or have different inputs.
    #[error(
        "rank {rank} sent a message that nobody expects: do all ranks run the same program with the same files?"
    )]
    OutOfStep {
        /// The rank whose message nobody expected.
        rank: usize,
    },
    /// A checkpoint cannot be used.
    #[error("{file}: {message}; {remedy}")]
    Checkpoint {
        /// The file, as it was named.
        file: String,
        /// What is wrong.
        message: String,
        /// What to do.
        remedy: String,
    },
}

impl From<mp_store::Error> for Error {
    fn from(e: mp_store::Error) -> Self {
        let (file, message) = (e.path().display().to_string(), e.message().to_owned());
        Self::Checkpoint { file, message, remedy: e.remedy().to_owned() }
    }
}
