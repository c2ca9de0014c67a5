//! Motions of several parts, between which things are attached to links and put down again.

use super::named::{NamedValues, resolve};
use super::{ArmScene, what};
use crate::{Error, Interrupt};
use mp_io::{PartChange, RobotFilePart};
use mp_robot::Arm;

impl ArmScene {
    /// How many parts of the motion come after this one.
    #[must_use]
    pub fn parts_left(&self) -> usize {
        self.source.as_ref().map_or(0, |problem| problem.file.parts.len())
    }

    /// The scene of the next part of the motion, when this one has ended at the row `end`; `None` when this is the last part.
    ///
    /// # Errors
    /// When `end` is no configuration of the robot, what is attached or detached is not there, a goal cannot be one, or the work was
    /// interrupted: with the line of the file.
    pub fn next_part(&self, end: &[f64], interrupt: &Interrupt) -> Result<Option<Self>, Error> {
        let Some(problem) = &self.source else { return Ok(None) };
        let wrong = |[message, help]: [String; 2]| problem.file.fault(RobotFilePart::Next, &message, &help);
        let kinematics = self.arm.kinematics();
        let poses = kinematics.link_poses(end).ok_or_else(|| {
            Error::new(format!("the end of part {} is no configuration of {}", problem.file.part, self.name))
        })?;
        let pose = |link: &str| Some(poses[kinematics.links().position(|name| name == link)?]);
        let Some(mut next) = problem.next_part(end, pose).map_err(wrong)? else { return Ok(None) };
        let model = self.arm.model().clone();
        let model = match problem.file.parts.first().and_then(|part| part.change.as_ref()) {
            None => model,
            Some(PartChange::Detach(name)) => model.detached(name),
            Some(PartChange::Attach { link, may_touch, .. }) => {
                let Some(body) = next.attached.last() else { return Ok(None) };
                let attached = model.attached(&body.name, &body.mesh, link, &body.pose, may_touch);
                attached.map_err(|e| wrong([e.to_string(), "name links as the URDF does".to_owned()]))?
            }
        };
        let bodies = next.obstacles.iter().map(|o| (o.name.clone(), o.mesh.clone(), o.pose));
        let arm =
            Arm::new_until(&model, bodies, interrupt).map_err(|e| Error::from(e).context(what(problem)))?;
        let named = NamedValues::of(&next)?;
        let of_ends = resolve(&mut next, &named, arm.kinematics(), arm.model())?;
        // Pairs are looked at again, and what is found is said again.
        let said = self.said.iter().filter(|note| model.notes.contains(note)).cloned();
        let said = said.chain(arm.not_compared().iter().cloned()).collect();
        Self::with_ends_of(next, arm, [said, of_ends], self.held.clone(), interrupt).map(Some)
    }
}
