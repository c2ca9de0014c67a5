//! Bases that move in the plane, as those on wheels that can go in any direction.

use super::{ArmError, ArmModel, Joint, JointKind, Link};
use nalgebra::Vector3;

/// The names of the numbers that a base in the plane adds to a configuration: metres along X and Y, and the angle (rad) about Z.
pub const PLANAR_NUMBERS: [&str; 3] = ["x", "y", "theta"];

impl ArmModel {
    /// The same robot with a base that moves in the plane z = 0 of its [base](Self::base) and turns about Z: by three joints before all
    /// others, called [`PLANAR_NUMBERS`], of which the first two are between `low` and `high` (m).
    ///
    /// # Errors
    /// [`ArmError::BaseName`] when a joint has such a name. A model that is not valid stays so.
    pub fn with_planar_base(mut self, low: [f64; 2], high: [f64; 2]) -> Result<Self, ArmError> {
        let [x, y, theta] = PLANAR_NUMBERS;
        if let Some(joint) = self.joints.iter().find(|joint| PLANAR_NUMBERS.contains(&joint.name.as_str())) {
            return Err(ArmError::BaseName { joint: joint.name.clone(), taken: PLANAR_NUMBERS.join(", ") });
        }
        let is_child = |link: &Link| self.joints.iter().any(|joint| joint.child == link.name);
        let Some(root) = self.links.iter().find(|link| !is_child(link)).map(|link| link.name.clone()) else {
            return Ok(self);
        };
        let names = ["plane", "along x", "along y"].map(|name| self.unused(name));
        let [plane, along_x, along_y] = &names;
        let along = |i: usize| JointKind::Prismatic { low: low[i], high: high[i] };
        let joints = [
            Joint::new(x, plane, along_x, along(0)),
            Joint::new(y, along_x, along_y, along(1)).axis(Vector3::y()),
            Joint::new(theta, along_y, root, JointKind::Continuous).axis(Vector3::z()),
        ];
        self.joints.splice(0..0, joints);
        self.links.splice(0..0, names.map(Link::new));
        Ok(self)
    }

    /// Whether the first joints are those of a [base in the plane](Self::with_planar_base).
    pub(super) fn has_planar_base(&self) -> bool {
        self.joints.len() >= PLANAR_NUMBERS.len()
            && self.joints.iter().zip(PLANAR_NUMBERS).all(|(joint, name)| joint.name == name)
    }

    /// A name that no link has: `name`, with lines after it where it is taken.
    fn unused(&self, name: &str) -> String {
        let mut name = name.to_owned();
        while self.links.iter().any(|link| link.name == name) {
            name.push('_');
        }
        name
    }
}
