//! A second implementation, deliberately plain, that shares no code with the first: a tree of spheres,
//! split at the median, and its own distance of triangles. The independent path checker rests on it, and
//! the differential tests compare both.
//!
//! It is not exact at contact: whatever is nearer than about 1e-13 of the coordinates counts as touching.

mod axis;
pub mod exact;
mod pairs;
mod sweep;
mod swept_triangle;
mod triangle;

use mp_geom::TriMesh;
use nalgebra::{Isometry3, IsometryMatrix3, Point3, Vector3};
use std::cmp::Ordering;

pub use sweep::{Sweep, SweepCheck};
pub use triangle::triangle_distance;

use triangle::{Triangle, point_triangle};

/// Anything nearer than this fraction of the coordinates counts as touching.
const TOUCHING: f64 = 1e-13;

/// A ball around some triangles.
#[derive(Clone, Copy, Debug)]
struct Ball {
    center: Point3<f64>,
    radius: f64,
    /// From the center to the sides of the box around the triangles.
    half: Vector3<f64>,
    /// The largest distance of a point of the triangles from the origin.
    reach: f64,
    content: Content,
}

#[derive(Clone, Copy, Debug)]
enum Content {
    Triangle(usize),
    /// Two balls.
    Parts([usize; 2]),
}

/// A mesh with its tree of spheres.
#[derive(Clone, Debug)]
pub struct RefMesh {
    /// The last one is the root.
    balls: Vec<Ball>,
    triangles: Vec<Triangle>,
    /// The largest absolute coordinate.
    size: f64,
    /// Its corners, each once; none when there are too many to look for an axis.
    corners: Vec<Point3<f64>>,
}

impl RefMesh {
    /// Builds the tree of `mesh`: O(n log² n) for n triangles.
    #[must_use]
    pub fn new(mesh: &TriMesh) -> Self {
        let triangles: Vec<Triangle> = (0..mesh.triangles().len()).map(|i| mesh.triangle(i)).collect();
        let size = triangles.iter().flatten().map(|p| p.coords.amax()).fold(0.0, f64::max);
        let mut order: Vec<usize> = (0..triangles.len()).collect();
        let mut balls = Vec::with_capacity(2 * triangles.len());
        build(&triangles, &mut order, &mut balls);
        let mut corners: Vec<Point3<f64>> = triangles.iter().flatten().copied().collect();
        corners
            .sort_by(|p, q| p.iter().zip(q.iter()).fold(Ordering::Equal, |o, (x, y)| o.then(x.total_cmp(y))));
        corners.dedup();
        if corners.len() > axis::MOST_CORNERS {
            corners.clear();
        }
        Self { balls, triangles, size, corners }
    }

    /// Whether the distance from this mesh at `pose_wa` to `other` at `pose_wb` is at least `enough` (metres):
    /// `Ok` with a lower bound on it, or `Err` with the distance of some pair of triangles that are nearer (0
    /// when they intersect or touch), the first found. Much faster than [`RefMesh::clearance`] when the
    /// meshes are near.
    ///
    /// # Errors
    /// That distance. Bad input gives `Err(0.0)`, where [`RefMesh::clearance`] gives 0.
    pub fn at_least(
        &self,
        pose_wa: &Isometry3<f64>,
        other: &RefMesh,
        pose_wb: &Isometry3<f64>,
        enough: f64,
    ) -> Result<f64, f64> {
        let Some(mut search) = self.search(pose_wa, other, pose_wb, enough) else { return Err(0.0) };
        search.any = true;
        let enough = search.best;
        match search.run() {
            found if found < enough => Err(found),
            bound => Ok(bound),
        }
    }

    /// A lower bound on the distance from this mesh at `pose_wa` to `other` at `pose_wb` that is exact (up to
    /// rounding) when below `enough` (metres), and some value of at least `enough` otherwise; 0 when they
    /// intersect or touch.
    ///
    /// A pose that is not finite or not a rigid motion, and coordinates beyond 1e75, give 0. `enough` NaN
    /// counts as infinity.
    #[must_use]
    pub fn clearance(
        &self,
        pose_wa: &Isometry3<f64>,
        other: &RefMesh,
        pose_wb: &Isometry3<f64>,
        enough: f64,
    ) -> f64 {
        self.search(pose_wa, other, pose_wb, enough).map_or(0.0, Search::run)
    }

    /// A search for what is nearer than `enough`; `None` on bad input.
    fn search<'a>(
        &'a self,
        pose_wa: &Isometry3<f64>,
        other: &'a RefMesh,
        pose_wb: &Isometry3<f64>,
        enough: f64,
    ) -> Option<Search<'a>> {
        let pose_ab = pose_wa.inverse() * pose_wb;
        let scale = self.size + other.size + pose_ab.translation.vector.norm();
        if !(is_usable(pose_wa, scale) && is_usable(pose_wb, scale)) {
            return None;
        }
        let pose_ab = IsometryMatrix3::from_parts(pose_ab.translation, pose_ab.rotation.to_rotation_matrix());
        let touching = TOUCHING * scale;
        // A little more than `enough`, so that touching is always found.
        let best = if enough.is_nan() { f64::INFINITY } else { enough.max(2.0 * touching) };
        Some(Search { a: self, b: other, pose_ab, touching, best, any: false })
    }
}

