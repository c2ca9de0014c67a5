//! Intervals of a motion, eight at a time: where links are in their middles, how far they move in them, and lower bounds on distances by
//! the covers of links.

#![allow(clippy::needless_range_loop)] // Rows and columns are indices here.

use super::kinematics::{BaseTravel, JointFrame};
use super::robot::{LinkBody, SharedArm};
use super::travel::{Chain, ROUND_UP};
use mp_collide::{Contacts, Scene, WideCover, wide_apart, wide_apart_here, wide_within_here};
use mp_cspace::{Coordinates, MotionInterval};
use mp_simd::wide::{
    Doubles, Frames, LANES, Wide, Wide3, WideFrame, WideKernel, add, cross, dot, load3, on_widest, sin_cos,
    store3, sub,
};
use nalgebra::{Isometry3, Matrix3};

/// A bound by covers that is at least this part of what is enough is used as it is: it proves a part of the interval, and the exact distance
/// would take longer than the intervals that it saves.
pub(super) const COARSE: f64 = 0.25;
/// No bound is used that is less than this many margins: at two margins an interval would end.
pub(super) const LEAST: f64 = 2.5;

/// What may be in contact.
#[derive(Clone, Copy, Debug)]
pub(super) enum Part {
    /// A link, by its number among the bodies, with obstacles.
    Link(usize),
    /// A pair of links, by its number.
    Pair(usize),
}

/// Up to eight intervals of a motion.
#[derive(Clone, Debug, Default)]
pub(super) struct WideIntervals {
    /// The ends of the motion.
    ends: Vec<f64>,
    /// The middles of the intervals, one after another.
    middles: Vec<f64>,
    halves: [f64; LANES],
    margin: f64,
    count: usize,
    /// The interval that is likely asked about next.
    next: usize,
    frames: Vec<WideFrame>,
    axes: Vec<Wide3>,
    /// As [`Scratch::near`](super::robot::Scratch).
    near: Vec<Wide>,
    /// For each body, what the base adds.
    by_base: Vec<Wide>,
    covers: Vec<WideCover>,
    /// Lower bounds on the distance of each body from obstacles, and of each pair, where they were asked for.
    links: Vec<Option<(Wide, bool)>>,
    pairs: Vec<Option<Wide>>,
    proven: ProvenParts,
    /// What balls left open at the configurations where links are placed, with these as bits.
    pub(super) open: Vec<(Part, u32)>,
    /// For each body, how far it moves over the whole motion with the first joints of its chain: as [`Chain::far`].
    pub(super) far: Vec<f64>,
    pub(super) base: BaseTravel,
    /// For each joint its angle (rad), or how far it slides (m).
    values: Vec<Wide>,
    /// How far each coordinate goes, with its sign.
    displacements: Vec<f64>,
}

impl WideIntervals {
    /// The number of this interval among those that were prepared; it is prepared alone if it is none of them.
    pub(super) fn find<Q: Coordinates>(
        &mut self,
        robot: &SharedArm,
        interval: &MotionInterval<'_, Q>,
    ) -> usize {
        if !(self.next < self.count && self.is(self.next, interval)) {
            self.prepare(robot, std::slice::from_ref(interval));
        }
        self.next += 1;
        self.next - 1
    }

    fn is<Q: Coordinates>(&self, k: usize, interval: &MotionInterval<'_, Q>) -> bool {
        let middle = interval.middle.as_slice();
        self.halves[k] == interval.half
            && self.margin == interval.margin
            && self.middles[k * middle.len()..(k + 1) * middle.len()] == *middle
            && self.is_motion(interval)
    }

    fn is_motion<Q: Coordinates>(&self, interval: &MotionInterval<'_, Q>) -> bool {
        let (from, to) = (interval.from.as_slice(), interval.to.as_slice());
        self.ends.len() == from.len() + to.len()
            && self.ends[..from.len()] == *from
            && self.ends[from.len()..] == *to
    }

