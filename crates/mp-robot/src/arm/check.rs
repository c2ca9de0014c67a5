//! The checks of an arm that planners use: validity, clearance and motions.

use super::Arm;
use super::pairs::LinkPair;
use super::robot::{LinkBody, Scratch, SharedArm, are_nested};
use super::wide::{COARSE, LEAST, Part};
use crate::kept::beyond;
use mp_collide::{BodyId, Contacts, Query, Scene};
use mp_cspace::{
    Clearance, ClearanceSearch, Configuration, Coordinates, IntervalClearance, LeastClearance,
    MotionClearance, MotionInterval, Rng, Validity, obstacles::ObstacleHints,
};
use mp_simd::wide::LANES;
use nalgebra::Isometry3;
use std::collections::VecDeque;

impl Arm {
    /// Whether `q` is in collision, or no configuration. Leaves the frames at `q` in the scratch memory.
    pub(super) fn collides(&mut self, q: &[f64]) -> bool {
        self.is_within(q, 0.0)
    }

    /// Whether `q` has less clearance than `clearance` (m), is in collision if that is zero, or is no configuration. Leaves the frames at `q`
    /// in the scratch memory.
    fn is_within(&mut self, q: &[f64], clearance: f64) -> bool {
        self.counters.collision_checks += 1;
        if self.still_clearance() <= 0.0 {
            return true;
        }
        let Self { robot, obstacles, query, scratch, kept, .. } = self;
        let kept = *kept + clearance;
        if !robot.kinematics.is_configuration(q) {
            return true;
        }
        robot.place(q, scratch);
        let Scratch { frames, balls, covers, undecided, .. } = scratch;
        let scene = &obstacles.scene;
        // What covers decide costs less than any tree: all of that first.
        let beyond = |distance: f64| (distance * (1.0 + 1e-9)).max(f64::MIN_POSITIVE);
        undecided.clear();
        undecided.extend(robot.numbered_moving().filter_map(|(i, body)| {
            let by_balls = scene.apart(&body.cover, &mut covers[i], beyond(kept)).is_some();
            // Outside of all boxes it is in no solid, but solids may be in it.
            (!by_balls || body.tree.is_filled()).then_some((i, by_balls))
        }));
        let touches = undecided.iter().any(|&(i, by_balls)| {
            let body = &robot.bodies[i];
            match by_balls {
                true => scene.nested(query, &body.tree, &frames[body.frame]).is_some(),
                false => link_within(robot, scene, query, frames, i, kept),
            }
        });
        if touches {
            return true;
        }
        robot.pairs.iter().any(|pair| {
            let [a, b] = pair.bodies.map(|k| &robot.bodies[k]);
            // With solids, only balls around all of them say that none is inside of the other.
            let by_balls = match a.tree.is_filled() || b.tree.is_filled() {
                true => {
                    let [a, b] = pair.bodies.map(|k| &balls[k]);
                    (a.center - b.center).norm() > a.radius + b.radius + clearance
                }
                false => robot.apart(pair, covers, beyond(clearance)).is_some(),
            };
            !by_balls && pair_within(robot, query, frames, pair, clearance)
        })
    }

    /// The first of the configurations, at which links are placed in lanes, where a part that balls left open is nearer than `clearance` (m).
    fn first_of_open<Q: Coordinates>(&mut self, states: &[&Q], clearance: f64) -> Option<usize> {
        let Self { robot, obstacles, query, scratch, kept, .. } = self;
        let kept = *kept + clearance;
        (0..states.len()).find(|k| {
            let mut is_placed = false;
            (0..scratch.wide.open.len()).any(|i| {
                let (part, lanes) = scratch.wide.open[i];
                if lanes >> k & 1 == 0 {
                    return false;
                }
                robot.place_once(states[*k].as_slice(), scratch, &mut is_placed);
                let frames = &scratch.frames;
                match part {
                    Part::Link(i) => link_within(robot, &obstacles.scene, query, frames, i, kept),
                    Part::Pair(p) => pair_within(robot, query, frames, &robot.pairs[p], clearance),
                }
            })
        })
    }
}

/// Whether link `i` is within `kept` (m) of an obstacle, or touches one if that is zero.
fn link_within(
    robot: &SharedArm,
    scene: &Scene,
    query: &mut Query,
    frames: &[Isometry3<f64>],
    i: usize,
    kept: f64,
) -> bool {
    let body = &robot.bodies[i];
    let (tree, pose) = (&body.tree, &frames[body.frame]);
    match kept > 0.0 {
        true => scene.within(query, tree, pose, kept),
        false => scene.collides(query, tree, pose),
    }
}

