//! Finishing a path: shortens it, writes it as text, and verifies what the text says.

use crate::check::{clearance, verified};
use crate::prepared::Possible;
use crate::{Control, Error, Finish, PathRows, Request, RobotKind, Stage};
use mp_cspace::erased::AnyCheck;
use mp_cspace::shorten::{Effort, simplify};
use mp_cspace::{Cancel, Certified, Factored, KnownFree, MotionCheck, MotionValidity, Path, Rng};
use std::sync::atomic::Ordering;

/// The stream of random numbers for shortening. Planning uses another one.
const STREAM: u64 = 1;

/// A path that passed the verifier after it was written as text and read again.
#[derive(Clone, Debug)]
pub(crate) struct Finished {
    pub(crate) path: PathRows,
    /// Its length, in the metric of the space.
    pub(crate) length: f64,
    /// A lower bound (m) on the clearance along it.
    pub(crate) clearance: f64,
    pub(crate) shortened: bool,
}

/// A check that finds no motion free once the flag is raised, so that shortening comes to an end.
struct Cancellable<'a, S>(AnyCheck<'a, S>, &'a Cancel);

impl<S> MotionValidity<S> for Cancellable<'_, S> {
    fn check_motion(&mut self, from: &S, to: &S) -> MotionCheck {
        self.check_extension(from, to, KnownFree::Neither)
    }
    fn check_extension(&mut self, from: &S, to: &S, known: KnownFree) -> MotionCheck {
        if self.1.0.load(Ordering::Relaxed) {
            return MotionCheck::Unproven { at: 0.0 };
        }
        self.0.check_extension(from, to, known)
    }
}

/// Shortens a path. Every edge of the result keeps the [clearance of shortcuts](RobotKind::shortcut_clearance) or is an
/// edge of the given path. The same seed gives the same path. Raising `cancel` ends it early.
///
/// # Errors
/// When the tolerance of the robot is not valid.
pub fn shorten<K: RobotKind>(
    kind: &K,
    path: &Path<K::State>,
    seed: u64,
    cancel: &Cancel,
) -> Result<Path<K::State>, Error> {
    let _span = tracing::info_span!("shorten").entered();
    let certified: AnyCheck<'_, K::State> = Box::new(Possible {
        kind,
        check: Certified::new(kind.space(), kind.checker().clone(), kind.shortcut_clearance())?,
    });
    let (mut check, mut rng) = (Cancellable(certified, cancel), Rng::stream(seed, STREAM));
    Ok(match kind.shortened(path, &mut check, Effort::default(), &mut rng) {
        Some(short) => short,
        None => shorten_by(kind.space(), check, path, rng),
    })
}

/// [`shorten`] with a check behind a pointer: compiled for each space instead of each robot.
fn shorten_by<C: Factored>(
    space: &C,
    mut check: Cancellable<'_, C::State>,
    path: &Path<C::State>,
    mut rng: Rng,
) -> Path<C::State> {
    simplify(space, &mut check, path, Effort::default(), &mut rng)
}

/// Shortens `found` if the request says so, and verifies what will be written. If the shortened path does not pass, `found`
/// itself is used; `None` if that, written and read again, does not pass either.
pub(crate) fn finish<K: RobotKind>(
    kind: &K,
    found: &Path<K::State>,
    request: &Request,
    control: &mut Control<'_>,
) -> Result<Option<Finished>, Error> {
    control.stage(Stage::Finishing);
    if request.finish == Finish::Shorten {
        let short = shorten(kind, found, request.seed, &control.cancel)?;
        if let Some(finished) = verified_as_written(kind, &short, true)? {
            return Ok(Some(finished));
        }
        tracing::info!("the shortened path does not pass the verifier: the path as found is written");
    }
    verified_as_written(kind, found, false)
}

/// `path` written as text and read again, if the verifier passes the result.
fn verified_as_written<K: RobotKind>(
    kind: &K,
    path: &Path<K::State>,
    shortened: bool,
) -> Result<Option<Finished>, Error> {
    let _span = tracing::info_span!("verify").entered();
    let rows = PathRows { format: kind.path_format(), columns: kind.columns(), rows: kind.rows(path) };
    let rows = rows.read_back()?;
    let read = Path::straight(rows.rows.iter().map(|row| kind.state(row)).collect());
    let report = verified(kind, &read)?;
    if let Some(fault) = report.fault {
        tracing::info!("{fault}");
        return Ok(None);
    }
    let clearance =
        clearance(kind, &read, kind.accuracy()).map_or(report.clearance, |c| c.max(report.clearance));
    Ok(Some(Finished { path: rows, length: path.length(kind.space()), clearance, shortened }))
}
