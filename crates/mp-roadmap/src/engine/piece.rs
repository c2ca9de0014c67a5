//! Pieces of roadmaps: what one attempt made from some nodes of a roadmap, apart from the roadmap itself.
//!
//! A piece depends only on the nodes that it was made from and on its random numbers. So pieces of different
//! nodes can be made at the same time, on threads or on the ranks of a cluster, and they are added to the
//! roadmap one after the other.

use super::file::{Reader, put_link, put_node};
use super::{EdgeId, Link, LinkState, Roadmap, RoadmapError, Tag};
use mp_cspace::{NodeId, StateVector};
use std::collections::{HashMap, HashSet};

/// How a roadmap was at some moment.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moment {
    nodes: usize,
    edges: usize,
    blocked: usize,
}

impl Moment {
    /// As it is now.
    pub(crate) fn of<S, E>(map: &Roadmap<S, E>) -> Self {
        Self { nodes: map.len(), edges: map.all_edges().len(), blocked: map.blocked() }
    }
}

/// Nodes of a roadmap with the edges between them, as a roadmap of their own.
pub(crate) struct Part<S, E> {
    /// The nodes in the roadmap.
    members: Vec<NodeId>,
    tags: Vec<Tag>,
    edges: usize,
    /// The roadmap of their own. What is added to it becomes the [piece](Self::piece).
    pub(crate) map: Roadmap<S, E>,
}

impl<S: Clone, E: Clone> Part<S, E> {
    /// These nodes of a roadmap, numbered in this order, with the edges between them that were there at some
    /// moment and not blocked.
    pub(crate) fn of(map: &Roadmap<S, E>, members: Vec<NodeId>, at: Moment) -> Self {
        debug_assert!(members.iter().all(|&id| (id as usize) < at.nodes));
        let mut part = Roadmap::new();
        let mut numbers = HashMap::with_capacity(members.len());
        for &id in &members {
            numbers.insert(id, part.add(map.state(id).clone(), *map.tag(id)));
        }
        let blocked_later: HashSet<EdgeId> = map.blocked_after(at.blocked).iter().copied().collect();
        let links = members.iter().flat_map(|&id| map.links_and_blocked(id));
        let within = links.filter(|(edge, other, link)| {
            let there = link.state != LinkState::Blocked || blocked_later.contains(edge);
            (edge.0 as usize) < at.edges && there && numbers.contains_key(other)
        });
        let mut edges: Vec<EdgeId> = within.map(|(edge, ..)| edge).collect();
        edges.sort_unstable();
        edges.dedup();
        for &edge in &edges {
            let [from, to] = map.ends(edge).map(|end| numbers[&end]);
            part.insert(from, to, Link { state: LinkState::Free, ..map.edge(edge).clone() });
        }
        let tags = members.iter().map(|&id| *map.tag(id)).collect();
        Self { members, tags, edges: edges.len(), map: part }
    }

    /// What was added.
    pub(crate) fn piece(self) -> Piece<S, E> {
        let Self { members, tags, edges, map } = self;
        let all =
            map.tags().zip(tags.iter().map(|tag| [tag.tried, tag.failed]).chain(std::iter::repeat([0; 2])));
        let tries = all.map(|(tag, [tried, failed])| [tag.tried - tried, tag.failed - failed]);
        let tries: Vec<[u32; 2]> = tries.collect();
        let nodes = map.states().iter().zip(map.tags()).skip(members.len());
        let links = map.all_edges().skip(edges);
        Piece {
            // Each attempt counts at both ends.
            motions: tries.iter().map(|[tried, _]| u64::from(*tried)).sum::<u64>() / 2,
            tries: tries.into_iter().take(members.len()).collect(),
            nodes: nodes.map(|(state, tag)| (state.clone(), *tag)).collect(),
            links: links.map(|(_, ends, link)| (ends, link.clone())).collect(),
            members,
        }
    }
}

/// What an attempt made from some nodes of a roadmap, its members: nodes, edges between all of them, and
/// attempts to connect members.
///
/// A generator [makes](crate::NodeGenerator::piece) it. As bytes it goes from one rank of a cluster to
/// another.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece<S, E> {
    /// The members in the roadmap. In the piece they come before the new nodes.
    members: Vec<NodeId>,
    /// How often each member was tried to be connected, and how often that failed.
    tries: Vec<[u32; 2]>,
    nodes: Vec<(S, Tag)>,
    /// Edges by the numbers of nodes in the piece.
    links: Vec<([NodeId; 2], Link<E>)>,
    motions: u64,
}

