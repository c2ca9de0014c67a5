//! Obstacles in the plane.

use super::cells::{CellKind, Cells};
use super::edge::Edge;
use super::polygon::closed;
use super::tree::EdgeTree;
use super::{Polygon, PolygonError};
use mp_stop::Interrupt;
use nalgebra::Point2;
use thiserror::Error;

/// Why a world could not be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PlanarWorldError {
    /// The walls enclose nothing.
    #[error("the bounds from ({}, {}) to ({}, {}) must be finite, the first corner below the second", .low[0], .low[1], .high[0], .high[1])]
    Bounds {
        /// The lower corner.
        low: [f64; 2],
        /// The upper corner.
        high: [f64; 2],
    },
    /// More than fit in memory.
    #[error("{edges} edges are too many: at most {max} can be handled")]
    TooManyEdges {
        /// How many there are.
        edges: usize,
        /// How many there may be.
        max: usize,
    },
    /// The work was interrupted.
    #[error("preparing the map was ended")]
    Interrupted,
    /// A polygon is invalid.
    #[error(transparent)]
    Polygon(#[from] PolygonError),
}

/// The most edges, limited by memory only.
const MAX_EDGES: usize = 20_000_000;

/// How many edges are remembered along a segment, so that they are not compared again.
const SEEN: usize = 8;

/// The polygon number of the edges of the walls, above all others.
const WALLS: u32 = u32::MAX - 1;

/// The point of an obstacle's boundary that is nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestToPoint {
    /// The point of the boundary, metres.
    pub point: Point2<f64>,
    /// Its distance, metres.
    pub distance: f64,
    /// The index of the polygon; `None` for the walls.
    pub obstacle: Option<usize>,
}

/// Where a segment and the boundary of an obstacle are nearest to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestToSegment {
    /// The nearest point on the segment, metres.
    pub on_segment: Point2<f64>,
    /// The point on the boundary.
    pub point: Point2<f64>,
    /// Their distance, metres; zero when they cross or touch.
    pub distance: f64,
    /// The index of the polygon; `None` for the walls.
    pub obstacle: Option<usize>,
}

/// Polygons, which may overlap, with or without walls around them; everything outside of the walls is
/// obstacle.
///
/// Distances are to boundaries, exact up to rounding. They are found by a grid whose cells list all edges
/// that can be nearest to one of their points, made once in O((n + cells) log n). A point takes some tens of
/// nanoseconds, a segment that many for each cell near obstacles along it.
#[derive(Clone, Debug)]
pub struct PlanarWorld {
    polygons: Vec<Polygon>,
    walls: Option<[Point2<f64>; 2]>,
    edges: Vec<Edge>,
    tree: EdgeTree,
    cells: Option<Cells>,
    /// The first corner of each ring, by x.
    corners: Vec<Point2<f64>>,
    low: Point2<f64>,
    high: Point2<f64>,
}

impl PlanarWorld {
    /// The world of `polygons`, and of `walls` from a lower to an upper corner around the free space.
    ///
    /// # Errors
    /// When the walls are not finite or enclose nothing, or there are more than 2·10⁷ edges.
    pub fn new(polygons: Vec<Polygon>, walls: Option<[[f64; 2]; 2]>) -> Result<Self, PlanarWorldError> {
        Self::new_until(polygons, walls, &Interrupt::never())
    }

    /// As [`new`](Self::new), unless `interrupt` says to end.
    ///
    /// # Errors
    /// As [`new`](Self::new), and [`Interrupted`](PlanarWorldError::Interrupted) when it was interrupted.
    pub fn new_until(
        polygons: Vec<Polygon>,
        walls: Option<[[f64; 2]; 2]>,
        interrupt: &Interrupt,
    ) -> Result<Self, PlanarWorldError> {
        let mut interrupt = interrupt.clone();
        let mut edges = Vec::new();
        for (i, polygon) in polygons.iter().enumerate() {
            for ring in polygon.rings() {
                if interrupt.ask() {
                    return Err(PlanarWorldError::Interrupted);
                }
                edges.extend(closed(ring).map(|e| Edge::new(e, i as u32)));
            }
            if edges.len() > MAX_EDGES {
                return Err(PlanarWorldError::TooManyEdges { edges: edges.len(), max: MAX_EDGES });
            }
        }
        let solid = edges.len();
        if let Some([low, high]) = walls {
            let room = Polygon::rectangle(low, high).map_err(|_| PlanarWorldError::Bounds { low, high })?;
            edges.extend(room.edges().map(|e| Edge::new(e, WALLS)));
        }
        let (mut low, mut high) = (Point2::from([f64::INFINITY; 2]), Point2::from([f64::NEG_INFINITY; 2]));
        for edge in &edges {
            let [l, h] = edge.bounds();
            (low, high) = (low.inf(&l), high.sup(&h));
        }
        let tree = EdgeTree::new(&edges, &mut interrupt);
        let positive = |v: f64| v > 0.0 && v.is_finite();
        let has_area = positive(high.x - low.x) && positive(high.y - low.y);
        let cells = has_area.then(|| Cells::new([low, high], &edges, solid, &tree, &mut interrupt));
        if interrupt.ask() {
            return Err(PlanarWorldError::Interrupted);
        }
        let mut corners: Vec<Point2<f64>> = polygons.iter().flat_map(Polygon::rings).map(|r| r[0]).collect();
        corners.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
        let walls = walls.map(|w| w.map(Point2::from));
        Ok(Self { polygons, walls, edges, tree, cells, corners, low, high })
    }

