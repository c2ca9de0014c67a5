//! A second implementation, deliberately plain, that shares no code with the first: a tree of spheres,
//! split at the median, and its own distance of triangles. The independent path checker rests on it, and
//! the differential tests compare both.
//!
//! It is not exact at contact: whatever is nearer than about 1e-13 of the coordinates counts as touching.

mod axis;
mod cuboid;
mod drift;
pub mod exact;
mod hint;
mod nested;
mod pairs;
mod parts;
mod sweep;
mod swept_triangle;
mod triangle;

use mp_geom::{Aabb, TriMesh};
use mp_stop::{Interrupt, Interrupted};
use nalgebra::{Isometry3, IsometryMatrix3, Matrix3, Point3, Vector3};
use std::cmp::Ordering;
use std::collections::HashSet;
use std::ops::Range;
use std::sync::OnceLock;

pub use drift::{Drift, KeptApart};
pub use hint::Hint;
pub use sweep::{Sweep, SweepCheck};
pub use triangle::triangle_distance;

use cuboid::{Beside, Cuboid};
use triangle::{Triangle, point_triangle};

/// Anything nearer than this fraction of the coordinates counts as touching.
const TOUCHING: f64 = 1e-13;

/// Meshes of more triangles store neither copies of their triangles nor the balls around [so few](FEW) of them, which are most balls:
/// these are made when they are needed.
const LARGE: usize = 1 << 20;

/// Large meshes store the balls around more triangles than this.
const FEW: u32 = 16;

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
    Triangle(u32),
    Parts([Node; 2]),
}

/// Names a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Node {
    /// The number of a stored ball.
    Stored(u32),
    /// The ball around `count` triangles from the place `first` of the order on.
    Few { first: u32, count: u16 },
}

/// A mesh with its tree of spheres.
#[derive(Clone, Debug)]
pub struct RefMesh {
    /// Shares its vertices and triangles with the mesh that was given.
    mesh: TriMesh,
    /// Of a mesh that is not large, the triangles.
    triangles: Vec<Triangle>,
    /// Of a large mesh, the numbers of the triangles in the order of the leaves.
    order: Vec<u32>,
    balls: Vec<Ball>,
    root: Node,
    /// The largest absolute coordinate.
    size: f64,
    /// Its corners, each once; none when there are too many to look for an axis.
    corners: Vec<Point3<f64>>,
    /// The triangles of each solid, and the box around them.
    solids: Vec<(Range<u32>, Aabb)>,
    /// A vertex of each connected component, by x, found at the first use.
    components: OnceLock<Vec<Point3<f64>>>,
    /// A ball around the boxes of all solids, found at the first use.
    around_solids: OnceLock<(Point3<f64>, f64)>,
    /// Few balls around all of it, taken from the tree.
    parts: Vec<(Point3<f64>, f64)>,
    /// If it is a box.
    cuboid: Option<Cuboid>,
    /// Whether all triangles are single points, with balls around them.
    is_balls: bool,
}

impl RefMesh {
    /// Builds the tree of `mesh`: O(n log² n) for n triangles. It takes 232 bytes a triangle. Of more than a million triangles it takes
    /// 9 to 15 bytes each, and 16 more while it is built; then answers take two to three times as long, and building nearly twice.
    #[must_use]
    pub fn new(mesh: &TriMesh) -> Self {
        match Self::storing(mesh, few_of(mesh), &mut || Ok(())) {
            Ok(made) => made,
            Err(Interrupted) => unreachable!("nothing interrupts it"),
        }
    }

    /// As [`new`](Self::new); `None` when `interrupt` says to end.
    #[must_use]
    pub fn new_until(mesh: &TriMesh, interrupt: &Interrupt) -> Option<Self> {
        let mut interrupt = interrupt.clone();
        Self::storing(mesh, few_of(mesh), &mut || interrupt.go_on()).ok()
    }

