//! Point clouds against the plain distance to all points.

use crate::common::{bumpy, cases_of, cuboid, point, pose, rng, soup};
use mp_collide::reference::{RefMesh, Sweep, SweepCheck};
use mp_collide::{CollisionMesh, IntervalCheck, Query, RigidMotion, Scene, triangle};
use mp_geom::TriMesh;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use rand::RngExt;
use rand_pcg::Pcg64;

const RADIUS: f64 = 0.03;
/// Rounding of distances of things about as large as 1 m.
const BAND: f64 = 1e-12;

/// Points on a bumpy sphere, in a heap, and some in one place.
fn cloud(rng: &mut Pcg64, count: usize) -> TriMesh {
    let mut points: Vec<_> = (0..count).map(|_| point(rng, 1.0)).collect();
    for p in points.iter_mut().step_by(2) {
        *p = Point3::from(p.coords.normalize() * 0.9);
    }
    points.extend([Point3::new(0.1, 0.2, 0.3); 20]);
    TriMesh::of_balls(points, RADIUS).unwrap()
}

/// Balls of three radii.
fn mixed(rng: &mut Pcg64, count: usize) -> TriMesh {
    let all = [1.0, 0.3, 2.5].map(|scale| {
        let centers = cloud(rng, count / 3).vertices().to_vec();
        TriMesh::of_balls(centers, RADIUS * scale).unwrap()
    });
    TriMesh::merged(&all).unwrap()
}

/// The centres and radii of balls.
fn balls(cloud: &TriMesh) -> impl Iterator<Item = (Point3<f64>, f64)> + '_ {
    let ranges = cloud.balls().iter();
    ranges.flat_map(|(range, radius)| range.clone().map(|i| (cloud.triangle(i as usize)[0], *radius)))
}

fn bodies(rng: &mut Pcg64) -> Vec<TriMesh> {
    let sliver = vec![Point3::origin(), Point3::new(0.3, 0.0, 0.0), Point3::new(0.3, 0.0, 0.0)];
    vec![
        bumpy(8, 0.2, 0.2),
        cuboid(Vector3::new(0.4, 0.02, 0.1)),
        soup(rng, 30, 0.2, 0.1),
        TriMesh::new(sliver, vec![[0, 1, 2], [0, 0, 0]]).unwrap(),
    ]
}

/// The distance of a mesh from the balls, all against all, but for what is plainly too far; below 0 within a ball.
fn plain(mesh: &TriMesh, at: &Isometry3<f64>, cloud: &TriMesh) -> f64 {
    let placed = mesh.transformed(at);
    let triangles: Vec<_> = (0..placed.triangles().len()).map(|i| placed.triangle(i)).collect();
    let reach = |[a, b, c]: &[Point3<f64>; 3]| (b - a).norm().max((c - a).norm());
    let triangles: Vec<_> = triangles.into_iter().map(|triangle| (triangle, reach(&triangle))).collect();
    let mut least = f64::INFINITY;
    for (p, radius) in balls(cloud) {
        for (triangle, reach) in &triangles {
            if (p - triangle[0]).norm() - reach - radius <= least {
                least = least.min(triangle::closest(triangle, &[p; 3]).distance - radius);
            }
        }
    }
    least
}

#[test]
fn all_queries_agree_with_all_pairs() {
    let mut rng = rng(1);
    let clouds = [cloud(&mut rng, 150), mixed(&mut rng, 60)];
    clouds.iter().for_each(|cloud| queries_agree_with_all_pairs(&mut rng, cloud));
}

