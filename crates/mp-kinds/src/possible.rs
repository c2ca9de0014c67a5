//! Checks of motions as a run or the finish of its path asks them: only motions that the robot can make are free, and none once it is time.

use crate::Robot;
use mp_cspace::erased::AnyCheck;
use mp_cspace::{Configuration, Interrupt, KnownFree, MotionCheck, MotionValidity};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

/// Until when a run searches, and until when it proves a path that it has found by then: times of its clock in nanoseconds, 0 where there
/// is no such time.
///
/// A run asks one token. Its deadline is that of the search, but while a path is proved.
#[derive(Debug, Default)]
pub struct Deadlines {
    search: AtomicU64,
    proof: AtomicU64,
    proving: AtomicBool,
}

impl Deadlines {
    /// Sets both times; the search comes first.
    pub fn set(&self, search: Duration, proof: Duration) {
        let nanoseconds = |time: Duration| u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
        self.search.store(nanoseconds(search), Ordering::Relaxed);
        self.proof.store(nanoseconds(proof), Ordering::Relaxed);
        self.proving.store(false, Ordering::Relaxed);
    }

    /// A path is proved from now on.
    pub fn prove(&self, interrupt: &Interrupt) {
        self.enter(true, &self.proof, interrupt);
    }

    /// The search goes on.
    #[inline]
    fn search(&self, interrupt: &Interrupt) {
        if self.proving.load(Ordering::Relaxed) {
            self.enter(false, &self.search, interrupt);
        }
    }

    fn enter(&self, proving: bool, deadline: &AtomicU64, interrupt: &Interrupt) {
        let at = deadline.load(Ordering::Relaxed);
        if at > 0 && self.proving.swap(proving, Ordering::Relaxed) != proving {
            interrupt.move_deadline(Duration::from_nanos(at));
        }
    }
}

/// A check that finds no motion free that the robot cannot make, and none at all once it is interrupted.
#[allow(missing_debug_implementations, reason = "a pointer has nothing to print")]
pub struct Possible<'k> {
    /// The robot whose motions are checked.
    pub kind: &'k dyn Robot,
    /// The check of motions that it can make.
    pub check: AnyCheck<'k, Configuration>,
    /// What ends the run.
    pub interrupt: Interrupt,
    /// Those of the run that it is a part of.
    pub deadlines: Option<&'k Deadlines>,
}

impl MotionValidity<Configuration> for Possible<'_> {
    fn check_motion(&mut self, from: &Configuration, to: &Configuration) -> MotionCheck {
        self.check_extension(from, to, KnownFree::Neither)
    }
    fn check_extension(&mut self, from: &Configuration, to: &Configuration, known: KnownFree) -> MotionCheck {
        if let Some(deadlines) = self.deadlines {
            deadlines.search(&self.interrupt);
        }
        match !self.interrupt.ask() && self.kind.can_move(from, to) {
            true => self.check.check_extension(from, to, known),
            false => MotionCheck::Unproven { at: 0.0 },
        }
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.interrupt = interrupt.clone();
    }
    fn is_interrupted(&mut self) -> bool {
        self.interrupt.ask()
    }
}