    /// Prepares up to eight intervals of one motion, between configurations.
    pub(super) fn prepare<Q: Coordinates>(&mut self, robot: &SharedArm, intervals: &[MotionInterval<'_, Q>]) {
        let intervals = &intervals[..intervals.len().min(LANES)];
        let Some(first) = intervals.first() else { return };
        let kinematics = &robot.kinematics;
        let [from, to] = [first.from, first.to].map(Q::as_slice);
        if !self.is_motion(first) {
            let travels = |i: usize| kinematics.travel(i, from, to);
            self.ends.clear();
            self.ends.extend(from.iter().chain(to));
            self.base = kinematics.base_travel(from, to);
            self.far.clear();
            robot.bodies.iter().for_each(|body| body.chain.far(travels, &mut self.far));
        }
        (self.margin, self.count, self.next) = (first.margin, intervals.len(), 0);
        self.middles.clear();
        for interval in intervals {
            self.middles.extend_from_slice(interval.middle.as_slice());
        }
        self.halves = std::array::from_fn(|k| intervals[if k < self.count { k } else { 0 }].half);
        self.displacements.clear();
        self.displacements
            .extend((0..kinematics.coordinates.len()).map(|i| kinematics.displacement(i, from, to)));
        self.place(robot);
    }

    /// Places links in the middle of the intervals. Not generic, as [`contacts_of_middles`](Self::contacts_of_middles): compiled once, for each
    /// set of instructions.
    fn place(&mut self, robot: &SharedArm) {
        self.set_values(robot, self.count);
        self.axes.clear();
        self.near.clear();
        self.by_base.clear();
        self.links.clear();
        self.links.resize(robot.bodies.len(), None);
        self.pairs.clear();
        self.pairs.resize(robot.pairs.len(), None);
        self.proven =
            ProvenParts { margin: self.margin, halves: Wide(self.halves), ..ProvenParts::default() };
        on_widest(Place {
            robot,
            values: &self.values,
            displacements: &self.displacements,
            halves: Wide(self.halves),
            base: &self.base,
            frames: &mut self.frames,
            axes: &mut self.axes,
            near: &mut self.near,
            by_base: &mut self.by_base,
            covers: &mut self.covers,
        });
    }

    /// Places links at up to eight configurations. Returns those where a link is within `kept` (m) of an obstacle or two links within `apart`
    /// of each other, one at least if it is known that there are any, and those that balls leave open.
    pub(super) fn contacts<Q: Coordinates>(
        &mut self,
        robot: &SharedArm,
        scene: &Scene,
        [kept, apart]: [f64; 2],
        states: &[&Q],
    ) -> Contacts {
        // No interval is prepared then.
        (self.count, self.next) = (0, 0);
        self.middles.clear();
        for state in states {
            self.middles.extend_from_slice(state.as_slice());
        }
        self.contacts_of_middles(robot, scene, [kept, apart], states.len())
    }

    fn contacts_of_middles(
        &mut self,
        robot: &SharedArm,
        scene: &Scene,
        [kept, apart]: [f64; 2],
        count: usize,
    ) -> Contacts {
        self.set_values(robot, count);
        self.open.clear();
        let Self { values, frames, covers, open, .. } = self;
        on_widest(Within { robot, values, frames, covers, scene, kept, apart, open, asked: (1 << count) - 1 })
    }

    /// The frame of the base, and the values of the joints, at the first `count` of `middles`, at least one.
    fn set_values(&mut self, robot: &SharedArm, count: usize) {
        let kinematics = &robot.kinematics;
        // Lanes that are left are as the first.
        let n = self.middles.len() / count;
        let middle = |k: usize| {
            let k = if k < count { k } else { 0 };
            &self.middles[k * n..(k + 1) * n]
        };
        if kinematics.floats() || self.frames.is_empty() {
            self.frames.clear();
            self.frames.push(wide_frame(&std::array::from_fn(|k| kinematics.parts(middle(k)).0)));
        }
        self.frames.truncate(1);
        self.covers.resize_with(robot.bodies.len(), WideCover::default);
        let first = kinematics.first();
        let value = |frame: &JointFrame| {
            Wide(std::array::from_fn(|k| middle(k)[first + frame.coordinate] * frame.scale + frame.offset))
        };
        self.values.clear();
        self.values.extend(kinematics.frames.iter().map(value));
    }

    /// A bound (m) on how far the points of a body move over half of interval `k`.
    pub(super) fn near(&self, k: usize, i: usize, body: &LinkBody) -> f64 {
        self.near[body.last()].0[k] + self.by_base[i].0[k]
    }

    /// A bound (m) on how far the two bodies of pair `p` move relative to each other.
    pub(super) fn near_pair(&self, robot: &SharedArm, p: usize, k: usize) -> f64 {
        self.near_pairs(robot, p).0[k]
    }

    fn near_pairs(&self, robot: &SharedArm, p: usize) -> Wide {
        let [a, b] = of_pair(robot, p, &self.near);
        *a + *b
    }

    /// How far to either side of its middle interval `k` is shown free by bounds that covers give alone, as a fraction of the motion; `None`
    /// where they leave something open.
    pub(super) fn proven(&mut self, robot: &SharedArm, scene: &Scene, kept: f64, k: usize) -> Option<f64> {
        let Self { covers, links, pairs, proven, near, far, by_base, base, .. } = self;
        let lane = 1 << k;
        on_widest(Proving {
            robot,
            scene,
            kept,
            covers,
            links,
            pairs,
            proven,
            near,
            far,
            by_base,
            base,
            lane,
        });
        (self.proven.open & lane == 0).then(|| self.proven.part.0[k])
    }

    /// A lower bound (m) on the distance of body `i` from obstacles in interval `k`, beyond `kept`; and whether it is nearly the distance where
    /// that is not enough.
    pub(super) fn link_apart(
        &mut self,
        robot: &SharedArm,
        scene: &Scene,
        kept: f64,
        i: usize,
        k: usize,
    ) -> (f64, bool) {
        let (found, is_tight) = self.links_apart(robot, scene, kept, i);
        (found.0[k] - kept, is_tight)
    }

    /// The same in all intervals, `kept` included.
    fn links_apart(&mut self, robot: &SharedArm, scene: &Scene, kept: f64, i: usize) -> (Wide, bool) {
        match self.links[i] {
            Some(found) => found,
            None => {
                let body = &robot.bodies[i];
                let near = self.near[body.last()] + self.by_base[i];
                let [enough, some] = enough(near, self.margin).map(|distance| distance + kept);
                let found = scene.wide_apart(&body.cover, &mut self.covers[i], enough, some);
                *self.links[i].insert(found)
            }
        }
    }

    /// A lower bound (m) on the distance of pair `p` in interval `k`.
    pub(super) fn pair_apart(&mut self, robot: &SharedArm, p: usize, k: usize) -> f64 {
        let found = match self.pairs[p] {
            Some(found) => found,
            None => {
                let [enough, some] = enough(self.near_pairs(robot, p), self.margin);
                let [i, j] = robot.pairs[p].bodies;
                let [a, b] = [i, j].map(|i| &robot.bodies[i].cover);
                let found = match self.covers.get_disjoint_mut([i, j]) {
                    Ok([at_a, at_b]) => wide_apart((a, at_a), (b, at_b), enough, some),
                    Err(_) => Wide::splat(f64::NEG_INFINITY),
                };
                *self.pairs[p].insert(found)
            }
        };
        found.0[k]
    }
}

/// What is enough, and what is of use at least, where bodies move as far as `near`.
#[inline(always)]
fn enough<D: Doubles>(near: D, margin: f64) -> [D; 2] {
    let enough = near.max(D::splat(margin)) + margin;
    [enough, (enough * COARSE).max(D::splat(LEAST * margin))]
}

/// What there is for the two bodies of a pair.
#[inline(always)]
fn of_pair<'a, T>(robot: &SharedArm, p: usize, all: &'a [T]) -> [&'a T; 2] {
    let pair = &robot.pairs[p];
    let [a, b] = pair.bodies.map(|i| &robot.bodies[i]);
    [&all[a.first + pair.steps[0]], &all[b.first + pair.steps[1]]]
}