fn queries_agree_with_all_pairs(rng: &mut Pcg64, cloud: &TriMesh) {
    let (mut query, own) = (Query::default(), balls(cloud).collect::<Vec<_>>());
    let (tree, reference) = (CollisionMesh::new(cloud), RefMesh::new(cloud));
    let mut hits = 0;
    for mesh in bodies(rng) {
        let (body, plain_body) = (CollisionMesh::new(&mesh), RefMesh::new(&mesh));
        for _ in 0..cases_of(250) {
            let (at, there) = (pose(rng, 1.2), pose(rng, 0.5));
            let expected = plain(&mesh, &(there.inverse() * at), cloud);
            hits += usize::from(expected <= 0.0);
            if expected.abs() > BAND {
                assert_eq!(query.intersects(&body, &at, &tree, &there), expected < 0.0, "{expected}");
                assert_eq!(query.intersects(&tree, &there, &body, &at), expected < 0.0, "{expected}");
                assert_eq!(query.intersecting_triangles(&body, &at, &tree, &there).is_some(), expected < 0.0);
                let found = query.first_collision(&body, &[at, at], &tree, &there);
                assert_eq!(found, (expected < 0.0).then_some(0));
            }
            let expected = expected.max(0.0);
            for enough in [0.0, 0.5 * expected, 2.0 * expected + 0.01, f64::INFINITY] {
                for found in [
                    query.clearance(&body, &at, &tree, &there, enough),
                    query.clearance(&tree, &there, &body, &at, enough),
                    plain_body.clearance(&at, &reference, &there, enough),
                    reference.clearance(&there, &plain_body, &at, enough),
                ] {
                    let exact = expected < enough - BAND;
                    let right = if exact {
                        (found - expected).abs() < BAND
                    } else {
                        found >= enough - BAND && found <= expected.max(enough).max(f64::MIN_POSITIVE) + BAND
                    };
                    assert!(right, "{found} {expected} {enough}");
                }
            }
            let near: Vec<usize> = (0..own.len())
                .filter(|i| {
                    let one = TriMesh::of_balls(vec![own[*i].0], own[*i].1).unwrap();
                    plain(&mesh, &(there.inverse() * at), &one) <= 0.05
                })
                .collect();
            let found = query.balls_near(&body, &at, &tree, &there, 0.05);
            // What is deep inside is among them too.
            assert!(
                near.iter().all(|id| found.contains(id)) && found.len() < near.len() + 20,
                "{near:?} {found:?}"
            );
            let found = query.distance(&body, &at, &tree, &there);
            assert!((found.distance - expected).abs() < BAND);
            assert!(((found.point_a - found.point_b).norm() - expected).abs() < BAND);
            let swapped = query.distance(&tree, &there, &body, &at);
            assert!((swapped.distance - expected).abs() < BAND);
            if expected > 0.01 {
                assert!(query.within(&body, &at, &tree, &there, expected + 1e-9));
                assert!(!query.within(&body, &at, &tree, &there, expected - 1e-9));
                let on_cloud = there.inverse_transform_point(&found.point_b);
                let apart = balls(cloud).map(|(p, radius)| (p - on_cloud).norm() - radius);
                let nearest = apart.fold(f64::INFINITY, f64::min);
                assert!(nearest.abs() < BAND, "{nearest}");
            }
        }
    }
    assert!(hits > cases_of(80), "{hits}");
}

#[test]
fn two_clouds() {
    let (mut rng, mut query) = (rng(2), Query::default());
    let all = [40, 90].map(|count| cloud(&mut rng, count)).into_iter().chain([mixed(&mut rng, 60)]);
    let all: Vec<_> = all.collect();
    for [a, b] in [[0, 1], [0, 2], [2, 1], [2, 2]].map(|pair| pair.map(|i| &all[i])) {
        two_clouds_agree(&mut rng, &mut query, a, b);
    }
}

fn two_clouds_agree(rng: &mut Pcg64, query: &mut Query, a: &TriMesh, b: &TriMesh) {
    let trees = [a, b].map(CollisionMesh::new);
    let references = [a, b].map(RefMesh::new);
    for _ in 0..cases_of(150) {
        let (at, there) = (pose(rng, 2.0), pose(rng, 0.1));
        let between = |(p, radius): (Point3<f64>, f64)| {
            balls(b).map(|(q, other)| (at * p - there * q).norm() - other).fold(f64::INFINITY, f64::min)
                - radius
        };
        let expected = balls(a).map(between).fold(f64::INFINITY, f64::min);
        let found = query.clearance(&trees[0], &at, &trees[1], &there, f64::INFINITY);
        assert!((found - expected.max(0.0)).abs() < BAND, "{found} {expected}");
        let plain = references[0].clearance(&at, &references[1], &there, f64::INFINITY);
        assert!((plain - expected.max(0.0)).abs() < BAND, "{plain} {expected}");
        assert_eq!(query.intersects(&trees[0], &at, &trees[1], &there), expected <= 0.0);
    }
}

