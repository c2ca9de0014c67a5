//! What a server takes from its clients.

use std::time::Duration;

/// What a server takes from its clients: times, sizes and numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limits {
    /// How long a client may take to send the head of a request, and how long a connection may rest between
    /// two requests.
    pub head_time: Duration,
    /// Bytes of the head of a request; at least 8192.
    pub head_bytes: usize,
    /// How long a client may send nothing while the body of its request is not complete.
    pub body_pause: Duration,
    /// Bytes of the body of a request.
    pub body_bytes: u64,
    /// Connections at once; further ones wait.
    pub connections: usize,
    /// Sessions at once. A browser opens six connections to one server, and each session keeps one of them
    /// open: with more than five, a tab could not send its requests.
    pub sessions: usize,
    /// How long requests that are being handled may take to end after [`Stop::stop`](crate::Stop::stop).
    pub stop_time: Duration,
}

impl Default for Limits {
    /// 10 s and 32 KiB for the head, 30 s without data and 512 MiB for the body, 256 connections, 5 sessions,
    /// 2 s to stop.
    fn default() -> Self {
        Self {
            head_time: Duration::from_secs(10),
            head_bytes: 32 << 10,
            body_pause: Duration::from_secs(30),
            body_bytes: 512 << 20,
            connections: 256,
            sessions: 5,
            stop_time: Duration::from_secs(2),
        }
    }
}
