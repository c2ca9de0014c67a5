//! Trees against brute force over all pairs of triangles, and against the reference implementation.

use mp_collide::reference::RefMesh;
use mp_collide::{CollisionMesh, Query};
use mp_geom::TriMesh;
use nalgebra::{Isometry3, Vector3};

use crate::common::{bumpy, cuboid, pose, rng, soup};

/// Every triangle as a mesh of its own: the same arithmetic without a tree.
fn pieces(mesh: &TriMesh) -> Vec<CollisionMesh> {
    let single = |i| TriMesh::new(mesh.triangle(i).to_vec(), vec![[0, 1, 2]]).unwrap();
    (0..mesh.triangles().len()).map(|i| CollisionMesh::new(&single(i))).collect()
}

#[test]
fn trees_answer_as_brute_force_does() {
    let mut rng = rng(3);
    let mut query = Query::default();
    let mut hits = 0;
    for round in 0..40 {
        let (a, b) = match round % 4 {
            0 => (soup(&mut rng, 30, 1.0, 0.4), soup(&mut rng, 40, 1.0, 0.2)),
            1 => (bumpy(5, 1.0, 0.2), soup(&mut rng, 20, 0.5, 2.0)),
            2 => (cuboid(Vector3::new(1.0, 0.5, 0.1)), bumpy(6, 0.6, 0.3)),
            _ => (soup(&mut rng, 1, 1.0, 1.0), soup(&mut rng, 50, 1e-3, 2.0)),
        };
        let (tree_a, tree_b) = (CollisionMesh::new(&a), CollisionMesh::new(&b));
        let (ref_a, ref_b) = (RefMesh::new(&a), RefMesh::new(&b));
        let (pieces_a, pieces_b) = (pieces(&a), pieces(&b));
        for _ in 0..25 {
            let (pose_wa, pose_wb) = (pose(&mut rng, 1.5), pose(&mut rng, 1.5));
            let (mut expected, mut hit) = (f64::INFINITY, false);
            for p in &pieces_a {
                for q in &pieces_b {
                    hit |= query.intersects(p, &pose_wa, q, &pose_wb);
                    expected = expected.min(query.clearance(p, &pose_wa, q, &pose_wb, expected));
                }
            }
            hits += u32::from(hit);
            assert_eq!(query.intersects(&tree_a, &pose_wa, &tree_b, &pose_wb), hit);
            let found = query.distance(&tree_a, &pose_wa, &tree_b, &pose_wb);
            assert_eq!(found.distance == 0.0, hit);
            assert!((found.distance - expected).abs() <= 1e-14, "{} {expected}", found.distance);
            let apart = (found.point_a - found.point_b).norm();
            assert!((apart - found.distance).abs() <= 1e-14, "{apart} {}", found.distance);
            let reference = ref_a.clearance(&pose_wa, &ref_b, &pose_wb, f64::INFINITY);
            assert!((reference - expected).abs() <= 1e-12, "{reference} {expected}");
            for enough in [0.0, 0.3 * expected, 0.999 * expected, 1.001 * expected, 3.0 * expected] {
                let clearance = query.clearance(&tree_a, &pose_wa, &tree_b, &pose_wb, enough);
                let reference = ref_a.clearance(&pose_wa, &ref_b, &pose_wb, enough);
                for bound in [clearance, reference] {
                    assert!(bound <= expected + 1e-12);
                    assert!(bound >= enough.min(expected) - 1e-12, "{bound} {enough} {expected}");
                }
                assert_eq!(clearance == 0.0, hit);
                assert_eq!(
                    query.within(&tree_a, &pose_wa, &tree_b, &pose_wb, enough),
                    expected <= enough || hit
                );
            }
        }
    }
    assert!((200..800).contains(&hits), "{hits} hits");
}

#[test]
fn batches_find_the_first_collision() {
    let mut rng = rng(5);
    let mut query = Query::default();
    let (a, b) = (CollisionMesh::new(&bumpy(6, 0.5, 0.2)), CollisionMesh::new(&bumpy(7, 0.5, 0.1)));
    for _ in 0..50 {
        let poses: Vec<Isometry3<f64>> = (0..8).map(|_| pose(&mut rng, 2.0)).collect();
        let here = pose(&mut rng, 0.2);
        let expected = poses.iter().position(|p| query.intersects(&a, p, &b, &here));
        assert_eq!(query.first_collision(&a, &poses, &b, &here), expected);
    }
}
