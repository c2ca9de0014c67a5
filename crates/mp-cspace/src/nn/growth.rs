//! The growth of a tree without obstacles: the benchmark of nearest-neighbour indexes.

use super::{NearestNeighbors, NodeId};
use crate::{Rng, Space};

/// Grows a rapidly-exploring random tree from `start` (LaValle 1998, *Rapidly-exploring random trees*) when
/// every motion is free: sample, find the nearest node, step toward the sample, insert.
///
/// `at` is called whenever the tree reaches the next of the ascending `sizes`; it may read a clock.
/// Returns the nodes.
pub fn grow<C: Space, N: NearestNeighbors<C>>(
    space: &C,
    index: &mut N,
    start: C::State,
    step: f64,
    rng: &mut Rng,
    sizes: &[usize],
    mut at: impl FnMut(usize),
) -> Vec<C::State> {
    let mut nodes = vec![start];
    index.clear();
    index.inserted(space, &nodes, 0);
    for &size in sizes {
        while nodes.len() < size {
            let sample = space.sample_uniform(rng);
            let Some(hit) = index.nearest(space, &nodes, &sample) else { return nodes };
            let node = if hit.distance > step {
                space.interpolate(&nodes[hit.id as usize], &sample, step / hit.distance)
            } else {
                sample
            };
            nodes.push(node);
            index.inserted(space, &nodes, (nodes.len() - 1) as NodeId);
        }
        at(size);
    }
    nodes
}
