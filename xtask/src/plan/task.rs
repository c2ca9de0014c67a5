//! What `plan` plans for, and what becomes of the path.

use super::Options;
use super::progress::Line;
use super::search::Search;
use miette::{IntoDiagnostic, Result};
use mp::cspace::shorten::{Effort, simplify};
use mp::cspace::{
    Cancel, Certified, Clearance, Factored, KnownFree, MotionBound, MotionCheck, MotionValidity, Path, Rng,
    Space, least_clearance, verify_path,
};
use mp::io::{JointPath, PathFile};
use std::sync::atomic::Ordering;

/// Which stream of random numbers shortening draws from: planning draws from another.
const STREAM: u64 = 1;

/// Shortcuts keep this many tolerances away from obstacles, where planning may go as near as one: a path that
/// grazes every corner is of no use to anybody.
pub(crate) const ROOM: f64 = 20.0;

/// A configuration of a task.
pub(crate) type State<T> = <<T as Task>::Space as Space>::State;

/// A scene made ready to plan on: of a rigid body, an arm or a robot of the plane.
pub(crate) trait Task {
    type Space: Factored<State: Clone + PartialEq>;
    /// How its paths are written.
    type File: Written;

    fn name(&self) -> &str;
    /// What reports call the space.
    fn kind(&self) -> String;
    fn space(&self) -> &Self::Space;
    /// Plans from start to goal with `seed`.
    fn search(
        &self,
        options: &Options,
        seed: u64,
        cancel: &Cancel,
        line: &mut Line,
    ) -> Result<Search<State<Self>>>;
    fn robot(&self) -> impl Clearance<State<Self>> + MotionBound<State<Self>> + Clone;
    /// The independent checker.
    fn verifier(&self) -> Result<impl MotionValidity<State<Self>>>;
    /// The clearance that shortcuts keep, metres.
    fn room(&self) -> f64;
    /// How well clearance is told, metres.
    fn accuracy(&self) -> f64;
    fn to_file(&self, path: &Path<State<Self>>) -> Self::File;
    fn states_of(&self, file: &Self::File) -> Result<Vec<State<Self>>>;
    /// Draws the path, to the file `to`.
    fn draw(&self, to: &std::path::Path, file: &Self::File, caption: String) -> Result<()>;
}

/// A path as files hold it.
pub(crate) trait Written: Sized {
    fn parse(text: &str) -> Result<Self>;
    fn text(&self) -> String;
    fn json(&self) -> String;
    fn rows(&self) -> Vec<Vec<f64>>;
}

impl Written for PathFile {
    fn parse(text: &str) -> Result<Self> {
        Ok(Self::parse("the path", text.as_bytes())?)
    }
    fn text(&self) -> String {
        self.to_text()
    }
    fn json(&self) -> String {
        self.to_json()
    }
    fn rows(&self) -> Vec<Vec<f64>> {
        self.configurations.iter().map(|c| c.to_vec()).collect()
    }
}

impl Written for JointPath {
    fn parse(text: &str) -> Result<Self> {
        Ok(Self::parse("the path", text.as_bytes())?)
    }
    fn text(&self) -> String {
        self.to_text()
    }
    fn json(&self) -> String {
        self.to_json()
    }
    fn rows(&self) -> Vec<Vec<f64>> {
        self.configurations.clone()
    }
}

/// A path that the verifier passed as it will be read.
#[derive(Clone, Debug)]
pub(super) struct Finished<F> {
    pub(super) file: F,
    /// In the metric of the space.
    pub(super) length: f64,
    /// A lower bound all along, metres.
    pub(super) clearance: f64,
    pub(super) shortened: bool,
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
pub(super) fn finish<T: Task>(
    task: &T,
    found: &Path<State<T>>,
    shorten: bool,
    seed: u64,
    cancel: &Cancel,
) -> Result<Option<Finished<T::File>>> {
    if shorten {
        let certified = Certified::new(task.space(), task.robot(), task.room()).into_diagnostic()?;
        let mut rng = Rng::stream(seed, STREAM);
        let short = simplify(task.space(), &mut Until(certified, cancel), found, Effort::default(), &mut rng);
        if let Some(finished) = written(task, &short, true)? {
            return Ok(Some(finished));
        }
        tracing::info!("the shortened path does not pass the verifier: the path as found is written");
    }
    written(task, found, false)
}

/// `path` as it reads back from its text, if the verifier passes that.
fn written<T: Task>(task: &T, path: &Path<State<T>>, shortened: bool) -> Result<Option<Finished<T::File>>> {
    let file = T::File::parse(&task.to_file(path).text())?;
    let read = Path::straight(task.states_of(&file)?);
    let report = verify_path(task.space(), &read, &mut task.verifier()?);
    if let Some(fault) = report.fault {
        tracing::info!("{fault}");
        return Ok(None);
    }
    let tightest = least_clearance(task.space(), &mut task.robot(), &read, task.accuracy());
    let clearance = tightest.map_or(report.clearance, |t| t.clearance.max(report.clearance));
    Ok(Some(Finished { file, length: path.length(task.space()), clearance, shortened }))
}
