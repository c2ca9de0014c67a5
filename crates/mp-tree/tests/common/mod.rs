//! Worlds of boxes with exact answers, for the tests of this crate.
#![allow(dead_code, reason = "crates whose tests share this use their part of it")]

use mp_cspace::angle::wrap_angle;
use mp_cspace::obstacles::ObstacleHints;
use mp_cspace::*;
use nalgebra::{SVector, Vector2};
use rand::RngExt;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Closed boxes in R^n, and points among them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Boxes<const N: usize>(pub(crate) Vec<([f64; N], [f64; N])>);

impl<const N: usize> Boxes<N> {
    /// Distance from a point to the nearest box.
    pub(crate) fn distance(&self, q: &SVector<f64, N>) -> f64 {
        let to_box = |(low, high): &([f64; N], [f64; N])| {
            (0..N).map(|i| mp_math::powi((low[i] - q[i]).max(q[i] - high[i]).max(0.0), 2)).sum::<f64>().sqrt()
        };
        self.0.iter().map(to_box).fold(f64::INFINITY, f64::min)
    }

    /// Whether a segment touches a box: exact, by clipping it against the slabs.
    pub(crate) fn hit(&self, from: &SVector<f64, N>, to: &SVector<f64, N>) -> bool {
        self.0.iter().any(|(low, high)| {
            let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
            for i in 0..N {
                let (p, v) = (from[i], to[i] - from[i]);
                if v == 0.0 {
                    if p < low[i] || p > high[i] {
                        return false;
                    }
                } else {
                    let (a, b) = ((low[i] - p) / v, (high[i] - p) / v);
                    enter = enter.max(a.min(b));
                    leave = leave.min(a.max(b));
                }
            }
            enter <= leave
        })
    }
}

impl<const N: usize> Validity<SVector<f64, N>> for Boxes<N> {
    fn is_valid(&mut self, q: &SVector<f64, N>) -> bool {
        !self.0.iter().any(|(low, high)| (0..N).all(|i| low[i] <= q[i] && q[i] <= high[i]))
    }
}
impl<const N: usize> Clearance<SVector<f64, N>> for Boxes<N> {
    fn clearance(&mut self, q: &SVector<f64, N>, _: f64) -> f64 {
        self.distance(q)
    }
}
impl<const N: usize> MotionClearance<SVector<f64, N>> for Boxes<N> {
    fn motion_bound(&self, from: &SVector<f64, N>, to: &SVector<f64, N>) -> f64 {
        (to - from).norm()
    }
}

/// Straight motions of a space: of one type with any check, so that planners are compiled once for all.
pub(crate) type Checked<'c, C> = Straight<'c, C, erased::AnyCheck<'c, <C as Space>::State>>;

/// Straight motions with this check.
pub(crate) fn checked<'c, C: Space>(
    space: &'c C,
    check: impl MotionValidity<C::State> + Send + 'c,
) -> Checked<'c, C> {
    Straight::new(space, Box::new(check))
}

/// Certified straight motions of a robot.
pub(crate) fn certified<'c, C: Space, V: MotionClearance<C::State> + Send + 'c>(
    space: &'c C,
    robot: V,
    tolerance: f64,
) -> Checked<'c, C> {
    checked(space, Certified::new(space, robot, tolerance).unwrap())
}

/// A check that panics on each extension while its number is above zero.
pub(crate) struct Fragile<'a, V>(pub(crate) V, pub(crate) &'a AtomicU64);

impl<S, V: MotionValidity<S>> MotionValidity<S> for Fragile<'_, V> {
    fn check_motion(&mut self, from: &S, to: &S) -> MotionCheck {
        self.0.check_motion(from, to)
    }
    fn check_extension(&mut self, from: &S, to: &S, known: KnownFree) -> MotionCheck {
        assert!(self.1.load(Relaxed) == 0, "trouble");
        self.0.check_extension(from, to, known)
    }
}

/// The exact verifier of straight motions among boxes.
#[derive(Clone, Debug)]
pub(crate) struct Exact<const N: usize>(pub(crate) Boxes<N>);

impl<const N: usize> MotionValidity<SVector<f64, N>> for Exact<N> {
    fn check_motion(&mut self, from: &SVector<f64, N>, to: &SVector<f64, N>) -> MotionCheck {
        match self.0.hit(from, to) {
            true => MotionCheck::Collision { at: 0.5 },
            false => MotionCheck::Free { clearance: 0.0 },
        }
    }
}

/// The unit square.
pub(crate) fn square() -> Rn<2> {
    Rn::new([0.0; 2], [1.0; 2]).unwrap()
}

/// The unit cube.
pub(crate) fn cube() -> Rn<3> {
    Rn::new([0.0; 3], [1.0; 3]).unwrap()
}

