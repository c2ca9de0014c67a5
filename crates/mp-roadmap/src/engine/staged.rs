//! Connecting in stages: first by the local planner, then by motions that turn in place.

use super::{Candidate, Connector, Growing, MilestoneKind, Reachable};
use mp_cspace::{BuildError, Direction, Hit, LocalPlanner, NearestNeighbors, NodeId, Reversible, Space};
use std::collections::BTreeMap;

/// To which nodes a candidate is connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NeighborSet {
    /// The nearest.
    Nearest,
    /// The nearest of all that are among this many nearest nodes of each obstacle, or of no obstacle. Costs a distance to
    /// every node.
    EachObstacle(usize),
}

/// Where a second stage turns in place.
#[derive(Clone, Debug, PartialEq)]
pub enum Turns {
    /// At these fractions of the motion, one after the other. Without fractions there is no second stage.
    At(Vec<f64>),
    /// At the ends that are far from all obstacles, where the robot is free in every rotation.
    WhereFar,
}

/// Every candidate becomes a node and is connected to others in stages (Amato, Bayazit, Dale, Jones and Vallejo
/// 1998, *OBPRM: an obstacle-based PRM for 3D workspaces*): first by the local planner; then, to
/// those that are still in other components, by rotate-at-s. Where the robot turns there are two more nodes, so that
/// each edge is one motion of the local planner.
///
/// Each node goes through both stages when it is added; in the paper all nodes go through the first stage before the
/// second.
#[derive(Clone, Debug)]
pub struct StagedConnector {
    within: Reachable,
    among: NeighborSet,
    turns: Turns,
    near: Vec<Hit>,
    scratch: Vec<(f64, NodeId)>,
    /// The nodes of each obstacle, among the nodes below `grouped`.
    groups: BTreeMap<Option<u32>, Vec<NodeId>>,
    grouped: NodeId,
}

impl StagedConnector {
    /// # Errors
    /// When there are no neighbours, the radius is not positive, or a fraction is not in \[0, 1\].
    pub fn new(within: Reachable, among: NeighborSet, turns: Turns) -> Result<Self, BuildError> {
        if let NeighborSet::EachObstacle(most) = among {
            BuildError::count_within("per-obstacle", most as u64, 1, 1_000_000)?;
        }
        if let Turns::At(fractions) = &turns {
            for &at in fractions {
                super::pairs::part("where to turn", at)?;
            }
        }
        let (near, scratch, groups) = (Vec::new(), Vec::new(), BTreeMap::new());
        Ok(Self { within: within.check()?, among, turns, near, scratch, groups, grouped: 0 })
    }

    /// Writes the nodes to try from `q`, in order of distance, ties by node, to `self.near`.
    fn look<C, L, N>(&mut self, q: &C::State, growing: &mut Growing<'_, '_, C, L, N>)
    where
        C: Space,
        L: LocalPlanner<C::State, Edge: Reversible>,
        N: NearestNeighbors<C>,
    {
        let Reachable { neighbours, radius, .. } = self.within;
        let NeighborSet::EachObstacle(most) = self.among else {
            return growing.near(q, neighbours, radius, &mut self.near);
        };
        let (space, map) = (growing.space(), growing.map());
        for id in self.grouped..map.len() as NodeId {
            self.groups.entry(map.tag(id).obstacle).or_default().push(id);
        }
        self.grouped = map.len() as NodeId;
        self.near.clear();
        let by_distance = |a: &(f64, NodeId), b: &(f64, NodeId)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        for group in self.groups.values() {
            self.scratch.clear();
            self.scratch.extend(group.iter().map(|&id| (space.distance(map.state(id), q), id)));
            if self.scratch.len() > most {
                self.scratch.select_nth_unstable_by(most, by_distance);
                self.scratch.truncate(most);
            }
            let within = self.scratch.iter().filter(|(distance, _)| *distance <= radius);
            self.near.extend(within.map(|&(distance, id)| Hit { id, distance }));
        }
        self.near.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.id.cmp(&b.id)));
        self.near.truncate(neighbours);
    }

    /// Tries to connect two nodes by a turn in place at a fraction of the motion.
    fn turn<C, L, N>(&self, from: NodeId, to: NodeId, at: f64, growing: &mut Growing<'_, '_, C, L, N>)
    where
        C: Space,
        L: LocalPlanner<C::State, Edge: Reversible>,
        N: NearestNeighbors<C>,
    {
        let space = growing.space();
        let [start, end] = [from, to].map(|id| growing.map().state(id).clone());
        let middle = space.interpolate(&start, &end, at);
        let mut corners = Vec::with_capacity(2);
        if at > 0.0 {
            corners.push(space.with_rotation_of(&middle, &start));
        }
        if at < 1.0 {
            corners.push(space.with_rotation_of(&middle, &end));
        }
        if !corners.iter().all(|q| growing.checker().admits(q)) {
            return;
        }
        let mut motions = Vec::with_capacity(3);
        let mut here = &start;
        for next in corners.iter().chain([&end]) {
            let Some(motion) = growing.checker().reach(here, next, Direction::Forward) else { return };
            motions.push(motion);
            here = next;
        }
        let mut last = from;
        for (i, motion) in motions.into_iter().enumerate() {
            let next = match corners.get(i) {
                Some(q) => growing.add(Candidate::new(q.clone(), MilestoneKind::Expanded)),
                None => to,
            };
            growing.link(last, next, motion);
            last = next;
        }
    }
}

impl<C, L> Connector<C, L> for StagedConnector
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
    fn connect<N: NearestNeighbors<C>>(
        &mut self,
        candidate: Candidate<C::State, L::Edge>,
        growing: &mut Growing<'_, '_, C, L, N>,
    ) -> Option<NodeId> {
        Some(self.adopt(candidate, growing))
    }

    fn adopt<N: NearestNeighbors<C>>(
        &mut self,
        candidate: Candidate<C::State, L::Edge>,
        growing: &mut Growing<'_, '_, C, L, N>,
    ) -> NodeId {
        self.look(&candidate.state, growing);
        let far = candidate.kind == MilestoneKind::Far;
        let id = growing.add(candidate);
        for hit in &self.near {
            if self.within.cycles || !growing.map().connected(hit.id, id) {
                growing.try_link(hit.id, id);
            }
        }
        let rounds = match &self.turns {
            Turns::At(fractions) => fractions.len(),
            Turns::WhereFar => 2,
        };
        for round in 0..rounds {
            for hit in &self.near {
                if growing.map().connected(hit.id, id) {
                    continue;
                }
                let at = match &self.turns {
                    Turns::At(fractions) => fractions[round],
                    // First at one end, then at the other.
                    Turns::WhereFar if round == 0 && growing.map().tag(hit.id).kind == MilestoneKind::Far => {
                        0.0
                    }
                    Turns::WhereFar if round == 1 && far => 1.0,
                    Turns::WhereFar => continue,
                };
                self.turn(hit.id, id, at, growing);
            }
        }
        id
    }
}
