//! Solid primitives against brute force and against parry.

use mp_collide::parry::{point_to_parry, solid_to_parry};
use mp_collide::{CollisionMesh, Isa, Query, Solid, triangle};
use mp_geom::TriMesh;
use mp_geom::primitives::{self, PrimitiveError};
use nalgebra::{Isometry3, Point3, Vector3};
use parry3d_f64::{math::Pose, query::distance as parry_distance, shape};
use rand::RngExt;

use crate::common::{Pcg64, bumpy, cases_of, point, pose, rng, soup};

/// How far parry's iterations may end from the distance of a curved shape.
const BAND: f64 = 1e-4;

struct Case {
    solid: Solid,
    /// The distance of a triangle in the frame of the solid.
    brute: Box<dyn Fn(&triangle::Triangle) -> f64>,
}

fn cases(rng: &mut Pcg64) -> Vec<Case> {
    let mut size = |low: f64| rng.random_range(low..0.6);
    let (r, l, [x, y, z]) = (size(0.01), 2.0 * size(0.01), [0; 3].map(|_| 2.0 * size(0.05)));
    let from = move |core: triangle::Triangle, radius: f64| {
        move |t: &triangle::Triangle| (triangle::closest(&core, t).distance - radius).max(0.0)
    };
    let (low, high) = (Point3::new(0.0, 0.0, -0.5 * l), Point3::new(0.0, 0.0, 0.5 * l));
    let faces = primitives::cuboid(x, y, z).unwrap();
    let to_box = move |t: &triangle::Triangle| {
        if t[0].x.abs() <= 0.5 * x && t[0].y.abs() <= 0.5 * y && t[0].z.abs() <= 0.5 * z {
            return 0.0;
        }
        let apart = |i| triangle::closest(&faces.triangle(i), t).distance;
        (0..12).map(apart).fold(f64::INFINITY, f64::min)
    };
    // Nested golden sections, of a function that is convex along every line.
    let revolved = |low: f64, high: f64, half: f64| {
        move |t: &triangle::Triangle| {
            let across = |u: f64| {
                let (p, q) = (t[0] + (t[1] - t[0]) * u, t[0] + (t[2] - t[0]) * u);
                least(|v| to_frustum(&(p + (q - p) * v), low, high, half))
            };
            least(across)
        }
    };
    let to_plane = |t: &triangle::Triangle| t.iter().map(|p| p.z).fold(f64::INFINITY, f64::min).max(0.0);
    vec![
        Case { solid: Solid::ball(r).unwrap(), brute: Box::new(from([Point3::origin(); 3], r)) },
        Case { solid: Solid::capsule(r, l).unwrap(), brute: Box::new(from([low, high, high], r)) },
        Case { solid: Solid::cuboid(x, y, z).unwrap(), brute: Box::new(to_box) },
        Case { solid: Solid::cylinder(r, l).unwrap(), brute: Box::new(revolved(r, r, 0.5 * l)) },
        Case { solid: Solid::cone(r, l).unwrap(), brute: Box::new(revolved(r, 0.0, 0.5 * l)) },
        Case { solid: Solid::half_space(), brute: Box::new(to_plane) },
    ]
}

/// The least value of a convex function on 0..1.
fn least(f: impl Fn(f64) -> f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut lo, mut hi) = (0.0, 1.0);
    let (mut x, mut y) = (1.0 - golden, golden);
    let (mut at_x, mut at_y) = (f(x), f(y));
    let mut best = f(0.0).min(f(1.0));
    for _ in 0..38 {
        best = best.min(at_x).min(at_y);
        if at_x < at_y {
            (hi, y, at_y) = (y, x, at_x);
            x = hi - golden * (hi - lo);
            at_x = f(x);
        } else {
            (lo, x, at_x) = (x, y, at_y);
            y = lo + golden * (hi - lo);
            at_y = f(y);
        }
    }
    best
}

/// The distance of a point from the solid between two discs about Z: from the outline of its section.
fn to_frustum(p: &Point3<f64>, low: f64, high: f64, half: f64) -> f64 {
    let p = [mp_math::hypot(p.x, p.y), p.z];
    let outline = [[0.0, -half], [low, -half], [high, half], [0.0, half]];
    let (mut inside, mut least) = (true, f64::INFINITY);
    for [a, b] in [[outline[0], outline[1]], [outline[1], outline[2]], [outline[2], outline[3]]] {
        let (d, e) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
        inside &= d[0] * e[1] - d[1] * e[0] >= 0.0;
        let length = d[0] * d[0] + d[1] * d[1];
        let t = if length > 0.0 { ((d[0] * e[0] + d[1] * e[1]) / length).clamp(0.0, 1.0) } else { 0.0 };
        least = least.min(mp_math::hypot(e[0] - d[0] * t, e[1] - d[1] * t));
    }
    if inside { 0.0 } else { least }
}

