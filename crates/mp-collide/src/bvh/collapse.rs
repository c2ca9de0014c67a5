//! From two children to eight: dynamic programming over the binary tree.

use crate::bvh::WIDTH;
use crate::bvh::split::BinaryNode;

/// The cheapest forest under a binary node with at most k + 1 roots, for k in 0..8: what it costs, and how
/// many roots go left (0: the node itself is the root).
pub(crate) struct Choice {
    cost: [f32; WIDTH],
    left: [u8; WIDTH],
    /// How many of the eight children of a node made here go left.
    node_left: u8,
}

/// From the leaves up: where to make nodes of eight so that queries are expected to test the fewest boxes
/// (the chance that a box is reached is proportional to its surface).
pub(crate) fn choose(binary: &[BinaryNode]) -> Vec<Choice> {
    let mut choices: Vec<Choice> = Vec::with_capacity(binary.len());
    choices.resize_with(binary.len(), || Choice { cost: [0.0; WIDTH], left: [0; WIDTH], node_left: 1 });
    for n in (0..binary.len()).rev() {
        let b = &binary[n];
        if b.children() == 0 {
            choices[n].cost = [b.surface; WIDTH];
            continue;
        }
        let (l, r) = (b.children(), b.children() + 1);
        // The cheapest division of k + 1 roots, k ≥ 1, between the children; where all costs have overflowed,
        // some division.
        let mut divided = [(f32::INFINITY, 1u8); WIDTH + 1];
        for (k, best) in divided.iter_mut().enumerate().skip(1).take(WIDTH - 1) {
            for left in 0..k {
                let cost = choices[l].cost[left] + choices[r].cost[k - 1 - left];
                if cost < best.0 {
                    *best = (cost, left as u8 + 1);
                }
            }
        }
        let c = &mut choices[n];
        c.node_left = divided[WIDTH - 1].1;
        c.cost[0] = b.surface + divided[WIDTH - 1].0;
        for k in 1..WIDTH {
            (c.cost[k], c.left[k]) =
                if divided[k].0 < c.cost[k - 1] { divided[k] } else { (c.cost[k - 1], c.left[k - 1]) };
        }
    }
    choices
}

/// The children of a wide node made at binary node `n`.
pub(crate) fn children(binary: &[BinaryNode], choices: &[Choice], n: usize) -> Vec<usize> {
    let mut roots = Vec::with_capacity(WIDTH);
    let left = usize::from(choices[n].node_left);
    forest(binary, choices, binary[n].children(), left, &mut roots);
    forest(binary, choices, binary[n].children() + 1, WIDTH - left, &mut roots);
    roots
}

/// The roots of the cheapest forest under `n` with at most `k` roots.
fn forest(binary: &[BinaryNode], choices: &[Choice], n: usize, k: usize, roots: &mut Vec<usize>) {
    // The least number of roots that reaches this cost.
    let c = &choices[n];
    let mut k = k;
    while k > 1 && c.cost[k - 2] <= c.cost[k - 1] {
        k -= 1;
    }
    let left = usize::from(c.left[k - 1]);
    if binary[n].children() == 0 || k == 1 || left == 0 {
        roots.push(n);
        return;
    }
    forest(binary, choices, binary[n].children(), left, roots);
    forest(binary, choices, binary[n].children() + 1, k - left, roots);
}
