//! The trees or the roadmap that a run grows: what the page has not been told yet, and all of them for a scene file.

use crate::message::Message;
use crate::{Bends, Roadmap, SceneFile, Tree};
use mp_cspace::NodeId;
use mp_plan::{GrownRoadmap, Request, Scene, SearchEvent, Watch};
use nalgebra::Vector3;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// At most this many motions that were not free are kept until the page takes them; the oldest are dropped first.
const MAX_REJECTED: usize = 20_000;

/// The trees or the roadmap of a run, and which part of them the page has.
#[derive(Debug)]
pub(crate) struct Growth {
    /// Says where a configuration is drawn, and relative to what.
    scene: Scene,
    origin: Vector3<f64>,
    /// Whether the planner builds a roadmap.
    roadmap: bool,
    trees: Vec<GrowingTree>,
    /// Edges of a roadmap that the page does not have.
    edges: Vec<u32>,
    /// Edges that turned out to be blocked, and that the page does not know of.
    unlinked: Vec<u32>,
    rejected: Vec<f32>,
}

/// A tree, or the nodes of a roadmap.
#[derive(Debug, Default)]
struct GrowingTree {
    /// x y z of each node.
    nodes: Vec<f32>,
    /// The parent of each node, −1 for roots.
    parents: Vec<i32>,
    /// What each node of a roadmap is, as in [`Roadmap`]; empty for a tree.
    kinds: Vec<u8>,
    /// Of each node whose edge bends, x y z of the points between its parent and itself.
    bends: BTreeMap<usize, Vec<f32>>,
    /// How many nodes the page has.
    sent: usize,
    /// Nodes that the page has with another parent.
    rewired: BTreeSet<usize>,
    /// The former numbers of the nodes that the page has and that remain, if some were removed.
    survivors: Option<Vec<u32>>,
}

impl Growth {
    pub(crate) fn new(scene: Scene, origin: [f64; 3], request: &Request) -> Self {
        let roadmap = mp_plan::roadmap_planners().iter().any(|info| info.is_called(&request.planner));
        Self {
            scene,
            origin: origin.into(),
            roadmap,
            trees: Vec::new(),
            edges: Vec::new(),
            unlinked: Vec::new(),
            rejected: Vec::new(),
        }
    }

    pub(crate) fn note(&mut self, event: &SearchEvent<'_>) {
        match event {
            SearchEvent::Rooted { tree, id, row, kind } => {
                self.add(*tree, *id, -1, row);
                self.tree(*tree).kinds.extend(kind.map(number_of_kind));
            }
            SearchEvent::Added { tree, id, parent, row, through } => {
                self.add(*tree, *id, number(*parent), row);
                self.bend(*tree, *id, through);
            }
            SearchEvent::Rewired { tree, id, parent, through } => {
                self.tree(*tree).rewire(*id as usize, number(*parent));
                self.bend(*tree, *id, through);
            }
            SearchEvent::Pruned { tree, survivors } => self.tree(*tree).prune(survivors),
            SearchEvent::Linked { from, to } => self.edges.extend([*from, *to]),
            SearchEvent::Unlinked { from, to } => self.unlinked.extend([*from, *to]),
            SearchEvent::Blocked { from, toward } => {
                if self.rejected.len() >= 6 * MAX_REJECTED {
                    self.rejected.drain(..3 * MAX_REJECTED);
                }
                let ends = [self.place(from), self.place(toward)];
                self.rejected.extend(ends.iter().flatten());
            }
            _ => {}
        }
    }

    fn add(&mut self, tree: usize, id: NodeId, parent: i32, row: &[f64]) {
        let place = self.place(row);
        let tree = self.tree(tree);
        // Nodes come in the order of their numbers.
        debug_assert_eq!(tree.parents.len(), id as usize);
        tree.nodes.extend(place);
        tree.parents.push(parent);
    }

