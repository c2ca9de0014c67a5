//! Relaxing a path by a snake.

use crate::field::{self, AnyField};
use crate::motion::{By, Counting};
use crate::prepared::Possible;
use crate::{Control, Error, Finish, RelaxField, Request, RobotKind, Stage};
use mp_cspace::erased::{AnyCheck, AnyGradient, AnySpace};
use mp_cspace::shorten::reduce;
use mp_cspace::{Demand, Interrupt, Path, Space, verify_path};
use mp_snake::{Params, relax};
use mp_tree::TreeState;
use std::sync::atomic::AtomicU64;
use std::time::Duration;

/// The range of the repulsion of obstacles, as a part of the extent of the space.
const RELAX_RANGE: f64 = 0.03;
/// How many times as long relaxing may make the path that is left without needless states.
const MOST_STRETCH: f64 = 1.15;

/// Refuses to relax what cannot be relaxed, before planning.
pub(crate) fn check<K: RobotKind + ?Sized>(kind: &K, request: &Request) -> Result<(), Error> {
    if request.finish != Finish::Relax {
        return Ok(());
    }
    if kind.demands().contains(&Demand::Inputs) {
        return Err(Error::new("a robot that moves by inputs cannot follow a relaxed path")
            .help("leave relaxing out: shortening chooses other inputs"));
    }
    let unused = AtomicU64::new(0);
    drop(gradient(kind, &unused, &Interrupt::never())?);
    field::check(kind, &request.field)
}

/// The clearance gradient of the robot.
fn gradient<'k, K: RobotKind + ?Sized>(
    kind: &'k K,
    unused: &'k AtomicU64,
    interrupt: &Interrupt,
) -> Result<AnyGradient<'k, K::State>, Error> {
    let knowledge = kind.any_obstacles(&Counting::new(unused, interrupt.clone()));
    knowledge.gradient.ok_or_else(|| {
        Error::new("this robot knows no clearance gradient, so its paths cannot be relaxed")
            .help("leave relaxing out: shortening needs none")
    })
}

/// The part of the time left that relaxing may take; the rest is for verifying.
const RELAXING_PART: f64 = 0.5;

/// The path, [relaxed] if the request says so, within the time `left`.
pub(crate) fn relax_if_requested<K: RobotKind + ?Sized>(
    kind: &K,
    request: &Request,
    path: Path<K::State>,
    control: &mut Control<'_>,
    left: Option<Duration>,
) -> Result<Path<K::State>, Error> {
    if request.finish != Finish::Relax {
        return Ok(path);
    }
    control.stage(Stage::Relaxing);
    let interrupt = match left {
        None => Interrupt::new(control.cancel.clone()),
        Some(left) => control.interrupt_within(left.mul_f64(RELAXING_PART)),
    };
    relaxed(kind, &request.field, path, &interrupt)
}

/// The path without the states that it does not need, relaxed by a snake; the path itself if the result does not pass the
/// verifier. In the metric of the space itself the result is no longer than the path.
fn relaxed<K: RobotKind + ?Sized>(
    kind: &K,
    field: &RelaxField,
    path: Path<K::State>,
    interrupt: &Interrupt,
) -> Result<Path<K::State>, Error> {
    let _span = tracing::info_span!("relax", %field).entered();
    let unused = AtomicU64::new(0);
    let gradient = gradient(kind, &unused, interrupt)?;
    let check =
        kind.motions(By::Certificates(kind.tolerance()), &Counting::new(&unused, interrupt.clone()))?;
    let mut check: AnyCheck<'_, K::State> =
        Box::new(Possible { kind, check, interrupt: interrupt.clone(), deadlines: None });
    let space = AnySpace::new(&kind.any_space());
    let short = reduce(&space, &mut check, &path);
    let range = RELAX_RANGE * space.extent();
    let field = field::make(kind, field, range, Some(&short), gradient)?;
    let mut verifier: AnyCheck<'_, K::State> = Box::new(kind.any_verifier()?);
    verifier.interrupt_by(interrupt);
    relaxed_by(&space, check, verifier, field, range, short, path)
}

/// [`relaxed`] behind pointers: compiled for each kind of state instead of each kind of robot.
fn relaxed_by<S: TreeState>(
    space: &AnySpace<'_, S>,
    mut check: AnyCheck<'_, S>,
    mut verifier: AnyCheck<'_, S>,
    mut field: AnyField<'_, S>,
    range: f64,
    short: Path<S>,
    path: Path<S>,
) -> Result<Path<S>, Error> {
    let [found, least] = [&path, &short].map(|path| path.length(space));
    let params = Params { straighten: 0.5, iterations: 200, ..Params::for_range(range)? };
    // Clearance may cost some of the length that was saved.
    let stretch = if least > 0.0 { (found / least).clamp(1.0, MOST_STRETCH) } else { 1.0 };
    let relaxed = relax(space, &mut check, &mut field, &short, params, stretch)?.path;
    let verified = verify_path(space, &relaxed, &mut verifier);
    if let Some(fault) = verified.fault {
        tracing::info!("the relaxed path does not pass the verifier: {fault}");
        return Ok(path);
    }
    tracing::info!("relaxed: length {found} to {}", relaxed.length(space));
    Ok(relaxed)
}
