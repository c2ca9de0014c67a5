//! An arm among obstacles that stand still.

use super::kinematics::{BaseTravel, Coordinate, Kinematics};
use super::pairs::{LinkPair, compared, fixed_links};
use super::travel::{Chain, axes_into};
use super::verify::ReferenceArm;
use super::wide::{Turns, WideIntervals};
use super::{ArmError, ArmModel};
use crate::CheckCounters;
use crate::obstacles::{MANY, MAX_TRIANGLES, Obstacles, make_once, resolved_tolerance};
use mp_collide::reference::RefMesh;
use mp_collide::{BodyId, CollisionMesh, Cover, PlacedCover, Query, Scene};
use mp_cspace::{Coordinates, FloatingJoints, Interrupt, Interrupted, Joints};
use mp_geom::{Aabb, Sphere, TriMesh};
use nalgebra::{Isometry3, Point3, Vector3};
use std::convert::Infallible;
use std::sync::{Arc, OnceLock};

/// Largest link, metres.
const MAX_RADIUS: f64 = 1e70;

/// A link that can collide.
#[derive(Debug)]
pub(super) struct LinkBody {
    /// The index of the link in the model.
    pub(super) link: usize,
    /// The index of the frame to which it is fixed; 0 is the base.
    pub(super) frame: usize,
    /// Its mesh, in that frame.
    pub(super) mesh: TriMesh,
    pub(super) tree: CollisionMesh,
    pub(super) ball: Sphere,
    pub(super) cover: Cover,
    pub(super) chain: Chain,
    /// The index of its first entry in [`Scratch::far`] and [`Scratch::near`].
    pub(super) first: usize,
}

impl LinkBody {
    /// The ball around it, in the world.
    #[inline]
    pub(super) fn ball_at(&self, frames: &[Isometry3<f64>]) -> Sphere {
        Sphere { center: frames[self.frame] * self.ball.center, radius: self.ball.radius }
    }

    /// The index of its last entry in [`Scratch::far`] and [`Scratch::near`].
    #[inline]
    pub(super) fn last(&self) -> usize {
        self.first + self.chain.steps.len()
    }

    /// A bound (m) on how far its points move, over the part `half` of a motion to either side of a configuration for which
    /// `scratch` is [filled](SharedArm::place_over).
    #[inline]
    pub(super) fn near(&self, base: &BaseTravel, half: f64, scratch: &Scratch) -> f64 {
        let by_joints = scratch.near[self.last()];
        let origin = Point3::from(scratch.frames[0].translation.vector);
        by_joints + base.near(half, self.chain.from_base, &self.ball_at(&scratch.frames), &origin, by_joints)
    }
}

/// The arm without its obstacles: shared by all clones, also among other obstacles.
#[derive(Debug)]
pub(super) struct SharedArm {
    pub(super) kinematics: Kinematics,
    /// In the order of the links.
    pub(super) bodies: Vec<LinkBody>,
    pub(super) pairs: Vec<LinkPair>,
    /// Pairs of bodies that must not touch, and never move relative to each other.
    pub(super) still_pairs: Vec<[usize; 2]>,
    /// Bodies that stand still for joints that are held or have equal limits, and must not touch obstacles.
    pub(super) still_bodies: Vec<usize>,
    /// Whether the covers of all links are [exact](Cover::is_exact).
    pub(super) is_of_balls: bool,
    /// For each joint that moves.
    pub(super) turns: Vec<Turns>,
    /// Which links are not compared, and why, unless the model says so: sentences.
    pub(super) not_compared: Vec<String>,
    /// An upper bound (m) on the distance of any of its points from the base in any configuration.
    pub(super) reach: f64,
    /// As [`reach`](Self::reach), but without what joints slide and without what is fixed to a base that stands still.
    pub(super) length: f64,
    pub(super) model: ArmModel,
    /// The arm as verifiers see it, made for the first one.
    pub(super) reference: OnceLock<Arc<ReferenceArm>>,
}

