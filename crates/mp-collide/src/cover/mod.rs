//! Covers: a few balls that together contain the surface of a mesh. They decide most questions about distance, before trees of triangles are
//! looked at.
//!
//! What keeps a distance from all balls keeps it from the mesh. What balls leave undecided is for [`Query`](crate::Query).

mod wide;

pub(crate) use wide::{ALL, LARGEST};
pub use wide::{Contacts, WideCover, wide_apart, wide_apart_here, wide_within, wide_within_here};

use crate::pose::rotation_matrix;
use mp_geom::{Sphere, TriMesh, minimal_sphere};
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use std::ops::Range;

/// The most groups of balls, and the most balls of a group.
pub const MOST_BALLS: usize = 8;

/// Balls are divided until they reach out of the hull of their mesh by no more than this part of its radius.
const FINE: f64 = 0.015;

/// How much a ball counts for its size alone: in hollows balls inside of the hull reach out of the surface.
const HOLLOW: f64 = 0.1;

/// Triangles are cut until no edge is longer than this part of the radius, so that balls need not contain whole long triangles.
const PIECE: f64 = 0.2;

/// Surfaces of more pieces are cut across their longest axis only, without trying the others, and their balls are not the smallest.
const LARGE: usize = 3000;

/// A group of at most this many balls is not divided, in the cover of a mesh of balls.
const FEW: usize = 3;

/// Larger meshes (m) have one ball.
const LARGEST_RADIUS: f64 = 1e70;

/// Meshes of more corners have one ball: fitting more would take long.
const MOST_CORNERS: usize = 300_000;

/// Balls are enlarged, and distances diminished, by this part of the coordinates, far more than their rounding.
pub(crate) const ROUNDING: f64 = 1e-12;

/// Balls that together contain the surface of a mesh: a hierarchy of two levels, at most [`MOST_BALLS`] groups of at most [`MOST_BALLS`] balls,
/// with a ball around each group.
#[derive(Clone, Debug)]
pub struct Cover {
    groups: Vec<Group>,
    balls: Vec<Sphere>,
    excess: f64,
    is_exact: bool,
}

/// Balls beside each other.
#[derive(Clone, Debug)]
struct Group {
    /// Around the surface that they cover.
    around: Sphere,
    balls: Range<usize>,
}

impl Cover {
    /// Fits balls to `mesh`, at most [`MOST_BALLS`] groups of as many: the ball that reaches out farthest is divided across one of three
    /// axes, again and again. None for meshes of more than a hundred thousand triangles. O(n) for n triangles. Of a mesh of
    /// [balls](TriMesh::balls) they are its own balls; none where these are more.
    #[must_use]
    pub fn new(mesh: &TriMesh) -> Self {
        let radius = mesh.bounding_sphere().radius;
        let mut cover =
            Self { groups: Vec::new(), balls: Vec::new(), excess: f64::INFINITY, is_exact: false };
        if mesh.is_balls() && radius < LARGEST_RADIUS && mesh.triangles().len() <= MOST_BALLS * MOST_BALLS {
            return Self::of_balls(mesh.each_ball().collect());
        }
        // Written so that NaN is refused.
        let is_usual = radius > 0.0 && radius < LARGEST_RADIUS && mesh.rounding().is_none();
        let pieces = if is_usual { pieces(mesh, PIECE * radius) } else { None };
        let Some(pieces) = pieces else { return cover };
        let hull = Hull::new(mesh.vertices());
        for group in divided(Part::new(pieces, &hull), &hull, FINE * radius) {
            let (around, first) = (group.least_ball(), cover.balls.len());
            let parts = divided(group, &hull, FINE * radius);
            cover.balls.extend(parts.iter().map(Part::least_ball));
            cover.groups.push(Group { around, balls: first..cover.balls.len() });
        }
        cover.excess = cover.balls.iter().map(|ball| hull.excess(ball)).fold(0.0, f64::max);
        cover
    }

