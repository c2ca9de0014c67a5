//! Against parry3d-f64, whose leaf tests iterate: it errs within 5e-6 of contact, so that band is left out.

use mp_collide::{CollisionMesh, Query, triangle};
use parry3d_f64::math::Pose;
use parry3d_f64::query;
use parry3d_f64::shape::{self, Shape};

use crate::common::{bumpy, mesh_to_parry, point, point_to_parry, pose, pose_to_parry, rng, soup};

/// Half the band around contact in which parry is not to be trusted, for sizes about 1.
const BAND: f64 = 5e-6;

/// Checks one pair; returns whether it counted (was outside the band), and whether it was a hit.
fn agree(hit: bool, distance: f64, parry: (bool, f64), what: &dyn std::fmt::Debug) -> (bool, bool) {
    // Beside contact from inside, the only witness is parry's own distance.
    let outside = distance > BAND || (hit && parry.1 < BAND);
    if outside {
        assert_eq!(hit, parry.0, "distance {distance}, parry {parry:?}: {what:?}");
        assert!((distance - parry.1).abs() < BAND, "distance {distance}, parry {parry:?}: {what:?}");
    }
    (outside, hit)
}

#[test]
fn triangles_agree_with_parry() {
    let mut rng = rng(21);
    let here = Pose::identity();
    let (mut counted, mut hits) = (0, 0);
    for _ in 0..100_000 {
        let (a, b) = ([0; 3].map(|_| point(&mut rng, 1.0)), [0; 3].map(|_| point(&mut rng, 1.0)));
        let [pa, pb] = [&a, &b].map(|t| shape::Triangle::from(t.map(|p| point_to_parry(&p))));
        let ours = triangle::closest(&a, &b).distance;
        // parry's intersection test at triangles is its distance: one call tells both.
        let theirs = query::distance(&here, &pa, &here, &pb).unwrap().distance;
        let (outside, hit) = agree(triangle::intersect(&a, &b), ours, (theirs == 0.0, theirs), &(a, b));
        counted += u32::from(outside);
        hits += u32::from(hit);
    }
    assert!(counted > 99_900 && hits > 5_000, "{counted} counted, {hits} hits");
}

#[test]
fn meshes_agree_with_parry() {
    let mut rng = rng(22);
    let mut query = Query::default();
    let (mut counted, mut hits) = (0, 0);
    for round in 0..60 {
        let (a, b) = match round % 3 {
            0 => (soup(&mut rng, 12, 1.0, 0.4), soup(&mut rng, 15, 1.0, 0.3)),
            1 => (bumpy(4, 1.0, 0.2), soup(&mut rng, 10, 0.5, 1.0)),
            _ => (bumpy(5, 0.5, 0.3), bumpy(4, 0.7, 0.0)),
        };
        let (tree_a, tree_b) = (CollisionMesh::new(&a), CollisionMesh::new(&b));
        let (parry_a, parry_b) = (mesh_to_parry(&a), mesh_to_parry(&b));
        for _ in 0..25 {
            let (pose_wa, pose_wb) = (pose(&mut rng, 1.5), pose(&mut rng, 1.5));
            let hit = query.intersects(&tree_a, &pose_wa, &tree_b, &pose_wb);
            let distance = query.distance(&tree_a, &pose_wa, &tree_b, &pose_wb).distance;
            let (pa, pb): (&dyn Shape, &dyn Shape) = (&parry_a, &parry_b);
            let (at_a, at_b) = (pose_to_parry(&pose_wa), pose_to_parry(&pose_wb));
            let parry = (
                query::intersection_test(&at_a, pa, &at_b, pb).unwrap().intersecting,
                query::distance(&at_a, pa, &at_b, pb).unwrap().distance,
            );
            let (outside, hit) = agree(hit, distance, parry, &(round, pose_wa, pose_wb));
            counted += u32::from(outside);
            hits += u32::from(hit);
        }
    }
    assert!(counted > 1_450 && (300..1_300).contains(&hits), "{counted} counted, {hits} hits");
}