/// The parts of eight intervals that covers show free: link by link and pair by pair, as `ProvenPart` of one interval.
#[derive(Clone, Debug)]
struct ProvenParts {
    margin: f64,
    halves: Wide,
    /// How far the proven part reaches to either side of the middle, as a fraction of the motion.
    part: Wide,
    /// Intervals, as bits, of which covers left something open. The part says nothing for these.
    open: u32,
    /// How many links and pairs were looked at.
    links: usize,
    pairs: usize,
}

impl Default for ProvenParts {
    fn default() -> Self {
        let (halves, part) = (Wide::splat(0.0), Wide::splat(f64::INFINITY));
        Self { margin: 0.0, halves, part, open: 0, links: 0, pairs: 0 }
    }
}

impl ProvenParts {
    /// Adds lower bounds on the distance of one link or pair, which moves by at most `near` over half the intervals, and by at most `far` over
    /// the motion. A bound that is at least `least` margins is used however little it proves.
    #[inline(always)]
    fn add<D: Doubles>(&mut self, near: D, far: f64, known: D, least: Option<f64>) {
        let (margin, halves, part) = (self.margin, D::load(&self.halves), D::load(&self.part));
        // No more than what earlier links and pairs allow.
        let wanted = halves.min(part);
        let near = near * (wanted / halves);
        let [enough, some] = enough(near, margin);
        let some = least.map_or(some, |least| D::splat(least * margin)).min(enough);
        // Written so that NaN is open.
        self.open |= !some.less(known);
        // 0/0 where nothing moves: free all along.
        if far > 0.0 {
            let beyond = known - margin;
            let (all, some) = (wanted.max(beyond / D::splat(far)), wanted * beyond / near);
            self.part = part.min(known.where_less(near + margin, some, all)).store();
        }
    }
}

