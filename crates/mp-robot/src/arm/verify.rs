//! The independent check of arm motions.

use super::{Arm, ArmModel, JointKind, Link};
use crate::obstacles::PlacedReference;
use mp_collide::reference::RefMesh;
use mp_cspace::{Coordinates, Curve, Interrupt, MotionCheck, MotionValidity, ParameterError, Space};
use mp_geom::TriMesh;
use nalgebra::{Isometry3, Matrix3, Matrix4, Rotation3, Translation3, UnitQuaternion, Vector3};
use std::collections::{HashMap, VecDeque};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// The arm as verifiers see it: built from the model a second time, by the names of links and joints.
#[derive(Debug)]
pub(super) struct ReferenceArm {
    /// Parents before children.
    links: Vec<ReferenceLink>,
    /// The pairs of links that must not touch.
    pairs: Vec<CheckedPair>,
    coordinates: Vec<bool>,
    base: Matrix4<f64>,
    /// How many numbers of a configuration are the pose of the base.
    pose: usize,
}

/// How many numbers of a configuration are the pose of a base that floats: place, then quaternion.
const POSE: usize = 7;

/// A link and the joint above it.
#[derive(Debug)]
struct ReferenceLink {
    parent: Option<usize>,
    /// How many links are above it.
    depth: usize,
    origin: Matrix4<f64>,
    axis: Vector3<f64>,
    motion: JointMotion,
    /// The value of the joint: coordinate, factor, offset.
    value: (usize, f64, f64),
    mesh: Option<RefMesh>,
    /// The largest distance of a point of its mesh from its origin.
    radius: f64,
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
    pub(super) fn new<'n, E>(
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
                let motion = match joint.map(|j| j.kind) {
                    None | Some(JointKind::Fixed) => JointMotion::Fixed,
                    Some(JointKind::Prismatic { .. }) => JointMotion::Slides,
                    Some(_) => JointMotion::Turns,
                };
                places.insert(&link.name, tree.links.len());
                tree.links.push(ReferenceLink {
                    parent,
                    depth: parent.map_or(0, |p| tree.links[p].depth + 1),
                    origin: joint.map_or_else(Matrix4::identity, |j| j.origin.to_homogeneous()),
                    axis: joint.map_or_else(Vector3::x, |j| j.axis.normalize()),
                    motion,
                    value: joint.map_or((0, 0.0, 0.0), |j| value(&j.name)),
                    radius: mesh
                        .iter()
                        .flat_map(|m| m.vertices())
                        .map(|p| p.coords.norm())
                        .fold(0.0, f64::max),
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

    /// The poses of the links in the world, as homogeneous matrices.
    fn poses_into(&self, q: &[f64], out: &mut Vec<Matrix4<f64>>) {
        out.clear();
        let (pose, q) = q.split_at(self.pose);
        let base = if self.pose == 0 { self.base } else { base_matrix(pose) };
        for link in &self.links {
            let above = link.parent.map_or(base, |p| out[p]);
            let value = q[link.value.0] * link.value.1 + link.value.2;
            let still = above * link.origin;
            if link.motion == JointMotion::Fixed {
                out.push(still);
                continue;
            }
            let mut motion = Matrix4::identity();
            if link.motion == JointMotion::Slides {
                motion.fixed_view_mut::<3, 1>(0, 3).copy_from(&(link.axis * value));
            } else {
                let across = link.axis.cross_matrix();
                let (sin, cos) = mp_math::sin_cos(value);
                let turn = Matrix3::identity() + across * sin + across * across * (1.0 - cos);
                motion.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
            }
            out.push(still * motion);
        }
    }

    /// An upper bound (m) on how far the joints below the link `stop` move a point of `link` relative to `stop` (all joints
    /// when it is `None`), while every coordinate goes as far as `travels` says and the links start at `poses`.
    ///
    /// A joint that turns by w moves a point no farther than w times its distance from the origin of the joint.
    /// That distance is at most the one at `poses` plus how far the joints nearer to the link have moved the point. A base
    /// that floats is one more such joint above the root, for pairs that do not `stop` below it.
    fn travel(&self, link: usize, stop: Option<usize>, travels: &Travels, poses: &[Matrix4<f64>]) -> f64 {
        let origin = |i: usize| Vector3::from(poses[i].fixed_view::<3, 1>(0, 3));
        let Travels { joints: travels, base } = travels;
        let tip = origin(link);
        let mut moved = 0.0;
        let mut at = Some(link);
        while at != stop {
            let Some(i) = at else { break };
            let part = &self.links[i];
            let travel = travels[part.value.0] * part.value.1.abs();
            match part.motion {
                JointMotion::Fixed => {}
                JointMotion::Slides => moved += travel,
                JointMotion::Turns => {
                    let now = (tip - origin(i)).norm() + self.links[link].radius;
                    moved += travel * (now + moved);
                }
            }
            at = part.parent;
        }
        if let (None, Some([slide, turn]), Some(root)) = (stop, base, self.above(link).last()) {
            let now = (tip - origin(*root)).norm() + self.links[link].radius;
            moved += turn * (now + moved) + slide;
        }
        // Enlarged against rounding.
        moved * (1.0 + 1e-9)
    }

    /// The links from `link` up to the root, `link` first.
    fn above(&self, link: usize) -> Vec<usize> {
        std::iter::successors(Some(link), |&i| self.links[i].parent).collect()
    }

    /// Whether any joint above the link moves it: one that is held does not.
    fn is_moved(&self, link: usize) -> bool {
        let moves = |link: &ReferenceLink| link.motion != JointMotion::Fixed && link.value.1 != 0.0;
        self.above(link).into_iter().any(|i| moves(&self.links[i]))
    }
}

/// How far each coordinate goes over a part of a motion (rad or m), and how far (m) and by which angle (rad) a base that
/// floats does.
struct Travels {
    joints: Vec<f64>,
    base: Option<[f64; 2]>,
}

impl Travels {
    /// The larger of each.
    fn max(&self, other: &Self) -> Self {
        let joints = self.joints.iter().zip(&other.joints).map(|(x, y)| x.max(*y)).collect();
        let base = self.base.zip(other.base).map(|([s, t], [u, v])| [s.max(u), t.max(v)]);
        Self { joints, base }
    }
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
fn base_travel(a: &[f64], b: &[f64]) -> [f64; 2] {
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
struct CheckedPair {
    link: usize,
    other: Option<usize>,
    /// The nearest link above both.
    meet: Option<usize>,
}

/// Proves motions of an [`Arm`] free of collision, with other code than planners use: its own kinematic tree, built from
/// the names in the model and multiplied out as homogeneous matrices; its own bounds on how far links
/// move; its own subdivision; and the sphere trees of `mp_collide::reference`. It shares with the checker only the space,
/// whose interpolation defines what a motion is, and the list of [pairs of links](Arm::checked_pairs) that must not
/// touch.
///
/// - free means that links keep at least the tolerance from obstacles and from each other all along, and none is inside of a
///   [solid](TriMesh::solids);
/// - a motion with a tested state of less than twice the tolerance is [`Unproven`](MotionCheck::Unproven), as
///   are motions that take more than a million parts, and motions of a million radians or metres.
///
/// Coordinates must go at constant speed, and by no more than a turn, as in [`Arm::space`]; a base that floats as in
/// [`Arm::floating_space`].
#[derive(Clone, Debug)]
pub struct ArmVerifier<'c, C> {
    space: &'c C,
    tree: Arc<ReferenceArm>,
    /// The obstacles and their poses.
    world: Arc<[PlacedReference]>,
    pairs: Vec<CheckedPair>,
    tolerance: f64,
    /// The clearance (m) that the arm keeps from obstacles, to which the tolerance is added.
    kept: f64,
    parts: u64,
    interrupt: Interrupt,
    /// The end of the last motion that was found free, where nothing is inside of anything.
    apart: Option<Vec<f64>>,
}

/// Motions of a coordinate longer than this (rad or m) are refused.
const MAX_TRAVEL: f64 = 1e6;

/// The share of a distance that is used to prove a part of a motion whose ends it does not reach: what is left is clearance that is shown.
const USED: f64 = 0.7;

/// Motions are not cut into more parts than this.
const MAX_PARTS: u64 = 1_000_000;

/// The first fault of a curve is found to this part of a piece.
const FIRST_FAULT: f64 = 1e-3;

/// A bound on the rounding of the range of a polynomial, as a part of its values.
const ROUNDING: f64 = 1e-12;

/// What each coefficient of a polynomial of degree 5 counts in its Bernstein coefficients.
const BERNSTEIN: [[f64; 6]; 6] = [
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 0.2, 0.0, 0.0, 0.0, 0.0],
    [1.0, 0.4, 0.1, 0.0, 0.0, 0.0],
    [1.0, 0.6, 0.3, 0.1, 0.0, 0.0],
    [1.0, 0.8, 0.6, 0.4, 0.2, 0.0],
    [1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
];

/// What is found over a part of a motion.
enum PartCheck {
    /// All pairs keep apart.
    Apart,
    /// These pairs come too near to tell.
    Near(Near),
    /// Touching in the middle.
    Collision,
    /// Too near to contact in the middle, or interrupted.
    Unproven,
}

/// Pairs that come too near over a part of a motion.
struct Near {
    pairs: Vec<usize>,
    /// Over which share of it, about the middle, they keep apart if coordinates go at constant speed.
    free: f64,
    /// The least clearance (m) there.
    clearance: f64,
}

/// Between which numbers a polynomial stays where its variable is in \[a, b\]: the least and the largest of its Bernstein coefficients
/// there.
fn control_range(mut c: [f64; 6], a: f64, b: f64) -> [f64; 2] {
    // Shifted to begin at `a`, by Horner's scheme, then scaled.
    for first in 0..5 {
        for i in (first..5).rev() {
            c[i] += a * c[i + 1];
        }
    }
    let mut scale = 1.0;
    for x in &mut c {
        *x *= scale;
        scale *= b - a;
    }
    let point = |k: usize| (0..=k).map(|i| BERNSTEIN[k][i] * c[i]).sum::<f64>();
    let points: [f64; 6] = std::array::from_fn(point);
    if points.iter().any(|x| !x.is_finite()) {
        return [f64::NAN; 2];
    }
    points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(*x), high.max(*x)])
}

impl<'c, C> ArmVerifier<'c, C>
where
    C: Space,
    C::State: Coordinates,
{
    /// A verifier for `arm` in `space` with a tenth of the arm's [tolerance](Arm::tolerance).
    ///
    /// # Errors
    /// When the tolerance is not positive and finite. The tolerance of an arm always is.
    pub fn new(space: &'c C, arm: &Arm) -> Result<Self, ParameterError> {
        Self::with_tolerance(space, arm, arm.tolerance() * 0.1)
    }

    /// A verifier with the tolerance `tolerance` (m).
    ///
    /// # Errors
    /// When the tolerance is not positive and finite.
    pub fn with_tolerance(space: &'c C, arm: &Arm, tolerance: f64) -> Result<Self, ParameterError> {
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            let (name, expected) = ("the tolerance", "positive and finite");
            return Err(ParameterError { name, expected, value: tolerance });
        }
        let tree = arm.reference();
        let world = arm.obstacles.references();
        let mut pairs = Vec::new();
        let solid = |i: &usize| tree.links[*i].mesh.is_some() && (tree.pose > 0 || tree.is_moved(*i));
        for link in (0..tree.links.len()).filter(solid) {
            if !world.is_empty() {
                pairs.push(CheckedPair { link, other: None, meet: None });
            }
        }
        pairs.extend_from_slice(&tree.pairs);
        Ok(Self {
            space,
            tree,
            world,
            pairs,
            tolerance,
            kept: arm.kept(),
            parts: 0,
            interrupt: Interrupt::never(),
            apart: None,
        })
    }