impl SharedArm {
    pub(super) fn new(model: &ArmModel, interrupt: &Interrupt) -> Result<Self, ArmError> {
        let _span =
            tracing::debug_span!("build", links = model.links.len(), joints = model.joints.len()).entered();
        let kinematics = Kinematics::new(model)?;
        let mut bodies = Vec::new();
        let fixed = fixed_links(model, &kinematics);
        let (mut first, mut count, mut reach, mut lengths) = (0, 0_usize, 0.0_f64, [0.0_f64; 2]);
        for (i, (link, place)) in model.links.iter().zip(&kinematics.attached).enumerate() {
            if link.shapes.is_empty() {
                continue;
            }
            // Shapes are finite, so merging fails only for a shape moved by an invalid pose, or for too many triangles.
            let too_large = |radius| ArmError::TooLarge { link: link.name.clone(), radius, max: MAX_RADIUS };
            let merged = TriMesh::merged(&link.shapes).ok_or_else(|| too_large(f64::NAN))?;
            // A tree has balls alone or triangles alone.
            let merged = if merged.is_balls() { merged } else { merged.faceted() };
            count = count.saturating_add(merged.triangles().len());
            if count > MAX_TRIANGLES {
                return Err(ArmError::TooManyTriangles { count, max: MAX_TRIANGLES });
            }
            let mesh = merged.transformed(&place.pose);
            let chain = Chain::new(&kinematics, &mesh, place.frame);
            let Extent { reach: radius, length: long } = extent_of(&kinematics, &mesh, place.frame);
            // Written so that NaN is refused.
            let small = radius <= MAX_RADIUS;
            if !small {
                return Err(too_large(radius));
            }
            reach = reach.max(radius);
            let length = &mut lengths[usize::from(fixed[i] && !kinematics.floats())];
            *length = length.max(long);
            let entries = chain.steps.len() + 1;
            let tree = CollisionMesh::new_until(&mesh, interrupt).ok_or(Interrupted)?;
            let ball = mesh.bounding_sphere();
            let ball = Sphere { radius: ball.radius * (1.0 + 1e-9), ..ball };
            let (frame, cover) = (place.frame, Cover::new(&mesh));
            bodies.push(LinkBody { link: i, frame, mesh, tree, ball, cover, chain, first });
            first += entries;
        }
        // Floors, walls and tables may be fixed to a base that stands still.
        let [moves, stands] = lengths;
        let length = if moves > 0.0 { moves } else { stands };
        let (model, reference) = (model.clone(), OnceLock::new());
        let turns = kinematics.frames.iter().map(Turns::of).collect();
        let is_of_balls = bodies.iter().all(|body| body.cover.is_exact());
        let mut robot = Self {
            kinematics,
            bodies,
            pairs: Vec::new(),
            still_pairs: Vec::new(),
            still_bodies: Vec::new(),
            is_of_balls,
            turns,
            not_compared: Vec::new(),
            reach,
            length,
            model,
            reference,
        };
        // Closer than this no motion can be certified.
        let close = 2.0 * robot.tolerance(0.0);
        let found = compared(&robot.kinematics, &robot.bodies, &robot.model, close, interrupt)?;
        tracing::debug!(dof = robot.kinematics.dof(), triangles = count, pairs = found.pairs.len(), "arm");
        (robot.pairs, robot.not_compared) = (found.pairs, found.notes);
        (robot.still_pairs, robot.still_bodies) = (found.still_pairs, found.still_bodies);
        Ok(robot)
    }

    /// Sentences about the model and its pairs.
    pub(super) fn notes(&self) -> impl Iterator<Item = &String> {
        self.model.notes.iter().chain(&self.not_compared)
    }

    /// The default tolerance (m) among obstacles whose coordinates are at most `farthest`.
    fn tolerance(&self, farthest: f64) -> f64 {
        let base = match &self.model.floating {
            Some(bounds) => bounds.min.coords.amax().max(bounds.max.coords.amax()),
            None => self.kinematics.base.translation.vector.amax(),
        };
        resolved_tolerance(1e-4 * self.length, base + farthest + self.reach)
    }