#[test]
fn intervals_found_free_are_free() {
    let (mut rng, mut query, mut sweep) = (rng(3), Query::default(), Sweep::default());
    let clouds = [cloud(&mut rng, 60), mixed(&mut rng, 30)];
    let (mut counts, here) = ([0; 4], Isometry3::identity());
    let bodies = bodies(&mut rng);
    for (mesh, cloud) in bodies.iter().flat_map(|mesh| clouds.each_ref().map(|cloud| (mesh, cloud))) {
        let (tree, reference) = (CollisionMesh::new(cloud), RefMesh::new(cloud));
        let (body, plain_body) = (CollisionMesh::new(mesh), RefMesh::new(mesh));
        for _ in 0..cases_of(150) {
            let middle = pose(&mut rng, 1.3);
            let size = rng.random_range(0.0..0.2);
            let (shift, turn) = (point(&mut rng, size).coords, point(&mut rng, 2.0 * size).coords);
            let (motion, margin) = (RigidMotion::new(shift, turn, body.radius()), 0.01);
            let pose_at = |t: f64| {
                let turned = UnitQuaternion::from_scaled_axis(turn * t) * middle.rotation;
                Isometry3::from_parts((middle.translation.vector + shift * t).into(), turned)
            };
            let least = (-8..=8).map(|i| plain(mesh, &pose_at(f64::from(i) / 8.0), cloud));
            let least = least.fold(f64::INFINITY, f64::min);
            let in_middle = plain(mesh, &middle, cloud);
            match query.check_interval(&body, &middle, &motion, &tree, &here, margin) {
                IntervalCheck::Free => {
                    assert!(least >= margin - BAND, "{least}");
                    counts[0] += 1;
                    counts[1] += usize::from(in_middle < motion.most + margin);
                }
                IntervalCheck::Collision { .. } => assert!(in_middle <= BAND),
                IntervalCheck::TooClose { .. } => assert!(in_middle < margin + BAND),
                IntervalCheck::Unproven => assert!(in_middle < motion.most + margin + BAND),
            }
            match sweep.sweep(&plain_body, |t| pose_at(2.0 * t - 1.0), &reference, margin, 1e-3) {
                SweepCheck::Free { clearance } => {
                    assert!(least >= margin - BAND && clearance <= least + BAND, "{least} {clearance}");
                    counts[2] += 1;
                }
                SweepCheck::Collision { at } => {
                    assert!(plain(mesh, &pose_at(2.0 * at - 1.0), cloud) < BAND);
                    counts[3] += 1;
                }
                SweepCheck::TooClose { at } => {
                    assert!(plain(mesh, &pose_at(2.0 * at - 1.0), cloud) < margin + 1e-3 + BAND);
                }
            }
        }
    }
    let [free, far, swept, hit] = counts;
    assert!(free > cases_of(200) && far > cases_of(4) && swept > free && hit > cases_of(15), "{counts:?}");
}

