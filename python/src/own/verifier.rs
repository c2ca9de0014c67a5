//! The verifier of paths of own robots. It shares no code with the checks of planners, only the functions, unless the robot has one of
//! its own for it.

use super::Own;
use super::check::{Functions, is_free, number};
use mp_cspace::Configuration;
use mp_cspace::{Interrupt, MotionCheck, MotionValidity, Space, Validity};
use mp_plan::{Length, VERIFIED_FINER};

/// The part of the clearance that the robot moves before the clearance is asked again. The rest is the clearance that is proved.
const PART: f64 = 0.8;
/// How many configurations are tested at a time: a run can be stopped in between.
const CHUNK: u64 = 64;

/// Walks along each motion from its beginning to its end.
#[derive(Clone, Debug)]
pub(crate) struct Verifier<'k> {
    own: &'k Own,
    interrupt: Interrupt,
}

impl<'k> Verifier<'k> {
    pub(super) fn new(own: &'k Own) -> Self {
        Self { own, interrupt: Interrupt::never() }
    }

    /// By the clearance: as long as no point travels as far as that, there is no contact.
    fn by_clearance(&mut self, from: &Configuration, to: &Configuration) -> MotionCheck {
        let own = self.own;
        let Functions::Clearance { clearance, displacement } = own.check.functions() else {
            return MotionCheck::Unproven { at: 0.0 };
        };
        let travel = number(displacement, &own.numbers, "displacement", &[from, to]);
        let Some(travel) = travel else { return MotionCheck::Unproven { at: 0.0 } };
        let (mut at, mut least) = (0.0, f64::INFINITY);
        loop {
            let q = own.space.interpolate(from, to, at);
            let here = number(clearance, &own.numbers, "clearance", &[&q]).unwrap_or(0.0);
            if here <= 0.0 {
                return MotionCheck::Collision { at };
            }
            if here < 0.5 * own.tolerance || self.interrupt.ask() {
                return MotionCheck::Unproven { at };
            }
            if at >= 1.0 {
                return MotionCheck::Free { clearance: least.min(here) };
            }
            let step = (PART * here).min((1.0 - at) * travel);
            least = least.min(here - step);
            // The last step ends exactly at the end.
            at = if step < PART * here { 1.0 } else { (at + step / travel).min(1.0) };
        }
    }

    /// By configurations that are much nearer to each other than while planning.
    fn by_steps(&mut self, from: &Configuration, to: &Configuration) -> MotionCheck {
        let own = self.own;
        let step = match own.resolution {
            Length::Absolute(length) => length,
            Length::Fraction(fraction) => fraction * own.space.extent(),
        } / VERIFIED_FINER;
        let steps = (own.space.distance(from, to) / step).ceil();
        if steps.is_nan() || steps > 1e10 {
            return MotionCheck::Unproven { at: 0.0 };
        }
        let steps = (steps as u64).max(1);
        let fraction = |i: u64| i as f64 / steps as f64;
        let mut check = own.check.clone();
        for first in (0..=steps).step_by(CHUNK as usize) {
            if self.interrupt.ask() {
                return MotionCheck::Unproven { at: fraction(first) };
            }
            let chunk: Vec<Configuration> = (first..=steps.min(first + CHUNK - 1))
                .map(|i| own.space.interpolate(from, to, fraction(i)))
                .collect();
            let hit = match &own.verify {
                Some(verify) => chunk.iter().position(|q| !is_free(verify, &own.numbers, "verify", q)),
                None => check.first_invalid(&chunk),
            };
            if let Some(hit) = hit {
                return MotionCheck::Collision { at: fraction(first + hit as u64) };
            }
        }
        MotionCheck::Free { clearance: 0.0 }
    }
}

impl MotionValidity<Configuration> for Verifier<'_> {
    fn check_motion(&mut self, from: &Configuration, to: &Configuration) -> MotionCheck {
        if !self.own.check.knows_clearance() {
            return self.by_steps(from, to);
        }
        match self.by_clearance(from, to) {
            free @ MotionCheck::Free { .. } if self.own.verify.is_some() => match self.by_steps(from, to) {
                MotionCheck::Free { .. } => free,
                hit => hit,
            },
            found => found,
        }
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.interrupt = interrupt.clone();
    }
    fn is_interrupted(&mut self) -> bool {
        self.interrupt.ask()
    }
}
