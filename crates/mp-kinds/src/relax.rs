//! Relaxing a path by a snake.

use crate::motion::{By, Counting, motions};
use crate::possible::Possible;
use crate::{Error, RelaxField, Robot, field};
use mp_cspace::erased::{AnyCheck, AnyGradient, AnySpace};
use mp_cspace::shorten::reduce;
use mp_cspace::{Configuration, Interrupt, Path, Space, verify_path};
use mp_snake::Params;
use std::sync::atomic::AtomicU64;

/// The range of the repulsion of obstacles, as a part of the extent of the space.
const RELAX_RANGE: f64 = 0.03;
/// How many times as long relaxing may make the path that is left without needless states.
const MOST_STRETCH: f64 = 1.15;

/// Refuses a robot whose paths cannot be relaxed.
///
/// # Errors
/// When it knows no clearance gradient.
pub fn check(kind: &dyn Robot) -> Result<(), Error> {
    gradient(kind, &AtomicU64::new(0), &Interrupt::never()).map(drop)
}

/// The clearance gradient of the robot.
fn gradient<'k>(
    kind: &'k dyn Robot,
    unused: &'k AtomicU64,
    interrupt: &Interrupt,
) -> Result<AnyGradient<'k, Configuration>, Error> {
    let knowledge = kind.any_obstacles(&Counting::new(unused, interrupt.clone()));
    knowledge.gradient.ok_or_else(|| {
        Error::new("this robot knows no clearance gradient, so its paths cannot be relaxed")
            .help("leave relaxing out: shortening needs none")
    })
}

/// The path without the states that it does not need, relaxed by a snake; the path itself if the result does not pass the
/// verifier. In the metric of the space itself the result is no longer than the path.
///
/// # Errors
/// When the robot knows no clearance gradient, or the field does not suit it.
pub fn relaxed(
    kind: &dyn Robot,
    field: &RelaxField,
    path: Path<Configuration>,
    interrupt: &Interrupt,
) -> Result<Path<Configuration>, Error> {
    let _span = tracing::info_span!("relax", %field).entered();
    let unused = AtomicU64::new(0);
    let gradient = gradient(kind, &unused, interrupt)?;
    let space = AnySpace::new(&kind.any_space());
    let counting = Counting::new(&unused, interrupt.clone());
    let check = motions(kind, &space, By::Certificates(kind.tolerance()), &counting)?;
    let mut check: AnyCheck<'_, Configuration> =
        Box::new(Possible { kind, check, interrupt: interrupt.clone(), deadlines: None });
    let short = reduce(&space, &mut check, &path);
    let range = RELAX_RANGE * space.extent();
    let mut field = field::make(kind, field, range, Some(&short), gradient)?;
    let mut verifier: AnyCheck<'_, Configuration> = Box::new(kind.any_verifier()?);
    verifier.interrupt_by(interrupt);
    let [found, least] = [&path, &short].map(|path| path.length(&space));
    let params = Params { straighten: 0.5, iterations: 200, ..Params::for_range(range)? };
    // Clearance may cost some of the length that was saved.
    let stretch = if least > 0.0 { (found / least).clamp(1.0, MOST_STRETCH) } else { 1.0 };
    let relaxed = mp_snake::relax(&space, &mut check, &mut field, &short, params, stretch)?.path;
    let verified = verify_path(&space, &relaxed, &mut verifier);
    if let Some(fault) = verified.fault {
        tracing::info!("the relaxed path does not pass the verifier: {fault}");
        return Ok(path);
    }
    tracing::info!("relaxed: length {found} to {}", relaxed.length(&space));
    Ok(relaxed)
}
