//! Meshes that are boxes along the axes of their frame: the distance of a point from all of their triangles is a formula.

use super::{Ball, Content, Node, RefMesh, Search, Triangle};
use mp_geom::TriMesh;
use nalgebra::{Point3, Vector3};

/// Stands for all triangles of a box.
pub(super) const WHOLE: u32 = u32::MAX;

/// The sides of a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cuboid {
    pub(super) middle: Point3<f64>,
    pub(super) half: Vector3<f64>,
}

impl Cuboid {
    /// The box that the triangles of a mesh are: two on each of its six sides, which meet in a diagonal.
    pub(super) fn of(mesh: &TriMesh) -> Option<Self> {
        if mesh.triangles().len() != 12 || mesh.rounding().is_some() {
            return None;
        }
        let points = || (0..12).flat_map(|i| mesh.triangle(i));
        let (low, high) =
            points().fold((points().next()?, points().next()?), |(low, high), p| (low.inf(&p), high.sup(&p)));
        // Of each side, which corners its triangles leave out, by the two other coordinates.
        let mut left_out = [const { Vec::new() }; 6];
        for i in 0..12 {
            // Whether each coordinate of a corner is the larger one.
            let corner = |p: &Point3<f64>| {
                let upper = [0, 1, 2].map(|k| p[k] == high[k]);
                (0..3).all(|k| upper[k] || p[k] == low[k]).then_some(upper)
            };
            let [p, q, r] = mesh.triangle(i).each_ref().map(corner);
            let corners = [p?, q?, r?];
            let side = (0..3).find(|&k| corners.iter().all(|c| c[k] == corners[0][k]))?;
            let others = [(side + 1) % 3, (side + 2) % 3];
            let mut free = [[false, false], [false, true], [true, false], [true, true]].to_vec();
            free.retain(|place| corners.iter().all(|c| others.map(|k| c[k]) != *place));
            let [place] = free[..] else { return None };
            left_out[2 * side + usize::from(corners[0][side])].push(place);
        }
        let is_covered = |side: &Vec<[bool; 2]>| match side[..] {
            [[a, b], [c, d]] => a != c && b != d,
            _ => false,
        };
        let middle = nalgebra::center(&low, &high);
        left_out.iter().all(is_covered).then(|| Self { middle, half: (high - middle).sup(&(middle - low)) })
    }

    /// The distance of a point from the sides.
    pub(super) fn distance(&self, p: &Point3<f64>) -> f64 {
        let beyond = (p - self.middle).abs() - self.half;
        let outside = beyond.sup(&Vector3::zeros()).norm();
        if outside > 0.0 { outside } else { -beyond.max() }
    }

    /// The shortest vector from the box to a point outside; `None` inside.
    pub(super) fn way_to(&self, p: &Point3<f64>) -> Option<Vector3<f64>> {
        let from_middle = p - self.middle;
        let beyond = (from_middle.abs() - self.half).sup(&Vector3::zeros());
        (beyond != Vector3::zeros()).then(|| beyond.zip_map(&from_middle, f64::copysign))
    }

    /// The least distance of the corners of a triangle from the sides.
    fn nearest(&self, corners: &Triangle) -> f64 {
        corners.iter().map(|p| self.distance(p)).fold(f64::INFINITY, f64::min)
    }

    /// A lower bound on the distance of a triangle: that of the box around it; 0 where the boxes overlap.
    fn apart(&self, [p, q, r]: &Triangle) -> f64 {
        let (low, high) = (p.inf(q).inf(r) - self.middle, p.sup(q).sup(r) - self.middle);
        (low - self.half).sup(&(-high - self.half)).sup(&Vector3::zeros()).norm()
    }
}

/// What settles a triangle beside a box.
pub(super) enum Beside {
    /// The distance of two triangles, of which one is [`WHOLE`].
    At([u32; 2], f64),
    /// It is at least so far away.
    Apart(f64),
}

/// A ball of one mesh beside all of a box.
struct BesideBox<'a> {
    cuboid: &'a Cuboid,
    /// Whether the box is the second mesh.
    is_second: bool,
    ball: &'a Ball,
}