    /// Stores the balls around more than `few` triangles, and the triangles if `few` is 0. Answers do not depend on that.
    ///
    /// # Errors
    /// That of `go_on`, which is called for each ball.
    fn storing(
        mesh: &TriMesh,
        few: u32,
        go_on: &mut dyn FnMut() -> Result<(), Interrupted>,
    ) -> Result<Self, Interrupted> {
        let count = mesh.triangles().len();
        let triangles = || (0..count).map(|i| mesh.triangle(i));
        let mut seen = vec![false; mesh.vertices().len()];
        let first = |i: &u32| !std::mem::replace(&mut seen[*i as usize], true);
        let corners = mesh.triangles().iter().flatten().copied().filter(first);
        let corners = corners.map(|i| mesh.vertices()[i as usize]);
        let mut tree = Self {
            mesh: mesh.clone(),
            triangles: if few == 0 { triangles().collect() } else { Vec::new() },
            order: (0..count as u32).collect(),
            balls: Vec::with_capacity(larger_balls(count, few as usize)),
            root: Node::Stored(0),
            size: triangles().flatten().map(|p| p.coords.amax()).fold(0.0, f64::max)
                + mesh.rounding().unwrap_or(0.0),
            // Axes separate corners, not balls.
            corners: if mesh.balls().is_empty() { distinct(corners) } else { Vec::new() },
            solids: nested::solids(mesh),
            components: OnceLock::new(),
            around_solids: OnceLock::new(),
            parts: Vec::new(),
            cuboid: Cuboid::of(mesh),
            is_balls: mesh.is_balls(),
        };
        let mut order = std::mem::take(&mut tree.order);
        tree.sort(&mut order, go_on)?;
        tree.order = order;
        tree.root = tree.store(0, count as u32, few, go_on)?;
        if few == 0 {
            tree.order = Vec::new();
        }
        tree.parts = tree.balls_of_depth(parts::DEPTH);
        Ok(tree)
    }

