//! The search for a free configuration near one that is not free.

use mp_cspace::Space;

/// How often the interval between the given and the found configuration is halved.
const HALVINGS: usize = 24;

/// The shells of a search: configurations around a centre, farther away in each shell than in the last.
pub(crate) struct Shells {
    /// The radius of the first shell.
    pub(crate) first: f64,
    /// How many times as large each shell is as the last.
    pub(crate) growth: f64,
    /// How many shells there are at most. The search also ends beyond the extent of the space.
    pub(crate) most: usize,
}

/// `q` itself if it `suits`, else a configuration that does: the nearest of the `candidates` of the innermost shell that
/// has any, moved back toward `q` as far as possible. `candidates` is given the index and the radius of a shell.
pub(crate) fn search_shells<C: Space>(
    space: &C,
    q: &C::State,
    shells: &Shells,
    mut candidates: impl FnMut(usize, f64) -> Vec<C::State>,
    mut suits: impl FnMut(&C::State) -> bool,
) -> Option<C::State> {
    if suits(q) {
        return Some(q.clone());
    }
    let mut radius = shells.first;
    for shell in 0..shells.most {
        let mut best: Option<(f64, C::State)> = None;
        for p in candidates(shell, radius) {
            let distance = space.distance(q, &p);
            if best.as_ref().is_none_or(|(d, _)| distance < *d) && suits(&p) {
                best = Some((distance, p));
            }
        }
        if let Some((_, found)) = best {
            return Some(moved_back(space, q, found, suits));
        }
        if radius > space.extent() {
            return None;
        }
        radius *= shells.growth;
    }
    None
}

/// The configuration nearest to `q` on the motion from `q` to `found` that suits, by bisection.
fn moved_back<C: Space>(
    space: &C,
    q: &C::State,
    found: C::State,
    mut suits: impl FnMut(&C::State) -> bool,
) -> C::State {
    let (mut free, mut hit, mut best) = (1.0, 0.0, found.clone());
    for _ in 0..HALVINGS {
        let middle = 0.5 * (free + hit);
        let p = space.interpolate(q, &found, middle);
        if suits(&p) {
            (free, best) = (middle, p);
        } else {
            hit = middle;
        }
    }
    best
}