    /// The obstacles around this arm.
    fn obstacles(
        &self,
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
        known: Option<&Arc<Obstacles>>,
        interrupt: &Interrupt,
    ) -> Result<Arc<Obstacles>, ArmError> {
        let triangles = self.bodies.iter().map(|body| body.mesh.triangles().len()).sum();
        let too_many = |count| ArmError::TooManyTriangles { count, max: MAX_TRIANGLES };
        Obstacles::new(obstacles, (triangles, MANY), too_many, known, interrupt)
    }

    /// The links that can collide with obstacles: those that move. The last ones move most, so they come first.
    #[inline]
    pub(super) fn moving(&self) -> impl Iterator<Item = &LinkBody> {
        self.numbered_moving().map(|(_, body)| body)
    }

    /// The same with their indices.
    #[inline]
    pub(super) fn numbered_moving(&self) -> impl Iterator<Item = (usize, &LinkBody)> {
        let floats = self.kinematics.floats();
        self.bodies.iter().enumerate().rev().filter(move |(_, body)| floats || body.frame > 0)
    }

    /// The links that are compared with obstacles: those that move, and those that only a held joint keeps from moving. In the order of the
    /// model, with their indices.
    pub(super) fn numbered_compared(&self) -> impl Iterator<Item = (usize, &LinkBody)> {
        let floats = self.kinematics.floats();
        let compared =
            move |i: usize, body: &LinkBody| floats || body.frame > 0 || self.still_bodies.contains(&i);
        self.bodies.iter().enumerate().filter(move |(i, body)| compared(*i, body))
    }

    /// The bodies of all pairs that must not touch, those too that never move relative to each other.
    pub(super) fn all_pairs(&self) -> impl Iterator<Item = [usize; 2]> {
        self.pairs.iter().map(|pair| pair.bodies).chain(self.still_pairs.iter().copied())
    }

    /// The least distances (m) of what never moves: of links from obstacles, and of links from each other. Zero where one is inside of the other.
    pub(super) fn still_distances(&self, scene: &Scene, query: &mut Query) -> [f64; 2] {
        let (base, mut from_obstacles, mut from_links) = (self.kinematics.base, f64::INFINITY, f64::INFINITY);
        for body in self.still_bodies.iter().map(|i| &self.bodies[*i]) {
            from_obstacles = from_obstacles.min(scene.clearance(query, &body.tree, &base, from_obstacles).0);
        }
        let here = Isometry3::identity();
        for pair in &self.still_pairs {
            let [a, b] = pair.map(|i| &self.bodies[i]);
            let distance = query.clearance(&a.tree, &here, &b.tree, &here, from_links);
            let filled = a.tree.is_filled() || b.tree.is_filled();
            let is_nested = filled && query.nested(&a.tree, &here, &b.tree, &here);
            from_links = if is_nested { 0.0 } else { from_links.min(distance) };
        }
        [from_obstacles, from_links]
    }

    /// A lower bound (m) on the distance of the two links of a pair by their covers, if that is at least `enough` (m). Links are
    /// [placed](Self::place).
    #[inline]
    pub(super) fn apart(&self, pair: &LinkPair, covers: &mut [PlacedCover], enough: f64) -> Option<f64> {
        let [i, j] = pair.bodies;
        let [a, b] = [i, j].map(|k| &self.bodies[k].cover);
        match covers.get_disjoint_mut([i, j]) {
            Ok([at_a, at_b]) => at_a.apart(a, at_b, b, enough),
            Err(_) => None,
        }
    }

    /// Places all links at the configuration `q`, and bounds how far joints that go as far as `travels` says move them.
    pub(super) fn place_over(&self, q: &[f64], travels: impl Fn(usize) -> f64, scratch: &mut Scratch) {
        self.place(q, scratch);
        let Scratch { frames, axes, balls, near, .. } = scratch;
        axes_into(&self.kinematics, frames, axes);
        near.clear();
        for (body, ball) in self.bodies.iter().zip(balls) {
            body.chain.near(&travels, ball, axes, near);
        }
    }

    /// [Places](Self::place) all links unless `is_placed`, and sets it.
    #[inline]
    pub(super) fn place_once(&self, q: &[f64], scratch: &mut Scratch, is_placed: &mut bool) {
        if !std::mem::replace(is_placed, true) {
            self.place(q, scratch);
        }
    }

