//! Solids, surfaces and bodies of both, inside of each other and not: against convex pieces in parry.

use mp_collide::reference::RefMesh;
use mp_collide::{CollisionMesh, Query, Scene};
use mp_geom::TriMesh;
use mp_geom::primitives::{cuboid, cylinder, prism, sphere};
use nalgebra::{Isometry3, Point2};
use parry3d_f64::math::Pose;
use parry3d_f64::query::intersection_test;
use parry3d_f64::shape::SharedShape;

use crate::common::{cases_of, point_to_parry, pose, pose_to_parry, rng};

/// Where parry and we differ, the shapes are within this of touching, metres.
const BAND: f64 = 1e-6;

/// A mesh three times, and the convex pieces of which it consists.
struct Shape {
    tree: CollisionMesh,
    reference: RefMesh,
    pieces: Vec<(Pose, SharedShape)>,
}

impl Shape {
    fn new(mesh: &TriMesh, pieces: Vec<(Pose, SharedShape)>) -> Self {
        Self { tree: CollisionMesh::new(mesh), reference: RefMesh::new(mesh), pieces }
    }

    /// A convex solid.
    fn convex(mesh: &TriMesh) -> Self {
        let corners: Vec<_> = mesh.vertices().iter().map(point_to_parry).collect();
        Self::new(mesh, vec![(Pose::IDENTITY, SharedShape::convex_hull(&corners).unwrap())])
    }
}

/// The box between two corners.
fn between(low: [f64; 3], high: [f64; 3]) -> (TriMesh, (Pose, SharedShape)) {
    let half: [f64; 3] = std::array::from_fn(|k| 0.5 * (high[k] - low[k]));
    let middle = Isometry3::translation(low[0] + half[0], low[1] + half[1], low[2] + half[2]);
    let mesh = cuboid(2.0 * half[0], 2.0 * half[1], 2.0 * half[2]).unwrap().transformed(&middle);
    (mesh, (pose_to_parry(&middle), SharedShape::cuboid(half[0], half[1], half[2])))
}

/// A box without its top, a surface.
fn bucket(s: f64) -> (TriMesh, Vec<(Pose, SharedShape)>) {
    let whole = cuboid(1.4 * s, 1.2 * s, s).unwrap();
    let triangles: Vec<_> = whole
        .triangles()
        .iter()
        .copied()
        .filter(|t| t.iter().any(|v| whole.vertices()[*v as usize].z < 0.0))
        .collect();
    let mesh = TriMesh::new(whole.vertices().to_vec(), triangles).unwrap();
    let triangle = |i| {
        let [a, b, c] = mesh.triangle(i).map(|p| point_to_parry(&p));
        (Pose::IDENTITY, SharedShape::triangle(a, b, c))
    };
    let pieces = (0..mesh.triangles().len()).map(triangle).collect();
    (mesh, pieces)
}

/// Shapes of size `s`, with their names.
fn shapes(s: f64) -> Vec<(&'static str, Shape)> {
    let corner = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.4], [0.4, 0.4], [0.4, 1.0], [0.0, 1.0]];
    let corner = corner.map(|[x, y]| Point2::new(s * (x - 0.5), s * (y - 0.5)));
    // As read from a file, facing inward, and made solid.
    let bracket = prism(&corner, -0.3 * s, 0.3 * s).unwrap().reversed().into_solid().unwrap();
    let leg = |x: f64, y: f64| between([-0.5 * s, -0.5 * s, -0.3 * s], [x * s, y * s, 0.3 * s]).1;
    let (mesh, mut pieces) = bucket(s);
    let (block, piece) = between([-0.2 * s, 0.1 * s, -0.3 * s], [0.2 * s, 0.9 * s, 0.1 * s]);
    let (other, second) = between([-0.1 * s, 0.5 * s, -0.2 * s], [0.8 * s, 1.1 * s, 0.0]);
    let merged = TriMesh::merged([&block, &mesh, &other]).unwrap();
    let open = Shape::new(&mesh, pieces.clone());
    pieces.extend([piece, second]);
    vec![
        ("box", Shape::convex(&cuboid(s, 0.8 * s, 0.6 * s).unwrap())),
        ("sphere", Shape::convex(&sphere(0.5 * s, 1).unwrap())),
        ("cylinder", Shape::convex(&cylinder(0.4 * s, s, 16).unwrap())),
        ("bracket", Shape::new(&bracket, vec![leg(0.5, -0.1), leg(-0.1, 0.5)])),
        ("bucket", open),
        ("body", Shape::new(&merged, pieces)),
    ]
}