    /// Notes the points at which the edge to a node bends.
    fn bend(&mut self, tree: usize, id: NodeId, through: &[Vec<f64>]) {
        let points = through.iter().flat_map(|row| self.place(row)).collect();
        self.tree(tree).bend(id as usize, points);
    }

    fn tree(&mut self, tree: usize) -> &mut GrowingTree {
        if self.trees.len() <= tree {
            self.trees.resize_with(tree + 1, GrowingTree::default);
        }
        &mut self.trees[tree]
    }

    fn drawn(&self, map: GrownRoadmap) -> Roadmap {
        Roadmap {
            nodes: map.rows.iter().flat_map(|row| self.place(row)).collect(),
            edges: map.edges.into_flattened(),
            component: map.components,
            kind: map.kinds.iter().map(|kind| number_of_kind(kind)).collect(),
        }
    }

    /// Where a configuration is drawn.
    fn place(&self, row: &[f64]) -> [f32; 3] {
        self.scene.traced(row).map_or([0.0; 3], |p| (p - self.origin).coords.map(|x| x as f32).into())
    }

    /// The event `grown` with all that the page does not have, if there is anything; afterwards the page has it.
    pub(crate) fn take(&mut self, run: u64) -> Option<Message> {
        let news = self.trees.iter().any(GrowingTree::has_news);
        let links = [&self.edges, &self.unlinked].iter().any(|edges| !edges.is_empty());
        if !news && !links && self.rejected.is_empty() {
            return None;
        }
        let mut message = Message::event("grown", run);
        let (mut trees, mut rewired, mut pruned, mut roadmap) = (vec![], vec![], vec![], Value::Null);
        for (i, tree) in self.trees.iter_mut().enumerate() {
            if let Some(survivors) = tree.survivors.take() {
                pruned.push(json!({"tree": i, "survivors": message.array(&survivors)}));
            }
            let nodes = message.array(&tree.nodes[3 * tree.sent..]);
            if self.roadmap {
                let edges = message.array(&std::mem::take(&mut self.edges));
                let unlinked = message.array(&std::mem::take(&mut self.unlinked));
                let kinds = message.array(&tree.kinds[tree.sent..]);
                roadmap = json!({
                    "from": tree.sent, "nodes": nodes, "edges": edges, "unlinked": unlinked, "kind": kinds,
                });
            } else if tree.sent < tree.parents.len() {
                let parents = message.array(&tree.parents[tree.sent..]);
                let bends = tree.bends_of(tree.sent..tree.parents.len());
                let (bent, through) = (message.array(&bends.nodes), message.array(&bends.through));
                trees.push(json!({
                    "tree": i, "name": name_of(i), "from": tree.sent, "nodes": nodes, "parents": parents,
                    "bent": bent, "through": through,
                }));
            }
            if !tree.rewired.is_empty() {
                let ids: Vec<u32> = tree.rewired.iter().map(|&id| id as u32).collect();
                let parents: Vec<i32> = tree.rewired.iter().map(|&id| tree.parents[id]).collect();
                let changed = std::mem::take(&mut tree.rewired);
                let bends = tree.bends_of(changed);
                rewired.push(json!({
                    "tree": i, "nodes": message.array(&ids), "parents": message.array(&parents),
                    "bent": message.array(&bends.nodes), "through": message.array(&bends.through),
                }));
            }
            tree.sent = tree.parents.len();
        }
        let rejected = message.array(&std::mem::take(&mut self.rejected));
        Some(
            message
                .with("trees", trees)
                .with("rewired", rewired)
                .with("pruned", pruned)
                .with("roadmap", roadmap)
                .with("rejected", rejected),
        )
    }
}

impl GrowingTree {
    fn has_news(&self) -> bool {
        self.sent < self.parents.len() || !self.rewired.is_empty() || self.survivors.is_some()
    }

    fn rewire(&mut self, id: usize, parent: i32) {
        if let Some(old) = self.parents.get_mut(id) {
            *old = parent;
            if id < self.sent {
                self.rewired.insert(id);
            }
        }
    }

