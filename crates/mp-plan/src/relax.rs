//! Relaxing a path by a snake.

use crate::counted::Counted;
use crate::prepared::Possible;
use crate::{Control, Error, Finish, Request, RobotKind, Stage};
use mp_cspace::erased::{AnyCheck, AnyGradient, AnySpace};
use mp_cspace::shorten::reduce;
use mp_cspace::{Certified, Demand, Path, Space, verify_path};
use mp_snake::{Params, Repulsion, relax};
use mp_tree::TreeState;
use std::sync::atomic::AtomicU64;

/// The range of the repulsion of obstacles, as a part of the extent of the space.
const RELAX_RANGE: f64 = 0.03;
/// How many times as long relaxing may make the path that is left without needless states.
const MOST_STRETCH: f64 = 1.15;

/// The path, [relaxed] if the request says so.
pub(crate) fn relax_if_requested<K: RobotKind>(
    kind: &K,
    request: &Request,
    path: Path<K::State>,
    control: &mut Control<'_>,
) -> Result<Path<K::State>, Error> {
    if request.finish != Finish::Relax {
        return Ok(path);
    }
    if kind.demands().contains(&Demand::Inputs) {
        return Err(Error::new("a robot that moves by inputs cannot follow a relaxed path")
            .help("leave relaxing out"));
    }
    control.stage(Stage::Relaxing);
    relaxed(kind, path)
}

/// The path without the states that it does not need, relaxed by a snake; the path itself if the result does not pass the
/// verifier. In the metric of the space itself the result is no longer than the path.
fn relaxed<K: RobotKind>(kind: &K, path: Path<K::State>) -> Result<Path<K::State>, Error> {
    let _span = tracing::info_span!("relax").entered();
    let unused = AtomicU64::new(0);
    let knowledge = kind.obstacles(&|| Counted::new(kind.checker().clone(), &unused));
    let Some(gradient) = knowledge.gradient else {
        return Err(Error::new("this robot knows no clearance gradient, so its paths cannot be relaxed")
            .help("leave relaxing out: shortening needs none"));
    };
    let check = Certified::new(kind.space(), kind.checker().clone(), kind.tolerance())?;
    let check = Box::new(Possible { kind, check });
    relaxed_by(&AnySpace::new(kind.space()), check, Box::new(kind.verifier()?), gradient, path)
}

/// [`relaxed`] behind pointers: compiled for each kind of state instead of each kind of robot.
fn relaxed_by<S: TreeState>(
    space: &AnySpace<'_, S>,
    mut check: AnyCheck<'_, S>,
    mut verifier: AnyCheck<'_, S>,
    gradient: AnyGradient<'_, S>,
    path: Path<S>,
) -> Result<Path<S>, Error> {
    let range = RELAX_RANGE * space.extent();
    let mut field = Repulsion::new(gradient, range)?;
    let short = reduce(space, &mut check, &path);
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