    /// The clearance (m) that motions found free keep between links and everything else, beyond what the arm [keeps](Arm::keeping) from
    /// obstacles.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// How many parts of motions have been tested so far.
    #[must_use]
    pub fn parts(&self) -> u64 {
        self.parts
    }

    /// How far each coordinate and the base go between two configurations. Continuous joints turn by the shorter way.
    fn travels(&self, a: &C::State, b: &C::State) -> Travels {
        let (base_a, a) = a.as_slice().split_at(self.tree.pose);
        let (base_b, b) = b.as_slice().split_at(self.tree.pose);
        let travel = |(i, endless): (usize, &bool)| {
            let d = (b[i] - a[i]).abs();
            if *endless && d > PI { (d % TAU).min(TAU - d % TAU) } else { d }
        };
        Travels {
            joints: self.tree.coordinates.iter().enumerate().map(travel).collect(),
            base: (self.tree.pose > 0).then(|| base_travel(base_a, base_b)),
        }
    }

    /// The clearance (m) that the two of a pair keep.
    fn kept_from(&self, pair: &CheckedPair) -> f64 {
        if pair.other.is_none() { self.kept } else { 0.0 }
    }

    /// A lower bound on the distance of a pair that is at least `enough`; else, as an error, the distance of two of their
    /// triangles that is less.
    fn distance(&self, pair: &CheckedPair, poses: &[Matrix4<f64>], enough: f64) -> Result<f64, f64> {
        self.least(pair, poses, enough, |[mesh, other], [pose, at], enough| {
            mesh.at_least(pose, other, at, enough)
        })
    }