    /// Notes x y z of the points at which the edge to a node bends.
    fn bend(&mut self, id: usize, points: Vec<f32>) {
        match points.is_empty() {
            true => self.bends.remove(&id),
            false => self.bends.insert(id, points),
        };
    }

    /// The bent edges of some nodes.
    fn bends_of(&self, nodes: impl IntoIterator<Item = usize>) -> Bends {
        let mut bends = Bends::default();
        for id in nodes {
            if let Some(points) = self.bends.get(&id) {
                bends.nodes.extend([id as u32, points.len() as u32 / 3]);
                bends.through.extend(points);
            }
        }
        bends
    }

    /// Keeps the nodes with these numbers, which rise.
    fn prune(&mut self, survivors: &[NodeId]) {
        let mut new = vec![-1; self.parents.len()];
        for (now, &before) in survivors.iter().enumerate() {
            new[before as usize] = now as i32;
        }
        let renumbered = |parent: i32| usize::try_from(parent).map_or(-1, |parent| new[parent]);
        let sent: Vec<u32> = survivors.iter().copied().filter(|&id| (id as usize) < self.sent).collect();
        self.nodes = survivors.iter().flat_map(|&id| self.nodes[3 * id as usize..][..3].to_vec()).collect();
        self.parents = survivors.iter().map(|&id| renumbered(self.parents[id as usize])).collect();
        let bends = std::mem::take(&mut self.bends).into_iter();
        self.bends = bends.filter_map(|(id, b)| Some((usize::try_from(new[id]).ok()?, b))).collect();
        self.rewired = self.rewired.iter().filter_map(|&id| usize::try_from(new[id]).ok()).collect();
        self.sent = sent.len();
        self.survivors = Some(match self.survivors.take() {
            Some(former) => sent.iter().map(|&id| former[id as usize]).collect(),
            None => sent,
        });
    }
}

fn name_of(tree: usize) -> &'static str {
    if tree == 0 { "from the start" } else { "from the goal" }
}

/// Keeps the trees or the roadmap that a run grows, for [`SceneFile`]: a watch of a run. It changes nothing of the result.
///
/// ```
/// use mp_plan::{Cancel, Control, Request, Scene};
/// use mp_view::{GrownTrees, SceneFile};
/// let (scene, request) = (Scene::find("easy")?, Request::new("rrt-connect").seed(7));
/// let mut grown = GrownTrees::new(&scene, &request);
/// let report = scene.plan_with(&request, &mut Control::new(Cancel::default(), &mut grown))?;
/// let mut file = SceneFile::of(&scene)?;
/// grown.add_to(&mut file);
/// assert_eq!(file.trees.iter().map(|tree| tree.parents.len()).sum::<usize>(), report.nodes);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct GrownTrees {
    growth: Growth,
    roadmap: Option<GrownRoadmap>,
}

impl GrownTrees {
    /// For one run of `request` in `scene`.
    #[must_use]
    pub fn new(scene: &Scene, request: &Request) -> Self {
        let origin = SceneFile::for_file(scene).map(|file| file.origin).unwrap_or_default();
        Self { growth: Growth::new(scene.clone(), origin, request), roadmap: None }
    }

    /// Adds what the run has grown to a file of its scene.
    pub fn add_to(self, file: &mut SceneFile) {
        let Self { mut growth, roadmap } = self;
        let shift = growth.origin - Vector3::from(file.origin);
        growth.origin = file.origin.into();
        if shift != Vector3::zeros() {
            let lists =
                growth.trees.iter_mut().flat_map(|tree| tree.bends.values_mut().chain([&mut tree.nodes]));
            lists.for_each(|list| {
                list.iter_mut().zip(shift.iter().cycle()).for_each(|(x, by)| *x += *by as f32)
            });
        }
        file.roadmap = roadmap.map(|map| growth.drawn(map));
        let trees = growth.trees.into_iter().enumerate().filter(|(_, tree)| !tree.parents.is_empty());
        file.trees.extend(trees.map(|(i, tree)| Tree {
            name: name_of(i).to_owned(),
            bends: tree.bends_of(0..tree.parents.len()),
            nodes: tree.nodes,
            parents: tree.parents,
        }));
    }
}

