//! The arm as verifiers see it.

use crate::arm::{ArmModel, JointKind, Link};
use mp_collide::reference::{Drift, RefMesh};
use mp_geom::TriMesh;
use nalgebra::{Isometry3, Matrix3, Matrix4, Rotation3, Translation3, UnitQuaternion, Vector3};
use std::collections::HashMap;

/// The links and joints of an arm, built from its model a second time, by their names.
#[derive(Debug)]
pub(crate) struct ReferenceArm {
    /// Parents before children.
    pub(super) links: Vec<ReferenceLink>,
    /// The pairs of links that must not touch.
    pub(super) pairs: Vec<CheckedPair>,
    pub(super) coordinates: Vec<bool>,
    base: Matrix4<f64>,
    /// How many numbers of a configuration are the pose of the base.
    pub(super) pose: usize,
}

/// How many numbers of a configuration are the pose of a base that floats: place, then quaternion.
pub(super) const POSE: usize = 7;

/// A link and the joint above it.
#[derive(Debug)]
pub(super) struct ReferenceLink {
    pub(super) name: String,
    parent: Option<usize>,
    /// How many links are above it.
    depth: usize,
    origin: Matrix4<f64>,
    axis: Vector3<f64>,
    /// The turn about the axis by an angle is 1 + sin times the first + (1 − cos) times the second (Rodrigues).
    turn: [Matrix3<f64>; 2],
    motion: JointMotion,
    /// The value of the joint: coordinate, factor, offset.
    value: (usize, f64, f64),
    pub(super) mesh: Option<RefMesh>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum JointMotion {
    Fixed,
    Turns,
    Slides,
}

impl ReferenceArm {
    /// `checked` are the names of the links of each pair that must not touch, and `make` makes the tree of a mesh.
    ///
    /// # Errors
    /// That of `make`, or of `go_on`, which is called for each link and each pair.
    pub(crate) fn new<'n, E>(
        model: &ArmModel,
        checked: impl Iterator<Item = [&'n str; 2]>,
        mut make: impl FnMut(&TriMesh) -> Result<RefMesh, E>,
        mut go_on: impl FnMut() -> Result<(), E>,
    ) -> Result<Self, E> {
        let own = model.joints.iter().filter(|j| j.kind != JointKind::Fixed && j.mimic.is_none());
        let own: Vec<_> = own.filter(|j| j.kind.held().is_none()).collect();
        let mut tree = Self {
            links: Vec::new(),
            pairs: Vec::new(),
            coordinates: own.iter().map(|j| j.kind == JointKind::Continuous).collect(),
            base: model.base.to_homogeneous(),
            pose: if model.floating.is_some() { POSE } else { 0 },
        };
        let coordinate = |name: &str| own.iter().position(|j| j.name == name);
        // Follows mimics to the end. The model has been checked: there are no loops.
        let value = |name: &str| {
            let (mut at, mut factor, mut offset) = (name.to_owned(), 1.0, 0.0);
            loop {
                if let Some(i) = coordinate(&at) {
                    return (i, factor, offset);
                }
                let joint = model.joints.iter().find(|j| j.name == at);
                let Some(mimic) = joint.and_then(|j| j.mimic.as_ref()) else {
                    // A fixed or held joint has at most one value.
                    let held = joint.and_then(|j| j.kind.held()).unwrap_or(0.0);
                    return (0, 0.0, offset + factor * held);
                };
                (offset, factor) = (offset + factor * mimic.offset, factor * mimic.multiplier);
                at.clone_from(&mimic.joint);
            }
        };
        let above: HashMap<&str, _> = model.joints.iter().map(|j| (j.child.as_str(), j)).collect();
        let mut places: HashMap<&str, usize> = HashMap::new();
        let mut todo: Vec<&Link> = model.links.iter().collect();
        while !todo.is_empty() {
            let before = todo.len();
            for link in std::mem::take(&mut todo) {
                go_on()?;
                let joint = above.get(link.name.as_str()).copied();
                let parent = joint.and_then(|j| places.get(j.parent.as_str()).copied());
                if joint.is_some() && parent.is_none() {
                    todo.push(link);
                    continue;
                }
                let mesh = TriMesh::merged(&link.shapes);
                let axis = joint.map_or_else(Vector3::x, |j| j.axis.normalize());
                let across = axis.cross_matrix();
                let motion = match joint.map(|j| j.kind) {
                    None | Some(JointKind::Fixed) => JointMotion::Fixed,
                    Some(JointKind::Prismatic { .. }) => JointMotion::Slides,
                    Some(_) => JointMotion::Turns,
                };
                places.insert(&link.name, tree.links.len());
                tree.links.push(ReferenceLink {
                    name: link.name.clone(),
                    parent,
                    depth: parent.map_or(0, |p| tree.links[p].depth + 1),
                    origin: joint.map_or_else(Matrix4::identity, |j| j.origin.to_homogeneous()),
                    axis,
                    turn: [across, across * across],
                    motion,
                    value: joint.map_or((0, 0.0, 0.0), |j| value(&j.name)),
                    mesh: mesh.as_ref().map(&mut make).transpose()?,
                });
            }
            if todo.len() == before {
                break;
            }
        }
        for [a, b] in checked {
            go_on()?;
            if let (Some(&link), Some(&other)) = (places.get(a), places.get(b)) {
                tree.pairs.push(CheckedPair { link, other: Some(other), meet: tree.meet(link, other) });
            }
        }
        Ok(tree)
    }

