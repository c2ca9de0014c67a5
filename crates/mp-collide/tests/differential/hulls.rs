//! Convex hulls and decompositions made by parry.

use mp_collide::CollisionMesh;
use mp_collide::parry::{Decomposition, ParryError, convex_decomposition, convex_hull};
use mp_collide::reference::RefMesh;
use mp_geom::{TriMesh, primitives};
use nalgebra::{Isometry3, Point3, Vector3};
use rand::RngExt;
use robust::{Coord3D, orient3d};

use crate::common::{Pcg64, bumpy, point, pose, rng, soup};

/// How far beyond the planes of a convex mesh a point is: negative inside.
fn beyond(hull: &TriMesh, p: &Point3<f64>) -> f64 {
    let planes = (0..hull.triangles().len()).filter_map(|i| {
        let [a, b, c] = hull.triangle(i);
        // Of slivers the plane is not known.
        let longest = (b - a).norm_squared().max((c - a).norm_squared());
        let out = (b - a).cross(&(c - a)).try_normalize(1e-6 * longest)?;
        Some((p - a).dot(&out))
    });
    planes.fold(f64::NEG_INFINITY, f64::max)
}

fn check(mesh: &TriMesh, hull: &TriMesh) {
    let topology = hull.topology();
    assert!(topology.is_solid() && topology.components == 1);
    assert!(hull.signed_volume() > 0.0);
    assert!(CollisionMesh::new(hull).filled().is_ok());
    let coord = |p: &Point3<f64>| Coord3D { x: p.x, y: p.y, z: p.z };
    for i in 0..hull.triangles().len() {
        let [a, b, c] = hull.triangle(i).map(|p| coord(&p));
        // Exactly: nothing is above any plane, and no triangle is a line.
        let heights = mesh.vertices().iter().map(|p| -orient3d(a, b, c, coord(p)));
        let (low, high) = heights.fold((0.0, 0.0), |(low, high): (f64, f64), h| (low.min(h), high.max(h)));
        assert!(low < 0.0 && high == 0.0, "{low} {high}");
    }
    assert!(hull.vertices().iter().all(|p| mesh.vertices().contains(p)));
}

#[test]
fn hulls_hold_all_and_are_convex_and_closed() {
    let mut rng = rng(81);
    let cube = Point3::from(Vector3::repeat(0.1));
    let grid = (0..216).map(|i| {
        let [x, y, z] = [i % 6, i / 6 % 6, i / 36].map(f64::from);
        Point3::new(x * cube.x, y * cube.y, z * cube.z)
    });
    let grid: Vec<_> = grid.collect();
    let all = (0..216).map(|i| [i, (i + 1) % 216, (i + 7) % 216]).collect();
    let mut meshes = vec![
        primitives::torus(1.0, 0.3, 24, 12).unwrap(),
        primitives::cylinder(0.5, 1.0, 64).unwrap(),
        primitives::sphere(1.0, 2).unwrap(),
        bumpy(8, 1.0, 0.3),
        TriMesh::new(grid, all).unwrap(),
    ];
    // Sheets down to a millionth of their length, which parry alone takes for flat.
    meshes.extend([0.1, 1e-3, 1e-4, 1e-6].map(|z| primitives::cuboid(1.0, 0.7, z).unwrap()));
    meshes.extend((0..30).map(|i| soup(&mut rng, 5 + i, 1.0, 0.4)));
    for mesh in &meshes {
        check(mesh, &convex_hull(mesh).unwrap());
        for size in [1.0, 1e-3, 1e6] {
            let at = pose(&mut rng, 1.0);
            let vertices = mesh.vertices().iter().map(|p| at * p * size).collect();
            let moved = TriMesh::new(vertices, mesh.triangles().to_vec()).unwrap();
            let hull = convex_hull(&moved).unwrap();
            check(&moved, &hull);
            assert_eq!(hull, convex_hull(&moved).unwrap());
            let volume = convex_hull(mesh).unwrap().signed_volume() * mp_math::powi(size, 3);
            assert!((hull.signed_volume() - volume).abs() <= 1e-8 * mp_math::powi(size, 3));
        }
    }
}

#[test]
fn hulls_of_points_in_planes_and_on_lines() {
    let mut rng = rng(84);
    let mut flat = 0;
    for round in 0..400 {
        let (n, size) = (rng.random_range(4..60), [2, 3, 5][round % 3]);
        let cell = |rng: &mut Pcg64| f64::from(rng.random_range(0..size));
        let points: Vec<_> = (0..n).map(|_| Point3::from([0; 3].map(|_| cell(&mut rng)))).collect();
        let mesh = TriMesh::new(points, (0..n - 2).map(|i| [i, i + 1, i + 2]).collect()).unwrap();
        for by in [Isometry3::identity(), pose(&mut rng, 1.0)] {
            let mesh = mesh.transformed(&by);
            match convex_hull(&mesh) {
                Ok(hull) => check(&mesh, &hull),
                Err(error) => {
                    assert_eq!(error, ParryError::Flat);
                    flat += 1;
                }
            }
        }
    }
    assert!(flat < 100, "{flat} flat");
}