    /// Puts triangles in the order of the leaves: those on the lower side of the median first, and so on within both halves.
    fn sort(
        &self,
        order: &mut [u32],
        go_on: &mut dyn FnMut() -> Result<(), Interrupted>,
    ) -> Result<(), Interrupted> {
        go_on()?;
        if order.len() < 2 {
            return Ok(());
        }
        // Triangles of large meshes are made anew whenever they are looked at.
        let middle = |triangle: &Triangle, k: usize| triangle.iter().map(|p| p[k] / 3.0).sum::<f64>();
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for &i in &*order {
            let mut made = None;
            let triangle = self.triangle(i, &mut made);
            for k in 0..3 {
                let x = middle(triangle, k);
                (low[k], high[k]) = (low[k].min(x), high[k].max(x));
            }
        }
        let extent = |k: usize| high[k] - low[k];
        let widest = (0..3).max_by(|&x, &y| extent(x).total_cmp(&extent(y))).unwrap_or(0);
        let along = |i: u32| (middle(self.triangle(i, &mut None), widest), i);
        let mut placed: Vec<(f64, u32)> = order.iter().map(|&i| along(i)).collect();
        placed.select_nth_unstable_by(order.len() / 2, |x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        order.iter_mut().zip(&placed).for_each(|(place, (_, i))| *place = *i);
        drop(placed);
        let (low, high) = order.split_at_mut(order.len() / 2);
        self.sort(low, go_on)?;
        self.sort(high, go_on)
    }

    /// Adds the balls around `count` triangles from the place `first` of the order on, children first. Returns that around them all.
    fn store(
        &mut self,
        first: u32,
        count: u32,
        few: u32,
        go_on: &mut dyn FnMut() -> Result<(), Interrupted>,
    ) -> Result<Node, Interrupted> {
        go_on()?;
        if count <= few {
            return Ok(Node::Few { first, count: count as u16 });
        }
        let content = match halves(first, count) {
            None => Content::Triangle(self.order[first as usize]),
            Some([(low, below), (high, above)]) => {
                let low = self.store(low, below, few, go_on)?;
                Content::Parts([low, self.store(high, above, few, go_on)?])
            }
        };
        self.balls.push(self.enclosing_ball(first, count, content));
        Ok(Node::Stored(self.balls.len() as u32 - 1))
    }

    /// A ball, put into `made` unless it is stored.
    #[inline]
    fn ball<'a>(&'a self, node: Node, made: &'a mut Option<Ball>) -> &'a Ball {
        match node {
            Node::Stored(i) => &self.balls[i as usize],
            Node::Few { first, count } => self.make_ball(first, count, made),
        }
    }

    // Out of the way of small meshes.
    #[cold]
    fn make_ball<'a>(&self, first: u32, count: u16, made: &'a mut Option<Ball>) -> &'a Ball {
        let content = match halves(first, count.into()) {
            None => Content::Triangle(self.order[first as usize]),
            Some(parts) => {
                Content::Parts(parts.map(|(first, count)| Node::Few { first, count: count as u16 }))
            }
        };
        made.insert(self.enclosing_ball(first, count.into(), content))
    }

    /// A ball around `count` triangles from the place `first` of the order on, about the middle of their box.
    fn enclosing_ball(&self, first: u32, count: u32, content: Content) -> Ball {
        let triangles = &self.order[first as usize..][..count as usize];
        let (mut low, mut high) = (Point3::from([f64::INFINITY; 3]), Point3::from([f64::NEG_INFINITY; 3]));
        for &i in triangles {
            let round = Vector3::repeat(self.rounding(i));
            for p in self.triangle(i, &mut None) {
                (low, high) = (low.inf(&(p - round)), high.sup(&(p + round)));
            }
        }
        let center = nalgebra::center(&low, &high);
        let (mut radius, mut reach) = (0.0_f64, 0.0_f64);
        for &i in triangles {
            let (mut far, mut from_origin) = (0.0_f64, 0.0_f64);
            for p in self.triangle(i, &mut None) {
                far = far.max((p - center).norm_squared());
                from_origin = from_origin.max(p.coords.norm_squared());
            }
            let round = self.rounding(i);
            (radius, reach) = (radius.max(far.sqrt() + round), reach.max(from_origin.sqrt() + round));
        }
        Ball { center, radius, half: (high - center).sup(&(center - low)), reach, content }
    }

    /// The radius of the ball around a triangle that is a single point; 0 for others.
    #[inline]
    fn rounding(&self, i: u32) -> f64 {
        let balls = self.mesh.balls();
        let next = balls.partition_point(|(range, _)| range.end <= i);
        balls.get(next).filter(|(range, _)| range.contains(&i)).map_or(0.0, |(_, radius)| *radius)
    }

    /// A triangle, put into `made` unless it is stored.
    #[inline]
    fn triangle<'a>(&'a self, i: u32, made: &'a mut Option<Triangle>) -> &'a Triangle {
        match self.triangles.get(i as usize) {
            Some(triangle) => triangle,
            None => self.make_triangle(i, made),
        }
    }

    #[cold]
    fn make_triangle<'a>(&self, i: u32, made: &'a mut Option<Triangle>) -> &'a Triangle {
        made.insert(self.mesh.triangle(i as usize))
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
        self.at_least_from(pose_wa, other, pose_wb, [enough; 2], &mut Hint::default())
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
        self.search(pose_wa, other, pose_wb, enough).map_or(0.0, |mut search| search.run())
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
        Some(Search {
            a: self,
            b: other,
            pose_ab,
            spread: pose_ab.rotation.matrix().abs(),
            touching,
            best,
            passed: f64::INFINITY,
            any: false,
            hint: Hint::default(),
        })
    }
}

/// One search for the smallest distance.
struct Search<'a> {
    a: &'a RefMesh,
    b: &'a RefMesh,
    pose_ab: IsometryMatrix3<f64>,
    /// The absolute values of its rotation: times the half sides of a box of `b` those of the box around it along the axes of `a`.
    spread: Matrix3<f64>,
    touching: f64,
    /// The smallest distance so far; at first, the distance that is enough.
    best: f64,
    /// The least bound of what was not looked at.
    passed: f64,
    /// Whether the first distance below `enough` ends the search.
    any: bool,
    /// What the last search left, and this one leaves for the next one.
    hint: Hint,
}