    /// A lower bound on the distance of a pair that is at least `enough`, or at least four fifths of the distance; 0 where they touch.
    fn nearly(&self, pair: &CheckedPair, poses: &[Matrix4<f64>], enough: f64) -> f64 {
        let mut least = f64::INFINITY;
        let nearest = self.least(pair, poses, enough, |[mesh, other], [pose, at], enough| {
            least = least.min(mesh.nearly(pose, other, at, enough.min(least)));
            Ok(least)
        });
        nearest.unwrap_or(0.0)
    }

    /// The least of what `bound` says of the link of a pair and each that it must not touch, unless that is surely at least `enough`.
    ///
    /// # Errors
    /// That of `bound`.
    fn least(
        &self,
        pair: &CheckedPair,
        poses: &[Matrix4<f64>],
        enough: f64,
        mut bound: impl FnMut([&RefMesh; 2], [&Isometry3<f64>; 2], f64) -> Result<f64, f64>,
    ) -> Result<f64, f64> {
        let Some((mesh, pose)) = self.mesh(pair.link, poses) else { return Ok(f64::INFINITY) };
        if pair.other.is_some() {
            let other = self.others(pair, poses).next();
            return other.map_or(Ok(f64::INFINITY), |(other, at)| bound([mesh, other], [&pose, &at], enough));
        }
        // Most obstacles are far from the ball around a link.
        let (center, radius) = mesh.around();
        let center = pose * center;
        let mut least = f64::INFINITY;
        for (obstacle, at) in self.world.iter() {
            let far = obstacle.distance_bound(at, &center, radius);
            let far =
                if far >= enough.min(least) { far } else { bound([mesh, obstacle], [&pose, at], enough)? };
            least = least.min(far);
        }
        Ok(least)
    }