    /// Balls that are the mesh themselves, at least one: the longest group of more than [`FEW`] is halved, until there are enough groups.
    fn of_balls(balls: Vec<Sphere>) -> Self {
        let mut parts = vec![balls];
        let sides = |part: &[Sphere]| {
            let centers = || part.iter().map(|ball| ball.center);
            let first = part[0].center;
            let (low, high) = centers().fold((first, first), |(low, high), p| (low.inf(&p), high.sup(&p)));
            high - low
        };
        while parts.len() < MOST_BALLS {
            let length = |i: &usize| sides(&parts[*i]).max();
            let many = (0..parts.len()).filter(|i| parts[*i].len() > FEW);
            let Some(longest) = many.max_by(|i, j| length(i).total_cmp(&length(j))) else { break };
            let mut part = parts.swap_remove(longest);
            let axis = sides(&part).imax();
            part.sort_by(|a, b| a.center[axis].total_cmp(&b.center[axis]));
            let other = part.split_off(part.len() / 2);
            parts.extend([part, other]);
        }
        let (mut groups, mut balls) = (Vec::new(), Vec::new());
        for part in parts {
            let middle = part.iter().map(|ball| ball.center.coords).sum::<Vector3<f64>>() / part.len() as f64;
            let center = Point3::from(middle);
            let reach = |ball: &Sphere| (ball.center - center).norm() + ball.radius;
            let radius = part.iter().map(reach).fold(0.0, f64::max);
            groups.push(Group {
                around: enlarged(Sphere { center, radius }),
                balls: balls.len()..balls.len() + part.len(),
            });
            balls.extend(part);
        }
        Self { groups, balls, excess: 0.0, is_exact: true }
    }

    /// Whether the balls are the mesh itself, not only around it.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.is_exact
    }

    /// The balls that cover the surface together: none where the ball around all is all there is.
    #[must_use]
    pub fn balls(&self) -> &[Sphere] {
        &self.balls
    }

    /// How far (m) the balls reach out of the convex hull of the mesh at most, in 26 directions.
    #[must_use]
    pub fn excess(&self) -> f64 {
        self.excess
    }
}

/// At most [`MOST_BALLS`] parts of a surface: the part whose ball reaches out farthest is divided, until none reaches out farther than `fine`
/// (m) and is large.
fn divided(whole: Part, hull: &Hull, fine: f64) -> Vec<Part> {
    let (ball, excess) = (whole.ball, whole.excess);
    let mut parts = vec![whole];
    while parts.len() < MOST_BALLS {
        let by_excess = |a: &usize, b: &usize| parts[*a].excess.total_cmp(&parts[*b].excess);
        let Some(worst) = (0..parts.len()).max_by(by_excess) else { break };
        if parts[worst].excess <= fine {
            break;
        }
        let Some(halves) = parts[worst].halves(hull) else { break };
        parts.swap_remove(worst);
        parts.extend(halves);
    }
    // One ball fits what is round better than several.
    if parts.len() > 1 && parts.iter().any(|part| part.excess >= excess) {
        let pieces = parts.into_iter().flat_map(|part| part.pieces).collect();
        return vec![Part { pieces, ball, excess }];
    }
    parts
}

/// A cover at a pose. Its balls are placed when they are first needed.
#[derive(Clone, Debug)]
pub struct PlacedCover {
    /// The ball around the whole mesh, in the world.
    pub(crate) around: Sphere,
    /// The balls around groups; none until they are needed.
    groups: Vec<Sphere>,
    balls: Vec<Sphere>,
    /// Bit i is set where the balls of group i are placed.
    are_placed: u32,
    pose: Isometry3<f64>,
    turn: Matrix3<f64>,
    /// Bodies that are near: scratch memory.
    pub(crate) near: Vec<u32>,
}

impl Default for PlacedCover {
    fn default() -> Self {
        let around = Sphere { center: Point3::origin(), radius: f64::NAN };
        let (pose, turn) = (Isometry3::identity(), Matrix3::identity());
        let (groups, balls, near) = (Vec::new(), Vec::new(), Vec::new());
        Self { around, groups, balls, are_placed: 0, pose, turn, near }
    }
}

impl PlacedCover {
    /// Puts a cover to `pose`, where `around` is the ball around the whole mesh in the world.
    #[inline]
    pub fn place(&mut self, around: Sphere, pose: &Isometry3<f64>) {
        (self.around, self.pose, self.are_placed) = (around, *pose, 0);
        self.groups.clear();
    }

    #[inline]
    fn placed(&self, ball: &Sphere) -> Sphere {
        let center = Point3::from(self.turn * ball.center.coords + self.pose.translation.vector);
        Sphere { center, radius: ball.radius }
    }

    /// Places the balls around the groups.
    #[inline]
    fn place_groups(&mut self, cover: &Cover) {
        if self.groups.is_empty() {
            self.turn = rotation_matrix(self.pose.rotation.quaternion());
            for group in &cover.groups {
                self.groups.push(self.placed(&group.around));
            }
            self.balls.resize(cover.balls.len(), self.around);
        }
    }