    /// The obstacles, in the order of the indices that queries answer with.
    #[must_use]
    pub fn polygons(&self) -> &[Polygon] {
        &self.polygons
    }

    /// Lower and upper corner of the walls.
    #[must_use]
    pub fn walls(&self) -> Option<[Point2<f64>; 2]> {
        self.walls
    }

    /// The box around walls and polygons; `None` for an empty world.
    #[must_use]
    pub fn bounds(&self) -> Option<[Point2<f64>; 2]> {
        (!self.edges.is_empty()).then_some([self.low, self.high])
    }

    /// How many edges there are, those of the walls included.
    #[must_use]
    pub fn edges(&self) -> usize {
        self.edges.len()
    }

    /// Whether `p` is in an obstacle, by exact predicates; on a boundary the answer may be either, and the
    /// distance is zero. So is a point with a coordinate that is not a number: nothing can be said of it.
    #[must_use]
    pub fn contains(&self, p: &Point2<f64>) -> bool {
        if p.x.is_nan() || p.y.is_nan() {
            return true;
        }
        if self.walls.is_some_and(|[l, h]| p.x <= l.x || p.y <= l.y || p.x >= h.x || p.y >= h.y) {
            return true;
        }
        let Some(cells) = &self.cells else { return self.polygons.iter().any(|polygon| polygon.contains(p)) };
        match cells.locate(p).map(|at| cells.cell(at).0.kind) {
            None | Some(CellKind::Open) => false,
            Some(CellKind::Solid) => true,
            Some(CellKind::Mixed) => cells.row_contains(p, &self.edges),
        }
    }

    /// The point of the boundary of an obstacle that is nearest to `p`; `None` in an empty world.
    #[must_use]
    pub fn nearest(&self, p: &Point2<f64>) -> Option<NearestToPoint> {
        let mut best = (f64::INFINITY, u32::MAX);
        match self.cells.as_ref().and_then(|cells| Some(cells.cell(cells.locate(p)?).1)) {
            Some(candidates) => {
                for &i in candidates {
                    let squared = self.edges[i as usize].squared(p);
                    if squared < best.0 {
                        best = (squared, i);
                    }
                }
            }
            None => self.tree.near(p, f64::INFINITY, |i, _| {
                let squared = self.edges[i as usize].squared(p);
                if (squared, i) < best {
                    best = (squared, i);
                }
                best.0
            }),
        }
        let edge = self.edges.get(best.1 as usize)?;
        Some(NearestToPoint {
            point: edge.nearest(p),
            distance: best.0.sqrt(),
            obstacle: self.obstacle(edge),
        })
    }

    /// The distance from `p` to the nearest obstacle; in an obstacle, minus the distance to the nearest
    /// boundary, which where obstacles overlap is less than the depth. Infinite in an empty world.
    #[must_use]
    pub fn signed_distance(&self, p: &Point2<f64>) -> f64 {
        let distance = self.nearest(p).map_or(f64::INFINITY, |n| n.distance);
        if self.contains(p) { -distance } else { distance }
    }

    /// Whether `p` is in no obstacle and farther than `distance` (m) from every one. Often decided by one
    /// cell of the grid.
    #[must_use]
    pub fn is_clear(&self, p: &Point2<f64>, distance: f64) -> bool {
        let found = self.cells.as_ref().and_then(|cells| Some((cells, cells.locate(p)?)));
        let Some((cells, at)) = found else {
            return self.nearest(p).is_none_or(|near| near.distance > distance) && !self.contains(p);
        };
        let (cell, candidates) = cells.cell(at);
        let off = (p - cells.center(at.0, at.1)).norm() + cells.slack;
        if cell.kind == CellKind::Solid || cell.from_center + off < distance {
            return false;
        }
        // Written so that a distance that is not a number is never kept.
        let beyond = |i: &u32| self.edges[*i as usize].squared(p).sqrt() > distance;
        let far = cell.from_center - off > distance;
        (far || candidates.iter().all(beyond)) && !self.contains(p)
    }

