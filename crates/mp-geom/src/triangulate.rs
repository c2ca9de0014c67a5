//! Planar polygons into triangles by ear clipping.
//!
//! G. H. Meisters, "Polygons have ears", 1975. Orientation tests are exact (J. R. Shewchuk, "Adaptive
//! precision floating-point arithmetic and fast robust geometric predicates", 1997), so collinear runs,
//! needles and large coordinates are decided correctly. The ear with the best-shaped triangle is cut first,
//! which also keeps collinear corners from becoming degenerate triangles.

use nalgebra::{Point2, Point3, Vector3};
use robust::{Coord, orient2d};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Newell's normal of a closed polygon, whose length is twice the area; correct for concave polygons too.
pub(crate) fn newell_normal(corners: &[Point3<f64>]) -> Vector3<f64> {
    // Relative to the first corner, so that no digits are lost far from the origin.
    let Some(origin) = corners.first() else { return Vector3::zeros() };
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(p, q)| (p - origin).cross(&(q - origin))).sum()
}

/// Triangles (indices into `corners`) covering a planar polygon, in its own orientation: always
/// `corners.len() − 2` of them. The polygon may be concave; holes are not handled. A polygon that crosses
/// itself or has no area gets some triangulation of its corners.
pub(crate) fn triangulate(corners: &[Point3<f64>]) -> Vec<[usize; 3]> {
    if corners.len() == 3 {
        return vec![[0, 1, 2]];
    }
    let normal = newell_normal(corners);
    // Dropping the dominant axis keeps coordinates exact.
    let drop = normal.iamax();
    let (mut u, mut v) = ((drop + 1) % 3, (drop + 2) % 3);
    if normal[drop] < 0.0 {
        (u, v) = (v, u);
    }
    let projected: Vec<_> = corners.iter().map(|p| Point2::new(p[u], p[v])).collect();
    triangulate_ccw(&projected)
}

/// How often the whole ring is searched for an ear. A simple polygon always has one, mostly beside the last cut: a
/// polygon that needs more searches crosses itself, and is given up.
const SEARCHES: usize = 16;

/// As [`triangulate`], for a counter-clockwise polygon of the plane. O(n log n) on ordinary polygons, O(n²)
/// on contrived ones.
pub(crate) fn triangulate_ccw(corners: &[Point2<f64>]) -> Vec<[usize; 3]> {
    let mut ring = Ring::new(corners);
    let mut triangles = Vec::with_capacity(corners.len().saturating_sub(2));
    let mut ears: BinaryHeap<Ear> = (0..corners.len()).filter_map(|k| ring.ear(k)).collect();
    let mut searches = 0;
    while ring.left > 3 {
        let ear = loop {
            match ears.pop() {
                Some(ear) if ear.around == ring.around(ear.corner) && ring.alive[ear.corner] => {
                    break Some(ear);
                }
                Some(_) => {}
                None => break None,
            }
        };
        let corner = match ear {
            Some(ear) => ear.corner,
            None if searches == SEARCHES => break,
            // Cutting may have made other corners ears; if not, the polygon is not simple.
            None => {
                searches += 1;
                ears.extend(ring.corners_left().filter_map(|k| ring.ear(k)));
                match ears.peek() {
                    Some(ear) => ear.corner,
                    None => ring.flattest(),
                }
            }
        };
        let cut = ring.around(corner);
        triangles.push(cut);
        ring.cut(corner);
        ears.extend([cut[0], cut[2]].into_iter().filter_map(|k| ring.ear(k)));
    }
    // The rest, mostly one triangle, as a fan.
    if let Some([fixed, mut k, mut after]) = ring.corners_left().next().map(|k| ring.around(k)) {
        for _ in 2..ring.left {
            triangles.push([fixed, k, after]);
            (k, after) = (after, ring.next[after]);
        }
    }
    triangles
}

/// A ring with holes as one ring that goes around all: each hole is joined to it by a bridge to a corner that
/// it sees. `outer` goes counter-clockwise and the holes clockwise, inside it and apart from each other; a
/// hole that sees no corner is left out.
pub(crate) fn bridged(outer: Vec<Point2<f64>>, mut holes: Vec<Vec<Point2<f64>>>) -> Vec<Point2<f64>> {
    let lexical = |p: &Point2<f64>, q: &Point2<f64>| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y));
    // Each hole begins at its rightmost corner, and the rightmost hole comes first: then no later hole is in
    // the way.
    for hole in &mut holes {
        let first = (0..hole.len()).max_by(|&i, &j| lexical(&hole[i], &hole[j])).unwrap_or(0);
        hole.rotate_left(first);
    }
    holes.retain(|hole| hole.len() > 2);
    holes.sort_by(|a, b| lexical(&b[0], &a[0]));
    let mut ring = outer;
    for (n, hole) in holes.iter().enumerate() {
        let from = hole[0];
        let mut seen: Vec<usize> = (0..ring.len()).filter(|&i| lexical(&ring[i], &from).is_gt()).collect();
        seen.sort_by(|&i, &j| (ring[i] - from).norm_squared().total_cmp(&(ring[j] - from).norm_squared()));
        let free = |i: usize| {
            let borders = std::iter::once(&ring).chain(&holes[n..]);
            begins_inside(&ring, i, from)
                && borders.flat_map(|b| sides(b)).all(|s| !cross((ring[i], from), s))
        };
        if let Some(corner) = seen.into_iter().find(|&i| free(i)) {
            let bridge = hole.iter().copied().chain([from, ring[corner]]);
            ring.splice(corner + 1..corner + 1, bridge);
        }
    }
    ring
}

