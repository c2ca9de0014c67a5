//! Over which part of a motion balls keep apart from a mesh, by the directions in which they move.

use super::{Ball, Content, Cuboid, Hint, Node, RefMesh, TOUCHING, axis, is_usable, triangle};
use nalgebra::{Isometry3, IsometryMatrix3, Point3, Vector3};

/// The share of a distance beyond what is needed that a motion may use up: what is left is clearance that is shown.
const USED: f64 = 0.7;

/// More than the rounding of velocities, as a part of how far points go at most.
const ROUNDING: f64 = 1e-9;

/// How the points of a mesh move over a part of a motion: from its middle, where the mesh is now, to its end, and as far back to its beginning.
/// Vectors are those of the world.
#[derive(Clone, Copy, Debug)]
pub struct Drift {
    /// A point that moves with the mesh.
    pub about: Point3<f64>,
    /// How far (m) that point would go to the end at the velocity that it has in the middle.
    pub velocity: Vector3<f64>,
    /// By which angles (rad) the mesh would turn about it meanwhile.
    pub turning: Vector3<f64>,
    /// How far (m) a point of the mesh is at both ends, at most, from where these two would have it; in between it grows as the square of the
    /// time from the middle. Infinite where that is not known.
    pub bent: f64,
    /// How far (m) a point of the mesh goes at most to either end; in between no more than in proportion.
    pub moved: f64,
}

impl Drift {
    /// Of what stays where it is.
    pub const STILL: Self = Self {
        about: Point3::new(0.0, 0.0, 0.0),
        velocity: Vector3::new(0.0, 0.0, 0.0),
        turning: Vector3::new(0.0, 0.0, 0.0),
        bent: 0.0,
        moved: 0.0,
    };

    /// The same in the frame with this pose.
    fn seen_from(&self, pose: &Isometry3<f64>) -> Self {
        Self {
            about: pose.inverse_transform_point(&self.about),
            velocity: pose.inverse_transform_vector(&self.velocity),
            turning: pose.inverse_transform_vector(&self.turning),
            ..*self
        }
    }

    /// How far a point would go to the end at its velocity in the middle.
    fn at(&self, p: &Point3<f64>) -> Vector3<f64> {
        self.velocity + self.turning.cross(&(p - self.about))
    }
}

/// Over which part of a motion something keeps apart.
#[derive(Clone, Copy, Debug)]
pub struct KeptApart {
    /// Which share of the way from the middle to the beginning, and to the end.
    pub shares: [f64; 2],
    /// A lower bound (m) on the distance there.
    pub clearance: f64,
    /// A lower bound (m) on the distance in the middle.
    pub now: f64,
    needed: f64,
}

impl KeptApart {
    /// All of it, before anything is looked at. The distance `needed` (m) is to be kept.
    #[must_use]
    pub fn new(needed: f64) -> Self {
        Self { shares: [1.0; 2], clearance: f64::INFINITY, now: f64::INFINITY, needed }
    }

    /// Whether something at least `bound` away, whose points go no farther than `moved`, allows the shares that were found so far. If so, it is
    /// taken into account.
    fn settles(&mut self, bound: f64, moved: f64) -> bool {
        let used = moved * self.shares[0].max(self.shares[1]);
        let is_enough = USED * (bound - self.needed) >= used;
        if is_enough {
            self.now = self.now.min(bound);
            self.clearance = self.clearance.min(bound - used);
        }
        is_enough
    }

    /// Takes something at that distance into account, which keeps apart over these shares, and over those that `moved` allows.
    fn take(&mut self, distance: f64, moved: f64, shares: [f64; 2]) {
        let beyond = distance - self.needed;
        self.now = self.now.min(distance);
        // Written so that nothing is free where something is not a number.
        let is_enough = beyond > 0.0;
        if !is_enough {
            self.shares = [0.0; 2];
            return;
        }
        let slow = USED * beyond / moved;
        let mut used: f64 = 0.0;
        for (least, share) in self.shares.iter_mut().zip(shares) {
            let share = share.max(slow) * (1.0 - ROUNDING);
            *least = least.min(share);
            used = used.max(*least / share);
        }
        self.clearance = self.clearance.min(self.needed + beyond * (1.0 - USED * used));
    }
}

