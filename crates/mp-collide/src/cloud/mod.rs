//! Point clouds: balls of one radius, found by a tree of balls around their centres.

mod search;

use nalgebra::{Point3, Vector3};

pub(crate) use search::{Found, Reach};

/// Up to this many points are in a leaf.
const LEAF: usize = 8;

/// A ball around the points of a range of the order.
#[derive(Clone, Copy, Debug)]
struct Node {
    center: Point3<f64>,
    /// Rounded up; with the radius of the cloud it holds the balls too.
    radius: f64,
    first: u32,
    count: u32,
    /// The second child; the first one follows the node. 0 in a leaf.
    second: u32,
}

/// Balls of one radius, and the tree of their centres: halves along the longest side, leaves of at most [`LEAF`] points.
#[derive(Clone, Debug)]
pub(crate) struct Cloud {
    nodes: Vec<Node>,
    /// In the order of the leaves.
    points: Vec<Point3<f64>>,
    /// The number of each in the mesh.
    ids: Vec<u32>,
    /// Of each ball (m).
    pub(crate) radius: f64,
}

impl Cloud {
    /// Of `count` points, at least one and at most `u32::MAX`. O(n log n).
    ///
    /// # Errors
    /// That of `go_on`, which is called for each node.
    pub(crate) fn build<E>(
        points: impl Iterator<Item = Point3<f64>>,
        radius: f64,
        go_on: &mut impl FnMut() -> Result<(), E>,
    ) -> Result<Self, E> {
        let mut order: Vec<(Point3<f64>, u32)> = points.zip(0..).collect();
        let mut nodes = Vec::with_capacity(order.len() / 2 + 1);
        split(&mut order, 0, &mut nodes, go_on)?;
        let (points, ids) = order.into_iter().unzip();
        Ok(Self { nodes, points, ids, radius })
    }

    /// The corners of the box around the centres.
    pub(crate) fn corners(&self) -> [Point3<f64>; 8] {
        let first = self.points[0];
        let (low, high) = self.points.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
        let of = |i: usize, k: usize| if i >> k & 1 == 0 { low[k] } else { high[k] };
        std::array::from_fn(|i| Point3::new(of(i, 0), of(i, 1), of(i, 2)))
    }

    /// The centres in the order of the mesh.
    pub(crate) fn centers(&self) -> Vec<Point3<f64>> {
        let mut centers = vec![Point3::origin(); self.points.len()];
        self.ids.iter().zip(&self.points).for_each(|(id, p)| centers[*id as usize] = *p);
        centers
    }

    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }

    pub(crate) fn memory(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.points[..]) + size_of_val(&self.ids[..])
    }
}

/// Adds the nodes of `order`, which begins at the place `first` of all.
fn split<E>(
    order: &mut [(Point3<f64>, u32)],
    first: usize,
    nodes: &mut Vec<Node>,
    go_on: &mut impl FnMut() -> Result<(), E>,
) -> Result<(), E> {
    go_on()?;
    let corner = order[0].0;
    let (low, high) = order.iter().fold((corner, corner), |(low, high), (p, _)| (low.inf(p), high.sup(p)));
    let center = nalgebra::center(&low, &high);
    let farthest = order.iter().map(|(p, _)| (p - center).norm_squared()).fold(0.0, f64::max);
    let me = nodes.len();
    let radius = farthest.sqrt() * (1.0 + 1e-15);
    nodes.push(Node { center, radius, first: first as u32, count: order.len() as u32, second: 0 });
    if order.len() > LEAF {
        let sides: Vector3<f64> = high - low;
        let longest = sides.imax();
        // Whole leaves on the left.
        let half = (order.len() / 2).next_multiple_of(LEAF);
        order.select_nth_unstable_by(half, |(p, i), (q, j)| p[longest].total_cmp(&q[longest]).then(i.cmp(j)));
        let (left, right) = order.split_at_mut(half);
        split(left, first, nodes, go_on)?;
        nodes[me].second = nodes.len() as u32;
        split(right, first + half, nodes, go_on)?;
    }
    Ok(())
}
