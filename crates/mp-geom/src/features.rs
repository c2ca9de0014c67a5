//! Features of a body for obstacle-geometry planners: its place, size, volume and direction.
//!
//! A. Benitez and D. Vallejo, "New technique to improve probabilistic roadmap methods", IBERAMIA 2004, as
//! described in A. Benitez et al., "Key Elements for Motion Planning Algorithms", 2010, section 3.5:
//!
//! - *straightness* is "the direction of an object with respect its longest side": here the longest side of
//!   its tight [oriented box](TriMesh::obb);
//! - *volume* is "the size of an object respect to the volume of its surrounding sphere": here the solid's
//!   volume over that of the sphere;
//! - the surrounding sphere is about the centre of gravity;
//! - where an obstacle "is built by smaller ones" each part has its own features: here parts are connected
//!   components.

use crate::{MassError, MassProperties, Sphere, TriMesh};
use nalgebra::{Isometry3, Point3, Unit, Vector3};
use std::f64::consts::PI;

/// The size, place and direction of a body, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Features {
    /// Centre of gravity of the solid; of the surface, where the mesh bounds no solid.
    pub center: Point3<f64>,
    /// The largest distance of a point of the body from `center`: the radius of the surrounding sphere.
    pub radius: f64,
    /// Straightness: the direction of the longest side of its tight box, with its largest coordinate
    /// positive. Any of several sides of equal length.
    pub axis: Unit<Vector3<f64>>,
    /// Volume of the solid (m³); of the tight box, where the mesh bounds no solid.
    pub volume: f64,
}

impl Features {
    /// The surrounding sphere.
    #[must_use]
    pub fn sphere(&self) -> Sphere {
        Sphere { center: self.center, radius: self.radius }
    }

    /// The volume as a fraction of that of the surrounding sphere, in \[0, 1\]; 1 for a single point. A ball
    /// has 1, a cube 0.37, a rod or a plate nearly 0.
    #[must_use]
    pub fn volume_ratio(&self) -> f64 {
        let sphere = 4.0 / 3.0 * PI * mp_math::powi(self.radius, 3);
        if sphere > 0.0 { (self.volume / sphere).min(1.0) } else { 1.0 }
    }

    /// The features of the body moved by `pose`.
    #[must_use]
    pub fn transformed(&self, pose: &Isometry3<f64>) -> Self {
        Self { center: pose * self.center, axis: upward(pose.rotation * self.axis.into_inner()), ..*self }
    }
}

/// The unit vector along `v` or against it, with its largest coordinate positive.
fn upward(v: Vector3<f64>) -> Unit<Vector3<f64>> {
    let unit = Unit::try_new(v, 0.0).unwrap_or_else(Vector3::x_axis);
    if unit[unit.iamax()] < 0.0 { -unit } else { unit }
}

impl TriMesh {
    /// Centre of gravity, surrounding sphere, straightness and volume. O(n log n), mostly for the box.
    #[must_use]
    pub fn features(&self) -> Features {
        let (obb, mass) = (self.obb(), self.mass_properties());
        let Sphere { center, radius } = self.sphere_about_center_of(mass.as_ref());
        Features {
            center,
            radius,
            axis: upward(obb.axes()[obb.half_extents.imax()]),
            volume: mass.map_or_else(|_| obb.volume(), |mass| mass.volume),
        }
    }

    /// The sphere of the [features](Self::features): around the body, about its centre of gravity. O(n), without the box.
    #[must_use]
    pub fn surrounding_sphere(&self) -> Sphere {
        self.sphere_about_center_of(self.mass_properties().as_ref())
    }

    fn sphere_about_center_of(&self, mass: Result<&MassProperties, &MassError>) -> Sphere {
        let center = match mass {
            Ok(mass) => mass.centroid,
            Err(MassError::NotSolid { .. } | MassError::NoVolume) => self.area_centroid(),
        };
        Sphere { center, radius: self.radius_about(&center) }
    }

