//! Paths.

/// A sequence of states and the edges between them (`edges.len() + 1 == states.len()`).
#[derive(Clone, Debug, PartialEq)]
pub struct Path<S, E = ()> {
    /// The states, start first.
    pub states: Vec<S>,
    /// `edges[i]` leads from `states[i]` to `states[i + 1]`.
    pub edges: Vec<E>,
}