    /// The nearest link above both, which may be one of them.
    fn meet(&self, mut a: usize, mut b: usize) -> Option<usize> {
        while a != b {
            let lower = if self.links[a].depth < self.links[b].depth { &mut b } else { &mut a };
            *lower = self.links[*lower].parent?;
        }
        Some(a)
    }

    /// Places the links.
    pub(super) fn place(&self, q: &[f64], placed: &mut Placement) {
        let Placement { matrices: out, frames, axes, balls } = placed;
        out.clear();
        let (pose, q) = q.split_at(self.pose);
        let base = if self.pose == 0 { self.base } else { base_matrix(pose) };
        for link in &self.links {
            let above = link.parent.map_or(base, |p| out[p]);
            let value = q[link.value.0] * link.value.1 + link.value.2;
            let still = compose(&above, &link.origin);
            if link.motion == JointMotion::Fixed {
                out.push(still);
                continue;
            }
            let mut motion = Matrix4::identity();
            if link.motion == JointMotion::Slides {
                motion.fixed_view_mut::<3, 1>(0, 3).copy_from(&(link.axis * value));
            } else {
                let (sin, cos) = mp_math::sin_cos(value);
                let turn = Matrix3::identity() + link.turn[0] * sin + link.turn[1] * (1.0 - cos);
                motion.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
            }
            out.push(compose(&still, &motion));
        }
        let turned = |m: &Matrix4<f64>, v: &Vector3<f64>| m.fixed_view::<3, 3>(0, 0) * v;
        axes.clear();
        axes.extend(self.links.iter().zip(&*out).map(|(link, matrix)| turned(matrix, &link.axis)));
        frames.clear();
        // Only links with meshes are asked for.
        let frame = |(link, matrix): (&ReferenceLink, _)| {
            link.mesh.as_ref().map_or_else(Isometry3::identity, |_| isometry(matrix))
        };
        frames.extend(self.links.iter().zip(&*out).map(frame));
        balls.clear();
        let ball = |(link, matrix): (&ReferenceLink, &Matrix4<f64>)| match &link.mesh {
            Some(mesh) => {
                let (center, radius) = mesh.around();
                (turned(matrix, &center.coords) + origin(matrix), radius)
            }
            None => (origin(matrix), 0.0),
        };
        balls.extend(self.links.iter().zip(&*out).map(ball));
    }