/// The sides of a closed ring.
fn sides(ring: &[Point2<f64>]) -> impl Iterator<Item = (Point2<f64>, Point2<f64>)> + '_ {
    (0..ring.len()).map(|i| (ring[i], ring[(i + 1) % ring.len()]))
}

/// Whether the way from corner `i` of a counter-clockwise ring to `to` begins inside the ring.
fn begins_inside(ring: &[Point2<f64>], i: usize, to: Point2<f64>) -> bool {
    let [before, at, after] = [ring[(i + ring.len() - 1) % ring.len()], ring[i], ring[(i + 1) % ring.len()]];
    let (left_of_first, left_of_second) = (turn([before, at, to]) > 0.0, turn([at, after, to]) > 0.0);
    match turn([before, at, after]) >= 0.0 {
        true => left_of_first && left_of_second,
        false => left_of_first || left_of_second,
    }
}

/// Whether two segments cross at one inner point of both.
fn cross((a, b): (Point2<f64>, Point2<f64>), (c, d): (Point2<f64>, Point2<f64>)) -> bool {
    let apart = |p: f64, q: f64| (p > 0.0 && q < 0.0) || (p < 0.0 && q > 0.0);
    apart(turn([a, b, c]), turn([a, b, d])) && apart(turn([c, d, a]), turn([c, d, b]))
}

/// A corner that can be cut, given its neighbours, and how well shaped its triangle is: area over the
/// longest side squared.
#[derive(PartialEq)]
struct Ear {
    quality: f64,
    corner: usize,
    around: [usize; 3],
}

impl Eq for Ear {}
impl PartialOrd for Ear {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Ear {
    fn cmp(&self, other: &Self) -> Ordering {
        // Of equals, the first corner.
        self.quality.total_cmp(&other.quality).then(other.corner.cmp(&self.corner))
    }
}

/// The rest of a polygon while ears are cut.
struct Ring<'p> {
    corners: &'p [Point2<f64>],
    previous: Vec<usize>,
    next: Vec<usize>,
    alive: Vec<bool>,
    left: usize,
    /// The corners in order of x and of y.
    sorted: [Vec<usize>; 2],
}

impl<'p> Ring<'p> {
    fn new(corners: &'p [Point2<f64>]) -> Self {
        let n = corners.len();
        let sorted = [0, 1].map(|axis| {
            let mut order: Vec<usize> = (0..n).collect();
            order.sort_by(|&i, &j| corners[i][axis].total_cmp(&corners[j][axis]));
            order
        });
        let previous = (0..n).map(|i| (i + n - 1) % n).collect();
        let next = (0..n).map(|i| (i + 1) % n).collect();
        Self { corners, previous, next, alive: vec![true; n], left: n, sorted }
    }

    fn around(&self, k: usize) -> [usize; 3] {
        [self.previous[k], k, self.next[k]]
    }

    fn corners_left(&self) -> impl Iterator<Item = usize> {
        (0..self.alive.len()).filter(|&k| self.alive[k])
    }

    fn cut(&mut self, k: usize) {
        let [before, _, after] = self.around(k);
        (self.next[before], self.previous[after]) = (after, before);
        self.alive[k] = false;
        self.left -= 1;
    }

    /// The corner of a ring without ears to cut: the one whose triangle is flattest.
    fn flattest(&self) -> usize {
        let flatness = |k: usize| turn(self.around(k).map(|i| self.corners[i])).abs();
        self.corners_left().min_by(|&a, &b| flatness(a).total_cmp(&flatness(b))).unwrap_or(0)
    }

