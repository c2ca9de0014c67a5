//! Whole motions of a mesh past another, proved free.

use super::hull::Hull;
use super::triangle::{from_segment, triangle_gap};
use super::{Ball, Content, RefMesh, TOUCHING, is_usable};
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

/// What a [`Sweep`] found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Swept {
    /// Free all along.
    Free {
        /// A lower bound on the distance all along, at least the margin (m).
        clearance: f64,
    },
    /// The meshes touch at fraction `at` of the motion, or have no distance there.
    Contact {
        /// The fraction.
        at: f64,
    },
    /// The meshes are nearer than twice the margin at fraction `at` of the motion, or the search was given up
    /// there.
    Near {
        /// The fraction.
        at: f64,
    },
}

/// Proves that a mesh that moves keeps a distance from one that stands: a search over pairs of balls and
/// parts of the motion. Holds the memory that takes.
///
/// While its mesh goes straight and turns by θ about a fixed axis, both at constant speed, a point at
/// distance r from the origin of its frame keeps within r·θ²/8 of the point that moves evenly from where it
/// begins to where it ends (the error of linear interpolation). So
///
/// - a ball is swept within a capsule so much wider, and the box around its triangles within the box around both
///   ends, so much wider: these are kept apart from what stands;
/// - a triangle is swept within the hull of its corners at both ends, so much wider, which is kept apart from
///   a triangle by a direction.
///
/// A pair that is not shown to be apart is cut in the larger of the two or, when the motion is longer than
/// that, in time. Triangles nearer than twice the margin in the middle of a part end the search.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    parts: Vec<Part>,
    moments: Vec<Moment>,
    open: Vec<Pair>,
    compared: u64,
}

/// A part of a motion, cut when need be.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// Indices of moments.
    ends: [usize; 2],
    /// θ²/8 for the part.
    bend: f64,
    /// The moment in the middle and the parts to either side.
    halves: Option<(usize, [usize; 2])>,
}

/// What the balls `a` and `b` hold, during a part of the motion.
#[derive(Clone, Copy, Debug)]
struct Pair {
    a: usize,
    b: usize,
    part: usize,
    /// A direction that may keep triangles apart; zero when none is known.
    way: Vector3<f64>,
}

/// What is to be done about a pair.
enum Look {
    /// Nothing: it keeps this distance (m).
    Apart(f64),
    /// To look at its parts.
    Split([[usize; 2]; 2]),
    /// To look at halves of the motion.
    Cut,
    /// Two triangles that may be near: to look at the middle of the motion, and then at halves.
    Close,
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

/// What a sweep is about.
struct Task<'a> {
    moving: &'a RefMesh,
    standing: &'a RefMesh,
    margin: f64,
    touching: f64,
}

/// More pairs than this are not compared.
const MAX_COMPARED: u64 = 20_000_000;

/// What a bend counts against the length of a motion when it is decided whether to cut in time: a cut makes it
/// four times smaller.
const BEND: f64 = 20.0;

impl Sweep {
    /// Pairs of balls and of triangles compared so far.
    #[must_use]
    pub fn compared(&self) -> u64 {
        self.compared
    }

    /// Whether `moving` keeps at least `margin` (metres, positive) from `standing`, both in the world, over a
    /// motion that takes its frame to `pose_at` of the fractions 0 to 1.
    ///
    /// The motion must take the origin on a straight line and turn by at most half a turn about a fixed axis,
    /// both at constant speed. Found free is every motion with a distance of at least twice the margin all
    /// along, unless it takes more than 20 million comparisons. A pose that is not finite or not a rigid motion,
    /// and coordinates beyond 1e75, give contact.
    pub fn sweep(
        &mut self,
        moving: &RefMesh,
        pose_at: impl Fn(f64) -> Isometry3<f64>,
        standing: &RefMesh,
        margin: f64,
    ) -> Swept {
        self.parts.clear();
        self.moments.clear();
        self.open.clear();
        let size = moving.size + standing.size;
        let ends = [0.0, 1.0].map(|at| (at, pose_at(at)));
        for (at, pose) in &ends {
            if !self.moment(*at, pose, size) {
                return Swept::Contact { at: *at };
            }
        }
        let [from, to] = ends.map(|(_, pose)| pose.rotation.into_inner());
        let between = from.conjugate() * to;
        let turn = 2.0 * between.imag().norm().atan2(between.w.abs());
        self.parts.push(Part { ends: [0, 1], bend: turn * turn / 8.0, halves: None });
        let far = self.moments.iter().map(|moment| moment.origin.norm()).fold(0.0, f64::max);
        let task = Task { moving, standing, margin, touching: TOUCHING * (size + far) };
        let [a, b] = [moving, standing].map(|mesh| mesh.balls.len() - 1);
        self.open.push(Pair { a, b, part: 0, way: Vector3::zeros() });

        let mut least = f64::INFINITY;
        let limit = self.compared + MAX_COMPARED;
        while let Some(mut pair) = self.open.pop() {
            self.compared += 1;
            if self.compared > limit {
                return Swept::Near { at: self.middle(pair.part) };
            }
            let close = match self.look(&task, &pair) {
                Look::Apart(distance) => {
                    least = least.min(distance);
                    continue;
                }
                Look::Split(parts) => {
                    self.open.extend(parts.map(|[a, b]| Pair { a, b, ..pair }));
                    continue;
                }
                Look::Cut => false,
                Look::Close => true,
            };
            let Some((middle, halves)) = self.cut(pair.part, &pose_at, size) else {
                return Swept::Contact { at: self.middle(pair.part) };
            };
            if close {
                let middle = &self.moments[middle];
                let gap = task.gap(&pair, middle);
                let distance = gap.norm();
                if distance <= task.touching {
                    return Swept::Contact { at: middle.at };
                }
                if distance < 2.0 * margin {
                    return Swept::Near { at: middle.at };
                }
                pair.way = gap / distance;
            }
            self.open.extend(halves.map(|part| Pair { part, ..pair }));
        }
        Swept::Free { clearance: least }
    }