    /// How the joints below the link `stop` move the points of `link` relative to `stop` (all joints when it is `None`), while every
    /// coordinate goes as far as `travels` says and the links start where they are `placed`.
    ///
    /// A joint that turns by w moves a point no farther than w times its distance from the axis of the joint.
    /// That distance is at most the one where they are placed plus how far the joints nearer to the link have moved the point; of all points
    /// of the link it is no more than that of the ball around them. A base that floats turns about any axis through the root, as one more
    /// joint above it, for pairs that do not `stop` below it.
    ///
    /// Where coordinates go at constant speed, joints may also undo what others do: the bound is then no more than by the velocity v of the
    /// centre of the ball and the angular velocity ω of the link, |v| + r |ω| + a / 2. The acceleration a of a point is that of all pairs of
    /// joints: what one gives to its velocity turns with each joint above it, and with itself.
    pub(super) fn drift(
        &self,
        link: usize,
        stop: Option<usize>,
        travels: &Travels,
        placed: &Placement,
    ) -> Drift {
        let Travels { joints: travels, ahead, base } = travels;
        let (center, radius) = placed.balls[link];
        let (mut moved, mut bent) = (0.0, 0.0);
        let (mut velocity, mut turning) = (Vector3::zeros(), Vector3::zeros());
        let mut at = Some(link);
        while at != stop {
            let Some(i) = at else { break };
            let part = &self.links[i];
            let travel = travels[part.value.0] * part.value.1.abs();
            let by = ahead.as_ref().map_or(0.0, |ahead| ahead[part.value.0] * part.value.1);
            let axis = &placed.axes[i];
            match part.motion {
                JointMotion::Fixed => {}
                JointMotion::Slides => {
                    moved += travel;
                    velocity += axis * by;
                }
                JointMotion::Turns => {
                    let arm = center - origin(&placed.matrices[i]);
                    let across = axis.cross(&arm);
                    let reach = across.norm() + radius + ROUNDING * arm.amax() + moved;
                    bent += travel * (moved + 0.5 * travel * reach);
                    moved += travel * reach;
                    velocity += across * by;
                    turning += axis * by;
                }
            }
            at = part.parent;
        }
        if let (None, Some([slide, turn])) = (stop, base)
            && let Some(root) = self.above(link).last()
        {
            let now = (center - origin(&placed.matrices[*root])).norm() + radius;
            moved += turn * (now + moved) + slide;
            bent = f64::INFINITY;
        } else if ahead.is_some() {
            let straight = velocity.norm() + radius * turning.norm() + bent;
            moved = moved.min(straight + CANCELLED * moved);
        } else {
            bent = f64::INFINITY;
        }
        // Enlarged against rounding.
        let enlarged = 1.0 + 1e-9;
        let (bent, moved) = (bent * enlarged, moved * enlarged);
        Drift { about: center.into(), velocity, turning, bent, moved }
    }

    /// The links from `link` up to the root, `link` first.
    fn above(&self, link: usize) -> Vec<usize> {
        std::iter::successors(Some(link), |&i| self.links[i].parent).collect()
    }