/// Adds links and pairs of links, until one leaves the interval of `lane`, a bit, open.
struct Proving<'a> {
    robot: &'a SharedArm,
    scene: &'a Scene,
    kept: f64,
    covers: &'a mut [WideCover],
    /// What is known of bodies, and of pairs.
    links: &'a mut [Option<(Wide, bool)>],
    pairs: &'a mut [Option<Wide>],
    proven: &'a mut ProvenParts,
    near: &'a [Wide],
    far: &'a [f64],
    by_base: &'a [Wide],
    base: &'a BaseTravel,
    lane: u32,
}

impl WideKernel for Proving<'_> {
    type Output = ();
    #[inline(always)]
    fn run<D: Doubles>(self) {
        let Self { robot, scene, kept, covers, links, pairs, proven, near, far, by_base, base, lane } = self;
        let floats = robot.kinematics.floats();
        while proven.links < robot.bodies.len() && proven.open & lane == 0 {
            let i = robot.bodies.len() - 1 - proven.links;
            proven.links += 1;
            let body = &robot.bodies[i];
            if !floats && body.frame == 0 {
                continue;
            }
            let near = D::load(&near[body.last()]) + D::load(&by_base[i]);
            let far = far[body.last()] + base.far(body.chain.from_base);
            let (known, is_tight) = match &links[i] {
                Some((known, is_tight)) => (D::load(known), *is_tight),
                None => {
                    let [enough, some] = enough(near, proven.margin).map(|distance| distance + kept);
                    scene.wide_apart_here::<D>(&body.cover, &mut covers[i], enough, some)
                }
            };
            links[i] = Some((known.store(), is_tight));
            proven.add::<D>(near, far, known - kept, is_tight.then_some(LEAST));
        }
        while proven.pairs < robot.pairs.len() && proven.open & lane == 0 {
            let p = proven.pairs;
            proven.pairs += 1;
            let [near_a, near_b] = of_pair(robot, p, near);
            let near = D::load(near_a) + D::load(near_b);
            let bodies = robot.pairs[p].bodies;
            let [a, b] = bodies.map(|i| &robot.bodies[i].cover);
            let known = match (&pairs[p], covers.get_disjoint_mut(bodies)) {
                (Some(known), _) => D::load(known),
                (None, Ok([at_a, at_b])) => {
                    let [enough, some] = enough(near, proven.margin);
                    wide_apart_here::<D>((a, at_a), (b, at_b), enough, some)
                }
                (None, Err(_)) => D::splat(f64::NEG_INFINITY),
            };
            pairs[p] = Some(known.store());
            let is_known = a.is_exact() && b.is_exact();
            let [far_a, far_b] = of_pair(robot, p, far);
            proven.add::<D>(near, far_a + far_b, known, is_known.then_some(2.0));
        }
    }
}

/// Eight poses as one.
fn wide_frame(poses: &[Isometry3<f64>; LANES]) -> WideFrame {
    let turns: [Matrix3<f64>; LANES] = poses.map(|pose| pose.rotation.to_rotation_matrix().into_inner());
    let turn =
        std::array::from_fn(|r| std::array::from_fn(|c| Wide(std::array::from_fn(|k| turns[k][(r, c)]))));
    WideFrame {
        turn,
        origin: std::array::from_fn(|r| Wide(std::array::from_fn(|k| poses[k].translation.vector[r]))),
    }
}

/// Places links, and finds where they are within a distance of obstacles or of each other.
struct Within<'a> {
    robot: &'a SharedArm,
    values: &'a [Wide],
    frames: &'a mut Vec<WideFrame>,
    covers: &'a mut [WideCover],
    scene: &'a Scene,
    kept: f64,
    apart: f64,
    open: &'a mut Vec<(Part, u32)>,
    asked: u32,
}

