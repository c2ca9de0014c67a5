//! Directions along obstacles, from their triangles.

use crate::{Placement, RigidBody};
use mp_cspace::{Rng, obstacles::ObstacleHints};
use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use rand::RngExt;

impl<P: Placement> RigidBody<P> {
    /// The first obstacle touched at `q`, and the triangle of it that is touched.
    pub(crate) fn hit(&mut self, q: &P::State) -> Option<(usize, usize)> {
        let (pose, shared) = (P::pose(q), &*self.shared);
        shared.obstacles.placed.iter().enumerate().find_map(|(obstacle, (id, _))| {
            let body = shared.obstacles.scene.body(*id)?;
            let (_, triangle) =
                self.query.intersecting_triangles(&shared.robot, &pose, body.mesh(), body.pose())?;
            Some((obstacle, triangle))
        })
    }

    /// A triangle (world) of the first obstacle touched at `q`.
    fn hit_triangle(&mut self, q: &P::State) -> Option<[Point3<f64>; 3]> {
        let (obstacle, triangle) = self.hit(q)?;
        Some(self.shared.obstacles.placed[obstacle].1.triangle(triangle))
    }

    /// A random triangle (world) of a random obstacle. Each obstacle is equally likely.
    fn any_triangle(&self, rng: &mut Rng) -> Option<[Point3<f64>; 3]> {
        let placed = &self.shared.obstacles.placed;
        if placed.is_empty() {
            return None;
        }
        let (_, mesh) = &placed[rng.random_range(0..placed.len())];
        let triangles = mesh.triangles().len();
        (triangles > 0).then(|| mesh.triangle(rng.random_range(0..triangles)))
    }
}

/// A random unit vector along the triangle: the direction of one of its edges, either way. For a robot that stays in the
/// plane: of the line in which the triangle cuts the plane.
fn along<P: Placement>([a, b, c]: [Point3<f64>; 3], rng: &mut Rng) -> Option<Vector3<f64>> {
    let edges = [b - a, c - b, a - c];
    let first = rng.random_range(0..3_usize);
    let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    let unit = |v: Vector3<f64>| Unit::try_new(v, 0.0).map(Unit::into_inner).filter(|v| v.norm() > 0.5);
    let mut edges = (0..3).filter_map(|i| unit(edges[(first + i) % 3]));
    let edge = if P::MOVES.contains(&2) {
        edges.next()
    } else {
        let normal = unit((b - a).cross(&(c - a)));
        let cut = normal.and_then(|n| unit(n.cross(&Vector3::z())));
        cut.or_else(|| edges.find(|v| v.z == 0.0))
    };
    edge.map(|v| v * sign)
}

/// From the triangles of the obstacles: along the triangle that the robot touches.
impl<P: Placement> ObstacleHints<P::State> for RigidBody<P> {
    fn touches(&mut self, q: &P::State) -> bool {
        !mp_cspace::Validity::is_valid(self, q)
    }

    /// Moves in the direction of an edge of the triangle hit, or of any triangle, either way; in the plane, of the line
    /// in which the triangle cuts the plane. `None` for a point inside a solid: it touches no triangle.
    fn slide_along(
        &mut self,
        from: &P::State,
        toward: &P::State,
        hit: Option<&P::State>,
        rng: &mut Rng,
    ) -> Option<P::State> {
        let pose = P::pose(from);
        let far = (P::pose(toward).translation.vector - pose.translation.vector).norm();
        let triangle = match hit {
            Some(q) => self.hit_triangle(q)?,
            None => self.any_triangle(rng)?,
        };
        let translation = Translation3::from(pose.translation.vector + along::<P>(triangle, rng)? * far);
        Some(P::configuration(&Isometry3::from_parts(translation, pose.rotation)))
    }

    /// Rotates in the world frame, by the rotation that leads from `from` to `to`.
    fn moved_by(&self, q: &P::State, from: &P::State, to: &P::State) -> P::State {
        let [q, from, to] = [q, from, to].map(P::pose);
        let shift = to.translation.vector - from.translation.vector;
        let turned = to.rotation * from.rotation.inverse() * q.rotation;
        P::configuration(&Isometry3::from_parts(
            Translation3::from(q.translation.vector + shift),
            UnitQuaternion::new_normalize(turned.into_inner()),
        ))
    }
}
