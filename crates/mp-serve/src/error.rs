//! Why a server cannot run.

use std::io;
use thiserror::Error;

/// Why a server cannot run.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ServeError {
    /// The port cannot be listened on.
    #[error("cannot listen on port {port} of this machine: {source}")]
    Listen {
        /// The port; 0 means any free one.
        port: u16,
        /// What the system says.
        source: io::Error,
    },
    /// The system gives no random numbers for the token.
    #[error("the system gives no random numbers for the token: {reason}")]
    Random {
        /// What the system says.
        reason: String,
    },
    /// The threads of the server cannot be started.
    #[error("cannot start the server: {source}")]
    Start {
        /// What the system says.
        #[from]
        source: io::Error,
    },
}