    /// Corner `k` as an ear, when it is one: convex, and no other corner in its closed triangle.
    fn ear(&self, k: usize) -> Option<Ear> {
        let around = self.around(k);
        let [a, b, c] = around.map(|i| self.corners[i]);
        let area = turn([a, b, c]);
        if area <= 0.0 {
            return None;
        }
        let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
        // The axis along which fewer corners are within the triangle's range.
        let [in_x, in_y] = [0, 1].map(|axis| {
            let order = &self.sorted[axis];
            let from = order.partition_point(|&i| self.corners[i][axis] < low[axis]);
            let to = order.partition_point(|&i| self.corners[i][axis] <= high[axis]);
            &order[from..to]
        });
        let near = if in_x.len() <= in_y.len() { in_x } else { in_y };
        let blocked = near.iter().any(|&i| {
            let p = self.corners[i];
            self.alive[i]
                && low.x <= p.x
                && p.x <= high.x
                && low.y <= p.y
                && p.y <= high.y
                && p != a
                && p != b
                && p != c
                && turn([a, b, p]) >= 0.0
                && turn([b, c, p]) >= 0.0
                && turn([c, a, p]) >= 0.0
        });
        let longest = (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared());
        (!blocked).then_some(Ear { quality: area / longest, corner: k, around })
    }
}