    /// The centre of gravity of the surface; of the corners, where it has no area.
    fn area_centroid(&self) -> Point3<f64> {
        let middle = self.aabb().center();
        let (mut sum, mut area) = (Vector3::zeros(), 0.0);
        for i in 0..self.triangles().len() {
            let (part, [a, b, c]) = (self.triangle_area(i), self.triangle(i).map(|p| p - middle));
            sum += (a + b + c) * (part / 3.0);
            area += part;
        }
        if area > 0.0 { middle + sum / area } else { middle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{pose_from_six, primitives::*};
    use proptest::prelude::*;

    fn along(axis: Unit<Vector3<f64>>, expected: Vector3<f64>) -> bool {
        axis.dot(&expected.normalize()).abs() > 1.0 - 1e-9
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn of_a_box_anywhere(x in 0.1..1.0_f64, y in 0.1..1.0_f64, z in 1.1..5.0_f64, six in prop::array::uniform6(-3.0..3.0_f64)) {
            let pose = pose_from_six(six);
            let mesh = cuboid(x, y, z).unwrap();
            let mesh_there = mesh.transformed(&pose);
            let found = mesh_there.features();
            prop_assert_eq!(mesh_there.surrounding_sphere(), found.sphere());
            let radius = 0.5 * Vector3::new(x, y, z).norm();
            prop_assert!((found.center.coords - pose.translation.vector).norm() < 1e-9);
            prop_assert!((found.radius - radius).abs() < 1e-9 && (found.volume - x * y * z).abs() < 1e-9);
            prop_assert!(along(found.axis, pose.rotation * Vector3::z()));
            prop_assert!((found.volume_ratio() - x * y * z / (4.0 / 3.0 * PI * mp_math::powi(radius, 3))).abs() < 1e-9);
            let moved = mesh.features().transformed(&pose);
            prop_assert!((moved.center - found.center).norm() < 1e-9 && (moved.axis.into_inner() - found.axis.into_inner()).norm() < 1e-6);
        }
    }

    #[test]
    fn of_round_and_pointed_things() {
        let ball = sphere(1.0, 5).unwrap().features();
        assert!(
            ball.volume_ratio() > 0.98
                && ball.center.coords.norm() < 1e-12
                && (ball.radius - 1.0).abs() < 1e-12
        );
        let rod = cylinder(0.1, 4.0, 48).unwrap().features();
        assert!(along(rod.axis, Vector3::z()) && rod.volume_ratio() < 0.01);
        assert!((rod.volume - PI * 0.01 * 4.0).abs() < 1e-3);
        // The centre of gravity of a cone is a quarter of the way up.
        let cone = cone(0.5, 4.0, 48).unwrap();
        let (low, found) = (cone.aabb().min.z, cone.features());
        assert!((found.center.z - (low + 1.0)).abs() < 1e-12 && (found.radius - 3.0).abs() < 1e-12);
        // Its tightest box leans on its side.
        assert!(found.axis.dot(&Vector3::z()) > 0.98);
    }

    #[test]
    fn of_what_bounds_no_solid() {
        let plate = cuboid(3.0, 1.0, 2.0).unwrap();
        let sheet = TriMesh::new(plate.vertices().to_vec(), plate.triangles()[2..].to_vec()).unwrap();
        let found = sheet.features();
        assert_eq!(sheet.surrounding_sphere(), found.sphere());
        assert!((found.volume - 6.0).abs() < 1e-9 && along(found.axis, Vector3::x()));
        // One of six faces is missing: the centre leans away from it.
        assert!(found.center.coords.norm() > 0.05);
        let point = TriMesh::from_soup(&[[Point3::new(1.0, 2.0, 3.0); 3]]).unwrap().features();
        assert_eq!(
            (point.center, point.radius, point.volume_ratio()),
            (Point3::new(1.0, 2.0, 3.0), 0.0, 1.0)
        );
    }
}
