//! The proof of a path, by code that shares nothing with the planner's checks, and how far from obstacles it stays.

use crate::counted::Counted;
use crate::{Error, Robot};
use mp_cspace::erased::AnyCheck;
use mp_cspace::path::PathReport;
use mp_cspace::{Configuration, Interrupt, MotionValidity, Path, least_clearance, verify_path};
use std::sync::atomic::AtomicU64;

/// Verifies a path edge by edge. Where `interrupt` says to end, the path has a fault.
///
/// # Errors
/// When the robot cannot be verified.
pub fn verified(
    kind: &dyn Robot,
    path: &Path<Configuration>,
    interrupt: &Interrupt,
) -> Result<PathReport, Error> {
    let mut verifier: AnyCheck<'_, Configuration> = Box::new(kind.any_verifier()?);
    verifier.interrupt_by(interrupt);
    Ok(verify_path(&kind.any_space(), path, &mut verifier))
}

/// A lower bound on the clearance (m) along a free path, to within `accuracy` (m); `None` where none is known, or `interrupt` says
/// to end.
pub fn clearance(
    kind: &dyn Robot,
    path: &Path<Configuration>,
    accuracy: f64,
    interrupt: &Interrupt,
) -> Option<f64> {
    if kind.sampled().is_some() {
        return None;
    }
    let unused = AtomicU64::new(0);
    let mut checker = Counted::new(kind.any_measure(), &unused).with_interrupt(interrupt.clone());
    let tightest = least_clearance(&kind.any_space(), &mut checker, path, accuracy)?;
    interrupt.raised().is_none().then_some(tightest.clearance)
}
