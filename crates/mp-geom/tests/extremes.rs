//! Any finite coordinates, however large, small or mixed: answers, never a panic or a hang.

use mp_geom::{TriMesh, pose_from_six, six_from_pose};
use nalgebra::Point3;
use proptest::prelude::*;

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        -1.0..1.0,
        (-308_i32..308, -9.9..9.9).prop_map(|(e, m)| m * mp_math::powi(10.0, e)),
        prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO,
    ]
}

fn point() -> impl Strategy<Value = Point3<f64>> {
    prop::array::uniform3(coordinate()).prop_map(Point3::from)
}

proptest! {
    #[test]
    fn every_measure_answers(soup in prop::collection::vec(prop::array::uniform3(point()), 1..20)) {
        let mesh = TriMesh::from_soup(&soup).unwrap();
        prop_assert_eq!(mesh.triangles().len(), soup.len());
        let t = mesh.topology();
        prop_assert_eq!(t.neighbours.len(), soup.len());
        prop_assert!(mesh.vertices().iter().all(|p| mesh.aabb().contains(p)));
        let sphere = mesh.bounding_sphere();
        prop_assert!(sphere.radius >= 0.0);
        let obb = mesh.obb();
        // Beyond, products of three lengths overflow.
        if mesh.vertices().iter().all(|p| p.coords.amax() < 1e100) {
            prop_assert!(obb.half_extents.iter().all(|h| *h >= 0.0 && h.is_finite()));
            let size = mesh.aabb().diagonal();
            prop_assert!(mesh.vertices().iter().all(|p| obb.distance(p) <= 1e-12 * size && sphere.contains(p)));
        }
        if let Ok(mass) = mesh.mass_properties() {
            prop_assert!(mass.volume > 0.0);
            let _axes = mass.principal_axes();
        }
    }

    #[test]
    fn polygons_of_any_points(ring in prop::collection::vec(point(), 3..12)) {
        let n = ring.len() as u32;
        let mesh = TriMesh::from_polygons(ring, [(0..n).collect::<Vec<_>>()]).unwrap();
        prop_assert_eq!(mesh.triangles().len(), n as usize - 2);
    }

    #[test]
    fn angles_of_any_size(six in prop::array::uniform6(coordinate())) {
        let back = six_from_pose(&pose_from_six(six));
        prop_assert_eq!(&back[..3], &six[..3]);
        prop_assert!(back[3..].iter().all(|a| a.abs() <= std::f64::consts::PI));
    }
}