/// One search for the smallest distance.
struct Search<'a> {
    a: &'a RefMesh,
    b: &'a RefMesh,
    pose_ab: IsometryMatrix3<f64>,
    touching: f64,
    /// The smallest distance so far; at first, the distance that is enough.
    best: f64,
    /// Whether the first distance below `enough` ends the search.
    any: bool,
}

impl Search<'_> {
    /// The distance found, 0 for touching; a lower bound when the roots are farther apart than is enough.
    fn run(mut self) -> f64 {
        let (root_a, root_b) = (self.a.balls.len() - 1, self.b.balls.len() - 1);
        let bound = self.bound(root_a, root_b);
        if bound >= self.best {
            return bound;
        }
        if self.any {
            let (a, b) = (&self.a.corners, &self.b.corners);
            let bound = axis::separation(a, b, &self.pose_ab, self.best + self.touching) - self.touching;
            if bound >= self.best {
                return bound;
            }
        }
        self.visit(root_a, root_b);
        if self.best <= self.touching { 0.0 } else { self.best }
    }

    /// A lower bound on the distance of the triangles of two balls.
    fn bound(&self, i: usize, j: usize) -> f64 {
        let (ball_a, ball_b) = (&self.a.balls[i], &self.b.balls[j]);
        // For a ball against a single triangle, the triangle itself is the better bound.
        let distance = match (ball_a.content, ball_b.content) {
            (Content::Triangle(k), Content::Parts(_)) => {
                point_triangle(&(self.pose_ab * ball_b.center), &self.a.triangles[k]) - ball_b.radius
            }
            (Content::Parts(_), Content::Triangle(l)) => {
                let center = self.pose_ab.inverse_transform_point(&ball_a.center);
                point_triangle(&center, &self.b.triangles[l]) - ball_a.radius
            }
            _ => (self.pose_ab * ball_b.center - ball_a.center).norm() - ball_a.radius - ball_b.radius,
        };
        distance - self.touching
    }

    /// Lowers `best` to the distance of the triangles of two balls, if that is smaller.
    /// Returns whether the search is over.
    fn visit(&mut self, i: usize, j: usize) -> bool {
        let (ball_a, ball_b) = (&self.a.balls[i], &self.b.balls[j]);
        let pairs = match (ball_a.content, ball_b.content) {
            (Content::Triangle(k), Content::Triangle(l)) => {
                let triangle_b = self.b.triangles[l].map(|p| self.pose_ab * p);
                let distance = triangle_distance(&self.a.triangles[k], &triangle_b);
                let nearer = distance < self.best;
                self.best = self.best.min(distance);
                return self.best <= self.touching || (nearer && self.any);
            }
            (Content::Parts(parts), Content::Parts(_)) if ball_a.radius >= ball_b.radius => {
                parts.map(|part| (part, j))
            }
            (_, Content::Parts(parts)) => parts.map(|part| (i, part)),
            (Content::Parts(parts), Content::Triangle(_)) => parts.map(|part| (part, j)),
        };
        let mut bounds = pairs.map(|(k, l)| (self.bound(k, l), k, l));
        if bounds[1].0 < bounds[0].0 {
            bounds.swap(0, 1);
        }
        for (bound, k, l) in bounds {
            if bound < self.best && self.visit(k, l) {
                return true;
            }
        }
        false
    }
}

/// Whether `pose` is a rigid motion within the limits, for meshes of that size.
fn is_usable(pose: &Isometry3<f64>, size: f64) -> bool {
    let rigid = (pose.rotation.quaternion().norm() - 1.0).abs() < 1e-6;
    rigid && pose.translation.vector.norm() + size < 1e75
}

/// Adds the balls of the triangles in `order`, children first; returns the index of the ball around them all.
fn build(triangles: &[Triangle], order: &mut [usize], balls: &mut Vec<Ball>) -> usize {
    let content = if let [only] = order {
        Content::Triangle(*only)
    } else {
        let middle = |i: &usize, k: usize| triangles[*i].iter().map(|p| p[k] / 3.0).sum::<f64>();
        let extent = |k: usize| {
            let along = order.iter().map(|i| middle(i, k));
            along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
        };
        let extents = [extent(0), extent(1), extent(2)];
        let widest = (0..3).max_by(|&x, &y| extents[x].total_cmp(&extents[y])).unwrap_or(0);
        let half = order.len() / 2;
        order.select_nth_unstable_by(half, |x, y| {
            middle(x, widest).total_cmp(&middle(y, widest)).then(x.cmp(y))
        });
        let (low, high) = order.split_at_mut(half);
        Content::Parts([build(triangles, low, balls), build(triangles, high, balls)])
    };
    balls.push(enclosing_ball(order.iter().flat_map(|&i| triangles[i]), content));
    balls.len() - 1
}

/// A ball around the points, about the middle of their box.
fn enclosing_ball(points: impl Iterator<Item = Point3<f64>> + Clone, content: Content) -> Ball {
    let low = points.clone().reduce(|p, q| p.inf(&q)).unwrap_or_default();
    let high = points.clone().reduce(|p, q| p.sup(&q)).unwrap_or_default();
    let center = nalgebra::center(&low, &high);
    let radius = points.clone().map(|p| (p - center).norm()).fold(0.0, f64::max);
    let reach = points.map(|p| p.coords.norm()).fold(0.0, f64::max);
    Ball { center, radius, half: (high - center).sup(&(center - low)), reach, content }
}
