//! Geometry for verifiers: plain loops over all edges. It shares no code with the queries of the world.

use mp_geom::planar::{PlanarWorld, Polygon};
use nalgebra::{Point2, Vector2};
use std::ops::Range;

type Segment = [Point2<f64>; 2];

/// The lower and the upper corner of a box.
type Box2 = [Point2<f64>; 2];

/// Obstacles as lists of points and of edges.
#[derive(Clone, Debug)]
pub(super) struct EdgeList {
    /// The rings of each polygon.
    polygons: Vec<Vec<Vec<Point2<f64>>>>,
    /// The box around each polygon.
    polygon_boxes: Vec<Box2>,
    walls: Option<[Point2<f64>; 2]>,
    pub(super) edges: Vec<Segment>,
    /// The box around each edge.
    edge_boxes: Vec<Box2>,
    /// The end of the edges of each polygon in `edges`. The edges of the walls come after those of the last polygon.
    ends: Vec<usize>,
}

impl EdgeList {
    pub(super) fn new(world: &PlanarWorld) -> Self {
        let polygons: Vec<Vec<Vec<Point2<f64>>>> =
            world.polygons().iter().map(|p| p.rings().to_vec()).collect();
        let (mut edges, mut ends, mut polygon_boxes) = (Vec::new(), Vec::new(), Vec::new());
        for rings in &polygons {
            edges.extend(rings.iter().flat_map(|ring| sides(ring)));
            ends.push(edges.len());
            polygon_boxes.push(box_around(rings.iter().flatten()));
        }
        let walls = world.walls();
        if let Some([low, high]) = walls {
            let ring = [low, Point2::new(low.x, high.y), high, Point2::new(high.x, low.y)];
            edges.extend(sides(&ring));
        }
        let edge_boxes = edges.iter().map(box_around).collect();
        Self { polygons, polygon_boxes, walls, edges, edge_boxes, ends }
    }

    /// Whether a point is in an obstacle. Exact for points that are not within rounding of a boundary.
    pub(super) fn inside(&self, p: &Point2<f64>) -> bool {
        let outside =
            |[low, high]: [Point2<f64>; 2]| !(low.x < p.x && p.x < high.x && low.y < p.y && p.y < high.y);
        let mut near = self.polygon_boxes.iter().zip(&self.polygons).filter(|(bounds, _)| !outside(**bounds));
        self.walls.is_some_and(outside) || near.any(|(_, rings)| inside_rings(rings, p))
    }

    /// The distance of a segment from the nearest edge; infinite if there are no edges.
    pub(super) fn nearest(&self, segment: &Segment) -> f64 {
        let here = box_around(segment);
        let look = |edges: Range<usize>, least: f64| {
            let near = |least: f64, i: usize| {
                if gap(&self.edge_boxes[i], &here) < least {
                    least.min(segment_distance(&self.edges[i], segment))
                } else {
                    least
                }
            };
            edges.fold(least, near)
        };
        let of = |i: usize| i.checked_sub(1).map_or(0, |before| self.ends[before])..self.ends[i];
        // The polygon with the nearest box comes first, so that few others are near enough to be tested.
        let mut nearest = (f64::INFINITY, None);
        for (i, other) in self.polygon_boxes.iter().enumerate() {
            let gap = gap(other, &here);
            if gap < nearest.0 {
                nearest = (gap, Some(i));
            }
        }
        let mut least = nearest.1.map_or(f64::INFINITY, |i| look(of(i), f64::INFINITY));
        for (i, other) in self.polygon_boxes.iter().enumerate() {
            if gap(other, &here) < least && Some(i) != nearest.1 {
                least = look(of(i), least);
            }
        }
        look(self.ends.last().copied().unwrap_or(0)..self.edges.len(), least)
    }

    /// The first points of all rings.
    pub(super) fn first_points(&self) -> impl Iterator<Item = &Point2<f64>> {
        self.polygons.iter().flatten().filter_map(|ring| ring.first())
    }
}

pub(super) fn sides(ring: &[Point2<f64>]) -> impl Iterator<Item = Segment> {
    ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| [*a, *b])
}

fn box_around<'a>(points: impl IntoIterator<Item = &'a Point2<f64>>) -> Box2 {
    let none = [Point2::from([f64::INFINITY; 2]), Point2::from([f64::NEG_INFINITY; 2])];
    points.into_iter().fold(none, |[low, high], p| [low.inf(p), high.sup(p)])
}

/// The gap between two boxes along the axis where it is greater; below zero where they overlap.
fn gap([a, b]: &Box2, [c, d]: &Box2) -> f64 {
    let greater = |x: f64, y: f64| if x > y { x } else { y };
    greater(greater(c.x - b.x, a.x - d.x), greater(c.y - b.y, a.y - d.y))
}

/// Whether `p` is within `rings`, by an upward ray.
pub(super) fn inside_rings(rings: &[Vec<Point2<f64>>], p: &Point2<f64>) -> bool {
    let mut crossings = 0_usize;
    for ring in rings {
        for [a, b] in sides(ring) {
            let spans = (a.x <= p.x && p.x < b.x) || (b.x <= p.x && p.x < a.x);
            if spans && a.y + (b.y - a.y) * ((p.x - a.x) / (b.x - a.x)) > p.y {
                crossings += 1;
            }
        }
    }
    crossings % 2 == 1
}

pub(super) fn rings(polygon: &Polygon) -> Vec<Vec<Point2<f64>>> {
    polygon.rings().to_vec()
}

/// The distance between two segments: that of the origin from the parallelogram of the differences of their points.
pub(super) fn segment_distance(s: &Segment, t: &Segment) -> f64 {
    let corners: [Vector2<f64>; 4] = [t[0] - s[0], t[1] - s[0], t[1] - s[1], t[0] - s[1]];
    let (mut left, mut right, mut least) = (0, 0, f64::INFINITY);
    for i in 0..4 {
        let (a, b) = (corners[i], corners[(i + 1) % 4]);
        let side = b - a;
        let turn = side.x * -a.y - side.y * -a.x;
        left += usize::from(turn > 0.0);
        right += usize::from(turn < 0.0);
        // The point of the side nearest to the origin.
        let square = side.dot(&side);
        let along = if square > 0.0 { (-a.dot(&side) / square).clamp(0.0, 1.0) } else { 0.0 };
        least = least.min((a + along * side).norm_squared()).min(b.norm_squared());
    }
    if left == 4 || right == 4 { 0.0 } else { least.sqrt() }
}

/// A lower bound on the distance between two segments: the gap between the boxes around them along the axis where it is
/// greater.
pub(super) fn box_distance(s: &Segment, t: &Segment) -> f64 {
    gap(&box_around(s), &box_around(t))
}
