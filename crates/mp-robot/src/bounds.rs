//! Where a robot may be when nobody says.

use crate::{Placement, RigidBody};
use mp_geom::Aabb;
use nalgebra::Point3;

impl<P: Placement> RigidBody<P> {
    /// Bounds for the origin of the robot's frame when a problem gives none: the box around the obstacles
    /// and the given configurations (start and goals), enlarged on every side by the robot's diameter about
    /// that origin, so that it can go around everything. For a point, and whenever that is more, enlarged by
    /// a tenth of the box's diagonal; by 1 m when that is nothing. In the plane only x and y matter.
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