    /// Whether any joint above the link moves it: one that is held does not.
    pub(super) fn is_moved(&self, link: usize) -> bool {
        let moves = |link: &ReferenceLink| link.motion != JointMotion::Fixed && link.value.1 != 0.0;
        self.above(link).into_iter().any(|i| moves(&self.links[i]))
    }
}

/// Where the links are in the world.
#[derive(Debug, Default)]
pub(super) struct Placement {
    /// As homogeneous matrices.
    matrices: Vec<Matrix4<f64>>,
    /// The same for links with meshes.
    pub(super) frames: Vec<Isometry3<f64>>,
    /// The axes of the joints above them.
    axes: Vec<Vector3<f64>>,
    /// The balls around their meshes.
    balls: Vec<(Vector3<f64>, f64)>,
}

/// More than the rounding of velocities that undo each other, as a part of how far they move a point one by one.
const CANCELLED: f64 = 1e-9;

/// More than the rounding of a distance from an axis, as a part of coordinates.
const ROUNDING: f64 = 1e-12;

fn origin(m: &Matrix4<f64>) -> Vector3<f64> {
    m.fixed_view::<3, 1>(0, 3).into_owned()
}

/// The product of two homogeneous matrices, of which the last rows are 0, 0, 0, 1.
fn compose(a: &Matrix4<f64>, b: &Matrix4<f64>) -> Matrix4<f64> {
    let mut product = Matrix4::identity();
    for c in 0..4 {
        for r in 0..3 {
            let turned = a[(r, 0)] * b[(0, c)] + a[(r, 1)] * b[(1, c)] + a[(r, 2)] * b[(2, c)];
            product[(r, c)] = if c == 3 { turned + a[(r, 3)] } else { turned };
        }
    }
    product
}

fn isometry(m: &Matrix4<f64>) -> Isometry3<f64> {
    let turn = Rotation3::from_matrix_unchecked(m.fixed_view::<3, 3>(0, 0).into_owned());
    let place: Vector3<f64> = m.fixed_view::<3, 1>(0, 3).into_owned();
    Isometry3::from_parts(Translation3::from(place), UnitQuaternion::from_rotation_matrix(&turn))
}

/// How far each coordinate goes over a part of a motion (rad or m), and how far (m) and by which angle (rad) a base that
/// floats does.
pub(super) struct Travels {
    pub(super) joints: Vec<f64>,
    /// Where coordinates go at constant speed: by how much, with its sign, from the middle to the end, and as far from the beginning to the middle.
    pub(super) ahead: Option<Vec<f64>>,
    pub(super) base: Option<[f64; 2]>,
}

/// The homogeneous matrix of a place and a quaternion.
fn base_matrix(pose: &[f64]) -> Matrix4<f64> {
    let &[x, y, z, i, j, k, w] = pose else { return Matrix4::identity() };
    Matrix4::new(
        1.0 - 2.0 * (j * j + k * k),
        2.0 * (i * j - w * k),
        2.0 * (i * k + w * j),
        x,
        2.0 * (i * j + w * k),
        1.0 - 2.0 * (i * i + k * k),
        2.0 * (j * k - w * i),
        y,
        2.0 * (i * k - w * j),
        2.0 * (j * k + w * i),
        1.0 - 2.0 * (i * i + j * j),
        z,
        0.0,
        0.0,
        0.0,
        1.0,
    )
}

/// How far the place of a base goes between two configurations, and the angle of its turn.
pub(super) fn base_travel(a: &[f64], b: &[f64]) -> [f64; 2] {
    let (&[ax, ay, az, ai, aj, ak, aw], &[bx, by, bz, bi, bj, bk, bw]) = (a, b) else { return [f64::NAN; 2] };
    let slide = mp_math::hypot(mp_math::hypot(bx - ax, by - ay), bz - az);
    // The quaternion of the turn: the conjugate of one times the other.
    let real = aw * bw + ai * bi + aj * bj + ak * bk;
    let [i, j, k] = [
        aw * bi - ai * bw - aj * bk + ak * bj,
        aw * bj - aj * bw - ak * bi + ai * bk,
        aw * bk - ak * bw - ai * bj + aj * bi,
    ];
    [slide, 2.0 * mp_math::atan2(mp_math::hypot(mp_math::hypot(i, j), k), real.abs())]
}

/// A link and another link, or a link and the obstacles: they must not touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct CheckedPair {
    pub(super) link: usize,
    pub(super) other: Option<usize>,
    /// The nearest link above both.
    pub(super) meet: Option<usize>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::{Joint, JointKind};
    use mp_cspace::Rng;
    use rand::RngExt;

    /// A chain of links with balls around them, with joints that turn, slide, and follow others, and a branch.
    fn tree() -> ReferenceArm {
        let names = ["a", "b", "c", "d", "e", "f", "g"];
        let mut model = ArmModel::default();
        let cube = |i: usize| mp_geom::primitives::cuboid(0.1, 0.2, 0.1 + 0.1 * i as f64).unwrap();
        model.links = names
            .iter()
            .enumerate()
            .map(|(i, name)| {
                Link::new(*name).with(&cube(i), &Isometry3::translation(0.1, 0.05 * i as f64, 0.1))
            })
            .collect();
        let turns = JointKind::Revolute { low: -3.0, high: 3.0 };
        let kinds = [
            turns,
            JointKind::Prismatic { low: -1.0, high: 1.0 },
            turns,
            JointKind::Continuous,
            turns,
            turns,
        ];
        model.joints = (0..6)
            .map(|i| {
                let parent = if i == 5 { 2 } else { i };
                let pose = mp_geom::pose_from_six([0.3, 0.1, 0.2, i as f64, 0.4, 0.2]);
                let axis = Vector3::new((i % 2) as f64, 1.0 - (i % 3) as f64, 0.7);
                let joint =
                    Joint::new(format!("j{i}"), names[parent], names[i + 1], kinds[i]).axis(axis).at(pose);
                if i == 2 { joint.mimic("j0", -0.8, 0.1) } else { joint }
            })
            .collect();
        let pairs = [["a", "g"], ["c", "f"], ["f", "g"]];
        ReferenceArm::new(&model, pairs.into_iter(), |mesh| Ok::<_, ()>(RefMesh::new(mesh)), || Ok(()))
            .unwrap()
    }