/// Whether the links of a pair are within `clearance` (m) of each other, or touch if that is zero.
fn pair_within(
    robot: &SharedArm,
    query: &mut Query,
    frames: &[Isometry3<f64>],
    pair: &LinkPair,
    clearance: f64,
) -> bool {
    let [a, b] = pair.bodies.map(|i| &robot.bodies[i]);
    let [pose_a, pose_b] = [a, b].map(|body| &frames[body.frame]);
    match clearance > 0.0 {
        true => query.within(&a.tree, pose_a, &b.tree, pose_b, clearance),
        false => query.meets(&a.tree, pose_a, &b.tree, pose_b),
    }
}

impl<Q: Coordinates> Validity<Q> for Arm {
    fn is_valid(&mut self, q: &Q) -> bool {
        self.first_within(&[q], 0.0).is_none()
    }
}

impl<Q: Coordinates> Clearance<Q> for Arm {
    /// The least distance of links from obstacles, beyond what is kept, and from each other.
    fn clearance(&mut self, q: &Q, enough: f64) -> f64 {
        self.least_clearance(q, enough, true).0
    }

    fn obstacle_clearance(&mut self, q: &Q, enough: f64) -> f64 {
        self.least_clearance(q, enough, false).0
    }

    fn in_contact(&mut self, q: &Q) -> bool {
        self.first_within(&[q], 0.0).is_some()
    }
}

/// What is nearest to each other.
#[derive(Clone, Copy, Debug)]
pub(super) enum Nearest {
    /// A link, by its number among the bodies, and an obstacle.
    Obstacle(usize, BodyId),
    /// Two links, by the number of their pair.
    Pair(usize),
}

impl Arm {
    /// The least distance (m), and what is that near: `None` where the distance is at least `enough`, or where what is nearest never moves.
    /// Leaves the frames at `q` in the scratch memory.
    pub(super) fn least_clearance<Q: Coordinates>(
        &mut self,
        q: &Q,
        enough: f64,
        of_links: bool,
    ) -> (f64, Option<Nearest>) {
        self.counters.clearance_checks += 1;
        let mut least = if of_links { self.still_clearance() } else { f64::INFINITY };
        let mut nearest = None;
        let Self { robot, obstacles, query, scratch, interrupt, kept, .. } = self;
        if interrupt.ask() || !robot.kinematics.is_configuration(q.as_slice()) {
            return (0.0, None);
        }
        let frames = &mut scratch.frames;
        robot.kinematics.frames_into(q.as_slice(), frames);
        let enough = if enough.is_nan() { f64::INFINITY } else { enough };
        for (i, body) in robot.numbered_moving() {
            let (scene, limit, mut obstacle) = (&obstacles.scene, enough.min(least), None);
            let found = beyond(*kept, limit, |limit| {
                let (found, id) = scene.clearance(query, &body.tree, &frames[body.frame], limit);
                obstacle = id;
                found
            });
            if found < limit {
                nearest = obstacle.map(|id| Nearest::Obstacle(i, id));
            }
            least = least.min(found);
            if least <= 0.0 {
                return (0.0, nearest);
            }
        }
        for (p, pair) in robot.pairs.iter().enumerate().filter(|_| of_links) {
            let [a, b] = pair.bodies.map(|i| &robot.bodies[i]);
            let limit = enough.min(least);
            let distance = query.clearance(&a.tree, &frames[a.frame], &b.tree, &frames[b.frame], limit);
            if distance < limit {
                nearest = Some(Nearest::Pair(p));
            }
            least = least.min(distance);
            if least <= 0.0 || are_nested(query, [a, b], frames) {
                return (0.0, Some(Nearest::Pair(p)));
            }
        }
        (least, nearest)
    }
}

/// A clearance that is less than the least one found, but not less than this much of it, is not looked for.
const LESS: f64 = 1.0 - 1e-6;

/// The part of a motion interval that is shown free so far.
pub(super) struct ProvenPart {
    pub(super) margin: f64,
    pub(super) half: f64,
    /// How far the proven part reaches to either side of the middle, as a fraction of the motion.
    pub(super) part: f64,
}

impl ProvenPart {
    /// How far a link or pair moves by the part of the interval that matters, where it moves by at most `near` over half the interval and
    /// proportionally less over a smaller part of it; and which distance is enough to prove that part free.
    #[inline]
    pub(super) fn wanted(&self, near: f64) -> (f64, f64) {
        // No more than what earlier links and pairs allow.
        let near = near * (self.half.min(self.part) / self.half);
        (near, near.max(self.margin) + self.margin)
    }

