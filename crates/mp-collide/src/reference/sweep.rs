//! Whole motions of a mesh past another mesh, proved free.

use super::swept_triangle::{Front, SweptTriangle};
use super::triangle::{Triangle, triangle_gap};
use super::{Ball, Content, Node, RefMesh, TOUCHING, is_usable};
use mp_stop::Interrupt;
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

/// What a [`Sweep`] found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SweepCheck {
    /// Free all along.
    Free {
        /// A lower bound on the distance all along, at least the margin (m).
        clearance: f64,
    },
    /// The meshes touch at fraction `at` of the motion, or the pose there is not usable.
    Collision {
        /// The fraction.
        at: f64,
    },
    /// The meshes are nearer than the margin and the slack at fraction `at` of the motion, or the search was given up
    /// there.
    TooClose {
        /// The fraction.
        at: f64,
    },
}

/// Proves that a moving mesh keeps a distance from a static mesh: a search over balls of the moving mesh and parts of
/// the motion, with a list of the balls of the static mesh that may be near. Keeps its memory between searches.
///
/// While its mesh goes straight and turns by θ about a fixed axis, both at constant speed, a point at
/// distance r from the origin of its frame stays within r·θ²/8 of the point that moves in a straight line at constant speed
/// from its start to its end (the error of linear interpolation). So
///
/// - the triangles of a ball sweep within the box around them at both ends, widened by this much, which
///   is compared with the boxes of static balls;
/// - a triangle is swept within the hull of its corners at both ends, widened by this much, which is
///   separated from a static triangle by a direction.
///
/// Where this does not separate, the largest is split: static balls, moving balls or, when it is longer than those,
/// the motion. Triangles nearer than the margin and the slack in the middle of a part end the search.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    parts: Vec<Part>,
    moments: Vec<Moment>,
    open: Vec<Open>,
    /// The static balls that may be near, listed for each open ball, and those still to be compared.
    near: Vec<Near>,
    todo: Vec<Near>,
    compared: u64,
    interrupt: Interrupt,
}

/// A moving ball during a part of the motion.
#[derive(Clone, Copy, Debug)]
struct Open {
    ball: Node,
    part: usize,
    /// The range of `Sweep::near` that lists what may be near.
    near: [usize; 2],
}

/// A static ball that may be near.
#[derive(Clone, Copy, Debug)]
struct Near {
    ball: Node,
    /// A direction that may separate triangles; zero when none is known.
    way: Vector3<f64>,
}

/// A part of a motion, halved on demand.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// Indices of moments.
    ends: [usize; 2],
    /// θ²/8 for the part.
    bend: f64,
    /// The moment in the middle and the parts to either side.
    halves: Option<(usize, [usize; 2])>,
}

/// The space that a ball sweeps in a part of the motion.
#[derive(Clone, Copy, Debug)]
struct Swath {
    /// The box around what the ball holds at both ends.
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// How far the center moves, plus [`BEND`] times `bend`.
    length: f64,
    /// How far points may leave the straight line.
    bend: f64,
}

impl Swath {
    /// A lower bound on the distance of this swath from the triangles of a static ball, if it is at least `enough`.
    fn apart(&self, ball: &Ball, enough: f64) -> Option<f64> {
        let (low, high) = (ball.center.coords - ball.half, ball.center.coords + ball.half);
        let gap = (self.low - high).sup(&(low - self.high)).sup(&Vector3::zeros());
        let (square, wanted) = (gap.norm_squared(), enough + self.bend);
        (square >= wanted * wanted).then(|| square.sqrt() - self.bend)
    }
}

/// A moment of a motion.
#[derive(Clone, Copy, Debug)]
struct Moment {
    /// Fraction of the motion.
    at: f64,
    rotation: Matrix3<f64>,
    /// The absolute values of the rotation: what a box is spread by.
    spread: Matrix3<f64>,
    origin: Vector3<f64>,
}

impl Moment {
    fn place(&self, p: &Point3<f64>) -> Point3<f64> {
        Point3::from(self.rotation * p.coords + self.origin)
    }
}