/// Whether `a` and `b` at a pose have a point in common.
fn meet_in_parry(a: &Shape, b: &Shape, pose: &Pose) -> bool {
    let meet = |x: &(Pose, SharedShape), y: &(Pose, SharedShape)| {
        intersection_test(&x.0, &*x.1, &(pose * y.0), &*y.1).unwrap().intersecting
    };
    a.pieces.iter().any(|x| b.pieces.iter().any(|y| meet(x, y)))
}

/// How often the two are free, touch, and are one inside of the other, of `count` poses within `reach`.
fn compare(name: &str, [a, b]: [&Shape; 2], reach: f64, count: usize) -> [usize; 3] {
    let (mut rng, mut query) = (rng(count as u64), Query::default());
    let (mut seen, here) = ([0; 3], Isometry3::identity());
    let mut scene = Scene::new();
    scene.insert("a", a.tree.clone(), here).unwrap();
    for _ in 0..count {
        let pose = pose(&mut rng, reach);
        let touch = query.intersects(&b.tree, &pose, &a.tree, &here);
        let nested = !touch && query.nested(&b.tree, &pose, &a.tree, &here);
        let clearance = scene.clearance(&mut query, &b.tree, &pose, 1e-3).0;
        let apart = b.reference.at_least(&pose, &a.reference, &here, 1e-12).is_ok();
        let proved = apart && !b.reference.is_nested(&pose, &a.reference, &here);
        let expected = meet_in_parry(a, b, &pose_to_parry(&pose));
        let collides =
            [touch || nested, scene.collides(&mut query, &b.tree, &pose), clearance <= 0.0, !proved];
        if collides != [expected; 4] {
            let surfaces = query.distance(&a.tree, &here, &b.tree, &pose).distance;
            let by = if surfaces > 0.0 { surfaces } else { query.depth(&a.tree, &here, &b.tree, &pose) };
            assert!(by < BAND, "{name} at {pose:?}: {collides:?}, {expected} in parry, by {by}");
        }
        seen[usize::from(touch) + 2 * usize::from(nested)] += 1;
    }
    seen
}

/// 100 000 poses for each pair of shapes: of the same size, and one much smaller than the other.
#[test]
fn what_is_inside_of_a_solid_meets_it() {
    let (large, small) = (shapes(1.0), shapes(0.2));
    let third = cases_of(100_000).div_ceil(3);
    let of_pair = |i: usize, j: usize| {
        let ((name, a), (other, b)) = (&large[i], &large[j]);
        let (small_a, small_b) = (&small[i].1, &small[j].1);
        let sizes = [([a, b], 1.2), ([a, small_b], 0.6), ([b, small_a], 0.6)];
        let seen = sizes.map(|(pair, reach)| compare(&format!("{name} and {other}"), pair, reach, third));
        assert!(
            seen.iter().all(|n| n[0] > third / 100 && n[1] > third / 100),
            "{name} and {other}: {seen:?}"
        );
        // What is as large as a solid is never inside of it; what is small is, unless both are surfaces.
        let solids = [a, b].iter().filter(|shape| shape.tree.is_filled()).count();
        assert!(seen[1][2] + seen[2][2] > 0 || solids == 0, "{name} and {other}: {seen:?}");
    };
    let (large, of_pair) = (&large, &of_pair);
    std::thread::scope(|threads| {
        for i in 0..large.len() {
            threads.spawn(move || (i..large.len()).for_each(|j| of_pair(i, j)));
        }
    });
}