    /// Places the balls of a group; the groups are placed.
    #[inline]
    fn place_balls(&mut self, cover: &Cover, group: usize) -> Range<usize> {
        let range = cover.groups[group].balls.clone();
        if self.are_placed >> group & 1 == 0 {
            for i in range.clone() {
                self.balls[i] = self.placed(&cover.balls[i]);
            }
            self.are_placed |= 1 << group;
        }
        range
    }

    /// A lower bound on the distance of the mesh from something, given how far a ball is from it, if that is at least `enough`: of the ball
    /// around the mesh, else of those around groups of balls, and where one of these is less, of its balls.
    #[inline]
    pub(crate) fn apart_from(
        &mut self,
        cover: &Cover,
        enough: f64,
        gap: impl Fn(&Sphere) -> f64,
    ) -> Option<f64> {
        // Comparisons are written so that NaN is undecided.
        let all = gap(&self.around);
        if all >= enough {
            return Some(all);
        }
        if cover.groups.is_empty() {
            return None;
        }
        self.place_groups(cover);
        let mut least = f64::INFINITY;
        for group in 0..cover.groups.len() {
            let mut near = gap(&self.groups[group]);
            let clear = near >= enough;
            if !clear {
                near = f64::INFINITY;
                for i in self.place_balls(cover, group) {
                    let own = gap(&self.balls[i]);
                    let clear = own >= enough;
                    if !clear {
                        return None;
                    }
                    near = near.min(own);
                }
            }
            least = least.min(near);
        }
        Some(least)
    }

    /// A lower bound (m) on the distance of two meshes by their covers, if that is at least `enough` (m): by the balls around them, else by
    /// the smaller balls.
    pub fn apart(&mut self, own: &Cover, other: &mut Self, others: &Cover, enough: f64) -> Option<f64> {
        let size = self.around.center.coords.amax() + other.around.center.coords.amax();
        let rounding = ROUNDING * (size + self.around.radius + other.around.radius);
        let wanted = enough + rounding;
        let bound = gap(&self.around, &other.around);
        if bound >= wanted {
            return Some(bound - rounding);
        }
        if own.groups.is_empty() || others.groups.is_empty() {
            return None;
        }
        let around = other.around;
        self.place_groups(own);
        other.place_groups(others);
        let mut least = f64::INFINITY;
        for i in 0..own.groups.len() {
            let group = self.groups[i];
            let whole = gap(&group, &around);
            if whole >= wanted {
                least = least.min(whole);
                continue;
            }
            for j in 0..others.groups.len() {
                let near = gap(&group, &other.groups[j]);
                if near >= wanted {
                    least = least.min(near);
                    continue;
                }
                let b = other.place_balls(others, j);
                for ball in self.place_balls(own, i).map(|i| self.balls[i]) {
                    for other in &other.balls[b.clone()] {
                        let near = gap(&ball, other);
                        let clear = near >= wanted;
                        if !clear {
                            return None;
                        }
                        least = least.min(near);
                    }
                }
            }
        }
        Some(least - rounding)
    }
}

/// The ball with room for its rounding.
fn enlarged(ball: Sphere) -> Sphere {
    Sphere { radius: ball.radius + ROUNDING * (ball.radius + ball.center.coords.amax()), ..ball }
}

/// The distance of two balls; negative where they overlap.
#[inline]
fn gap(a: &Sphere, b: &Sphere) -> f64 {
    (a.center - b.center).norm() - a.radius - b.radius
}

/// The corners of a mesh's triangles, cut until no edge is longer than `longest`; `None` when they are too many.
fn pieces(mesh: &TriMesh, longest: f64) -> Option<Vec<[Point3<f64>; 3]>> {
    let mut open: Vec<[Point3<f64>; 3]> = (0..mesh.triangles().len()).map(|i| mesh.triangle(i)).collect();
    let mut pieces = Vec::new();
    while let Some(triangle) = open.pop() {
        if 3 * (pieces.len() + open.len()) > MOST_CORNERS {
            return None;
        }
        let length = |i: usize| (triangle[(i + 1) % 3] - triangle[i]).norm_squared();
        let long = (0..3).max_by(|i, j| length(*i).total_cmp(&length(*j))).unwrap_or(0);
        if length(long) <= longest * longest {
            pieces.push(triangle);
            continue;
        }
        let [p, q, r] = [0, 1, 2].map(|i| triangle[(long + i) % 3]);
        let middle = nalgebra::center(&p, &q);
        open.extend([[p, middle, r], [middle, q, r]]);
    }
    Some(pieces)
}

