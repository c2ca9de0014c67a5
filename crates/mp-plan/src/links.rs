//! What only scenes of arms are asked for.

use crate::{ArmScene, Error, Reached, Scene};
use mp_cspace::Interrupt;
use mp_io::PoseEntry;
use mp_kinds::Constrained;
use nalgebra::Isometry3;
use std::sync::Arc;

impl Scene {
    /// Configurations that place a link of an arm, the free ones first: see [`ArmScene::reaching`].
    ///
    /// # Errors
    /// As there, and when the robot is no arm whose base stands still.
    pub fn reaching(
        &self,
        place: &PoseEntry,
        most: usize,
        interrupt: &Interrupt,
    ) -> Result<Vec<Reached>, Error> {
        let arm = self.robot::<ArmScene>().ok_or_else(|| {
            Error::new(format!("{} is no arm whose base stands still", self.name()))
                .help("only such have links to be placed; one that moves by inputs, or among obstacles that move, is none here")
        })?;
        arm.reaching(place, most, interrupt)
    }

    /// How many parts of the motion come after this one: zero, but for arms whose problem says so.
    #[must_use]
    pub fn parts_left(&self) -> usize {
        match self.robot::<Constrained>() {
            Some(under) => self.clone().of_robot(Arc::clone(under.robot())).parts_left(),
            None => self.robot::<ArmScene>().map_or(0, ArmScene::parts_left),
        }
    }

    /// The scene of the next part of the motion: see [`ArmScene::next_part`].
    ///
    /// # Errors
    /// As there.
    pub fn next_part(&self, end: &[f64], interrupt: &Interrupt) -> Result<Option<Self>, Error> {
        if let Some(under) = self.robot::<Constrained>() {
            let next = self.clone().of_robot(Arc::clone(under.robot())).next_part(end, interrupt)?;
            return Ok(next.map(|next| {
                let robot = under.around(Arc::clone(&next.robot));
                next.of_robot(robot).with_free_places()
            }));
        }
        let Some(arm) = self.robot::<ArmScene>() else { return Ok(None) };
        let Some(next) = arm.next_part(end, interrupt)? else { return Ok(None) };
        let (notes, kept) = (next.said(), self.clearance_kept());
        let scene = self.clone().with_notes(notes).of_robot(mp_kinds::build::shared_arm(next));
        if kept > 0.0 { scene.keeping(kept) } else { Ok(scene) }.map(Some)
    }

    /// Whether the robot is an arm whose base stands still: its bodies can be [placed](Self::reaching_from).
    #[must_use]
    pub fn has_links(&self) -> bool {
        self.robot::<ArmScene>().is_some()
    }

    /// Inverse kinematics from one seed, for drags: the configuration near `from` in which a body of an arm has the pose `pose` in the
    /// world (metres). Where that is out of reach, only the body's origin is there, turned in any way. `body` is its index in
    /// [`bodies`](Self::bodies). `None` when neither is reached, no joint moves the body, or the robot is no arm whose base stands still. The
    /// configuration is within the limits of the joints, and may be in collision.
    ///
    /// # Errors
    /// When `from` does not have as many numbers as the robot's configurations.
    pub fn reaching_from(
        &self,
        body: usize,
        pose: &Isometry3<f64>,
        from: &[f64],
    ) -> Result<Option<Vec<f64>>, Error> {
        let from = self.state(from)?;
        let reached = self.robot::<ArmScene>().and_then(|arm| arm.reaching_from(body, pose, &from));
        Ok(reached.map(|q| self.robot.row(&q)))
    }
}
