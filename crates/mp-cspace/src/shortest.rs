//! The shortest simple paths of a directed graph, and alternative paths through given nodes.

use crate::Interrupt;
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

/// A length with a total order.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Length(f64);

impl Eq for Length {}
impl Ord for Length {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}
impl PartialOrd for Length {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// The `k` shortest simple paths (which visit no node twice) between two nodes: their lengths and nodes,
/// the shortest first, ties by nodes. `arcs[i]` lists the ends and lengths, not negative, of the arcs
/// that leave node `i`, at most one to each node.
///
/// J. Y. Yen, *Finding the k shortest loopless paths in a network*, Management Science 17, 1971. One
/// search (Dijkstra 1959) for each node of each path found.
pub fn shortest_paths(
    arcs: &[Vec<(u32, f64)>],
    from: u32,
    to: u32,
    k: usize,
    interrupt: &Interrupt,
) -> Vec<(f64, Vec<u32>)> {
    let mut interrupt = interrupt.clone();
    let mut found: Vec<(Length, Vec<u32>)> = Vec::new();
    let mut candidates: BTreeSet<_> = shortest(arcs, &[from], to, &[]).into_iter().collect();
    while found.len() < k {
        let Some(next) = candidates.pop_first() else { break };
        found.push(next.clone());
        for end in 1..next.1.len() {
            if interrupt.ask() {
                break;
            }
            let root = &next.1[..end];
            let taken: Vec<u32> =
                found.iter().filter(|(_, path)| path.starts_with(root)).map(|(_, path)| path[end]).collect();
            candidates.extend(shortest(arcs, root, to, &taken));
        }
    }
    found.into_iter().map(|(length, path)| (length.0, path)).collect()
}

/// The shortest path that begins with the nodes `root` and then visits none of `taken` next.
fn shortest(arcs: &[Vec<(u32, f64)>], root: &[u32], to: u32, taken: &[u32]) -> Option<(Length, Vec<u32>)> {
    let (&spur, before) = root.split_last()?;
    // Lengths are summed from the start, so that the same path always has the same length.
    let mut length = 0.0;
    for pair in root.windows(2) {
        length += arcs[pair[0] as usize].iter().find(|arc| arc.0 == pair[1])?.1;
    }
    let mut best = vec![f64::INFINITY; arcs.len()];
    let mut parents = vec![spur; arcs.len()];
    for &node in before {
        best[node as usize] = f64::NEG_INFINITY;
    }
    best[spur as usize] = length;
    let mut queue = BinaryHeap::from([Reverse((Length(length), spur))]);
    while let Some(Reverse((Length(length), at))) = queue.pop() {
        if at == to {
            let backward = std::iter::successors(Some(at), |&at| (at != spur).then(|| parents[at as usize]));
            let mut path: Vec<u32> = backward.collect();
            path.extend(before.iter().rev());
            path.reverse();
            return Some((Length(length), path));
        }
        if length > best[at as usize] {
            continue;
        }
        for &(next, arc) in &arcs[at as usize] {
            if length + arc < best[next as usize] && !(at == spur && taken.contains(&next)) {
                best[next as usize] = length + arc;
                parents[next as usize] = at;
                queue.push(Reverse((Length(length + arc), next)));
            }
        }
    }
    None
}

/// The shortest path through one of the nodes `via`: a shortest path to it, then a shortest path from it to
/// the end. It visits no node twice and makes no detour: the part from `window` before the node to `window`
/// behind it is a shortest path. Ties by node. Arcs as in [`shortest_paths`]. Two searches, and one for each
/// path tried.
///
/// I. Abraham, D. Delling, A. V. Goldberg and R. F. Werneck, *Alternative routes in road networks*, ACM
/// J. of Experimental Algorithmics 18, 2013.
pub fn shortest_via(
    arcs: &[Vec<(u32, f64)>],
    [from, to]: [u32; 2],
    window: f64,
    via: impl Iterator<Item = u32>,
    interrupt: &Interrupt,
) -> Option<(f64, Vec<u32>)> {
    let mut reversed = vec![Vec::new(); arcs.len()];
    for (node, leaving) in (0..).zip(arcs) {
        leaving.iter().for_each(|&(next, length)| reversed[next as usize].push((node, length)));
    }
    let (from_start, to_end) = (lengths(arcs, from), lengths(&reversed, to));
    let mut candidates: Vec<(Length, u32)> =
        via.map(|node| (Length(from_start[node as usize].0 + to_end[node as usize].0), node)).collect();
    candidates.retain(|(length, _)| length.0.is_finite());
    candidates.sort_unstable();
    let mut interrupt = interrupt.clone();
    candidates.into_iter().take_while(|_| !interrupt.ask()).find_map(|(length, node)| {
        let path_in = |tree: &[(f64, u32)], end| {
            let next = |at: &u32| (*at != end).then(|| tree[*at as usize].1);
            std::iter::successors(Some(node), next).collect::<Vec<u32>>()
        };
        let mut path = path_in(&from_start, from);
        path.reverse();
        path.extend(&path_in(&to_end, to)[1..]);
        let distinct: BTreeSet<u32> = path.iter().copied().collect();
        if distinct.len() < path.len() {
            return None;
        }
        let before = |at: &u32| from_start[node as usize].0 - from_start[*at as usize].0;
        let behind = |at: &u32| to_end[node as usize].0 - to_end[*at as usize].0;
        let middle = path.iter().position(|at| *at == node)?;
        let first = path[..=middle].iter().rev().find(|at| before(at) >= window).unwrap_or(&from);
        let last = path[middle..].iter().find(|at| behind(at) >= window).unwrap_or(&to);
        let part = before(first) + behind(last);
        let is_shortest = lengths(arcs, *first)[*last as usize].0 >= part * (1.0 - 1e-9);
        is_shortest.then_some((length.0, path))
    })
}

/// The length of the shortest path to each node (Dijkstra), and the node before it on that path.
fn lengths(arcs: &[Vec<(u32, f64)>], from: u32) -> Vec<(f64, u32)> {
    let mut best = vec![(f64::INFINITY, from); arcs.len()];
    best[from as usize].0 = 0.0;
    let mut queue = BinaryHeap::from([Reverse((Length(0.0), from))]);
    while let Some(Reverse((Length(length), at))) = queue.pop() {
        if length > best[at as usize].0 {
            continue;
        }
        for &(next, arc) in &arcs[at as usize] {
            if length + arc < best[next as usize].0 {
                best[next as usize] = (length + arc, at);
                queue.push(Reverse((Length(length + arc), next)));
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From 0 to 4: through 1, or through 2 and 3. A detour leads from 2 to 3 through 5.
    #[test]
    fn detours_are_refused() {
        let mut arcs = vec![Vec::new(); 6];
        for (a, b, length) in [(0, 1, 1.0), (1, 4, 1.0), (0, 2, 2.0), (2, 3, 2.0), (3, 4, 2.0)] {
            arcs[a].push((b, length));
        }
        arcs[2].push((5, 1.5));
        arcs[5].push((3, 1.5));
        let via = |node, window| shortest_via(&arcs, [0, 4], window, [node].into_iter(), &Interrupt::never());
        assert_eq!(via(2, 1.0), Some((6.0, vec![0, 2, 3, 4])));
        assert_eq!(via(5, 0.0), Some((7.0, vec![0, 2, 5, 3, 4])));
        assert_eq!(via(5, 1.0), None);
        assert_eq!(via(2, 10.0), None);
    }

    /// All simple paths, by exhaustive search.
    fn all(
        arcs: &[Vec<(u32, f64)>],
        to: u32,
        path: &mut Vec<u32>,
        length: f64,
        out: &mut Vec<(f64, Vec<u32>)>,
    ) {
        let at = path[path.len() - 1];
        if at == to {
            return out.push((length, path.clone()));
        }
        for &(next, more) in &arcs[at as usize] {
            if !path.contains(&next) {
                path.push(next);
                all(arcs, to, path, length + more, out);
                path.pop();
            }
        }
    }

    #[test]
    fn agrees_with_exhaustive_search() {
        let mut seed = 1_u32;
        let mut pick = |n: u32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) % n
        };
        let mut most = 0;
        for _ in 0..300 {
            let n = 2 + pick(6);
            let mut arcs = vec![Vec::new(); n as usize];
            for a in 0..n {
                for b in 0..n {
                    if a != b && pick(2) == 0 {
                        // Quarters: sums are exact, and ties are many.
                        arcs[a as usize].push((b, f64::from(pick(8)) / 4.0));
                    }
                }
            }
            let mut expected = Vec::new();
            all(&arcs, n - 1, &mut vec![0], 0.0, &mut expected);
            expected.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            most = most.max(expected.len());
            let found = shortest_paths(&arcs, 0, n - 1, usize::MAX, &Interrupt::never());
            assert!(found.is_sorted_by(|a, b| a.0 <= b.0));
            let mut sorted = found.clone();
            sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            assert_eq!(sorted, expected, "{arcs:?}");
            for node in 0..n {
                let via = shortest_via(&arcs, [0, n - 1], 0.0, [node].into_iter(), &Interrupt::never());
                if let Some(path) = &via {
                    assert!(expected.contains(path) && path.1.contains(&node));
                }
                let best = expected.first().filter(|path| path.1.contains(&node));
                assert!(best.is_none_or(|best| via.is_none_or(|via| via.0 == best.0)));
            }
            let any = shortest_via(&arcs, [0, n - 1], f64::INFINITY, 0..n, &Interrupt::never());
            assert_eq!(any.map(|path| path.0), expected.first().map(|path| path.0));
            for k in [0, 1, 3] {
                let few = shortest_paths(&arcs, 0, n - 1, k, &Interrupt::never());
                assert_eq!(few, found[..k.min(found.len())]);
            }
        }
        assert!(most > 50, "at most {most} paths");
    }
}
