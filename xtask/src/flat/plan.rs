//! Robots of the plane: what is their own in `plan`.

use super::{FlatMover, Task, draw};
use crate::plan::Options;
use crate::plan::metrics::Kind;
use crate::plan::progress::Line;
use crate::plan::search::{Run, Search};
use crate::plan::task;
use miette::{Result, miette};
use mp::cspace::{Cancel, Clearance, DefaultNn, MotionBound, MotionValidity, Path};
use mp::io::JointPath;

/// Shortcuts keep this share of the robot's radius away from obstacles: a path that grazes every corner is of no
/// use to anybody.
const ROOM: f64 = 0.002;

impl<M: FlatMover> task::Task for Task<M> {
    type Space = M::Space;
    type File = JointPath;

    fn name(&self) -> &str {
        &self.problem.name
    }
    fn kind(&self) -> String {
        M::SPACE.to_owned()
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
        if options.metric != Kind::Default {
            return Err(miette!(
                help = "leave --metric out",
                "worlds in the plane have the metric of their space only, not `{}`",
                options.metric_name
            ));
        }
        if options.roadmap.is_some() {
            return Err(miette!(help = "leave --roadmap out", "roadmaps are kept of rigid bodies only"));
        }
        let run = Run {
            space: &self.space,
            robot: &self.robot,
            verifier: self.robot.verifier(&self.space),
            start: &self.start,
            goals: self.goals.clone(),
            fingerprint: None,
            tolerance: self.tolerance,
            options,
            seed,
            cancel,
        };
        run.on(&self.space, <M::Space as DefaultNn>::Nn::default(), line)
    }
    fn robot(&self) -> impl Clearance<M::State> + MotionBound<M::State> + Clone {
        self.robot.clone()
    }
    fn verifier(&self) -> Result<impl MotionValidity<M::State>> {
        Ok(self.robot.verifier(&self.space))
    }
    fn room(&self) -> f64 {
        (ROOM * self.robot.radius()).max(self.tolerance)
    }
    fn accuracy(&self) -> f64 {
        self.tolerance.max(1e-4 * self.robot.radius())
    }
    fn to_file(&self, path: &Path<M::State>) -> JointPath {
        JointPath { configurations: path.states.iter().map(M::row).collect() }
    }
    fn states_of(&self, file: &JointPath) -> Result<Vec<M::State>> {
        self.path(file)
    }
    fn draw(&self, to: &std::path::Path, file: &JointPath, caption: String) -> Result<()> {
        draw(to, self, Some(file), caption, None)
    }
}