impl RefMesh {
    /// Lowers `found` to the part of a motion over which this mesh, which is nothing but [balls](Self::is_balls), surely keeps its distance from
    /// `other`.
    ///
    /// The shortest way from a ball to a convex body is across a plane between them. Where the body stays, the ball is as far from that plane
    /// as before, but for its velocity across it, and its acceleration. A graze along a side takes nothing away.
    pub fn keeps_apart(
        &self,
        pose_wa: &Isometry3<f64>,
        other: &Self,
        pose_wb: &Isometry3<f64>,
        drifts: [&Drift; 2],
        hint: &mut Hint,
        found: &mut KeptApart,
    ) {
        let moved = drifts[0].moved + drifts[1].moved;
        let (center, radius) = self.around();
        let far = other.distance_bound(pose_wb, &(pose_wa * center), radius);
        if found.settles(far, moved) {
            return;
        }
        let pose = pose_wb.inverse() * pose_wa;
        let scale = self.size + other.size + pose.translation.vector.norm();
        if !(is_usable(pose_wa, scale) && is_usable(pose_wb, scale) && moved.is_finite()) {
            *found = KeptApart { shares: [0.0; 2], clearance: 0.0, now: 0.0, ..*found };
            return;
        }
        // Triangles that move are not known to stay behind a plane.
        let known = other.is_balls || drifts[1].moved == 0.0;
        let bent = if known { drifts[0].bent + drifts[1].bent } else { f64::INFINITY };
        let mut approach = Approach {
            other,
            around: other.cuboid_around(),
            pose: IsometryMatrix3::from_parts(pose.translation, pose.rotation.to_rotation_matrix()),
            drifts: drifts.map(|drift| drift.seen_from(pose_wb)),
            bent,
            moved,
            is_still: drifts[1].moved == 0.0,
            touching: TOUCHING * scale,
            plane: hint.plane,
            found: *found,
        };
        approach.of(self, self.root);
        (*found, hint.plane) = (approach.found, approach.plane);
    }
}

/// Balls beside a mesh, in whose frame everything is.
struct Approach<'a> {
    other: &'a RefMesh,
    around: Cuboid,
    /// Of the balls.
    pose: IsometryMatrix3<f64>,
    drifts: [Drift; 2],
    /// See [`Drift`]; of both together.
    bent: f64,
    moved: f64,
    /// Whether the mesh does not move.
    is_still: bool,
    touching: f64,
    /// A plane in front of the mesh: its normal, and how far from the origin it is.
    plane: Option<(Vector3<f64>, f64)>,
    found: KeptApart,
}

