//! Which links of a robot may touch, found by sampling, and the SRDF that says so.

use super::inputs::Recording;
use super::without_problem::robot_alone;
use crate::{Error, Interrupt, SceneFiles};
use mp_io::{Content, Disk, Files, RobotProblem, Until, robot_name};
use mp_kinds::model_of;
use mp_robot::SampledPairs;
use std::path::{Path, PathBuf};

/// The pairs of links of the robot in a file, from [`sampled`](Self::sampled).
#[derive(Clone, Debug, PartialEq)]
pub struct RobotPairs {
    /// The name of the robot in its file.
    pub robot: String,
    /// How often links touch.
    pub pairs: SampledPairs,
    /// The files that the robot was read from, which an output must not overwrite. SRDFs are none of them.
    pub inputs: Vec<PathBuf>,
}

impl RobotPairs {
    /// Looks at the robot in `file`, a URDF or a robot problem, whose limits of joints count: see
    /// [`ArmModel::sampled_pairs`](mp_robot::ArmModel::sampled_pairs). What an SRDF says is left aside.
    ///
    /// # Errors
    /// When the file cannot be read or describes no robot with joints, and when it was interrupted.
    pub fn sampled(file: &Path, interrupt: &Interrupt) -> Result<Self, Error> {
        let file = &SceneFiles::find(Path::new(""), file)?.file;
        let disk = Recording::new(&Disk);
        let files = Until { files: &disk, interrupt: interrupt.clone() };
        let problem = match Content::of(file).any(|content| content == Content::Toml) {
            true => RobotProblem::load_from(&files, file)?,
            false => robot_alone(&files, file)?,
        };
        let model = model_of(&files as &dyn Files, &problem)?;
        let pairs = model.sampled_pairs(interrupt);
        let pairs = pairs.map_err(|e| Error::new(e.to_string()).context(file.display().to_string()))?;
        let mut inputs = disk.read.into_inner().unwrap_or_default();
        inputs.retain(|input| input == file || input.extension().is_none_or(|ending| ending != "srdf"));
        Ok(Self {
            inputs,
            robot: problem.robots.first().and_then(|robot| robot_name(&robot.urdf)).unwrap_or(problem.name),
            pairs,
        })
    }

    /// The SRDF: see [`SampledPairs::srdf`].
    #[must_use]
    pub fn srdf(&self, never: bool) -> String {
        self.pairs.srdf(&self.robot, never)
    }
}