impl Watch for GrownTrees {
    fn wants_events(&self) -> bool {
        !self.growth.roadmap
    }
    fn event(&mut self, event: SearchEvent<'_>) {
        if !matches!(event, SearchEvent::Blocked { .. }) {
            self.growth.note(&event);
        }
    }
    fn wants_roadmap(&self) -> bool {
        self.growth.roadmap
    }
    fn roadmap(&mut self, roadmap: GrownRoadmap) {
        self.roadmap = Some(roadmap);
    }
}

/// What a node of a roadmap is, as in [`Roadmap`].
fn number_of_kind(name: &str) -> u8 {
    match name {
        "plain" => 0,
        "guard" => 1,
        "connection" => 2,
        _ => 3,
    }
}

/// A node as a parent.
fn number(id: NodeId) -> i32 {
    i32::try_from(id).unwrap_or(i32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A page that does what events say has the same tree, whenever it takes them.
    #[test]
    fn joined_events_give_the_same_tree() {
        for period in [1, 2, 3, 7, 100] {
            let mut tree = GrowingTree::default();
            let (mut page, mut taken) = (Vec::<i32>::new(), 0);
            // Each node's edge bends at points that say the step in which it was made.
            let mut bends = BTreeMap::new();
            for step in 0..60_usize {
                match step % 6 {
                    4 => {
                        let id = tree.parents.len() / 2;
                        tree.rewire(id, (id / 2) as i32 - 1);
                        tree.bend(id, vec![step as f32; 3 * (step % 3)]);
                    }
                    5 => {
                        // One of the last leaves is removed.
                        let leaf = |id: &usize| !tree.parents.contains(&(*id as i32));
                        let gone = (0..tree.parents.len()).rev().filter(leaf).nth(step % 3);
                        let rest = (0..tree.parents.len()).filter(|id| Some(*id) != gone);
                        let survivors: Vec<NodeId> = rest.map(|id| id as NodeId).collect();
                        tree.prune(&survivors);
                    }
                    _ => {
                        let id = tree.parents.len();
                        tree.nodes.extend([step as f32; 3]);
                        tree.parents.push(id as i32 - 1 - (step % 3).min(id) as i32);
                        tree.bend(id, vec![step as f32; 3 * (step % 4)]);
                    }
                }
                if step % period == 0 {
                    taken += 1;
                    if let Some(survivors) = tree.survivors.take() {
                        let new = |parent: i32| {
                            survivors.iter().position(|&s| s as i32 == parent).map_or(-1, |p| p as i32)
                        };
                        page = survivors.iter().map(|&s| new(page[s as usize])).collect();
                        let kept = survivors.iter().enumerate();
                        bends = kept.filter_map(|(i, &s)| Some((i, bends.remove(&(s as usize))?))).collect();
                    }
                    let mut bend = |told: Bends| {
                        let mut points = told.through.as_slice();
                        for [node, count] in told.nodes.as_chunks::<2>().0 {
                            let (own, rest) = points.split_at(3 * *count as usize);
                            bends.insert(*node as usize, own.to_vec());
                            points = rest;
                        }
                    };
                    bend(tree.bends_of(tree.sent..tree.parents.len()));
                    page.extend(&tree.parents[tree.sent..]);
                    let changed = std::mem::take(&mut tree.rewired);
                    bend(tree.bends_of(changed.clone()));
                    let straight = |id: &&usize| !tree.bends.contains_key(id);
                    changed.iter().filter(straight).for_each(|id| drop(bends.remove(id)));
                    for id in changed {
                        page[id] = tree.parents[id];
                    }
                    tree.sent = tree.parents.len();
                    assert_eq!(page, tree.parents, "period {period}, step {step}");
                    assert_eq!(bends, tree.bends, "period {period}, step {step}");
                }
            }
            assert!(taken > 0);
        }
    }
}
