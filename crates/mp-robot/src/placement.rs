//! Where configurations place a rigid body, and how far motions move it.

use mp_cspace::{
    Se2State,
    angle::{angle_difference, rotation_angle},
};
use mp_geom::{TriMesh, six_from_pose};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use std::fmt::Debug;

/// The radii and corners of a body, from which its travel is bounded. Metres, in the frame of the body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyRadii {
    /// The largest distance of a point of the body from the origin.
    pub radius: f64,
    /// The largest distance of a point of the body from the Z axis.
    pub radius_about_z: f64,
    /// The corners of a box around the body.
    pub corners: [Point3<f64>; 8],
}

impl BodyRadii {
    /// The radii of `mesh` about the origin of its frame.
    #[must_use]
    pub fn of(mesh: &TriMesh) -> Self {
        let from_z = mesh.vertices().iter().map(|p| mp_math::hypot(p.x, p.y)).fold(0.0, f64::max);
        Self {
            radius: mesh.radius_about(&Point3::origin()),
            radius_about_z: from_z,
            corners: mesh.obb().corners(),
        }
    }

    /// The size of the body (m): the largest distance of a point from the origin or, where that is less, the diagonal of the box around
    /// it, as of a body far from its origin.
    pub(crate) fn size(&self) -> f64 {
        let diagonal = self.corners.iter().map(|c| (c - self.corners[0]).norm()).fold(0.0, f64::max);
        self.radius.min(diagonal)
    }

    /// An upper bound on the distance of a point of the body from the line through the origin along the
    /// unit vector `axis`.
    #[must_use]
    pub fn radius_about(&self, axis: &Vector3<f64>) -> f64 {
        // The distance from a line is convex: over a box it is largest at a corner.
        let square = self.corners.iter().map(|c| c.coords.cross(axis).norm_squared()).fold(0.0, f64::max);
        square.sqrt().min(self.radius)
    }
}

/// How a kind of configuration places a rigid body in the world.
pub trait Placement: Copy + Debug + Default + Send + Sync + 'static {
    /// A configuration.
    type State: Clone + Debug + Send + Sync;

    /// The pose of the body in the world.
    fn pose(q: &Self::State) -> Isometry3<f64>;

    /// The configuration nearest to a pose: movements that the robot cannot make are left out.
    fn configuration(pose: &Isometry3<f64>) -> Self::State;

    /// An upper bound (m) on the length of the path of any point of a body with these radii, from `from` to `to` along
    /// the interpolation of the space: translation on a straight line, rotation about a fixed axis by the
    /// shorter way, both at constant speed.
    fn travel(radii: &BodyRadii, from: &Self::State, to: &Self::State) -> f64;

    /// The world axes along which the body can move.
    const MOVES: &'static [usize];
    /// The world axes about which the body can turn.
    const TURNS: &'static [usize];
}

/// Bounds are enlarged by this factor against rounding.
const ROUND_UP: f64 = 1.0 + 1e-12;

/// Any position and rotation in space: SE(3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spatial;

impl Placement for Spatial {
    type State = Isometry3<f64>;

    #[inline]
    fn pose(q: &Isometry3<f64>) -> Isometry3<f64> {
        *q
    }
    #[inline]
    fn configuration(pose: &Isometry3<f64>) -> Isometry3<f64> {
        *pose
    }