/// A wall of `thickness` across the first axis, with a passage of `width` around `at` on the
/// others.
pub(crate) fn slit<const N: usize>(thickness: f64, at: f64, width: f64) -> Boxes<N> {
    let (mut low, mut high) = ([-1.0; N], [2.0; N]);
    (low[0], high[0]) = (0.5 - thickness / 2.0, 0.5 + thickness / 2.0);
    let mut boxes = Vec::new();
    for i in 1..N {
        // Left of the passage on axis i, then right of it; nearer axes are within the passage.
        let (mut a, mut b) = ((low, high), (low, high));
        a.1[i] = at - width / 2.0;
        b.0[i] = at + width / 2.0;
        boxes.extend([a, b]);
        (low[i], high[i]) = (at - width / 2.0, at + width / 2.0);
    }
    Boxes(boxes)
}

/// A hollow box of half size `inner` around `center`, walls `thickness` thick, with a hole of
/// half size `hole` in the wall toward larger x (zero: closed).
pub(crate) fn hollow<const N: usize>(center: [f64; N], inner: f64, thickness: f64, hole: f64) -> Boxes<N> {
    let outer = inner + thickness;
    let around = |r: f64| (center.map(|c| c - r), center.map(|c| c + r));
    let mut boxes = Vec::new();
    for i in 0..N {
        let (low, high) = around(outer);
        let (mut a, mut b) = ((low, high), (low, high));
        a.1[i] = center[i] - inner;
        b.0[i] = center[i] + inner;
        boxes.push(a);
        if i > 0 || hole <= 0.0 {
            boxes.push(b);
            continue;
        }
        let (mut low, mut high) = b;
        for j in 1..N {
            let (mut a, mut b) = ((low, high), (low, high));
            a.1[j] = center[j] - hole;
            b.0[j] = center[j] + hole;
            boxes.extend([a, b]);
            (low[j], high[j]) = (center[j] - hole, center[j] + hole);
        }
    }
    Boxes(boxes)
}

/// A rod of five discs moving in the plane among boxes.
#[derive(Clone, Debug)]
pub(crate) struct Rod {
    pub(crate) boxes: Boxes<2>,
    pub(crate) half_length: f64,
    pub(crate) radius: f64,
}

impl Rod {
    fn centers(&self, q: &Se2State) -> [Vector2<f64>; 5] {
        let (s, c) = mp_math::sin_cos(q.angle);
        [-1.0, -0.5, 0.0, 0.5, 1.0].map(|k| q.translation + Vector2::new(c, s) * (k * self.half_length))
    }
}
impl Validity<Se2State> for Rod {
    fn is_valid(&mut self, q: &Se2State) -> bool {
        self.clearance(q, 0.0) > 0.0
    }
}
impl Clearance<Se2State> for Rod {
    fn clearance(&mut self, q: &Se2State, _: f64) -> f64 {
        let least = self.centers(q).iter().map(|c| self.boxes.distance(c)).fold(f64::INFINITY, f64::min);
        least - self.radius
    }
}
impl MotionClearance<Se2State> for Rod {
    fn motion_bound(&self, from: &Se2State, to: &Se2State) -> f64 {
        let turn = wrap_angle(to.angle - from.angle).abs();
        (to.translation - from.translation).norm() + turn * self.half_length
    }
}

/// A planar chain of links turned by its joints about the origin, each link a capsule, among discs.
/// Links do not see each other: they are at different heights.
#[derive(Clone, Debug)]
pub(crate) struct Arm<const N: usize> {
    pub(crate) link: f64,
    pub(crate) radius: f64,
    /// Centres and radii.
    pub(crate) discs: Vec<(Vector2<f64>, f64)>,
}

impl<const N: usize> Arm<N> {
    /// Where each link begins and ends.
    pub(crate) fn links(&self, q: &SVector<f64, N>) -> [[Vector2<f64>; 2]; N] {
        let (mut at, mut angle) = (Vector2::zeros(), 0.0);
        std::array::from_fn(|i| {
            angle += q[i];
            let (sin, cos) = mp_math::sin_cos(angle);
            let from = at;
            at += Vector2::new(cos, sin) * self.link;
            [from, at]
        })
    }
}
impl<const N: usize> Validity<SVector<f64, N>> for Arm<N> {
    fn is_valid(&mut self, q: &SVector<f64, N>) -> bool {
        self.clearance(q, 0.0) > 0.0
    }
}
impl<const N: usize> Clearance<SVector<f64, N>> for Arm<N> {
    /// Exact: the distance of a disc's centre from the axis of a link, less both radii.
    fn clearance(&mut self, q: &SVector<f64, N>, _: f64) -> f64 {
        let (links, inverse) = (self.links(q), 1.0 / (self.link * self.link));
        let clearance = |(center, radius): &(Vector2<f64>, f64)| {
            let squares = links.iter().map(|[from, tip]| {
                let (along, to) = (tip - from, center - from);
                (to - along * (to.dot(&along) * inverse).clamp(0.0, 1.0)).norm_squared()
            });
            squares.fold(f64::INFINITY, f64::min).sqrt() - radius - self.radius
        };
        self.discs.iter().map(clearance).fold(f64::INFINITY, f64::min)
    }
}
impl<const N: usize> MotionClearance<SVector<f64, N>> for Arm<N> {
    /// A joint swings no point of an axis faster than by what hangs on it.
    fn motion_bound(&self, from: &SVector<f64, N>, to: &SVector<f64, N>) -> f64 {
        let turns = (to - from).abs();
        turns.iter().enumerate().map(|(i, turn)| turn * self.link * (N - i) as f64).sum()
    }
}