/// How far a set of points reaches in 26 directions: to the faces, edges and corners of a cube.
struct Hull(Vec<(Vector3<f64>, f64)>);

impl Hull {
    fn new(points: &[Point3<f64>]) -> Self {
        let steps = || [-1.0, 0.0, 1.0].into_iter();
        let all =
            steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| Vector3::new(x, y, z))));
        let directions = all.filter_map(|v| v.try_normalize(0.5));
        let reach =
            |u: &Vector3<f64>| points.iter().map(|p| p.coords.dot(u)).fold(f64::NEG_INFINITY, f64::max);
        Self(directions.map(|u| (u, reach(&u))).collect())
    }

    /// How far a ball reaches out of it.
    fn excess(&self, ball: &Sphere) -> f64 {
        let out = |(u, reach): &(Vector3<f64>, f64)| ball.center.coords.dot(u) + ball.radius - reach;
        self.0.iter().map(out).fold(0.0, f64::max)
    }
}

/// Pieces of a surface, and the ball around them.
struct Part {
    pieces: Vec<[Point3<f64>; 3]>,
    ball: Sphere,
    excess: f64,
}

impl Part {
    /// With the ball about the middle of the box around the pieces.
    fn new(pieces: Vec<[Point3<f64>; 3]>, hull: &Hull) -> Self {
        let corners = || pieces.iter().flatten();
        let first = pieces.first().map_or(Point3::origin(), |piece| piece[0]);
        let (low, high) = corners().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)));
        let center = nalgebra::center(&low, &high);
        let radius = corners().map(|p| (p - center).norm_squared()).fold(0.0, f64::max).sqrt();
        let ball = enlarged(Sphere { center, radius });
        let excess = hull.excess(&ball).max(HOLLOW * radius);
        Self { pieces, ball, excess }
    }

    /// The smallest ball, or of a large part the one it has.
    fn least_ball(&self) -> Sphere {
        if self.pieces.len() > LARGE {
            return self.ball;
        }
        let corners: Vec<Point3<f64>> = self.pieces.iter().flatten().copied().collect();
        let least = minimal_sphere(&corners).map(enlarged);
        least.filter(|ball| ball.radius < self.ball.radius).unwrap_or(self.ball)
    }

    /// Both halves, cut across the axis for which the larger excess of the two is least; `None` where no axis divides it.
    fn halves(&self, hull: &Hull) -> Option<[Self; 2]> {
        let middle = |piece: &[Point3<f64>; 3]| (piece[0].coords + piece[1].coords + piece[2].coords) / 3.0;
        let first = self.pieces.first().map_or(Vector3::zeros(), middle);
        let (low, high) =
            self.pieces.iter().map(middle).fold((first, first), |(l, h), m| (l.inf(&m), h.sup(&m)));
        let axes =
            if self.pieces.len() > LARGE { (high - low).imax()..(high - low).imax() + 1 } else { 0..3 };
        let halves = axes.filter_map(|k| {
            let cut = 0.5 * (low[k] + high[k]);
            let (below, above): (Vec<_>, Vec<_>) =
                self.pieces.iter().copied().partition(|piece| middle(piece)[k] < cut);
            let both = !below.is_empty() && !above.is_empty();
            both.then(|| [below, above].map(|pieces| Self::new(pieces, hull)))
        });
        let worse = |halves: &[Self; 2]| halves[0].excess.max(halves[1].excess);
        halves.min_by(|a, b| worse(a).total_cmp(&worse(b)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::primitives;

    fn meshes() -> Vec<TriMesh> {
        let turned = Isometry3::new(Vector3::new(0.3, -0.2, 1.0), Vector3::new(0.4, 1.0, -0.3));
        [
            primitives::cuboid(0.1, 0.2, 0.9),
            primitives::cylinder(0.06, 0.4, 32),
            primitives::torus(0.5, 0.1, 24, 12),
            primitives::sphere(0.2, 2),
        ]
        .map(|mesh| mesh.unwrap().transformed(&turned))
        .to_vec()
    }

    /// Every point of every triangle is in one of the balls: tried on a grid over each triangle.
    #[test]
    fn the_balls_contain_the_surface() {
        for mesh in meshes() {
            let cover = Cover::new(&mesh);
            assert!((1..=MOST_BALLS * MOST_BALLS).contains(&cover.balls().len()), "{}", cover.balls().len());
            let around = mesh.bounding_sphere();
            assert!(cover.excess() < 0.2 * around.radius, "{} {}", cover.excess(), around.radius);
            for i in 0..mesh.triangles().len() {
                let [a, b, c] = mesh.triangle(i);
                for (x, y) in (0..=20).flat_map(|x| (0..=20 - x).map(move |y| (x, y))) {
                    let [x, y] = [x, y].map(|k| f64::from(k) / 20.0);
                    let p = a + (b - a) * x + (c - a) * y;
                    let holds = |ball: &Sphere| (p - ball.center).norm() <= ball.radius + 1e-12;
                    assert!(cover.balls().iter().any(holds), "{p}");
                }
            }
        }
    }

    /// Covers never say that meshes are farther apart than they are, and small balls say more than large ones.
    #[test]
    fn covers_are_no_farther_apart_than_meshes() {
        let meshes = meshes();
        let covers: Vec<Cover> = meshes.iter().map(Cover::new).collect();
        let trees: Vec<crate::CollisionMesh> = meshes.iter().map(crate::CollisionMesh::new).collect();
        let (mut query, mut better) = (crate::Query::default(), 0);
        for k in 0..400 {
            let (i, j, t) = (k % 4, k / 4 % 4, k as f64);
            let shift = Vector3::new(mp_math::sin(t), mp_math::cos(1.3 * t), mp_math::sin(0.7 * t)) * 0.9;
            let pose = Isometry3::new(shift, Vector3::new(t, 0.3 * t, -t));
            let here = Isometry3::identity();
            let distance = query.distance(&trees[i], &here, &trees[j], &pose).distance;
            let (mut a, mut b) = (PlacedCover::default(), PlacedCover::default());
            let around = meshes[j].bounding_sphere();
            a.place(meshes[i].bounding_sphere(), &here);
            b.place(Sphere { center: pose * around.center, ..around }, &pose);
            let coarse = gap(&a.around, &b.around);
            for enough in [0.01, 0.1, 0.3] {
                let Some(bound) = a.apart(&covers[i], &mut b, &covers[j], enough) else { continue };
                assert!(bound >= enough && bound <= distance, "{bound} {distance}");
                better += usize::from(coarse < enough);
            }
        }
        assert!(better > 50, "{better}");
    }

    #[test]
    fn what_cannot_be_covered_has_one_ball() {
        let point = TriMesh::new(vec![Point3::origin(); 3], vec![[0, 1, 2]]).unwrap();
        let many = (0..65).map(|i| Point3::new(f64::from(i), 0.0, 0.0)).collect();
        let cloud = TriMesh::of_balls(many, 0.1).unwrap();
        for mesh in [point, cloud] {
            assert!(Cover::new(&mesh).balls().is_empty());
        }
    }

    /// Balls are their own cover: the bound on their distance is the distance.
    #[test]
    fn covers_of_balls_are_exact() {
        let mut query = crate::Query::default();
        for count in [1, 2, 5, 17, 64] {
            let at = |i: u32| {
                let t = f64::from(i);
                Point3::new(mp_math::sin(t), mp_math::cos(2.3 * t), 0.05 * t)
            };
            let one = |i: u32| TriMesh::of_balls(vec![at(i)], 0.02 + 0.01 * f64::from(i % 5)).unwrap();
            let mesh = TriMesh::merged(&(0..count).map(one).collect::<Vec<_>>()).unwrap();
            let (cover, tree) = (Cover::new(&mesh), crate::CollisionMesh::new(&mesh));
            assert!(cover.is_exact() && cover.excess() == 0.0 && cover.balls().len() == count as usize);
            let here = Isometry3::identity();
            for k in 0..50 {
                let t = f64::from(k);
                let shift = Vector3::new(mp_math::sin(t), mp_math::cos(1.3 * t), mp_math::sin(0.7 * t)) * 4.0;
                let pose = Isometry3::new(shift, Vector3::new(t, 0.3 * t, -t));
                let (mut a, mut b) = (PlacedCover::default(), PlacedCover::default());
                let around = mesh.bounding_sphere();
                a.place(around, &here);
                b.place(Sphere { center: pose * around.center, ..around }, &pose);
                let distance = query.clearance(&tree, &here, &tree, &pose, f64::INFINITY);
                let enough = distance * (1.0 - 1e-9);
                let bound = a.apart(&cover, &mut b, &cover, enough);
                assert!(bound.is_none_or(|bound| bound <= distance));
                assert!(distance == 0.0 || bound.is_some(), "{count} {distance}");
                assert!(a.apart(&cover, &mut b, &cover, distance + 1e-9).is_none_or(|_| distance == 0.0));
            }
        }
    }
}
