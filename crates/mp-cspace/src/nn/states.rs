//! What an index asks about states, by their numbers. It does not know the type of the space, so it is compiled once for all spaces.

use super::{Layout, NodeId};
use crate::Space;
use crate::nn::Embed;

/// The states of an index, and one more: the query, or the state that is inserted.
pub(super) trait States {
    /// From state `id` to the query.
    fn to_query(&self, id: NodeId) -> f64;
    /// From one state to another.
    fn distance(&self, from: NodeId, to: NodeId) -> f64;
    /// Whether two states are the same.
    fn same(&self, a: NodeId, b: NodeId) -> bool;
}

/// States that have coordinates.
pub(super) trait EmbeddedStates: States {
    /// What the coordinates mean.
    fn layout(&self) -> Layout;
    /// Writes the coordinates of state `id`.
    fn embed(&self, id: NodeId, out: &mut [f64]);
    /// Writes the coordinates of the query.
    fn embed_query(&self, out: &mut [f64]);
}

/// States of a space, and the one searched for or inserted.
#[derive(Debug)]
pub(super) struct SpaceStates<'a, C: Space> {
    pub(super) space: &'a C,
    pub(super) points: &'a [C::State],
    pub(super) query: &'a C::State,
}

impl<C: Space> SpaceStates<'_, C> {
    #[inline]
    fn at(&self, id: NodeId) -> &C::State {
        &self.points[id as usize]
    }
}

impl<C: Space> States for SpaceStates<'_, C> {
    fn to_query(&self, id: NodeId) -> f64 {
        self.space.distance(self.at(id), self.query)
    }

    fn distance(&self, from: NodeId, to: NodeId) -> f64 {
        self.space.distance(self.at(from), self.at(to))
    }

    fn same(&self, a: NodeId, b: NodeId) -> bool {
        self.at(a) == self.at(b)
    }
}

impl<C: Embed> EmbeddedStates for SpaceStates<'_, C> {
    fn layout(&self) -> Layout {
        self.space.layout()
    }

    fn embed(&self, id: NodeId, out: &mut [f64]) {
        self.space.embed(self.at(id), out);
    }

    fn embed_query(&self, out: &mut [f64]) {
        self.space.embed(self.query, out);
    }
}