    /// Places all links at the configuration `q`.
    pub(super) fn place(&self, q: &[f64], scratch: &mut Scratch) {
        let Scratch { frames, balls, covers, .. } = scratch;
        self.kinematics.frames_into(q, frames);
        balls.clear();
        balls.extend(self.bodies.iter().map(|body| body.ball_at(frames)));
        covers.resize_with(self.bodies.len(), PlacedCover::default);
        for ((body, ball), cover) in self.bodies.iter().zip(balls).zip(covers) {
            cover.place(*ball, &frames[body.frame]);
        }
    }

    pub(super) fn checked_pairs(&self) -> impl Iterator<Item = [&str; 2]> {
        self.all_pairs().map(|pair| pair.map(|body| self.name(body)))
    }

    /// Whether of two links that must not touch one is solid and the other inside of it. Links are [placed](Self::place_over), their
    /// surfaces apart.
    pub(super) fn has_nested_links(&self, query: &mut Query, scratch: &Scratch) -> bool {
        self.pairs.iter().any(|pair| {
            let bodies = pair.bodies.map(|i| &self.bodies[i]);
            scratch.apart(pair) <= 0.0 && are_nested(query, bodies, &scratch.frames)
        })
    }

    pub(super) fn name(&self, body: usize) -> &str {
        &self.kinematics.attached[self.bodies[body].link].name
    }
}

/// How far (m) the points of a link are from the base.
struct Extent {
    /// An upper bound in any configuration.
    reach: f64,
    /// The same from the lengths of links alone. What carries the link without ever turning it counts no more than the rest: it
    /// places the link, like the pose of the base.
    length: f64,
}

/// The extent of `mesh`, given in the frame `frame`.
fn extent_of(kinematics: &Kinematics, mesh: &TriMesh, frame: usize) -> Extent {
    // `max` would drop NaN.
    let largest = |a: f64, b: f64| if b > a || b.is_nan() { b } else { a };
    let own = mesh.vertices().iter().map(|p| p.coords.norm()).fold(0.0, largest);
    let own = own + mesh.rounding().unwrap_or(0.0);
    let (mut reach, mut turned, mut placed) = (own, None, own);
    let mut at = frame;
    while at > 0 {
        let joint = &kinematics.frames[at - 1];
        if !joint.slides {
            turned = Some(placed);
        }
        let origin = joint.origin.translation.vector.norm();
        (reach, placed, at) = (reach + joint.slide + origin, placed + origin, joint.parent);
    }
    // What nothing turns is as long as it is itself.
    let turned = turned.unwrap_or_else(|| own.min(2.0 * mesh.bounding_sphere().radius));
    Extent { reach, length: placed.min(2.0 * turned) }
}

/// Whether of two links one is solid and the other inside of it, where their surfaces are apart.
pub(super) fn are_nested(query: &mut Query, [a, b]: [&LinkBody; 2], frames: &[Isometry3<f64>]) -> bool {
    (a.tree.is_filled() || b.tree.is_filled())
        && query.nested(&a.tree, &frames[a.frame], &b.tree, &frames[b.frame])
}

/// Scratch memory of one clone.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    pub(super) frames: Vec<Isometry3<f64>>,
    pub(super) axes: Vec<(Point3<f64>, Vector3<f64>)>,
    pub(super) balls: Vec<Sphere>,
    /// The covers of the links, for what balls around them leave undecided.
    pub(super) covers: Vec<PlacedCover>,
    /// Links that covers do not show free of obstacles, or that may have a solid inside; and whether their surfaces are shown free.
    pub(super) undecided: Vec<(usize, bool)>,
    /// Intervals of the motion that is checked.
    pub(super) wide: WideIntervals,
    pub(super) near: Vec<f64>,
    /// The ends of the last motion that has a state where no link is inside of anything: where it touches nothing, that holds for all
    /// of it.
    pub(super) apart: Vec<f64>,
}

