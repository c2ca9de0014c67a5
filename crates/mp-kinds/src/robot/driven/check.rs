//! Whether motions by inputs are free: for planners, and for the verification of finished paths.

use super::drivable::{AnyStateVerifier, Drivable};
use super::space::DrivenSpace;
use super::{DrivenScene, ROUND_UP};
use crate::numbers::rounding;
use crate::robot::Queries;
use crate::robot::motion::AnyChecker;
use mp_cspace::{
    Clearance, Configuration, Interrupt, MotionCheck, MotionClearance, MotionValidity, Space, Validity,
};
use std::sync::Arc;

/// Parts of a motion shorter than this are not tested by the verifier. What is not shown free by then is not free.
const SHORTEST: f64 = 1e-12;

/// Whether a robot that moves by inputs is free, and how far its motions move it.
#[derive(Clone, Debug)]
pub struct DrivenChecker {
    pub(super) robot: Arc<dyn Drivable>,
    pub(super) space: DrivenSpace,
    pub(super) checker: AnyChecker,
}

impl DrivenChecker {
    /// The checker of `robot` in `space`, which asks `checker` about single configurations.
    pub(super) fn new(robot: &Arc<dyn Drivable>, space: &DrivenSpace, checker: AnyChecker) -> Self {
        Self { robot: Arc::clone(robot), space: space.clone(), checker }
    }
}

impl Queries for DrivenChecker {
    fn queries(&self) -> u64 {
        self.checker.queries()
    }
}

impl Validity<Configuration> for DrivenChecker {
    fn is_valid(&mut self, q: &Configuration) -> bool {
        self.space.parts(q).is_some_and(|parts| self.checker.is_valid(&parts.q))
    }
}

impl Clearance<Configuration> for DrivenChecker {
    /// None outside of the bounds, which curved motions may leave.
    fn clearance(&mut self, q: &Configuration, enough: f64) -> f64 {
        match self.space.parts(q) {
            Some(parts) if self.space.positions().contains(&parts.q) => {
                self.checker.clearance(&parts.q, enough)
            }
            _ => 0.0,
        }
    }
    fn obstacle_clearance(&mut self, q: &Configuration, enough: f64) -> f64 {
        self.space.parts(q).map_or(0.0, |parts| self.checker.obstacle_clearance(&parts.q, enough))
    }
    fn in_contact(&mut self, q: &Configuration) -> bool {
        self.space.parts(q).is_none_or(|parts| self.checker.in_contact(&parts.q))
    }
}

impl MotionClearance<Configuration> for DrivenChecker {
    fn motion_bound(&self, from: &Configuration, to: &Configuration) -> f64 {
        if from == to {
            return 0.0;
        }
        match [from, to].map(|q| self.space.parts(q)) {
            [Some(from), Some(to)] if to.duration > 0.0 => {
                self.robot.speed(&self.space.system.rates(&from, &to)) * to.duration * ROUND_UP
            }
            // Straight motions are made nowhere; pictures of paths that are not valid ask for them.
            [Some(from), Some(to)] => self.checker.motion_bound(&from.q, &to.q),
            _ => f64::INFINITY,
        }
    }
}

/// Proves motions by inputs free of collision: replays the input, and asks the verifier of the robot about single moments. Its
/// answers are compared with how far the robot moves, and the motion is halved until all of it is shown free.
///
/// The answer is [`Unproven`](MotionCheck::Unproven) for a state that its input does not lead to, and for motions with a tested
/// moment of less clearance than the tolerance, a tenth of the robot's.
///
/// It shares the equations of motion and the bound on the speed of the robot's points with the planner's check; all that
/// it knows of obstacles comes from the robot's own verifier, which shares nothing with it.
#[derive(Clone)]
#[allow(missing_debug_implementations, reason = "a pointer has nothing to print")]
pub struct DrivenVerifier<'c> {
    pub(super) scene: &'c DrivenScene,
    pub(super) verifier: AnyStateVerifier<'c>,
}

impl MotionValidity<Configuration> for DrivenVerifier<'_> {
    fn check_motion(&mut self, from: &Configuration, to: &Configuration) -> MotionCheck {
        let space = &self.scene.space;
        let [Some(a), Some(b)] = [from, to].map(|q| space.contains(q).then(|| space.parts(q)).flatten())
        else {
            return MotionCheck::Unproven { at: 0.0 };
        };
        if from == to {
            return self.verifier.check_state(&a.q, f64::INFINITY);
        }
        let gap = space.off_course(&a, &b);
        if gap > rounding(space.extent()) {
            return MotionCheck::Unproven { at: 1.0 };
        }
        // Between these moments and the ends no number of the position is beyond its values there.
        for time in space.system.turning_times(&a, &b) {
            let then = space.system.flow(&space.positions(), &a, &b.input, time);
            if !space.positions().contains(&then.q) {
                return MotionCheck::Unproven { at: time / b.duration };
            }
        }
        let travel = self.scene.robot.speed(&space.system.rates(&a, &b)) * b.duration * ROUND_UP;
        let margin = self.scene.robot.kept() + 0.1 * self.scene.robot.tolerance();
        let mut least = f64::INFINITY;
        let mut open = vec![(0.0_f64, 1.0_f64)];
        while let Some((begin, end)) = open.pop() {
            let (at, half) = (0.5 * (begin + end), 0.5 * (end - begin));
            if self.verifier.is_interrupted() {
                return MotionCheck::Unproven { at };
            }
            let now = space.system.flow(&space.positions(), &a, &b.input, at * b.duration);
            let near = half * travel;
            let needed = (near + margin) * ROUND_UP;
            match self.verifier.check_state(&now.q, 2.0 * needed) {
                _ if !space.positions().contains(&now.q) => return MotionCheck::Unproven { at },
                MotionCheck::Free { clearance } if clearance >= needed => {
                    least = least.min(clearance - near);
                }
                MotionCheck::Free { clearance } if clearance >= margin && half >= SHORTEST => {
                    open.extend([(at, end), (begin, at)]);
                }
                MotionCheck::Collision { .. } => return MotionCheck::Collision { at },
                _ => return MotionCheck::Unproven { at },
            }
        }
        // The last state itself, as written.
        match self.verifier.check_state(&b.q, least) {
            MotionCheck::Free { clearance } => MotionCheck::Free { clearance: least.min(clearance) },
            MotionCheck::Collision { .. } => MotionCheck::Collision { at: 1.0 },
            MotionCheck::Unproven { .. } => MotionCheck::Unproven { at: 1.0 },
        }
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.verifier.interrupt_by(interrupt);
    }
    fn is_interrupted(&mut self) -> bool {
        self.verifier.is_interrupted()
    }
}
