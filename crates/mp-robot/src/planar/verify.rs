//! The independent checks of motions in the plane.

use super::edge_list::{EdgeList, box_distance, inside_rings, rings, segment_distance, sides};
use crate::{DiscRobot, PolygonRobot};
use mp_cspace::{Interrupt, MotionCheck, MotionValidity, Se2State, Space};
use nalgebra::{Point2, Vector2};
use std::sync::Arc;

/// Proves straight motions of a disc free of collision, by a test of every edge: no grid, and other formulas than the
/// robot's.
///
/// Free means a clearance of at least the tolerance all along. The tolerance is a tenth of the robot's, so that the verifier
/// proves whatever [`DiscRobot`] accepts. O(edges) for each motion.
#[derive(Clone, Debug)]
pub struct DiscVerifier {
    obstacles: Arc<EdgeList>,
    radius: f64,
    tolerance: f64,
    /// The clearance (m) that the robot keeps, to which the tolerance is added.
    kept: f64,
    interrupt: Interrupt,
}

impl DiscVerifier {
    /// A verifier of the motions of `robot`, with its own copy of the obstacles.
    #[must_use]
    pub fn new(robot: &DiscRobot) -> Self {
        let obstacles = Arc::new(EdgeList::new(robot.world()));
        let interrupt = Interrupt::never();
        let (radius, tolerance, kept) = (robot.radius(), 0.1 * robot.tolerance(), robot.kept());
        Self { obstacles, radius, tolerance, kept, interrupt }
    }

    /// The clearance (m) that motions found free keep from every obstacle, beyond what the robot [keeps](DiscRobot::keeping).
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }
}

impl MotionValidity<Vector2<f64>> for DiscVerifier {
    fn check_motion(&mut self, from: &Vector2<f64>, to: &Vector2<f64>) -> MotionCheck {
        let segment = [from, to].map(|q| Point2::from(*q));
        // Written so that NaN is refused.
        let finite = segment.iter().all(|p| p.x.abs() + p.y.abs() < 1e60);
        if !finite {
            return MotionCheck::Unproven { at: 0.0 };
        }
        if self.obstacles.inside(&segment[0]) {
            return MotionCheck::Collision { at: 0.0 };
        }
        if self.interrupt.ask() {
            return MotionCheck::Unproven { at: 0.0 };
        }
        let clearance = self.obstacles.nearest(&segment) - self.radius;
        if clearance >= self.kept + self.tolerance {
            return MotionCheck::Free { clearance };
        }
        let at = self.nearest_fraction(&segment);
        if clearance <= self.kept { MotionCheck::Collision { at } } else { MotionCheck::Unproven { at } }
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.interrupt = interrupt.clone();
    }
    fn is_interrupted(&mut self) -> bool {
        self.interrupt.ask()
    }
}

impl DiscVerifier {
    /// The fraction of the motion at which the disc is nearest to the nearest side of an obstacle.
    fn nearest_fraction(&self, segment: &[Point2<f64>; 2]) -> f64 {
        let apart = |side| segment_distance(side, segment);
        let nearest = self.obstacles.edges.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)));
        let Some(side) = nearest else { return 0.0 };
        let distance = |t: f64| {
            let p = segment[0] + (segment[1] - segment[0]) * t;
            segment_distance(side, &[p, p])
        };
        // It falls and then rises along the motion.
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..100 {
            let third = (high - low) / 3.0;
            if distance(low + third) <= distance(high - third) {
                high -= third;
            } else {
                low += third;
            }
        }
        0.5 * (low + high)
    }
}

/// How often a motion is halved at most.
const MAX_DEPTH: u32 = 40;

/// Proves motions of a polygon free of collision, by a test of every edge near the motion: no grid, and other formulas and
/// another motion bound than planners use. Only the space is shared with the checker: its interpolation defines what a
/// motion is.
///
/// Free means a clearance of at least the tolerance all along, a tenth of the robot's. The space must move the
/// origin on a straight line and turn by at most half a turn, both at constant speed, as [`Se2`](mp_cspace::Se2) does.
#[derive(Clone, Debug)]
pub struct PolygonVerifier<'c, C> {
    space: &'c C,
    obstacles: Arc<EdgeList>,
    body: Arc<Vec<Vec<Point2<f64>>>>,
    radius: f64,
    tolerance: f64,
    /// The clearance (m) that the robot keeps, to which the tolerance is added.
    kept: f64,
    interrupt: Interrupt,
}