/// The static mesh of a sweep, and its distances.
struct Task<'a> {
    standing: &'a RefMesh,
    margin: f64,
    /// Nearer than the margin and this (m) the search ends.
    slack: f64,
    touching: f64,
}

/// A sweep gives up after comparing this many pairs.
const MAX_COMPARED: u64 = 20_000_000;

/// The weight of a bend against the length of a motion in the decision whether to halve the motion: halving makes
/// the bend four times smaller.
const BEND: f64 = 20.0;

impl Sweep {
    /// Pairs of boxes compared so far.
    #[must_use]
    pub fn compared(&self) -> u64 {
        self.compared
    }

    /// Gives searches up once `interrupt` says to end.
    pub fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.interrupt = interrupt.clone();
    }

    /// Whether `moving` keeps at least `margin` (metres, positive) from `standing`, both in the world, over a
    /// motion that takes its frame to `pose_at` of the fractions 0 to 1.
    ///
    /// The motion must take the origin on a straight line and turn by at most half a turn about a fixed axis,
    /// both at constant speed. Every motion with a distance of at least the margin and the `slack` (metres, positive) all along is found
    /// free, unless it takes more than 20 million comparisons. A pose that is not finite or not a rigid motion,
    /// and coordinates beyond 1e75, give a collision.
    pub fn sweep(
        &mut self,
        moving: &RefMesh,
        pose_at: impl Fn(f64) -> Isometry3<f64>,
        standing: &RefMesh,
        margin: f64,
        slack: f64,
    ) -> SweepCheck {
        self.parts.clear();
        self.moments.clear();
        self.open.clear();
        self.near.clear();
        self.todo.clear();
        let size = moving.size + standing.size;
        let ends = [0.0, 1.0].map(|at| (at, pose_at(at)));
        for (at, pose) in &ends {
            if !self.moment(*at, pose, size) {
                return SweepCheck::Collision { at: *at };
            }
        }
        let [from, to] = ends.map(|(_, pose)| pose.rotation.into_inner());
        let between = from.conjugate() * to;
        let turn = 2.0 * mp_math::atan2(between.imag().norm(), between.w.abs());
        self.parts.push(Part { ends: [0, 1], bend: turn * turn / 8.0, halves: None });
        let far = self.moments.iter().map(|moment| moment.origin.norm()).fold(0.0, f64::max);
        let task = Task { standing, margin, slack, touching: TOUCHING * (size + far) };
        self.near.push(Near { ball: standing.root, way: Vector3::zeros() });
        self.open.push(Open { ball: moving.root, part: 0, near: [0, 1] });

        let mut least = f64::INFINITY;
        let limit = self.compared + MAX_COMPARED;
        while let Some(open) = self.open.pop() {
            let mut made = None;
            let ball = moving.ball(open.ball, &mut made);
            let swath = self.swath(ball, open.part);
            let first = open.near[1];
            self.list(&task, &open, ball, &swath, &mut least);
            if self.compared > limit || self.interrupt.ask() {
                return SweepCheck::TooClose { at: self.middle(open.part) };
            }
            let triangle = match ball.content {
                Content::Triangle(k) => Some((*moving.triangle(k, &mut None), moving.rounding(k))),
                Content::Parts(_) => None,
            };
            if let Some(triangle) = triangle {
                self.drop_apart(&task, triangle, &open, &swath, &mut least);
            }
            let near = [first, self.near.len()];
            if near[0] == near[1] {
                continue;
            }
            let short = swath.length <= ball.radius.max(2.0 * slack);
            if let Content::Parts(parts) = ball.content
                && short
            {
                self.open.extend(parts.map(|ball| Open { ball, part: open.part, near }));
                continue;
            }
            let Some((middle, halves)) = self.cut(open.part, &pose_at, size) else {
                return SweepCheck::Collision { at: self.middle(open.part) };
            };
            if let Some((triangle, round)) = &triangle {
                let middle = &self.moments[middle];
                let moved = triangle.map(|p| middle.place(&p));
                for near in &mut self.near[first..] {
                    near.way = match task.way(&moved, *round, near) {
                        Ok(way) => way,
                        Err(distance) if distance <= task.touching => {
                            return SweepCheck::Collision { at: middle.at };
                        }
                        Err(_) => return SweepCheck::TooClose { at: middle.at },
                    };
                }
            }
            self.open.extend(halves.map(|part| Open { ball: open.ball, part, near }));
        }
        SweepCheck::Free { clearance: least }
    }

    /// Lists the static balls that may be near a ball in a part of the motion, from the list of its parent: balls no larger
    /// than the ball or its motion; for a ball with one triangle, single triangles.
    fn list(&mut self, task: &Task<'_>, open: &Open, ball: &Ball, swath: &Swath, least: &mut f64) {
        let [from, to] = open.near;
        self.near.truncate(to);
        let size = match ball.content {
            Content::Triangle(_) => f64::NEG_INFINITY,
            Content::Parts(_) => ball.radius.max(swath.length),
        };
        for i in from..to {
            self.todo.push(self.near[i]);
            while let Some(near) = self.todo.pop() {
                self.compared += 1;
                if self.compared.is_multiple_of(64) && self.interrupt.ask() {
                    self.todo.clear();
                    return;
                }
                let mut made = None;
                let ball = task.standing.ball(near.ball, &mut made);
                match (swath.apart(ball, task.margin + task.touching), ball.content) {
                    (Some(apart), _) => *least = least.min(apart - task.touching),
                    (None, Content::Parts(parts)) if ball.radius > size => {
                        self.todo.extend(parts.map(|ball| Near { ball, ..near }));
                    }
                    (None, _) => self.near.push(near),
                }
            }
        }
    }

    /// Drops the triangles last listed that a direction separates from a moving triangle.
    fn drop_apart(
        &mut self,
        task: &Task<'_>,
        (triangle, round): (Triangle, f64),
        open: &Open,
        swath: &Swath,
        least: &mut f64,
    ) {
        let ends = self.parts[open.part].ends.map(|end| &self.moments[end]);
        let [from, to] = ends.map(|moment| triangle.map(|p| moment.place(&p)));
        let hull = SweptTriangle::new(from, to);
        let enough = task.margin + task.touching;
        let first = open.near[1];
        let mut kept = first;
        // What separates one triangle often separates the next, which is near it.
        let mut front = Front::none();
        for i in first..self.near.len() {
            let (near, mut made) = (self.near[i], None);
            let gap = task.stands(&near, &mut made).map_or(f64::NEG_INFINITY, |(stands, other)| {
                let round = round + other;
                let wanted = enough + swath.bend + round;
                let gap = front.gap(stands);
                if gap >= wanted {
                    return gap - round;
                }
                let (gap, way) = hull.gap_from(stands, near.way, wanted);
                if gap >= wanted {
                    front = hull.along(way);
                }
                gap - round
            });
            let gap = gap - swath.bend;
            if gap >= enough {
                *least = least.min(gap - task.touching);
            } else {
                self.near[kept] = near;
                kept += 1;
            }
        }
        self.near.truncate(kept);
    }

    /// The space that a ball sweeps in a part of the motion.
    fn swath(&self, ball: &Ball, part: usize) -> Swath {
        let Part { ends, bend, .. } = self.parts[part];
        let ends = ends.map(|end| &self.moments[end]);
        let [from, to] = ends.map(|moment| moment.place(&ball.center).coords);
        // The box around a rotated box, or around the ball if that is smaller.
        let round = Vector3::repeat(ball.radius);
        let [at_from, at_to] = ends.map(|moment| (moment.spread * ball.half).inf(&round));
        let bend = ball.reach * bend;
        Swath {
            low: (from - at_from).inf(&(to - at_to)),
            high: (from + at_from).sup(&(to + at_to)),
            length: (to - from).norm() + BEND * bend,
            bend,
        }
    }

    /// Adds a moment; returns whether its pose is usable.
    fn moment(&mut self, at: f64, pose: &Isometry3<f64>, size: f64) -> bool {
        let rotation = pose.rotation.to_rotation_matrix().into_inner();
        self.moments.push(Moment { at, rotation, spread: rotation.abs(), origin: pose.translation.vector });
        is_usable(pose, size)
    }

    /// The middle of a part, as a fraction of the motion.
    fn middle(&self, part: usize) -> f64 {
        let [a, b] = self.parts[part].ends;
        0.5 * (self.moments[a].at + self.moments[b].at)
    }

    /// The moment in the middle of a part and both halves; `None` when the pose there is not usable.
    fn cut(
        &mut self,
        part: usize,
        pose_at: &impl Fn(f64) -> Isometry3<f64>,
        size: f64,
    ) -> Option<(usize, [usize; 2])> {
        let Part { ends: [a, b], bend, halves } = self.parts[part];
        if halves.is_some() {
            return halves;
        }
        let (middle, at) = (self.moments.len(), self.middle(part));
        if !self.moment(at, &pose_at(at), size) {
            return None;
        }
        let first = self.parts.len();
        // Half the angle, a quarter of the bend.
        self.parts.extend([[a, middle], [middle, b]].map(|ends| Part {
            ends,
            bend: bend / 4.0,
            halves: None,
        }));
        let halves = (middle, [first, first + 1]);
        self.parts[part].halves = Some(halves);
        Some(halves)
    }
}

