//! Arms: what is their own in `plan`.

use super::picture::scene;
use super::task::{State, Task};
use crate::plan::Options;
use crate::plan::metrics::Kind;
use crate::plan::progress::Line;
use crate::plan::search::{Run, Search, with};
use crate::plan::task::{self, ROOM};
use crate::render;
use miette::{IntoDiagnostic, Result, miette};
use mp::cspace::{Cancel, Clearance, Joints, KdTree, Manhattan, MotionBound, MotionValidity, Path};
use mp::io::JointPath;

impl task::Task for Task {
    type Space = Joints<State>;
    type File = JointPath;

    fn name(&self) -> &str {
        Self::name(self)
    }
    fn kind(&self) -> String {
        format!("{} joints", self.arm.dof())
    }
    fn space(&self) -> &Joints<State> {
        &self.space
    }
    fn search(
        &self,
        options: &Options,
        seed: u64,
        cancel: &Cancel,
        line: &mut Line,
    ) -> Result<Search<State>> {
        let space = &self.space;
        if options.roadmap.is_some() {
            return Err(miette!(help = "leave --roadmap out", "roadmaps are kept of rigid bodies only"));
        }
        let run = Run {
            space,
            robot: &self.arm,
            verifier: Self::verifier(self)?,
            start: &self.start,
            goals: self.goals.clone(),
            fingerprint: None,
            tolerance: self.tolerance,
            options,
            seed,
            cancel,
        };
        match options.metric {
            // The metric of the space is the Euclidean one.
            Kind::Default | Kind::Euclidean => run.on(space, <KdTree>::default(), line),
            Kind::Manhattan => run.on(&with(space, Manhattan), <KdTree>::default(), line),
            Kind::Scaled | Kind::MaxDisplacement | Kind::SweptVolume => Err(miette!(
                help = "arms have --metric default, euclidean or manhattan",
                "the metric `{}` is one of rigid bodies",
                options.metric_name
            )),
        }
    }
    fn robot(&self) -> impl Clearance<State> + MotionBound<State> + Clone {
        self.arm.clone()
    }
    fn verifier(&self) -> Result<impl MotionValidity<State>> {
        Self::verifier(self)
    }
    fn room(&self) -> f64 {
        ROOM * self.tolerance
    }
    fn accuracy(&self) -> f64 {
        self.tolerance
    }
    fn to_file(&self, path: &Path<State>) -> JointPath {
        JointPath { configurations: path.states.iter().map(|q| q.as_slice().to_vec()).collect() }
    }
    fn states_of(&self, file: &JointPath) -> Result<Vec<State>> {
        Ok(self.states(file))
    }
    fn draw(&self, to: &std::path::Path, file: &JointPath, caption: String) -> Result<()> {
        let scene = scene(self, &self.states(file), caption);
        render::write(to, &scene.draw(render::SIZE).into_diagnostic()?)
    }
}
