//! Point clouds: balls, found by a tree of balls around their centres.

mod search;

use mp_geom::Sphere;
use mp_stop::Interrupted;
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
    /// As `radius`, but less where all balls of the node are smaller than the largest of the cloud: this and the radius of the cloud together
    /// enclose the balls, though not all centres.
    reach: f64,
    first: u32,
    count: u32,
    /// The second child; the first one follows the node. 0 in a leaf.
    second: u32,
}

/// Balls, and the tree of their centres: halves along the longest side, leaves of at most [`LEAF`] points.
#[derive(Clone, Debug)]
pub(crate) struct Cloud {
    nodes: Vec<Node>,
    /// In the order of the leaves.
    points: Vec<Point3<f64>>,
    /// The number of each in the mesh.
    ids: Vec<u32>,
    /// How much (m) less than `radius` the radius of each is, in the order of the leaves; none where all have the same.
    smaller: Vec<f64>,
    /// Of the largest ball (m).
    pub(crate) radius: f64,
}

impl Cloud {
    /// Of balls, at least one and at most `u32::MAX`: their centres and radii (m). O(n log n).
    ///
    /// # Errors
    /// That of `go_on`, which is called for each node.
    pub(crate) fn build(
        balls: &[Sphere],
        go_on: &mut dyn FnMut() -> Result<(), Interrupted>,
    ) -> Result<Self, Interrupted> {
        let radius = balls.iter().map(|ball| ball.radius).fold(0.0, f64::max);
        let smaller = |id: u32| radius - balls[id as usize].radius;
        let mut order: Vec<(Point3<f64>, u32)> = balls.iter().map(|ball| ball.center).zip(0..).collect();
        let mut nodes = Vec::with_capacity(order.len() / 2 + 1);
        split(&mut order, 0, &smaller, &mut nodes, go_on)?;
        let (points, ids): (Vec<_>, Vec<_>) = order.into_iter().unzip();
        let smaller = match balls.iter().all(|ball| ball.radius == radius) {
            true => Vec::new(),
            false => ids.iter().map(|id| smaller(*id)).collect(),
        };
        Ok(Self { nodes, points, ids, smaller, radius })
    }

    /// How much (m) less than that of the largest ball the radius of ball `i` is, in the order of the leaves.
    #[inline]
    fn smaller(&self, i: usize) -> f64 {
        self.smaller.get(i).copied().unwrap_or(0.0)
    }

    /// The radius (m) of the ball with this number in the mesh. O(n) where not all have the same.
    pub(crate) fn radius_of(&self, id: usize) -> f64 {
        let place = || self.ids.iter().position(|own| *own as usize == id);
        self.radius - if self.smaller.is_empty() { 0.0 } else { place().map_or(0.0, |i| self.smaller(i)) }
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
        let own = size_of_val(&self.nodes[..]) + size_of_val(&self.points[..]);
        own + size_of_val(&self.ids[..]) + size_of_val(&self.smaller[..])
    }
}

/// Adds the nodes of `order`, which begins at the place `first` of all.
fn split(
    order: &mut [(Point3<f64>, u32)],
    first: usize,
    smaller: &impl Fn(u32) -> f64,
    nodes: &mut Vec<Node>,
    go_on: &mut dyn FnMut() -> Result<(), Interrupted>,
) -> Result<(), Interrupted> {
    go_on()?;
    let corner = order[0].0;
    let (low, high) = order.iter().fold((corner, corner), |(low, high), (p, _)| (low.inf(p), high.sup(p)));
    let center = nalgebra::center(&low, &high);
    let farthest = order.iter().map(|(p, _)| (p - center).norm_squared()).fold(0.0, f64::max);
    let me = nodes.len();
    let radius = farthest.sqrt() * (1.0 + 1e-15);
    let own = |(p, id): &(Point3<f64>, u32)| (p - center).norm() * (1.0 + 1e-15) - smaller(*id);
    let reach = match order.iter().all(|(_, id)| smaller(*id) == 0.0) {
        true => radius,
        // Differences of radii are rounded too.
        false => order.iter().map(own).fold(f64::NEG_INFINITY, f64::max) + 1e-15 * radius,
    };
    nodes.push(Node { center, radius, reach, first: first as u32, count: order.len() as u32, second: 0 });
    if order.len() > LEAF {
        let sides: Vector3<f64> = high - low;
        let longest = sides.imax();
        // Whole leaves on the left.
        let half = (order.len() / 2).next_multiple_of(LEAF);
        order.select_nth_unstable_by(half, |(p, i), (q, j)| p[longest].total_cmp(&q[longest]).then(i.cmp(j)));
        let (left, right) = order.split_at_mut(half);
        split(left, first, smaller, nodes, go_on)?;
        nodes[me].second = nodes.len() as u32;
        split(right, first + half, smaller, nodes, go_on)?;
    }
    Ok(())
}