#[test]
fn hulls_of_what_no_triangle_uses_and_of_nothing_thick() {
    let mut mesh = primitives::cuboid(1.0, 1.0, 1.0).unwrap();
    let far = [mesh.vertices(), &[Point3::new(9.0, 9.0, 9.0)]].concat();
    mesh = TriMesh::new(far, mesh.triangles().to_vec()).unwrap();
    assert_eq!(convex_hull(&mesh).unwrap().signed_volume(), 1.0);

    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    for [p, q] in [[[0.0; 3], [0.0; 3]], [[1.0, 2.0, 3.0], [0.0; 3]], [[0.0; 3], [0.3, 0.2, 1e-12]]] {
        let corner = |[x, y]: [f64; 2]| Point3::new(x + p[0] + q[0], y + p[1], x * q[2] + p[2]);
        let flat = TriMesh::new(square.map(corner).to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        assert_eq!(convex_hull(&flat), Err(ParryError::Flat));
        let tilted =
            flat.transformed(&Isometry3::new(Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.3, 2.0, 1.0)));
        assert_eq!(convex_hull(&tilted), Err(ParryError::Flat));
    }
    for p in [Point3::origin(), Point3::new(1.0, 2.0, 3.0), Point3::new(1e300, 0.0, 0.0)] {
        let place = TriMesh::new(vec![p], vec![[0, 0, 0]]).unwrap();
        assert_eq!(convex_hull(&place), Err(ParryError::Flat));
        assert_eq!(convex_decomposition(&place, &Decomposition::default()), Err(ParryError::Flat));
    }
    // Sizes whose squares are no numbers.
    for size in [1e-300, 1e-100, 1e100, 1e300] {
        let cube = primitives::cuboid(size, size, size).unwrap();
        assert_eq!(convex_hull(&cube).unwrap().triangles().len(), 12);
        let parts = convex_decomposition(&cube, &Decomposition { resolution: 8, ..Decomposition::default() });
        assert_eq!(parts.unwrap().len(), 1);
    }
}

#[test]
fn parameters_of_decompositions_are_checked() {
    let cube = primitives::cuboid(1.0, 1.0, 1.0).unwrap();
    let good = Decomposition::default();
    let bad = [
        Decomposition { resolution: 7, ..good },
        Decomposition { resolution: u32::MAX, ..good },
        Decomposition { concavity: -0.1, ..good },
        Decomposition { concavity: f64::NAN, ..good },
        Decomposition { max_parts: 3, ..good },
        Decomposition { max_parts: u32::MAX, ..good },
    ];
    for params in bad {
        let error = convex_decomposition(&cube, &params).unwrap_err();
        assert!(matches!(error, ParryError::Parameter { .. }), "{error}");
    }
}

#[test]
fn no_more_parts_than_asked_for() {
    let ring = primitives::torus(1.0, 0.2, 24, 12).unwrap();
    for (most, least) in [(4, 3), (7, 3), (8, 5), (4096, 9)] {
        let params = Decomposition { resolution: 24, max_parts: most, ..Decomposition::default() };
        let parts = convex_decomposition(&ring, &params).unwrap().len();
        assert!((least..=most as usize).contains(&parts), "{parts} of {most}");
    }
    let once = Decomposition { concavity: 1.0, ..Decomposition::default() };
    let [hull] = &convex_decomposition(&ring, &once).unwrap()[..] else { panic!("more than one part") };
    assert!((hull.signed_volume() - convex_hull(&ring).unwrap().signed_volume()).abs() < 1e-12);
    // A vertex that no triangle uses is no part of it.
    let far = [ring.vertices(), &[Point3::new(1e300, 0.0, 0.0)]].concat();
    let with_far = TriMesh::new(far, ring.triangles().to_vec()).unwrap();
    let params = Decomposition { resolution: 16, ..Decomposition::default() };
    assert!(convex_decomposition(&with_far, &params) == convex_decomposition(&ring, &params));
}

/// Two boxes in the shape of an L, as one surface.
fn corner() -> TriMesh {
    let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 0.5], [0.5, 0.5], [0.5, 1.5], [0.0, 1.5]];
    primitives::prism(&outline.map(nalgebra::Point2::from), 0.0, 0.7).unwrap()
}

/// A box without a lid, of thin sheet.
fn tray() -> TriMesh {
    let (t, h) = (0.003, 0.4);
    let wall = |x: f64, y: f64, z: f64, at: [f64; 3]| {
        primitives::cuboid(x, y, z).unwrap().transformed(&Isometry3::translation(at[0], at[1], at[2]))
    };
    let walls = [
        wall(1.0, 0.6, t, [0.0, 0.0, 0.0]),
        wall(t, 0.6, h, [0.51, 0.0, 0.2]),
        wall(t, 0.6, h, [-0.51, 0.0, 0.2]),
        wall(1.0, t, h, [0.0, 0.31, 0.2]),
        wall(1.0, t, h, [0.0, -0.31, 0.2]),
    ];
    TriMesh::merged(&walls).unwrap()
}