impl Approach<'_> {
    /// The balls below a node of `balls`.
    fn of(&mut self, balls: &RefMesh, node: Node) {
        let mut made = None;
        let Ball { center, radius, content, .. } = balls.ball(node, &mut made);
        let p = self.pose * center;
        // From the side of the box around the mesh.
        let way = self.around.way_to(&p).unwrap_or_default();
        let (gap, normal) = (way.norm() - radius, way.normalize());
        if self.is_settled(gap) || (self.is_still && self.is_settled_across(gap, &normal, &p)) {
            return;
        }
        match content {
            Content::Parts(parts) => parts.iter().for_each(|part| self.of(balls, *part)),
            Content::Triangle(_) => match &self.other.cuboid {
                Some(cuboid) if way == Vector3::zeros() => self.take(cuboid.distance(&p) - radius, [0.0; 2]),
                Some(_) => self.take_across(gap, &normal, &p, &p),
                None => self.ball(&p, *radius),
            },
        }
    }

    /// A single ball beside all of the mesh.
    fn ball(&mut self, p: &Point3<f64>, radius: f64) {
        if self.is_still {
            // The plane of the last ball is often as good.
            if let Some((normal, at)) = self.plane
                && self.is_settled_across(normal.dot(&p.coords) - at - radius, &normal, p)
            {
                return;
            }
            if let Some((gap, normal)) = self.convex(p) {
                return self.take_across(gap - radius, &normal, p, p);
            }
        }
        self.beside(p, radius, self.other.root);
    }

    /// The distance of `p` from the mesh if that is convex, and the normal of the plane between them.
    fn convex(&mut self, p: &Point3<f64>) -> Option<(f64, Vector3<f64>)> {
        if self.other.corners.is_empty() {
            return None;
        }
        let mut nearest = (f64::INFINITY, Vector3::zeros());
        self.nearest(p, self.other.root, &mut nearest);
        let (distance, way) = nearest;
        let normal = way / distance;
        let at = -axis::lowest(&self.other.corners, -normal);
        let gap = normal.dot(&p.coords) - at;
        let is_convex = gap >= distance * (1.0 - ROUNDING);
        if is_convex {
            self.plane = Some((normal, at));
        }
        is_convex.then_some((gap, normal))
    }

    /// A single ball beside what is below a node of the mesh.
    fn beside(&mut self, p: &Point3<f64>, radius: f64, node: Node) {
        let other = self.other;
        match other.ball(node, &mut None).content {
            Content::Triangle(i) => {
                let mut made = None;
                let corners = other.triangle(i, &mut made);
                let way = triangle::to_point(p, corners);
                let distance = way.norm() - radius - other.rounding(i);
                self.take_across(distance, &way.normalize(), p, &corners[0]);
            }
            Content::Parts(parts) => {
                for (bound, part) in self.nearer_first(p, parts) {
                    if !self.is_settled(bound - radius) {
                        self.beside(p, radius, part);
                    }
                }
            }
        }
    }

    /// Lowers the distance of `p` from the triangles below a node of the mesh, and the shortest way to it.
    fn nearest(&self, p: &Point3<f64>, node: Node, nearest: &mut (f64, Vector3<f64>)) {
        match self.other.ball(node, &mut None).content {
            Content::Triangle(i) => {
                let way = triangle::to_point(p, self.other.triangle(i, &mut None));
                let distance = way.norm();
                if distance < nearest.0 {
                    *nearest = (distance, way);
                }
            }
            Content::Parts(parts) => {
                for (bound, part) in self.nearer_first(p, parts) {
                    if bound < nearest.0 {
                        self.nearest(p, part, nearest);
                    }
                }
            }
        }
    }

    /// Two nodes of the mesh with lower bounds on their distances from `p`.
    fn nearer_first(&self, p: &Point3<f64>, parts: [Node; 2]) -> [(f64, Node); 2] {
        let mut parts = parts.map(|part| {
            let mut made = None;
            let ball = self.other.ball(part, &mut made);
            ((p - ball.center).norm() - ball.radius, part)
        });
        if parts[1].0 < parts[0].0 {
            parts.swap(0, 1);
        }
        parts
    }

    /// Whether a lower bound on the distance of some of the balls from some of the mesh leaves what was found so far.
    fn is_settled(&mut self, bound: f64) -> bool {
        self.found.settles(bound - self.touching, self.moved)
    }

    /// Whether a ball about `p` leaves what was found so far, by its distance from a plane in front of the mesh.
    fn is_settled_across(&mut self, gap: f64, normal: &Vector3<f64>, p: &Point3<f64>) -> bool {
        let shares = self.shares(gap, normal, p, p);
        let is_enough = self.found.shares.iter().zip(shares).all(|(least, share)| share >= *least);
        if is_enough {
            self.take(gap, shares);
        }
        is_enough
    }

    /// Takes a ball about `p`, at that distance along a unit vector from something convex, of which `q` is a point if it is a ball.
    fn take_across(&mut self, distance: f64, way: &Vector3<f64>, p: &Point3<f64>, q: &Point3<f64>) {
        self.take(distance, self.shares(distance, way, p, q));
    }

    fn take(&mut self, distance: f64, shares: [f64; 2]) {
        self.found.take(distance - self.touching, self.moved, shares);
    }

    /// Over which shares of the motion the ball of [`take_across`](Self::take_across) keeps the distance that is needed, by its velocity along
    /// the way: NaN or too little where that is not known.
    fn shares(&self, distance: f64, way: &Vector3<f64>, p: &Point3<f64>, q: &Point3<f64>) -> [f64; 2] {
        let budget = USED * (distance - self.touching - self.found.needed);
        let [a, b] = &self.drifts;
        let speed = (a.at(p) - b.at(q)).dot(way);
        [speed, -speed].map(|nearer| {
            let nearer = nearer + ROUNDING * self.moved;
            let root = (nearer * nearer + 4.0 * self.bent * budget).sqrt();
            if nearer < 0.0 { (root - nearer) / (2.0 * self.bent) } else { 2.0 * budget / (nearer + root) }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::{TriMesh, primitives};
    use nalgebra::{Translation3, UnitQuaternion};

    /// A mesh that goes by a vector and turns about a point of it at constant speed, both from −1 to 1.
    struct Way {
        pose: Isometry3<f64>,
        drift: Drift,
    }

    impl Way {
        fn new(mesh: &RefMesh, pose: Isometry3<f64>, velocity: Vector3<f64>, turning: Vector3<f64>) -> Self {
            let (center, radius) = mesh.around();
            let bent = 0.5 * turning.norm_squared() * radius;
            let moved = velocity.norm() + turning.norm() * radius;
            Self { pose, drift: Drift { about: pose * center, velocity, turning, bent, moved } }
        }

        fn at(&self, t: f64) -> Isometry3<f64> {
            let Drift { about, velocity, turning, .. } = self.drift;
            let turn = UnitQuaternion::from_scaled_axis(turning * t);
            Translation3::from(about.coords + velocity * t)
                * turn
                * Translation3::from(-about.coords)
                * self.pose
        }
    }

    fn wave(t: f64) -> Vector3<f64> {
        Vector3::new(mp_math::sin(t), mp_math::cos(1.3 * t), mp_math::sin(0.7 * t + 1.0))
    }

    /// What is found keeps its clearance, beside all kinds of meshes, and is found often; hints and the order do not matter for that.
    #[test]
    fn shares_keep_their_clearance() {
        let row = |n: i32, radius: f64| {
            let at = |i: i32| Point3::new(0.05 * f64::from(i), 0.02 * f64::from(i * i % 5), 0.1);
            TriMesh::of_balls((0..n).map(at).collect(), radius).unwrap()
        };
        let balls = RefMesh::new(&row(7, 0.03));
        let others = [
            primitives::cuboid(0.3, 0.5, 0.9).unwrap(),
            primitives::cylinder(0.2, 0.5, 24).unwrap(),
            primitives::torus(0.3, 0.1, 24, 12).unwrap(),
            row(40, 0.02),
        ];
        let (mut whole, mut parts, mut better) = (0, 0, 0);
        for (k, other) in others.iter().map(RefMesh::new).enumerate() {
            let mut hint = Hint::default();
            for i in 0..300 {
                let t = f64::from(i) + 0.1 * k as f64;
                let size = [0.02, 0.1, 0.4][i as usize % 3];
                let pose = Isometry3::new(wave(t) * 0.5, wave(2.0 * t));
                let way = Way::new(&balls, pose, wave(3.0 * t) * size, wave(5.0 * t) * size);
                // The last ones move, as links do: balls by their velocity, others by no more than is said.
                let by = if i % 4 == 0 { size } else { 0.0 };
                let there = Isometry3::new(wave(7.0 * t) * 0.1, wave(0.1 * t));
                let mut theirs = Way::new(&other, there, wave(11.0 * t) * by, wave(13.0 * t) * by);
                if by == 0.0 {
                    theirs.drift = Drift::STILL;
                }
                let needed = [0.0, 0.01][i as usize % 2];
                let mut found = KeptApart::new(needed);
                let drifts = [&way.drift, &theirs.drift];
                balls.keeps_apart(&pose, &other, &there, drifts, &mut hint, &mut found);
                let distance = |t: f64| balls.clearance(&way.at(t), &other, &theirs.at(t), f64::INFINITY);
                let now = distance(0.0);
                assert!(found.now <= now + 1e-12, "{k} {i}");
                let [before, after] = found.shares;
                for s in [0.3, 0.6, 0.9, 1.0] {
                    for t in [-before * s, after * s].into_iter().filter(|t| *t != 0.0) {
                        let there = distance(t);
                        assert!(
                            there >= found.clearance - 1e-12 && found.clearance >= needed,
                            "{k} {i} {t}: {there} {found:?}"
                        );
                    }
                }
                let plain = USED * (now - needed).max(0.0) / (way.drift.moved + theirs.drift.moved);
                assert!(
                    found.shares.iter().all(|share| *share >= 0.99 * plain.min(1.0)),
                    "{k} {i}: {found:?}"
                );
                whole += u32::from(found.shares == [1.0; 2]);
                parts += u32::from(found.shares.iter().any(|share| *share > 0.0 && *share < 1.0));
                better += u32::from(found.shares.iter().any(|share| *share > 1.5 * plain));
            }
        }
        assert!(whole > 150 && parts > 300 && better > 300, "{whole} {parts} {better}");
    }

    /// Along the sides of convex bodies nothing is used up, however near; towards them, half of the distance takes half of it.
    #[test]
    fn a_graze_takes_nothing_away() {
        let ball = RefMesh::new(&TriMesh::of_balls(vec![Point3::origin()], 0.1).unwrap());
        let bodies =
            [primitives::cuboid(2.0, 2.0, 2.0).unwrap(), primitives::cylinder(1.0, 2.0, 32).unwrap()];
        for body in bodies.iter().map(RefMesh::new) {
            let pose = Isometry3::translation(0.3, 0.2, 1.1 + 1e-3);
            let shares = |velocity: Vector3<f64>| {
                let way = Way::new(&ball, pose, velocity, Vector3::new(0.0, 0.0, 1.0));
                let (mut found, here) = (KeptApart::new(1e-4), Isometry3::identity());
                let drifts = [&Drift { bent: 0.0, ..way.drift }, &Drift::STILL];
                ball.keeps_apart(&pose, &body, &here, drifts, &mut Hint::default(), &mut found);
                found.shares
            };
            assert_eq!(shares(Vector3::new(0.5, 0.4, 0.0)), [1.0; 2]);
            let [before, after] = shares(Vector3::new(0.5, 0.4, -9e-3));
            assert!(before == 1.0 && (after - 0.07).abs() < 1e-6, "{before} {after}");
        }
    }

    #[test]
    fn nothing_is_free_where_numbers_are_none() {
        let ball = RefMesh::new(&TriMesh::of_balls(vec![Point3::origin()], 0.1).unwrap());
        let body = RefMesh::new(&primitives::sphere(1.0, 2).unwrap());
        let pose = Isometry3::translation(0.0, 0.0, 1.2);
        let good = Way::new(&ball, pose, Vector3::new(1.0, 0.0, 0.0), Vector3::zeros()).drift;
        let shares = |pose: &Isometry3<f64>, drift: Drift| {
            let (mut found, here) = (KeptApart::new(0.0), Isometry3::identity());
            ball.keeps_apart(pose, &body, &here, [&drift, &Drift::STILL], &mut Hint::default(), &mut found);
            found.shares
        };
        assert!(shares(&pose, good)[0] > 0.5);
        for moved in [f64::NAN, f64::INFINITY] {
            assert_eq!(shares(&pose, Drift { moved, ..good }), [0.0; 2]);
        }
        assert_eq!(shares(&Isometry3::translation(0.0, f64::NAN, 1.2), good), [0.0; 2]);
        // By no velocity more than by how far points go.
        let plain = shares(&pose, Drift { bent: f64::INFINITY, ..good });
        let unknown = shares(&pose, Drift { velocity: Vector3::repeat(f64::NAN), ..good });
        assert!(plain == unknown && plain[0] > 0.0 && plain[0] < 0.1, "{plain:?} {unknown:?}");
    }
}
