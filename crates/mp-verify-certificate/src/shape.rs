//! Whether bodies are apart. All rests on this: two convex sets are apart by the gap between them along any
//! axis. Boxes of the tree are compared along their axes, pieces along the one that parry finds, or along all
//! that can matter. The gap is arithmetic on corners; where the axis comes from is of no account.

use crate::file::Body;
use parry3d_f64::math::{Pose3 as Pose, Vec3};
use parry3d_f64::query::gjk::{CsoPoint, GJKResult, VoronoiSimplex, closest_points};
use parry3d_f64::shape::SupportMap;

/// What rounding may add to a gap, as a fraction of the coordinates.
const ROUNDING: f64 = 1e-13;

/// A convex piece: the hull of its corners.
struct Piece(Vec<Vec3>);

impl SupportMap for Piece {
    fn local_support_point(&self, dir: Vec3) -> Vec3 {
        let ahead = |a: &&Vec3, b: &&Vec3| a.dot(dir).total_cmp(&b.dot(dir));
        self.0.iter().max_by(ahead).copied().unwrap_or(Vec3::ZERO)
    }
}

/// A box around some pieces.
struct Node {
    center: Vec3,
    half: Vec3,
    /// Two nodes, or one piece.
    below: Below,
}

enum Below {
    Nodes(usize, usize),
    Piece(usize),
}

/// A body as a tree of boxes around its pieces.
pub(crate) struct Shape {
    pieces: Vec<Piece>,
    nodes: Vec<Node>,
    /// The largest of the pieces.
    radius: f64,
    /// Of each piece; none where all have the largest.
    radii: Vec<f64>,
    /// The largest coordinate.
    size: f64,
}

impl Shape {
    pub(crate) fn new(body: &Body) -> Self {
        let corner = |i: &usize| Vec3::from_array(body.vertices[*i]);
        let pieces: Vec<Piece> = body.pieces.iter().map(|p| Piece(p.iter().map(corner).collect())).collect();
        let size = body.vertices.iter().flatten().fold(0.0_f64, |size, x| size.max(x.abs())) + body.radius;
        let mut shape =
            Self { pieces, nodes: Vec::new(), radius: body.radius, radii: body.radii.clone(), size };
        let mut all: Vec<usize> = (0..shape.pieces.len()).collect();
        shape.build(&mut all);
        shape
    }

    /// How much less than the largest radius that of a piece is.
    fn smaller(&self, piece: usize) -> f64 {
        self.radii.get(piece).map_or(0.0, |radius| self.radius - radius)
    }

    /// Adds a node around pieces and gives its index.
    fn build(&mut self, pieces: &mut [usize]) -> usize {
        let corners = || pieces.iter().flat_map(|i| &self.pieces[*i].0);
        let low = corners().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = corners().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        let (center, half) = (0.5 * (low + high), 0.5 * (high - low));
        let below = match pieces {
            [piece] => Below::Piece(*piece),
            _ => {
                let axis = [half.x, half.y, half.z];
                let axis = (0..3).max_by(|a, b| axis[*a].total_cmp(&axis[*b])).unwrap_or(0);
                let place = |i: &usize| {
                    self.pieces[*i].0.iter().map(|c| c[axis]).sum::<f64>() / self.pieces[*i].0.len() as f64
                };
                pieces.sort_by(|a, b| place(a).total_cmp(&place(b)));
                let (left, right) = pieces.split_at_mut(pieces.len() / 2);
                Below::Nodes(self.build(left), self.build(right))
            }
        };
        self.nodes.push(Node { center, half, below });
        self.nodes.len() - 1
    }