    /// Adds a lower bound on the distance of one link or pair, which moves by at most [`near`](Self::wanted), and by at most `far` over
    /// the whole motion. Returns an answer if the remaining links and pairs need no test.
    #[inline]
    pub(super) fn add(&mut self, near: f64, far: f64, clearance: f64) -> Option<IntervalClearance> {
        let (margin, wanted) = (self.margin, self.half.min(self.part));
        let part = if clearance <= 0.0 {
            return Some(IntervalClearance::Collision { at: 0.0 });
        } else if clearance >= near + margin {
            wanted.max((clearance - margin) / far)
        } else if clearance >= 2.0 * margin {
            wanted * (clearance - margin) / near
        } else {
            return Some(IntervalClearance::TooClose { at: 0.0 });
        };
        // 0/0 where nothing moves: free all along.
        self.part = self.part.min(if far > 0.0 { part } else { f64::INFINITY });
        None
    }
}

/// Whether `known`, a lower bound on a distance by covers, says enough: at least `enough`, or so much of it that the exact distance would
/// take longer than the intervals that it saves.
#[inline]
pub(super) fn is_of_use(known: f64, enough: f64, margin: f64) -> bool {
    known >= enough || known >= (COARSE * enough).max(LEAST * margin)
}

impl<Q: Coordinates> MotionClearance<Q> for Arm {
    /// The largest travel of any link, or of two links relative to each other, along the interpolation of the
    /// [space](Arm::space) of the arm. For a link this is a sum over the joints above it: how far the joint goes, times the
    /// largest distance of a point of the link from the joint's axis. A base that floats adds how far its origin goes, and its
    /// turn times the largest distance of a point of the link from it. For configurations within the limits.
    fn motion_bound(&self, from: &Q, to: &Q) -> f64 {
        let (robot, from, to) = (&*self.robot, from.as_slice(), to.as_slice());
        let kinematics = &robot.kinematics;
        let (joints, numbers) =
            (kinematics.coordinates.len(), kinematics.first() + kinematics.coordinates.len());
        if from.len() != numbers || to.len() != numbers {
            return f64::INFINITY;
        }
        // Once, as many links and pairs ask for them.
        let of_joints = Configuration::from_fn(joints, |i| kinematics.travel(i, from, to));
        let travels = |i: usize| of_joints[i];
        let base = kinematics.base_travel(from, to);
        // `max` would drop NaN.
        if !(of_joints.iter().all(|travel| travel.is_finite()) && base.far(1.0).is_finite()) {
            return f64::INFINITY;
        }
        let whole = |body: &LinkBody| body.chain.whole(travels) + base.far(body.chain.from_base);
        let links = robot.bodies.iter().map(whole).fold(0.0, f64::max);
        let pairs = robot.pairs.iter().filter(|pair| pair.steps.iter().all(|steps| *steps > 0)).map(|pair| {
            let [a, b] = pair.bodies.map(|i| &robot.bodies[i].chain);
            a.part(pair.steps[0], travels) + b.part(pair.steps[1], travels)
        });
        pairs.fold(links, f64::max)
    }
    /// Link by link and pair by pair, each with its own travel, so that a link near the base may be near an obstacle without
    /// shortening the interval for the others. The two links of a pair move relative to each other only by the joints
    /// between them.
    fn interval_clearance(&mut self, interval: &MotionInterval<'_, Q>) -> IntervalClearance {
        self.counters.clearance_checks += 1;
        match self.still_clearance() {
            still if still <= 0.0 => return IntervalClearance::Collision { at: 0.0 },
            // Less than verifiers can tell.
            still if still < 0.2 * self.tolerance() => return IntervalClearance::TooClose { at: 0.0 },
            _ => {}
        }
        let [from, to, middle] = [interval.from, interval.to, interval.middle].map(Q::as_slice);
        let Self { robot, obstacles, query, scratch, kept, .. } = self;
        if ![from, to, middle].into_iter().all(|q| robot.kinematics.is_configuration(q)) {
            return IntervalClearance::Collision { at: 0.0 };
        }
        let scene = &obstacles.scene;
        let k = scratch.wide.find(robot, interval);
        let mut is_placed = false;
        let mut proven = ProvenPart { margin: interval.margin, half: interval.half, part: f64::INFINITY };
        let by_covers = scratch.wide.proven(robot, scene, *kept, k);
        if let Some(part) = by_covers {
            proven.part = part;
        }
        // All of it where covers leave something open.
        let is_open = by_covers.is_none();
        for (i, body) in robot.numbered_moving().filter(|_| is_open) {
            let wide = &mut scratch.wide;
            let (near, enough) = proven.wanted(wide.near(k, i, body));
            let far = wide.far[body.last()] + wide.base.far(body.chain.from_base);
            let (mut clearance, is_tight) = wide.link_apart(robot, scene, *kept, i, k);
            // A bound that is nearly the distance is as good as that, but for contact.
            let is_known = is_tight && clearance >= LEAST * interval.margin;
            if !is_known && !is_of_use(clearance, enough, interval.margin) {
                robot.place_once(middle, scratch, &mut is_placed);
                let pose = &scratch.frames[body.frame];
                let found = |limit| scene.surface_clearance(query, &body.tree, pose, limit).0;
                clearance = beyond(*kept, enough, found);
            }
            if let Some(answer) = proven.add(near, far, clearance) {
                return answer;
            }
        }
        for (p, pair) in robot.pairs.iter().enumerate().filter(|_| is_open) {
            let [a, b] = pair.bodies.map(|i| &robot.bodies[i]);
            let wide = &mut scratch.wide;
            let (near, enough) = proven.wanted(wide.near_pair(robot, p, k));
            let far = wide.far[a.first + pair.steps[0]] + wide.far[b.first + pair.steps[1]];
            let mut clearance = wide.pair_apart(robot, p, k);
            let is_known = a.cover.is_exact() && b.cover.is_exact();
            if !is_known && !is_of_use(clearance, enough, interval.margin) {
                robot.place_once(middle, scratch, &mut is_placed);
                let frames = &scratch.frames;
                clearance = query.clearance(&a.tree, &frames[a.frame], &b.tree, &frames[b.frame], enough);
            }
            if let Some(answer) = proven.add(near, far, clearance) {
                return answer;
            }
        }
        // Nothing gets inside without meeting a surface: one state of a motion decides for all of it.
        let ends = || from.iter().chain(to).copied();
        if !scratch.apart.iter().copied().eq(ends()) {
            robot.place_once(middle, scratch, &mut is_placed);
            let inside = |body: &LinkBody| {
                obstacles.scene.nested(query, &body.tree, &scratch.frames[body.frame]).is_some()
            };
            if robot.moving().any(inside) || robot.has_nested_links(query, scratch) {
                return IntervalClearance::Collision { at: 0.0 };
            }
            scratch.apart.clear();
            scratch.apart.extend(ends());
        }
        IntervalClearance::FreeOver { part: proven.part }
    }
    fn intervals_at_once(&self) -> usize {
        LANES
    }
    fn contacts_at_once(&self) -> usize {
        if self.robot.is_of_balls { LANES } else { 1 }
    }
    /// With meshes for links, eight states are tested together only where a clearance is asked for: what is inside of a solid link is not found
    /// then.
    fn first_within(&mut self, states: &[&Q], clearance: f64) -> Option<usize> {
        let is_wide = self.robot.is_of_balls || clearance > 0.0;
        if !is_wide || states.is_empty() || states.len() > LANES {
            return states.iter().position(|q| self.is_within(q.as_slice(), clearance));
        }
        let is_none = |q: &&Q| !self.robot.kinematics.is_configuration(q.as_slice());
        if let Some(none) = states.iter().position(is_none) {
            return Some(none);
        }
        self.counters.collision_checks += states.len() as u64;
        if self.still_clearance() <= 0.0 {
            return Some(0);
        }
        let Self { robot, obstacles, scratch, kept, .. } = self;
        let distances = [*kept + clearance, clearance];
        let Contacts { touching, open } = scratch.wide.contacts(robot, &obstacles.scene, distances, states);
        if touching != 0 {
            return Some(touching.trailing_zeros() as usize);
        }
        if open == 0 { None } else { self.first_of_open(states, clearance) }
    }
    fn look_ahead(&mut self, intervals: &[MotionInterval<'_, Q>]) {
        let Self { robot, scratch, .. } = self;
        let all = intervals.iter().flat_map(|i| [i.from, i.to, i.middle]);
        if all.map(Q::as_slice).all(|q| robot.kinematics.is_configuration(q)) {
            scratch.wide.prepare(robot, intervals);
        }
    }
    /// Link by link and pair by pair, as [`interval_clearance`](Self::interval_clearance): what keeps enough clearance over a
    /// part of the motion is not looked at again in its halves.
    fn least_along(&mut self, search: &ClearanceSearch<'_, Q>) -> LeastClearance {
        let still = self.still_clearance();
        let Self { robot, obstacles, query, scratch, counters, kept, .. } = self;
        let kinematics = &robot.kinematics;
        let ends = [search.from, search.to].map(Q::as_slice);
        if !ends.into_iter().all(|q| kinematics.is_configuration(q)) {
            return LeastClearance { bound: 0.0, found: 0.0, at: Some(0.0) };
        }
        let base = kinematics.base_travel(ends[0], ends[1]);
        let known = search.known.min(still);
        let mut least = LeastClearance { bound: known, found: known, at: None };
        let moving: Vec<&LinkBody> = robot.moving().collect();
        let all: Vec<usize> = (0..moving.len() + robot.pairs.len()).collect();
        let mut open = VecDeque::from([(0.0, 1.0, f64::NEG_INFINITY, all)]);
        let mut states = 0;
        while let Some((start, end, known, parts)) = open.pop_front() {
            if least.found <= 0.0 || states >= search.states {
                least.bound = open.iter().map(|open| open.2).fold(least.bound.min(known), f64::min);
                break;
            }
            states += 1;
            counters.clearance_checks += 1;
            let (at, half) = (0.5 * (start + end), 0.5 * (end - start));
            let travels = |i: usize| half * kinematics.travel(i, ends[0], ends[1]);
            robot.place_over((search.at)(at).as_slice(), travels, scratch);
            let frames = &scratch.frames;
            let (mut left, mut worst) = (Vec::new(), f64::INFINITY);
            for part in parts {
                let wanted = least.found - search.accuracy;
                let (near, clearance) = match part.checked_sub(moving.len()) {
                    None => {
                        let body = moving[part];
                        let near = body.near(&base, half, scratch);
                        let scene = &obstacles.scene;
                        let found = |limit| scene.clearance(query, &body.tree, &frames[body.frame], limit).0;
                        (near, beyond(*kept, wanted + near, found))
                    }
                    Some(pair) => {
                        let pair = &robot.pairs[pair];
                        let [a, b] = pair.bodies.map(|i| &robot.bodies[i]);
                        let near =
                            scratch.near[a.first + pair.steps[0]] + scratch.near[b.first + pair.steps[1]];
                        let (apart, enough) = (scratch.apart(pair), wanted + near);
                        let (pose_a, pose_b) = (&frames[a.frame], &frames[b.frame]);
                        let clearance = match apart >= enough {
                            true => apart,
                            false if apart <= 0.0 && are_nested(query, [a, b], frames) => 0.0,
                            // Links that keep the least clearance all along, like one that turns beside another, have
                            // many triangles at that distance: exact only if it is less.
                            false => query.clearance(&a.tree, pose_a, &b.tree, pose_b, least.found * LESS),
                        };
                        let settles = clearance >= enough
                            || (clearance >= least.found * LESS
                                && !query.within(&a.tree, pose_a, &b.tree, pose_b, enough));
                        (near, if settles { clearance.max(enough) } else { clearance })
                    }
                };
                // Less than what would have been enough: the distance itself.
                if clearance < least.found * LESS && clearance < wanted + near {
                    (least.found, least.at) = (clearance.max(0.0), Some(at));
                }
                let bound = clearance - near;
                if bound >= least.found - search.accuracy {
                    least.bound = least.bound.min(bound);
                } else {
                    worst = worst.min(bound);
                    left.push(part);
                }
            }
            if !left.is_empty() {
                open.push_back((start, at, worst, left.clone()));
                open.push_back((at, end, worst, left));
            }
        }
        least
    }
}

/// An arm has no position apart from its rotation, so it cannot follow an obstacle. Its hints only carry configurations
/// along, in the space of joints.
impl<Q: Coordinates> ObstacleHints<Q> for Arm {
    fn touches(&mut self, q: &Q) -> bool {
        self.first_within(&[q], 0.0).is_some()
    }

    /// Always `None`.
    fn slide_along(&mut self, _: &Q, _: &Q, _: Option<&Q>, _: &mut Rng) -> Option<Q> {
        None
    }

    /// `q` with each joint moved by as much as from `from` to `to`, by the shorter way where the joint is continuous; a base
    /// that floats by the same translation and turn.
    fn moved_by(&self, q: &Q, from: &Q, to: &Q) -> Q {
        self.robot.kinematics.moved_by(q, from, to)
    }
}
