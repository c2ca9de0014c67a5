//! Default bounds for the position of a rigid body.

use crate::{Placement, RigidBody};
use mp_geom::Aabb;
use nalgebra::Point3;

impl<P: Placement> RigidBody<P> {
    /// Bounds for the origin of the robot's frame, for problems that give none.
    ///
    /// The box around the obstacles and the given configurations (start and goals) is enlarged on every side by twice
    /// the robot's radius about that origin, so that the robot can go around everything, or by a tenth of the box's
    /// diagonal if that is more; by 1 m if both are zero. In the plane only x and y matter.
    #[must_use]
    pub fn default_bounds<'a>(&self, configurations: impl IntoIterator<Item = &'a P::State>) -> Aabb
    where
        P::State: 'a,
    {
        let places: Vec<_> =
            configurations.into_iter().map(|q| Point3::from(P::pose(q).translation.vector)).collect();
        let mut inner = self.obstacle_bounds().union(&Aabb::of_points(&places));
        if inner.is_empty() {
            inner = Aabb::new(Point3::origin(), Point3::origin());
        }
        let margin = (2.0 * self.radius()).max(0.1 * inner.diagonal());
        inner.enlarged(if margin > 0.0 { margin } else { 1.0 })
    }
}