    /// Whether two bodies at two poses are apart by at least `enough` (m).
    pub(crate) fn apart(&self, at: &Pose, other: &Self, other_at: &Pose, enough: f64) -> bool {
        // The other in the frame of this one.
        let pose = at.inverse() * *other_at;
        let size = self.size + other.size + pose.translation.length();
        // What is not a number is not apart.
        if size.is_nan() || size > 1e75 {
            return false;
        }
        let enough = enough + self.radius + other.radius + ROUNDING * size;
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| pose.rotation * axis);
        let mut open = vec![(self.nodes.len() - 1, other.nodes.len() - 1)];
        while let Some((i, j)) = open.pop() {
            let (a, b) = (&self.nodes[i], &other.nodes[j]);
            if boxes_apart(a, b, &pose, &axes, enough) {
                continue;
            }
            match (&a.below, &b.below) {
                (Below::Piece(p), Below::Piece(q)) => {
                    let enough = enough - self.smaller(*p) - other.smaller(*q);
                    let q = Piece(other.pieces[*q].0.iter().map(|c| pose.transform_point(*c)).collect());
                    if !pieces_apart(&self.pieces[*p], &q, enough) {
                        return false;
                    }
                }
                (Below::Nodes(l, r), Below::Piece(_)) => open.extend([(*l, j), (*r, j)]),
                (Below::Piece(_), Below::Nodes(l, r)) => open.extend([(i, *l), (i, *r)]),
                (Below::Nodes(l, r), Below::Nodes(..)) if a.half.length() >= b.half.length() => {
                    open.extend([(*l, j), (*r, j)]);
                }
                (Below::Nodes(..), Below::Nodes(l, r)) => open.extend([(i, *l), (i, *r)]),
            }
        }
        true
    }
}

/// Whether two boxes are apart by at least `enough`: along the axes of one, or along `axes`, those of the
/// other.
fn boxes_apart(a: &Node, b: &Node, pose: &Pose, axes: &[Vec3; 3], enough: f64) -> bool {
    let between = pose.transform_point(b.center) - a.center;
    let far = axes[0].abs() * b.half.x + axes[1].abs() * b.half.y + axes[2].abs() * b.half.z;
    let long = |gap: Vec3| gap.max(Vec3::ZERO).length_squared() >= enough * enough;
    let along = |axis: Vec3| between.dot(axis).abs() - a.half.dot(axis.abs());
    long(between.abs() - a.half - far) || long(Vec3::from_array(axes.map(along)) - b.half)
}

/// Whether two convex pieces are apart by at least `enough`.
fn pieces_apart(a: &Piece, b: &Piece, enough: f64) -> bool {
    let shows = |axis: Vec3| axis.try_normalize().is_some_and(|axis| gap(a, b, axis) >= enough);
    // Mostly the plane of one does.
    let across = |piece: &Piece| match *piece.0.as_slice() {
        [p, q, r] => (q - p).cross(r - p),
        _ => Vec3::ZERO,
    };
    if shows(across(a)) || shows(across(b)) {
        return true;
    }
    let mut simplex = VoronoiSimplex::new();
    let start = CsoPoint::from_shapes(&Pose::IDENTITY, a, b, b.0[0] - a.0[0]);
    simplex.reset(start);
    let found = match closest_points(&Pose::IDENTITY, a, b, enough, true, &mut simplex) {
        GJKResult::NoIntersection(axis) => shows(axis),
        GJKResult::ClosestPoints(p, q, axis) => shows(q - p) || shows(axis),
        _ => false,
    };
    found || axes(a, b).any(shows)
}

/// The gap between two pieces along an axis of unit length: on one side of it or on the other.
fn gap(a: &Piece, b: &Piece, axis: Vec3) -> f64 {
    let ends = |piece: &Piece| {
        let along = piece.0.iter().map(|corner| corner.dot(axis));
        along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    };
    let (a, b) = (ends(a), ends(b));
    (b.0 - a.1).max(a.0 - b.1)
}

/// The axes along which two pieces can be nearest: between corners, from a corner across an edge, across two
/// edges of one or of both.
fn axes<'p>(a: &'p Piece, b: &'p Piece) -> impl Iterator<Item = Vec3> + 'p {
    let edges = |piece: &Piece| -> Vec<Vec3> {
        let n = piece.0.len();
        let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
        pairs.map(|(i, j)| piece.0[j] - piece.0[i]).collect()
    };
    let (of_a, of_b) = (edges(a), edges(b));
    let all: Vec<Vec3> = of_a.iter().chain(&of_b).copied().collect();
    let between = a.0.iter().flat_map(|p| b.0.iter().map(move |q| *q - *p));
    let between: Vec<Vec3> = between.collect();
    let mut axes = between.clone();
    for edge in all.iter().filter_map(|edge| edge.try_normalize()) {
        axes.extend(between.iter().map(|v| *v - edge * v.dot(edge)));
        axes.extend(all.iter().map(|other| edge.cross(*other)));
    }
    axes.into_iter()
}

#[cfg(test)]
mod tests;
