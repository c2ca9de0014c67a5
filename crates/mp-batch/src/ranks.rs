//! What `mp-ranks` does, with errors of `mp-plan`.

use mp_plan::Error;
use mp_ranks::{Job, JobEnd, Link, Options, Work};

/// An error of ranks as one of `mp-plan`.
#[must_use]
pub fn ranks_error(error: mp_ranks::Error) -> Error {
    match error {
        mp_ranks::Error::Checkpoint { file, message, remedy } => {
            Error::new(format!("{file}: {message}")).help(remedy)
        }
        other => Error::new(other.to_string()),
    }
}

/// As [`mp_ranks::broadcast`].
pub(crate) fn broadcast(link: &dyn Link, bytes: Vec<u8>) -> Result<Vec<u8>, Error> {
    mp_ranks::broadcast(link, bytes).map_err(ranks_error)
}

/// As [`mp_ranks::run`].
pub(crate) fn run(
    link: &dyn Link,
    options: &Options,
    job: Option<&mut dyn Job>,
    work: &Work<'_>,
) -> Result<JobEnd, Error> {
    mp_ranks::run(link, options, job, work).map_err(ranks_error)
}