    /// Compares a pair.
    fn look(&self, task: &Task<'_>, pair: &Pair) -> Look {
        let Task { moving, standing, margin, touching } = *task;
        let (ball_a, ball_b) = (&moving.balls[pair.a], &standing.balls[pair.b]);
        let Part { ends, bend, .. } = self.parts[pair.part];
        let ends = ends.map(|end| &self.moments[end]);
        let centers = ends.map(|moment| moment.place(&ball_a.center));
        let enough = margin + touching;
        let mut apart = apart_balls(ball_a, ball_b, &centers, bend);
        if apart < enough {
            apart = apart.max(apart_boxes(ball_a, ball_b, &centers, &ends, bend));
        }
        if apart >= enough {
            return Look::Apart(apart - touching);
        }
        let swept = (centers[1] - centers[0]).norm() + BEND * ball_a.reach * bend;
        if swept > ball_a.radius.max(ball_b.radius).max(2.0 * margin) {
            return Look::Cut;
        }
        match (ball_a.content, ball_b.content) {
            (Content::Triangle(k), Content::Triangle(l)) => {
                let [from, to] = ends.map(|moment| moving.triangles[k].map(|p| moment.place(&p)));
                let hull = Hull::new(from, to);
                let bend = ball_a.reach * bend;
                let ahead = hull.ahead_of(&standing.triangles[l], pair.way, enough + bend) - bend;
                if ahead >= enough { Look::Apart(ahead - touching) } else { Look::Close }
            }
            (Content::Parts([i, j]), Content::Parts(_)) if ball_a.radius >= ball_b.radius => {
                Look::Split([[i, pair.b], [j, pair.b]])
            }
            (_, Content::Parts([i, j])) => Look::Split([[pair.a, i], [pair.a, j]]),
            (Content::Parts([i, j]), Content::Triangle(_)) => Look::Split([[i, pair.b], [j, pair.b]]),
        }
    }

    /// Notes a moment; whether it can be computed with.
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

    /// The moment in the middle of a part and both halves; `None` when that is no pose.
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
    /// The shortest way from the triangle that stands to the one that moves, at a moment; zero for other pairs.
    fn gap(&self, pair: &Pair, moment: &Moment) -> Vector3<f64> {
        match (self.moving.balls[pair.a].content, self.standing.balls[pair.b].content) {
            (Content::Triangle(k), Content::Triangle(l)) => {
                let moved = self.moving.triangles[k].map(|p| moment.place(&p));
                triangle_gap(&moved, &self.standing.triangles[l])
            }
            _ => Vector3::zeros(),
        }
    }
}

/// A lower bound on the distance of two balls while the center of the first goes from one place to another.
fn apart_balls(a: &Ball, b: &Ball, [from, to]: &[Point3<f64>; 2], bend: f64) -> f64 {
    from_segment(&b.center, from, to).norm() - a.radius - b.radius - a.center.coords.norm() * bend
}

/// A lower bound on the distance of the boxes around what two balls hold, while the first moves.
fn apart_boxes(a: &Ball, b: &Ball, [from, to]: &[Point3<f64>; 2], ends: &[&Moment; 2], bend: f64) -> f64 {
    let [at_from, at_to] = ends.map(|moment| moment.spread * a.half);
    let low = (from.coords - at_from).inf(&(to.coords - at_to));
    let high = (from.coords + at_from).sup(&(to.coords + at_to));
    let gap = (low - b.center.coords - b.half).sup(&(b.center.coords - b.half - high));
    gap.sup(&Vector3::zeros()).norm() - a.reach * bend
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::{TriMesh, pose_from_six, primitives};
    use proptest::prelude::*;

    /// A straight way with a turn at constant speed about a fixed axis.
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
            match Sweep::default().sweep(&bar, &pose_at, &other, margin) {
                Swept::Free { clearance } => {
                    prop_assert!(clearance >= margin && clearance <= sampled + 1e-12, "{} {}", clearance, sampled);
                }
                Swept::Contact { at } => prop_assert_eq!(clearance(at), 0.0),
                Swept::Near { at } => prop_assert!(clearance(at) < 2.0 * margin),
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
            let found = sweep.sweep(&bar, motion(pose_from_six(from), by), &wall, 1e-5);
            assert!(!matches!(found, Swept::Free { .. }), "{found:?}");
        }
        let beside = motion(pose_from_six([-0.71, 0.0, 0.0, 0.0, 0.0, 0.0]), [0.0, 1.0, 0.0, 0.0, 0.0, 3.1]);
        assert!(matches!(sweep.sweep(&bar, beside, &wall, 1e-5), Swept::Free { .. }));
        assert!(sweep.compared() < 20_000, "{}", sweep.compared());
    }

    #[test]
    fn what_is_no_motion_is_contact() {
        let [bar, other] = meshes();
        for x in [f64::NAN, f64::INFINITY, 1e80] {
            let jump = |t: f64| Isometry3::translation(if t > 0.3 { x } else { 5.0 }, 0.0, 0.0);
            assert!(matches!(Sweep::default().sweep(&bar, jump, &other, 1e-3), Swept::Contact { .. }));
        }
    }
}