impl WideKernel for Within<'_> {
    type Output = Contacts;
    #[inline(always)]
    fn run<D: Doubles>(self) -> Contacts {
        let Self { robot, values, frames, covers, scene, kept, apart, open, asked } = self;
        for ((joint, turns), value) in robot.kinematics.frames.iter().zip(&robot.turns).zip(values) {
            let frame = moved::<D>(&frames[joint.parent], joint, turns, value);
            frames.push(frame.store());
        }
        let mut all = Contacts::default();
        let mut add = |part: Part, found: Contacts| {
            let found = Contacts { touching: found.touching & asked, open: found.open & asked };
            if found.open != 0 {
                open.push((part, found.open));
            }
            all.add(found);
            all.touching != 0
        };
        // In the order of `numbered_moving`. As a rule the first links touch where any do: the others are not placed before.
        let floats = robot.kinematics.floats();
        for (i, body) in robot.bodies.iter().enumerate().rev() {
            covers[i].place::<D>(&body.ball, &frames[body.frame]);
            let moves = floats || body.frame > 0;
            if moves && add(Part::Link(i), scene.wide_contact_here::<D>(&body.cover, &mut covers[i], kept)) {
                return all;
            }
        }
        for (p, pair) in robot.pairs.iter().enumerate() {
            let [a, b] = pair.bodies.map(|i| &robot.bodies[i].cover);
            let found = match covers.get_disjoint_mut(pair.bodies) {
                Ok([at_a, at_b]) => wide_within_here::<D>((a, at_a), (b, at_b), apart),
                Err(_) => Contacts { touching: 0, open: asked },
            };
            if add(Part::Pair(p), found) {
                return all;
            }
        }
        all
    }
}

/// Places links, and bounds how far they move.
struct Place<'a> {
    robot: &'a SharedArm,
    values: &'a [Wide],
    displacements: &'a [f64],
    halves: Wide,
    base: &'a BaseTravel,
    frames: &'a mut Vec<WideFrame>,
    axes: &'a mut Vec<Wide3>,
    near: &'a mut Vec<Wide>,
    by_base: &'a mut Vec<Wide>,
    covers: &'a mut [WideCover],
}

impl WideKernel for Place<'_> {
    type Output = ();
    #[inline(always)]
    fn run<D: Doubles>(mut self) {
        let joints = self.robot.kinematics.frames.iter().zip(&self.robot.turns);
        for ((joint, turns), value) in joints.zip(self.values) {
            let frame = moved::<D>(&self.frames[joint.parent], joint, turns, value);
            let axis = joint.axis.as_ref();
            self.axes.push(store3(frame.vector(&[axis.x, axis.y, axis.z])));
            self.frames.push(frame.store());
        }
        for (i, body) in self.robot.bodies.iter().enumerate() {
            self.covers[i].place::<D>(&body.ball, &self.frames[body.frame]);
            let by_joints = self.near::<D>(&body.chain, i);
            let cover = &self.covers[i];
            let base = &self.base;
            let by_base = match base.is_still() {
                true => D::splat(0.0),
                false => {
                    let from_axis = match base.turn > 0.0 {
                        true => {
                            let axis = base.axis;
                            let axis = [D::splat(axis.x), D::splat(axis.y), D::splat(axis.z)];
                            let d = sub(&load3(cover.center()), &load3(&self.frames[0].origin));
                            let v = cross(&d, &axis);
                            dot(&v, &v).sqrt() * (1.0 / base.turn)
                        }
                        false => D::splat(0.0),
                    };
                    let reach = (from_axis + by_joints + cover.radius()).min(D::splat(body.chain.from_base));
                    D::load(&self.halves) * (reach * base.turn + base.slide) * ROUND_UP
                }
            };
            self.by_base.push(by_base.store());
        }
    }
}

