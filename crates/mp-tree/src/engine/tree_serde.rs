//! Trees serialized and deserialized by serde.

use super::tree::Tree;
use mp_cspace::{Direction, NodeId};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

/// The serialized form of a tree, without what can be computed from it.
#[derive(Serialize, Deserialize)]
struct Written<S, L> {
    direction: Direction,
    states: Vec<S>,
    /// One for each state; `None` of a root.
    links: Vec<Option<L>>,
}

#[derive(Serialize, Deserialize)]
struct Link<E> {
    parent: NodeId,
    edge: E,
    cost: f64,
}

/// An object with the members `direction`, `states` and `links`; a link has `parent`, `edge` and `cost`, and
/// is null for roots. Which edges are verified is not serialized.
impl<S: Serialize, E: Serialize> Serialize for Tree<S, E> {
    fn serialize<Z: Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        let link = |id| {
            let (parent, edge, cost) = (self.parent(id)?, self.edge(id)?, self.edge_cost(id)?);
            Some(Link { parent, edge, cost })
        };
        let links = (0..self.len() as NodeId).map(link).collect();
        Written { direction: self.direction(), states: self.states().iter().collect(), links }
            .serialize(serializer)
    }
}

/// Refuses what is not a tree: a parent that does not exist, a cycle, a cost that is negative or not finite.
/// No edge counts as verified. The children of a node are in the order of their ids.
impl<'de, S: Deserialize<'de>, E: Deserialize<'de>> Deserialize<'de> for Tree<S, E> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let written: Written<S, Link<E>> = Written::deserialize(deserializer)?;
        tree(written).map_err(D::Error::custom)
    }
}

fn tree<S, E>(Written { direction, states, links }: Written<S, Link<E>>) -> Result<Tree<S, E>, String> {
    let n = states.len();
    if links.len() != n {
        return Err(format!("a tree of {n} states has {} links", links.len()));
    }
    let fault = links.iter().enumerate().find_map(|(id, link)| match link {
        Some(link) if link.parent as usize >= n => {
            Some(format!("the parent of node {id}, {}, does not exist", link.parent))
        }
        Some(link) if !(link.cost >= 0.0 && link.cost < f64::INFINITY) => {
            Some(format!("the edge of node {id} costs {}", link.cost))
        }
        _ => None,
    });
    if let Some(fault) = fault {
        return Err(fault);
    }
    let links = links.into_iter().map(|link| link.map(|l| (l.parent, l.edge, l.cost))).collect();
    Tree::from_links(direction, states, links).map_err(|id| format!("node {id} is its own ancestor"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_cspace::Motion;

    fn read(text: &str) -> Result<Tree<i32, i32>, String> {
        serde_json::from_str(text).map_err(|e| e.to_string())
    }

    #[test]
    fn trees_are_read_back() {
        let mut tree = Tree::new(Direction::Backward);
        let root = tree.add_root(9);
        let a = tree.push(root, Motion { end: 5, edge: 4, cost: 4.5 });
        let b = tree.push(root, Motion { end: 3, edge: 6, cost: 6.0 });
        let c = tree.push(a, Motion { end: 1, edge: 4, cost: 4.0 });
        // A parent younger than its child.
        assert!(tree.reparent(a, b, 2, 2.0));
        tree.set_verified(c);
        let text = serde_json::to_string(&tree).unwrap();
        let back = read(&text).unwrap();
        assert_eq!(serde_json::to_string(&back).unwrap(), text);
        for id in 0..4 {
            assert_eq!((back.cost(id), back.state(id)), (tree.cost(id), tree.state(id)));
            let ids = |tree: &Tree<i32, i32>| tree.children(id).collect::<std::collections::BTreeSet<_>>();
            assert_eq!(ids(&back), ids(&tree));
        }
        assert_eq!(back.path(c), tree.path(c));
        assert!(!back.is_verified(c) && back.is_verified(root));
    }

    #[test]
    fn what_is_no_tree_is_refused() {
        let links =
            |links: &str| format!(r#"{{"direction": "forward", "states": [1, 2, 3], "links": [{links}]}}"#);
        let link = |parent: u32, cost: f64| format!(r#"{{"parent": {parent}, "edge": 0, "cost": {cost}}}"#);
        assert_eq!(read(&links("null, null, null")).unwrap().len(), 3);
        for (bad, why) in [
            ("null, null".to_owned(), "a tree of 3 states has 2 links"),
            (format!("null, null, {}", link(3, 1.0)), "the parent of node 2, 3, does not exist"),
            (format!("null, null, {}", link(0, -1.0)), "the edge of node 2 costs -1"),
            (format!("null, {}, {}", link(2, 1.0), link(1, 1.0)), "is its own ancestor"),
            (format!("{}, null, null", link(0, 1.0)), "node 0 is its own ancestor"),
        ] {
            let error = read(&links(&bad)).unwrap_err();
            assert!(error.contains(why), "{error}");
        }
    }

    /// A chain as deep as it is long is read in linear time.
    #[test]
    fn deep_trees_are_read() {
        let mut tree = Tree::new(Direction::Forward);
        let mut last = tree.add_root(0);
        for i in 1..200_000 {
            last = tree.push(last, Motion { end: i, edge: i, cost: 1.0 });
        }
        let back = read(&serde_json::to_string(&tree).unwrap()).unwrap();
        assert_eq!((back.cost(last), back.lineage(last).count()), (199_999.0, 200_000));
    }
}