    /// The mesh of a link, and where it is; `None` when it has none.
    fn mesh(&self, link: usize, poses: &[Matrix4<f64>]) -> Option<(&RefMesh, Isometry3<f64>)> {
        Some((self.tree.links[link].mesh.as_ref()?, isometry(&poses[link])))
    }

    /// What the link of a pair must not touch, where it is: another link, or all obstacles.
    fn others<'a>(
        &'a self,
        pair: &CheckedPair,
        poses: &[Matrix4<f64>],
    ) -> impl Iterator<Item = (&'a RefMesh, Isometry3<f64>)> {
        let world = if pair.other.is_none() { &*self.world } else { &[] };
        let link = pair.other.and_then(|other| self.mesh(other, poses));
        link.into_iter().chain(world.iter().map(|(mesh, pose)| (mesh, *pose)))
    }

    /// Whether of any pair one is inside of the other, which is solid, where their surfaces are apart.
    fn is_nested(&self, q: &C::State) -> bool {
        let mut poses = Vec::new();
        self.tree.poses_into(q.as_slice(), &mut poses);
        self.pairs.iter().any(|pair| {
            self.mesh(pair.link, &poses).is_some_and(|(mesh, pose)| {
                self.others(pair, &poses).any(|(other, at)| mesh.is_nested(&pose, other, &at))
            })
        })
    }

    /// How much nearer to each other the two of a pair can come.
    fn approach(&self, pair: &CheckedPair, travels: &Travels, poses: &[Matrix4<f64>]) -> f64 {
        let moved = |link| self.tree.travel(link, pair.meet, travels, poses);
        moved(pair.link) + pair.other.map_or(0.0, moved)
    }

    /// Proves the motion in parts, longer parts first.
    fn prove(&mut self, from: &C::State, to: &C::State) -> MotionCheck {
        let mut least = f64::INFINITY;
        let mut poses = Vec::new();
        let all: Vec<usize> = (0..self.pairs.len()).collect();
        let mut open = VecDeque::from([(0.0, 1.0, all)]);
        let limit = self.parts + MAX_PARTS;
        while let Some((a, b, pairs)) = open.pop_front() {
            let at = 0.5 * (a + b);
            self.parts += 1;
            if self.parts > limit {
                return MotionCheck::Unproven { at };
            }
            let [qa, qm, qb] = [a, at, b].map(|t| self.space.interpolate(from, to, t));
            let (before, after) = (self.travels(&qa, &qm), self.travels(&qm, &qb));
            let near = match self.part(&qm, &before.max(&after), &pairs, &mut poses, &mut least) {
                PartCheck::Apart => continue,
                PartCheck::Near(near) => near,
                PartCheck::Collision => return MotionCheck::Collision { at },
                PartCheck::Unproven => return MotionCheck::Unproven { at },
            };
            least = least.min(near.clearance);
            let free = 0.5 * (b - a) * near.free;
            open.push_back((a, at - free, near.pairs.clone()));
            open.push_back((at + free, b, near.pairs));
        }
        MotionCheck::Free { clearance: least }
    }

    /// Compares `pairs` over a part of a motion, in which coordinates go no farther than `travels` from the configuration `middle`. `least`
    /// becomes the clearance of those that keep apart, if that is less.
    fn part(
        &mut self,
        middle: &C::State,
        travels: &Travels,
        pairs: &[usize],
        poses: &mut Vec<Matrix4<f64>>,
        least: &mut f64,
    ) -> PartCheck {
        self.tree.poses_into(middle.as_slice(), poses);
        let mut near = Near { pairs: Vec::new(), free: 1.0, clearance: f64::INFINITY };
        for &i in pairs {
            let pair = &self.pairs[i];
            let approach = self.approach(pair, travels, poses);
            if self.interrupt.ask() {
                return PartCheck::Unproven;
            }
            let kept = self.kept_from(pair);
            let (enough, needed) = (approach + kept + self.tolerance, kept + 2.0 * self.tolerance);
            let is_of_balls = self.tree.links[pair.link].mesh.as_ref().is_some_and(RefMesh::is_balls);
            let found = match is_of_balls {
                // A lower bound on the distance.
                true => self.nearly(pair, poses, enough),
                // The first distance of two triangles: of meshes a bound takes longer than it saves.
                false => {
                    self.distance(pair, poses, enough).unwrap_or_else(|found| found.min(enough.next_down()))
                }
            };
            if found >= enough {
                *least = least.min(found - approach);
                continue;
            }
            // It need not be the distance.
            if (found < needed || !is_of_balls) && self.distance(pair, poses, kept).is_err() {
                return PartCheck::Collision;
            }
            if found < needed && (!is_of_balls || self.distance(pair, poses, needed).is_err()) {
                return PartCheck::Unproven;
            }
            let beyond = if is_of_balls { found.max(needed) - kept - self.tolerance } else { 0.0 };
            let free = USED * beyond / approach;
            // Written so that nothing is free where that is not a number.
            near.free = if free >= near.free { near.free } else { free.max(0.0) };
            if is_of_balls {
                near.clearance = near.clearance.min((1.0 - USED) * beyond + kept + self.tolerance);
            }
            near.pairs.push(i);
        }
        if near.pairs.is_empty() { PartCheck::Apart } else { PartCheck::Near(near) }
    }

    /// Proves a curve in parts, the first ones first. What is found at a part ends the search behind it only: the fault is the first one.
    fn prove_curve(&mut self, curve: &dyn Curve) -> MotionCheck {
        let pieces = curve.pieces() as f64;
        let (mut least, mut hit, mut near_contact, mut poses) = (f64::INFINITY, None, None, Vec::new());
        let mut open = vec![(0.0, pieces, (0..self.pairs.len()).collect::<Vec<_>>())];
        let limit = self.parts + MAX_PARTS;
        while let Some((a, b, pairs)) = open.pop() {
            let at = 0.5 * (a + b);
            self.parts += 1;
            if self.parts > limit {
                return MotionCheck::Unproven { at: at / pieces };
            }
            let (middle, travels) = self.around(curve, a, b);
            match self.part(&middle, &travels, &pairs, &mut poses, &mut least) {
                PartCheck::Apart => continue,
                PartCheck::Near(near) => {
                    open.push((at, b, near.pairs.clone()));
                    open.push((a, at, near.pairs));
                    continue;
                }
                PartCheck::Collision => (hit, near_contact) = (Some(at), None),
                PartCheck::Unproven => near_contact = Some(at),
            }
            if self.interrupt.raised().is_some() {
                return MotionCheck::Unproven { at: at / pieces };
            }
            open.clear();
            if b - a > FIRST_FAULT {
                open.push((a, at, pairs));
            }
        }
        match (near_contact, hit) {
            (None, None) => MotionCheck::Free { clearance: least },
            (None, Some(hit)) => MotionCheck::Collision { at: hit / pieces },
            (Some(near), hit) => match hit.and_then(|hit| self.first_contact(curve, near, hit)) {
                Some(hit) => MotionCheck::Collision { at: hit / pieces },
                None => MotionCheck::Unproven { at: near / pieces },
            },
        }
    }

    /// Where a curve first touches something between two parameters, at the first of which it is too near to contact to tell and at the second
    /// in contact; `None` where it is clear of everything in between.
    fn first_contact(&self, curve: &dyn Curve, mut near: f64, mut hit: f64) -> Option<f64> {
        while hit - near > FIRST_FAULT {
            let at = 0.5 * (near + hit);
            let (q, _) = self.around(curve, at, at);
            if self.touches(&q) {
                hit = at;
            } else if self.is_near(&q) {
                near = at;
            } else {
                return None;
            }
        }
        Some(hit)
    }

    /// The configuration of a curve in the middle between two parameters, in pieces, and how far the coordinates are from it at most between
    /// them: polynomials stay between their control points.
    fn around(&self, curve: &dyn Curve, a: f64, b: f64) -> (C::State, Travels) {
        let (first, last) = (a.floor() as usize, (b.ceil() as usize).min(curve.pieces()));
        let at = 0.5 * (a + b);
        let value = |coordinate: usize| {
            let piece = (at.floor() as usize).min(curve.pieces() - 1);
            let [c @ .., highest] = curve.polynomial(piece, coordinate);
            c.iter().rev().fold(highest, |sum, c| sum * (at - piece as f64) + c)
        };
        let middle = C::State::from_fn(self.tree.coordinates.len(), value);
        let far = |(coordinate, middle): (usize, &f64)| {
            let piece = |i: usize| {
                let part = |x: f64| (x - i as f64).clamp(0.0, 1.0);
                let [low, high] = control_range(curve.polynomial(i, coordinate), part(a), part(b));
                [high - middle, middle - low]
            };
            // Written so that NaN stays.
            let most = |most: f64, x: f64| if x <= most { most } else { x };
            (first..last).flat_map(piece).fold(0.0, most) + ROUNDING * (1.0 + middle.abs())
        };
        let joints = middle.as_slice().iter().enumerate().map(far).collect();
        (middle, Travels { joints, base: None })
    }

    /// Whether any pair is too near to contact to tell at `q`.
    fn is_near(&self, q: &C::State) -> bool {
        let mut poses = Vec::new();
        self.tree.poses_into(q.as_slice(), &mut poses);
        let near = |pair| self.distance(pair, &poses, self.kept_from(pair) + 2.0 * self.tolerance).is_err();
        self.pairs.iter().any(near)
    }

    /// Whether any pair touches at `q`.
    fn touches(&self, q: &C::State) -> bool {
        let mut poses = Vec::new();
        self.tree.poses_into(q.as_slice(), &mut poses);
        let touching = |pair| {
            let kept = self.kept_from(pair);
            self.distance(pair, &poses, kept + self.tolerance).is_err_and(|d| d <= kept)
        };
        self.pairs.iter().any(touching)
    }
}