/// Along an axis, whichever box is touched.
impl<const N: usize> ObstacleHints<SVector<f64, N>> for Boxes<N> {
    fn touches(&mut self, q: &SVector<f64, N>) -> bool {
        !self.is_valid(q)
    }
    fn slide_along(
        &mut self,
        from: &SVector<f64, N>,
        toward: &SVector<f64, N>,
        hit: Option<&SVector<f64, N>>,
        rng: &mut Rng,
    ) -> Option<SVector<f64, N>> {
        if self.0.is_empty() || hit.is_some_and(|q| self.distance(q) > 0.0) {
            return None;
        }
        let far = (toward - from).norm() * if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let mut to = *from;
        to[rng.random_range(0..N)] += far;
        Some(to)
    }
    fn moved_by(&self, q: &SVector<f64, N>, from: &SVector<f64, N>, to: &SVector<f64, N>) -> SVector<f64, N> {
        q + (to - from)
    }
}

/// The same for a rod, which has a rotation.
impl ObstacleHints<Se2State> for Rod {
    fn touches(&mut self, q: &Se2State) -> bool {
        !self.is_valid(q)
    }
    fn slide_along(
        &mut self,
        from: &Se2State,
        toward: &Se2State,
        hit: Option<&Se2State>,
        rng: &mut Rng,
    ) -> Option<Se2State> {
        if hit.is_some_and(|q| self.is_valid(q)) {
            return None;
        }
        let to = self.boxes.slide_along(&from.translation, &toward.translation, None, rng)?;
        Some(Se2State::new(to.x, to.y, from.angle))
    }
    fn moved_by(&self, q: &Se2State, from: &Se2State, to: &Se2State) -> Se2State {
        let at = q.translation + (to.translation - from.translation);
        Se2State::new(at.x, at.y, q.angle + wrap_angle(to.angle - from.angle))
    }
}

/// An arm follows nothing: it has no position to keep while it turns.
impl<const N: usize> ObstacleHints<SVector<f64, N>> for Arm<N> {
    fn touches(&mut self, q: &SVector<f64, N>) -> bool {
        !self.is_valid(q)
    }
    fn slide_along(
        &mut self,
        _: &SVector<f64, N>,
        _: &SVector<f64, N>,
        _: Option<&SVector<f64, N>>,
        _: &mut Rng,
    ) -> Option<SVector<f64, N>> {
        None
    }
    fn moved_by(&self, q: &SVector<f64, N>, from: &SVector<f64, N>, to: &SVector<f64, N>) -> SVector<f64, N> {
        q + (to - from)
    }
}

/// Joint angles of an arm, within ±π.
pub(crate) fn joints<const N: usize>() -> Rn<N> {
    Rn::new([-std::f64::consts::PI; N], [std::f64::consts::PI; N]).unwrap()
}

/// What planners may ask of obstacles: hints, and the clearance with its gradient, by central differences.
pub(crate) fn knowledge<'c, C, V>(space: &'c C, robot: &V) -> ObstacleKnowledge<'c, C::State>
where
    C: Space,
    V: Clearance<C::State> + ObstacleHints<C::State> + Clone + Send + 'c,
{
    let (mut field, mut velocity) = (robot.clone(), vec![0.0; space.dim()]);
    let gradient = move |q: &C::State, reach: f64, gradient: &mut [f64]| {
        let clearance = field.clearance(q, f64::INFINITY);
        gradient.fill(0.0);
        if clearance < reach {
            for (k, slope) in gradient.iter_mut().enumerate() {
                velocity.fill(0.0);
                velocity[k] = 1.0;
                let [before, after] = [-1e-5, 1e-5].map(|t| {
                    let moved = space.moved(q, &velocity, t);
                    moved.map_or(0.0, |q| field.clearance(&q, f64::INFINITY))
                });
                *slope = (after - before) / 2e-5;
            }
        }
        clearance
    };
    ObstacleKnowledge {
        hints: Some(Box::new(robot.clone())),
        gradient: Some(Box::new(gradient)),
        ..ObstacleKnowledge::default()
    }
}

/// Checks a path from `start` to `goal`, densely along each edge.
pub(crate) fn assert_path<C: Space>(
    space: &C,
    path: &Path<C::State>,
    start: &C::State,
    goal: impl Fn(&C::State) -> bool,
    mut valid: impl FnMut(&C::State) -> bool,
) {
    assert_eq!(path.states.len(), path.edges.len() + 1);
    assert_eq!(path.states.first(), Some(start));
    assert!(goal(path.states.last().unwrap()), "the path does not end in the goal");
    for pair in path.states.windows(2) {
        let steps = (space.distance(&pair[0], &pair[1]) / space.extent() / 2e-4).ceil().max(1.0) as usize;
        for i in 0..=steps {
            let q = space.interpolate(&pair[0], &pair[1], i as f64 / steps as f64);
            assert!(space.contains(&q) && valid(&q), "the path collides at {q:?}");
        }
    }
}