impl<S, E> Piece<S, E> {
    /// How many nodes it adds.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.nodes.len()
    }

    /// How many edges it adds.
    #[must_use]
    pub fn edges(&self) -> usize {
        self.links.len()
    }

    /// How many motions the local planner was asked for.
    #[must_use]
    pub fn motions(&self) -> u64 {
        self.motions
    }

    /// Adds it to the roadmap that has its members, without the edges that `keeps` refuses, given the states
    /// of their ends.
    pub fn insert(self, map: &mut Roadmap<S, E>, mut keeps: impl FnMut(&S, &Link<E>, &S) -> bool) {
        self.insert_kept(map, &mut keeps);
    }

    /// As [`insert`](Self::insert): compiled once for all closures.
    pub(crate) fn insert_kept(
        self,
        map: &mut Roadmap<S, E>,
        keeps: &mut dyn FnMut(&S, &Link<E>, &S) -> bool,
    ) {
        let mut ids = self.members;
        for (&id, [tried, failed]) in ids.iter().zip(self.tries).filter(|(_, [tried, _])| *tried > 0) {
            map.tried_often(id, tried, failed);
        }
        ids.extend(self.nodes.into_iter().map(|(state, tag)| map.add(state, tag)));
        for (ends, link) in self.links {
            let [from, to] = ends.map(|end| ids[end as usize]);
            if keeps(map.state(from), &link, map.state(to)) {
                map.insert(from, to, link);
            }
        }
    }
}

impl<S: StateVector, E: StateVector> Piece<S, E> {
    /// It as bytes, without its members. The same piece gives the same bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let tries = || self.tries.iter().enumerate().filter(|(_, [tried, _])| *tried > 0);
        let mut numbers = Vec::new();
        if let Some((state, _)) = self.nodes.first() {
            state.write(&mut numbers);
        }
        let mut bytes = self.motions.to_le_bytes().to_vec();
        for count in [self.tries.len(), tries().count(), self.nodes.len(), self.links.len(), numbers.len()] {
            bytes.extend((count as u32).to_le_bytes());
        }
        for (member, [tried, failed]) in tries() {
            [member as u32, *tried, *failed].iter().for_each(|number| bytes.extend(number.to_le_bytes()));
        }
        self.nodes.iter().for_each(|(state, tag)| put_node(&mut bytes, state, tag));
        self.links.iter().for_each(|(ends, link)| put_link(&mut bytes, *ends, link));
        bytes
    }

    /// The piece from the bytes of [`to_bytes`](Self::to_bytes); `members` are its members in the roadmap.
    ///
    /// # Errors
    /// When the bytes are cut off, or are not a piece with these members and such states.
    pub fn from_bytes(bytes: &[u8], members: Vec<NodeId>) -> Result<Self, RoadmapError> {
        let mut reader = Reader { bytes, at: 0 };
        let motions = reader.u64()?;
        let counts = [reader.u32()?, reader.u32()?, reader.u32()?, reader.u32()?, reader.u32()?];
        let [of, tried, nodes, links, width] = counts;
        let invalid = |at, expected| Err(RoadmapError::Invalid { at, expected });
        let all = members.len() as u64 + u64::from(nodes);
        if of as usize != members.len() || all > u64::from(u32::MAX) {
            return invalid(0, "a piece with as many members");
        }
        if motions < u64::from(links) {
            return invalid(0, "as many motions as edges");
        }
        let mut tries = vec![[0; 2]; members.len()];
        for _ in 0..tried {
            let at = reader.at;
            match tries.get_mut(reader.u32()? as usize) {
                Some(of) => *of = [reader.u32()?, reader.u32()?],
                None => return invalid(at, "a member"),
            }
        }
        // Not reserved beforehand: a damaged count takes no more memory than the bytes.
        let nodes = (0..nodes).map(|_| reader.node(width)).collect::<Result<Vec<_>, _>>()?;
        let links = (0..links).map(|_| reader.link(all as u32)).collect::<Result<Vec<_>, _>>()?;
        match reader.at == bytes.len() {
            true => Ok(Self { members, tries, nodes, links, motions }),
            false => invalid(reader.at, "the end"),
        }
    }
}
