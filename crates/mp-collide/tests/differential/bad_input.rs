//! Queries are total: bad input counts as in collision with everything.

use mp_collide::reference::RefMesh;
use mp_collide::{CollisionMesh, Query, Scene, SceneError};
use mp_geom::TriMesh;
use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};

use crate::common::cuboid;

fn bad_poses() -> Vec<Isometry3<f64>> {
    let mut poses = Vec::new();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e76, f64::MAX] {
        for k in 0..3 {
            let mut translation = Vector3::zeros();
            translation[k] = bad;
            poses.push(Isometry3::from(Translation3::from(translation)));
        }
        for k in 0..4 {
            let mut q = Quaternion::identity();
            q.coords[k] = bad;
            poses.push(Isometry3::from_parts(Translation3::identity(), UnitQuaternion::new_unchecked(q)));
        }
    }
    for q in [[0.0; 4], [0.0, 0.0, 0.0, 1.01], [0.5, 0.5, 0.5, 0.0], [1e-300, 0.0, 0.0, 0.0]] {
        let q = UnitQuaternion::new_unchecked(Quaternion::from(q));
        poses.push(Isometry3::from_parts(Translation3::new(100.0, 0.0, 0.0), q));
    }
    poses
}

#[test]
fn bad_poses_collide_with_everything() {
    let mesh = cuboid(Vector3::new(1.0, 1.0, 1.0));
    let (tree, reference) = (CollisionMesh::new(&mesh), RefMesh::new(&mesh));
    let far = Isometry3::translation(50.0, 0.0, 0.0);
    let mut scene = Scene::new();
    let body = scene.insert("box", tree.clone(), far).unwrap();
    let mut query = Query::default();
    for bad in bad_poses() {
        for (pose_wa, pose_wb) in [(bad, far), (far, bad), (bad, bad)] {
            assert!(query.intersects(&tree, &pose_wa, &tree, &pose_wb), "{bad:?}");
            assert_eq!(query.intersecting_triangles(&tree, &pose_wa, &tree, &pose_wb), Some((0, 0)));
            assert_eq!(query.distance(&tree, &pose_wa, &tree, &pose_wb).distance, 0.0);
            assert!(query.within(&tree, &pose_wa, &tree, &pose_wb, 0.1));
            assert_eq!(query.depth(&tree, &pose_wa, &tree, &pose_wb), f64::INFINITY);
            assert_eq!(query.escape(&tree, &pose_wa, &tree, &pose_wb), None);
            assert!(query.first_collision(&tree, &[far, pose_wa], &tree, &pose_wb).is_some());
            for enough in [0.0, 1.0, f64::INFINITY, f64::NAN] {
                assert_eq!(query.clearance(&tree, &pose_wa, &tree, &pose_wb, enough), 0.0);
                assert_eq!(reference.clearance(&pose_wa, &reference, &pose_wb, enough), 0.0, "{bad:?}");
            }
        }
        let near = Isometry3::identity();
        assert_eq!(scene.collide_body(&mut query, &tree, &near), None);
        assert_eq!(scene.collide_body(&mut query, &tree, &bad), Some(body));
        assert_eq!(scene.first_collision(&mut query, &tree, &[near, bad]), Some((1, body)));
        assert_eq!(scene.clearance(&mut query, &tree, &bad, 1.0), (0.0, Some(body)));
        assert_eq!(scene.contacts(&mut query, &tree, &bad).len(), 1);
        assert_eq!(scene.move_body(body, bad), Err(SceneError::BadPose { name: "box".into() }));
        assert!(scene.insert("bad", tree.clone(), bad).is_err());
        assert_eq!(scene.body(body).unwrap().pose(), &far);
        assert_eq!(scene.len(), 1);
    }
}

#[test]
fn meshes_moved_by_bad_poses_collide_with_everything() {
    let (mesh, here) = (cuboid(Vector3::new(1.0, 1.0, 1.0)), Isometry3::identity());
    let (good, far) = (CollisionMesh::new(&mesh), Isometry3::translation(50.0, 0.0, 0.0));
    let mut query = Query::default();
    let mut scene = Scene::new();
    for bad in [f64::NAN, f64::INFINITY] {
        let mut poses = vec![Isometry3::translation(bad, 0.0, 0.0), Isometry3::translation(0.0, bad, bad)];
        let q = UnitQuaternion::new_unchecked(Quaternion::new(1.0, bad, 0.0, 0.0));
        poses.push(Isometry3::from_parts(Translation3::identity(), q));
        for pose in poses {
            // All corners, and one among good ones.
            let moved = mesh.transformed(&pose);
            let both = TriMesh::merged([&mesh, &moved, &mesh]);
            for bad_mesh in [Some(moved), both].into_iter().flatten() {
                let tree = CollisionMesh::new(&bad_mesh);
                assert!(query.intersects(&tree, &here, &good, &far), "{pose}");
                assert!(query.intersects(&good, &far, &tree, &here), "{pose}");
                assert_eq!(query.distance(&tree, &here, &good, &far).distance, 0.0);
                assert_eq!(query.clearance(&tree, &here, &good, &far, 1.0), 0.0);
                assert!(matches!(scene.insert("bad", tree.clone(), here), Err(SceneError::TooLarge { .. })));
            }
        }
    }
}

