//! What is inside of what. Only what is closed has an inside: edges in the plane z = 0, or triangles that
//! face outward.

use crate::file::{Body, Part};
use parry3d_f64::math::Vec3;
use std::collections::HashMap;

/// Pieces of a body that enclose an area of the plane z = 0, or a volume.
pub(crate) struct Solid {
    pieces: Vec<Vec<Vec3>>,
    low: Vec3,
    high: Vec3,
}

/// A place, to the last bit.
type Place = [u64; 3];

/// Where a vertex of a body is.
fn place(body: &Body, vertex: usize) -> Place {
    // There are two zeros.
    body.vertices[vertex].map(|x| (x + 0.0).to_bits())
}

/// Whether pieces have no end: a place ends an even number of edges, and the side of a triangle is the side
/// of another one, where it runs the other way.
fn is_closed(body: &Body, pieces: &[Vec<usize>]) -> bool {
    let (mut ends, mut sides) = (HashMap::new(), HashMap::new());
    for piece in pieces {
        let places: Vec<Place> = piece.iter().map(|v| place(body, *v)).collect();
        match *places.as_slice() {
            [a, b] => [a, b].into_iter().for_each(|end| *ends.entry(end).or_insert(0_u64) += 1),
            [a, b, c] => [[a, b], [b, c], [c, a]].into_iter().for_each(|[from, to]| {
                *sides.entry([from.min(to), from.max(to)]).or_insert(0_i64) += from.cmp(&to) as i64;
            }),
            _ => {}
        }
    }
    ends.values().all(|n| n % 2 == 0) && sides.values().all(|n| *n == 0)
}

/// The solids of a body.
///
/// # Errors
/// What is wrong with its parts: a solid that has no inside, or a line that ends somewhere.
pub(crate) fn solids(body: &Body) -> Result<Vec<Solid>, String> {
    let (mut left, mut solids) = (body.pieces.as_slice(), Vec::new());
    for part in &body.parts {
        let (Part::Solid(count) | Part::Surface(count)) = *part;
        let (pieces, rest) = left.split_at_checked(count).ok_or("its parts have more pieces than it has")?;
        left = rest;
        let closed = is_closed(body, pieces);
        let corners = pieces.first().map_or(0, Vec::len);
        if matches!(part, Part::Surface(_)) {
            // Lines in the plane are outlines of areas, also where only the lines count.
            if pieces.is_empty() || (corners == 2 && !closed) {
                return Err("one of its outlines is not closed".to_owned());
            }
            continue;
        }
        if corners < 2 || pieces.iter().any(|piece| piece.len() != corners) || !closed {
            return Err("one of its solids is not closed, and so has no inside".to_owned());
        }
        let corner = |v: &usize| Vec3::from_array(body.vertices[*v]);
        let pieces: Vec<Vec<Vec3>> = pieces.iter().map(|p| p.iter().map(corner).collect()).collect();
        let first = pieces[0][0];
        let volume = |p: &Vec<Vec3>| (p[0] - first).dot((p[1] - first).cross(p[2] - first));
        if corners == 3 && pieces.iter().map(volume).sum::<f64>() <= 0.0 {
            return Err("one of its solids does not face outward".to_owned());
        }
        let all = || pieces.iter().flatten().copied();
        let (low, high) = (all().fold(first, Vec3::min), all().fold(first, Vec3::max));
        solids.push(Solid { pieces, low, high });
    }
    if left.is_empty() { Ok(solids) } else { Err("its parts have fewer pieces than it has".to_owned()) }
}

/// A corner of each connected part of a body: what is apart from a surface all over is on one side of it.
pub(crate) fn witnesses(body: &Body) -> Vec<Vec3> {
    let mut first = HashMap::new();
    let mut above: Vec<usize> =
        (0..body.vertices.len()).map(|v| *first.entry(place(body, v)).or_insert(v)).collect();
    let top = |above: &mut [usize], mut v: usize| {
        while above[v] != v {
            above[v] = above[above[v]];
            v = above[v];
        }
        v
    };
    for pair in body.pieces.iter().flat_map(|piece| piece.windows(2)) {
        let [a, b] = [pair[0], pair[1]].map(|v| top(&mut above, v));
        above[a] = b;
    }
    let mut tops: Vec<usize> = body.pieces.iter().map(|piece| top(&mut above, piece[0])).collect();
    tops.sort_unstable();
    tops.dedup();
    tops.into_iter().map(|v| Vec3::from_array(body.vertices[v])).collect()
}

impl Solid {
    /// Whether a point is inside: edges are crossed an odd number of times on the way to it, triangles fill
    /// more than half of what is seen from it. Not for points within rounding of a piece.
    pub(crate) fn holds(&self, p: Vec3) -> bool {
        if p.min(self.low) != self.low || p.max(self.high) != self.high {
            return false;
        }
        let (mut odd, mut angle) = (false, 0.0);
        for piece in &self.pieces {
            match *piece.as_slice() {
                [a, b] => {
                    let crosses = (a.y > p.y) != (b.y > p.y);
                    odd ^= crosses && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
                }
                [a, b, c] => {
                    let [a, b, c] = [a - p, b - p, c - p];
                    let [l, m, n] = [a, b, c].map(Vec3::length);
                    let below = l * m * n + a.dot(b) * n + b.dot(c) * l + c.dot(a) * m;
                    angle += 2.0 * a.dot(b.cross(c)).atan2(below);
                }
                _ => {}
            }
        }
        odd || angle.abs() > std::f64::consts::TAU
    }
}

#[cfg(test)]
mod tests;