/// Points on the triangles of a mesh.
fn surface_points(rng: &mut Pcg64, mesh: &TriMesh, n: usize) -> Vec<Point3<f64>> {
    let one = |rng: &mut Pcg64| {
        let [a, b, c] = mesh.triangle(rng.random_range(0..mesh.triangles().len()));
        let (mut u, mut v) = (rng.random_range(0.0..1.0), rng.random_range(0.0..1.0));
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        a + (b - a) * u + (c - a) * v
    };
    (0..n).map(|_| one(rng)).collect()
}

/// Whether a point is inside by the solid angles of the triangles.
fn is_inside(mesh: &TriMesh, p: &Point3<f64>) -> bool {
    let angle = (0..mesh.triangles().len()).map(|i| {
        let [a, b, c] = mesh.triangle(i).map(|v| (v - p).normalize());
        2.0 * mp_math::atan2(a.dot(&b.cross(&c)), 1.0 + a.dot(&b) + b.dot(&c) + c.dot(&a))
    });
    angle.sum::<f64>() > std::f64::consts::TAU
}

#[test]
fn parts_cover_the_mesh_and_its_inside() {
    let mut rng = rng(82);
    let meshes = [
        ("corner", corner(), 0.05),
        ("ring", primitives::torus(1.0, 0.3, 24, 12).unwrap(), 0.1),
        ("bumpy", bumpy(10, 1.0, 0.4), 0.4),
        ("tray", tray(), 0.05),
    ];
    for (name, mesh, more) in meshes {
        for (turned, resolution) in [(false, 32), (true, 24)] {
            let by = if turned { pose(&mut rng, 2.0) } else { Isometry3::identity() };
            let mesh = mesh.transformed(&by);
            let params = Decomposition { resolution, ..Decomposition::default() };
            let parts = convex_decomposition(&mesh, &params).unwrap();
            assert!((2..=64).contains(&parts.len()), "{name}: {}", parts.len());
            assert_eq!(parts, convex_decomposition(&mesh, &params).unwrap());
            for part in &parts {
                assert!(part.topology().is_solid() && part.signed_volume() > 0.0, "{name}");
                assert!(part.vertices().iter().all(|p| beyond(part, p) < 1e-8), "{name}");
            }
            let mut points = surface_points(&mut rng, &mesh, 400);
            points.extend(mesh.vertices());
            let within = (0..2000).map(|_| by * point(&mut rng, 2.0));
            points.extend(within.filter(|p| is_inside(&mesh, p)));
            for p in &points {
                let out = parts.iter().map(|part| beyond(part, p)).fold(f64::INFINITY, f64::min);
                assert!(out < 1e-8, "{name}: {p} is {out} outside of all {} parts", parts.len());
            }
            let volume: f64 = parts.iter().map(TriMesh::signed_volume).sum();
            let expected = mesh.signed_volume();
            assert!(volume >= expected * (1.0 - 1e-6), "{name}: {volume} {expected}");
            if !turned {
                assert!(volume <= expected + more * (1.0 + expected), "{name}: {volume} {expected}");
            }
        }
    }
}

#[test]
fn sheets_and_open_meshes_are_taken_to_pieces_too() {
    let mut rng = rng(83);
    // A sheet bent in two, and a bowl.
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 1.0, 1.0],
    ];
    let bent = vec![[0, 1, 2], [0, 2, 3], [0, 3, 5], [0, 5, 4]];
    let bent = TriMesh::new(corners.map(Point3::from).to_vec(), bent).unwrap();
    let ball = bumpy(8, 1.0, 0.2);
    let bowl = (0..ball.triangles().len()).filter(|&i| ball.triangle(i).iter().all(|p| p.z < 0.3));
    let bowl = TriMesh::new(ball.vertices().to_vec(), bowl.map(|i| ball.triangles()[i]).collect()).unwrap();
    for mesh in [bent, bowl, soup(&mut rng, 8, 1.0, 0.3)] {
        let params = Decomposition { resolution: 16, ..Decomposition::default() };
        let parts = convex_decomposition(&mesh, &params).unwrap();
        assert!(parts.len() > 1);
        for p in surface_points(&mut rng, &mesh, 300) {
            let out = parts.iter().map(|part| beyond(part, &p)).fold(f64::INFINITY, f64::min);
            assert!(out < 1e-8, "{p} is {out} outside of all {} parts", parts.len());
        }
        // All is near the mesh.
        let tree = RefMesh::new(&mesh);
        let here = Isometry3::identity();
        for p in parts.iter().flat_map(TriMesh::vertices) {
            let place = RefMesh::new(&TriMesh::new(vec![*p], vec![[0, 0, 0]]).unwrap());
            assert!(tree.clearance(&here, &place, &here, f64::INFINITY) < 0.35, "{p}");
        }
    }
}