#[test]
fn solids_answer_as_brute_force_and_parry_do() {
    let mut rng = rng(41);
    let mut queries: Vec<Query> = Isa::available().into_iter().map(Query::with_isa).collect();
    let turns = queries.len();
    let (mut hits, mut total) = (0, 0);
    for round in 0..cases_of(60) {
        let mesh = match round % 3 {
            0 => soup(&mut rng, 30, 1.0, 0.3),
            1 => bumpy(5, 0.8, 0.2),
            _ => soup(&mut rng, 12, 0.3, 0.1),
        };
        let tree = CollisionMesh::new(&mesh);
        for case in cases(&mut rng) {
            for i in 0..8 {
                let query = &mut queries[i % turns];
                let (pose_wm, pose_ws) = (pose(&mut rng, 0.9), pose(&mut rng, 0.9));
                let local = mesh.transformed(&pose_ws.inv_mul(&pose_wm));
                let triangles = || (0..local.triangles().len()).map(|k| local.triangle(k));
                let expected = triangles().map(|t| (case.brute)(&t)).fold(f64::INFINITY, f64::min);
                let hit = query.solid_intersects(&tree, &pose_wm, &case.solid, &pose_ws);
                let found = query.solid_distance(&tree, &pose_wm, &case.solid, &pose_ws);
                let distance = found.distance;
                assert!((distance - expected).abs() <= 1e-14, "{distance} {expected} {:?}", case.solid);
                assert_eq!(distance == 0.0, hit);
                assert!(((found.point_a - found.point_b).norm() - distance).abs() <= 1e-14);
                // The points are where they should be.
                let on_mesh = pose_ws.inverse_transform_point(&found.point_a);
                assert!((case.brute)(&[on_mesh; 3]) <= distance + 1e-14);
                let near = triangles().map(|t| triangle::closest(&t, &[on_mesh; 3]).distance);
                assert!(near.fold(f64::INFINITY, f64::min) < 1e-14);
                let on_solid = pose_ws.inverse_transform_point(&found.point_b);
                assert!((case.brute)(&[on_solid; 3]) < 1e-14);
                for part in [0.0, 0.4, 0.999, 1.001, 3.0] {
                    let enough = part * expected;
                    let clearance = query.solid_clearance(&tree, &pose_wm, &case.solid, &pose_ws, enough);
                    assert_eq!(clearance == 0.0, hit);
                    assert!(clearance <= distance + 1e-14);
                    assert!(clearance >= enough.min(distance) - 1e-14);
                    let within = query.solid_within(&tree, &pose_wm, &case.solid, &pose_ws, enough);
                    assert_eq!(within, hit || distance <= enough, "{distance} {enough}");
                }
                let (parry, at) = solid_to_parry(&case.solid);
                let theirs = triangles()
                    .map(|t| {
                        let t = shape::Triangle::from(t.map(|p| point_to_parry(&p)));
                        parry_distance(&at, &*parry, &Pose::IDENTITY, &t).unwrap().distance
                    })
                    .fold(f64::INFINITY, f64::min);
                assert!((distance - theirs).abs() < BAND, "{distance} {theirs} {:?}", case.solid);
                hits += u32::from(hit);
                total += 1;
            }
        }
    }
    assert!(hits > total / 10 && hits < total * 9 / 10, "{hits} of {total}");
}

#[test]
fn solids_are_filled_and_meshes_are_not() {
    let mut query = Query::default();
    let here = Isometry3::identity();
    let small = CollisionMesh::new(&primitives::cuboid(0.1, 0.1, 0.1).unwrap());
    let large = CollisionMesh::new(&primitives::cuboid(10.0, 10.0, 10.0).unwrap());
    let round =
        [Solid::ball(1.0), Solid::capsule(1.0, 1.0), Solid::cylinder(1.0, 2.0), Solid::cone(1.5, 3.0)];
    for solid in round.into_iter().chain([Solid::cuboid(2.0, 2.0, 2.0)]) {
        let solid = solid.unwrap();
        for at in [here, Isometry3::new(Vector3::new(0.3, -0.2, 0.4), Vector3::new(1.0, 0.3, -2.0))] {
            assert!(query.solid_intersects(&small, &at, &solid, &here));
            assert_eq!(query.solid_distance(&small, &at, &solid, &here).distance, 0.0);
            assert_eq!(query.solid_clearance(&small, &at, &solid, &here, 0.1), 0.0);
            assert!(query.solid_within(&small, &at, &solid, &here, 0.0));
            assert!(!query.solid_intersects(&large, &at, &solid, &here));
            assert!(query.solid_distance(&large, &at, &solid, &here).distance > 2.0);
        }
    }
    // One of two pieces inside, the other far away.
    let mut both = primitives::cuboid(0.1, 0.1, 0.1).unwrap();
    both = {
        let far = both.transformed(&Isometry3::translation(20.0, 0.0, 0.0));
        let vertices = [both.vertices(), far.vertices()].concat();
        let shifted = far.triangles().iter().map(|t| t.map(|i| i + 8));
        TriMesh::new(vertices, both.triangles().iter().copied().chain(shifted).collect()).unwrap()
    };
    let both = CollisionMesh::new(&both);
    let solid = Solid::cuboid(2.0, 2.0, 2.0).unwrap();
    for x in [0.0, -20.0] {
        assert!(query.solid_intersects(&both, &Isometry3::translation(x, 0.0, 0.0), &solid, &here));
    }
    assert!(!query.solid_intersects(&both, &Isometry3::translation(-10.0, 0.0, 0.0), &solid, &here));
}

