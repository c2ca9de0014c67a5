//! Intervals of a motion, eight at a time: where links are in their middles, how far they move in them, and lower bounds on distances by
//! the covers of links.

#![allow(clippy::needless_range_loop)] // Rows and columns are indices here.

use super::kinematics::{BaseTravel, JointFrame};
use super::robot::{LinkBody, SharedArm};
use super::travel::{Chain, ROUND_UP};
use mp_collide::{Scene, WideCover, wide_apart};
use mp_cspace::{Coordinates, MotionInterval};
use mp_simd::wide::{LANES, Wide, Wide3, WideFrame, WideKernel, add, cross, dot, on_widest, sub};
use nalgebra::{Isometry3, Matrix3};

/// A bound by covers that is at least this part of what is enough is used as it is: it proves a part of the interval, and the exact distance
/// would take longer than the intervals that it saves.
pub(super) const COARSE: f64 = 0.25;
/// No bound is used that is less than this many margins: at two margins an interval would end.
pub(super) const LEAST: f64 = 2.5;

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
    links: Vec<Option<Wide>>,
    pairs: Vec<Option<Wide>>,
    /// For each body, how far it moves over the whole motion with the first joints of its chain: as [`Chain::far`].
    pub(super) far: Vec<f64>,
    pub(super) base: BaseTravel,
    /// For each joint, sines and cosines; of those that slide, how far.
    values: Vec<[Wide; 2]>,
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
        // Lanes that are left are as the first.
        let n = from.len();
        let middle = |k: usize| {
            let k = if k < self.count { k } else { 0 };
            &self.middles[k * n..(k + 1) * n]
        };
        let bases: [(Isometry3<f64>, &[f64]); LANES] = std::array::from_fn(|k| kinematics.parts(middle(k)));
        self.frames.clear();
        self.frames.push(wide_frame(&bases.map(|(base, _)| base)));
        self.axes.clear();
        self.near.clear();
        self.by_base.clear();
        self.covers.resize_with(robot.bodies.len(), WideCover::default);
        for (links, count) in [(&mut self.links, robot.bodies.len()), (&mut self.pairs, robot.pairs.len())] {
            links.clear();
            links.resize(count, None);
        }
        // Sines and cosines first, which are not computed in lanes.
        let value = |frame: &JointFrame| {
            let values: [f64; LANES] =
                std::array::from_fn(|k| bases[k].1[frame.coordinate] * frame.scale + frame.offset);
            if frame.slides {
                return [Wide(values), Wide::splat(0.0)];
            }
            let both = values.map(mp_math::sin_cos);
            [Wide(both.map(|(sin, _)| sin)), Wide(both.map(|(_, cos)| cos))]
        };
        self.values.clear();
        self.values.extend(kinematics.frames.iter().map(value));
        self.displacements.clear();
        self.displacements
            .extend((0..kinematics.coordinates.len()).map(|i| kinematics.displacement(i, from, to)));
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

    /// A bound (m) on how far the points of a body move over half of interval `k`.
    pub(super) fn near(&self, k: usize, i: usize, body: &LinkBody) -> f64 {
        self.near[body.last()].0[k] + self.by_base[i].0[k]
    }

    /// A bound (m) on how far the two bodies of pair `p` move relative to each other.
    pub(super) fn near_pair(&self, robot: &SharedArm, p: usize, k: usize) -> f64 {
        self.near_pairs(robot, p).0[k]
    }

    fn near_pairs(&self, robot: &SharedArm, p: usize) -> Wide {
        let pair = &robot.pairs[p];
        let [a, b] = pair.bodies.map(|i| &robot.bodies[i]);
        self.near[a.first + pair.steps[0]] + self.near[b.first + pair.steps[1]]
    }

    /// What is enough, and what is of use at least, where bodies move as far as `near`.
    fn enough(&self, near: Wide, kept: f64) -> (Wide, Wide) {
        let margin = self.margin;
        let enough = near.max(Wide::splat(margin)) + margin;
        (enough + kept, (enough * COARSE).max(Wide::splat(LEAST * margin)) + kept)
    }

    /// A lower bound (m) on the distance of body `i` from obstacles in interval `k`, beyond `kept`.
    pub(super) fn link_apart(
        &mut self,
        robot: &SharedArm,
        scene: &Scene,
        kept: f64,
        i: usize,
        k: usize,
    ) -> f64 {
        let found = match self.links[i] {
            Some(found) => found,
            None => {
                let body = &robot.bodies[i];
                let (enough, some) = self.enough(self.near[body.last()] + self.by_base[i], kept);
                let found = scene.wide_apart(&body.cover, &mut self.covers[i], enough, some);
                *self.links[i].insert(found)
            }
        };
        found.0[k] - kept
    }

    /// A lower bound (m) on the distance of pair `p` in interval `k`.
    pub(super) fn pair_apart(&mut self, robot: &SharedArm, p: usize, k: usize) -> f64 {
        let found = match self.pairs[p] {
            Some(found) => found,
            None => {
                let (enough, some) = self.enough(self.near_pairs(robot, p), 0.0);
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

/// Places links, and bounds how far they move.
struct Place<'a> {
    robot: &'a SharedArm,
    /// For each joint, sines and cosines; of those that slide, how far.
    values: &'a [[Wide; 2]],
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
    fn run(mut self) {
        let joints = self.robot.kinematics.frames.iter().zip(&self.robot.turns);
        for ((joint, turns), value) in joints.zip(self.values) {
            let parent = self.frames[joint.parent];
            let frame = moved(&parent, joint, turns, value);
            let axis = joint.axis.as_ref();
            self.axes.push(frame.vector(&[axis.x, axis.y, axis.z]));
            self.frames.push(frame);
        }
        for (i, body) in self.robot.bodies.iter().enumerate() {
            self.covers[i].place(&body.ball, &self.frames[body.frame]);
            let by_joints = self.near(&body.chain, i);
            let cover = &self.covers[i];
            let base = &self.base;
            let by_base = match base.is_still() {
                true => Wide::splat(0.0),
                false => {
                    let from_axis = match base.turn > 0.0 {
                        true => {
                            let axis: Wide3 = [
                                Wide::splat(base.axis.x),
                                Wide::splat(base.axis.y),
                                Wide::splat(base.axis.z),
                            ];
                            let d = sub(cover.center(), &self.frames[0].origin);
                            let v = cross(&d, &axis);
                            dot(&v, &v).sqrt() * (1.0 / base.turn)
                        }
                        false => Wide::splat(0.0),
                    };
                    let reach =
                        (from_axis + by_joints + cover.radius()).min(Wide::splat(body.chain.from_base));
                    self.halves * (reach * base.turn + base.slide) * ROUND_UP
                }
            };
            self.by_base.push(by_base);
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
    fn near(&mut self, chain: &Chain, i: usize) -> Wide {
        let (center, radius) = (*self.covers[i].center(), self.covers[i].radius());
        let zero = Wide::splat(0.0);
        let mut sum = zero;
        self.near.push(sum);
        // Of the ball, in the middle of the interval. The unit of time is the whole motion.
        let (mut velocity, mut angular) = ([zero; 3], [zero; 3]);
        // Bounds for every point, all over the interval.
        let (mut speed, mut acceleration) = (zero, zero);
        for step in &chain.steps {
            let rate =
                self.displacements[step.coordinate] * self.robot.kinematics.frames[step.frame - 1].scale;
            if rate != 0.0 {
                let (axis, by) = (self.axes[step.frame - 1], rate.abs());
                let reach = if step.slides {
                    velocity = add(&velocity, &axis, rate);
                    Wide::splat(1.0)
                } else {
                    let across = cross(&axis, &sub(&center, &self.frames[step.frame].origin));
                    velocity = add(&velocity, &across, rate);
                    angular = add(&angular, &axis, rate);
                    (dot(&across, &across).sqrt() + radius + sum).min(Wide::splat(step.reach))
                };
                let own = reach * by;
                if !step.slides {
                    acceleration = acceleration + (speed * 2.0 + own) * by;
                }
                speed = speed + own;
                let in_middle = dot(&velocity, &velocity).sqrt() + dot(&angular, &angular).sqrt() * radius;
                // Velocities that cancel leave the rounding of their parts.
                let curved = in_middle + self.halves * acceleration * 0.5 + speed * (ROUND_UP - 1.0);
                sum = (sum + self.halves * own * ROUND_UP).min(self.halves * curved * ROUND_UP);
            }
            self.near.push(sum);
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
fn moved(parent: &WideFrame, joint: &JointFrame, turns: &Turns, value: &[Wide; 2]) -> WideFrame {
    let t = joint.origin.translation.vector;
    let (mut origin, mut turn) = (parent.point(&[t.x, t.y, t.z]), parent.turn);
    // Of joints that slide both matrices are zero.
    let [sin, cos] = *value;
    for c in 0..3 {
        let mut m = [Wide::splat(0.0); 3];
        for r in 0..3 {
            m[r] = cos * turns.cos[(r, c)] + sin * turns.sin[(r, c)] + turns.still[(r, c)];
        }
        for r in 0..3 {
            let row = &parent.turn[r];
            turn[r][c] = row[0] * m[0] + row[1] * m[1] + row[2] * m[2];
        }
    }
    if joint.slides {
        let axis = joint.axis.as_ref();
        for r in 0..3 {
            let along = turn[r][0] * axis.x + turn[r][1] * axis.y + turn[r][2] * axis.z;
            origin[r] = origin[r] + along * value[0];
        }
    }
    WideFrame { turn, origin }
}

#[cfg(test)]
mod tests {
    use super::super::robot::{LinkBody, SharedArm};
    use super::super::travel::tests::chain;
    use crate::{Arm, ArmModel};
    use mp_collide::Query;
    use mp_cspace::{Configuration, MotionClearance, MotionInterval, Rng, Space};
    use mp_geom::{Aabb, primitives};
    use nalgebra::{Isometry3, Vector3};
    use rand::RngExt;

    /// A random motion of an arm, the middles of `count` equal intervals of it, and states of each interval.
    type Motion = (Configuration, Configuration, Vec<Configuration>, Vec<Vec<Configuration>>);

    fn motion(arm: &Arm, rng: &mut Rng, count: usize) -> Motion {
        fn of<S: Space<State = Configuration>>(space: &S, rng: &mut Rng, count: usize) -> Motion {
            let (from, far) = (space.sample_uniform(rng), space.sample_uniform(rng));
            // Long ones and short ones.
            let to = space.interpolate(&from, &far, [1.0, 0.1, 0.01][rng.random_range(0..3)]);
            let at = |k: usize, part: f64| space.interpolate(&from, &to, (k as f64 + part) / count as f64);
            let middles = (0..count).map(|k| at(k, 0.5)).collect();
            let parts = |k| [0.0, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 0.9, 1.0].map(|part| at(k, part)).to_vec();
            (from.clone(), to.clone(), middles, (0..count).map(parts).collect())
        }
        match arm.floating_space() {
            Ok(space) => of(&space, rng, count),
            Err(_) => of(&arm.space::<Configuration>().unwrap(), rng, count),
        }
    }

    /// How far the vertices of a link move from where they are at `middle`, seen from frame `base`, until `at`.
    fn moved(
        robot: &SharedArm,
        body: &LinkBody,
        base: Option<usize>,
        [middle, at]: [&Configuration; 2],
    ) -> f64 {
        let place = |q: &Configuration| {
            let mut frames = Vec::new();
            robot.kinematics.frames_into(q.as_slice(), &mut frames);
            base.map_or_else(Isometry3::identity, |base| frames[base].inverse()) * frames[body.frame]
        };
        let [from, to] = [middle, at].map(place);
        body.mesh.vertices().iter().map(|v| (from * v - to * v).norm()).fold(0.0, f64::max)
    }

    /// The intervals of motions of random arms, some on bases that float: links move no farther than the bounds say, which are no more than
    /// those of one interval, and nothing is nearer. Most bounds say something.
    #[test]
    fn links_stay_within_the_bounds_of_eight_intervals() {
        let mut rng = Rng::seed(4);
        let (mut query, mut known, mut all) = (Query::default(), 0, 0);
        let (mut best, mut less, mut more) = (0.0_f64, 0.0, 0.0);
        for round in 0..40 {
            let floating = (round % 2 == 1).then(|| Aabb::new([-1.0; 3].into(), [1.0, 2.0, 0.5].into()));
            let model = ArmModel { floating, ..chain(&mut rng) };
            let obstacles: Vec<_> = (0..6)
                .map(|i| {
                    let mut vector = |scale: f64| Vector3::from_fn(|_, _| rng.random_range(-scale..scale));
                    let pose = Isometry3::new(vector(2.0), vector(3.0));
                    (i.to_string(), primitives::cuboid(0.1, 0.3, 0.7).unwrap(), pose)
                })
                .collect();
            let mut arm = Arm::new(&model, obstacles).unwrap();
            let count = 1 + round % 8;
            let half = 0.5 / count as f64;
            let (from, to, middles, ends) = motion(&arm, &mut rng, count);
            let intervals: Vec<_> = middles
                .iter()
                .map(|middle| MotionInterval {
                    from: &from,
                    to: &to,
                    middle,
                    half,
                    travel: 0.0,
                    margin: 1e-4,
                })
                .collect();
            arm.look_ahead(&intervals);
            let Arm { robot, obstacles, scratch, .. } = &mut arm;
            for (k, interval) in intervals.iter().enumerate() {
                assert_eq!(scratch.wide.find(robot, interval), k);
                let travels = |i: usize| half * robot.kinematics.travel(i, from.as_slice(), to.as_slice());
                robot.place_over(interval.middle.as_slice(), travels, scratch);
                for (i, body) in robot.numbered_moving() {
                    let near = body.near(&scratch.wide.base.clone(), half, scratch);
                    let wide = scratch.wide.near(k, i, body);
                    let far = ends[k].iter().map(|q| moved(robot, body, None, [interval.middle, q]));
                    let far = far.fold(0.0, f64::max);
                    assert!(far <= wide + 1e-12 && wide <= near * (1.0 + 1e-12), "{far} {wide} {near}");
                    best = best.max(far / wide);
                    (less, more) = (less + wide, more + near);
                    let bound = scratch.wide.link_apart(robot, &obstacles.scene, 0.0, i, k);
                    let pose = &scratch.frames[body.frame];
                    let found =
                        obstacles.scene.surface_clearance(&mut query, &body.tree, pose, f64::INFINITY).0;
                    assert!(bound <= found, "{bound} {found}");
                    (known, all) = (known + usize::from(bound > 0.0), all + usize::from(found > 0.0));
                }
                for (p, pair) in robot.pairs.iter().enumerate() {
                    let [a, b] = pair.bodies.map(|i| &robot.bodies[i]);
                    let near = scratch.near[a.first + pair.steps[0]] + scratch.near[b.first + pair.steps[1]];
                    let wide = scratch.wide.near_pair(robot, p, k);
                    let far = ends[k].iter().map(|q| {
                        let above = |body: &LinkBody, steps: usize| {
                            Some(body.chain.steps.get(steps).map_or(0, |step| step.frame))
                        };
                        let moved =
                            |body, steps| moved(robot, body, above(body, steps), [interval.middle, q]);
                        moved(a, pair.steps[0]) + moved(b, pair.steps[1])
                    });
                    let far = far.fold(0.0, f64::max);
                    assert!(far <= wide + 1e-12 && wide <= near * (1.0 + 1e-12), "{far} {wide} {near}");
                    let bound = scratch.wide.pair_apart(robot, p, k);
                    let [at_a, at_b] = [a, b].map(|body| &scratch.frames[body.frame]);
                    let found = query.clearance(&a.tree, at_a, &b.tree, at_b, f64::INFINITY);
                    assert!(bound <= found, "{bound} {found}");
                    (known, all) = (known + usize::from(bound > 0.0), all + usize::from(found > 0.0));
                }
            }
        }
        assert!(all > 1000 && known > all / 2, "{known} of {all}");
        assert!(best > 0.9 && less < 0.9 * more, "{best} {less} {more}");
    }
}