    /// No point of the ball around a link goes farther, relative to the link where the bound stops, and often it goes nearly as far.
    #[test]
    fn travel_bounds_how_far_points_go() {
        let (tree, mut rng) = (tree(), Rng::seed(4));
        let count = tree.coordinates.len();
        let (mut shares, mut gains, mut bends) = (Vec::new(), Vec::new(), Vec::new());
        for round in 0..400 {
            let size = [1e-3, 0.1, 0.5, 1.5][round % 4];
            let mut random =
                |most: f64| -> Vec<f64> { (0..count).map(|_| most * rng.random_range(-1.0..1.0)).collect() };
            let (middle, ahead) = (random(2.0), random(size));
            let at = |t: f64| {
                let q: Vec<f64> = middle.iter().zip(&ahead).map(|(q, by)| q + t * by).collect();
                let mut placed = Placement::default();
                tree.place(&q, &mut placed);
                placed
            };
            let joints: Vec<f64> = ahead.iter().map(|by| by.abs()).collect();
            let placed = at(0.0);
            for link in 1..tree.links.len() {
                for stop in [None, Some(2)]
                    .into_iter()
                    .filter(|stop| stop.is_none_or(|stop| tree.above(link).contains(&stop) && link != stop))
                {
                    let drift = |ahead| {
                        let travels = Travels { joints: joints.clone(), ahead, base: None };
                        tree.drift(link, stop, &travels, &placed)
                    };
                    let (drift, plain) = (drift(Some(ahead.clone())), drift(None).moved);
                    let bound = drift.moved;
                    assert!(bound <= plain);
                    gains.push(bound / plain);
                    let (center, radius) = placed.balls[link];
                    // In the frame of the link where it stops.
                    let seen = |placed: &Placement, p: Vector3<f64>| match stop {
                        Some(stop) => isometry(&placed.matrices[stop]).inverse() * nalgebra::Point3::from(p),
                        None => nalgebra::Point3::from(p),
                    };
                    let mut most: f64 = 0.0;
                    for _ in 0..20 {
                        let way = Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0)).normalize();
                        let p = center + way * radius;
                        let own = isometry(&placed.matrices[link]).inverse() * nalgebra::Point3::from(p);
                        for t in [-1.0, -0.6, -0.2, 0.3, 0.7, 1.0] {
                            let then = at(t);
                            let moved = isometry(&then.matrices[link]) * own;
                            let now = seen(&then, moved.coords);
                            let far = (now - seen(&placed, p)).norm();
                            assert!(far <= bound + 1e-12, "{round} {link} {stop:?}: {far} {bound}");
                            most = most.max(far);
                            // And it is not far from where its velocity has it.
                            let straight = p + (drift.velocity + drift.turning.cross(&(way * radius))) * t;
                            let (off, bent) = ((now - seen(&placed, straight)).norm(), drift.bent * t * t);
                            assert!(off <= bent + 1e-12, "{round} {link} {stop:?}: {off} {bent}");
                            bends.push(off / (bent + 1e-12));
                        }
                    }
                    shares.push(most / bound);
                }
            }
        }
        let mean = |all: &[f64]| all.iter().sum::<f64>() / all.len() as f64;
        assert!(mean(&shares) > 0.6 && mean(&gains) < 0.9, "{} {}", mean(&shares), mean(&gains));
        assert!(mean(&bends) > 0.05, "{}", mean(&bends));
    }
}