impl Place<'_> {
    /// Bounds (m) how far the joints move the points of body `i` from where they are in the middle of the interval: the first joint of its
    /// chain, the first two, and so on. Returns the bound for all of them. Two bounds are computed, and the lesser is taken:
    ///
    /// - that of [`Chain::near`]: the sum of how far each joint alone moves them;
    /// - by Taylor's theorem: a point moves no farther than `h·v + h²/2·a` over half the interval, `h` of the motion, where `v` is its speed in
    ///   the middle and `a` bounds its acceleration. Velocities add as vectors, so that joints that move the body in opposite directions cancel.
    ///
    /// For the second, `v` is at most the speed of the middle of the ball around the body, and its radius times the angular speed. A joint
    /// that turns by `u` over the motion adds at most `2·u·s` (Coriolis) and `u²·r` (centripetal) to the acceleration of a point at most `r`
    /// from its axis, which the joints nearer to the body move at a speed of at most `s`.
    #[inline(always)]
    fn near<D: Doubles>(&mut self, chain: &Chain, i: usize) -> D {
        let (center, radius) = (load3::<D>(self.covers[i].center()), self.covers[i].radius());
        let (halves, zero) = (D::load(&self.halves), D::splat(0.0));
        let mut sum = zero;
        self.near.push(sum.store());
        // Of the ball, in the middle of the interval. The unit of time is the whole motion.
        let (mut velocity, mut angular) = ([zero; 3], [zero; 3]);
        // Bounds for every point, all over the interval.
        let (mut speed, mut acceleration) = (zero, zero);
        for step in &chain.steps {
            let rate =
                self.displacements[step.coordinate] * self.robot.kinematics.frames[step.frame - 1].scale;
            if rate != 0.0 {
                let (axis, by) = (load3::<D>(&self.axes[step.frame - 1]), rate.abs());
                let reach = if step.slides {
                    velocity = add(&velocity, &axis, rate);
                    D::splat(1.0)
                } else {
                    let across = cross(&axis, &sub(&center, &load3(&self.frames[step.frame].origin)));
                    velocity = add(&velocity, &across, rate);
                    angular = add(&angular, &axis, rate);
                    (dot(&across, &across).sqrt() + radius + sum).min(D::splat(step.reach))
                };
                let own = reach * by;
                if !step.slides {
                    acceleration = acceleration + (speed * 2.0 + own) * by;
                }
                speed = speed + own;
                let in_middle = dot(&velocity, &velocity).sqrt() + dot(&angular, &angular).sqrt() * radius;
                // Velocities that cancel leave the rounding of their parts.
                let curved = in_middle + halves * acceleration * 0.5 + speed * (ROUND_UP - 1.0);
                sum = (sum + halves * own * ROUND_UP).min(halves * curved * ROUND_UP);
            }
            self.near.push(sum.store());
        }
        sum
    }
}

/// The parts of the rotation behind a joint: without a turn, and of its cosine and sine.
#[derive(Clone, Debug)]
pub(super) struct Turns {
    still: Matrix3<f64>,
    cos: Matrix3<f64>,
    sin: Matrix3<f64>,
}

impl Turns {
    /// By the formula of Rodrigues: c·1 + s·\[k\]ₓ + (1 − c)·k kᵀ for an axis k, behind the pose of the joint.
    pub(super) fn of(joint: &JointFrame) -> Self {
        let origin = joint.origin.rotation.to_rotation_matrix().into_inner();
        if joint.slides {
            return Self { still: origin, cos: Matrix3::zeros(), sin: Matrix3::zeros() };
        }
        let axis = joint.axis.as_ref();
        let along = axis * axis.transpose();
        Self {
            still: origin * along,
            cos: origin * (Matrix3::identity() - along),
            sin: origin * axis.cross_matrix(),
        }
    }
}

/// The frame behind a joint.
#[inline(always)]
fn moved<D: Doubles>(parent: &WideFrame, joint: &JointFrame, turns: &Turns, value: &Wide) -> Frames<D> {
    let (parent, value) = (Frames::<D>::load(parent), D::load(value));
    let t = joint.origin.translation.vector;
    let (mut origin, mut turn) = (parent.point(&[t.x, t.y, t.z]), parent.turn);
    if joint.slides {
        for c in 0..3 {
            for r in 0..3 {
                let (row, m) = (&parent.turn[r], &turns.still);
                turn[r][c] = row[0] * m[(0, c)] + row[1] * m[(1, c)] + row[2] * m[(2, c)];
            }
        }
        let axis = joint.axis.as_ref();
        for r in 0..3 {
            let along = turn[r][0] * axis.x + turn[r][1] * axis.y + turn[r][2] * axis.z;
            origin[r] = origin[r] + along * value;
        }
        return Frames { turn, origin };
    }
    let [sin, cos] = sin_cos(value);
    for c in 0..3 {
        let mut m = [D::splat(0.0); 3];
        for r in 0..3 {
            m[r] = cos * turns.cos[(r, c)] + sin * turns.sin[(r, c)] + turns.still[(r, c)];
        }
        for r in 0..3 {
            let row = &parent.turn[r];
            turn[r][c] = row[0] * m[0] + row[1] * m[1] + row[2] * m[2];
        }
    }
    Frames { turn, origin }
}

#[cfg(test)]
mod tests;
