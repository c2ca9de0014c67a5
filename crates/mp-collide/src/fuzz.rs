//! Entry point for fuzzing: a function to be called with any bytes at all. `docs/fuzzing.md` tells how to call
//! it from a coverage-guided fuzzer.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use crate::mesh::CollisionMesh;
use crate::query::Query;
use crate::save::read;

/// Trees in files. Reads bytes that may be anything, whatever their checksum; when they are good, the answers
/// are those of a tree built anew from the same triangles. Tells whether they were good.
///
/// # Panics
/// When they are not: an error of the library.
pub fn tree(bytes: &[u8]) -> bool {
    let strict = CollisionMesh::from_bytes(bytes);
    let mesh = match read(bytes, false) {
        Ok(mesh) => mesh,
        Err(error) => {
            let line = error.to_string();
            assert!(!line.contains('\n') && line.len() < 2000, "{line}");
            assert!(strict.is_err());
            return false;
        }
    };
    let built = CollisionMesh::from_triangles(mesh.triangles());
    let bits = |m: &CollisionMesh| -> Vec<u64> {
        m.triangles().iter().flatten().flat_map(|p| [p.x, p.y, p.z].map(f64::to_bits)).collect()
    };
    assert_eq!(bits(&built), bits(&mesh));
    assert_eq!(built.radius(), mesh.radius());
    let again = CollisionMesh::from_bytes(&mesh.to_bytes()).map(|again| again.to_bytes());
    assert_eq!(again.ok(), Some(mesh.to_bytes()));
    same_answers(&mesh, &built);
    true
}

fn same_answers(mesh: &CollisionMesh, built: &CollisionMesh) {
    let exact = |x: f64| x == 0.0 || (1e-75..=1e75).contains(&x.abs());
    if !mesh.triangles().iter().flatten().all(|p| p.iter().all(|&x| exact(x))) {
        return; // Outside the contract: there is nothing to compare but that there is an answer.
    }
    let (radius, center) = (mesh.tree().radius_center, mesh.tree().center);
    let (mut query, here) = (Query::default(), Isometry3::identity());
    for i in 0..24 {
        let t = f64::from(i);
        let turn =
            UnitQuaternion::from_scaled_axis(Vector3::new(t.sin(), (2.0 * t).cos(), (3.0 * t).sin()) * t);
        let way = Vector3::new((5.0 * t).cos(), (7.0 * t).sin(), (11.0 * t).cos()) * (radius * t / 8.0);
        // About the centre of the mesh, and away from it.
        let away = center + way - turn * center;
        let pose = Isometry3::from_parts(Translation3::from(away), turn);
        let (found, expected) =
            (query.distance(mesh, &here, mesh, &pose), query.distance(built, &here, built, &pose));
        assert_eq!(found.distance == 0.0, expected.distance == 0.0, "{pose}");
        let rounding = 1e-12 * (mesh.radius() + expected.distance);
        assert!((found.distance - expected.distance).abs() <= rounding, "{found:?} {expected:?}");
        assert_eq!(query.intersects(mesh, &here, mesh, &pose), expected.distance == 0.0);
        for enough in [0.5 * expected.distance, 2.0 * expected.distance] {
            let clearance = query.clearance(mesh, &here, built, &pose, enough);
            assert!(clearance <= expected.distance + rounding, "{clearance} {expected:?}");
            assert!(clearance >= enough.min(expected.distance) - rounding, "{clearance} {expected:?}");
        }
    }
}