#[test]
fn odd_thresholds_are_taken_at_their_word() {
    let tree = CollisionMesh::new(&cuboid(Vector3::new(1.0, 1.0, 1.0)));
    let mut query = Query::default();
    let (here, apart) = (Isometry3::identity(), Isometry3::translation(3.0, 0.0, 0.0));
    assert_eq!(query.clearance(&tree, &here, &tree, &apart, f64::NAN), 1.0);
    assert_eq!(query.clearance(&tree, &here, &tree, &apart, f64::INFINITY), 1.0);
    for enough in [0.0, -0.0, -1.0, f64::NEG_INFINITY, 1e-300] {
        let clearance = query.clearance(&tree, &here, &tree, &apart, enough);
        assert!(clearance > 0.0 && clearance <= 1.0, "{clearance}");
        assert_eq!(query.clearance(&tree, &here, &tree, &here, enough), 0.0);
    }
    for (tolerance, near, touching) in [
        (f64::NAN, true, true),
        (f64::INFINITY, true, true),
        (f64::NEG_INFINITY, false, true),
        (-1.0, false, true),
        (0.0, false, true),
        (1.0, true, true),
        (0.999, false, true),
    ] {
        assert_eq!(query.within(&tree, &here, &tree, &apart, tolerance), near, "{tolerance}");
        assert_eq!(query.within(&tree, &here, &tree, &here, tolerance), touching, "{tolerance}");
    }
}

#[test]
fn huge_tiny_and_degenerate_meshes_neither_panic_nor_hang() {
    let scaled = |s: f64| {
        let corners = [[0.0, 0.0, 0.0], [s, 0.0, 0.0], [0.0, s, 0.0], [0.0, 0.0, s], [s, s, s]];
        let triangles = vec![[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 4], [2, 3, 4], [1, 1, 1], [0, 0, 4]];
        CollisionMesh::new(&TriMesh::new(corners.map(Point3::from).to_vec(), triangles).unwrap())
    };
    let mut query = Query::default();
    let here = Isometry3::identity();
    let beside = Isometry3::translation(10.0, 10.0, 10.0);
    for size in [5e-324, 1e-300, 1e-160, 1e-75, 1e-20, 1.0, 1e20, 1e74, 1e76, 1e160, 1e300, f64::MAX] {
        for other in [1e-300, 1e-20, 1.0, 1e74, 1e200] {
            let (a, b) = (scaled(size), scaled(other));
            assert!(query.intersects(&a, &here, &b, &here), "{size} {other}");
            assert_eq!(query.distance(&a, &here, &b, &here).distance, 0.0);
            let hit = query.intersects(&a, &here, &b, &beside);
            let found = query.distance(&a, &here, &b, &beside);
            assert_eq!(hit, found.distance == 0.0);
            assert!(found.distance.is_finite() && found.point_a.iter().all(|c| c.is_finite()));
            assert_eq!(hit, query.clearance(&a, &here, &b, &beside, 1.0) == 0.0);
            if size > 1e75 || other > 1e75 {
                assert!(hit && query.depth(&a, &here, &b, &beside) == f64::INFINITY);
            }
        }
    }
    let mut scene = Scene::new();
    assert_eq!(scene.insert("huge", scaled(1e80), here), Err(SceneError::TooLarge { name: "huge".into() }));
}

#[test]
fn trees_of_any_shape_are_built_and_stay_shallow() {
    // All triangles the same; each half as large as the one before; a needle of points.
    let same = (0..300).map(|_| [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).collect::<Vec<_>>();
    let halves = (0..1000)
        .map(|i| {
            let s = mp_math::powi(0.5, i);
            [[s, 0.0, 0.0], [s, s, 0.0], [s, 0.0, s]]
        })
        .collect();
    let points = (0..500).map(|i| [[f64::from(i), 0.0, 0.0]; 3]).collect();
    let mut query = Query::default();
    for soup in [same, halves, points] {
        let vertices: Vec<Point3<f64>> = soup.iter().flatten().map(|p| Point3::from(*p)).collect();
        let triangles = (0..soup.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = CollisionMesh::new(&TriMesh::new(vertices, triangles).unwrap());
        assert_eq!(mesh.triangles().len(), soup.len());
        for (triangle, expected) in mesh.triangles().iter().zip(&soup) {
            assert_eq!(triangle.map(|p| [p.x, p.y, p.z]), *expected);
        }
        let (here, above) = (Isometry3::identity(), Isometry3::translation(0.0, 0.0, 3.0));
        assert!(query.intersects(&mesh, &here, &mesh, &here));
        assert!(!query.intersects(&mesh, &here, &mesh, &above));
        assert!(query.distance(&mesh, &here, &mesh, &above).distance >= 1.9);
    }
}

#[test]
fn everything_can_be_shared_between_threads() {
    fn shared<T: Send + Sync + Clone>() {}
    shared::<CollisionMesh>();
    shared::<Scene>();
    shared::<RefMesh>();
    shared::<Query>();
}
