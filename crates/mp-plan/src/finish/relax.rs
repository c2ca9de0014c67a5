//! Relaxing a path by a snake.

use crate::{Control, Error, Finish, Request, Robot, Stage};
use mp_cspace::{Configuration, Demand, Interrupt, Path, StopReason};
use mp_kinds::field;
use mp_kinds::relax::{self, relaxed};
use std::time::Duration;

/// Refuses to relax what cannot be relaxed, before planning.
pub(crate) fn check(kind: &dyn Robot, request: &Request) -> Result<(), Error> {
    if request.finish != Finish::Relax {
        return Ok(());
    }
    if kind.demands().contains(&Demand::Inputs) {
        return Err(Error::new("a robot that moves by inputs cannot follow a relaxed path")
            .help("leave relaxing out: shortening chooses other inputs"));
    }
    relax::check(kind)?;
    field::check(kind, &request.field)
}

/// The part of the time left that relaxing may take; the rest is for verifying.
const RELAXING_PART: f64 = 0.5;

/// The work of relaxing; nothing where none was asked for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Relaxing {
    /// How long it took.
    pub time: Duration,
    /// What ended it before it was done.
    pub ended_by: Option<StopReason>,
}

/// The path, [relaxed] if the request says so, within the time `left`.
pub(crate) fn relax_if_requested(
    kind: &dyn Robot,
    request: &Request,
    path: Path<Configuration>,
    control: &mut Control<'_>,
    left: Option<Duration>,
) -> Result<(Path<Configuration>, Relaxing), Error> {
    if request.finish != Finish::Relax {
        return Ok((path, Relaxing::default()));
    }
    let began = control.clock.now();
    control.stage(Stage::Relaxing);
    let interrupt = match left {
        None => Interrupt::new(control.cancel.clone()),
        Some(left) => control.interrupt_within(left.mul_f64(RELAXING_PART)),
    };
    let path = relaxed(kind, &request.field, path, &interrupt)?;
    let time = control.clock.now().saturating_sub(began);
    Ok((path, Relaxing { time, ended_by: interrupt.raised() }))
}