#[test]
fn a_cloud_among_bodies_of_a_scene() {
    let (mut rng, mut query) = (rng(4), Query::default());
    let points = cloud(&mut rng, 120);
    let (cube, at) =
        (mp_geom::primitives::cuboid(1.0, 1.0, 1.0).unwrap(), Isometry3::translation(1.5, 0.0, 0.0));
    let mut scene = Scene::new();
    let table = scene.insert("table", CollisionMesh::new(&cube), at).unwrap();
    let scan = scene.insert("scan", CollisionMesh::new(&points), Isometry3::identity()).unwrap();
    scene.insert("other table", CollisionMesh::new(&cube), at).unwrap();
    scene.merge_static();
    let mesh = bumpy(6, 0.25, 0.1);
    let body = CollisionMesh::new(&mesh);
    let mut seen = [0; 3];
    for _ in 0..cases_of(400) {
        let pose = pose(&mut rng, 1.6);
        let (to_scan, to_table) = (
            plain(&mesh, &pose, &points),
            RefMesh::new(&mesh).clearance(&pose, &RefMesh::new(&cube), &at, f64::INFINITY),
        );
        let (found, id) = scene.clearance(&mut query, &body, &pose, f64::INFINITY);
        let expected = to_scan.min(to_table).max(0.0);
        if scene.nested(&mut query, &body, &pose).is_none() {
            assert!((found - expected).abs() < BAND, "{found} {expected}");
            assert_eq!(scene.collides(&mut query, &body, &pose), expected == 0.0);
            assert_eq!(id == Some(scan), to_scan < to_table, "{to_scan} {to_table} {id:?} {table:?}");
        }
        seen[if expected > 0.0 {
            0
        } else if to_scan <= 0.0 {
            1
        } else {
            2
        }] += 1;
        if to_scan <= 0.0 {
            let contact =
                scene.contacts(&mut query, &body, &pose).into_iter().find(|c| c.body == scan).unwrap();
            assert!(contact.name == "scan" && contact.depth > 0.0 && contact.depth < 3.0, "{contact:?}");
        }
    }
    assert!(seen.iter().all(|n| *n > cases_of(4)), "{seen:?}");
}

/// A ball wholly inside of a solid collides with it, and a body wholly inside of a ball.
#[test]
fn what_is_inside_collides() {
    let mut query = Query::default();
    let cube = mp_geom::primitives::cuboid(2.0, 2.0, 2.0).unwrap();
    let ball = |radius| TriMesh::of_balls(vec![Point3::new(0.1, 0.0, 0.0)], radius).unwrap();
    let here = Isometry3::identity();
    for (radius, solid, expected) in [(0.1, true, true), (0.1, false, false), (5.0, false, true)] {
        let cube = if solid { cube.clone() } else { cube.clone().into_surface() };
        let (scan, body) = (CollisionMesh::new(&ball(radius)), CollisionMesh::new(&cube));
        assert_eq!(query.balls_near(&body, &here, &scan, &here, 0.01), [0]);
        let mut scene = Scene::new();
        scene.insert("scan", scan.clone(), here).unwrap();
        assert_eq!(scene.collides(&mut query, &body, &here), expected, "{radius} {solid}");
        assert_eq!(query.meets(&scan, &here, &body, &here), expected);
        let (a, b) = (RefMesh::new(&cube), RefMesh::new(&ball(radius)));
        let met = a.clearance(&here, &b, &here, 1.0) == 0.0 || a.is_nested(&here, &b, &here);
        assert_eq!(met, expected);
    }
}

#[test]
fn sizes_beyond_lanes_and_bad_poses() {
    let mut query = Query::default();
    for scale in [1e-12, 1e12] {
        let points = (0..30).map(|i| Point3::new(f64::from(i) * scale, 0.0, 0.0)).collect();
        let cloud = CollisionMesh::new(&TriMesh::of_balls(points, 0.1 * scale).unwrap());
        let body = CollisionMesh::new(&cuboid(Vector3::repeat(0.3 * scale)));
        let at = Isometry3::translation(3.5 * scale, 0.9 * scale, 0.0);
        let here = Isometry3::identity();
        let found = query.clearance(&body, &at, &cloud, &here, f64::INFINITY) / scale;
        let expected = (0.2_f64 * 0.2 + 0.6 * 0.6).sqrt() - 0.1;
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        assert!(
            query.intersects(&body, &Isometry3::translation(3.5 * scale, 0.0, 0.0), &cloud, &here)
                != (0.2 > 0.1)
        );
        let bad = Isometry3::translation(f64::NAN, 0.0, 0.0);
        assert!(
            query.intersects(&body, &bad, &cloud, &here)
                && query.clearance(&body, &bad, &cloud, &here, 1.0) == 0.0
        );
        let motion = RigidMotion::new(Vector3::zeros(), Vector3::zeros(), 1.0);
        assert_eq!(query.check_interval(&body, &bad, &motion, &cloud, &here, 0.1), IntervalCheck::Unproven);
    }
}