impl Scratch {
    /// A lower bound (m) on the distance of a pair of links, by the balls around them.
    #[inline]
    pub(super) fn apart(&self, pair: &LinkPair) -> f64 {
        let [a, b] = pair.bodies.map(|i| &self.balls[i]);
        (a.center - b.center).norm() - a.radius - b.radius
    }
}

/// An arm, or any tree of links, among named obstacles that stand still.
///
/// A configuration is a list of joint values (`SVector<f64, N>` or `Configuration`), one for each
/// [coordinate](Arm::coordinates); its space is [`space`](Arm::space). If the [root floats](ArmModel::floating), the pose
/// of the root comes first, as seven numbers, and the space is [`floating_space`](Arm::floating_space). It is free when
///
/// - no link that can move has a point in common with an obstacle. Links that are fixed to the base are not tested against
///   obstacles, which stand still too: a table may touch the base that it carries. Links that stand still because joints are
///   [held](ArmModel::holding), or have equal limits, are tested;
/// - no two links have a point in common, except pairs that fixed joints connect, pairs that one joint
///   connects (a link without a shape stands for the one that it is fixed to), and pairs that may touch: those of [`ArmModel::may_touch`] if given, else those that touch
///   at each of 100 configurations, the neutral one and 99 of the Halton sequence. Pairs within twice the tolerance of each
///   other at each of these are left out too, as are links that are fixed to one of two that a joint connects and touch the other one at the
///   neutral configuration; [`Arm::notes`] says so. Which joints are held, and what limits a problem gives them, makes no difference.
///
/// Meshes are surfaces and primitives solids, as for [`RigidBody`](crate::RigidBody): touching is collision, a link wholly inside
/// a closed mesh is free, one inside a solid is not. The space checks the limits.
///
/// Distances between links count as clearance, like those to obstacles.
///
/// Clones share meshes and trees. Each clone has its own counters and scratch memory, so clone it for each thread.
/// Checks allocate nothing once the scratch memory has grown.
#[derive(Clone, Debug)]
pub struct Arm {
    pub(super) robot: Arc<SharedArm>,
    pub(super) obstacles: Arc<Obstacles>,
    pub(super) query: Query,
    pub(super) counters: CheckCounters,
    pub(super) scratch: Scratch,
    /// What checks of clearance ask whether to end.
    pub(super) interrupt: Interrupt,
    /// The clearance (m) to keep from obstacles.
    pub(super) kept: f64,
    /// The [distances of what never moves](SharedArm::still_distances), found at the first use.
    pub(super) still: Arc<OnceLock<[f64; 2]>>,
}

impl Arm {
    /// The arm of `model` among obstacles: each a name, a mesh and its pose in the world.
    ///
    /// # Errors
    /// When the model is not valid (see [`ArmError`]), or an obstacle has an invalid pose or is too large.
    pub fn new(
        model: &ArmModel,
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
    ) -> Result<Self, ArmError> {
        Self::new_until(model, obstacles, &Interrupt::never())
    }

    /// As [`new`](Self::new), unless `interrupt` says to end.
    ///
    /// # Errors
    /// As [`new`](Self::new), and [`Interrupted`](ArmError::Interrupted) when it was interrupted.
    pub fn new_until(
        model: &ArmModel,
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
        interrupt: &Interrupt,
    ) -> Result<Self, ArmError> {
        let robot = SharedArm::new(model, interrupt)?;
        let obstacles = robot.obstacles(obstacles, None, interrupt)?;
        Ok(Self {
            robot: Arc::new(robot),
            obstacles,
            query: Query::default(),
            counters: CheckCounters::default(),
            scratch: Scratch::default(),
            interrupt: Interrupt::never(),
            kept: 0.0,
            still: Arc::default(),
        })
    }

    /// The same arm, which keeps the clearance `kept` (m) from obstacles, not between its own links: what is nearer counts as in contact,
    /// clearances of obstacles are less by this much, and an [`ArmVerifier`](crate::ArmVerifier) of it proves that it is kept.
    #[must_use]
    pub fn keeping(mut self, kept: f64) -> Self {
        self.scratch = Scratch::default();
        Self { kept: crate::kept::asked(kept), ..self }
    }