fn isometry(m: &Matrix4<f64>) -> Isometry3<f64> {
    let turn = Rotation3::from_matrix_unchecked(m.fixed_view::<3, 3>(0, 0).into_owned());
    let place: Vector3<f64> = m.fixed_view::<3, 1>(0, 3).into_owned();
    Isometry3::from_parts(Translation3::from(place), UnitQuaternion::from_rotation_matrix(&turn))
}

impl<C> MotionValidity<C::State> for ArmVerifier<'_, C>
where
    C: Space,
    C::State: Coordinates,
{
    fn check_motion(&mut self, from: &C::State, to: &C::State) -> MotionCheck {
        let count = self.tree.pose + self.tree.coordinates.len();
        let is_turn = |q: &[f64]| (q[3..POSE].iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-8;
        let is_sound = |q: &[f64]| {
            q.len() == count && q.iter().all(|x| x.is_finite()) && (self.tree.pose == 0 || is_turn(q))
        };
        if !(is_sound(from.as_slice()) && is_sound(to.as_slice())) {
            return MotionCheck::Unproven { at: 0.0 };
        }
        let mut travels = from.as_slice().iter().zip(to.as_slice()).map(|(a, b)| (b - a).abs());
        let provable = travels.all(|travel| travel < MAX_TRAVEL);
        if !provable {
            return MotionCheck::Unproven { at: 0.0 };
        }
        if self.apart.as_deref() != Some(from.as_slice()) && self.is_nested(from) {
            return MotionCheck::Collision { at: 0.0 };
        }
        match self.prove(from, to) {
            MotionCheck::Free { clearance } => {
                self.apart = Some(to.as_slice().to_vec());
                MotionCheck::Free { clearance }
            }
            other if self.interrupt.raised().is_some() => other,
            _ if self.touches(from) => MotionCheck::Collision { at: 0.0 },
            _ if self.touches(to) => MotionCheck::Collision { at: 1.0 },
            other => other,
        }
    }
    /// `None` where the base floats: its pose is no row of independent coordinates.
    fn check_curve(&mut self, curve: &dyn Curve) -> Option<MotionCheck> {
        if self.tree.pose > 0 || curve.pieces() == 0 {
            return None;
        }
        let (start, travels) = self.around(curve, 0.0, curve.pieces() as f64);
        // Written so that NaN is refused.
        if !travels.joints.iter().all(|travel| *travel < MAX_TRAVEL) {
            return Some(MotionCheck::Unproven { at: 0.0 });
        }
        let start = C::State::from_fn(start.as_slice().len(), |i| curve.polynomial(0, i)[0]);
        if self.is_nested(&start) {
            return Some(MotionCheck::Collision { at: 0.0 });
        }
        Some(match self.prove_curve(curve) {
            MotionCheck::Free { clearance } => MotionCheck::Free { clearance },
            other if self.interrupt.raised().is_some() => other,
            _ if self.touches(&start) => MotionCheck::Collision { at: 0.0 },
            other => other,
        })
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.interrupt = interrupt.clone();
    }
    fn is_interrupted(&mut self) -> bool {
        self.interrupt.ask()
    }
}
