//! Agreement of nearest-neighbour indexes with the linear scan.

use crate::{Hit, NearestNeighbors, NodeId, Rng, Space};
use rand::RngExt;

/// Checks a [`NearestNeighbors`] index against a linear scan written here: `nearest`, `k_nearest`
/// and `within` give the same ids and the same distances, to the bit, while `points` states are
/// inserted (some of them twice, so that distances tie), and again after a `clear`.
///
/// # Panics
/// When an answer differs, naming the query.
pub fn check_nearest_neighbors<C, N>(space: &C, index: &mut N, points: usize, seed: u64)
where
    C: Space,
    N: NearestNeighbors<C>,
{
    agree(space, index, points, seed);
}

/// As [`check_nearest_neighbors`]; each method of the index is compiled once.
fn agree<C: Space>(space: &C, index: &mut dyn NearestNeighbors<C>, points: usize, seed: u64) {
    let mut rng = Rng::seed(seed);
    for round in 0..2 {
        index.clear();
        let mut states: Vec<C::State> = Vec::with_capacity(points);
        compare(space, index, &states, &mut rng);
        while states.len() < points {
            let again = !states.is_empty() && rng.random_range(0..8) == 0;
            let q = if again {
                states[rng.random_range(0..states.len())].clone()
            } else {
                space.sample_uniform(&mut rng)
            };
            states.push(q);
            index.inserted(space, &states, (states.len() - 1) as NodeId);
            let n = states.len();
            if n < 20 || n.is_power_of_two() || n == points || rng.random_range(0..1 + n / 4) == 0 {
                compare(space, index, &states, &mut rng);
            }
        }
        if round == 0 {
            index.clear();
            let q = space.sample_uniform(&mut rng);
            let left = index.nearest(space, &[], &q);
            assert!(left.is_none(), "nearest neighbours: nothing is found after clear, violated by {left:?}");
        }
    }
}

/// All hits in order.
fn scan<C: Space>(space: &C, states: &[C::State], q: &C::State) -> Vec<Hit> {
    let mut hits: Vec<Hit> =
        (0..).zip(states).map(|(id, p)| Hit { id, distance: space.distance(p, q) }).collect();
    hits.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.id.cmp(&b.id)));
    hits
}

fn compare<C: Space>(space: &C, index: &dyn NearestNeighbors<C>, states: &[C::State], rng: &mut Rng) {
    let n = states.len();
    for query in 0..3 {
        // A state in the index has itself and equal states at distance zero.
        let q = if query == 0 && n > 0 {
            states[rng.random_range(0..n)].clone()
        } else {
            space.sample_uniform(rng)
        };
        let all = scan(space, states, &q);
        let case = format!("among {n} points, query {q:?}");
        let nearest = index.nearest(space, states, &q);
        assert!(
            nearest.as_ref() == all.first(),
            "nearest neighbours: nearest agrees with the scan, violated {case}: {nearest:?}, expected {:?}",
            all.first()
        );
        let mut out = vec![Hit { id: 0, distance: -1.0 }];
        for k in [0, 1, 2, 7, n, n + 3] {
            index.k_nearest(space, states, &q, k, &mut out);
            same(&out, &all[..k.min(n)], &format!("{k} nearest {case}"));
        }
        let some = all.get(rng.random_range(0..1 + n / 2)).map_or(0.0, |hit| hit.distance);
        for radius in [0.0, some, 0.1 * space.extent(), 2.0 * space.extent()] {
            index.within(space, states, &q, radius, &mut out);
            let inside = all.iter().take_while(|hit| hit.distance <= radius).count();
            same(&out, &all[..inside], &format!("within {radius} {case}"));
        }
    }
}

fn same(found: &[Hit], expected: &[Hit], what: &str) {
    if found == expected {
        return;
    }
    let first =
        found.iter().zip(expected).position(|(a, b)| a != b).unwrap_or(found.len().min(expected.len()));
    panic!(
        "nearest neighbours: {what} agrees with the scan, violated: {} hits, expected {}; hit {first} is {:?}, expected {:?}",
        found.len(),
        expected.len(),
        found.get(first),
        expected.get(first)
    );
}
