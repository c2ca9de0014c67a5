//! What makes one variant of the family differ from another.

use super::{AStar, EndGrowth};

/// One variant of the family: what fills each slot, and when paths are looked for.
#[derive(Clone, Copy, Debug)]
pub struct RoadmapPlannerParts<G, K, Q> {
    /// Which configurations are tried as nodes.
    pub generator: G,
    /// Which of them become nodes, and with which edges.
    pub connector: K,
    /// How paths are looked for.
    pub query: Q,
    /// When paths are looked for.
    pub pace: Pace,
    /// Whether the planner is anytime: it may be stepped on after a path, and returns only shorter ones then.
    pub improves: bool,
    /// How trees grow from start and goal.
    pub ends: EndGrowth,
}

impl<G, K> RoadmapPlannerParts<G, K, AStar> {
    /// The parts of a planner that searches by A* after every attempt and ends with its first path.
    pub fn new(generator: G, connector: K) -> Self {
        let (query, pace, ends) = (AStar::new(), Pace::default(), EndGrowth::default());
        Self { generator, connector, query, pace, improves: false, ends }
    }
}

impl<G, K, Q> RoadmapPlannerParts<G, K, Q> {
    /// The same parts with another connector.
    pub fn connected_by<T>(self, connector: T) -> RoadmapPlannerParts<G, T, Q> {
        let Self { generator, query, pace, improves, ends, .. } = self;
        RoadmapPlannerParts { generator, connector, query, pace, improves, ends }
    }
}

/// When a planner looks for a path, once start and goal are in the same component. It always looks for one in
/// the first step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pace {
    /// Not before there are this many nodes.
    pub first: usize,
    /// Then whenever there are this many more.
    pub more: usize,
}
