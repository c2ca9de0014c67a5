//! From what a planner found to what is written: shortened, put into six-tuples, read back, verified.

use super::mover::Mover;
use super::setting::Setting;
use super::tuples;
use miette::{IntoDiagnostic, Result};
use mp::cspace::shorten::{Effort, simplify};
use mp::cspace::{
    Cancel, Certified, KnownFree, MotionCheck, MotionValidity, Path, Rng, Space, least_clearance, verify_path,
};
use mp::io::PathFile;
use std::sync::atomic::Ordering;

/// Which stream of random numbers shortening draws from: planning draws from another.
pub(crate) const STREAM: u64 = 1;

/// Shortcuts keep this many tolerances away from obstacles, where planning may go as near as one: a path that
/// grazes every corner is of no use to anybody.
pub(crate) const ROOM: f64 = 20.0;

/// A path that the verifier passed as it will be read.
#[derive(Clone, Debug)]
pub(crate) struct Finished {
    pub(crate) file: PathFile,
    /// In the metric of the space.
    pub(crate) length: f64,
    /// A lower bound all along, metres.
    pub(crate) clearance: f64,
    pub(crate) shortened: bool,
}

/// A check that finds nothing free any more once the flag is raised: whatever shortens with it comes to an end.
pub(crate) struct Until<'a, V>(pub(crate) V, pub(crate) &'a Cancel);

impl<S, V: MotionValidity<S>> MotionValidity<S> for Until<'_, V> {
    fn check_motion(&mut self, from: &S, to: &S) -> MotionCheck {
        self.check_extension(from, to, KnownFree::Neither)
    }
    fn check_extension(&mut self, from: &S, to: &S, known: KnownFree) -> MotionCheck {
        if self.1.0.load(Ordering::Relaxed) {
            return MotionCheck::Undecided { at: 0.0 };
        }
        self.0.check_extension(from, to, known)
    }
}

/// Shortens `found` if asked to, and verifies what will be written. Falls back to `found` itself; `None` when
/// not even that is free after it has been through its text.
pub(crate) fn finish<M: Mover>(
    setting: &Setting<M>,
    found: &Path<M::State>,
    shorten: bool,
    seed: u64,
    cancel: &Cancel,
) -> Result<Option<Finished>> {
    if shorten {
        let certified = Certified::new(&setting.space, setting.robot.clone(), ROOM * setting.tolerance)
            .into_diagnostic()?;
        let mut check = Until(certified, cancel);
        let mut rng = Rng::stream(seed, STREAM);
        let short = simplify(&setting.space, &mut check, found, Effort::default(), &mut rng);
        if let Some(finished) = written(setting, &short, true)? {
            return Ok(Some(finished));
        }
        tracing::info!("the shortened path does not pass the verifier: the path as found is written");
    }
    written(setting, found, false)
}

/// `path` as it reads back from its text, if the verifier passes that.
fn written<M: Mover>(
    setting: &Setting<M>,
    path: &Path<M::State>,
    shortened: bool,
) -> Result<Option<Finished>> {
    let states = &path.states;
    let at = |i: usize, t: f64| match states.get(i + 1) {
        Some(next) => M::pose(&setting.space.interpolate(&states[i], next, t)),
        None => M::pose(&states[i]),
    };
    let configurations = tuples::along(states.len().saturating_sub(1), setting.radius, at);
    let text = PathFile { configurations }.to_text();
    let file = PathFile::parse("the path", text.as_bytes())?;
    let read = Path::straight(file.poses().iter().map(M::configuration).collect());
    let report = verify_path(&setting.space, &read, &mut setting.verifier()?);
    if let Some(fault) = report.fault {
        tracing::info!("{fault}");
        return Ok(None);
    }
    let mut robot = setting.robot.clone();
    let tightest = least_clearance(&setting.space, &mut robot, &read, setting.tolerance);
    let clearance = tightest.map_or(report.clearance, |t| t.clearance.max(report.clearance));
    Ok(Some(Finished { file, length: path.length(&setting.space), clearance, shortened }))
}
