//! The outline of the occupied squares of a grid map.

use super::{Polygon, PolygonError};
use mp_stop::Interrupt;
use nalgebra::Point2;

/// The polygon of the occupied squares of a map of `width` × `height` squares with sides of `size` metres,
/// whose lower left corner is at `origin`: `occupied(column, row)`, rows counted upward. `None` when none is.
///
/// Rings run along the sides of squares, with one edge for each straight stretch; where two squares touch at
/// a corner only, rings touch. O(width · height).
///
/// # Errors
/// When a coordinate is not finite or beyond 10⁶⁰, or `interrupt` says to end.
pub fn outline(
    [width, height]: [usize; 2],
    size: f64,
    origin: [f64; 2],
    occupied: impl Fn(usize, usize) -> bool,
    interrupt: &Interrupt,
) -> Result<Option<Polygon>, PolygonError> {
    let mut interrupt = interrupt.clone();
    // Lines between squares: east[y·(width+1) + x] is the side from corner (x, y) to (x+1, y), when the
    // squares below and above it differ; `north` likewise for sides from (x, y) to (x, y+1).
    let at = |x: usize, y: usize| y * (width + 1) + x;
    let inside = |x: usize, y: usize| x < width && y < height && occupied(x, y);
    let mut east = vec![false; (width + 1) * (height + 1)];
    let mut north = east.clone();
    for y in 0..=height {
        if interrupt.ask() {
            return Err(PolygonError::Interrupted);
        }
        for x in 0..=width {
            let here = inside(x, y);
            // Squares outside of the map are free, as are indices that wrap below zero.
            east[at(x, y)] = here != inside(x, y.wrapping_sub(1));
            north[at(x, y)] = here != inside(x.wrapping_sub(1), y);
        }
    }
    let corner = |x: usize, y: usize| Point2::new(origin[0] + size * x as f64, origin[1] + size * y as f64);
    let mut rings = Vec::new();
    for y in 0..=height {
        if interrupt.ask() {
            return Err(PolygonError::Interrupted);
        }
        for x in 0..=width {
            if !east[at(x, y)] {
                continue;
            }
            let ring = follow((x, y), (width, height), at, &mut east, &mut north);
            rings.push(ring.into_iter().map(|(x, y)| corner(x, y)).collect());
        }
    }
    if rings.is_empty() { Ok(None) } else { Polygon::new(rings).map(Some) }
}

/// The corners of a ring that begins with the side east of `start`; its sides are removed from `east` and
/// `north`.
fn follow(
    start: (usize, usize),
    (width, height): (usize, usize),
    at: impl Fn(usize, usize) -> usize,
    east: &mut [bool],
    north: &mut [bool],
) -> Vec<(usize, usize)> {
    let mut ring = Vec::new();
    let (mut x, mut y) = start;
    // 0 east, 1 north, 2 west, 3 south.
    let mut heading = 4;
    loop {
        // Every corner has an even number of sides, so the ring continues until it is closed. By the even-odd
        // rule either turn is right where four sides meet.
        let next = [0, 1, 2, 3].into_iter().find(|&way| {
            let side = match way {
                0 => (x < width).then(|| &mut east[at(x, y)]),
                1 => (y < height).then(|| &mut north[at(x, y)]),
                2 => (x > 0).then(|| &mut east[at(x - 1, y)]),
                _ => (y > 0).then(|| &mut north[at(x, y - 1)]),
            };
            side.is_some_and(std::mem::take)
        });
        let Some(way) = next else { return ring };
        if way != heading {
            ring.push((x, y));
            heading = way;
        }
        match way {
            0 => x += 1,
            1 => y += 1,
            2 => x -= 1,
            _ => y -= 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn holds_the_occupied_squares(map in prop::collection::vec(prop::collection::vec(any::<bool>(), 7), 1..9)) {
            let size = [7, map.len()];
            let polygon = outline(size, 0.5, [-1.0, 2.0], |x, y| map[y][x], &Interrupt::never()).unwrap();
            let count = map.iter().flatten().filter(|o| **o).count();
            prop_assert_eq!(polygon.is_some(), count > 0);
            if let Some(polygon) = polygon {
                for (y, row) in map.iter().enumerate() {
                    for (x, occupied) in row.iter().enumerate() {
                        let p = Point2::new(-0.75 + 0.5 * x as f64, 2.25 + 0.5 * y as f64);
                        prop_assert_eq!(polygon.contains(&p), *occupied);
                    }
                }
            }
        }
    }

    #[test]
    fn straight_stretches_are_one_edge() {
        let bar = outline([9, 3], 1.0, [0.0, 0.0], |_, y| y == 1, &Interrupt::never()).unwrap().unwrap();
        assert_eq!(bar.edges().count(), 4);
        assert_eq!(bar.area(), 9.0);
        let ring =
            outline([5, 5], 1.0, [0.0, 0.0], |x, y| x != 2 || y != 2, &Interrupt::never()).unwrap().unwrap();
        assert_eq!((ring.rings().len(), ring.area()), (2, 24.0));
    }
}