impl Search<'_> {
    /// The distance found, 0 for touching; a lower bound when the roots are farther apart than is enough.
    fn run(&mut self) -> f64 {
        let (root_a, root_b) = (self.a.root, self.b.root);
        let bound = self.bound(root_a, root_b);
        if bound >= self.best {
            return bound;
        }
        if let Some(found) = self.by_hint() {
            return found;
        }
        if self.any {
            let bound = self.parts_apart();
            if bound >= self.best {
                return bound;
            }
            let bound = self.by_axis(self.best, self.best);
            if bound >= self.best {
                return bound;
            }
        }
        self.visit(root_a, root_b);
        self.found()
    }

    /// The distance found, 0 for touching.
    fn found(&self) -> f64 {
        if self.best <= self.touching { 0.0 } else { self.best }
    }

    /// A lower bound on the distance by an axis between the corners, as good as it gets below `enough` where the distance is at least
    /// `least`; at most 0 where there is no such axis.
    fn by_axis(&mut self, least: f64, enough: f64) -> f64 {
        let (a, b) = (&self.a.corners, &self.b.corners);
        let limits = [least, enough].map(|x| x + self.touching);
        axis::separation(a, b, &self.pose_ab, limits, &mut self.hint.apart) - self.touching
    }

    /// The distance of two triangles, or of the corners of one from a box.
    fn distance_of(&self, near: [u32; 2]) -> f64 {
        if let Some(distance) = self.corners_from_box(near) {
            return distance;
        }
        let [k, l] = near;
        let (mut made_a, mut made_b) = (None, None);
        let (a, b) = (self.a.triangle(k, &mut made_a), self.b.triangle(l, &mut made_b));
        let distance = match self.a.is_balls && self.b.is_balls {
            true => (self.pose_ab * b[0] - a[0]).norm(),
            false => triangle_distance(a, &b.map(|p| self.pose_ab * p)),
        };
        distance - self.a.rounding(k) - self.b.rounding(l)
    }

    /// A lower bound on the distance of the triangles of two balls.
    fn bound(&self, i: Node, j: Node) -> f64 {
        if let Some(bound) = self.bound_by_box(i, j) {
            return bound;
        }
        let (mut made_a, mut made_b, mut made) = (None, None, None);
        let (ball_a, ball_b) = (self.a.ball(i, &mut made_a), self.b.ball(j, &mut made_b));
        // From the second ball to the first.
        let way = self.pose_ab * ball_b.center - ball_a.center;
        // For a ball against a single triangle that is no point, the triangle itself is the better bound.
        let distance = match (ball_a.content, ball_b.content) {
            (Content::Triangle(k), Content::Parts(_)) if !self.a.is_balls => {
                let triangle = self.a.triangle(k, &mut made);
                let distance = point_triangle(&(self.pose_ab * ball_b.center), triangle);
                distance - ball_b.radius - self.a.rounding(k)
            }
            (Content::Parts(_), Content::Triangle(l)) if !self.b.is_balls => {
                let center = self.pose_ab.inverse_transform_point(&ball_a.center);
                point_triangle(&center, self.b.triangle(l, &mut made)) - ball_a.radius - self.b.rounding(l)
            }
            _ => way.norm() - ball_a.radius - ball_b.radius,
        };
        if distance - self.touching >= self.best {
            return distance - self.touching;
        }
        // The boxes around the triangles, each beside a box along its axes around the other.
        let turn = self.pose_ab.rotation.matrix();
        let beyond = |way: Vector3<f64>, half: Vector3<f64>, other: Vector3<f64>| {
            (way.abs() - half - other).sup(&Vector3::zeros()).norm()
        };
        let in_a = beyond(way, ball_a.half, self.spread * ball_b.half);
        let in_b = beyond(turn.tr_mul(&way), ball_b.half, self.spread.tr_mul(&ball_a.half));
        distance.max(in_a).max(in_b) - self.touching
    }

    /// The parts of the larger of two balls, each with the other ball.
    ///
    /// # Errors
    /// The triangles, where each ball holds one.
    #[inline]
    fn split(&self, i: Node, j: Node) -> Result<[(Node, Node); 2], [u32; 2]> {
        if let Some(parts) = self.split_beside_box(i, j) {
            return Ok(parts);
        }
        let (mut made_a, mut made_b) = (None, None);
        let (ball_a, ball_b) = (self.a.ball(i, &mut made_a), self.b.ball(j, &mut made_b));
        Ok(match (ball_a.content, ball_b.content) {
            (Content::Triangle(k), Content::Triangle(l)) => return Err([k, l]),
            (Content::Parts(parts), Content::Parts(_)) if ball_a.radius >= ball_b.radius => {
                parts.map(|part| (part, j))
            }
            (_, Content::Parts(parts)) => parts.map(|part| (i, part)),
            (Content::Parts(parts), Content::Triangle(_)) => parts.map(|part| (part, j)),
        })
    }

    /// Lowers `best` to the distance of the triangles of two balls, if that is smaller.
    /// Returns whether the search is over.
    fn visit(&mut self, i: Node, j: Node) -> bool {
        match self.beside_box(i, j) {
            Some(Beside::At(near, distance)) => return self.offer(near, distance),
            Some(Beside::Apart(bound)) => {
                self.passed = self.passed.min(bound);
                return false;
            }
            None => {}
        }
        let pairs = match self.split(i, j) {
            Ok(pairs) => pairs,
            Err(near) => return self.offer(near, self.distance_of(near)),
        };
        let mut bounds = pairs.map(|(k, l)| (self.bound(k, l), k, l));
        if bounds[1].0 < bounds[0].0 {
            bounds.swap(0, 1);
        }
        for (bound, k, l) in bounds {
            if bound >= self.best {
                self.passed = self.passed.min(bound);
            } else if self.visit(k, l) {
                return true;
            }
        }
        false
    }

    /// A distance of triangles. Returns whether the search is over.
    fn offer(&mut self, near: [u32; 2], distance: f64) -> bool {
        let nearer = distance < self.best;
        if nearer {
            self.best = distance;
            self.hint.near = Some(near);
        } else {
            self.passed = self.passed.min(distance);
        }
        self.best <= self.touching || (nearer && self.any)
    }
}

