//! Rigid bodies: what is their own in `plan`.

use super::Options;
use super::measured::Measured;
use super::metrics;
use super::mover::Mover;
use super::progress::Line;
use super::search::{Run, Search};
use super::setting::Setting;
use super::task::{ROOM, Task};
use super::tuples;
use crate::render;
use miette::{IntoDiagnostic, Result};
use mp::cspace::{Cancel, Clearance, DefaultNn, MotionBound, MotionValidity, Path, Space};
use mp::io::PathFile;

impl<M: Mover> Task for Setting<M> {
    type Space = M::Space;
    type File = PathFile;

    fn name(&self) -> &str {
        &self.problem.name
    }
    fn kind(&self) -> String {
        self.problem.space.to_string()
    }
    fn space(&self) -> &M::Space {
        &self.space
    }
    fn search(
        &self,
        options: &Options,
        seed: u64,
        cancel: &Cancel,
        line: &mut Line,
    ) -> Result<Search<M::State>> {
        let space = &self.space;
        let run = Run {
            space,
            robot: &self.robot,
            verifier: Self::verifier(self)?,
            start: &self.start,
            goals: vec![self.goal.clone()],
            fingerprint: options.roadmap.as_ref().map(|_| self.fingerprint(&options.metric_name)),
            tolerance: self.tolerance,
            options,
            seed,
            cancel,
        };
        if options.metric == metrics::Kind::Default {
            return run.on(space, <M::Space as DefaultNn>::Nn::default(), line);
        }
        let scaled = || M::scaled(space, self.radius);
        let displacement = || M::displacement(&self.problem.robot.mesh);
        let swept = || M::swept(&self.problem.robot.mesh);
        let measured = Measured::<M>::new(space, options.metric, scaled, displacement, swept)?;
        run.on(&measured, measured.index(), line)
    }
    fn robot(&self) -> impl Clearance<M::State> + MotionBound<M::State> + Clone {
        self.robot.clone()
    }
    fn verifier(&self) -> Result<impl MotionValidity<M::State>> {
        Self::verifier(self)
    }
    fn room(&self) -> f64 {
        ROOM * self.tolerance
    }
    fn accuracy(&self) -> f64 {
        self.tolerance
    }
    fn to_file(&self, path: &Path<M::State>) -> PathFile {
        let states = &path.states;
        let at = |i: usize, t: f64| match states.get(i + 1) {
            Some(next) => M::pose(&self.space.interpolate(&states[i], next, t)),
            None => M::pose(&states[i]),
        };
        PathFile { configurations: tuples::along(states.len().saturating_sub(1), self.radius, at) }
    }
    fn states_of(&self, file: &PathFile) -> Result<Vec<M::State>> {
        Ok(file.poses().iter().map(M::configuration).collect())
    }
    fn draw(&self, to: &std::path::Path, file: &PathFile, caption: String) -> Result<()> {
        let scene = render::rigid(&self.problem, &file.poses(), caption);
        render::write(to, &scene.draw(render::SIZE).into_diagnostic()?)
    }
}