impl Search<'_> {
    /// A ball beside a whole box, if one of two balls is around all of a box. Of two boxes the second counts.
    #[inline]
    fn boxed<'a>(&'a self, i: Node, j: Node, made: &'a mut Option<Ball>) -> Option<BesideBox<'a>> {
        match (&self.a.cuboid, &self.b.cuboid) {
            (_, Some(cuboid)) if j == self.b.root => {
                Some(BesideBox { cuboid, is_second: true, ball: self.a.ball(i, made) })
            }
            (Some(cuboid), _) if i == self.a.root => {
                Some(BesideBox { cuboid, is_second: false, ball: self.b.ball(j, made) })
            }
            _ => None,
        }
    }

    /// A point of the one mesh in the frame of the other one, which is the box.
    #[inline]
    fn to_box(&self, p: &Point3<f64>, is_second: bool) -> Point3<f64> {
        if is_second { self.pose_ab.inverse_transform_point(p) } else { self.pose_ab * p }
    }

    /// A lower bound on the distance of the triangles of a ball from a box; `None` where there is no whole box.
    #[inline]
    pub(super) fn bound_by_box(&self, i: Node, j: Node) -> Option<f64> {
        let mut made = None;
        let BesideBox { cuboid, is_second, ball } = self.boxed(i, j, &mut made)?;
        Some(cuboid.distance(&self.to_box(&ball.center, is_second)) - ball.radius - self.touching)
    }

    /// Where a ball is to be taken apart, and not the box beside it: its parts, each with the box.
    #[inline]
    pub(super) fn split_beside_box(&self, i: Node, j: Node) -> Option<[(Node, Node); 2]> {
        let mut made = None;
        let BesideBox { is_second, ball, .. } = self.boxed(i, j, &mut made)?;
        let Content::Parts(parts) = ball.content else { return None };
        Some(parts.map(|part| if is_second { (part, j) } else { (i, part) }))
    }

    /// Whether a single triangle is settled beside a box: one that is a point, one whose own box is at least as far as is looked for, or one of
    /// which a corner is nearer than the least so far where the first such ends the search.
    pub(super) fn beside_box(&self, i: Node, j: Node) -> Option<Beside> {
        let mut made = None;
        let BesideBox { is_second, ball, .. } = self.boxed(i, j, &mut made)?;
        let Content::Triangle(k) = ball.content else { return None };
        let near = if is_second { [k, WHOLE] } else { [WHOLE, k] };
        let (corners, cuboid, rounding) = self.in_box(near)?;
        let distance = cuboid.nearest(&corners) - rounding;
        if (corners[0] == corners[1] && corners[1] == corners[2]) || (self.any && distance < self.best) {
            return Some(Beside::At(near, distance));
        }
        let bound = cuboid.apart(&corners) - rounding - self.touching;
        (bound >= self.best).then_some(Beside::Apart(bound))
    }

    /// The triangle that is not [`WHOLE`] in the frame of the box that is, that box, and the radius of the ball around a triangle that is a point.
    fn in_box(&self, near: [u32; 2]) -> Option<(Triangle, &Cuboid, f64)> {
        let (mesh, k, cuboid, is_second) = match (near, &self.a.cuboid, &self.b.cuboid) {
            ([k, WHOLE], _, Some(cuboid)) => (self.a, k, cuboid, true),
            ([WHOLE, l], Some(cuboid), _) => (self.b, l, cuboid, false),
            _ => return None,
        };
        let corners = mesh.triangle(k, &mut None).map(|p| self.to_box(&p, is_second));
        Some((corners, cuboid, mesh.rounding(k)))
    }

    /// The least distance of the corners of a triangle from a box; `None` where neither is a box.
    pub(super) fn corners_from_box(&self, near: [u32; 2]) -> Option<f64> {
        self.in_box(near).map(|(corners, cuboid, rounding)| cuboid.nearest(&corners) - rounding)
    }

    /// Whether these are numbers of triangles of both meshes, or one stands for a box.
    pub(super) fn knows(&self, [k, l]: [u32; 2]) -> bool {
        let has = |mesh: &RefMesh, i: u32| (i as usize) < mesh.mesh.triangles().len();
        match (k, l) {
            (WHOLE, l) => self.a.cuboid.is_some() && has(self.b, l),
            (k, WHOLE) => self.b.cuboid.is_some() && has(self.a, k),
            (k, l) => has(self.a, k) && has(self.b, l),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::primitives;
    use nalgebra::Isometry3;

    fn changed(mesh: &TriMesh, change: impl FnOnce(&mut Vec<[u32; 3]>)) -> TriMesh {
        let mut triangles = mesh.triangles().to_vec();
        change(&mut triangles);
        TriMesh::new(mesh.vertices().to_vec(), triangles).unwrap()
    }

    #[test]
    fn only_whole_boxes_are_boxes() {
        let cuboid = primitives::cuboid(1.0, 2.0, 0.5).unwrap();
        let found = Cuboid::of(&cuboid).unwrap();
        assert_eq!(found.half, Vector3::new(0.5, 1.0, 0.25));
        let moved = cuboid.transformed(&Isometry3::translation(0.3, -1.0, 7.0));
        assert!(Cuboid::of(&moved).is_some());
        // Turned, with a hole, with a side covered twice on one half, and what has twelve triangles by chance.
        assert!(Cuboid::of(&cuboid.transformed(&Isometry3::rotation(Vector3::new(0.1, 0.2, 0.3)))).is_none());
        for i in 0..12 {
            assert!(Cuboid::of(&changed(&cuboid, |t| t[i] = t[(i + 1) % 12])).is_none());
            assert!(Cuboid::of(&changed(&cuboid, |t| t[i].swap(0, 1))).is_some(), "the same place");
        }
        assert!(Cuboid::of(&changed(&cuboid, |t| t.truncate(11))).is_none());
        assert!(Cuboid::of(&primitives::cylinder(0.5, 1.0, 3).unwrap()).is_none());
    }

    #[test]
    fn points_are_as_far_from_a_box_as_from_its_triangles() {
        let mesh =
            primitives::cuboid(1.0, 2.0, 0.5).unwrap().transformed(&Isometry3::translation(0.3, -1.0, 0.7));
        let cuboid = Cuboid::of(&mesh).unwrap();
        for i in 0..500 {
            let t = f64::from(i);
            let p = Point3::new(
                mp_math::sin(t),
                -1.0 + 1.5 * mp_math::cos(1.3 * t),
                0.7 + 0.6 * mp_math::sin(0.7 * t),
            );
            let plain = (0..12)
                .map(|k| super::super::point_triangle(&p, &mesh.triangle(k)))
                .fold(f64::INFINITY, f64::min);
            assert!((cuboid.distance(&p) - plain).abs() < 1e-12, "{p}");
        }
    }

    /// Distances from a box are those from the same box that is not known to be one.
    #[test]
    fn boxes_are_no_other_meshes() {
        let cuboid = primitives::cuboid(0.4, 0.5, 0.9).unwrap();
        let known = RefMesh::new(&cuboid);
        let mut plain = RefMesh::new(&cuboid);
        assert!(plain.cuboid.take().is_some());
        let balls =
            TriMesh::of_balls((0..40).map(|i| Point3::new(0.02 * f64::from(i), 0.0, 0.1)).collect(), 0.03);
        let others = [primitives::torus(0.5, 0.1, 24, 12).unwrap(), balls.unwrap(), cuboid];
        let (mut near, mut apart) = (0, 0);
        for (i, other) in others.iter().map(RefMesh::new).enumerate() {
            for k in 0..200 {
                let t = f64::from(k) + i as f64;
                let shift = Vector3::new(mp_math::sin(t), mp_math::cos(1.3 * t), mp_math::sin(0.7 * t)) * 0.9;
                let (here, pose) = (
                    Isometry3::translation(0.1, 0.0, 0.2),
                    Isometry3::new(shift, Vector3::new(t, 0.3 * t, -t)),
                );
                for (a, b, c, d) in [(&known, &other, &plain, &other), (&other, &known, &other, &plain)] {
                    let distances =
                        [(a, b), (c, d)].map(|(a, b)| a.clearance(&here, b, &pose, f64::INFINITY));
                    assert!((distances[0] - distances[1]).abs() < 1e-12, "{distances:?}");
                    for enough in [0.01, 0.2] {
                        let found = a.at_least(&here, b, &pose, enough);
                        assert_eq!(found.is_ok(), c.at_least(&here, d, &pose, enough).is_ok());
                        if found.is_ok() { apart += 1 } else { near += 1 }
                    }
                }
            }
        }
        assert!(near > 300 && apart > 300, "{near} {apart}");
    }
}
