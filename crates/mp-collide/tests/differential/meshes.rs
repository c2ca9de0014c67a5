//! Trees against brute force over all pairs of triangles, and against the reference implementation.

use mp_collide::reference::RefMesh;
use mp_collide::{CollisionMesh, Isa, Query, triangle};
use mp_geom::TriMesh;
use nalgebra::{Isometry3, Point3, Translation3, Vector3};
use rand::RngExt;

use crate::common::{Pcg64, bumpy, cases_of, cuboid, point, pose, rng, rotation, soup};
use crate::referee::{self, Corner};

/// Every triangle as a mesh of its own: the same arithmetic without a tree.
fn pieces(mesh: &TriMesh) -> Vec<CollisionMesh> {
    let single = |i| TriMesh::new(mesh.triangle(i).to_vec(), vec![[0, 1, 2]]).unwrap();
    (0..mesh.triangles().len()).map(|i| CollisionMesh::new(&single(i))).collect()
}

/// One query per instruction set of this CPU, to take turns.
fn queries() -> Vec<Query> {
    Isa::available().into_iter().map(Query::with_isa).collect()
}

#[test]
fn trees_answer_as_brute_force_does() {
    let mut rng = rng(3);
    let mut queries = queries();
    let turns = queries.len();
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
        for i in 0..25 {
            let query = &mut queries[i % turns];
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
            for tolerance in [1e-12, 1e-9, 1e-6, 1e-3, 0.1, 1e12] {
                assert_eq!(
                    query.within(&tree_a, &pose_wa, &tree_b, &pose_wb, tolerance),
                    hit || expected <= tolerance,
                    "{expected} {tolerance}"
                );
            }
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

/// A mesh of a few triangles on an integer grid, of all kinds of degeneracy.
fn grid_mesh(rng: &mut Pcg64, size: i64) -> (TriMesh, Vec<[Corner; 3]>) {
    let corners: Vec<Corner> =
        (0..rng.random_range(3..7)).map(|_| [0; 3].map(|_| rng.random_range(-size..=size))).collect();
    let count = corners.len() as u32;
    let triangles: Vec<[u32; 3]> =
        (0..rng.random_range(1..7)).map(|_| [0; 3].map(|_| rng.random_range(0..count))).collect();
    let exact = triangles.iter().map(|t| t.map(|i| corners[i as usize])).collect();
    let vertices = corners.iter().map(|p| Point3::from(p.map(|c| c as f64))).collect();
    (TriMesh::new(vertices, triangles).unwrap(), exact)
}

#[test]
fn meshes_on_grids_are_decided_exactly() {
    let mut rng = rng(7);
    let mut queries = queries();
    let turns = queries.len();
    let mut hits = 0;
    for i in 0..20_000 {
        let size = [1, 3, 8, 1 << 20][i % 4];
        let query = &mut queries[i / 4 % turns];
        let ((a, exact_a), (b, exact_b)) = (grid_mesh(&mut rng, size), grid_mesh(&mut rng, size));
        let (a, b) = (CollisionMesh::new(&a), CollisionMesh::new(&b));
        // Translations by whole numbers are exact, whatever the common rotation.
        let shift: Corner = [0; 3].map(|_| rng.random_range(-size..=size));
        let (place_a, place_b) = (Isometry3::identity(), Vector3::from(shift.map(|c| c as f64)));
        let pose_wb = Isometry3::from(Translation3::from(place_b));
        let shifted = |t: &[Corner; 3]| t.map(|p| [0, 1, 2].map(|k| p[k] + shift[k]));
        let mut least = f64::INFINITY;
        for t in exact_b.iter().map(shifted) {
            for s in &exact_a {
                if least > 0.0 {
                    least = if referee::intersect(s, &t) {
                        0.0
                    } else if size <= referee::DISTANCE_LIMIT {
                        least.min(referee::distance(s, &t))
                    } else {
                        least
                    };
                }
            }
        }
        let hit = least == 0.0;
        hits += u32::from(hit);
        assert_eq!(query.intersects(&a, &place_a, &b, &pose_wb), hit, "{exact_a:?} {exact_b:?} {shift:?}");
        // The other way round is as exact.
        assert_eq!(query.intersects(&b, &pose_wb, &a, &place_a), hit);
        if let Some((s, t)) = query.intersecting_triangles(&a, &place_a, &b, &pose_wb) {
            assert!(referee::intersect(&exact_a[s], &shifted(&exact_b[t])));
        }
        let distance = query.distance(&a, &place_a, &b, &pose_wb).distance;
        assert_eq!(distance == 0.0, hit);
        if size <= referee::DISTANCE_LIMIT {
            let error = 1e-14 * least + 8.0 * f64::EPSILON * size as f64;
            assert!((distance - least).abs() <= error, "{distance} {least}");
        }
        assert_eq!(query.clearance(&a, &place_a, &b, &pose_wb, 0.5) == 0.0, hit);
        assert_eq!(query.within(&a, &place_a, &b, &pose_wb, 0.0), hit);
    }
    assert!((4_000..16_000).contains(&hits), "{hits} hits");
}

#[test]
fn touching_is_decided_to_the_last_place() {
    let mut query = Query::default();
    let cube = CollisionMesh::new(&cuboid(Vector3::new(1.0, 1.0, 1.0)));
    let here = Isometry3::identity();
    for direction in [[1.0, 0.0, 0.0], [1.0, -1.0, 0.0], [-1.0, 1.0, 1.0]] {
        let direction = Vector3::from(direction);
        for (scale, touches) in [(2.0, true), (2.0_f64.next_up(), false), (2.0_f64.next_down(), true)] {
            let apart = Isometry3::from(Translation3::from(direction * scale));
            assert_eq!(query.intersects(&cube, &here, &cube, &apart), touches, "{direction} {scale}");
            let distance = query.distance(&cube, &here, &cube, &apart).distance;
            assert_eq!(distance == 0.0, touches);
            assert!(distance < 1e-15);
        }
    }
    // Equal poses are not rounded at all: a face laid on a face, turned together by anything.
    let mut rng = rng(8);
    let lower = CollisionMesh::new(&cuboid(Vector3::new(1.0, 1.0, 1.0)));
    let upper = cuboid(Vector3::new(0.3, 0.2, 0.1));
    for (height, touches) in [(1.1_f64, true), (1.1 + 1e-15, false)] {
        let raised: Vec<Point3<f64>> = upper
            .vertices()
            .iter()
            .map(|p| Point3::new(p.x, p.y, if p.z < 0.0 { 1.0 + (height - 1.1) } else { 1.2 }))
            .collect();
        let upper = CollisionMesh::new(&TriMesh::new(raised, upper.triangles().to_vec()).unwrap());
        for _ in 0..100 {
            let at = pose(&mut rng, 1e3);
            assert_eq!(query.intersects(&lower, &at, &upper, &at), touches);
        }
    }
}

#[test]
fn boxes_never_miss_far_from_the_origin_or_at_odd_scales() {
    let mut rng = rng(9);
    let mut queries = queries();
    let turns = queries.len();
    let (mut hits, mut total) = (0, 0);
    for round in 0..120 {
        let (offset, scale) =
            [(0.0, 1e-9), (1e6, 1.0), (1e9, 1.0), (1e3, 1e-6), (0.0, 1e12), (1e14, 1.0)][round % 6];
        let centre = point(&mut rng, 1.0).coords * offset;
        let place = |mesh: TriMesh| {
            let moved = mesh.vertices().iter().map(|p| p * scale + centre).collect();
            TriMesh::new(moved, mesh.triangles().to_vec()).unwrap()
        };
        let (a, b) = (place(soup(&mut rng, 12, 1.0, 0.5)), place(soup(&mut rng, 12, 1.0, 0.5)));
        let (tree_a, tree_b) = (CollisionMesh::new(&a), CollisionMesh::new(&b));
        let (pieces_a, pieces_b) = (pieces(&a), pieces(&b));
        for i in 0..10 {
            let query = &mut queries[i % turns];
            let turn = Isometry3::rotation_wrt_point(rotation(&mut rng), centre.into());
            let here = Isometry3::identity();
            let pairs = || pieces_a.iter().flat_map(|p| pieces_b.iter().map(move |q| (p, q)));
            let hit = pairs().any(|(p, q)| query.intersects(p, &here, q, &turn));
            assert_eq!(query.intersects(&tree_a, &here, &tree_b, &turn), hit, "{offset} {scale}");
            hits += u32::from(hit);
            total += 1;
        }
    }
    assert!(hits > total / 10 && hits < total * 9 / 10, "{hits} of {total}");
}

#[test]
fn answers_do_not_depend_on_earlier_queries() {
    let mut rng = rng(10);
    let (a, b) = (CollisionMesh::new(&bumpy(9, 0.5, 0.2)), CollisionMesh::new(&soup(&mut rng, 90, 0.6, 0.2)));
    let mut used = Query::default();
    for _ in 0..60 {
        let (pose_wa, pose_wb) = (pose(&mut rng, 0.8), pose(&mut rng, 0.8));
        let before = used.counters;
        let from_used = used.distance(&a, &pose_wa, &b, &pose_wb);
        let mut fresh = Query::default();
        assert_eq!(fresh.distance(&a, &pose_wa, &b, &pose_wb), from_used);
        assert_eq!(fresh.counters.box_tests, used.counters.box_tests - before.box_tests);
        assert_eq!(fresh.counters.triangle_tests, used.counters.triangle_tests - before.triangle_tests);
        assert_eq!(fresh.counters.queries, 1);
    }
}

/// The distance over all pairs of triangles, without tree or filter.
fn brute_distance(a: &TriMesh, b: &TriMesh, pose_ab: &Isometry3<f64>) -> f64 {
    let b = b.transformed(pose_ab);
    let triangles =
        |mesh: &TriMesh| (0..mesh.triangles().len()).map(|i| mesh.triangle(i)).collect::<Vec<_>>();
    let (a, b) = (triangles(a), triangles(&b));
    let pairs = a.iter().flat_map(|s| b.iter().map(move |t| triangle::closest(s, t).distance));
    pairs.fold(f64::INFINITY, f64::min)
}

/// A soup of slivers, needles, points and triangles of sizes from 1 down to 1e-12 within `size`.
fn awkward(rng: &mut Pcg64, n: usize, size: f64) -> TriMesh {
    let mut vertices = Vec::new();
    for _ in 0..n {
        let (at, edge) = (point(rng, size), mp_math::powf(10.0, rng.random_range(-12.0..0.0)));
        let (u, v) = (point(rng, 1.0).coords * edge, point(rng, 1.0).coords * edge);
        let thin = mp_math::powf(10.0, rng.random_range(-12.0..0.0));
        vertices.extend(match rng.random_range(0..6) {
            0 => [at, at + u, at + u * 0.5 + v * thin],
            1 => [at, at + u, at + v],
            2 => [at, at + u, at + u * 2.0],
            3 => [at; 3],
            4 => [at, at + u, at + v * thin],
            _ => [at, at + u / edge * size, at + v],
        });
    }
    TriMesh::new(vertices, (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
}

#[test]
fn distances_are_right_for_awkward_triangles_at_any_scale() {
    let mut rng = rng(13);
    let mut queries = queries();
    let turns = queries.len();
    let mut apart = 0;
    let scales = [1.0, 1e-30, 1e-12, 1e-9, 1e-8, 1e-6, 1e-3, 1e3, 1e6, 3e8, 1e9, 1e12, 1e30];
    for round in 0..cases_of(260) {
        let scale = scales[round % scales.len()];
        let reach = [0.1, 1.0, 3.0][round % 3];
        let (a, b) = (awkward(&mut rng, 25, reach), awkward(&mut rng, 30, reach));
        let scaled = |mesh: &TriMesh| {
            let vertices = mesh.vertices().iter().map(|p| p * scale).collect();
            TriMesh::new(vertices, mesh.triangles().to_vec()).unwrap()
        };
        let (a, b) = (scaled(&a), scaled(&b));
        let (tree_a, tree_b) = (CollisionMesh::new(&a), CollisionMesh::new(&b));
        for i in 0..turns {
            let away = [0.0, 1.0, 30.0][(round + i) % 3] + rng.random_range(0.0..1.0);
            let mut pose_ab = pose(&mut rng, away);
            pose_ab.translation.vector *= scale;
            let here = Isometry3::identity();
            let expected = brute_distance(&a, &b, &pose_ab);
            let size = (6.0 + 2.0 * away) * scale;
            let query = &mut queries[i % turns];
            let found = query.distance(&tree_a, &here, &tree_b, &pose_ab);
            let context = || format!("{} {expected} scale {scale} round {round} {i}", found.distance);
            assert!((found.distance - expected).abs() <= 1e-14 * size, "{}", context());
            assert_eq!(found.distance == 0.0, query.intersects(&tree_a, &here, &tree_b, &pose_ab));
            for part in [0.2, 0.999, 1.001, 4.0] {
                let enough = part * expected;
                let clearance = query.clearance(&tree_a, &here, &tree_b, &pose_ab, enough);
                assert!(clearance <= expected + 1e-14 * size, "{clearance} {}", context());
                assert!(clearance >= enough.min(expected) - 1e-14 * size, "{clearance} {}", context());
            }
            if expected > 1e-3 * scale {
                assert!(
                    query.within(&tree_a, &here, &tree_b, &pose_ab, expected * 1.000_001),
                    "{}",
                    context()
                );
                assert!(
                    !query.within(&tree_a, &here, &tree_b, &pose_ab, expected * 0.999_999),
                    "{}",
                    context()
                );
                apart += 1;
            }
        }
    }
    assert!(apart > cases_of(400), "{apart} apart");
}

#[test]
fn rounding_far_from_the_origin_loses_no_pair() {
    let mut rng = rng(14);
    let mut query = Query::default();
    let (mut hits, mut total) = (0, 0);
    for round in 0..1500 {
        // Coordinates so large that the transform rounds them by a visible part of the triangles.
        let offset = [1e13, 1e14, 3e14][round % 3];
        let centre = Vector3::new(1.0, 0.7, -0.4) * offset;
        let place = |mesh: TriMesh| {
            let moved = mesh.vertices().iter().map(|p| p + centre).collect();
            TriMesh::new(moved, mesh.triangles().to_vec()).unwrap()
        };
        let (few, many) = (place(soup(&mut rng, 1, 1.0, 0.7)), place(soup(&mut rng, 8, 1.0, 0.7)));
        let (a, b) = if round % 2 == 0 { (few, many) } else { (many, few) };
        let (tree_a, tree_b) = (CollisionMesh::new(&a), CollisionMesh::new(&b));
        let turn = Isometry3::rotation_wrt_point(rotation(&mut rng), centre.into());
        let here = Isometry3::identity();
        let (pieces_a, pieces_b) = (pieces(&a), pieces(&b));
        let hit = pieces_a.iter().any(|p| pieces_b.iter().any(|q| query.intersects(p, &here, q, &turn)));
        assert_eq!(query.intersects(&tree_a, &here, &tree_b, &turn), hit, "{round}");
        hits += u32::from(hit);
        total += 1;
    }
    assert!(hits > total / 10 && hits < total * 9 / 10, "{hits} of {total}");
}

#[test]
fn faces_count_at_any_scale() {
    // A small triangle over the middle of a large face, and a pair of edges not quite so near.
    let large = [[-10.0, -10.0, 0.0], [10.0, -10.0, 0.0], [0.0, 15.0, 0.0]];
    let beside = [[20.0, 0.0, 0.0], [21.0, 0.0, 0.0], [20.0, 1.0, -1.0]];
    let above = [[0.0, 0.0, 1.0], [0.1, 0.0, 1.1], [0.0, 0.1, 1.1]];
    let crossing = [[20.5, -0.5, 1.5], [20.5, 0.5, 1.5], [20.5, 0.0, 3.0]];
    for exponent in -40..40 {
        let scale = mp_math::powi(10.0, exponent);
        let mesh = |triangles: [[[f64; 3]; 3]; 2]| {
            let vertices = triangles.iter().flatten().map(|p| Point3::from(*p) * scale).collect();
            CollisionMesh::new(&TriMesh::new(vertices, vec![[0, 1, 2], [3, 4, 5]]).unwrap())
        };
        let (a, b) = (mesh([large, beside]), mesh([above, crossing]));
        let here = Isometry3::identity();
        for mut query in queries() {
            for (x, y) in [(&a, &b), (&b, &a)] {
                let distance = query.distance(x, &here, y, &here).distance;
                assert!((distance / scale - 1.0).abs() < 1e-14, "{distance} at scale {scale}");
            }
        }
    }
}