/// Twice the signed area of a triangle, with the exact sign.
fn turn([a, b, c]: [Point2<f64>; 3]) -> f64 {
    let coord = |p: Point2<f64>| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// Whether the closed polygon is simple: at least three corners, no two equal, and no two sides touch except
/// neighbours at their common corner.
pub(crate) fn is_simple(corners: &[Point2<f64>]) -> bool {
    let n = corners.len();
    let side = |i: usize| (corners[i], corners[(i + 1) % n]);
    n >= 3
        && (0..n).all(|i| {
            let (a, b) = side(i);
            let after = corners[(i + 2) % n];
            // No zero-length side, no turning straight back.
            a != b
                && (turn([a, b, after]) != 0.0 || (b - a).dot(&(after - b)) > 0.0)
                && (i + 2..n).filter(|j| (j + 1) % n != i).all(|j| !sides_touch((a, b), side(j)))
        })
}

fn sides_touch((a, b): (Point2<f64>, Point2<f64>), (c, d): (Point2<f64>, Point2<f64>)) -> bool {
    let sign = |p, q, r| turn([p, q, r]).total_cmp(&0.0) as i8 * i8::from(turn([p, q, r]) != 0.0);
    let within = |p: Point2<f64>, q: Point2<f64>, r: Point2<f64>| {
        let (low, high) = (p.inf(&q), p.sup(&q));
        low.x <= r.x && r.x <= high.x && low.y <= r.y && r.y <= high.y
    };
    let (o1, o2, o3, o4) = (sign(a, b, c), sign(a, b, d), sign(c, d, a), sign(c, d, b));
    (o1 * o2 < 0 && o3 * o4 < 0)
        || (o1 == 0 && within(a, b, c))
        || (o2 == 0 && within(a, b, d))
        || (o3 == 0 && within(c, d, a))
        || (o4 == 0 && within(c, d, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn area(polygon: &[Point2<f64>]) -> f64 {
        let n = polygon.len();
        (0..n).map(|i| polygon[i].coords.perp(&polygon[(i + 1) % n].coords)).sum::<f64>() * 0.5
    }

    /// Same orientation, areas adding up, every side used once: then nothing overlaps and nothing is missing.
    fn check(polygon: &[Point2<f64>]) -> Result<(), TestCaseError> {
        prop_assert!(is_simple(polygon), "{:?}", polygon);
        let triangles = triangulate_ccw(polygon);
        prop_assert_eq!(triangles.len(), polygon.len() - 2);
        let mut total = 0.0;
        for t in &triangles {
            let t = t.map(|i| polygon[i]);
            prop_assert!(turn(t) > 0.0, "degenerate or turned: {:?} of {:?}", t, polygon);
            total += turn(t) * 0.5;
        }
        let exact = area(polygon);
        prop_assert!((total - exact).abs() <= 1e-12 * exact);
        for i in 0..polygon.len() {
            let j = (i + 1) % polygon.len();
            let uses = triangles.iter().filter(|t| (0..3).any(|k| (t[k], t[(k + 1) % 3]) == (i, j)));
            prop_assert_eq!(uses.count(), 1);
        }
        Ok(())
    }

    /// To search for ears that do not exist would take hours here. The number of triangles is right, and each
    /// corner is in one.
    #[test]
    fn polygons_that_cross_themselves_are_cut_into_as_many_triangles() {
        for n in [4, 5, 50, 20_000_usize] {
            // Corners of a square and its middle, in an order without order.
            let places = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.4, 0.5]];
            let corners: Vec<_> = (0..n).map(|i| Point2::from(places[(i * i / 3 + i * 7 / 5) % 5])).collect();
            let triangles = triangulate_ccw(&corners);
            assert_eq!(triangles.len(), n - 2);
            let mut used = vec![false; n];
            triangles.iter().flatten().for_each(|&k| used[k] = true);
            assert!(used.iter().all(|used| *used));
        }
    }

    proptest! {
        #[test]
        fn star_shaped_polygons(radii in prop::collection::vec(0.05..1.0_f64, 3..40)) {
            let n = radii.len() as f64;
            let polygon: Vec<_> = radii.iter().enumerate().map(|(i, r)| {
                let (s, c) = mp_math::sin_cos(std::f64::consts::TAU * i as f64 / n);
                Point2::new(r * c, r * s)
            }).collect();
            check(&polygon)?;
        }

        #[test]
        fn combs_with_collinear_corners(teeth in prop::collection::vec(1_u8..6, 1..12), extra in 0_usize..5) {
            // A comb on an integer grid: exact collinear runs below, right angles above.
            let mut polygon = Vec::new();
            let width = 2 * teeth.len();
            polygon.extend((0..=width).map(|x| Point2::new(x as f64, 0.0)));
            for k in 1..=extra {
                polygon.push(Point2::new(width as f64, k as f64 / (extra + 1) as f64));
            }
            for (i, t) in teeth.iter().enumerate() {
                let right = (width - 2 * i) as f64;
                let top = 1.0 + f64::from(*t);
                polygon.extend([(right, top), (right - 1.0, top), (right - 1.0, 1.0), (right - 2.0, 1.0)].map(|(x, y)| Point2::new(x, y)));
            }
            polygon.dedup();
            check(&polygon)?;
        }

        #[test]
        fn in_any_plane_and_orientation(radii in prop::collection::vec(0.1..1.0_f64, 4..12), axis in prop::array::uniform3(-1.0..1.0), reverse in any::<bool>()) {
            let n = radii.len() as f64;
            let turn = nalgebra::Rotation3::new(Vector3::from(axis) * 3.0);
            let mut corners: Vec<_> = radii.iter().enumerate().map(|(i, r)| {
                let (s, c) = mp_math::sin_cos(std::f64::consts::TAU * i as f64 / n);
                turn * Point3::new(r * c + 5.0, r * s - 3.0, 2.0)
            }).collect();
            if reverse {
                corners.reverse();
            }
            let normal = newell_normal(&corners);
            let mut sum = Vector3::zeros();
            for t in triangulate(&corners) {
                let [a, b, c] = t.map(|i| corners[i]);
                let cross = (b - a).cross(&(c - a));
                prop_assert!(cross.dot(&normal) > 0.0);
                sum += cross;
            }
            prop_assert!((sum - normal).norm() < 1e-12);
        }

        #[test]
        fn any_ring_gives_triangles(points in prop::collection::vec(prop::array::uniform3(-3_i8..4), 3..12)) {
            let corners: Vec<_> = points.iter().map(|p| Point3::from(p.map(f64::from))).collect();
            let triangles = triangulate(&corners);
            prop_assert_eq!(triangles.len(), corners.len() - 2);
            prop_assert!(triangles.iter().flatten().all(|&i| i < corners.len()));
        }
    }

    /// Ten thousand corners, convex and jagged, in no time.
    #[test]
    fn large_polygons() {
        for depth in [0.0, 0.3] {
            let polygon: Vec<_> = (0..10_000)
                .map(|i| {
                    let (s, c) = mp_math::sin_cos(std::f64::consts::TAU * f64::from(i) / 1e4);
                    Point2::new(c, s) * (1.0 - depth * f64::from(i % 3))
                })
                .collect();
            let triangles = triangulate_ccw(&polygon);
            assert_eq!(triangles.len(), 9_998);
            let total: f64 = triangles.iter().map(|t| turn(t.map(|i| polygon[i])) * 0.5).sum();
            assert!(triangles.iter().all(|t| turn(t.map(|i| polygon[i])) > 0.0));
            assert!((total - area(&polygon)).abs() < 1e-9);
        }
    }

    #[test]
    fn simple_or_not() {
        let p = |c: &[(f64, f64)]| c.iter().map(|&(x, y)| Point2::new(x, y)).collect::<Vec<_>>();
        assert!(is_simple(&p(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.0, 1.0)])));
        // A bow tie, a spike, a repeated corner, a corner touching a side, two corners.
        assert!(!is_simple(&p(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)])));
        assert!(!is_simple(&p(&[(0.0, 0.0), (2.0, 0.0), (1.0, 0.0), (0.0, 1.0)])));
        assert!(!is_simple(&p(&[(0.0, 0.0), (0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])));
        assert!(!is_simple(&p(&[(0.0, 0.0), (4.0, 0.0), (2.0, 2.0), (2.0, 0.0), (1.0, 3.0)])));
        assert!(!is_simple(&p(&[(0.0, 0.0), (1.0, 0.0)])));
    }
}
