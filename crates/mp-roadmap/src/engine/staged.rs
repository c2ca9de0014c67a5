//! Connecting in stages: first by the local planner, then by motions that turn in place.

use super::{Candidate, Connector, Growing, MilestoneKind, Prefetching, Reachable};
use mp_cspace::registry::{Parameter, Settings};
use mp_cspace::{BuildError, Direction, Hit, LocalPlanner, NearestNeighbors, NodeId, Reversible, Space};
use std::collections::BTreeMap;

/// To which nodes a candidate is connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NeighborSet {
    /// The nearest nodes, whatever obstacle they belong to.
    Nearest,
    /// The nearest of all that are among this many nearest nodes of each obstacle, or of no obstacle. Costs a
    /// distance to every node.
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

/// To which nodes a new one is connected, and by which motions.
#[derive(Clone, Debug, PartialEq)]
pub struct ConnectionStages {
    /// To which nodes.
    pub among: NeighborSet,
    /// Whether there is a first stage, in which the local planner makes the whole motion.
    pub straight: bool,
    /// Where the second stage turns in place.
    pub turns: Turns,
}

/// The first stage alone, to the nearest nodes, as in PRM.
impl Default for ConnectionStages {
    fn default() -> Self {
        Self { among: NeighborSet::Nearest, straight: true, turns: Turns::At(Vec::new()) }
    }
}

/// [`ConnectionStages::among`].
pub(crate) const CONNECT: Parameter = Parameter {
    name: "connect",
    range: "nearest or obstacles",
    default: "nearest",
    doc: "to the nearest nodes, or to the nearest of each obstacle",
};

/// The number of [`NeighborSet::EachObstacle`].
pub(crate) const PER_OBSTACLE: Parameter = Parameter {
    name: "per-obstacle",
    range: "a whole number, 1 to 10⁶",
    default: "3",
    doc: "most nodes of each obstacle (k)",
};

/// [`ConnectionStages::straight`].
pub(crate) const STRAIGHT: Parameter = Parameter {
    name: "straight",
    range: "yes or no",
    default: "yes",
    doc: "tries straight motions first; `no` leaves rotate-at-s alone",
};

/// [`ConnectionStages::turns`].
pub(crate) const fn turns(range: &'static str, default: &'static str) -> Parameter {
    let doc =
        "fractions of a motion (1/2, 0, 1) at which rotate-at-s is tried where the straight motion fails";
    Parameter { name: TURNS, range, default, doc }
}

const TURNS: &str = "turns";

/// The values of [`turns`].
pub(crate) const TURNS_RANGE: &str = "a whole number, 0 to 3";

/// The values of [`turns`] where nodes are [far](MilestoneKind::Far) from obstacles.
pub(crate) const TURNS_OR_FAR: &str = "a whole number, 0 to 3, or far";

/// Where the second stage turns, by name.
const AT: [f64; 3] = [0.5, 0.0, 1.0];

impl Turns {
    /// At the first `n` of 1/2, 0 and 1, the usual fractions; all of them, if there are not as many.
    #[must_use]
    pub fn first(n: usize) -> Self {
        Self::At(AT[..n.min(AT.len())].to_vec())
    }
}

impl ConnectionStages {
    /// The values that are set, the others as they are.
    pub(crate) fn read(self, settings: &Settings) -> Result<Self, BuildError> {
        let each = NeighborSet::EachObstacle(settings.count_of(&PER_OBSTACLE)? as usize);
        let among = |word: &str| match word {
            "nearest" => Some(NeighborSet::Nearest),
            "obstacles" => Some(each),
            _ => None,
        };
        let has_far = self.turns == Turns::WhereFar;
        let turns = |word: &str| match word.parse() {
            Ok(n) if n <= AT.len() => Some(Turns::first(n)),
            _ if has_far && word == "far" => Some(Turns::WhereFar),
            _ => None,
        };
        let range = if has_far { TURNS_OR_FAR } else { TURNS_RANGE };
        Ok(Self {
            among: settings.choice(CONNECT.name, CONNECT.range, among)?.unwrap_or(self.among),
            straight: super::settings::yes(settings, &STRAIGHT)?,
            turns: settings.choice(TURNS, range, turns)?.unwrap_or(self.turns),
        })
    }
}

/// Every candidate becomes a node and is connected to others in stages (Amato, Bayazit, Dale, Jones and
/// Vallejo 1998, *OBPRM: an obstacle-based PRM for 3D workspaces*): first by the local planner; then, to
/// those that are still in other components, by rotate-at-s. Where the robot turns there are two more nodes,
/// so that each edge is one motion of the local planner.
///
/// Each node goes through both stages when it is added; in the paper all nodes go through the first stage
/// before the second.
#[derive(Clone, Debug)]
pub struct StagedConnector {
    within: Reachable,
    stages: ConnectionStages,
    near: Vec<Hit>,
    scratch: Vec<(f64, NodeId)>,
    /// The nodes of each obstacle, among the nodes below `grouped`.
    groups: BTreeMap<Option<u32>, Vec<NodeId>>,
    grouped: NodeId,
}

impl StagedConnector {
    /// # Errors
    /// When there are no neighbours, the radius is not positive, a fraction is not in \[0, 1\], or there is
    /// no stage.
    pub fn new(within: Reachable, stages: ConnectionStages) -> Result<Self, BuildError> {
        if let NeighborSet::EachObstacle(most) = stages.among {
            BuildError::count_within(PER_OBSTACLE.name, most as u64, 1, 1_000_000)?;
        }
        if let Turns::At(fractions) = &stages.turns {
            for &at in fractions {
                super::pairs::part("where to turn", at)?;
            }
            if fractions.is_empty() && !stages.straight {
                let reason = "without straight motions and without turns, nodes cannot be connected";
                return Err(BuildError::Unmade { reason: reason.to_owned() });
            }
        }
        let (near, scratch, groups) = (Vec::new(), Vec::new(), BTreeMap::new());
        Ok(Self { within: within.check()?, stages, near, scratch, groups, grouped: 0 })
    }

    /// Writes the nodes to try from `q`, in order of distance, ties by node, to `self.near`.
    fn look<C, L, N>(&mut self, q: &C::State, growing: &mut Growing<'_, '_, C, L, N>)
    where
        C: Space,
        L: LocalPlanner<C::State, Edge: Reversible>,
        N: NearestNeighbors<C>,
    {
        let Reachable { neighbours, radius, .. } = self.within;
        let NeighborSet::EachObstacle(most) = self.stages.among else {
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
    fn prefetch<N: NearestNeighbors<C>>(&self, prefetching: &mut Prefetching<'_, '_, C, L, N>) {
        if self.stages.straight && self.stages.among == NeighborSet::Nearest {
            prefetching.reach_nearest(&self.within);
        }
    }

    fn adopt<N: NearestNeighbors<C>>(
        &mut self,
        candidate: Candidate<C::State, L::Edge>,
        growing: &mut Growing<'_, '_, C, L, N>,
    ) -> NodeId {
        self.look(&candidate.state, growing);
        let far = candidate.kind == MilestoneKind::Far;
        let id = growing.add(candidate);
        if self.stages.straight {
            growing.link_near(&self.near, id, self.within.cycles);
        }
        let rounds = match &self.stages.turns {
            Turns::At(fractions) => fractions.len(),
            Turns::WhereFar => 2,
        };
        for round in 0..rounds {
            for hit in &self.near {
                if growing.checker().is_interrupted() {
                    return id;
                }
                if growing.map().connected(hit.id, id) {
                    continue;
                }
                let at = match &self.stages.turns {
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