    /// Where the segment from `a` to `b` and the boundary of an obstacle are nearest to each other, if that
    /// is less than `below` metres; the segment may be on either side of the boundary.
    #[must_use]
    pub fn nearest_to_segment(
        &self,
        a: &Point2<f64>,
        b: &Point2<f64>,
        below: f64,
    ) -> Option<NearestToSegment> {
        let segment = Edge::new([*a, *b], 0);
        let mut best = (below, None);
        let slack = self.cells.as_ref().map_or(f64::INFINITY, |cells| cells.slack);
        // Cells next to each other have most of their edges in common.
        let mut seen = [u32::MAX; SEEN];
        let mut at = 0;
        let mut look = |i: u32, below: f64| -> f64 {
            if seen.contains(&i) {
                return below;
            }
            seen[at] = i;
            at = (at + 1) % SEEN;
            let edge = &self.edges[i as usize];
            if edge.is_beside(&segment, below + slack) || segment.is_beside(edge, below + slack) {
                return below;
            }
            match edge.nearest_to(&segment, below) {
                Some((points, distance)) => {
                    best = (distance, Some((points, i)));
                    distance
                }
                None => below,
            }
        };
        self.along(a, b, below, &mut look);
        let ([on_segment, point], i) = best.1?;
        let obstacle = self.obstacle(&self.edges[i as usize]);
        Some(NearestToSegment { on_segment, point, distance: best.0, obstacle })
    }

    /// Calls `look` with edges, among them the one nearest to the segment if that is nearer than `below`;
    /// `look` returns the new `below`.
    fn along(&self, a: &Point2<f64>, b: &Point2<f64>, below: f64, look: &mut impl FnMut(u32, f64) -> f64) {
        let (u, mut below) = (b - a, below);
        let length = u.norm();
        let inside =
            self.cells.as_ref().filter(|cells| cells.locate(a).is_some() && cells.locate(b).is_some());
        let Some(cells) = inside else {
            // Edges that can be near are within a disc around the segment.
            let (middle, half) = (a + u * 0.5, 0.5 * length);
            let within = |below: f64| mp_math::powi(half + below, 2) * (1.0 + 1e-12);
            self.tree.near(&middle, within(below), |i, _| {
                below = look(i, below);
                within(below)
            });
            return;
        };
        let (inverse, per_length) = (u.map(|x| 1.0 / x), 1.0 / length);
        let nudge = 0.5 * cells.slack * per_length;
        let mut t = 0.0;
        loop {
            let p = a + u * t;
            let Some(at) = cells.locate(&p) else { return };
            let (cell, candidates) = cells.cell(at);
            // No edge is within `from_center` of the centre, so none is within `below` of any point of the
            // cell, or at least of points around `p`.
            let clear = cell.from_center - below - cells.slack;
            if clear <= cells.half_diagonal {
                for &i in candidates {
                    below = look(i, below);
                    if below <= 0.0 {
                        return;
                    }
                }
            }
            let clear = clear - (p - cells.center(at.0, at.1)).norm();
            let next = cells.leaves(a, &inverse, at).max(t + nudge).max(t + clear * per_length);
            // Infinite or NaN for a segment of no length.
            if next.is_nan() || next >= 1.0 {
                return;
            }
            t = next;
        }
    }

    /// A corner of an obstacle for which `inside` is true, among those between `low` and `high`. One corner
    /// of each ring is tested, so a ring that lies wholly inside of a shape is found.
    #[must_use]
    pub fn ring_in(
        &self,
        [low, high]: [Point2<f64>; 2],
        inside: impl Fn(&Point2<f64>) -> bool,
    ) -> Option<Point2<f64>> {
        let from = self.corners.partition_point(|p| p.x < low.x);
        let near = self.corners[from..].iter().take_while(|p| p.x <= high.x);
        near.filter(|p| p.y >= low.y && p.y <= high.y).find(|p| inside(p)).copied()
    }