#[test]
fn touching_a_solid_counts() {
    let mut query = Query::default();
    let here = Isometry3::identity();
    let mesh = CollisionMesh::new(&primitives::cuboid(2.0, 2.0, 2.0).unwrap());
    let solids: [(Solid, f64); 5] = [
        (Solid::cylinder(0.25, 0.5).unwrap(), 1.25),
        (Solid::cone(0.25, 0.5).unwrap(), 1.25),
        (Solid::ball(0.25).unwrap(), 1.25),
        (Solid::capsule(0.25, 0.5).unwrap(), 1.5),
        (Solid::cuboid(1.0, 1.0, 0.5).unwrap(), 1.25),
    ];
    for (solid, height) in &solids {
        for (z, touches) in [(*height, true), (height.next_up(), false), (height.next_down(), true)] {
            let above = Isometry3::translation(0.1, 0.2, z);
            assert_eq!(query.solid_intersects(&mesh, &here, solid, &above), touches, "{solid:?} {z}");
            assert_eq!(query.solid_distance(&mesh, &here, solid, &above).distance == 0.0, touches);
        }
    }
    for (z, touches) in [(-1.0, true), ((-1.0_f64).next_down(), false), ((-1.0_f64).next_up(), true)] {
        let floor = Isometry3::translation(5.0, 0.0, z);
        assert_eq!(query.solid_intersects(&mesh, &here, &Solid::half_space(), &floor), touches, "{z}");
    }
}

#[test]
fn sizes_and_poses_of_any_kind_are_answered() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let round =
            [Solid::ball(bad), Solid::capsule(1.0, bad), Solid::cylinder(bad, 1.0), Solid::cone(1.0, bad)];
        for solid in round.into_iter().chain([Solid::cuboid(1.0, bad, 1.0)]) {
            assert!(matches!(solid, Err(PrimitiveError::NotPositive { .. })));
        }
    }
    let mut rng = rng(43);
    let mut query = Query::default();
    let mesh = |scale: f64| {
        let corners = (0..30).map(|_| point(&mut rng, 1.0) * scale).collect();
        CollisionMesh::new(
            &TriMesh::new(corners, (0..10).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap(),
        )
    };
    let meshes = [1e-300, 1e-20, 1.0, 1e20, 1e74, 1e80].map(mesh);
    let here = Isometry3::identity();
    let nan = Isometry3::translation(f64::NAN, 0.0, 0.0);
    for size in [1e-300, 1e-20, 1.0, 1e20, 1e74, 1e300] {
        let round = [Solid::ball(size), Solid::capsule(size, size), Solid::cylinder(size, size)];
        let others = [Solid::cone(size, size), Solid::cuboid(size, size, size)];
        for solid in round.into_iter().chain(others).map(Result::unwrap).chain([Solid::half_space()]) {
            for mesh in &meshes {
                for at in [here, Isometry3::translation(0.0, 0.0, 1e3)] {
                    let hit = query.solid_intersects(mesh, &here, &solid, &at);
                    let found = query.solid_distance(mesh, &here, &solid, &at);
                    assert_eq!(hit, found.distance == 0.0, "{solid:?} {found:?}");
                    assert!(found.distance.is_finite() && found.point_b.iter().all(|c| c.is_finite()));
                    assert_eq!(hit, query.solid_clearance(mesh, &here, &solid, &at, 1.0) == 0.0);
                }
                assert!(query.solid_intersects(mesh, &nan, &solid, &here));
                assert_eq!(query.solid_distance(mesh, &here, &solid, &nan).distance, 0.0);
                assert_eq!(query.solid_clearance(mesh, &nan, &solid, &here, f64::NAN), 0.0);
                assert!(query.solid_within(mesh, &nan, &solid, &here, f64::NAN));
            }
        }
    }
}