    /// At any moment a point at distance `d` from the axis through the origin moves with the velocity `v` of
    /// the origin plus `θ·d` across the axis; with `v` split along and across the axis,
    /// `√(v∥² + (v⊥ + θ·d)²)` bounds its speed. With `d` at most the radius this is at most the customary
    /// `‖Δp‖ + radius·θ`.
    fn travel(radii: &BodyRadii, from: &Isometry3<f64>, to: &Isometry3<f64>) -> f64 {
        let velocity = to.translation.vector - from.translation.vector;
        let angle = rotation_angle(&from.rotation, &to.rotation);
        // Along the axis of the turn, in the frame of the body; its length is the sine of half the angle.
        let turn = (from.rotation.inverse() * to.rotation).imag();
        let sine = turn.norm();
        if sine < 1e-6 {
            return (velocity.norm() + radii.radius * angle) * ROUND_UP;
        }
        let axis = turn / sine;
        // The direction of the axis is known to 1e-16/sine rad. The lever is enlarged by the error this causes.
        let lever = radii.radius_about(&axis) + radii.radius * 1e-9;
        let along = velocity.dot(&(from.rotation * axis));
        let across = (velocity.norm_squared() - along * along).max(0.0).sqrt() + velocity.norm() * 1e-9;
        mp_math::hypot(along, across + lever * angle) * ROUND_UP
    }

    const MOVES: &'static [usize] = &[0, 1, 2];
    const TURNS: &'static [usize] = &[0, 1, 2];
}

/// Positions in the plane z = 0, rotated about Z: SE(2), for planar problems of 3D meshes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Planar;

impl Placement for Planar {
    type State = Se2State;

    #[inline]
    fn pose(q: &Se2State) -> Isometry3<f64> {
        q.to_isometry3(0.0)
    }
    #[inline]
    fn configuration(pose: &Isometry3<f64>) -> Se2State {
        let [x, y, _, yaw, _, _] = six_from_pose(pose);
        Se2State::new(x, y, yaw)
    }
    #[inline]
    fn travel(radii: &BodyRadii, from: &Se2State, to: &Se2State) -> f64 {
        let angle = angle_difference(from.angle, to.angle).abs();
        ((to.translation - from.translation).norm() + radii.radius_about_z * angle) * ROUND_UP
    }

    const MOVES: &'static [usize] = &[0, 1];
    const TURNS: &'static [usize] = &[2];
}

/// Any position in space, never rotated: R³.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Point;

impl Placement for Point {
    type State = Vector3<f64>;

    #[inline]
    fn pose(q: &Vector3<f64>) -> Isometry3<f64> {
        Isometry3::from_parts(Translation3::from(*q), UnitQuaternion::identity())
    }
    #[inline]
    fn configuration(pose: &Isometry3<f64>) -> Vector3<f64> {
        pose.translation.vector
    }
    #[inline]
    fn travel(_: &BodyRadii, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
        (to - from).norm() * ROUND_UP
    }

    const MOVES: &'static [usize] = &[0, 1, 2];
    const TURNS: &'static [usize] = &[];
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_cspace::{Rn, Se2, Se3, Space};
    use mp_geom::pose_from_six;
    use proptest::prelude::*;

    const STEPS: usize = 60;

    /// Compares the bound with the polygonal paths of all vertices, over the whole motion and over its parts. Other points
    /// lie between vertices, and are slower than the fastest vertex.
    fn check<P: Placement, C: Space<State = P::State>>(
        space: &C,
        (mesh, radii): (&TriMesh, &BodyRadii),
        from: &P::State,
        to: &P::State,
    ) -> Result<f64, TestCaseError> {
        let bound = P::travel(radii, from, to);
        let poses: Vec<_> =
            (0..=STEPS).map(|i| P::pose(&space.interpolate(from, to, i as f64 / STEPS as f64))).collect();
        let mut longest = 0.0_f64;
        for p in mesh.vertices() {
            let steps: Vec<f64> = poses.windows(2).map(|w| (w[0] * p - w[1] * p).norm()).collect();
            longest = longest.max(steps.iter().sum());
            // Constant speed: no part is faster than its share.
            let fastest = steps.iter().copied().fold(0.0, f64::max) * STEPS as f64;
            prop_assert!(fastest <= bound + 1e-9, "{} {}", fastest, bound);
        }
        prop_assert!(longest <= bound + 1e-12, "{} {}", longest, bound);
        Ok(longest / bound.max(1e-300))
    }