    /// The clearance (m) that it [keeps](Self::keeping) from obstacles: zero, unless asked for.
    #[must_use]
    pub fn kept(&self) -> f64 {
        self.kept
    }

    /// The least clearance (m) of what never moves, beyond what is kept: of links that joints hold in their place. Infinite without any.
    pub(super) fn still_clearance(&mut self) -> f64 {
        let Self { robot, obstacles, kept, still, .. } = self;
        if robot.still_bodies.is_empty() && robot.still_pairs.is_empty() {
            return f64::INFINITY;
        }
        // By queries of its own: which clone asks first must not show in what it counts.
        let [from_obstacles, from_links] =
            *still.get_or_init(|| robot.still_distances(&obstacles.scene, &mut Query::default()));
        (from_obstacles - *kept).min(from_links).max(0.0)
    }

    /// The names of the links that are compared with obstacles though they stand still, as joints are held.
    pub fn held_links(&self) -> impl Iterator<Item = &str> {
        self.robot.still_bodies.iter().map(|i| self.robot.name(*i))
    }

    /// The names of the links that are compared with obstacles.
    pub fn compared_with_obstacles(&self) -> impl Iterator<Item = &str> {
        self.robot.numbered_compared().map(|(i, _)| self.robot.name(i))
    }

    /// The same arm, whose clearance is zero once `interrupt` says to end: searches for a free configuration end soon then.
    #[must_use]
    pub fn with_interrupt(self, interrupt: Interrupt) -> Self {
        Self { interrupt, ..self }
    }

    /// The same arm among other obstacles. Counters start at zero.
    ///
    /// # Errors
    /// When an obstacle has an invalid pose or is too large.
    pub fn among(
        &self,
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
    ) -> Result<Self, ArmError> {
        self.among_until(obstacles, &Interrupt::never())
    }

    /// As [`among`](Self::among), unless `interrupt` says to end.
    ///
    /// # Errors
    /// As [`among`](Self::among), and [`Interrupted`](ArmError::Interrupted) when it was interrupted.
    pub fn among_until(
        &self,
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
        interrupt: &Interrupt,
    ) -> Result<Self, ArmError> {
        let obstacles = self.robot.obstacles(obstacles, Some(&self.obstacles), interrupt)?;
        let mut other =
            Self { obstacles, scratch: Scratch::default(), still: Arc::default(), ..self.clone() };
        other.take_counters();
        Ok(other)
    }

    /// Makes what an [`ArmVerifier`](crate::ArmVerifier) would make at its first use, which takes long for large meshes, unless
    /// `interrupt` says to end. Clones share it.
    ///
    /// # Errors
    /// When it was interrupted.
    pub fn make_ready(&self, interrupt: &Interrupt) -> Result<(), Interrupted> {
        let (robot, mut asked) = (&*self.robot, interrupt.clone());
        make_once(&robot.reference, interrupt, || {
            let tree = |mesh: &TriMesh| RefMesh::new_until(mesh, interrupt).ok_or(Interrupted);
            ReferenceArm::new(&robot.model, robot.checked_pairs(), tree, || asked.go_on()).map(Arc::new)
        })?;
        self.obstacles.make_references(interrupt)
    }

    /// The arm as verifiers see it.
    pub(super) fn reference(&self) -> Arc<ReferenceArm> {
        let robot = &*self.robot;
        Arc::clone(robot.reference.get_or_init(|| {
            let tree = |mesh: &TriMesh| Ok::<_, Infallible>(RefMesh::new(mesh));
            let Ok(made) = ReferenceArm::new(&robot.model, robot.checked_pairs(), tree, || Ok(()));
            Arc::new(made)
        }))
    }

    /// The model that it was made from.
    #[must_use]
    pub fn model(&self) -> &ArmModel {
        &self.robot.model
    }

    /// What was odd about the model, and what was decided for it: which links are [not compared](Self::not_compared). Sentences.
    pub fn notes(&self) -> impl Iterator<Item = &String> {
        self.robot.notes()
    }

