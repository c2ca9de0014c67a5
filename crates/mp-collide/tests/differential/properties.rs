//! Properties that hold for all meshes and poses.

use mp_collide::reference::RefMesh;
use mp_collide::{CollisionMesh, Query};
use mp_geom::TriMesh;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

fn mesh() -> impl Strategy<Value = TriMesh> {
    let corner = [-1.0..1.0, -1.0..1.0, -1.0..1.0_f64].prop_map(Point3::from);
    (
        proptest::collection::vec(corner, 3..12),
        proptest::collection::vec([0..1000_u32, 0..1000, 0..1000], 1..12),
    )
        .prop_map(|(vertices, triangles)| {
            let n = vertices.len() as u32;
            TriMesh::new(vertices, triangles.iter().map(|t| t.map(|i| i % n)).collect()).unwrap()
        })
}

fn pose() -> impl Strategy<Value = Isometry3<f64>> {
    ([-2.0..2.0, -2.0..2.0, -2.0..2.0_f64], [-3.0..3.0, -3.0..3.0, -3.0..3.0_f64]).prop_map(|(t, r)| {
        Isometry3::from_parts(Translation3::from(t), UnitQuaternion::from_scaled_axis(Vector3::from(r)))
    })
}

/// The rotation is by a multiple of its own, so that nothing but rounding can change.
fn moved(by: &Isometry3<f64>, pose: &Isometry3<f64>) -> Isometry3<f64> {
    let mut moved = by * pose;
    moved.rotation.renormalize();
    moved
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn distance_is_symmetric_and_moves_along(
        a in mesh(), b in mesh(), pose_wa in pose(), pose_wb in pose(), by in pose()
    ) {
        let (a, b) = (CollisionMesh::new(&a), CollisionMesh::new(&b));
        let mut query = Query::default();
        let here = query.distance(&a, &pose_wa, &b, &pose_wb);
        let swapped = query.distance(&b, &pose_wb, &a, &pose_wa);
        let there = query.distance(&a, &moved(&by, &pose_wa), &b, &moved(&by, &pose_wb));
        prop_assert!((here.distance - swapped.distance).abs() < 1e-13);
        prop_assert!((here.distance - there.distance).abs() < 1e-13);
        prop_assert!(((here.point_b - here.point_a).norm() - here.distance).abs() < 1e-13);
        // Pulling them together along the join by a little less than the distance does not make them meet;
        // by a little more it does.
        if here.distance > 1e-6 {
            let join = here.point_b - here.point_a;
            let pulled = |part: f64| Translation3::from(join * part) * pose_wa;
            prop_assert!(!query.intersects(&a, &pulled(1.0 - 1e-9), &b, &pose_wb));
            let left = query.distance(&a, &pulled(0.5), &b, &pose_wb).distance;
            prop_assert!((left - 0.5 * here.distance).abs() < 1e-13);
            prop_assert!(query.distance(&a, &pulled(1.0), &b, &pose_wb).distance < 1e-13);
        }
    }

    #[test]
    fn clearance_is_a_lower_bound(
        a in mesh(), b in mesh(), pose_wa in pose(), pose_wb in pose(), enough in 0.0..2.0_f64
    ) {
        let (tree_a, tree_b) = (CollisionMesh::new(&a), CollisionMesh::new(&b));
        let mut query = Query::default();
        let distance = query.distance(&tree_a, &pose_wa, &tree_b, &pose_wb).distance;
        let plain = RefMesh::new(&a).clearance(&pose_wa, &RefMesh::new(&b), &pose_wb, enough);
        for clearance in [query.clearance(&tree_a, &pose_wa, &tree_b, &pose_wb, enough), plain] {
            prop_assert!(clearance <= distance + 1e-12);
            prop_assert!(clearance >= enough.min(distance) - 1e-12);
        }
        prop_assert_eq!(query.within(&tree_a, &pose_wa, &tree_b, &pose_wb, enough), distance <= enough);
    }

    #[test]
    fn escapes_lead_out(a in mesh(), b in mesh(), pose_wa in pose(), pose_wb in pose()) {
        let (a, b) = (CollisionMesh::new(&a), CollisionMesh::new(&b));
        let mut query = Query::default();
        let way = query.escape(&a, &pose_wa, &b, &pose_wb).unwrap();
        let hit = query.intersects(&a, &pose_wa, &b, &pose_wb);
        prop_assert_eq!(way.norm() > 0.0, hit);
        prop_assert_eq!(query.depth(&a, &pose_wa, &b, &pose_wb), way.norm());
        prop_assert!(!query.intersects(&a, &(Translation3::from(way) * pose_wa), &b, &pose_wb));
        // No deeper than the two together are long.
        prop_assert!(way.norm() <= 1.01 * 2.0 * (a.radius() + b.radius()));
    }
}

#[test]
fn depths_of_boxes_are_known() {
    let mut query = Query::default();
    let cube = CollisionMesh::new(&crate::common::cuboid(Vector3::new(1.0, 1.0, 1.0)));
    let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.4, -0.2, 1.0));
    for depth in [1e-6, 1e-3, 0.1, 0.5] {
        for axis in [Vector3::x(), -Vector3::y(), Vector3::z()] {
            let pose_wa = Isometry3::from_parts(Translation3::new(3.0, 1.0, 2.0), turn);
            let pose_wb = pose_wa * Translation3::from(axis * (2.0 - depth));
            let found = query.depth(&cube, &pose_wa, &cube, &pose_wb);
            assert!((found - depth).abs() <= 1e-3 * depth + 1e-6, "{found} {depth}");
        }
    }
}