impl<'c, C: Space<State = Se2State>> PolygonVerifier<'c, C> {
    /// A verifier of the motions of `robot` in `space`, with its own copy of the obstacles.
    #[must_use]
    pub fn new(space: &'c C, robot: &PolygonRobot) -> Self {
        let obstacles = Arc::new(EdgeList::new(robot.world()));
        let body = rings(robot.body());
        let radius = body.iter().flatten().map(|p| p.coords.norm()).fold(0.0, f64::max);
        let (tolerance, interrupt) = (0.1 * robot.tolerance(), Interrupt::never());
        Self { space, obstacles, body: Arc::new(body), radius, tolerance, kept: robot.kept(), interrupt }
    }

    /// The clearance (m) that motions found free keep from every obstacle, beyond what the robot [keeps](PolygonRobot::keeping).
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    fn placed(&self, q: &Se2State) -> Vec<Vec<Point2<f64>>> {
        self.body.iter().map(|ring| ring.iter().map(|p| q.transform_point(p)).collect()).collect()
    }

    fn distance(&self, q: &Se2State, edges: &[[Point2<f64>; 2]]) -> f64 {
        let mut least = f64::INFINITY;
        let mut interrupt = self.interrupt.clone();
        for side in self.placed(q).iter().flat_map(|ring| sides(ring)) {
            if interrupt.ask() {
                return 0.0;
            }
            for edge in edges {
                if box_distance(&side, edge) < least {
                    least = least.min(segment_distance(&side, edge));
                }
            }
        }
        least
    }

    /// Whether the robot is inside an obstacle or around one. For boundaries that do not meet.
    fn nested(&self, q: &Se2State) -> bool {
        let placed = self.placed(q);
        placed.iter().any(|ring| self.obstacles.inside(&ring[0]))
            || self.obstacles.first_points().any(|p| inside_rings(&placed, p))
    }
}

impl<C: Space<State = Se2State>> MotionValidity<Se2State> for PolygonVerifier<'_, C> {
    fn check_motion(&mut self, from: &Se2State, to: &Se2State) -> MotionCheck {
        let segment = [from, to].map(|q| Point2::from(q.translation));
        let length = (segment[1] - segment[0]).norm();
        let finite =
            segment.iter().all(|p| p.x.abs() + p.y.abs() < 1e60) && (from.angle + to.angle).is_finite();
        if !finite {
            return MotionCheck::Unproven { at: 0.0 };
        }
        if self.nested(from) {
            return MotionCheck::Collision { at: 0.0 };
        }
        // The edges to which the robot can come near.
        let margin = self.kept + self.tolerance;
        let reach = self.radius + margin;
        let edges = self.obstacles.edges.iter().filter(|e| box_distance(e, &segment) <= 2.0 * reach);
        let near: Vec<[Point2<f64>; 2]> = edges.copied().collect();
        let turn = (to.angle - from.angle).rem_euclid(std::f64::consts::TAU);
        let turn = turn.min(std::f64::consts::TAU - turn);
        let mut open = vec![(0.0, 1.0, 0)];
        // All other edges are at least this far away.
        let mut least = reach;
        while let Some((a, b, depth)) = open.pop() {
            let at = 0.5 * (a + b);
            let travel = 0.5 * (b - a) * (length + self.radius * turn);
            let distance = self.distance(&self.space.interpolate(from, to, at), &near);
            if self.interrupt.ask() {
                return MotionCheck::Unproven { at };
            }
            if distance <= self.kept {
                return MotionCheck::Collision { at };
            }
            if distance - travel >= margin {
                least = least.min(distance - travel);
            } else if distance < margin || depth == MAX_DEPTH {
                return MotionCheck::Unproven { at };
            } else {
                open.extend([(at, b, depth + 1), (a, at, depth + 1)]);
            }
        }
        MotionCheck::Free { clearance: least }
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.interrupt = interrupt.clone();
    }
    fn is_interrupted(&mut self) -> bool {
        self.interrupt.ask()
    }
}
