//! The `tracing` events of the crate: at debug level, from functions that are compiled once.

/// A problem was read, with all files that it names.
pub(crate) fn problem(name: &str, obstacles: usize) {
    tracing::debug!(name, obstacles, "problem");
}