    /// Which links are not compared with each other, though no file says so, and why: a sentence for each two.
    #[must_use]
    pub fn not_compared(&self) -> &[String] {
        &self.robot.not_compared
    }

    /// Its kinematic tree.
    #[must_use]
    pub fn kinematics(&self) -> &Kinematics {
        &self.robot.kinematics
    }

    /// The coordinates of a configuration, in order.
    #[must_use]
    pub fn coordinates(&self) -> &[Coordinate] {
        self.kinematics().coordinates()
    }

    /// The number of degrees of freedom: one for each coordinate, and six more if the base floats.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.kinematics().dof()
    }

    /// The space of its configurations: see [`Kinematics::space`].
    ///
    /// # Errors
    /// When `Q` has another number of coordinates, or the base floats.
    pub fn space<Q: Coordinates>(&self) -> Result<Joints<Q>, ArmError> {
        self.kinematics().space()
    }

    /// The space of its configurations if the base floats: poses of the base in its box, and the joints.
    ///
    /// # Errors
    /// When the base stands still.
    pub fn floating_space(&self) -> Result<FloatingJoints, ArmError> {
        self.kinematics().floating_space()
    }

    /// The name of each link that can collide, and its mesh in the world at `q`. Empty when `q` is not a configuration.
    /// Slow: meant for pictures.
    #[must_use]
    pub fn meshes_at(&self, q: &[f64]) -> Vec<(&str, TriMesh)> {
        let mut frames = Vec::new();
        if !self.kinematics().is_configuration(q) {
            return Vec::new();
        }
        self.kinematics().frames_into(q, &mut frames);
        let bodies = self.robot.bodies.iter().enumerate();
        bodies.map(|(i, body)| (self.robot.name(i), body.mesh.transformed(&frames[body.frame]))).collect()
    }

    /// The names of the pairs of links that must not touch.
    #[must_use]
    pub fn checked_pairs(&self) -> Vec<[&str; 2]> {
        self.robot.checked_pairs().collect()
    }

    /// An upper bound (m) on the distance of any of its points from the base in any configuration, from the lengths of
    /// its links and how far joints slide.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.robot.reach
    }

    /// For each coordinate, how far (m) a unit of it moves any point of the robot, at most: the largest distance of a point
    /// from the axis of a joint, 1 for a joint that slides. Zero where it moves nothing that can collide.
    #[must_use]
    pub fn coordinate_reaches(&self) -> Vec<f64> {
        let mut reaches = vec![0.0_f64; self.coordinates().len()];
        for step in self.robot.bodies.iter().flat_map(|body| &body.chain.steps) {
            let (i, reach) = step.unit_reach();
            reaches[i] = reaches[i].max(reach);
        }
        reaches
    }

    /// The obstacles, by name.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.obstacles.scene
    }

    /// The obstacles in the world, with their names.
    pub fn obstacles(&self) -> impl Iterator<Item = (&str, &TriMesh)> {
        let name = |id: &BodyId| self.obstacles.scene.body(*id).map_or("", |body| body.name());
        self.obstacles.placed.iter().map(move |(id, mesh)| (name(id), &**mesh))
    }

    /// The box around all obstacles; empty when there are none.
    #[must_use]
    pub fn obstacle_bounds(&self) -> Aabb {
        self.obstacles.bounds
    }

    /// How long (m) the robot is: as [`reach`](Self::reach) from the lengths of its links, but without how far joints slide. A
    /// robot on long rails is no longer than one on the floor.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.robot.length
    }

    /// The default tolerance (m) of certified motion checks: 1e-4 of its [length](Self::length), and at least what
    /// coordinates can resolve. An [`ArmVerifier`](crate::ArmVerifier) uses a tenth of it.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.robot.tolerance(self.obstacles.farthest())
    }

    /// The checks made by this clone so far.
    #[must_use]
    pub fn counters(&self) -> CheckCounters {
        self.counters.with(&self.query)
    }

    /// Sets the counters of this clone to zero. Returns the counts before.
    pub fn take_counters(&mut self) -> CheckCounters {
        self.counters.take(&mut self.query)
    }
}
