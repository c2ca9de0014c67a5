//! Several paths merged into one.

use crate::shortest::shortest_paths;
use crate::{Interrupt, MotionValidity, Objective, Path, Space};
use std::collections::HashSet;

/// The cheapest way by `objective` over pieces of `paths` and bridges between them: straight motions from a state of one path to the state of another
/// that is nearest to it, which `check` finds free.
///
/// B. Raveh, A. Enosh and D. Halperin, *A little more, a lot better: improving path quality by a path-merging algorithm*, IEEE Transactions
/// on Robotics 27(2), 2011. Each of several paths is good somewhere; the merged one costs no more than the cheapest of them. Their edges are
/// taken as free, so that few motions are checked: a bridge is asked about when the cheapest way leads over it, and left out if it is
/// not free. (There bridges are those of an alignment of two paths, and all are checked.)
///
/// All paths begin with the same state and may end at different goals. Edges are cut into pieces no longer than `step`, where bridges
/// begin and end. `m` paths of `n` pieces take m²·n² distances and, for each bridge that is not free, a search (Dijkstra 1959). When `check`
/// is [interrupted](MotionValidity::interrupt_by), the cheapest of `paths` is returned; `None` where there is none, or they do not begin
/// with the same state.
///
/// ```
/// use mp_cspace::{Discrete, Length, Path, PathLength, Rn, Space, shorten::hybridized};
/// use nalgebra::Vector2;
/// let space = Rn::<2>::new([0.0, 0.0], [9.0, 6.0])?;
/// // A wall with a gate in the middle.
/// let free = |q: &Vector2<f64>| q.x < 4.0 || q.x > 5.0 || (q.y - 3.0).abs() < 1.0;
/// let mut check = Discrete::new(&space, free, Length::Fraction(0.001))?;
/// let path = |rows: &[[f64; 2]]| Path::straight(rows.iter().map(|p| Vector2::from(*p)).collect());
/// // One goes astray before the gate, the other one behind it.
/// let early = path(&[[0.0, 3.0], [2.0, 6.0], [4.0, 3.2], [9.0, 3.2], [9.0, 3.0]]);
/// let late = path(&[[0.0, 3.0], [0.0, 2.8], [5.0, 2.8], [7.0, 0.0], [9.0, 3.0]]);
/// let both = hybridized(&space, &mut check, &mut PathLength(&space), &[early.clone(), late.clone()], 0.1).ok_or("no path")?;
/// let [early, late, both] = [early, late, both].map(|path| path.length(&space));
/// assert!(early > 12.0 && late > 12.0 && both < 9.8, "{early} {late} {both}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn hybridized<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    objective: &mut impl Objective<C::State>,
    paths: &[Path<C::State>],
    step: f64,
) -> Option<Path<C::State>> {
    let start = paths.first()?.states.first()?;
    if paths.iter().any(|path| path.states.first() != Some(start)) {
        return None;
    }
    // Node 0 is the start of all paths, and the last one the end of all.
    let mut states = vec![start.clone()];
    let rows: Vec<Vec<u32>> = paths.iter().map(|path| pieces(space, path, step, &mut states)).collect();
    let end = states.len() as u32;
    let mut arcs: Vec<Vec<(u32, f64)>> = vec![Vec::new(); states.len() + 1];
    for row in &rows {
        for w in row.windows(2) {
            add(&mut arcs, w[0], w[1], objective.cost(&states[w[0] as usize], &states[w[1] as usize]));
        }
        add(&mut arcs, row[row.len() - 1], end, 0.0);
    }
    let mut unchecked = HashSet::new();
    for (i, from) in rows.iter().enumerate() {
        for to in rows.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, row)| &row[1..]) {
            for &a in from {
                let away = |b: &u32| space.distance(&states[a as usize], &states[*b as usize]);
                let nearest = to.iter().map(|b| (away(b), *b)).min_by(|a, b| a.0.total_cmp(&b.0));
                let Some((_, b)) = nearest.filter(|(_, b)| *b != a) else { continue };
                if add(&mut arcs, a, b, objective.cost(&states[a as usize], &states[b as usize])) {
                    unchecked.insert((a, b));
                }
            }
        }
    }
    loop {
        let (_, nodes) = shortest_paths(&arcs, 0, end, 1, &Interrupt::never()).pop()?;
        let nodes = &nodes[..nodes.len() - 1];
        let mut is_free = |w: &[u32]| {
            let [from, to] = [w[0], w[1]].map(|node| &states[node as usize]);
            let free = !unchecked.contains(&(w[0], w[1])) || check.check_motion(from, to).is_free();
            if free {
                unchecked.remove(&(w[0], w[1]));
            }
            free
        };
        let Some(w) = nodes.windows(2).find(|w| !is_free(w)) else {
            return Some(Path::straight(nodes.iter().map(|n| states[*n as usize].clone()).collect()));
        };
        if check.is_interrupted() {
            let costs = paths.iter().map(|path| (objective.path_cost(path), path));
            return costs.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, path)| path.clone());
        }
        arcs[w[0] as usize].retain(|arc| arc.0 != w[1]);
    }
}

/// Adds an arc, unless there is one. Whether it was added.
fn add(arcs: &mut [Vec<(u32, f64)>], from: u32, to: u32, length: f64) -> bool {
    let leaving = &mut arcs[from as usize];
    let is_new = leaving.iter().all(|arc| arc.0 != to);
    if is_new {
        leaving.push((to, length));
    }
    is_new
}

/// Adds the states of a path but the first, and those between them, no further than `step` from each other. Returns its nodes.
fn pieces<C: Space>(space: &C, path: &Path<C::State>, step: f64, states: &mut Vec<C::State>) -> Vec<u32> {
    let mut nodes = vec![0];
    for w in path.states.windows(2) {
        let count = (space.distance(&w[0], &w[1]) / step).ceil().clamp(1.0, 1e4) as usize;
        for k in 1..=count {
            nodes.push(states.len() as u32);
            states.push(match k == count {
                true => w[1].clone(),
                false => space.interpolate(&w[0], &w[1], k as f64 / count as f64),
            });
        }
    }
    nodes
}