    fn obstacle(&self, edge: &Edge) -> Option<usize> {
        (edge.polygon != WALLS).then_some(edge.polygon as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn polygon() -> impl Strategy<Value = Polygon> {
        let ring = prop::collection::vec((0.0..10.0_f64, 0.0..6.0_f64), 3..9);
        // Round numbers make edges in line with each other and with the grid.
        (ring, any::<bool>()).prop_map(|(ring, round)| {
            let round = |v: f64| if round { v.round() } else { v };
            Polygon::outlined(ring.into_iter().map(|(x, y)| [round(x), round(y)])).unwrap()
        })
    }

    fn brute(edges: &[Edge], a: Point2<f64>, b: Point2<f64>) -> f64 {
        let segment = Edge::new([a, b], 0);
        let each = edges.iter().filter_map(|e| Some(e.nearest_to(&segment, f64::INFINITY)?.1));
        each.fold(f64::INFINITY, f64::min)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]
        #[test]
        fn agrees_with_looking_at_every_edge(
            polygons in prop::collection::vec(polygon(), 0..12),
            walled in any::<bool>(),
            points in prop::collection::vec((-1.0..11.0_f64, -1.0..7.0_f64), 2..30),
            below in (-12.0..0.5_f64).prop_map(|e| mp_math::powf(10.0, e)),
        ) {
            let walls = walled.then_some([[0.0, 0.0], [10.0, 6.0]]);
            let world = PlanarWorld::new(polygons, walls).unwrap();
            let points: Vec<_> = points.iter().map(|p| Point2::new(p.0, p.1)).collect();
            for p in &points {
                let outside = walled && !(p.x > 0.0 && p.x < 10.0 && p.y > 0.0 && p.y < 6.0);
                let inside = outside || world.polygons().iter().any(|polygon| polygon.contains(p));
                prop_assert_eq!(world.contains(p), inside);
                let expected = brute(&world.edges, *p, *p);
                let near = world.nearest(p);
                prop_assert_eq!(near.is_none(), world.edges() == 0);
                if let Some(near) = near {
                    prop_assert!((near.distance - expected).abs() < 1e-12);
                    prop_assert!(((near.point - p).norm() - near.distance).abs() < 1e-12);
                    let signed = if inside { -near.distance } else { near.distance };
                    prop_assert_eq!(world.signed_distance(p), signed);
                    for distance in [0.0, below, 10.0 * below.sqrt(), 0.999 * near.distance, 1.001 * near.distance] {
                        let close = (near.distance - distance).abs() < 1e-9;
                        prop_assert!(close || world.is_clear(p, distance) == (signed > distance));
                    }
                }
            }
            // Upright and level ones too.
            let level = points.windows(2).map(|w| [w[0], Point2::new(w[0].x, w[1].y)]);
            let level = level.chain(points.windows(2).map(|w| [w[0], Point2::new(w[1].x, w[0].y)]));
            for w in points.windows(2).map(|w| [w[0], w[1]]).chain(level) {
                let expected = brute(&world.edges, w[0], w[1]);
                let all = world.nearest_to_segment(&w[0], &w[1], f64::INFINITY);
                prop_assert!((all.map_or(f64::INFINITY, |n| n.distance) - expected).abs() < 1e-12 || world.edges() == 0);
                let near = world.nearest_to_segment(&w[0], &w[1], below);
                match near {
                    Some(near) => prop_assert!((near.distance - expected).abs() < 1e-12),
                    None => prop_assert!(expected >= below - 1e-12),
                }
            }
        }
    }

    /// Nothing can be said of a point or a distance that is not a number: it is not free.
    #[test]
    fn what_is_not_a_number_is_not_clear() {
        let square = Polygon::rectangle([0.0, 0.0], [1.0, 1.0]).unwrap();
        for walls in [None, Some([[-5.0, -5.0], [5.0, 5.0]])] {
            let world = PlanarWorld::new(vec![square.clone()], walls).unwrap();
            for p in [Point2::new(f64::NAN, 2.0), Point2::new(2.0, f64::NAN)] {
                assert!(world.contains(&p) && world.signed_distance(&p) < 0.0);
                assert!(!world.is_clear(&p, 0.1));
            }
            for p in [Point2::new(3.0, 3.0), Point2::new(0.5, 1.1), Point2::new(40.0, 3.0)] {
                assert!(!world.is_clear(&p, f64::NAN), "{p}");
            }
        }
    }

    /// Edges that are turned by a quarter run along borders of cells but for rounding: they cross few cells. Each of these took billions of steps.
    #[test]
    fn segments_along_borders_take_few_steps() {
        let squares = (0..16).map(|i| [f64::from(i % 4), f64::from(i / 4)]);
        let squares = squares.map(|[x, y]| Polygon::rectangle([x, y], [x + 0.25, y + 0.25]).unwrap());
        let world = PlanarWorld::new(squares.collect(), Some([[-1.0, -1.0], [5.0, 5.0]])).unwrap();
        let cells = world.cells.as_ref().unwrap();
        let border = |i: usize| nalgebra::center(&cells.center(i, i), &cells.center(i + 1, i + 1));
        for (i, off) in (0..8).flat_map(|i| [-1e-16, -1e-17, 0.0, 1e-17, 1e-16].map(|off| (i, off))) {
            let p = border(i);
            for v in [[off, 1.5], [off, -0.5], [1.5, off], [-0.5, off]] {
                let q = p + nalgebra::Vector2::from(v);
                let near = world.nearest_to_segment(&p, &q, f64::INFINITY).unwrap();
                assert!((near.distance - brute(&world.edges, p, q)).abs() < 1e-12, "{p} {q}");
            }
        }
    }

    #[test]
    fn rings_wholly_inside_are_found() {
        let small = Polygon::rectangle([1.0, 1.0], [1.1, 1.1]).unwrap();
        let world = PlanarWorld::new(vec![small], None).unwrap();
        let big = Polygon::rectangle([0.0, 0.0], [2.0, 2.0]).unwrap();
        assert_eq!(world.ring_in(big.bounds(), |p| big.contains(p)), Some(Point2::new(1.0, 1.0)));
        let beside = Polygon::rectangle([0.0, 1.05], [2.0, 2.0]).unwrap();
        assert_eq!(world.ring_in(beside.bounds(), |p| beside.contains(p)), None);
    }

    #[test]
    fn worlds_of_nothing_and_of_lines() {
        let empty = PlanarWorld::new(vec![], None).unwrap();
        let p = Point2::new(1.0, 2.0);
        assert!(
            !empty.contains(&p) && empty.signed_distance(&p) == f64::INFINITY && empty.bounds().is_none()
        );
        let line = Polygon::outlined([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]).unwrap();
        let world = PlanarWorld::new(vec![line], None).unwrap();
        assert_eq!((world.signed_distance(&p), world.contains(&Point2::new(1.0, 0.0))), (2.0, false));
        let far = Point2::new(1.0, -1e9);
        assert_eq!(world.nearest_to_segment(&p, &far, 5.0).unwrap().distance, 0.0);
        for bad in [f64::NAN, f64::INFINITY, -1.0, 0.0] {
            assert!(PlanarWorld::new(vec![], Some([[0.0, 0.0], [1.0, bad]])).is_err());
        }
    }

    /// A world of many rings is given up at any question, and is the same as ever when it is not.
    #[test]
    fn a_world_ends_when_told_to() {
        use mp_stop::{Cancel, Clock, Interrupt};
        use std::sync::atomic::{AtomicU64, Ordering};
        use std::time::Duration;
        static READ: AtomicU64 = AtomicU64::new(0);
        const STEP: Duration = Duration::from_millis(2);
        let clock = Clock::new(|| STEP * READ.fetch_add(1, Ordering::SeqCst) as u32);
        let square = |i: usize| {
            let (x, y) = ((i % 200) as f64, (i / 200) as f64);
            Polygon::rectangle([x, y], [x + 0.5 + (i % 7) as f64 * 0.05, y + 0.5]).unwrap()
        };
        let polygons: Vec<Polygon> = (0..20_000).map(square).collect();
        let world = |at: u64| {
            READ.store(0, Ordering::SeqCst);
            let interrupt = Interrupt::by(Cancel::new(), clock, STEP * at as u32);
            PlanarWorld::new_until(polygons.clone(), None, &interrupt)
        };
        let whole = world(u64::from(u32::MAX)).unwrap();
        let questions = READ.load(Ordering::SeqCst);
        assert!(questions > 40_000, "{questions}");
        for part in 0..10 {
            let at = 1 + part * (questions - 2) / 9;
            assert_eq!(world(at).err(), Some(PlanarWorldError::Interrupted), "{at} of {questions}");
            assert_eq!(READ.load(Ordering::SeqCst), at + 1, "the clock is read after the end");
        }
        let brute = |p: &Point2<f64>| {
            let each = whole.edges.iter().map(|e| e.squared(p));
            each.fold(f64::INFINITY, f64::min).sqrt()
        };
        for i in 0..200 {
            let p = Point2::new(0.97 * f64::from(i), 0.49 * f64::from(i));
            assert_eq!(whole.nearest(&p).unwrap().distance, brute(&p), "{p}");
        }
    }
}