    fn mesh() -> impl Strategy<Value = TriMesh> {
        prop::collection::vec(prop::array::uniform3(-2.0..2.0_f64), 3..10).prop_map(|v| {
            let n = v.len() as u32;
            let triangles = (0..n - 2).map(|i| [i, i + 1, i + 2]).collect();
            TriMesh::new(v.into_iter().map(Point3::from).collect(), triangles).unwrap()
        })
    }

    fn pose() -> impl Strategy<Value = Isometry3<f64>> {
        prop::array::uniform6(-3.1..3.1_f64).prop_map(pose_from_six)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100))]
        #[test]
        fn no_point_travels_farther_in_space(mesh in mesh(), a in pose(), b in pose(), small in -9.0..0.0_f64) {
            let space = Se3::new([-5.0; 3], [5.0; 3]).unwrap();
            let radii = BodyRadii::of(&mesh);
            check::<Spatial, _>(&space, (&mesh, &radii), &a, &b)?;
            let near = a.lerp_slerp(&b, mp_math::powf(10.0, small));
            check::<Spatial, _>(&space, (&mesh, &radii), &a, &near)?;
            let customary = |p: &Isometry3<f64>, q: &Isometry3<f64>| {
                (p.translation.vector - q.translation.vector).norm()
                    + radii.radius * rotation_angle(&p.rotation, &q.rotation)
            };
            prop_assert!(Spatial::travel(&radii, &a, &b) <= customary(&a, &b) * (1.0 + 1e-8));
        }

        #[test]
        fn no_point_travels_farther_in_the_plane(mesh in mesh(), a in prop::array::uniform3(-3.1..3.1_f64), b in prop::array::uniform3(-3.1..3.1_f64)) {
            let space = Se2::new([-5.0; 2], [5.0; 2]).unwrap();
            let [a, b] = [a, b].map(|[x, y, t]| Se2State::new(x, y, t));
            check::<Planar, _>(&space, (&mesh, &BodyRadii::of(&mesh)), &a, &b)?;
        }

        #[test]
        fn configurations_and_poses_agree(pose in pose(), planar in prop::array::uniform3(-3.1..3.1_f64)) {
            prop_assert_eq!(Spatial::configuration(&Spatial::pose(&pose)), pose);
            let q = Se2State::new(planar[0], planar[1], planar[2]);
            let back = Planar::configuration(&Planar::pose(&q));
            prop_assert!((back.translation - q.translation).norm() < 1e-14 && (back.angle - q.angle).abs() < 1e-14);
            let v = pose.translation.vector;
            prop_assert_eq!(Point::configuration(&Point::pose(&v)), v);
        }
    }

    /// The bound is reached by some motions, and a thin rod that turns about its own axis hardly travels.
    #[test]
    fn the_bound_is_tight() {
        let rod = mp_geom::primitives::cuboid(4.0, 0.02, 0.02).unwrap();
        let radii = BodyRadii::of(&rod);
        let space = Se3::new([-5.0; 3], [5.0; 3]).unwrap();
        let turn = |six| (Isometry3::identity(), pose_from_six(six));
        let (a, b) = turn([0.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
        assert!(check::<Spatial, _>(&space, (&rod, &radii), &a, &b).unwrap() > 0.999);
        let (a, b) = turn([0.0, 0.0, 0.0, 0.0, 0.0, 2.0]);
        assert!(Spatial::travel(&radii, &a, &b) < 0.03);
        let (a, b) = turn([3.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert!((Spatial::travel(&radii, &a, &b) - 3.0).abs() < 1e-11);
        let line = Rn::<3>::new([0.0; 3], [1.0; 3]).unwrap();
        let (a, b) = (Vector3::new(0.0, 0.0, 0.0), Vector3::new(1.0, 0.0, 0.0));
        assert!(check::<Point, _>(&line, (&rod, &radii), &a, &b).unwrap() > 0.999);
    }
}