impl Task<'_> {
    /// The static triangle, put into `made` unless it is stored, and the radius of the ball that it is; for a moving triangle only single
    /// triangles are listed.
    fn stands<'a>(&'a self, near: &Near, made: &'a mut Option<Triangle>) -> Option<(&'a Triangle, f64)> {
        match self.standing.ball(near.ball, &mut None).content {
            Content::Triangle(l) => Some((self.standing.triangle(l, made), self.standing.rounding(l))),
            Content::Parts(_) => None,
        }
    }

    /// A direction along which a moved triangle, with a ball of radius `round` if it is a point, is the margin and the slack apart from a static one.
    ///
    /// # Errors
    /// Their distance when it is less.
    fn way(&self, moved: &Triangle, round: f64, near: &Near) -> Result<Vector3<f64>, f64> {
        let mut made = None;
        let Some((stands, other)) = self.stands(near, &mut made) else { return Err(0.0) };
        let round = round + other;
        let wanted = self.margin + self.slack + round;
        let enough = wanted + self.touching;
        let (gap, way) = SweptTriangle::new(*moved, *moved).gap_from(stands, near.way, enough);
        if gap >= enough {
            return Ok(way);
        }
        let gap = triangle_gap(moved, stands);
        let distance = gap.norm();
        let far = distance > self.touching && distance >= wanted;
        if far { Ok(gap / distance) } else { Err(distance - round) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::{TriMesh, pose_from_six, primitives};
    use proptest::prelude::*;

    /// A straight motion with a turn at constant speed about a fixed axis.
    fn motion(from: Isometry3<f64>, by: [f64; 6]) -> impl Fn(f64) -> Isometry3<f64> {
        let [x, y, z, a, b, c] = by;
        move |t| {
            let turned =
                from.rotation * nalgebra::UnitQuaternion::from_scaled_axis(Vector3::new(a, b, c) * t);
            Isometry3::from_parts((from.translation.vector + Vector3::new(x, y, z) * t).into(), turned)
        }
    }

    fn meshes() -> [RefMesh; 2] {
        let bar = primitives::cuboid(1.4, 0.1, 0.2).unwrap();
        let ring = primitives::torus(0.8, 0.1, 16, 8).unwrap();
        let sheet =
            TriMesh::from_soup(&[[[-2.0, 1.3, -2.0], [2.0, 1.3, -2.0], [0.0, 1.5, 2.0]].map(Point3::from)]);
        [bar, TriMesh::merged([&ring, &sheet.unwrap()]).unwrap()].map(|mesh| RefMesh::new(&mesh))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(150))]
        #[test]
        fn finds_what_sampling_finds(
            from in prop::array::uniform6(-1.5..1.5_f64),
            by in prop::array::uniform6(-1.7..1.7_f64),
            short in 0.0..1.0_f64,
            margin in prop_oneof![Just(1e-6), Just(1e-3), Just(0.05)],
        ) {
            let [bar, other] = meshes();
            let pose_at = motion(pose_from_six(from), by.map(|v| v * short));
            let clearance = |t: f64| bar.clearance(&pose_at(t), &other, &Isometry3::identity(), 10.0);
            let sampled = (0..=60).map(|k| clearance(f64::from(k) / 60.0)).fold(f64::INFINITY, f64::min);
            match Sweep::default().sweep(&bar, &pose_at, &other, margin, margin) {
                SweepCheck::Free { clearance } => {
                    prop_assert!(clearance >= margin && clearance <= sampled + 1e-12, "{} {}", clearance, sampled);
                }
                SweepCheck::Collision { at } => prop_assert_eq!(clearance(at), 0.0),
                SweepCheck::TooClose { at } => prop_assert!(clearance(at) < 2.0 * margin),
            }
        }
    }

    /// A wall of no thickness between the samples of any step, crossed straight, aslant and by half a turn.
    #[test]
    fn nothing_passes_a_sheet() {
        let [bar, _] = meshes();
        let sheet = primitives::cuboid(1e-9, 6.0, 6.0).unwrap();
        let wall = RefMesh::new(&sheet);
        let mut sweep = Sweep::default();
        for (from, by) in [
            ([-1.0, 0.0, 0.0, 0.0, 0.0, 0.0], [2.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
            ([-1.0, 0.3, 0.2, 0.4, 0.5, 0.6], [2.0, 0.5, -0.5, 1.0, -2.0, 1.0]),
            ([-0.05, 0.8, 0.0, 1.57, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0, 3.1]),
        ] {
            let found = sweep.sweep(&bar, motion(pose_from_six(from), by), &wall, 1e-5, 1e-5);
            assert!(!matches!(found, SweepCheck::Free { .. }), "{found:?}");
        }
        let beside = motion(pose_from_six([-0.71, 0.0, 0.0, 0.0, 0.0, 0.0]), [0.0, 1.0, 0.0, 0.0, 0.0, 3.1]);
        assert!(matches!(sweep.sweep(&bar, beside, &wall, 1e-5, 1e-5), SweepCheck::Free { .. }));
        assert!(sweep.compared() < 20_000, "{}", sweep.compared());
    }

    /// A search leaves nothing behind that changes the next.
    #[test]
    fn a_sweep_used_before_finds_the_same() {
        let [bar, other] = meshes();
        let mut used = Sweep::default();
        for i in 0..200 {
            let x = f64::from(i);
            let from = pose_from_six([
                1.5 * mp_math::sin(0.7 * x),
                1.5 * mp_math::cos(1.1 * x),
                0.1,
                x,
                2.0 * x,
                0.3 * x,
            ]);
            let by =
                [mp_math::cos(0.9 * x), 0.4 * mp_math::sin(1.7 * x), 0.1, 0.5, mp_math::sin(0.3 * x), 0.2];
            let again = used.sweep(&bar, motion(from, by), &other, 1e-4, 1e-4);
            assert_eq!(again, Sweep::default().sweep(&bar, motion(from, by), &other, 1e-4, 1e-4), "{i}");
        }
    }

    #[test]
    fn what_is_no_motion_is_contact() {
        let [bar, other] = meshes();
        for x in [f64::NAN, f64::INFINITY, 1e80] {
            let jump = |t: f64| Isometry3::translation(if t > 0.3 { x } else { 5.0 }, 0.0, 0.0);
            assert!(matches!(
                Sweep::default().sweep(&bar, jump, &other, 1e-3, 1e-3),
                SweepCheck::Collision { .. }
            ));
        }
    }
}