/// How many triangles a ball must be around to be stored.
fn few_of(mesh: &TriMesh) -> u32 {
    if mesh.triangles().len() > LARGE { FEW } else { 0 }
}

/// Whether `pose` is a rigid motion within the limits, for meshes of that size.
fn is_usable(pose: &Isometry3<f64>, size: f64) -> bool {
    let rigid = (pose.rotation.quaternion().norm() - 1.0).abs() < 1e-6;
    rigid && pose.translation.vector.norm() + size < 1e75
}

/// Where the halves of `count` triangles from the place `first` on begin, and their numbers; `None` for a single triangle.
fn halves(first: u32, count: u32) -> Option<[(u32, u32); 2]> {
    let half = count / 2;
    (count > 1).then_some([(first, half), (first + half, count - half)])
}

/// How many balls of the tree of `count` triangles are around more than `few`.
fn larger_balls(count: usize, few: usize) -> usize {
    match count {
        _ if count <= few => 0,
        1 => 1,
        _ => 1 + larger_balls(count / 2, few) + larger_balls(count - count / 2, few),
    }
}

/// The corners, each once, in order; none when there are too many to look for an axis.
fn distinct(corners: impl Iterator<Item = Point3<f64>>) -> Vec<Point3<f64>> {
    // A zero is written in two ways, so that a place may be found up to eight times.
    let most = 8 * axis::MOST_CORNERS;
    let mut seen = HashSet::new();
    for p in corners {
        seen.insert([p.x, p.y, p.z].map(f64::to_bits));
        if seen.len() > most {
            return Vec::new();
        }
    }
    let mut corners: Vec<_> = seen.into_iter().map(|p| Point3::from(p.map(f64::from_bits))).collect();
    corners.sort_by(|p, q| p.iter().zip(q.iter()).fold(Ordering::Equal, |o, (x, y)| o.then(x.total_cmp(y))));
    corners.dedup();
    if corners.len() > axis::MOST_CORNERS { Vec::new() } else { corners }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::primitives;

    /// One mesh with a tree for each number of balls stored; the first one stores them all.
    fn trees(mesh: &TriMesh) -> [RefMesh; 4] {
        let trees = [0, 1, FEW, 1000].map(|few| RefMesh::storing(mesh, few, &mut || Ok(())).unwrap());
        let (all, stored) = (2 * mesh.triangles().len() - 1, trees.each_ref().map(|tree| tree.balls.len()));
        assert!(stored[0] == all && stored[1] < all && stored[2] < all / 3, "{stored:?}");
        let counted = |few| larger_balls(mesh.triangles().len(), few as usize);
        assert_eq!(stored, [0, 1, FEW, 1000].map(counted));
        trees
    }

    #[test]
    fn answers_do_not_depend_on_which_balls_are_stored() {
        let ring = trees(&primitives::torus(0.8, 0.1, 24, 13).unwrap());
        // Coarse beside fine, and two triangles in one place.
        let bar = primitives::cuboid(1.4, 0.1, 0.2).unwrap();
        let ball = primitives::sphere(0.2, 2).unwrap().transformed(&Isometry3::translation(0.8, 0.0, 0.0));
        let body = trees(&TriMesh::merged([&bar, &ball, &bar]).unwrap());
        let bits = |found: Result<f64, f64>| (found.is_ok(), found.map_or_else(f64::to_bits, f64::to_bits));
        let (mut free, mut hit) = (0, 0);
        for i in 0..150 {
            let x = f64::from(i);
            let wave = |k: f64| mp_math::sin(k * x);
            let from =
                mp_geom::pose_from_six([1.3 * wave(0.7), 1.3 * wave(1.1), wave(0.3), x, 2.0 * x, 0.3 * x]);
            let by = Vector3::new(wave(0.9), wave(1.7), 0.1);
            let pose_at =
                |t: f64| Isometry3::from_parts((from.translation.vector + by * t).into(), from.rotation);
            let here = Isometry3::identity();
            let answers: Vec<_> = [(0, 0), (2, 2), (1, 3), (3, 1), (0, 2), (3, 0)]
                .into_iter()
                .map(|(k, l)| {
                    let (a, b) = (&body[k], &ring[l]);
                    let mut pairs = Vec::new();
                    a.any_near_pair(&from, b, &here, |k, l| {
                        pairs.push((k, l));
                        false
                    });
                    let mut sweep = Sweep::default();
                    let swept = match sweep.sweep(a, pose_at, b, 1e-3, 1e-3) {
                        SweepCheck::Free { clearance } => (0, clearance.to_bits()),
                        SweepCheck::Collision { at } => (1, at.to_bits()),
                        SweepCheck::TooClose { at } => (2, at.to_bits()),
                    };
                    let clearances = [0.0, 0.05, f64::INFINITY]
                        .map(|enough| a.clearance(&from, b, &here, enough).to_bits());
                    (clearances, bits(a.at_least(&from, b, &here, 0.05)), swept, sweep.compared(), pairs)
                })
                .collect();
            assert!(answers.iter().all(|answer| *answer == answers[0]), "{i}: {answers:?}");
            if answers[0].2.0 == 0 { free += 1 } else { hit += 1 }
        }
        assert!(free > 30 && hit > 30, "{free} {hit}");
    }

    #[test]
    fn corners_are_listed_once_unless_there_are_too_many() {
        let [a, b] = [Point3::new(-0.0, 5.0, 1.0), Point3::new(0.0, 5.0, 1.0)];
        let between = Point3::new(0.0, 3.0, 1.0);
        let bits = |points: Vec<Point3<f64>>| {
            points.into_iter().map(|p| <[f64; 3]>::from(p).map(f64::to_bits)).collect::<Vec<_>>()
        };
        assert_eq!(bits(distinct([b, a, a, b, b].into_iter())), bits(vec![a]));
        // In order, equal places are not beside each other here.
        assert_eq!(bits(distinct([b, between, a, b].into_iter())), bits(vec![a, between, b]));
        let row = |n: usize| (0..3 * n).map(move |i| Point3::new((i % n) as f64, 0.0, 0.0));
        assert_eq!(distinct(row(axis::MOST_CORNERS)).len(), axis::MOST_CORNERS);
        assert!(distinct(row(axis::MOST_CORNERS + 1)).is_empty());
        assert!(distinct(row(100 * axis::MOST_CORNERS)).is_empty());
    }
}
